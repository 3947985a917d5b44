//! A seam: where the beam is on the part, and the direction that is turned towards it. In: t. Out: the axes
//! of the positioner that bring the seam under the beam (mm, degrees), with their derivatives.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | p, l | mm, – | point and direction in the frame of the work-holder |
//! | h | mm | way along the axis of a surface, from its point `at` |
//! | ρ | mm | distance from that axis |
//! | e(t) | – | unit vector across the axis of the first surface, at the angle t |
//! | n₁, n₂ | – | outward unit normals; θ the angle between them, σ the share of it |
//! | c | – | by what a direction is moved so that it goes through ±Z |
//!
//! ```text
//! p = at + r e(t) + h (axis + k e(t)),   F(p) = c0 + c1 h₂ + c2 h₂² + c3 ρ₂² = 0:  A h² + B h + C = 0  (M92)
//! h = 2C/(−B ∓ √(B² − 4AC)) = (−B ± √…)/2A,   l = sin((1 − σ)θ) n₁ + sin(σθ) n₂
//! l′ = (lx − cx lz, ly − cy lz, lz), ±Z where (lx, ly) = c lz, off by 2 atan(|c|/2) at most           (M239)
//! ```
//! The first form serves where A = 0, too: a plane, or a generator along an asymptote. Axes by M49; `lean`
//! has their angles.

mod lean;

use lean::{Angles, Lean};
use serde::{Deserialize, Serialize};

use crate::number::{Function, Number};
use crate::positioner::nearest_turn;
use crate::{Branch, Curve, Formula, Point, Positioner, Series};

/// Where a direction is ±Z it is looked at in another place, too, this share of the seam away.
const BESIDE: f64 = 1e-3;

/// Three coordinates as functions of t.
type Vector = [Series; 3];

/// Position and direction in the frame of the work-holder, as functions of t. The direction need not be of
/// length 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)] // fixed size is the point: the queue of machine code holds it by value
pub enum SeamCurve {
    /// Formulas 0 … 2 are x, y, z in mm, 3 … 5 the direction.
    Formulas,
    /// Polynomials of t for the same six, constant first.
    Polynomials([[f64; 8]; 6]),
    /// Where two surfaces meet; t is the angle about the axis of the first, rad.
    Meeting(Meeting),
}

/// Where a cylinder or cone, generator by generator, meets a second surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meeting {
    /// The cylinder or cone.
    pub first: Ruled,
    /// The other.
    pub second: Quadric,
    /// A generator pierces the second surface twice: where it leaves its inside as h grows, else where it
    /// enters.
    pub leaving: bool,
    /// Direction between both outward normals: 0 that of the first, 1 that of the second, 1/2 the bisector.
    pub share: f64,
}

/// A cylinder or cone about an axis: at the way h along the axis its radius is `radius_mm + slope·h`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ruled {
    /// A point of the axis, h = 0, mm.
    pub at: [f64; 3],
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// Unit vector across it, where t = 0; t grows counterclockwise as seen against the axis.
    pub zero: [f64; 3],
    /// Radius at h = 0, mm.
    pub radius_mm: f64,
    /// Growth of the radius with h; 0 for a cylinder.
    pub slope: f64,
}

/// A surface of the second order about an axis: with the way h along it and the distance ρ from it, the
/// points where `c0 + c1 h + c2 h² + c3 ρ² = 0`. What is positive is outside.
///
/// | | c0 | c1 | c2 | c3 |
/// |---|---|---|---|---|
/// | plane, outside where the axis points | 0 | 1 | 0 | 0 |
/// | sphere | −R² | 0 | 1 | 1 |
/// | cylinder | −R² | 0 | 0 | 1 |
/// | cone of radius R + k h | −R² | −2 R k | −k² | 1 |
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quadric {
    /// A point of the axis, h = 0, mm.
    pub at: [f64; 3],
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// The four coefficients.
    pub c: [f64; 4],
}

/// A seam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seam {
    /// Where it runs.
    pub curve: SeamCurve,
    /// t at the start and at the end.
    pub t: [f64; 2],
    /// Which of both solutions of M49 it is at the start; where the direction begins with ±Z, just behind it.
    /// A direction that goes through ±Z takes it from one to the other.
    pub branch: Branch,
    /// β where the direction is ±Z all along the seam and any would do, degrees.
    pub idle_beta_deg: f64,
    /// c of M239: the axes follow a direction that goes through ±Z where that of the curve passes closely.
    pub moved: Option<[f64; 2]>,
}

