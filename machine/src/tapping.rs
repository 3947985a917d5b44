//! What a tap asks of the spindle: where it has to begin to brake so that it turns round at the depth, and
//! how fast it may turn for that. In: what the controller believes of the spindle, a pass that returns. Out:
//! angles in degrees, speeds in 1/min.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | n, ρ | 1/min, 1/min per s | speed; ramp of the drive, as the machine file tells it |
//! | β = 4/5 ρ | 1/min per s | what a turn is planned with: a drive that is a fifth weaker still keeps it |
//! | Φ | deg | angle from where the axes set off to the depth |
//! | h | s | from the status of an axis to the command that follows from it |
//!
//! ```text
//! φ(n) = 6 n²/2β = 3 n²/β                        angle from n to rest                             (M210)
//! n ≤ −β h + √(β² h² + β Φ/3)                    the highest n with φ(n) + 6 n h ≤ Φ               (M211)
//! ```

use protocol::{AxisLaw, ThreadPass};

use crate::Machine;

/// What of the ramp of its drive a turn of the spindle is planned with.
const SHARE: f64 = 0.8;
/// Ticks from the status of an axis to the command that follows from it, and one to spare.
const HEARD_TICKS: f64 = 3.0;

impl Machine {
    /// β: how fast a spindle is braked and turned round in a tap, 1/min per s.
    pub fn tap_ramp_rpm_s(&self) -> f64 {
        SHARE * self.spindle.ramp_rpm_s
    }

    /// φ: angle from a speed in 1/min to rest, degrees (M210).
    pub fn tap_stop_deg(&self, rpm: f64) -> f64 {
        3.0 * rpm * rpm / self.tap_ramp_rpm_s()
    }

    /// The highest speed from which the spindle comes to rest within an angle in degrees, 1/min (M211).
    pub fn tap_top_rpm(&self, deg: f64) -> f64 {
        let ramp = self.tap_ramp_rpm_s();
        let late = ramp * HEARD_TICKS * self.general.interpolator_cycle_s;
        (late * late + ramp * deg.max(0.0) / 3.0).sqrt() - late
    }

    /// Whether the spindle can turn round where a pass that returns says, at the highest ratio that it
    /// claims, and turn as fast on the way out. True of every other pass.
    pub fn can_turn_round(&self, pass: &ThreadPass) -> bool {
        if !pass.returns() {
            return true;
        }
        let law: &AxisLaw = pass.axis(pass.along());
        let top = self.tap_top_rpm(pass.thread_end_deg - law.run_in_c0_deg);
        let fits = |rpm: f64, most: f64| rpm <= most * (1.0 + 1e-9);
        fits(pass.max_ratio * pass.s_rpm, top)
            && fits(pass.return_ratio * pass.s_rpm, self.spindle.max_rpm)
            && fits(pass.return_ratio, pass.max_ratio.max(self.tap_axes_ratio(pass)))
    }

    /// The highest ratio at which every axis can follow the law of a pass.
    pub fn tap_axes_ratio(&self, pass: &ThreadPass) -> f64 {
        let ratios = self.axes().map(|(axis, config)| {
            let law = pass.axis(axis);
            if law.lead_mm == 0.0 {
                return f64::INFINITY;
            }
            config.limits().top_ratio(&law.law(pass.s_rpm).peak())
        });
        ratios.fold(f64::INFINITY, f64::min)
    }

    /// How long a tap takes from its index until the tool is back, at programmed speed, s.
    pub fn tap_s(&self, pass: &ThreadPass) -> f64 {
        let law = pass.axis(pass.along());
        let (n, out) = (pass.s_rpm, pass.s_rpm * pass.return_ratio);
        let ramp = self.tap_ramp_rpm_s();
        let way = pass.thread_end_deg - law.run_in_c0_deg;
        let spun_up = self.tap_stop_deg(out);
        let (up_s, left_deg) = match spun_up <= way {
            true => (out / ramp, way - spun_up),
            false => ((way / 3.0 / ramp).sqrt(), 0.0),
        };
        let inwards = (pass.thread_end_deg - self.tap_stop_deg(n)) / (6.0 * n) + n / ramp;
        inwards + pass.dwell_s + up_s + left_deg / (6.0 * out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn m210_is_the_angle_of_a_ramp_to_rest() {
        let machine = Machine::plain();
        let (ramp, tick_s) = (machine.tap_ramp_rpm_s(), 1e-5);
        let (mut rpm, mut deg) = (700.0, 0.0);
        while rpm > 0.0 {
            deg += 6.0 * rpm * tick_s;
            rpm -= ramp * tick_s;
        }
        assert!((deg / machine.tap_stop_deg(700.0) - 1.0).abs() < 1e-3, "{deg}");
    }

    #[test]
    fn m211_is_the_speed_whose_stop_fits() {
        let machine = Machine::plain();
        for deg in [10.0, 300.0, 7000.0] {
            let rpm = machine.tap_top_rpm(deg);
            let late = 6.0 * rpm * HEARD_TICKS * machine.general.interpolator_cycle_s;
            assert!((machine.tap_stop_deg(rpm) + late - deg).abs() < 1e-6 * deg, "{deg}: {rpm}");
        }
        assert_eq!(machine.tap_top_rpm(-5.0), 0.0);
    }
}
