//! The spindle as the interpolator commands and watches it: programmed speed, override, ceiling, at speed.
//! In: direction and speed, the commanded X of every tick, measurements. Out: speeds in 1/min, signed:
//! positive clockwise (M3).
//!
//! At constant surface speed (G96) the speed follows the commanded X. Meanwhile the measured one lags; the
//! band that counts as "at speed" is wider by n′/2πf then, with f the bandwidth of the watch and n′ the rate
//! of the commanded speed, no more of it than the drive's ramp. A speed that has run away from the ramp, as
//! after a rapid towards the axis, is not at speed before it has come there.
//!
//! No spindle is commanded above its highest speed: an override that would ask for more is clamped. While it
//! leads a pass, the override is eased (M135).

mod ease;
mod rest;
mod watch;

use std::f64::consts::TAU;

use machine::{Machine, SpeedLaw, SpindleConfig};
use motion::SpindleObserver;
use protocol::{
    Fault, Feed, Measurement, Position, SpindleMode, SpindleSpeed, Variation, measurement::middle_of,
};

use ease::Ease;
use watch::Watch;

const WATCH_HZ: f64 = SpindleConfig::WATCH_HZ;
const STANDSTILL_RPM: f64 = SpindleConfig::STANDSTILL_RPM;

/// A spindle that stands has not moved by more than a count for so many ticks that a count in them is no more
/// than this speed, 1/min; so many ticks are remembered.
const COUNT_RPM: f64 = 8.0;
const KEPT_TICKS: usize = 64;

/// The spindle.
#[derive(Clone, Debug)]
pub struct Spindle {
    observer: SpindleObserver,
    /// Counts of the last ticks, the present one last.
    counts: [i64; KEPT_TICKS + 1],
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
    /// What was asked for, as far as it is allowed; the same eased, while it leads a pass.
    granted_pct: f64,
    ease: Ease,
    leads: bool,
    /// A tool leaves a pass: the speed commanded stays what it is.
    kept: bool,
    /// What a tap asks for instead, 1/min, signed.
    tap_rpm: Option<f64>,
    /// How the speed is varied in the pass that is cut, and how far the spindle was told to turn since that
    /// began, turns.
    varied: Option<(SpeedLaw, f64)>,
    override_max_pct: f64,
    at_speed_share: f64,
    ceiling_pct: f64,
    request_pct: f64,
    /// What the guard of a thread leaves of the override, a share.
    guarded: f64,
    max_rpm: f64,
    /// Whether the override is held below what was asked for, and how often that has begun.
    clamps: bool,
    clamped: u32,
    /// How long it has been at the speed programmed, and how far it has turned then, s and turns.
    even: (f64, f64),
    watch: Watch,
}

impl Spindle {
    /// The spindle of a machine file, standing.
    pub fn new(machine: &Machine) -> Spindle {
        Spindle {
            observer: SpindleObserver::new(WATCH_HZ, machine.general.interpolator_cycle_s),
            counts: [0; KEPT_TICKS + 1],
            rpm_per_count_s: 60.0 / machine.spindle_counts(),
            tick_s: machine.general.interpolator_cycle_s,
            ramp_rpm_s: machine.spindle.ramp_rpm_s,
            mode: SpindleMode::Stop,
            speed: SpindleSpeed::Rpm(0.0),
            x: Position(0),
            programmed: 0.0,
            rate: 0.0,
            granted_pct: 100.0,
            ease: Ease::new(machine.general.interpolator_cycle_s),
            leads: false,
            kept: false,
            tap_rpm: None,
            varied: None,
            override_max_pct: machine.spindle.override_max_pct,
            at_speed_share: machine.spindle.at_speed_pct / 100.0,
            ceiling_pct: f64::INFINITY,
            request_pct: 100.0,
            guarded: 1.0,
            max_rpm: machine.spindle.max_rpm,
            clamps: false,
            clamped: 0,
            even: (0.0, 0.0),
            watch: Watch::new(machine),
        }
    }

    /// The highest override that the pass in hand allows, per cent; infinite without one.
    pub fn set_ceiling(&mut self, pct: f64) {
        self.ceiling_pct = pct;
        self.grant();
    }

