//! The cuts of a threading cycle. In: the cycle as the program means it ([`gcode::canon::ThreadCycle`]:
//! depths, infeed, tapers). Out: one [`Cut`] for each pass.

use gcode::canon::{ThreadCycle, Units};

use super::chain::Chain;
use super::cut::{Along, Cut, Point, Taper};

/// A threading cycle at its place on the machine; mm, radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cycle {
    pub(crate) s_rpm: f64,
    pub(crate) direction: f64,
    /// Where the tool stands: X is the drive line.
    pub(crate) from: Point,
    pub(crate) to_z: f64,
    pub(crate) lead_mm: f64,
    /// Of `words`.
    pub(crate) units: Units,
    pub(crate) words: ThreadCycle,
}

/// The most passes of one cycle.
pub(crate) const MOST_PASSES: usize = 1000;

impl Cycle {
    /// Depths of the passes, mm; one more than [`MOST_PASSES`] if there are too many.
    pub(crate) fn depths(&self) -> Vec<f64> {
        self.words.depths().take(MOST_PASSES + 1).map(|depth| depth * self.units.mm()).collect()
    }

    /// The cut of the pass that goes to `depth`, mm.
    pub(crate) fn cut(&self, depth: f64) -> Cut {
        let words = &self.words;
        let full_mm = words.depth * self.units.mm();
        let way = self.to_z - self.from.z;
        let towards = way.signum();
        let tan = libm::tan(words.infeed_deg.to_radians());
        let taper = Taper { length_mm: words.chamfer * self.units.mm(), height_mm: full_mm };
        let to_z = self.to_z - towards * (full_mm - depth) * tan;
        let from = Point { x: self.from.x, z: self.from.z + towards * depth * tan };
        let slope = words.taper_x * self.units.mm() / way;
        let approach_mm =
            words.crest * self.units.mm() + words.crest.signum() * depth + slope * (from.z - self.from.z);
        let lead_z = towards * self.lead_mm;
        Cut {
            s_rpm: self.s_rpm,
            top_share: 1.0,
            direction: self.direction,
            along: Along::Z,
            lead: Point { x: slope * lead_z, z: lead_z },
            chain: Chain::default(),
            from,
            to_mm: to_z,
            start_deg: words.start_deg,
            approach_mm,
            // X goes back to the drive line, however far the cone took it.
            retract_mm: -approach_mm - slope * (to_z - from.z),
            lift_mm: 0.0,
            outwards: -words.crest.signum(),
            clear_mm: depth,
            depth_mm: depth,
            depth_is_told: words.depth_is_told,
            entry: words.chamfer_in.then_some(taper),
            exit: words.chamfer_out.then_some(taper),
        }
    }
}
