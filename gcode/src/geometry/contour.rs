//! Contours of turned parts: lines and arcs in the ZX plane, and what roughing has to know of them.
//!
//! Lengths in any one unit, X a radius. In the *frame of the cuts* ([`super::frame`]) a contour runs towards
//! −Z, the tool is on its +X side, the material on the other; passes run towards −Z, infeed is −X.
//!
//! | symbol | meaning |
//! |---|---|
//! | S, E | start and end of a segment |
//! | t | direction of travel, length 1 |
//! | n | normal to the right of it: n = (t_x, −t_z), which is +X for travel towards −Z |
//! | C, r | centre and radius of an arc |
//! | σ | +1 for an arc counterclockwise (G3) with Z to the right and X up, −1 for one clockwise (G2) |
//!
//! ```text
//! line      t = (E − S) / |E − S|
//! arc       t(P) = σ (C_x − P_x, P_z − C_z) / r                                      (1)
//! offset    P + d n(P): a line moves, an arc keeps C and has r + σ d                   (2)
//! monotone  E_z ≤ S_z;  arc: σ (P_x − C_x) ≥ 0 at both ends, so x is a function of z   (3)
//!           x(z) = C_x + σ √(r² − (z − C_z)²)                                           (4)
//! ```

use std::ops::{Add, Mul, Sub};

/// Points nearer than this are one.
pub(crate) const NEAR: f64 = 1e-6;
/// How far a segment may run backwards, or an arc beyond its half, and still count as monotone: programs are
/// written with three decimals.
pub(crate) const ROUNDING: f64 = 1e-3;

/// A point of the plane, or the way from one to another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Point {
    /// Z.
    pub(crate) z: f64,
    /// X, a radius.
    pub(crate) x: f64,
}

impl Point {
    /// Z and X.
    pub(crate) const fn new(z: f64, x: f64) -> Point {
        Point { z, x }
    }

    /// Distance from the origin.
    pub(crate) fn length(self) -> f64 {
        (self.z * self.z + self.x * self.x).sqrt()
    }

    /// Distance from another point.
    pub(crate) fn distance(self, other: Point) -> f64 {
        (self - other).length()
    }

    /// z₁ z₂ + x₁ x₂.
    pub(crate) fn dot(self, other: Point) -> f64 {
        self.z * other.z + self.x * other.x
    }

    /// z₁ x₂ − x₁ z₂: positive if `other` points to the left of this.
    pub(crate) fn cross(self, other: Point) -> f64 {
        self.z * other.x - self.x * other.z
    }

    /// Turned clockwise by a quarter: the right-hand normal of a direction.
    pub(crate) fn right(self) -> Point {
        Point::new(self.x, -self.z)
    }
}

impl Add for Point {
    type Output = Point;
    fn add(self, other: Point) -> Point {
        Point::new(self.z + other.z, self.x + other.x)
    }
}

impl Sub for Point {
    type Output = Point;
    fn sub(self, other: Point) -> Point {
        Point::new(self.z - other.z, self.x - other.x)
    }
}

impl Mul<f64> for Point {
    type Output = Point;
    fn mul(self, factor: f64) -> Point {
        Point::new(self.z * factor, self.x * factor)
    }
}

/// What makes a segment an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bend {
    /// C.
    pub(crate) center: Point,
    /// G3: counterclockwise with Z to the right and X up.
    pub(crate) ccw: bool,
}

/// A line, or an arc of at most one turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// S.
    pub(crate) start: Point,
    /// E.
    pub(crate) end: Point,
    /// The arc it is.
    pub(crate) bend: Option<Bend>,
}

impl Segment {
    /// A line.
    pub(crate) fn line(start: Point, end: Point) -> Segment {
        Segment { start, end, bend: None }
    }

    /// An arc.
    pub(crate) fn arc(start: Point, end: Point, center: Point, ccw: bool) -> Segment {
        Segment { start, end, bend: Some(Bend { center, ccw }) }
    }

    /// An arc by its radius: up to half a turn, more with a negative `radius`. `None` if the radius is less
    /// than half the distance of the ends (by more than [`ROUNDING`]) or the ends are one point.
    pub(crate) fn arc_of_radius(start: Point, end: Point, radius: f64, ccw: bool) -> Option<Segment> {
        let chord = end - start;
        let (length, half) = (chord.length(), chord.length() / 2.0);
        if length < NEAR || half > radius.abs() + ROUNDING {
            return None;
        }
        let height = (radius * radius - half * half).max(0.0).sqrt();
        let side = if ccw == (radius > 0.0) { -height } else { height };
        let center = (start + end) * 0.5 + chord.right() * (side / length);
        Some(Segment::arc(start, end, center, ccw))
    }

    /// From S to E as the crow flies.
    pub(crate) fn chord(&self) -> f64 {
        self.start.distance(self.end)
    }

    /// r; infinite for a line.
    pub(crate) fn radius(&self) -> f64 {
        self.bend.map_or(f64::INFINITY, |bend| self.start.distance(bend.center))
    }

    /// t at a point of it (1); zero where there is none.
    pub(crate) fn direction(&self, at: Point) -> Point {
        let along = match self.bend {
            None => self.end - self.start,
            Some(Bend { center, ccw: true }) => (center - at).right(),
            Some(Bend { center, ccw: false }) => (at - center).right(),
        };
        let length = along.length();
        if length > 0.0 { along * (1.0 / length) } else { Point::default() }
    }

