//! How time on the machine keeps to the clock of the wall. In: once a control cycle, before it is over. Out:
//! nothing but a wait: no number of a run depends on it.
//!
//! In real time a cycle lasts until its moment has come, whoever has answered or not; a process that has
//! plant and regulators and was held up counts the cycles that it has missed. At a pace it lasts until its
//! moment has come *and* everybody has answered, as in lock step: the machine does the same, bit for bit, and
//! somebody can watch it.

use std::time::Duration;

use super::Clock;
use crate::ipc::time::{Moment, sleep_until};

/// What a machine at a pace has lost against the wall is made up for by shorter waits as long as it is no
/// more than this; what is more is given up, so that nobody sees it race.
const CATCH_UP: Duration = Duration::from_millis(20);

/// A process that was held up for longer than this has missed so much and no more: a computer that slept has
/// not moved its machine meanwhile.
const STANDS: Duration = Duration::from_secs(2);

/// What a process in real time has missed because it was held up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Missed {
    /// The answers of this cycle came after its end.
    pub answer: bool,
    /// So many cycles behind it have ended before they began: nothing was measured in them, nothing answered.
    pub cycles: u64,
    /// How long after its moment the process woke.
    pub woke_late: Option<Duration>,
    /// How long after the moment at which this cycle began it went to sleep, where the moments of all cycles
    /// are fixed.
    pub worked: Option<Duration>,
}

/// How many whole cycles a time has.
fn cycles_in(time: Duration, period: Duration) -> u64 {
    (time.min(STANDS).as_nanos() / period.as_nanos().max(1)) as u64
}

/// Time on the machine for each second on the wall: [`Pace::SLOWEST`] to [`Pace::FASTEST`]; or as fast as the
/// computer can.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace(Option<f64>);

impl Pace {
    /// As fast as the computer can.
    pub const MAX: Pace = Pace(None);
    /// As fast as the machine would be.
    pub const ONE: Pace = Pace(Some(1.0));
    /// The slowest. A cycle is still short beside the patience of whoever watches over the processes.
    pub const SLOWEST: f64 = 0.05;
    /// The fastest that has a number.
    pub const FASTEST: f64 = 1000.0;

    /// Whether anything is waited for.
    pub fn waits(self) -> bool {
        self.0.is_some()
    }

    /// How long a cycle of the machine lasts on the wall at least, s, if it has to last.
    fn period(self, cycle_s: f64) -> Option<Duration> {
        self.0.map(|pace| Duration::from_secs_f64(cycle_s / pace))
    }
}

impl std::fmt::Display for Pace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            None => f.write_str("max"),
            Some(pace) => pace.fmt(f),
        }
    }
}

impl std::str::FromStr for Pace {
    type Err = String;

    fn from_str(text: &str) -> Result<Pace, String> {
        match text.parse::<f64>() {
            _ if text == "max" => Ok(Pace::MAX),
            Ok(pace) if (Pace::SLOWEST..=Pace::FASTEST).contains(&pace) => Ok(Pace(Some(pace))),
            _ => Err(format!(
                "seconds on the machine for each second on the wall, {} to {}, or max",
                Pace::SLOWEST,
                Pace::FASTEST
            )),
        }
    }
}

/// The beat of a machine.
#[derive(Clone, Copy, Debug)]
pub struct Beat {
    rule: Rule,
    next: Moment,
}

#[derive(Clone, Copy, Debug)]
enum Rule {
    /// Nobody waits for the wall.
    Free,
    /// The moments of all cycles are fixed; those that have passed meanwhile have been missed.
    Kept(Duration),
    /// The next cycle begins when its moment has come, and lasts half of its length at least.
    Real(Duration),
    /// The next cycle does not begin before its moment has come.
    Paced(Duration),
}

impl Beat {
    /// Of a plant in one process with its regulators, in real time: a process that was held up has missed
    /// cycles, as the world has not stood meanwhile.
    pub fn kept(cycle_s: f64) -> Beat {
        let period = Duration::from_secs_f64(cycle_s);
        Beat { rule: Rule::Kept(period), next: Moment::now().after(period) }
    }

    /// Of a machine whose control cycle is so long, s; it begins now.
    pub fn new(clock: Clock, pace: Pace, cycle_s: f64) -> Beat {
        let rule = match (clock, pace.period(cycle_s)) {
            (Clock::Real, _) => Rule::Real(Duration::from_secs_f64(cycle_s)),
            (Clock::Virtual, Some(period)) => Rule::Paced(period),
            (Clock::Virtual, None) => Rule::Free,
        };
        let first = match rule {
            Rule::Free => Duration::ZERO,
            Rule::Real(period) | Rule::Paced(period) | Rule::Kept(period) => period,
        };
        Beat { rule, next: Moment::now().after(first) }
    }

