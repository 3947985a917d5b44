//! What feeds leave of a part that turns, outside and inside. In: the true place of the tip in every row of
//! the trace, mm. Out: radii over Z.
//!
//! A feed with what comes after it, up to where the tool is free, is an excursion. Outside or inside is told
//! by how the tool leaves: at right angles to what it has cut along Z, or, in rapid motion, away from where
//! it has stopped. One that stays on the axis is a drill.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z, r | mm | tip along the axis and from it; z is looked at every [`STEP_MM`] |
//! | Δr | mm | by how much r grows as the tool leaves |
//!
//! ```text
//! (M169) r_o(z) = min r   over excursions with Δr > 0, or where Δr is not known
//!        r_i(z) = max r   over those with Δr < 0
//! ```

use std::collections::BTreeMap;

use protocol::{Axis, Motion};
use rig::observe::{Summary, ToolNote};
use rig::trace::Row;

/// Places along Z, and how far the tip moves from one point that is looked at to the next.
const STEP_MM: f64 = 0.02;
const NEAR_MM: f64 = 0.004;
/// What is less than this is no way.
const LEAST_MM: f64 = 0.05;

/// What lies beyond a place, mm.
const BEYOND_MM: f64 = 1e-6;

/// Radii over Z, of places that are so many steps from Z 0.
type Radii = BTreeMap<i64, f64>;

/// What tools have left so far.
#[derive(Clone, Debug, Default)]
pub(in crate::run) struct Swept {
    outer: Radii,
    inner: Radii,
    /// Where a tool went across to the axis.
    pub(super) faces_mm: Vec<f64>,
    excursion: Option<Excursion>,
}

/// A feed that is not at its end, or not left.
#[derive(Clone, Debug)]
struct Excursion {
    /// Least and largest radius.
    radii: BTreeMap<i64, [f64; 2]>,
    ends_mm: [f64; 2],
    /// Z and X: of the point that was looked at last, and of the last one.
    last: [f64; 2],
    seen: [f64; 2],
    /// How far it went along Z in all, and how far r has grown since it last did.
    along_mm: f64,
    across_mm: f64,
    farthest_mm: f64,
    width_mm: f64,
    is_over: bool,
}

impl Swept {
    /// Takes the next row; `in_pass` is one of a thread.
    pub(super) fn add(&mut self, summary: &Summary, in_pass: bool, row: &Row) {
        let [Some(x), Some(z)] = [Axis::X, Axis::Z].map(|axis| row.axis(axis)) else { return };
        let tool = summary.tools.get(&row.led.tool);
        let [x_origin, z_origin] = tool.and_then(|tool| tool.origin_mm).unwrap_or_default();
        let at = [z.slide - z_origin, x.slide - x_origin];
        match row.led.motion {
            _ if in_pass => self.end(None),
            Motion::Feed => {
                let on_axis = at[1].abs() < LEAST_MM;
                let width = |tool: &ToolNote| if on_axis { tool.drill_mm() } else { tool.width_mm };
                self.feed(at, tool.and_then(width).unwrap_or(0.0));
            }
            Motion::Rapid => self.leave(at),
            Motion::None => {}
        }
    }

    fn feed(&mut self, at: [f64; 2], width_mm: f64) {
        if self.excursion.as_ref().is_some_and(|excursion| excursion.is_over) {
            self.end(None);
        }
        let excursion = self.excursion.get_or_insert_with(|| Excursion::new(at, width_mm));
        excursion.seen = at;
        let gone = libm::hypot(at[0] - excursion.last[0], at[1] - excursion.last[1]);
        if gone >= NEAR_MM {
            let face = excursion.go(at);
            let is_new = |z: &f64| self.faces_mm.last().is_none_or(|last| (z - last).abs() > LEAST_MM);
            self.faces_mm.extend(face.filter(is_new));
        }
    }

    fn leave(&mut self, at: [f64; 2]) {
        let Some(excursion) = &mut self.excursion else { return };
        if !excursion.is_over {
            excursion.go(excursion.seen);
            excursion.is_over = true;
        }
        let away = at[1].abs() - excursion.last[1].abs();
        let [low, high] = excursion.ends_mm;
        if away.abs() > LEAST_MM {
            self.end(Some(away));
        } else if !(low - LEAST_MM..=high + LEAST_MM).contains(&at[0]) {
            self.end(None);
        }
    }

