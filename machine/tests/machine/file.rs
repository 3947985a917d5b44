//! A machine file that cannot be used is refused, and the message says where and why.
#![allow(clippy::unwrap_used)]

use machine::{
    Difference, Feedforward, Kinematics, Machine, PLAIN_LATHE, POSITIONER, PathConfig, SMALL_MILL,
};
use proptest::prelude::*;
use protocol::{Axis, AxisMeasurement, Cycle, Position};
use toml::{Table, Value};

fn refusal(text: &str) -> String {
    Machine::from_toml(text).unwrap_err().to_string()
}

/// The file of the plain lathe with one line changed.
fn with(line: &str, instead: &str) -> String {
    assert!(PLAIN_LATHE.contains(line), "{line}");
    PLAIN_LATHE.replacen(line, instead, 1)
}

/// Every key that the controller reads, as a path.
fn paths() -> Vec<Vec<String>> {
    fn walk(table: &Table, path: &mut Vec<String>, found: &mut Vec<Vec<String>>) {
        for (key, value) in table {
            path.push(key.clone());
            match value {
                Value::Table(inner) => walk(inner, path, found),
                _ => found.push(path.clone()),
            }
            path.pop();
        }
    }
    let mut table: Table = PLAIN_LATHE.parse().unwrap();
    table.remove("plant");
    table.remove("tools");
    let mut found = Vec::new();
    walk(&table, &mut Vec::new(), &mut found);
    found
}

/// The built-in file with one value replaced.
fn replaced(path: &[String], value: Value) -> String {
    let mut table: Table = PLAIN_LATHE.parse().unwrap();
    let (key, parents) = path.split_last().unwrap();
    let mut inner = &mut table;
    for parent in parents {
        inner = inner.get_mut(parent).unwrap().as_table_mut().unwrap();
    }
    inner.insert(key.clone(), value);
    toml::to_string(&table).unwrap()
}

#[test]
fn the_built_in_machine_and_the_plain_one_are_good() {
    for machine in [Machine::default(), Machine::plain()] {
        assert_eq!(machine.cycles_per_tick(), 4);
        assert!(machine.is_tick(Cycle(8)) && !machine.is_tick(Cycle(9)));
        assert_eq!(machine.axes().map(|(axis, _)| axis).collect::<Vec<_>>(), [Axis::X, Axis::Z]);
        let again = Machine::from_toml(&toml::to_string(&machine).unwrap()).unwrap();
        assert_eq!(again, machine);
    }
}

#[test]
fn the_built_in_mill_is_good() {
    let machine = Machine::from_toml(SMALL_MILL).unwrap();
    assert_eq!(machine.general.kinematics, Kinematics::Mill);
    assert_eq!(machine.axes().map(|(axis, _)| axis).collect::<Vec<_>>(), [Axis::X, Axis::Y, Axis::Z]);
    assert_eq!(machine.path, PathConfig::default());
}

#[test]
fn the_built_in_positioner_is_good() {
    let machine = Machine::from_toml(POSITIONER).unwrap();
    assert_eq!(machine.general.kinematics, Kinematics::Positioner);
    let axes: Vec<_> = machine.axes().map(|(axis, _)| axis).collect();
    assert_eq!(axes, [Axis::X, Axis::Y, Axis::A, Axis::C]);
    assert!(machine.spindle.is_none());
    let geometry = machine.positioner.as_ref().unwrap();
    assert_eq!((geometry.x1_mm, geometry.y1_mm, geometry.z1_mm), (120.0, -35.0, 250.0));
    assert_eq!((geometry.x2_mm, geometry.y2_mm, geometry.z2_mm), (15.0, 8.0, -50.0));
    let travel = [Axis::X, Axis::C].map(|axis| machine.axis[&axis].travel_mm);
    assert_eq!(travel, [[-150.0, 150.0], [-720.0, 720.0]]);
    let written = toml::to_string(&machine).unwrap();
    assert!(written.contains("travel_deg") && written.contains("quantum_deg"), "{written}");
    assert_eq!(Machine::from_toml(&written).unwrap(), machine);
}

