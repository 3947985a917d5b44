//! The spindle as the interpolator commands and watches it: programmed speed, override, ceiling, at speed.
//!
//! Speeds in 1/min, signed: positive clockwise (M3).

use motion::SpindleObserver;
use protocol::{Machine, Measurement, SpindleMode};

/// Bandwidth of the observer that watches the speed, Hz: slow, because it only judges.
const WATCH_HZ: f64 = 5.0;

/// Speed below which the spindle counts as standing, 1/min.
const STANDSTILL_RPM: f64 = 1.0;

/// The spindle.
#[derive(Clone, Debug)]
pub struct Spindle {
    observer: SpindleObserver,
    rpm_per_count_s: f64,
    mode: SpindleMode,
    programmed: f64,
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
            observer: SpindleObserver::new(WATCH_HZ, machine.machine.interpolator_cycle_s),
            rpm_per_count_s: 60.0 / machine.spindle_counts(),
            mode: SpindleMode::Stop,
            programmed: 0.0,
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
        self.observer.update(measurement.spindle_count as f64 + 0.5);
        let request = measurement.panel.spindle_override_pct;
        let request = if request.is_finite() { request.max(0.0) } else { self.request_pct };
        let before = (self.request_pct, self.override_pct);
        self.request_pct = request;
        self.grant();
        let clamped = self.override_pct < request;
        self.clamped += u32::from(clamped && (request, self.override_pct) != before);
    }

    /// Programs direction and speed.
    pub fn program(&mut self, mode: SpindleMode, rpm: f64) {
        self.mode = mode;
        self.programmed = rpm;
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

    /// Whether the observed speed lies in the band around the commanded one. A spindle that the override holds at 0 is
    /// not at speed: nothing may feed into a part that stands.
    pub fn at_speed(&self) -> bool {
        let commanded = self.commanded();
        if self.held() {
            return false;
        }
        let band = (self.at_speed_share * commanded.abs()).max(STANDSTILL_RPM);
        (self.observed() - commanded).abs() <= band
    }

    /// Whether it shall turn, and the override holds it at 0.
    pub fn held(&self) -> bool {
        self.programmed() != 0.0 && self.commanded() == 0.0
    }

    /// Whether it shall turn and hardly does.
    pub fn stalls(&self) -> bool {
        self.observed().abs() < 0.1 * self.commanded().abs()
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
