//! What cutting cost in one pass. In: the truth of every control cycle of the pass. Out: a [`CuttingReport`];
//! none if nothing was cut.

use core::f64::consts::TAU;

use protocol::Truth;
use serde::{Deserialize, Serialize};

/// Largest of what cutting took in a pass (M74–M76), by the truth of the plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CuttingReport {
    /// Tangential force, N.
    pub force_max_n: f64,
    /// Force that pushed X out of the cut, N.
    pub radial_max_n: f64,
    /// Force on Z against the motion along the thread, N.
    pub axial_max_n: f64,
    /// Torque that held the spindle back, N·m.
    pub torque_max_nm: f64,
    /// That torque times the true speed, kW.
    pub power_max_kw: f64,
    /// Chip area, mm².
    pub chip_area_max_mm2: f64,
}

impl CuttingReport {
    /// Takes a control cycle into the report of a pass.
    pub(super) fn take(report: &mut Option<CuttingReport>, truth: &Truth) {
        let cut = &truth.cut;
        if cut.area_mm2 <= 0.0 {
            return;
        }
        let most = report.get_or_insert_default();
        most.force_max_n = most.force_max_n.max(cut.force_n);
        most.radial_max_n = most.radial_max_n.max(cut.radial_n);
        most.axial_max_n = most.axial_max_n.max(cut.axial_n);
        most.torque_max_nm = most.torque_max_nm.max(cut.torque_nm);
        most.power_max_kw = most.power_max_kw.max(power_kw(cut.torque_nm, truth.spindle_rpm));
        most.chip_area_max_mm2 = most.chip_area_max_mm2.max(cut.area_mm2);
    }
}

/// P = M ω, in kW, of a torque in N·m at a speed in 1/min.
pub fn power_kw(torque_nm: f64, rpm: f64) -> f64 {
    1e-3 * torque_nm * rpm.abs() * TAU / 60.0
}

#[cfg(test)]
mod tests {
    use protocol::CutTruth;

    use super::*;
    use crate::observe::tests::ideal::{Ideal, Injected, pass};

    #[test]
    fn the_largest_of_each_is_reported_and_power_goes_with_the_speed() {
        let mut report = None;
        let cut = |area_mm2, force_n, torque_nm| CutTruth {
            area_mm2,
            force_n,
            torque_nm,
            radial_n: 0.5 * force_n,
            axial_n: 0.2 * force_n,
        };
        for (cut, spindle_rpm) in
            [(cut(0.1, 300.0, 3.0), -600.0), (cut(0.2, 600.0, 6.0), -100.0), (cut(0.0, 9e9, 9e9), -600.0)]
        {
            CuttingReport::take(&mut report, &Truth { cut, spindle_rpm, ..Truth::default() });
        }
        let report = report.expect("something was cut");
        assert_eq!((report.force_max_n, report.radial_max_n, report.axial_max_n), (600.0, 300.0, 120.0));
        assert_eq!((report.torque_max_nm, report.chip_area_max_mm2), (6.0, 0.2));
        // 3 N·m at 600 1/min are more than 6 at 100.
        assert!((report.power_max_kw - 0.188_495_559).abs() < 1e-9, "{}", report.power_max_kw);
    }

    #[test]
    fn a_pass_that_cuts_nothing_has_no_report() {
        let quiet = Ideal::new().run(&[(pass(1), Injected::default())], |_, _| {});
        assert_eq!(quiet.passes[0].cutting, None);
        let mut cutting = Ideal::new();
        cutting.truth.cut = CutTruth { area_mm2: 0.1, force_n: 300.0, ..CutTruth::default() };
        let loud = cutting.run(&[(pass(1), Injected::default())], |_, _| {});
        assert_eq!(loud.passes[0].cutting.map(|cutting| cutting.force_max_n), Some(300.0));
    }
}
