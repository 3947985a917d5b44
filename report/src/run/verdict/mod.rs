//! What a run comes to, in plain words. In: the summary. Out: a grade, a headline, and sentences.

use std::collections::BTreeSet;

use protocol::Axis;
use rig::observe::{Outcome, PartVerdict, PassReport, Summary, TOOL_IN_THREAD, TraceReport, WorkKind};

use super::{gauge, taps};

/// A thread that is off at the tool by more than this share of what it may be deserves a look.
pub(super) const LOOK_SHARE: f64 = 0.5;

/// A slide further than this from its programmed place in the thread deserves a look, µm; elasticity and
/// friction alone make three or four.
const LOOK_SLIDE_UM: f64 = 8.0;

/// Timed motion further than this from its path deserves a look, µm; a sound machine keeps within a few.
const LOOK_CONTOUR_UM: f64 = 10.0;

/// How good a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Grade {
    /// Nothing was judged.
    None,
    Good,
    Look,
    Bad,
}

impl Grade {
    /// Word and sign: never colour alone.
    pub(super) fn label(self) -> &'static str {
        match self {
            Grade::None => "– Not judged",
            Grade::Good => "✓ Good",
            Grade::Look => "! Take a look",
            Grade::Bad => "✗ Not good",
        }
    }

    /// Class of the style sheet.
    pub(super) fn class(self) -> &'static str {
        match self {
            Grade::None => "none",
            Grade::Good => "good",
            Grade::Look => "look",
            Grade::Bad => "bad",
        }
    }
}

/// The verdict on a run.
pub(super) struct Verdict {
    pub(super) grade: Grade,
    pub(super) sentences: Vec<String>,
}

impl Verdict {
    pub(super) fn say(&mut self, grade: Grade, sentence: impl Into<String>) {
        self.grade = self.grade.max(grade);
        self.sentences.push(sentence.into());
    }
}

/// Judges a run.
pub(super) fn of(summary: &Summary) -> Verdict {
    let mut verdict = Verdict { grade: Grade::Good, sentences: Vec::new() };
    match summary.outcome {
        Outcome::Completed => verdict.say(Grade::Good, "The program ran to its end."),
        Outcome::Stopped => verdict.say(Grade::Look, "The program was stopped before its end."),
        Outcome::Faulted => {
            let why = summary.faults.first().map_or_else(String::new, |fault| {
                format!(" {} at {:.3} s: {}.", fault.source, fault.cycle as f64 * summary.cycle_s, fault.text)
            });
            verdict.say(Grade::Bad, format!("The run ended in a fault.{why}"));
        }
    }
    if let Some(resumed) = &summary.resumed {
        verdict.say(Grade::Good, format!("It {}.", resumed.told()));
    }
    if let Some(line) = summary.from_line {
        let what = "what is cut before it was not cut in this run, so the part as a whole is not judged";
        verdict.say(Grade::Good, format!("It was begun at line {line}: {what}."));
    }
    for warning in summary.warnings.iter().filter(|warning| warning.code == TOOL_IN_THREAD) {
        verdict.say(Grade::Bad, format!("Careful: {}.", warning.text));
    }
    checked(summary, &mut verdict);
    threads(summary, &mut verdict);
    gauge::says(summary, &mut verdict);
    traces(summary, &mut verdict);
    let why = summary.part.reasons.join("; ");
    match summary.part.verdict {
        PartVerdict::Bad => verdict.say(Grade::Bad, format!("The part is not good: {why}.")),
        PartVerdict::None if !why.is_empty() => {
            verdict.say(Grade::Look, format!("The part has no verdict: {why}."));
        }
        _ => {}
    }
    limits(summary, &mut verdict);
    moves(summary, &mut verdict);
    if summary.deadline_misses > 0 {
        verdict.say(Grade::Look, format!("{} answers came late.", summary.deadline_misses));
    }
    if verdict.grade == Grade::Good && summary.part.verdict == PartVerdict::None {
        verdict.grade = Grade::None;
        verdict
            .sentences
            .push("Nothing of this run is judged: whether the part is good, it does not say.".into());
    }
    verdict
}

