//! Holes along Z: G81 and G83 drill, in one go or in pecks of Q; G82 and P wait at the bottom; G85 and G89
//! come back at the feed, G86 with the spindle at rest. They are in force until G80 or a code such as G00; X
//! or Z alone makes another hole. G84 taps ([`taps`]).
//!
//! In: `G83 X Z R Q P F K`. R is where the feed begins: a distance from where the tool stands (FANUC) or a Z
//! (Haas). Of the two readings those count that lie between the tool and the bottom, of these the one farther
//! from the bottom: the tool feeds too far at worst. Out: moves.
//!
//! ```text
//! K times:
//! rapid to X · rapid to R · [ feed by Q · rapid to R · rapid to GAP above the bottom ]* · feed to Z · back
//! ```

use super::execution::{Execution, target};
use super::line::Line;
use super::once;
use super::points::doubt_cut;
use super::taps;
use crate::bounds::MOST_PECKS;
use crate::canon::{Call, Units, X, Z};
use crate::codes::G;
use crate::execute::Done;
use crate::problem::{Blame, Problem, short};

/// How far above the bottom the feed begins again after a peck, mm and inch.
const GAP: [f64; 2] = [0.5, 0.02];

/// A cycle in force, program units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drill {
    pub(super) code: G,
    /// Where the tool stood at its beginning.
    level: f64,
    /// Where the feed begins.
    r: f64,
    bottom: f64,
    /// 0: in one go.
    peck: f64,
    dwell_s: f64,
}

/// G81, G82, G83, G84, G85, G86, G89.
///
/// # Errors
/// There is no depth, or words make no sense; what the moves refuse.
pub(super) fn cycle(code: G, run: &mut Execution) -> Done {
    let from = run.state.axes.position;
    let before = run.modal.drill.filter(|drill| drill.code == code);
    if run.line.has('W') {
        let message = format!("{code} takes the bottom as Z: controls count W from different places");
        return Err(Problem::error("not-available", Blame::Word('W'), message, "write Z"));
    }
    let x = target(run.line, from)?[X];
    let drill = drill(code, run.line, from[Z], before)?;
    run.modal.drill = Some(drill);
    let way = drill.bottom - drill.r;
    let pecks = if drill.peck > 0.0 { (way.abs() / drill.peck - 1e-9).ceil().max(1.0) } else { 1.0 };
    if pecks > MOST_PECKS {
        let message = format!("this would take more than {MOST_PECKS} pecks");
        return Err(Problem::error("bad-value", Blame::Word('Q'), message, "give a greater Q"));
    }
    if run.line.has('Q') {
        doubt_cut(("a peck", 'Q', false), drill.peck, pecks, run.line, run.out);
    }
    let often = times(run)?;
    if often > 1.0 && run.line.has('U') {
        let message =
            "a hole that is made several times does not move on by U: holes of a lathe lie on its axis";
        return Err(Problem::error("not-available", Blame::Word('U'), message, "write X"));
    }
    if often * pecks > MOST_PECKS {
        let message = format!("this would take more than {MOST_PECKS} pecks");
        return Err(Problem::error("bad-value", Blame::Word('K'), message, "make the hole less often"));
    }
    let mut made = 0.0;
    while made < often {
        hole(code, &drill, x, run)?;
        made += 1.0;
    }
    Ok(())
}

/// One hole, from where it begins back to there.
fn hole(code: G, drill: &Drill, x: f64, run: &mut Execution) -> Done {
    let inch = usize::from(run.line.units == Some(Units::Inch));
    let (way, gap) = (drill.bottom - drill.r, GAP[inch]);
    let pecks = if drill.peck > 0.0 { (way.abs() / drill.peck - 1e-9).ceil().max(1.0) } else { 1.0 };
    let place = run.line.block.place();
    let (rapid, feed) = (G(0), G(10));
    run.go(rapid, [drill.level, x], None, place)?;
    run.go(rapid, [drill.r, x], None, place)?;
    if code == G(840) {
        taps::lathe(code, [drill.r, drill.bottom, drill.peck, drill.dwell_s], run)?;
        return run.go(rapid, [drill.level, x], None, place);
    }
    let mut n = 1.0;
    while n < pecks {
        let at = drill.r + way.signum() * drill.peck * n;
        run.go(feed, [at, x], None, place)?;
        run.go(rapid, [drill.r, x], None, place)?;
        run.go(rapid, [at - way.signum() * gap.min(drill.peck), x], None, place)?;
        n += 1.0;
    }
    run.go(feed, [drill.bottom, x], None, place)?;
    if drill.dwell_s > 0.0 {
        run.out.call(Call::Dwell(drill.dwell_s))?;
    }
    let turning = run.state.spindle.turning.filter(|_| code == G(860));
    if turning.is_some() {
        run.out.call(Call::StopSpindle)?;
    }
    run.go(if matches!(code, G(850 | 890)) { feed } else { rapid }, [drill.r, x], None, place)?;
    run.go(rapid, [drill.level, x], None, place)?;
    turning.map_or(Ok(()), |turn| run.out.call(Call::StartSpindle(turn)))
}

