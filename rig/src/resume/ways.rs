//! Where the tool stands on a program that was broken off, and how it gets back from there. In: items of the
//! program, the places before them, the measured places of the axes. Out: moves that lead over nothing but
//! what the tool has been over, or straight out of its groove.
//!
//! | the tool stands | it goes |
//! |---|---|
//! | on the way of a pass, or lifted off it | along the axis that lifts it, to where it is clear; along the thread; then to the start |
//! | on a line, an arc or a curve | back on it, to its begin |
//! | beside a line or an arc, on the way of a later pass | as out of that pass, to where the line leads or the contour begins |
//!
//! A line and an arc are followed backwards exactly, a piece of a curve by lines that lie within a thousandth
//! of what it rises, so what the tool has cut is free for it.

use protocol::{Arc, Axis, Code, Curve, Feed, Item, PerAxis, Position, ThreadPass};
use route::{
    approach::{BACK, Way, places},
    in_force::{LINEAR, apart_mm},
};

/// An axis that was braked stands so far beside its way at most, mm: on a rapid, where axes brake from speeds
/// of their own, and on a feed.
const BESIDE_RAPID_MM: f64 = 6.0;
const BESIDE_FEED_MM: f64 = 0.5;
/// Nearer than this it is on it, mm; and while it is led over what it cuts.
pub(super) const ON_MM: f64 = 0.1;
pub(super) const LED_MM: f64 = 0.02;
/// So many moves are next: what was in hand when the journal was written, and what has come since.
const NEXT: usize = 3;
/// How far an axis goes beyond the box of a pass while it brakes, along the thread and across it, mm.
const BEYOND_MM: [f64; 2] = [8.0, 0.5];
/// So many steps are seen of a part of a law: between them an arc bulges by far less than an axis may be off.
const STEPS: u32 = 8;

/// One item of the program and where the axes are before it.
pub(super) type Step = (Item, PerAxis<Position>);

/// The step on which the tool stands: of the next moves behind `known` the one that it is on, or beside which
/// it may have been braked; else a later one that it is on.
pub(super) fn stands_on(steps: &[Step], known: usize, here: &PerAxis<Position>) -> Option<usize> {
    let moves = || steps.iter().enumerate().skip(known).filter(|(_, step)| moves(&step.0));
    let is_on = |(_, step): &(usize, &Step)| off(step, here).is_some_and(|[mm, _]| mm < ON_MM);
    let beside = || {
        let share = |(index, step): (usize, &Step)| {
            let [mm, most_mm] = off(step, here)?;
            (mm < most_mm).then_some((index, mm / most_mm))
        };
        let nearest = moves().take(NEXT).filter_map(share).min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map(|(index, _)| index)
    };
    let near = moves().take(NEXT).find(is_on).map(|(index, _)| index);
    let later = || moves().skip(NEXT).find(is_on).map(|(index, _)| index);
    // It was on its way back over a contour, and that was broken off as well.
    let before = || (0..known).rev().find(|index| is_on(&(*index, &steps[*index])));
    near.or_else(beside).or_else(later).or_else(before)
}

/// A later pass in whose groove the tool may stand, though it is beside the first of these steps: the journal
/// may be old. Back along that step, or on along it, it would cut across the turns.
pub(super) fn perhaps_in(steps: &[Step], here: &PerAxis<Position>) -> Option<ThreadPass> {
    let (step, later) = steps.split_first()?;
    let led_mm = if matches!(step.0.code, Code::Line { feed: Feed::Rapid, .. }) { ON_MM } else { LED_MM };
    off(step, here).filter(|[mm, _]| *mm > led_mm)?;
    later.iter().find_map(|(item, _)| match item.code {
        Code::Pass(pass) => is_in_box(&pass, here).then_some(pass),
        _ => None,
    })
}

/// Whether an item moves the axes.
pub(super) fn moves(item: &Item) -> bool {
    item.is_move() || matches!(item.code, Code::Pass(_))
}

/// The last of these steps that puts another tool in the place of this one.
pub(super) fn last_change(mut tool: Option<u32>, steps: &[Step]) -> Option<usize> {
    let mut last = None;
    for (at, (item, _)) in steps.iter().enumerate() {
        if let Code::Tool { number } = item.code
            && tool.replace(number) != Some(number)
        {
            last = Some(at);
        }
    }
    last
}

/// Line and tool of the step on which the tool stands, and of another one that leads another tool over the
/// same place.
pub(super) fn in_another(
    mut tool: Option<u32>,
    steps: &[Step],
    last: usize,
    here: &PerAxis<Position>,
) -> Option<[(u32, Option<u32>); 2]> {
    let mut over = Vec::new();
    let mut own = None;
    for (at, step) in steps.iter().enumerate() {
        if let Code::Tool { number } = step.0.code {
            tool = Some(number);
        }
        if at == last {
            own = Some((step.0.line, tool));
        } else if moves(&step.0) && off(step, here).is_some_and(|[mm, most_mm]| mm < most_mm.max(ON_MM)) {
            over.push((step.0.line, tool));
        }
    }
    let own = own?;
    over.into_iter().find(|other| other.1 != own.1).map(|other| [own, other])
}

