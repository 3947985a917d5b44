//! What a gauge says of the thread of a run. In: what [`gauge`] found, mm and µm. Out: a [`GaugeReport`] for
//! `summary.json`, and sentences for people.

use gauge::{Nominal, Side};
use serde::{Deserialize, Serialize};

use crate::observe::verdict::PartVerdict;

/// Why nothing is said of a part that is still being cut when its run ends.
const UNFINISHED: &str = "the program was not executed to its end";

/// What a gauge says of the thread of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GaugeReport {
    /// Name of the thread, or its numbers.
    pub name: String,
    /// What GO and NO-GO say.
    pub verdict: PartVerdict,
    /// Why they refuse, or why there is no verdict.
    pub reasons: Vec<String>,
    /// What was not judged, and why.
    pub notes: Vec<String>,
    /// Smallest pitch diameter, mm.
    pub pitch_diameter_min_mm: f64,
    /// Largest pitch diameter, mm.
    pub pitch_diameter_max_mm: f64,
    /// Virtual pitch diameter: what GO meets, mm.
    pub virtual_pitch_diameter_mm: f64,
    /// Of a taper: how far before its plane GO comes to rest; negative where it goes beyond, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standoff_mm: Option<f64>,
    /// Of a blunt start: turns behind the face up to which the ridge is gone, and from which on it is whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blunt_turns: Option<[f64; 2]>,
    /// Error of the lead over the length of the GO gauge, or of the thread if that is shorter, µm.
    pub lead_error_um: f64,
    /// Largest unevenness of the helix within a turn, µm.
    pub drunkenness_um: f64,
    /// Largest distance of two starts from where they belong, µm.
    pub starts_um: f64,
    /// Change of the pitch diameter over that length, µm.
    pub taper_um: f64,
    /// How far the pitch line moves while the thread is turned, µm.
    pub runout_um: f64,
    /// Flanks towards lower and higher Z, degrees.
    pub flank_deg: Vec<f64>,
    /// Smallest and largest diameter of the root, mm.
    pub root_mm: Vec<f64>,
    /// Smallest and largest diameter of the crest, mm; empty if nobody knows.
    pub crest_mm: Vec<f64>,
    /// Length of full thread that was measured, mm.
    pub length_mm: f64,
    /// What is asked of the thread.
    pub limits: GaugeLimits,
    /// Numbers of the passes that are judged.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub passes: Vec<u32>,
}

/// What a gauge asks of a thread: diameters of a cone hold at its plane; mm, degrees.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GaugeLimits {
    /// `external` for a screw, `internal` for a nut.
    pub side: String,
    /// Distance of grooves along the axis.
    pub pitch_mm: f64,
    /// Number of grooves beside each other.
    pub starts: u32,
    /// Whether it is wound to the left.
    pub left_hand: bool,
    /// Flanks towards lower and higher Z, to a plane across the axis.
    pub flank_deg: [f64; 2],
    /// Smallest and largest pitch diameter.
    pub pitch_diameter_mm: [f64; 2],
    /// Smallest and largest diameter of the crest.
    pub crest_mm: [Option<f64>; 2],
    /// Smallest and largest diameter of the root.
    pub root_mm: [Option<f64>; 2],
    /// Diameter that the groove has to reach for the GO gauge.
    pub root_go_mm: Option<f64>,
    /// Change of diameter along Z.
    pub taper: f64,
    /// Where along Z of the program the diameters of a cone hold.
    pub plane_mm: f64,
    /// Length of the GO gauge.
    pub length_mm: f64,
}

impl From<&Nominal> for GaugeLimits {
    fn from(nominal: &Nominal) -> GaugeLimits {
        GaugeLimits {
            side: if nominal.side == Side::External { "external" } else { "internal" }.into(),
            pitch_mm: nominal.pitch_mm,
            starts: nominal.starts,
            left_hand: nominal.grows,
            flank_deg: nominal.flank_deg,
            pitch_diameter_mm: nominal.pitch_diameter_mm,
            crest_mm: nominal.crest_mm,
            root_mm: nominal.root_mm,
            root_go_mm: nominal.root_go_mm,
            taper: nominal.taper,
            plane_mm: nominal.plane_mm,
            length_mm: nominal.gauge_mm,
        }
    }
}

impl GaugeReport {
    /// No verdict, and why.
    pub(super) fn none(nominal: &Nominal, why: String) -> GaugeReport {
        let limits = GaugeLimits::from(nominal);
        GaugeReport { name: nominal.name.clone(), reasons: vec![why], limits, ..GaugeReport::default() }
    }

    /// Refused without a measure.
    pub(super) fn refused(nominal: &Nominal, why: String) -> GaugeReport {
        GaugeReport { verdict: PartVerdict::Bad, ..GaugeReport::none(nominal, why) }
    }

