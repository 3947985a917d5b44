//! A tool that turns about Z, and where its tip stands while it touches a surface. In: a point of contact and
//! the slopes there, mm. Out: the tip, the lowest point of the tool on its axis, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | R, c | mm | radius of the tool, and of its corner: 0 of a flat end, R of a ball |
//! | ψ_x, ψ_y | – | slopes of the surface |
//! | n | – | its normal, upwards: (−ψ_x, −ψ_y, 1)/(1 + ψ_x² + ψ_y²)^½ |
//! | h | – | level part of n, made a unit vector: (−ψ_x, −ψ_y, 0)/(ψ_x² + ψ_y²)^½ |
//! | e_z | – | upwards |
//!
//! ```text
//! tip = contact + c n + (R − c) h − c e_z                                                            (M87)
//! ```
//! Where the surface is level h does not exist: a ball needs none, other tools may touch there with any point
//! of their end.
//!
//! Source: the tool is the body swept by a ball of radius c round a circle of radius R − c.

use serde::{Deserialize, Serialize};

use crate::{Gradient, Number};

/// Its cutting end. `corner_mm` = 0 is flat, = `radius_mm` a ball, in between a bull nose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Radius, mm, > 0.
    pub radius_mm: f64,
    /// Radius of its corner, mm, 0 to `radius_mm`.
    pub corner_mm: f64,
}

impl Tool {
    /// Whether it is a ball: where it touches a level place, it touches with its tip.
    #[must_use]
    pub fn is_ball(&self) -> bool {
        self.corner_mm == self.radius_mm
    }

    /// The tip, while the tool touches at X, Y of `contact` a surface of this height with these slopes (M87).
    /// Not finite where a tool that is no ball touches a level place.
    pub fn tip<T: Number>(&self, contact: [T; 2], surface: Gradient<T>) -> [T; 3] {
        let corner = T::constant(self.corner_mm);
        let level = surface.x * surface.x + surface.y * surface.y;
        let upwards = corner / (T::constant(1.0) + level).sqrt();
        let mut sideways = upwards;
        if !self.is_ball() {
            sideways = sideways + T::constant(self.radius_mm - self.corner_mm) / level.sqrt();
        }
        let [x, y] = contact;
        [x - surface.x * sideways, y - surface.y * sideways, surface.value + upwards - corner]
    }

    /// Height of its end above its tip at a distance from its axis, mm; `None` beyond its radius.
    #[must_use]
    pub fn height(&self, from_axis_mm: f64) -> Option<f64> {
        let beside = (from_axis_mm - self.radius_mm + self.corner_mm).max(0.0);
        let below = self.corner_mm * self.corner_mm - beside * beside;
        (below >= 0.0).then(|| self.corner_mm - below.sqrt())
    }
}
