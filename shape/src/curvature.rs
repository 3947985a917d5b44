//! Curvature of a path and of a surface: the feed that keeps a chord error, and the surface that a tool moves on while
//! it touches another. In: derivatives. Out: radius, feeds, derivatives. mm, s.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | R, δ | mm | radius of curvature of the path in space; chord error |
//! | l, dt | mm, s | step along the path, its time |
//! | S_k, S_X | mm/s | feed along the path, that of the master |
//! | g, H | –, 1/mm | gradient and second derivatives of the part; w = (1 + g²)^½ |
//! | c, a | mm | radius of the corner of the tool; the rest of its radius (a = 0: ball) |
//!
//! | | |
//! |---|---|
//! | M44 | δ = l²/8R, so S_k = 2 (2Rδ)^½/dt; exactly 2 (2Rδ − δ²)^½/dt; of steps along the tangent δ = l²/2R, (2Rδ)^½/dt |
//! | M45 | S_X = S_k/(1 + K1² + K2²)^½ |
//! | M93 | the tip is at q − c g/w − a g/\|g\|, at the height ψ + c/w − c. There its surface has the gradient g and the second derivatives H (1 − (c/w)(1 − g gᵀ/w²) H − (a/\|g\|)(1 − g gᵀ/g²) H)⁻¹ |
//!
//! The exact form of M44 is the published one of the radius R − δ/2.
//!
//! What is here of M44 and M45 serves `experiment surface` alone: a chain keeps a chord error by M66, from bounds over a
//! stretch. [`Touch::under`] serves the corrections of a trace, too.
//!
//! Source of M44 and M45: (21) to (23) of that of `shaping.rs`. It leaves the tool out.

use crate::{Series, Tool, Touch};

/// Radius of curvature of a path in space, mm; infinite where it is straight, not finite where it stands still in its
/// parameter.
#[must_use]
pub fn radius(path: &[Series; 3]) -> f64 {
    let [[x1, x2], [y1, y2], [z1, z2]] = path.map(|Series([_, first, second, _])| [first, 2.0 * second]);
    let speed2 = x1 * x1 + y1 * y1 + z1 * z1;
    let cross = [y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2];
    let cross2: f64 = cross.iter().map(|c| c * c).sum();
    speed2 * (speed2 / cross2).sqrt()
}

/// Feed of chords that lie within δ of a path of radius R: the published form 2 (2Rδ)^½/dt, mm/s (M44). Given R − δ/2, it
/// is that of a circle without approximation.
#[must_use]
pub fn chord_feed(radius: f64, delta: f64, dt: f64) -> f64 {
    2.0 * (2.0 * radius * delta).sqrt() / dt
}

/// Feed of steps along the tangent, as without correction: (2Rδ)^½/dt, half of [`chord_feed`], mm/s (M44).
#[must_use]
pub fn tangent_feed(radius: f64, delta: f64, dt: f64) -> f64 {
    (2.0 * radius * delta).sqrt() / dt
}

/// Feed of the master for a feed `s_k` along the path (M45).
#[must_use]
pub fn master_feed(s_k: f64, ratios: [f64; 2]) -> f64 {
    let [k1, k2] = ratios;
    s_k / (1.0 + k1 * k1 + k2 * k2).sqrt()
}

impl Touch {
    /// The surface on which the tip of a tool moves while it touches this one, at the place of the tip that
    /// belongs to this point (M93). `None` where the tool does not fit: where the surface is bent more than the tool.
    #[must_use]
    pub fn under(&self, tool: &Tool) -> Option<Touch> {
        let ([gx, gy], [hxx, hxy, hyy]) = (self.slope, self.second);
        let g2 = self.level();
        let w2 = 1.0 + g2;
        // With a ball the second term is not there; a flat tool has no derivative where the surface is level.
        let (ball, flat) = (tool.corner_mm / w2.sqrt(), tool.radius_mm - tool.corner_mm);
        let (flat, g2) = if flat > 0.0 { (flat / g2.sqrt(), g2) } else { (0.0, 1.0) };
        let p = |own: f64, a: f64, b: f64| ball * (own - a * b / w2) + flat * (own - a * b / g2);
        let (pxx, pxy, pyy) = (p(1.0, gx, gx), p(0.0, gx, gy), p(1.0, gy, gy));
        // M = 1 − P H; the wanted H M⁻¹ is symmetric.
        let (mxx, mxy) = (1.0 - pxx * hxx - pxy * hxy, -(pxx * hxy + pxy * hyy));
        let (myx, myy) = (-(pxy * hxx + pyy * hxy), 1.0 - pxy * hxy - pyy * hyy);
        let det = mxx * myy - mxy * myx;
        // Both eigenvalues of M are positive: along every direction there is room.
        let fits = det > 0.0 && mxx + myy > 0.0;
        fits.then(|| Touch {
            z: self.z + ball - tool.corner_mm,
            slope: self.slope,
            second: [
                (hxx * myy - hxy * myx) / det,
                (hxy * mxx - hxx * mxy) / det,
                (hyy * mxx - hxy * mxy) / det,
            ],
        })
    }
}
