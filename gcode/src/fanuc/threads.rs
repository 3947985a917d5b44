//! Threads: G32 (one move), G34 (the same with a lead that grows), G35 and G36 (along an arc), G76 in two
//! lines or one, the thread of G92.
//!
//! In: words of the block; F is the lead along the axis with the longer way. Out: moves that follow the
//! spindle, or a [`ThreadCycle`].
//!
//! ```text
//! G32   lead along the way = F √(ΔX² + ΔZ²) / max(|ΔX|, |ΔZ|)                                    (1)
//! G34   the same of F, the lead where it begins, and of K, by how much it grows in a turn
//! G35   G36: F the lead along Z; X Z I K R as of G02 and G03
//! G76   P(m)(r)(a) Q(least cut) R(finishing allowance)
//!       X Z R(i) P(k) Q(Δd) F         depth of pass n = Δd √n, no cut less than Q,
//!                                     R left for m finishing passes                            (2)
//!       infeed along the flank: a/2; chamfer r/10 leads long at the end
//!       X Z I(i) K(k) D(Δd) A(a) F P Q       one line: P1 area, one edge; P3 depth, one edge
//! i     X at the start less X at the end, radii; k height, radius; Q of the one line start angle, 0.001°
//! ```
//! G92 pulls out over as long a chamfer as G76 was last told, one lead if it never was. Where X cannot
//! follow a chamfer it leaves as steeply as it can.

use super::block;
use super::execution::{Execution, target};
use super::line::Line;
use super::modal::{Modal, ThreadFirst};
use super::points::doubt_cut;
use crate::bounds::MOST_PASSES;
use crate::canon::{Call, Degression, Pose, ThreadCycle, X, Z};
use crate::codes::{G, group};
use crate::execute;
use crate::execute::Done;
use crate::problem::{Blame, Problem, short};

/// Angles of the tool that P of G76 may name, degrees.
const ANGLES: [i64; 6] = [0, 29, 30, 55, 60, 80];

/// What is the same for all cycles.
struct Shape {
    /// G76 or G92.
    code: G,
    end: Pose,
    /// i.
    taper: f64,
    lead: f64,
    /// Length of the chamfer.
    chamfer: f64,
    start_deg: f64,
}

/// How a thread is cut to its height.
struct Depths {
    height: f64,
    degression: Degression,
    infeed_deg: f64,
    springs: u32,
}

/// G32, G34.
pub(super) fn single_move(code: G, run: &mut Execution) -> Done {
    let end = target(run.line, run.state.axes.position)?;
    let lead = lead(run.modal)?;
    let start_deg = start_angle(run.line)?;
    let growth = if code == G(340) { growth(run)? } else { 0.0 };
    execute::threading::ready(code, run.state, run.out)?;
    let (dx, dz) = ((end[X] - run.state.axes.position[X]).abs(), (end[Z] - run.state.axes.position[Z]).abs());
    if dx.max(dz) == 0.0 {
        let message = "the thread has no length";
        return Err(Problem::error("bad-value", Blame::G(code), message, "give X or Z of its end"));
    }
    let stretch = libm::hypot(dx, dz) / dx.max(dz);
    let (lead, growth) = (lead * stretch, growth * stretch);
    run.out.call(Call::StartSpeedFeedSynch { lead, velocity: false, start_deg, growth })?;
    run.out.call(Call::StraightFeed(end))?;
    run.out.call(Call::StopSpeedFeedSynch)?;
    run.state.axes.position = end;
    Ok(())
}

