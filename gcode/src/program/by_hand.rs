//! A program that is given by hand, text by text. In: a text, and where the axes stand. Out: what is in
//! force, for whoever types the next one.

use super::{Findings, Program, Stage, Stay, files};
use crate::canon::{FeedMode, Plane, Pose, Units};
use crate::codes::G;
use crate::options::Options;
use crate::problem::short;
use crate::program::reader::Reader;
use crate::text::Source;

impl Program {
    /// Goes on with another text, in all that is in force. The tool stands at a programmed point, program
    /// units and degrees: it may have been moved meanwhile. `options` are those the program began with.
    ///
    /// What labels and subroutines the text before had is forgotten.
    pub fn goes_on(&mut self, name: &str, text: impl Into<Vec<u8>>, options: &Options, at: Pose) {
        let source = Source::from_text(name, text.into(), options.limits.line_length);
        self.reader.goes_on(files(source, None, options), options);
        (self.state.progress.ended, self.state.progress.call_level) = (false, 0);
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

    /// What is in force, as words of the dialect: motion, plane, units, positions, feed, diameters,
    /// coordinate system, tool, F and S. Lathes of FANUC have no code for positions and diameters.
    pub fn in_force(&self) -> String {
        let (state, modes) = (&self.state, &self.state.modes);
        let motion = self.reader.motion().or(modes.motion).unwrap_or(G(800));
        let system = match state.axes.system() {
            system @ 1..=6 => format!("G{}", 53 + system),
            system => format!("G59.{}", system - 6),
        };
        let [per_minute, per_revolution] = state.settings.feed_codes;
        let feed = match modes.feed_mode {
            FeedMode::InverseTime => G(930),
            FeedMode::PerMinute => per_minute,
            FeedMode::PerRevolution => per_revolution,
        };
        let plane = match modes.plane {
            Plane::Xy => G(170),
            Plane::Xz => G(180),
            Plane::Yz => G(190),
        };
        let units = if state.units.program() == Units::Inch { G(200) } else { G(210) };
        let positions = if modes.incremental { G(910) } else { G(900) };
        let across = if modes.diameter { G(70) } else { G(80) };
        let fanuc = matches!(self.reader, Reader::Fanuc(_));
        let lathe_of_fanuc = fanuc && !state.settings.is_mill;
        let codes = [
            Some(motion),
            Some(plane),
            Some(units),
            Some(positions).filter(|_| !lathe_of_fanuc),
            Some(feed),
            Some(across).filter(|_| !fanuc),
        ];
        let words: Vec<String> = codes.into_iter().flatten().map(|code| code.to_string()).collect();
        let words = self.reader.in_its_words(words.join(" "));
        let (tool, spindle) = (state.tools.number, &state.spindle);
        format!("{words} {system} T{tool} F{} S{}", short(modes.feed), short(spindle.speed))
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
