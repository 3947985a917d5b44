//! G codes of FANUC and Haas mills, the groups they exclude each other in, the words they use, and what is
//! refused by name.

use super::super::codes::{Deed, EXACT_STOP, HOLES, MACRO, ROTATION, unknown};
use super::super::line::Line;
use crate::block::{letter_bits as bits, letters_of};
use crate::codes::{G, M, group, m_group};
use crate::problem::{Blame, Problem, Span};

/// Codes that end what never begins here: polar coordinates, scaling, mirrors, cylinders.
const IDLE: [u16; 6] = [150, 500, 501, 1000, 131, 1130];

/// Codes that are known but not executed, why not, and what to write in their place.
const REFUSED: &[(&[u16], (&str, &str))] = &[
    (
        &[71, 1070, 121, 1120],
        ("cylinders and polar planes are not computed", "write the points in X, Y and A"),
    ),
    (&[120, 130, 1500], ("pockets are not computed", "write the moves, with G02 and G03")),
    (&[160], ("polar coordinates are not computed", "write X and Y")),
    (&[220, 230], ("limits of travel belong to the machine file", "leave it out")),
    (&[270, 290, 301], ("G28 and G30 are the ways home", "use G28 or G30")),
    (
        &[310, 350, 360, 370],
        ("nothing is measured", "measure the tool or the part first, and write the value"),
    ),
    (
        &[330],
        ("threads need a spindle that the axes follow", "mill the thread as a helix, G02 or G03 with Z"),
    ),
    (&[434, 435, 432, 1430], ("the tool does not lean", "use G43")),
    (&[470], ("letters are not computed", "write the moves")),
    (&[510, 511, 1010], ("nothing is scaled or mirrored", "write the coordinates as they are to be cut")),
    (&[600], ("a point is approached as programmed", "write the approach as two moves")),
    (&[661], ("G66 calls a macro behind each move", "use G66")),
    (&[700, 710, 720], ("patterns of holes are not computed", "write the place of each hole")),
    (&[760], ("the spindle of this machine does not stop at an angle", "bore with G85, G86 or G89")),
    (
        &[870],
        ("the spindle of this machine does not stop at an angle", "bore from the other side with G85 or G86"),
    ),
    (&[960], ("a mill has no diameter to keep a surface speed at", "use G97 and S in 1/min")),
];

/// The group of a G code; `None`: it does nothing.
///
/// # Errors
/// There is no such code, or it is not available.
pub(in super::super) fn g_group(code: G, span: Span) -> Result<Option<usize>, Box<Problem>> {
    Ok(Some(match code.0 {
        40 | 100 | 280 | 300 | 520 | 530 | 920 => group::ONCE,
        0 | 10 | 20 | 30 => group::MOTION,
        170 | 180 | 190 => group::PLANE,
        900 | 910 => group::DISTANCE,
        930 | 940 | 950 => group::FEED_MODE,
        200 | 210 => group::UNITS,
        400 | 410 | 420 => group::COMPENSATION,
        430 | 440 | 490 => group::TOOL_LENGTH,
        980 | 990 => group::RETRACT,
        540 | 541 | 550 | 560 | 570 | 580 | 590 | 1540 => group::COORDINATES,
        90 => EXACT_STOP,
        610 | 640 => group::PATH,
        970 => group::SPINDLE_MODE,
        650 | 660 | 670 => MACRO,
        680 | 690 => ROTATION,
        730 | 740 | 800 | 810 | 820 | 830 | 840 | 850 | 860 | 880 | 890 => HOLES,
        tenths if IDLE.contains(&tenths) => return Ok(None),
        tenths => {
            let Some((_, (why, help))) = REFUSED.iter().find(|(codes, _)| codes.contains(&tenths)) else {
                return Err(unknown(
                    f64::from(tenths) / 10.0,
                    span,
                    "G codes of a mill: G81 to G89 make holes",
                ));
            };
            let message = format!("{code} is not available: {why}");
            return Err(Problem::error("not-available", Blame::Span(span), message, *help));
        }
    }))
}

/// Words of the axes.
pub(super) const AXES: u32 = bits("XYZABC");
/// Words that a block may always have.
const ALWAYS: u32 = bits("FSTDH");

