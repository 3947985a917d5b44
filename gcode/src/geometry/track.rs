//! The way of the tool's centre beside a contour: offsets of lines and arcs, and the corners between them.
//!
//! All in one plane, first axis and second axis; lengths in one unit, angles in radians.
//!
//! | symbol | meaning |
//! |---|---|
//! | r | radius of the tool, > 0 |
//! | σ | side of the tool seen along the contour: +1 left, -1 right |
//! | t | unit vector of travel |
//! | n | unit vector from the contour to the centre of the tool |
//! | J | quarter turn to the left: J (x, y) = (-y, x) |
//! | ε | sense of an arc: +1 counterclockwise, -1 clockwise; σε = 1 is a tool inside the arc |
//! | m, R, ρ | centre of an arc, its radius, radius of the way of the tool's centre |
//! | γ | angle of a corner, > 0 where the contour turns towards the tool |
//! | κ | curvature towards the tool: σε/R, 0 for a line |
//!
//! ```text
//! n = σ J t                                           (O1)
//! c = p + r n                                         (O2)  centre of the tool at p
//! ρ = R - σε r,  R > r if σε = 1                      (O3)
//! γ = σ atan2(t0 × t1, t0 · t1)                       (O4)
//! p + r (n0 - tan(γ/2) t0)                            (O5)  inside corner of two lines
//! f ± √(ρ² - |m - f|²) t,  f = q + ((m - q) · t) t    (O6)  line through q along t, and a circle
//! m0 + x u ± √(ρ0² - x²) J u,                         (O7)  two circles, u from m0 to m1, D apart
//!     x = (ρ0² + D² - ρ1²) / 2D
//! σ (t0 × t1) > 0                                     (O8)  which of two points is the corner
//! e + |c - e| / (2 cos φ) u                           (O9)  centre of an entry arc from c to e,
//!                                                           u from e to m, φ from u to c - e
//! ```
//! Unit vectors come from angles, and O5 is a way back from p + r n0, so that values which are exact in the
//! drawing are rounded as LinuxCNC rounds them. O8 follows from the corner being an inside one: there the way
//! turns towards the tool. It gives the sign in O6 (line to arc: σε, arc to line: -σε) and in O7 (σ ε0 ε1). A
//! contour that turns back by half a turn has an inside corner if its arms part on the side of the tool, κ0 +
//! κ1 < 0; else the tool goes around its tip.

use libm::{atan2, cos, sin, sqrt, tan};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// First axis and second axis of the plane.
pub(crate) use crate::plane::Point;
use crate::plane::{add, cross, dot, length, scale, sub};

/// Corners within this angle of tangent, or of turning back, are taken as such. LinuxCNC's value, radians.
pub(crate) const TANGENT: f64 = 0.05;
/// Rounding of lengths and angles that does not count as a gouge.
const ROUNDING: f64 = 1e-9;
/// Angles that fall short of a full turn by less are rounding of 0.
const SAME_ANGLE: f64 = 1e-6;

/// Side of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// G41.
    Left,
    /// G42.
    Right,
}

impl Side {
    /// σ.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }

    /// O1: n of the straight way from one point to another.
    pub(crate) fn normal(self, from: Point, to: Point) -> Point {
        polar(angle(sub(to, from)) + self.sign() * FRAC_PI_2)
    }
}

/// An element of a contour, as programmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Element {
    /// Its start.
    pub(crate) from: Point,
    /// Its end.
    pub(crate) to: Point,
    /// Centre and turns (as [`crate::canon::Arc::turns`]) of an arc; `None` for a line, which has a length
    /// then.
    pub(crate) arc: Option<(Point, i32)>,
}

/// What the centre of the tool moves on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Path {
    /// t.
    Line(Point),
    /// m, ρ, ε.
    Circle(Point, f64, f64),
}

/// The way of the tool's centre along an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Track {
    /// Where it begins if nothing is cut off by a corner.
    pub(crate) from: Point,
    /// Where it ends.
    pub(crate) to: Point,
    /// n at its start and at its end.
    pub(crate) normals: [Point; 2],
    /// What it follows.
    pub(crate) path: Path,
    /// κ of the contour.
    pub(crate) curvature: f64,
    /// Length (of an arc: angle) that corners have left of it.
    pub(crate) left: f64,
}

