//! What a run comes to, in words for the terminal. In: its summary. Out: text.

use std::{collections::BTreeSet, fmt::Write as _};

use protocol::Axis;
use rig::observe::{
    FaultReport, Outcome, PassEnd, PassReport, ProgramWarning, ServoError, Summary, WorkKind,
};

use crate::words::counted;

/// Pauses and circles that are named.
const SHOWN: usize = 10;

/// A fault or a warning in a line.
pub(super) fn told(report: &FaultReport) -> String {
    let FaultReport { source, code, cycle, text } = report;
    format!("{source} {code} (cycle {cycle}): {text}")
}

/// What a person wants to know first.
pub(super) fn summed_up(summary: &Summary, report: Option<&std::path::Path>) -> String {
    let mut text = String::new();
    for fault in &summary.faults {
        let _ = writeln!(text, "fault     {}", told(fault));
    }
    for warning in &summary.warnings {
        let _ = writeln!(text, "warning   {}", told(warning));
    }
    for ProgramWarning { file, line, code, text: what, .. } in summary.program_warnings.iter().take(SHOWN) {
        let _ = writeln!(text, "checked   {file}:{line}: {code}: {what}");
    }
    if summary.program_warnings.len() > SHOWN {
        let _ = writeln!(text, "          and {} more warnings", summary.program_warnings.len() - SHOWN);
    }
    let outcome = match summary.outcome {
        Outcome::Completed => "completed",
        Outcome::Faulted => "FAULTED",
        Outcome::Stopped => "stopped by the operator",
    };
    // One that was left and taken up again is one pass.
    let passes: BTreeSet<u32> = summary.passes.iter().map(|pass| pass.pass).collect();
    let _ = writeln!(
        text,
        "{outcome}: {}, {}, {:.1} s on the machine in {:.1} s",
        counted(passes.len() as u64, "pass", "passes"),
        counted(summary.moves.count, "move", "moves"),
        summary.simulated_s,
        summary.wall_s
    );
    if let Some(resumed) = &summary.resumed {
        let _ = writeln!(text, "resumed   {}", resumed.told());
    }
    if let Some(line) = summary.from_line {
        let _ = writeln!(text, "begun     at line {line}: what is cut before it is not judged");
    }
    for found in &summary.references {
        let _ = writeln!(text, "reference {}", found.told(summary.cycle_s));
    }
    threads(&mut text, summary);
    gauged(&mut text, summary);
    traces(&mut text, summary);
    moves(&mut text, summary);
    pauses(&mut text, summary);
    signals(&mut text, summary);
    if let Some(words) = summary.overrides_held() {
        let _ = writeln!(text, "override  {words}");
    }
    if summary.deadline_misses > 0 && summary.clock == "real" {
        let _ = writeln!(text, "late      {} answers came after their cycle", summary.deadline_misses);
    }
    for report in &summary.real_time {
        let times = [("wake-up", &report.wake_up), ("answer", &report.answer), ("frame", &report.frame)];
        for (what, times) in times.into_iter().filter_map(|(what, times)| Some((what, times.as_ref()?))) {
            let _ = writeln!(
                text,
                "timed     {}: {what} {} µs (median), {} µs (99 %), {} µs (most of {})",
                report.process, times.median_us, times.p99_us, times.most_us, times.count
            );
        }
        for item in report.set_up.iter().filter(|item| !item.done) {
            let _ = writeln!(text, "refused   {}: {}: {}", report.process, item.what, item.text);
        }
    }
    let _ = writeln!(text, "trace     {}", summary.trace_hash);
    if let Some(report) = report {
        let _ = writeln!(text, "report    {}", report.display());
    }
    text
}

fn pauses(text: &mut String, summary: &Summary) {
    for pause in summary.pauses.iter().take(SHOWN) {
        let _ = writeln!(
            text,
            "pause     line {}: {} after {:.1} s",
            pause.line,
            pause.ended_by.text(),
            pause.waited_s
        );
    }
    if summary.pauses.len() > SHOWN {
        let _ = writeln!(text, "          and {} more pauses", summary.pauses.len() - SHOWN);
    }
}