    /// The segment at a distance, to the right if positive (2), and whether anything is left of it: an arc
    /// shrinks to its centre and beyond, where it runs backwards.
    pub(crate) fn offset(&self, distance: f64) -> (Segment, bool) {
        let moved = |at: Point| at + self.direction(at).right() * distance;
        let offset = Segment { start: moved(self.start), end: moved(self.end), bend: self.bend };
        let growth = match self.bend {
            Some(bend) if bend.ccw => distance,
            Some(_) => -distance,
            None => 0.0,
        };
        (offset, self.radius() + growth > ROUNDING)
    }

    /// Whether Z never grows along it (3), give or take [`ROUNDING`].
    pub(crate) fn is_monotone(&self) -> bool {
        let advance = self.start.z - self.end.z;
        match self.bend {
            None => advance >= -ROUNDING,
            Some(bend) => {
                let side = if bend.ccw { 1.0 } else { -1.0 };
                let above = |at: Point| side * (at.x - bend.center.x) >= -ROUNDING;
                advance >= ROUNDING && above(self.start) && above(self.end)
            }
        }
    }

    /// Whether it goes straight up or down.
    pub(crate) fn is_wall(&self) -> bool {
        self.start.z - self.end.z < NEAR
    }

    /// X of a monotone segment at a Z (4). Walls give their start.
    pub(crate) fn x_at(&self, z: f64) -> f64 {
        match self.bend {
            None if self.is_wall() => self.start.x,
            None => {
                let part = (z - self.start.z) / (self.end.z - self.start.z);
                self.start.x + part * (self.end.x - self.start.x)
            }
            Some(Bend { center, ccw }) => {
                let (r, dz) = (self.radius(), z - center.z);
                let height = (r * r - dz * dz).max(0.0).sqrt();
                if ccw { center.x + height } else { center.x - height }
            }
        }
    }

    /// The part of a monotone segment between two Z, `from` ≥ `to`.
    pub(crate) fn between(&self, from: f64, to: f64) -> Segment {
        let at = |z: f64| {
            let end = [self.start, self.end].into_iter().find(|end| (end.z - z).abs() < 1e-9);
            end.unwrap_or(Point::new(z, self.x_at(z)))
        };
        Segment { start: at(from), end: at(to), bend: self.bend }
    }

    /// A monotone segment in parts that only rise or only fall: an arc is cut at its highest or lowest point.
    pub(crate) fn halves(&self) -> (Segment, Option<Segment>) {
        let over = |center: Point| self.start.z > center.z + NEAR && self.end.z < center.z - NEAR;
        if let Some(Bend { center, ccw }) = self.bend.filter(|bend| over(bend.center)) {
            let r = self.radius();
            let middle = Point::new(center.z, if ccw { center.x + r } else { center.x - r });
            return (Segment { end: middle, ..*self }, Some(Segment { start: middle, ..*self }));
        }
        (*self, None)
    }

    /// Z where a segment that only rises or only falls has this X, if it has; where a level one begins.
    pub(crate) fn z_at(&self, x: f64) -> Option<f64> {
        let (start, end) = (self.start, self.end);
        if x < start.x.min(end.x) - NEAR || x > start.x.max(end.x) + NEAR {
            return None;
        }
        Some(match self.bend {
            None if (end.x - start.x).abs() < NEAR => start.z,
            None => start.z + (x - start.x) / (end.x - start.x) * (end.z - start.z),
            Some(Bend { center, ccw }) => {
                let (r, dx) = (self.radius(), x - center.x);
                let width = (r * r - dx * dx).max(0.0).sqrt();
                if ccw == (end.x > start.x) { center.z + width } else { center.z - width }
            }
        })
    }

    /// The same, elsewhere.
    pub(crate) fn shifted(&self, by: Point) -> Segment {
        let bend = self.bend.map(|bend| Bend { center: bend.center + by, ..bend });
        Segment { start: self.start + by, end: self.end + by, bend }
    }
}

/// Where the lines and circles that two segments lie on cross: none, one point or two.
pub(crate) fn crossings(a: &Segment, b: &Segment) -> [Option<Point>; 2] {
    match (a.bend, b.bend) {
        (None, None) => {
            let (u, v) = (a.end - a.start, b.end - b.start);
            let turn = u.cross(v);
            if turn.abs() <= 1e-12 * u.length() * v.length() {
                return [None, None];
            }
            [Some(a.start + u * ((b.start - a.start).cross(v) / turn)), None]
        }
        (None, Some(bend)) => line_and_circle(a, bend.center, b.radius()),
        (Some(bend), None) => line_and_circle(b, bend.center, a.radius()),
        (Some(one), Some(other)) => circles(one.center, a.radius(), other.center, b.radius()),
    }
}

fn line_and_circle(line: &Segment, center: Point, radius: f64) -> [Option<Point>; 2] {
    let t = line.direction(line.start);
    let foot = line.start + t * (center - line.start).dot(t);
    on_both_sides(foot, t, radius * radius - (foot - center).dot(foot - center))
}

fn circles(a: Point, a_radius: f64, b: Point, b_radius: f64) -> [Option<Point>; 2] {
    let distance = a.distance(b);
    if distance < NEAR {
        return [None, None];
    }
    let t = (b - a) * (1.0 / distance);
    let part = (distance * distance + a_radius * a_radius - b_radius * b_radius) / (2.0 * distance);
    on_both_sides(a + t * part, t.right(), a_radius * a_radius - part * part)
}

/// `middle` ± √square along t. What touches within rounding counts as touching.
fn on_both_sides(middle: Point, t: Point, square: f64) -> [Option<Point>; 2] {
    if square < -NEAR {
        return [None, None];
    }
    let reach = square.max(0.0).sqrt();
    [Some(middle + t * reach), Some(middle - t * reach)]
}