/// How far a tool that stands here is off a step, and how far it may be if it was braked there, mm.
pub(super) fn off((item, from): &Step, here: &PerAxis<Position>) -> Option<[f64; 2]> {
    match &item.code {
        Code::Line { target, feed: Feed::Rapid } => {
            Some([beside_line_mm(from, target, here), BESIDE_RAPID_MM])
        }
        Code::Line { target, .. } => Some([beside_line_mm(from, target, here), BESIDE_FEED_MM]),
        Code::Arc { arc, .. } => Some([beside_arc_mm(from, arc, here), BESIDE_FEED_MM]),
        Code::Curve { curve, .. } => {
            let (_, mm) = nearest(&places(from, curve), here)?;
            Some([mm, BESIDE_FEED_MM])
        }
        Code::Pass(pass) => is_in_box(pass, here).then_some([0.0, BESIDE_FEED_MM]),
        _ => None,
    }
}

/// The axis that lifts the tool off a pass, and the one along the thread.
fn across_and_along(pass: &ThreadPass) -> [Axis; 2] {
    let across = Axis::ALL[pass.out.axis as usize];
    [across, if across == Axis::X { Axis::Z } else { Axis::X }]
}

/// Whether a tool stands in the hole of a tap, or where it starts.
pub(super) fn is_in_hole(pass: &ThreadPass, here: &PerAxis<Position>) -> bool {
    [Axis::X, Axis::Y, Axis::Z].into_iter().all(|axis| {
        let (law, mm) = (pass.axis(axis), here[axis.index()].mm());
        let start_mm = law.start.mm();
        let turn_mm = start_mm + law.lead_mm * pass.done_deg() / 360.0;
        let ends = [start_mm, start_mm + law.stroke_mm, law.end.mm(), turn_mm];
        let [low, high] = lowest_and_highest(&ends);
        (low - BEYOND_MM[1]..=high + BEYOND_MM[1]).contains(&mm)
    })
}

fn lowest_and_highest(ends: &[f64]) -> [f64; 2] {
    let beyond = |[low, high]: [f64; 2], end: &f64| [low.min(*end), high.max(*end)];
    ends.iter().fold([f64::INFINITY, f64::NEG_INFINITY], beyond)
}

/// Whether a tool stands where a pass leads it: between the way that it cuts, every section of it, and where
/// it is lifted to, as far along as it may have gone while it braked.
fn is_in_box(pass: &ThreadPass, here: &PerAxis<Position>) -> bool {
    if pass.returns() {
        return is_in_hole(pass, here);
    }
    let [across, along] = across_and_along(pass);
    let [across_mm, along_mm] = [across, along].map(|axis| here[axis.index()].mm());
    let near = |ends: &[[f64; 2]]| {
        let [low, high] = lowest_and_highest(&[ends[0][1], ends[1][1]]);
        (low - BEYOND_MM[0]..=high + BEYOND_MM[0]).contains(&along_mm)
    };
    let way = way_of(pass, [across, along]);
    let mut ends: Vec<f64> =
        way.windows(2).filter(|ends| near(ends)).flatten().map(|place| place[0]).collect();
    if ends.is_empty() {
        return false;
    }
    let law = pass.axis(across);
    ends.extend([law.start.mm(), law.end.mm(), pass.out.clear.mm()]);
    let [low, high] = lowest_and_highest(&ends);
    (low - BEYOND_MM[1]..=high + BEYOND_MM[1]).contains(&across_mm)
}

/// Places of two axes on the way of a pass, mm: where a part of their laws begins or ends, and between.
fn way_of(pass: &ThreadPass, axes: [Axis; 2]) -> Vec<[f64; 2]> {
    let windows = axes.iter().flat_map(|axis| {
        let law = pass.axis(*axis);
        let unloads_deg = law.stroke_c0_deg + law.stroke_dc_deg - law.unload_dc_deg;
        [
            [law.stroke_c0_deg, law.stroke_dc_deg],
            [unloads_deg, law.unload_dc_deg],
            [law.run_in_c0_deg, law.run_in_dc_deg],
            [law.brake_c_deg, law.brake_dc_deg],
            [law.retract_c_deg, law.retract_dc_deg],
        ]
    });
    let corners = pass.corners().map(|corner| [corner.c_deg, corner.dc_deg]);
    let mut parts: Vec<f64> = windows.chain(corners).flat_map(|[c, dc]| [c, c + dc]).collect();
    parts.sort_by(f64::total_cmp);
    parts.dedup();
    let laws = axes.map(|axis| (pass.axis(axis).start.mm(), pass.law(axis)));
    let between = |part: &[f64]| {
        let [from, to] = [part[0], part[1]];
        (0..=STEPS).map(move |step| from + (to - from) * f64::from(step) / f64::from(STEPS))
    };
    let place = |c_deg: f64| laws.each_ref().map(|(start_mm, law)| start_mm + law.at(c_deg).s);
    parts.windows(2).flat_map(between).map(place).collect()
}

