//! What outlives a program: parameters as a parameter file keeps them, and what has become of the tools.

use super::reader::Reader;
use crate::files::{ParameterFile, ToolTable};
use crate::options::Options;
use crate::state::State;

/// Common variables of FANUC that outlast a run, unless they are vacant.
const KEPT: std::ops::RangeInclusive<u32> = 500..=999;

/// What a program has left, in machine units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outlasting {
    /// Parameters: those that it was given, and those that every parameter file has.
    pub parameters: ParameterFile,
    /// Those of them that are not what they were at the start.
    pub changed: Vec<(u32, f64)>,
    /// Words of tools that are not what they were: number of the tool, letter, value.
    pub tools: Vec<(i32, char, f64)>,
}

/// What was there at the start.
pub(super) struct Start {
    given: ParameterFile,
    parameters: ParameterFile,
    tools: ToolTable,
}

impl Start {
    pub(super) fn new(options: &Options, reader: &Reader, state: &State) -> Start {
        let mut given = ParameterFile { values: options.parameters.clone() };
        given.values.sort_by_key(|(number, _)| *number);
        let parameters = parameters(&given, reader, state);
        Start { given, parameters, tools: options.tools.clone() }
    }

    /// What is there now.
    pub(super) fn outlasting(&self, reader: &Reader, state: &State) -> Outlasting {
        let parameters = parameters(&self.given, reader, state);
        let before = |number: u32| {
            let same = |(other, _): &&(u32, f64)| *other == number;
            self.parameters.values.iter().find(same).map(|(_, value)| *value)
        };
        let is_changed = |(number, value): &&(u32, f64)| before(*number) != Some(*value);
        let changed = parameters.values.iter().filter(is_changed).copied().collect();
        Outlasting { parameters, changed, tools: state.tools.table.changes_since(&self.tools) }
    }
}

fn parameters(given: &ParameterFile, reader: &Reader, state: &State) -> ParameterFile {
    let value = |number| reader.shared(number).unwrap_or_else(|| Some(state.parameter(number)));
    let mut file = given.clone();
    file.values.retain(|(number, _)| value(*number).is_some());
    let shared = KEPT.filter(|number| reader.shared(*number).is_some());
    file.values.extend(shared.filter_map(|number| Some((number, value(number)?))));
    file.updated(|number| value(number).unwrap_or(0.0))
}