/// The table of a positioner belongs to a positioner, a spindle to the others.
#[test]
fn tables_that_a_machine_lacks_or_has_no_use_for_are_named() {
    let without = |text: &str, table: &str, end: &str| {
        let (before, rest) = text.split_once(table).unwrap();
        let (_, after) = rest.split_once(end).unwrap();
        format!("{before}{end}{after}")
    };
    let table =
        "[positioner]\nx1_mm = 1\ny1_mm = 1\nz1_mm = 1\nx2_mm = 1\ny2_mm = 1\nz2_mm = 1\nbeam_mm = [0, 0]";
    let spindle = SMALL_MILL.split_once("[spindle]").unwrap().1.split_once("# The truth").unwrap().0;
    for (text, message) in [
        (
            without(POSITIONER, "[positioner]", "[path]"),
            "machine.kinematics = positioner: needs [positioner] with x1_mm",
        ),
        (
            format!("{SMALL_MILL}\n{table}"),
            "positioner = a table: is for machine.kinematics = \"positioner\" only",
        ),
        (format!("{POSITIONER}\n[spindle]{spindle}"), "spindle = a table: a positioner has no spindle"),
        (
            without(SMALL_MILL, "[spindle]", "[plant.axis.x]"),
            "spindle = nothing: a lathe or a mill needs [spindle]",
        ),
        (
            POSITIONER.replace("[axis.a]", "[axis.b]"),
            "axis = x, y, b, c: a positioner has [axis.x], [axis.y]",
        ),
        (POSITIONER.replace("[axis.a]", "[axis.z]"), "axis = x, y, z, c: a positioner has"),
        (POSITIONER.replace("z2_mm = -50.0", "z2_mm = nan"), "positioner.z2_mm = NaN: must lie between"),
        (POSITIONER.replace("[130.0, -20.0]", "[130.0, -2e5]"), "positioner.beam_mm[1] = -200000: must lie"),
    ] {
        let refused = refusal(&text);
        assert!(refused.starts_with(message), "{refused}");
    }
    assert!(refusal(&POSITIONER.replace("beam_mm = [130.0, -20.0]", "")).contains("beam_mm"));
    assert!(refusal(&POSITIONER.replace("x1_mm = ", "x3_mm = ")).contains("x3_mm"));
}

#[test]
fn each_kinematics_has_its_axes() {
    let as_lathe = SMALL_MILL.replace("kinematics = \"mill\"", "kinematics = \"lathe\"");
    assert!(refusal(&as_lathe).starts_with("axis = y: a lathe needs"));
    let as_mill = with("kinematics = \"lathe\"", "kinematics = \"mill\"");
    assert!(refusal(&as_mill).starts_with("axis = x, z: a mill needs"));
    let with_u = SMALL_MILL.replace("[axis.y]", "[axis.u]");
    assert!(refusal(&with_u).starts_with("axis = x, z, u: a mill needs"));
}

/// The built-in lathe with a copy of Z as C, in degrees.
fn with_c() -> String {
    let (_, z) = PLAIN_LATHE.split_once("[axis.z]").unwrap();
    let (z, _) = z.split_once("[spindle]").unwrap();
    format!("{PLAIN_LATHE}\n[axis.c]{}", z.replace("mm", "deg"))
}

#[test]
fn a_rotary_axis_is_in_degrees() {
    let machine = Machine::from_toml(&with_c()).unwrap();
    assert_eq!(machine.axis[&Axis::C].travel_mm, machine.axis[&Axis::Z].travel_mm);

    let message = refusal(&with_c().replace("home_deg", "home_mm"));
    assert_eq!(message, "axis.c.home_mm = 100.0: C is measured in deg: write home_deg");
    let message = refusal(&with("home_mm = 60.0", "home_deg = 60.0"));
    assert_eq!(message, "axis.x.home_deg = 60.0: X is measured in mm: write home_mm");
    let message = refusal(&with_c().replace("velocity_deg_s = 150.0", "velocity_deg_s = -1.0"));
    assert!(message.starts_with("axis.c.velocity_deg_s = -1: must"), "{message}");
}

#[test]
fn unknown_keys_are_refused_wherever_they_are() {
    for section in ["[machine]", "[axis.x]", "[axis.z]", "[spindle]"] {
        let message = refusal(&with(section, &format!("{section}\nvelocity_mm_min = 1")));
        assert!(message.contains("velocity_mm_min") && message.contains("line"), "{message}");
    }
    assert!(refusal(&format!("{PLAIN_LATHE}\n[turret]")).contains("turret"));
}

