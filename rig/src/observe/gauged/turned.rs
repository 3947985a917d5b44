//! The diameter that was turned or bored before the thread: its crest. In: the true place of the tip in every
//! control cycle of motion at a feed, mm. Out: the least and the largest diameter along the thread, if all of
//! it was turned.
//!
//! The length of the thread is looked at in [`BINS`] places; in each the tip that reached deepest counts.
//! Where that one went across the axis rather than along it (a face, a chamfer, a groove) there is no crest.
//! A tip beyond the bottom of the grooves is in the bore of a screw or on the outside of a nut, which is no
//! crest either; where it goes across, as a chamfer that begins below the grooves, no crest is left. Which
//! way a tip goes is seen over [`WAY_MM`]: while it comes to rest it goes anywhere, by less than 1 µm.
//!
//! A tool that goes along the axis is a drill: its hole is as wide as the tool, from as far behind the tip as
//! its point is long. How wide one is that nobody described is not known, nor is the crest that it leaves,
//! unless it is bored afterwards.
//!
//! On a mill the hole stands. A tool that covers its axis and goes along it is a drill, whose hole is wider
//! by twice as much as it lies beside; one that covers the axis and goes across leaves no crest above its
//! tip. Where the hole begins is not always known, and spot drills are wide: the deeper half is looked at.

use gauge::{Nominal, Side};

use crate::observe::ToolNote;

const BINS: usize = 128;
const WAY_MM: f64 = 0.01;
/// Steeper than this, dX by dZ, a cut is no cylinder: chamfers of threads have 0.27 (15°) and more.
const STEEPEST: f64 = 0.25;
/// A tip is on the axis that is nearer to it, mm: slides stray by some µm.
const ON_AXIS_MM: f64 = 0.06;
/// Points of drills and of spot drills have 90° to 142°: the longest of them, of which nobody says more.
const POINT_DEG: f64 = 90.0;

/// The tool in the holder, as a drill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::observe) struct Drill {
    tool: u32,
    /// Half of its width, and how long its point is, mm, if somebody said it.
    shape_mm: Option<[f64; 2]>,
}

impl Drill {
    /// Of a number, and what is known of that tool.
    pub(in crate::observe) fn of(tool: u32, note: Option<&ToolNote>) -> Drill {
        let half_deg = 0.5 * note.and_then(|note| note.angle_deg).unwrap_or(POINT_DEG);
        let shape = |width_mm: f64| [0.5 * width_mm, 0.5 * width_mm / libm::tan(half_deg.to_radians())];
        Drill { tool, shape_mm: note.and_then(ToolNote::drill_mm).map(shape) }
    }
}

/// What reached deepest at a place.
#[derive(Clone, Copy, Debug)]
struct Cut {
    radius_mm: f64,
    /// It went along the axis rather than across.
    along: bool,
    /// It was a drill.
    drilled: bool,
    /// The tool, of a hole of unknown width.
    unknown: Option<u32>,
}

