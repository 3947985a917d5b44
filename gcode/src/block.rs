//! A block: the words of one line, sorted by letter and modal group, with their places.
//!
//! One block is filled again and again, so that reading allocates nothing.

use crate::canon::Place;
use crate::codes::{G, G_GROUPS, M, M_GROUPS, group};
use crate::problem::{Blame, Problem, Span};

/// Room for the letters A to Z and the words that have none.
const WORDS: usize = 32;

/// `@`: distance of a polar point. `^`: its angle. `$`: spindle. `,C` and `,R` of FANUC are `c` and `r`.
pub(crate) const SPECIAL: [char; 5] = ['@', '^', '$', 'c', 'r'];

/// The bit of a letter in [`Block::present`].
pub(crate) const fn letter_bit(letter: char) -> u32 {
    1 << slot(letter)
}

const fn slot(letter: char) -> usize {
    match letter {
        'A'..='Z' => letter as usize - 'A' as usize,
        '@' => 26,
        '^' => 27,
        '$' => 28,
        'c' => 29,
        'r' => 30,
        _ => 31,
    }
}

/// The bits of some letters.
pub(crate) const fn letter_bits(letters: &str) -> u32 {
    let letters = letters.as_bytes();
    let (mut bits, mut i) = (0, 0);
    while i < letters.len() {
        bits |= letter_bit(letters[i] as char);
        i += 1;
    }
    bits
}

/// The letters of some bits of [`Block::present`], in the order of the alphabet.
pub(crate) fn letters_of(bits: u32) -> impl Iterator<Item = char> {
    places(bits).filter_map(|place| match place {
        0..26 => Some(char::from(b'A' + place as u8)),
        _ => SPECIAL.get(place - 26).copied(),
    })
}

/// Letters of X, Y, Z, A, B, C.
pub(crate) const AXES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// What a comment is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CommentKind {
    /// Text for the reader of the program.
    Plain,
    /// `(MSG,...)`.
    Message,
    /// `(DEBUG,...)`: parameters in it are replaced by their values.
    Debug,
    /// `(PRINT,...)`: the same, to standard output.
    Print,
    /// `(LOG,...)` `(LOGOPEN,...)` `(LOGAPPEND,...)` `(LOGCLOSE)`.
    Log,
}

/// A comment of a block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Comment {
    /// Kind.
    pub(crate) kind: CommentKind,
    /// Its text with the parameters of DEBUG, PRINT and LOG replaced; verbs of messages are left out, that of
    /// LOG stands in front.
    pub(crate) text: String,
}

/// The words of one line.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Line, from 1.
    pub(crate) line: u32,
    /// File, see [`Place`].
    pub(crate) file: u16,
    /// N word.
    pub(crate) n: Option<u32>,
    /// How many digits N was written with, see [`Place`].
    pub(crate) n_digits: u8,
    present: u32,
    values: [f64; WORDS],
    spans: [Span; WORDS],
    /// Bits of the groups that have a code. Values without their bit are old.
    g_present: u32,
    g: [G; G_GROUPS],
    g_spans: [Span; G_GROUPS],
    m_present: u32,
    m: [M; M_GROUPS],
    m_spans: [Span; M_GROUPS],
    /// The last comment of the line, and whether there is any.
    pub(crate) comment: Option<Comment>,
}

impl Default for Block {
    fn default() -> Block {
        Block {
            line: 0,
            file: 0,
            n: None,
            n_digits: 0,
            present: 0,
            values: [0.0; WORDS],
            spans: [Span::default(); WORDS],
            g_present: 0,
            g: [G(0); G_GROUPS],
            g_spans: [Span::default(); G_GROUPS],
            m_present: 0,
            m: [M(0); M_GROUPS],
            m_spans: [Span::default(); M_GROUPS],
            comment: None,
        }
    }
}

impl Block {
    /// Makes the block an empty one of `line`.
    pub(crate) fn clear(&mut self, file: u16, line: u32) {
        (self.file, self.line, self.n, self.n_digits, self.present) = (file, line, None, 0, 0);
        (self.g_present, self.m_present) = (0, 0);
        self.comment = None;
    }

    /// Makes the block one of `line` that has nothing but its N word, with the count of its digits.
    pub(crate) fn begin(&mut self, file: u16, line: u32, number: Option<(u32, u8)>) {
        self.clear(file, line);
        if let Some((number, digits)) = number {
            (self.n, self.n_digits) = (Some(number), digits);
        }
    }

    /// Where its calls come from.
    pub(crate) fn place(&self) -> Place {
        Place { file: self.file, line: self.line, n: self.n, n_digits: self.n_digits }
    }

    /// Adds the word of a letter.
    ///
    /// # Errors
    /// The letter stands in the block already.
    pub(crate) fn add(&mut self, letter: char, value: f64, span: Span) -> Result<(), Box<Problem>> {
        if self.has(letter) {
            let message = format!("{letter} stands in this block already");
            let help = "leave one of the two out, or put them in different blocks";
            return Err(Problem::error("repeated-word", Blame::Span(span), message, help));
        }
        let slot = slot(letter);
        self.present |= 1 << slot;
        (self.values[slot], self.spans[slot]) = (value, span);
        Ok(())
    }

