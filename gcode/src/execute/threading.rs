//! Moves that follow the spindle: G33 (thread), G33.1 (rigid tapping), G76 (threading cycle).
//!
//! In: a block and the state; K of G33 and P of G76 in units per revolution, I J K of G76 diameters under G7.
//! Out: the moves of G33 and G33.1 between start and stop of synchronisation, G76 as one [`ThreadCycle`].

use super::{Done, Output, straight, thin};
use crate::block::Block;
use crate::bounds::{MOST_PASSES, MOST_SPRINGS};
use crate::canon::{Call, Degression, Plane, Pose, ThreadCycle, X, Y, Z};
use crate::codes::G;
use crate::problem::{Blame, Problem, short};
use crate::state::State;

/// G33, G33.1 and G76.
pub(super) fn threading(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    straight::some_axis(code, block)?;
    ready(code, state, out)?;
    let target = straight::target(block, state)?;
    state.compensation.straight_made();
    match code.0 {
        330 => thread(target, block, state, out),
        331 => tap(target, block, out),
        _ => cycle(target, block, state, out),
    }
}

/// Whether something may follow the spindle now.
///
/// # Errors
/// The radius of the tool is compensated, or the spindle does not turn.
pub(crate) fn ready(code: G, state: &State, out: &mut Output) -> Done {
    if state.compensation.is_on() {
        let message = format!("{code} while {} is on", state.compensation.code());
        return Err(Problem::error("compensation-on", Blame::G(code), message, "end it with G40 first"));
    }
    if state.spindle.turning.is_none() {
        let message = format!("{code} follows the spindle, which is not turning");
        return Err(Problem::error(
            "spindle-not-turning",
            Blame::G(code),
            message,
            "start it with S and M3 or M4 first",
        ));
    }
    if state.spindle.constant_surface.is_some() {
        let message = format!(
            "{code} under G96: the spindle keeps one speed through it, the surface speed where the thread begins"
        );
        let help = "select G97 and a speed in 1/min before the thread, and all passes have it";
        out.warn(Problem::warning("constant-surface-thread", Blame::G(code), message, help));
    }
    Ok(())
}

/// A value that must be greater than 0.
fn positive(letter: char, what: &str, block: &Block) -> Result<f64, Box<Problem>> {
    match block.get(letter) {
        Some(value) if value > 0.0 => Ok(value),
        Some(value) => {
            let message = format!("{letter}{} cannot be the {what}", short(value));
            Err(Problem::error("bad-value", Blame::Word(letter), message, "give a value greater than 0"))
        }
        None => {
            let message = format!("{letter}, the {what}, is missing");
            Err(Problem::error("missing-word", Blame::Block, message, format!("add {letter}")))
        }
    }
}

/// G33: a straight move, K per revolution along it, beginning at the angle Q of the spindle, degrees.
fn thread(target: Pose, block: &Block, state: &mut State, out: &mut Output) -> Done {
    let lead = positive('K', "distance per revolution", block)?;
    let start_deg = block.get('Q').unwrap_or(0.0);
    if !(0.0..=360.0).contains(&start_deg) {
        let message = format!("Q{} cannot be the angle of the spindle at the start", short(start_deg));
        return Err(Problem::error("bad-value", Blame::Word('Q'), message, "give 0 to 360 degrees"));
    }
    out.call(Call::StartSpeedFeedSynch { lead, velocity: false, start_deg, growth: 0.0 })?;
    out.call(Call::StraightFeed(target))?;
    out.call(Call::StopSpeedFeedSynch)?;
    state.axes.position = target;
    Ok(())
}

/// G33.1: in, and out again with the spindle reversed, I times as fast.
fn tap(target: Pose, block: &Block, out: &mut Output) -> Done {
    let lead = positive('K', "distance per revolution", block)?;
    if let Some(letter) = ['A', 'B', 'C'].into_iter().find(|letter| block.has(*letter)) {
        let message = format!("G33.1 does not turn {letter}");
        return Err(Problem::error(
            "unused-word",
            Blame::Word(letter),
            message,
            "turn the axis in an earlier block",
        ));
    }
    let faster = block.get('I').unwrap_or(1.0);
    if faster < 1.0 {
        let message =
            format!("I{} is less than 1: the way out is never slower than the way in", short(faster));
        out.warn(Problem::warning(
            "no-effect",
            Blame::Word('I'),
            message,
            "leave I out, or give a factor above 1",
        ));
    }
    out.call(Call::StartSpeedFeedSynch { lead, velocity: false, start_deg: 0.0, growth: 0.0 })?;
    out.call(Call::RigidTap(target, faster.max(1.0), 0.0))?;
    out.call(Call::StopSpeedFeedSynch)
}

/// G76.
fn cycle(target: Pose, block: &Block, state: &mut State, out: &mut Output) -> Done {
    let cycle = programmed(target, block, state, out)?;
    out.call(Call::ThreadCycle(&cycle))?;
    state.axes.position[Z] = cycle.end_z;
    Ok(())
}

