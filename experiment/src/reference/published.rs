//! What the reference simulation printed. Out: for each structure at 100, 80 and 60 % of override least and
//! largest servo error of X in the approach, at its end and the largest magnitude in the thread, µm, as they
//! were printed.

use machine::Feedforward;

/// Positions of the override knob, per cent.
pub(super) const OVERRIDES: [f64; 3] = [100.0, 80.0, 60.0];

/// The angle that a structure sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Angle {
    /// Counts of 1024 lines, as they come.
    Raw,
    /// By an observer of 30 Hz.
    Observed,
    /// By one of 15 Hz, from 2500 lines.
    Fine,
}

/// A structure and what was printed of it.
pub(super) struct Structure {
    pub(super) name: &'static str,
    pub(super) feedforward: Feedforward,
    pub(super) angle: Angle,
    /// Whether friction is fed forward where the structure does that.
    pub(super) friction: bool,
    /// Whether loop and reference go on every 1 ms; else every 0.5 ms.
    pub(super) held: bool,
    /// At each of [`OVERRIDES`].
    pub(super) printed: [[&'static str; 4]; 3],
}

const fn structure(
    name: &'static str,
    feedforward: Feedforward,
    angle: Angle,
    printed: [[&'static str; 4]; 3],
) -> Structure {
    let held =
        matches!(feedforward, Feedforward::None | Feedforward::DifferenceV | Feedforward::DifferenceVa);
    Structure { name, feedforward, angle, friction: true, held, printed }
}

/// Every row of the printed table.
pub(super) const STRUCTURES: [Structure; 9] = [
    structure(
        "no feedforward",
        Feedforward::None,
        Angle::Observed,
        [["0", "796", "77", "28"], ["0", "649", "39", "12"], ["0", "494", "16", "3"]],
    ),
    structure(
        "raw angle, differences, v",
        Feedforward::DifferenceV,
        Angle::Raw,
        [["-19", "19", "6.7", "3.6"], ["-11", "12", "4.0", "1.5"], ["-6.3", "6.4", "1.7", "0.4"]],
    ),
    structure(
        "raw angle, differences, v + a",
        Feedforward::DifferenceVa,
        Angle::Raw,
        [["-6.8", "8.5", "-2.7", "2.1"], ["-5.0", "6.1", "-1.9", "1.2"], ["-3.8", "4.1", "-1.3", "0.6"]],
    ),
    structure(
        "observer, differences, v + a",
        Feedforward::DifferenceVa,
        Angle::Observed,
        [["-6.6", "8.0", "-2.7", "2.1"], ["-5.1", "6.1", "-2.1", "1.3"], ["-4.0", "3.8", "-1.1", "0.5"]],
    ),
    structure(
        "analytic, v",
        Feedforward::AnalyticV,
        Angle::Observed,
        [["-12", "13", "9.4", "4.5"], ["-6.9", "7.7", "5.3", "2.0"], ["-3.5", "4.3", "2.4", "0.5"]],
    ),
    structure(
        "analytic, v + a, no leads",
        Feedforward::AnalyticVaNoLead,
        Angle::Observed,
        [["-3.8", "3.8", "0.9", "0.1"], ["-2.6", "2.4", "0.5", "0.1"], ["-1.7", "1.7", "0.3", "0.04"]],
    ),
    Structure {
        friction: false,
        ..structure(
            "analytic, v + a with leads",
            Feedforward::Full,
            Angle::Observed,
            [["-1.3", "2.1", "0.0", "0.04"], ["-0.9", "2.1", "0.1", "0.04"], ["-0.7", "2.0", "0.2", "0.04"]],
        )
    },
    structure(
        "the same with friction",
        Feedforward::Full,
        Angle::Observed,
        [["-1.3", "1.1", "0.3", "0.1"], ["-1.0", "1.1", "0.3", "0.1"], ["-0.9", "1.1", "0.2", "0.04"]],
    ),
    structure(
        "the same, tight loops, 2500 lines",
        Feedforward::Full,
        Angle::Fine,
        [["-0.5", "1.0", "0.1", "0.04"], ["-0.5", "0.5", "0.1", "0.04"], ["-0.9", "1.0", "0.0", "0.04"]],
    ),
];

/// How far the slide of X is off 1.35 s into the thread in the reference, µm: as it is; without the damping
/// of the bristles; without the breakaway of the screw, too.
pub(super) const CREEP_UM: [f64; 3] = [1.55, 1.10, 0.98];
