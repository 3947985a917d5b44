//! The part, as the program means it: what of it the tool may touch in a pass. In: a [`ThreadPass`], the true
//! place of tool and spindle. Out: how deep the tool is, and by how much it is beside its groove.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | s | mm | way of Z in the direction of the thread, from the start of the pass |
//! | d | mm | depth of the tool below the crest; negative outside |
//! | D(s), D | mm | depth of the groove at a place, at its deepest |
//! | e | mm | true Z minus the helix at the true spindle angle, less whole leads |
//! | φ | – | half angle of the flank |
//!
//! ```text
//! bottom   d <= D(s)                       the tool is not deeper than its law at that Z, give or take
//! flank    |e| <= (D − d) tan φ            the tool is within the groove, prolonged along the helix,
//!                                          give or take, or no farther behind the face of the part
//! ```
//!
//! The part begins where Z has reached its lead in every pass: before that place no thread can be cut, so a
//! sensible program has no material there. It ends nowhere, unless the pass has no retract: then there is a
//! relief where Z begins to brake. A single pass (G33) does not say how deep it is: it is taken to be as deep
//! as a thread of its lead is, but no more than half of its way out.

use protocol::{Axis, ThreadPass};

/// Places of a pass at which the depth of its groove is known.
const STATIONS: usize = 400;
/// Depth of a thread, a share of its lead.
const DEPTH_LEADS: f64 = 0.62;
/// The tool touches nothing that is less deep than this, mm.
const SKIN_MM: f64 = 0.002;
/// Beyond the last place of a pass the groove is still that of its end for so far, mm.
const END_MM: f64 = 0.03;

/// How far around a place its groove counts, leads.
const NEAR_LEADS: f64 = 0.1;

/// What a pass may touch.
#[derive(Clone, Debug)]
pub struct PassStock {
    /// Its number.
    pub pass: u32,
    /// Advance of Z per turn, mm, positive.
    pub lead: f64,
    towards: f64,
    direction: f64,
    start_z: f64,
    /// A point of the helix: angle and s.
    helix: (f64, f64),
    face: f64,
    back: f64,
    brake: f64,
    crest: f64,
    /// How much X goes for each mm of Z.
    pub slope: f64,
    into: f64,
    /// D, mm.
    pub deepest: f64,
    /// (s, D), s rising.
    groove: Vec<(f64, f64)>,
}

/// Where the tool is, in the material or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// d, mm.
    pub depth_mm: f64,
    /// s, mm.
    pub way_mm: f64,
    /// By how much it is too deep, mm; negative: so much is left.
    pub bottom_mm: f64,
    /// By how much it is beside the groove, mm; negative: so much is left.
    pub flank_mm: f64,
}

impl PassStock {
    /// The stock of a pass along Z with one lead, which lifts; nothing for any other.
    pub fn of(pass: &ThreadPass) -> Option<PassStock> {
        let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
        if z.lead_mm == 0.0 || pass.corners().next().is_some() || pass.returns() {
            return None;
        }
        let towards = z.lead_mm.signum();
        let (x_law, z_law) = (pass.law(Axis::X), pass.law(Axis::Z));
        let run = z.run_in_c0_deg + z.run_in_dc_deg;
        let place = |c: f64| (towards * z_law.at(c).s, x.start.mm() + x_law.at(c).s);
        let slope = x.lead_mm / z.lead_mm;
        let root_at = |c: f64| {
            let (s, mm) = place(c);
            mm - slope * (z.start.mm() + towards * s)
        };
        let root = root_at(0.5 * (x.locked_deg().max(run) + x.leaves_deg().min(z.brake_c_deg)));
        // The way out is shortest at one of the ends of a cone.
        let clear_at = |c: f64| pass.out.clear.mm() - slope * (z.start.mm() + towards * place(c).0);
        let clear = clear_at(run);
        let into = if clear > root { -1.0 } else { 1.0 };
        let lift = (clear - root).abs().min((clear_at(z.done_deg()) - root).abs());
        let single = (DEPTH_LEADS * z.lead_mm.abs()).min(0.5 * lift);
        let depth = if pass.depth_mm > 0.0 { pass.depth_mm } else { single };
        let crest = root - into * depth;
        let done = pass.done_deg();
        let first = x.begins_deg().min(z.begins_deg());
        let station = |i: usize| first + (done - first) * i as f64 / STATIONS as f64;
        let groove = (0..=STATIONS).map(station).map(|c| (place(c).0, into * (root_at(c) - crest)));
        let retracts = x.retract_mm != 0.0;
        Some(PassStock {
            pass: pass.pass,
            lead: z.lead_mm.abs(),
            towards,
            direction: pass.direction,
            start_z: z.start.mm(),
            helix: (run, place(run).0),
            face: place(run).0,
            back: if retracts { f64::INFINITY } else { place(z.brake_c_deg).0 },
            brake: place(z.brake_c_deg).0,
            crest,
            slope,
            into,
            deepest: depth,
            groove: groove.collect(),
        })
    }

