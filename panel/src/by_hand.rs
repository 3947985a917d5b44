//! What can be asked of work by hand. In: the value of a request. Out: what it asks for, or what it should
//! have been. What the machine makes of it is its own affair.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use crate::wire::{HandAsked, Play};

/// Most characters of a block.
const LONGEST_BLOCK: usize = 512;

/// Longest name of a coordinate system, a tool, an axis.
const LONGEST_NAME: usize = 12;

type Read = Result<HandAsked, &'static str>;

/// The machine is switched on for it.
pub(crate) fn on(value: &Value) -> Read {
    if value.is_null() { Ok(HandAsked::On) } else { Err("has no value") }
}

/// A jog is confirmed.
pub(crate) fn jog_on(value: &Value) -> Read {
    if value.is_null() { Ok(HandAsked::JogOn) } else { Err("has no value") }
}

/// A block of G-code.
pub(crate) fn block(value: &Value) -> Read {
    match value.as_str() {
        Some(text) if !text.trim().is_empty() && text.chars().count() <= LONGEST_BLOCK => {
            Ok(HandAsked::Block(text.to_owned()))
        }
        _ => Err("value is a block of G-code, 1 to 512 characters"),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Jog {
    axis: String,
    mm_min: f64,
    step_mm: Option<f64>,
    way: Option<String>,
}

/// An axis goes so far, or as long as that is confirmed.
pub(crate) fn jog(value: &Value) -> Read {
    let what = "value is {axis, mm_min, step_mm} or {axis, mm_min, way}, way \"+\" or \"-\"";
    let Jog { axis, mm_min, step_mm, way } = Deserialize::deserialize(value).map_err(|_| what)?;
    match (step_mm, way.as_deref()) {
        (Some(mm), None) if mm != 0.0 => Ok(HandAsked::Step { axis, mm, mm_min }),
        (None, Some("+")) => Ok(HandAsked::Jog { axis, positive: true, mm_min }),
        (None, Some("-")) => Ok(HandAsked::Jog { axis, positive: false, mm_min }),
        _ => Err(what),
    }
}

/// An axis goes to its home.
pub(crate) fn home(value: &Value) -> Read {
    match value.as_str() {
        Some(axis) if !axis.is_empty() && axis.len() <= LONGEST_NAME => Ok(HandAsked::Home(axis.to_owned())),
        _ => Err("value is the name of an axis"),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TouchOff {
    axis: String,
    value: f64,
    tool: Option<u32>,
}

/// Where an axis stands is this value.
pub(crate) fn touch_off(value: &Value) -> Read {
    let TouchOff { axis, value, tool } = Deserialize::deserialize(value)
        .map_err(|_| "value is {axis, value} or {axis, value, tool}, the value in units of the program")?;
    if value.abs() < 1e6 {
        Ok(HandAsked::TouchOff { axis, value, tool })
    } else {
        Err("value is below 1000000")
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Offset {
    of: String,
    set: Option<BTreeMap<char, f64>>,
    add: Option<BTreeMap<char, f64>>,
}

/// Words of a coordinate system or a tool are set, or added to what is there.
pub(crate) fn offset(value: &Value) -> Read {
    let what = "value is {of, set} or {of, add}: of G54 to G59.3 or a tool as T3, and words as {\"X\": -12.4, \"Z\": 3}";
    let Offset { of, set, add } = Deserialize::deserialize(value).map_err(|_| what)?;
    let adds = add.is_some();
    match (set, add) {
        (Some(words), None) | (None, Some(words)) if !words.is_empty() && of.len() <= LONGEST_NAME => {
            Ok(HandAsked::Offset { of, words: words.into_iter().collect(), add: adds })
        }
        _ => Err(what),
    }
}

/// A tool is in.
pub(crate) fn tool_in(value: &Value) -> Read {
    match value.as_u64().and_then(|number| u32::try_from(number).ok()) {
        Some(number) => Ok(HandAsked::ToolIn(number)),
        None => Err("value is the number of the tool that is in, 0 for none"),
    }
}

/// The next start begins at a line, or at the beginning.
pub(crate) fn from(value: &Value) -> Read {
    let line = value.as_u64().and_then(|line| u32::try_from(line).ok()).filter(|line| *line > 0);
    match line {
        None if !value.is_null() => {
            Err("value is a line of the program, from 1; without one it is the beginning")
        }
        line => Ok(HandAsked::From(line)),
    }
}

/// A recording is played at a speed.
pub(crate) fn play(value: &Value) -> Read {
    match value.as_f64() {
        Some(speed) if (0.0..=1000.0).contains(&speed) => Ok(HandAsked::Play(Play::Speed(speed))),
        _ => Err("value is how many times as fast as the machine was, 0 to 1000; 0 stands"),
    }
}

/// A recording goes on by some cycles.
pub(crate) fn step(value: &Value) -> Read {
    match value.as_u64() {
        Some(cycles @ 1..=1_000_000) => Ok(HandAsked::Play(Play::Step(cycles))),
        _ => Err("value is how many control cycles, 1 to 1000000"),
    }
}

/// A recording stands at a time.
pub(crate) fn seek(value: &Value) -> Read {
    match value.as_f64() {
        Some(time) if (0.0..=1e6).contains(&time) => Ok(HandAsked::Play(Play::Seek(time))),
        _ => Err("value is a time on the machine, s"),
    }
}

/// The spindle turns.
pub(crate) fn spindle(value: &Value) -> Read {
    match value.as_f64() {
        Some(rpm) if rpm.abs() <= 1e6 => Ok(HandAsked::Spindle(rpm)),
        _ => Err("value is 1/min, negative counterclockwise, 0 stops it"),
    }
}
