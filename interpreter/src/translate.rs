//! Calls become items. In: canonical functions in the order of the program. Out: machine code, and what this machine
//! cannot do, by name.

use std::collections::VecDeque;

use gcode::canon::{FeedMode, Plane, Turn};
use gcode::problem::{Blame, short};
use gcode::{Call, Place, Problem, Sink};
use protocol::machine::Kinematics;
use protocol::{Axis, Code, Item, Machine, PathMode, Position, SpindleMode};

use crate::frame::Frame;
use crate::job::{Asked, JobNote, Planned};
use crate::merge::{self, Merged};
use crate::moves::no_axis;
use crate::options::home;
use crate::spindle::Spindle;
use crate::thread::Starts;
use crate::threading::{Held, PassNote};

/// What a receiver of calls returns.
pub(crate) type Done = Result<(), Box<Problem>>;

/// Longest dwell, s.
const LONGEST_DWELL: f64 = 86_400.0;
/// Highest feed, mm/min or mm/rev.
const HIGHEST_FEED: f64 = 1e6;

/// Takes calls, holds items until they are asked for.
pub(crate) struct Translator {
    pub(crate) machine: Machine,
    pub(crate) frame: Frame,
    pub(crate) plane: Plane,
    pub(crate) feed_mode: FeedMode,
    /// F in mm/min or mm/rev, 0 for none.
    pub(crate) feed: f64,
    pub(crate) spindle: Spindle,
    /// G61, G61.1, G64.
    pub(crate) path_mode: PathMode,
    /// Q of G64 says how far lines are merged, whatever their length.
    pub(crate) merges_all: bool,
    /// What was sent of it last.
    path_mode_sent: PathMode,
    tool: Option<u32>,
    mist: bool,
    flood: bool,
    /// Where the last move was to go, whether or not it can.
    pub(crate) asked: gcode::Position,
    /// The programmed point, in coordinates of the machine.
    pub(crate) point: gcode::Position,
    /// Where the axes rest; differs from the programmed point after a pass that ran beyond it.
    pub(crate) rest: gcode::Position,
    /// Lead of the synchronised motion that has begun, mm/rev along the path, and its start angle, degrees.
    pub(crate) lead: Option<(f64, f64)>,
    /// A pass whose retract may follow.
    pub(crate) held: Option<Held>,
    /// The last motion was synchronised.
    pub(crate) after_thread: bool,
    pub(crate) passes: u32,
    pub(crate) starts: Starts,
    pub(crate) notes: Vec<PassNote>,
    pub(crate) jobs: Vec<JobNote>,
    /// The last job that could be done.
    pub(crate) last_job: Option<(Asked, Planned)>,
    /// A line that others may yet lengthen.
    merged: Option<Merged>,
    items: VecDeque<Item>,
    problems: Vec<(Place, Problem)>,
    /// Where the last call came from.
    place: Place,
}

impl Translator {
    pub(crate) fn new(machine: &Machine) -> Translator {
        let point = home(machine);
        let path_mode = PathMode::within(machine.path.tolerance_mm);
        Translator {
            machine: machine.clone(),
            frame: Frame::new(),
            plane: plane_of(machine),
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
            spindle: Spindle::new(),
            path_mode,
            merges_all: false,
            path_mode_sent: path_mode,
            tool: None,
            mist: false,
            flood: false,
            asked: point,
            point,
            rest: point,
            lead: None,
            held: None,
            after_thread: false,
            passes: 0,
            starts: Starts::default(),
            notes: Vec::new(),
            jobs: Vec::new(),
            last_job: None,
            merged: None,
            items: VecDeque::new(),
            problems: Vec::new(),
            place: Place { line: 1, ..Place::default() },
        }
    }

