//! A program that is given by hand, text by text. In: a text, and where the axes stand. Out: what is in
//! force, for whoever types the next one.

use super::{Findings, Program, Stage, Stay, files};
use crate::canon::{FeedMode, Plane, Pose, Units};
use crate::options::Options;
use crate::problem::short;
use crate::program::reader::Reader;
use crate::text::Source;

impl Program {
    /// Goes on with another text, in all that is in force. The tool stands at a programmed point, program
    /// units and degrees: it may have been moved meanwhile. `options` are those the program began with.
    ///
    /// What labels, subroutines and common variables of FANUC the text before had is forgotten.
    pub fn goes_on(&mut self, name: &str, text: impl Into<Vec<u8>>, options: &Options, at: Pose) {
        let source = Source::from_text(name, text.into(), options.limits.line_length);
        self.reader = Reader::new(files(source, None, options), options);
        self.state.progress.ended = false;
        self.state.told_place.set(false);
        self.state.axes.position = at;
        self.state.axes.moved();
        if self.stage == Stage::Ended {
            self.stage = Stage::Running;
        }
        self.stay = Stay::default();
        // Its lines are counted from 1 again: what was said of others says nothing of them.
        self.findings = Findings::default();
    }

    /// Whether it has read, since then, a parameter that tells where the axes are: #5420, #<_x> and the like.
    pub fn has_read_place(&self) -> bool {
        self.state.told_place.get()
    }

    /// What is in force, as words of RS274/NGC: motion, plane, units, positions, feed, diameters, coordinate
    /// system, tool, F and S.
    pub fn in_force(&self) -> String {
        let (state, modes) = (&self.state, &self.state.modes);
        let motion = modes.motion.map_or_else(|| "G80".to_owned(), |motion| motion.to_string());
        let system = match state.axes.system() {
            system @ 1..=6 => format!("G{}", 53 + system),
            system => format!("G59.{}", system - 6),
        };
        let feed = match modes.feed_mode {
            FeedMode::InverseTime => "G93",
            FeedMode::PerMinute => "G94",
            FeedMode::PerRevolution => "G95",
        };
        let plane = match modes.plane {
            Plane::Xy => "G17",
            Plane::Xz => "G18",
            Plane::Yz => "G19",
        };
        let words = [
            motion.as_str(),
            plane,
            if state.units.program() == Units::Inch { "G20" } else { "G21" },
            if modes.incremental { "G91" } else { "G90" },
            feed,
            if modes.diameter { "G7" } else { "G8" },
            system.as_str(),
        ];
        let (tool, spindle) = (state.tools.number, &state.spindle);
        format!("{} T{tool} F{} S{}", words.join(" "), short(modes.feed), short(spindle.speed))
    }

    /// Units of the words of a block: G20 or G21.
    pub fn units(&self) -> Units {
        self.state.units.program()
    }

    /// Number of the coordinate system in force, 1 (G54) to 9 (G59.3).
    pub fn system(&self) -> u8 {
        self.state.axes.system()
    }
}
