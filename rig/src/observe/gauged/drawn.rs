//! The groove that all passes leave, held against the one that a program draws. In: every control cycle of
//! a pass the true places of the slides, mm, and the true angle of the spindle, degrees. Out: a
//! [`GrooveReport`].
//!
//! Kept is where the tip was at each of some angles (M158); nothing of the laws by which it got there. Taps
//! are no part of it: what a tap cuts is its own form.

use std::collections::BTreeMap;

use gauge::{Drawn, DrawnReport, Spot, Verdict};
use machine::Machine;
use protocol::{Axis, ThreadPass, Truth};
use serde::{Deserialize, Serialize};

use super::crossings::Crossings;
use super::{LEAST, PLACES, SPARE, STATIONS};
use crate::observe::planned::Planned;
use crate::observe::verdict::PartVerdict;

/// A drawing that a groove is held against.
#[derive(Clone, Debug, PartialEq)]
pub struct GrooveAsked {
    /// What was drawn.
    pub drawn: Drawn,
    /// Where the zero of the program lies on the machine in each pass: X, Z, mm; 0 if nothing is said.
    pub origins_mm: BTreeMap<u32, [f64; 2]>,
}

/// What is found of a groove that is drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GrooveReport {
    /// What was drawn, as it is written.
    pub drawn: String,
    /// Whether it is as drawn.
    pub verdict: PartVerdict,
    /// Why it is not, or why there is no verdict.
    pub reasons: Vec<String>,
    /// How far it may stray along its axis and in depth, µm.
    pub within_um: f64,
    /// Farthest that anything was cut beside the groove along its axis, µm.
    pub place_um: f64,
    /// Least and largest height of the root over that of the drawing, µm.
    pub depth_um: [f64; 2],
    /// By how much it is longer than drawn, µm.
    pub lead_error_um: f64,
    /// How far the means of passes that reach the root lie apart, µm.
    pub passes_um: f64,
    /// Length along its axis that was judged, mm.
    pub length_mm: f64,
    /// Turns that were judged.
    pub turns: f64,
}

impl GrooveReport {
    fn of(drawn: &Drawn, found: DrawnReport) -> GrooveReport {
        let mut reasons = found.reasons;
        let verdict = match found.verdict {
            Verdict::Good => PartVerdict::Good,
            Verdict::Bad => PartVerdict::Bad,
            Verdict::None => {
                reasons.push("nothing was cut where it is drawn".into());
                PartVerdict::None
            }
        };
        GrooveReport {
            drawn: drawn.text.clone(),
            verdict,
            reasons,
            within_um: 1e3 * drawn.within_mm,
            place_um: found.place_um,
            depth_um: found.depth_um,
            lead_error_um: found.lead_error_um,
            passes_um: found.passes_um,
            length_mm: found.length_mm,
            turns: found.turns,
        }
    }

    /// The verdict in words, with what speaks for it or against it.
    pub fn sentence(&self) -> String {
        let GrooveReport { place_um, within_um, lead_error_um, passes_um, length_mm, turns, .. } = self;
        let [low, high] = self.depth_um;
        match self.verdict {
            PartVerdict::Good => format!(
                "as drawn over {turns:.1} turns and {length_mm:.1} mm: place within {place_um:.2} µm, depth off by \
                 {low:+.2} to {high:+.2} of {within_um:.0} allowed; lead {lead_error_um:+.2} µm, passes {passes_um:.2} µm \
                 apart"
            ),
            PartVerdict::Bad => format!("not as drawn: {}", self.reasons.join("; ")),
            PartVerdict::None => format!("no verdict: {}", self.reasons.join("; ")),
        }
    }
}

/// Collects the places of the tip.
#[derive(Clone, Debug)]
pub(in crate::observe) struct Grooved {
    asked: GrooveAsked,
    crossings: Crossings<2>,
    /// Tangent of the flank of the tool of each pass that cuts a groove.
    tangents: BTreeMap<u32, f64>,
    spots: Vec<Spot>,
    is_full: bool,
}

impl Grooved {
    /// For the passes of a program.
    pub(in crate::observe) fn new(
        machine: &Machine,
        program: &BTreeMap<u32, Planned>,
        asked: GrooveAsked,
    ) -> Grooved {
        let cuts = || program.iter().filter(|(_, planned)| !planned.pass.returns());
        let turns: f64 = cuts().map(|(_, planned)| planned.pass.done_deg() / 360.0).sum();
        let stations = ((PLACES as f64 / (SPARE * turns.max(1.0))) as usize).clamp(LEAST, STATIONS);
        let tangent = |number: u32| {
            let tool = machine.tool(number).and_then(|tool| Some(0.5 * tool.angle_deg?));
            let drawn = || Some(0.5 * asked.drawn.angle_deg?);
            let deg = tool.or_else(drawn).unwrap_or(machine.threading.flank_half_angle_deg);
            libm::tan(deg.to_radians())
        };
        Grooved {
            tangents: cuts().map(|(number, planned)| (*number, tangent(planned.tool))).collect(),
            crossings: Crossings::new(stations),
            spots: Vec::new(),
            is_full: false,
            asked,
        }
    }

    /// What was cut so far counts for a run that goes on, whose tools may be others.
    pub(in crate::observe) fn goes_on(self, now: &Grooved) -> Grooved {
        Grooved {
            asked: now.asked.clone(),
            tangents: now.tangents.clone(),
            crossings: Crossings::new(self.crossings.stations()),
            ..self
        }
    }

    /// Takes a control cycle of a pass.
    pub(in crate::observe) fn cycle(&mut self, pass: &ThreadPass, truth: &Truth) {
        let Some(tangent) = self.tangents.get(&pass.pass).copied() else { return };
        let [x, z] = self.asked.origins_mm.get(&pass.pass).copied().unwrap_or_default();
        let slide = |axis: Axis| truth.axes[axis.index()].slide_mm;
        let tip = [slide(Axis::X) - x, slide(Axis::Z) - z];
        let (spots, is_full, on_face) = (&mut self.spots, &mut self.is_full, self.asked.drawn.on_face());
        let [low, high] = self.asked.drawn.ends_mm();
        self.crossings.cycle(pass.pass, truth.spindle_deg, tip, |station, [radius, z_mm]| {
            let radius_mm = radius.abs();
            let along = if on_face { radius_mm } else { z_mm };
            *is_full |= spots.len() == PLACES;
            if (low..=high).contains(&along) && !*is_full {
                spots.push(Spot { pass: pass.pass, station: station as u32, z_mm, radius_mm, tangent });
            }
        });
    }

    /// The pass is over, and may be cut again from its start.
    pub(in crate::observe) fn pass_ends(&mut self) {
        self.crossings.pass_ends();
    }

    /// What is found.
    pub(in crate::observe) fn report(&self) -> GrooveReport {
        let drawn = &self.asked.drawn;
        if self.is_full {
            let reasons = vec![format!("it is too long to be judged: more than {PLACES} places")];
            return GrooveReport { drawn: drawn.text.clone(), reasons, ..GrooveReport::default() };
        }
        let stations = self.crossings.stations() as u32;
        GrooveReport::of(drawn, gauge::judge_drawn(drawn, stations, &self.spots))
    }
}