    pub(crate) fn items(&mut self) -> impl Iterator<Item = Item> + '_ {
        self.items.drain(..)
    }

    /// What was found wrong later than at its call.
    pub(crate) fn problems(&mut self) -> impl Iterator<Item = (Place, Problem)> + use<> {
        std::mem::take(&mut self.problems).into_iter()
    }

    /// Where the last call came from.
    pub(crate) fn place(&self) -> Place {
        self.place
    }

    pub(crate) fn notes(&self) -> &[PassNote] {
        &self.notes
    }

    /// The program is over, however it ended.
    pub(crate) fn finish(&mut self) {
        self.release(None);
        let line = self.place.line;
        self.spindle.mode = SpindleMode::Stop;
        self.end_of_block();
        self.coolant(line, false, false);
        self.push(line, Code::End);
    }

    /// A block is over: what its words ask of the spindle is known.
    pub(crate) fn end_of_block(&mut self) {
        if self.held.is_none() {
            self.settle_spindle(self.place);
        }
    }

    /// An item, behind what has to be said before it.
    pub(crate) fn push(&mut self, line: u32, code: Code) {
        self.settle_spindle(self.place);
        if matches!(code, Code::Line { .. } | Code::Arc { .. }) && self.path_mode != self.path_mode_sent {
            self.path_mode_sent = self.path_mode;
            self.push_alone(line, Code::PathMode(self.path_mode));
        }
        self.push_alone(line, code);
    }

    /// An item, unless it becomes part of a line that waits for others (G64 Q). Until it has been pushed the axes rest at
    /// its start.
    pub(crate) fn push_alone(&mut self, line: u32, code: Code) {
        let item = Item { line, code };
        let merge_mm = match self.path_mode_sent {
            PathMode::Blend { merge_mm, .. } => merge_mm,
            PathMode::ExactStop | PathMode::ExactPath => 0.0,
        };
        if self.merged.as_mut().is_some_and(|merged| merged.take(&item, merge_mm)) {
            return;
        }
        self.items.extend(self.merged.take().map(|merged| merged.item()));
        let longest = if self.merges_all { f64::INFINITY } else { merge::SHORT_MM };
        self.merged = Merged::new(self.positions(&self.rest), &item, longest).filter(|_| merge_mm > 0.0);
        if self.merged.is_none() {
            self.items.push_back(item);
        }
    }

    /// Reports a problem of an earlier call, or a warning.
    pub(crate) fn report(&mut self, place: Place, problem: Problem) {
        self.problems.push((place, problem));
    }

    pub(crate) fn select_tool(&mut self, place: Place, number: i32) -> Done {
        let number = u32::try_from(number).unwrap_or(0);
        let tools = &self.machine.tools;
        if !tools.is_empty() && number != 0 && tools.keys().all(|name| name.parse() != Ok(number)) {
            let known: Vec<&str> = tools.keys().map(String::as_str).collect();
            let message = format!("tool {number} is not in the machine file");
            let help = format!("tools there: {}; add [tools.{number}] for this one", known.join(", "));
            return Err(Problem::error("unknown-tool", Blame::Word('T'), message, help));
        }
        if self.tool != Some(number) {
            self.tool = Some(number);
            self.push(place.line, Code::Tool { number });
        }
        Ok(())
    }

    fn dwell(&mut self, place: Place, seconds: f64) -> Done {
        if !(0.0..=LONGEST_DWELL).contains(&seconds) {
            let message = format!("G4 cannot wait {} s", short(seconds));
            let help = format!("give 0 to {LONGEST_DWELL} seconds");
            return Err(Problem::error("bad-value", Blame::Word('P'), message, help));
        }
        self.push(place.line, Code::Dwell { seconds });
        Ok(())
    }

    fn set_feed(&mut self, feed: f64) -> Done {
        let feed = feed * self.frame.unit;
        if !(0.0..=HIGHEST_FEED).contains(&feed) {
            self.feed = HIGHEST_FEED; // one mistake, one message: moves do not lack a feed, too
            let message = format!("F of {} mm is no feed", short(feed));
            let help = format!("give a feed above 0 and up to {} mm", short(HIGHEST_FEED));
            return Err(Problem::error("bad-value", Blame::Word('F'), message, help));
        }
        self.feed = feed;
        Ok(())
    }

    pub(crate) fn coolant(&mut self, line: u32, mist: bool, flood: bool) {
        if (self.mist, self.flood) != (mist, flood) {
            (self.mist, self.flood) = (mist, flood);
            self.push(line, Code::Coolant { mist, flood });
        }
    }

    /// A message that only a person can act on.
    fn unheard(&mut self, place: Place, text: &str) {
        let message = format!("messages are not shown while the program runs: \"{text}\"");
        let help = "the program runs without it; leave it out to silence this warning";
        let problem = Problem::warning("message-not-shown", Blame::Line(place.line), message, help);
        self.report(place, *problem);
    }

    fn modal(&mut self, call: &Call<'_>) -> Done {
        match *call {
            Call::UseLengthUnits(units) => self.frame.unit = units.mm(),
            Call::SelectPlane(plane) => self.plane = plane,
            Call::SetG5xOffset(_, offset) => self.frame.system = self.offset(&offset)?,
            Call::SetG92Offset(offset) => self.frame.shift = self.offset(&offset)?,
            Call::UseToolLengthOffset(offset) => self.frame.tool = self.offset(&offset)?,
            Call::SetXyRotation(degrees) if degrees != 0.0 && !self.machine.axis.contains_key(&Axis::Y) => {
                let help = "leave R out, or set it to 0";
                return Err(missing("a coordinate system turned about Z", help));
            }
            Call::SetXyRotation(degrees) => self.frame.rotation_deg = degrees,
            Call::SetFeedMode(mode) => self.set_feed_mode(mode)?,
            Call::SetFeedRate(feed) => self.set_feed(feed)?,
            Call::SetMotionControlMode(mode) => {
                (self.path_mode, self.merges_all) = (self.mode_of_path(mode)?, false);
            }
            Call::SetNaivecamTolerance { tolerance, programmed: true } => self.merge_within(tolerance)?,
            _ => {}
        }
        Ok(())
    }

    /// An offset in mm and degrees; refused if it shifts an axis that the machine does not have.
    fn offset(&self, offset: &gcode::Position) -> Result<gcode::Position, Box<Problem>> {
        let scaled = self.frame.scaled(offset);
        let shifts = self.positions(&scaled);
        let lacks =
            |axis: &Axis| !self.machine.axis.contains_key(axis) && shifts[axis.index()] != Position(0);
        match Axis::ALL.into_iter().find(lacks) {
            Some(axis) => Err(no_axis(&self.machine, axis, shifts[axis.index()].mm())),
            None => Ok(scaled),
        }
    }

    /// Calls that make the machine do something.
    fn act(&mut self, place: Place, call: &Call<'_>) -> Done {
        match *call {
            Call::StraightTraverse(to) => self.straight(place, &to, true)?,
            Call::StraightFeed(to) => self.straight(place, &to, false)?,
            Call::ArcFeed(arc) => self.arc(place, &arc)?,
            Call::ThreadCycle(cycle) => self.thread_cycle(place, cycle)?,
            Call::Job(job, tools) => self.job(place, job, tools)?,
            Call::Dwell(seconds) => self.dwell(place, seconds)?,
            Call::SetSpindleMode(highest) => self.spindle_mode(highest)?,
            Call::SetSpindleSpeed(speed) => self.spindle_speed(speed)?,
            Call::StartSpindle(Turn::Clockwise) => self.start_spindle(SpindleMode::Clockwise)?,
            Call::StartSpindle(Turn::Counterclockwise) => {
                self.start_spindle(SpindleMode::Counterclockwise)?
            }
            Call::StopSpindle => self.spindle.mode = SpindleMode::Stop,
            Call::SelectTool(number) | Call::ChangeTool(number) | Call::ChangeToolNumber(number) => {
                self.select_tool(place, number)?;
            }
            Call::MistOn => self.coolant(place.line, true, self.flood),
            Call::MistOff => self.coolant(place.line, false, self.flood),
            Call::FloodOn => self.coolant(place.line, self.mist, true),
            Call::FloodOff => self.coolant(place.line, self.mist, false),
            Call::ProgramStop | Call::OptionalProgramStop => self.push(place.line, Code::Pause),
            Call::OrientSpindle(..) | Call::WaitSpindleOrient(_) => {
                return Err(missing("spindle orientation (M19)", "leave it out: threads find their angle"));
            }
            Call::EnableFeedOverride(false)
            | Call::EnableSpeedOverride(false)
            | Call::EnableFeedHold(false)
            | Call::EnableAdaptiveFeed(true) => {
                let help =
                    "leave M49 to M53 out; the operator's overrides always count (of G74 and G84, too)";
                return Err(missing("switching overrides and hold on and off", help));
            }
            Call::MoveByHand => {
                return Err(missing("moving the tool out by hand (G88)", "bore with G85, G86 or G89"));
            }
            Call::StraightProbe(..) => return Err(missing("probing (G38)", "measure by other means")),
            Call::RigidTap(..) => {
                return Err(missing("rigid tapping (G33.1)", "cut the thread with G33 or G76"));
            }
            Call::SetMotionOutputBit(..)
            | Call::SetAuxOutputBit(..)
            | Call::SetMotionOutputValue(..)
            | Call::SetAuxOutputValue(..)
            | Call::WaitInput { .. } => {
                return Err(missing(
                    "inputs and outputs (M62 to M68)",
                    "this machine has none: leave it out",
                ));
            }
            _ => {}
        }
        Ok(())
    }
}

