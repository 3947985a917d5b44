//! Feeds that can be meant, but hardly are: a standing spindle, mm/min where mm/rev was meant and the other
//! way round, more than an axis can do. In: moves in feed, mm. Out: a warning each, once until F, its mode or
//! the spindle changes.

use gcode::canon::Units;
use gcode::problem::{Blame, short};
use gcode::{Place, Problem};
use machine::Kinematics;
use protocol::{Axis, Feed, PerAxis, Position};

use super::Translator;
use crate::modal::HIGHEST_FEED;

/// More mm in a turn than any tool of a lathe takes.
const MOST_PER_REV: f64 = 5.0;
/// Slower than any feed per minute, mm/min, and a move long enough that it matters, s.
const LEAST_PER_MIN: f64 = 2.0;
const LONG_S: f64 = 60.0;

/// What was said last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Doubts {
    feed: Option<Feed>,
    standing: bool,
}

impl Translator {
    /// A move in feed from where the axes rest.
    pub(super) fn doubt(&mut self, place: Place, to: &PerAxis<Position>, feed: Feed) {
        if let Some(problem) = self.standing() {
            self.output.report(place, *problem);
        }
        if self.doubts.feed != Some(feed)
            && let Some(problem) = self.unlikely(to, feed)
        {
            self.doubts.feed = Some(feed);
            self.output.report(place, *problem);
        }
    }

    /// A feed while the spindle stands. Where the part is known, what moves through it is looked at instead.
    fn standing(&mut self) -> Option<Box<Problem>> {
        let cuts = self.machine.general.kinematics != Kinematics::Positioner && self.part().is_none();
        let standing = cuts && !self.spindle.turns();
        let is_new = standing && !std::mem::replace(&mut self.doubts.standing, standing);
        self.doubts.standing = standing;
        let help = "start it before, as in S600 M3; what only moves the tool is a G0";
        is_new.then(|| {
            let message = "this moves in feed while the spindle stands";
            Problem::warning("spindle-not-turning", Blame::Block, message, help)
        })
    }

    fn unlikely(&self, to: &PerAxis<Position>, feed: Feed) -> Option<Box<Problem>> {
        let rest = self.points.axes_at_rest();
        let way = |axis: Axis| (to[axis.index()].mm() - rest[axis.index()].mm()).abs();
        let linear = Axis::ALL.into_iter().filter(|axis| Axis::METRIC[axis.index()]);
        let length = linear.map(way).map(|mm| mm * mm).sum::<f64>().sqrt();
        let units = self.modal.frame.units;
        let turns = self.spindle.turning().map(|(rpm, _)| rpm);
        let (value, per_min, per_rev) = match feed {
            Feed::PerMinute(value) => (value, Some(value), false),
            Feed::PerRevolution(value) => (value, turns.map(|rpm| value * rpm), true),
            Feed::Rapid => return None,
        };
        if value >= HIGHEST_FEED {
            return None; // an F that is none was refused
        }
        if per_rev && value > MOST_PER_REV {
            let made = per_min.map_or(String::new(), |feed| format!(", {}/min", units.length(feed)));
            let message = format!("F is {} in each turn of the spindle{made}", units.length(value));
            let help = "a feed per minute is G94 (G98 of FANUC); per revolution, 0.2 is usual";
            return Some(Problem::warning("unlikely-feed", Blame::Block, message, help));
        }
        let per_min = per_min?;
        let seconds = 60.0 * length / per_min;
        if !per_rev && per_min < LEAST_PER_MIN && seconds > LONG_S {
            let message = format!("at F{}/min this takes {} s", units.length(value), short(seconds.round()));
            let help = "a feed per revolution is G95 (G99 of FANUC)";
            return Some(Problem::warning("unlikely-feed", Blame::Block, message, help));
        }
        let share = |(axis, config): (Axis, &machine::AxisConfig)| {
            let used = way(axis) / length * per_min / 60.0 / config.velocity_mm_s;
            (used.is_finite() && Axis::METRIC[axis.index()]).then_some((axis, used))
        };
        let (axis, used) = self.machine.axes().filter_map(share).max_by(|a, b| a.1.total_cmp(&b.1))?;
        (used > 1.0 + 1e-9).then(|| {
            let name = axis.name().to_ascii_uppercase();
            // Rounded down, in the last place that a feed is written with.
            let step = if units == Units::Inch { 0.1 * units.mm() } else { 1.0 };
            let held = units.length((per_min / used / step).floor() * step);
            let message = format!(
                "{}/min is more than {name} can do: the feed is held to {held}/min",
                units.length(per_min)
            );
            let help = format!("give F for at most {held}/min (axis.{}.velocity_mm_s)", axis.name());
            Problem::warning("feed-clipped", Blame::Block, message, help)
        })
    }
}
