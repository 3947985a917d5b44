//! How closely a tool fits a surface where it touches it: whether it cuts into it, and how high the ridge is
//! that it leaves to the next path. In: a formula, a place, a tool, the direction of the path seen from
//! above. Out: curvatures 1/mm, lengths mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | t, b | – | unit vectors in the tangent plane: along the path, and across it |
//! | u, v | – | the same: along the steepest slope, and level |
//! | θ | rad | angle of the slope |
//! | S, T | 1/mm | curvature of the surface, and of the tool where it touches; positive where they bend upwards |
//! | D | 1/mm | T − S: how fast both part |
//! | δ, p | mm | distance of neighbouring paths on the surface, and seen from above |
//! | h | mm | height of the ridge between them |
//!
//! ```text
//! S(a, b) = aᵀ H b/(1 + ψ_x² + ψ_y²)^½,  H the second derivatives of ψ, a and b seen from above
//! T = u uᵀ/c + v vᵀ sin θ/(R − c + c sin θ);  of a ball 1/r in all directions
//! D positive definite: the tool cuts nothing but the surface beside the place where it touches
//! k = D_bb − D_tb²/D_tt,  h = k δ²/8; of a ball the height of a circle, h = 1/k − (1/k² − δ²/4)^½; of other
//! tools that of the edge they sweep over a plane, where its curvature is k₀, at δ (k/k₀)^½ (M177)
//! δ = p ((1 + ψ_x² + ψ_y²)/(1 + ψ_t²))^½                                                             (M89)
//! ```
//! Where rings turn, the place that is farthest from all paths lies on the way from corner to corner, which
//! is ℓ long for p = 1: d from the sides of one ring and as far from the corner of the next, d = δ ℓ/(δ + ℓ).
//! There 2 d takes the place of δ; on a level place it is 2 (2 − √2) p = 1.17 p.
//!
//! k is the curvature, across the path and seen from the surface, of what the tool leaves behind: the surface
//! it sweeps touches the tool all along its line of contact, the direction conjugate to t under D, and the
//! surface along the path.
//!
//! Source: second fundamental forms, and the envelope of a moving body.

mod swept;
mod under;

use self::swept::Swept;
use crate::{Formula, Gradient, Tool};

/// A surface where a tool touches it, or the one on which its tip moves then ([`Touch::under`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// Height, mm.
    pub z: f64,
    /// Slopes by x and by y.
    pub slope: [f64; 2],
    /// Second derivatives by xx, xy, yy, 1/mm.
    pub second: [f64; 3],
}

/// D of a tool and a surface, in the frame of a path, 1/mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parting {
    /// D_tt.
    pub along: f64,
    /// D_tb.
    pub mixed: f64,
    /// D_bb.
    pub across: f64,
    /// What the tool sweeps over a plane of this slope; none of a tool that is as round as a ball across the
    /// path.
    swept: Option<Swept>,
}

impl Touch {
    /// The surface at a place; not finite where it does not exist.
    #[must_use]
    pub fn at(formula: &Formula, [x, y]: [f64; 2]) -> Touch {
        let one = |value| Gradient { value, x: 1.0, y: 0.0 };
        let other = |value| Gradient { value, x: 0.0, y: 1.0 };
        let at = formula.eval(Gradient::variables(one(x), other(y)));
        Touch { z: at.value.value, slope: [at.x.value, at.y.value], second: [at.x.x, at.x.y, at.y.y] }
    }