    /// Where Z reaches the lead, and in which direction it goes, mm of the machine.
    pub fn face(&self) -> (f64, f64) {
        (self.start_z + self.towards * self.face, self.towards)
    }

    /// The part begins no nearer than here, if the other pass goes in the same direction.
    pub fn begins(&mut self, (z_mm, towards): (f64, f64)) {
        if towards == self.towards {
            self.face = self.face.max(towards * (z_mm - self.start_z));
        }
    }

    /// Where the tool is; mm, degrees.
    pub fn place(&self, x_mm: f64, z_mm: f64, spindle_deg: f64, tan_flank: f64) -> Contact {
        let s = self.towards * (z_mm - self.start_z);
        let depth_mm = self.into * (x_mm - self.slope * z_mm - self.crest);
        let turns = (self.direction * spindle_deg - self.helix.0) / 360.0;
        let ahead = (s - self.helix.1) / self.lead - turns;
        let beside = (ahead - ahead.round()).abs() * self.lead;
        let room = (self.deepest - depth_mm).max(0.0) * tan_flank;
        Contact {
            depth_mm,
            way_mm: s,
            bottom_mm: depth_mm - self.groove_at(s),
            // Nothing is beside the groove by more than it is behind the face.
            flank_mm: (beside - room).min(s - self.face),
        }
    }

    /// Whether the tool is in the material there.
    pub fn touches(&self, place: &Contact) -> bool {
        place.depth_mm > SKIN_MM && self.is_along(place)
    }

    fn is_along(&self, place: &Contact) -> bool {
        place.way_mm > self.face && place.way_mm < self.back
    }

    /// Where the tool goes through the skin of the part from one cycle to the next, if it does.
    pub fn through_skin(&self, from: &Contact, to: &Contact) -> Option<Contact> {
        let [was, is] = [from, to].map(|place| place.depth_mm - SKIN_MM);
        let along = [from, to].into_iter().all(|place| self.is_along(place));
        let between = |from: f64, to: f64| from + was / (was - is) * (to - from);
        (along && was * is < 0.0).then(|| Contact {
            depth_mm: SKIN_MM,
            way_mm: between(from.way_mm, to.way_mm),
            bottom_mm: between(from.bottom_mm, to.bottom_mm),
            flank_mm: between(from.flank_mm, to.flank_mm),
        })
    }

    /// Whether Z brakes where the tool is: it leaves the helix there.
    pub(crate) fn brakes(&self, contact: &Contact) -> bool {
        contact.way_mm >= self.brake
    }

    /// How far the tool is behind the last place of the pass, mm.
    pub(crate) fn beyond_mm(&self, contact: &Contact) -> f64 {
        contact.way_mm - self.groove.last().map_or(contact.way_mm, |(last, _)| *last)
    }

    /// The angle of the pass that belongs to where the tool is, degrees.
    pub(crate) fn angle_deg(&self, contact: &Contact) -> f64 {
        self.helix.0 + 360.0 * (contact.way_mm - self.helix.1) / self.lead
    }

    /// How far X goes with a mm of Z around there, mm: along the cone, and in and out of the groove.
    pub(crate) fn steep(&self, contact: &Contact) -> f64 {
        let near = |(s, _): &&(f64, f64)| (s - contact.way_mm).abs() < NEAR_LEADS * self.lead;
        let places: Vec<_> = self.groove.iter().filter(near).collect();
        let steep = places.windows(2).filter(|pair| pair[1].0 > pair[0].0);
        let steep = steep.map(|pair| ((pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).abs());
        self.slope.abs() + steep.fold(0.0, f64::max)
    }

    /// By how much the tool is too deep if Z may be off by so much, mm.
    pub fn bottom_mm(&self, contact: &Contact, off_mm: f64) -> f64 {
        let deepest = [-off_mm, -0.5 * off_mm, 0.0, 0.5 * off_mm, off_mm]
            .map(|off| self.groove_at(contact.way_mm + off))
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        contact.depth_mm - deepest
    }

    /// D(s); nothing may be touched behind the last place.
    fn groove_at(&self, s: f64) -> f64 {
        let next = self.groove.partition_point(|(place, _)| *place < s);
        match (next.checked_sub(1).and_then(|i| self.groove.get(i)), self.groove.get(next)) {
            (Some((s0, d0)), Some((s1, d1))) if s1 > s0 => d0 + (d1 - d0) * (s - s0) / (s1 - s0),
            (_, Some((_, d))) => *d,
            (Some((last, d)), None) if s < last + END_MM => *d,
            _ => 0.0,
        }
    }
}
