//! The first of the two lines of G71, G72 and G73: depth of cut and retract, or the way and the number of
//! passes. In: its words. Out: what the second line cuts by.

use super::line::Line;
use super::modal::Modal;
use super::points::doubt_cut;
use crate::codes::G;
use crate::execute::{Done, Output};
use crate::problem::{Blame, Problem, short};

/// `G71 U R`, `G72 W R`, `G73 U W R`.
pub(super) fn take(code: G, line: &Line, modal: &mut Modal, out: &mut Output) -> Done {
    let bad = |letter, message: String, help: &str| {
        Err(Problem::error("bad-value", Blame::Word(letter), message, help))
    };
    if code == G(730) {
        let passes = line.plain('R').unwrap_or(0.0);
        if passes.fract() != 0.0 || !(1.0..=1000.0).contains(&passes) {
            return bad(
                'R',
                format!("R{} cannot be a number of passes", short(passes)),
                "give a whole number from 1 to 1000",
            );
        }
        let way = |letter| line.length(letter).unwrap_or(0.0);
        let (x, z) = (way('U'), way('W'));
        let letter = if x.abs() < z.abs() { 'W' } else { 'U' };
        let cut = x.abs().max(z.abs()) / (passes - 1.0).max(1.0);
        doubt_cut(("a pass", letter, false), cut, passes, line, out);
        modal.first.pattern = Some((x, z, passes as u32));
        return Ok(());
    }
    let facing = code == G(720);
    let (letter, other) = if facing { ('W', 'U') } else { ('U', 'W') };
    if line.has(other) {
        let message = format!("the first line of {code} does not use {other}");
        return Err(Problem::error(
            "unused-word",
            Blame::Word(other),
            message,
            format!("{letter} is the depth of cut"),
        ));
    }
    let slot = &mut modal.first.rough[usize::from(facing)];
    let (depth, retract) = slot.unwrap_or((0.0, 0.0));
    let (depth, retract) = (line.length(letter).unwrap_or(depth), line.length('R').unwrap_or(retract));
    if depth <= 0.0 {
        return bad(
            letter,
            format!("the depth of cut is {}", short(depth)),
            "give a radius greater than 0, such as 2.",
        );
    }
    if retract < 0.0 {
        return bad('R', format!("the retract is {}", short(retract)), "give 0 or more, such as R0.5");
    }
    doubt_cut(("the depth of cut", letter, false), depth, 0.0, line, out);
    *slot = Some((depth, retract));
    Ok(())
}

/// Whether G71, G72 or G73 may cut now; `missing`: its first line was not written.
pub(super) fn can_rough(code: G, cycle: &Line, missing: bool) -> Done {
    if missing {
        let message = format!("the first line of {code} is missing");
        let help = match code.0 {
            710 => "write it first: G71 U2. R0.5 (depth of cut, retract)",
            720 => "write it first: G72 W2. R0.5 (depth of cut, retract)",
            _ => "write it first: G73 U8. W2. R4 (way in X and Z, number of passes)",
        };
        return Err(Problem::error("missing-word", Blame::G(code), message, help));
    }
    if cycle.has('R') {
        let message = format!("R belongs to the first line of {code}");
        return Err(Problem::error("unused-word", Blame::Word('R'), message, "leave it out here"));
    }
    Ok(())
}
