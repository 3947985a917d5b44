//! A drawing of a groove from what a person writes. In: text, mm. Out: a [`Drawn`], or where the text is
//! wrong and what would be right.
//!
//! ```text
//! text = part { , part }      part = row | face | internal | LH | A degrees | within mm
//! row  = { Z place | D diameter of the root | K lead | R radius of the arc from the row before }
//! ```
//! What a row does not say is as in the row before. A lead that jumps has two rows at one place.

use std::ops::Range;
use std::str::FromStr;

use metrology::Misread;

use super::{Drawn, DrawnSide, Row, SAME_MM, WITHIN_MM};

/// What a drawing looks like.
const LOOKS: &str = "write rows along the groove, as in Z0 D29 K3, Z-40 K5, Z-60, within 0.02";
/// Rows at most.
const MOST_ROWS: usize = 64;
/// Farthest and longest that is drawn, mm.
const MOST_MM: f64 = 1e5;
/// Turns at most.
const MOST_TURNS: f64 = 1e4;
/// Least lead and tolerance, mm.
const LEAST_MM: f64 = 1e-3;

/// What rows say, from one to the next.
#[derive(Clone, Copy, Default)]
struct Said {
    z: Option<f64>,
    d: Option<f64>,
    k: Option<f64>,
    r: Option<f64>,
}

fn wrong<T>(span: Range<usize>, message: String) -> Result<T, Misread> {
    Err(Misread { span, message, help: LOOKS.into() })
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.abs() <= MOST_MM)
}

impl FromStr for Drawn {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Drawn, Misread> {
        let (mut side, mut left_hand, mut within_mm) = (DrawnSide::External, false, WITHIN_MM);
        let (mut said, mut at, mut angle_deg) = (Vec::new(), 0, None);
        for part in text.split(',') {
            let span = at..at + part.len();
            at = span.end + 1;
            let words: Vec<&str> = part.split_whitespace().collect();
            let lower = words.first().map(|word| word.to_ascii_lowercase()).unwrap_or_default();
            match (lower.as_str(), &words[..]) {
                ("face", [_]) => side = DrawnSide::Face,
                ("internal", [_]) => side = DrawnSide::Internal,
                ("external", [_]) => side = DrawnSide::External,
                ("lh", [_]) => left_hand = true,
                ("within", [_, mm]) => match number(mm).filter(|mm| *mm >= LEAST_MM) {
                    Some(mm) => within_mm = mm,
                    None => return wrong(span, format!("within {mm} is no tolerance of 0.001 mm or more")),
                },
                (key, [word]) if key.starts_with('a') => {
                    match number(&word[1..]).filter(|deg| (0.0..=160.0).contains(deg)) {
                        Some(deg) => angle_deg = Some(deg),
                        None => return wrong(span, format!("{word} is no angle of 0 to 160 degrees")),
                    }
                }
                _ if words.is_empty() => return wrong(span, "a row is empty".into()),
                _ => {
                    let before = said.last().map(|(_, said)| *said).unwrap_or_default();
                    said.push((span.clone(), row(span, &words, before)?));
                }
            }
        }
        let rows = rows(text, &said, side)?;
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        Ok(Drawn { text, side, left_hand, angle_deg, within_mm, rows })
    }
}

/// The words of a row on top of what the row before said.
fn row(span: Range<usize>, words: &[&str], before: Said) -> Result<Said, Misread> {
    let mut said = Said { r: None, ..before };
    for word in words {
        let key = word.chars().next().map(|key| key.to_ascii_uppercase());
        let value = key.and_then(|key| number(&word[key.len_utf8()..]));
        let slot = match key {
            Some('Z') => &mut said.z,
            Some('D') => &mut said.d,
            Some('K') => &mut said.k,
            Some('R') => &mut said.r,
            _ => return wrong(span, format!("{word:?} is not understood")),
        };
        if value.is_none() {
            return wrong(span, format!("{word:?} is not understood"));
        }
        *slot = value;
    }
    Ok(said)
}

/// Rows from the lowest on.
fn rows(text: &str, said: &[(Range<usize>, Said)], side: DrawnSide) -> Result<Vec<Row>, Misread> {
    let mut rows = Vec::with_capacity(said.len());
    for (span, said) in said {
        let Said { z: Some(z), d: Some(d), k: Some(k), r } = *said else {
            return wrong(span.clone(), "Z, D or K of the first row is missing".into());
        };
        if d <= 0.0 && side != DrawnSide::Face || d < 0.0 || k < LEAST_MM {
            return wrong(span.clone(), "D and K are above 0".into());
        }
        let [along_mm, root_mm] = if side == DrawnSide::Face { [0.5 * d, z] } else { [z, 0.5 * d] };
        rows.push(Row { along_mm, root_mm, lead_mm: k, arc_mm: r });
    }
    if !(2..=MOST_ROWS).contains(&rows.len()) {
        return wrong(
            0..text.len(),
            format!("a groove has 2 to {MOST_ROWS} rows, and this one {}", rows.len()),
        );
    }
    let falls = rows[rows.len() - 1].along_mm < rows[0].along_mm;
    for (i, pair) in rows.windows(2).enumerate() {
        let [step, half] = [pair[1].along_mm - pair[0].along_mm, pair[1].root_mm - pair[0].root_mm];
        let (span, chord) = (said[i + 1].0.clone(), libm::hypot(step, half));
        if step * if falls { -1.0 } else { 1.0 } < -SAME_MM {
            return wrong(span, "rows go one way along the groove".into());
        }
        if pair[1].arc_mm.is_some_and(|r| 2.0 * r.abs() < chord || chord < SAME_MM || step.abs() < SAME_MM) {
            return wrong(
                span,
                "an arc of this radius does not reach from the row before to this one".into(),
            );
        }
    }
    if falls {
        // An arc belongs to the row at which it ends.
        let arcs: Vec<_> = rows.iter().map(|row| row.arc_mm).collect();
        rows.reverse();
        for (row, arc) in rows.iter_mut().zip([None].into_iter().chain(arcs.into_iter().rev())) {
            row.arc_mm = arc;
        }
    }
    if rows[rows.len() - 1].along_mm - rows[0].along_mm < SAME_MM {
        return wrong(0..text.len(), "the groove has no length".into());
    }
    let turns: f64 = rows
        .windows(2)
        .map(|pair| 2.0 * (pair[1].along_mm - pair[0].along_mm) / (pair[0].lead_mm + pair[1].lead_mm))
        .sum();
    if turns > MOST_TURNS {
        return wrong(
            0..text.len(),
            format!("the groove has {turns:.0} turns, and at most {MOST_TURNS:.0} are judged"),
        );
    }
    Ok(rows)
}
