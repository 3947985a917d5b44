//! `feed_profile.json`: single ramps and whole blocks (M16–M25), in m and s. The files give no speed limit.

use super::values;
use motion::{Binding, FeedBlock, Limits, Ramp, Sample, Unreachable, junction_distance};
use serde::Deserialize;
use std::f64::consts::PI;
use testing::reference::{close, parameter, read, rows};

#[derive(Deserialize)]
struct File {
    schema: String,
    ramps: Vec<RampCase>,
    blocks: Vec<BlockCase>,
}

#[derive(Deserialize)]
struct RampCase {
    id: String,
    f0_m_s: f64,
    f_m_s: f64,
    a_max_m_s2: f64,
    j_max_m_s3: f64,
    dj_max_m_s4: f64,
    binding: String,
    j_p_m_s3: f64,
    t1_s: f64,
    t2_s: f64,
    t_p_s: f64,
    a_peak_m_s2: f64,
    dj_peak_m_s4: f64,
    v_t1_m_s: f64,
    v_t2_m_s: f64,
    s_t1_m: f64,
    s_t2_m: f64,
    s_tp_m: f64,
    columns: Vec<String>,
    samples: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct BlockCase {
    id: String,
    f0_m_s: f64,
    f_m_s: f64,
    f_end_m_s: f64,
    length_m: f64,
    a_max_m_s2: f64,
    j_max_m_s3: f64,
    dj_max_m_s4: f64,
    #[serde(flatten)]
    outcome: Outcome,
}

#[derive(Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
enum Outcome {
    FullFeed(Profile),
    ReducedFeed(Profile),
    EndFeedUnreachable { junction_distance_m: f64, reachable_end_feed_m_s: f64 },
    StartFeedTooHigh { junction_distance_m: f64, admissible_start_feed_m_s: f64 },
}

#[derive(Deserialize)]
struct Profile {
    peak_feed_m_s: f64,
    accel: RampOfBlock,
    cruise_time_s: f64,
    decel: RampOfBlock,
    total_time_s: f64,
    columns: Vec<String>,
    samples: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct RampOfBlock {
    j_p_m_s3: f64,
    t1_s: f64,
    t2_s: f64,
    t_p_s: f64,
    length_m: f64,
}

const COLUMNS: [&str; 6] = ["t_s", "s_m", "v_m_s", "a_m_s2", "j_m_s3", "dj_m_s4"];

fn row(t: f64, sample: Sample) -> [f64; 6] {
    let [s, v, a, j, dj] = values(sample);
    [t, s, v, a, j, dj]
}

#[test]
fn reference_feed_ramps() {
    let file: File = read("feed_profile.json");
    assert_eq!(file.schema, "feed_profile/1");
    assert!(!file.ramps.is_empty(), "no ramps");
    for case in &file.ramps {
        let limits =
            Limits { v: f64::INFINITY, a: case.a_max_m_s2, j: case.j_max_m_s3, dj: case.dj_max_m_s4 };
        let ramp = Ramp::fastest(case.f_m_s - case.f0_m_s, &limits);
        let feed_at = |t: f64| ramp.at(t) + Sample::uniform(case.f0_m_s * t, case.f0_m_s);
        check_ramp(case, &ramp, &limits);
        for (name, t, v, s) in [
            ("t1", case.t1_s, case.v_t1_m_s, case.s_t1_m),
            ("t2", case.t2_s, case.v_t2_m_s, case.s_t2_m),
            ("tp", case.t_p_s, case.f_m_s, case.s_tp_m),
        ] {
            parameter(&format!("{}: v({name})", case.id), feed_at(t).v, v);
            parameter(&format!("{}: s({name})", case.id), feed_at(t).s, s);
        }
        rows(&case.id, COLUMNS, &case.columns, &case.samples, [0.0; 6], |t| row(t, feed_at(t)));
    }
}

fn check_ramp(case: &RampCase, ramp: &Ramp, limits: &Limits) {
    let (id, peak) = (&case.id, ramp.peak());
    let (peak_jerk, binding) = Ramp::peak_jerk(ramp.dv(), limits);
    let name = match binding {
        Binding::Jerk => "jerk",
        Binding::AccelerationAndJerkRate => "accel+djerk",
        Binding::JerkRate => "djerk",
    };
    assert_eq!(name, case.binding, "{id}: binding");
    parameter(&format!("{id}: j_p by M19"), peak_jerk, case.j_p_m_s3);
    parameter(&format!("{id}: j_p"), peak.j, case.j_p_m_s3);
    parameter(&format!("{id}: t1"), ramp.jerk_interval(), case.t1_s);
    parameter(&format!("{id}: t2"), ramp.duration() - ramp.jerk_interval(), case.t2_s);
    parameter(&format!("{id}: t_p"), ramp.duration(), case.t_p_s);
    parameter(&format!("{id}: a_peak"), peak.a, case.a_peak_m_s2);
    parameter(&format!("{id}: dj_peak"), peak.dj, case.dj_peak_m_s4);
}

#[test]
fn reference_feed_blocks() {
    let file: File = read("feed_profile.json");
    assert!(!file.blocks.is_empty(), "no blocks");
    for case in &file.blocks {
        let limits =
            Limits { v: f64::INFINITY, a: case.a_max_m_s2, j: case.j_max_m_s3, dj: case.dj_max_m_s4 };
        let block = FeedBlock::plan(case.length_m, case.f0_m_s, case.f_m_s, case.f_end_m_s, &limits);
        let junction = junction_distance(case.f0_m_s, case.f_end_m_s, &limits);
        let id = &case.id;
        match (&case.outcome, block) {
            (Outcome::FullFeed(want), Ok(block)) => check_block(case, want, &block, true),
            (Outcome::ReducedFeed(want), Ok(block)) => check_block(case, want, &block, false),
            (
                Outcome::EndFeedUnreachable { junction_distance_m, reachable_end_feed_m_s },
                Err(Unreachable::EndFeed { reachable }),
            ) => {
                parameter(&format!("{id}: junction"), junction, *junction_distance_m);
                parameter(&format!("{id}: reachable"), reachable, *reachable_end_feed_m_s);
            }
            (
                Outcome::StartFeedTooHigh { junction_distance_m, admissible_start_feed_m_s },
                Err(Unreachable::StartFeed { admissible }),
            ) => {
                parameter(&format!("{id}: junction"), junction, *junction_distance_m);
                parameter(&format!("{id}: admissible"), admissible, *admissible_start_feed_m_s);
            }
            (_, got) => panic!("{id}: another outcome: {got:?}"),
        }
    }
}

fn check_block(case: &BlockCase, want: &Profile, block: &FeedBlock, full_feed: bool) {
    let id = &case.id;
    assert_eq!(block.reaches_feed(), full_feed, "{id}: status");
    parameter(&format!("{id}: peak feed"), block.peak_feed(), want.peak_feed_m_s);
    close(&format!("{id}: total time"), block.duration(), want.total_time_s, want.total_time_s, 1e-6);
    close(&format!("{id}: cruise"), block.cruise_time(), want.cruise_time_s, want.total_time_s, 1e-6);
    for (name, got, length, want) in [
        ("accel", block.accel(), block.accel_length(), &want.accel),
        ("decel", block.decel(), block.decel_length(), &want.decel),
    ] {
        let check = |field: &str, got: f64, want: f64| {
            close(&format!("{id} {name}: {field}"), got, want, want.abs(), 1e-6);
        };
        check("j_p", got.peak().j, want.j_p_m_s3);
        check("t1", got.jerk_interval(), want.t1_s);
        check("t2", got.duration() - got.jerk_interval(), want.t2_s);
        check("t_p", got.duration(), want.t_p_s);
        check("length", length, want.length_m);
    }
    let j = want.accel.j_p_m_s3.max(want.decel.j_p_m_s3);
    let dj = PI * (want.accel.j_p_m_s3 / want.accel.t1_s).max(want.decel.j_p_m_s3 / want.decel.t1_s);
    let peaks = [0.0, 0.0, 0.0, 0.0, j, dj];
    rows(id, COLUMNS, &want.columns, &want.samples, peaks, |t| row(t, block.at(t)));
}
