//! What cutting a thread costs: chip area, forces on the slides, torque of the spindle.
//! In: once a control cycle, which pass is in hand, the true place of the tool, mm. Out: mm², N, N·m.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | d, d₀ | mm | depth of the tool below the crest; of the groove that earlier passes of this start left here |
//! | α | – | half angle of the tool, a V with a sharp point |
//! | z, z_f, z_b | mm | place of its point; face of the stock, and where the stock ends behind it |
//! | A | mm² | chip area, in the plane of the spindle axis |
//! | k_c, f | N/mm², – | specific cutting force; how much more a V chip takes than a straight one |
//! | F, F_r, F_a | N | tangential; on X, out of the cut; on Z, against the motion along the thread |
//! | ρ, κ | – | radial and axial share |
//! | M, r, P | N·m, m, W | torque at the spindle; true radius of the point; power |
//!
//! ```text
//! (M74) A = V(d) − V(d₀) if d > d₀, else 0
//!       V(d) = d w (g((z_f − z)/w) − g((z_b − z)/w)) if d > 0, else 0,  w = d tan α
//!       g(u) = 0 | (1 + u)²/2 | 1 − (1 − u)²/2 | 1  for u ≤ −1 | ≤ 0 | ≤ 1 | beyond: share of the V below u
//! (M75) F = k_c f A,  F_r = ρ F,  F_a = κ F
//! (M76) M = F r,  P = M ω
//! ```
//! Well within the stock V = d² tan α. At the face the tool enters over the width 2 w of its V, at the other
//! end it leaves over it, so no force has a step.
//!
//! Source: k_c times chip area is the law of Kienzle (VDI-Z 94, 1952) without its dependence on the thickness
//! of the chip; areas are geometry. Not modelled: a nose, and what a turn leaves for the next one
//! (`chatter` has that, for tools that meet it); earlier passes are taken to have their points below each
//! other, which flank infeed does within its flank.
//!
//! The depth is that of the true slide, so a slide that gives way takes less, and a later pass finds what is
//! left. It is taken in the middle of the cycle in which the force acts: half a cycle late it would take
//! damping from the slide.

use machine::Machine;
use protocol::{CutTruth, Groove, SpindleCommand};

use crate::chatter::{Chatter, ChatterMode, Chip};
use crate::config::Cutting;
use crate::grooves::Grooves;

/// Tool and stock.
#[derive(Clone, Debug)]
pub(crate) struct Cutter {
    config: Cutting,
    tan_flank: f64,
    /// The pass in hand, or the one before as long as its tool is in the material.
    pass: Option<(u32, Groove)>,
    grooves: Option<Grooves>,
    /// The tool, if it gives way (M234).
    chatter: Option<Chatter>,
    /// Where the axes carry the point of the tool, beside where they carried it in the first pass: X, Z, mm.
    beside_mm: [f64; 2],
    /// The same of a tool that is put in as soon as the one before has come out of the material.
    next_mm: Option<[f64; 2]>,
}

impl Cutter {
    /// A part that nothing was cut into. Without a specific force there is none.
    pub(crate) fn new(config: Cutting, mode: Option<ChatterMode>, machine: &Machine) -> Cutter {
        let cuts = config.specific_force_n_mm2 > 0.0;
        Cutter {
            config,
            tan_flank: libm::tan(config.flank_half_angle_deg.to_radians()),
            pass: None,
            grooves: cuts.then(|| Grooves::new(machine)),
            chatter: mode.map(|mode| Chatter::new(mode, machine.general.cycle_s)),
            beside_mm: [0.0; 2],
            next_mm: None,
        }
    }

    /// A tool that is longer or shorter by so much is put in when the one before is out of the material.
    pub(crate) fn change(&mut self, by_mm: [f64; 2]) {
        let from = self.next_mm.unwrap_or(self.beside_mm);
        self.next_mm = Some([from[0] + by_mm[0], from[1] + by_mm[1]]);
    }

