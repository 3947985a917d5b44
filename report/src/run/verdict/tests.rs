//! What a run comes to, in words: each defect is said, and nothing is called good that nobody judged.

use super::{Grade, TOOL_IN_THREAD, of};
use rig::observe::{
    FaultReport, GaugeReport, Outcome, PartVerdict, PassReport, ProgramWarning, Summary, ToolReport,
};

fn good() -> Summary {
    let tool = ToolReport { helix_max_abs_um: 0.75, contact_deg: 3600.0, ..ToolReport::default() };
    let pass = PassReport {
        pass: 1,
        complete: true,
        same_index: true,
        thread_cycles: 100,
        helix_max_abs_um: 0.5,
        slide_helix_max_abs_um: 3.5,
        tool,
        ..PassReport::default()
    };
    let mut summary = Summary { outcome: Outcome::Completed, passes: vec![pass], ..Summary::default() };
    summary.part.verdict = PartVerdict::Good;
    (summary.thread.tool_depth_um, summary.thread.tool_depth_off_um) = (2.7, -1.5);
    summary
}

#[test]
fn a_good_run_is_called_good() {
    let verdict = of(&good());
    assert_eq!(verdict.grade, Grade::Good);
    assert_eq!(
        verdict.sentences.join(" "),
        "The program ran to its end. One pass was cut. At the tool it keeps to its helix within 0.75 µm about its \
         mean, and is off in depth by 1.50 µm, from end to end by 2.70 µm."
    );
}

#[test]
fn what_is_close_to_too_much_is_named() {
    let mut summary = good();
    (summary.part.error_um, summary.thread.tool_depth_off_um) = (10.0, -5.5);
    let verdict = of(&summary);
    assert_eq!(verdict.grade, Grade::Look);
    let named = "That is more than half of the 10.00 µm that threading.part_error_um allows, in the depth: ";
    let last = |verdict: &super::Verdict| verdict.sentences.last().cloned().unwrap_or_default();
    let told = last(&verdict);
    assert!(told.starts_with(named) && told.contains("name the thread"), "{told}");
    // A part that is within what is allowed and that its gauge calls good alarms nobody.
    summary.gauge = Some(GaugeReport { verdict: PartVerdict::Good, ..GaugeReport::default() });
    let verdict = of(&summary);
    assert!(verdict.grade == Grade::Good && verdict.sentences.join(" ").contains(named));
}

/// A program that cuts nothing that is judged makes no good part.
#[test]
fn where_nothing_is_judged_the_part_is_not_called_good() {
    let summary = Summary { outcome: Outcome::Completed, ..Summary::default() };
    let verdict = of(&summary);
    assert_eq!((verdict.grade, verdict.grade.label()), (Grade::None, "– Not judged"));
    assert!(verdict.sentences.last().is_some_and(|last| last.contains("Nothing of this run is judged")));
}

#[test]
fn a_part_that_is_not_finished_has_no_verdict() {
    let mut summary = good();
    (summary.outcome, summary.part.verdict) = (Outcome::Stopped, PartVerdict::None);
    summary.part.reasons = vec!["pass 1 was not cut to its end".into()];
    let verdict = of(&summary);
    let words = verdict.sentences.join(" ");
    assert!(verdict.grade == Grade::Look, "{words}");
    assert!(words.ends_with("The part has no verdict: pass 1 was not cut to its end."), "{words}");
}

#[test]
fn a_pass_that_was_entered_again_is_one_pass() {
    let mut summary = good();
    let again = PassReport { pass: 2, ..summary.passes[0].clone() };
    summary.passes.extend([PassReport { complete: false, ..again.clone() }, again]);
    let verdict = of(&summary);
    let words = verdict.sentences.join(" ");
    assert_eq!(verdict.grade, Grade::Good, "{words}");
    assert!(words.contains("Left, entered again and cut to the end: pass 2. 2 passes were cut"), "{words}");
}

#[test]
fn what_the_check_warned_of_is_said() {
    let warned = |codes: &[&str]| {
        let warning = |code: &&str| ProgramWarning {
            line: 4,
            code: (*code).into(),
            text: "the rapid goes through the stock".into(),
            ..ProgramWarning::default()
        };
        let verdict = of(&Summary { program_warnings: codes.iter().map(warning).collect(), ..good() });
        (verdict.grade, verdict.sentences[1..].join(" "))
    };
    let (grade, words) = warned(&["rapid-in-stock", "no-effect"]);
    let both =
        "Careful, line 4: the rapid goes through the stock. The check had 2 warnings, which stand below.";
    assert!(grade == Grade::Look && words.starts_with(both), "{words}");
    let (grade, words) = warned(&["no-effect"]);
    assert!(grade == Grade::Good && words.starts_with("The check had one warning"), "{words}");
}

