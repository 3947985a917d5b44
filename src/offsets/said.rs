//! What a line says of a coordinate system or a tool. In: its words. Out: what they set, or what is wrong.

use std::path::Path;

use gcode::files::Tool;

use crate::error::CliError;

/// Coordinate systems in the order of their parameters.
pub(super) const SYSTEMS: [&str; 9] = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];
/// Words of a system: the first ones are its zero, the last one turns it.
pub(super) const OF_SYSTEM: [char; 7] = ['X', 'Y', 'Z', 'A', 'B', 'C', 'R'];

/// The files keep six decimals.
const LEAST: f64 = 1e-6;

/// What a line sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Target {
    System(usize),
    Tool(i32),
}

impl Target {
    pub(crate) fn name(self) -> String {
        match self {
            Target::System(system) => SYSTEMS[system].to_owned(),
            Target::Tool(number) => format!("T{number}"),
        }
    }
}

/// One word of a line.
pub(crate) struct Set {
    pub(crate) target: Target,
    pub(crate) letter: char,
    pub(crate) value: f64,
}

/// What the lines of a file set.
pub(super) fn loaded(from: &Path) -> Result<Vec<Set>, CliError> {
    let text = intake::bytes(from, intake::TABLE).map_err(|error| CliError::file(from, error))?;
    let mut sets = Vec::new();
    for (n, text) in gcode::readable(&text).lines().enumerate() {
        let mut words = text.split(';').next().unwrap_or_default().split_whitespace();
        let Some(target) = words.next() else { continue };
        let place = |error| CliError::Input(format!("{}:{}: {error}", from.display(), n + 1));
        sets.extend(line(target, words).map_err(place)?);
    }
    if sets.is_empty() {
        return Err(CliError::file(
            from,
            "sets nothing: its lines are as `G54 X0 Z-112.4` or `T3 X-12.4 D0.8`",
        ));
    }
    Ok(sets)
}

/// What a line sets.
pub(crate) fn line<'a>(name: &str, words: impl Iterator<Item = &'a str>) -> Result<Vec<Set>, String> {
    let upper = name.to_ascii_uppercase();
    let number = upper.strip_prefix('T').and_then(|number| number.parse().ok()).filter(|number| *number > 0);
    let target = match (SYSTEMS.iter().position(|system| *system == upper), number) {
        (Some(system), _) => Target::System(system),
        (None, Some(number)) => Target::Tool(number),
        (None, None) => {
            return Err(format!("`{name}` is neither a coordinate system, G54 to G59.3, nor a tool, as T3"));
        }
    };
    words.map(|word| one(target, name, word)).collect()
}

fn one(target: Target, name: &str, word: &str) -> Result<Set, String> {
    let mut characters = word.chars();
    let letter = characters.next().unwrap_or(' ').to_ascii_uppercase();
    let known = match target {
        Target::System(_) => OF_SYSTEM.contains(&letter),
        Target::Tool(_) => Tool::default().words().iter().any(|(known, _)| *known == letter),
    };
    if !known {
        let has =
            if matches!(target, Target::System(_)) { "X Y Z A B C R" } else { "X Y Z A B C U V W D I J Q" };
        return Err(format!("{name} has no word `{word}`: its words are {has}, as in Z-112.4"));
    }
    match characters.as_str().parse::<f64>() {
        Ok(value) if value.abs() <= 1e6 => Ok(Set { target, letter, value }),
        _ => Err(format!(
            "`{word}` of {name} is not a word: write a number of at most 1000000 behind {letter}"
        )),
    }
}

/// Whether words can be set, or added with `add`, together.
///
/// # Errors
/// One stands twice, is less than [`LEAST`] and not 0, is an angle beyond a turn, or cannot be added to.
pub(crate) fn can_be(sets: &[Set], add: bool) -> Result<(), String> {
    for (n, Set { target, letter, value }) in sets.iter().enumerate() {
        let name = target.name();
        if sets[..n].iter().any(|set| (set.target, set.letter) == (*target, *letter)) {
            return Err(format!("{letter} of {name} stands twice: leave one of the two out"));
        }
        if add && *letter == 'Q' {
            return Err(format!(
                "Q of {name} is an orientation, 0 to 9, and cannot be added to: leave out --add"
            ));
        }
        if *value != 0.0 && value.abs() < LEAST {
            return Err(format!(
                "{letter}{value} of {name} is less than the files keep: write 0, or {LEAST} and more"
            ));
        }
        within_a_turn(*letter, *value, &name)?;
    }
    Ok(())
}

/// Angles lie within a turn.
pub(super) fn within_a_turn(letter: char, value: f64, name: &str) -> Result<(), String> {
    if "ABCRIJ".contains(letter) && value.abs() > 360.0 {
        return Err(format!("{letter}{value} of {name} is more than a turn: write -360 to 360 degrees"));
    }
    Ok(())
}
