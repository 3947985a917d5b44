//! Curves of G5 become arcs that touch where they meet: moves like any other.
//!
//! In: a curve in the plane in force. Out: arcs and lines that keep a fifth of `path.exact_mm` from it, so
//! that the chain has the rest of what the path mode allows to round the steps of their curvature.

use gcode::canon::{self, A, B, C, Nurbs};
use gcode::problem::Blame;
use gcode::{Place, Problem};

use super::Translator;
use crate::reach::Done;

/// What of `path.exact_mm` the arcs may leave the curve by.
const SHARE: f64 = 0.2;
/// Arcs with a larger radius are lines, mm.
const LARGEST_MM: f64 = 1e5;
/// Most moves of a curve.
const MOST_MOVES: usize = 1_000_000;

impl Translator {
    pub(super) fn spline(&mut self, place: Place, curve: &Nurbs) -> Done {
        let within = SHARE * self.machine.path.exact_mm / self.modal.frame.unit();
        let largest = LARGEST_MM / self.modal.frame.unit();
        let way = curve.follow(within, largest, MOST_MOVES).ok_or_else(|| {
            let message = format!("the curve would be more than {MOST_MOVES} arcs");
            Problem::error("bad-value", Blame::Block, message, "correct its points, or divide it")
        })?;
        let (first, second, along) = self.modal.plane.axes();
        let mut at = self.modal.frame.programmed(self.points.programmed());
        for follows in way {
            [at[first], at[second]] = follows.end;
            match follows.arc {
                None => self.straight(place, &at, false)?,
                Some((center, ccw)) => {
                    let turns = if ccw { 1 } else { -1 };
                    let rotary = [at[A], at[B], at[C]];
                    let arc = canon::Arc { end: follows.end, center, turns, along: at[along], rotary };
                    self.arc(place, &arc)?;
                }
            }
        }
        Ok(())
    }
}
