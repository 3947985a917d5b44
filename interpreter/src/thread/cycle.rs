//! The cuts of a G76 cycle, as LinuxCNC defines it. In: the words of the block, scaled to mm and radius. Out: one
//! [`Cut`] for each pass.
//!
//! | symbol | word | unit | meaning |
//! |---|---|---|---|
//! | P | P | mm/rev | lead along Z |
//! | I | I | mm | drive line to crest, negative for an external thread |
//! | J, K | J, K | mm | depth of the first pass, full depth |
//! | R | R | – | degression, ≥ 1 |
//! | Q | Q | deg | angle of the infeed |
//! | E | E | mm | length of the tapers that L asks for |
//!
//! ```text
//! depth of pass n    d = min(J n^(1/R), K),  then H passes at K
//! start of a pass    Z0 + d tan Q            towards the end
//! end of a pass      Ze - (K - d) tan Q      so that the last one ends at Ze
//! ```

use super::cut::{Cut, Point, Taper};

/// Words of a G76 block: mm, radius, degrees; checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cycle {
    pub(crate) s_rpm: f64,
    pub(crate) direction: f64,
    /// Where the tool stands: X is the drive line.
    pub(crate) from: Point,
    pub(crate) to_z: f64,
    pub(crate) lead_mm: f64,
    pub(crate) crest_mm: f64,
    pub(crate) first_mm: f64,
    pub(crate) full_mm: f64,
    pub(crate) degression: f64,
    pub(crate) infeed_deg: f64,
    pub(crate) springs: u32,
    pub(crate) taper_mm: f64,
    pub(crate) taper_in: bool,
    pub(crate) taper_out: bool,
}

/// The most passes of one cycle.
pub(crate) const MOST_PASSES: usize = 1000;

impl Cycle {
    /// Depths of the passes, mm; one more than [`MOST_PASSES`] if there are too many.
    pub(crate) fn depths(&self) -> Vec<f64> {
        let mut depths = Vec::new();
        for n in 1..=MOST_PASSES + 1 {
            let depth = self.first_mm * libm::pow(n as f64, 1.0 / self.degression);
            depths.push(depth.min(self.full_mm));
            if depth >= self.full_mm {
                break;
            }
        }
        let springs = (self.springs as usize).min(MOST_PASSES + 1 - depths.len());
        depths.resize(depths.len() + springs, self.full_mm);
        depths
    }

    /// The cut of the pass that goes to `depth`.
    pub(crate) fn cut(&self, depth: f64) -> Cut {
        let towards = (self.to_z - self.from.z).signum();
        let tan = libm::tan(self.infeed_deg.to_radians());
        let taper = Taper { length_mm: self.taper_mm, height_mm: self.full_mm };
        let inwards = self.crest_mm.signum();
        let approach_mm = self.crest_mm + inwards * depth;
        Cut {
            s_rpm: self.s_rpm,
            direction: self.direction,
            lead: Point { x: 0.0, z: towards * self.lead_mm },
            from: Point { x: self.from.x, z: self.from.z + towards * depth * tan },
            to_z: self.to_z - towards * (self.full_mm - depth) * tan,
            approach_mm,
            retract_mm: -approach_mm,
            clear_mm: depth,
            depth_mm: depth,
            entry: self.taper_in.then_some(taper),
            exit: self.taper_out.then_some(taper),
        }
    }
}
