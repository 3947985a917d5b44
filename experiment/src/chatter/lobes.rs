//! The lobes of one mode at an even speed. In: mode, cutting stiffness, speed. Out: the widest chip that is
//! stable, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | G = G_r + j G_i | mm/N | what the tool gives way for a force at ω: 1/k / (1 − (ω/ω_n)² + 2jζ ω/ω_n) |
//! | K, b | N/mm², mm | force across the groove for each mm of the chip's thickness and of its width b |
//! | τ, i | s, – | time of a turn; whole waves in it |
//! | ε | rad | what of a wave is left: 3π + 2 arg G |
//!
//! ```text
//! b = −1/(2 K G_r(ω)),   ω τ = 2π i + ε(ω);  the least over i, over all ω with G_r < 0             (M236)
//! least of all:  b = 2 k ζ (1 + ζ)/K
//! ```
//! Source: Tlusty and Polacek (1963); in this form Altintas, Manufacturing Automation (2nd ed. 2012), 4.3. It
//! follows from 1 + K b (1 − e^(−jωτ)) G = 0, with ω real at the limit.

use core::f64::consts::{PI, TAU};

use sim_plant::ChatterMode;

/// Halvings of a search.
const STEPS: u32 = 60;

/// Real part and angle of G at `r` = ω/ω_n times the stiffness.
fn response(mode: &ChatterMode, r: f64) -> (f64, f64) {
    let (re, im) = (1.0 - r * r, 2.0 * mode.damping * r);
    let square = re * re + im * im;
    (re / square, libm::atan2(-im, re))
}

/// The least limit at any speed, mm.
pub(super) fn least_mm(mode: &ChatterMode, stiffness_n_mm2: f64) -> f64 {
    2.0 * mode.stiffness_n_mm * mode.damping * (1.0 + mode.damping) / stiffness_n_mm2
}

/// The limit at a speed, 1/min, by every lobe (M236), mm.
pub(super) fn limit_mm(mode: &ChatterMode, stiffness_n_mm2: f64, rpm: f64) -> f64 {
    let waves = mode.hz * 60.0 / rpm;
    let phase = |r: f64| TAU * waves * r - (3.0 * PI + 2.0 * response(mode, r).1);
    let limit = |i: f64| {
        // The phase grows with ω; just above the mode ε is 2π.
        let (mut low, mut high) = (1.0 + 1e-12, 1.0 + (i + 2.0) / waves);
        if phase(low) > TAU * i {
            return f64::INFINITY;
        }
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if phase(middle) > TAU * i { high = middle } else { low = middle }
        }
        -mode.stiffness_n_mm / (2.0 * stiffness_n_mm2 * response(mode, 0.5 * (low + high)).0)
    };
    // The least of each lies near ω_n (1 + 2ζ)^½.
    let first = (waves - 1.5).floor().max(0.0);
    let last = (waves * (1.0 + 2.0 * mode.damping)).ceil() + 1.0;
    let lobes = (last - first) as u32;
    (0..=lobes).map(|n| limit(first + f64::from(n))).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODE: ChatterMode = ChatterMode { stiffness_n_mm: 20_000.0, hz: 120.0, damping: 0.04 };

    /// 1 + K b (1 − e^(−jωτ)) G, its magnitude.
    fn characteristic(b: f64, r: f64, waves: f64) -> f64 {
        let (re, im) = (1.0 - r * r, 2.0 * MODE.damping * r);
        let square = re * re + im * im;
        let (g, h) = (re / square / MODE.stiffness_n_mm, -im / square / MODE.stiffness_n_mm);
        let (sin, cos) = libm::sincos(TAU * waves * r);
        let (c, s) = (1.0 - cos, sin);
        let k = 1500.0 * b;
        libm::hypot(1.0 + k * (c * g - s * h), k * (c * h + s * g))
    }

    #[test]
    fn m236_at_the_limit_the_characteristic_equation_has_a_real_frequency_and_below_it_none() {
        for rpm in [90.0, 240.0, 311.0, 600.0, 1450.0, 2900.0, 7000.0] {
            let (b, waves) = (limit_mm(&MODE, 1500.0, rpm), MODE.hz * 60.0 / rpm);
            let least = |b: f64| {
                let scan = (1..400_000).map(|n| characteristic(b, 0.5 + f64::from(n) * 5e-6, waves));
                scan.fold(f64::INFINITY, f64::min)
            };
            assert!(least(b) < 2e-3, "{rpm}: {}", least(b));
            assert!(least(0.9 * b) > 0.02, "{rpm}: {}", least(0.9 * b));
        }
    }

    #[test]
    fn no_lobe_lies_below_the_least_limit_and_slow_ones_come_to_it() {
        let least = least_mm(&MODE, 1500.0);
        let limits: Vec<f64> = (1..4000).map(|n| limit_mm(&MODE, 1500.0, f64::from(n))).collect();
        assert!(limits.iter().all(|b| *b >= least * (1.0 - 1e-9)));
        assert!(limits.iter().any(|b| *b < least * 1.0001));
        assert!(limits[..90].iter().all(|b| *b < 1.03 * least), "slow speeds have no pockets");
    }
}
