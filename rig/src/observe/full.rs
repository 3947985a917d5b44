//! Where the axis across a thread is at full depth, along the thread. In: a pass. Out: places, mm: a line,
//! and behind each corner of a chain another one, or a parabola where it follows an arc.
//!
//! ```text
//! (M218) b(a) = b₀ + k₀ (a − a₀) + Σ (kᵢ − k(aᵢ)) (a − aᵢ) + Σ (κᵢ − κᵢ₋₁) (a − aᵢ)²/2 of the corners aᵢ
//!        before a;  k = F_b/F_a of the leads across and along,
//!        κ = (G_b F_a − F_b G_a)/F_a³ with their growths
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
    /// aᵢ, and by how much slope and curvature change there.
    corners: [[f64; 3]; MOST_CHANGES],
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
            corners: [[0.0; 3]; MOST_CHANGES],
        };
        let (mut slope, mut bends, mut last_mm) = (full.slope, 0.0, 0.0);
        let (mut leads, mut growths, mut at) = ([lead.lead_mm, depth.lead_mm], [0.0; 2], 0.0);
        let changes = [along, across].map(|axis| pass.changes(axis));
        for (place, (a, b)) in full.corners.iter_mut().zip(changes[0].iter().zip(changes[1].iter())) {
            let c = a.corner_deg();
            for (i, change) in [a, b].into_iter().enumerate() {
                leads[i] += growths[i] * (c - at) / 360.0 + change.lead_mm;
                growths[i] += change.growth_mm;
            }
            at = c;
            let a_mm = helix.programmed_mm(c);
            let next = leads[1] / leads[0];
            let curved = (growths[1] * leads[0] - leads[1] * growths[0]) / (leads[0] * leads[0] * leads[0]);
            *place = [a_mm, next - (slope + bends * (a_mm - last_mm)), curved - bends];
            (slope, bends, last_mm) = (next, curved, a_mm);
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
        let behind = |[a, slope, bends]: &[f64; 3]| {
            let gone = (self.towards * (along_mm - a)).max(0.0) * self.towards;
            (slope + 0.5 * bends * gone) * gone
        };
        self.slope * (along_mm - self.from[0]) + self.corners.iter().map(behind).sum::<f64>()
    }

    /// By how much it goes beyond its beginning in a direction up to an end of the thread, mm.
    pub(super) fn grows_mm(&self, outwards: f64, end_mm: f64) -> f64 {
        let corners = self.corners.iter().filter(|[_, slope, bends]| [*slope, *bends] != [0.0; 2]);
        let corners = corners.map(|[a, ..]| *a);
        corners.chain([end_mm]).map(|a| outwards * self.way_mm(a)).fold(0.0, f64::max)
    }
}
