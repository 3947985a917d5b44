//! What stays in force from block to block, beyond the state that both dialects share.

use std::collections::BTreeMap;

use super::codes::{DRILLING, HOLES};
use super::drilling::Drill;
use super::line::Line;
use crate::canon::{Place, Pose};
use crate::codes::{G, group};

/// What stays in force from block to block.
#[derive(Clone, Debug)]
pub(super) struct Modal {
    /// The code of group 01 in force.
    pub(super) motion: G,
    /// G50 S: highest speed of the spindle at G96, 1/min.
    pub(super) highest: Option<f64>,
    /// The last S of G96.
    pub(super) surface: Option<f64>,
    /// The last F of a thread.
    pub(super) lead: Option<f64>,
    /// G50 has set coordinates: G52 would lose them.
    pub(super) preset: bool,
    /// G81 to G85, until G80 or a code of group 01.
    pub(super) drill: Option<Drill>,
    /// M29: taps are rigid, until G80 or a code of group 01.
    pub(super) rigid: bool,
    /// On a mill: the cycle for holes in force.
    pub(super) held: Option<Held>,
    /// On a mill: H, D, G54.1.
    pub(super) offsets: Offsets,
    /// On a mill, while G68 is on: the offset of the coordinate system that it turns.
    pub(super) straight: Option<Pose>,
    /// Words of G90, G92 and G94.
    pub(super) single: SingleWords,
    /// First lines of the cycles.
    pub(super) first: FirstLines,
    /// A contour is read for its shape: tools and compensation wait for G70.
    pub(super) shape_only: bool,
    /// A move whose end is a corner that is cut off or rounded: it waits for the next move.
    pub(super) pending: Option<Pending>,
}

/// What the first of two lines said, until it says something else.
#[derive(Clone, Debug, Default)]
pub(super) struct FirstLines {
    /// G71, G72: depth of cut (U, W) and retract (R).
    pub(super) rough: [Option<(f64, f64)>; 2],
    /// One that was refused: what it belongs to is not cut, and was told.
    pub(super) refused: Option<G>,
    /// G73: U, W, R.
    pub(super) pattern: Option<(f64, f64, u32)>,
    /// G74 and G75: R.
    pub(super) retract: Option<f64>,
    /// G76.
    pub(super) thread: Option<ThreadFirst>,
}

impl Default for Modal {
    fn default() -> Modal {
        Modal {
            motion: G(0),
            highest: None,
            surface: None,
            lead: None,
            preset: false,
            drill: None,
            rigid: false,
            held: None,
            offsets: Offsets::default(),
            straight: None,
            single: SingleWords::default(),
            first: FirstLines::default(),
            shape_only: false,
            pending: None,
        }
    }
}

impl Modal {
    /// What moves the words of a block that has no code for them: the cycle for holes in force, unless the
    /// block ends it, or the code of group 01.
    pub(super) fn acting(&mut self, line: &Line) -> G {
        let home = matches!(line.block.g(group::ONCE), Some(G(280 | 300 | 530)));
        if line.mill {
            if home || line.block.g(HOLES) == Some(G(800)) || line.block.g(group::MOTION).is_some() {
                (self.held, self.rigid) = (None, false);
            }
            return self.in_force(true);
        }
        if home || line.block.g(DRILLING) == Some(G(800)) || line.block.g(group::MOTION).is_some() {
            (self.drill, self.rigid) = (None, false);
        }
        self.in_force(false)
    }

    /// The cycle for holes in force, or the code of group 01.
    pub(super) fn in_force(&self, mill: bool) -> G {
        let cycle = if mill { self.held.map(|held| held.code) } else { self.drill.map(|drill| drill.code) };
        cycle.unwrap_or(self.motion)
    }

    /// What a program begins with behind another one: offsets stay.
    pub(super) fn anew(&mut self) -> Modal {
        let additional = std::mem::take(&mut self.offsets.additional);
        Modal { offsets: Offsets { additional, ..Offsets::default() }, ..Modal::default() }
    }

    /// The units change: lengths times a factor. The surface speed is forgotten, it has other units than
    /// lengths, and so is a cycle for holes.
    pub(super) fn convert(&mut self, factor: f64) {
        self.lead = self.lead.map(|lead| lead * factor);
        (self.surface, self.drill, self.held) = (None, None, None);
        self.straight = self.straight.map(|mut offset| {
            offset.iter_mut().take(3).for_each(|length| *length *= factor);
            offset
        });
        self.single.convert(factor);
        let first = &mut self.first;
        for rough in &mut first.rough {
            *rough = rough.map(|(depth, retract)| (depth * factor, retract * factor));
        }
        first.pattern = first.pattern.map(|(x, z, passes)| (x * factor, z * factor, passes));
        first.retract = first.retract.map(|retract| retract * factor);
        if let Some(thread) = &mut first.thread {
            thread.convert(factor);
        }
    }
}

/// Words of G90, G92 and G94 in force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SingleWords {
    /// X of the far corner, a radius.
    pub(super) x: Option<f64>,
    pub(super) z: Option<f64>,
    pub(super) taper: f64,
}

impl SingleWords {
    /// The units change: lengths times a factor.
    fn convert(&mut self, factor: f64) {
        self.x = self.x.map(|x| x * factor);
        self.z = self.z.map(|z| z * factor);
        self.taper *= factor;
    }
}

/// The first line of G76.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ThreadFirst {
    /// m: finishing passes.
    pub(super) finishing: u32,
    /// r: chamfer, tenths of the lead.
    pub(super) chamfer: f64,
    /// a: angle of the tool, degrees.
    pub(super) angle: f64,
    /// Q.
    pub(super) least: f64,
    /// R.
    pub(super) finish: f64,
}

impl ThreadFirst {
    /// The units change: lengths times a factor.
    fn convert(&mut self, factor: f64) {
        self.least *= factor;
        self.finish *= factor;
    }
}

/// What becomes of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// c of a chamfer, r of a rounding, > 0.
    pub(super) size: f64,
    pub(super) round: bool,
    /// C R I K without a comma: the direction along the other axis that the next move must take.
    pub(super) next: Option<(usize, f64)>,
}

/// A move that waits for the next one.
#[derive(Clone, Debug)]
pub(super) struct Pending {
    /// Its programmed end.
    pub(super) end: Pose,
    pub(super) cut: Cut,
    pub(super) place: Place,
}

/// The cycle for holes of a mill that is in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    pub(super) code: G,
    /// Bottom and R (as written), Q, P in s; program units.
    pub(super) bottom: Option<f64>,
    pub(super) r: Option<f64>,
    pub(super) peck: Option<f64>,
    pub(super) dwell_s: Option<f64>,
    /// Bottom and R were written under G91.
    pub(super) incremental: bool,
}

/// Offsets of a mill.
#[derive(Clone, Debug, Default)]
pub(super) struct Offsets {
    /// H, and the sign that G43 and G44 give it.
    pub(super) h: Option<i32>,
    pub(super) sign: Option<f64>,
    /// D.
    pub(super) d: Option<i32>,
    /// G54.1: offsets in machine units.
    pub(super) additional: BTreeMap<u8, Pose>,
}