    /// The same of a part that was not finished: what was cut so far has no verdict.
    pub(in crate::observe) fn unfinished(self) -> GaugeReport {
        GaugeReport { verdict: PartVerdict::None, reasons: vec![UNFINISHED.into()], ..self }
    }

    /// Refused for another reason besides.
    pub(super) fn bad_for(&mut self, why: String) {
        self.verdict = PartVerdict::Bad;
        self.reasons.push(why);
    }

    /// Without a verdict, and why.
    pub(super) fn undecided_for(&mut self, why: String) {
        self.verdict = PartVerdict::None;
        self.reasons.push(why);
    }

    /// With what was found; measures of nothing are left empty.
    pub(super) fn of(nominal: &Nominal, found: gauge::Report) -> GaugeReport {
        let [low, high] = found.pitch_diameter_mm;
        let measured = low > 0.0;
        GaugeReport {
            name: nominal.name.clone(),
            verdict: match found.verdict {
                gauge::Verdict::Good => PartVerdict::Good,
                gauge::Verdict::Bad => PartVerdict::Bad,
                gauge::Verdict::None => PartVerdict::None,
            },
            reasons: found.reasons.into_iter().map(|reason| reason.text).collect(),
            notes: Vec::new(),
            pitch_diameter_min_mm: low,
            pitch_diameter_max_mm: high,
            virtual_pitch_diameter_mm: found.virtual_mm,
            standoff_mm: found.standoff_mm,
            blunt_turns: found.blunt_turns,
            lead_error_um: found.lead_error_um,
            drunkenness_um: found.drunkenness_um,
            starts_um: found.starts_um,
            taper_um: found.taper_um,
            runout_um: found.runout_um,
            flank_deg: if measured { found.flank_deg.to_vec() } else { Vec::new() },
            root_mm: if measured { found.root_mm.to_vec() } else { Vec::new() },
            crest_mm: Vec::new(),
            length_mm: found.length_mm,
            limits: GaugeLimits::from(nominal),
            passes: Vec::new(),
        }
    }

    /// How bad the verdict is.
    fn grade(&self) -> u32 {
        match self.verdict {
            PartVerdict::Bad => 2,
            PartVerdict::None => 1,
            PartVerdict::Good => 0,
        }
    }

    /// Of several threads the first with the worst verdict.
    pub(crate) fn worst(all: impl IntoIterator<Item = GaugeReport>) -> Option<GaugeReport> {
        all.into_iter().reduce(|one, other| if other.grade() > one.grade() { other } else { one })
    }

    /// Of two holes of one thread: whether it is refused and the other is not, has no verdict and the other
    /// is good, or is wider.
    pub(super) fn is_worse_than(&self, other: &GaugeReport) -> bool {
        let wider = self.pitch_diameter_max_mm > other.pitch_diameter_max_mm;
        self.grade() > other.grade() || self.grade() == other.grade() && wider
    }

    /// The verdict in words, with what speaks for it or against it.
    pub fn sentence(&self) -> String {
        let reasons = self.reasons.join("; ");
        match self.verdict {
            PartVerdict::Good => {
                let GaugeLimits { pitch_diameter_mm: [least, most], pitch_mm, starts, .. } = self.limits;
                let standoff = self.standoff_mm.map_or_else(String::new, |mm| {
                    format!(", {mm:+.3} mm ({:+.2} turns) before its plane", mm / pitch_mm)
                });
                let apart = match starts {
                    0 | 1 => String::new(),
                    _ => format!(", {starts} starts within {:.2} µm", self.starts_um),
                };
                let blunt = self.blunt_turns.map_or_else(String::new, |[gone, whole]| {
                    format!("; its ridge is gone for {gone:.2} turns behind the face, and whole from {whole:.2} on")
                });
                format!(
                    "{} good: pitch diameter {:.4} to {:.4} mm of {least:.3} to {most:.3}, GO meets {:.4} mm{standoff}; lead \
                     {:+.2} µm over {:.1} mm, drunkenness {:.2} µm{apart}{blunt}",
                    self.name,
                    self.pitch_diameter_min_mm,
                    self.pitch_diameter_max_mm,
                    self.virtual_pitch_diameter_mm,
                    self.lead_error_um,
                    self.limits.length_mm.min(self.length_mm),
                    self.drunkenness_um,
                )
            }
            PartVerdict::Bad => format!("{} not good: {reasons}", self.name),
            PartVerdict::None => format!("{} no verdict: {reasons}", self.name),
        }
    }
}

/// A nut is no screw.
pub(super) fn other_side(nominal: &Nominal) -> String {
    let name = &nominal.name;
    match nominal.side {
        Side::External => {
            format!("the thread is cut away from the axis, as in a bore, and {name} is a screw")
        }
        Side::Internal => format!("the thread is cut towards the axis, as on a shaft, and {name} is a nut"),
    }
}
