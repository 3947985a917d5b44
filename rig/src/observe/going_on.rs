//! A run that goes on with one that was broken off: both cut one thread. In: the observer of the run before,
//! and the truth of its machine while that came to rest. Out: an observer that judges the thread of both, and
//! what the tool did to the thread while nobody led it.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | Ω | deg | how far the spindle turned while the tool was in the material and off its helix |
//! | e | µm | distance of the tool from the helix of its pass, less what it is out of the groove (M122) |
//! | d | mm | how deep it was below the crest of stock that its flanks reach |
//!
//! ```text
//! (M190) a ring: Ω = Σ |ΔC| ≥ 1° over the cycles with d > 0 and |e| > part_error_um; it lies from min z to max z
//! ```
//! Axes brake in a tenth of a second, a spindle coasts for seconds: what the tool cuts then is no helix.

use protocol::{Axis, Truth};
use serde::{Deserialize, Serialize};

use super::gauged::Gauged;
use super::pass::PassObserver;
use super::verdict::PartVerdict;
use super::{Observer, PassReport, ThreadReport};

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
pub(super) struct Earlier {
    passes: Vec<PassReport>,
    /// The gauge without what was cut while the spindle ran down.
    without_rings: Option<Gauged>,
    rings: Vec<RingReport>,
    /// The same machine in the cycle before: true angle of the spindle, degrees.
    turned_deg: Option<f64>,
    /// A ring is being cut.
    cuts: bool,
    report: Option<ResumedReport>,
}

impl Earlier {
    /// Gauges beside the one of all that was cut.
    pub(super) fn gauges(&mut self) -> impl Iterator<Item = &mut Gauged> {
        self.without_rings.iter_mut()
    }

    /// Takes a cycle in which nobody leads a tool that was led in a pass (M190).
    fn coast(&mut self, pass: &PassObserver, truth: &Truth, part_error_um: f64) {
        let before = self.turned_deg.replace(truth.spindle_deg).unwrap_or(truth.spindle_deg);
        let Some([depth_mm, off_um]) = pass.off_helix(truth) else { return };
        if off_um <= part_error_um {
            return;
        }
        let origin_mm = pass.origin_mm().map_or(0.0, |[_, z]| z);
        let z = truth.axes[Axis::Z.index()].slide_mm - origin_mm;
        let number = pass.pass().pass;
        if !std::mem::replace(&mut self.cuts, true) {
            self.rings.push(RingReport { pass: number, z_mm: [z; 2], ..RingReport::default() });
        }
        let Some(ring) = self.rings.last_mut() else { return };
        let [low, high] = ring.z_mm;
        ring.z_mm = [low.min(z), high.max(z)];
        ring.depth_mm = ring.depth_mm.max(depth_mm);
        ring.turned_deg += (truth.spindle_deg - before).abs();
    }
}

impl Observer {
    /// Takes a cycle in which the machine comes to rest without its controls: what the tool does to the
    /// thread in which it stands counts for the gauge.
    pub fn run_down(&mut self, truth: &Truth) {
        let Some(pass) = &self.current else { return };
        if let Some(gauged) = &mut self.gauged {
            self.earlier.without_rings.get_or_insert_with(|| gauged.clone());
            gauged.cycle(pass.pass(), truth);
        }
        self.earlier.coast(pass, truth, self.out.part_error_um);
    }

    /// The same observer of a run that goes on with another one of the same program.
    #[must_use]
    pub fn going_on(mut self, mut before: Observer) -> Observer {
        before.close();
        if self.gauged.is_some() {
            self.gauged = before.gauged;
        }
        self.threads = before.threads;
        self.earlier = before.earlier;
        (self.earlier.turned_deg, self.earlier.cuts) = (None, false);
        self.earlier.passes.append(&mut before.out.passes);
        self
    }

    /// The same observer, told which run that is and where it goes on with it.
    #[must_use]
    pub fn resumed(mut self, report: ResumedReport) -> Observer {
        self.earlier.report = Some(report);
        self
    }

    /// What all passes come to, those of the runs before included.
    pub(super) fn thread(&self) -> ThreadReport {
        let all: Vec<_> = self.earlier.passes.iter().chain(&self.out.passes).cloned().collect();
        self.threads.report(&all)
    }

    /// The run that it goes on with, and what became of the part meanwhile.
    pub(super) fn report_of_resumed(&self) -> Option<ResumedReport> {
        let Earlier { without_rings, rings, report, .. } = &self.earlier;
        let judged = without_rings.as_ref().map(|gauged| gauged.report().verdict);
        let rings: Vec<_> = rings.iter().filter(|ring| ring.turned_deg >= LEAST_DEG).cloned().collect();
        let gauge_without_rings = judged.filter(|_| !rings.is_empty());
        report.clone().map(|report| ResumedReport { rings, gauge_without_rings, ..report })
    }
}
