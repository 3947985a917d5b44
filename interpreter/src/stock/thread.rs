//! A pass of a thread and the stock: what its run-in, its way and its retract go through. In: passes, where
//! the part lies on the machine, mm. Out: warnings.

use gcode::Problem;
use gcode::problem::short;
use protocol::{Axis, ThreadPass};

use super::{Stock, warning};
use crate::frame::Frame;
use crate::thread::Point;

/// Places of a run-in that are looked at, and of what comes behind it.
const LOOKS: u32 = 64;
const WAY_LOOKS: u32 = 512;
/// No groove is deeper than so many leads.
const DEEPEST_LEADS: f64 = 1.3;

impl Stock {
    /// Takes a pass of a thread, of which X 0 and Z 0 of the part lie at `origin` on the machine.
    pub(crate) fn pass(&mut self, pass: &ThreadPass, origin: Point, frame: &Frame) -> Option<Box<Problem>> {
        let law = |axis: Axis| (pass.axis(axis).start.mm(), pass.law(axis));
        let ((x0, x), (z0, z)) = (law(Axis::X), law(Axis::Z));
        let at = |c: f64| Point { x: x0 + x.at(c).s - origin.x, z: z0 + z.at(c).s - origin.z };
        // From where the axis along the thread sets off to where it is on its lead.
        let [begins, locked] = {
            let along = pass.axis(pass.along());
            [along.run_in_c0_deg, along.run_in_c0_deg + along.run_in_dc_deg]
        };
        let inside = places(begins, locked, LOOKS).map(at).find(|point| self.is_inside(*point));
        let end = at(if pass.returns() { pass.thread_end_deg } else { pass.done_deg() });
        let retracts = pass.axes.iter().any(|law| law.retract_mm != 0.0);
        let warning = match inside {
            None if retracts && self.is_inside(end) => Some(warning(
                "retract-in-stock",
                format!("the tool is retracted into the stock, to {}", frame.place(end)),
                "retract it further, or end the thread where the tool has room: in front of a shoulder, in an undercut",
            )),
            Some(at) => Some(warning(
                "run-in-in-stock",
                format!("the tool is in the stock at {} before it is on the helix", frame.place(at)),
                "start further from the part: `pitchlock check` says from which Z on there is full depth",
            )),
            None => self.in_chuck(at(begins), end, frame).or_else(|| self.too_deep(pass, origin, at, frame)),
        };
        self.told(warning)
    }

    /// A pass along Z of which more lies in the stock than any groove is deep.
    fn too_deep(
        &self,
        pass: &ThreadPass,
        origin: Point,
        at: impl Fn(f64) -> Point,
        frame: &Frame,
    ) -> Option<Box<Problem>> {
        if pass.along() != Axis::Z || pass.returns() {
            return None;
        }
        let (outwards, along) = (pass.cuts_outwards(origin.x), pass.axis(Axis::Z));
        let (locked, most_mm) =
            (along.run_in_c0_deg + along.run_in_dc_deg, DEEPEST_LEADS * along.most_lead_mm());
        let mut way = places(locked, pass.done_deg(), WAY_LOOKS).map(at);
        let deep =
            |point: Point| Some((point, self.beside_mm(point, outwards))).filter(|deep| deep.1 > most_mm);
        let (at, beside_mm) = way.find_map(deep)?;
        let beside = short((1e3 * beside_mm / frame.unit()).round() / 1e3);
        let message = format!(
            "the pass goes through the stock at {}: {beside} {} of it stand beside the tool, and no groove is that deep",
            frame.place(at),
            frame.units.name()
        );
        let help = "end the thread in front of the shoulder (of a bore: of its step), or cut the stock down to \
                    the crest before; is the part as it is said to be, and the offset?";
        Some(warning("thread-in-stock", message, help))
    }

    /// How much of the stock is beside the tool of a pass, mm: beyond it from outside, in a bore within it.
    fn beside_mm(&self, point: Point, outwards: Option<bool>) -> f64 {
        let x = point.x.abs();
        let of = |nodes: &[[f64; 2]]| {
            let here = self.node(point.z).and_then(|node| nodes.get(node));
            let Some([bore, outer]) = here.filter(|_| self.is_inside_of(nodes, point)) else { return 0.0 };
            match outwards {
                Some(true) => x - bore,
                Some(false) => outer - x,
                None => (x - bore).min(outer - x),
            }
        };
        self.other.iter().fold(of(&self.nodes), |beside, other| beside.min(of(other)))
    }
}

/// Angles between two, evenly spread.
fn places(from: f64, to: f64, looks: u32) -> impl Iterator<Item = f64> {
    (0..looks).map(move |look| from + (to - from) * f64::from(look) / f64::from(looks))
}
