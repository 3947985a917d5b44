//! The spindle: S, G96, G97, M3, M4, M5. In: calls. Out: an item where the words of a block together change
//! what the spindle is to do, or where an offset moves the axis that surface speed counts from.

use gcode::Problem;
use gcode::canon::{FeedMode, Turn, X};
use gcode::problem::{Blame, short};
use machine::{Kinematics, Machine};
use protocol::{Code, Position, SpindleMode, SpindleSpeed};

use crate::frame::Frame;
use crate::reach::{Done, missing, needs_spindle};

/// Slowest spindle speed, 1/min.
const SLOWEST_RPM: f64 = 0.01;
/// Highest surface speed, mm/s.
const HIGHEST_SURFACE: f64 = 1e6;
/// mm in a foot.
const FOOT_MM: f64 = 304.8;
/// mm in a metre.
const METRE_MM: f64 = 1000.0;

/// What the program asks of the spindle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spindle {
    mode: SpindleMode,
    /// S: 1/min; under G96 m/min, or ft/min.
    s: f64,
    /// S of G96, mm/s.
    surface_mm_s: f64,
    /// G96: its D, 1/min.
    highest: Option<f64>,
    /// Under G96: the one speed that it keeps through a thread, 1/min.
    held: Option<f64>,
    /// What was sent last.
    sent: (SpindleMode, SpindleSpeed),
}

impl Spindle {
    pub(crate) fn new() -> Spindle {
        let sent = (SpindleMode::Stop, SpindleSpeed::Rpm(0.0));
        Spindle { mode: SpindleMode::Stop, s: 0.0, surface_mm_s: 0.0, highest: None, held: None, sent }
    }

    /// Whether it turns.
    pub(crate) fn turns(&self) -> bool {
        self.mode != SpindleMode::Stop && self.s > 0.0
    }

    /// What makes mm/min of a feed: revolutions per minute under G95, infinite where they are not constant,
    /// else 1.
    pub(crate) fn turns_in_feed(&self, mode: FeedMode) -> f64 {
        match mode {
            FeedMode::PerRevolution => self.turning().map_or(f64::INFINITY, |(rpm, _)| rpm),
            FeedMode::PerMinute | FeedMode::InverseTime => 1.0,
        }
    }

    /// Whether its surface speed is constant (G96).
    pub(crate) fn is_surface(&self) -> bool {
        self.highest.is_some()
    }

    /// Speed and direction, if it turns at a constant speed.
    pub(crate) fn turning(&self) -> Option<(f64, f64)> {
        (self.turns() && !self.is_surface()).then(|| (self.s, self.mode.sign()))
    }

    /// Speed and direction of a thread whose tool stands at X of the machine, if it turns: what G96 gives
    /// there is kept through the pass, because a pass that is proved for one speed is not for another. What
    /// goes on from a thread has the speed that this one keeps, wherever X is by then.
    fn turning_at(&self, x_mm: f64, frame: &Frame, machine: &Machine) -> Option<(f64, f64)> {
        let speed = self.wanted(frame, machine).1;
        self.turns().then(|| (speed.rpm(Position::from_mm(x_mm)), self.mode.sign()))
    }

    /// Keeps one speed from now on, if it is that of G96 that would change it.
    pub(crate) fn hold(&mut self, rpm: f64) {
        self.held = self.is_surface().then_some(rpm);
    }

    /// Follows X again.
    pub(crate) fn release(&mut self) {
        self.held = None;
    }

    /// Direction and speed of a job, 1/min; negative counterclockwise.
    pub(crate) fn turn(&mut self, rpm: f64) {
        let mode = if rpm < 0.0 { SpindleMode::Counterclockwise } else { SpindleMode::Clockwise };
        (self.mode, self.s, self.highest) = (mode, rpm.abs(), None);
    }

    /// G96 with its highest speed, or G97: 0.
    pub(crate) fn set_mode(&mut self, highest: f64, machine: &Machine) -> Done {
        if highest > 0.0 {
            needs_spindle(machine, "G96", Blame::Block)?;
        }
        self.highest = (highest > 0.0).then_some(highest);
        Ok(())
    }

    /// M3 or M4.
    pub(crate) fn start(&mut self, turn: Turn, machine: &Machine) -> Done {
        let (word, mode) = match turn {
            Turn::Clockwise => ("M3", SpindleMode::Clockwise),
            Turn::Counterclockwise => ("M4", SpindleMode::Counterclockwise),
        };
        needs_spindle(machine, word, Blame::Block)?;
        self.mode = mode;
        Ok(())
    }

    /// M5.
    pub(crate) fn stop(&mut self) {
        self.mode = SpindleMode::Stop;
    }

