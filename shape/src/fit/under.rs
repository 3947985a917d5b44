//! The surface that the tip of a tool moves on while the tool touches another one. In: gradient and second
//! derivatives of the surface that is touched, the tool. Out: height, gradient and second derivatives under
//! the tip. mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | g, H | –, 1/mm | gradient and second derivatives of the part; w = (1 + g²)^½ |
//! | c, a | mm | radius of the corner of the tool; the rest of its radius (a = 0: ball) |
//!
//! ```text
//! the tip is at q − c g/w − a g/|g|, at the height ψ + c/w − c; there its surface has the gradient g and
//! the second derivatives H (1 − (c/w)(1 − g gᵀ/w²) H − (a/|g|)(1 − g gᵀ/g²) H)⁻¹               (M93)
//! ```

use super::Touch;
use crate::Tool;

impl Touch {
    /// The surface on which the tip of a tool moves while it touches this one, at the place of the tip that
    /// belongs to this point (M93). `None` where the tool does not fit: where the surface is bent more than
    /// the tool.
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
