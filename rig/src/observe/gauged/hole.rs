//! The hole that a tap goes into: whether the program drilled it, and as deep as it is tapped. In: the taps
//! as they are planned, mm of the machine; what tools left there, mm of the program. Out: a verdict with its
//! reason, and why the crest is not judged.

use std::collections::BTreeMap;

use gauge::{Check, Nominal, Reason};
use protocol::Axis;

use super::turned::{Turned, unknown};
use super::{GaugeReport, Gauged};
use crate::observe::{
    helix::Helix,
    planned::{Planned, Stock},
    verdict::PartVerdict,
};

/// A tap goes no deeper than its hole by more than this, mm: slides stray by some µm.
const DEEPER_MM: f64 = 0.05;
/// A hole lies beside its tap from here on, mm; a tap beside the axis of its hole.
const BESIDE_MM: f64 = 0.02;
/// A tap with another lead than its thread, mm.
const OTHER_LEAD_MM: f64 = 1e-4;

/// A hole that is tapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hole {
    /// How far along Z of the program it is tapped, mm.
    to_mm: f64,
    /// Towards which Z: 1 or −1.
    way: f64,
    /// What the stock is there before it is cut.
    stock: Known,
    /// So many taps go into it.
    taps: u32,
    /// By how much the tap advances in a turn, mm.
    lead_mm: f64,
    /// How far a tap stands beside the axis of the hole, mm.
    beside_mm: f64,
    /// How far along Z its zero lies beside that of the first hole that its tap went into, mm.
    moved_mm: f64,
}

/// What is known of the stock where a hole is tapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    /// Nobody described it.
    Nothing,
    Solid,
    /// It has a bore.
    Bored,
}

impl Hole {
    /// Of a tap, where zero of the program lies in its pass, X and Z, and where the hole of a mill lies,
    /// X and Y of the machine.
    pub(super) fn of(planned: &Planned, [origin_x, origin_z]: [f64; 2], hole_mm: Option<[f64; 2]>) -> Hole {
        let pass = &planned.pass;
        let way = pass.lead_mm.signum();
        let to_mm = Helix::of(pass, Axis::Z).at_mm(pass.thread_end_deg) - origin_z;
        let [x, y] = [Axis::X, Axis::Y].map(|axis| pass.axis(axis).start.mm());
        let beside_mm =
            hole_mm.map_or((x - origin_x).abs(), |[hole_x, hole_y]| libm::hypot(x - hole_x, y - hole_y));
        let lead_mm = pass.lead_mm.abs();
        let unknown = Hole { to_mm, way, stock: Known::Nothing, taps: 1, lead_mm, beside_mm, moved_mm: 0.0 };
        let Stock::Part(part, _) = &planned.stock else { return unknown };
        // What goes through the part is tapped as deep as the part is.
        let [low, high] = part.ends_mm();
        let to_mm = if way < 0.0 { to_mm.max(low) } else { to_mm.min(high) };
        let is_bored = part.radii_mm(to_mm).is_some_and(|[inner, _]| inner > 0.0);
        Hole { to_mm, stock: if is_bored { Known::Bored } else { Known::Solid }, ..unknown }
    }

    /// The same of a hole whose zero lies beside that of the first.
    pub(super) fn moved(self, moved_mm: f64) -> Hole {
        Hole { moved_mm, ..self }
    }

    /// How far it does.
    pub(super) fn moved_mm(self) -> f64 {
        self.moved_mm
    }

    /// The same hole with the taps before: the deepest of them counts.
    pub(super) fn behind(self, before: Option<Hole>) -> Hole {
        let Some(before) = before else { return self };
        let is_deeper = before.way * before.to_mm >= self.way * self.to_mm;
        let deepest = if is_deeper { before } else { self };
        let beside_mm = before.beside_mm.max(self.beside_mm);
        Hole { taps: before.taps + 1, beside_mm, ..deepest }
    }

    /// Why a gauge refuses the pitch diameter, where it is the tap: another lead than that of its thread, a
    /// place beside the axis. What several passes are elsewhere are here the teeth of one tap.
    pub(super) fn names_cause(self, nominal: &Nominal, reason: &mut Reason) {
        if !matches!(reason.check, Check::Go | Check::NoGo) {
            return;
        }
        let mut causes = Vec::new();
        let asked_mm = nominal.pitch_mm * f64::from(nominal.starts);
        if (self.lead_mm - asked_mm).abs() > OTHER_LEAD_MM {
            let [is, asked] = [self.lead_mm, asked_mm].map(|mm| (1e4 * mm).round() / 1e4);
            causes.push(format!("the tap is fed by {is} mm in a turn, and its thread has {asked}"));
        }
        if self.beside_mm > BESIDE_MM {
            causes.push(format!("the tap stands {:.3} mm beside the axis of its hole", self.beside_mm));
        }
        match reason.text.rfind(" (").filter(|_| !causes.is_empty()) {
            Some(at) => reason.text.replace_range(at.., &format!(" ({})", causes.join(", "))),
            None if self.taps == 1 => {
                reason.text = reason.text.replacen("(passes ", "(the teeth of the tap ", 1);
                reason.text = reason.text.replacen(", passes ", ", the teeth of the tap ", 1);
            }
            None => {}
        }
    }

