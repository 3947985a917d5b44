//! Curvature of a path: the feed that keeps a chord error. In: derivatives. Out: radius, feeds. mm, s.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | R, δ | mm | radius of curvature of the path in space; chord error |
//! | l, dt | mm, s | step along the path, its time |
//! | S_k, S_X | mm/s | feed along the path, that of the master |
//!
//! | | |
//! |---|---|
//! | M44 | δ = l²/8R, so S_k = 2 (2Rδ)^½/dt; exactly 2 (2Rδ − δ²)^½/dt; of steps along the tangent δ = l²/2R, (2Rδ)^½/dt |
//! | M45 | S_X = S_k/(1 + K1² + K2²)^½ |
//!
//! The exact form of M44 is the published one of the radius R − δ/2.
//!
//! They serve `experiment surface` alone: a chain keeps a chord error by M66, from bounds over a stretch.
//!
//! Source: (21) to (23) of that of `shaping.rs`. It leaves the tool out.

use crate::Series;

/// Radius of curvature of a path in space, mm; infinite where it is straight, not finite where it stands
/// still in its parameter.
#[must_use]
pub fn radius(path: &[Series; 3]) -> f64 {
    let [[x1, x2], [y1, y2], [z1, z2]] = path.map(|Series([_, first, second, _])| [first, 2.0 * second]);
    let speed2 = x1 * x1 + y1 * y1 + z1 * z1;
    let cross = [y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2];
    let cross2: f64 = cross.iter().map(|c| c * c).sum();
    speed2 * (speed2 / cross2).sqrt()
}

/// Feed of chords that lie within δ of a path of radius R: the published form 2 (2Rδ)^½/dt, mm/s (M44). Given
/// R − δ/2, it is that of a circle without approximation.
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
