//! Torque as a drive measures it: from its current, with noise, in steps. In: the torque that the drive
//! believes its motor to give, N·m, and the control cycle. Out: what it reports.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | t | N·m | torque as the drive believes it |
//! | s, q | N·m | noise, root of its mean square, and step of what is reported |
//! | u | – | four numbers evenly spread over [0, 1) that the seed has for this cycle |
//!
//! ```text
//! shown = q round((t + s √3 (u1 + u2 + u3 + u4 − 2))/q)                                             (M109)
//! ```
//! A sum of four is as good as normal within its ±3.5 s.

use protocol::Cycle;

use crate::seed::Seed;

/// Variance of one evenly spread number is 1/12, that of four of them a third.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// What a drive reports of its torque.
#[derive(Clone, Debug)]
pub(crate) struct Meter {
    noise_nm: f64,
    step_nm: f64,
    seed: Seed,
}

impl Meter {
    /// Noise and step in N·m; 0 for none.
    pub(crate) fn new(noise_nm: f64, step_nm: f64, seed: Seed) -> Meter {
        Meter { noise_nm, step_nm, seed }
    }

    /// The torque that is shown in a cycle.
    pub(crate) fn show(&self, now: Cycle, torque_nm: f64) -> f64 {
        let mut shown_nm = torque_nm;
        if self.noise_nm > 0.0 {
            let mut cycle = self.seed.branch(now.0);
            let sum: f64 = (0..4).map(|_| cycle.fraction()).sum();
            shown_nm += self.noise_nm * SQRT_3 * (sum - 2.0);
        }
        if self.step_nm > 0.0 {
            shown_nm = self.step_nm * (shown_nm / self.step_nm).round();
        }
        shown_nm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_its_size_and_no_mean() {
        let meter = Meter::new(0.05, 0.0, Seed(3));
        let noise: Vec<f64> = (0..100_000).map(|cycle| meter.show(Cycle(cycle), 2.0) - 2.0).collect();
        let mean = noise.iter().sum::<f64>() / 1e5;
        let rms = libm::sqrt(noise.iter().map(|nm| nm * nm).sum::<f64>() / 1e5);
        let next = noise.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / 1e5 / (rms * rms);
        assert!(mean.abs() < 5e-4 && (rms / 0.05 - 1.0).abs() < 0.01, "mean {mean}, rms {rms}");
        assert!(next.abs() < 0.02, "correlation {next} from cycle to cycle");
        assert!(noise.iter().all(|nm| nm.abs() < 3.5 * 0.05));
    }

    #[test]
    fn steps_are_rounded_to_and_a_perfect_meter_changes_nothing() {
        let meter = Meter::new(0.0, 0.005, Seed(3));
        for (torque_nm, expected_nm) in [(0.0024, 0.0), (-0.0026, -0.005), (0.0126, 0.015), (-1.0, -1.0)] {
            let shown_nm = meter.show(Cycle(9), torque_nm);
            assert!((shown_nm - expected_nm).abs() < 1e-12, "{shown_nm} of {torque_nm}");
        }
        assert_eq!(Meter::new(0.0, 0.0, Seed(3)).show(Cycle(9), 0.123_456_789), 0.123_456_789);
    }
}
