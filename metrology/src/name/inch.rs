//! Names that begin with a size in inches: `1/4-20 UNC-2A/2B`, `1 1/8-5 ACME-2G`, `1/2-14 NPT`, `3/16-24
//! BSW`; and sizes of pipe threads. Out: a thread whose sizes and classes exist.

use std::ops::{Range, RangeInclusive};

use super::{
    cursor::{Cursor, Misread, wrong_at},
    metric::list,
    size::{self, InchSize},
};
use crate::{
    acme::Acme,
    basic::Whitworth,
    buttress::{self, Buttress},
    pipe::{self, Taper},
    series::Series,
    thread::Form,
    unified::{Root, Unified},
};

/// Series that exist and are not here, and what to take or know instead.
const ELSEWHERE: [(&str, &str); 8] = [
    ("STUB", "stub Acme (ASME B1.8) is not known here; ACME-2G is general purpose"),
    ("NPTF", "dryseal threads (ASME B1.20.3) are not known here; NPT is"),
    ("NPS", "straight pipe threads (NPSM, NPSC, ...) are not known here; NPT and G are"),
    ("NC", "write UNC"),
    ("NF", "write UNF"),
    ("BSF", "BSF is not known here; BSW is, with basic sizes"),
    ("BSPP", "write G and the size, as in G1/2-A"),
    ("BSPT", "write R and the size, as in R1/2"),
];

/// What a size and threads per inch may be followed by.
const SERIES: &str =
    "UNC, UNF, UNEF, UN, UNS, UNRC ..., UNJC ... with a class as in -2A/2B; ACME-2G; BUTT-2A; NPT; BSW";

/// Reads a name that begins with its size.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Form, Misread> {
    let at = cursor.at();
    let size = size::read(cursor)?;
    let mut at = at..cursor.at();
    cursor.spaces();
    let tpi = if cursor.one_of("-").is_some() { Some(threads_per_inch(cursor)?) } else { None };
    if tpi.is_some() {
        at.end = cursor.at();
    }
    cursor.spaces();
    let from = cursor.at();
    let series = cursor.letters().to_ascii_uppercase();
    if series == "NPT" {
        return taper(size, tpi, at);
    }
    let elsewhere = ELSEWHERE.iter().find(|(of, _)| series.starts_with(of));
    if let Some((of, help)) = elsewhere {
        return Err(cursor.wrong(from, format!("{of} is another thread"), *help));
    }
    let missing = || {
        let help = "write the number of threads per inch behind a hyphen, as in 1/4-20 UNC";
        wrong_at(at.clone(), "the threads per inch are missing", help)
    };
    match series.as_str() {
        "ACME" => acme(cursor, size, tpi.ok_or_else(missing)?, at.clone()),
        "BUTT" => buttress(cursor, size, tpi.ok_or_else(missing)?, (false, at.clone())),
        "PUSH" if cursor.one_of("-").is_some() && cursor.word("BUTT") => {
            buttress(cursor, size, tpi.ok_or_else(missing)?, (true, at.clone()))
        }
        "BSW" => whitworth(size, tpi.ok_or_else(missing)?, at.clone()),
        "" => Err(cursor.wrong(from, "the series is missing", format!("write one of {SERIES}"))),
        _ => {
            let (letters, root) = match series.strip_prefix("UN") {
                Some(rest) => match (rest.strip_prefix('R'), rest.strip_prefix('J')) {
                    (Some(letters), _) => (Some(letters), Root::Rounded),
                    (_, Some(letters)) => (Some(letters), Root::Large),
                    (None, None) => (Some(rest), Root::Flat),
                },
                None => (None, Root::Flat),
            };
            let known = letters.and_then(|of| Series::ALL.iter().find(|(letters, _)| *letters == of));
            let Some((_, known)) = known else {
                return Err(cursor.wrong(
                    from,
                    format!("the series {series} is not known"),
                    format!("known are {SERIES}"),
                ));
            };
            let (size, tpi) = match tpi {
                Some(tpi) => (size.of_unified(tpi), tpi),
                None => sole_pitch(size, *known).ok_or_else(missing)?,
            };
            unified(cursor, size, tpi, (*known, root), at)
        }
    }
}