#[test]
fn a_missing_key_is_named() {
    let message = refusal(&with("mass_kg = 1905.0", ""));
    assert!(message.contains("mass_kg"), "{message}");
}

#[test]
fn a_value_of_the_wrong_type_is_shown() {
    let message = refusal(&with("velocity_mm_s = 150.0", "velocity_mm_s = \"9 m/min\""));
    assert!(message.contains("velocity_mm_s = \"9 m/min\""), "{message}");
    let message = refusal(&with("dialect = \"auto\"", "dialect = \"heidenhain\""));
    assert!(message.contains("heidenhain") && message.contains("linuxcnc"), "{message}");
}

#[test]
fn every_number_has_bounds_and_its_refusal_names_its_path() {
    for path in paths() {
        let name = path.join(".");
        let table: Table = PLAIN_LATHE.parse().unwrap();
        let value = path.iter().fold(&Value::Table(table), |value, key| &value[key.as_str()]).clone();
        let impossible = match value {
            Value::Float(_) => Value::Float(f64::NAN),
            Value::Integer(_) => Value::Integer(1),
            Value::Array(_) => Value::Array(vec![Value::Float(f64::NAN), Value::Float(1.0)]),
            _ => continue,
        };
        let message = refusal(&replaced(&path, impossible));
        assert!(message.starts_with(&name) && message.contains("must"), "{name}: {message}");
    }
}

#[test]
fn values_that_contradict_each_other_are_refused() {
    for (line, instead, message) in [
        (
            "interpolator_cycle_s = 0.002",
            "interpolator_cycle_s = 0.0018",
            "machine.interpolator_cycle_s = 0.0018",
        ),
        (
            "interpolator_cycle_s = 0.002",
            "interpolator_cycle_s = 0.0001",
            "machine.interpolator_cycle_s = 0.0001",
        ),
        (
            "interpolator_cycle_s = 0.002",
            "interpolator_cycle_s = 0.02",
            "machine.interpolator_cycle_s = 0.02: must lie between 0.0005 and 0.005",
        ),
        ("travel_mm = [-5.0, 120.0]", "travel_mm = [120.0, -5.0]", "axis.x.travel_mm[1] = -5"),
        ("home_mm = 60.0", "home_mm = 121.0", "axis.x.home_mm = 121"),
        ("[threading]", "[path]\nexact_mm = 0.02\n[threading]", "path.exact_mm = 0.02: must lie between"),
        ("[axis.z]", "[axis.y]", "axis = x, y: a lathe needs [axis.x] and [axis.z]"),
    ] {
        let refused = refusal(&with(line, instead));
        assert!(refused.starts_with(message), "{instead}: {refused}");
    }
    let message = refusal(&format!("{PLAIN_LATHE}\n[tools.T3]\nname = \"x\""));
    assert!(message.starts_with("tools = T3"), "{message}");
}

/// The built-in lathe with more keys of X.
fn with_x(keys: &str) -> String {
    with("[axis.x]", &format!("[axis.x]\n{keys}"))
}

#[test]
fn structures_of_feedforward_have_names() {
    for (name, structure) in [
        ("none", Feedforward::None),
        ("difference-v", Feedforward::DifferenceV),
        ("difference-va", Feedforward::DifferenceVa),
        ("analytic-v", Feedforward::AnalyticV),
        ("analytic-va-no-lead", Feedforward::AnalyticVaNoLead),
        ("full", Feedforward::Full),
    ] {
        let machine = Machine::from_toml(&with_x(&format!("feedforward = {name:?}"))).unwrap();
        assert_eq!(machine.axis[&Axis::X].feedforward, structure);
    }
    let built_in = &Machine::default().axis[&Axis::X];
    assert_eq!((built_in.feedforward, built_in.difference), (Feedforward::Full, Difference::default()));
    let message = refusal(&with_x("feedforward = \"differences\""));
    assert!(message.contains("difference-va") && message.contains("line"), "{message}");
}

