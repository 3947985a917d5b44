//! The spindle as a regulator sees it: counts in, angle, speed and acceleration out (M53).
//!
//! Counts are taken at the middle of their quantum. Observers run from the first measurement on and are never
//! reset at the index; the index only gives the origin of C. A spindle may turn already when it is first
//! seen: then its speed is taken from two counts 1/f_o apart. No pass is armed before 10/f_o
//! (`interpolator/src/pass.rs`).
//!
//! What is known of the spindle is as old as the bus and its encoder make it; the angle is that of the
//! present, by the speed observed.
//!
//! What repeats with every turn is taken off the counts before anything else (M130), so observers see an even
//! rotation. There are two. An axis on a lead has to be where the spindle is, at once: a fast observer leads
//! it, it follows every correction of the estimate beyond the rounding of counts, and as much of the ripple
//! as its mode lets through. An axis that only strokes is at rest at both ends, whatever the angle; on the
//! way, the noise of the encoder would be its largest error: a slow observer leads it, by the estimate alone.

use machine::Machine;
use motion::{Ripple, SpindleMotion, SpindleObserver};
use protocol::{Cycle, Measurement, measurement::middle_of};

use crate::{
    encoder::{Encoder, EncoderFault},
    state::Pass,
};

/// Two observers that agree so far see a steady spindle, a share.
const STEADY: f64 = 0.1;
/// A spindle has turned round that is so far back, a share of a turn and counts, and turns back faster than
/// this, 1/min and a share of the speed of the pass: a drive that stops a spindle swings through rest.
const ROUND_SHARE: f64 = 0.001;
const ROUND_COUNTS: f64 = 4.0;
const RESTING_RPM: f64 = 20.0;
const RESTING_SHARE: f64 = 0.05;
/// A ripple is followed up to this share of the mode of the axis, and left out from this one on: beyond it
/// the motor would have to go the other way, by a model that is not right to a tenth.
const FOLLOWED: f64 = 0.6;
const LEFT_OUT: f64 = 0.85;
/// More measurements in a row than this are never made up for: the observers begin anew behind them.
const MOST_MISSED: u64 = 50;

/// An index of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Index {
    /// Count latched at it.
    pub count: i64,
    /// First cycle that shows it.
    pub cycle: Cycle,
}

/// Tracks the spindle encoder. Angles in degrees, speeds in deg/s.
#[derive(Clone, Debug)]
pub struct Spindle {
    leading: SpindleObserver,
    /// What of its angle repeats with every turn.
    ripple: Ripple,
    /// The mode of the axis, Hz.
    mode_hz: f64,
    stroking: SpindleObserver,
    /// Control cycles from one look to the next of observers that know nothing of ripple; how long ago the
    /// last one was, s.
    plain_cycles: Option<u64>,
    looked_s: f64,
    cycle_s: f64,
    first_count: Option<i64>,
    opening_s: f64,
    /// Cycles until the observers get their speed from the first count and the present one.
    opening: u64,
    encoder: Encoder,
    degrees_per_count: f64,
    /// How old a count is, s.
    age_s: f64,
    /// Error of the lead up to which counts are corrected, mm.
    lost_counts_mm: f64,
    /// Count of the last measurement.
    count: i64,
    index: Option<Index>,
    index_number: u64,
    /// Cycles for which the encoder has not been believed; whether it is not, and whether it is again.
    blind: u64,
    coasts: bool,
    is_back: bool,
    /// What a drive brakes with, count/s², and cycles of a tick: behind a fault of the encoder in a tap.
    ramp: f64,
    tick: u64,
    /// Cycle in which such a fault was found, and the speed that the spindle is taken to have since, count/s.
    unseen: Option<(Cycle, f64)>,
    /// The farthest count of the pass in hand, in its direction; none without one.
    farthest: Option<i64>,
    /// How far back from there a spindle has turned round, count.
    round: i64,
    /// And how fast, a highest speed taken for rest, count/s.
    resting: f64,
}