#[test]
fn a_nut_that_is_off_where_the_slide_is_not_is_no_defect() {
    let mut summary = good();
    (summary.passes[0].helix_max_abs_um, summary.passes[0].slide_helix_max_abs_um) = (60.5, 1.0);
    let verdict = of(&summary);
    assert!(verdict.grade == Grade::Good, "{:?}", verdict.sentences);
}

#[test]
fn a_part_that_is_not_good_is_called_bad_with_its_reason() {
    let mut summary = good();
    summary.part.reasons = vec!["pass 1 strays by 90.00 µm".into()];
    summary.part.verdict = PartVerdict::Bad;
    let verdict = of(&summary);
    let words = verdict.sentences.join(" ");
    assert!(
        verdict.grade == Grade::Bad && words.ends_with("The part is not good: pass 1 strays by 90.00 µm."),
        "{words}"
    );
}

#[test]
fn every_defect_is_said() {
    let defect = |spoil: fn(&mut Summary)| {
        let mut summary = good();
        spoil(&mut summary);
        let verdict = of(&summary);
        (verdict.grade, verdict.sentences.join(" "))
    };
    let (grade, words) = defect(|summary| summary.passes[0].tool.helix_max_abs_um = 5.1);
    assert!(grade == Grade::Look && words.contains("within 5.10 µm about its mean"), "{words}");
    let (grade, words) = defect(|summary| summary.thread.tool_depth_um = 5.1);
    assert!(grade == Grade::Look && words.contains("from end to end by 5.10 µm"), "{words}");
    let (grade, words) = defect(|summary| summary.thread.tool_depth_off_um = -5.1);
    assert!(grade == Grade::Look && words.contains("off in depth by 5.10 µm"), "{words}");
    let (grade, words) = defect(|summary| summary.passes[0].tool.contact_deg = 0.0);
    assert!(grade == Grade::Look && words.contains("touched no material"), "{words}");
    let (grade, words) = defect(|summary| summary.passes[0].slide_helix_max_abs_um = 10.5);
    assert!(grade == Grade::Look && words.contains("0.000 µm in X and 10.50 µm in Z"), "{words}");
    let (grade, words) = defect(|summary| summary.passes[0].x_slide.thread_max_abs_um = 12.0);
    assert!(grade == Grade::Look && words.contains("up to 12.00 µm in X and 3.50 µm in Z"), "{words}");
    let (grade, words) = defect(|summary| summary.passes[0].limits_asked_pct.z_a = 101.0);
    assert!(grade == Grade::Look && words.contains("more than its limits"), "{words}");
    let (grade, words) = defect(|summary| summary.moves.contour_max_um = 25.0);
    assert!(grade == Grade::Look && words.contains("within 25.00 µm of its path"), "{words}");
    let (grade, words) = defect(|summary| summary.overrides_clamped = 1);
    assert!(grade == Grade::Good && words.contains("The spindle was held once below"), "{words}");
    let (grade, words) = defect(|summary| summary.moves.starved = 2);
    assert!(grade == Grade::Look && words.contains("stopped 2 times"), "{words}");
    let (grade, words) = defect(|summary| summary.moves.limit_violations = 3);
    assert!(grade == Grade::Look && words.contains("in 3 cycles"), "{words}");
    let (grade, words) = defect(|summary| {
        summary.outcome = Outcome::Faulted;
        let text = "the drive reports a fault".into();
        summary.faults.push(FaultReport { source: "regulator-x".into(), text, ..FaultReport::default() });
    });
    assert!(grade == Grade::Bad && words.contains("regulator-x at 0.000 s: the drive"), "{words}");
    let (grade, words) = defect(|summary| {
        let text = "the tool stands in the thread of pass 1".into();
        summary.warnings = vec![FaultReport { code: TOOL_IN_THREAD.into(), text, ..FaultReport::default() }];
    });
    assert!(grade == Grade::Bad && words.contains("Careful: the tool stands in the thread"), "{words}");
}