/// G35, G36: along an arc, clockwise and counterclockwise.
pub(super) fn along_arc(code: G, run: &mut Execution) -> Done {
    if code == G(360) && !run.line.has_any("IKR") {
        let message = "G36 without I, K or R measures a tool on most controls, and nothing is measured here";
        let help =
            "measure the tool first and write the value; a thread along an arc has its centre or radius";
        return Err(Problem::error("not-available", Blame::G(code), message, help));
    }
    let end = target(run.line, run.state.axes.position)?;
    let lead = lead(run.modal)?;
    let start_deg = start_angle(run.line)?;
    execute::threading::ready(code, run.state, run.out)?;
    run.begin();
    run.add_g(group::MOTION, code)?;
    run.add_point(&end)?;
    block::round(run)?;
    let arc = execute::arc::programmed(code, run.equivalent, run.state, run.out)?;
    run.out.call(Call::StartSpeedFeedSynch { lead, velocity: false, start_deg, growth: 0.0 })?;
    run.out.call(Call::ArcFeed(arc))?;
    run.out.call(Call::StopSpeedFeedSynch)?;
    run.state.axes.position = end;
    Ok(())
}

/// G76: its first line, its second, or the one that says it all.
pub(super) fn cycle(run: &mut Execution) -> Done {
    if !run.line.has_any("XZUW") {
        if let Some(letter) = ['I', 'K', 'D', 'A'].into_iter().find(|letter| run.line.has(*letter)) {
            let help = "X and Z name the end of the thread";
            return Err(Problem::error("missing-word", Blame::Word(letter), "G76 without X and Z", help));
        }
        run.modal.first.thread = Some(first_line(run.line, run.modal.first.thread)?);
        return Ok(());
    }
    for (absolute, incremental) in [('X', 'U'), ('Z', 'W')] {
        if !run.line.has(absolute) && !run.line.has(incremental) {
            let message = format!("G76 needs {absolute} of the end of the thread");
            let help = format!("add {absolute} or {incremental}");
            return Err(Problem::error("missing-word", Blame::G(G(760)), message, help));
        }
    }
    let end = target(run.line, run.state.axes.position)?;
    let lead = lead(run.modal)?;
    if run.line.has_any("KDAI") {
        return one_line(end, lead, run);
    }
    let Some(first) = run.modal.first.thread else {
        let message = "the first line of G76 is missing";
        let help =
            "write it first: G76 P021060 Q100 R0.05 (finishing passes, chamfer, angle; least cut; finish)";
        return Err(Problem::error("missing-word", Blame::G(G(760)), message, help));
    };
    let height =
        needed(run.line.increments('P')?, 'P', "the height of the thread, in steps of 0.001 mm", "P900")?;
    let depth =
        needed(run.line.increments('Q')?, 'Q', "the depth of the first pass, in steps of 0.001 mm", "Q250")?;
    let taper = run.line.length('R').unwrap_or(0.0);
    let shape =
        Shape { code: G(760), end, taper, lead, chamfer: first.chamfer * lead / 10.0, start_deg: 0.0 };
    if first.finish >= height {
        let message =
            format!("the finishing allowance {} is all of the height {}", short(first.finish), short(height));
        return Err(Problem::error(
            "bad-value",
            Blame::Word('P'),
            message,
            "make R of the first line smaller",
        ));
    }
    let degression = Degression { first: depth, exponent: 2.0, least: first.least, finish: first.finish };
    // With an allowance the first finishing pass takes it off; without one, all of them come on top.
    let springs = first.finishing - u32::from(first.finish > 0.0);
    send(&shape, Depths { height, degression, infeed_deg: first.angle / 2.0, springs }, run)
}

fn needed(value: Option<f64>, letter: char, what: &str, example: &str) -> Result<f64, Box<Problem>> {
    match value {
        Some(value) if value > 0.0 => Ok(value),
        Some(value) => {
            let message = format!("{} cannot be {what}", short(value));
            Err(Problem::error("bad-value", Blame::Word(letter), message, format!("such as {example}")))
        }
        None => {
            let message = format!("G76 needs {letter}, {what}");
            Err(Problem::error(
                "missing-word",
                Blame::G(G(760)),
                message,
                format!("add it, such as {example}"),
            ))
        }
    }
}