    /// Ends an excursion, by how much the radius grew in rapid motion, if it did.
    fn end(&mut self, away: Option<f64>) {
        let Some(excursion) = self.excursion.take() else { return };
        if excursion.farthest_mm < LEAST_MM {
            let radius = 0.5 * excursion.width_mm;
            excursion.radii.keys().for_each(|key| keep(&mut self.inner, *key, radius, f64::max));
            return;
        }
        let is_inside = excursion.leaves(away) < 0.0;
        let wide = if is_inside { 0.0 } else { 0.5 * excursion.width_mm };
        let beside = (wide / STEP_MM) as i64;
        for (key, [least, most]) in excursion.radii {
            for key in key - beside..=key + beside {
                if is_inside {
                    keep(&mut self.inner, key, most, f64::max);
                } else {
                    keep(&mut self.outer, key, least, f64::min);
                }
            }
        }
    }

    /// Nothing more comes.
    pub(super) fn finished(&self) -> Swept {
        let mut all = self.clone();
        all.end(None);
        all
    }

    /// Radii left at a place: outside and inside (M169).
    pub(super) fn at(&self, z_mm: f64) -> [Option<f64>; 2] {
        [&self.outer, &self.inner].map(|radii| between(radii, z_mm))
    }

    /// Places just beyond those, where there is none any more.
    pub(super) fn ends_mm(&self) -> impl Iterator<Item = f64> {
        let beside = |radii: &Radii, key: i64| {
            let ends = [-1, 1].into_iter().filter(|side| !radii.contains_key(&(key + side)));
            ends.map(|side| key as f64 * STEP_MM + side as f64 * (STEP_MM + BEYOND_MM)).collect::<Vec<_>>()
        };
        [&self.outer, &self.inner]
            .into_iter()
            .flat_map(move |radii| radii.keys().flat_map(move |key| beside(radii, *key)))
    }

    /// Places at which a tool has left a radius, by Z.
    pub(super) fn places_mm(&self) -> Vec<f64> {
        let mut keys: Vec<i64> = self.outer.keys().chain(self.inner.keys()).copied().collect();
        keys.sort_unstable();
        keys.dedup();
        keys.into_iter().map(|key| key as f64 * STEP_MM).collect()
    }
}

impl Excursion {
    fn new(at: [f64; 2], width_mm: f64) -> Excursion {
        Excursion {
            radii: BTreeMap::new(),
            ends_mm: [at[0]; 2],
            last: at,
            seen: at,
            along_mm: 0.0,
            across_mm: 0.0,
            farthest_mm: at[1].abs(),
            width_mm,
            is_over: false,
        }
    }

    /// Goes on to a point; where it has met the axis on its way across.
    fn go(&mut self, at: [f64; 2]) -> Option<f64> {
        let [z0, x0] = std::mem::replace(&mut self.last, at);
        let [z, x] = at;
        let (from, to) = ((z0.min(z) / STEP_MM).ceil() as i64, (z0.max(z) / STEP_MM).floor() as i64);
        for key in from..=to {
            let share = if z == z0 { 1.0 } else { (key as f64 * STEP_MM - z0) / (z - z0) };
            let radius = (x0 + share * (x - x0)).abs();
            let [least, most] = self.radii.entry(key).or_insert([radius; 2]);
            (*least, *most) = (least.min(radius), most.max(radius));
        }
        self.ends_mm = [self.ends_mm[0].min(z), self.ends_mm[1].max(z)];
        self.farthest_mm = self.farthest_mm.max(x.abs());
        let is_across = (x - x0).abs() > (z - z0).abs();
        if is_across {
            self.across_mm += x.abs() - x0.abs();
        } else {
            (self.along_mm, self.across_mm) = (self.along_mm + (z - z0).abs(), 0.0);
        }
        (is_across && x0.abs().min(x.abs()) < LEAST_MM).then_some(z)
    }

    /// By how much r grows as the tool leaves; 0 if that cannot be told.
    fn leaves(&self, away: Option<f64>) -> f64 {
        if self.along_mm > LEAST_MM && self.across_mm.abs() > LEAST_MM {
            return self.across_mm;
        }
        away.unwrap_or(0.0)
    }
}

fn keep(radii: &mut Radii, key: i64, radius: f64, of: fn(f64, f64) -> f64) {
    radii.entry(key).and_modify(|before| *before = of(*before, radius)).or_insert(radius);
}