/// The words of the block, or those in force.
fn drill(code: G, line: &Line, here: f64, before: Option<Drill>) -> Result<Drill, Box<Problem>> {
    let level = before.map_or(here, |drill| drill.level);
    let Some(bottom) = line.length('Z').or(before.map(|drill| drill.bottom)) else {
        if code == G(890) {
            let message = "G89 with X alone bores along X, and there are no driven tools";
            return Err(Problem::error("not-available", Blame::G(code), message, "holes are along Z: add Z"));
        }
        let message = format!("{code} needs Z, the bottom of the hole");
        return Err(Problem::error("missing-word", Blame::G(code), message, "add Z"));
    };
    if bottom == level {
        let message = format!("{code} cuts nothing: the tool stands at the bottom, Z{}", short(bottom));
        return Err(Problem::error("bad-value", Blame::Word('Z'), message, "start above the hole"));
    }
    let r = match (line.length('R'), before) {
        (Some(r), _) => begin_of_feed(r, level, bottom)?,
        (None, Some(drill)) => drill.r,
        (None, None) => level,
    };
    let peck = line.length('Q').or(before.map(|drill| drill.peck)).unwrap_or(0.0);
    if peck < 0.0 || line.has('Q') && !matches!(code, G(830 | 840)) {
        let message = format!("Q{} cannot be the depth of a peck of {code}", short(peck));
        let help = "only G83 and G84 have pecks, and Q is greater than 0";
        return Err(Problem::error("bad-value", Blame::Word('Q'), message, help));
    }
    let dwell_s = once::milliseconds(line)?.or(before.map(|drill| drill.dwell_s)).unwrap_or(0.0);
    Ok(Drill { code, level, r, bottom, peck, dwell_s })
}

/// R, as a Z.
fn begin_of_feed(r: f64, level: f64, bottom: f64) -> Result<f64, Box<Problem>> {
    let (low, high) = (level.min(bottom), level.max(bottom));
    let readings = [r, level + r].into_iter().filter(|z| (low..=high).contains(z));
    readings.max_by(|a, b| (a - bottom).abs().total_cmp(&(b - bottom).abs())).ok_or_else(|| {
        let message = format!(
            "R{} is neither a Z nor a distance between the tool at Z{} and the bottom at Z{}",
            short(r),
            short(level),
            short(bottom)
        );
        let help = "R is where the feed begins: a distance from the tool, such as R-3., or a Z, such as R2.";
        Problem::error("bad-value", Blame::Word('R'), message, help)
    })
}

/// K or L: how often a hole is made; 0 keeps its words.
///
/// # Errors
/// Both are there, or it is no number of holes.
pub(super) fn times(run: &Execution) -> Result<f64, Box<Problem>> {
    let letter = match (run.line.has('K'), run.line.has('L')) {
        (true, true) => {
            let message = "K and L both say how often";
            return Err(Problem::error("repeated-word", Blame::Word('L'), message, "leave one of them out"));
        }
        (true, false) => 'K',
        (false, true) => 'L',
        (false, false) => return Ok(1.0),
    };
    match run.line.whole(letter)? {
        Some(times @ 0..=9999) => Ok(times as f64),
        other => {
            let message = format!("{letter}{} cannot be a number of holes", short(other.unwrap_or(0) as f64));
            Err(Problem::error("bad-value", Blame::Word(letter), message, "give a whole number up to 9999"))
        }
    }
}
