//! A gauge from what a person writes: the name of a thread, or numbers. In: text, lengths in mm, angles in
//! degrees. Out: a [`Nominal`], or where the text is wrong and what would be right.
//!
//! ```text
//! text    = (name | numbers) [tap length] [blunt turns..turns]
//! name    = as `metrology` reads it, with a class or a side
//! numbers = P pitch D2 limits { A angle | external | internal | LH | starts n | crest limits | root limits
//!           | taper 1:n | at Z | length L }
//! limits  = least..most; of crest and root one of them may be left out
//! ```
//!
//! | word | what | unless it is said |
//! |---|---|---|
//! | `P`, `starts` | distance of grooves along the axis; number of grooves beside each other | –, 1 |
//! | `D2`, `crest`, `root` | limits of the diameters | –, not looked at |
//! | `A` | angle between the flanks, half of it to either side | 60 |
//! | `taper` | change of diameter per length: a screw grows away from its face, a nut shrinks | 0 |
//! | `at` | where the diameters of a cone hold, along Z of the program | 0, the face |
//! | `length` | length of the GO gauge | the larger limit of D2 |
//! | `tap` | how far from its point a tapered tap has the diameter of the plane | no tapered tap is judged |
//! | `blunt` | turns behind the face up to which the ridge is gone, and from which on whole | not looked at |
//!
//! The words come in any order, in capitals or not, and a number may stand apart from its letter.

use std::{ops::Range, str::FromStr};

use metrology::{Misread, Side, Thread};

use super::{Nominal, NominalError};

/// What numbers look like.
const NUMBERS: &str = "write numbers as in P2 D2 18.503..18.663 A60 external starts 1 crest 19.682..19.962";

impl FromStr for Nominal {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Nominal, Misread> {
        if let Some((thread, turns)) = behind(text, "blunt") {
            let nominal: Nominal = thread.parse()?;
            let name = format!("{} blunt {turns}", nominal.name);
            let turns = limits(turns).and_then(|[gone, whole]| Some([gone?, whole?]));
            let blunt = Nominal { name, blunt_turns: turns, ..nominal };
            return match turns {
                Some(_) if blunt.check().is_ok() => Ok(blunt),
                _ => Err(Misread {
                    span: thread.len()..text.len(),
                    message: "behind blunt two numbers of turns are missing, up to 4, the smaller one first".into(),
                    help: "write blunt 0.9..1: the ridge is gone for 0.9 turns behind the face, and whole from 1 on".into(),
                }),
            };
        }
        let Some((thread, length)) = behind(text, "tap") else { return read(text) };
        let nominal = read(thread)?;
        let span = thread.len()..text.len();
        if nominal.side != Side::Internal || nominal.taper == 0.0 {
            return Err(wrong(span, "a tap is told of a nut that is tapered".into()));
        }
        let tap_mm = number(length).filter(|mm| (0.1..=500.0).contains(mm));
        let tap_mm = tap_mm.ok_or_else(|| wrong(span, format!("{length:?} behind tap is not a length")))?;
        Ok(Nominal { name: format!("{} tap {tap_mm}", nominal.name), tap_mm: Some(tap_mm), ..nominal })
    }
}

/// Reads a name or numbers.
fn read(text: &str) -> Result<Nominal, Misread> {
    let refused = |why: NominalError| Misread {
        span: 0..text.len(),
        message: why.to_string(),
        help: why.help().into(),
    };
    let first = text.trim_start().as_bytes();
    if first.first().is_some_and(|p| p.eq_ignore_ascii_case(&b'P'))
        && first.get(1).is_some_and(|next| next.is_ascii_digit() || b" \t.-+".contains(next))
    {
        let nominal = numbers(text)?;
        return nominal.check().map(|()| nominal).map_err(refused);
    }
    let thread: Thread = text.parse()?;
    Nominal::of(&thread).map_err(|why| match why {
        NominalError::NoLimits => Misread { help: by_numbers(&thread), ..refused(why) },
        _ => refused(why),
    })
}

/// What stands before a word and behind it, where that ends the text.
fn behind<'a>(text: &'a str, asked: &str) -> Option<(&'a str, &'a str)> {
    let (before, told) = text.trim_end().rsplit_once(char::is_whitespace)?;
    let (thread, word) = before.trim_end().rsplit_once(char::is_whitespace)?;
    word.eq_ignore_ascii_case(asked).then_some((thread, told))
}

/// How a thread without limits is written by numbers.
fn by_numbers(thread: &Thread) -> String {
    let profile = thread.profile();
    let middle = 0.5 * (profile.major_mm + profile.minor_mm);
    let angle: f64 = profile.flank_deg.iter().sum();
    format!(
        "give your limits by numbers, P{:.4} D2 least..most A{angle} external or internal: its basic pitch \
         diameter is {middle:.3} mm",
        profile.pitch_mm
    )
}

/// What is said so far.
#[derive(Default)]
struct Said {
    pitch: Option<f64>,
    pitch_diameter: Option<[Option<f64>; 2]>,
    angle: Option<f64>,
    side: Option<Side>,
    left_hand: Option<bool>,
    starts: Option<f64>,
    crest: Option<[Option<f64>; 2]>,
    root: Option<[Option<f64>; 2]>,
    taper: Option<f64>,
    at: Option<f64>,
    length: Option<f64>,
}

