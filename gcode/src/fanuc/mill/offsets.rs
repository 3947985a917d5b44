//! G43 H, G44 H, G49; D of G41 and G42; G54 to G59, G54.1 P, G154 P; G10.
//!
//! In: words of the line, the tool table. Out: blocks of RS274/NGC, and calls for coordinate systems that it
//! does not have. H and D are lines of the tool table: Z of it is a length, its diameter the tool's. One that
//! is not there is 0, with a warning.

use super::super::codes::Deed;
use super::super::execution::Execution;
use super::{compensation_off, rotation};
use crate::canon::{Call, Pose, Z};
use crate::codes::{G, group};
use crate::execute::{Done, other_length};
use crate::problem::{Blame, Problem, Span, short};
use crate::state::offset_of_system;

/// The last of the additional coordinate systems, G54.1 P99.
const LAST: i64 = 99;
/// Their numbers in calls follow that of G59.3.
const BEFORE: u8 = 9;

/// H or D.
fn number(letter: char, run: &Execution) -> Result<Option<i32>, Box<Problem>> {
    match run.line.whole(letter)? {
        None => Ok(None),
        Some(number @ 0..=9999) => Ok(Some(number as i32)),
        Some(number) => {
            let message = format!("{letter}{number} is not the number of an offset");
            Err(Problem::error(
                "bad-value",
                Blame::Word(letter),
                message,
                "give the number of a tool of the table",
            ))
        }
    }
}

/// G43, G44, G49, or another H while one of them is on.
pub(super) fn length(run: &mut Execution) -> Done {
    let code = run.line.block.g(group::TOOL_LENGTH);
    if let Some(h) = number('H', run)? {
        run.modal.offsets.h = Some(h);
    }
    run.modal.offsets.sign = match code.map(|code| code.0) {
        Some(430) => Some(1.0),
        Some(440) => Some(-1.0),
        Some(_) => None,
        None => run.modal.offsets.sign,
    };
    let sign = run.modal.offsets.sign;
    let blame = code.map_or(Blame::Word('H'), Blame::G);
    if code.is_none() && (sign.is_none() || !run.line.has('H')) {
        return Ok(());
    }
    run.begin();
    let Some(sign) = sign else {
        run.add_g(group::TOOL_LENGTH, G(490))?;
        return run.execute();
    };
    let h = run.modal.offsets.h.unwrap_or(run.state.tools.number);
    let entry = run.state.tools.table.find(h).map(|tool| run.state.units.to_program(&tool.offset)[Z]);
    if entry.is_none() && h != 0 {
        missing('H', h, blame, run);
    }
    other_length(h, blame, run.state, run.out);
    let span = run.span_of(blame);
    run.equivalent.add_g(group::TOOL_LENGTH, G(431), span)?;
    run.equivalent.add('Z', sign * entry.unwrap_or(0.0), span)?;
    run.execute()
}

fn missing(letter: char, number: i32, blame: Blame, run: &mut Execution) {
    let (message, help) = match run.state.tools.table.is_empty() {
        true => (
            format!("nothing is known of {letter}{number}: there is no tool table, and it is taken as 0"),
            "name one with --tools FILE, or as tool_table under [machine] of the machine file",
        ),
        false => (
            format!("{letter}{number} is not in the tool table: it is taken as 0"),
            "enter it in the table as the tool of this number",
        ),
    };
    let blame = if run.line.has(letter) { Blame::Word(letter) } else { blame };
    run.out.warn(Problem::warning("unknown-tool", blame, message, help));
}

/// G40, G41, G42 with D. A radius of 0 compensates nothing.
pub(super) fn radius(_: Deed, run: &mut Execution) -> Done {
    if let Some(d) = number('D', run)? {
        run.modal.offsets.d = Some(d);
    }
    let Some(code) = run.line.block.g(group::COMPENSATION) else { return Ok(()) };
    if code != G(400) && code == run.state.compensation.code() {
        return Ok(());
    }
    let d = run.modal.offsets.d;
    if code != G(400) {
        match d {
            Some(0) => return Ok(()),
            Some(d) if run.state.tools.table.find(d).is_none() => {
                missing('D', d, Blame::G(code), run);
                return Ok(());
            }
            _ => {}
        }
    }
    run.begin();
    run.add_g(group::COMPENSATION, code)?;
    if let Some(d) = d.filter(|_| code != G(400)) {
        run.add('D', f64::from(d))?;
    }
    run.execute()
}

