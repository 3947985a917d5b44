//! Holes that a lathe drills on its axis before a thread in them is judged. In: feeds in the coordinates of
//! the part, mm, and how wide the drill is. Out: a warning where the gauge will not know the crest of the
//! thread.

use gauge::Nominal;
use gcode::problem::Blame;
use gcode::{Place, Problem};

use crate::stock::along_the_axis;
use crate::thread::Point;

/// A hole of unknown width.
#[derive(Clone, Copy, Debug)]
struct Unknown {
    place: Place,
    tool: Option<u32>,
    /// Least radius of what was cut along the axis afterwards, mm.
    bored_mm: f64,
}

/// The holes of a program.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Drilled(Option<Unknown>);

impl Drilled {
    /// Takes a feed of a tool; `drill_mm` is its radius, 0 if nobody said it.
    pub(super) fn goes(&mut self, place: Place, [from, to]: [Point; 2], tool: Option<u32>, drill_mm: f64) {
        if (to.z - from.z).abs() <= (to.x - from.x).abs() {
            return;
        }
        match &mut self.0 {
            _ if along_the_axis(from, to) && drill_mm > 0.0 => {}
            Some(unknown) if !along_the_axis(from, to) => {
                unknown.bored_mm = unknown.bored_mm.min(from.x.abs().max(to.x.abs()));
            }
            None if along_the_axis(from, to) => {
                self.0 = Some(Unknown { place, tool, bored_mm: f64::INFINITY });
            }
            _ => {}
        }
    }

    /// A nut whose crest is that hole, unless it was bored afterwards.
    pub(super) fn crest_unknown(&self, nominal: &Nominal) -> Option<(Place, Box<Problem>)> {
        let Unknown { place, tool, bored_mm } = self.0?;
        let judged = nominal.side == gauge::Side::Internal
            && nominal.taper == 0.0
            && nominal.crest_mm.iter().any(Option::is_some);
        let [_, largest] = nominal.pitch_diameter_mm;
        if !judged || bored_mm < 0.5 * largest {
            return None;
        }
        let which = tool.map_or("the tool that drills here".into(), |number| format!("tool {number}"));
        let message = format!(
            "nobody said how wide {which} is: the minor diameter of {}, which this hole is, will not be judged",
            nominal.name
        );
        let call = if tool.is_none() { "call for it with T and M6, and " } else { "" };
        let help = format!(
            "{call}give D in the tool table (--tools FILE), or width_mm in [tools] of the machine file"
        );
        Some((place, Problem::warning("crest-unknown", Blame::Line(place.line), message, &help)))
    }
}
