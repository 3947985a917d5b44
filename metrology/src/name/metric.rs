//! Names of metric threads: `M20x2-6g/6H`, `MJ6x1-4h6h`, `Tr40x14P7-7e`. In: the place behind the letters.
//! Out: a thread whose sizes and classes exist.

use std::ops::Range;

use super::cursor::{Cursor, Misread, wrong_at};
use crate::{
    deviations::{self, Position},
    grades,
    iso_m::{Class, Metric, Zone, coarse_pitch},
    limits::Side,
    thread::Form,
    trapezoidal::{self, Trapezoidal},
};

/// Up to this diameter, mm, a name of M without a class means 6h/5H, ISO 965-1.
const SMALL: f64 = 1.4;
/// Up to this diameter, mm, the class of the nut of MJ is another one.
const SMALL_MJ: f64 = 5.0;
/// Most starts of a thread.
const STARTS: f64 = 32.0;

/// Numbers as a list for people.
pub(super) fn list(numbers: impl IntoIterator<Item = impl ToString>) -> String {
    numbers.into_iter().map(|number| number.to_string()).collect::<Vec<_>>().join(", ")
}

/// What stands behind the letters of a metric thread; mm.
struct Sizes {
    d: f64,
    pitch: f64,
    starts: u32,
    /// Where the diameter stands.
    d_at: Range<usize>,
    /// Where the pitch does; where the diameter does if there is none.
    pitch_at: Range<usize>,
}

/// Reads sizes. `coarse`: the pitch where none is written.
fn sizes(
    cursor: &mut Cursor<'_>,
    example: &str,
    coarse: impl Fn(f64) -> Option<f64>,
) -> Result<Sizes, Misread> {
    cursor.spaces();
    let from = cursor.at();
    let missing = |cursor: &Cursor<'_>, from: usize, what: &str| {
        cursor.wrong(from, format!("the {what} is missing"), format!("write it as in {example}"))
    };
    let d = cursor.number().ok_or_else(|| missing(cursor, from, "diameter"))?;
    let d_at = from..cursor.at();
    cursor.spaces();
    if cursor.one_of("xX×*").is_none() {
        let refused = || {
            let help = format!("write the pitch behind an x, as in {example}");
            wrong_at(d_at.clone(), format!("a diameter of {d} mm has no coarse pitch"), help)
        };
        let pitch = coarse(d).ok_or_else(refused)?;
        return Ok(Sizes { d, pitch, starts: 1, pitch_at: d_at.clone(), d_at });
    }
    cursor.spaces();
    // ISO 965-1 writes Ph before a lead, older names L.
    let _ = cursor.word("Ph") || cursor.word("L");
    let from = cursor.at();
    let lead = cursor.number().ok_or_else(|| missing(cursor, from, "pitch"))?;
    let pitch_at = from..cursor.at();
    cursor.spaces();
    let bracket = cursor.one_of("(").is_some();
    if !cursor.word("P") {
        return Ok(Sizes { d, pitch: lead, starts: 1, d_at, pitch_at });
    }
    cursor.spaces();
    let pitch = cursor.number().ok_or_else(|| missing(cursor, from, "pitch"))?;
    if bracket && cursor.one_of(")").is_none() {
        return Err(cursor.wrong(from, "the bracket is not closed", "write it as in Tr40x14(P7)"));
    }
    let starts = (lead / pitch).round();
    if pitch <= 0.0 || (starts * pitch - lead).abs() > 1e-6 || !(1.0..=STARTS).contains(&starts) {
        let help = format!("a lead is 1 to {STARTS} pitches, as in Tr40x14P7 with two starts");
        let message = format!("a lead of {lead} mm is not a number of pitches of {pitch} mm");
        return Err(cursor.wrong(from, message, help));
    }
    Ok(Sizes { d, pitch, starts: starts as u32, d_at, pitch_at: from..cursor.at() })
}