#[test]
fn differences_have_bounds() {
    for (table, message) in [
        ("{ quantum_mm = 0.0 }", "axis.x.difference.quantum_mm = 0: must lie between"),
        ("{ cycles = 0 }", "axis.x.difference.cycles = 0: must lie between"),
        (
            "{ cycles = 3, centred = true }",
            "axis.x.difference.cycles = 3: centred differences look 0.00275 s",
        ),
    ] {
        let refused = refusal(&with_x(&format!("difference = {table}")));
        assert!(refused.starts_with(message), "{refused}");
    }
    assert!(refusal(&with_x("difference = { quantum = 1.0 }")).contains("quantum"));
    for table in ["{ cycles = 3 }", "{ cycles = 2, centred = true }", "{ quantum_mm = 1e-9 }"] {
        Machine::from_toml(&with_x(&format!("difference = {table}"))).unwrap();
    }
}

/// Setpoints reach one tick of 2 ms back, and a cycle of 0.5 ms farther ahead.
#[test]
fn feedforward_looks_no_farther_than_setpoints_reach() {
    let lead = |name: &str, before: &str, lead: &str, more: &str| {
        let keys = with(&format!("{name} = {before}"), &format!("{name} = {lead}"));
        keys.replacen("[axis.x]", &format!("[axis.x]\n{more}"), 1)
    };
    let velocity = |at: &str, more: &str| lead("velocity_lead_s", "-0.00025", at, more);
    let acceleration = |at: &str, more: &str| lead("acceleration_lead_s", "0.00125", at, more);
    for at in ["-0.002", "0.0025"] {
        Machine::from_toml(&velocity(at, "")).unwrap();
        Machine::from_toml(&acceleration(at, "")).unwrap();
    }
    for at in ["-0.008", "-0.0021", "0.0026", "0.009"] {
        for structure in ["full", "analytic-v"] {
            let refused = refusal(&velocity(at, &format!("feedforward = {structure:?}")));
            assert!(
                refused.starts_with(&format!("axis.x.velocity_lead_s = {at}: must lie between")),
                "{refused}"
            );
        }
        let refused = refusal(&acceleration(at, ""));
        assert!(refused.contains(&format!("acceleration_lead_s = {at}: must lie between -0.002 and 0.0025")));
    }
    let refused = refusal(&velocity("-0.0015", "difference = { cycles = 2, centred = true }"));
    assert!(refused.contains("difference.cycles = 2: centred differences look 0.0025 s back"), "{refused}");
}

#[test]
fn what_lies_behind_the_motor_has_bounds() {
    for (keys, message) in [
        ("scale_step_mm = 0.0", "axis.x.scale_step_mm = 0: must"),
        ("scale_step_mm = 0.01", "axis.x.scale_step_mm = 0.01: must lie between 0.0000001 and 0.002"),
        ("backlash_mm = -0.1", "axis.x.backlash_mm = -0.1: must"),
        ("screw_error = [[0.0, 1.0]]", "axis.x.screw_error = 1 rows: must have between 2 and 256 rows"),
        ("screw_error = [[0, 1], [nan, 2]]", "axis.x.screw_error[1][0] = NaN: must"),
        ("screw_error = [[0, 1], [300, 1001]]", "axis.x.screw_error[1][1] = 1001: must"),
        ("screw_error = [[0, 1], [5, 2], [5.05, 2]]", "axis.x.screw_error[2][0] = 5.05: must be at least"),
        ("screw_error = [[0, 1], [-5, 2]]", "axis.x.screw_error[1][0] = -5: must be at least 0.1"),
        (
            "screw_error = [[0, 1], [10, 2], [20, -49]]",
            "axis.x.screw_error[2][1] = -49: may differ from 2, the row before",
        ),
    ] {
        let refused = refusal(&with_x(keys));
        assert!(refused.starts_with(message), "{refused}");
    }
    for wrong in ["screw_error = [[0, 1], [5, 2, 2]]", "screw_error = [[0], [5, 2]]"] {
        let message = refusal(&with_x(wrong));
        assert!(message.contains("screw_error") && message.contains("there must be two"), "{message}");
    }
    let message = refusal(&with("travel_mm = [-5.0, 120.0]", "travel_mm = [-5.0, 120.0, 3.0]"));
    assert!(message.contains("3 numbers were found, and there must be two"), "{message}");
    let long: Vec<_> = (0..257).map(|row| format!("[{row}, 0]")).collect();
    assert!(refusal(&with_x(&format!("screw_error = [{}]", long.join(", ")))).contains("257 rows"));
    let good = "scale_step_mm = 1e-4\nbacklash_mm = 0.01\nscrew_error = [[0, 1], [10, -49], [20, 1]]";
    let machine = Machine::from_toml(&with_x(good)).unwrap();
    assert_eq!(machine.axis[&Axis::X].screw_error, [[0.0, 1.0], [10.0, -49.0], [20.0, 1.0]]);
}

