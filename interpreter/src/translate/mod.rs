//! Calls become items. In: canonical functions in the order of the program. Out: machine code, and what this
//! machine cannot do, by name.
//!
//! Whoever knows a part of it decides; here each call is taken there, and what comes of it is sent.

mod doubts;
mod drilled;
mod gauged;
mod hand;
mod insert;
mod jobs;
mod part;
mod splines;
mod taps;
mod threads;

use std::collections::BTreeMap;

use gcode::canon;
use gcode::files::ToolTable;
use gcode::problem::{Blame, short};
use gcode::{Call, Job, Place, Pose, Problem, Sink};
use machine::{Machine, Part};
use protocol::{Code, Feed, Item};

use crate::auxiliary::{self, Auxiliary, find_tool, may_change};
use crate::block::Block;
use crate::job::{JobNote, Jobs};
use crate::modal::Modal;
use crate::output::Output;
use crate::pass_note::PassNote;
use crate::points::Points;
use crate::reach::{Done, LONGEST_DWELL, refuse_absent};
use crate::spindle::Spindle;
use crate::stock::Stock;
use crate::thread::Next;
use crate::threading::Threads;
use crate::{MessageNote, arc};
use doubts::Doubts;
use drilled::Drilled;
use gauged::Gauged;
pub use gauged::GaugedThread;

/// Takes calls, holds items until they are asked for.
pub(crate) struct Translator {
    machine: Machine,
    modal: Modal,
    points: Points,
    spindle: Spindle,
    auxiliary: Auxiliary,
    threads: Threads,
    jobs: Jobs,
    output: Output,
    doubts: Doubts,
    part: Option<Part>,
    /// Comments read in the units in force, until something moves.
    read_in_units: Vec<(Place, &'static str, canon::Units)>,
    stock: Option<Stock>,
    block: Option<Block>,
    /// Whether the block lies where X and Y of the machine are; until it is cut nobody knows.
    block_lies: bool,
    /// Of the tool table, by tool.
    diameters_mm: BTreeMap<u32, f64>,
    /// Where zero of the program lies on the machine where a tool first cuts: X, Z.
    origins_mm: BTreeMap<u32, [f64; 2]>,
    /// Number of the coordinate system in force.
    system: u8,
    gauged: Gauged,
    drilled: Drilled,
}

impl Sink for Translator {
    /// Takes a call. What the machine cannot do is reported, and the program goes on: its own state is not
    /// disturbed, so that what else is wrong is found, and nothing that is not.
    fn call(&mut self, place: Place, call: Call<'_>) -> Done {
        self.output.comes_from(place);
        if let Err(problem) = self.take(place, call) {
            self.refuse(place, *problem);
        }
        Ok(())
    }

    fn assumes(&mut self, place: Place, call: Call<'_>) {
        let told = self.output.told();
        // What it refuses is not told.
        let _ = self.call(place, call);
        self.output.tell_no_more_than(told);
    }

    fn skips_to(&mut self, place: Place, to: &Pose) {
        self.output.comes_from(place);
        self.release(Next::Stays);
        self.points.skip_to(self.modal.frame.machine(to));
    }

    fn job(&mut self, place: Place, job: &Job, tools: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        self.output.comes_from(place);
        self.release(Next::Stays);
        self.take_job(place, job, tools);
        Ok(Some(self.modal.frame.programmed(self.points.programmed())))
    }
}

impl Translator {
    /// `diameters_mm` are those of the tool table.
    pub(crate) fn new(machine: &Machine, diameters_mm: BTreeMap<u32, f64>) -> Translator {
        let modal = Modal::new(machine);
        Translator {
            machine: machine.clone(),
            output: Output::new(machine, modal.path.mode),
            modal,
            points: Points::at_home(machine),
            spindle: Spindle::new(),
            auxiliary: Auxiliary::default(),
            threads: Threads::default(),
            jobs: Jobs::default(),
            doubts: Doubts::default(),
            part: None,
            read_in_units: Vec::new(),
            stock: None,
            block: None,
            block_lies: false,
            diameters_mm,
            origins_mm: BTreeMap::new(),
            system: 1,
            gauged: Gauged::default(),
            drilled: Drilled::default(),
        }
    }

    /// The next item, once it cannot change any more.
    pub(crate) fn next_item(&mut self) -> Option<Item> {
        self.output.next_item()
    }

    /// Lines that wait for others to become one with leave as they are.
    pub(crate) fn settle(&mut self) {
        self.output.settle();
    }

    /// The line of the G33 that waits, and how many legs its chain has so far.
    pub(crate) fn waits(&self) -> Option<(u32, usize)> {
        self.threads.waits_with()
    }

