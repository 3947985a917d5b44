//! Where a beam meets a seam. In: where the four drives of the positioner are, mm and rad. Out: the distance
//! of the beam from the seam, mm, and the angle between the direction that belongs to the seam and the beam,
//! degrees.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | S, l | mm, – | point of the seam and its direction, in the frame of the work-holder |
//! | p, k | mm, – | the same in the frame of the machine, by M47 and M46 from where the drives really are |
//! | b | mm | where the beam stands; it runs along Z of the machine |
//!
//! ```text
//! (b − p)·p′ = 0 in the plane of X and Y,   d = |b − p|        the beam's nearest point of the seam  (M97)
//! angle = atan2(hypot(kₓ, k_y), k_z) at that point
//! ```
//! d is positive where the beam lies left of the seam. The nearest point is found by Newton's method from
//! that of the cycle before: what is early or late along the seam is not an error of its shape.

use shape::{Drives, Positioner, Series};

const STEPS: usize = 20;
const RESIDUAL_MM: f64 = 1e-7;
/// Places along the seam at which the nearest point is searched for when there is none to start from.
const STARTS: u32 = 64;

/// Point and direction of a seam at a parameter.
pub(super) type At = [[Series; 3]; 2];

/// Where the beam meets the seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    /// d.
    pub(super) deviation_mm: f64,
    /// Between the direction and the beam.
    pub(super) angle_deg: f64,
    /// The point of the seam, in the frame of the work-holder.
    pub(super) point: [f64; 3],
    t: f64,
}

/// Measures a beam against a seam.
#[derive(Clone, Debug)]
pub(super) struct Beam {
    positioner: Positioner,
    beam: [f64; 2],
    t: [f64; 2],
    last: Option<f64>,
}

impl Beam {
    /// A beam at a place of the machine, and a seam with its parameter at the start and at the end.
    pub(super) fn new(positioner: Positioner, beam: [f64; 2], t: [f64; 2]) -> Beam {
        Beam { positioner, beam, t, last: None }
    }

    /// Forgets where it was last.
    pub(super) fn lift(&mut self) {
        self.last = None;
    }

    /// Where the beam meets the seam; `None` if no nearest point is found.
    pub(super) fn spot(&mut self, drives: &Drives, seam: impl Fn(f64) -> At) -> Option<Spot> {
        let near = self.last.and_then(|last| self.solve(drives, &seam, last));
        let spot = near.or_else(|| self.search(drives, &seam));
        self.last = spot.map(|spot| spot.t);
        spot
    }

    /// The nearest of all points that are nearer than their neighbours.
    fn search(&self, drives: &Drives, seam: &impl Fn(f64) -> At) -> Option<Spot> {
        let [from, to] = self.t;
        let start = |i: u32| from + (to - from) * f64::from(i) / f64::from(STARTS);
        let spots = (0..=STARTS).filter_map(|i| self.solve(drives, seam, start(i)));
        spots.min_by(|a, b| a.deviation_mm.abs().total_cmp(&b.deviation_mm.abs()))
    }

    fn solve(&self, drives: &Drives, seam: &impl Fn(f64) -> At, start: f64) -> Option<Spot> {
        let most = (0.05 * (self.t[1] - self.t[0])).abs();
        let mut t = start;
        for _ in 0..STEPS {
            let [point, direction] = seam(t);
            let of = |n: usize| point.map(|series| series.derivative(n));
            let [x, y, _] = self.positioner.forward(of(0), drives);
            let ([u, v, _], [u2, v2, _]) =
                (Positioner::turned(of(1), drives), Positioner::turned(of(2), drives));
            let (across, up) = (self.beam[0] - x, self.beam[1] - y);
            let (left, bend) = (across * u + up * v, u * u + v * v - across * u2 - up * v2);
            let speed = libm::hypot(u, v);
            if left.abs() <= RESIDUAL_MM * speed {
                let k = Positioner::turned(direction.map(|series| series.value()), drives);
                return (bend > 0.0).then(|| Spot {
                    deviation_mm: (up * u - across * v) / speed,
                    angle_deg: libm::atan2(libm::hypot(k[0], k[1]), k[2]).to_degrees(),
                    point: of(0),
                    t,
                });
            }
            t += (left / bend).clamp(-most, most);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::{At, Beam};
    use core::f64::consts::TAU;
    use shape::{Branch, Drives, Function, Number, Positioner, Series};

    const PLACE: Positioner = Positioner { x1: 12.0, y1: -7.0, z1: 150.0, x2: -3.0, y2: 5.0, z2: 40.0 };
    const BEAM: [f64; 2] = [30.0, 20.0];

    /// Where a cylinder of 40 mm across one of 60 mm meets it, with a direction between both normals.
    fn saddle(t: f64) -> At {
        let t = Series::variable(t);
        let (sin, cos) = (t.apply(Function::Sin), t.apply(Function::Cos));
        let twenty = Series::constant(20.0);
        let (x, y) = (twenty * cos, twenty * sin);
        let z = (Series::constant(900.0) - y * y).sqrt();
        let third = Series::constant(1.0 / 30.0);
        [[x, y, z], [cos, sin + y * third, z * third]]
    }

    /// Where the drives would have to be for a point beside the seam, a distance to its left.
    fn beside(t: f64, d: f64) -> Drives {
        let [point, direction] = saddle(t);
        let value = |series: [Series; 3]| series.map(|series| series.value());
        let pose = PLACE.inverse(value(point), value(direction), BEAM, Branch::Negative, 0.0);
        let [u, v, _] = Positioner::turned(point.map(|series| series.derivative(1)), &pose);
        let speed = libm::hypot(u, v);
        // The beam stands still: to have it left of the seam the part goes right.
        Drives { x: pose.x + d * v / speed, y: pose.y - d * u / speed, ..pose }
    }

    #[test]
    fn a_beam_beside_the_seam_is_as_far_as_it_is() {
        let mut beam = Beam::new(PLACE, BEAM, [0.0, TAU]);
        for step in 0..=360 {
            let (t, d) = (TAU * f64::from(step) / 360.0, 1e-3 * f64::from(step % 9 - 4));
            let spot = beam.spot(&beside(t, d), saddle).expect("there is a nearest point");
            assert!((spot.deviation_mm - d).abs() <= 1e-9, "{step}: {spot:?} for {d}");
            assert!(spot.angle_deg <= 1e-5, "{step}: {spot:?}");
        }
    }

    /// A drive that turns too far by an angle turns the direction off the beam by as much, or less.
    #[test]
    fn the_angle_is_that_by_which_the_tilt_is_wrong() {
        for step in 0..36 {
            let t = 0.1 + TAU * f64::from(step) / 36.0;
            let pose = beside(t, 0.0);
            // About the point itself, so that it stays under the beam.
            let tilted = Drives { alpha: pose.alpha + 1e-4, ..pose };
            let [point, _] = saddle(t);
            let point = point.map(|series| series.value());
            let [before, after] = [&pose, &tilted].map(|drives| PLACE.forward(point, drives));
            let tilted =
                Drives { x: tilted.x + before[0] - after[0], y: tilted.y + before[1] - after[1], ..tilted };
            let spot = Beam::new(PLACE, BEAM, [0.0, TAU]).spot(&tilted, saddle).expect("nearest");
            assert!(spot.deviation_mm.abs() <= 1e-9, "{step}: {spot:?}");
            assert!((spot.angle_deg - 1e-4_f64.to_degrees()).abs() <= 1e-6, "{step}: {spot:?}");
        }
    }
}