/// Words of a text with their places.
struct Words<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Words<'a> {
    /// The next word.
    fn next(&mut self) -> Option<(Range<usize>, &'a str)> {
        let rest = &self.text[self.at..];
        let start = self.at + rest.len() - rest.trim_start().len();
        let word = self.text[start..].split_whitespace().next()?;
        self.at = start + word.len();
        Some((start..self.at, word))
    }

    /// What stands behind a word, read as something.
    fn value<T>(&mut self, key: &str, what: &str, read: impl Fn(&str) -> Option<T>) -> Result<T, Misread> {
        let end = self.text.len();
        let (span, word) = self.next().unwrap_or((end..end, ""));
        let message = || match word {
            "" => format!("behind {key} {what} is missing"),
            _ => format!("{word:?} behind {key} is not {what}"),
        };
        read(word).ok_or_else(|| wrong(span.clone(), message()))
    }
}

fn wrong(span: Range<usize>, message: String) -> Misread {
    Misread { span, message, help: NUMBERS.into() }
}

fn number(word: &str) -> Option<f64> {
    word.replace(',', ".").parse().ok().filter(|number: &f64| number.is_finite())
}

/// `least..most`, one of which may be missing.
fn limits(word: &str) -> Option<[Option<f64>; 2]> {
    let (least, most) = word.split_once("..")?;
    let limit = |word: &str| if word.is_empty() { Some(None) } else { number(word).map(Some) };
    let limits = [limit(least)?, limit(most)?];
    limits.iter().any(Option::is_some).then_some(limits)
}

/// `1:16` or `0.0625`.
fn taper(word: &str) -> Option<f64> {
    match word.split_once(':') {
        Some((rise, run)) => Some(number(rise)? / number(run).filter(|run| *run != 0.0)?),
        None => number(word),
    }
}

/// Reads a thread by its numbers.
fn numbers(text: &str) -> Result<Nominal, Misread> {
    let mut words = Words { text, at: 0 };
    let mut said = Said::default();
    while let Some((span, word)) = words.next() {
        let twice = take(&mut said, &mut words, (span.clone(), word))?;
        if twice {
            return Err(wrong(span, format!("{word:?} is said twice")));
        }
    }
    let missing = |what: &str| wrong(0..text.len(), format!("{what} is missing"));
    let pitch_mm = said.pitch.ok_or_else(|| missing("the pitch, P,"))?;
    let Some([Some(least), Some(most)]) = said.pitch_diameter else {
        return Err(missing("D2 with both limits of the pitch diameter"));
    };
    let side = said.side.unwrap_or(Side::External);
    let [root, crest] = [said.root, said.crest].map(Option::unwrap_or_default);
    let starts = said.starts.unwrap_or(1.0);
    if !(1.0..=100.0).contains(&starts) || starts.fract() != 0.0 {
        return Err(wrong(0..text.len(), format!("a thread has no {starts} starts")));
    }
    let taper = said.taper.unwrap_or(0.0);
    Ok(Nominal {
        name: text.split_whitespace().collect::<Vec<_>>().join(" "),
        side,
        flank_deg: [0.5 * said.angle.unwrap_or(60.0); 2],
        pitch_mm,
        starts: starts as u32,
        grows: said.left_hand.unwrap_or(false),
        pitch_diameter_mm: [least, most],
        crest_mm: crest,
        root_go_mm: if side == Side::External { root[1] } else { root[0] },
        root_mm: root,
        taper: if side == Side::External { -taper } else { taper },
        plane_mm: said.at.unwrap_or(0.0),
        gauge_mm: said.length.unwrap_or(most),
        tap_mm: None,
        blunt_turns: None,
        left_out: &[],
    })
}

/// Takes a word with what belongs to it. True if it was said before.
fn take(said: &mut Said, words: &mut Words, (span, word): (Range<usize>, &str)) -> Result<bool, Misread> {
    let key = word.to_ascii_lowercase();
    let range = "a range, as in 18.503..18.663";
    Ok(match key.as_str() {
        "external" => said.side.replace(Side::External).is_some(),
        "internal" => said.side.replace(Side::Internal).is_some(),
        "lh" => said.left_hand.replace(true).is_some(),
        "d2" => said.pitch_diameter.replace(words.value("D2", range, limits)?).is_some(),
        "crest" => said.crest.replace(words.value("crest", range, limits)?).is_some(),
        "root" => said.root.replace(words.value("root", range, limits)?).is_some(),
        "starts" => said.starts.replace(words.value("starts", "a number", number)?).is_some(),
        "taper" => said.taper.replace(words.value("taper", "a taper, as in 1:16", taper)?).is_some(),
        "at" => said.at.replace(words.value("at", "a place along Z", number)?).is_some(),
        "length" => said.length.replace(words.value("length", "a length", number)?).is_some(),
        "p" => said.pitch.replace(words.value("P", "a pitch", number)?).is_some(),
        "a" => said.angle.replace(words.value("A", "an angle", number)?).is_some(),
        _ => {
            let slot = match key.as_bytes().first() {
                Some(b'p') => &mut said.pitch,
                Some(b'a') => &mut said.angle,
                _ => return Err(wrong(span, format!("{word:?} is not understood"))),
            };
            let joined = number(&key[1..]);
            slot.replace(joined.ok_or_else(|| wrong(span, format!("{word:?} is not understood")))?).is_some()
        }
    })
}
