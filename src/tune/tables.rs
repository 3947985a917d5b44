//! What tuning found, as tables and sentences. In: findings. Out: text for the screen, tables for the page.

use machine::Kinematics;
use protocol::Axis;
use tune::{Estimate, Goals, LoopMargins, Tuned};

use super::{
    Found,
    change::{self, Change},
    trial::Row,
};
use report::table::{Place, Table, six};

/// Everything for the screen.
pub(super) fn text(found: &Found) -> String {
    let axes = found.tuned.iter().map(|tuned| {
        let tables = [changes(found, tuned), margins(tuned)];
        let sentences: String = sentences(found, tuned).iter().map(|line| format!("{line}\n")).collect();
        format!("{}\n{}\n{sentences}\n", tables[0].text(), tables[1].text())
    });
    let axes: String = axes.collect();
    let trial = match &found.trial {
        Ok(compared) => {
            let one = |(axis, _): &(Axis, _)| {
                format!("trial pass, servo error of {axis}\n{}", trial(*axis, &compared.rows).text())
            };
            let tables = compared.curves.iter().map(one).collect::<Vec<_>>().join("\n");
            let failures = failures(&compared.rows).into_iter().map(|line| format!("{line}\n"));
            tables + &failures.collect::<String>()
        }
        Err(reason) => format!("no trial pass: {reason}\n"),
    };
    format!("{axes}{trial}")
}

/// Keys before and after.
pub(super) fn changes(found: &Found, tuned: &Tuned) -> Table {
    let before = &found.machine.axis[&tuned.axis];
    let changes = change::changes(before, tuned);
    let widest = |of: fn(&Change) -> usize| changes.iter().map(of).max().unwrap_or(0);
    let (key, how) = (widest(|change| change.key.len()), widest(|change| change.how.chars().count()));
    // Columns are flush right; words of one width are flush left as well.
    let row = |change: &Change| {
        let deviation = change.deviation.map_or("chosen".into(), two);
        vec![
            format!("{:key$}", change.key),
            change.before.map_or("–".into(), six),
            change.after.map_or("–".into(), six),
            deviation,
            change.unit.clone(),
            format!("{:how$}", change.how),
        ]
    };
    Table {
        title: format!("{}: what is proposed", tuned.axis),
        caption: "±: standard deviation, from what the model leaves of the measurements; \"chosen\": follows from the \
                  margins or from the cycle."
            .into(),
        head: ["key", "before", "after", "±", "", "how"].map(|name| [name.into(), String::new()]).to_vec(),
        rows: changes.iter().map(row).collect(),
        place: Place::Everywhere,
    }
}

/// A number in two significant digits.
fn two(value: f64) -> String {
    format!("{value:.1e}").parse::<f64>().unwrap_or(value).to_string()
}

/// Margins before and after.
pub(super) fn margins(tuned: &Tuned) -> Table {
    let row = |name: &str, margins: &LoopMargins| {
        let gain = if margins.gain.is_finite() { format!("{:.2}", margins.gain) } else { "–".into() };
        let phase =
            if margins.phase_deg.is_finite() { format!("{:.1}", margins.phase_deg) } else { "–".into() };
        let crossover = margins.crossover_hz;
        let crossover = if crossover.is_finite() { format!("{crossover:.1}") } else { "–".into() };
        vec![format!("{name:22}"), phase, gain, crossover]
    };
    Table {
        title: format!("{}: margins of the loops", tuned.axis),
        caption: "On the measured response. The crossover is the one with the least phase margin.".into(),
        head: [["loop", ""], ["phase margin", "°"], ["gain margin", ""], ["crossover", "Hz"]]
            .map(|column| column.map(str::to_owned))
            .to_vec(),
        rows: vec![
            row("velocity loop, before", &tuned.before.velocity),
            row("velocity loop, after", &tuned.after.velocity),
            row("position loop, before", &tuned.before.position),
            row("position loop, after", &tuned.after.position),
        ],
        place: Place::Everywhere,
    }
}

