//! Where along Z a thread is judged. In: its passes as they are planned, mm of the machine. Out: lengths,
//! mm of the program.

use protocol::{Axis, ThreadPass};

use crate::observe::{
    helix::Helix,
    planned::{Planned, Stock},
};

/// A pass is as long as the longest one from this share of its length on: passes that follow a flank begin
/// and end apart by their infeed.
const AS_LONG: f64 = 0.9;

/// Where a thread is judged: what all passes that are about as long as the longest have in common. A shorter
/// one is part of the same thread if it lies within, but what is cut beyond its end is judged as well.
pub(super) fn judged_mm(lengths_mm: &[[f64; 2]]) -> [f64; 2] {
    let longest = lengths_mm.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
    let is_long = |[low, high]: &&[f64; 2]| high - low >= AS_LONG * longest;
    let none = [f64::NEG_INFINITY, f64::INFINITY];
    let both = |[from, to]: [f64; 2], [low, high]: &[f64; 2]| [from.max(*low), to.min(*high)];
    let common = lengths_mm.iter().filter(is_long).fold(none, both);
    let meets = |length: &[f64; 2]| {
        let [low, high] = both(common, length);
        low < high
    };
    if lengths_mm.iter().all(meets) { common } else { [0.0; 2] }
}

/// The longer of two lengths.
pub(super) fn longer_mm(one: Option<[f64; 2]>, other: [f64; 2]) -> Option<[f64; 2]> {
    let mm = |[low, high]: [f64; 2]| high - low;
    one.filter(|one| mm(*one) >= mm(other)).or(Some(other))
}

/// Where a pass is at full depth on one lead in the stock, along Z of the program: on its first, or on the
/// first behind `from_mm` of the machine and from there on. Stock that the machine file tells of does not
/// move with another tool: it lies where the first pass sees it. Along the last `chamfer_mm` of a tap its
/// teeth are not whole. `None` of a pass that ends before that place, as those of a blunt start: it cuts none
/// of the thread.
pub(super) fn full_mm(
    planned: &Planned,
    from_mm: Option<f64>,
    [origin_mm, first_origin_mm]: [f64; 2],
    chamfer_mm: f64,
) -> Option<[f64; 2]> {
    let helix = Helix::of(&planned.pass, Axis::Z);
    let [from_deg, to_deg] = on_one_lead_deg(&planned.pass, &helix, from_mm)?;
    let at = |deg: f64| helix.at_mm(deg) - origin_mm;
    let [a, b] = [at(from_deg), at(to_deg)];
    let way = planned.pass.lead_mm.signum();
    let a = from_mm.map_or(a, |from| way * (way * a).max(way * (from - origin_mm)).min(way * b));
    let b = b + chamfer_mm.min((b - a).abs()) * (a - b).signum();
    let [low, high] = match &planned.stock {
        Stock::Ends(ends) => ends.map(|end| end - first_origin_mm),
        Stock::Below(zero) => [f64::NEG_INFINITY, zero - origin_mm],
        Stock::Part(part, _) => part.ends_mm(),
    };
    Some([a.min(b).max(low), a.max(b).min(high)])
}

/// Where a pass is on one lead, degrees: up to its first corner, or between those behind a place. What
/// follows a corner is another thread.
fn on_one_lead_deg(pass: &ThreadPass, helix: &Helix, from_mm: Option<f64>) -> Option<[f64; 2]> {
    let locked_deg = pass.axes.iter().map(protocol::AxisLaw::locked_deg).fold(0.0, f64::max);
    let end_deg = pass.thread_end_deg.max(locked_deg);
    let begins = pass.corners().map(|corner| corner.c_deg + corner.dc_deg);
    let ends = pass.corners().map(|corner| corner.c_deg).chain([end_deg]);
    let mut leads = std::iter::once(locked_deg).chain(begins).zip(ends);
    let way = pass.lead_mm.signum();
    let is_behind = |end_deg: f64| from_mm.is_none_or(|from| way * (helix.at_mm(end_deg) - from) > 0.0);
    let (from, to) = leads.find(|(_, end)| is_behind(*end))?;
    let [from, to] = [from, to].map(|deg| deg.clamp(locked_deg, end_deg));
    Some([from, to.max(from)])
}