/// A seam on its positioner, as a [`Curve`] of the parameter of the seam. Axes: x, y, α, β. Its tip is the
/// point of the seam: the beam travels along it.
#[derive(Clone, Copy, Debug)]
pub struct SeamPath<'a> {
    seam: &'a Seam,
    formulas: &'a [Formula],
    positioner: Positioner,
    beam: [f64; 2],
}

impl Seam {
    /// The axes of a positioner along the seam; its beam stands at `beam` (xA, yA), mm. The first six
    /// formulas count, if the seam is of formulas; where they lack it is nowhere.
    #[must_use]
    pub fn on<'a>(&'a self, formulas: &'a [Formula], positioner: Positioner, beam: [f64; 2]) -> SeamPath<'a> {
        SeamPath { seam: self, formulas, positioner, beam }
    }
}

impl SeamPath<'_> {
    /// Point and direction at t that the axes follow: that of the curve, moved if it shall be.
    fn followed(&self, t: f64) -> [Vector; 2] {
        let [point, direction @ [x, y, z]] = self.place(t);
        let moved = self.seam.moved.map(|[cx, cy]| [x - z * cx, y - z * cy, z]);
        [point, moved.unwrap_or(direction)]
    }

    /// Point and direction of the curve at t, in the frame of the work-holder.
    #[must_use]
    pub fn place(&self, t: f64) -> [[Series; 3]; 2] {
        let t = Series::variable(t);
        match &self.seam.curve {
            SeamCurve::Formulas => {
                let of = |i: usize| {
                    let nowhere = Series::constant(f64::NAN);
                    self.formulas.get(i).map_or(nowhere, |formula| formula.eval([t, Series::default()]))
                };
                [[of(0), of(1), of(2)], [of(3), of(4), of(5)]]
            }
            SeamCurve::Polynomials(all) => {
                let [x, y, z, lx, ly, lz] = all.map(|c| polynomial(&c, t));
                [[x, y, z], [lx, ly, lz]]
            }
            SeamCurve::Meeting(meeting) => meeting.place(t),
        }
    }

    /// How the direction leans at t.
    fn lean(&self, t: f64, direction: &Vector) -> Lean {
        let [from, to] = self.seam.t;
        let fourth = || {
            // Into the seam: beyond its ends a formula need not have a value.
            let eta = BESIDE * (to - from) * if (t - from).abs() < (to - t).abs() { 1.0 } else { -1.0 };
            let [_, beside] = self.followed(t + eta);
            [0, 1].map(|i| lean::fourth(direction[i], beside[i], eta))
        };
        Lean::of(*direction, (to - from).signum(), self.seam.idle_beta_deg.to_radians(), fourth)
    }

    /// M49 for series: what [`Positioner::inverse`] finds at a place.
    fn axes(&self, [x, y, z]: Vector, angles: &Angles) -> [Series; 4] {
        let Positioner { x1, y1, x2, y2, z2, .. } = self.positioner;
        let constant = Series::constant;
        let ([alpha, beta], [sa, ca], [sb, cb]) = (angles.degrees, angles.tilt, angles.turn);
        let (w, q) = (constant(y2) + y * cb - x * sb, x * cb + y * sb);
        let height = constant(z2) + z;
        [
            constant(self.beam[0] - x1 - x2) - q,
            constant(self.beam[1] - y1) - ca * w - sa * height,
            alpha,
            beta,
        ]
    }

    /// The branch on which the axes go on at t from where they are: X, Y, A, C in mm and degrees.
    #[must_use]
    pub fn branch_near(&self, t: f64, [_, _, alpha, beta]: &[f64; 4]) -> Branch {
        let [_, direction] = self.followed(t);
        self.lean(t, &direction).branch_near([*alpha, *beta])
    }
}