    /// What the guard of a thread leaves of the override, a share; while a tool leaves, what it left.
    pub(crate) fn guard(&mut self, share: f64) {
        if self.kept {
            return;
        }
        self.clamped += u32::from(share < 1.0 && self.guarded == 1.0);
        self.guarded = share;
        self.grant();
    }

    /// A pass is cut under a variation: from the programmed speed on, by the angle commanded (M230). While a
    /// tool leaves, the speed stays what it is.
    pub(crate) fn vary(&mut self, variation: Variation, pass: u32) {
        if self.varied.is_none() {
            self.varied = Some((SpeedLaw::new(variation, pass.into()), 0.0));
        }
    }

    /// No pass is cut. Behind a variation the speed has to settle again.
    pub(crate) fn turn_evenly(&mut self) {
        if self.varied.take().is_some() {
            self.even = (0.0, 0.0);
        }
    }

    /// What the variation makes of the speed, a share.
    fn varied_share(&self) -> f64 {
        self.varied.map_or(1.0, |(law, turns)| law.share(turns))
    }

    /// What was asked for, as far as it is allowed; in force at once, unless it is eased.
    fn grant(&mut self) {
        let allowed = self.request_pct.min(self.allowed_pct());
        let top_pct =
            if self.programmed > 0.0 { 100.0 * self.max_rpm / self.programmed } else { f64::INFINITY };
        self.granted_pct = allowed.min(top_pct);
        if !self.leads {
            self.ease.jump(self.granted_pct);
        }
    }

    /// The highest override of the machine and of the pass in hand, per cent.
    fn allowed_pct(&self) -> f64 {
        self.ceiling_pct.min(self.override_max_pct)
    }

    /// Takes a measurement and the panel's override. `pass` is the direction of a pass in hand; a tool that
    /// leaves it does so by an angle that may only be foretold, or behind a fault: the speed is kept until it
    /// is out.
    pub(crate) fn update(&mut self, measurement: &Measurement, pass: Option<f64>, leaves: bool) {
        self.observer.update(middle_of(measurement.spindle_count));
        self.counts.rotate_left(1);
        self.counts[KEPT_TICKS] = measurement.spindle_count;
        self.watch.update(measurement.spindle_count, self.commanded(), self.observed(), pass);
        let request = measurement.panel.spindle_override_pct;
        let request = if request.is_finite() { request.max(0.0) } else { self.request_pct };
        self.request_pct = request;
        self.leads = pass.is_some() && self.programmed > 0.0;
        self.kept = leaves;
        self.grant();
        if !leaves {
            let turned = self.commanded().abs() / 60.0 * self.tick_s;
            self.varied.iter_mut().for_each(|(_, turns)| *turns += turned);
        }
        if self.leads && !leaves {
            self.ease.tick(self.granted_pct, 100.0 * self.ramp_rpm_s * self.tick_s / self.programmed);
        }
        let clamps = self.granted_pct < request;
        self.clamped += u32::from(clamps && !self.clamps);
        self.clamps = clamps;
        if self.commanded() == 0.0 {
            self.even = (0.0, 0.0);
        } else if self.at_speed() {
            let (s, turns) = self.even;
            self.even = (s + self.tick_s, turns + self.observed().abs() / 60.0 * self.tick_s);
        }
    }

    /// What is wrong with it, as far as its encoder and its commands tell.
    pub(crate) fn fault(&self) -> Option<Fault> {
        self.watch.fault()
    }

    /// Whether it has had three times as long as its ramp takes to come to rest: for one whose encoder nobody
    /// believes.
    pub(crate) fn ran_down(&self) -> bool {
        self.watch.ran_down()
    }

    /// Whether it turns faster than it was told to.
    pub(crate) fn runs_away(&self) -> bool {
        self.watch.runs_away()
    }

    /// It is braked otherwise from here on: the time it has for that begins anew, from its highest speed if
    /// nobody sees it.
    pub(crate) fn wait_anew(&mut self, unseen: bool) {
        self.watch.wait_anew(unseen);
    }

