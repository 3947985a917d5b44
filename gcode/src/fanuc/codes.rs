//! G and M codes of G-code system A, the groups they exclude each other in, the words they use, and what is
//! refused by name.

use super::line::Line;
use crate::block::{letter_bits as bits, letters_of};
use crate::codes::{G, M, group, m_group as groups};
use crate::problem::{Blame, Problem, Span, short};

/// G65, G66: the group of macro calls.
pub(super) const MACRO: usize = 4;
/// G09: stop at the end of the block.
pub(super) const EXACT_STOP: usize = 11;
/// G80 to G89: cycles for holes.
pub(super) const DRILLING: usize = 10;
/// On a mill: G68, G69.
pub(super) const ROTATION: usize = group::SUSPENSION;
/// On a mill: G73 to G89.
pub(super) const HOLES: usize = group::DIAMETER;
/// Groups of codes that end what never begins here: mirrored turrets G69, the driven C axis G13.1 (G113).
const ENDS: &[(&[u16], usize)] = &[(&[690], 9), (&[131, 1130], 8)];

/// What a G code may be.
pub(super) const SYSTEM_A: &str =
    "codes are those of G-code systems A and B, as docs/gcode-fanuc.md has them";

const ONCE: [u16; 14] = [40, 100, 280, 300, 500, 520, 530, 700, 710, 720, 730, 740, 750, 760];

/// Codes that are known but not executed, why not, and what to write in their place.
const REFUSED: &[(&[u16], (&str, &str))] = &[
    (&[71, 1070, 121, 1120], ("there is no driven C axis", "turn the contour with G01, G02 and G03")),
    (&[220, 230, 250, 260], ("limits of travel and speed belong to the machine file", "leave it out")),
    (&[270, 290, 301], ("G28 and G30 are the ways home", "use G28 or G30")),
    (&[310, 370], ("nothing is measured", "measure the tool or the part first, and write the value")),
    (&[661], ("G66 calls a macro behind each move", "use G66")),
    (&[680], ("there is one turret", "write the blocks for it alone")),
    (&[170, 190], ("a lathe works in the plane of X and Z", "use G18")),
    (&[880], ("there are no driven tools to tap along X", "holes are along Z: use G84")),
    (&[870], ("there are no driven tools to drill along X", "holes are along Z: use G83")),
    (&[502, 512], ("tools do not turn in step with the part", "write the corners of the polygon as moves")),
];

/// Codes that switch look-ahead and smoothing.
const SMOOTHING: [u16; 6] = [50, 51, 61, 80, 81, 1870];
/// P beside S: the main spindle, where a machine has several.
const MAIN_SPINDLE: f64 = 11.0;
/// M codes that choose a gear of the spindle.
pub(super) const GEARS: std::ops::RangeInclusive<u16> = 40..=44;

/// Why a code may stand in any block and does nothing, and the words that it takes with it.
pub(super) fn does_nothing(code: G, mill: bool) -> Option<(&'static str, u32)> {
    match code.0 {
        tenths if SMOOTHING.contains(&tenths) => {
            Some(("look-ahead and smoothing are always on", bits("PQRE")))
        }
        490 if !mill => Some(("the offset of a tool comes with its T and ends with T00", 0)),
        _ => None,
    }
}

