//! Phase, lead, servo error and limits of a pass, as injected into an ideal machine.

use protocol::{Axis, AxisState};

use super::ideal::{Ideal, Injected, lay_out, pass};

#[track_caller]
fn close(measured: f64, injected: f64, tolerance: f64) {
    assert!((measured - injected).abs() <= tolerance, "measured {measured}, injected {injected}");
}

#[test]
fn phase_and_lead_error_are_measured_in_both_directions_of_spindle_and_axis() {
    let injected =
        Injected { phase_um: 3.0, lead_error_um_per_rev: 0.2, slide_um: -5.0, ..Injected::default() };
    for direction in [1.0, -1.0] {
        for lead in [-2.0, 2.0] {
            for spindle_deg in [-1234.5, 0.0, 4321.0] {
                let mut pass = pass(1);
                (pass.direction, pass.lead_mm, pass.start_angle_deg) = (direction, lead, 75.0);
                lay_out(&mut pass);
                let mut ideal = Ideal { spindle_deg, ..Ideal::new() };
                let observed = ideal.run(&[(pass, injected)], |_, _| {});
                let [report] = &observed.passes[..] else { panic!("one pass, not {:?}", observed.passes) };
                close(report.phase_um, 3.0, 0.001);
                close(report.lead_error_um_per_rev, 0.2, 1e-6);
                close(report.helix_max_abs_um, 4.0, 0.001); // 3 µm and half of ten turns
                close(report.slide_phase_um, -2.0, 0.001);
                close(report.slide_helix_max_abs_um, 3.0, 0.001);
                assert!(report.complete && report.same_index);
                assert_eq!(report.index_deg % 360.0, 0.0);
                assert_eq!(report.thread_cycles, 2000); // ten turns at 600 1/min
            }
        }
    }
}

#[test]
fn a_run_in_that_breaks_the_phase_rule_shows_as_a_phase_error() {
    let mut pass = pass(1);
    for law in &mut pass.axes {
        law.run_in_c0_deg += 90.0;
    }
    pass.axes[Axis::X.index()].stroke_dc_deg += 90.0;
    let observed = Ideal::new().run(&[(pass, Injected::default())], |_, _| {});
    close(observed.passes[0].phase_um, 500.0, 1e-3); // a quarter of 2 mm, behind on the way to -Z
}

#[test]
fn servo_errors_are_taken_in_their_windows() {
    fn servo(axis: Axis, state: AxisState, c: f64) -> f64 {
        let sign = if axis == Axis::X { 1.0 } else { -1.0 };
        sign * match state {
            AxisState::RunIn if c < 300.0 => -2.0,
            AxisState::RunIn => 1.5,
            AxisState::Locked if c < 543.0 => 0.4,
            AxisState::Locked => 0.05,
            _ => 99.0,
        }
    }
    let injected = Injected { servo_um: Some(servo), slide_um: 3.0, ..Injected::default() };
    let observed = Ideal::new().run(&[(pass(1), injected)], |_, _| {});
    let report = &observed.passes[0];
    for slide in [report.x_slide, report.z_slide] {
        close(slide.approach_min_um, -3.0, 1e-6);
        close(slide.approach_max_um, -3.0, 1e-6);
        close(slide.end_um, -3.0, 1e-6);
        close(slide.thread_max_abs_um, 3.0, 1e-6);
        close(slide.settled_max_abs_um, 3.0, 1e-6);
    }
    close(report.x.approach_min_um, -2.0, 1e-9);
    close(report.x.approach_max_um, 1.5, 1e-9);
    close(report.x.end_um, 0.4, 1e-9);
    close(report.x.thread_max_abs_um, 0.4, 1e-9);
    close(report.x.settled_max_abs_um, 0.05, 1e-9);
    close(report.z.approach_min_um, -1.5, 1e-9);
    close(report.z.approach_max_um, 2.0, 1e-9);
    close(report.z.end_um, -0.4, 1e-9);
}

#[test]
fn limits_used_scale_with_the_speed_of_the_spindle() {
    for ratio in [1.0, 0.6, 1.2] {
        let mut ideal = Ideal { ratio, ..Ideal::new() };
        let pass = pass(1);
        let report = ideal.run(&[(pass, Injected::default())], |_, _| {}).passes.remove(0);
        let peak = |axis: Axis| {
            let (peak, limit) =
                (pass.axis(axis).law(pass.s_rpm).peak().scaled(ratio), &ideal.machine.axis[&axis]);
            [peak.v / limit.velocity_mm_s, peak.a / limit.acceleration_mm_s2, peak.j / limit.jerk_mm_s3]
        };
        let expected: Vec<f64> = [Axis::X, Axis::Z].into_iter().flat_map(peak).collect();
        // Asked for: the peak may fall between two cycles. Used, by differences: the peak of a pulse of jerk
        // lies higher than its mean over three ticks.
        for (of, loss) in [(report.limits_asked_pct, 0.01), (report.limits_used_pct, 0.08)] {
            for (share, expected) in [of.x_v, of.x_a, of.x_j, of.z_v, of.z_a, of.z_j].iter().zip(&expected) {
                let share = share / (100.0 * expected);
                assert!((1.0 - loss..=1.0 + 1e-6).contains(&share), "{share} at {ratio}: {report:#?}");
            }
        }
        close(report.rpm_min, 600.0 * ratio, 1e-9);
        close(report.rpm_max, 600.0 * ratio, 1e-9);
        close(report.phase_um, 0.0, 1e-6);
    }
}

#[test]
fn the_packet_is_counted_against_the_setpoints_it_saves() {
    let report = Ideal::new().run(&[(pass(1), Injected::default())], |_, _| {}).passes.remove(0);
    assert_eq!(report.packet_bytes, 2 * 200);
    // From 40° to 4320° at 600 1/min: 1.189 s, one tick every 2 ms, two axes.
    close(report.setpoints_saved as f64, 2.0 * 594.5, 2.0);
    assert_eq!((report.c0_deg, report.delta_c_deg), (180.0, 360.0));
    assert_eq!((report.delta_z_mm, report.delta_x_mm), (-1.0, -1.0));
    assert_eq!(report.x_moments_deg, [40.0, 540.0, 4140.0, 4320.0]);
    assert_eq!(report.max_feasible_override_pct, 137.0);
    close(report.helix_at_index_mm, 7.0, 1e-9); // 5 mm at the start angle, one turn of -2 mm after the index
    assert!(report.armed_cycle < report.begin_cycle && report.begin_cycle < report.end_cycle);
}
