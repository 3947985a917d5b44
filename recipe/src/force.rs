//! What a pass asks of the machine. In: material, edge, depth in mm, area in mm². Out: the tangential
//! force, N.
//!
//! ```text
//! (M209) F = k_c1 h^(−m_c) A     Kienzle, k_c1 in N/mm² for a chip of 1 mm, h in mm
//!        h = A/ℓ,  ℓ = w + Σ d/cos α    mean thickness over the edge that cuts: its flat w,
//!                                     and of every flank that cuts its length at depth d
//! ```
//! A first pass cuts with both flanks, whatever the infeed; behind it infeed along a flank, or in turns, with
//! one. The figures are those of a sharp edge without rake; wear adds a third and more.

use gauge::Edge;

use crate::{Infeed, Material};

/// The tangential force of a pass (M209), N. `is_first`: nothing was cut before it.
pub(crate) fn tangential_n(
    material: Material,
    edge: &Edge,
    infeed: Infeed,
    is_first: bool,
    [depth_mm, area_mm2]: [f64; 2],
) -> f64 {
    if area_mm2 <= 0.0 {
        return 0.0;
    }
    let lengths = edge.flank_deg.map(|deg| depth_mm / libm::cos(deg.to_radians()));
    let both = is_first || infeed == Infeed::Radial;
    // The shorter edge has the thicker chip under less force: the longer one is on the safe side.
    let flanks = if both { lengths[0] + lengths[1] } else { lengths[0].max(lengths[1]) };
    let thickness_mm = area_mm2 / (edge.flat_mm + flanks);
    let [kc1, exponent] = material.kienzle();
    kc1 * libm::pow(thickness_mm, -exponent) * area_mm2
}

#[cfg(test)]
mod tests {
    use super::tangential_n;
    use crate::{Infeed, Material};
    use gauge::Edge;

    const SHARP: Edge = Edge { flank_deg: [30.0; 2], flat_mm: 0.0, nose_mm: 0.0 };

    /// By hand: a first cut of 0.5 mm has 0.25 tan 30° = 0.1443 mm² over 2 · 0.5/cos 30° = 1.1547 mm of edge,
    /// so a chip of 0.125 mm: 1500 · 0.125^−0.22 · 0.1443 = 342.1 N.
    #[test]
    fn a_first_cut_is_that_of_the_formula() {
        let area = 0.25 * libm::tan(30f64.to_radians());
        let force = tangential_n(Material::Steel, &SHARP, Infeed::Flank, true, [0.5, area]);
        assert!((force - 342.1).abs() < 0.5, "{force}");
    }

    /// The same area on one flank is a chip of twice the thickness: 2^0.22 less force.
    #[test]
    fn one_flank_takes_less_force_than_two() {
        let of = |infeed| tangential_n(Material::Steel, &SHARP, infeed, false, [1.0, 0.1]);
        let ratio = of(Infeed::Radial) / of(Infeed::Flank);
        assert!((ratio - libm::pow(2.0, 0.22)).abs() < 1e-12, "{ratio}");
        assert_eq!(tangential_n(Material::Steel, &SHARP, Infeed::Flank, false, [1.0, 0.0]), 0.0);
    }
}
