//! How the tool leaves a pass before its end. In: a cut. Out: which axis lifts, where it is clear and where
//! free, mm.

use machine::Machine;
use protocol::{Position, WayOut};

use super::cut::Cut;
use super::limits::travel;

/// What the tool keeps away from the crest before Z may brake, a share of the depth, and of the way out.
const FREE_SHARE: f64 = 0.05;
/// No groove is deeper than so many leads.
const DEEPEST_LEADS: f64 = 1.3;

/// The way out: to where the retract leads, else to where the approach came from, else to where the program
/// goes next, else off by the lift of the machine file.
pub(super) fn out(cut: &Cut, machine: &Machine) -> WayOut {
    let surface = cut.above_mm() + cut.approach_mm;
    let end = match cut.chain.bends() {
        [] => surface + cut.rise_mm() / cut.lead_mm() * (cut.to_mm - cut.starts_mm()),
        _ => surface + cut.along.across(cut.at(cut.end_deg())[0]),
    };
    // Of a chain each corner is one.
    let corners = cut.chain.bends().iter().map(|bend| surface + cut.along.across(cut.at(bend.c_deg)[0]));
    let reach = corners.fold([surface.min(end), surface.max(end)], |[low, high], corner| {
        [low.min(corner), high.max(corner)]
    });
    let lift = match (cut.retract_mm, cut.approach_mm) {
        (0.0, 0.0) if cut.lift_mm != 0.0 => cut.lift_mm,
        (0.0, 0.0) => machine.threading.lift_mm * cut.outwards,
        (0.0, approach_mm) => -approach_mm,
        (retract_mm, _) => retract_mm,
    };
    let outermost = if lift > 0.0 { reach[1] } else { reach[0] };
    let clear = match (cut.retract_mm, cut.lift_mm) {
        (0.0, 0.0) => outermost + lift,
        _ => end + lift,
    };
    let groove =
        if cut.clear_mm > 0.0 { cut.clear_mm } else { DEEPEST_LEADS * cut.along.of(cut.most_lead()) };
    // A tool that leaves a chain early lifts over what comes before its end.
    let over = outermost + (groove * (1.0 + 2.0 * FREE_SHARE)).copysign(lift);
    let clear = match cut.chain.bends() {
        [] => clear,
        _ if lift > 0.0 => clear.max(over),
        _ => clear.min(over),
    };
    let [low, high] = travel(machine, cut.along.lifts());
    let clear = clear.clamp(low, high);
    let most = (clear - outermost).abs() * (1.0 - FREE_SHARE);
    let free = outermost + (groove * (1.0 + FREE_SHARE)).min(most).copysign(lift);
    WayOut {
        axis: cut.along.lifts().index() as u32,
        leaves: machine.threading.leaves(),
        clear: Position::from_mm(clear),
        free: Position::from_mm(free),
    }
}
