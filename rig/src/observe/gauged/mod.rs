//! The thread that all passes leave, held against a virtual gauge. In: every control cycle of a pass the true
//! places of the slides, mm, and the true angle of the spindle, degrees; what the gauge asks. Out: a
//! [`GaugeReport`].
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | C₀, C₁ | deg | true spindle angle in the cycle before and in this one, unwrapped |
//! | p₀, p₁ | mm | tip of the tool on the part in them: X from the axis, Z from the zero of the program |
//! | Cₖ | deg | an angle at which the part is looked at: k 360°/n |
//!
//! ```text
//! (M158) p(Cₖ) = p₀ + (Cₖ − C₀)/(C₁ − C₀) (p₁ − p₀)   for every Cₖ between C₀ and C₁, whole turns added
//! ```
//! The straight line is off by a h²/8 at most, with the acceleration a of a slide and the control cycle h: on
//! the helix nothing, while a slide leaves with 5 m/s² 0.16 µm. The edge lies in the plane of X and Z, so no
//! other angle sees what is cut at Cₖ.
//!
//! Nothing is kept unless somebody asks for a gauge. Then n is 72, or as many as [`PLACES`] has room for, at
//! least [`LEAST`]; beyond that there is no verdict.

mod crossings;
mod drawn;
mod edge;
mod hole;
mod length;
mod report;
mod tapped;
mod turned;

use std::{borrow::Cow, collections::BTreeMap};

use gauge::{Edge, Nominal, Place, Sections, Side};
use machine::{Kinematics, Machine};
use protocol::{Axis, ThreadPass, Truth};

use crossings::Crossings;
pub(super) use drawn::Grooved;
pub use drawn::{GrooveAsked, GrooveReport};
use edge::edge_of;
use hole::Hole;
use length::{full_mm, judged_mm, longer_mm};
use report::other_side;
pub use report::{GaugeLimits, GaugeReport};
use tapped::{Tap, holes};
pub(super) use turned::Drill;
use turned::Turned;

use super::{planned::Planned, verdict::PartVerdict};

/// Places of the tip that are kept at most; a place takes 24 bytes.
const PLACES: usize = 1_000_000;
/// Angles at which a part is looked at, if there is room, and at least.
const STATIONS: usize = 72;
const LEAST: usize = 16;
/// Passes that are cut again after a hold, or that begin late, take more turns than planned: so much room.
const SPARE: f64 = 1.25;
/// What the gauge does not know.
const CREST: &str = "the crest is not judged: the diameter before the thread was not turned by the program";
/// A thread is judged that is longer than this share of a turn: its last groove ends within the turn.
const SHORT: f64 = 0.9;

/// A gauge that somebody asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeAsked {
    /// What it asks.
    pub nominal: Nominal,
    /// Where the zero of the program lies on the machine in each pass: X, Z, mm; 0 if nothing is said.
    pub origins_mm: BTreeMap<u32, [f64; 2]>,
    /// The passes that it judges, and from where along Z of the machine on, mm: from the beginning of the
    /// pass where nothing is said. All passes if it is not there.
    pub passes: Option<BTreeMap<u32, Option<f64>>>,
}

/// Collects the places of the tip.
#[derive(Clone, Debug)]
pub(super) struct Gauged {
    asked: GaugeAsked,
    sections: Sections,
    /// Number of the edge of each pass.
    edges: BTreeMap<u32, usize>,
    /// Where the thread is judged, along Z.
    full_mm: [f64; 2],
    crossings: Crossings<3>,
    /// The taps of passes that return.
    taps: BTreeMap<u32, Tap>,
    kept: usize,
    /// So many are kept at most.
    places: usize,
    is_full: bool,
    /// X and Y of the machine where the hole of a mill lies, mm: its taps are seen from there.
    hole_mm: Option<[f64; 2]>,
    /// The other holes of a mill, each judged by itself.
    others: Vec<Gauged>,
    /// Highest number of a pass that was begun.
    begun: u32,
    /// What was turned there.
    turned: Turned,
    /// The hole that is tapped.
    tapped: Option<Hole>,
    /// Of the places that are too far from the thread to have cut any of it, the nearest.
    far: Option<Place>,
    /// Whether a pass cuts the other side: a bore for a screw, a shaft for a nut.
    other_side: bool,
    /// Where zero of the program lies for the tool in place before the program calls for one.
    in_place_mm: Option<[f64; 2]>,
    /// What was taken for the edges of which nobody said it.
    assumed: Vec<String>,
}