    /// Sleeps to the end of the cycle, which begins another one; says what was missed.
    pub fn wait(&mut self) -> Missed {
        if matches!(self.rule, Rule::Free) {
            return Missed::default();
        }
        let slept = Moment::now();
        sleep_until(self.next);
        let now = Moment::now();
        let woke_late = self.is_real().then(|| now.since(self.next));
        let Rule::Kept(period) = self.rule else {
            self.next = self.after(now);
            return Missed { woke_late, ..Missed::default() };
        };
        let missed = Missed {
            answer: slept >= self.next,
            cycles: cycles_in(now.since(self.next), period),
            woke_late,
            worked: Some(slept.since(self.next.before(period))),
        };
        self.next = self.after(now);
        missed
    }

    /// When the next cycle is over, if this one is so now.
    fn after(&self, now: Moment) -> Moment {
        match self.rule {
            Rule::Free => self.next,
            // If this process was itself held up, the regulators still need half of a cycle.
            Rule::Real(period) => self.next.after(period).max(now.after(period / 2)),
            Rule::Paced(period) if now > self.next.after(CATCH_UP) => now.after(period),
            Rule::Paced(period) => self.next.after(period),
            Rule::Kept(period) if now.since(self.next) > STANDS => now.after(period),
            Rule::Kept(period) => {
                let missed = cycles_in(now.since(self.next), period);
                self.next.after(period * (1 + missed as u32))
            }
        }
    }

    /// Whether cycles end by the clock alone.
    pub fn is_real(&self) -> bool {
        matches!(self.rule, Rule::Real(_) | Rule::Kept(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_is_read_as_it_is_written() {
        for text in ["max", "1", "0.2", "5", "0.05", "1000"] {
            assert_eq!(text.parse::<Pace>().map(|pace| pace.to_string()), Ok(text.to_owned()));
        }
        for text in ["", "0", "-1", "0.049", "1001", "inf", "NaN", "MAX", "1x", "1,5"] {
            let refused = text.parse::<Pace>().expect_err(text);
            assert!(refused.contains("0.05 to 1000, or max"), "{refused}");
        }
    }

    /// Whole cycles are missed, the moments of the others stay where they are, however long it was held up;
    /// and one that slept for an hour has missed two seconds.
    #[test]
    fn what_a_process_was_held_up_for_is_counted_in_whole_cycles() {
        let (mut beat, period) = (Beat::kept(0.0005), Duration::from_micros(500));
        let begun = beat.next;
        for held_us in [0, 1, 499, 500, 501, 1000, 1999, 2000, 50_000, 1_999_999] {
            let missed = held_us / 500;
            assert_eq!(cycles_in(Duration::from_micros(held_us), period), missed, "{held_us} µs");
            let next = beat.after(begun.after(Duration::from_micros(held_us)));
            assert_eq!(next, begun.after(period * (missed as u32 + 1)), "{held_us} µs");
        }
        let hour = STANDS * 1800;
        let slept = begun.after(hour);
        assert_eq!(cycles_in(hour, period), 4000);
        assert_eq!(beat.after(slept), slept.after(period));
        // And on the wall.
        std::thread::sleep(period * 7);
        let at = Moment::now();
        let missed = beat.wait();
        assert!(missed.answer && missed.cycles >= cycles_in(at.since(begun), period), "{missed:?}");
        assert!(beat.next > at && beat.is_real());
    }

    fn beat(pace: &str, cycle_s: f64) -> Beat {
        Beat::new(Clock::Virtual, pace.parse().expect("a pace"), cycle_s)
    }

    /// However late a cycle ends, and at any pace, the moments of the cycles are a period apart at least,
    /// but for what is made up for.
    #[test]
    fn what_was_lost_for_long_is_not_made_up_for() {
        for (pace, period_us) in [("1", 500), ("0.2", 2500), ("5", 100), ("50", 10)] {
            let (beat, period) = (beat(pace, 0.0005), Duration::from_micros(period_us));
            for late in [Duration::ZERO, period, CATCH_UP] {
                assert_eq!(beat.after(beat.next.after(late)), beat.next.after(period), "{pace}, {late:?}");
            }
            for late in [CATCH_UP + Duration::from_nanos(1), CATCH_UP * 5, CATCH_UP * 100_000] {
                let now = beat.next.after(late);
                assert_eq!(beat.after(now), now.after(period), "{pace}, {late:?}: it begins anew");
            }
        }
    }

    #[test]
    fn cycles_at_a_pace_take_their_time_on_the_wall() {
        let mut paced = beat("2", 0.004);
        let begun = paced.next;
        assert!((0..10).all(|_| paced.wait() == Missed::default()), "who waits for all misses nothing");
        assert!(begun.elapsed() >= Duration::from_micros(2000) * 9, "nine periods behind the first");
        let mut free = beat("max", 1e9);
        assert!((0..1000).all(|_| free.wait() == Missed::default()));
        assert!(!free.is_real() && Beat::new(Clock::Real, Pace::MAX, 1.0).is_real());
    }
}
