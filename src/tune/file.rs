//! The machine file with the keys of tuned axes changed, and nothing else: comments and layout stay. In: its
//! text. Out: its text.

use machine::AxisConfig;
use protocol::Axis;
use toml_edit::{DocumentMut, Item, Value};

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
    for key in &KEYS {
        let name = key.name_on(axis);
        let item = ["axis", axis.name(), &name].iter().try_fold(document.as_item_mut(), |item, name| {
            item.as_table_like_mut().and_then(|table| table.get_mut(name))
        });
        let missing = || CliError::Input(format!("machine file: axis.{}.{name} is missing", axis.name()));
        let item = item.ok_or_else(missing)?;
        set(item, (key.of)(proposal));
    }
    Ok(document.to_string())
}

/// Sets a number. A comment behind it stays in its column where there is room.
fn set(item: &mut Item, number: f64) {
    let mut value = Value::from(number);
    let length = |value: &Value| value.clone().decorated("", "").to_string().chars().count();
    if let Some(before) = item.as_value() {
        let decor = before.decor();
        let text =
            |raw: Option<&toml_edit::RawString>| raw.and_then(|raw| raw.as_str()).unwrap_or("").to_owned();
        let (prefix, suffix) = (text(decor.prefix()), text(decor.suffix()));
        let comment = suffix.trim_start_matches(' ');
        let suffix = if comment.starts_with('#') {
            let column = length(before) + suffix.chars().count() - comment.chars().count();
            let gap = column.saturating_sub(length(&value)).max(1);
            format!("{}{comment}", " ".repeat(gap))
        } else {
            suffix
        };
        value = value.decorated(prefix, suffix);
    }
    *item = Item::Value(value);
}

#[cfg(test)]
mod tests {
    use machine::{Machine, SMALL_LATHE};
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
    fn what_is_no_machine_file_is_refused() {
        let proposal = Machine::default().axis[&Axis::X].clone();
        for text in ["[axis", "", "[axis.z]\nmass_kg = 1.0", "axis = 1", "[axis]\nx = [1]"] {
            assert!(edited(text, Axis::X, &proposal).is_err(), "{text}");
        }
    }
}