impl Spindle {
    /// A spindle with the encoder and the observer of a machine file, for an axis with a mode, Hz.
    pub fn new(machine: &Machine, mode_hz: f64) -> Spindle {
        let (config, cycle_s) = (&machine.spindle, machine.general.cycle_s);
        let opening = (1.0 / (config.slowest_observer_hz() * cycle_s)).ceil().max(1.0);
        let period_s = f64::from(config.plain_observer_cycles.unwrap_or(1)) * cycle_s;
        Spindle {
            leading: SpindleObserver::of_counts(config.observer_hz, period_s),
            ripple: Ripple::new(machine.spindle_counts(), cycle_s),
            mode_hz,
            stroking: SpindleObserver::new(config.stroke_observer_hz, period_s),
            plain_cycles: config.plain_observer_cycles.map(u64::from),
            looked_s: 0.0,
            cycle_s,
            first_count: None,
            opening_s: opening * cycle_s,
            opening: opening as u64,
            encoder: Encoder::new(machine),
            degrees_per_count: 360.0 / machine.spindle_counts(),
            age_s: machine.bus.input_s(cycle_s) + config.encoder_delay_s,
            lost_counts_mm: machine.threading.lost_counts_um / 1000.0,
            count: 0,
            index: None,
            index_number: 0,
            blind: 0,
            coasts: false,
            is_back: false,
            ramp: config.ramp_rpm_s / 60.0 * machine.spindle_counts(),
            tick: machine.cycles_per_tick(),
            unseen: None,
            farthest: None,
            round: (ROUND_SHARE * machine.spindle_counts()).max(ROUND_COUNTS) as i64,
            resting: RESTING_RPM / 60.0 * machine.spindle_counts(),
        }
    }

    /// Takes the measurement of one control cycle, which comes `missed` cycles late, and the pass in hand. An
    /// encoder that cannot be believed is not asked any more: the spindle is taken to turn on at its speed.
    pub fn update(&mut self, measurement: &Measurement, missed: u64, pass: Option<&Pass>) {
        for _ in 0..missed.min(MOST_MISSED) {
            self.leading.skip();
            self.stroking.skip();
            self.ripple.skip();
        }
        if missed > 0 {
            self.encoder.skip();
        }
        let lead_mm = pass.map_or(0.0, |pass| pass.law.most_lead_mm());
        self.encoder.update(measurement, self.tolerated(lead_mm), pass.is_some());
        if self.encoder.is_blind() {
            (self.blind, self.coasts) = (self.blind + 1, true);
            let taps = pass.is_some_and(Pass::returns);
            return if taps { self.brakes(measurement.cycle) } else { self.coast() };
        }
        self.unseen = None;
        self.count = self.encoder.count(measurement);
        let angle = self.encoder.angle(measurement);
        // Only a spindle that has jammed is believed again: it stands.
        self.is_back = std::mem::take(&mut self.coasts);
        if self.is_back {
            self.start(angle, 0.0);
        }
        if missed > MOST_MISSED {
            self.start(angle, self.last_speed());
            self.looked_s = 0.0;
        } else {
            self.look(measurement.cycle, angle);
        }
        self.farthest = pass.map(|pass| {
            let ahead = self.ahead(pass);
            self.farthest.map_or(ahead, |farthest| farthest.max(ahead))
        });
        self.open(self.count);
        if measurement.index_number != self.index_number {
            let count = self.encoder.index_count(measurement);
            self.index = Some(Index { count, cycle: measurement.index_cycle });
            self.index_number = measurement.index_number;
        }
    }

    /// The observers look at the angle of a cycle.
    fn look(&mut self, cycle: Cycle, angle: f64) {
        let even = match self.plain_cycles {
            None => self.ripple.update(angle),
            Some(cycles) if cycle.0.is_multiple_of(cycles) => angle,
            Some(_) => {
                self.looked_s += self.cycle_s;
                return;
            }
        };
        self.leading.update(even);
        self.stroking.update(even);
        self.looked_s = 0.0;
    }

    /// The observers begin anew.
    fn start(&mut self, angle: f64, speed: f64) {
        self.leading.start(angle, speed);
        self.stroking.start(angle, speed);
        self.ripple.start(angle, speed);
    }