/// The one pitch that a series has for a size, if it gives one. A whole number may be a small size or inches:
/// then there may be two.
fn sole_pitch(size: InchSize, series: Series) -> Option<(InchSize, f64)> {
    let pitch = |size: InchSize| Some((size, series.threads_per_inch(size.inches())?));
    match (pitch(size), size.as_number().and_then(pitch)) {
        (Some(_), Some(_)) => None,
        (inches, number) => inches.or(number),
    }
}

fn threads_per_inch(cursor: &mut Cursor<'_>) -> Result<f64, Misread> {
    cursor.spaces();
    let from = cursor.at();
    let found = cursor.number().filter(|tpi| (1.0..=120.0).contains(tpi));
    found.ok_or_else(|| {
        let help = "a number from 1 to 120, as in 1/4-20 UNC";
        cursor.wrong(from, "this is not a number of threads per inch", help)
    })
}

/// Refuses a pitch that is too large for a size.
fn fits(size: InchSize, tpi: f64, least: f64, at: Range<usize>) -> Result<(), Misread> {
    if size.inches() * tpi >= least {
        return Ok(());
    }
    let help = format!("its diameter is at least {least} pitches");
    Err(wrong_at(at, format!("{tpi} threads per inch do not fit on {size} in"), help))
}

/// The digits and letters of the classes behind a hyphen or a space; none without.
fn classes(
    cursor: &mut Cursor<'_>,
    digits: RangeInclusive<u8>,
    letters: &str,
    help: &str,
) -> Result<Vec<(u8, char)>, Misread> {
    if !cursor.class() {
        return Ok(Vec::new());
    }
    let mut found: Vec<(u8, char)> = Vec::new();
    loop {
        let from = cursor.at();
        let digit = cursor.whole().and_then(|digit| u8::try_from(digit).ok());
        let letter = cursor.one_of("ABCGabcg").filter(|letter| letters.contains(*letter));
        let class = digit
            .filter(|digit| digits.contains(digit))
            .zip(letter)
            .map(|(digit, letter)| (digit, letter.to_ascii_uppercase()));
        let Some(class) = class else {
            return Err(cursor.wrong(from, "this is not a class", help));
        };
        if found.iter().any(|(_, letter)| *letter == class.1) {
            return Err(cursor.wrong(from, "there are two classes of one member", help));
        }
        found.push(class);
        if cursor.one_of("/").is_none() {
            return Ok(found);
        }
    }
}

fn unified(
    cursor: &mut Cursor<'_>,
    size: InchSize,
    tpi: f64,
    (series, root): (Series, Root),
    at: Range<usize>,
) -> Result<Form, Misread> {
    if series.gives_the_pitch() && series.threads_per_inch(size.inches()) != Some(tpi) {
        let letters = series.letters();
        let message = format!("UN{letters} does not have {size}-{tpi}");
        let help = match series.threads_per_inch(size.inches()) {
            Some(has) => format!("it has {size}-{has}; another pitch is UNS, as in {size}-{tpi} UNS"),
            None => format!("sizes that it does not have are UN or UNS, as in {size}-{tpi} UNS"),
        };
        return Err(wrong_at(at, message, help));
    }
    if let Some(coarse) = size.coarser_than(tpi) {
        let help = format!("write it in inches, as in {:.3}-{tpi} UNS", size.inches());
        return Err(wrong_at(at, format!("number {size} has at least {coarse} threads per inch"), help));
    }
    fits(size, tpi, 3.0, at)?;
    let (least, usual, help) = match root {
        Root::Large => {
            (2, 3, "UNJ of ASME B1.15 has 2A and 3A for screws and 2B and 3B for nuts, as in 3A/3B")
        }
        _ => (1, 2, "ASME B1.1 has 1A, 2A, 3A for screws and 1B, 2B, 3B for nuts, as in 2A/2B"),
    };
    let found = classes(cursor, least..=3, "ABab", help)?;
    let of = |letter| found.iter().find(|(_, of)| *of == letter).map(|(digit, _)| *digit);
    let [external, internal] = if found.is_empty() { [Some(usual); 2] } else { ['A', 'B'].map(of) };
    Ok(Form::Unified(Unified { size, tpi, series, root, external, internal }))
}