impl Element {
    /// The way of the tool's centre: O1 to O3. `None` if the tool does not fit into the arc.
    pub(crate) fn offset(&self, side: Side, r: f64) -> Option<Track> {
        let Element { from, to, arc } = *self;
        let shifted = |p: Point, n: Point| add(p, scale(r, n));
        let Some((m, turns)) = arc else {
            let (t, n) = (unit(sub(to, from)), side.normal(from, to));
            let (from, to, left) = (shifted(from, n), shifted(to, n), distance(from, to));
            return Some(Track { from, to, normals: [n, n], path: Path::Line(t), curvature: 0.0, left });
        };
        let sense = f64::from(turns.signum());
        let inside = side.sign() * sense;
        let radius = distance(m, to);
        if inside > 0.0 && radius <= r {
            return None;
        }
        let normals = [from, to].map(|p| polar(angle(scale(inside, sub(m, p)))));
        Some(Track {
            from: shifted(from, normals[0]),
            to: shifted(to, normals[1]),
            normals,
            path: Path::Circle(m, radius - inside * r, sense),
            curvature: inside / radius,
            left: sweep(from, to, m, turns),
        })
    }
}

impl Track {
    /// The straight way from `start` to the centre of the tool at `to`. It touches the contour at its end
    /// only and cannot be too short for a corner.
    pub(crate) fn entry_line(start: Point, to: Point, side: Side, r: f64) -> Track {
        let line = Element { from: start, to, arc: None };
        let (t, n) = (unit(sub(to, start)), side.normal(start, to));
        let end = add(line.to, scale(r, n));
        Track {
            from: start,
            to: end,
            normals: [n, n],
            path: Path::Line(t),
            curvature: 0.0,
            left: f64::INFINITY,
        }
    }

    /// The arc from `start` to the centre of the tool at the end of a programmed arc, tangent to it there:
    /// O9. Also gives its centre. `None` if the tool does not fit into the arc, or the arc is too short to
    /// lead in.
    pub(crate) fn entry_arc(programmed: &Element, side: Side, r: f64) -> Option<(Track, Point)> {
        let (m, turns) = programmed.arc?;
        let start = programmed.from;
        let track = programmed.offset(side, r)?;
        let end = track.to;
        let (u, chord) = (angle(sub(m, end)), sub(start, end));
        let slant = cos(angle(chord) - u);
        if slant <= 1e-4 {
            return None;
        }
        let radius = length(chord) / 2.0 / slant;
        let center = add(end, scale(radius, polar(u)));
        let sense = f64::from(turns.signum());
        let path = Path::Circle(center, radius, sense);
        Some((Track { from: start, path, left: sweep(start, end, center, turns), ..track }, center))
    }

    /// Ends the track earlier, at a point of its path. `false` if nothing is left of it.
    pub(crate) fn end_at(&mut self, point: Point) -> bool {
        self.left -= self.between(point, self.to);
        self.to = point;
        self.left >= -ROUNDING
    }

    /// Begins the track later, at a point of its path. `false` if nothing is left of it.
    pub(crate) fn begin_at(&mut self, point: Point) -> bool {
        self.left -= self.between(self.from, point);
        self.from = point;
        self.left >= -ROUNDING
    }

    /// The same in other units.
    pub(crate) fn scale(&mut self, factor: f64) {
        (self.from, self.to) = (scale(factor, self.from), scale(factor, self.to));
        self.curvature /= factor;
        match &mut self.path {
            Path::Line(_) => self.left *= factor,
            Path::Circle(m, radius, _) => (*m, *radius) = (scale(factor, *m), *radius * factor),
        }
    }

    /// Length (angle) of the path from one point to another.
    fn between(&self, a: Point, b: Point) -> f64 {
        match self.path {
            Path::Line(t) => dot(sub(b, a), t),
            Path::Circle(m, _, sense) => {
                let angle = turn(a, b, m, sense);
                if angle > TAU - SAME_ANGLE { 0.0 } else { angle }
            }
        }
    }
}

