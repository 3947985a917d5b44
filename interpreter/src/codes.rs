//! The G and M codes of RS274/NGC: which of them are known here, and in which modal group. In: the number of a G or
//! M word. Out: a code, or why there is none.

use crate::diagnostic::short;
use crate::words::Word;

/// The G codes of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum G {
    Rapid,
    Feed,
    Dwell,
    Diameter,
    Radius,
    PlaneZX,
    Inches,
    Millimetres,
    ThreadMove,
    ThreadCycle,
    FirstSystem,
    Absolute,
    Incremental,
    ArcAbsolute,
    ArcIncremental,
    FeedPerMinute,
    FeedPerRevolution,
    SpeedConstant,
}

/// The M codes of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum M {
    Clockwise,
    Counterclockwise,
    SpindleStop,
    End,
}

/// Code times ten, code, modal group.
const G_CODES: [(i64, G, u32); 18] = [
    (0, G::Rapid, 1),
    (10, G::Feed, 1),
    (40, G::Dwell, 0),
    (70, G::Diameter, 15),
    (80, G::Radius, 15),
    (180, G::PlaneZX, 2),
    (200, G::Inches, 6),
    (210, G::Millimetres, 6),
    (330, G::ThreadMove, 1),
    (540, G::FirstSystem, 12),
    (760, G::ThreadCycle, 1),
    (900, G::Absolute, 3),
    (901, G::ArcAbsolute, 4),
    (910, G::Incremental, 3),
    (911, G::ArcIncremental, 4),
    (940, G::FeedPerMinute, 5),
    (950, G::FeedPerRevolution, 5),
    (970, G::SpeedConstant, 14),
];

const M_CODES: [(i64, M, u32); 5] = [
    (2, M::End, 4),
    (3, M::Clockwise, 7),
    (4, M::Counterclockwise, 7),
    (5, M::SpindleStop, 7),
    (30, M::End, 4),
];

/// Codes of the language that this machine does not execute yet: times ten, and what to write instead.
const G_TO_COME: [(&[i64], &str); 9] = [
    (&[20, 30], "approximate the arc with G1 moves"),
    (&[170, 171, 190, 191, 181], "a lathe works in the plane of Z and X: leave it out or write G18"),
    (&[400, 410, 411, 420, 421], "programme the path of the tool's reference point"),
    (&[430, 431, 432, 490, 100, 920, 921, 922, 923, 520], "programme positions in the machine's coordinates"),
    (
        &[530, 550, 560, 570, 580, 590, 591, 592, 593],
        "programme positions in the machine's coordinates (G54)",
    ),
    (&[610, 611, 640], "leave it out: every block ends in an exact stop"),
    (&[700, 710, 711, 712, 720, 721, 722], "write the roughing moves out as G0 and G1"),
    (&[930], "use G94 (mm/min) or G95 (mm/rev)"),
    (&[960], "use G97 and one S word for each diameter"),
];

/// More codes of the language that are not executed yet, without a substitute.
const G_WITHOUT_SUBSTITUTE: [i64; 30] = [
    50, 51, 52, 53, 280, 281, 300, 301, 331, 340, 350, 380, 382, 383, 384, 385, 730, 740, 800, 810, 820, 830,
    840, 850, 860, 870, 880, 890, 980, 990,
];

const M_TO_COME: [(&[i64], &str); 6] = [
    (&[0, 1, 60], "divide the program where it shall stop"),
    (&[6, 61], "write T alone: the tool is taken to be in place"),
    (&[7, 8, 9], "switch the coolant at the machine, and leave the word out"),
    (&[19], "leave it out"),
    (&[48, 49, 50, 51, 52, 53, 62, 63, 64, 65, 66, 67, 68], "leave it out"),
    (&[70, 71, 72, 73, 98, 99], "write the blocks out one after the other"),
];

/// Why a word is no code: a stable name, the message, the remedy.
pub(crate) type NoCode = (&'static str, String, String);

/// The G code of a word, with its modal group.
pub(crate) fn g_code(word: &Word) -> Result<(G, u32), NoCode> {
    let name = format!("G{}", short(word.value));
    let Some(number) = whole(word.value * 10.0) else { return Err(unknown("unknown-g-code", &name)) };
    if let Some((_, code, group)) = G_CODES.iter().find(|(known, ..)| *known == number) {
        return Ok((*code, *group));
    }
    let substitute = G_TO_COME.iter().find(|(codes, _)| codes.contains(&number)).map(|(_, help)| *help);
    match substitute {
        Some(help) => Err(to_come(&name, help)),
        None if G_WITHOUT_SUBSTITUTE.contains(&number) => {
            Err(to_come(&name, "write its moves out with G0 and G1, or leave it out"))
        }
        None => Err(unknown("unknown-g-code", &name)),
    }
}

/// The M code of a word, with its modal group.
pub(crate) fn m_code(word: &Word) -> Result<(M, u32), NoCode> {
    let name = format!("M{}", short(word.value));
    let Some(number) = whole(word.value) else { return Err(unknown("unknown-m-code", &name)) };
    if let Some((_, code, group)) = M_CODES.iter().find(|(known, ..)| *known == number) {
        return Ok((*code, *group));
    }
    match M_TO_COME.iter().find(|(codes, _)| codes.contains(&number)) {
        Some((_, help)) => Err(to_come(&name, help)),
        None => Err(unknown("unknown-m-code", &name)),
    }
}

/// A number as the whole one it means, if it means one.
pub(crate) fn whole(value: f64) -> Option<i64> {
    let near = value.round();
    ((value - near).abs() < 1e-3 && near.abs() < 1e9).then_some(near as i64)
}

fn unknown(code: &'static str, name: &str) -> NoCode {
    let known = if code == "unknown-g-code" {
        "G0 G1 G4 G7 G8 G18 G20 G21 G33 G54 G76 G90 G90.1 G91 G91.1 G94 G95 G97"
    } else {
        "M2 M3 M4 M5 M30"
    };
    (code, format!("there is no {name}"), format!("available: {known}"))
}

fn to_come(name: &str, help: &str) -> NoCode {
    ("not-available", format!("{name} is not available yet"), help.to_owned())
}
