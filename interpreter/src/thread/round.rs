//! Threads along an arc: as few legs as follow it. In: ends and centre, mm, the lead along Z, mm/rev. Out:
//! legs, of which Z keeps its lead and X is a parabola. An arc that is nowhere steeper than 45 degrees to X
//! is one on a face: the same with the two axes exchanged.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | R, u | mm | radius of the arc; distance from its middle along Z |
//! | h | mm | length of a piece along Z |
//! | e | mm | how far the parabola through both ends and the middle of a piece is off at most |
//!
//! ```text
//! x‴ = 3 R² u/(R² − u²)^(5/2);   e ≤ h³ max |x‴|/(72 √3)                                           (M204)
//! ```
//! A piece is as long as e allows; a knot lies where the arc is farthest out, so that each end of a piece is
//! its highest or lowest place. Where the end misses the circle by a rounding, the arc leans by as much.

use motion::MOST_CHANGES;

use super::chain::{Broken, Leg};
use super::cut::{Along, Point};

/// How far pieces may be off the arc, mm: the first that takes few enough.
const OFF_MM: [f64; 2] = [0.0002, 0.0005];
/// An arc at 45 degrees to Z may be steeper by a rounding of its ends: the tangent.
const STEEPEST: f64 = 1.0 + 1e-3;
/// An end that is lower than the farthest place by less is as far out, mm.
const FLAT_MM: f64 = 1e-4;
/// Pieces that one arc may have: each is a corner, and the last lead stops to grow in another one.
const MOST_PIECES: usize = MOST_CHANGES - 1;
/// Pieces that are counted of an arc that takes too many.
const COUNTED: usize = 99;
/// Halvings that find the length of a piece, and the least that pieces are off.
const HALVINGS: u32 = 30;

/// Where the centre of an arc lies, mm, and which way round it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Round {
    pub(crate) centre: Point,
    /// From Z+ towards X+: G3 and G36.
    pub(crate) counterclockwise: bool,
}

/// An arc as a function X of Z.
struct Arc {
    centre: Point,
    /// R.
    radius: f64,
    /// The side of the centre on which it lies, ±1.
    side: f64,
    /// By how much it leans, for its end to be the programmed one.
    lean: f64,
    from_z: f64,
}

impl Arc {
    fn x(&self, z: f64) -> f64 {
        let u = z - self.centre.z;
        let circle = self.centre.x + self.side * (self.radius * self.radius - u * u).max(0.0).sqrt();
        circle + self.lean * (z - self.from_z)
    }

    /// How far the parabola of a piece is off at most, mm (M204).
    fn off_mm(&self, [from, to]: [f64; 2]) -> f64 {
        let u = (from - self.centre.z).abs().max((to - self.centre.z).abs());
        let square = self.radius * self.radius;
        let third = 3.0 * square * u / libm::pow((square - u * u).max(0.0), 2.5);
        libm::pow((to - from).abs(), 3.0) * third / (72.0 * 3.0_f64.sqrt())
    }

    /// Where a piece that is off by `most_mm` ends, at `end` at the latest.
    fn reaches(&self, from: f64, end: f64, most_mm: f64) -> f64 {
        if self.off_mm([from, end]) <= most_mm {
            return end;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.off_mm([from, from + middle * (end - from)]) <= most_mm {
                true => low = middle,
                false => high = middle,
            }
        }
        from + low * (end - from)
    }

    /// Where its pieces between two places end along Z, each off by no more than `most_mm`; [`COUNTED`] at
    /// most.
    fn pieces(&self, [from, end]: [f64; 2], most_mm: f64) -> Vec<f64> {
        let next = |at: &f64| (*at != end).then(|| self.reaches(*at, end, most_mm));
        core::iter::successors(Some(from), next).skip(1).take(COUNTED).collect()
    }

