//! What is misprinted in the published formulas, each by itself: what it is, and what it makes of the next
//! point. In: the works of the reference values. Out: rows of a table, µm.
//!
//! A section is looked at alone where a formula is of one section, so nothing else hides what it does.

use shape::{Section, Sections, Touch};

use super::work::Work;
use report::table::{Column, Table};

/// A misprint, and the largest error of the next point without any correction, with it, and with it put
/// right.
pub(super) struct Misprint {
    pub(super) equation: &'static str,
    pub(super) what: &'static str,
    /// The work, and which error.
    pub(super) of: &'static str,
    /// In µm.
    pub(super) none: f64,
    pub(super) printed: f64,
    pub(super) right: f64,
}

/// Ways of Y and Z of a step `h`.
type Ways = fn(&Sections, f64) -> [f64; 2];

/// How a step starts: along X, along Y (then h is its way), or along the path.
#[derive(Clone, Copy)]
enum Along {
    X,
    Y,
    Path,
    /// Along the path, and the error is that of Y.
    Plan,
}

/// (f′ + τ)/(1 − τ g), which is M39 where g = f′.
fn turned(slope: f64, tau: f64, below: f64) -> f64 {
    (slope + tau) / (1.0 - tau * below)
}

/// A misprint: equation, in words, along what, and the ways without a correction, as printed and put right.
type Case = (&'static str, &'static str, Along, [Ways; 3]);

const CASES: [Case; 6] = [
    (
        "(14)",
        "−τ for +τ",
        Along::X,
        [
            |s, h| [0.0, s.xoz.slope * h],
            |s, h| [0.0, s.xoz.printed(h) * h],
            |s, h| [0.0, s.xoz.corrected(h) * h],
        ],
    ),
    (
        "(15)",
        "−τ for +τ",
        Along::Y,
        [|s, k| [k, s.yoz.slope * k], |s, k| [k, s.yoz.printed(k) * k], |s, k| [k, s.yoz.corrected(k) * k]],
    ),
    (
        "(15)",
        "angle of XOZ",
        Along::Y,
        [
            |s, k| [k, s.yoz.slope * k],
            |s, k| [k, turned(s.yoz.slope, s.xoz.turn(k), s.yoz.slope) * k],
            |s, k| [k, s.yoz.corrected(k) * k],
        ],
    ),
    (
        "(16)",
        "−τ for +τ",
        Along::Plan,
        [
            |s, h| [s.xoy.slope * h, 0.0],
            |s, h| [s.xoy.printed(h) * h, 0.0],
            |s, h| [s.xoy.corrected(h) * h, 0.0],
        ],
    ),
    (
        "(16)",
        "Z_X below",
        Along::Plan,
        [
            |s, h| [s.xoy.slope * h, 0.0],
            |s, h| [turned(s.xoy.slope, s.xoy.turn(h), s.xoz.slope) * h, 0.0],
            |s, h| [s.xoy.corrected(h) * h, 0.0],
        ],
    ),
    (
        "(17)",
        "no Z_XY",
        Along::Path,
        [
            |s, h| [s.xoy.slope * h, (s.xoz.slope + s.yoz.slope * s.xoy.slope) * h],
            |s, h| {
                let k = s.xoy.corrected(h) * h;
                [k, s.xoz.corrected(h) * h + s.yoz.corrected(k) * k]
            },
            |s, h| {
                let k = s.xoy.corrected(h) * h;
                [k, s.xoz.corrected(h) * h + (s.yoz.corrected(k) + s.mixed * h) * k]
            },
        ],
    ),
];

/// Sections of a work at a place, X leading; `None` on a plane curve.
pub(super) fn sections(work: &Work, t: f64) -> Option<Sections> {
    let place = work.place(t);
    let Touch { slope: [zx, zy], second: [zxx, mixed, zyy], .. } = place.surface?;
    let section = |slope, second| Section { slope, second, third: 0.0 };
    let xoy = Section::of(&place.path[0], &place.path[1]);
    Some(Sections { xoz: section(zx, zxx), yoz: section(zy, zyy), xoy, mixed })
}

/// Largest error of the next point of a work with these ways, µm.
fn worst(work: &Work, along: Along, ways: Ways) -> f64 {
    let (h, [from, to]) = (work.text.h_mm, work.text.t);
    let steps = ((to - from) / h + 1e-9).floor() as u32;
    let error = |n: u32| {
        let t = from + h * f64::from(n);
        let sections = sections(work, t)?;
        let [x, y, z] = work.point(t);
        let [dy, dz] = ways(&sections, h);
        let dx = if matches!(along, Along::Y) { 0.0 } else { h };
        Some(match along {
            Along::Plan => y + dy - work.point(t + h)[1],
            _ => work.over([x + dx, y + dy, z + dz])[0],
        })
    };
    (0..steps).filter_map(error).map(|error| 1e3 * error.abs()).fold(0.0, f64::max)
}

/// Every misprint on the surface that is given.
pub(super) fn all(work: &Work) -> Vec<Misprint> {
    let case = |&(equation, what, along, [none, printed, right]): &Case| {
        let [none, printed, right] = [none, printed, right].map(|ways| worst(work, along, ways));
        let of = match along {
            Along::X => "Z, step along X",
            Along::Y => "Z, step along Y",
            Along::Path => "Z, step along the path",
            Along::Plan => "Y of the path",
        };
        Misprint { equation, what, of, none, printed, right }
    };
    CASES.iter().map(case).collect()
}

/// Micrometres in three significant digits.
fn um(value: f64) -> String {
    super::three(value)
}

pub(super) fn table(work: &Work, misprints: &[Misprint]) -> Table {
    let columns: [Column<Misprint>; 7] = [
        Column { name: "equation", unit: "", cell: |row| row.equation.into() },
        Column { name: "misprint", unit: "", cell: |row| row.what.into() },
        Column { name: "error of", unit: "", cell: |row| row.of.into() },
        Column { name: "no correction", unit: "µm", cell: |row| um(row.none) },
        Column { name: "as printed", unit: "µm", cell: |row| um(row.printed) },
        Column { name: "put right", unit: "µm", cell: |row| um(row.right) },
        Column { name: "printed / right", unit: "", cell: |row| super::three(row.printed / row.right) },
    ];
    Table::of("The misprints one by one: largest error of the next point", &columns, misprints).with_caption(format!(
        "Path {} on z = {}, steps of {} mm in X. Each line has one misprint and nothing else; a section is looked at \
         alone, on a step along its own axis.",
        work.text.path[1], work.text.psi, work.text.h_mm
    ))
}
