//! Machine files with other values in them. In: a machine file, keys with values. Out: its text with those
//! values, checked: everything else, comments too, is as it was.

use std::path::Path;

use machine::Machine;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// The text of a machine file with other values. Paths in it that are relative to `beside`, the folder of
/// the original, are written out, because the new file lies elsewhere.
///
/// # Errors
/// A key is not one of a machine file, or a machine with these values is refused: which, and why.
pub fn machine(text: &str, beside: &Path, keys: &[(&str, &toml::Value)]) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    for (key, value) in keys {
        let value: Value = value.to_string().parse().map_err(|error| format!("vary.\"{key}\": {error}"))?;
        put(document.as_item_mut(), key, value).map_err(|why| format!("vary.\"{key}\": {why}"))?;
    }
    for name in ["tool_table", "parameters"] {
        let item = document.get_mut("machine").and_then(|machine| machine.get_mut(name));
        if let Some(item) = item
            && let Some(path) = item.as_str().map(|path| beside.join(path))
        {
            *item = toml_edit::value(path.display().to_string());
        }
    }
    let text = document.to_string();
    let said = || keys.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ");
    Machine::from_toml(&text).map_err(|error| format!("no machine with {}: {error}", said()))?;
    Ok(text)
}

/// Puts a value where a path of keys leads. The last key may be new, because a machine file need not say what
/// has a default; the table has to be there.
fn put(item: &mut Item, path: &str, value: Value) -> Result<(), String> {
    let (way, last) = path.rsplit_once('.').unwrap_or(("", path));
    let mut at = item;
    for name in way.split('.').filter(|name| !name.is_empty()) {
        let there = at.get_mut(name).filter(|there| !there.is_none());
        at = there.ok_or_else(|| format!("the machine file has no [{way}]"))?;
    }
    let table = at.as_table_like_mut().ok_or_else(|| format!("[{way}] is no table of the machine file"))?;
    if table.get(last).is_some_and(|there| !there.is_none() && !there.is_value()) {
        return Err(format!("{path} is a table: name a key in it"));
    }
    set(table, last, value);
    Ok(())
}

/// Sets a value; one that is absent comes at the end of the section. A comment behind it stays in its column
/// where there is room.
pub fn set(section: &mut dyn TableLike, name: &str, mut value: Value) {
    let length = |value: &Value| value.clone().decorated("", "").to_string().chars().count();
    if let Some(before) = section.get(name).and_then(Item::as_value) {
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
    section.insert(name, Item::Value(value));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(key: &str, value: impl Into<toml::Value>) -> Result<String, String> {
        machine(machine::SMALL_LATHE, Path::new("/shop"), &[(key, &value.into())])
    }

    #[test]
    fn a_value_is_changed_and_nothing_else() {
        let text = with("axis.x.mass_kg", 1500.0).expect("a machine");
        let was: Vec<&str> = machine::SMALL_LATHE.lines().collect();
        let other: Vec<_> = text.lines().zip(&was).filter(|(new, old)| new != *old).collect();
        assert_eq!(other.len(), 1, "{other:?}");
        assert!(other[0].0.starts_with("mass_kg = 1500.0"), "{other:?}");
        assert_eq!(text.lines().count(), was.len());
    }

    #[test]
    fn a_path_of_the_original_is_found_from_elsewhere() {
        let text = with("machine.tool_table", "shop.tbl").expect("a machine");
        assert!(text.contains("tool_table = \"/shop/shop.tbl\""), "{text}");
    }

    #[test]
    fn what_is_no_key_or_no_machine_is_told_by_name() {
        let refused = |key: &str, value: toml::Value, says: &str| {
            let why = with(key, value).expect_err(key);
            assert!(why.contains(says), "{key}: {why}");
        };
        refused("axis.w.mass_kg", 1.0.into(), "has no [axis.w]");
        refused("axis.x", 1.0.into(), "axis.x is a table");
        refused("axis.x.mas_kg", 1.0.into(), "mas_kg");
        refused("axis.x.mass_kg", (-1.0).into(), "no machine with axis.x.mass_kg = -1.0");
        refused("axis.x.mass_kg", "heavy".into(), "no machine with axis.x.mass_kg = \"heavy\"");
    }
}