    /// As few pieces as `most_mm` allows, and with as many the least that each can be off.
    fn even(&self, range: [f64; 2], most_mm: f64) -> Vec<f64> {
        let mut best = self.pieces(range, most_mm);
        let (mut low, mut high) = (0.0, most_mm);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let pieces = self.pieces(range, middle);
            match pieces.len() <= best.len() {
                true => (high, best) = (middle, pieces),
                false => low = middle,
            }
        }
        best
    }

    /// Where its pieces end along Z, if they are no more than [`MOST_PIECES`]; else how many there would be.
    fn knots(&self, end: f64, most_mm: f64) -> Result<Vec<f64>, usize> {
        let farthest = self.centre.z;
        let rises = |z: f64| (farthest - z) * (farthest - z) / (2.0 * self.radius) > FLAT_MM;
        let inside = (farthest - self.from_z) * (end - farthest) > 0.0 && rises(self.from_z) && rises(end);
        let ranges = match inside {
            true => vec![[self.from_z, farthest], [farthest, end]],
            false => vec![[self.from_z, end]],
        };
        let count: usize = ranges.iter().map(|range| self.pieces(*range, most_mm).len()).sum();
        if count > MOST_PIECES {
            return Err(count);
        }
        Ok(ranges.into_iter().flat_map(|range| self.even(range, most_mm)).collect())
    }
}

impl Round {
    /// The legs of a thread along an arc from a point to another, whose lead is `lead_mm` along Z, or along X
    /// where it lies on a face.
    ///
    /// # Errors
    /// It is steeper than 45 degrees against either axis anywhere, or takes more pieces than a pass has.
    pub(crate) fn legs(&self, line: u32, ends: [Point; 2], lead_mm: f64) -> Result<Vec<Leg>, Broken> {
        let legs = self.along_z(line, ends, lead_mm);
        if legs != Err(Broken::Steep) {
            return legs;
        }
        let exchanged = Round { centre: self.centre.exchanged(), counterclockwise: !self.counterclockwise };
        let legs = exchanged.along_z(line, ends.map(Point::exchanged), lead_mm)?;
        Ok(legs.into_iter().map(Leg::exchanged).collect())
    }

    fn along_z(&self, line: u32, [from, to]: [Point; 2], lead_mm: f64) -> Result<Vec<Leg>, Broken> {
        let arc = self.arc([from, to])?;
        let mut least = Err(0);
        for most_mm in OFF_MM {
            least = arc.knots(to.z, most_mm);
            if least.is_ok() {
                break;
            }
        }
        let knots = least.map_err(Broken::TooRound)?;
        let lead_z = lead_mm.copysign(to.z - from.z);
        let mut at = from.z;
        Ok(knots
            .into_iter()
            .enumerate()
            .map(|(number, z)| {
                let turns = (z - at) / lead_z;
                let [x0, middle, x1] = [at, 0.5 * (at + z), z].map(|z| arc.x(z));
                let growth = 4.0 * (x0 - 2.0 * middle + x1) / (turns * turns);
                let lead = (x1 - x0) / turns - 0.5 * growth * turns;
                at = z;
                Leg {
                    line,
                    along: Along::Z,
                    to: Point { x: x1, z },
                    lead: Point { x: lead, z: lead_z },
                    growth: Point { x: growth, z: 0.0 },
                    turns,
                    within: number > 0,
                }
            })
            .collect())
    }

