//! How a groove is cut in passes. In: the edge of the tool, the full depth h, mm of radius. Out: depths d of
//! the passes, and how far along Z each of them stands from where the groove will be.
//!
//! | law | depth of pass n of N |
//! |---|---|
//! | root | h √(n/N): what threading cycles do, and equal area of a sharp edge |
//! | equal area | A(dₙ) = A(h) n/N, A of the edge (M201) with its flat and its corners |
//! | equal depth | h n/N |
//! | table | h √φ/√(N − 1), φ = 0.3, 1, 2 … N − 1 (tables of Sandvik and Mitsubishi for threading) |
//!
//! No cut is shallower than a least one; the passes behind it are fewer for that.
//!
//! ```text
//! (M202) beside the groove, along a flank:  (h − dₙ) tan γ,  0 ≤ γ ≤ α
//!        on both flanks in turns:           ± min(½ (dₙ − dₙ₋₁), h − dₙ) tan α; last but one: (h − dₙ) tan α
//! ```
//! α is the flank on the side to which the pass is moved. γ = α goes along that flank, so only the other one
//! cuts. In turns, the flank that does not cut stays clear where cuts grow no deeper. No pass cuts beyond the
//! groove.

use gauge::Edge;

/// Where beside the groove the passes run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Infeed {
    /// Straight in, on both flanks.
    Radial,
    /// Along the flank behind the tool as it moves: the one before it cuts.
    Flank,
    /// The same, so many degrees off the flank, which then is touched by the tool as well.
    Modified(f64),
    /// Along one flank and the other in turns.
    Alternating,
}

/// How deep the passes go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// By the square root of the number of the pass.
    Root,
    /// All take the same area.
    EqualArea,
    /// All go deeper by the same.
    EqualDepth,
    /// As tables of makers have it.
    Table,
}

/// The most passes that are written.
pub(crate) const MOST: u32 = 200;

impl Law {
    /// The depths of `passes` passes, the last of them `full_mm`; fewer where cuts would be shallower than
    /// `least_mm`.
    pub(crate) fn depths_mm(self, edge: &Edge, full_mm: f64, passes: u32, least_mm: f64) -> Vec<f64> {
        let mut depths = Vec::new();
        let mut last = 0.0;
        for n in 1..=passes {
            let depth: f64 = self.depth_mm(edge, full_mm, n, passes).max(last + least_mm);
            if depth >= full_mm - 0.5 * least_mm || n == passes {
                depths.push(full_mm);
                break;
            }
            depths.push(depth);
            last = depth;
        }
        depths
    }

    fn depth_mm(self, edge: &Edge, full_mm: f64, n: u32, passes: u32) -> f64 {
        let share = f64::from(n) / f64::from(passes);
        match self {
            Law::Root => full_mm * share.sqrt(),
            Law::EqualDepth => full_mm * share,
            Law::EqualArea => of_area(edge, full_mm, share),
            Law::Table if passes == 1 => full_mm,
            Law::Table => {
                let phi = if n == 1 { 0.3 } else { f64::from(n - 1) };
                full_mm * (phi / f64::from(passes - 1)).sqrt()
            }
        }
    }
}

