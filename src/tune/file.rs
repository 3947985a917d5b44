//! The machine file with the keys of tuned axes changed, and nothing else: comments and layout stay. In: its
//! text. Out: its text.

use campaign::vary::set;
use machine::AxisConfig;
use protocol::Axis;
use toml_edit::{Array, DocumentMut, Item, Value};

use super::change::KEYS;
use crate::error::CliError;

/// Writes the proposal of an axis into the text of a machine file.
///
/// # Errors
/// A text that is not TOML, or one without the section of the axis: it was read before, so neither is to be
/// expected.
pub(super) fn edited(text: &str, axis: Axis, proposal: &AxisConfig) -> Result<String, CliError> {
    let mut document: DocumentMut =
        text.parse().map_err(|error| CliError::Input(format!("machine file: {error}")))?;
    let section = ["axis", axis.name()].iter().try_fold(document.as_item_mut(), |item, name| {
        item.as_table_like_mut().and_then(|table| table.get_mut(name))
    });
    let missing = || CliError::Input(format!("machine file: [axis.{}] is missing", axis.name()));
    let section = section.and_then(Item::as_table_like_mut).ok_or_else(missing)?;
    for key in &KEYS {
        let name = key.name_on(axis);
        // A weight that is not proposed is none.
        let value = (key.of)(proposal).or(section.contains_key(&name).then_some(0.0));
        if let Some(value) = value {
            set(section, &name, Value::from(value));
        }
    }
    if !proposal.cogging.is_empty() || section.contains_key("cogging") {
        let rows = proposal.cogging.iter().map(|[times, torque_nm, phase_deg]| {
            let row = [Value::from(*times as i64), (*torque_nm).into(), (*phase_deg).into()];
            row.into_iter().collect::<Array>()
        });
        set(section, "cogging", Value::from(rows.collect::<Array>()));
    }
    Ok(document.to_string())
}

#[cfg(test)]
mod tests {
    use machine::{Machine, PLAIN_LATHE, SMALL_LATHE};
    use protocol::Axis;

    use super::edited;

    #[test]
    fn only_the_keys_of_the_axis_change() {
        let mut proposal = Machine::default().axis[&Axis::X].clone();
        (proposal.mass_kg, proposal.coulomb_n, proposal.acceleration_lead_s) = (2004.9, 270.0, 0.001_251);
        let text = edited(SMALL_LATHE, Axis::X, &proposal).expect("it is a machine file");
        assert_eq!(Machine::from_toml(&text).expect("it still is").axis[&Axis::X], proposal);
        let changed: Vec<_> =
            SMALL_LATHE.lines().zip(text.lines()).filter(|(before, after)| before != after).collect();
        let expected = [
            "mass_kg = 2004.9              # as believed: everything that accelerates, with screw and rotor",
            "coulomb_n = 270.0             # friction as believed,",
            "acceleration_lead_s = 0.001251 # one and a half cycles and the lag of the current",
        ];
        assert_eq!(changed.iter().map(|(_, after)| *after).collect::<Vec<_>>(), expected);
        assert_eq!(SMALL_LATHE.lines().count(), text.lines().count());
    }

    #[test]
    fn keys_that_are_absent_come_at_the_end_of_the_section() {
        let mut proposal = Machine::plain().axis[&Axis::X].clone();
        (proposal.gravity_n, proposal.mode_hz) = (-723.5, Some(99.86));
        proposal.cogging = vec![[24.0, 0.0474, 150.0], [48.0, 0.01, -20.5]];
        let text = edited(PLAIN_LATHE, Axis::X, &proposal).expect("it is a machine file");
        assert_eq!(Machine::from_toml(&text).expect("it still is").axis[&Axis::X], proposal);
        let added: Vec<_> =
            text.lines().filter(|line| !PLAIN_LATHE.lines().any(|old| old == *line)).collect();
        let rows = "cogging = [[24, 0.0474, 150.0], [48, 0.01, -20.5]]";
        assert_eq!(added, ["gravity_n = -723.5", "mode_hz = 99.86", rows]);
        assert_eq!(PLAIN_LATHE.lines().count() + 3, text.lines().count());
        // And what is there and not proposed any more is none.
        let plain = Machine::plain().axis[&Axis::X].clone();
        let none = edited(&text.replace("mode_hz = 99.86\n", ""), Axis::X, &plain).expect("a machine file");
        assert!(none.contains("\ngravity_n = 0.0\n") && none.contains("\ncogging = []\n"), "{none}");
        assert_eq!(Machine::from_toml(&none).expect("it still is").axis[&Axis::X], plain);
    }

    #[test]
    fn what_is_no_machine_file_is_refused() {
        let proposal = Machine::default().axis[&Axis::X].clone();
        for text in ["[axis", "", "[axis.z]\nmass_kg = 1.0", "axis = 1", "[axis]\nx = [1]"] {
            assert!(edited(text, Axis::X, &proposal).is_err(), "{text}");
        }
    }
}
