//! The interpreter from outside: programs in, items and diagnostics out.

mod bad_programs;
mod blocks;
mod blunt;
mod by_hand;
mod chain;
mod curves;
mod cycle;
mod dialects;
mod doubts;
mod entry;
mod feasible;
mod formula;
mod job_keys;
mod jobs;
mod merge;
mod mill;
mod named;
mod part;
mod policy;
mod properties;
mod ridges;
mod seams;
mod single;
mod surface;
mod tapping;
mod threads;
mod upright;
mod varied;
mod with_c;

use interpreter::{Check, check};
use machine::Machine;
use protocol::{Axis, Code, Feed, Item, SpindleMode, SpindleSpeed, ThreadPass};

/// The folder of the project.
fn project() -> &'static std::path::Path {
    std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// A program that must be right, on the built-in lathe.
fn good(source: &str) -> Check {
    let check = check("test.ngc", source, &Machine::plain());
    let said: String = check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect();
    assert!(check.is_good(), "{said}");
    check
}

/// The passes among items.
fn passes(items: &[Item]) -> Vec<ThreadPass> {
    let pass = |item: &Item| if let Code::Pass(pass) = item.code { Some(pass) } else { None };
    items.iter().filter_map(pass).collect()
}

/// Items as short text, one a line: `3 rapid X10 Z5`.
fn listing(items: &[Item]) -> String {
    items.iter().map(|item| format!("{} {}\n", item.line, text(&item.code))).collect()
}

fn text(code: &Code) -> String {
    match code {
        Code::Line { target, feed } => {
            let (x, z) = (target[Axis::X.index()].mm(), target[Axis::Z.index()].mm());
            let feed = match feed {
                Feed::Rapid => "rapid".to_owned(),
                Feed::PerMinute(feed) => format!("feed {feed}/min"),
                Feed::PerRevolution(feed) => format!("feed {feed}/rev"),
            };
            format!("{feed} X{x} Z{z}")
        }
        Code::Dwell { seconds } => format!("dwell {seconds}"),
        Code::Spindle { mode: SpindleMode::Stop, .. } => "spindle stop".to_owned(),
        Code::Spindle { mode, speed: SpindleSpeed::Rpm(rpm) } => format!("spindle {}", mode.sign() * rpm),
        Code::Spindle { mode, speed } => format!("spindle {mode:?} {speed:?}"),
        Code::PathMode(mode) => format!("path {mode:?}"),
        Code::Arc { arc, .. } => format!("arc {arc:?}"),
        Code::Curve { curve, .. } => format!("curve {curve:?}"),
        Code::Tool { number } => format!("tool {number}"),
        Code::Coolant { mist, flood } => format!("coolant mist {mist} flood {flood}"),
        Code::Output { number, set, in_step } => format!("output {number} {set:?} in step {in_step}"),
        Code::Await { input, until, within_s } => format!("await {input} {until:?} {within_s}"),
        Code::Pause => "pause".to_owned(),
        Code::OptionalPause => "optional pause".to_owned(),
        Code::ByHand(by_hand) => format!("by hand {by_hand:?}"),
        Code::Pass(pass) => {
            let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
            format!("pass {} X{} Z{} to Z{}", pass.pass, x.start.mm(), z.start.mm(), z.end.mm())
        }
        Code::Formula { slot, .. } => format!("formula {slot}"),
        Code::Work(trace) => format!("trace at {}/min", trace.feed_mm_min),
        Code::Variation(variation) => format!("variation {variation:?}"),
        Code::End => "end".to_owned(),
    }
}
