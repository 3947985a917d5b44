//! Where the axis across a thread is at full depth, along the thread. In: a pass. Out: places, mm: a line,
//! and behind each corner of a chain another one.
//!
//! ```text
//! (M218) b(a) = b₀ + k₀ (a − a₀) + Σ (kᵢ − kᵢ₋₁) (a − aᵢ) of the corners aᵢ before a,
//!        k = lead across / lead along
//! ```

use motion::MOST_CHANGES;
use protocol::{Axis, ThreadPass};

use super::helix::Helix;

/// The axis across at full depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Full {
    /// a₀ and b₀.
    from: [f64; 2],
    slope: f64,
    /// Direction along the thread, ±1.
    towards: f64,
    /// aᵢ, and by how much the slope changes there.
    corners: [[f64; 2]; MOST_CHANGES],
}

impl Full {
    /// Of a pass with an axis along it and one across.
    pub(super) fn of(pass: &ThreadPass, [along, across]: [Axis; 2]) -> Full {
        let (lead, depth) = (pass.axis(along), pass.axis(across));
        let helix = Helix::of(pass, along);
        let mut full = Full {
            from: [lead.start.mm() + lead.stroke_mm, depth.start.mm() + depth.stroke_mm],
            slope: depth.lead_mm / lead.lead_mm,
            towards: lead.lead_mm.signum(),
            corners: [[0.0; 2]; MOST_CHANGES],
        };
        let mut slope = full.slope;
        let (mut leads, mut growths, mut at) = ([lead.lead_mm, depth.lead_mm], [0.0; 2], 0.0);
        let changes = [along, across].map(|axis| pass.changes(axis));
        for (place, (a, b)) in full.corners.iter_mut().zip(changes[0].iter().zip(changes[1].iter())) {
            let c = a.corner_deg();
            for (i, change) in [a, b].into_iter().enumerate() {
                leads[i] += growths[i] * (c - at) / 360.0 + change.lead_mm;
                growths[i] += change.growth_mm;
            }
            at = c;
            let next = leads[1] / leads[0];
            *place = [helix.programmed_mm(c), next - slope];
            slope = next;
        }
        full
    }

    /// Where it is at the beginning.
    pub(super) fn bottom_mm(&self) -> f64 {
        self.from[1]
    }

    /// Where it is at a place along the thread.
    pub(super) fn at_mm(&self, along_mm: f64) -> f64 {
        self.from[1] + self.way_mm(along_mm)
    }

    /// The same if there were no corners.
    pub(super) fn first_mm(&self, along_mm: f64) -> f64 {
        self.from[1] + self.slope * (along_mm - self.from[0])
    }

    /// How far it is from its beginning there.
    fn way_mm(&self, along_mm: f64) -> f64 {
        let behind = |[a, slope]: &[f64; 2]| slope * (self.towards * (along_mm - a)).max(0.0) * self.towards;
        self.slope * (along_mm - self.from[0]) + self.corners.iter().map(behind).sum::<f64>()
    }

    /// By how much it goes beyond its beginning in a direction up to an end of the thread, mm.
    pub(super) fn grows_mm(&self, outwards: f64, end_mm: f64) -> f64 {
        let corners = self.corners.iter().filter(|[_, slope]| *slope != 0.0).map(|[a, _]| *a);
        corners.chain([end_mm]).map(|a| outwards * self.way_mm(a)).fold(0.0, f64::max)
    }
}