/// The group of a G code.
///
/// # Errors
/// There is no such code, or it is not available.
pub(super) fn g_group(code: G, span: Span) -> Result<usize, Box<Problem>> {
    Ok(match code.0 {
        tenths if ONCE.contains(&tenths) => group::ONCE,
        0 | 10 | 20 | 30 | 320 | 340 | 350 | 360 | 900 | 920 | 940 => group::MOTION,
        180 => group::PLANE,
        650 | 660 | 670 => MACRO,
        800 | 810 | 820 | 830 | 840 | 850 | 860 | 890 => DRILLING,
        90 => EXACT_STOP,
        610 | 640 => group::PATH,
        960 | 970 => group::SPINDLE_MODE,
        980 | 990 => group::FEED_MODE,
        200 | 210 => group::UNITS,
        400 | 410 | 420 => group::COMPENSATION,
        540 | 550 | 560 | 570 | 580 | 590 => group::COORDINATES,
        tenths => match (in_table(ENDS, tenths), in_table(REFUSED, tenths)) {
            (Some(group), _) => *group,
            (None, Some((why, help))) => {
                let message = format!("{code} is not available: {why}");
                return Err(Problem::error("not-available", Blame::Span(span), message, *help));
            }
            (None, None) => return Err(unknown(f64::from(tenths) / 10.0, span, SYSTEM_A)),
        },
    })
}

/// What a table says about a code.
fn in_table<T>(table: &'static [(&[u16], T)], tenths: u16) -> Option<&'static T> {
    table.iter().find(|(codes, _)| codes.contains(&tenths)).map(|(_, entry)| entry)
}

/// The group of an M code; `None` if there is no such code.
pub(super) fn m_group(code: M) -> Option<usize> {
    Some(match code.0 {
        0 | 1 | 2 | 30 => groups::STOP,
        3..=5 => groups::SPINDLE,
        7 => groups::MIST,
        8 | 9 => groups::FLOOD,
        6 => groups::TOOL,
        97..=99 => groups::CALL,
        _ => return None,
    })
}

/// A G code that does not exist.
pub(super) fn unknown(value: f64, span: Span, help: &str) -> Box<Problem> {
    let message = format!("there is no code G{}", short(value));
    Problem::error("unknown-g-code", Blame::Span(span), message, help)
}

/// The local variable of a letter of G65 (argument assignment I), 1 to 26; I, J and K begin at 4.
pub(super) fn argument(letter: u8) -> usize {
    match letter {
        b'a'..=b'c' => usize::from(letter - b'a') + 1,
        b'd'..=b'f' => usize::from(letter - b'd') + 7,
        b'h' => 11,
        _ => usize::from(letter.saturating_sub(b'a')) + 1,
    }
}

/// Words that name a point.
const POINT: u32 = bits("XZUW");
/// Words that a block may always have.
const ALWAYS: u32 = bits("FST");

/// The words that a G code uses.
fn words_of_g(code: G) -> u32 {
    match code.0 {
        0 | 520 | 530 => POINT,
        280 => POINT | bits("V"),
        10 => POINT | bits("CRIKcrA"),
        20 | 30 => POINT | bits("RIK"),
        40 => bits("XUP"),
        100 => bits("LPXZ"),
        300 => POINT | bits("PV"),
        320 => POINT | bits("Q"),
        340 => POINT | bits("QK"),
        350 | 360 => POINT | bits("IKRQ"),
        500 => POINT,
        650 | 660 => bits("PL"),
        700 => bits("PQUWD"),
        710 | 720 => bits("PQUWRD"),
        730 => bits("PQUWR"),
        740 | 750 => POINT | bits("PQRIK"),
        760 => POINT | bits("PQRIKAD"),
        810..=890 => POINT | bits("RQPK"),
        900 | 940 => POINT | bits("R"),
        920 => POINT | bits("RQ"),
        _ => 0,
    }
}

/// The code that says what a block does: a macro or subprogram, a code that is not modal, or the motion code
/// `motion`, if the block has words for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Deed {
    None,
    G(G),
    M(M),
}