/// The radius at a place, from those beside it.
fn between(radii: &Radii, z_mm: f64) -> Option<f64> {
    let place = z_mm / STEP_MM;
    let share = place - place.floor();
    match [place.floor(), place.ceil()].map(|key| radii.get(&(key as i64)).copied()) {
        [Some(low), Some(high)] => Some(low + share * (high - low)),
        [low, high] => low.or(high),
    }
}

#[cfg(test)]
impl Swept {
    /// What one feed along Z leaves outside.
    pub(super) fn turned([from, to]: [f64; 2], radius_mm: f64) -> Swept {
        let mut swept = Swept::default();
        swept.feed([from, radius_mm], 0.0);
        swept.feed([to, radius_mm], 0.0);
        swept.finished()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What ways of straight lines leave, in rows that are 2 µm apart.
    fn swept(ways: &[(Motion, &[[f64; 2]])], width_mm: f64) -> Swept {
        let mut swept = Swept::default();
        for (motion, corners) in ways {
            for two in corners.windows(2) {
                let steps = libm::hypot(two[1][0] - two[0][0], two[1][1] - two[0][1]) / 0.002;
                for step in 0..=steps as usize {
                    let share = step as f64 / steps;
                    let at = [0, 1].map(|i| two[0][i] + share * (two[1][i] - two[0][i]));
                    if *motion == Motion::Feed { swept.feed(at, width_mm) } else { swept.leave(at) }
                }
            }
        }
        swept.finished()
    }

    fn close(found: Option<f64>, wanted: f64) -> bool {
        found.is_some_and(|found| (found - wanted).abs() < 0.002)
    }

    #[test]
    fn the_way_out_tells_outside_from_inside() {
        let (feed, rapid) = (Motion::Feed, Motion::Rapid);
        let turned = swept(
            &[(feed, &[[1.0, 10.0], [-26.0, 10.0], [-26.0, 12.0]]), (rapid, &[[-26.0, 12.0], [8.0, 9.0]])],
            0.0,
        );
        assert!(close(turned.at(-13.0)[0], 10.0) && turned.at(-13.0)[1].is_none());
        assert!(turned.at(-26.1)[0].is_none() && close(turned.at(-25.9)[0], 10.0));
        let bored = [[1.0, 12.0], [-20.0, 12.0]];
        for out in [&[[-20.0, 12.0], [-20.0, 11.0]], &[[-20.0, 12.0], [3.0, 5.0]]] {
            let bored = swept(&[(feed, &bored), (rapid, out)], 0.0);
            assert!(close(bored.at(-13.0)[1], 12.0) && bored.at(-13.0)[0].is_none());
        }
        let groove =
            swept(&[(feed, &[[-5.0, 12.0], [-5.0, 9.0]]), (rapid, &[[-5.0, 9.0], [-5.0, 12.0]])], 2.0);
        assert!(
            close(groove.at(-5.9)[0], 9.0) && close(groove.at(-4.1)[0], 9.0) && groove.at(-3.9)[0].is_none()
        );
        let drilled = swept(
            &[(feed, &[[2.0, 0.0], [-30.0, 0.0]]), (rapid, &[[-30.0, 0.0], [2.0, 0.0], [2.0, 40.0]])],
            8.0,
        );
        assert!(close(drilled.at(-29.0)[1], 4.0) && drilled.at(-29.0)[0].is_none());
    }

    #[test]
    fn a_cone_is_followed_and_the_deepest_cut_stays() {
        let (feed, rapid) = (Motion::Feed, Motion::Rapid);
        let cone: &[[f64; 2]] = &[[0.0, 5.0], [-10.0, 10.0], [-10.0, 20.0]];
        let rough: &[[f64; 2]] = &[[0.0, 8.0], [-10.0, 8.0]];
        let cut = swept(&[(feed, rough), (rapid, &[[-10.0, 8.0], [-10.0, 9.0]]), (feed, cone)], 0.0);
        for (z, r) in [(-2.03, 6.015), (-5.0, 7.5), (-7.0, 8.0)] {
            assert!(close(cut.at(z)[0], r), "{z}: {:?}", cut.at(z));
        }
    }

    #[test]
    fn a_face_is_where_the_axis_is_met_across() {
        let cut = swept(
            &[(Motion::Feed, &[[0.3, 12.0], [0.3, -0.4]]), (Motion::Rapid, &[[0.3, -0.4], [1.0, -0.4]])],
            0.0,
        );
        assert!(cut.faces_mm.iter().all(|z| (z - 0.3).abs() < 1e-9) && !cut.faces_mm.is_empty());
        assert!(cut.at(0.3)[1].is_none(), "a face is no bore");
    }
}