    /// What is cut until the next cycle with the point of the tool at (x, z), mm, by the pass that `tags`
    /// name, while the spindle turns by so many turns. A tool that gives way is where its slide holds it but
    /// for [`Cutter::bent_mm`].
    pub(crate) fn cut(&mut self, tags: &SpindleCommand, x_mm: f64, z_mm: f64, turned: f64) -> CutTruth {
        let bent_mm = self.chatter.as_ref().map_or(0.0, Chatter::place_mm);
        let [area_mm2, thickness_mm] = self.chip(tags, x_mm, z_mm, bent_mm);
        let config = &self.config;
        let specific = config.specific_force_n_mm2 * config.form_factor;
        let mut area_mm2 = area_mm2;
        if let Some(chatter) = &mut self.chatter {
            let width_mm = if area_mm2 > 0.0 { area_mm2 / thickness_mm } else { 0.0 };
            let stiffness_n_mm = specific * config.radial_share * width_mm;
            area_mm2 = width_mm * chatter.advance(&Chip { stiffness_n_mm, thickness_mm }, turned, |_| ());
        }
        if area_mm2 == 0.0 {
            return CutTruth::default();
        }
        let force_n = specific * area_mm2;
        CutTruth {
            area_mm2,
            force_n,
            radial_n: config.radial_share * force_n,
            axial_n: config.axial_share * force_n,
            torque_nm: 1e-3 * x_mm.abs() * force_n,
        }
    }

    /// Area and thickness of the chip of a tool that does not swing, mm² and mm (M74).
    fn chip(&mut self, tags: &SpindleCommand, x_mm: f64, z_mm: f64, bent_mm: f64) -> [f64; 2] {
        let Cutter { config, tan_flank, pass, grooves: Some(grooves), beside_mm, next_mm, .. } = self else {
            return [0.0; 2];
        };
        let groove = in_hand(pass, grooves, tags, x_mm, z_mm);
        let Some(groove) = groove else {
            *beside_mm = next_mm.take().unwrap_or(*beside_mm);
            return [0.0; 2];
        };
        // What was cut is kept where the first tool was carried.
        let [x_beside, z_beside] = *beside_mm;
        let z_kept = z_mm - z_beside;
        let kept = groove.into * (x_beside - groove.slope * z_beside);
        let (reach, crest) = (groove.reach_mm(x_mm, z_mm), groove.into * groove.crest_mm);
        let earlier = grooves.earlier_mm(z_kept, crest - kept) + kept;
        grooves.pass_by(z_kept, reach + bent_mm - kept);
        let stock = config.stock_mm().map(|end_mm| end_mm - z_kept);
        let v = |reach: f64| v_area(reach - crest, *tan_flank, stock);
        [(v(reach) - v(earlier)).max(0.0), reach - earlier]
    }

    /// How far the point of a tool that gives way is from where its slide holds it, along X, mm.
    pub(crate) fn bent_mm(&self) -> Option<f64> {
        let into = self.pass.map_or(0.0, |(_, groove)| groove.into);
        self.chatter.as_ref().map(|chatter| into * chatter.place_mm())
    }

    /// The directions in which `radial_n` and `axial_n` act on X and Z.
    pub(crate) fn directions(&self) -> [f64; 2] {
        self.pass.map_or([0.0; 2], |(_, groove)| [-groove.into, -groove.lead_mm.signum()])
    }
}

/// The groove that is being cut. What a tool does in the material does not end with the program: a pass that
/// was broken off goes on cutting until the tool is out.
fn in_hand<'a>(
    pass: &'a mut Option<(u32, Groove)>,
    grooves: &mut Grooves,
    tags: &SpindleCommand,
    x_mm: f64,
    z_mm: f64,
) -> Option<&'a Groove> {
    let number = pass.map_or(0, |(number, _)| number);
    if tags.pass != 0 && tags.pass != number {
        grooves.end();
        *pass = (tags.groove.into != 0.0).then_some((tags.pass, tags.groove));
        pass.iter().for_each(|(_, groove)| grooves.begin(groove));
    }
    if tags.pass == 0 && pass.is_some_and(|(_, groove)| groove.depth_mm(x_mm, z_mm) <= 0.0) {
        grooves.end();
        *pass = None;
    }
    pass.as_ref().map(|(_, groove)| groove)
}

/// Area of a V that lies between two distances from its point along Z, mm² (M74).
fn v_area(depth_mm: f64, tan_flank: f64, [low, high]: [f64; 2]) -> f64 {
    if depth_mm <= 0.0 {
        return 0.0;
    }
    let half_width = depth_mm * tan_flank;
    depth_mm * half_width * (share_below(high / half_width) - share_below(low / half_width))
}

