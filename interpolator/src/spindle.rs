//! The spindle as the interpolator commands and watches it: programmed speed, override, ceiling, at speed.
//! In: direction and speed, the commanded X of every tick, measurements. Out: speeds in 1/min, signed:
//! positive clockwise (M3).
//!
//! At constant surface speed (G96) the speed follows the commanded X. Meanwhile the measured one lags; the
//! band that counts as "at speed" is wider by n′/2πf then, with f the bandwidth of the watch and n′ the rate
//! of the commanded speed, no more of it than the drive's ramp. A speed that has run away from the ramp, as
//! after a rapid towards the axis, is not at speed before it has come there.

use std::f64::consts::TAU;

use machine::{Machine, SpindleConfig};
use motion::SpindleObserver;
use protocol::{Feed, Measurement, Position, SpindleMode, SpindleSpeed, measurement::middle_of};

const WATCH_HZ: f64 = SpindleConfig::WATCH_HZ;
const STANDSTILL_RPM: f64 = SpindleConfig::STANDSTILL_RPM;

/// The spindle.
#[derive(Clone, Debug)]
pub struct Spindle {
    observer: SpindleObserver,
    rpm_per_count_s: f64,
    tick_s: f64,
    ramp_rpm_s: f64,
    mode: SpindleMode,
    speed: SpindleSpeed,
    /// Commanded X.
    x: Position,
    /// Programmed speed at X, 1/min, ≥ 0.
    programmed: f64,
    /// How fast X changes it, 1/min per s.
    rate: f64,
    override_pct: f64,
    override_max_pct: f64,
    at_speed_share: f64,
    ceiling_pct: f64,
    request_pct: f64,
    clamped: u32,
}

impl Spindle {
    /// The spindle of a machine file, standing.
    pub fn new(machine: &Machine) -> Spindle {
        Spindle {
            observer: SpindleObserver::new(WATCH_HZ, machine.general.interpolator_cycle_s),
            rpm_per_count_s: 60.0 / machine.spindle_counts(),
            tick_s: machine.general.interpolator_cycle_s,
            ramp_rpm_s: machine.spindle.ramp_rpm_s,
            mode: SpindleMode::Stop,
            speed: SpindleSpeed::Rpm(0.0),
            x: Position(0),
            programmed: 0.0,
            rate: 0.0,
            override_pct: 100.0,
            override_max_pct: machine.spindle.override_max_pct,
            at_speed_share: machine.spindle.at_speed_pct / 100.0,
            ceiling_pct: f64::INFINITY,
            request_pct: 100.0,
            clamped: 0,
        }
    }

    /// The highest override that the pass in hand allows, per cent; infinite without one.
    pub fn set_ceiling(&mut self, pct: f64) {
        self.ceiling_pct = pct;
        self.grant();
    }

    /// Override in force: what was asked for, as far as it is allowed.
    fn grant(&mut self) {
        self.override_pct = self.request_pct.min(self.ceiling_pct.min(self.override_max_pct));
    }

    /// Takes a measurement and the panel's override.
    pub fn update(&mut self, measurement: &Measurement) {
        self.observer.update(middle_of(measurement.spindle_count));
        let request = measurement.panel.spindle_override_pct;
        let request = if request.is_finite() { request.max(0.0) } else { self.request_pct };
        let before = (self.request_pct, self.override_pct);
        self.request_pct = request;
        self.grant();
        let clamped = self.override_pct < request;
        self.clamped += u32::from(clamped && (request, self.override_pct) != before);
    }

    /// Programs direction and speed.
    pub fn program(&mut self, mode: SpindleMode, speed: SpindleSpeed) {
        (self.mode, self.speed) = (mode, speed);
        (self.programmed, self.rate) = (speed.rpm(self.x), 0.0);
    }

    /// Takes the commanded X, once per tick: the speed follows it under G96.
    pub fn at_x(&mut self, x: Position) {
        let before = self.programmed;
        (self.x, self.programmed) = (x, self.speed.rpm(x));
        self.rate = (self.programmed - before) / self.tick_s;
    }

    /// Speed for the drive.
    pub fn commanded(&self) -> f64 {
        self.mode.sign() * self.programmed * self.override_pct / 100.0
    }

    /// Programmed speed without override.
    pub fn programmed(&self) -> f64 {
        self.mode.sign() * self.programmed
    }

    /// Observed speed.
    pub fn observed(&self) -> f64 {
        self.observer.at(0.0).speed * self.rpm_per_count_s
    }

    /// Whether the observed speed lies in the band around the commanded one. A spindle that the override
    /// holds at 0 is not at speed: nothing may feed into a part that stands.
    pub fn at_speed(&self) -> bool {
        let commanded = self.commanded();
        if self.held() {
            return false;
        }
        // The watch sees single counts; half the speed it must be, or a slow spindle would be at speed
        // standing.
        let least = STANDSTILL_RPM.min(0.5 * commanded.abs());
        let band = (self.at_speed_share * commanded.abs()).max(least);
        let rate = (self.rate * self.override_pct / 100.0).abs().min(self.ramp_rpm_s);
        (self.observed() - commanded).abs() <= band + rate / (TAU * WATCH_HZ)
    }

    /// Whether it shall turn, and the override holds it at 0.
    pub fn held(&self) -> bool {
        self.programmed() != 0.0 && self.commanded() == 0.0
    }

    /// Whether it shall turn and hardly does.
    pub fn stalls(&self) -> bool {
        self.observed().abs() < 0.1 * self.commanded().abs()
    }

    /// Whether a move may begin at a feed: one that cuts waits for the spindle.
    pub fn lets(&self, feed: Feed) -> bool {
        let least = (0.5 * self.commanded().abs()).min(1.0);
        let turns = !matches!(feed, Feed::PerRevolution(_)) || self.observed().abs() >= least;
        feed == Feed::Rapid || self.at_speed() && turns
    }