/// Collects what tools leave.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    side: Side,
    /// Radius of the pitch line at Z 0, its change along Z, and how far from it grooves reach at most.
    pitch_line_mm: [f64; 3],
    /// Where the thread is at full depth, along Z.
    along_mm: [f64; 2],
    /// In each place; none where nothing was turned.
    cuts: Vec<Option<Cut>>,
    /// Where the way that is looked at began.
    from: Option<[f64; 3]>,
    goes_along: bool,
    goes_across: bool,
    /// The part stands and the tool turns: towards which Z the hole of a mill goes.
    stands: Option<f64>,
    /// Least and largest Z of tips that went along in the hole.
    reached_mm: Option<[f64; 2]>,
    /// How far beside its axis it was drilled at most.
    beside_mm: f64,
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
        Turned {
            side,
            pitch_line_mm,
            along_mm,
            cuts: vec![None; BINS],
            from: None,
            goes_along: false,
            goes_across: false,
            stands: None,
            reached_mm: None,
            beside_mm: 0.0,
        }
    }

    /// The same in a part that stands: a hole of a mill that goes towards higher Z (1) or lower (−1).
    pub(super) fn standing(self, way: f64) -> Turned {
        Turned { stands: Some(way), ..self }
    }

    /// Takes a control cycle: X and Y from the axis (0 on a lathe) and Z, if the tool is moved at a feed, and
    /// what it is on the axis.
    pub(super) fn cycle(&mut self, tip: Option<[f64; 3]>, drill: Drill) {
        let (Some([x0, y0, z0]), Some([x, y, z])) = (self.from, tip) else {
            (self.from, self.goes_along, self.goes_across) = (tip, false, false);
            return;
        };
        let (across, along) = (libm::hypot(x - x0, y - y0), (z - z0).abs());
        if libm::hypot(across, along) >= WAY_MM {
            self.from = tip;
            self.goes_along = across <= STEEPEST * along;
            self.goes_across = !self.goes_along;
        }
        if let Some(way) = self.stands {
            return self.mills(libm::hypot(x, y), z, drill, way);
        }
        if self.side == Side::Internal && self.goes_along && x.abs() < ON_AXIS_MM {
            return self.drills(0.0, z, drill);
        }
        let Some(bin) = self.bin(z) else { return };
        let [middle, slope, reach] = self.pitch_line_mm;
        let beyond = x.abs() - (middle + slope * z);
        let is_other_wall = reach < if self.side == Side::External { -beyond } else { beyond };
        if is_other_wall && self.goes_along {
            return;
        }
        let cut = Cut { radius_mm: x.abs(), along: self.goes_along, drilled: false, unknown: None };
        if cut.along {
            self.reaches(z);
        }
        self.cuts_to(bin, cut);
    }

    /// A tool that turns, so far beside the axis of a hole that goes one way along Z.
    fn mills(&mut self, beside_mm: f64, z: f64, drill: Drill, way: f64) {
        let covers = beside_mm < drill.shape_mm.map_or(ON_AXIS_MM, |[radius_mm, _]| radius_mm);
        if covers && self.goes_along {
            self.beside_mm = self.beside_mm.max(beside_mm);
            self.drills(beside_mm, z, drill);
        } else if covers && self.goes_across {
            let wide = Cut { radius_mm: f64::MAX, along: false, drilled: false, unknown: None };
            let [low, high] = self.along_mm;
            let at = |bin: usize| low + (high - low) * (bin as f64 + 0.5) / BINS as f64;
            (0..BINS).filter(|bin| way * (at(*bin) - z) <= 0.0).for_each(|bin| self.cuts[bin] = Some(wide));
        }
    }

    fn reaches(&mut self, z: f64) {
        let [low, high] = self.reached_mm.unwrap_or([z, z]);
        self.reached_mm = Some([low.min(z), high.max(z)]);
    }

    /// How far along a hole that goes towards higher Z (1) or lower (−1) a tip went along it.
    pub(super) fn reached_mm(&self, way: f64) -> Option<f64> {
        self.reached_mm.map(|[low, high]| if way < 0.0 { low } else { high })
    }

    /// How far beside its axis a hole was drilled at most.
    pub(super) fn beside_mm(&self) -> f64 {
        self.beside_mm
    }

    /// The number of a place along the thread.
    fn bin(&self, z: f64) -> Option<usize> {
        let [low, high] = self.along_mm;
        let bin = (z - low) / (high - low) * BINS as f64;
        ((low..=high).contains(&z) && low < high && (bin as usize) < BINS).then_some(bin as usize)
    }

    /// A drill with its tip at Z, so far beside the axis: the point leaves a cone, which is no crest.
    fn drills(&mut self, beside_mm: f64, z: f64, Drill { tool, shape_mm }: Drill) {
        self.reaches(z);
        let cone = Cut { radius_mm: 0.0, along: false, drilled: true, unknown: None };
        let Some([radius_mm, point_mm]) = shape_mm else {
            let Some(bin) = self.bin(z) else { return };
            // Nobody drills what has been bored, but deeper down.
            if self.cuts[bin].is_none_or(|before| before.drilled) {
                self.cuts[bin] = Some(Cut { unknown: Some(tool), ..cone });
            }
            return;
        };
        self.bin(z).into_iter().for_each(|bin| self.cuts_to(bin, cone));
        let wall = Cut { radius_mm: radius_mm + beside_mm, along: true, ..cone };
        let away = self.stands.map_or(1.0, |way| -way);
        self.bin(z + away * point_mm).into_iter().for_each(|bin| self.cuts_to(bin, wall));
    }

    fn cuts_to(&mut self, bin: usize, cut: Cut) {
        let deeper = |before: Cut| match self.side {
            Side::External => cut.radius_mm < before.radius_mm,
            Side::Internal if cut.drilled && before.unknown.is_some() => false,
            Side::Internal => cut.radius_mm > before.radius_mm,
        };
        if self.cuts[bin].is_none_or(deeper) {
            self.cuts[bin] = Some(cut);
        }
    }

    /// The tool that drilled a hole of unknown width, where that is what was left.
    pub(super) fn unknown_drill(&self) -> Option<u32> {
        self.cuts.iter().flatten().find_map(|cut| cut.unknown)
    }

    /// Least and largest diameter, mm; `None` if some of the length was not turned, or half of it is no
    /// crest.
    pub(super) fn diameters_mm(&self) -> Option<[f64; 2]> {
        let looked_at = match self.stands {
            None => &self.cuts[..],
            Some(way) if way < 0.0 => &self.cuts[..BINS / 2],
            Some(_) => &self.cuts[BINS / 2..],
        };
        let cuts: Vec<Cut> = looked_at.iter().copied().collect::<Option<_>>()?;
        let crest = || cuts.iter().filter(|cut| cut.along).map(|cut| cut.radius_mm);
        if 2 * crest().count() < cuts.len() {
            return None;
        }
        Some([2.0 * crest().reduce(f64::min)?, 2.0 * crest().reduce(f64::max)?])
    }
}

