//! Compensation of screw and backlash: what the motor does besides, so that the slide does what is commanded.
//! In: the motion of the axis in mm and s. Out: the motion of the motor; and back, where the axis is when the
//! motor is measured.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | s, v, a | mm, mm/s, mm/s² | motion of the axis as commanded |
//! | m | mm | position of the motor |
//! | e(s) | mm | error of the screw: how much too far the slide stands (`machine/src/screw.rs`) |
//! | B, b | mm | backlash; what of it the motor is ahead: B/2 on the way up, −B/2 on the way down, 0 at the start |
//! | x(t) | mm | stroke from one side to the other (M2), as short as the limits of the axis allow (M7) |
//!
//! ```text
//! m = s − e(s) + e(home) + b,   m′ = (1 − e′) v + b′,   m″ = (1 − e′) a − e″ v² + b″              (M68)
//! b(t) = b_before + x(t − t_r)                                                                    (M69)
//! ```
//! The axis stands at home when the machine starts, whatever the table says of home: the datum of the machine
//! is there.
//!
//! The side changes at t_r, when the commanded position has come back from the farthest point of its way and
//! goes on in that direction: by 1 µm, in a pass by two counts of the spindle where these are more way. The
//! observed angle wanders about the true one by less than that, so neither a standing axis nor its noise ever
//! begins a stroke, and one that has begun ends within the dead zone even if the axis stops meanwhile. One
//! stroke ends before the next begins. Feedforward looks ahead of the present, and reversals are seen where
//! it looks farthest: the stroke begins for every lead at its own time, from rest.

use machine::AxisConfig;
use motion::{Sample, Stroke};

use machine::screw::Screw;

/// How far the commanded position comes back before that is a reversal, mm.
const REVERSED_MM: f64 = 1e-3;
/// The same in counts of the spindle, for an axis that follows it.
const REVERSED_COUNTS: f64 = 2.0;
/// Steps of the iteration that inverts M68. Each is more exact by the slope of the error, a hundredth at the
/// worst.
const INVERSIONS: usize = 6;

/// Compensation of one axis.
#[derive(Clone, Debug)]
pub struct Compensation {
    screw: Option<Screw>,
    at_home_mm: f64,
    backlash: Option<Backlash>,
}

impl Compensation {
    /// What an axis of the machine file compensates; `None` if nothing. `reach_s` is how far feedforward
    /// looks back and ahead, s.
    pub fn of(config: &AxisConfig, reach_s: [f64; 2], cycle_s: f64) -> Option<Compensation> {
        let screw = Screw::new(&config.screw_error);
        let backlash = (config.backlash_mm > 0.0).then(|| Backlash::new(config, reach_s, cycle_s));
        let at_home_mm = screw.as_ref().map_or(0.0, |screw| screw.error(config.home_mm)[0]);
        (screw.is_some() || backlash.is_some()).then_some(Compensation { screw, at_home_mm, backlash })
    }

    /// A control cycle later.
    pub fn step(&mut self) {
        if let Some(backlash) = &mut self.backlash {
            backlash.seen_s += backlash.cycle_s;
        }
    }

    /// The axis has no command.
    pub fn rest(&mut self) {
        if let Some(backlash) = &mut self.backlash {
            backlash.farthest_mm = None;
        }
    }

    /// Looks for a reversal in the motion of the axis, given by its lead. `count_mm` is how far a count of
    /// the spindle moves it, mm; 0 outside a pass.
    pub fn watch(&mut self, count_mm: f64, axis: impl Fn(f64) -> Sample) {
        if let Some(backlash) = &mut self.backlash {
            backlash.watch(REVERSED_MM.max(REVERSED_COUNTS * count_mm.abs()), &axis(backlash.ahead_s));
        }
    }

    /// Whether the motor is on its way from one side of the backlash to the other.
    pub fn is_turning(&self) -> bool {
        self.backlash.as_ref().is_some_and(|backlash| !backlash.settled())
    }

    /// Position, speed and acceleration of the motor when the axis moves so, `lead_s` after the sample
    /// instant (M68).
    pub fn motor(&self, axis: &Sample, lead_s: f64) -> Sample {
        let [e, slope, curvature] = self.error(axis.s);
        let side = self.side(lead_s);
        Sample {
            s: axis.s - e + side.s,
            v: axis.v * (1.0 - slope) + side.v,
            a: axis.a * (1.0 - slope) - curvature * axis.v * axis.v + side.a,
            ..Sample::default()
        }
    }

    /// Where the axis was when the motor was measured at `motor_mm`, so long ago.
    pub fn axis_mm(&self, motor_mm: f64, ago_s: f64) -> f64 {
        let nut_mm = motor_mm - self.side(-ago_s).s;
        (0..INVERSIONS).fold(nut_mm, |s, _| nut_mm + self.error(s)[0])
    }

    fn side(&self, lead_s: f64) -> Sample {
        self.backlash.as_ref().map_or(Sample::default(), |backlash| backlash.at(lead_s))
    }

    /// Error since home, and its derivatives.
    fn error(&self, s: f64) -> [f64; 3] {
        let Some(screw) = &self.screw else { return [0.0; 3] };
        let [e, slope, curvature] = screw.error(s);
        [e - self.at_home_mm, slope, curvature]
    }
}

/// Which side of the backlash the motor is on.
#[derive(Clone, Debug)]
struct Backlash {
    mm: f64,
    limits: motion::Limits,
    cycle_s: f64,
    back_s: f64,
    ahead_s: f64,
    /// The side before the last reversal, the way to the present one, and how long ago that was seen.
    before_mm: f64,
    stroke: Stroke,
    seen_s: f64,
    /// Direction in which the axis goes, ±1; 0 before it has moved.
    direction: f64,
    /// Farthest commanded position in that direction.
    farthest_mm: Option<f64>,
}

impl Backlash {
    fn new(config: &AxisConfig, [back_s, ahead_s]: [f64; 2], cycle_s: f64) -> Backlash {
        Backlash {
            mm: config.backlash_mm,
            limits: config.limits(),
            cycle_s,
            back_s,
            ahead_s,
            before_mm: 0.0,
            stroke: Stroke::new(0.0, 0.0),
            seen_s: back_s + ahead_s,
            direction: 0.0,
            farthest_mm: None,
        }
    }

    /// b and its derivatives (M69).
    fn at(&self, lead_s: f64) -> Sample {
        let mut side = self.stroke.at(self.seen_s - self.ahead_s + lead_s);
        side.s += self.before_mm;
        side
    }

    /// Whether the last stroke is over wherever feedforward looks.
    fn settled(&self) -> bool {
        self.seen_s >= self.stroke.duration() + self.ahead_s + self.back_s
    }

    fn watch(&mut self, reversed_mm: f64, ahead: &Sample) {
        let farthest_mm = self.farthest_mm.unwrap_or(ahead.s);
        let came = ahead.s - farthest_mm;
        self.farthest_mm = Some(if came * self.direction > 0.0 { ahead.s } else { farthest_mm });
        let reversed = came.abs() > reversed_mm && came * self.direction <= 0.0;
        if reversed && came * ahead.v > 0.0 && self.settled() {
            self.begin(came.signum());
            self.farthest_mm = Some(ahead.s);
        }
    }

    fn begin(&mut self, direction: f64) {
        self.before_mm += self.stroke.length();
        self.direction = direction;
        let way = 0.5 * self.mm * direction - self.before_mm;
        self.stroke = Stroke::new(way, Stroke::shortest(way, &self.limits));
        self.seen_s = 0.0;
    }
}