    /// S; `unit`: mm in one of the program's.
    pub(crate) fn set_speed(&mut self, s: f64, unit: f64, machine: &Machine) -> Done {
        if s != 0.0 {
            needs_spindle(machine, "S", Blame::Word('S'))?;
        }
        if self.is_surface() {
            let per_minute = if unit == 1.0 { METRE_MM } else { FOOT_MM };
            let mm_s = s * per_minute / 60.0;
            if !(0.0..=HIGHEST_SURFACE).contains(&mm_s) {
                let message = format!("S{} is not a surface speed", short(s));
                let help = "give m/min, or ft/min under G20, such as G96 S180";
                return Err(Problem::error("bad-value", Blame::Word('S'), message, help));
            }
            self.surface_mm_s = mm_s;
        } else {
            let in_range = rpm_in_range(s, Blame::Word('S'), machine);
            // What follows is not to blame: it has the nearest speed that there is.
            self.s = if in_range.is_ok() { s } else { s.max(SLOWEST_RPM).min(machine.spindle.max_rpm) };
            return in_range;
        }
        self.s = s;
        Ok(())
    }

    /// What has changed since it was sent last, which it counts as now. S of G96 becomes 1/min where G97
    /// leaves it in force, as in LinuxCNC; one that the spindle cannot turn at becomes 0, and is reported.
    pub(crate) fn settle(&mut self, frame: &Frame, machine: &Machine) -> (Done, Option<Code>) {
        let in_range = if self.is_surface() { Ok(()) } else { rpm_in_range(self.s, Blame::Block, machine) };
        if in_range.is_err() {
            self.s = 0.0;
        }
        let wanted = self.wanted(frame, machine);
        let before = std::mem::replace(&mut self.sent, wanted);
        let (mode, speed) = wanted;
        (in_range, (wanted != before).then_some(Code::Spindle { mode, speed }))
    }

    fn wanted(&self, frame: &Frame, machine: &Machine) -> (SpindleMode, SpindleSpeed) {
        let Spindle { mode, s, surface_mm_s, highest, held, .. } = *self;
        let speed = match (mode, highest, held) {
            (SpindleMode::Stop, ..) => SpindleSpeed::Rpm(0.0),
            (_, None, _) => SpindleSpeed::Rpm(s),
            (_, Some(_), Some(rpm)) => SpindleSpeed::Rpm(rpm),
            (_, Some(highest), None) => SpindleSpeed::Surface {
                mm_s: surface_mm_s,
                max_rpm: highest.min(machine.spindle.max_rpm),
                axis_mm: Position::from_mm(frame.machine(&[0.0; 6])[X]),
            },
        };
        (mode, speed)
    }
}

/// The spindle, and where zero of the program lies: what a thread is told its speed by.
#[derive(Clone, Copy)]
pub(crate) struct Turning<'a> {
    pub(crate) spindle: &'a Spindle,
    pub(crate) frame: &'a Frame,
}

impl Turning<'_> {
    /// Speed and direction of a tap: of a spindle with one speed.
    pub(crate) fn taps(self, machine: &Machine) -> Result<(f64, f64), Box<Problem>> {
        needs_spindle(machine, "a tap", Blame::Block)?;
        self.spindle.turning().ok_or_else(|| {
            let (message, help) = match self.spindle.is_surface() {
                true => ("a tap has no surface speed (G96)", "select G97 and S in 1/min before it"),
                false => ("a tap needs a turning spindle", "start it before, as in S400 M3"),
            };
            Problem::error("spindle-not-turning", Blame::Block, message, help)
        })
    }

    /// Speed and direction through a thread on a lathe; under G96 those at X of the machine: the crest of a
    /// cycle, or where a single pass begins.
    pub(crate) fn at(self, x_mm: f64, machine: &Machine) -> Result<(f64, f64), Box<Problem>> {
        if machine.general.kinematics != Kinematics::Lathe {
            let help = "mill it with G2 or G3 and Z, or use a lathe";
            return Err(missing("a thread (G33, G76) on a mill", help));
        }
        self.spindle.turning_at(x_mm, self.frame, machine).ok_or_else(|| {
            let message = "a thread needs a turning spindle";
            let help = "start it in a block before or in this one, as in S400 M3";
            Problem::error("spindle-not-turning", Blame::Block, message, help)
        })
    }
}

/// Refuses a speed that the spindle cannot turn at, 1/min.
fn rpm_in_range(rpm: f64, blame: Blame, machine: &Machine) -> Done {
    let highest = machine.spindle.max_rpm;
    if rpm == 0.0 || (SLOWEST_RPM..=highest).contains(&rpm) {
        return Ok(());
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
    Err(Problem::error("speed-limit", blame, message, help))
}
