//! The diameter that was turned or bored before the thread: its crest. In: the true place of the tip in every
//! control cycle of motion at a feed, mm. Out: the least and the largest diameter along the thread, if all of
//! it was turned.
//!
//! The length of the thread is looked at in [`BINS`] places; in each the tip that reached deepest counts.
//! Where that one went across the axis rather than along it (a face, a chamfer, a groove) there is no crest.
//! A tip beyond the bottom of the grooves is in the bore of a screw or on the outside of a nut, which is no
//! crest either; where it goes across, as a chamfer that begins below the grooves, no crest is left. Which
//! way a tip goes is seen over [`WAY_MM`]: while it comes to rest it goes anywhere, by less than 1 µm.

use gauge::{Nominal, Side};

const BINS: usize = 128;
const WAY_MM: f64 = 0.01;
/// Steeper than this, dX by dZ, a cut is no cylinder: chamfers of threads have 0.27 (15°) and more.
const STEEPEST: f64 = 0.25;

/// Collects what tools leave.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    side: Side,
    /// Radius of the pitch line at Z 0, its change along Z, and how far from it grooves reach at most.
    pitch_line_mm: [f64; 3],
    /// Where the thread is at full depth, along Z.
    along_mm: [f64; 2],
    /// Radius in each place, and whether it was cut along the axis; none where nothing was turned.
    cuts: Vec<Option<(f64, bool)>>,
    /// Where the way that is looked at began.
    from: Option<[f64; 2]>,
    goes_along: bool,
}

impl Turned {
    pub(super) fn new(nominal: &Nominal, along_mm: [f64; 2]) -> Turned {
        let (side, slope) = (nominal.side, nominal.taper / 2.0);
        let middle = nominal.pitch_diameter_mm.iter().sum::<f64>() / 4.0;
        // Where the flanks meet a groove ends, half the height of a sharp thread from that line; and some
        // more.
        let [one, other] = nominal.flank_deg.map(|deg| libm::tan(deg.to_radians()));
        let reach = 0.55 * nominal.pitch_mm / (one + other);
        let pitch_line_mm = [middle - slope * nominal.plane_mm, slope, reach];
        Turned { side, pitch_line_mm, along_mm, cuts: vec![None; BINS], from: None, goes_along: false }
    }

    /// Takes a control cycle: X from the axis and Z, if the tool is moved at a feed.
    pub(super) fn cycle(&mut self, tip: Option<[f64; 2]>) {
        let (Some([x0, z0]), Some([x, z])) = (self.from, tip) else {
            (self.from, self.goes_along) = (tip, false);
            return;
        };
        if libm::hypot(x - x0, z - z0) >= WAY_MM {
            (self.from, self.goes_along) = (tip, (x - x0).abs() <= STEEPEST * (z - z0).abs());
        }
        let [low, high] = self.along_mm;
        if !(low..=high).contains(&z) || low >= high {
            return;
        }
        let [middle, slope, reach] = self.pitch_line_mm;
        let beyond = x.abs() - (middle + slope * z);
        let is_other_wall = reach < if self.side == Side::External { -beyond } else { beyond };
        if is_other_wall && self.goes_along {
            return;
        }
        let bin = ((z - low) / (high - low) * BINS as f64) as usize;
        let Some(cut) = self.cuts.get_mut(bin) else { return };
        let (x, side) = (x.abs(), self.side);
        let deeper = |(radius, _): (f64, bool)| match side {
            Side::External => x < radius,
            Side::Internal => x > radius,
        };
        if cut.is_none_or(deeper) {
            *cut = Some((x, self.goes_along));
        }
    }