/// What is off by more than half of what it may be deserves a look, unless a gauge has judged it.
pub(super) fn more_than_half(summary: &Summary, of: &str, verdict: &mut Verdict) {
    if !summary.part.reasons.is_empty() {
        return;
    }
    let gauges = summary.gauged();
    let allowed = um(summary.part.error_um);
    let share =
        format!("That is more than half of the {allowed} that threading.part_error_um allows, in {of}");
    if !gauges.is_empty() && gauges.iter().all(|gauge| gauge.verdict == PartVerdict::Good) {
        return verdict
            .say(Grade::Good, format!("{share}: that is allowed, and the gauge calls the thread good."));
    }
    let remedy = "name the thread, as in (thread, M20x2-6g), and a gauge says whether it is good";
    verdict.say(Grade::Look, format!("{share}: {remedy}."));
}

/// What a machine would have hit or spoilt, and what the check warned of besides.
fn checked(summary: &Summary, verdict: &mut Verdict) {
    const CRASHES: [&str; 6] = [
        "rapid-in-stock",
        "into-chuck",
        "cut-at-rest",
        "run-in-in-stock",
        "retract-in-stock",
        "thread-in-stock",
    ];
    let warnings = &summary.program_warnings;
    let crashes: Vec<_> = warnings.iter().filter(|one| CRASHES.contains(&one.code.as_str())).collect();
    if let Some(first) = crashes.first() {
        verdict.say(Grade::Look, format!("Careful, line {}: {}.", first.line, first.text));
    }
    match (warnings.len(), crashes.len()) {
        (0, _) | (1, 1) => {}
        (1, _) => verdict.say(Grade::Good, "The check had one warning, which stands below."),
        (all, _) => verdict.say(Grade::Good, format!("The check had {all} warnings, which stand below.")),
    }
}

fn threads(summary: &Summary, verdict: &mut Verdict) {
    let passes = &summary.passes;
    if passes.is_empty() {
        let lathe = !summary.limits.contains_key(&Axis::Y);
        if lathe {
            verdict.say(Grade::Good, "No thread was cut.");
        }
        return;
    }
    let again: Vec<_> = summary.interrupted().filter(|last| last.complete).map(|last| last.pass).collect();
    if !again.is_empty() {
        let named = again.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        verdict.say(Grade::Good, format!("Left, entered again and cut to the end: pass {named}."));
    }
    taps::says(summary, verdict);
    let cut: Vec<_> = summary.turned().filter(|pass| pass.thread_cycles > 0).collect();
    if cut.is_empty() {
        return;
    }
    at_the_tool(summary, verdict);
    let worst = |of: fn(&PassReport) -> f64| cut.iter().map(|pass| of(pass)).fold(0.0, f64::max);
    let x = worst(|pass| pass.x_slide.thread_max_abs_um);
    let z = worst(|pass| pass.slide_helix_max_abs_um);
    if x.max(z) > LOOK_SLIDE_UM {
        let words = format!("In the thread the slides stand off by up to {} in X and {} in Z.", um(x), um(z));
        verdict.say(Grade::Look, words);
    }
}

/// What the tool did in the material.
fn at_the_tool(summary: &Summary, verdict: &mut Verdict) {
    let numbers = summary.touched_turning().map(|pass| pass.pass).collect::<BTreeSet<_>>().len();
    let off = summary.at_the_tool();
    let [helix, passes, depth, ends] = off.map(um);
    let count = match numbers {
        0 => {
            let words = "The tool touched no material, so the thread is not judged: the stock lies below Z 0 of the \
                         program, unless a part is described, as by (part, bar D24 L60 Z30), or the machine file \
                         says where it is (plant.cutting).";
            return verdict.say(Grade::Look, words);
        }
        1 => "One pass was cut. At the tool it keeps to its".into(),
        n => format!("{n} passes were cut. At the tool they keep to their"),
    };
    let (same, are) = match numbers {
        1 => (String::new(), "is"),
        _ => (format!(", follow one groove within {passes}"), "are"),
    };
    let words = format!(
        "{count} helix within {helix} about its mean{same}, and {are} off in depth by {depth}, from end to end by \
         {ends}."
    );
    verdict.say(Grade::Good, words);
    let names = ["the helix", "the groove of the passes", "the depth", "the depth from end to end"];
    let close = |(_, off): &(&str, f64)| *off > LOOK_SHARE * summary.part.error_um;
    let near: Vec<_> = names.into_iter().zip(off).filter(close).map(|(name, _)| name).collect();
    if !near.is_empty() {
        more_than_half(summary, &near.join(" and "), verdict);
    }
}