/// The share of a V of half width 1 that lies below u.
fn share_below(u: f64) -> f64 {
    let from_edge = 1.0 - u.abs().min(1.0);
    let tail = 0.5 * from_edge * from_edge;
    if u < 0.0 { tail } else { 1.0 - tail }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAN: f64 = 0.577_350_269_189_625_8;
    /// M20 by 2 along -Z, cut from outside; the stock from -30 to 0.
    const OUTSIDE: Groove =
        Groove { start: 0, reserved: 0, lead_mm: -2.0, crest_mm: 10.0, slope: 0.0, into: -1.0 };

    fn cutter() -> Cutter {
        let config = Cutting { specific_force_n_mm2: 2000.0, back_mm: Some(-30.0), ..Cutting::default() };
        Cutter::new(config, None, &Machine::plain())
    }

    fn tags(pass: u32, groove: Groove) -> SpindleCommand {
        SpindleCommand { pass, groove, ..SpindleCommand::default() }
    }

    /// Goes along a thread with a depth that depends on z, and gives what was cut at every hundredth of a mm.
    fn go(
        cutter: &mut Cutter,
        pass: u32,
        groove: Groove,
        [from, to]: [f64; 2],
        depth: impl Fn(f64) -> f64,
    ) -> Vec<(f64, CutTruth)> {
        let steps = ((to - from).abs() * 100.0).round() as i32;
        let at = |step: i32| from + (to - from) * f64::from(step) / f64::from(steps);
        let x = |z: f64| groove.crest_mm + groove.slope * z + groove.into * depth(z);
        (0..=steps).map(at).map(|z| (z, cutter.cut(&tags(pass, groove), x(z), z, 0.001))).collect()
    }

    /// What is cut well within the stock, at -10.
    fn amid(cuts: &[(f64, CutTruth)]) -> CutTruth {
        cuts.iter().find(|(z, _)| (z + 10.0).abs() < 0.005).expect("it goes by there").1
    }

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{value}, not {expected}");
    }

    #[test]
    fn m74_radial_infeed_takes_the_ring_between_two_grooves() {
        let mut cutter = cutter();
        let mut before = 0.0;
        for (pass, depth) in [0.35, 0.6, 0.9, 1.227].into_iter().enumerate() {
            let cut = amid(&go(&mut cutter, pass as u32 + 1, OUTSIDE, [5.0, -20.0], |_| depth));
            close(cut.area_mm2, TAN * (depth * depth - before * before));
            before = depth;
        }
    }

    #[test]
    fn m75_m76_forces_and_torque_follow_the_area() {
        let cut = amid(&go(&mut cutter(), 1, OUTSIDE, [5.0, -20.0], |_| 0.4));
        close(cut.force_n, 2000.0 * 1.5 * TAN * 0.16);
        close(cut.radial_n, 0.5 * cut.force_n);
        close(cut.axial_n, 0.2 * cut.force_n);
        close(cut.torque_nm, 0.0096 * cut.force_n);
    }

    #[test]
    fn passes_of_equal_area_take_equal_forces_and_a_spring_pass_none() {
        let mut cutter = cutter();
        let mut pass = 0;
        let mut force = |depth: f64| {
            pass += 1;
            amid(&go(&mut cutter, pass, OUTSIDE, [5.0, -20.0], |_| depth)).force_n
        };
        let first = force(0.35);
        for n in 2..=8 {
            close(force(0.35 * f64::from(n).sqrt()), first);
        }
        assert_eq!(force(0.35 * 8f64.sqrt()), 0.0);
        assert_eq!(force(0.5), 0.0, "a pass in the groove that is there");
    }

    #[test]
    fn a_pass_meets_only_the_groove_of_its_own_start() {
        let mut cutter = cutter();
        let mut force = |pass, start| {
            let groove = Groove { start, ..OUTSIDE };
            amid(&go(&mut cutter, pass, groove, [5.0, -20.0], |_| 0.5)).force_n
        };
        let fresh = force(1, 0);
        assert!(fresh > 100.0);
        assert_eq!([force(2, 0), force(3, 1), force(4, 1), force(5, 0)], [0.0, fresh, 0.0, 0.0]);
    }

    #[test]
    fn the_tool_enters_and_leaves_over_the_width_of_its_v() {
        let cuts = go(&mut cutter(), 1, OUTSIDE, [5.0, -35.0], |_| 1.0);
        let full = TAN;
        for (z, cut) in &cuts {
            // The part of the triangle that lies in the stock, by adding up strips.
            let strip = |i: i32| {
                let u = (f64::from(i) + 0.5) / 1000.0 * TAN;
                let inside = (-30.0..=0.0).contains(&(z + u));
                if inside { (1.0 - u.abs() / TAN) * TAN / 1000.0 } else { 0.0 }
            };
            let expected: f64 = (-1000..1000).map(strip).sum();
            assert!((cut.area_mm2 - expected).abs() < 1e-3, "{} at {z}, not {expected}", cut.area_mm2);
        }
        close(amid(&cuts).area_mm2, full);
        // 0.01 mm further on the V is at most its depth times that larger: nothing jumps.
        assert!(cuts.windows(2).all(|pair| (pair[1].1.area_mm2 - pair[0].1.area_mm2).abs() <= 0.01 + 1e-9));
        assert_eq!((cuts[0].1.area_mm2, cuts[cuts.len() - 1].1.area_mm2), (0.0, 0.0));
    }

    #[test]
    fn a_way_in_and_out_within_the_stock_is_followed_without_steps() {
        // Down to depth over 2 mm, out over 2 mm; the second pass 0.2 mm deeper all the way.
        let depth = |z: f64| ((-5.0 - z) / 2.0).min((z + 20.0) / 2.0).min(1.0);
        let mut cutter = cutter();
        go(&mut cutter, 1, OUTSIDE, [0.0, -25.0], depth);
        let cuts = go(&mut cutter, 2, OUTSIDE, [0.0, -25.0], |z| depth(z) + 0.2);
        for (z, cut) in &cuts {
            let (d, before) = ((depth(*z) + 0.2).max(0.0), depth(*z).max(0.0));
            let expected = TAN * (d * d - before * before);
            // Nodes know a bend of the way to 0.02 mm, on a slope of one half.
            assert!((cut.area_mm2 - expected).abs() < 0.005, "{} at {z}, not {expected}", cut.area_mm2);
        }
        close(amid(&cuts).area_mm2, TAN * (1.44 - 1.0));
        assert!(cuts.windows(2).all(|pair| (pair[1].1.area_mm2 - pair[0].1.area_mm2).abs() < 0.012));
    }

    #[test]
    fn inside_and_on_a_cone_the_depth_is_that_below_the_crest() {
        for groove in [
            Groove { crest_mm: 13.1, into: 1.0, ..OUTSIDE },
            Groove { slope: -1.0 / 32.0, ..OUTSIDE },
            Groove { slope: 1.0 / 32.0, into: 1.0, ..OUTSIDE },
            Groove { lead_mm: 2.0, ..OUTSIDE },
        ] {
            let mut cutter = cutter();
            let way = if groove.lead_mm < 0.0 { [5.0, -20.0] } else { [-20.0, 5.0] };
            close(amid(&go(&mut cutter, 1, groove, way, |_| 0.3)).area_mm2, TAN * 0.09);
            assert_eq!(cutter.directions(), [-groove.into, -groove.lead_mm.signum()]);
            let cut = amid(&go(&mut cutter, 2, groove, way, |_| 0.5));
            assert!((cut.area_mm2 - TAN * (0.25 - 0.09)).abs() < 1e-9, "{groove:?}: {cut:?}");
            let radius = groove.crest_mm - 10.0 * groove.slope + 0.5 * groove.into;
            assert!((cut.torque_nm - 1e-3 * radius * cut.force_n).abs() < 1e-9, "{groove:?}: {cut:?}");
        }
    }

    #[test]
    fn nothing_is_cut_without_force_without_a_pass_and_without_a_groove() {
        let air = Cutter::new(Cutting::default(), None, &Machine::plain());
        assert!(
            go(&mut air.clone(), 1, OUTSIDE, [5.0, -20.0], |_| 1.0).iter().all(|(_, cut)| cut.force_n == 0.0)
        );
        for (pass, groove) in [(0, OUTSIDE), (1, Groove::default())] {
            let cuts = go(&mut cutter(), pass, groove, [5.0, -20.0], |_| 1.0);
            assert!(cuts.iter().all(|(_, cut)| *cut == CutTruth::default()));
        }
        let cut = cutter().cut(&tags(1, OUTSIDE), f64::NAN, f64::NAN, 0.001);
        assert_eq!(cut, CutTruth::default());
    }

    #[test]
    fn a_pass_that_is_broken_off_cuts_until_the_tool_is_out() {
        let mut cutter = cutter();
        let in_cut = amid(&go(&mut cutter, 1, OUTSIDE, [5.0, -10.0], |_| 0.5));
        let ended = SpindleCommand::default();
        assert_eq!(cutter.cut(&ended, 9.5, -10.0, 0.001), in_cut);
        assert!(cutter.cut(&ended, 9.7, -10.0, 0.001).force_n > 0.0);
        assert_eq!(cutter.cut(&ended, 10.1, -10.0, 0.001), CutTruth::default());
        assert_eq!(cutter.cut(&ended, 9.5, -10.0, 0.001), CutTruth::default(), "timed motion does not cut");
        assert_eq!(cutter.directions(), [0.0; 2]);
    }
}
