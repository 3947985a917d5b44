//! The spindle: S, G96, G97, M3, M4, M5. In: calls. Out: an item where the words of a block together change what the
//! spindle is to do, or where an offset moves the axis that surface speed counts from.

use gcode::problem::{Blame, short};
use gcode::{Place, Problem};
use protocol::{Code, Position, SpindleMode, SpindleSpeed};

use gcode::canon::{FeedMode, X};

use crate::translate::{Done, Translator};

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
    pub(crate) mode: SpindleMode,
    /// S: 1/min; under G96 m/min, or ft/min.
    s: f64,
    /// S of G96, mm/s.
    surface_mm_s: f64,
    /// G96: its D, 1/min.
    highest: Option<f64>,
    /// What was sent last.
    sent: (SpindleMode, SpindleSpeed),
}

impl Spindle {
    pub(crate) fn new() -> Spindle {
        let sent = (SpindleMode::Stop, SpindleSpeed::Rpm(0.0));
        Spindle { mode: SpindleMode::Stop, s: 0.0, surface_mm_s: 0.0, highest: None, sent }
    }

    /// Whether it turns.
    pub(crate) fn turns(&self) -> bool {
        self.mode != SpindleMode::Stop && self.s > 0.0
    }

    /// What makes mm/min of a feed: revolutions per minute under G95, infinite where they are not constant, else 1.
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
}

impl Spindle {
    /// Direction and speed of a job, 1/min.
    pub(crate) fn turn(&mut self, mode: SpindleMode, rpm: f64) {
        (self.mode, self.s, self.highest) = (mode, rpm, None);
    }
}

impl Translator {
    /// G96 with its highest speed, or G97: 0.
    pub(crate) fn spindle_mode(&mut self, highest: f64) -> Done {
        if highest > 0.0 {
            self.needs_spindle("G96", Blame::Block)?;
        }
        self.spindle.highest = (highest > 0.0).then_some(highest);
        Ok(())
    }

    /// M3 or M4.
    pub(crate) fn start_spindle(&mut self, mode: SpindleMode) -> Done {
        let word = if mode == SpindleMode::Clockwise { "M3" } else { "M4" };
        self.needs_spindle(word, Blame::Block)?;
        self.spindle.mode = mode;
        Ok(())
    }

    /// G93, G94 or G95.
    pub(crate) fn set_feed_mode(&mut self, mode: FeedMode) -> Done {
        if mode == FeedMode::PerRevolution {
            self.needs_spindle("feed per revolution", Blame::Block)?;
        }
        self.feed_mode = mode;
        Ok(())
    }

    /// Refuses a word that needs a spindle where there is none.
    fn needs_spindle(&self, word: &str, blame: Blame) -> Done {
        if !self.machine.spindle.is_none() {
            return Ok(());
        }
        let message = format!("{word}: {} has no spindle", self.machine.machine.name);
        Err(Problem::error("no-spindle", blame, message, "leave out S, M3, M4, G95 and G96"))
    }

    /// S.
    pub(crate) fn spindle_speed(&mut self, s: f64) -> Done {
        if s != 0.0 {
            self.needs_spindle("S", Blame::Word('S'))?;
        }
        if self.spindle.is_surface() {
            let per_minute = if self.frame.unit == 1.0 { METRE_MM } else { FOOT_MM };
            let mm_s = s * per_minute / 60.0;
            if !(0.0..=HIGHEST_SURFACE).contains(&mm_s) {
                let message = format!("S{} is no surface speed", short(s));
                let help = "give m/min, or ft/min under G20, such as G96 S180";
                return Err(Problem::error("bad-value", Blame::Word('S'), message, help));
            }
            self.spindle.surface_mm_s = mm_s;
        } else {
            self.rpm_in_range(s, Blame::Word('S'))?;
        }
        self.spindle.s = s;
        Ok(())
    }

    fn rpm_in_range(&self, rpm: f64, blame: Blame) -> Done {
        let highest = self.machine.spindle.max_rpm;
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

    /// Sends what has changed. S of G96 becomes 1/min where G97 leaves it in force, as in LinuxCNC.
    pub(crate) fn settle_spindle(&mut self, place: Place) {
        if !self.spindle.is_surface()
            && let Err(problem) = self.rpm_in_range(self.spindle.s, Blame::Block)
        {
            self.spindle.s = 0.0;
            self.report(place, *problem);
        }
        let wanted = self.wanted();
        if wanted != self.spindle.sent {
            self.spindle.sent = wanted;
            let (mode, speed) = wanted;
            self.push_alone(place.line, Code::Spindle { mode, speed });
        }
    }

    fn wanted(&self) -> (SpindleMode, SpindleSpeed) {
        let Spindle { mode, s, surface_mm_s, highest, .. } = self.spindle;
        let speed = match (mode, highest) {
            (SpindleMode::Stop, _) => SpindleSpeed::Rpm(0.0),
            (_, None) => SpindleSpeed::Rpm(s),
            (_, Some(highest)) => SpindleSpeed::Surface {
                mm_s: surface_mm_s,
                max_rpm: highest.min(self.machine.spindle.max_rpm),
                axis_mm: Position::from_mm(self.frame.machine(&[0.0; 6])[X]),
            },
        };
        (mode, speed)
    }
}
