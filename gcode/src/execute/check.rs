//! Refuses blocks before anything of them is executed: words that no code of the block uses, words that two
//! codes use, words that a code lacks, and codes that contradict each other or the state.
//!
//! Which code uses which words: manual of LinuxCNC, chapters G-Codes and M-Codes. A word that LinuxCNC
//! accepts without using it is also refused.

use super::Done;
use super::words::{self, AXES, CYCLES, POLAR, Words};
use crate::block::{Block, letter_bit, letters_of};
use crate::codes::{G, M, group, m_group};
use crate::problem::{Blame, Problem, short};
use crate::state::State;

/// Words that a block may always have: F, S, T, and the $ of S.
const ALWAYS: u32 = letter_bit('F') | letter_bit('S') | letter_bit('T');
const UVW: u32 = letter_bit('U') | letter_bit('V') | letter_bit('W');

/// Checks a block; the answer is the motion code that it executes.
///
/// # Errors
/// See the head of this file.
pub(super) fn check(block: &Block, state: &State) -> Result<Option<G>, Box<Problem>> {
    let motion = motion(block, state)?;
    let modal_only = block.m_codes().next().is_none() && block.g_codes().all(|code| Some(code) == motion);
    match motion {
        Some(G(0 | 10)) if modal_only && block.present() & !(ALWAYS | AXES | POLAR) == 0 => Ok(motion),
        _ => {
            words_used(block, motion)?;
            values(block)?;
            contradictions(block, motion, state)?;
            Ok(motion)
        }
    }
}

/// The motion code of a block: its own, or that in force if nothing else uses the axis words.
fn motion(block: &Block, state: &State) -> Result<Option<G>, Box<Problem>> {
    if let Some(code) = block.g(group::MOTION) {
        return Ok(Some(code));
    }
    let taken = axis_user(block).is_some();
    if block.present() & (AXES | POLAR) == 0 {
        let arc = matches!(state.modes.motion, Some(G(20 | 30)));
        let center = ['I', 'J', 'K'].into_iter().any(|letter| block.has(letter));
        return Ok(state.modes.motion.filter(|_| arc && center && !taken));
    }
    if taken {
        return Ok(None);
    }
    let letter = letters_of(block.present() & (AXES | POLAR)).next().unwrap_or('X');
    match state.modes.motion {
        Some(code) => Ok(Some(code)),
        None => {
            let message = format!("{letter} moves nothing: no motion code is in force");
            let help = "write G0 or G1, for instance, in this block or an earlier one";
            Err(Problem::error("no-motion-mode", Blame::Word(letter), message, help))
        }
    }
}

/// The code that takes the axis words away from motion.
fn axis_user(block: &Block) -> Option<G> {
    let once = block.g(group::ONCE).filter(|code| matches!(code.0, 100 | 280 | 300 | 520 | 920));
    let dynamic = block.g(group::TOOL_LENGTH).filter(|code| match code.0 {
        431 => true,
        432 => !block.has('H'),
        _ => false,
    });
    once.or(dynamic)
}

/// Every word is used by one code, and every code has the words it needs.
fn words_used(block: &Block, motion: Option<G>) -> Done {
    let mut used = if block.has('S') { ALWAYS | letter_bit('$') } else { ALWAYS };
    let mut first: Option<Words> = None;
    let mut claim = |words: Words| -> Done {
        let twice = block.present() & words.uses & used & !letter_bit('$');
        if let Some(letter) = letters_of(twice).next() {
            return Err(used_twice(letter, &words, first.as_ref()));
        }
        if let Some(letter) = letters_of(words.needs & !block.present()).next() {
            return Err(missing(letter, &words));
        }
        used |= words.uses;
        first = first.take().or(Some(words));
        Ok(())
    };
    for code in block.g_codes().filter(|code| Some(*code) != motion).chain(motion) {
        let mut words = words::of_g(code);
        if code == G(432) && block.has('H') {
            // The tool of the table is added, and axes belong to the move.
            words.uses = letter_bit('H');
        }
        claim(words)?;
    }
    for code in block.m_codes().filter(|code| Some(*code) != block.m(m_group::MACHINE)) {
        claim(words::of_m(code))?;
    }
    if let Some(letter) = letters_of(block.present() & !used).next() {
        return Err(unused(letter, motion));
    }
    let shifts = block.g_codes().find(|code| matches!(code.0, 432 | 520 | 920));
    match shifts.filter(|_| block.present() & (AXES | letter_bit('H')) == 0) {
        Some(code) => {
            let message = format!("{code} shifts nothing: the block has no axis words");
            Err(Problem::error("missing-word", Blame::G(code), message, "add the axes to shift, such as X0"))
        }
        None => Ok(()),
    }
}

