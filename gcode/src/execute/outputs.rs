//! Coolant, M48 to M53, M62 to M68.

use super::{Done, Output, check};
use crate::block::Block;
use crate::canon::Call;
use crate::codes::{M, m_group};
use crate::options::MachineCode;
use crate::problem::{Blame, Problem, short};
use crate::state::{INPUT, State};

/// M7, M8, M9.
pub(super) fn coolant(block: &Block, state: &mut State, out: &mut Output) -> Done {
    if block.m(m_group::MIST).is_some() {
        state.coolant.mist = true;
        out.call(Call::MistOn)?;
    }
    match block.m(m_group::FLOOD) {
        Some(M(8)) => {
            state.coolant.flood = true;
            out.call(Call::FloodOn)
        }
        Some(_) => {
            (state.coolant.mist, state.coolant.flood) = (false, false);
            out.call(Call::MistOff)?;
            out.call(Call::FloodOff)
        }
        None => Ok(()),
    }
}

/// M48 to M53. P0 switches off; without P it is on.
pub(super) fn overrides(code: M, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::M(code), "change the overrides", state)?;
    let on = match code.0 {
        48 => true,
        49 => false,
        _ => block.get('P') != Some(0.0),
    };
    let overrides = &mut state.overrides;
    if matches!(code.0, 48..=50) {
        overrides.feed = on;
        out.call(Call::EnableFeedOverride(on))?;
    }
    if matches!(code.0, 48 | 49 | 51) {
        overrides.speed = on;
        out.call(Call::EnableSpeedOverride(on))?;
    }
    if code.0 == 52 {
        overrides.adaptive = on;
        out.call(Call::EnableAdaptiveFeed(on))?;
    }
    if code.0 == 53 {
        overrides.hold = on;
        out.call(Call::EnableFeedHold(on))?;
    }
    Ok(())
}

/// M62 to M68.
pub(super) fn io(code: M, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::M(code), "switch outputs or wait for inputs", state)?;
    if code == M(66) {
        return wait(code, block, state, out);
    }
    let letter = if code.0 < 66 { 'P' } else { 'E' };
    let index = number(block, letter, code)?;
    whole(block, letter, state)?;
    match code.0 {
        62 | 63 => out.call(Call::SetMotionOutputBit(index, code == M(62))),
        64 | 65 => out.call(Call::SetAuxOutputBit(index, code == M(64))),
        67 => out.call(Call::SetMotionOutputValue(index, value(block, code)?)),
        _ => out.call(Call::SetAuxOutputValue(index, value(block, code)?)),
    }
}

/// A code of the machine that switches an output or waits for an input.
pub(super) fn of_machine(code: M, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::M(code), "switch outputs or wait for inputs", state)?;
    match state.machine_codes.get(&code.0) {
        Some(MachineCode::Output { number, on }) => out.call(Call::SetAuxOutputBit(*number, *on)),
        Some(&MachineCode::Input { number: index, wait, timeout }) => {
            state.set_parameter(INPUT, level_behind(wait));
            out.call(Call::WaitInput { index, analog: false, wait, timeout })
        }
        _ => Ok(()), // only such codes are of this group
    }
}

/// What an input shows behind a wait that has ended as it should: who waits in vain goes no further.
fn level_behind(wait: u8) -> f64 {
    f64::from(matches!(wait, 1 | 3))
}

/// M66 P (digital) or E (analog), L (how to wait), Q (at most, s). The input is known when the program runs,
/// not when it is read: behind a wait it is what was waited for, and nothing else can be known here.
/// Stand-alone, #5399 keeps what it was.
fn wait(code: M, block: &Block, state: &mut State, out: &mut Output) -> Done {
    let analog = block.has('E');
    if analog && block.has('P') {
        let message = "M66 has both P (a digital input) and E (an analog one)";
        return Err(Problem::error("bad-value", Blame::Word('E'), message, "leave one of the two out"));
    }
    let letter = if analog { 'E' } else { 'P' };
    let index = number(block, letter, code)?;
    whole(block, letter, state)?;
    whole(block, 'L', state)?;
    let wait = block.get('L').unwrap_or(0.0).round();
    if !(0.0..=4.0).contains(&wait) {
        let message = format!("L{} is not a way to wait", short(wait));
        let help = "L0 does not wait, L1 waits for a rise, L2 for a fall, L3 for high, L4 for low";
        return Err(Problem::error("bad-value", Blame::Word('L'), message, help));
    }
    if analog && wait != 0.0 {
        let message = "M66 cannot wait for a value of an analog input";
        return Err(Problem::error("bad-value", Blame::Word('L'), message, "use L0 with E"));
    }
    let timeout = block.get('Q').unwrap_or(0.0).max(0.0);
    if wait > 0.0 && timeout == 0.0 {
        let message = format!("M66 L{wait} waits, but the block does not say how long");
        return Err(Problem::error(
            "missing-word",
            Blame::M(code),
            message,
            "add Q, the longest wait in s, > 0",
        ));
    }
    if state.settings.stand_alone {
        let last = state.parameter(INPUT);
        state.set_parameter(INPUT, if analog { last } else { f64::from(last != 0.0) });
    } else if wait == 0.0 {
        let message = "what M66 reads is known when the machine runs, not when the program is read";
        let help =
            "wait for it: M66 P with L3 (on) or L4 (off) and Q, the longest wait in s; #5399 is 1 or 0 then";
        return Err(Problem::error("unknown-input", Blame::M(code), message, help));
    } else {
        state.set_parameter(INPUT, level_behind(wait as u8));
    }
    out.call(Call::WaitInput { index, analog, wait: wait as u8, timeout })
}

/// A number of an output, an input, a way to wait is a whole one; the stand-alone interpreter rounds it.
fn whole(block: &Block, letter: char, state: &State) -> Done {
    let value = block.get(letter).filter(|value| *value != value.round() && !state.settings.stand_alone);
    value.map_or(Ok(()), |value| {
        let message = format!("{letter}{} is not a whole number", short(value));
        Err(Problem::error("bad-value", Blame::Word(letter), message, "give a whole one"))
    })
}

fn number(block: &Block, letter: char, code: M) -> Result<u32, Box<Problem>> {
    match block.get(letter).map(f64::round) {
        Some(number) if (0.0..1e6).contains(&number) => Ok(number as u32),
        Some(number) => {
            let message = format!("{letter}{} cannot be the number of an input or output", short(number));
            Err(Problem::error("bad-value", Blame::Word(letter), message, "they are numbered from 0"))
        }
        None => {
            let message = format!("{code} needs {letter}, the number of the input or output");
            Err(Problem::error("missing-word", Blame::M(code), message, format!("add {letter}")))
        }
    }
}

fn value(block: &Block, code: M) -> Result<f64, Box<Problem>> {
    block.get('Q').ok_or_else(|| {
        let message = format!("{code} needs Q, the value of the output");
        Problem::error("missing-word", Blame::M(code), message, "add Q")
    })
}
