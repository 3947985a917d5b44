//! How long a fault may take. In: a length of time or of the angle of the spindle, as a test can compare it.
//! Out: the words of `docs/faults.md`.
//!
//! It is counted from the cycle whose measurement, message or absence of one shows the fault. The answer to
//! that very cycle is 1 cycle, the first tick that can see it 1 tick. A message that does not come is missing
//! from the end of the cycle in which it was due.

use core::fmt::{self, Display, Formatter};

/// A length of time, or of the angle of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Span {
    /// Control cycles.
    Cycles(u64),
    /// Ticks of the interpolator.
    Ticks(u64),
    /// Seconds on the machine.
    Seconds(f64),
    /// Turns of the spindle.
    Turns(f64),
}

/// How long it takes at most until the machine reacts to a fault that is there to be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Within {
    /// One after the other, in one of the cases of the row; empty words if there is only one.
    Most {
        /// What is added up.
        sum: &'static [Span],
        /// In which case.
        when: &'static str,
    },
    /// Before something acts: nothing has moved.
    Before(&'static str),
}

impl Display for Span {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let many = |one: bool| if one { "" } else { "s" };
        match *self {
            Span::Cycles(n) => write!(f, "{n} cycle{}", many(n == 1)),
            Span::Ticks(n) => write!(f, "{n} tick{}", many(n == 1)),
            Span::Seconds(s) => write!(f, "{} s", rounded(s)),
            Span::Turns(turns) if turns < 0.1 => write!(f, "{} % of a turn", rounded(100.0 * turns)),
            Span::Turns(turns) => write!(f, "{} turn{}", rounded(turns), many(turns == 1.0)),
        }
    }
}

/// To a hundredth, without what says nothing.
fn rounded(number: f64) -> String {
    format!("{number:.2}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl Display for Within {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Within::Before(what) => write!(f, "before {what}"),
            Within::Most { sum, when } => {
                for (i, span) in sum.iter().enumerate() {
                    write!(f, "{}{span}", if i > 0 { " and " } else { "" })?;
                }
                let space = if when.is_empty() { "" } else { " " };
                write!(f, "{space}{when}")
            }
        }
    }
}