/// The depth at which an edge has cut a share of its area at full depth, mm.
fn of_area(edge: &Edge, full_mm: f64, share: f64) -> f64 {
    let wanted = share * edge.area_mm2(full_mm);
    let (mut low, mut high) = (0.0, full_mm);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if edge.area_mm2(middle) < wanted { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

impl Infeed {
    /// How far towards higher Z the pass of number `n` (from 0) of `count` stands beside the groove, mm
    /// (M202). It goes from depth `before_mm` to `depth_mm` of `full_mm`, `towards` is the direction of the
    /// cut along Z, `flank_deg` are the flanks towards lower and higher Z.
    pub(crate) fn beside_mm(
        self,
        (n, count): (usize, usize),
        [before_mm, depth_mm, full_mm]: [f64; 3],
        flank_deg: [f64; 2],
        towards: f64,
    ) -> f64 {
        let tangent = |deg: f64| libm::tan(deg.to_radians());
        let [lower, higher] = flank_deg;
        let left_mm = full_mm - depth_mm;
        // The flank behind a tool that goes towards lower Z is the one of higher Z.
        let (behind, side) = if towards < 0.0 { (higher, 1.0) } else { (lower, -1.0) };
        match self {
            Infeed::Radial => 0.0,
            Infeed::Flank => side * left_mm * tangent(behind),
            Infeed::Modified(off_deg) => side * left_mm * tangent((behind - off_deg).max(0.0)),
            Infeed::Alternating => {
                let side = if n.is_multiple_of(2) { side } else { -side };
                let deg = if side > 0.0 { higher } else { lower };
                // The last pass runs in the middle: the one before it leaves it one flank.
                let half_mm = if n + 2 == count { left_mm } else { 0.5 * (depth_mm - before_mm) };
                side * half_mm.min(left_mm) * tangent(deg)
            }
        }
    }

    /// In words.
    #[must_use]
    pub fn text(self) -> String {
        match self {
            Infeed::Radial => "straight in".into(),
            Infeed::Flank => "along a flank".into(),
            Infeed::Modified(off_deg) => format!("{off_deg} degrees off a flank"),
            Infeed::Alternating => "on both flanks in turns".into(),
        }
    }

    /// The angle that a cycle names for it, degrees; none if a cycle cannot say it.
    pub(crate) fn cycle_deg(self, flank_deg: [f64; 2], towards: f64) -> Option<f64> {
        let behind = flank_deg[usize::from(towards < 0.0)];
        match self {
            Infeed::Radial => Some(0.0),
            Infeed::Flank => Some(behind),
            Infeed::Modified(off_deg) => Some((behind - off_deg).max(0.0)),
            Infeed::Alternating => None,
        }
    }
}

/// Deepest first cut, mm: Tungaloy, general catalogue 2020-2021, page 1636.
pub(crate) const DEEPEST_CUT_MM: f64 = 0.5;

/// How many passes a pitch takes: about the middle of what the same page prints.
pub(crate) fn passes(pitch_mm: f64) -> u32 {
    const BY_PITCH: [(f64, u32); 12] = [
        (0.6, 5),
        (0.9, 6),
        (1.1, 6),
        (1.3, 7),
        (1.6, 8),
        (2.1, 10),
        (2.6, 11),
        (3.1, 13),
        (4.1, 15),
        (4.6, 16),
        (5.1, 18),
        (6.1, 20),
    ];
    BY_PITCH.iter().find(|(up_to, _)| pitch_mm <= *up_to).map_or(24, |(_, passes)| *passes)
}

#[cfg(test)]
mod tests {
    use super::{Infeed, Law, passes};
    use gauge::Edge;

    const SHARP: Edge = Edge { flank_deg: [30.0; 2], flat_mm: 0.0, nose_mm: 0.0 };
    const FLAT: Edge = Edge { flank_deg: [15.0; 2], flat_mm: 0.6, nose_mm: 0.1 };

    #[test]
    fn equal_area_is_the_root_of_the_number_for_a_sharp_tool() {
        for (n, depth) in Law::EqualArea.depths_mm(&SHARP, 1.2, 9, 0.0).iter().enumerate() {
            let root = 1.2 * ((n as f64 + 1.0) / 9.0).sqrt();
            assert!((depth - root).abs() < 1e-12, "{n}: {depth} {root}");
        }
    }

    #[test]
    fn every_pass_of_equal_area_takes_the_same() {
        let depths = Law::EqualArea.depths_mm(&FLAT, 2.5, 14, 0.0);
        let mut before = 0.0;
        for depth in &depths {
            let area = FLAT.area_mm2(*depth);
            assert!((area - before - FLAT.area_mm2(2.5) / 14.0).abs() < 1e-9, "{depth}");
            before = area;
        }
        assert_eq!((depths.len(), depths[13]), (14, 2.5));
    }

    #[test]
    fn no_cut_is_shallower_than_the_least() {
        for law in [Law::Root, Law::EqualArea, Law::EqualDepth, Law::Table] {
            let depths = law.depths_mm(&SHARP, 1.0, 30, 0.05);
            let cuts = depths.iter().scan(0.0, |last, depth| Some(depth - std::mem::replace(last, *depth)));
            assert!(cuts.clone().all(|cut| cut >= 0.025 - 1e-12), "{law:?} {:?}", cuts.collect::<Vec<_>>());
            assert_eq!(depths.last(), Some(&1.0));
        }
        assert_eq!(Law::Table.depths_mm(&SHARP, 1.0, 1, 0.02), [1.0]);
    }

    #[test]
    fn the_table_is_that_of_its_source() {
        // By hand: 1.28 (φ/7)^½.
        let depths = Law::Table.depths_mm(&SHARP, 1.28, 8, 0.0);
        let rounded: Vec<f64> = depths.iter().map(|depth| (depth * 100.0).round() / 100.0).collect();
        assert_eq!(rounded, [0.26, 0.48, 0.68, 0.84, 0.97, 1.08, 1.19, 1.28]);
    }

    #[test]
    fn no_pass_leaves_the_groove() {
        for infeed in [Infeed::Radial, Infeed::Flank, Infeed::Modified(1.0), Infeed::Alternating] {
            for towards in [-1.0, 1.0] {
                let depths = Law::Root.depths_mm(&SHARP, 1.2, 6, 0.0);
                let mut before = 0.0;
                for (n, depth) in depths.into_iter().enumerate() {
                    let beside = infeed.beside_mm((n, 6), [before, depth, 1.2], [3.0, 30.0], towards);
                    let room = [3.0_f64, 30.0].map(|deg| (1.2 - depth) * libm::tan(deg.to_radians()));
                    assert!(
                        -room[0] - 1e-12 <= beside && beside <= room[1] + 1e-12,
                        "{infeed:?} {n}: {beside}"
                    );
                    before = depth;
                }
            }
        }
        let beside = Infeed::Flank.beside_mm((0, 3), [0.0, 0.5, 1.5], [0.0, 45.0], -1.0);
        assert_eq!(beside, libm::tan(45.0_f64.to_radians()));
    }

    /// In turns, one flank of each pass but the first touches nothing that is left.
    #[test]
    fn in_turns_one_flank_cuts() {
        let depths = Law::Root.depths_mm(&SHARP, 1.5, 10, 0.0);
        let tangent = libm::tan(30.0_f64.to_radians());
        let (mut before, mut reached) = (0.0, [0.0; 2]);
        for (n, depth) in depths.iter().copied().enumerate() {
            let beside =
                Infeed::Alternating.beside_mm((n, depths.len()), [before, depth, 1.5], [30.0; 2], -1.0);
            // Where its flanks cross the crest.
            let crosses = [depth * tangent - beside, depth * tangent + beside];
            let cuts = [0, 1].map(|side| crosses[side] > reached[side] + 1e-9);
            assert!(n == 0 || cuts[0] != cuts[1], "{n}: {crosses:?} {reached:?}");
            reached = [0, 1].map(|side| crosses[side].max(reached[side]));
            before = depth;
        }
        assert!(reached.iter().all(|mm| (mm - 1.5 * tangent).abs() < 1e-9), "{reached:?}");
    }

    #[test]
    fn passes_grow_with_the_pitch() {
        let counts = [0.5, 1.0, 2.0, 3.0, 6.0, 10.0].map(passes);
        assert_eq!(counts, [5, 6, 10, 13, 20, 24]);
    }
}
