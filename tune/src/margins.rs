//! Margins of the loops, from the measured response. In: gains of a configuration, lines. Out: phase and gain
//! margins.
//!
//! ```text
//! velocity loop   L = C G,                C = Kp (1 + T/(Ti (1 − z⁻¹)))                                (M82)
//! position loop   L = Kv C Gx/(1 + C G) T/(1 − z⁻¹) z⁻ᵇ, Gx of the encoder that the loop closes over,
//!                 b cycles of the bus, there and back
//! phase margin    least 180° + arg L where |L| = 1;   gain margin  least 1/|L| where arg L = 180°
//! ```
//! Between lines L is taken as a straight stretch of the complex plane.

use machine::AxisConfig;
use nalgebra::Complex;

use crate::{drive_loop::gain, response::Line, torque_path::delayed};

/// Margins of one loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargins {
    /// Phase margin, degrees, and the frequency of the crossing it belongs to, Hz.
    pub phase_deg: f64,
    /// See `phase_deg`.
    pub crossover_hz: f64,
    /// Gain margin, a factor; infinite if no frequency that was measured turns the phase by 180°.
    pub gain: f64,
}

impl LoopMargins {
    /// Whether the loop comes to a magnitude of 1 within the frequencies that are known.
    pub(crate) fn crosses(&self) -> bool {
        self.crossover_hz.is_finite()
    }

    /// Largest relative deviation of the lines within an octave of the crossover; 0 without one.
    pub(crate) fn known_to(&self, lines: &[Line]) -> f64 {
        let near = |line: &&Line| (0.5 * self.crossover_hz..2.0 * self.crossover_hz).contains(&line.hz);
        lines.iter().filter(near).map(|line| line.deviation).fold(0.0, f64::max)
    }
}

/// Margins of both loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// The velocity loop in the drive.
    pub velocity: LoopMargins,
    /// The position loop in the regulator, the velocity loop closed.
    pub position: LoopMargins,
}

impl Margins {
    /// Whether both loops are stable.
    pub(crate) fn stable(&self) -> bool {
        [self.velocity, self.position].iter().all(|one| one.phase_deg > 0.0 && one.gain > 1.0)
    }
}

/// When the loops are closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Control cycle, s.
    pub cycle_s: f64,
    /// What the position loop is late by the bus, there and back, s.
    pub bus_s: f64,
}

/// Both loops, opened, at one frequency.
#[derive(Clone, Copy, Debug)]
pub struct OpenLoops {
    /// Frequency, Hz.
    pub hz: f64,
    /// The velocity loop.
    pub velocity: Complex<f64>,
    /// The position loop, the velocity loop closed.
    pub position: Complex<f64>,
}

/// The loops of `config` on the measured response.
pub(crate) fn open(lines: &[Line], config: &AxisConfig, timing: Timing) -> Vec<OpenLoops> {
    let open = |line: &Line| OpenLoops {
        hz: line.hz,
        velocity: velocity(line, config, timing.cycle_s),
        position: position(line, config, timing),
    };
    lines.iter().map(open).collect()
}

/// Margins of the loops of `config` on the measured response.
pub(crate) fn of(lines: &[Line], config: &AxisConfig, timing: Timing) -> Margins {
    let open = open(lines, config, timing);
    let curve =
        |of: fn(&OpenLoops) -> Complex<f64>| open.iter().map(|at| (at.hz, of(at))).collect::<Vec<_>>();
    Margins { velocity: margins(&curve(|at| at.velocity)), position: margins(&curve(|at| at.position)) }
}

/// The velocity loop, opened, at a line.
fn velocity(line: &Line, config: &AxisConfig, cycle_s: f64) -> Complex<f64> {
    controller(line, config, cycle_s) * line.speed_per_torque
}

