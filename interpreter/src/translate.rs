//! Calls become items. In: canonical functions in the order of the program. Out: machine code, and what this machine
//! cannot do, by name.
//!
//! Every move stops exactly at its end, so that every path mode and every tolerance is kept.

use std::collections::VecDeque;

use gcode::canon::{FeedMode, Plane, Turn};
use gcode::problem::{Blame, short};
use gcode::{Call, Place, Problem, Sink};
use protocol::{Axis, Code, Item, Machine, SpindleMode, SpindleSpeed};

use crate::frame::Frame;
use crate::thread::{Point, Starts};
use crate::threading::{Held, PassNote};

/// What a receiver of calls returns.
pub(crate) type Done = Result<(), Box<Problem>>;

/// Slowest spindle speed, 1/min.
const SLOWEST_RPM: f64 = 0.01;
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
    spindle: SpindleMode,
    rpm: f64,
    tool: Option<u32>,
    /// G96.
    surface_speed: bool,
    mist: bool,
    flood: bool,
    /// Where the last move was to go, whether or not it can.
    pub(crate) asked: gcode::Position,
    /// The programmed point.
    pub(crate) point: Point,
    /// Where the axes rest; differs from the programmed point after a pass that ran beyond it.
    pub(crate) rest: Point,
    /// Lead of the synchronised motion that has begun, mm/rev along the path, and its start angle, degrees.
    pub(crate) lead: Option<(f64, f64)>,
    /// A pass whose retract may follow.
    pub(crate) held: Option<Held>,
    /// The last motion was synchronised.
    pub(crate) after_thread: bool,
    pub(crate) passes: u32,
    pub(crate) starts: Starts,
    pub(crate) notes: Vec<PassNote>,
    items: VecDeque<Item>,
    problems: Vec<(Place, Problem)>,
    /// Where the last call came from.
    place: Place,
}

impl Translator {
    pub(crate) fn new(machine: &Machine) -> Translator {
        let home = |axis| machine.axis.get(&axis).map_or(0.0, |config| config.home_mm);
        let point = Point { x: home(Axis::X), z: home(Axis::Z) };
        Translator {
            machine: machine.clone(),
            frame: Frame::new(),
            plane: Plane::Xz,
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
            spindle: SpindleMode::Stop,
            rpm: 0.0,
            tool: None,
            surface_speed: false,
            mist: false,
            flood: false,
            asked: [point.x, 0.0, point.z, 0.0, 0.0, 0.0],
            point,
            rest: point,
            lead: None,
            held: None,
            after_thread: false,
            passes: 0,
            starts: Starts::default(),
            notes: Vec::new(),
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
        if self.spindle != SpindleMode::Stop {
            self.spindle = SpindleMode::Stop;
            self.push(line, Code::Spindle { mode: SpindleMode::Stop, speed: SpindleSpeed::Rpm(0.0) });
        }
        self.coolant(line, false, false);
        self.push(line, Code::End);
    }

    pub(crate) fn push(&mut self, line: u32, code: Code) {
        self.items.push_back(Item { line, code });
    }

    /// Reports a problem of an earlier call, or a warning.
    pub(crate) fn report(&mut self, place: Place, problem: Problem) {
        self.problems.push((place, problem));
    }

    /// Speed and direction of a spindle that turns.
    pub(crate) fn turning(&self) -> Option<(f64, f64)> {
        (self.spindle != SpindleMode::Stop && self.rpm > 0.0).then(|| (self.rpm, self.spindle.sign()))
    }

    fn set_spindle(&mut self, place: Place, mode: SpindleMode, rpm: f64) {
        let commanded = |mode, rpm| if mode == SpindleMode::Stop { (mode, 0.0) } else { (mode, rpm) };
        let (before, after) = (commanded(self.spindle, self.rpm), commanded(mode, rpm));
        (self.spindle, self.rpm) = (mode, rpm);
        if before != after {
            self.push(place.line, Code::Spindle { mode: after.0, speed: SpindleSpeed::Rpm(after.1) });
        }
    }

    fn speed(&self, rpm: f64) -> Result<f64, Box<Problem>> {
        let highest = self.machine.spindle.max_rpm;
        if rpm == 0.0 || (SLOWEST_RPM..=highest).contains(&rpm) {
            return Ok(rpm);
        }
        let message = format!(
            "S{} is outside what the spindle can do: {SLOWEST_RPM} to {} 1/min (spindle.max_rpm)",
            short(rpm),
            short(highest)
        );
        let help = if rpm > highest {
            format!("give at most S{}", short(highest))
        } else {
            "stop it with M5".to_owned()
        };
        Err(Problem::error("speed-limit", Blame::Word('S'), message, help))
    }

    fn select_tool(&mut self, place: Place, number: i32) -> Done {
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
            let message = format!("F of {} mm is no feed", short(feed));
            let help = format!("give a feed above 0 and up to {} mm", short(HIGHEST_FEED));
            return Err(Problem::error("bad-value", Blame::Word('F'), message, help));
        }
        self.feed = feed;
        Ok(())
    }