fn signals(text: &mut String, summary: &Summary) {
    for (what, changes) in [("output", &summary.outputs), ("input", &summary.inputs)] {
        let told = changes.iter().map(|one| {
            let state = if one.on { "on" } else { "off" }.to_owned();
            (one.number, &one.name, state, one.cycle, one.line)
        });
        changed(text, what, told, summary.cycle_s);
    }
    let analog = &summary.analog_outputs;
    let told =
        analog.iter().map(|one| (one.number, &one.name, format!("= {}", one.value), one.cycle, one.line));
    changed(text, "analog", told, summary.cycle_s);
}

/// Changes of outputs or inputs: number, name, state, cycle, line.
fn changed<'a>(
    text: &mut String,
    what: &str,
    changes: impl ExactSizeIterator<Item = (u32, &'a String, String, u64, u32)>,
    cycle_s: f64,
) {
    let more = changes.len().saturating_sub(SHOWN);
    for (number, name, state, cycle, line) in changes.take(SHOWN) {
        let at_s = cycle as f64 * cycle_s;
        let _ = writeln!(text, "{what:<10}{number} {name} {state} at {at_s:.3} s, line {line}");
    }
    if more > 0 {
        let _ = writeln!(text, "          and {more} more changes of {what}s");
    }
}

/// Taps by their farthest error on each part of the way.
fn taps(text: &mut String, summary: &Summary) {
    let Some(([inwards, turn, out], [least, most])) = summary.taps_at_worst() else { return };
    let depth = match () {
        () if least < 0.0 => format!("at most {:.1} µm deeper than programmed", -least),
        () if most - least < 0.05 => format!("{most:.1} µm short of the depth"),
        () => format!("{least:.1} to {most:.1} µm short of the depth"),
    };
    let _ = writeln!(
        text,
        "tap       {}: off the helix at most {inwards:.2} µm on the way in, {turn:.2} µm while the spindle turns round, {out:.2} µm on the way out; {depth}",
        counted(summary.taps().count() as u64, "tap", "taps"),
    );
}

/// Where the largest helix error is none of the helix: what the tool took from the flank on its way in or
/// out.
fn of_the_flank(summary: &Summary) -> &'static str {
    let tools = summary.turned().map(|pass| pass.tool);
    match tools.max_by(|a, b| a.helix_max_abs_um.total_cmp(&b.helix_max_abs_um)) {
        Some(tool) if tool.flank_um == 0.0 || tool.flank_um < tool.helix_max_abs_um => "",
        Some(tool) if tool.flank_in_um >= tool.flank_um => " (of the flank, in the run-in)",
        Some(_) => " (of the flank, in the run-out)",
        None => "",
    }
}

fn threads(text: &mut String, summary: &Summary) {
    for last in summary.interrupted().take(SHOWN) {
        let words = match last.end {
            PassEnd::Complete => "was left, entered again and cut to its end",
            PassEnd::Left => "was left before its end",
            PassEnd::CutOff => "was cut off before its end",
        };
        let _ = writeln!(text, "pass      {} {words}", last.pass);
    }
    taps(text, summary);
    if summary.turned().next().is_none() {
        return;
    }
    let worst = |of: fn(&PassReport) -> f64| summary.turned().map(of).fold(0.0, f64::max);
    let [helix, passes, depth, ends] = summary.at_the_tool();
    let flank = of_the_flank(summary);
    let _ = match summary.touched_turning().next() {
        None => writeln!(
            text,
            "thread    the tool touched no material: nothing of it is judged; (part, ...) in the program says where it is"
        ),
        Some(_) => writeln!(
            text,
            "thread    at the tool: helix error at most {helix:.2} µm about its mean{flank}, from pass to pass {passes:.2} µm, depth off by {depth:.2} µm, from end to end {ends:.2} µm"
        ),
    };
    let _ = writeln!(
        text,
        "nut       helix error at most {:.2} µm, phase spread from pass to pass {:.2} µm, lead error at most {:.3} µm/rev",
        worst(|pass| pass.helix_max_abs_um),
        summary.thread.phase_spread_um,
        worst(|pass| pass.lead_error_um_per_rev.abs()),
    );
    // The axis that takes the tool to depth.
    for axis in [Axis::X, Axis::Z] {
        let errors = summary.turned().filter(|pass| pass.on_face == (axis == Axis::Z));
        let errors = errors.map(|pass| if axis == Axis::X { pass.x } else { pass.z });
        let worst = |of: fn(ServoError) -> f64| errors.clone().map(of).reduce(f64::max);
        let Some(approach) = worst(|error| error.approach_max_um.max(-error.approach_min_um)) else {
            continue;
        };
        let [end, thread] = [worst(|error| error.end_um.abs()), worst(|error| error.thread_max_abs_um)];
        let _ = writeln!(
            text,
            "depth ({axis}) servo error in the approach at most {approach:.2} µm, at its end {:.2} µm, in the thread {:.2} µm",
            end.unwrap_or_default(),
            thread.unwrap_or_default()
        );
    }
}