/// What the block does.
///
/// # Errors
/// Two codes want its words, or a word is used by none.
pub(super) fn deed(line: &Line, motion: G) -> Result<Deed, Box<Problem>> {
    let block = &line.block;
    let once = block
        .g(MACRO)
        .filter(|code| *code != G(670))
        .or(block.g(group::ONCE).filter(|code| *code != G(500) || line.has_any("XZUW")));
    let point = line.has_any("XZUWIK");
    let written = block.g(group::MOTION).filter(|code| !is_idle(*code, line));
    let hole = block.g(DRILLING).filter(|code| *code != G(800));
    if let (Some(hole), Some(other)) = (hole, once.or(written)) {
        let message = format!("{hole} and {other} both act in this block");
        let help = "put them in different blocks";
        return Err(Problem::error("modal-group", Blame::G(hole), message, help));
    }
    let moving = written.or(hole).or(point.then_some(motion)).filter(|_| once.is_none());
    if block.g(group::ONCE) == Some(G(500)) && !line.has_any("XZUWS") {
        let help = "add S, the highest speed of the spindle, or X and Z, the coordinates of this point";
        return Err(Problem::error("missing-word", Blame::G(G(500)), "G50 alone sets nothing", help));
    }
    let deed = match (once, block.m(groups::CALL)) {
        (Some(code), Some(call)) => return Err(both(code, call)),
        (Some(code), None) => Deed::G(code),
        (None, Some(call)) if point => return Err(both(moving.unwrap_or(motion), call)),
        (None, Some(call)) => Deed::M(call),
        (None, None) => moving.map_or(Deed::None, Deed::G),
    };
    let used = match deed {
        Deed::None => 0,
        Deed::G(code) => words_of_g(code),
        Deed::M(M(97 | 98)) => bits("PL"),
        Deed::M(_) => bits("P"),
    };
    let idle = line.idle.as_ref().map_or(0, |idle| idle.words);
    match letters_of(block.present() & !(ALWAYS | used | idle)).next() {
        Some('P') if line.has('S') || matches!(block.m(groups::SPINDLE), Some(M(3..=5))) => {
            match line.plain('P') == Some(MAIN_SPINDLE)
                && block.present() & !(ALWAYS | used | idle | bits("P")) == 0
            {
                true => Ok(deed),
                false => Err(of_another_spindle()),
            }
        }
        Some(letter) => Err(unused(letter, deed)),
        None => Ok(deed),
    }
}

/// G90, G92 and G94 without a point: they cut nothing. G92 with S is G50 S, as other code systems have it.
pub(super) fn is_idle(code: G, line: &Line) -> bool {
    matches!(code, G(900 | 920 | 940)) && !line.has_any("XZUWR")
}

fn both(code: G, call: M) -> Box<Problem> {
    let message = format!("{code} and {call} both act in this block");
    Problem::error("modal-group", Blame::M(call), message, "put them in different blocks")
}

/// `S1200 M03 P12`.
fn of_another_spindle() -> Box<Problem> {
    let message = "P beside S chooses one of several spindles, and this machine has the main one (P11)";
    let help = "write P11, or leave P out, where the block means the main spindle; what the others do cannot be done here";
    Problem::error("not-available", Blame::Word('P'), message, help)
}

fn unused(letter: char, deed: Deed) -> Box<Problem> {
    let blame = Blame::Word(letter);
    if matches!(letter, 'Y' | 'A' | 'B' | 'V' | 'H') {
        let message = format!("{letter} moves nothing on this lathe");
        return Problem::error("not-available", blame, message, "axes are X and Z (U and W incremental)");
    }
    let word = match letter {
        'c' => ",C".into(),
        'r' => ",R".into(),
        letter => letter.to_string(),
    };
    let elsewhere = "leave it out, or put it in a block of its own";
    let (message, help) = match deed {
        Deed::None => {
            (format!("nothing in this block uses {word}"), "leave it out, or write the code it belongs to")
        }
        Deed::G(G(710..=730)) if matches!(letter, 'D' | 'I' | 'K') => (
            format!("{word} is not a word of this cycle"),
            "G71 P(first) Q(last) U W D(depth) F is one block; two are G71 U(depth) R(retract), then G71 P Q U W F",
        ),
        Deed::G(code) => (format!("{code} does not use {word}"), elsewhere),
        Deed::M(code) => (format!("{code} does not use {word}"), elsewhere),
    };
    Problem::error("unused-word", blame, message, help)
}