fn programmed(
    target: Pose,
    block: &Block,
    state: &State,
    out: &mut Output,
) -> Result<ThreadCycle, Box<Problem>> {
    let lead = positive('P', "lead", block)?;
    if state.modes.plane != Plane::Xz {
        let message = "G76 cuts along Z and feeds in along X, and their plane is not in force";
        return Err(Problem::error("not-available", Blame::G(G(760)), message, "select G18 first"));
    }
    let from = state.axes.position;
    for (axis, letter) in [(X, 'X'), (Y, 'Y')] {
        if target[axis] != from[axis] {
            let message =
                format!("{letter} of G76: the thread runs along Z, at the X and Y where the tool stands");
            let help = format!("leave {letter} out; I names the crest, seen from the tool");
            return Err(Problem::error("unused-word", Blame::Word(letter), message, help));
        }
    }
    if target[Z] == from[Z] {
        let message = format!("the thread has no length: it begins and ends at Z{}", short(from[Z]));
        return Err(Problem::error("bad-value", Blame::Word('Z'), message, "give Z of its end"));
    }
    let half = if state.modes.diameter { 0.5 } else { 1.0 };
    let crest = block.get('I').unwrap_or(0.0) * half;
    if crest == 0.0 {
        let message = "I0: the crest of the thread lies on the drive line, so neither side is inside";
        let help = "start away from the thread; I is negative outside, positive inside";
        return Err(Problem::error("bad-value", Blame::Word('I'), message, help));
    }
    let first = positive('J', "depth of the first pass", block)? * half;
    let depth = positive('K', "full depth", block)? * half;
    if depth <= first {
        let message = format!(
            "the first pass, J{}, is as deep as the thread, K{}",
            short(first / half),
            short(depth / half)
        );
        return Err(Problem::error(
            "bad-value",
            Blame::Word('J'),
            message,
            "K is the full depth and greater than J",
        ));
    }
    let (chamfer, [chamfer_in, chamfer_out]) = chamfers(target[Z] - from[Z], block, out)?;
    let exponent = degression(depth / first, block)?;
    let cuts = libm::pow(depth / first, exponent).ceil();
    thin::doubt(("the first pass", Blame::Word('J')), first, cuts, state.units.program(), None, out);
    Ok(ThreadCycle {
        from,
        end_z: target[Z],
        taper_x: 0.0,
        lead,
        crest,
        depth,
        depth_is_told: true,
        degression: Degression { first, exponent, least: 0.0, finish: 0.0 },
        infeed_deg: infeed(block)?,
        springs: springs(block)?,
        chamfer,
        chamfer_in,
        chamfer_out,
        chamfer_yields: false,
        start_deg: 0.0,
    })
}

/// R. `depths` is the full depth in first depths.
fn degression(depths: f64, block: &Block) -> Result<f64, Box<Problem>> {
    let exponent = block.get('R').unwrap_or(1.0);
    let refuse = |message, help: &str| Err(Problem::error("bad-value", Blame::Word('R'), message, help));
    if exponent < 1.0 {
        let message = format!(
            "the degression R{} is less than 1: every pass would be deeper than the last",
            short(exponent)
        );
        return refuse(message, "1 keeps the depth of the passes, 2 the area they cut");
    }
    let passes = libm::pow(depths, exponent);
    if passes > MOST_PASSES {
        let message = format!("this would take more than {MOST_PASSES} passes");
        return refuse(message, "give a greater J, or a smaller R");
    }
    Ok(exponent)
}

/// Q.
fn infeed(block: &Block) -> Result<f64, Box<Problem>> {
    let angle = block.get('Q').unwrap_or(0.0);
    if angle.abs() < 90.0 {
        return Ok(angle);
    }
    let message = format!("the infeed Q{} does not lead into the thread", short(angle));
    Err(Problem::error(
        "bad-value",
        Blame::Word('Q'),
        message,
        "give degrees from straight in: 0, or 29.5 along a flank of 60",
    ))
}

/// H.
fn springs(block: &Block) -> Result<u32, Box<Problem>> {
    let Some(value) = block.get('H') else { return Ok(0) };
    let springs = block.integer('H').filter(|count| (0..=MOST_SPRINGS).contains(count));
    springs.and_then(|count| u32::try_from(count).ok()).ok_or_else(|| {
        let message = format!("H{} cannot be a number of spring passes", short(value));
        Problem::error(
            "bad-value",
            Blame::Word('H'),
            message,
            format!("give a whole number from 0 to {MOST_SPRINGS}"),
        )
    })
}

/// E and L; `way` is that of the thread along Z. Length, at the start, at the end.
fn chamfers(way: f64, block: &Block, out: &mut Output) -> Result<(f64, [bool; 2]), Box<Problem>> {
    let ends = match (block.integer('L'), block.get('L')) {
        (Some(ends @ 0..=3), _) => [ends & 1 != 0, ends & 2 != 0],
        (_, None) => [false; 2],
        (_, Some(value)) => {
            let message = format!("L{} does not name ends of the thread", short(value));
            let help = "0 for no taper, 1 at the start, 2 at the end, 3 at both";
            return Err(Problem::error("bad-value", Blame::Word('L'), message, help));
        }
    };
    let length = block.get('E').unwrap_or(0.0);
    let count = ends.into_iter().filter(|end| *end).count();
    let refuse =
        |message: String, help: &str| Err(Problem::error("bad-value", Blame::Word('E'), message, help));
    if length < 0.0 {
        return refuse(format!("the taper E{} is negative", short(length)), "give its length along Z");
    }
    if length * count as f64 > way.abs() {
        let message =
            format!("{count} taper of E{} is longer than the thread, {}", short(length), short(way.abs()));
        return refuse(message, "give a shorter E");
    }
    let useless = match (length > 0.0, count > 0) {
        (true, false) => {
            Some(('E', "E without L: no end of the thread is tapered", "add L1 (start), L2 (end) or L3"))
        }
        (false, true) => Some(('L', "L without E: the taper has no length", "add E, its length along Z")),
        _ => None,
    };
    if let Some((letter, message, help)) = useless {
        out.warn(Problem::warning("no-effect", Blame::Word(letter), message, help));
    }
    Ok((length, ends))
}