impl Sink for Translator {
    /// Takes a call. What the machine cannot do is reported, and the program goes on: its own state is not disturbed,
    /// so that what else is wrong is found, and nothing that is not.
    fn call(&mut self, place: Place, call: Call<'_>) -> Done {
        self.place = place;
        if let Err(problem) = self.take(place, call) {
            self.report(place, *problem);
        }
        Ok(())
    }

    fn after_job(&self) -> Option<gcode::Position> {
        Some(self.frame.programmed(&self.point))
    }
}

impl Translator {
    fn take(&mut self, place: Place, call: Call<'_>) -> Done {
        match call {
            Call::Comment(_)
            | Call::Note(_)
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
            Call::UseLengthUnits(_)
            | Call::SelectPlane(_)
            | Call::SetG5xOffset(..)
            | Call::SetG92Offset(_)
            | Call::UseToolLengthOffset(_)
            | Call::SetXyRotation(_)
            | Call::SetFeedMode(_)
            | Call::SetFeedRate(_)
            | Call::SetMotionControlMode(_)
            | Call::SetNaivecamTolerance { .. } => self.modal(&call),
            Call::Message(text) | Call::Print(text) | Call::Log(_, text) => {
                self.unheard(place, text);
                Ok(())
            }
            Call::StartSpeedFeedSynch { lead, velocity, start_deg } => {
                self.lead = (!velocity).then_some((lead * self.frame.unit, start_deg));
                Ok(())
            }
            Call::StopSpeedFeedSynch => {
                self.lead = None;
                Ok(())
            }
            _ => {
                // A retract that is part of the pass still ends at its own point, should Z have run beyond it.
                if self.held.is_some() && !self.retracts(&call) {
                    self.release(None);
                }
                self.act(place, &call)
            }
        }
    }
}

/// What this machine does not have, in words.
pub(crate) fn missing(what: &str, help: &str) -> Box<Problem> {
    let message = format!("{what}: not available on this machine yet");
    Problem::error("not-available", Blame::Block, message, help)
}

/// The plane at the start.
pub(crate) fn plane_of(machine: &Machine) -> Plane {
    match machine.machine.kinematics {
        Kinematics::Lathe => Plane::Xz,
        Kinematics::Mill | Kinematics::Positioner => Plane::Xy,
    }
}