/// Reads M or MJ.
pub(super) fn read(cursor: &mut Cursor<'_>, mj: bool) -> Result<(Form, bool), Misread> {
    let example = if mj { "MJ6x1-4h6h/4H5H" } else { "M20x2-6g/6H" };
    let Sizes { d, pitch, starts, d_at, pitch_at } =
        sizes(cursor, example, |d| coarse_pitch(d).filter(|_| !mj))?;
    if grades::range(d).is_none() {
        let help = "ISO 965-1 has tolerances above 0.99 and up to 355 mm";
        return Err(wrong_at(d_at, format!("a diameter of {d} mm has no tolerances"), help));
    }
    if !deviations::pitches().any(|known| known == pitch) {
        let help = format!("the pitches of ISO 261 are {}", list(deviations::pitches()));
        return Err(wrong_at(pitch_at, format!("a pitch of {pitch} mm has no tolerances"), help));
    }
    if d < 3.0 * pitch {
        let help = "the pitch is at most a third of the diameter";
        return Err(wrong_at(pitch_at, format!("a pitch of {pitch} mm does not fit on {d} mm"), help));
    }
    let left = super::hand(cursor);
    let zone = |grade, position| Zone { grade, position };
    let class = |pitch, crest| Some(Class { pitch, crest });
    let (mut external, mut internal) = (None, None);
    let classes = cursor.class();
    let from = cursor.at();
    if classes {
        loop {
            let (side, read) = read_class(cursor, pitch)?;
            let slot = if side == Side::External { &mut external } else { &mut internal };
            if slot.replace(read).is_some() {
                let help = "name one of the screw, in small letters, and one of the nut, in capitals: 6g/6H";
                return Err(cursor.wrong(from, "there are two classes of one member", help));
            }
            if cursor.one_of("/").is_none() {
                break;
            }
        }
    } else if mj && d <= SMALL_MJ {
        let help = "write it behind a hyphen, as in MJ5x0.8-4h6h/4H6H";
        return Err(wrong_at(d_at, format!("MJ of {d} mm needs a class"), help));
    } else if mj {
        external = class(zone(4, Position::H), zone(6, Position::H));
        internal = class(zone(4, Position::H), zone(5, Position::H));
    } else {
        let (screw, nut) = if d <= SMALL {
            (zone(6, Position::H), zone(5, Position::H))
        } else {
            (zone(6, Position::G), zone(6, Position::H))
        };
        (external, internal) = (class(screw, screw), class(nut, nut));
        // No pitch below 0.25 has grade 5 of a nut, and none below 0.3 grade 6.
        internal = internal.filter(|class| is_defined(Side::Internal, *class, pitch));
    }
    Ok((Form::Metric(Metric { mj, d, pitch, starts, external, internal }), left))
}

fn is_defined(side: Side, class: Class, pitch: f64) -> bool {
    grades::has_pitch_grade(side, class.pitch.grade, pitch)
        && grades::has_crest_grade(side, class.crest.grade, pitch)
}

/// A class of one member: one or two pairs of grade and position.
fn read_class(cursor: &mut Cursor<'_>, pitch: f64) -> Result<(Side, Class), Misread> {
    let from = cursor.at();
    let (side, first) = zone(cursor)?;
    let second = if cursor.peek().is_some_and(|letter| letter.is_ascii_digit()) {
        let (other, second) = zone(cursor)?;
        if other != side {
            let help = "write a / between the class of the screw and that of the nut, as in 6g/6H";
            return Err(cursor.wrong(from, "small and capital letters in one class", help));
        }
        second
    } else {
        first
    };
    let class = Class { pitch: first, crest: second };
    if is_defined(side, class, pitch) {
        return Ok((side, class));
    }
    let (pitch_grades, crest_grades) = grades::known(side);
    let (member, crest) = match side {
        Side::External => ("a screw", "major"),
        Side::Internal => ("a nut", "minor"),
    };
    let help = format!(
        "ISO 965-1 has grades {} for the pitch diameter of {member} and {} for its {crest} diameter, the coarse ones from \
         P = 0.8 on only",
        list(pitch_grades),
        list(crest_grades)
    );
    let message = format!("{} is not defined for a pitch of {pitch} mm", class.text(side));
    Err(cursor.wrong(from, message, help))
}