impl Gauged {
    /// A gauge for the passes of a program that are its thread; on a mill one for each hole.
    pub(super) fn new(machine: &Machine, program: &BTreeMap<u32, Planned>, asked: GaugeAsked) -> Gauged {
        let mut program = program.clone();
        if let Some(passes) = &asked.passes {
            program.retain(|number, _| passes.contains_key(number));
        }
        if machine.general.kinematics != Kinematics::Mill {
            return Gauged::of(machine, &program, asked, None, PLACES);
        }
        let holes = holes(&program, asked.nominal.pitch_diameter_mm[0]);
        let places = PLACES / holes.len().max(1);
        let hole = |(mm, passes): (_, BTreeMap<u32, Planned>)| {
            let moved_mm = hole::moved_mm(&passes, &program, &asked.origins_mm);
            let mut gauged = Gauged::of(machine, &passes, asked.clone(), Some(mm), places);
            gauged.tapped = gauged.tapped.map(|hole| hole.moved(moved_mm));
            gauged
        };
        let mut holes = holes.into_iter();
        let first = hole(holes.next().unwrap_or_default());
        Gauged { others: holes.map(hole).collect(), ..first }
    }

    fn of(
        machine: &Machine,
        program: &BTreeMap<u32, Planned>,
        asked: GaugeAsked,
        hole_mm: Option<[f64; 2]>,
        places: usize,
    ) -> Gauged {
        let turns: f64 = program.values().map(|planned| planned.pass.done_deg() / 360.0).sum();
        let room = places as f64 / (SPARE * turns.max(1.0));
        let taps = program.values().any(|planned| planned.pass.returns());
        let room = if taps { room / tapped::teeth(&asked.nominal) as f64 } else { room };
        let stations = (room as usize).clamp(LEAST, STATIONS);
        let stations = if taps { stations - stations % tapped::FLUTES } else { stations };
        let per_station = (SPARE * turns) as usize + 1;
        let mut gauged = Gauged {
            sections: Sections {
                edges: Vec::new(),
                stations: vec![Vec::with_capacity(per_station.min(places / stations)); stations],
            },
            edges: BTreeMap::new(),
            full_mm: [0.0; 2],
            crossings: Crossings::new(stations),
            taps: BTreeMap::new(),
            kept: 0,
            places,
            is_full: false,
            hole_mm,
            others: Vec::new(),
            begun: 0,
            turned: Turned::new(&asked.nominal, [0.0; 2]),
            tapped: None,
            far: None,
            other_side: false,
            in_place_mm: None,
            assumed: Vec::new(),
            asked,
        };
        let (mut lengths_mm, mut tapped_mm) = (Vec::with_capacity(program.len()), None);
        let first_mm = program.keys().next().map_or(0.0, |first| gauged.origin_mm(*first)[1]);
        for (number, planned) in program {
            let pass = &planned.pass;
            let tap = Tap::of(&gauged.asked.nominal, pass, stations, hole_mm.is_some());
            let Some(edge) = gauged.edge(machine, planned, tap.as_ref()) else { continue };
            let edges = &mut gauged.sections.edges;
            let known = edges.iter().position(|other| *other == edge);
            let at = known.unwrap_or_else(|| {
                edges.push(edge);
                edges.len() - 1
            });
            gauged.edges.insert(*number, at);
            let [x, z] = gauged.origin_mm(*number);
            let nominal = &gauged.asked.nominal;
            let is_nut = nominal.side == Side::Internal;
            gauged.other_side |= pass.cuts_outwards(x).is_some_and(|away| away != is_nut);
            let chamfer_mm = tap.as_ref().map_or(0.0, |_| tapped::PARTIAL * nominal.pitch_mm);
            let length_mm = full_mm(planned, gauged.begins_mm(*number), [z, first_mm], chamfer_mm);
            match (&tap, length_mm) {
                (Some(_), Some(length_mm)) => tapped_mm = longer_mm(tapped_mm, length_mm),
                (None, Some(length_mm)) => lengths_mm.push(length_mm),
                (_, None) => {}
            }
            gauged.taps.extend(tap.map(|tap| (*number, tap)));
        }
        // Pecks stop in the thread that they cut: the deepest of them has all of it.
        lengths_mm.extend(tapped_mm);
        gauged.full_mm = judged_mm(&lengths_mm);
        gauged.finds_hole(program);
        gauged
    }

