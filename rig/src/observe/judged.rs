//! Whether the part is good, as far as a run shows it. In: a summary. Out: a verdict, and every reason
//! against the part in words.
//!
//! A thread is judged at the tool, over all contact, by `threading.part_error_um` of the machine file: the
//! swing of each pass about its mean, passes and starts against each other, the depth, and how it differs
//! from end to end. Where along the part the whole thread lies is not judged: nobody measures that in µm.
//! Work from formulas is judged by what its job asks for. Where a gauge is asked for, what it refuses speaks
//! against the part, and so does a ring that was cut in a loss of power, before a run that goes on; where the
//! gauge has no verdict, the part has none either, nor where the program was begun at a line in its middle.
//! A part that is still being cut when its run ends has no verdict, but for what speaks against it already.

use machine::Threading;
use serde::{Deserialize, Serialize};

use super::{Outcome, PassReport, RingReport, Summary, verdict::PartVerdict};

/// The part, as far as it is judged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PartReport {
    /// How good it is.
    pub verdict: PartVerdict,
    /// What a thread may be off at the tool.
    pub error_um: f64,
    /// What speaks against it, or why it is not finished.
    pub reasons: Vec<String>,
}

impl PartReport {
    /// The reasons, each with what it is a reason for.
    pub fn told(&self) -> impl Iterator<Item = String> {
        let what = if self.verdict == PartVerdict::Bad { "not good" } else { "no verdict" };
        self.reasons.iter().map(move |reason| format!("{what}: {reason}"))
    }
}

impl Default for PartReport {
    fn default() -> Self {
        let error_um = Threading::default().part_error_um;
        PartReport { verdict: PartVerdict::None, error_um, reasons: Vec::new() }
    }
}

/// Judges the part of a run.
pub(super) fn judged(summary: &Summary, error_um: f64) -> PartReport {
    let finished = summary.outcome == Outcome::Completed;
    let broken = summary.interrupted().filter(|last| !last.complete);
    let broken: Vec<_> = broken.map(|pass| format!("pass {} was not cut to its end", pass.pass)).collect();
    let mut reasons = if finished { broken.clone() } else { Vec::new() };
    for pass in summary.passes.iter().filter(|pass| !pass.same_index) {
        reasons.push(format!("the axes of pass {} started from different indexes of the spindle", pass.pass));
    }
    let rings = summary.resumed.iter().flat_map(|resumed| &resumed.rings);
    reasons.extend(rings.map(RingReport::told));
    reasons.extend(threads(summary, error_um));
    let gauge = summary.gauged().iter().filter(|gauge| gauge.verdict == PartVerdict::Bad);
    reasons.extend(gauge.flat_map(|gauge| gauge.reasons.iter().map(|why| format!("{}: {why}", gauge.name))));
    let groove = summary.groove.iter().filter(|groove| groove.verdict == PartVerdict::Bad);
    reasons.extend(groove.flat_map(|groove| groove.reasons.iter().map(|why| format!("the groove: {why}"))));
    for trace in summary.traces.iter().filter(|trace| trace.is_wrong()) {
        reasons.push(format!(
            "in line {} the commanded path itself is {:.2} µm off, more than the chord error of {:.2} µm allows: the \
             part is not what the formula says",
            trace.line,
            trace.commanded.max_abs_um(),
            trace.most_um.unwrap_or(0.0)
        ));
    }
    let judges = !summary.traces.is_empty() || summary.touched().next().is_some();
    // What was cut before the line at which a program is begun has been judged by nobody.
    let undecided = !finished
        || summary.from_line.is_some()
        || summary.gauged().iter().any(|gauge| gauge.verdict == PartVerdict::None)
        || summary.groove.iter().any(|groove| groove.verdict == PartVerdict::None);
    let verdict = match (reasons.is_empty(), judges && !undecided) {
        (false, _) => PartVerdict::Bad,
        (true, true) => PartVerdict::Good,
        (true, false) => PartVerdict::None,
    };
    if !finished {
        reasons.splice(0..0, broken);
    }
    PartReport { verdict, error_um, reasons }
}

/// What is wrong with the threads.
fn threads(summary: &Summary, error_um: f64) -> Vec<String> {
    let mut reasons = Vec::new();
    let mut judge = |um: f64, says: &dyn Fn(String) -> String| {
        if um > error_um {
            let words = says(format!("{um:.2} µm"));
            reasons.push(format!("{words}, and threading.part_error_um allows {error_um} µm"));
        }
    };
    let farthest =
        |a: &&PassReport, b: &&PassReport| a.tool.helix_max_abs_um.total_cmp(&b.tool.helix_max_abs_um);
    if let Some(PassReport { pass, tool, .. }) = summary.passes.iter().max_by(farthest) {
        judge(tool.helix_max_abs_um, &|um| match tool.flank_um < tool.helix_max_abs_um {
            true => format!("pass {pass} strays by {um} from its own groove at the tool"),
            false if tool.flank_in_um >= tool.flank_um => format!(
                "pass {pass} takes {um} from the flank in its run-in: the tool is in the stock before it is on the helix"
            ),
            false => format!("pass {pass} takes {um} from the flank while the tool leaves the thread"),
        });
    }
    let thread = &summary.thread;
    judge(thread.tool_phase_spread_um, &|um| format!("passes of one groove lie {um} apart at the tool"));
    judge(thread.tool_start_spread_um, &|um| format!("the starts of a thread lie {um} apart at the tool"));
    judge(thread.tool_depth_um, &|um| {
        format!("from end to end the depth of a thread differs by {um} of radius at the tool")
    });
    let way = if thread.tool_depth_off_um > 0.0 { "shallow" } else { "deep" };
    judge(thread.tool_depth_off_um.abs(), &|um| {
        format!("a pass at full depth is {um} of radius too {way} at the tool")
    });
    reasons
}
