//! What is misprinted in the published examples. In: a computed row. Out: the printed figure, the right one,
//! the reason.
//!
//! Equations (16) and (6) of the source give t1 ≥ π J/DJ; its (17) is printed with 4π. So its (18),
//! sqrt(A DJ/2π), is half of sqrt(2 A DJ/π) (M19), and the examples evaluate (18).

use motion::{Limits, Ramp};
use serde::Serialize;

use super::{LIMITS, Row};
use report::table::six;

/// One figure that is not right in print.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Correction {
    /// Which figure, with its unit.
    figure: &'static str,
    printed: &'static str,
    right: String,
    why: String,
}

impl Correction {
    pub(super) fn sentence(&self) -> String {
        let Correction { figure, printed, right, why } = self;
        format!("{figure}: printed {printed}, right {right}. {why}")
    }
}

/// The corrections of a published example, its `row` computed.
pub(super) fn of(example: usize, row: &Row) -> Vec<Correction> {
    let mut corrections = vec![jerk_bound(match example {
        1 | 2 => "Nothing else changes: j_max is lower.",
        _ => "Nothing else changes: for so small a change of feed the jerk rate alone gives a lower bound.",
    })];
    if example == 1 {
        let feeds = [row.start.t1, row.start.t2, row.start.t_p].map(|t| six(row.block.at(t).v));
        corrections.push(Correction {
            figure: "feed at t1, t2, t_p in m/s",
            printed: "0.0595 and 0.1",
            right: feeds.join(", "),
            why: "The speeds of example 2 are printed a second time.".into(),
        });
    }
    corrections
}

/// The jerk at which a pulse up to a_max keeps dj_max, the second bound of (22).
fn jerk_bound(consequence: &str) -> Correction {
    let without_jerk = Limits { j: f64::INFINITY, ..LIMITS };
    Correction {
        figure: "bound of j_p by a_max and dj_max in m/s³",
        printed: "5.64",
        right: six(Ramp::peak_jerk(f64::INFINITY, &without_jerk).0),
        why: format!(
            "(17) is printed with 4π for π, so (18), which is used, gives half of it. {consequence}"
        ),
    }
}
