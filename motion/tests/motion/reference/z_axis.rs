//! `z_profile.json`: run-in and run-out of the longitudinal axis (M9–M15).

use super::values;
use motion::{Ramp, Sample};
use serde::Deserialize;
use testing::reference::{parameter, read, rows};

#[derive(Deserialize)]
struct File {
    schema: String,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    id: String,
    lead_mm_rev: f64,
    s_rpm: f64,
    delta_z_mm: f64,
    a_max_mm_s2: f64,
    v_z_mm_s: f64,
    delta_c_deg: f64,
    p_acc_s: f64,
    lambda: f64,
    t1_s: f64,
    t2_s: f64,
    j_p_mm_s3: f64,
    a_peak_mm_s2: f64,
    dj_peak_mm_s4: f64,
    columns: Vec<String>,
    accel_samples: Vec<Vec<f64>>,
    decel_samples: Vec<Vec<f64>>,
}

#[test]
fn reference_z_profile() {
    let file: File = read("z_profile.json");
    assert_eq!(file.schema, "z_profile/1");
    assert!(!file.cases.is_empty(), "no cases");
    for case in &file.cases {
        let delta_c = 720.0 * case.delta_z_mm / case.lead_mm_rev.abs();
        parameter(&format!("{}: delta_c", case.id), delta_c, case.delta_c_deg);
        let (v_z, duration) = (case.lead_mm_rev * case.s_rpm / 60.0, delta_c / (6.0 * case.s_rpm));
        let ramp = Ramp::least_jerk(v_z, duration, case.a_max_mm_s2)
            .unwrap_or_else(|| panic!("{}: not feasible", case.id));
        check_parameters(case, &ramp);
        check_samples(&format!("{} accel", case.id), case, &case.accel_samples, |p| ramp.at(p));
        check_samples(&format!("{} decel", case.id), case, &case.decel_samples, |p| ramp.braking_at(p));
        for row in case.accel_samples.iter().filter(|row| row[0] > duration) {
            assert_eq!(ramp.at(row[0]).v, ramp.dv(), "{}: thread after the run-in", case.id);
        }
    }
}

fn check_parameters(case: &Case, ramp: &Ramp) {
    let (id, peak) = (&case.id, ramp.peak());
    parameter(&format!("{id}: v_z"), ramp.dv(), case.v_z_mm_s);
    parameter(&format!("{id}: delta_z"), ramp.distance().abs(), case.delta_z_mm);
    parameter(&format!("{id}: p_acc"), ramp.duration(), case.p_acc_s);
    parameter(&format!("{id}: lambda"), ramp.lambda(), case.lambda);
    parameter(&format!("{id}: t1"), ramp.jerk_interval(), case.t1_s);
    parameter(&format!("{id}: t2"), ramp.duration() - ramp.jerk_interval(), case.t2_s);
    parameter(&format!("{id}: peak v"), peak.v, case.v_z_mm_s.abs());
    parameter(&format!("{id}: a"), peak.a, case.a_peak_mm_s2);
    parameter(&format!("{id}: j"), peak.j, case.j_p_mm_s3);
    parameter(&format!("{id}: dj"), peak.dj, case.dj_peak_mm_s4);
}

fn check_samples(at: &str, case: &Case, samples: &[Vec<f64>], law: impl Fn(f64) -> Sample) {
    let names = ["p_s", "c_rel_deg", "z_rel_mm", "v_mm_s", "a_mm_s2", "j_mm_s3", "dj_mm_s4"];
    rows(at, names, &case.columns, samples, [0.0; 7], |p| {
        let [s, v, a, j, dj] = values(law(p));
        [p, 6.0 * case.s_rpm * p, s, v, a, j, dj]
    });
}