    fn coolant(&mut self, line: u32, mist: bool, flood: bool) {
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

    fn modal(&mut self, place: Place, call: &Call<'_>) -> Done {
        match *call {
            Call::UseLengthUnits(units) => self.frame.unit = units.mm(),
            Call::SelectPlane(plane) => self.plane = plane,
            Call::SetG5xOffset(_, offset) => self.frame.system = self.lathe_offset(&offset)?,
            Call::SetG92Offset(offset) => self.frame.shift = self.lathe_offset(&offset)?,
            Call::UseToolLengthOffset(offset) => self.frame.tool = self.lathe_offset(&offset)?,
            Call::SetXyRotation(degrees) if degrees != 0.0 => {
                let help = "leave R out, or set it to 0";
                self.report(place, *missing("a coordinate system turned about Z", help));
            }
            Call::SetFeedMode(mode) => self.feed_mode = mode,
            Call::SetFeedRate(feed) => self.set_feed(feed)?,
            Call::SetSpindleMode(highest) if highest > 0.0 => {
                self.surface_speed = true;
                let help = "give the speed in 1/min with G97 S";
                self.report(place, *missing("constant surface speed (G96)", help));
            }
            Call::SetSpindleMode(_) => self.surface_speed = false,
            _ => {}
        }
        Ok(())
    }

    fn lathe_offset(&self, offset: &gcode::Position) -> Result<gcode::Position, Box<Problem>> {
        match Frame::foreign(offset) {
            Some((axis, by)) => Err(no_axis(axis, by)),
            None => Ok(self.frame.scaled(offset)),
        }
    }

    /// Calls that make the machine do something.
    fn act(&mut self, place: Place, call: &Call<'_>) -> Done {
        match *call {
            Call::StraightTraverse(to) => self.straight(place, &to, true)?,
            Call::StraightFeed(to) => self.straight(place, &to, false)?,
            Call::ArcFeed(arc) => self.arc(place, &arc)?,
            Call::ThreadCycle(cycle) => self.thread_cycle(place, cycle)?,
            Call::Dwell(seconds) => self.dwell(place, seconds)?,
            // S of G96 is m/min, and G96 has been refused: any speed will do to find other errors.
            Call::SetSpindleSpeed(_) if self.surface_speed => self.rpm = 1.0,
            Call::SetSpindleSpeed(rpm) => {
                let rpm = self.speed(rpm)?;
                self.set_spindle(place, self.spindle, rpm);
            }
            Call::StartSpindle(Turn::Clockwise) => self.set_spindle(place, SpindleMode::Clockwise, self.rpm),
            Call::StartSpindle(Turn::Counterclockwise) => {
                self.set_spindle(place, SpindleMode::Counterclockwise, self.rpm);
            }
            Call::StopSpindle => self.set_spindle(place, SpindleMode::Stop, self.rpm),
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
}

impl Translator {
    fn take(&mut self, place: Place, call: Call<'_>) -> Done {
        match call {
            Call::Comment(_)
            | Call::Note(_)
            | Call::OnReset
            | Call::SetFeedReference
            | Call::SetMotionControlMode(_)
            | Call::SetNaivecamTolerance(_)
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
            | Call::SetSpindleMode(_) => self.modal(place, &call),
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

/// A lathe of X and Z is asked for another axis.
pub(crate) fn no_axis(axis: char, at: f64) -> Box<Problem> {
    let message = format!("this lathe has no axis {axis} (it would be at {})", short(at));
    Problem::error("no-such-axis", Blame::Word(axis), message, "its axes are X and Z: leave the word out")
}