    /// The edge that cuts a pass, if it is one that is known here.
    fn edge(&mut self, machine: &Machine, planned: &Planned, tap: Option<&Tap>) -> Option<Edge> {
        let nominal = &self.asked.nominal;
        match (tap, planned.pass.returns()) {
            (Some(_), _) => Some(Tap::edge(nominal)),
            (None, true) => {
                self.other_side |= nominal.side == Side::External;
                None
            }
            // An edge that turns with the spindle is no lathe tool.
            (None, false) if self.hole_mm.is_some() => None,
            (None, false) => {
                let edge = edge_of(machine, planned.tool, nominal);
                let assumed = edge::assumed(machine, planned.tool, edge.flank_deg);
                self.assumed.extend(assumed.filter(|told| !self.assumed.contains(told)));
                Some(edge)
            }
        }
    }

    /// Takes a control cycle: whether the axes are moved at a feed, where zero of the program lies for the
    /// tool, if that is known, and what hole it drills.
    pub(super) fn turns(
        &mut self,
        at_a_feed: bool,
        origin_mm: Option<[f64; 2]>,
        drill: Drill,
        truth: &Truth,
    ) {
        let first = || self.asked.origins_mm.values().next().copied();
        let [x, z] = origin_mm.or(self.in_place_mm).or_else(first).unwrap_or_default();
        let slide = |axis: Axis| truth.axes[axis.index()].slide_mm;
        let [x, y] =
            self.hole_mm.map_or([slide(Axis::X) - x, 0.0], |[x, y]| [slide(Axis::X) - x, slide(Axis::Y) - y]);
        let z = z + self.tapped.map_or(0.0, Hole::moved_mm);
        self.turned.cycle(at_a_feed.then(|| [x, y, slide(Axis::Z) - z]), drill);
        self.others.iter_mut().for_each(|other| other.turns(at_a_feed, origin_mm, drill, truth));
    }

    /// What was gauged so far counts for a run that goes on, whose tools may be others: `now` is what that
    /// has of its own, `in_place_mm` where zero of the program lies for the tool that is still in place.
    pub(super) fn goes_on(&mut self, now: &Gauged, in_place_mm: Option<[f64; 2]>) {
        self.asked.origins_mm.clone_from(&now.asked.origins_mm);
        self.in_place_mm = in_place_mm;
        self.others.iter_mut().for_each(|other| other.goes_on(now, in_place_mm));
    }

    fn origin_mm(&self, pass: u32) -> [f64; 2] {
        self.asked.origins_mm.get(&pass).copied().unwrap_or_default()
    }

    /// Where along Z of the machine a pass begins to be this thread, if that is not its beginning.
    fn begins_mm(&self, pass: u32) -> Option<f64> {
        self.asked.passes.as_ref()?.get(&pass).copied().flatten()
    }

    /// Takes a control cycle of a pass (M158).
    pub(super) fn cycle(&mut self, pass: &ThreadPass, truth: &Truth) {
        if let Some(other) = self.others.iter_mut().find(|other| other.edges.contains_key(&pass.pass)) {
            return other.cycle(pass, truth);
        }
        let [x, z] = self.origin_mm(pass.pass);
        let slide = |axis: Axis| truth.axes[axis.index()].slide_mm;
        let tip = match self.hole_mm {
            Some([x, y]) => [slide(Axis::X) - x, slide(Axis::Y) - y, slide(Axis::Z) - z],
            None => [slide(Axis::X) - x, 0.0, slide(Axis::Z) - z],
        };
        self.begun = self.begun.max(pass.pass);
        let (Some(edge), tap) = (self.edges.get(&pass.pass).copied(), self.taps.get(&pass.pass).cloned())
        else {
            return;
        };
        let mut crossings = std::mem::replace(&mut self.crossings, Crossings::new(LEAST));
        crossings.cycle(pass.pass, truth.spindle_deg, tip, |station, [radius, y, z_mm]| match &tap {
            Some(tap) => tap.cuts([radius, y, z_mm], station, |station, radius_mm, z_mm| {
                self.keep(station, Place { z_mm, radius_mm, edge });
            }),
            None => self.keep(station, Place { z_mm, radius_mm: radius.abs(), edge }),
        });
        self.crossings = crossings;
    }