/// The position loop, opened, at a line.
fn position(line: &Line, config: &AxisConfig, Timing { cycle_s, bus_s }: Timing) -> Complex<f64> {
    let inner = Complex::from(1.0) + velocity(line, config, cycle_s);
    let speed =
        if config.scale_step_mm.is_some() { line.scale_speed_per_torque } else { line.speed_per_torque };
    let integral = cycle_s / (Complex::from(1.0) - delayed(line.hz, cycle_s));
    let integral = integral * delayed(line.hz, bus_s);
    controller(line, config, cycle_s) * speed / inner * integral * config.position_gain_1_s
}

/// C of (M82).
fn controller(line: &Line, config: &AxisConfig, cycle_s: f64) -> Complex<f64> {
    let integral = cycle_s / config.velocity_integral_s / (Complex::from(1.0) - delayed(line.hz, cycle_s));
    (Complex::from(1.0) + integral) * gain(config)
}

/// Margins of an open loop, given at rising frequencies.
fn margins(open: &[(f64, Complex<f64>)]) -> LoopMargins {
    let mut least = LoopMargins { phase_deg: f64::INFINITY, crossover_hz: f64::NAN, gain: f64::INFINITY };
    for two in open.windows(2) {
        let [(hz, from), (hz_to, to)] = [two[0], two[1]];
        for share in crossings(from, to) {
            let at = from + (to - from) * share;
            let degrees = 180.0 - libm::atan2(at.im, at.re).to_degrees().abs();
            // Beyond 180° of lag the imaginary part is positive, and the margin lost.
            let margin = if at.im > 0.0 { -degrees } else { degrees };
            if margin < least.phase_deg {
                (least.phase_deg, least.crossover_hz) = (margin, hz + (hz_to - hz) * share);
            }
        }
        if (from.im > 0.0) != (to.im > 0.0) {
            let at = from + (to - from) * (from.im / (from.im - to.im));
            if at.re < 0.0 {
                least.gain = least.gain.min(-1.0 / at.re);
            }
        }
    }
    least
}

/// Where a straight stretch crosses the unit circle, shares of its length.
fn crossings(from: Complex<f64>, to: Complex<f64>) -> impl Iterator<Item = f64> {
    let way = to - from;
    let (a, b, c) = (way.norm_sqr(), (from.conj() * way).re, from.norm_sqr() - 1.0);
    let root = (b * b - a * c).max(0.0).sqrt();
    let crosses = b * b - a * c > 0.0 && a > 0.0;
    [(-b - root) / a, (-b + root) / a].into_iter().filter(move |share| crosses && (0.0..1.0).contains(share))
}

#[cfg(test)]
mod tests {
    use super::{Complex, margins};

    /// L = K exp(−jωτ)/(jω): |L| = 1 at ω = K with phase 90° − Kτ; phase 180° at ω = π/2τ with |L| = 2Kτ/π.
    #[test]
    fn an_integrator_behind_a_delay() {
        let (k, tau) = (2.0 * core::f64::consts::PI * 40.0, 1e-3);
        let at = |hz: f64| {
            let w = core::f64::consts::TAU * hz;
            let turned = Complex::new(libm::cos(w * tau), -libm::sin(w * tau));
            (hz, turned * k / Complex::new(0.0, w))
        };
        let open: Vec<_> = (2..350).map(|i| at(2.0 * f64::from(i))).collect();
        let found = margins(&open);
        assert!((found.phase_deg - (90.0 - (k * tau).to_degrees())).abs() < 0.1, "{found:?}");
        assert!((found.crossover_hz - 40.0).abs() < 0.1, "{found:?}");
        assert!((found.gain - core::f64::consts::FRAC_PI_2 / (k * tau)).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn a_loop_that_turns_too_far_has_negative_margin() {
        let open = [(1.0, Complex::new(-2.0, -0.2)), (2.0, Complex::new(-0.4, 0.7))];
        let found = margins(&open);
        assert!(found.phase_deg < 0.0 && found.gain < 1.0, "{found:?}");
    }
}
