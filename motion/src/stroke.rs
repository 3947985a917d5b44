//! Stroke of the transverse axis over a spindle angle, two intervals of sin² acceleration (M1–M8a). In:
//! signed stroke in mm and its duration at programmed speed in s. Out: samples in mm/sⁿ, peaks, residual
//! vibration. Source: "Smooth acceleration of transverse axis movements in CNC threading machining", Eqs.
//! (1)–(13).
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | dX | mm | signed stroke |
//! | p, p_acc | s | time at programmed speed since the start angle; duration of the stroke |
//! | D = p_acc/2 | s | length of one interval (M3) |
//! | w = π/D | rad/s | frequency of the sin² (M3) |
//! | a_p = 8 dX/p_acc² | mm/s² | signed peak acceleration (M5) |
//! | dC, S | deg, 1/min | spindle angle of the stroke, programmed speed; p_acc = dC/(6 S) (M3) |
//!
//! ```text
//! 0 < p ≤ D:  a = a_p sin²(w p),  the rest by integration;  second interval: x(p) = dX − x(p_acc − p)   (M2)
//! ```
//! The law is point-symmetric about its middle, so only the first interval is ever evaluated. With x = 2 w p,
//! a_p sin²(w p) = (a_p/2)(1 − cos x), and M4 becomes the integrals of `versine.rs`.

use crate::limits::{Limits, ROUNDING};
use crate::sample::Sample;
use crate::versine::Versine;
use core::f64::consts::PI;

/// Smooth stroke from 0 to a signed length (M2). Acceleration and jerk are continuous, at the ends too.
///
/// ```
/// let stroke = motion::Stroke::over_angle(5.0, 360.0, 300.0); // 5 mm in one turn at 300 1/min
/// assert_eq!(stroke.duration(), 0.2);
/// let middle = stroke.at(0.1);
/// assert!((middle.s - 2.5).abs() < 1e-12 && (middle.v - 50.0).abs() < 1e-12);
/// assert_eq!(stroke.at(0.2).s, 5.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    length: f64,
    duration: f64,
    /// a_p/2, mm/s².
    half_a: f64,
    /// 2 w = 4π/p_acc, rad/s: rate of the phase.
    phase_rate: f64,
}

impl Stroke {
    /// Stroke of `length_mm` (signed) in `duration_s` at programmed speed.
    ///
    /// # Panics
    /// If the length is not finite, or the duration not positive and finite; a stroke of length 0 may last 0
    /// s.
    #[must_use]
    pub fn new(length_mm: f64, duration_s: f64) -> Stroke {
        assert!(length_mm.is_finite() && duration_s.is_finite(), "stroke {length_mm} mm in {duration_s} s");
        assert!(
            duration_s > 0.0 || (length_mm == 0.0 && duration_s == 0.0),
            "a stroke of {length_mm} mm takes time"
        );
        let (half_a, phase_rate) = if length_mm == 0.0 {
            (0.0, 0.0)
        } else {
            (4.0 * length_mm / (duration_s * duration_s), 4.0 * PI / duration_s)
        };
        Stroke { length: length_mm, duration: duration_s, half_a, phase_rate }
    }

    /// Stroke of `length_mm` while the spindle, at its programmed speed `s_rpm` > 0, turns by `delta_c_deg` >
    /// 0 (M3).
    ///
    /// # Panics
    /// As [`Stroke::new`].
    #[must_use]
    pub fn over_angle(length_mm: f64, delta_c_deg: f64, s_rpm: f64) -> Stroke {
        Stroke::new(length_mm, delta_c_deg / (6.0 * s_rpm))
    }

    /// Shortest duration in s of a stroke of `length_mm` within `limits` (M7); 0 for length 0. Divide the
    /// limits by a margin first if the spindle may change speed during the stroke: M8 adds |r'| v to the
    /// acceleration.
    #[must_use]
    pub fn shortest(length_mm: f64, limits: &Limits) -> f64 {
        limits.check();
        let x = length_mm.abs();
        let longest = (2.0 * x / limits.v)
            .max((8.0 * x / limits.a).sqrt())
            .max(libm::cbrt(16.0 * PI * x / limits.j))
            .max((64.0 * PI * PI * x / limits.dj).sqrt().sqrt());
        longest * ROUNDING
    }

    /// Sample at `p` seconds (at programmed speed) after the start: at rest at 0 for `p` ≤ 0, at rest at
    /// exactly the length for `p` ≥ duration.
    #[must_use]
    #[inline]
    pub fn at(&self, p: f64) -> Sample {
        if p <= 0.0 || self.length == 0.0 {
            Sample::default()
        } else if p >= self.duration {
            Sample::uniform(self.length, 0.0)
        } else if p <= 0.5 * self.duration {
            self.first_interval(p)
        } else {
            self.first_interval(self.duration - p).reversed(self.length)
        }
    }

    /// M2 with 0 < p ≤ D: acceleration (a_p/2)(1 − cos x), x = 2 w p.
    #[inline]
    fn first_interval(&self, p: f64) -> Sample {
        let (h, k) = (self.half_a, self.phase_rate);
        let phase = Versine::at(k * p);
        Sample {
            s: h * phase.second / (k * k),
            v: h * phase.first / k,
            a: h * phase.pulse,
            j: h * k * phase.rate,
            dj: h * k * k * (1.0 - phase.pulse),
        }
    }

    /// Largest magnitudes at programmed speed (M6): 2|dX|/p_acc, 8|dX|/p_acc², 16π|dX|/p_acc³,
    /// 64π²|dX|/p_acc⁴.
    #[must_use]
    pub fn peak(&self) -> Limits {
        let (h, k) = (self.half_a.abs(), self.phase_rate);
        Limits { v: 0.5 * h * self.duration, a: 2.0 * h, j: h * k, dj: h * k * k }
    }

    /// Duration at programmed speed, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Signed length, mm.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Amplitude in mm that an undamped mode of `mode_hz` > 0 keeps after the stroke at programmed speed
    /// (M8a):
    /// |dX| sin²(πN)/(π² N² |N² − 1|) with N = f D, zero for every whole N ≥ 1.
    ///
    /// At speed ratio r the stroke lasts 1/r as long: ask with `mode_hz / r`.
    #[must_use]
    pub fn residual(&self, mode_hz: f64) -> f64 {
        let n = 0.5 * mode_hz * self.duration;
        let sin = libm::sin(PI * n);
        let denominator = PI * PI * n * n * (n * n - 1.0).abs();
        if denominator > 0.0 {
            self.length.abs() * sin * sin / denominator
        } else if n == 1.0 {
            0.0
        } else {
            self.length.abs()
        }
    }

    /// Envelope of [`Stroke::residual`] over the phase: |dX|/(π² N² (N² − 1)), and never more than |dX|. It
    /// is what can be promised when the frequency is known only roughly.
    ///
    /// ```
    /// // 5 mm leave less than 0.2 µm in a mode of 80 Hz if the stroke takes 0.18 s.
    /// assert!(motion::Stroke::new(5.0, 0.18).residual_bound(80.0) < 0.2e-3);
    /// ```
    #[must_use]
    pub fn residual_bound(&self, mode_hz: f64) -> f64 {
        let n2 = (0.5 * mode_hz * self.duration) * (0.5 * mode_hz * self.duration);
        let free = self.length.abs();
        if n2 > 1.0 { free.min(free / (PI * PI * n2 * (n2 - 1.0))) } else { free }
    }
}
