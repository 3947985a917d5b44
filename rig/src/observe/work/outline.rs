//! How far a round tool is from touching a plane contour. In: where its axis is, mm. Out: the deviation, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | x, f | mm | a point of the contour |
//! | c | mm | axis of the tool |
//! | n | – | normal of the contour, to the left of the way the contour is followed |
//! | ρ | mm | radius of the tool, 0 for one on the contour |
//!
//! ```text
//! (cₓ − x) + (c_y − f) f′ = 0,   d = (c − (x, f))·n        the nearest point (M96 in a plane)
//! deviation: d on the contour, d − ρ left of it, −d − ρ right of it
//! ```
//! So beside the contour, positive is away from it.

use shape::{Contour, Formula, Number, Series, Side};

const STEPS: usize = 20;
const RESIDUAL_MM: f64 = 1e-7;
/// Places along the contour at which the nearest point is searched for when there is none to start from.
const STARTS: u32 = 64;

/// Measures a tool against a contour.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    formula: Formula,
    contour: Contour,
    last: Option<f64>,
}

impl Outline {
    pub(super) fn new(formula: Formula, contour: Contour) -> Outline {
        Outline { formula, contour, last: None }
    }

    /// Forgets where it was last.
    pub(super) fn lift(&mut self) {
        self.last = None;
    }

    /// Deviation of a tool there, mm; `None` if no nearest point is found.
    pub(super) fn deviation_mm(&mut self, c: [f64; 2]) -> Option<f64> {
        let near = self.last.and_then(|last| self.solve(c, last));
        let (d, x) = near.or_else(|| self.search(c))?;
        self.last = Some(x);
        let ([from, to], radius) = (self.contour.x, self.contour.radius_mm);
        let left = if to < from { -d } else { d };
        Some(match self.contour.side {
            Side::On => left,
            Side::Left => left - radius,
            Side::Right => -left - radius,
        })
    }

    /// The nearest of all points that are nearer than their neighbours.
    fn search(&self, c: [f64; 2]) -> Option<(f64, f64)> {
        let [from, to] = self.contour.x;
        let start = |i: u32| from + (to - from) * f64::from(i) / f64::from(STARTS);
        let found = (0..=STARTS).map(start).chain([c[0]]).filter_map(|start| self.solve(c, start));
        found.min_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))
    }

    /// Distance, positive above, and x of the nearest point.
    fn solve(&self, c: [f64; 2], start: f64) -> Option<(f64, f64)> {
        let most = (0.1 * (self.contour.x[1] - self.contour.x[0])).abs();
        let mut x = start;
        for _ in 0..STEPS {
            let f = self.formula.eval([Series::variable(x), Series::constant(0.0)]);
            let (across, up, slope) = (c[0] - x, c[1] - f.value(), f.derivative(1));
            let left = across + up * slope;
            let bend = 1.0 + slope * slope - up * f.derivative(2);
            if left.abs() <= RESIDUAL_MM {
                let d = (up - across * slope) / libm::sqrt(1.0 + slope * slope);
                return (bend > 0.0).then_some((d, x));
            }
            x += (left / bend).clamp(-most, most);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::Outline;
    use shape::{Contour, Formula, Function, Op, Side};

    /// `5 sin(x/8)` from 0 to 60 mm, or back.
    fn sine(side: Side, x: [f64; 2]) -> Outline {
        let ops = [
            Op::Constant(5.0),
            Op::Variable(0),
            Op::Constant(8.0),
            Op::Div,
            Op::Apply(Function::Sin),
            Op::Mul,
        ];
        let radius_mm = if side == Side::On { 0.0 } else { 2.0 };
        Outline::new(Formula::new(&ops).expect("complete"), Contour { x, radius_mm, side })
    }

    #[test]
    fn a_tool_beside_the_contour_is_as_far_as_it_is() {
        let cases = [
            (Side::On, [0.0, 60.0], 1.0),
            (Side::Left, [0.0, 60.0], 1.0),
            (Side::Right, [0.0, 60.0], -1.0),
            (Side::On, [60.0, 0.0], -1.0),
            (Side::Left, [60.0, 0.0], -1.0),
            (Side::Right, [60.0, 0.0], 1.0),
        ];
        for (side, x, above) in cases {
            let mut outline = sine(side, x);
            let radius = outline.contour.radius_mm;
            for step in 0..=120 {
                let (at, d) = (0.5 * f64::from(step), 1e-3 * f64::from(step % 7) - 3e-3);
                let (sin, cos) = libm::sincos(at / 8.0);
                let normal = (1.0 + (0.625 * cos).powi(2)).sqrt();
                let off = above * (radius + d);
                let c = [at - off * 0.625 * cos / normal, 5.0 * sin + off / normal];
                let found = outline.deviation_mm(c).expect("there is a nearest point");
                assert!((found - d).abs() <= 1e-11, "{side:?} {x:?} {at}: {found} for {d}");
            }
        }
    }
}