    /// Whether all of it exists.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.z.is_finite() && self.slope.iter().chain(&self.second).all(|one| one.is_finite())
    }

    /// ψ_x² + ψ_y².
    #[must_use]
    pub fn level(&self) -> f64 {
        let [x, y] = self.slope;
        x * x + y * y
    }

    /// Its largest curvature upwards, 1/mm: above 0 where it is hollow.
    #[must_use]
    pub fn hollow(&self) -> f64 {
        let [t, b] = self.frame([1.0, 0.0]);
        let (tt, tb, bb) = (self.curvature(t, t), self.curvature(t, b), self.curvature(b, b));
        0.5 * (tt + bb) + libm::hypot(0.5 * (tt - bb), tb)
    }

    /// How fast a tool and the surface part (D), by the direction of a path seen from above. Not finite where
    /// a tool that is no ball touches a level place.
    #[must_use]
    pub fn parting(&self, tool: &Tool, along: [f64; 2]) -> Parting {
        let [t, b] = self.frame(along);
        let [tt, tb, bb] =
            [[t, t], [t, b], [b, b]].map(|[a, b]| self.tool(tool, a, b) - self.curvature(a, b));
        Parting { along: tt, mixed: tb, across: bb, swept: self.swept(tool, t) }
    }

    /// What a tool sweeps along a tangent.
    fn swept(&self, tool: &Tool, t: [f64; 3]) -> Option<Swept> {
        let (ring, level) = (tool.radius_mm - tool.corner_mm, self.level());
        let [u, v] = self.steepest();
        let wide = ring * dot(t, u).abs();
        // Level across the slope nothing of the ring is seen but its edge.
        let is_seen = !tool.is_ball() && level > 0.0 && dot(t, v).abs() < 1.0 - 1e-12;
        let high = ring * (level / (1.0 + level)).sqrt();
        is_seen.then_some(Swept { wide, high, corner: tool.corner_mm.max(SHARP_MM) })
    }

    /// u and v; not finite on a level place.
    fn steepest(&self) -> [[f64; 3]; 2] {
        let [x, y] = self.slope;
        [unit([x, y, self.level()]), unit([-y, x, 0.0])]
    }

    /// Distance on the surface of two paths that are 1 mm apart, seen from above: δ/p.
    #[must_use]
    pub fn spread(&self, along: [f64; 2]) -> f64 {
        let [x, y] = self.slope;
        let climb = (x * along[0] + y * along[1]) / libm::hypot(along[0], along[1]);
        ((1.0 + self.level()) / (1.0 + climb * climb)).sqrt()
    }

    /// The same where rings turn: twice the distance from the paths to the place that is farthest from them.
    #[must_use]
    pub fn spread_in_corners(&self, along: [f64; 2]) -> f64 {
        let ([x, y], side) = (self.slope, self.spread(along));
        let climb = x.abs() + y.abs();
        let corner = (2.0 + climb * climb).sqrt();
        2.0 * side * corner / (side + corner)
    }

    /// t and b.
    fn frame(&self, along: [f64; 2]) -> [[f64; 3]; 2] {
        let [x, y] = self.slope;
        let t = unit([along[0], along[1], x * along[0] + y * along[1]]);
        let n = unit([-x, -y, 1.0]);
        [t, [n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]]]
    }

    /// S of two tangents.
    fn curvature(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let [xx, xy, yy] = self.second;
        let form = a[0] * (xx * b[0] + xy * b[1]) + a[1] * (xy * b[0] + yy * b[1]);
        form / (1.0 + self.level()).sqrt()
    }

    /// T of two tangents.
    fn tool(&self, tool: &Tool, a: [f64; 3], b: [f64; 3]) -> f64 {
        if tool.is_ball() {
            return dot(a, b) / tool.radius_mm;
        }
        let level = self.level();
        let [u, v] = self.steepest();
        let sine = (level / (1.0 + level)).sqrt();
        let round = sine / (tool.radius_mm - tool.corner_mm + tool.corner_mm * sine);
        dot(a, u) * dot(b, u) / tool.corner_mm.max(SHARP_MM) + dot(a, v) * dot(b, v) * round
    }
}

/// Radius of a corner that is sharp, mm.
const SHARP_MM: f64 = 1e-6;

impl Parting {
    /// Whether the tool cuts into the surface beside the place where it touches.
    #[must_use]
    pub fn gouges(&self) -> bool {
        !(self.along > 0.0 && self.ridge() > 0.0)
    }

    /// k, 1/mm.
    #[must_use]
    pub fn ridge(&self) -> f64 {
        self.across - self.mixed * self.mixed / self.along
    }

    /// Height of the ridge to a path at the distance δ, mm.
    #[must_use]
    pub fn height(&self, delta_mm: f64) -> f64 {
        let (k, half) = (self.ridge(), 0.5 * delta_mm);
        match self.swept {
            Some(swept) if k.is_finite() => swept.height(half * self.bent(&swept)),
            // 1/k − (1/k² − δ²/4)^½, without the difference of two numbers that are nearly the same.
            _ => k * half * half / (1.0 + (1.0 - (k * half) * (k * half)).max(0.0).sqrt()),
        }
    }

    /// Whether a tool on neighbouring paths at the distance δ leaves a ridge between them: otherwise what it
    /// sweeps does not reach as far. Of what is not finite this is not known, and it says that it does.
    #[must_use]
    pub fn overlaps(&self, delta_mm: f64) -> bool {
        let half = 0.5 * delta_mm;
        let share = match self.swept {
            Some(swept) => half * self.bent(&swept) / swept.reach(),
            None => half * self.ridge(),
        };
        share < 1.0 || !share.is_finite()
    }

    /// Distance δ of paths that leaves a ridge of this height, mm.
    #[must_use]
    pub fn distance(&self, height_mm: f64) -> f64 {
        let k = self.ridge();
        match self.swept {
            Some(swept) if k.is_finite() => 2.0 * swept.half(height_mm) / self.bent(&swept),
            _ => 2.0 * (height_mm * (2.0 / k - height_mm)).max(0.0).sqrt(),
        }
    }

    /// How much farther apart paths on a plane are that leave the same ridge: (k/k₀)^½.
    fn bent(&self, swept: &Swept) -> f64 {
        (self.ridge() / swept.curvature()).sqrt()
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|one| one / length)
}
