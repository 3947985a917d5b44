//! The part while a program is translated: what a comment says of it, and what moves do to it. In: comments,
//! moves and passes of machine positions. Out: what is left of the stock, and warnings.

use std::collections::BTreeMap;

use gcode::problem::Blame;
use gcode::{Place, Problem};
use machine::{Kinematics, Part};
use protocol::{Arc, PerAxis, Position, ThreadPass};

use super::Translator;
use crate::reach::Done;
use crate::stock::{Goes, Stock, drill_mm, point};
use crate::thread::Point;

/// An arc is looked at in so many chords.
const CHORDS: u32 = 32;

impl Translator {
    /// The part that a file beside the program describes.
    pub(crate) fn has_part(&mut self, part: Part) {
        self.stock = Some(Stock::new(&part));
        self.part = Some(part);
    }

    /// The part, if anybody said what it is.
    pub(crate) fn part(&self) -> Option<&Part> {
        self.part.as_ref()
    }

    /// A comment may say what the part of a lathe is.
    pub(super) fn take_part(&mut self, text: &str) -> Done {
        if self.machine.general.kinematics != Kinematics::Lathe {
            return Ok(());
        }
        let wrong = |message: String, help: &str| Problem::error("bad-part", Blame::Block, message, help);
        let part = Part::from_comment(text, self.modal.frame.unit);
        let Some(part) = part.map_err(|error| wrong(error.to_string(), error.help()))? else { return Ok(()) };
        if self.part.is_some() {
            let help = "leave one of them out: a comment, or [part] in the file beside the program";
            return Err(wrong("what the part is has been said before".into(), help));
        }
        self.has_part(part);
        Ok(())
    }

    /// Where X 0 and Z 0 of the part lie on the machine, mm.
    pub(super) fn origin(&self) -> Point {
        let at = self.modal.frame.machine(&[0.0; 6]);
        Point { x: at[gcode::canon::X], z: at[gcode::canon::Z] }
    }

    /// Where zero of the program lies where a tool first cuts.
    pub(crate) fn origins_mm(&self) -> &BTreeMap<u32, [f64; 2]> {
        &self.origins_mm
    }

    /// The tool in the holder cuts, and zero of the program lies there.
    fn cuts_at(&mut self, origin: Point) {
        let tool = self.auxiliary.tool().unwrap_or(0);
        self.origins_mm.entry(tool).or_insert([origin.x, origin.z]);
    }

    /// A straight move from where the axes rest.
    pub(super) fn part_sees(&mut self, place: Place, to: &PerAxis<Position>, rapid: bool) {
        if !rapid {
            self.cuts_at(self.origin());
        }
        if self.stock.is_some() {
            self.part_sees_way(place, &[self.points.axes_at_rest(), *to], rapid);
        }
    }

    /// An arc from where the axes rest.
    pub(super) fn part_sees_arc(&mut self, place: Place, arc: &Arc) {
        self.cuts_at(self.origin());
        let rest = self.points.axes_at_rest();
        if self.stock.is_some()
            && let Ok(path) = arc.path(&rest)
        {
            let way = (0..=CHORDS).map(|chord| {
                let [gone, ..] = path.at(path.length() * f64::from(chord) / f64::from(CHORDS));
                std::array::from_fn(|axis| Position(rest[axis].0 + Position::from_mm(gone[axis]).0))
            });
            self.part_sees_way(place, &way.collect::<Vec<_>>(), false);
        }
    }

    fn part_sees_way(&mut self, place: Place, way: &[PerAxis<Position>], rapid: bool) {
        let (origin, drill) = (self.origin(), drill_mm(&self.machine, self.auxiliary.tool()));
        let goes = match (rapid, self.spindle.turns()) {
            (true, _) => Goes::Rapid,
            (false, true) => Goes::Cuts,
            (false, false) => Goes::CutsAtRest,
        };
        let Some(stock) = &mut self.stock else { return };
        for ends in way.windows(2) {
            let line = [&ends[0], &ends[1]].map(|axes| point(axes, origin));
            if let Some(problem) = stock.goes(line, goes, drill) {
                self.output.report(place, Problem { blame: Blame::Line(place.line), ..*problem });
            }
        }
    }

    /// A pass of a thread, programmed where the part lay at `origin`.
    pub(super) fn part_sees_pass(&mut self, place: Place, pass: &ThreadPass, origin: Point) {
        self.threads.lies_at(pass.pass, origin);
        self.cuts_at(origin);
        self.gauge_sees_pass(place, pass, origin);
        if let Some(problem) = self.stock.as_mut().and_then(|stock| stock.pass(pass, origin)) {
            self.output.report(place, Problem { blame: Blame::Line(place.line), ..*problem });
        }
    }
}