    /// What was found wrong later than at its call, since it was asked last.
    pub(crate) fn take_problems(&mut self) -> Vec<(Place, Problem)> {
        self.output.take_problems()
    }

    /// Whether a move before could not be made.
    pub(crate) fn is_astray(&self) -> bool {
        self.points.is_astray()
    }

    /// Where the last call came from.
    pub(crate) fn place(&self) -> Place {
        self.output.place()
    }

    /// The passes so far.
    pub(crate) fn passes(&self) -> &[PassNote] {
        self.threads.notes()
    }

    /// What the operator is told so far.
    pub(crate) fn messages(&self) -> &[MessageNote] {
        self.output.messages()
    }

    /// Steps of progress of all that has left.
    pub(crate) fn steps(&self) -> u64 {
        self.output.steps()
    }

    /// The jobs so far.
    pub(crate) fn jobs(&self) -> &[JobNote] {
        self.jobs.notes()
    }

    /// The program is over, however it ended.
    pub(crate) fn finish(&mut self) {
        self.release(Next::Stays);
        self.gauge_tells();
        let line = self.place().line;
        self.spindle.stop();
        self.end_of_block();
        let coolant = self.auxiliary.coolant(false, false);
        self.push_some(line, coolant);
        self.push(line, Code::End);
    }

    /// A block is over: what its words ask of the spindle is known.
    pub(crate) fn end_of_block(&mut self) {
        if !self.threads.waits() {
            self.settle_spindle();
        }
    }

    /// Sends what has changed of the spindle.
    fn settle_spindle(&mut self) {
        let place = self.place();
        let (in_range, code) = self.spindle.settle(&self.modal.frame, &self.machine);
        if let Err(problem) = in_range {
            self.output.report(place, *problem);
        }
        if let Some(code) = code {
            self.send(place.line, code);
        }
    }

    /// Reports what cannot be done. Of the travel, which the machine file has, it is told what the program
    /// may write.
    pub(super) fn refuse(&mut self, place: Place, mut problem: Problem) {
        if problem.code == "travel-limit"
            && let Some(may) = self.modal.frame.travel(&problem.message, &self.machine)
        {
            problem.help = format!("{may}; check units (G20, G21), G7, G91 and offsets");
        }
        self.output.report(place, problem);
    }

    /// An item, behind what has to be said before it.
    fn push(&mut self, line: u32, code: Code) {
        self.settle_spindle();
        self.send(line, code);
    }

    fn push_some(&mut self, line: u32, code: Option<Code>) {
        if let Some(code) = code {
            self.push(line, code);
        }
    }

    fn send(&mut self, line: u32, code: Code) {
        self.output.push(Item { line, code }, self.points.axes_at_rest(), &self.modal.path);
    }

    fn take(&mut self, place: Place, call: Call<'_>) -> Done {
        match call {
            Call::Comment(text) => {
                self.threads.comment(text)?;
                self.take_part(text)?;
                self.take_thread(text)
            }
            Call::Note(_)
            | Call::OnReset
            | Call::SetFeedReference
            | Call::SetToolTableEntry(_)
            | Call::EnableFeedOverride(true)
            | Call::EnableSpeedOverride(true)
            | Call::EnableAdaptiveFeed(false)
            | Call::EnableFeedHold(true)
            | Call::PalletShuttle
            | Call::Finish
            | Call::ProgramEnd => Ok(()),
            Call::UseLengthUnits(units) => {
                self.units_are(units);
                self.modal.change(&call, &self.machine)
            }
            Call::SelectPlane(_)
            | Call::SetG5xOffset(..)
            | Call::SetG92Offset(_)
            | Call::UseToolLengthOffset(_)
            | Call::SetXyRotation(_)
            | Call::SetFeedMode(_)
            | Call::SetFeedRate(_)
            | Call::SetMotionControlMode(_)
            | Call::SetNaivecamTolerance { .. }
            | Call::StartSpeedFeedSynch { .. }
            | Call::StopSpeedFeedSynch => {
                self.modal.change(&call, &self.machine).map(|()| self.zero_follows(&call))
            }
            Call::Message(text) | Call::Print(text) | Call::Log(_, text) => {
                self.output.tell(place, text);
                Ok(())
            }
            _ => {
                // A retract that is part of the pass still ends at its own point, should Z have run beyond
                // it.
                if self.threads.waits() && !self.goes_on(&call) {
                    self.release(self.behind_thread(&call));
                }
                self.act(place, &call)
            }
        }
    }

