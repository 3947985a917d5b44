//! Codes that act in their own block only: G04 G10 G28 G30 G50 G52 G53.
//!
//! In: a line. Out: the words of the equivalent block.

use super::execution::{Execution, target};
use super::line::Line;
use crate::block::letter_bit;
use crate::codes::{G, group};
use crate::execute::Done;
use crate::problem::{Blame, Problem, short};

/// Codes that act in their own block only.
pub(super) fn once(code: G, run: &mut Execution) -> Done {
    let span = run.span_of(Blame::G(code));
    let end = target(run.line, run.state.axes.position)?;
    match code.0 {
        40 => {
            run.equivalent.add_g(group::ONCE, G(40), span)?;
            return run.equivalent.add('P', dwell(run.line)?, span);
        }
        100 => return origin(run),
        500 => {
            run.modal.preset = true;
            run.equivalent.add_g(group::ONCE, G(920), span)?;
        }
        520 if run.modal.preset => {
            let message = "G52 after G50 X Z: one shift would replace the other";
            return Err(Problem::error(
                "not-available",
                Blame::G(code),
                message,
                "use G54 to G59, or G50 alone",
            ));
        }
        520 | 530 if run.line.has_any("UW") => {
            let message = format!("{code} takes X and Z as they are, not U or W");
            return Err(Problem::error("unused-word", Blame::G(code), message, "use X and Z"));
        }
        300 if run.line.whole('P')?.is_some_and(|p| p != 2) => {
            let message = "there are two reference points: G28, and G30 or G30 P2";
            return Err(Problem::error("not-available", Blame::Word('P'), message, "leave P out"));
        }
        530 => {
            run.equivalent.add_g(group::MOTION, G(0), span)?;
            run.equivalent.add_g(group::ONCE, code, span)?;
        }
        _ => run.equivalent.add_g(group::ONCE, code, span)?,
    }
    if code == G(520) {
        for (letter, value) in [('X', run.line.length('X')), ('Z', run.line.length('Z'))] {
            if let Some(value) = value {
                run.equivalent.add(letter, value, span)?;
            }
        }
        return Ok(());
    }
    if run.line.plain('V').is_some_and(|way| way != 0.0) {
        let help = "leave it out, or write V0, as in G28 U0. V0. W0.";
        return Err(Problem::error("not-available", Blame::Word('V'), "V moves nothing on this lathe", help));
    }
    // G28 and G30 alone send both axes home from where they are.
    if !run.line.has_any("XZUW") && !matches!(code, G(280 | 300)) {
        let message = format!("{code} needs the axes that it is for");
        return Err(Problem::error(
            "missing-word",
            Blame::G(code),
            message,
            "add X, Z, U or W, such as U0 W0",
        ));
    }
    run.add_point(&end)
}

/// G04: seconds. P counts milliseconds.
pub(super) fn dwell(line: &Line) -> Result<f64, Box<Problem>> {
    let given: Vec<char> = ['X', 'U', 'P'].into_iter().filter(|letter| line.has(*letter)).collect();
    let [letter] = given.as_slice() else {
        let message = "G04 needs one time";
        return Err(Problem::error(
            "missing-word",
            Blame::G(G(40)),
            message,
            "write X or U in s, or P in ms (P1.5, with a point, in s)",
        ));
    };
    let seconds = match letter {
        'P' => milliseconds(line)?.unwrap_or(0.0),
        // Without a decimal point these are milliseconds in any units.
        _ if line.is_bare(*letter) => line.plain(*letter).unwrap_or(0.0) / 1000.0,
        _ => line.plain(*letter).unwrap_or(0.0),
    };
    if seconds < 0.0 {
        let message = format!("a dwell of {} s", short(seconds));
        return Err(Problem::error("bad-value", Blame::Word(*letter), message, "give a time of 0 or more"));
    }
    Ok(seconds)
}

/// P, a time in s: it counts milliseconds. With a point it is s, as Haas has it; no other control has one.
///
/// # Errors
/// It is too large.
pub(super) fn milliseconds(line: &Line) -> Result<Option<f64>, Box<Problem>> {
    if line.pointed() & letter_bit('P') != 0 {
        return Ok(line.plain('P'));
    }
    Ok(line.whole('P')?.map(|milliseconds| milliseconds as f64 / 1000.0))
}

/// G10 L2 P X Z.
fn origin(run: &mut Execution) -> Done {
    let (Some(2), Some(system @ 1..=6)) = (run.line.whole('L')?, run.line.whole('P')?) else {
        let message = "G10 is available as L2 P1 to P6, which sets the offset of G54 to G59";
        let help = "keep the offsets of tools in the tool table";
        return Err(Problem::error("not-available", Blame::G(G(100)), message, help));
    };
    run.add_g(group::ONCE, G(100))?;
    run.add('L', 2.0)?;
    run.add('P', system as f64)?;
    for letter in ['X', 'Z'] {
        if let Some(value) = run.line.length(letter) {
            run.add(letter, value)?;
        }
    }
    Ok(())
}