    /// Whether it should have come to rest long ago: nobody waits for it any longer.
    pub(crate) fn never_stops(&self) -> bool {
        self.watch.never_stops()
    }

    /// Programs direction and speed.
    pub fn program(&mut self, mode: SpindleMode, speed: SpindleSpeed) {
        if (mode, speed) != (self.mode, self.speed) {
            self.even = (0.0, 0.0);
        }
        (self.mode, self.speed) = (mode, speed);
        (self.programmed, self.rate) = (speed.rpm(self.x), 0.0);
        self.grant();
    }

    /// Takes the commanded X, once per tick: the speed follows it under G96.
    pub fn at_x(&mut self, x: Position) {
        let before = self.programmed;
        (self.x, self.programmed) = (x, self.speed.rpm(x));
        self.rate = (self.programmed - before) / self.tick_s;
        self.grant();
    }

    /// Turns as a tap asks for, 1/min, signed; `None`: as program and override say.
    pub(crate) fn tap(&mut self, rpm: Option<f64>) {
        self.tap_rpm = rpm;
    }

    /// Speed for the drive.
    pub fn commanded(&self) -> f64 {
        self.tap_rpm.map_or_else(|| self.asked(), |rpm| rpm.clamp(-self.max_rpm, self.max_rpm))
    }

    /// What program and override ask for, and a variation makes of it.
    pub(crate) fn asked(&self) -> f64 {
        let asked = self.programmed * self.override_pct() / 100.0 * self.varied_share();
        self.mode.sign() * asked.min(self.max_rpm)
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
        let least = match commanded {
            0.0 => STANDSTILL_RPM,
            _ => STANDSTILL_RPM.min(0.5 * commanded.abs()),
        };
        let band = (self.at_speed_share * commanded.abs()).max(least);
        let rate = (self.rate * self.override_pct() / 100.0).abs().min(self.ramp_rpm_s);
        (self.observed() - commanded).abs() <= band + rate / (TAU * WATCH_HZ)
    }

    /// Whether it has been at speed for so long that regulators know it.
    pub(crate) fn is_known(&self) -> bool {
        let ((s, turns), (known_turns, known_s)) = (self.even, SpindleConfig::KNOWN);
        turns >= known_turns || s >= known_s
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

    /// Whether it stands: the slow watch says so, which swings through zero when the spindle stops fast, and
    /// so do the counts of the last ticks; or it rests, if its encoder is too noisy for that.
    pub fn stands(&self) -> bool {
        let quiet = self.observed().abs() <= STANDSTILL_RPM && self.stays();
        (quiet || self.watch.rests()) && self.is_believed()
    }

    /// Whether the count has moved by no more than one, and what standstill allows, for so long that one
    /// count is a slow spindle.
    fn stays(&self) -> bool {
        let ticks = (self.rpm_per_count_s / self.tick_s / COUNT_RPM).ceil().clamp(1.0, KEPT_TICKS as f64);
        let most = 1.0 + STANDSTILL_RPM / self.rpm_per_count_s * self.tick_s * ticks;
        let last = &self.counts[KEPT_TICKS - ticks as usize..];
        let now = self.counts[KEPT_TICKS];
        last.iter().all(|count| now.saturating_sub(*count).unsigned_abs() as f64 <= most)
    }

    /// Whether it has come to rest: surer than that it [stands](Self::stands), and later.
    pub(crate) fn rests(&self) -> bool {
        self.watch.rests() && self.is_believed()
    }

    /// Nobody believes an encoder that never showed the spindle turning, before it has run down; nor any that
    /// stands sooner than a drive can bring a spindle to rest.
    fn is_believed(&self) -> bool {
        self.watch.may_rest() && (!self.watch.is_doubtful() || self.ran_down())
    }

    /// Override in force, per cent.
    pub fn override_pct(&self) -> f64 {
        self.ease.pct() * self.guarded
    }

    /// How often a request was clamped.
    pub fn clamped(&self) -> u32 {
        self.clamped
    }
}

#[cfg(test)]
mod tests;
