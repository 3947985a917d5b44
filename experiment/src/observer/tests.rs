//! The observer alone: the figures of the reference, and what coarse and fine encoders leave at 0.2 1/min.

use super::{
    Case, LINES, PRINTED,
    alone::{self, Kind},
};

/// What an observer leaves of a change of speed with nothing rounded: a bound from below for every encoder.
fn lag(bandwidth_hz: f64, case: Case) -> f64 {
    alone::errors(Kind::Plain, 250_000, bandwidth_hz, case).typical_um
}

/// Within 20 %, or apart for a reason that can be seen: the reference is below what sharp corners of the
/// speed leave with nothing rounded, or rounding comes on top; at constant speed rounding beats with the
/// cycle.
#[test]
fn the_reference_is_reproduced_or_the_difference_explained() {
    let mut within = 0;
    for (lines, bandwidth_hz, printed) in PRINTED {
        for (case, printed) in Case::ALONE.into_iter().zip(printed) {
            let found = alone::errors(Kind::Plain, lines, bandwidth_hz, case).typical_um;
            let what = format!("{lines} lines, {bandwidth_hz} Hz, {case:?}: {found} for {printed}");
            if (found - printed).abs() <= 0.2 * printed + 0.005 {
                within += 1;
                continue;
            }
            match case {
                Case::OverrideRamp | Case::Dip => {
                    assert!(found - printed <= 0.4 * printed + 0.005, "{what}");
                    let lag = lag(bandwidth_hz, case);
                    let rounding = alone::errors(Kind::Plain, lines, bandwidth_hz, Case::Constant).worst_um;
                    assert!(lag > 1.05 * printed || found <= lag + rounding + 0.01, "{what}");
                }
                Case::Constant => assert!(found < 0.4 * 5000.0 / (4.0 * f64::from(lines)), "{what}"),
                Case::Slow | Case::Force => panic!("{what}"),
            }
        }
    }
    assert!(within >= 12, "{within} of 20");
}

/// At 0.2 1/min counts come one by one up to some thousand lines, and half a count is the error; finer ones
/// are averaged.
#[test]
fn counts_that_come_one_by_one_leave_half_a_count() {
    for lines in LINES {
        let half_um = 5000.0 / (8.0 * f64::from(lines));
        let share = alone::errors(Kind::Plain, lines, 30.0, Case::Slow).typical_um / half_um;
        let one_by_one = f64::from(4 * lines) * 0.2 / 60.0 < 2.0 * 30.0;
        let expected = if one_by_one { 0.9..1.4 } else { 0.0..1.1 };
        assert!(expected.contains(&share), "{lines} lines: {share} of half a count");
    }
}