#[test]
fn the_loop_of_an_axis_with_a_scale_closes_over_it() {
    let measured = AxisMeasurement { position: Position(1), scale: Position(2), ..Default::default() };
    let mut x = Machine::plain().axis[&Axis::X].clone();
    assert_eq!(x.position(&measured), Position(1));
    x.scale_step_mm = Some(1e-4);
    assert_eq!(x.position(&measured), Position(2));
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(text in "(\\[[a-z.]{0,8}\\]\n|[a-z_]{1,12} = [-0-9.e\"a-z]{0,8}\n){0,12}") {
        let _ = Machine::from_toml(&text);
    }

    #[test]
    fn no_number_makes_it_panic(path in prop::sample::select(paths()), number in any::<f64>()) {
        let _ = Machine::from_toml(&replaced(&path, Value::Float(number)));
    }
}

#[test]
fn the_jitter_of_the_index_has_bounds() {
    for jitter in ["-1e-9", "2e-4"] {
        let keys = format!("encoder_lines = 2500          # four counts each\nindex_jitter_s = {jitter}");
        let refused = refusal(&with("encoder_lines = 2500          # four counts each", &keys));
        assert!(refused.starts_with("spindle.index_jitter_s = "), "{refused}");
        assert!(refused.contains("must lie between 0 and 0.0001"), "{refused}");
    }
}

#[test]
fn cogging_as_believed_has_bounds() {
    let nine: Vec<_> = (1..10).map(|times| format!("[{times}, 0.01, 0]")).collect();
    for (rows, message) in [
        ("[0.5, 0.01, 0]", "axis.x.cogging[0][0] = 0.5: must lie between 1 and 64"),
        ("[1, 0.01, 0], [65, 0.01, 0]", "axis.x.cogging[1][0] = 65: must lie between 1 and 64"),
        ("[2.5, 0.01, 0]", "axis.x.cogging[0][0] = 2.5: must be whole"),
        ("[24, -0.01, 0]", "axis.x.cogging[0][1] = -0.01: must lie between 0 and 14.3"),
        ("[24, 14.4, 0]", "axis.x.cogging[0][1] = 14.4: must lie between 0 and 14.3"),
        ("[24, 8, 0], [12, 7, 0]", "axis.x.cogging = 2 rows: takes 15.000 N·m at the motor, with gravity_n"),
        ("[24, 0.01, 361]", "axis.x.cogging[0][2] = 361: must lie between -360 and 360"),
        (&nine.join(", "), "axis.x.cogging = 9 rows: must have at most 8 rows"),
    ] {
        let refused = refusal(&with_x(&format!("cogging = [{rows}]")));
        assert!(refused.starts_with(message), "{refused}");
    }
    let message = refusal(&with_x("cogging = [[24, 0.05]]"));
    assert!(message.contains("2 numbers were found, and there must be three"), "{message}");
    let machine = Machine::from_toml(&with_x("cogging = [[24, 0.05, -90], [12, 0.0, 10]]")).unwrap();
    assert_eq!(machine.axis[&Axis::X].cogging, [[24.0, 0.05, -90.0], [12.0, 0.0, 10.0]]);
}

/// 14.3 N·m are 17970 N on a lead of 5 mm.
#[test]
fn weight_and_friction_are_less_than_the_drive_can_hold() {
    Machine::from_toml(&with_x("gravity_n = 17700.0")).unwrap();
    for (file, message) in [
        (
            with_x("gravity_n = -1e5"),
            "axis.x.gravity_n = -100000: takes 79.577 N·m at the motor, with gravity_n",
        ),
        (with_x("gravity_n = 17800.0"), "axis.x.gravity_n = 17800: takes 14.165 N·m at the motor"),
        (with("coulomb_n = 216.0", "coulomb_n = 20000.0"), "axis.x.coulomb_n = 20000: takes 15.915 N·m"),
    ] {
        let refused = refusal(&file);
        assert!(refused.starts_with(message) && refused.ends_with("if the drive has more"), "{refused}");
    }
}