fn first_line(line: &Line, before: Option<ThreadFirst>) -> Result<ThreadFirst, Box<Problem>> {
    let mut first =
        before.unwrap_or(ThreadFirst { finishing: 1, chamfer: 10.0, angle: 60.0, least: 0.0, finish: 0.0 });
    if let Some(word) = line.whole('P')? {
        let (m, r, a) = (word / 10_000, word / 100 % 100, word % 100);
        if !(1..=99).contains(&m) || !ANGLES.contains(&a) {
            let message = format!(
                "P{word:06} means {m} finishing passes, a chamfer of {r} tenths, a tool of {a} degrees"
            );
            let help =
                "P has two digits for each: passes 01 to 99, chamfer 00 to 99, angle 80 60 55 30 29 or 00";
            return Err(Problem::error("bad-value", Blame::Word('P'), message, help));
        }
        (first.finishing, first.chamfer, first.angle) = (m as u32, r as f64, a as f64);
    }
    first.least = line.increments('Q')?.unwrap_or(first.least);
    first.finish = line.length('R').unwrap_or(first.finish);
    for (letter, value) in [('Q', first.least), ('R', first.finish)] {
        if value < 0.0 {
            let message = format!("{letter} is {}", short(value));
            return Err(Problem::error("bad-value", Blame::Word(letter), message, "give 0 or more"));
        }
    }
    Ok(first)
}

/// `G76 X Z I K D A F P Q`.
fn one_line(end: Pose, lead: f64, run: &mut Execution) -> Done {
    if run.line.has('R') {
        let help = "I is the taper when all of G76 stands in one line";
        return Err(Problem::error("unused-word", Blame::Word('R'), "G76 in one line does not use R", help));
    }
    let height = needed(run.line.length('K'), 'K', "the height of the thread", "K0.9")?;
    let depth = needed(run.line.length('D'), 'D', "the depth of the first pass", "D250")?;
    let exponent = match run.line.whole('P')?.unwrap_or(1) {
        1 => 2.0,
        3 => 1.0,
        other => {
            let (code, what) = if matches!(other, 2 | 4) {
                ("not-available", "cuts on both edges")
            } else {
                ("bad-value", "is not a way to cut")
            };
            let message = format!("P{other} {what}");
            return Err(Problem::error(
                code,
                Blame::Word('P'),
                message,
                "P1 keeps the area of the cuts, P3 their depth",
            ));
        }
    };
    let angle = run.line.plain('A').unwrap_or(0.0);
    if !(0.0..=120.0).contains(&angle) {
        let message = format!("A{} cannot be the angle of a tool", short(angle));
        return Err(Problem::error("bad-value", Blame::Word('A'), message, "give 0 to 120 degrees"));
    }
    let taper = run.line.length('I').unwrap_or(0.0);
    let shape = Shape { code: G(760), end, taper, lead, chamfer: 0.0, start_deg: start_angle(run.line)? };
    let degression = Degression { first: depth, exponent, least: 0.0, finish: 0.0 };
    send(&shape, Depths { height, degression, infeed_deg: angle / 2.0, springs: 0 }, run)
}

/// G92: one pass with the words that are in force.
pub(super) fn box_cycle(end: Pose, taper: f64, run: &mut Execution) -> Done {
    let start_deg = start_angle(run.line)?;
    let lead = lead(run.modal)?;
    let tenths = run.modal.first.thread.map_or(10.0, |first| first.chamfer);
    let way = (end[Z] - run.state.axes.position[Z]).abs();
    let chamfer = (tenths * lead / 10.0).min(way);
    let depth = (end[X] + taper - run.state.axes.position[X]).abs();
    // The pull-out rises at 45 degrees, but by no more than half of the way run.out.
    let height = if chamfer > 0.0 { chamfer.min(depth / 2.0) } else { depth / 2.0 };
    let shape = Shape { code: G(920), end, taper, lead, chamfer, start_deg };
    let degression = Degression { first: height, exponent: 1.0, least: 0.0, finish: 0.0 };
    send(&shape, Depths { height, degression, infeed_deg: 0.0, springs: 0 }, run)
}

