//! The largest and the smallest thread that a gauge allows, in section. In: what the gauge asks, the
//! middle of a groove, mm and degrees. Out: corners of a groove.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | y_p(z) | mm | pitch line, of the limit that GO holds or of that of NO-GO |
//! | y_c(z), y_r(z) | mm | crest and root of that limit; s their slope and that of the pitch line |
//! | z_p, t | mm, – | where a flank goes through the pitch line; its slope along Z, negative towards lower Z |
//! | h | mm | height of a corner over the pitch line |
//!
//! A flank goes along z = z_p + t h, y = y_p + h, and meets the crest (and, likewise, the root) at
//! h = (y_c(z_p) − y_p)/(1 − s t).

use rig::observe::GaugeLimits;

/// A limit: the diameters of its pitch line, crest and root, as y at the plane of the gauge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limit {
    pub(super) pitch: f64,
    pub(super) crest: f64,
    pub(super) root: f64,
}

/// The largest thread (GO) and the smallest one (NO-GO): of a screw, of the material; of a nut, too.
pub(super) fn both(limits: &GaugeLimits, sign: f64, crest_mm: f64) -> [Limit; 2] {
    let y = |diameter: f64| 0.5 * sign * diameter;
    let (most, least) = if sign > 0.0 { (1, 0) } else { (0, 1) };
    let triangle = limits.pitch_mm / tangents(limits).iter().sum::<f64>();
    let [go, no_go] = [most, least].map(|at| y(limits.pitch_diameter_mm[at]));
    let crest = limits.crest_mm[most].map_or(crest_mm, y);
    let root = limits.root_go_mm.map_or(go - 0.25 * triangle, y).max(go - 0.5 * triangle);
    let lower_crest = limits.crest_mm[least].map_or(crest, y);
    let lower_root = limits.root_mm[least].map_or(root - (go - no_go), y).min(root);
    [
        Limit { pitch: go, crest, root },
        Limit { pitch: no_go, crest: lower_crest, root: lower_root.max(no_go - 0.5 * triangle) },
    ]
}

/// Slopes of the flanks.
pub(super) fn tangents(limits: &GaugeLimits) -> [f64; 2] {
    limits.flank_deg.map(|deg| libm::tan(deg.to_radians()))
}

/// The corners of the groove with this middle: crest, root, root, crest; z and y.
pub(super) fn corners(limits: &GaugeLimits, limit: Limit, sign: f64, middle: f64) -> [(f64, f64); 4] {
    let slope = 0.5 * sign * limits.taper;
    let [lower, higher] = tangents(limits);
    let rises = |z: f64| slope * (z - limits.plane_mm);
    let pitch = limit.pitch + rises(middle);
    let half = 0.25 * limits.pitch_mm;
    let corner = |side: f64, tangent: f64, level: f64| {
        let z_p = middle + side * half;
        let h = (level + rises(z_p) - pitch) / (1.0 - slope * side * tangent);
        (z_p + side * tangent * h, pitch + h)
    };
    [
        corner(-1.0, lower, limit.crest),
        corner(-1.0, lower, limit.root),
        corner(1.0, higher, limit.root),
        corner(1.0, higher, limit.crest),
    ]
}