/// Why no crest is judged.
pub(super) fn unknown(tool: u32) -> String {
    let (which, call) = match tool {
        0 => ("the tool that drilled the hole".into(), "call for it with T and M6, and "),
        _ => (format!("tool {tool}, which drilled the hole,"), ""),
    };
    format!(
        "the crest is not judged: nobody said how wide {which} is; {call}give D in the tool table (--tools FILE), or \
         width_mm in [tools] of the machine file"
    )
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
        ways.iter().for_each(|way| cuts(&mut turned, *way, Drill::of(1, None)));
        turned
    }

    fn cuts(turned: &mut Turned, [from, to]: [[f64; 2]; 2], drill: Drill) {
        let along = |i: usize, step: i32| from[i] + (to[i] - from[i]) * f64::from(step) / 2000.0;
        (0..=2000).for_each(|step| turned.cycle(Some([along(0, step), 0.0, along(1, step)]), drill));
        turned.cycle(None, drill);
    }

    /// One drill behind another, some of them known; what is bored afterwards is known again.
    #[test]
    fn a_drill_leaves_a_hole_of_its_width_and_an_unknown_one_no_crest() {
        let drill = |tool, width_mm, angle_deg| {
            Drill::of(tool, Some(&ToolNote { width_mm, angle_deg, ..ToolNote::default() }))
        };
        let drilled = |drills: &[(Drill, f64)], bored_mm: Option<f64>| {
            let mut turned = Turned::new(&gauge::Nominal { side: Side::Internal, ..m20x2() }, [-20.0, -1.0]);
            drills.iter().for_each(|(drill, z)| cuts(&mut turned, [[0.005, 2.0], [0.004, *z]], *drill));
            let bore = |x: f64| cuts(&mut turned, [[x, 1.0], [x, -25.0]], Drill::of(9, None));
            bored_mm.into_iter().for_each(bore);
            (turned.diameters_mm(), turned.unknown_drill())
        };
        let (wide, unknown) = (drill(1, Some(17.4), Some(118.0)), drill(2, None, None));
        assert_eq!(drilled(&[(wide, -30.0)], None), (Some([17.4; 2]), None));
        assert_eq!(drilled(&[(unknown, -30.0)], None), (None, Some(2)));
        assert_eq!(drilled(&[(unknown, -30.0)], Some(8.7)), (Some([17.4; 2]), None), "bored");
        assert_eq!(drilled(&[(wide, -30.0), (unknown, -30.0)], None), (None, Some(2)), "a reamer");
        let much = drill(3, Some(24.0), None);
        assert_eq!(drilled(&[(much, -35.0)], None), (Some([24.0; 2]), None), "beyond its grooves, too");
        // A spot drill is wider, and leaves a cone; so does the point of a hole that is not deep enough.
        assert_eq!(drilled(&[(drill(3, Some(25.0), None), -12.0), (wide, -30.0)], None).0, Some([17.4; 2]));
        assert_eq!(drilled(&[(wide, -21.0)], None), (Some([17.4; 2]), None));
        assert_eq!(drilled(&[(wide, -14.0)], None), (None, None), "not all of it");
    }

    /// Holes of a mill: what lies beside the axis is wider, what does not cover it drills another hole, a
    /// spot drill in front of the mouth and a pocket above the thread are no crest of it.
    #[test]
    fn a_hole_of_a_mill_is_as_wide_as_its_drill_and_as_deep_as_that_went() {
        let drill = |width_mm| Drill::of(1, Some(&ToolNote { width_mm, ..ToolNote::default() }));
        let milled = |ways: &[(Option<f64>, [[f64; 2]; 2])]| {
            let nut = gauge::Nominal { side: Side::Internal, ..m20x2() };
            let mut turned = Turned::new(&nut, [-20.0, 2.0]).standing(-1.0);
            ways.iter().for_each(|(width_mm, way)| cuts(&mut turned, *way, drill(*width_mm)));
            (turned.diameters_mm(), turned.reached_mm(-1.0), turned.unknown_drill())
        };
        let down = |x: f64, z: f64| [[x, 5.0], [x, z]];
        let spot = (Some(25.0), down(0.0, -2.0));
        let hole = (Some(17.4), down(0.0, -30.0));
        assert_eq!(milled(&[spot, hole]), (Some([17.4; 2]), Some(-30.0), None));
        let (beside, ..) = milled(&[(Some(17.4), down(0.6, -30.0))]);
        assert!(beside.is_some_and(|mm| mm.iter().all(|mm| (mm - 18.6).abs() < 1e-9)), "{beside:?}");
        assert_eq!(milled(&[(Some(17.4), down(9.0, -30.0))]), (None, None, None), "another hole");
        assert_eq!(milled(&[(None, down(0.0, -30.0))]), (None, Some(-30.0), Some(1)));
        assert_eq!(milled(&[(Some(17.4), down(0.0, -6.0))]), (None, Some(-6.0), None), "too shallow");
        let pocket = |z: f64| (Some(20.0), [[-30.0, z], [30.0, z]]);
        assert_eq!(milled(&[hole, pocket(-3.0)]).0, Some([17.4; 2]));
        assert_eq!(milled(&[hole, pocket(-19.0)]).0, None);
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
