//! A block that is being executed, and the equivalent block of RS274/NGC that is executed in its place.

use super::line::Line;
use super::modal::Modal;
use crate::block::Block;
use crate::canon::{Place, Pose, X, Z};
use crate::codes::{G, M, group};
use crate::execute::Done;
use crate::execute::{self, Output};
use crate::problem::{Blame, Problem, Span};
use crate::state::State;

/// A block with all that it acts on.
pub(super) struct Execution<'a, 'b> {
    pub(super) line: &'a Line,
    pub(super) modal: &'a mut Modal,
    /// The block of RS274/NGC that is executed in place of the line.
    pub(super) equivalent: &'a mut Block,
    pub(super) state: &'a mut State,
    pub(super) out: &'a mut Output<'b>,
}

impl Execution<'_, '_> {
    /// Makes the equivalent block an empty one at the place of the line.
    pub(super) fn begin(&mut self) {
        self.begin_at(self.line.block.place());
    }

    fn begin_at(&mut self, place: Place) {
        self.equivalent.clear(place.file, place.line);
        (self.equivalent.n, self.equivalent.n_digits) = (place.n, place.n_digits);
    }

    /// Executes the equivalent block.
    ///
    /// # Errors
    /// As for any block.
    pub(super) fn execute(&mut self) -> Done {
        execute::execute(self.equivalent, self.state, self.out)
    }

    /// The bytes of the line that `blame` means.
    pub(super) fn span_of(&self, blame: Blame) -> Span {
        self.line.block.span(blame).unwrap_or_default()
    }

    /// Adds a G code of the line to the equivalent block, with its bytes.
    pub(super) fn add_g(&mut self, group: usize, code: G) -> Done {
        let span = self.span_of(Blame::G(code));
        self.equivalent.add_g(group, code, span)
    }

    /// Adds an M code of the line to the equivalent block, with its bytes.
    pub(super) fn add_m(&mut self, group: usize, code: M) -> Done {
        let span = self.span_of(Blame::M(code));
        self.equivalent.add_m(group, code, span)
    }

    /// Adds a word to the equivalent block, with the bytes of the same word of the line.
    pub(super) fn add(&mut self, letter: char, value: f64) -> Done {
        let span = self.span_of(Blame::Word(letter));
        self.equivalent.add(letter, value, span)
    }

    /// Adds X and Z of a point to the equivalent block, those axes alone that the line names.
    pub(super) fn add_point(&mut self, end: &Pose) -> Done {
        for (letters, letter, value) in [(['X', 'U'], 'X', 2.0 * end[X]), (['Z', 'W'], 'Z', end[Z])] {
            if let Some(named) = letters.into_iter().find(|letter| self.line.has(*letter)) {
                let span = self.span_of(Blame::Word(named));
                self.equivalent.add(letter, value, span)?;
            }
        }
        Ok(())
    }

    /// One move to a point (Z, X, a radius), for the block at `place`; `center` of an arc is seen from its
    /// start.
    pub(super) fn go(&mut self, code: G, end: [f64; 2], center: Option<[f64; 2]>, place: Place) -> Done {
        let nowhere = Span::default();
        self.begin_at(place);
        self.equivalent.add_g(group::MOTION, code, nowhere)?;
        self.equivalent.add('X', 2.0 * end[1], nowhere)?;
        self.equivalent.add('Z', end[0], nowhere)?;
        if let Some([k, i]) = center {
            self.equivalent.add('I', i, nowhere)?;
            self.equivalent.add('K', k, nowhere)?;
        }
        self.execute()
    }
}

/// The end point of the words X Z U W; `from` is where the move before ended.
///
/// # Errors
/// X and U, or Z and W, stand in one block.
pub(super) fn target(line: &Line, from: Pose) -> Result<Pose, Box<Problem>> {
    let mut end = from;
    for (absolute, incremental, axis, scale) in [('X', 'U', X, 0.5), ('Z', 'W', Z, 1.0)] {
        match (line.length(absolute), line.length(incremental)) {
            (Some(_), Some(_)) => {
                let message = format!("{absolute} and {incremental} both move the same axis");
                let help = "leave one of them out";
                return Err(Problem::error("repeated-word", Blame::Word(incremental), message, help));
            }
            (Some(value), None) => end[axis] = scale * value,
            (None, Some(value)) => end[axis] += scale * value,
            (None, None) => {}
        }
    }
    Ok(end)
}