/// What kind of corner two elements make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corner {
    /// None: the way goes on.
    Tangent,
    /// The tool goes around it.
    Outside,
    /// The ways of both elements end at their intersection.
    Inside,
}

impl Corner {
    /// The corner where the tool stands on `n` and goes on along `next`; `curvature` is that of the element
    /// before.
    pub(crate) fn between(n: Point, curvature: f64, next: &Track, side: Side) -> Corner {
        let angle = side.sign() * atan2(cross(n, next.normals[0]), dot(n, next.normals[0])); // O4
        let back = angle.abs() >= PI - TANGENT;
        if back && curvature + next.curvature < 0.0 || !back && angle > TANGENT {
            Corner::Inside
        } else if back || angle < -TANGENT {
            Corner::Outside
        } else {
            Corner::Tangent
        }
    }
}

/// Where two ways meet in an inside corner at the contour's point `p`: O5 to O8. `None` if they do not.
pub(crate) fn meet(before: &Track, next: &Track, p: Point, side: Side, r: f64) -> Option<Point> {
    match (before.path, next.path) {
        (Path::Line(_), Path::Line(_)) => {
            let (n0, n1) = (before.normals[1], next.normals[0]);
            let half = atan2(cross(n0, n1), dot(n0, n1)).abs() / 2.0;
            let back = polar(angle(n0) + side.sign() * FRAC_PI_2);
            finite(add(add(p, scale(r, n0)), scale(r * tan(half), back)))
        }
        (Path::Line(t), Path::Circle(m, radius, sense)) => {
            line_and_circle(before.to, t, m, radius, side.sign() * sense)
        }
        (Path::Circle(m, radius, sense), Path::Line(t)) => {
            line_and_circle(next.from, t, m, radius, -side.sign() * sense)
        }
        (Path::Circle(m0, r0, e0), Path::Circle(m1, r1, e1)) => {
            let apart = distance(m0, m1);
            let x = (r0 * r0 + apart * apart - r1 * r1) / (2.0 * apart);
            let y = sqrt(r0 * r0 - x * x);
            let u = unit(sub(m1, m0));
            let point = add(m0, add(scale(x, u), scale(side.sign() * e0 * e1 * y, left(u))));
            finite(point)
        }
    }
}

fn line_and_circle(q: Point, t: Point, m: Point, radius: f64, sign: f64) -> Option<Point> {
    let along = dot(sub(m, q), t);
    let across = cross(t, sub(m, q));
    let half_chord = sqrt(radius * radius - across * across);
    finite(add(q, scale(along + sign * half_chord, t)))
}

fn finite(point: Point) -> Option<Point> {
    point.iter().all(|value| value.is_finite()).then_some(point)
}

/// Angle from `a` to `b` about `m` in the sense `sense`, 0 to one turn.
fn turn(a: Point, b: Point, m: Point, sense: f64) -> f64 {
    let [from, to] = [a, b].map(|p| atan2(p[1] - m[1], p[0] - m[0]));
    let angle = sense * (to - from);
    if angle < 0.0 { angle + TAU } else { angle }
}

/// Angle of an arc, > 0; its ends are equal for a full turn.
fn sweep(from: Point, to: Point, m: Point, turns: i32) -> f64 {
    let angle = turn(from, to, m, f64::from(turns.signum()));
    let angle = if angle == 0.0 { TAU } else { angle };
    angle + TAU * f64::from(turns.unsigned_abs().saturating_sub(1))
}

fn left(a: Point) -> Point {
    [-a[1], a[0]]
}

/// Direction of a vector.
fn angle(a: Point) -> f64 {
    atan2(a[1], a[0])
}

/// The unit vector of a direction.
fn polar(angle: f64) -> Point {
    [cos(angle), sin(angle)]
}

/// Distance of two points.
pub(crate) fn distance(a: Point, b: Point) -> f64 {
    length(sub(a, b))
}

fn unit(a: Point) -> Point {
    let length = length(a);
    [a[0] / length, a[1] / length]
}