    /// Adds a G code of a group. Beside another motion code G80 says nothing.
    ///
    /// # Errors
    /// The block has a code of that group.
    pub(crate) fn add_g(&mut self, group: usize, code: G, span: Span) -> Result<(), Box<Problem>> {
        const G80: G = G(800);
        let other = self.g(group);
        if code == G80 && other.is_some() {
            return Ok(());
        }
        if let Some(other) = other.filter(|other| *other != G80) {
            return Err(excluded(&code.to_string(), &other.to_string(), span));
        }
        self.g_present |= 1 << group;
        (self.g[group], self.g_spans[group]) = (code, span);
        Ok(())
    }

    /// Adds an M code of a group.
    ///
    /// # Errors
    /// The block has a code of that group.
    pub(crate) fn add_m(&mut self, group: usize, code: M, span: Span) -> Result<(), Box<Problem>> {
        if let Some(other) = self.m(group) {
            return Err(excluded(&code.to_string(), &other.to_string(), span));
        }
        self.m_present |= 1 << group;
        (self.m[group], self.m_spans[group]) = (code, span);
        Ok(())
    }

    /// Takes the word of a letter out.
    pub(crate) fn remove(&mut self, letter: char) {
        self.present &= !letter_bit(letter);
    }

    /// Whether the block has the word of a letter.
    pub(crate) fn has(&self, letter: char) -> bool {
        self.present >> slot(letter) & 1 == 1
    }

    /// The letters it has, as bits of [`letter_bit`].
    pub(crate) fn present(&self) -> u32 {
        self.present
    }

    /// The value of the word of a letter.
    pub(crate) fn get(&self, letter: char) -> Option<f64> {
        self.has(letter).then(|| self.values[slot(letter)])
    }

    /// The word of a letter as a whole number, if it is near one.
    pub(crate) fn integer(&self, letter: char) -> Option<i64> {
        let value = self.get(letter)?;
        let rounded = value.round();
        ((value - rounded).abs() < 1e-4 && rounded.abs() < 1e9).then_some(rounded as i64)
    }

    /// The letters of its words (no G, no M, no N), in the order of the alphabet.
    pub(crate) fn letters(&self) -> impl Iterator<Item = char> + use<> {
        letters_of(self.present)
    }

    /// The G code of a group.
    pub(crate) fn g(&self, group: usize) -> Option<G> {
        (self.g_present >> group & 1 == 1).then(|| self.g[group])
    }

    /// The M code of a group.
    pub(crate) fn m(&self, group: usize) -> Option<M> {
        (self.m_present >> group & 1 == 1).then(|| self.m[group])
    }

    /// Its G codes.
    pub(crate) fn g_codes(&self) -> impl Iterator<Item = G> + '_ {
        places(self.g_present).map(|group| self.g[group])
    }

    /// Its M codes.
    pub(crate) fn m_codes(&self) -> impl Iterator<Item = M> + '_ {
        places(self.m_present).map(|group| self.m[group])
    }

    /// Whether it has any word of X, Y, Z, A, B, C.
    pub(crate) fn has_axes(&self) -> bool {
        AXES.into_iter().any(|letter| self.has(letter))
    }

    /// The values of its axis words.
    pub(crate) fn axes(&self) -> [Option<f64>; 6] {
        AXES.map(|letter| self.get(letter))
    }

    /// Whether its only code is one of G0 to G3, if it has any, and it has no comment.
    pub(crate) fn only_moves(&self) -> bool {
        let moves = self.g_present & !(1 << group::MOTION) == 0
            && (self.g_present == 0 || matches!(self.g[group::MOTION].0, 0 | 10 | 20 | 30));
        moves && self.m_present == 0 && self.comment.is_none()
    }

    /// Whether it has a word or a code.
    pub(crate) fn has_words(&self) -> bool {
        self.present != 0 || self.g_present != 0 || self.m_present != 0
    }

    /// Whether it has no words, codes or comment.
    pub(crate) fn is_empty(&self) -> bool {
        !self.has_words() && self.comment.is_none()
    }

    /// The bytes of the line that `blame` means.
    pub(crate) fn span(&self, blame: Blame) -> Option<Span> {
        match blame {
            Blame::Span(span) => Some(span),
            Blame::Word(letter) => self.has(letter).then(|| self.spans[slot(letter)]),
            Blame::G(code) => {
                places(self.g_present).find(|group| self.g[*group] == code).map(|group| self.g_spans[group])
            }
            Blame::M(code) => {
                places(self.m_present).find(|group| self.m[*group] == code).map(|group| self.m_spans[group])
            }
            Blame::Block | Blame::Line(_) | Blame::At(_) | Blame::Part(..) => None,
        }
    }
}

/// The places of the bits that are set, lowest first.
fn places(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (place < u32::BITS).then_some(place as usize)
    })
}

fn excluded(code: &str, other: &str, span: Span) -> Box<Problem> {
    let message = format!("{code} and {other} exclude each other in one block");
    Problem::error(
        "modal-group",
        Blame::Span(span),
        message,
        "put them in different blocks, or leave one out",
    )
}
