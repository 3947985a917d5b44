//! Which causes weigh most where a gauge refuses. In: a thread and its helix, the cuts that the gauge was
//! held against, the heights between which a GO gauge has flanks, mm. Out: the causes, the heaviest first,
//! each with the measure that it is told with.
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
//!        flanks 2 (g⁺ + ℓ)/T, root 2 k/T, shallow 2 (h̄ − g⁺/T);
//!        of NO-GO, flanks 2 g⁻/T, passes 2 u/T, deep 2 (h_no-go − h̄ − g⁻/T − u/T)
//! ```
//! g⁺ = max (g, 0) and g⁻ = max (−g, 0): flanks are blamed for what they spoil, not set off against it. Too
//! shallow or too deep is told only of a thread that another depth alone would make good. Every cause that
//! weighs half as much as the heaviest is told.
//!
//! Each is the share that the virtual or the simple pitch diameter would change by without it. For flanks of
//! 30° 2/T is 1.732, as books say of the lead.

use crate::{
    groove::Cut,
    helix::Helix,
    nominal::Nominal,
    reason::{Cause, Check, Told},
};

/// Causes lighter than this share of the heaviest are not told.
const TOLD: f64 = 0.5;

/// What a gauge is held against.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held<'a> {
    pub(crate) cuts: &'a [Cut],
    /// q of each of them (M154).
    pub(crate) rest: &'a [f64],
    /// Heights between which a GO gauge has flanks.
    pub(crate) heights: [f64; 2],
    /// Whether another depth alone would make the thread good.
    pub(crate) depth_helps: bool,
}

/// The causes against a gauge, the heaviest first; at least one.
pub(crate) fn causes(nominal: &Nominal, check: Check, helix: &Helix, held: &Held) -> Vec<(Cause, Told)> {
    let Held { cuts, rest, heights, depth_helps } = *held;
    let t = nominal.tangent();
    let mean = |of: &dyn Fn(&Cut) -> f64| cuts.iter().map(of).sum::<f64>() / cuts.len().max(1) as f64;
    let ends = cuts.first().zip(cuts.last());
    let length = ends.map_or(0.0, |(first, last)| (last.nominal - first.nominal).abs());
    let tangents = mean_tangents(nominal, cuts);
    let missing: [f64; 2] = core::array::from_fn(|side| nominal.tangents()[side] - tangents[side]);
    let simple = mean(&|cut| cut.simple);
    let g = missing.iter().sum::<f64>() * (simple - mean(&|cut| cut.root)) / t;
    let (narrower, wider) = (g.max(0.0), (-g).max(0.0));
    let told = |amount: f64| Told { amount, length, flank_deg: angles_deg(tangents) };
    let mut all = if check == Check::Go {
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
        ]
    } else {
        let apart = mean(&|cut| cut.apart);
        let size = simple + wider + apart / t - nominal.height_mm(nominal.no_go_mm());
        vec![
            (-2.0 * size, Cause::Size, told(size)),
            (2.0 * wider, Cause::Flanks, told(0.0)),
            (2.0 * apart / t, Cause::Apart, told(apart)),
        ]
    };
    all.push((helix.taper.abs() * length, Cause::Taper, told(2.0 * helix.taper * length)));
    all.push((helix.runout, Cause::Runout, told(helix.runout)));
    all.retain(|(_, cause, _)| depth_helps || *cause != Cause::Size);
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let heaviest = all[0].0;
    let heavy = all.into_iter().filter(|(weight, ..)| *weight >= TOLD * heaviest);
    heavy.map(|(_, cause, told)| (cause, told)).collect()
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