    /// Whether it stands.
    pub fn stands(&self) -> bool {
        self.observed().abs() <= STANDSTILL_RPM
    }

    /// Override in force, per cent.
    pub fn override_pct(&self) -> f64 {
        self.override_pct
    }

    /// How often a request was clamped.
    pub fn clamped(&self) -> u32 {
        self.clamped
    }
}

#[cfg(test)]
mod tests {
    use protocol::{Panel, PerAxis};

    use super::*;

    /// 100 m/min about X 2 mm, at most 1200 1/min.
    fn surface() -> SpindleSpeed {
        let axis_mm = Position::from_mm(2.0);
        SpindleSpeed::Surface { mm_s: 100_000.0 / 60.0, max_rpm: 1200.0, axis_mm }
    }

    fn spindle() -> Spindle {
        Spindle::new(&Machine::default())
    }

    /// Lets the measured speed go from `from` to `to` (1/min) within some ticks; X goes with `x`, told the
    /// tick.
    fn turn(spindle: &mut Spindle, count: &mut f64, ticks: u32, rpm: impl Fn(u32) -> f64) {
        for tick in 0..ticks {
            *count += rpm(tick) / spindle.rpm_per_count_s * spindle.tick_s;
            let panel = Panel { spindle_override_pct: 100.0, ..Panel::default() };
            let axes = PerAxis::default();
            let spindle_count = count.floor() as i64;
            spindle.update(&Measurement { spindle_count, panel, axes, ..Measurement::default() });
        }
    }

    fn x_for(rpm: f64) -> Position {
        Position::from_mm(2.0 + 100_000.0 / (TAU * rpm))
    }

    #[test]
    fn surface_speed_follows_x_up_to_the_highest() {
        let mut spindle = spindle();
        spindle.program(SpindleMode::Counterclockwise, surface());
        for (x, rpm) in [(x_for(300.0), -300.0), (x_for(900.0), -900.0), (Position::from_mm(2.0), -1200.0)] {
            spindle.at_x(x);
            assert!((spindle.commanded() - rpm).abs() < 1e-6, "{}", spindle.commanded());
        }
        let beyond = 2.0 * 2.0 - x_for(300.0).mm();
        spindle.at_x(Position::from_mm(beyond));
        assert!((spindle.commanded() + 300.0).abs() < 1e-6, "behind the axis it is the same");
        spindle.program(SpindleMode::Clockwise, SpindleSpeed::Rpm(500.0));
        spindle.at_x(x_for(900.0));
        assert_eq!(spindle.commanded(), 500.0);
        let still = SpindleSpeed::Surface { mm_s: 0.0, max_rpm: 1200.0, axis_mm: Position(0) };
        spindle.program(SpindleMode::Clockwise, still);
        spindle.at_x(Position(0));
        assert_eq!(spindle.commanded(), 0.0);
    }

    #[test]
    fn at_speed_is_judged_against_the_speed_of_now() {
        let (mut spindle, mut count) = (spindle(), 0.0);
        spindle.program(SpindleMode::Clockwise, surface());
        spindle.at_x(x_for(400.0));
        assert!(!spindle.at_speed(), "it still stands");
        turn(&mut spindle, &mut count, 1000, |_| 400.0);
        assert!(spindle.at_speed());
        // A step of X, as after a rapid: the next tick commands a speed that the spindle does not have.
        for _ in 0..2 {
            spindle.at_x(x_for(800.0));
        }
        assert!(!spindle.at_speed());
        turn(&mut spindle, &mut count, 1000, |_| 800.0);
        assert!(spindle.at_speed());
    }

    #[test]
    fn a_slow_spindle_is_at_speed_when_it_turns_and_does_not_stall() {
        for sign in [1.0, -1.0] {
            let (mut spindle, mut count) = (spindle(), 0.0);
            let mode = if sign > 0.0 { SpindleMode::Clockwise } else { SpindleMode::Counterclockwise };
            spindle.program(mode, SpindleSpeed::Rpm(0.2));
            turn(&mut spindle, &mut count, 1000, |_| 0.0);
            assert!(!spindle.at_speed() && spindle.stalls(), "it stands");
            turn(&mut spindle, &mut count, 2000, |_| -0.2 * sign);
            assert!(!spindle.at_speed(), "the other way");
            turn(&mut spindle, &mut count, 2000, |_| 0.2 * sign);
            for _ in 0..2000 {
                turn(&mut spindle, &mut count, 1, |_| 0.2 * sign);
                assert!(spindle.at_speed() && !spindle.stalls(), "{}", spindle.observed());
            }
        }
    }

    #[test]
    fn what_lags_behind_a_facing_cut_is_at_speed() {
        let (mut spindle, mut count) = (spindle(), 0.0);
        let (rate, lag_s) = (300.0, 0.02); // 1/min per s; the measured speed comes 20 ms late
        spindle.program(SpindleMode::Clockwise, surface());
        spindle.at_x(x_for(400.0));
        turn(&mut spindle, &mut count, 1000, |_| 400.0);
        let mut without = 0;
        for tick in 1..500 {
            let at = |t: f64| 400.0 + rate * t.max(0.0);
            let t = f64::from(tick) * spindle.tick_s;
            spindle.at_x(x_for(at(t)));
            turn(&mut spindle, &mut count, 1, |_| at(t - lag_s));
            assert!(spindle.at_speed(), "{} at {}", spindle.observed(), spindle.commanded());
            without += u32::from((spindle.observed() - spindle.commanded()).abs() > STANDSTILL_RPM);
        }
        assert!(without > 0, "it does lag");
    }
}
