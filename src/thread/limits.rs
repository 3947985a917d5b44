//! `pitchlock thread NAME --limits`: what a standard asks of a thread. In: its name. Out: a table, or one
//! JSON document:
//!
//! ```json
//! { "version": 1, "name": "M20x2-6g", "complete": "M20x2-6g", "standard": "ISO 965 M",
//!   "ext": { "d_max": 19.962, "d_min": 19.682, "d2_max": 18.663, "d2_min": 18.503 },
//!   "profile": { "pitch_mm": 2.0, "lead_mm": 2.0, "starts": 1, "flank_deg": [30.0, 30.0], "taper": 0.0 } }
//! ```
//! `ext` and `int` are in mm and have the members that the name has; `inch` holds the same in inches where
//! the standard is in inches. Keys: docs/metrology.md.

use std::collections::BTreeMap;

use metrology::{Limits, Member, Side, Size, Thread, Unit};
use serde::Serialize;

/// Sizes by their keys.
type Sizes = BTreeMap<&'static str, f64>;

#[derive(Serialize)]
struct Members {
    #[serde(skip_serializing_if = "Option::is_none")]
    ext: Option<Sizes>,
    #[serde(skip_serializing_if = "Option::is_none")]
    int: Option<Sizes>,
}

#[derive(Serialize)]
pub(super) struct Document<'a> {
    version: u32,
    name: &'a str,
    /// The same with everything that it leaves out.
    complete: String,
    standard: &'static str,
    #[serde(flatten)]
    mm: Members,
    #[serde(skip_serializing_if = "Option::is_none")]
    inch: Option<Members>,
    profile: Profile,
    note: &'static str,
}

/// The nominal profile.
#[derive(Serialize)]
struct Profile {
    flank_deg: [f64; 2],
    triangle_mm: f64,
    pitch_mm: f64,
    lead_mm: f64,
    starts: u32,
    left_hand: bool,
    taper: f64,
    major_mm: f64,
    pitch_diameter_mm: f64,
    minor_mm: f64,
}

pub(super) fn document<'a>(name: &'a str, thread: &Thread) -> Document<'a> {
    let (limits, profile) = (thread.limits(), thread.profile());
    let sizes = |side: Side, in_inches: bool| {
        let (_, member) = limits.members().find(|(of, _)| *of == side)?;
        let key = |(size, value): (Size, f64)| (size.key(side), value);
        Some(if in_inches {
            member.sizes().map(key).collect::<Sizes>()
        } else {
            member.sizes_mm().map(key).collect()
        })
    };
    let members =
        |in_inches| Members { ext: sizes(Side::External, in_inches), int: sizes(Side::Internal, in_inches) };
    Document {
        version: 1,
        name,
        complete: thread.to_string(),
        standard: thread.standard(),
        mm: members(false),
        inch: (limits.unit == Unit::Inch).then(|| members(true)),
        profile: Profile {
            flank_deg: profile.flank_deg,
            triangle_mm: profile.triangle_mm(),
            pitch_mm: profile.pitch_mm,
            lead_mm: profile.lead_mm(),
            starts: profile.starts,
            left_hand: profile.left_hand,
            taper: profile.taper,
            major_mm: profile.major_mm,
            pitch_diameter_mm: profile.pitch_diameter_mm,
            minor_mm: profile.minor_mm,
        },
        note: thread.note(),
    }
}

/// Everything for the screen.
pub(super) fn text(thread: &Thread) -> String {
    let (limits, profile) = (thread.limits(), thread.profile());
    let starts = if profile.starts == 1 { String::new() } else { format!(", {} starts", profile.starts) };
    let hand = if profile.left_hand { "left-hand" } else { "right-hand" };
    let taper = if profile.taper == 0.0 { "" } else { ", taper 1:16" };
    let mut text = format!(
        "{thread}, {}\npitch {} mm{starts}, {hand}{taper}, flanks {} deg\n",
        thread.standard(),
        places(profile.pitch_mm, 0),
        places(profile.flank_deg[0], 0)
    );
    for (side, member) in limits.members() {
        text += &format!("\n{}", table(&limits, side, member));
    }
    format!("{text}\n{}", wrapped(thread.note()))
}

/// Words in lines of a terminal, each with its end.
fn wrapped(words: &str) -> String {
    const WIDTH: usize = 100;
    let mut lines = vec![String::new()];
    for word in words.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.len() + word.len() < WIDTH => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n") + "\n"
}

/// A number with so many places, more if it has more: the six that sizes are rounded to at most.
fn places(value: f64, least: usize) -> String {
    let long = format!("{value:.6}");
    let zeros = long.len() - long.trim_end_matches('0').len();
    format!("{value:.*}", least.max(6 - zeros))
}

/// The sizes of a member, a line each.
fn table(limits: &Limits, side: Side, member: &Member) -> String {
    let inch = limits.unit == Unit::Inch;
    let title = if side == Side::External { "external" } else { "internal" };
    let line = |key: &str, mm: &str, inches: &str, text: &str| {
        let inches = if inch { format!("{inches:>9}") } else { String::new() };
        format!("{key:<12}{mm:>9}{inches}  {text}").trim_end().to_owned() + "\n"
    };
    let sizes = member.sizes_mm().zip(member.sizes()).map(|((size, mm), (_, inches))| {
        let mm = places((mm * 1e4).round() / 1e4, if inch { 4 } else { 3 });
        line(size.key(side), &mm, &places(inches, 4), size.text())
    });
    line(title, "mm", "in", "") + &sizes.collect::<String>()
}