/// How far a place lies beside a straight way, mm.
fn beside_line_mm(from: &PerAxis<Position>, to: &PerAxis<Position>, here: &PerAxis<Position>) -> f64 {
    let seen = |place: &PerAxis<Position>| LINEAR.map(|axis| place[axis.index()].mm_from(from[axis.index()]));
    let (along, place) = (seen(to), seen(here));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(along, along);
    let share = if length > 0.0 { (dot(place, along) / length).clamp(0.0, 1.0) } else { 0.0 };
    let off: [f64; 3] = std::array::from_fn(|i| place[i] - share * along[i]);
    dot(off, off).sqrt()
}

/// How far a place lies beside an arc or a helix: as far as its distance from the centre and its height over
/// the plane, where it is within it; else as far as from its ends, mm.
fn beside_arc_mm(from: &PerAxis<Position>, arc: &Arc, here: &PerAxis<Position>) -> f64 {
    let plane = arc.plane.axes();
    let [first, second] = plane;
    let Some(rise) = LINEAR.into_iter().find(|axis| !plane.contains(axis)) else { return f64::INFINITY };
    let seen = |place: &PerAxis<Position>| {
        let a = place[first.index()].mm_from(arc.center[0]);
        let b = place[second.index()].mm_from(arc.center[1]);
        (libm::hypot(a, b), libm::atan2(b, a), place[rise.index()].mm_from(from[rise.index()]))
    };
    let ((radius, start, _), (_, stop, to), (away, angle, high)) =
        (seen(from), seen(&arc.target), seen(here));
    let sign = f64::from(arc.turns.signum());
    let turned = |to: f64| (sign * (to - start)).rem_euclid(core::f64::consts::TAU);
    let between = |axis: Axis| arc.target[axis.index()].mm_from(from[axis.index()]);
    let whole = libm::hypot(between(first), between(second)) < 1e-6;
    let more = core::f64::consts::TAU * f64::from(arc.turns.unsigned_abs() - 1);
    let sweep = more + if whole { core::f64::consts::TAU } else { turned(stop) };
    let ends = apart_mm(from, here).min(apart_mm(&arc.target, here));
    let each =
        (0..arc.turns.unsigned_abs()).map(|turn| turned(angle) + core::f64::consts::TAU * f64::from(turn));
    let beside = |at: f64| libm::hypot(away - radius, high - to * at / sweep);
    each.filter(|at| *at <= sweep).map(beside).fold(ends, f64::min)
}

/// The one of the lines between places that is nearest, and how far it is, mm.
fn nearest(places: &[PerAxis<Position>], here: &PerAxis<Position>) -> Option<(usize, f64)> {
    let beside = places.windows(2).map(|pair| beside_line_mm(&pair[0], &pair[1], here)).enumerate();
    beside.min_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// Back along a piece of a curve to where it begins.
fn back_along(way: &mut Way, curve: &Curve, from: &PerAxis<Position>) {
    let places = places(from, curve);
    if let Some((line, _)) = nearest(&places, &way.at) {
        places[..=line].iter().rev().for_each(|place| way.go(*place, BACK));
    }
    way.go(*from, BACK);
}

/// The moves from where the tool stands on the last of these steps to where it was before the first.
pub(super) fn way_back(steps: &[Step], here: &PerAxis<Position>) -> Vec<Item> {
    let mut way = Way { items: Vec::new(), at: *here, line: 0 };
    for (item, from) in steps.iter().rev() {
        way.line = item.line;
        match &item.code {
            Code::Pass(pass) => way.out_of(pass, pass.axes.map(|law| law.start)),
            Code::Line { feed: Feed::Rapid, .. } => way.go(*from, Feed::Rapid),
            Code::Line { .. } => way.go(*from, BACK),
            Code::Arc { arc, .. } => way.back_on(arc, from),
            Code::Curve { curve, .. } => back_along(&mut way, curve, from),
            _ => {}
        }
    }
    way.items
}

/// The moves of a line of the program that lift a tool straight out of the groove of a pass and lead it to a
/// place.
pub(super) fn way_out(
    pass: &ThreadPass,
    line: u32,
    here: &PerAxis<Position>,
    to: PerAxis<Position>,
) -> Vec<Item> {
    let mut way = Way { items: Vec::new(), at: *here, line };
    way.out_of(pass, to);
    way.items
}
