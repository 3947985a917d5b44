//! How much deeper each pass of a thread goes than the one before it in the same groove, and a warning of
//! passes whose edge rubs. In: cuts and the numbers of their starts, mm. Out: Δd and Δz of (M208) for each
//! pass; one warning for every lead.

use gcode::canon::Units;
use gcode::problem::Blame;
use gcode::{Place, Problem};

use super::cut::Cut;
use super::starts::Helix;

/// Less than this deeper, an edge rubs instead of cutting, mm: what tables of makers have as the least infeed
/// of a last pass is 0.025 (Mitsubishi) to 0.05 mm (Tungaloy).
const RUBS_MM: f64 = 0.025;
/// A pass that goes no deeper than this is a spring pass, mm.
const SPRING_MM: f64 = 1e-3;
/// Depths are sums of six places: what is short of `RUBS_MM` by less than this is not.
const ROUNDING_MM: f64 = 1e-6;

/// The infeed of the passes seen so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Infeeds {
    /// The last pass of each start, and its depth where the program tells it.
    last: Vec<(Helix, Option<f64>)>,
    rubs: Vec<Rubs>,
}

/// Passes of one lead that rub.
#[derive(Clone, Copy, Debug)]
struct Rubs {
    helix: Helix,
    passes: u32,
    least_mm: f64,
}

impl Infeeds {
    /// Takes the next pass; Δd and Δz in mm, the first negative where it is shallower. Of the first pass of a
    /// start all of its depth, straight in; `None` where nobody told that.
    pub(crate) fn beyond(&mut self, cut: &Cut, start: u32, place: Place) -> Option<[f64; 2]> {
        let helix = Helix::of(cut, place).numbered(start);
        let depth = cut.depth_is_told.then_some(cut.depth_mm);
        let known = self.last.iter_mut().find(|(other, _)| other.is_start_of(&helix));
        let Some(last) = known else {
            self.last.push((helix, depth));
            return depth.map(|deeper| [deeper, 0.0]);
        };
        let (before, before_mm) = std::mem::replace(last, (helix, depth));
        let deeper = match (depth, before_mm) {
            (Some(depth), Some(before)) => depth - before,
            _ => helix.inwards_mm(&before, cut),
        };
        if (SPRING_MM..RUBS_MM - ROUNDING_MM).contains(&deeper) {
            match self.rubs.iter_mut().find(|rubs| rubs.helix.is_related(&helix)) {
                Some(rubs) => (rubs.passes, rubs.least_mm) = (rubs.passes + 1, rubs.least_mm.min(deeper)),
                None => self.rubs.push(Rubs { helix, passes: 1, least_mm: deeper }),
            }
        }
        Some([deeper, helix.along_mm(&before)])
    }

    /// A warning for every lead with passes that rub, at the first of them.
    pub(crate) fn rubs(&self, units: Units) -> impl Iterator<Item = (Place, Box<Problem>)> {
        self.rubs.iter().map(move |Rubs { helix, passes, least_mm }| {
            let [least, rubs] = [*least_mm, RUBS_MM].map(|mm| units.length(mm));
            let goes = match passes {
                1 => "a pass goes no more than".into(),
                _ => format!("{passes} passes go as little as"),
            };
            let message = format!(
                "{goes} {least} deeper than the one before in this groove: below {rubs} an edge rubs instead of cutting"
            );
            let help = "take fewer passes, a least cut, or a larger finish allowance; a spring pass goes no deeper at all";
            let place = helix.place();
            (place, Problem::warning("thin-chip", Blame::Line(place.line), message, help))
        })
    }
}
