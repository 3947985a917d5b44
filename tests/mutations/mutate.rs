//! Mutations of known inputs. In: a corpus, a number. Out: bytes, the same ones for the same number every
//! time.

use testing::Seed;

/// Words and signs of both dialects that are worth putting anywhere.
const DICTIONARY: &[&str] = &[
    "G0",
    "G1",
    "G2",
    "G3",
    "G4 P",
    "G5.1",
    "G10 L1",
    "G10 L2",
    "G10 L20",
    "G17",
    "G18",
    "G19",
    "G20",
    "G21",
    "G28",
    "G28.1",
    "G30",
    "G33",
    "G33.1",
    "G38.2",
    "G40",
    "G41",
    "G41.1 D",
    "G42",
    "G43",
    "G43.1",
    "G49",
    "G52",
    "G53",
    "G54",
    "G59.3",
    "G61",
    "G64 P",
    "G65 P",
    "G70",
    "G71",
    "G72",
    "G73",
    "G74",
    "G75",
    "G76",
    "G80",
    "G81",
    "G82",
    "G83",
    "G84",
    "G86",
    "G87",
    "G88",
    "G89",
    "G90",
    "G91",
    "G90.1",
    "G91.1",
    "G92",
    "G92.1",
    "G92.3",
    "G93",
    "G94",
    "G95",
    "G96",
    "G97",
    "G98",
    "G99",
    "G7",
    "G8",
    "G32",
    "G34",
    "G43 H2",
    "G44 H",
    "G54.1 P",
    "G66 P5",
    "G67",
    "G68 R",
    "G69",
    "G154 P",
    "G187 P",
    "G50",
    "M0",
    "M2",
    "M3",
    "M6",
    "M19",
    "M30",
    "M31",
    "M32",
    "M48",
    "M61",
    "M62",
    "M66",
    "M68",
    "M70",
    "M73",
    "M97 P",
    "M98",
    "M99",
    "T1 M6",
    "T0101",
    "N10",
    "O1000",
    "o1 sub",
    "o1 endsub",
    "o1 call",
    "o1 call [1] [2]",
    "o1 return [1]",
    "o1 while [1]",
    "o1 endwhile",
    "o1 if [#1 LT 3]",
    "o1 elseif [1]",
    "o1 else",
    "o1 endif",
    "o1 do",
    "o1 repeat [3]",
    "o1 endrepeat",
    "o1 break",
    "o1 continue",
    "o<a> sub",
    "o<a> call",
    "IF [#1 EQ #0] GOTO 10",
    "GOTO 10",
    "WHILE [1] DO 1",
    "END 1",
    "IF [1] THEN #1=2",
    "#1=[#1+1]",
    "#<x>=1",
    "#<_x>",
    "#<_g>=2",
    "#5221",
    "#3000=1",
    "#3006=1",
    "##1",
    "#[1]",
    "[",
    "]",
    "(",
    ")",
    "(MSG,x)",
    "(DEBUG,#1)",
    "(PRINT,#<x>)",
    "(LOGOPEN,a)",
    ";",
    "%",
    "/",
    "@5",
    "^30",
    "$0",
    ",A45",
    ",C1",
    ",R1",
    "E1",
    "Q1",
    "P10 Q20",
    "SQRT[",
    "ATAN[1]/[2]",
    "ACOS[",
    "LN[",
    "EXISTS[#<x>]",
    "MOD",
    "**",
    "XOR",
    "ROUND[",
    "FUP[",
    "EXP[",
    " ",
    "\n",
    "\r\n",
    "\t",
    "\u{fc}",
    "\0",
    "=",
];

const NUMBERS: &[&str] = &[
    "0",
    "1",
    "-1",
    "0.0001",
    "1e9",
    "-0",
    "99999",
    "2147483647",
    "4294967296",
    "9999999999999",
    "1.",
    ".5",
    "-.5",
    "360",
    "0.1",
    "1000000",
    "0.000000000001",
    "5399",
    "5602",
    "3.14159",
    "+2",
    "--2",
    "255",
    "65536",
    "18446744073709551616",
];

/// Longest mutation, bytes.
const LONGEST: usize = 6000;

/// A range within so many bytes: in most cases a short one.
fn range(random: &mut Seed, length: usize) -> std::ops::Range<usize> {
    let start = random.below(length + 1);
    let long = if random.below(8) == 0 { length } else { 24 };
    start..(start + random.below(long)).min(length)
}

/// The mutation of a number.
pub(crate) fn mutation(corpus: &[Vec<u8>], number: u64) -> Vec<u8> {
    let mut random = Seed::new(number.wrapping_mul(0xD134_2543_DE82_EF95));
    let mut bytes = corpus[random.below(corpus.len())].clone();
    for _ in 0..=random.below(6) {
        change(&mut bytes, corpus, &mut random);
    }
    bytes.truncate(LONGEST);
    bytes
}

/// One change: bits, bytes, ranges, lines, words, numbers, pieces of others.
fn change(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], random: &mut Seed) {
    let at = random.below(bytes.len());
    match random.below(12) {
        0 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.below(8)),
        1 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte = random.below(256) as u8),
        2 => drop(bytes.drain(range(random, bytes.len()))),
        3 => {
            let piece = bytes[range(random, bytes.len())].repeat(1 + random.below(4));
            insert(bytes, at, &piece);
        }
        4 => {
            let other = &corpus[random.below(corpus.len())];
            insert(bytes, at, &other[range(random, other.len())]);
        }
        5 => insert(bytes, at, random.of(DICTIONARY).as_bytes()),
        6 => number(bytes, at, random),
        7 => {
            let (line, to) = (line_at(bytes, at), random.below(bytes.len()));
            let line = bytes[line].to_vec();
            insert(bytes, line_at(bytes, to).start, &line);
        }
        8 => drop(bytes.drain(line_at(bytes, at))),
        9 => {
            let other = &corpus[random.below(corpus.len())];
            let line = other[line_at(other, random.below(other.len()))].to_vec();
            insert(bytes, line_at(bytes, at).start, &line);
        }
        10 => {
            let line = line_at(bytes, at);
            insert(bytes, line.start, random.of(DICTIONARY).as_bytes());
        }
        _ => bytes.truncate(at),
    }
}

fn insert(bytes: &mut Vec<u8>, at: usize, piece: &[u8]) {
    if bytes.len() < LONGEST {
        bytes.splice(at..at, piece.iter().copied());
    }
}

/// Puts another number in place of the next one.
fn number(bytes: &mut Vec<u8>, at: usize, random: &mut Seed) {
    let of_number = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
    let Some(start) = bytes.iter().skip(at).position(of_number).map(|start| start + at) else { return };
    let length = bytes[start..].iter().take_while(|byte| of_number(byte)).count();
    bytes.splice(start..start + length, random.of(NUMBERS).bytes());
}

/// The line that a byte belongs to, with its end.
fn line_at(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |start| start + 1);
    let end = bytes[at..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |end| at + end + 1);
    start..end
}
