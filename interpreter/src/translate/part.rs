//! The part while a program is translated: what a comment says of it, and what moves do to it. In: comments,
//! moves and passes of machine positions. Out: what is left of the stock, and warnings.

use std::collections::BTreeMap;

use gcode::canon::Units;
use gcode::problem::Blame;
use gcode::{Call, Place, Problem};
use machine::{Kinematics, Part};
use protocol::{Arc, Axis, PerAxis, Position, ThreadPass};

use super::Translator;
use crate::block::Block;
use crate::reach::Done;
use crate::stock::{Goes, Stock, drill_mm, point};
use crate::thread::Point;
use crate::zeros::ZeroNote;

/// An arc is looked at in so many chords.
const CHORDS: u32 = 32;

impl Translator {
    /// The part that a file beside the program describes.
    pub(crate) fn has_part(&mut self, part: Part) {
        self.block = part.block().map(Block::new);
        self.stock = self.block.is_none().then(|| Stock::new(&part));
        self.part = Some(part);
    }

    /// The part, if anybody said what it is.
    pub(crate) fn part(&self) -> Option<&Part> {
        self.part.as_ref()
    }

    /// How the program writes X, for what it is told.
    pub(crate) fn writes_x(&mut self, as_diameter: bool) {
        self.modal.frame.x_is_diameter = as_diameter;
    }

    /// A comment may say what the part is.
    pub(super) fn take_part(&mut self, text: &str) -> Done {
        let kinematics = self.machine.general.kinematics;
        if kinematics == Kinematics::Positioner {
            return Ok(());
        }
        let wrong = |message: String, help: &str| Problem::error("bad-part", Blame::Block, message, help);
        let part = Part::from_comment(text, self.modal.frame.unit());
        let part = part.and_then(|part| part.map(|part| part.fits(kinematics)).transpose());
        let Some(part) = part.map_err(|error| wrong(error.to_string(), error.help()))? else { return Ok(()) };
        if self.part.is_some() {
            let help = "leave one of them out: a comment, or [part] in the file beside the program";
            return Err(wrong("what the part is has been said before".into(), help));
        }
        self.has_part(part);
        self.read_in_units("the part");
        Ok(())
    }

    /// A comment was read in the units in force.
    pub(super) fn read_in_units(&mut self, what: &'static str) {
        let read = (self.place(), what, self.modal.frame.units);
        self.read_in_units.push(read);
    }

    /// Other units before anything has moved: comments above them were hardly meant in those before.
    pub(super) fn units_are(&mut self, units: Units) {
        for (place, what, before) in std::mem::take(&mut self.read_in_units) {
            if before == units {
                continue;
            }
            let code = if units == Units::Inch { "G20" } else { "G21" };
            let message =
                format!("the numbers of {what} are read in {}: {code} comes behind them", before.name());
            let help = format!("write {code} in a block above this comment");
            self.output
                .report(place, *Problem::warning("comment-units", Blame::Line(place.line), message, help));
        }
    }

    /// Where X 0 and Z 0 of the part lie on the machine, mm.
    pub(super) fn origin(&self) -> Point {
        let at = self.modal.frame.machine(&[0.0; 6]);
        Point { x: at[gcode::canon::X], z: at[gcode::canon::Z] }
    }

    /// A call may move zero of the program.
    pub(super) fn zero_follows(&mut self, call: &Call<'_>) {
        match *call {
            Call::SetG5xOffset(system, _) => self.system = system,
            Call::SetG92Offset(_)
            | Call::UseToolLengthOffset(_)
            | Call::SetXyRotation(_)
            | Call::SelectTool(_)
            | Call::ChangeTool(_)
            | Call::ChangeToolNumber(_) => {}
            _ => return,
        }
        let Point { x, z } = self.origin();
        self.output.zero_is(Some([x, z]), self.system, self.auxiliary.tool().unwrap_or(0));
    }

    /// A job file has a zero of its own.
    pub(super) fn zero_is_of_job(&mut self) {
        self.output.zero_is(None, self.system, self.auxiliary.tool().unwrap_or(0));
    }

    /// Parameters of coordinate systems were set.
    pub(crate) fn systems_are(&mut self, set: Vec<(u32, f64)>) {
        self.output.systems_are(set);
    }

    /// Where zero of the program lies, from its beginning on.
    pub(crate) fn zeros(&self) -> &[ZeroNote] {
        self.output.zeros()
    }

    /// Where zero of the program lies where a tool first cuts.
    pub(crate) fn origins_mm(&self) -> &BTreeMap<u32, [f64; 2]> {
        &self.origins_mm
    }