/// G54 to G59, G54.1 P, G154 P.
pub(super) fn coordinates(run: &mut Execution) -> Done {
    let Some(code) = run.line.block.g(group::COORDINATES) else { return Ok(()) };
    rotation::refuse_inside(code, run)?;
    if !matches!(code.0, 541 | 1540) {
        run.begin();
        run.add_g(group::COORDINATES, code)?;
        return run.execute();
    }
    compensation_off(Blame::G(code), "change the coordinate system", run)?;
    let Some(number @ 1..=LAST) = run.line.whole('P')? else {
        let message = format!("{code} needs P, the number of an additional coordinate system");
        return Err(Problem::error("missing-word", Blame::G(code), message, "add P1 to P99"));
    };
    enter(number as u8, run)
}

fn enter(number: u8, run: &mut Execution) -> Done {
    let offset = run.modal.offsets.additional.get(&number).copied().unwrap_or_default();
    let offset = run.state.units.to_program(&offset);
    run.state.axes.enter(BEFORE + number, offset, 0.0);
    run.out.call(Call::SetG5xOffset(BEFORE + number, offset))?;
    run.out.call(Call::SetG92Offset(run.state.axes.g92()))?;
    run.out.call(Call::SetXyRotation(0.0))
}

/// G10: L2 (G54 to G59) and L20 (G54.1), added to under G91; L10 length and L12 radius of a tool.
pub(super) fn set(run: &mut Execution) -> Done {
    let (kind, number) = (run.line.whole('L')?, run.line.whole('P')?.unwrap_or(0));
    let refuse = |message: String, help: &str| {
        Err(Problem::error("not-available", Blame::G(G(100)), message, help.to_owned()))
    };
    match (kind, number) {
        (Some(2), 1..=6) => {
            rotation::refuse_inside(G(100), run)?;
            let old = run.state.lengths_at(offset_of_system(number as u8));
            let new = words(old, run);
            run.add_g(group::ONCE, G(100))?;
            let span = run.span_of(Blame::G(G(100)));
            run.equivalent.add('L', 2.0, span)?;
            run.equivalent.add('P', number as f64, span)?;
            for (letter, value) in
                crate::block::AXES.into_iter().zip(new).filter(|(letter, _)| run.line.has(*letter))
            {
                run.equivalent.add(letter, value, span)?;
            }
            run.execute()
        }
        (Some(20), 1..=LAST) => {
            let number = number as u8;
            let old = run.modal.offsets.additional.get(&number).copied().unwrap_or_default();
            let new = words(run.state.units.to_program(&old), run);
            let new = run.state.units.to_machine(&new);
            run.modal.offsets.additional.insert(number, new);
            if run.state.axes.system() == BEFORE + number {
                rotation::refuse_inside(G(100), run)?;
                compensation_off(Blame::G(G(100)), "change the coordinate system in force", run)?;
                return enter(number, run);
            }
            Ok(())
        }
        (Some(10 | 12), 1..) => entry(kind == Some(10), number, run),
        (Some(11 | 13), _) if run.line.plain('R') == Some(0.0) => Ok(()),
        (Some(11 | 13), _) => {
            refuse("G10 L11 and L13 set wear, which is not kept".into(), "set length and radius, L10 and L12")
        }
        _ => {
            let kind = kind.map_or("G10 without L".to_owned(), |kind| format!("G10 L{kind} P{number}"));
            refuse(
                format!("{kind} is not available"),
                "L2 P1 to P6 set G54 to G59, L20 P1 to P99 those of G54.1, L10 and L12 length and radius of a tool",
            )
        }
    }
}

/// Offsets with the words of the block, on top of them under G91.
fn words(mut offset: Pose, run: &Execution) -> Pose {
    for (value, letter) in offset.iter_mut().zip(crate::block::AXES) {
        let rotary = matches!(letter, 'A' | 'B' | 'C');
        let word = if rotary { run.line.degrees(letter) } else { run.line.length(letter) };
        let Some(word) = word else { continue };
        *value = if run.state.modes.incremental { *value + word } else { word };
    }
    offset
}

/// G10 L10 P R, G10 L12 P R: RS274/NGC's G10 L1.
fn entry(length: bool, number: i64, run: &mut Execution) -> Done {
    let Some(value) = run.line.length('R') else {
        let message = "G10 L10 and L12 need R, the length or the radius of the tool";
        return Err(Problem::error("missing-word", Blame::G(G(100)), message, "add R"));
    };
    if run.state.modes.incremental {
        let message = format!("G91 would add {} to an offset of the tool", short(value));
        return Err(Problem::error("not-available", Blame::Word('R'), message, "switch to G90 first"));
    }
    run.add_g(group::ONCE, G(100))?;
    let nowhere: Span = run.span_of(Blame::G(G(100)));
    run.equivalent.add('L', 1.0, nowhere)?;
    run.equivalent.add('P', number as f64, nowhere)?;
    run.equivalent.add(if length { 'Z' } else { 'R' }, value, nowhere)?;
    run.execute()
}