/// The words that a G code of a line uses.
fn words_of_g(code: G, line: &Line) -> u32 {
    match code.0 {
        100 if matches!(line.block.integer('L'), Some(2 | 20)) => AXES | bits("LP"),
        100 if matches!(line.block.integer('L'), Some(10..=13)) => bits("LPR"),
        0 | 10 | 280 | 300 | 520 | 530 | 920 => AXES,
        20 | 30 => AXES | bits("RIJK"),
        40 => bits("XP"),
        100 => AXES | bits("LPR"),
        541 | 1540 => bits("P"),
        650 | 660 => bits("PL"),
        680 => bits("XYZR"),
        730 | 740 | 810..=890 => bits("XYZRQPKL"),
        _ => 0,
    }
}

/// Whether G68 turns in a block.
pub(in super::super) fn turns(line: &Line) -> bool {
    line.block.g(ROTATION) == Some(G(680))
}

/// What a block does; `motion` is what moves words without a code.
///
/// # Errors
/// Two codes want its words, or a word is used by none.
pub(in super::super) fn deed(line: &Line, motion: G) -> Result<Deed, Box<Problem>> {
    let block = &line.block;
    let own = [
        block.g(MACRO).filter(|code| *code != G(670)),
        block.g(group::ONCE),
        block.g(ROTATION).filter(|code| *code == G(680)),
        block.g(HOLES).filter(|code| *code != G(800)),
        block.g(group::MOTION),
    ];
    // G00 beside G53, G28 and the like says what comes after them.
    let mut acting = own.into_iter().flatten().filter(|code| !matches!(code.0, 0 | 10 | 20 | 30));
    let (first, second) = (acting.next(), acting.next());
    let written = block.g(group::MOTION);
    let hole = block.g(HOLES).filter(|code| *code != G(800));
    if let Some((first, second)) = first.zip(second.or(written.filter(|_| hole.is_some()))) {
        return Err(both(&first.to_string(), &second.to_string(), Blame::G(second)));
    }
    let point = block.present() & (AXES | bits("IJK")) != 0;
    let moving = first.or(written).or(point.then_some(motion));
    let deed = match (first, block.m(m_group::CALL)) {
        (Some(code), Some(call)) => return Err(both(&code.to_string(), &call.to_string(), Blame::M(call))),
        (None, Some(call)) if point => {
            let code = moving.unwrap_or(motion);
            return Err(both(&code.to_string(), &call.to_string(), Blame::M(call)));
        }
        (None, Some(call)) => Deed::M(call),
        (_, None) => moving.map_or(Deed::None, Deed::G),
    };
    let used = match deed {
        Deed::None => 0,
        Deed::G(code) => words_of_g(code, line),
        Deed::M(M(97 | 98)) => bits("PL"),
        Deed::M(_) => bits("P"),
    };
    let beside = block.g(group::COORDINATES).map_or(0, |code| words_of_g(code, line));
    if used & beside & block.present() != 0 {
        let coordinates = block.g(group::COORDINATES).unwrap_or(G(541));
        return Err(both(&coordinates.to_string(), "another code", Blame::Word('P')));
    }
    let idle = line.idle.as_ref().map_or(0, |idle| idle.words);
    match letters_of(block.present() & !(ALWAYS | used | beside | idle)).next() {
        Some(letter) => Err(unused(letter, deed)),
        None => Ok(deed),
    }
}

fn both(one: &str, other: &str, blame: Blame) -> Box<Problem> {
    let message = format!("{one} and {other} both act in this block");
    Problem::error("modal-group", blame, message, "put them in different blocks")
}

fn unused(letter: char, deed: Deed) -> Box<Problem> {
    let blame = Blame::Word(letter);
    if matches!(letter, 'U' | 'V' | 'W') {
        let message = format!("{letter} moves nothing on this mill");
        return Problem::error(
            "not-available",
            blame,
            message,
            "axes are X, Y, Z, A, B and C; G91 counts from here",
        );
    }
    let word =
        if letter.is_ascii_lowercase() { format!(",{}", letter.to_ascii_uppercase()) } else { letter.into() };
    let (message, help) = match deed {
        Deed::None => {
            (format!("nothing in this block uses {word}"), "leave it out, or write the code it belongs to")
        }
        Deed::G(code) => {
            (format!("{code} does not use {word}"), "leave it out, or put it in a block of its own")
        }
        Deed::M(code) => {
            (format!("{code} does not use {word}"), "leave it out, or put it in a block of its own")
        }
    };
    Problem::error("unused-word", blame, message, help)
}