fn unused(letter: char, motion: Option<G>) -> Box<Problem> {
    let blame = Blame::Word(letter);
    // A second slide would have to be a seventh axis of every point: of offsets, tools, parameters, calls and
    // printed canon, and of the wires, which have six places and two axes of positioners.
    if letter_bit(letter) & UVW != 0 {
        let message = format!("the axis {letter} is not available: no machine here has secondary axes");
        let help = "axes are X, Y, Z, A, B and C; under G91 X, Y and Z count from where the tool stands";
        return Problem::error("not-available", blame, message, help);
    }
    if let (Some(code), 'A' | 'B' | 'C') = (motion.filter(|code| CYCLES.contains(&code.0)), letter) {
        let message = format!("{code} does not move {letter}");
        return Problem::error("unused-word", blame, message, "turn the axis in an earlier block");
    }
    let help = format!("{letter} belongs to {}: leave it out or write the code", words::users(letter));
    Problem::error("unused-word", blame, format!("nothing in this block uses {letter}"), help)
}

fn used_twice(letter: char, words: &Words, other: Option<&Words>) -> Box<Problem> {
    let other = other.map_or_else(String::new, |other| format!(" and {}", other.code));
    let message = format!("{}{other} both use {letter}", words.code);
    let code = if letter_bit(letter) & AXES != 0 { "modal-group" } else { "ambiguous-word" };
    Problem::error(code, Blame::Word(letter), message, "put the two codes in different blocks")
}

fn missing(letter: char, words: &Words) -> Box<Problem> {
    let message = format!("{} needs {letter}", words.code);
    Problem::error("missing-word", words.blame(), message, format!("add {letter}"))
}

/// Values that only some numbers make sense of.
fn values(block: &Block) -> Done {
    if block.g(group::ONCE) == Some(G(100)) {
        ten(block)?;
    }
    if block.m(m_group::SPINDLE) == Some(M(19)) {
        within(block, 'R', 0.0, 360.0, "the angle of M19 is 0 to 360 degrees")?;
        within(block, 'P', 0.0, 2.0, "0 is the shortest way, 1 clockwise, 2 counterclockwise")?;
        whole(block, 'P')?;
        if block.get('Q').is_some_and(|seconds| seconds <= 0.0) {
            return Err(bad(block, 'Q', "M19 Q is the longest wait in s, greater than 0"));
        }
    }
    if block.g(group::ONCE) == Some(G(40)) && block.get('P').is_some_and(|seconds| seconds < 0.0) {
        return Err(bad(block, 'P', "G4 P is a time in s, 0 or greater"));
    }
    Ok(())
}

/// G10 L P.
fn ten(block: &Block) -> Done {
    let lengths = ['X', 'Y', 'Z', 'A', 'B', 'C'];
    let (letters, least, greatest): (&[char], f64, f64) = match block.integer('L') {
        Some(1) => (&['R', 'I', 'J', 'Q'], 1.0, 1e9),
        Some(10 | 11) => (&['R', 'I', 'J', 'Q'], 1.0, 1e9),
        Some(2) => (&['R'], 0.0, 9.0),
        Some(20) => (&[], 0.0, 9.0),
        Some(0) => {
            let message = "G10 L0, which reads the tool table again, is not available";
            return Err(Problem::error("not-available", Blame::Word('L'), message, "leave the block out"));
        }
        _ => {
            return Err(bad(block, 'L', "G10 has L1, L10, L11 for tools and L2, L20 for coordinate systems"));
        }
    };
    for letter in ['R', 'I', 'J', 'Q'] {
        if block.has(letter) && !letters.contains(&letter) {
            let message = format!("G10 L{} does not use {letter}", short(block.get('L').unwrap_or(0.0)));
            return Err(Problem::error("unused-word", Blame::Word(letter), message, "leave it out"));
        }
    }
    let what = if greatest > 9.0 {
        "P is the number of the tool"
    } else {
        "P0 is the system in force, P1 is G54, P9 is G59.3"
    };
    if !block.has('P') {
        let message = "G10 needs P";
        return Err(Problem::error("missing-word", Blame::G(G(100)), message, format!("add P: {what}")));
    }
    whole(block, 'P')?;
    within(block, 'P', least, greatest, what)?;
    whole(block, 'Q')?;
    within(block, 'Q', 0.0, 9.0, "Q is the orientation of a turning tool")?;
    let tool = greatest > 9.0;
    if tool && !lengths.iter().chain(letters).any(|letter| block.has(*letter)) {
        let message = "G10 changes nothing: no offset stands in the block";
        return Err(Problem::error(
            "missing-word",
            Blame::G(G(100)),
            message,
            "add axis words, R, I, J or Q",
        ));
    }
    Ok(())
}

