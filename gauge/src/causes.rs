//! Which cause weighs most where a gauge refuses. In: a thread and its helix, the cuts that the gauge was
//! held against, the heights between which a GO gauge has flanks, mm. Out: the cause, and the measure that
//! it is told with.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | T | – | tangents of both flanks together |
//! | G | mm | length of the gauge on the thread |
//! | e, q | –, mm | error of the lead per length; unevenness of the helix (M154) |
//! | h̄, κ, ρ | mm, –, mm | mean of h_s, its change per length, its range over the angle |
//! | τ₁, τ₂ | – | tangents of the flanks as asked, less those that are there |
//! | g | mm | Σ τ (h̄ − root): what flanks make a groove narrower at the same depth |
//! | ℓ, k | mm | Σ max (τ (h_c − h̄), −τ (h̄ − h_r), 0): what flanks lean into a counterpart; what else does, at the root |
//! | u | mm | how far apart passes made the groove wider |
//!
//! ```text
//! (M156) in diameter, lead 2 |e| G/T, uneven 2 (max q − min q)/T, starts alike, taper |κ| G, runout ρ,
//!        flanks 2 (g + ℓ)/T, root 2 k/T, shallow 2 (h̄ − g/T);
//!        of NO-GO, flanks −2 g/T, passes 2 u/T, deep 2 (h_no-go − h̄ + g/T − u/T)
//! ```
//! Each is the share that the virtual or the simple pitch diameter would change by without it. For flanks of
//! 30° 2/T is 1.732, as books say of the lead.

use crate::{
    groove::Cut,
    helix::Helix,
    nominal::Nominal,
    reason::{Cause, Check, Told},
};

/// The cause that weighs most against a gauge over these cuts.
pub(crate) fn heaviest(
    nominal: &Nominal,
    check: Check,
    helix: &Helix,
    (cuts, rest): (&[Cut], &[f64]),
    heights: [f64; 2],
) -> (Cause, Told) {
    let t = nominal.tangent();
    let mean = |of: &dyn Fn(&Cut) -> f64| cuts.iter().map(of).sum::<f64>() / cuts.len().max(1) as f64;
    let ends = cuts.first().zip(cuts.last());
    let length = ends.map_or(0.0, |(first, last)| (last.nominal - first.nominal).abs());
    let tangents = mean_tangents(nominal, cuts);
    let missing: [f64; 2] = core::array::from_fn(|side| nominal.tangents()[side] - tangents[side]);
    let simple = mean(&|cut| cut.simple);
    let narrower = missing.iter().sum::<f64>() * (simple - mean(&|cut| cut.root)) / t;
    let told = |amount: f64| Told { amount, length, flank_deg: angles_deg(tangents) };
    let taper = (helix.taper.abs() * length, Cause::Taper, told(2.0 * helix.taper * length));
    let runout = (helix.runout, Cause::Runout, told(helix.runout));
    let causes = if check == Check::Go {
        let uneven = range(rest);
        let size = simple - narrower;
        let [root, crest] = heights.map(|h| h - simple);
        let leans = missing.map(|less| (less * crest).max(less * root).max(0.0)).iter().sum::<f64>() / t;
        let round = mean(&|cut| cut.lean) / t - leans;
        vec![
            (2.0 * size, Cause::Size, told(size)),
            (2.0 * helix.lead.abs() * length / t, Cause::Lead, told(helix.lead * length)),
            (2.0 * uneven / t, Cause::Drunken, told(uneven)),
            (2.0 * helix.starts / t, Cause::Starts, told(helix.starts)),
            (2.0 * (narrower + leans), Cause::Flanks, told(0.0)),
            (2.0 * round, Cause::Root, told(round * t)),
            taper,
            runout,
        ]
    } else {
        let apart = mean(&|cut| cut.apart);
        let size = simple - narrower + apart / t - nominal.height_mm(nominal.no_go_mm());
        vec![
            (-2.0 * size, Cause::Size, told(size)),
            (-2.0 * narrower, Cause::Flanks, told(0.0)),
            (2.0 * apart / t, Cause::Apart, told(apart)),
            taper,
            runout,
        ]
    };
    let heaviest = causes.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    heaviest.map_or((Cause::Size, told(0.0)), |(_, cause, told)| (cause, told))
}

/// Tangents of the flanks, averaged over the cuts.
pub(crate) fn mean_tangents(nominal: &Nominal, cuts: &[Cut]) -> [f64; 2] {
    let fitted = || cuts.iter().filter_map(|cut| cut.tangents);
    let n = fitted().count() as f64;
    if n == 0.0 {
        return nominal.tangents();
    }
    [0, 1].map(|side| fitted().map(|tangents| tangents[side]).sum::<f64>() / n)
}

/// Angles of tangents, degrees.
pub(crate) fn angles_deg(tangents: [f64; 2]) -> [f64; 2] {
    tangents.map(|tangent| libm::atan(tangent).to_degrees())
}

/// Largest minus smallest.
fn range(values: &[f64]) -> f64 {
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - values.iter().copied().fold(f64::INFINITY, f64::min)
}