    /// Least and largest diameter, mm; `None` if some of the length was not turned, or half of it is no
    /// crest.
    pub(super) fn diameters_mm(&self) -> Option<[f64; 2]> {
        let cuts: Vec<(f64, bool)> = self.cuts.iter().copied().collect::<Option<_>>()?;
        let crest = || cuts.iter().filter(|(_, along)| *along).map(|(radius, _)| *radius);
        if 2 * crest().count() < BINS {
            return None;
        }
        Some([2.0 * crest().reduce(f64::min)?, 2.0 * crest().reduce(f64::max)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn m20x2() -> Nominal {
        "M20x2-6g".parse().expect("a name")
    }

    /// The end of a bolt is chamfered from below its grooves: of the rough cut nothing is left there.
    #[test]
    fn a_chamfer_that_begins_below_the_grooves_leaves_no_crest() {
        let rough = [[10.5, 1.0], [10.5, -25.0]];
        let finish = [[[6.0, 0.0], [9.91, -3.91]], [[9.91, -3.91], [9.91, -25.0]]];
        let one = turned(Side::External, &[rough, finish[0], finish[1]]).diameters_mm();
        assert_eq!(one, Some([19.82, 19.82]));
    }

    fn turned(side: Side, ways: &[[[f64; 2]; 2]]) -> Turned {
        let nominal = gauge::Nominal { side, ..m20x2() };
        let mut turned = Turned::new(&nominal, [-20.0, -1.0]);
        for [from, to] in ways {
            let at = |step: i32| [0, 1].map(|i| from[i] + (to[i] - from[i]) * f64::from(step) / 2000.0);
            (0..=2000).for_each(|step| turned.cycle(Some(at(step))));
            turned.cycle(None);
        }
        turned
    }

    #[test]
    fn the_deepest_cut_along_the_thread_counts() {
        let rough = [[10.5, 1.0], [10.5, -25.0]];
        let fine = [[9.91, 1.0], [9.91, -25.0]];
        let facing = [[10.5, -5.0], [0.0, -5.0]];
        assert_eq!(turned(Side::External, &[rough, fine, facing]).diameters_mm(), Some([19.82, 19.82]));
        let bored = [[[8.7, 1.0], [8.7, -25.0]], [[8.6, 1.0], [8.6, -25.0]]];
        assert_eq!(turned(Side::Internal, &bored).diameters_mm(), Some([17.4, 17.4]));
        let half = [[9.91, 1.0], [9.91, -12.0]];
        assert_eq!(turned(Side::External, &[half]).diameters_mm(), None, "not all of it");
        let both = turned(Side::External, &[rough, half]).diameters_mm();
        assert_eq!(both, Some([19.82, 21.0]), "a step");
    }

    /// A screw with a hole through it, a nut whose outside is turned.
    #[test]
    fn the_other_side_of_the_wall_is_no_crest() {
        let along = |x: f64| [[x, 1.0], [x, -25.0]];
        let screw = turned(Side::External, &[along(9.91), along(0.005), along(6.0)]);
        assert_eq!(screw.diameters_mm(), Some([19.82, 19.82]));
        let nut = turned(Side::Internal, &[along(8.7), along(15.0)]);
        assert_eq!(nut.diameters_mm(), Some([17.4, 17.4]));
        assert_eq!(turned(Side::External, &[along(0.0)]).diameters_mm(), None);
        let thin = turned(Side::External, &[along(9.91), along(8.9)]);
        assert_eq!(thin.diameters_mm(), Some([17.8, 17.8]), "a crest turned off is one that was turned off");
    }

    /// A tool that faces comes to rest within a fraction of a micrometre of its place, in any direction.
    #[test]
    fn a_face_a_chamfer_and_a_tool_at_rest_are_no_crest() {
        let fine = [[9.91, 1.0], [9.91, -25.0]];
        let facing = [[10.5, -1.001], [-0.4, -1.001]];
        let rest = [[-0.4, -1.001], [-0.4, -1.0015]];
        assert_eq!(turned(Side::External, &[facing, rest, fine]).diameters_mm(), Some([19.82, 19.82]));
        for chamfer in [[[8.0, -0.5], [10.4, -2.9]], [[9.0, -0.5], [9.99, -4.2]]] {
            let one = turned(Side::External, &[fine, chamfer]).diameters_mm();
            assert_eq!(one, Some([19.82, 19.82]), "{chamfer:?}");
        }
        let mostly = [[[8.4, -1.0], [9.9, -6.8]], [[8.4, -12.0], [9.9, -17.8]]];
        assert_eq!(turned(Side::External, &[fine, mostly[0], mostly[1]]).diameters_mm(), None);
    }
}
