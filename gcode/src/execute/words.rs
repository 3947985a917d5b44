//! Which words a code uses, and which of them it needs.

use std::fmt::Write as _;

use crate::block::{letter_bit, letter_bits as bits};
use crate::codes::{G, M};
use crate::problem::Blame;

/// Words of the axes, as bits.
pub(super) const AXES: u32 = bits("XYZABC");
/// Words of a polar point.
pub(super) const POLAR: u32 = bits("@^");
/// Cycles, which move X, Y and Z only, in tenths.
pub(super) const CYCLES: [u16; 12] = [730, 740, 760, 810, 820, 830, 840, 850, 860, 870, 880, 890];

/// What a code does with words.
pub(super) struct Words {
    /// Its name.
    pub(super) code: Code,
    /// Letters it uses, as bits.
    pub(super) uses: u32,
    /// Letters it cannot do without.
    pub(super) needs: u32,
}

/// A code of either kind.
#[derive(Clone, Copy)]
pub(super) enum Code {
    G(G),
    M(M),
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Code::G(code) => code.fmt(f),
            Code::M(code) => code.fmt(f),
        }
    }
}

impl Words {
    /// The code itself, as what is to blame.
    pub(super) fn blame(&self) -> Blame {
        match self.code {
            Code::G(code) => Blame::G(code),
            Code::M(code) => Blame::M(code),
        }
    }
}

/// Codes in tenths, the words they use, the words they need.
const G_WORDS: &[(&[u16], u32, u32)] = &[
    (&[0, 10], AXES | POLAR, 0),
    (&[20, 30], AXES | POLAR | bits("IJKRP"), 0),
    (&[40], bits("P"), bits("P")),
    (&[50], AXES | bits("IJPQ"), bits("PQ")),
    (&[51], AXES | bits("IJ"), 0),
    (&[52], AXES | bits("PL"), 0),
    (&[62], AXES | bits("PQKR"), 0),
    (&[100], AXES | bits("PLRIJQ"), bits("L")),
    (&[280, 300], AXES, 0),
    (&[520, 920], AXES, 0),
    (&[330], AXES | POLAR | bits("KQ$"), bits("K")),
    (&[331], AXES | POLAR | bits("KI$"), bits("K")),
    (&[382, 383, 384, 385], AXES | POLAR, 0),
    (&[410, 420], bits("D"), 0),
    (&[411, 421], bits("DL"), bits("D")),
    (&[430], bits("H"), 0),
    (&[431], AXES, 0),
    (&[432], AXES | bits("H"), 0),
    (&[640], bits("PQR"), 0),
    (&[700], bits("XZQDEP"), bits("Q")),
    (&[710, 711, 712, 720, 721, 722], bits("XZQDIR"), bits("Q")),
    (&[730, 830], bits("XYZ@^RLQD"), 0),
    (&[740, 840], bits("XYZ@^RLP$"), 0),
    (&[760], bits("XYZPIJKRQHEL$"), bits("PIJK")),
    (&[810, 850], bits("XYZ@^RL"), 0),
    (&[820, 860, 880, 890], bits("XYZ@^RLP"), 0),
    (&[870], bits("XYZ@^RLIJK"), 0),
    (&[950, 970], bits("$"), 0),
    (&[960], bits("D$"), bits("S")),
];

const M_WORDS: &[(&[u16], u32, u32)] = &[
    (&[3, 4, 5], bits("$"), 0),
    (&[19], bits("RPQ$"), 0),
    (&[50, 52, 53], bits("P"), 0),
    (&[51], bits("P$"), 0),
    (&[61], bits("Q"), bits("Q")),
    (&[62, 63, 64, 65], bits("P"), bits("P")),
    (&[66], bits("PELQ"), 0),
    (&[67, 68], bits("EQ"), bits("EQ")),
    (&[98], bits("PL"), bits("P")),
];

/// What a G code does with words.
pub(super) fn of_g(code: G) -> Words {
    let (uses, needs) = find(G_WORDS, code.0);
    Words { code: Code::G(code), uses, needs }
}

/// What an M code does with words.
pub(super) fn of_m(code: M) -> Words {
    let (uses, needs) = find(M_WORDS, code.0);
    Words { code: Code::M(code), uses, needs }
}

fn find(table: &[(&[u16], u32, u32)], code: u16) -> (u32, u32) {
    let found = table.iter().find(|(codes, ..)| codes.contains(&code));
    found.map_or((0, 0), |(_, uses, needs)| (*uses, *needs))
}

/// The codes that use a letter: `G4, G10 and M66`.
pub(super) fn users(letter: char) -> String {
    let of = |table: &'static [(&[u16], u32, u32)]| {
        let used = table.iter().filter(move |(_, uses, _)| uses & letter_bit(letter) != 0);
        used.flat_map(|(codes, ..)| codes.iter().copied())
    };
    let mut codes: Vec<u16> = of(G_WORDS).collect();
    codes.sort_unstable();
    let mut names: Vec<String> = codes.into_iter().map(|code| G(code).to_string()).collect();
    names.extend(of(M_WORDS).map(|code| M(code).to_string()));
    let Some(last) = names.pop() else { return "no code".into() };
    let mut text = names.join(", ");
    if !text.is_empty() {
        text.push_str(" and ");
    }
    let _ = write!(text, "{last}"); // a string takes everything
    text
}
