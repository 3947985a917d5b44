//! What the columns of a trace are called, in which order they come, and in which unit each of them is.

use protocol::Axis;

/// A name and a unit of what is recorded of an axis; `state` is not a real number.
const AXIS_COLUMNS: [(&str, &str); 10] = [
    ("programmed", "mm"),
    ("commanded", "mm"),
    ("measured", "mm"),
    ("true", "mm"),
    ("velocity", "mm/s"),
    ("acceleration", "mm/s^2"),
    ("jerk", "mm/s^3"),
    ("servo_error", "mm"),
    ("torque", "N m"),
    ("state", "code of the state"),
];

/// A name and a unit of what is recorded of the cut.
const CUT_COLUMNS: [(&str, &str); 4] = [
    ("chip_area", "mm^2"),
    ("cutting_force", "N, tangential"),
    ("cutting_torque", "N m"),
    ("spindle_torque", "N m, of the motor"),
];

/// A name and a unit of what is measured of a contour, a surface or a seam, first by commanded, then by true
/// positions.
const TRACED_COLUMNS: [(&str, &str); 6] = [
    ("commanded_deviation", "mm"),
    ("commanded_angle", "deg"),
    ("commanded_feed", "mm/min"),
    ("true_deviation", "mm"),
    ("true_angle", "deg"),
    ("true_feed", "mm/min"),
];

/// Name, unit and whether it is a real number, of every column of a trace.
pub(super) fn described(axes: &[Axis]) -> Vec<(String, &'static str, bool)> {
    let column = |name: &str, unit, real| (name.to_string(), unit, real);
    let mut all = vec![
        column("cycle", "control cycle", false),
        column("t_s", "s", true),
        column("spindle_true_deg", "degrees, unwrapped", true),
        column("spindle_counts", "encoder counts, unwrapped", false),
        column("spindle_rpm", "1/min, true", true),
        column("override_pct", "per cent", true),
    ];
    for axis in axes {
        let of_axis =
            |(name, unit)| (format!("{}_{name}", axis.name()), in_unit_of(*axis, unit), name != "state");
        all.extend(AXIS_COLUMNS.map(of_axis));
    }
    all.push(column("pass", "0 in timed motion", false));
    all.push(column("line", "of the part program", false));
    all.extend(
        axes.iter().map(|axis| (format!("{}_slide", axis.name()), in_unit_of(*axis, "mm, true"), true)),
    );
    all.extend(axes.iter().map(|axis| (format!("{}_force", axis.name()), "N, on the slide", true)));
    all.extend(CUT_COLUMNS.map(|(name, unit)| column(name, unit, true)));
    all.push(column("trace", "contour, surface or seam that is cut, 0 if none", false));
    all.extend(TRACED_COLUMNS.map(|(name, unit)| column(name, unit, true)));
    all.push(column("tool", "number of the tool, 0 if none", false));
    all.push(column("motion", "code of how the commanded position moves", false));
    all
}

/// The unit of a column of an axis: a rotary axis has degrees for mm.
fn in_unit_of(axis: Axis, unit: &'static str) -> &'static str {
    match (axis.is_rotary(), unit) {
        (false, unit) => unit,
        (true, "mm") => "deg",
        (true, "mm/s") => "deg/s",
        (true, "mm/s^2") => "deg/s^2",
        (true, "mm/s^3") => "deg/s^3",
        (true, "mm, true") => "deg, true",
        (true, other) => other,
    }
}

/// The columns of a trace in their order. Those of an axis begin with its letter, as in `x_commanded`.
pub fn columns(axes: &[Axis]) -> Vec<String> {
    described(axes).into_iter().map(|(name, ..)| name).collect()
}

/// Their units, or what they are, in words.
pub fn units(axes: &[Axis]) -> Vec<&'static str> {
    described(axes).into_iter().map(|(_, unit, _)| unit).collect()
}

/// The axes of a trace with these columns.
///
/// # Errors
/// Says which column is missing or unexpected.
pub fn axes_of(names: &[&str]) -> Result<Vec<Axis>, String> {
    let axis = |name: &&str| Axis::from_name(name.strip_suffix("_programmed")?);
    let axes: Vec<Axis> = names.iter().filter_map(axis).collect();
    let expected = columns(&axes);
    for (index, name) in expected.iter().enumerate() {
        match names.get(index) {
            Some(found) if found == name => {}
            Some(found) => return Err(format!("column {} is {found}, expected {name}", index + 1)),
            None => return Err(format!("column {name} is missing")),
        }
    }
    match names.get(expected.len()) {
        Some(extra) => Err(format!("unexpected column {extra}")),
        None => Ok(axes),
    }
}