    fn arc(&self, [from, to]: [Point; 2]) -> Result<Arc, Broken> {
        let centre = self.centre;
        let radius = libm::hypot(from.x - centre.x, from.z - centre.z);
        let side = (from.x - centre.x).signum();
        let steep = |point: Point| (point.z - centre.z).abs() > STEEPEST * (side * (point.x - centre.x));
        // Above its centre an arc that turns from Z+ towards X+ goes towards Z-.
        let towards = if self.counterclockwise { -side } else { side };
        if steep(from) || steep(to) || towards * (to.z - from.z) <= 0.0 {
            return Err(Broken::Steep);
        }
        let mut arc = Arc { centre, radius, side, lean: 0.0, from_z: from.z };
        arc.lean = (to.x - arc.x(to.z)) / (to.z - from.z);
        Ok(arc)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testing::Seed;

    /// Whatever the arc, along Z or on a face: its legs follow each other, end where it ends, and are no
    /// farther off than they may.
    #[test]
    fn legs_follow_the_circle() {
        let (mut worst, mut most, mut refused) = (0.0_f64, 0, 0);
        for case in 0..2000 {
            let mut seed = Seed::of_case(case);
            let radius = 2.0 * libm::pow(500.0, seed.unit());
            let angle = |unit: f64| (90.0 * unit - 45.0).to_radians();
            let [a, b] = [angle(seed.unit()), angle(seed.unit())];
            let side = if case % 2 == 0 { 1.0 } else { -1.0 };
            let (face, centre) = (case % 4 > 1, Point { x: 30.0, z: -7.0 });
            let on = |a: f64| {
                let [across, along] = [side * radius * libm::cos(a), radius * libm::sin(a)];
                let [x, z] = if face { [along, across] } else { [across, along] };
                Point { x: centre.x + x, z: centre.z + z }
            };
            let (from, to, lead_mm) = (on(a), on(b), 0.5 + 3.0 * seed.unit());
            // From Z+ to X+ is the other way round from X+ to Z+.
            let counterclockwise = ((b > a) == (side < 0.0)) != face;
            let round = Round { centre, counterclockwise };
            let legs = match round.legs(7, [from, to], lead_mm) {
                Ok(legs) => legs,
                Err(why) => {
                    let long = libm::hypot(to.x - from.x, to.z - from.z);
                    assert!(matches!(why, Broken::TooRound(_)) && long > 11.0, "{why:?}, case {case}");
                    refused += 1;
                    continue;
                }
            };
            most = most.max(legs.len());
            let mut at = from;
            for leg in &legs {
                for step in 0..=32 {
                    let n = leg.turns * f64::from(step) / 32.0;
                    let x = at.x + leg.lead.x * n + 0.5 * leg.growth.x * n * n;
                    let z = at.z + leg.lead.z * n + 0.5 * leg.growth.z * n * n;
                    worst = worst.max((libm::hypot(x - centre.x, z - centre.z) - radius).abs());
                    assert_eq!(leg.along, if face { Along::X } else { Along::Z });
                    assert_eq!(leg.along.of(leg.growth), 0.0);
                    assert!((leg.along.of(leg.lead).abs() - lead_mm).abs() < 1e-12);
                }
                at = leg.to;
            }
            assert!((at.x - to.x).abs() < 1e-9 && (at.z - to.z).abs() < 1e-9, "case {case}");
            let back = Round { counterclockwise: !counterclockwise, ..round };
            assert_eq!(back.legs(7, [from, to], lead_mm), Err(Broken::Steep), "the other way round");
        }
        assert!(worst <= OFF_MM[1], "{worst} mm");
        assert!(most == MOST_PIECES && refused > 0 && refused < 600, "{most} pieces, {refused} refused");
    }

    /// An arc about X20 Z0 from one angle to another, degrees from Z+ towards X+.
    fn legs(radius: f64, from: f64, to: f64) -> Result<usize, Broken> {
        let round = Round { centre: Point { x: 20.0, z: 0.0 }, counterclockwise: from < to };
        let on = |deg: f64| Point {
            x: 20.0 + radius * libm::sin(deg.to_radians()),
            z: radius * libm::cos(deg.to_radians()),
        };
        round.legs(1, [on(from), on(to)], 1.0).map(|legs| legs.len())
    }

    #[test]
    fn an_arc_that_is_steep_against_both_axes_is_refused() {
        assert!(legs(8.0, 45.0, 135.0).is_ok() && legs(8.0, -45.0, -135.0).is_ok());
        assert!(legs(8.0, 45.0, -45.0).is_ok() && legs(8.0, 135.0, 225.0).is_ok(), "on a face");
        for (from, to) in [(44.0, 135.0), (50.0, 140.0), (-10.0, 46.0), (46.0, -45.0)] {
            assert_eq!(legs(8.0, from, to), Err(Broken::Steep), "{from} to {to}");
        }
    }

    /// What docs/chained-threads.md says of how round an arc may be.
    #[test]
    fn arcs_of_these_sizes_have_a_law() {
        for (half, radius, too_round) in [(45.0, 8.0, 8.6), (30.0, 50.0, 53.0), (20.0, 290.0, 292.0)] {
            assert!(legs(radius, 90.0 - half, 90.0 + half).is_ok(), "R{radius}");
            let refused = legs(too_round, 90.0 - half, 90.0 + half);
            assert!(matches!(refused, Err(Broken::TooRound(_))), "R{too_round}: {refused:?}");
        }
    }
}