/// What the gauge says.
fn gauged(text: &mut String, summary: &Summary) {
    if let Some(groove) = &summary.groove {
        let _ = writeln!(text, "groove    {}", groove.sentence());
    }
    for gauge in summary.gauged() {
        let _ = writeln!(text, "gauge     {}", gauge.sentence());
        for note in &gauge.notes {
            let _ = writeln!(text, "          {note}");
        }
    }
}

fn traces(text: &mut String, summary: &Summary) {
    let mut shown: Vec<_> = summary.traces.iter().collect();
    if shown.len() > SHOWN {
        shown.sort_by(|a, b| b.slide.max_abs_um().total_cmp(&a.slide.max_abs_um()));
        shown.truncate(SHOWN);
    }
    for trace in &shown {
        let (name, turned) = match trace.kind {
            WorkKind::Contour => ("contour  ", String::new()),
            WorkKind::Surface => ("surface  ", String::new()),
            WorkKind::Seam => ("seam     ", format!(", direction within {:.5}°", trace.slide.angle_max_deg)),
        };
        let _ = writeln!(
            text,
            "{name} line {}: true within {:.2} µm, commanded within {:.3} µm{turned}; {:.0} mm/min held {:.1} % of the time",
            trace.line,
            trace.slide.max_abs_um(),
            trace.commanded.max_abs_um(),
            trace.feed.programmed_mm_min,
            trace.feed.held_pct
        );
    }
    for trace in summary.traces.iter().filter(|trace| trace.is_wrong()).take(SHOWN) {
        let _ = writeln!(
            text,
            "WRONG     line {}: commanded {:.3} µm off, more than the chord error of {:.3} µm: the part is not what the formula says",
            trace.line,
            trace.commanded.max_abs_um(),
            trace.most_um.unwrap_or(0.0)
        );
    }
    let more = (summary.traces.len() - shown.len()) as u64 + summary.traces_left_out;
    if more > 0 {
        let _ = writeln!(text, "          and {more} more contours, surfaces and seams, each of them truer");
    }
}

fn moves(text: &mut String, summary: &Summary) {
    if summary.moves.contour_max_um > 0.0 {
        let moves = &summary.moves;
        let _ = writeln!(
            text,
            "contour   at most {:.2} µm from the path (line {} at {:.3} s), rms {:.2} µm",
            moves.contour_max_um, moves.contour_line, moves.contour_t_s, moves.contour_rms_um
        );
        for circle in moves.circles.iter().take(SHOWN) {
            let _ = writeln!(
                text,
                "circle    line {}: radius {:.3} mm at {:.0} mm/min round within {:.2} µm",
                circle.line, circle.radius_mm, circle.feed_mm_min, circle.round_max_um
            );
        }
    }
    if summary.moves.limit_violations > 0 {
        let _ = writeln!(
            text,
            "limits    {} cycles beyond the limit of an axis: docs/run-folder.md says how that is judged",
            summary.moves.limit_violations
        );
    }
    if summary.moves.starved > 0 {
        let _ = writeln!(text, "starved   stopped {} times to wait for machine code", summary.moves.starved);
    }
}