    /// The tool in the holder cuts, and zero of the program lies there.
    fn cuts_at(&mut self, origin: Point) {
        let tool = self.auxiliary.tool().unwrap_or(0);
        if self.block.is_some() && !std::mem::replace(&mut self.block_lies, true) {
            let at = self.modal.frame.machine(&[0.0; 6]);
            self.part = self.part.take().map(|part| part.moved([at[gcode::canon::X], at[gcode::canon::Y]]));
        }
        self.origins_mm.entry(tool).or_insert([origin.x, origin.z]);
        self.output.cuts([origin.x, origin.z]);
    }

    /// A straight move from where the axes rest.
    pub(super) fn part_sees(&mut self, place: Place, to: &PerAxis<Position>, rapid: bool) {
        self.read_in_units.clear();
        if !rapid {
            self.cuts_at(self.origin());
            let origin = self.origin();
            let line = [&self.points.axes_at_rest(), to].map(|axes| point(axes, origin));
            let tool = self.auxiliary.tool();
            self.drilled.goes(place, line, tool, drill_mm(&self.machine, tool, &self.diameters_mm));
        }
        if self.part.is_some() {
            self.part_sees_way(place, &[self.points.axes_at_rest(), *to], rapid);
        }
    }

    /// An arc from where the axes rest.
    pub(super) fn part_sees_arc(&mut self, place: Place, arc: &Arc) {
        self.cuts_at(self.origin());
        let rest = self.points.axes_at_rest();
        if self.part.is_some()
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
        let (origin, drill) =
            (self.origin(), drill_mm(&self.machine, self.auxiliary.tool(), &self.diameters_mm));
        let goes = match (rapid, self.spindle.turns()) {
            (true, _) => Goes::Rapid,
            (false, true) => Goes::Cuts,
            (false, false) => Goes::CutsAtRest,
        };
        self.block_sees_way(place, way, goes);
        let Some(stock) = &mut self.stock else { return };
        for ends in way.windows(2) {
            let line = [&ends[0], &ends[1]].map(|axes| point(axes, origin));
            if let Some(problem) = stock.goes(line, goes, drill, &self.modal.frame) {
                self.output.report(place, Problem { blame: Blame::Line(place.line), ..*problem });
            }
        }
    }

    /// The same, of the block of a mill. Where it is turned, or its zero with G10 R, nobody knows what is
    /// left.
    fn block_sees_way(&mut self, place: Place, way: &[PerAxis<Position>], goes: Goes) {
        let Some(block) = &mut self.block else { return };
        if !block.is_known() {
            return;
        }
        let frame = &self.modal.frame;
        let turned = [Axis::A, Axis::B, Axis::C].map(|axis| way.iter().any(|at| at[axis.index()].0 != 0));
        if frame.rotation_deg != 0.0 || turned.contains(&true) {
            block.forget();
            let why = "the coordinates are turned here";
            return self.output.report(
                place,
                *unknown(
                    place,
                    why,
                    "what follows is not looked at: watch it in the report, or leave out the rotation",
                ),
            );
        }
        let number = self.auxiliary.tool();
        let width = number.and_then(|number| self.machine.tool(number)?.width_mm);
        let diameter = number.and_then(|number| self.diameters_mm.get(&number).copied()).or(width);
        let tip = |axes: &PerAxis<Position>| {
            let at = |axis: Axis| axes[axis.index()].mm();
            let [x, y, z, ..] = frame.programmed(&[at(Axis::X), at(Axis::Y), at(Axis::Z), 0.0, 0.0, 0.0]);
            [x, y, z].map(|given| given * frame.unit())
        };
        for ends in way.windows(2) {
            let line = [tip(&ends[0]), tip(&ends[1])];
            if let Some(problem) = block.goes(line, goes, diameter.map(|mm| 0.5 * mm), frame.units) {
                self.output.report(place, Problem { blame: Blame::Line(place.line), ..*problem });
            }
        }
        if !block.is_known() {
            let tool = number.map_or("the tool".into(), |number| format!("tool {number}"));
            let help = "give D in the tool table (--tools FILE), or width_mm in [tools] of the machine file";
            let why = format!("nobody said how wide {tool} is");
            self.output.report(place, *unknown(place, &why, help));
        }
    }

    /// A pass of a thread, programmed where the part lay at `origin`.
    pub(super) fn part_sees_pass(&mut self, place: Place, pass: &ThreadPass, origin: Point) {
        self.threads.lies_at(pass.pass, origin, self.auxiliary.tool());
        self.cuts_at(origin);
        self.gauge_sees_pass(place, pass, origin);
        self.insert_cuts(place);
        if let Some(problem) =
            self.stock.as_mut().and_then(|stock| stock.pass(pass, origin, &self.modal.frame))
        {
            self.output.report(place, Problem { blame: Blame::Line(place.line), ..*problem });
        }
    }
}

/// Nothing is warned of from here on, and why.
fn unknown(place: Place, why: &str, help: &str) -> Box<Problem> {
    let message =
        format!("{why}: from here on it is not known what is left of the part, and nothing warns of it");
    Problem::warning("stock-unknown", Blame::Line(place.line), message, help)
}