/// A tool further than this from its surface or contour, or a beam from its seam, deserves a look, µm.
const LOOK_TRACE_UM: f64 = 10.0;

fn traces(summary: &Summary, verdict: &mut Verdict) {
    if summary.traces_left_out > 0 {
        let words = format!(
            "{} more contours, surfaces and seams have no figures of their own here: those that have are the farthest off.",
            summary.traces_left_out
        );
        verdict.say(Grade::Good, words);
    }
    for (kind, who) in [
        (WorkKind::Contour, "The tool kept to its contour"),
        (WorkKind::Surface, "The tool kept to its surface"),
        (WorkKind::Seam, "The beam kept to its seam"),
    ] {
        let of_kind: Vec<_> = summary.traces.iter().filter(|trace| trace.kind == kind).collect();
        let worst = |of: fn(&&TraceReport) -> f64| of_kind.iter().map(of).fold(0.0, f64::max);
        let (commanded, slide) =
            (worst(|trace| trace.commanded.max_abs_um()), worst(|trace| trace.slide.max_abs_um()));
        if of_kind.iter().any(|trace| trace.unmeasured_cycles > 0) {
            verdict.say(Grade::Look, "In some cycles no place was found where the tool would touch.");
        }
        let unexplained = worst(|trace| trace.feed.unexplained_s);
        if unexplained > 0.0 {
            let words = format!("For {unexplained:.3} s the feed was low although no limit asked for it.");
            verdict.say(Grade::Look, words);
        }
        if !of_kind.is_empty() {
            let grade = if slide > LOOK_TRACE_UM { Grade::Look } else { Grade::Good };
            verdict.say(grade, format!("{who} within {}, commanded within {}.", um(slide), um(commanded)));
        }
    }
}

fn moves(summary: &Summary, verdict: &mut Verdict) {
    let moves = &summary.moves;
    if moves.contour_max_um > 0.0 {
        let grade = if moves.contour_max_um > LOOK_CONTOUR_UM { Grade::Look } else { Grade::Good };
        let words = format!("Timed motion kept within {} of its path.", um(moves.contour_max_um));
        verdict.say(grade, words);
    }
    if moves.starved > 0 {
        let words = format!("It stopped {} times on its path to wait for machine code.", moves.starved);
        verdict.say(Grade::Look, words);
    }
}

fn limits(summary: &Summary, verdict: &mut Verdict) {
    let beyond = summary.passes.iter().find(|pass| pass.limits_asked_pct.most() > 100.0);
    if let Some(pass) = beyond {
        verdict.say(Grade::Look, format!("Pass {} asked an axis for more than its limits.", pass.pass));
    }
    match summary.moves.limit_violations {
        0 => {}
        n => verdict.say(Grade::Look, format!("Timed motion went beyond a limit of an axis in {n} cycles.")),
    }
    if let Some(words) = summary.overrides_held() {
        verdict.say(Grade::Good, format!("The spindle was {words}."));
    }
}

/// A length for people: µm, or mm if it is long.
pub(super) fn um(value: f64) -> String {
    match value.abs() {
        size if size >= 1000.0 => format!("{:.3} mm", value / 1000.0),
        size if size >= 0.1 => format!("{value:.2} µm"),
        _ => format!("{value:.3} µm"),
    }
}

#[cfg(test)]
mod tests;