fn whole(block: &Block, letter: char) -> Done {
    match (block.get(letter), block.integer(letter)) {
        (Some(_), None) => Err(bad(block, letter, "give a whole number")),
        _ => Ok(()),
    }
}

fn within(block: &Block, letter: char, least: f64, greatest: f64, help: &str) -> Done {
    match block.get(letter) {
        Some(value) if !(least..=greatest).contains(&value) => Err(bad(block, letter, help)),
        _ => Ok(()),
    }
}

fn bad(block: &Block, letter: char, help: &str) -> Box<Problem> {
    let message = format!("{letter}{} makes no sense here", short(block.get(letter).unwrap_or(0.0)));
    let blame = if block.has(letter) { Blame::Word(letter) } else { Blame::Block };
    Problem::error("bad-value", blame, message, help)
}

/// Codes against codes and against the state.
fn contradictions(block: &Block, motion: Option<G>, state: &State) -> Done {
    let mover = block.g(group::MOTION).filter(|code| *code != G(800));
    if let (Some(user), Some(code)) = (axis_user(block), mover) {
        let message = format!("{user} and {code} both use the axis words");
        return Err(Problem::error("modal-group", Blame::G(code), message, "put them in different blocks"));
    }
    if let (Some(code), Some(M(5 | 4 | 3 | 19))) = (block.m(m_group::STATE), block.m(m_group::SPINDLE)) {
        let message = format!("{code} and a spindle code exclude each other in one block");
        return Err(Problem::error("modal-group", Blame::M(code), message, "put them in different blocks"));
    }
    if let (Some(code), Some(other)) = (block.m(m_group::MIST), block.m(m_group::FLOOD)) {
        let message = format!("{code} and {other} exclude each other in one block");
        let help = "put them in different blocks; mist and flood may be on together";
        return Err(Problem::error("modal-group", Blame::M(code), message, help));
    }
    if matches!(motion, Some(G(330 | 331))) && block.has('F') {
        let message = "F has no meaning in a move that follows the spindle: K is its feed per revolution";
        return Err(Problem::error("feed-in-thread", Blame::Word('F'), message, "leave F out"));
    }
    if block.g(group::ONCE) == Some(G(530)) {
        machine_coordinates(block, motion, state)?;
    }
    Ok(())
}

/// G53.
fn machine_coordinates(block: &Block, motion: Option<G>, state: &State) -> Done {
    let blame = Blame::G(G(530));
    if !matches!(motion, Some(G(0 | 10))) {
        let message = "G53 needs a straight move: neither G0 nor G1 is executed in this block";
        return Err(Problem::error("missing-word", blame, message, "add G0 or G1 and axis words"));
    }
    let incremental = block.g(group::DISTANCE).map_or(state.modes.incremental, |code| code == G(910));
    if incremental {
        let message = "G53 names points of the machine, G91 distances";
        return Err(Problem::error("modal-group", blame, message, "switch to G90 first"));
    }
    if let Some(letter) = letters_of(block.present() & POLAR).next() {
        let message = "G53 takes no polar coordinates";
        return Err(Problem::error("unused-word", Blame::Word(letter), message, "write X and Y"));
    }
    match block.g(group::COMPENSATION) {
        Some(G(400)) => Ok(()),
        _ => compensation_off(blame, "use G53", state),
    }
}

/// Refuses what must not happen while G41 or G42 is on.
pub(super) fn compensation_off(blame: Blame, what: &str, state: &State) -> Done {
    if !state.compensation.is_on() {
        return Ok(());
    }
    let message = format!("cannot {what} while {} is on", state.compensation.code());
    Err(Problem::error("compensation-on", blame, message, "end it with G40 first"))
}
