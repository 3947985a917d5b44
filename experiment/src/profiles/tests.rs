//! The rows: what the bound promises, what the reference prints, what the page says.

use super::{
    APPROACHES_S, Choice, Mode, Profile, QUIET_UM, Row, STROKE_MM, compared, extremes, largest, modes, rows,
};

#[test]
fn every_figure_of_the_reference_comes_out_to_its_last_digit() {
    let pairs = compared::pairs();
    assert_eq!(pairs.len(), 24);
    for pair in pairs.iter().flatten() {
        let name = pair.profile.name();
        assert!(pair.agrees(), "{name}, {} s: {} for {}", pair.approach_s, pair.got, pair.printed);
    }
}

#[test]
fn there_is_a_row_for_every_case() {
    let rows = rows();
    assert_eq!(rows.len(), 6 * 4 * 61);
    for profile in Profile::ALL {
        for t in APPROACHES_S {
            let of: Vec<&Row> = rows.iter().filter(|r| r.profile == profile && r.approach_s == t).collect();
            assert!(of.iter().map(|row| row.mode_hz).eq(modes(1)), "{} {t}", profile.name());
        }
    }
    let json = serde_json::to_value(&rows[0]).expect("it is plain");
    assert_eq!(json["profile"], "trapezoidal-speed");
    assert!(json["bound_um"].is_null() && json["residual_um"].is_f64());
    let names: Vec<_> = Profile::ALL.iter().map(|law| serde_json::to_value(law).expect("a name")).collect();
    let expected = [
        "trapezoidal-speed",
        "trapezoidal-acceleration",
        "cubic",
        "quintic",
        "sin2-acceleration",
        "sin2-jerk",
    ];
    assert_eq!(names, expected);
}

/// M8a promises for a mode without damping; some damping only helps. Searched in steps of a tenth of a Hz.
#[test]
fn sin2_acceleration_stays_below_its_bound() {
    for t in APPROACHES_S {
        let mut nearest: f64 = 0.0;
        for hz in modes(10) {
            let row = Row::of(Profile::Sin2Acceleration, t, hz);
            let bound = row.bound_um.expect("it has one");
            assert!(row.amplitude_um <= bound, "{t} s, {hz} Hz: {row:?}");
            nearest = nearest.max(row.amplitude_um / bound);
        }
        assert!(nearest > 0.4, "{t} s: the bound says nothing, {nearest}");
    }
}

/// How much the steps of 1 Hz miss of the largest residual of any frequency between.
#[test]
fn the_modes_are_close_enough() {
    let rows = rows();
    for (profile, t) in Profile::ALL.into_iter().flat_map(|law| APPROACHES_S.map(|t| (law, t))) {
        let law = profile.law(STROKE_MM, t);
        let true_largest = modes(10).map(|hz| 1e3 * Mode::at(hz).residual(&law).largest).fold(0.0, f64::max);
        let (of_rows, _) = extremes(&rows, profile, t);
        assert!(of_rows > 0.96 * true_largest, "{} {t}: {of_rows} of {true_largest}", profile.name());
    }
}

/// The order in which the laws become quiet, and that shorter times are not.
#[test]
fn a_smoother_law_is_quiet_earlier() {
    let quiet = |profile| Choice::of(profile).quiet_s().expect("it becomes quiet");
    let times = [
        Profile::Sin2Acceleration,
        Profile::Quintic,
        Profile::TrapezoidalAcceleration,
        Profile::TrapezoidalSpeed,
        Profile::Cubic,
    ]
    .map(quiet);
    assert!(times.is_sorted(), "{times:?}");
    let sin2 = times[0];
    assert!(largest(Profile::Sin2Acceleration, sin2, 1) <= 1.05 * QUIET_UM);
    assert!(largest(Profile::Sin2Acceleration, sin2 - 0.01, 1) > QUIET_UM);
    // The rule of M8a, made for the worst phase and no damping, is on the safe side by less than a third.
    assert!((14.3 / 60.0 - sin2) / sin2 > 0.0 && (14.3 / 60.0 - sin2) / sin2 < 0.34, "{sin2}");
}

#[test]
fn sin2_acceleration_gains_two_to_eight_on_the_quintic() {
    for t in APPROACHES_S {
        let gain = largest(Profile::Quintic, t, 2) / largest(Profile::Sin2Acceleration, t, 2);
        assert!((2.0..8.6).contains(&gain), "{t} s: {gain}");
    }
}
