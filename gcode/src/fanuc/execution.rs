//! A block that is being executed, and the equivalent block of RS274/NGC that is executed in its place.

use super::line::Line;
use super::modal::{Modal, SingleWords};
use crate::block::Block;
use crate::canon::{Place, Pose, X, Y, Z};
use crate::codes::{G, M, group};
use crate::execute::Done;
use crate::execute::{self, Output};
use crate::options::DecimalPoint;
use crate::problem::{Blame, Problem, Span, short};
use crate::state::State;
use crate::text::degrees;

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
        let inclined = self.line.has('A') && self.line.block.g(group::ONCE).is_none();
        for (letters, letter, value) in [(['X', 'U'], 'X', 2.0 * end[X]), (['Z', 'W'], 'Z', end[Z])] {
            if let Some(named) = letters.into_iter().find(|letter| self.line.has(*letter)) {
                let span = self.span_of(Blame::Word(named));
                self.equivalent.add(letter, value, span)?;
            } else if inclined {
                self.equivalent.add(letter, value, self.span_of(Blame::Word('A')))?;
            }
        }
        Ok(())
    }

    /// A straight move with F, X Y Z of a mill, X Z U W of a lathe.
    pub(super) fn plain(&mut self, code: G) -> Done {
        if code != self.modal.motion {
            self.modal.single = SingleWords::default();
        }
        self.modal.motion = code;
        let from = self.state.axes.position;
        let end = match self.line.mill {
            true => on_mill(self.line, from, self.state.modes.incremental),
            false => target(self.line, from)?,
        };
        execute::straight_move(code, end, &self.line.block, self.state, self.out)
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
    match line.plain('A').filter(|_| line.block.g(group::ONCE).is_none()) {
        Some(angle) => inclined(angle, line, from, end),
        None => Ok(end),
    }
}

/// The end point of the words X Y Z of a mill.
pub(super) fn on_mill(line: &Line, from: Pose, incremental: bool) -> Pose {
    let mut end = from;
    for (axis, letter) in [(X, 'X'), (Y, 'Y'), (Z, 'Z')] {
        let Some(value) = line.length(letter) else { continue };
        end[axis] = if incremental { end[axis] + value } else { value };
    }
    end
}

/// The end of a line at an angle (A, from Z+ towards X+) of which one coordinate is given.
fn inclined(angle: f64, line: &Line, from: Pose, mut end: Pose) -> Result<Pose, Box<Problem>> {
    let bad = |code, message: String, help: &str| Err(Problem::error(code, Blame::Word('A'), message, help));
    let angle = match (line.is_bare('A') && angle != 0.0, line.decimal_point) {
        (true, Some(DecimalPoint::Conventional)) => angle / 1000.0,
        (true, None | Some(DecimalPoint::Refuse)) => {
            let message =
                format!("A{angle} has no decimal point: it is {angle} degrees or {} of them", angle / 1000.0);
            return bad("no-decimal-point", message, &format!("write A{angle}. for {angle} degrees"));
        }
        _ => angle,
    };
    let (x, z) = (line.has_any("XU"), line.has_any("ZW"));
    if x == z {
        let message = "A needs one coordinate of the end beside it, X or Z, and computes the other";
        let help = "leave A out, or one of X and Z; where two lines at angles meet must be computed by hand";
        return bad("missing-word", message.into(), help);
    }
    let slope = degrees::tangent(angle);
    let way = if z { (end[Z] - from[Z]) * slope } else { (end[X] - from[X]) / slope };
    if !way.is_finite() || way.abs() > 1e6 {
        let message = format!("a line at {} degrees never reaches this coordinate", short(angle));
        return bad("bad-value", message, "A counts from Z+ towards X+: 0 and 180 along Z, 90 along X");
    }
    let axis = if z { X } else { Z };
    end[axis] += way;
    Ok(end)
}
