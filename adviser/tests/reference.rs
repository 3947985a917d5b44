//! `resolution.json`: positions that are counted, and the steps that feed, acceleration and jerk need
//! (M28–M35).

use adviser::resolution::{Counts, Demand, Required, Steps, counts_per_mm, order, position_mm};
use motion::Ramp;
use serde::Deserialize;
use testing::reference::{close, parameter, read};

#[derive(Deserialize)]
struct File {
    schema: String,
    g_m_s2: f64,
    feed_error: Vec<FeedCase>,
    position_order: Vec<PositionCase>,
    conversion: Vec<ConversionCase>,
    required_resolution: Vec<RequiredCase>,
    start_of_motion: Start,
}

#[derive(Deserialize)]
struct FeedCase {
    feed_mm_min: f64,
    f_cycle_hz: f64,
    k_per_mm: f64,
    v_t: f64,
    v_low: f64,
    v_high: f64,
    err_low_pct: f64,
    err_high_pct: f64,
    err_envelope_pct: f64,
}

#[derive(Deserialize)]
struct PositionCase {
    p_accur_um: f64,
    k_measur: f64,
    dx_min_mm: f64,
    order_floor: i32,
    order_ceil: i32,
    k_floor: f64,
}

#[derive(Deserialize)]
struct ConversionCase {
    feed_mm_min: f64,
    overload_g: f64,
    jerk_m_s3: f64,
    k_per_mm: f64,
    f_cycle_hz: f64,
    v_t: f64,
    a_t: f64,
    j_t: f64,
}

#[derive(Deserialize)]
struct RequiredCase {
    f_max_mm_min: f64,
    f_cycle_hz: f64,
    k_f: f64,
    overload_g: f64,
    k_a: f64,
    j_max_m_s3: f64,
    k_j: f64,
    k_per_mm: f64,
    df_min_mm_cycle: f64,
    df_order_floor: i32,
    d_f: f64,
    da_min_mm_cycle2: f64,
    da_order_floor: i32,
    d_a: f64,
    dj_min_mm_cycle3: f64,
    dj_order_floor: i32,
    d_j: f64,
}

#[derive(Deserialize)]
struct Start {
    columns: Vec<String>,
    rows: Vec<[f64; 3]>,
}

fn file() -> File {
    let file: File = read("resolution.json");
    assert_eq!(file.schema, "resolution/1");
    file
}

#[test]
fn reference_resolution_feed_error() {
    let cases = file().feed_error;
    assert!(!cases.is_empty(), "no cases");
    for case in cases {
        let at = format!("{} mm/min at {} Hz, {}/mm", case.feed_mm_min, case.f_cycle_hz, case.k_per_mm);
        let counts = Counts { per_mm: case.k_per_mm, cycle_hz: case.f_cycle_hz };
        let error = counts.feed_error(case.feed_mm_min);
        parameter(&format!("{at}: v_t"), error.internal, case.v_t);
        assert_eq!((error.low, error.high), (case.v_low, case.v_high), "{at}");
        close(&format!("{at}: low"), error.low_pct, case.err_low_pct, case.err_envelope_pct, 1e-9);
        close(&format!("{at}: high"), error.high_pct, case.err_high_pct, case.err_envelope_pct, 1e-9);
        parameter(&format!("{at}: envelope"), error.envelope_pct, case.err_envelope_pct);
    }
}

#[test]
fn reference_resolution_position_order() {
    let cases = file().position_order;
    assert!(!cases.is_empty(), "no cases");
    for case in cases {
        let at = format!("{} µm", case.p_accur_um);
        let step = position_mm(case.p_accur_um, case.k_measur);
        parameter(&at, step, case.dx_min_mm);
        assert_eq!(order(step), case.order_floor, "{at}");
        assert_eq!(-order(1.0 / step), case.order_ceil, "{at}: the power that is not finer");
        assert_eq!(counts_per_mm(order(step)), case.k_floor, "{at}");
    }
}

#[test]
fn reference_resolution_conversion() {
    let File { g_m_s2, conversion, .. } = file();
    assert!(!conversion.is_empty(), "no cases");
    for case in conversion {
        let at = format!("{} mm/min at {} Hz", case.feed_mm_min, case.f_cycle_hz);
        let counts = Counts { per_mm: case.k_per_mm, cycle_hz: case.f_cycle_hz };
        parameter(&format!("{at}: v_t"), counts.speed(case.feed_mm_min), case.v_t);
        parameter(&format!("{at}: a_t"), counts.acceleration(case.overload_g * g_m_s2), case.a_t);
        parameter(&format!("{at}: j_t"), counts.jerk(case.jerk_m_s3), case.j_t);
    }
}

#[test]
fn reference_resolution_required() {
    let File { g_m_s2, required_resolution, .. } = file();
    assert!(!required_resolution.is_empty(), "no cases");
    for case in required_resolution {
        let demand = Demand {
            tolerance_um: 6.0,
            feed_mm_min: case.f_max_mm_min,
            acceleration_m_s2: case.overload_g * g_m_s2,
            jerk_m_s3: case.j_max_m_s3,
            cycle_hz: case.f_cycle_hz,
        };
        let steps = Steps { feed: case.k_f, acceleration: case.k_a, jerk: case.k_j, ..Steps::PUBLISHED };
        let counts = Counts { per_mm: case.k_per_mm, cycle_hz: case.f_cycle_hz };
        let [_, speed, acceleration, jerk] = Required::of(&demand, &steps).steps();
        for (name, step, want, want_order, want_ratio) in [
            ("feed", speed, case.df_min_mm_cycle, case.df_order_floor, case.d_f),
            ("acceleration", acceleration, case.da_min_mm_cycle2, case.da_order_floor, case.d_a),
            ("jerk", jerk, case.dj_min_mm_cycle3, case.dj_order_floor, case.d_j),
        ] {
            let at = format!("{} mm/min at {} Hz: {name}", case.f_max_mm_min, case.f_cycle_hz);
            parameter(&at, step, want);
            assert_eq!(order(step), want_order, "{at}");
            parameter(&at, counts.discrepancy(step), want_ratio);
        }
    }
}

/// The ramp of the note: J = 5 m/s³, t1 = 0.2 s, so 100 mm/s of change of speed without a middle interval.
#[test]
fn reference_resolution_start_of_motion() {
    let start = file().start_of_motion;
    assert_eq!(start.columns, ["cycle", "position_um", "integer_position"]);
    assert!(!start.rows.is_empty(), "no rows");
    let ramp = Ramp::new(100.0, 0.4, 0.5);
    assert_eq!((ramp.jerk_interval(), ramp.peak().j), (0.2, 5000.0));
    let counts = Counts { per_mm: 1000.0, cycle_hz: 1000.0 };
    for [cycle, position_um, integer] in &start.rows {
        let way_mm = ramp.at(cycle / counts.cycle_hz).s;
        parameter(&format!("cycle {cycle}"), 1e3 * way_mm, *position_um);
        assert_eq!(counts.cut(way_mm), *integer, "cycle {cycle}");
    }
    let first = start.rows.iter().find(|row| row[2] > 0.0).expect("it moves").map(|value| value as u32)[0];
    assert_eq!(counts.first_seen(1000, |t| ramp.at(t).s), Some(first));
    assert_eq!(counts.first_seen(first - 1, |t| ramp.at(t).s), None);
}
