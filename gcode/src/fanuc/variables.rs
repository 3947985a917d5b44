//! Variables of custom macro B. In: numbers. Out: values, or vacant; #5001 and its like in the units in
//! force.
//!
//! | variables | what |
//! |---|---|
//! | #0 | always vacant |
//! | #1 to #33 | local: a set for each G65 |
//! | #100 to #199, #500 to #999 | common |
//! | #4109 #4119 #4120 | F, S, T in force |
//! | #5001 #5002 | programmed point, X (a diameter) and Z; #5041 #5042 the same |
//! | #5021 #5022 | that point as a point of the machine |
//! | #5081 #5082 | offset of the tool in X (a diameter) and Z |
//! | #5221 #5222 ... #5321 #5322 | offsets of G54 to G59 |

use crate::canon::{X, Z};
use crate::problem::{Blame, Problem, short};
use crate::state::{State, offset_of_system};

/// Locals of one level; the first is #0.
pub(super) type Locals = [Option<f64>; 34];

const COMMON: [std::ops::RangeInclusive<u32>; 2] = [100..=199, 500..=999];

/// The variables of a program.
#[derive(Clone, Debug)]
pub(super) struct Variables {
    /// One set for each G65 that has not returned, and what it was called with; the last is in force.
    locals: Vec<(Locals, Locals)>,
    common: Vec<Option<f64>>,
}

impl Variables {
    /// All vacant but those common ones that `set` names.
    pub(super) fn new(set: &[(u32, f64)]) -> Variables {
        let mut variables = Variables { locals: vec![([None; 34], [None; 34])], common: vec![None; 1000] };
        for (index, value) in set.iter().filter(|(index, _)| is_shared(*index)) {
            if let Some(slot) = variables.common.get_mut(*index as usize) {
                *slot = Some(*value);
            }
        }
        variables
    }

    /// G65 begins: its arguments are the locals.
    pub(super) fn enter(&mut self, arguments: Locals) {
        self.locals.push((arguments, arguments));
    }

    /// What G65 called is run once more.
    pub(super) fn again(&mut self) {
        if let Some((locals, arguments)) = self.locals.last_mut() {
            *locals = *arguments;
        }
    }

    /// G65 ends.
    pub(super) fn leave(&mut self) {
        if self.locals.len() > 1 {
            self.locals.pop();
        }
    }

    /// Nothing that was called goes on.
    pub(super) fn only_main(&mut self) {
        self.locals.truncate(1);
    }

    /// A common variable, vacant or not; `None`: it is not one of them.
    pub(super) fn shared(&self, index: u32) -> Option<Option<f64>> {
        is_shared(index).then(|| self.common.get(index as usize).copied().flatten())
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// There is no variable of this number.
    pub(super) fn get(&self, index: u32, state: &State, blame: Blame) -> Result<Option<f64>, Box<Problem>> {
        match index {
            0 => Ok(None),
            1..=33 => {
                Ok(self.locals.last().and_then(|(locals, _)| locals.get(index as usize)).copied().flatten())
            }
            _ if is_shared(index) => Ok(self.common.get(index as usize).copied().flatten()),
            _ => system(index, state).map(Some).ok_or_else(|| unknown(index, blame)),
        }
    }

    /// Sets a variable.
    ///
    /// # Errors
    /// There is no variable of this number, or it cannot be set.
    pub(super) fn set(
        &mut self,
        index: u32,
        value: Option<f64>,
        state: &State,
        blame: Blame,
    ) -> Result<(), Box<Problem>> {
        let slot = match index {
            1..=33 => self.locals.last_mut().and_then(|(locals, _)| locals.get_mut(index as usize)),
            _ if is_shared(index) => self.common.get_mut(index as usize),
            _ => None,
        };
        if let Some(slot) = slot {
            *slot = value;
            return Ok(());
        }
        if index == 0 || system(index, state).is_some() {
            let message = format!("#{index} cannot be set");
            let help = "set #1 to #33, #100 to #199 or #500 to #999; offsets are set by G10 L2";
            return Err(Problem::error("bad-parameter", blame, message, help));
        }
        Err(unknown(index, blame))
    }
}

fn is_shared(index: u32) -> bool {
    COMMON.iter().any(|range| range.contains(&index))
}

/// What the control tells about itself.
fn system(index: u32, state: &State) -> Option<f64> {
    // X, Z of a lathe, X a diameter; X Y Z A B C of a mill.
    let lathe = state.modes.diameter;
    let lengths = |place: &crate::Pose, axis: u32| match axis {
        1..=6 if !lathe => place.get(axis as usize - 1).copied(),
        _ if !lathe => None,
        1 => Some(2.0 * place[X]),
        2 => Some(place[Z]),
        _ => None,
    };
    if matches!(index, 5001..=5006 | 5021..=5026 | 5041..=5046) {
        state.told_place.set(true);
    }
    match index {
        4109 => Some(state.modes.feed),
        4119 => Some(state.spindle.speed),
        4120 => Some(f64::from(state.tools.number)),
        5001..=5006 => lengths(&state.axes.position, index - 5000),
        5021..=5026 => lengths(&state.axes.machine_point(), index - 5020),
        5041..=5046 => lengths(&state.axes.position, index - 5040),
        5081..=5086 => lengths(&state.axes.tool_offset(), index - 5080),
        5221..=5326 => {
            let (system, axis) = ((index - 5221) / 20 + 1, (index - 5221) % 20 + 1);
            lengths(&state.lengths_at(offset_of_system(system as u8)), axis)
        }
        _ => None,
    }
}

fn unknown(index: u32, blame: Blame) -> Box<Problem> {
    let (code, message) = match index {
        1000.. => ("not-available", format!("the system variable #{index} is not available")),
        _ => ("bad-parameter", format!("there is no variable #{}", short(f64::from(index)))),
    };
    let help = "variables are #1 to #33, #100 to #199, #500 to #999, and of the system #3000, #3006, #4109, #4119, \
                #4120, #5001 to #5082 (X and Z), #5221 to #5322";
    Problem::error(code, blame, message, help)
}
