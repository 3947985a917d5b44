//! Lines that begin with `[`. They tell Denford's simulators of FANUC controls, on which schools write
//! programs, what there is: `[BILLET X50 Z80` on a lathe, `[BILLET X100 Y80 Z30` on a mill, `[TOOLDEF T1
//! D6`, `[EDGEMOVE`.
//!
//! In: such a line. Out: of a billet the comment that says the same of the part, before the first block with
//! a coordinate, because G20 may stand behind it. A bar lies with its face at Z0 there, a block with its
//! upper corner at zero. Whatever else there is does nothing.

use super::line::Line;
use crate::canon::{Call, Place};
use crate::execute::{Done, Output};
use crate::problem::{Blame, Problem, short};
use crate::text::{Cursor, number};

/// What a line says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SimulatorLine {
    /// The stock: X, Y, Z as written.
    Billet([Option<f64>; 3]),
    /// It lies elsewhere than at zero.
    Moved,
    /// Anything else.
    Other,
}

/// Reads the line; the cursor is at `[`.
pub(super) fn line(cursor: &mut Cursor) -> SimulatorLine {
    cursor.skip();
    let said = match cursor.take_name(&[("billet", true), ("edgemove", false)]) {
        Some(true) => SimulatorLine::Billet(sizes(cursor)),
        Some(false) => SimulatorLine::Moved,
        None => SimulatorLine::Other,
    };
    cursor.take_rest();
    said
}

fn sizes(cursor: &mut Cursor) -> [Option<f64>; 3] {
    let mut sizes = [None; 3];
    while let Some(letter @ b'x'..=b'z') = cursor.peek() {
        cursor.skip();
        let size = number(cursor).ok().filter(|size| *size > 0.0);
        sizes[usize::from(letter - b'x')] = size;
    }
    sizes
}

/// What the simulator was told so far.
#[derive(Default)]
pub(super) struct Simulator {
    billet: Option<(Place, [Option<f64>; 3])>,
    /// Somebody was told that such lines do nothing.
    told: bool,
    moved: bool,
}

impl Simulator {
    /// Takes a line.
    pub(super) fn take(&mut self, said: SimulatorLine, line: &Line, out: &mut Output) -> Done {
        match said {
            SimulatorLine::Billet(sizes) if !self.moved => {
                self.billet = Some((line.block.place(), sizes));
                return Ok(());
            }
            SimulatorLine::Moved => (self.billet, self.moved) = (None, true),
            SimulatorLine::Billet(_) | SimulatorLine::Other => {}
        }
        if !std::mem::replace(&mut self.told, true) {
            let message = "lines with [ are for a simulator: the machine does nothing with this one";
            let help = "put the offsets of tools in the tool table, and say what the part is in (part, ...)";
            out.warn(Problem::warning("simulator-line", Blame::Block, message, help));
        }
        Ok(())
    }

    /// Tells what the stock is before the first block with a coordinate, in the units in force there.
    pub(super) fn stock(&mut self, line: &Line, out: &mut Output) -> Done {
        if self.billet.is_none() || !line.has_any("XYZUW") {
            return Ok(());
        }
        let Some((place, sizes)) = self.billet.take() else { return Ok(()) };
        let text = match (line.mill, sizes) {
            (false, [Some(x), None, Some(z)]) => format!("part, bar D{} L{}", short(x), short(z)),
            (true, [Some(x), Some(y), Some(z)]) => {
                format!("part, block X0 Y0 Z{} X{} Y{} Z0", short(-z), short(x), short(y))
            }
            _ => {
                let message = "this says no stock: a lathe has X and Z of it, a mill X, Y and Z";
                let help = "say it in a comment: (part, bar D50 L80), (part, block X0 Y0 Z-30 X100 Y80 Z0)";
                out.warn(Problem::warning("simulator-line", Blame::At(place), message, help));
                return Ok(());
            }
        };
        let zero = if line.mill { "a corner of its top at zero" } else { "its face at Z0" };
        let message = format!("this line for a simulator is taken for ({text}): stock with {zero}");
        let help = "write that comment in its place, with Z of another face, or C where the chuck begins";
        out.warn(Problem::warning("simulator-line", Blame::At(place), message, help));
        let here = std::mem::replace(&mut out.place, place);
        let done = out.call(Call::Comment(&text));
        out.place = here;
        done
    }
}