    /// Calls that make the machine do something.
    fn act(&mut self, place: Place, call: &Call<'_>) -> Done {
        let (line, machine) = (place.line, &self.machine);
        match *call {
            Call::StraightTraverse(to) => self.straight(place, &to, true)?,
            Call::StraightFeed(to) => self.straight(place, &to, false)?,
            Call::ArcFeed(arc) => self.arc(place, &arc)?,
            Call::NurbsFeed(curve) => self.spline(place, curve)?,
            Call::RigidTap(to, faster, dwell_s) => self.rigid_tap(place, &to, [faster, dwell_s])?,
            Call::ThreadCycle(cycle) => self.thread_cycle(place, cycle)?,
            Call::Dwell(seconds) => self.dwell(line, seconds)?,
            Call::SetSpindleMode(highest) => self.spindle.set_mode(highest, machine)?,
            Call::SetSpindleSpeed(s) => self.spindle.set_speed(s, self.modal.frame.unit(), machine)?,
            Call::StartSpindle(turn) => self.spindle.start(turn, machine)?,
            Call::StopSpindle => self.spindle.stop(),
            // Somebody who puts tools in is asked at the change, and not when the next one is named.
            Call::SelectTool(_) if !machine.general.tool_change.is_automatic() => {}
            Call::SelectTool(number) | Call::ChangeTool(number) | Call::ChangeToolNumber(number) => {
                let number = u32::try_from(number).unwrap_or(0);
                find_tool(number, machine)?;
                may_change(machine, self.spindle.turns())?;
                let tool = self.auxiliary.select_tool(number);
                self.zero_follows(call);
                self.push_some(line, tool);
            }
            Call::MistOn | Call::MistOff | Call::FloodOn | Call::FloodOff => {
                let coolant = self.auxiliary.cools(call);
                self.push_some(line, coolant);
            }
            Call::ProgramStop => self.push(line, Code::Pause),
            Call::OptionalProgramStop => self.push(line, Code::OptionalPause),
            _ => {
                refuse_absent(call)?;
                self.push_some(line, auxiliary::signal(call, &self.machine, self.spindle.turns())?);
            }
        }
        Ok(())
    }

    fn dwell(&mut self, line: u32, seconds: f64) -> Done {
        if !(0.0..=LONGEST_DWELL).contains(&seconds) {
            let message = format!("G4 cannot wait {} s", short(seconds));
            let help = format!("give 0 to {LONGEST_DWELL} seconds");
            return Err(Problem::error("bad-value", Blame::Word('P'), message, help));
        }
        self.push(line, Code::Dwell { seconds });
        Ok(())
    }

    /// G0, G1, and the moves of canned cycles.
    fn straight(&mut self, place: Place, to: &Pose, rapid: bool) -> Done {
        let target = self.modal.frame.machine(to);
        self.points.target(target, &self.machine)?;
        if let (false, Some(synchronised)) = (rapid, self.modal.synchronised) {
            return self.thread_move(place, (&target, None), &synchronised);
        }
        if self.points.rests_at(&target) {
            self.points.program_goes_to(target);
            return Ok(());
        }
        let feed = if rapid {
            Feed::Rapid
        } else {
            self.points.at_programmed_point()?;
            self.settle_spindle();
            let to = self.points.axes(&target);
            let feed = self.modal.feed_of_line([self.points.axes_at_rest(), to], &self.spindle)?;
            self.doubt(place, &to, feed);
            feed
        };
        self.part_sees(place, &self.points.axes(&target), rapid);
        self.points.program_goes_to(target);
        self.line_to(place.line, target, feed);
        Ok(())
    }

    /// A line, unless the axes rest there already.
    fn line_to(&mut self, line: u32, target: Pose, feed: Feed) {
        if !self.points.rests_at(&target) {
            self.push(line, Code::Line { target: self.points.axes(&target), feed });
            self.points.axes_go_to(target);
        }
    }

    /// G2, G3, helices.
    fn arc(&mut self, place: Place, arc: &canon::Arc) -> Done {
        arc::check_plane(&self.modal, &self.machine)?;
        if let Some(synchronised) = self.modal.synchronised {
            return self.thread_along_arc(place, arc, &synchronised);
        }
        // A move before that could not be made was reported: this arc would begin where it did not end.
        let astray = self.points.is_astray();
        let ends = arc::ends(arc, &self.modal);
        let [target, _] = ends;
        self.points.target(target, &self.machine)?;
        self.points.at_programmed_point()?;
        self.settle_spindle();
        let feed = self.modal.feed_of_arc(&self.spindle)?;
        let (arc, corners) = match arc::on_machine(arc.turns, &ends, self.modal.plane, &self.points) {
            Err(_) if astray => return Ok(()),
            made => made?,
        };
        arc::check_travel(&corners, &self.machine)?;
        self.doubt(place, &arc.target, feed);
        self.part_sees_arc(place, &arc);
        self.points.program_goes_to(target);
        self.points.axes_go_to(target);
        self.push(place.line, Code::Arc { arc, feed });
        Ok(())
    }
}
