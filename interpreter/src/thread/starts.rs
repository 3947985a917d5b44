//! Which start of a multi-start thread a pass belongs to, and which passes run beside a groove. In: leads and
//! starting points of the passes, mm, and their start angles. Out: a number from 0, passes with one number
//! run in one groove; warnings.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | L, k | mm, – | lead; number of grooves of that lead |
//! | d | mm | how far two helices lie apart along Z, at most L/2 |
//! | Δx | mm | how much deeper one of them cuts than the other |
//!
//! Passes that go in along a flank lie apart along Z by what they go deeper: 0.2 Δx ≤ d ≤ Δx belongs to one
//! groove, be it along one flank (0.577 of 30°, 0.268 of 15°) or on both in turns. Of what is left, k grooves
//! of a thread lie L/k apart; one that is nearer than half of that to another was meant to be in it.

use gcode::canon::Units;
use gcode::problem::Blame;
use gcode::{Place, Problem};

use super::cut::{Along, Cut};

/// Helices closer than this are one, mm.
const SAME: f64 = 1e-6;
/// d/Δx of an infeed along a flank.
const FLANK: std::ops::RangeInclusive<f64> = 0.2..=1.0;
/// Grooves of a thread lie apart by more than this share of what evenly spread ones do.
const APART: f64 = 0.5;

/// The helices seen so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Starts(Vec<Helix>);

/// Where a pass runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Helix {
    place: Place,
    along: Along,
    lead: f64,
    direction: f64,
    z: f64,
    start_deg: f64,
    /// X at depth, where a cone has it at Z 0; of a face X and Z are exchanged.
    x: f64,
    number: u32,
}

impl Helix {
    pub(super) fn of(cut: &Cut, place: Place) -> Helix {
        let slope = cut.rise_mm() / cut.lead_mm();
        Helix {
            place,
            along: cut.along,
            lead: cut.lead_mm(),
            direction: cut.direction,
            z: cut.starts_mm(),
            start_deg: cut.start_deg,
            x: cut.above_mm() + cut.approach_mm - slope * cut.starts_mm(),
            number: 0,
        }
    }

    /// The same as a pass of this start.
    pub(super) fn numbered(self, number: u32) -> Helix {
        Helix { number, ..self }
    }

    /// Where its pass stands in the program.
    pub(super) fn place(&self) -> Place {
        self.place
    }

    /// Whether they are passes of one start.
    pub(super) fn is_start_of(&self, other: &Helix) -> bool {
        self.number == other.number && self.is_related(other)
    }

    /// How much further it cuts in the direction in which `cut`, its own, goes in, mm.
    pub(super) fn inwards_mm(&self, other: &Helix, cut: &Cut) -> f64 {
        let outwards = [cut.retract_mm, -cut.approach_mm, cut.outwards].into_iter().find(|mm| *mm != 0.0);
        (other.x - self.x) * outwards.unwrap_or(1.0).signum()
    }

    /// How far it lies along the thread from another, to the nearest turn, mm, signed.
    pub(super) fn along_mm(&self, other: &Helix) -> f64 {
        let turns = (self.z - other.z) / self.lead - (self.start_deg - other.start_deg) / 360.0;
        (turns - turns.round()) * self.lead
    }

    /// Whether they have one lead.
    pub(super) fn is_related(&self, other: &Helix) -> bool {
        self.along == other.along
            && (self.lead - other.lead).abs() < SAME
            && self.direction == other.direction
    }

    /// d.
    fn apart(&self, other: &Helix) -> f64 {
        self.along_mm(other).abs()
    }

    /// Whether they are one groove.
    fn is_in(&self, other: &Helix) -> bool {
        let apart = self.apart(other);
        apart < SAME || FLANK.contains(&(apart / (self.x - other.x).abs()))
    }
}

impl Starts {
    /// The number of the start whose helix the cut follows; a new one if it follows none that was seen.
    pub(crate) fn number(&mut self, cut: &Cut, place: Place) -> u32 {
        let new = Helix::of(cut, place);
        let related = || self.0.iter().filter(|helix| helix.is_related(&new));
        let same = related().find(|helix| helix.apart(&new) < SAME);
        let known = same.or_else(|| related().find(|helix| helix.is_in(&new)));
        let next = || related().map(|helix| helix.number + 1).max().unwrap_or(0);
        let number = known.map_or_else(next, |helix| helix.number);
        let is_new = !related().any(|helix| helix.apart(&new) < SAME && helix.x == new.x);
        if is_new {
            self.0.push(Helix { number, ..new });
        }
        number
    }

    /// A warning of each pass that runs beside the groove of another.
    pub(crate) fn beside(&self, units: Units) -> Vec<(Place, Box<Problem>)> {
        let mut leads: Vec<Vec<Helix>> = Vec::new();
        for helix in &self.0 {
            match leads.iter_mut().find(|lead| lead[0].is_related(helix)) {
                Some(lead) => lead.push(*helix),
                None => leads.push(vec![*helix]),
            }
        }
        leads.into_iter().flat_map(|helices| beside(helices, units)).collect()
    }
}

/// A warning of each helix of one lead that lies beside another.
fn beside(helices: Vec<Helix>, units: Units) -> Vec<(Place, Box<Problem>)> {
    // The first pass of each groove.
    let mut grooves: Vec<Helix> = Vec::new();
    for helix in &helices {
        if !grooves.iter().any(|groove| groove.number == helix.number) {
            grooves.push(*helix);
        }
    }
    let lead = helices[0].lead.abs();
    let mut found = Vec::new();
    loop {
        let pairs = (1..grooves.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let apart = |(i, j): (usize, usize)| {
            let of = |number: u32| helices.iter().filter(move |helix| helix.number == number);
            let all = of(grooves[i].number).flat_map(|a| of(grooves[j].number).map(move |b| a.apart(b)));
            (all.fold(f64::INFINITY, f64::min), i, j)
        };
        let nearest = pairs.map(apart).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((mm, i, j)) = nearest.filter(|(mm, ..)| *mm < APART * lead / grooves.len() as f64) else {
            return found;
        };
        let (beside, groove) = (grooves.remove(i).place, grooves[j].place.line);
        let message = format!("this pass runs {} beside the groove of line {groove}", units.length(mm));
        let help = "start it from the same Z and at the same angle (Q); starts of a thread lie evenly apart";
        found.push((beside, Problem::warning("beside-groove", Blame::Line(beside.line), message, help)));
    }
}