impl Curve<4> for SeamPath<'_> {
    /// On the branch of the seam, both angles within ±180°.
    fn at(&self, t: f64) -> Point<4> {
        let [point, direction] = self.followed(t);
        let angles = self.lean(t, &direction).angles(self.seam.branch);
        Point { axes: self.axes(point, &angles), tip: point }
    }

    /// At the start on the branch of the seam, behind it on that which is nearest, so α goes through 0 with
    /// the direction; angles by the turns that are nearest.
    fn near(&self, t: f64, here: &[f64; 4]) -> Point<4> {
        let [point, direction] = self.followed(t);
        let lean = self.lean(t, &direction);
        let [_, _, alpha, beta] = *here;
        let starts = t == self.seam.t[0];
        let branch = if starts { self.seam.branch } else { lean.branch_near([alpha, beta]) };
        let mut axes = self.axes(point, &lean.angles(branch));
        for (axis, here) in axes.iter_mut().zip(here).skip(2) {
            axis.0[0] = nearest_turn(axis.0[0], *here, 360.0);
        }
        Point { axes, tip: point }
    }
}

/// A polynomial, constant first.
fn polynomial(c: &[f64], t: Series) -> Series {
    c.iter().rev().fold(Series::default(), |sum, c| sum * t + Series::constant(*c))
}

fn add(a: &Vector, b: &Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(a: &Vector, factor: Series) -> Vector {
    a.map(|c| c * factor)
}

fn constant(a: &[f64; 3]) -> Vector {
    a.map(Series::constant)
}

fn dot(a: &Vector, b: &Vector) -> Series {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: &Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|c| c / length)
}

impl Ruled {
    /// e(t).
    fn across(&self, t: Series) -> Vector {
        let ([ax, ay, az], [ux, uy, uz]) = (self.axis, self.zero);
        let side = [ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux];
        let (c, s) = (t.apply(Function::Cos), t.apply(Function::Sin));
        add(&scaled(&constant(&self.zero), c), &scaled(&constant(&side), s))
    }
}

impl Meeting {
    /// M92.
    fn place(&self, t: Series) -> [Vector; 2] {
        let Meeting { first, second, .. } = self;
        let across = first.across(t);
        let slope = Series::constant(first.slope);
        let along = add(&constant(&first.axis), &scaled(&across, slope));
        let foot = add(&constant(&first.at), &scaled(&across, Series::constant(first.radius_mm)));
        let h = second.pierced(&foot, &along, self.leaving);
        let point = add(&foot, &scaled(&along, h));
        let one = unit(&add(&across, &scaled(&constant(&first.axis), -slope)));
        let other = unit(&second.normal(&point));
        let angle = dot(&one, &other).apply(Function::Acos);
        let part = |share: f64| (angle * share).apply(Function::Sin);
        [point, add(&scaled(&one, part(1.0 - self.share)), &scaled(&other, part(self.share)))]
    }
}

impl Quadric {
    /// Where a line meets the surface, as a multiple of `along`.
    fn pierced(&self, foot: &Vector, along: &Vector, leaving: bool) -> Series {
        let [c0, c1, c2, c3] = self.c;
        let axis = constant(&self.axis);
        let from = add(foot, &constant(&self.at.map(|mm| -mm)));
        let (h0, h1) = (dot(&from, &axis), dot(along, &axis));
        // ρ² = p² − h²
        let (own, rest) = (Series::constant(c2 - c3), Series::constant(c3));
        let a = own * h1 * h1 + rest * dot(along, along);
        let b = (own * h0 * h1 + rest * dot(&from, along)) * 2.0 + h1 * c1;
        let c = own * h0 * h0 + rest * dot(&from, &from) + h0 * c1 + Series::constant(c0);
        let root = (b * b - a * c * 4.0).sqrt();
        // F grows where the line leaves: there 2 A h + B = √…; of both forms of a root the one that does not
        // cancel.
        let (sign, outwards) = if leaving { (1.0, b.value() >= 0.0) } else { (-1.0, b.value() <= 0.0) };
        if outwards { -(c * 2.0) / (b + root * sign) } else { (root * sign - b) / (a * 2.0) }
    }

    /// Gradient of F, outwards.
    fn normal(&self, point: &Vector) -> Vector {
        let [_, c1, c2, c3] = self.c;
        let axis = constant(&self.axis);
        let from = add(point, &constant(&self.at.map(|mm| -mm)));
        let h = dot(&from, &axis);
        let along = h * (2.0 * (c2 - c3)) + Series::constant(c1);
        add(&scaled(&from, Series::constant(2.0 * c3)), &scaled(&axis, along))
    }
}
