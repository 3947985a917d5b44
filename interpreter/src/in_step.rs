//! Outputs that change with the motion that follows. In: items in the order of the program. Out: warnings of
//! those that no motion follows, or another value of the same output before any.

use gcode::problem::Blame;
use gcode::{Place, Problem};
use protocol::{Code, Set};

/// What waits for a motion: where it stands, which output, whether it is an analog one.
#[derive(Clone, Debug, Default)]
pub(crate) struct InStep {
    waiting: Vec<(Place, u8, Set)>,
}

impl InStep {
    /// The next item of the program, and where it comes from.
    pub(crate) fn item(&mut self, place: Place, code: &Code) -> Vec<(Place, Problem)> {
        match *code {
            Code::Line { .. } | Code::Arc { .. } | Code::Curve { .. } | Code::Work(_) | Code::Pass(_) => {
                self.waiting.clear();
                Vec::new()
            }
            Code::Output { number, set, in_step } => {
                let same =
                    |other: &(Place, u8, Set)| other.1 == number && is_analog(other.2) == is_analog(set);
                let found = self.waiting.iter().position(same).map(|at| self.waiting.remove(at));
                if in_step {
                    self.waiting.push((place, number, set));
                }
                found.map(|(before, ..)| (before, replaced(before, number, set, place))).into_iter().collect()
            }
            Code::End => self
                .waiting
                .drain(..)
                .map(|(place, number, set)| (place, alone(place, number, set)))
                .collect(),
            _ => Vec::new(),
        }
    }
}

fn is_analog(set: Set) -> bool {
    matches!(set, Set::Analog(_))
}

/// The word that sets an output in step with motion.
fn word(number: u8, set: Set) -> String {
    match set {
        Set::Digital(true) => format!("M62 P{number}"),
        Set::Digital(false) => format!("M63 P{number}"),
        Set::Analog(_) => format!("M67 E{number}"),
    }
}

fn replaced(before: Place, number: u8, set: Set, by: Place) -> Problem {
    let what = if is_analog(set) { "M67" } else { "M62 or M63" };
    let message =
        format!("this {what} does nothing: line {} sets output {number} again before any motion", by.line);
    let help = "put a motion between the two, or leave this one out; M64, M65 and M68 set an output at once";
    *Problem::warning("no-effect", Blame::Line(before.line), message, help)
}

fn alone(place: Place, number: u8, set: Set) -> Problem {
    let message = format!("{} does nothing: no motion follows with which it could change", word(number, set));
    let help =
        "put it before the motion with which the output shall change; M64, M65 and M68 set one at once";
    *Problem::warning("no-effect", Blame::Line(place.line), message, help)
}