    /// An even rotation with as much of the ripple as an axis can follow.
    fn upon(&self, even: &SpindleMotion) -> SpindleMotion {
        let mode_hz = self.mode_hz;
        self.ripple.upon(even, |hz| ((LEFT_OUT - hz / mode_hz) / (LEFT_OUT - FOLLOWED)).clamp(0.0, 1.0))
    }

    /// Counts that may be lost or gained within ten turns.
    fn tolerated(&self, lead_mm: f64) -> i64 {
        match lead_mm {
            0.0 => self.encoder.margin(),
            _ => (self.lost_counts_mm / (lead_mm.abs() / 360.0 * self.degrees_per_count)) as i64,
        }
    }

    /// The slow observer knows the speed best: the ripple of the spindle hardly moves it; the fast one, if it
    /// is being stopped.
    fn last_speed(&self) -> f64 {
        let (steady, fast) = (self.stroking.at(0.0).speed, self.leading.at(0.0).speed);
        if (fast - steady).abs() > STEADY * steady.abs() { fast } else { steady }
    }

    /// A tap has no way out beside its helix. So the interpolator, which hears of the fault at its next tick,
    /// stops the spindle a tick later, and the angle is taken to be that of its ramp (M224).
    fn brakes(&mut self, cycle: Cycle) {
        let (found, mut speed) = self.unseen.unwrap_or_else(|| (cycle, self.last_speed()));
        let heard = (found.0 / self.tick + 1) * self.tick;
        if cycle.0 > heard + self.tick {
            let step = self.ramp * self.cycle_s;
            speed -= speed.clamp(-step, step);
        }
        self.unseen = Some((found, speed));
        self.turn_on(speed);
    }

    /// Whether a spindle that nobody sees is taken to have come to rest.
    pub fn has_coasted(&self) -> bool {
        self.unseen.is_some_and(|(_, speed)| speed == 0.0)
    }

    fn coast(&mut self) {
        self.turn_on(self.last_speed());
    }

    /// A cycle without a count, at this speed, count/s.
    fn turn_on(&mut self, speed: f64) {
        self.leading.coast(speed);
        self.stroking.coast(speed);
        self.ripple.skip();
    }

    /// Counts lost or gained that were corrected so far.
    pub fn corrected(&self) -> u32 {
        self.encoder.corrected()
    }

    /// Whether the spindle has stood for so many cycles.
    pub fn stands_for(&self, cycles: u64) -> bool {
        !self.encoder.is_blind() && self.encoder.still() >= cycles
    }

    /// The count in the direction of a pass.
    fn ahead(&self, pass: &Pass) -> i64 {
        if pass.direction < 0.0 { -self.count } else { self.count }
    }

    /// Whether it turns against the direction of the pass in hand (M106).
    pub fn turns_back(&self, pass: &Pass) -> bool {
        let round = self.farthest.is_some_and(|farthest| farthest - self.ahead(pass) > self.round);
        let slow = self.resting.max(RESTING_SHARE * pass.programmed_deg_s / self.degrees_per_count);
        round && self.leading.at(0.0).speed * pass.direction < -slow
    }

    /// Whether its angle is known again in this cycle, and it stands.
    pub fn is_back(&self) -> bool {
        self.is_back
    }

    /// Whether nobody has known its angle for so many cycles.
    pub fn is_lost_for(&self, cycles: u64) -> bool {
        self.blind >= cycles
    }

    /// Gives the observers their speed at the end of the opening.
    fn open(&mut self, count: i64) {
        let Some(first) = self.first_count else {
            self.first_count = Some(count);
            return;
        };
        if self.opening == 1 {
            let speed = count.saturating_sub(first) as f64 / self.opening_s;
            self.start(middle_of(count), speed);
        }
        self.opening = self.opening.saturating_sub(1);
    }

    /// What is wrong with the encoder, if anything.
    pub fn fault(&self) -> Option<EncoderFault> {
        self.encoder.fault()
    }