fn send(shape: &Shape, depths: Depths, run: &mut Execution) -> Done {
    let Depths { height, degression, infeed_deg, springs } = depths;
    let from = run.state.axes.position;
    execute::threading::ready(shape.code, run.state, run.out)?;
    let wrong = |letter, message: String, help: &str| {
        Err(Problem::error("bad-value", Blame::Word(letter), message, help))
    };
    let infeed = shape.end[X] + shape.taper - from[X];
    let way = (shape.end[Z] - from[Z]).abs();
    if way == 0.0 {
        return wrong(
            'Z',
            format!("the thread has no length: it begins and ends at Z{}", short(from[Z])),
            "give Z of its end",
        );
    }
    // The difference of two decimals is also a decimal.
    let crest = ((infeed.abs() - height) * 1e9).round() / 1e9;
    if crest <= 0.0 {
        let message = format!(
            "the tool starts at X{}, inside of the crest at X{}",
            short(2.0 * from[X]),
            short(2.0 * (shape.end[X] + shape.taper - height.copysign(infeed)))
        );
        return wrong('X', message, "start farther from the thread");
    }
    if degression.first > height {
        let message = format!(
            "the first pass, {}, is deeper than the thread, {}",
            short(degression.first),
            short(height)
        );
        return wrong('Q', message, "make it smaller");
    }
    let (letter, counts) = if run.line.has('D') { ('D', false) } else { ('Q', true) };
    let cuts = libm::pow(height / degression.first, degression.exponent).ceil();
    if shape.code == G(760) {
        doubt_cut(("the first pass", letter, counts), degression.first, cuts, run.line, run.out);
    }
    if cuts > MOST_PASSES {
        return wrong(
            letter,
            format!("this would take more than {MOST_PASSES} passes"),
            "give a deeper first pass",
        );
    }
    if shape.chamfer > way {
        let message =
            format!("the chamfer, {}, is longer than the thread, {}", short(shape.chamfer), short(way));
        return wrong('Z', message, "give a shorter chamfer in the first line of G76, digits 3 and 4 of P");
    }
    run.out.call(Call::ThreadCycle(&ThreadCycle {
        from,
        end_z: shape.end[Z],
        taper_x: 0.0 - shape.taper,
        lead: shape.lead,
        crest: crest.copysign(infeed),
        depth: height,
        depth_is_told: shape.code != G(920),
        degression,
        infeed_deg,
        springs,
        chamfer: shape.chamfer,
        chamfer_in: false,
        chamfer_out: shape.chamfer > 0.0,
        chamfer_yields: shape.chamfer > 0.0,
        start_deg: shape.start_deg,
    }))?;
    run.out.call(Call::StraightTraverse(from))
}

/// F, or that of the thread before.
fn lead(modal: &Modal) -> Result<f64, Box<Problem>> {
    match modal.lead {
        Some(lead) if lead > 0.0 => Ok(lead),
        Some(lead) => {
            let message = format!("F{} cannot be a lead", short(lead));
            Err(Problem::error("bad-value", Blame::Word('F'), message, "give the lead, greater than 0"))
        }
        None => {
            Err(Problem::error("missing-word", Blame::Block, "the thread has no lead", "add F, such as F1.5"))
        }
    }
}

/// K of G34. A lead that was reached is not taken over: each block says with which one it begins.
fn growth(run: &Execution) -> Result<f64, Box<Problem>> {
    for (letter, what, such) in
        [('F', "the lead where it begins", "F2."), ('K', "by how much the lead grows in a turn", "K0.1")]
    {
        if run.line.plain(letter).is_none() {
            let message = format!("G34 needs {letter}, {what}");
            let help = format!("add {letter}, such as {such}, in this block");
            return Err(Problem::error("missing-word", Blame::G(G(340)), message, help));
        }
    }
    Ok(run.line.plain('K').unwrap_or(0.0))
}

/// Q: thousandths of a degree.
fn start_angle(line: &Line) -> Result<f64, Box<Problem>> {
    let angle = line.whole('Q')?.unwrap_or(0);
    if (0..=360_000).contains(&angle) {
        return Ok(angle as f64 / 1000.0);
    }
    let message = format!("Q{angle} is not an angle of the spindle");
    Err(Problem::error("bad-value", Blame::Word('Q'), message, "give 0 to 360000, thousandths of a degree"))
}
