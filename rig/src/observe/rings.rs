//! What a tool does to the thread in which it stands while its machine comes to rest without its controls.
//! In: the truth of every such cycle. Out: rings, and what the gauge would say without them.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | Ω | deg | how far the spindle turned while the tool was in the material and off its helix |
//! | e | µm | distance of the tool from the helix of its pass, less what it is out of the groove (M122) |
//! | d | mm | how deep it was below the crest of stock that its flanks reach |
//!
//! ```text
//! (M190) a ring: Ω = Σ |ΔC| ≥ 1° over the cycles with d > 0 and |e| > part_error_um; from min z to max z
//! ```
//! Axes brake in a tenth of a second, a spindle coasts for seconds: what the tool cuts then is no helix.

use protocol::{Axis, Truth};
use serde::{Deserialize, Serialize};

use super::gauged::{GaugeReport, Gauged};
use super::verdict::PartVerdict;

/// A spindle that stands swings by less, degrees.
const LEAST_DEG: f64 = 1.0;

/// The run that another one goes on with, and where.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ResumedReport {
    /// Its folder.
    pub run: String,
    /// The last control cycle that its journal knew.
    pub known_cycle: u64,
    /// The line at which the program was begun again.
    pub line: u32,
    /// The pass there, if it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pass: Option<u32>,
    /// What the tool cut while spindles ran down that nobody controlled.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rings: Vec<RingReport>,
    /// What the gauge would say without that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gauge_without_rings: Option<PartVerdict>,
}

impl ResumedReport {
    /// In words.
    pub fn told(&self) -> String {
        let pass = self.pass.map_or_else(String::new, |pass| format!(", pass {pass}"));
        let apart = match self.gauge_without_rings {
            Some(PartVerdict::Good) => {
                "; the gauge finds no other fault than what was cut while the spindle ran down"
            }
            Some(PartVerdict::Bad) => {
                "; the gauge finds fault with more than what was cut while the spindle ran down"
            }
            _ => "",
        };
        format!("goes on with {} from line {}{pass}{apart}", self.run, self.line)
    }
}

/// A ring that a tool has cut into its thread while the spindle ran down (M190).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RingReport {
    /// The pass in which the tool stood.
    pub pass: u32,
    /// Lowest and highest Z of the program, if it is known where its zero lies; of the machine otherwise, mm.
    pub z_mm: [f64; 2],
    /// How deep it goes below the crest, mm.
    pub depth_mm: f64,
    /// How far the spindle turned meanwhile, degrees.
    pub turned_deg: f64,
}

impl RingReport {
    /// In words.
    pub fn told(&self) -> String {
        let RingReport { pass, z_mm: [low, high], depth_mm, turned_deg } = self;
        format!(
            "a ring {depth_mm:.3} mm deep at Z {low:.3} … {high:.3} mm: the tool stood in the groove of pass {pass} while \
             the spindle ran down {turned_deg:.0}° without a control"
        )
    }
}

/// What is known of the runs that one goes on with.
#[derive(Clone, Debug, Default)]
pub(super) struct Rings {
    /// The gauges without what was cut while the spindle ran down; empty where it did not.
    without: Vec<Gauged>,
    rings: Vec<RingReport>,
    /// In the cycle before: true angle of the spindle, degrees.
    turned_deg: Option<f64>,
    /// A ring is being cut.
    cuts: bool,
    /// The run that is gone on with.
    pub(super) report: Option<ResumedReport>,
}

/// A tool that nobody leads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coasting {
    /// The pass in which it stood.
    pub(super) pass: u32,
    /// Where zero of the program lies along Z, mm.
    pub(super) origin_mm: f64,
    /// How deep it is below the crest, mm, and how far off its helix, µm, if it cuts.
    pub(super) off_helix: Option<[f64; 2]>,
}

impl Rings {
    /// Gauges beside those of all that was cut.
    pub(super) fn gauges(&mut self) -> impl Iterator<Item = &mut Gauged> {
        self.without.iter_mut()
    }

    /// From here on what is cut may be no thread: the gauges as they are go on without it.
    pub(super) fn part_from(&mut self, gauged: &[Gauged]) {
        if self.without.is_empty() {
            self.without = gauged.to_vec();
        }
    }

    /// Takes a cycle in which nobody leads a tool that was led in a pass (M190).
    pub(super) fn coast(&mut self, tool: Coasting, truth: &Truth, part_error_um: f64) {
        let before = self.turned_deg.replace(truth.spindle_deg).unwrap_or(truth.spindle_deg);
        let Some([depth_mm, _]) = tool.off_helix.filter(|[_, off_um]| *off_um > part_error_um) else {
            return;
        };
        let z = truth.axes[Axis::Z.index()].slide_mm - tool.origin_mm;
        if !std::mem::replace(&mut self.cuts, true) {
            self.rings.push(RingReport { pass: tool.pass, z_mm: [z; 2], ..RingReport::default() });
        }
        let Some(ring) = self.rings.last_mut() else { return };
        let [low, high] = ring.z_mm;
        ring.z_mm = [low.min(z), high.max(z)];
        ring.depth_mm = ring.depth_mm.max(depth_mm);
        ring.turned_deg += (truth.spindle_deg - before).abs();
    }

    /// The machine is switched on again.
    pub(super) fn switched_on(self) -> Rings {
        Rings { turned_deg: None, cuts: false, ..self }
    }

    /// The run that is gone on with, and what became of the part meanwhile.
    pub(super) fn reported(&self) -> Option<ResumedReport> {
        let rings: Vec<_> = self.rings.iter().filter(|ring| ring.turned_deg >= LEAST_DEG).cloned().collect();
        let judged = GaugeReport::worst(self.without.iter().map(Gauged::report)).map(|report| report.verdict);
        let gauge_without_rings = judged.filter(|_| !rings.is_empty());
        self.report.clone().map(|report| ResumedReport { rings, gauge_without_rings, ..report })
    }
}