    /// The last index, if there was one.
    pub fn index(&self) -> Option<Index> {
        self.index
    }

    /// Angle since the index of a pass, speed and acceleration as estimated, at `lead_s` after the present,
    /// positive in the direction of the pass.
    pub fn since(&self, pass: &Pass, lead_s: f64) -> SpindleMotion {
        let lead_s = self.looked_s + self.age_s + lead_s;
        let motion = match pass.law.is_led() {
            false => self.stroking.at(lead_s),
            true => self.upon(&self.leading.at(lead_s)),
        };
        // A way out begins from this: the jerk of a ripple is not that of the axis.
        self.in_degrees(SpindleMotion { jerk: 0.0, snap: 0.0, ..motion }, pass)
    }

    /// The same as an axis is fed forward: on a lead with the corrections of the estimate, too.
    pub fn followed_since(&self, pass: &Pass, lead_s: f64) -> SpindleMotion {
        if !pass.law.is_led() {
            return self.since(pass, lead_s);
        }
        self.in_degrees(self.upon(&self.leading.following(self.looked_s + self.age_s + lead_s)), pass)
    }

    /// Angle since the index of a pass by the count of the last measurement, degrees: the same on every axis.
    pub fn counted_since(&self, pass: &Pass) -> f64 {
        (self.count - pass.index_count) as f64 * pass.direction * self.degrees_per_count
    }

    fn in_degrees(&self, motion: SpindleMotion, pass: &Pass) -> SpindleMotion {
        let scale = pass.direction * self.degrees_per_count;
        SpindleMotion {
            angle: (motion.angle - middle_of(pass.index_count)) * scale,
            speed: motion.speed * scale,
            acceleration: motion.acceleration * scale,
            jerk: motion.jerk * scale,
            snap: motion.snap * scale,
        }
    }

    /// A count of the encoder, degrees.
    pub fn degrees_per_count(&self) -> f64 {
        self.degrees_per_count
    }

    /// Speed by the slow observer, 1/min, positive clockwise.
    pub fn steady_rpm(&self) -> f64 {
        self.stroking.at(0.0).speed * self.degrees_per_count / 6.0
    }

    /// Observed speed, 1/min, positive clockwise.
    pub fn rpm(&self) -> f64 {
        self.leading.at(0.0).speed * self.degrees_per_count / 6.0
    }
}

#[cfg(test)]
mod tests {
    use machine::Machine;
    use protocol::Cycle;

    use super::*;

    /// Behind a gap of any length the observers are where an even spindle is, whatever is being made up for.
    #[test]
    fn an_angle_is_known_behind_so_many_missing_measurements() {
        let machine = Machine::plain();
        let per_cycle = 1392.0 / 60.0 * machine.spindle_counts() * machine.general.cycle_s;
        let turned = |cycle: u64| (per_cycle * cycle as f64).floor() as i64;
        let mut spindle = Spindle::new(&machine, 100.0);
        let mut cycle = 0;
        let mut sees = |spindle: &mut Spindle, missed: u64| {
            cycle += 1 + missed;
            let (now, spindle_count) = (Cycle(cycle), turned(cycle));
            let measurement = Measurement { cycle: now, spindle_count, ..Measurement::default() };
            spindle.update(&measurement, missed, None);
            per_cycle * cycle as f64
        };
        for _ in 0..4000 {
            sees(&mut spindle, 0);
        }
        for missed in (0..120).chain([MOST_MISSED, MOST_MISSED + 1, 1000]) {
            let angle = sees(&mut spindle, missed);
            for observer in [&spindle.leading, &spindle.stroking] {
                let now = observer.at(0.0);
                let (off, faster) =
                    (now.angle - angle, now.speed * machine.general.cycle_s / per_cycle - 1.0);
                // A count, and the noise of counts.
                assert!(
                    off.abs() < 1.5 && faster.abs() < 1e-3,
                    "{missed} missed: {off} counts, {faster} of its speed"
                );
            }
            for _ in 0..400 {
                sees(&mut spindle, 0);
            }
        }
    }
}