    /// What speaks against the hole before its thread is looked at.
    pub(super) fn told(self, turned: &Turned) -> Option<(PartVerdict, String)> {
        let Hole { to_mm, way, stock, .. } = self;
        match (turned.reached_mm(way), stock) {
            (_, Known::Bored) | (None, Known::Nothing) => None,
            (None, Known::Solid) => {
                let why =
                    "nothing drilled the hole that is tapped, and the part that is described is solid there";
                Some((PartVerdict::None, why.into()))
            }
            (Some(reached), _) if way * (to_mm - reached) <= DEEPER_MM => None,
            (Some(reached), Known::Solid) => Some((
                PartVerdict::Bad,
                format!("the hole is drilled to Z{reached:.2} and tapped to Z{to_mm:.2}"),
            )),
            (Some(reached), Known::Nothing) => Some((
                PartVerdict::None,
                format!(
                    "the hole is drilled to Z{reached:.2} and tapped to Z{to_mm:.2}, and nobody described what the part \
                     is there"
                ),
            )),
        }
    }

    /// Why its crest is not judged.
    pub(super) fn crest_unknown(self, turned: &Turned) -> String {
        match (turned.unknown_drill(), turned.reached_mm(self.way)) {
            (Some(tool), _) => unknown(tool),
            (None, None) => "the crest is not judged: nothing in the program drilled the hole".into(),
            (None, Some(_)) => {
                "the crest is not judged: the hole is not drilled along all of the thread".into()
            }
        }
    }

    /// How far beside the tap it was drilled, in words.
    pub(super) fn beside(turned: &Turned) -> Option<String> {
        let mm = turned.beside_mm();
        (mm > BESIDE_MM).then(|| format!("the hole is drilled {mm:.3} mm beside the tap"))
    }
}

/// Zero of the program lies for each tool where it first cuts. How far along Z from there the passes of a
/// hole lie, which may have another zero of the part, mm.
pub(super) fn moved_mm(
    passes: &BTreeMap<u32, Planned>,
    program: &BTreeMap<u32, Planned>,
    origins_mm: &BTreeMap<u32, [f64; 2]>,
) -> f64 {
    let z = |number: &u32| origins_mm.get(number).map_or(0.0, |[_, z]| *z);
    let Some((here, planned)) = passes.iter().next() else { return 0.0 };
    let first = program.iter().find(|(_, other)| other.tool == planned.tool);
    first.map_or(0.0, |(first, _)| z(here) - z(first))
}

impl Gauged {
    /// What is tapped, and what tools will leave there.
    pub(super) fn finds_hole(&mut self, program: &BTreeMap<u32, Planned>) {
        for (number, planned) in program.iter().filter(|(number, _)| self.taps.contains_key(number)) {
            let hole = Hole::of(planned, self.origin_mm(*number), self.hole_mm);
            self.tapped = Some(hole.behind(self.tapped));
        }
        let turned = Turned::new(&self.asked.nominal, self.full_mm);
        self.turned = match (self.hole_mm, self.tapped) {
            (Some(_), Some(hole)) => turned.standing(hole.way),
            _ => turned,
        };
    }

    /// What the gauge says; of several holes, of the worst.
    pub(in crate::observe) fn report(&self) -> GaugeReport {
        let told = std::iter::once(self).chain(&self.others).map(Gauged::of_hole);
        let Some(mut worst) = told.reduce(|one, other| if other.is_worse_than(&one) { other } else { one })
        else {
            return self.of_hole();
        };
        if !self.others.is_empty() {
            let holes = 1 + self.others.len();
            worst
                .notes
                .push(format!("{holes} holes, each judged by itself: these are the figures of the worst"));
        }
        worst
    }

    /// What it says of the part of a lathe, or of one hole.
    fn of_hole(&self) -> GaugeReport {
        let mut report = self.of_thread();
        report.passes = self.edges.keys().copied().collect();
        if let (Some([x, y]), false) = (self.hole_mm, report.reasons.is_empty()) {
            report.reasons[0].insert_str(0, &format!("hole at X {x:.3} Y {y:.3} of the machine: "));
        }
        report
    }
}
