//! The part that turns: what the passes of a thread leave of it, in its section through the axis at spindle
//! angle 0, and the whole of it. In: the true places of the slides, mm, and the true angle of the spindle,
//! degrees. Out: pictures, mm.
//!
//! The edge of a threading tool lies in the plane of X and Z, so the section at an angle is what the edge
//! leaves at its places there (M158), pass by pass.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z, y | mm | along the axis; radius of a screw, minus the radius of a nut: the tool comes from above |
//! | C | deg | true angle of the spindle, unwrapped |
//!
//! | file | holds |
//! |---|---|
//! | `outline.rs` | what the edge leaves |
//! | `thread.rs` | the passes of a thread, its pitch, its crest |
//! | `limits.rs` | the largest and the smallest thread that a gauge allows |
//! | `swept.rs` | what feeds leave outside and inside |
//! | `plain.rs` | threads of which crest and root alone are known |
//! | `profile.rs` | the part as a body of revolution |
//! | `whole.rs`, `section.rs`, `chips.rs` | the pictures |

mod chips;
mod limits;
mod outline;
mod plain;
mod profile;
mod section;
mod swept;
#[cfg(test)]
mod tests;
mod thread;
mod whole;

use protocol::{Axis, AxisState};
use rig::observe::Summary;
use rig::trace::Row;

use super::curves::Curves;
use crate::paint::Figure;
use crate::table::Table;
use swept::Swept;
use thread::Thread;

/// Places of one pass.
#[derive(Clone, Debug, Default)]
struct Cuts {
    /// Z and X of the tip each time the spindle goes through angle 0, and through 180°; X from the axis and
    /// signed.
    tips: [Vec<[f64; 2]>; 2],
    /// Z of the slide and X of the program where every axis is first on its helix, and where it is last.
    full: Option<[[f64; 2]; 2]>,
}

/// Where every pass was.
#[derive(Clone, Debug)]
pub(super) struct Part {
    passes: Vec<Cuts>,
    swept: Swept,
    /// Pass, angle and tip of the row before.
    before: Option<(usize, f64, [f64; 2])>,
}

impl Part {
    /// Nothing is cut yet.
    pub(super) fn new(summary: &Summary) -> Part {
        Part { passes: vec![Cuts::default(); summary.passes.len()], swept: Swept::default(), before: None }
    }

    /// Takes the next row, of the pass with this index if it is one of a pass.
    pub(super) fn add(&mut self, summary: &Summary, pass: Option<usize>, row: &Row) {
        self.swept.add(summary, pass.is_some(), row);
        let Some(index) = pass else { return };
        let [Some(x), Some(z)] = [Axis::X, Axis::Z].map(|axis| row.axis(axis)) else { return };
        let [x_origin, z_origin] = summary.passes[index].origin_mm.unwrap_or_default();
        let tip = [z.slide - z_origin, x.slide - x_origin];
        let cuts = &mut self.passes[index];
        if x.state == AxisState::Locked && z.state == AxisState::Locked {
            let here = [tip[0], x.programmed - x_origin];
            cuts.full = Some([cuts.full.map_or(here, |[first, _]| first), here]);
        }
        let now = row.spindle_true_deg / 180.0;
        let before = self.before.replace((index, now, tip)).filter(|(other, ..)| *other == index);
        let Some((_, then, from)) = before else { return };
        let half = then.min(now).floor() + 1.0;
        if half <= then.max(now) {
            let share = (half - then) / (now - then);
            let tips = &mut cuts.tips[half.rem_euclid(2.0) as usize];
            tips.push([0, 1].map(|i| from[i] + share * (tip[i] - from[i])));
        }
    }
}

/// The pictures of a thread; none where there is no thread along Z whose tool and crest are known.
pub(super) fn figures(summary: &Summary, curves: &Curves) -> Vec<Figure> {
    let Some(thread) = thread(summary, curves) else { return Vec::new() };
    vec![section::figure(summary, &thread), chips::figure(curves, &thread, &chips::chips(&thread))]
}

/// The table of chips, likewise.
pub(super) fn table(summary: &Summary, curves: &Curves) -> Option<Table> {
    Some(chips::table(curves, &chips::chips(&thread(summary, curves)?)))
}

/// The whole of a part that turns, as far as anything is known of it.
pub(super) fn whole(summary: &Summary, curves: &Curves) -> Option<Figure> {
    let turns = !summary.limits.contains_key(&Axis::Y);
    turns.then(|| whole::figure(summary, &curves.part, curves.shown_index)).flatten()
}

fn thread(summary: &Summary, curves: &Curves) -> Option<Thread> {
    Thread::of(summary, &curves.part, curves.shown_index, 0)
}