/// Servo errors of an axis in the trial passes.
pub(super) fn trial(axis: Axis, rows: &[Row]) -> Table {
    // A value that rounds to nothing has no sign.
    let micrometres = |um: f64| format!("{:+.2}", (um * 100.0).round() / 100.0 + 0.0);
    let row = |row: &Row| {
        let clamped = row.in_force_pct.filter(|pct| (pct - row.override_pct).abs() > 0.5);
        let clamped = clamped.map_or(String::new(), |pct| format!(" ({pct:.0} in force)"));
        let mut cells = vec![
            format!("{:.0}{clamped}", row.override_pct),
            if row.tuned { "after" } else { "before" }.into(),
        ];
        match &row.errors {
            Some(errors) => cells.extend([
                micrometres(errors.approach_min_um),
                micrometres(errors.approach_max_um),
                micrometres(errors.end_um),
                format!("{:.2}", errors.at_depth_max_abs_um),
                format!("{:.2}", errors.thread_max_abs_um),
            ]),
            None => cells.extend(["failed", "", "", "", ""].map(String::from)),
        }
        cells
    };
    Table {
        title: format!("Trial pass before and after: servo error of {axis}"),
        caption:
            "A stroke of 5 mm in one turn at 300 1/min, then a thread of 5 mm lead, without cutting force. At \
                  depth: from the end of the approach on; thread: from one turn later on."
                .into(),
        head: [
            ["override", "%"],
            ["", ""],
            ["approach min", "µm"],
            ["approach max", "µm"],
            ["end", "µm"],
            ["at depth", "± µm"],
            ["thread", "± µm"],
        ]
        .map(|column| column.map(str::to_owned))
        .to_vec(),
        rows: rows.iter().filter(|row| row.axis == axis).map(row).collect(),
        place: Place::Everywhere,
    }
}

/// What ended the passes that the machine did not make, once each.
pub(super) fn failures(rows: &[Row]) -> Vec<String> {
    let when = |row: &Row| if row.tuned { "after" } else { "before" };
    let line = |row: &Row| Some(format!("{} % {}: {}", row.override_pct, when(row), row.failed.as_ref()?));
    let mut lines: Vec<String> = rows.iter().filter_map(line).collect();
    lines.dedup();
    lines
}

/// Angle of the spindle in degrees that an approach of `time_s` takes at the highest override it is laid out
/// for.
pub(super) fn approach_deg(found: &Found, time_s: f64) -> f64 {
    6.0 * found.rpm * time_s * design(found) / 100.0
}

/// The same in words, on a machine that moves in step with its spindle.
fn angle(found: &Found, time_s: f64) -> String {
    if found.machine.general.kinematics != Kinematics::Lathe {
        return String::new();
    }
    let (degrees, rpm, design) = (approach_deg(found, time_s).ceil(), found.rpm, design(found));
    format!(": ΔC of {degrees:.0}° at {rpm} 1/min, up to {design:.0} % override")
}

fn design(found: &Found) -> f64 {
    found.machine.threading.design_override_pct
}

/// What no key of the machine file holds.
pub(super) fn sentences(found: &Found, tuned: &Tuned) -> Vec<String> {
    let shown = |estimate: Estimate, factor: f64, digits: usize| {
        let unit = libm::pow(10.0, digits as f64);
        let rounded = (factor * estimate.value * unit).round() / unit + 0.0;
        format!("{rounded:.digits$} ± {:.digits$}", factor * estimate.deviation)
    };
    let axis = tuned.axis;
    let mut lines = vec![
        format!(
            "{axis}: test moves within {:.0} {}; torque acts {} µs after its command, behind a lag of {} µs",
            tuned.reach_mm.abs(),
            axis.unit(),
            shown(tuned.delay_s, 1e6, 1),
            shown(tuned.lag_s, 1e6, 1),
        ),
        format!(
            "{axis}: breaks away at {:.0} N; constant force {} N",
            tuned.breakaway_n,
            shown(tuned.constant_n, 1.0, 1)
        ),
    ];
    lines.push(match &tuned.mode {
        Some(mode) => format!(
            "{axis}: the slide ({:.0} kg) swings at {} Hz, damping {:.3}{}",
            mode.slide_kg.value,
            shown(mode.hz, 1.0, 2),
            mode.damping.value,
            stroke(found, tuned),
        ),
        None => format!("{axis}: no mode of the slide is seen"),
    });
    lines
}

/// What the mode leaves of an approach, in words.
fn stroke(found: &Found, tuned: &Tuned) -> String {
    let backlash = found.machine.axis[&tuned.axis].backlash_mm;
    if backlash > 0.0 {
        let unit = tuned.axis.unit();
        return format!(
            ": not to be trusted, a backlash of {backlash} {unit} makes it seem slower and more damped"
        );
    }
    tuned.approach_s.map_or(String::new(), |approach_s| {
        let Goals { stroke_mm, residual_um, .. } = found.goals;
        format!(
            "; a stroke of {stroke_mm} mm leaves at most {residual_um} µm of it if it takes {approach_s:.3} s or more{}",
            angle(found, approach_s),
        )
    })
}