/// A grade and a position; whose it is.
fn zone(cursor: &mut Cursor<'_>) -> Result<(Side, Zone), Misread> {
    let from = cursor.at();
    let grade = cursor.whole().and_then(|grade| u8::try_from(grade).ok());
    let letters = cursor.peek().filter(char::is_ascii_alphabetic);
    let (Some(grade), Some(letter)) = (grade, letters) else {
        let help = "a class is a grade and a position, as in 6g for a screw or 6H for a nut; a pitch stands behind an x";
        return Err(cursor.wrong(from, "this is not a tolerance class", help));
    };
    cursor.one_of(&letter.to_string());
    let side = if letter.is_ascii_uppercase() { Side::Internal } else { Side::External };
    let of_nut = |position| matches!(position, Position::G | Position::H);
    let found = Position::of(letter.to_ascii_lowercase());
    let found = found.filter(|position| side == Side::External || of_nut(*position));
    let help = || match letter {
        'A' => "positions AZ and AX of coated threads (ISO 965-4, 965-5) are not known here: G and H are",
        'a'..='d' => "positions a, b, c and d are not known here: e, f, g and h are",
        'A'..='Z' => "a nut has position G or H",
        _ => "a screw has position e, f, g or h",
    };
    match found {
        Some(position) => Ok((side, Zone { grade, position })),
        None => Err(cursor.wrong(from, format!("position {letter} is not known"), help())),
    }
}

/// Reads Tr.
pub(super) fn read_trapezoidal(cursor: &mut Cursor<'_>) -> Result<(Form, bool), Misread> {
    let Sizes { d, pitch, starts, d_at, pitch_at } = sizes(cursor, "Tr40x7-7e", |_| None)?;
    if !(8.0..=300.0).contains(&d) {
        let help = "ISO 2904 has diameters from 8 to 300 mm";
        return Err(wrong_at(d_at, format!("Tr of {d} mm does not exist"), help));
    }
    if !trapezoidal::pitches().any(|known| known == pitch) {
        let help = format!("the pitches of ISO 2902 are {}", list(trapezoidal::pitches()));
        return Err(wrong_at(pitch_at, format!("Tr does not have a pitch of {pitch} mm"), help));
    }
    if d < 2.5 * pitch {
        let help = "the pitch is at most two fifths of the diameter";
        return Err(wrong_at(pitch_at, format!("a pitch of {pitch} mm does not fit on {d} mm"), help));
    }
    let left = super::hand(cursor);
    let thread = |external, internal| Form::Trapezoidal(Trapezoidal { d, pitch, starts, external, internal });
    if !cursor.class() {
        return Ok((thread(Some((7, trapezoidal::Position::E)), Some(7)), left));
    }
    let (mut external, mut internal) = (None, None);
    let from = cursor.at();
    loop {
        let (grade, letter) = trapezoidal_class(cursor)?;
        let position = match letter {
            'c' => trapezoidal::Position::C,
            _ => trapezoidal::Position::E,
        };
        let twice = if letter == 'H' {
            internal.replace(grade).is_some()
        } else {
            external.replace((grade, position)).is_some()
        };
        if twice {
            let help = "name one of the screw and one of the nut: 7e/7H";
            return Err(cursor.wrong(from, "there are two classes of one member", help));
        }
        if letter != 'H' && trapezoidal::deviation(position, pitch).is_none() {
            let help = "7e and 8e are; or name a pitch of 1.5, 2, 3, 4, 5, 6 or 8";
            return Err(cursor.wrong(
                from,
                format!("position c is not known here for a pitch of {pitch} mm"),
                help,
            ));
        }
        if cursor.one_of("/").is_none() {
            return Ok((thread(external, internal), left));
        }
    }
}

/// A grade, and one of c, e and H.
fn trapezoidal_class(cursor: &mut Cursor<'_>) -> Result<(u8, char), Misread> {
    let from = cursor.at();
    let grade = cursor.whole().and_then(|grade| u8::try_from(grade).ok());
    let grade = grade.filter(|grade| (7..=9).contains(grade));
    let class = grade.zip(cursor.one_of("ceH"));
    class.ok_or_else(|| {
        let help = "ISO 2903 has 7e, 8e, 8c, 9c for screws and 7H, 8H, 9H for nuts";
        cursor.wrong(from, "this is not a tolerance class of Tr", help)
    })
}
