//! `x_profile.json`: the transverse axis (M1–M8).

use motion::{Sample, Stroke};
use serde::Deserialize;
use testing::reference::{close, parameter, read, rows};

#[derive(Deserialize)]
struct File {
    schema: String,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    id: String,
    delta_x_mm: f64,
    delta_c_deg: f64,
    s_rpm: f64,
    x0_mm: f64,
    p_acc_s: f64,
    dp1_s: f64,
    omega_rad_s: f64,
    a_p_mm_s2: f64,
    v_peak_mm_s: f64,
    j_peak_mm_s3: f64,
    dj_peak_mm_s4: f64,
    chain_rule: ChainRule,
    columns: Vec<String>,
    samples: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct ChainRule {
    r: f64,
    r_dot_1_s: f64,
    p_s: f64,
    v_mm_s: f64,
    a_mm_s2: f64,
}

#[test]
fn reference_x_profile() {
    let file: File = read("x_profile.json");
    assert_eq!(file.schema, "x_profile/1");
    assert!(!file.cases.is_empty(), "no cases");
    for case in &file.cases {
        let stroke = Stroke::over_angle(case.delta_x_mm, case.delta_c_deg, case.s_rpm);
        check_parameters(case, &stroke);
        check_chain_rule(case, &stroke);
        let names = ["p_s", "c_rel_deg", "x_mm", "v_mm_s", "a_mm_s2", "j_mm_s3"];
        rows(&case.id, names, &case.columns, &case.samples, [0.0; 6], |p| {
            let Sample { s, v, a, j, .. } = stroke.at(p);
            [p, 6.0 * case.s_rpm * p, case.x0_mm + s, v, a, j]
        });
    }
}

/// Peaks are magnitudes; the file signs v and a with the stroke. w and a_p are not stored as such: w = π/D,
/// and the peak jerk over the peak acceleration is w again (M5, M6).
fn check_parameters(case: &Case, stroke: &Stroke) {
    let (id, sign, peak) = (&case.id, case.delta_x_mm.signum(), stroke.peak());
    assert_eq!(stroke.length(), case.delta_x_mm, "{id}");
    parameter(&format!("{id}: p_acc"), stroke.duration(), case.p_acc_s);
    parameter(&format!("{id}: dp1"), 0.5 * stroke.duration(), case.dp1_s);
    parameter(&format!("{id}: omega"), peak.j / peak.a, case.omega_rad_s);
    parameter(&format!("{id}: a_p"), sign * peak.a, case.a_p_mm_s2);
    parameter(&format!("{id}: v_peak"), sign * peak.v, case.v_peak_mm_s);
    parameter(&format!("{id}: j_peak"), peak.j, case.j_peak_mm_s3);
    parameter(&format!("{id}: dj_peak"), peak.dj, case.dj_peak_mm_s4);
}

fn check_chain_rule(case: &Case, stroke: &Stroke) {
    let rule = &case.chain_rule;
    let driven = stroke.at(rule.p_s).driven([rule.r, rule.r_dot_1_s, 0.0, 0.0]);
    close(&format!("{}: chain rule v", case.id), driven.v, rule.v_mm_s, case.v_peak_mm_s.abs(), 1e-9);
    close(&format!("{}: chain rule a", case.id), driven.a, rule.a_mm_s2, case.a_p_mm_s2.abs(), 1e-9);
}