    /// Forgets where the tip was: the pass is over, and may be cut again from its start.
    pub(super) fn pass_ends(&mut self) {
        self.crossings.pass_ends();
        self.others.iter_mut().for_each(Gauged::pass_ends);
    }

    /// Keeps a place that can have cut something of the thread.
    fn keep(&mut self, station: usize, place: Place) {
        let nominal = &self.asked.nominal;
        if !nominal.is_near(&place) {
            let nearer = |other: &Place| nominal.over_mm(&place) < nominal.over_mm(other);
            if self.far.as_ref().is_none_or(nearer) {
                self.far = Some(place);
            }
            return;
        }
        self.is_full |= self.kept == self.places;
        if !self.is_full {
            self.sections.stations[station].push(place);
            self.kept += 1;
        }
    }

    fn of_thread(&self) -> GaugeReport {
        let nominal = &self.asked.nominal;
        let (planned, [low, high]) = (self.edges.len(), self.full_mm);
        let why = if self.is_full {
            format!("the thread is too long for the gauge: more than {} places", self.places)
        } else if self.other_side && self.begun > 0 {
            return GaugeReport::refused(nominal, other_side(nominal));
        } else if planned == 0 {
            "the program cuts no thread, or it is a tapered tap and its name does not end with tap and the distance from \
             its point to the plane, or, on a mill, no tap"
                .into()
        } else if low >= high {
            "the passes have no length of full thread in common within the stock: it lies below Z 0 of the program, \
             unless (part, ...) or plant.cutting of the machine file says otherwise"
                .into()
        } else {
            return self.judged();
        };
        GaugeReport::none(nominal, why)
    }

    /// What it says of what was cut.
    fn judged(&self) -> GaugeReport {
        let nominal = &self.asked.nominal;
        let crest_mm = self.turned.diameters_mm().filter(|_| nominal.taper == 0.0);
        let worst_mm = crest_mm.map(|[least, largest]| {
            let too_small = nominal.crest_mm[0].is_some_and(|limit| least < limit);
            if too_small { least } else { largest }
        });
        let mut sections = Cow::Borrowed(&self.sections);
        if let Some(far) = self.far.filter(|_| self.kept == 0) {
            sections.to_mut().stations[0].push(far);
        }
        let mut found = gauge::judge(nominal, &sections, self.full_mm, worst_mm);
        if let Some(hole) = self.tapped {
            found.reasons.iter_mut().for_each(|reason| hole.names_cause(nominal, reason));
        }
        let mut report = GaugeReport::of(nominal, found);
        report.crest_mm = crest_mm.map(Vec::from).unwrap_or_default();
        if crest_mm.is_none() && nominal.crest_mm.iter().any(Option::is_some) {
            let drilled = || self.turned.unknown_drill().map_or(CREST.into(), turned::unknown);
            report.notes.push(self.tapped.map_or_else(drilled, |hole| hole.crest_unknown(&self.turned)));
        }
        report.notes.extend(self.tapped.and_then(|_| Hole::beside(&self.turned)));
        report.notes.extend(self.assumed.iter().cloned());
        report.notes.extend(nominal.left_out.iter().map(|note| String::from(*note)));
        let lead_mm = nominal.pitch_mm * f64::from(nominal.starts);
        match report.verdict {
            PartVerdict::None => report.reasons.push(format!(
                "nothing was cut where the thread is at full depth: {} of {} passes were begun",
                self.begun.min(self.edges.len() as u32),
                self.edges.len()
            )),
            PartVerdict::Good if report.length_mm < SHORT * lead_mm => {
                report
                    .undecided_for(format!("{:.2} mm of full thread is less than a turn", report.length_mm));
            }
            _ => {}
        }
        match self.tapped.and_then(|hole| hole.told(&self.turned)) {
            Some((PartVerdict::Bad, why)) => report.bad_for(why),
            Some((_, why)) if report.verdict == PartVerdict::Good => report.undecided_for(why),
            _ => {}
        }
        report
    }
}