fn acme(cursor: &mut Cursor<'_>, size: InchSize, tpi: f64, at: Range<usize>) -> Result<Form, Misread> {
    if !(0.25..=5.0).contains(&size.inches()) {
        let help = "ASME B1.5 has sizes from 1/4 to 5 in";
        return Err(wrong_at(at, format!("ACME of {size} in does not exist"), help));
    }
    fits(size, tpi, 2.5, at)?;
    let help = "classes of general purpose are 2G, 3G and 4G; centralizing ones (2C ...) are not known here";
    let found = classes(cursor, 2..=4, "Gg", help)?;
    let class = found.first().map_or(2, |(class, _)| *class);
    Ok(Form::Acme(Acme { size, tpi, class }))
}

fn buttress(
    cursor: &mut Cursor<'_>,
    size: InchSize,
    tpi: f64,
    (push, at): (bool, Range<usize>),
) -> Result<Form, Misread> {
    if !buttress::SIZES.contains(&size.inches()) || !(1.0..=20.0).contains(&tpi) {
        let help = "here are sizes from 1/2 to 12 in with 1 to 20 threads per inch";
        return Err(wrong_at(
            at,
            format!("BUTT of {size} in with {tpi} threads per inch does not exist"),
            help,
        ));
    }
    fits(size, tpi, 4.0, at)?;
    let help = "ASME B1.9 has 2A and 3A for screws and 2B and 3B for nuts, as in 2A/2B";
    let found = classes(cursor, 2..=3, "ABab", help)?;
    let of = |letter| found.iter().find(|(_, of)| *of == letter).map(|(digit, _)| *digit);
    let [external, internal] = if found.is_empty() { [Some(2); 2] } else { ['A', 'B'].map(of) };
    Ok(Form::Buttress(Buttress { size, tpi, push, external, internal }))
}

fn whitworth(size: InchSize, tpi: f64, at: Range<usize>) -> Result<Form, Misread> {
    if let InchSize::Number(number) = size {
        let help = "only unified threads have numbers for sizes; write it in inches, as in 1/4-20 BSW";
        return Err(wrong_at(at, format!("BSW has no number {number}"), help));
    }
    fits(size, tpi, 3.0, at)?;
    Ok(Form::Whitworth(Whitworth { size, tpi }))
}

/// Size and threads per inch behind the letters BSW.
pub(super) fn whitworth_first(cursor: &mut Cursor<'_>) -> Result<Form, Misread> {
    cursor.spaces();
    let at = cursor.at();
    let size = size::read(cursor)?;
    cursor.spaces();
    if cursor.one_of("-").is_none() {
        let help = "write them as in BSW 3/16-24";
        return Err(cursor.wrong(at, "the threads per inch are missing", help));
    }
    let tpi = threads_per_inch(cursor)?;
    whitworth(size, tpi, at..cursor.at())
}

/// Size, and threads per inch if they are written, behind the letters NPT.
pub(super) fn taper_first(cursor: &mut Cursor<'_>) -> Result<Form, Misread> {
    cursor.spaces();
    let at = cursor.at();
    let size = size::read(cursor)?;
    let end = cursor.at();
    cursor.spaces();
    if cursor.one_of("-").is_none() {
        return taper(size, None, at..end);
    }
    let tpi = threads_per_inch(cursor)?;
    taper(size, Some(tpi), at..cursor.at())
}

fn taper(size: InchSize, tpi: Option<f64>, at: Range<usize>) -> Result<Form, Misread> {
    let (written, sizes) = (size.to_string(), pipe::taper_sizes());
    let Some((size, has)) = sizes.iter().find(|(of, _)| *of == written) else {
        let help = format!("known are {}", list(sizes.iter().map(|(size, _)| size)));
        return Err(wrong_at(at, format!("NPT does not have the size {written}"), help));
    };
    if tpi.is_some_and(|tpi| tpi != *has) {
        let help = format!("write {size}-{has} NPT");
        return Err(wrong_at(at, format!("NPT {size} has {has} threads per inch"), help));
    }
    Ok(Form::Taper(Taper { size }))
}

/// A size of ISO 228-1 or ISO 7-1, one of those that exist.
pub(super) fn pipe_size(
    cursor: &mut Cursor<'_>,
    letters: &str,
    sizes: &[&'static str],
) -> Result<&'static str, Misread> {
    cursor.spaces();
    let from = cursor.at();
    let written = size::read(cursor)?.to_string();
    let written = written.strip_suffix(".0").unwrap_or(&written);
    let found = sizes.iter().find(|size| **size == written);
    found.copied().ok_or_else(|| {
        let help = format!("known are {}", list(sizes));
        cursor.wrong(from, format!("{letters} does not have the size {written}"), help)
    })
}
