//! Which start of a multi-start thread a pass belongs to. In: the leads, starting points (mm) and
//! start angles of the passes.
//! Out: a number from 0; passes with one number run in one groove.

use super::cut::Cut;

/// Helices closer than this are one, mm.
const SAME: f64 = 1e-6;

/// The helices seen so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Starts(Vec<Helix>);

#[derive(Clone, Copy, Debug)]
struct Helix {
    lead: f64,
    direction: f64,
    z: f64,
    start_deg: f64,
    number: u32,
}

impl Starts {
    /// The number of the start whose helix the cut follows; a new one if it follows none that was seen.
    pub(crate) fn number(&mut self, cut: &Cut) -> u32 {
        let lead = cut.lead.z;
        let related = |helix: &&Helix| (helix.lead - lead).abs() < SAME && helix.direction == cut.direction;
        let mut next = 0;
        for helix in self.0.iter().filter(related) {
            let turns = (cut.from.z - helix.z) / lead - (cut.start_deg - helix.start_deg) / 360.0;
            if ((turns - turns.round()) * lead).abs() < SAME {
                return helix.number;
            }
            next = next.max(helix.number + 1);
        }
        self.0.push(Helix {
            lead,
            direction: cut.direction,
            z: cut.from.z,
            start_deg: cut.start_deg,
            number: next,
        });
        next
    }
}
