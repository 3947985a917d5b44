//! Where the tool touches a surface, seen from above: patterns, and their legs one by one. In: a domain, mm.
//! Out: the leg of a number, whatever came before it, in bounded time.

use serde::{Deserialize, Serialize};

/// How the paths lie over the domain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pattern {
    /// Parallel lines along X, or along Y.
    Lines {
        /// Along Y instead of X.
        along_y: bool,
        /// So many lines fill the domain from border to border, ≥ 2.
        count: u32,
        /// Every other line backwards, joined along the border; else all in one sense, with retracts.
        zigzag: bool,
    },
    /// Along the border of the domain, ring in ring, from outside inwards, joined on the surface. The
    /// innermost is a line, or nothing in a square.
    Rings {
        /// Rings that are rectangles, ≥ 1; their distance is half the shorter side of the domain divided by
        /// it.
        count: u32,
    },
    /// One curve x(t), y(t): formulas 1 and 2.
    Curve {
        /// t at the start and at the end.
        t: [f64; 2],
    },
}

/// One leg of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leg {
    /// The tool touches the surface along this plan.
    Cut(Plan),
    /// Off the surface: from where it is up to `clear_mm`, across, and down at feed to where it touches here.
    Air {
        /// X and Y of the point of contact where the next leg begins, mm.
        to: [f64; 2],
    },
}

/// Where the tool touches, seen from above, as a function of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plan {
    /// Straight from one point to another, mm; the parameter is the way from the first, mm.
    Line {
        /// From here,
        from: [f64; 2],
        /// to here.
        to: [f64; 2],
    },
    /// Formulas 1 and 2 of a parameter.
    Curve {
        /// t at the start and at the end.
        t: [f64; 2],
    },
}

impl Plan {
    /// The parameter at the start and at the end.
    #[must_use]
    pub fn t(&self) -> [f64; 2] {
        match *self {
            Plan::Line { from: [x0, y0], to: [x1, y1] } => [0.0, libm::hypot(x1 - x0, y1 - y0)],
            Plan::Curve { t } => t,
        }
    }
}

impl Pattern {
    /// How many legs it has over a domain: lowest and highest X and Y.
    #[must_use]
    pub fn legs(&self, x: [f64; 2], y: [f64; 2]) -> u32 {
        match *self {
            Pattern::Lines { count, .. } => count.saturating_mul(2).saturating_sub(1),
            Pattern::Rings { count } => {
                let is_square = x[1] - x[0] == y[1] - y[0];
                count.saturating_mul(5).saturating_add(u32::from(!is_square))
            }
            Pattern::Curve { .. } => 1,
        }
    }

    /// Leg `k` over a domain, counted from 0; `None` behind the last.
    #[must_use]
    pub fn leg(&self, x: [f64; 2], y: [f64; 2], k: u32) -> Option<Leg> {
        if k >= self.legs(x, y) {
            return None;
        }
        Some(match *self {
            Pattern::Lines { along_y, count, zigzag } => {
                let line = |k: u32| line(if along_y { [y, x] } else { [x, y] }, count, k, zigzag, along_y);
                match (k % 2, zigzag) {
                    (0, _) => Leg::Cut(Plan::Line { from: line(k / 2)[0], to: line(k / 2)[1] }),
                    (_, true) => Leg::Cut(Plan::Line { from: line(k / 2)[1], to: line(k / 2 + 1)[0] }),
                    (_, false) => Leg::Air { to: line(k / 2 + 1)[0] },
                }
            }
            Pattern::Rings { count } => {
                let [from, to] = side(x, y, count, k / 5, k % 5);
                Leg::Cut(Plan::Line { from, to })
            }
            Pattern::Curve { t } => Leg::Cut(Plan::Curve { t }),
        })
    }
}

/// Start and end of line `k`; `along` and `across` are the domain.
fn line([along, across]: [[f64; 2]; 2], count: u32, k: u32, zigzag: bool, along_y: bool) -> [[f64; 2]; 2] {
    let share = f64::from(k) / f64::from(count.saturating_sub(1).max(1));
    let at = between(across, share);
    let ends = if zigzag && k % 2 == 1 { [along[1], along[0]] } else { along };
    ends.map(|end| if along_y { [at, end] } else { [end, at] })
}

/// Start and end of a side of a ring, counterclockwise from its lowest corner; side 4 leads to the next ring.
/// The ring behind the last rectangle is the line that the domain shrinks to.
fn side(x: [f64; 2], y: [f64; 2], count: u32, ring: u32, side: u32) -> [[f64; 2]; 2] {
    let half = 0.5 * (x[1] - x[0]).min(y[1] - y[0]);
    let inset = |ring: u32| half * f64::from(ring) / f64::from(count.max(1));
    let corner = |ring: u32, corner: u32| {
        let (wide, high) = (matches!(corner, 1 | 2), matches!(corner, 2 | 3));
        let d = inset(ring);
        [if wide { x[1] - d } else { x[0] + d }, if high { y[1] - d } else { y[0] + d }]
    };
    match side {
        4 => [corner(ring, 0), corner(ring + 1, 0)],
        _ if ring == count => [corner(ring, 0), corner(ring, 2)],
        _ => [corner(ring, side), corner(ring, (side + 1) % 4)],
    }
}

/// From the first to the second, both met exactly.
fn between([low, high]: [f64; 2], share: f64) -> f64 {
    low * (1.0 - share) + high * share
}
