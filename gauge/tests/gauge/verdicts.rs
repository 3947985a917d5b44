//! Good threads are good, and threads with an error on purpose are refused because of it.

use std::collections::BTreeSet;

use gauge::{Cause, Check, Verdict};
use testing::Seed;

use crate::made::{Errors, Made, cone, threads};

/// Tolerance of the pitch diameter, mm.
fn tolerance(made: &Made) -> f64 {
    made.nominal.pitch_diameter_mm[1] - made.nominal.pitch_diameter_mm[0]
}

#[test]
fn thirty_five_good_threads_are_good() {
    let mut seed = Seed::new(31);
    let mut good = 0;
    for thread in threads().into_iter().chain([cone()]) {
        for _ in 0..5 {
            let room = 0.05 * tolerance(&thread);
            let taper = thread.errors.taper;
            let made = thread.clone().with(Errors {
                lead: room * seed.signed() / thread.length_mm,
                drunken: 0.5 * room * seed.signed(),
                start: room * seed.signed(),
                taper: taper + if taper == 0.0 { room * seed.signed() / thread.length_mm } else { 0.0 },
                runout: room * seed.signed(),
                pass: room * seed.signed(),
            });
            let report = made.judged();
            assert_eq!(report.verdict, Verdict::Good, "{made:?}: {report:?}");
            let [low, high] = report.pitch_diameter_mm;
            let name = &made.nominal.name;
            let middle = 0.5 * (low + high);
            assert!((middle - made.pitch_diameter_mm).abs() < 6.0 * room, "{name}: {low} to {high}");
            for (is, asked) in report.flank_deg.iter().zip(made.nominal.flank_deg) {
                assert!((is - asked).abs() < 0.01, "{name}: {is}");
            }
            assert!((report.drunkenness_um.abs() - 2e3 * made.errors.drunken.abs()).abs() < 0.1, "{name}");
            assert!((report.runout_um - 2e3 * made.errors.runout.abs()).abs() < 0.2, "{name}");
            good += 1;
        }
    }
    assert_eq!(good, 35);
}

/// A thread with one error, and what refuses it.
fn wrong(thread: &Made) -> Vec<(&'static str, Made, Check, Cause)> {
    let tolerance = tolerance(thread);
    let (t, gauge) = (thread.tangent(), thread.nominal.gauge_mm);
    // What moves a flank so far uses up the tolerance.
    let all = 0.5 * tolerance * t;
    let with = |errors: Errors| thread.clone().with(errors);
    let flanks = |by: f64| {
        let mut made = thread.clone();
        made.edge.flank_deg = made.edge.flank_deg.map(|deg| deg + by);
        made
    };
    let mut wrong = vec![
        ("a long lead", with(Errors { lead: all / gauge, ..Errors::default() }), Check::Go, Cause::Lead),
        ("a short lead", with(Errors { lead: -all / gauge, ..Errors::default() }), Check::Go, Cause::Lead),
        ("another lead", with(Errors { lead: 0.1, ..Errors::default() }), Check::Go, Cause::Lead),
        (
            "a drunken helix",
            with(Errors { drunken: 0.5 * all, ..Errors::default() }),
            Check::Go,
            Cause::Drunken,
        ),
        ("too shallow", thread.clone().above_go(0.01), Check::Go, Cause::Size),
        ("too deep", thread.clone().above_no_go(-0.01), Check::NoGo, Cause::Size),
        ("steep flanks", flanks(-3.0).above_go(-0.2 * tolerance), Check::Go, Cause::Flanks),
        (
            "a cone",
            with(Errors { taper: 1.6 * tolerance / thread.length_mm, ..Errors::default() }),
            Check::Go,
            Cause::Taper,
        ),
        (
            "out of round",
            with(Errors { runout: 0.4 * tolerance, ..Errors::default() }),
            Check::Go,
            Cause::Runout,
        ),
    ];
    for um in [5.0, 20.0, 100.0] {
        let pass = 1e-3 * um;
        let made = with(Errors { pass, ..Errors::default() }).above_no_go(0.8 * 2.0 * pass / t);
        let taken = 2.0 * pass / t < 1.2 * tolerance;
        let name = ["a pass 5 µm off", "a pass 20 µm off", "a pass 100 µm off"]
            [(um > 5.0) as usize + (um > 20.0) as usize];
        if taken {
            wrong.push((name, made, Check::NoGo, Cause::Apart));
        }
    }
    if thread.nominal.starts > 1 {
        let start = with(Errors { start: 1.2 * all, ..Errors::default() });
        wrong.push(("the second start off", start, Check::Go, Cause::Starts));
    }
    wrong
}

#[test]
fn threads_that_are_wrong_on_purpose_are_refused_for_that_reason() {
    let (mut refused, mut out_of_phase) = (0, BTreeSet::new());
    for thread in threads() {
        for (what, made, check, cause) in wrong(&thread) {
            let report = made.judged();
            let at = format!("{}, {what}: {report:?}", made.nominal.name);
            assert_eq!(report.verdict, Verdict::Bad, "{at}");
            assert_eq!((report.reasons[0].check, report.reasons[0].cause), (check, cause), "{at}");
            refused += 1;
            if cause == Cause::Apart {
                // As deep and in phase it is good: nothing but the pass is wrong.
                let in_phase = made.with(Errors::default()).judged();
                assert_eq!(in_phase.verdict, Verdict::Good, "{}, {what}: {in_phase:?}", thread.nominal.name);
                out_of_phase.insert(what);
            }
        }
    }
    assert!(refused >= 60, "{refused}");
    assert_eq!(out_of_phase.len(), 3, "{out_of_phase:?}");
}

#[test]
fn a_thread_of_the_other_hand_or_with_too_few_starts_is_told() {
    for thread in threads() {
        let sections = thread.sections();
        let judged =
            |nominal: &gauge::Nominal| gauge::judge(nominal, &sections, thread.full_mm(), thread.crest_mm());
        let mut other = thread.nominal.clone();
        other.grows = !other.grows;
        let report = judged(&other);
        assert_eq!((report.verdict, report.reasons[0].cause), (Verdict::Bad, Cause::Hand), "{report:?}");
        let mut more = thread.nominal.clone();
        more.starts += 1;
        let report = judged(&more);
        let reason = &report.reasons[0];
        assert_eq!((reason.check, reason.cause), (Check::Grooves, Cause::Starts), "{report:?}");
        let text = format!("number of starts: {}, not {}", thread.nominal.starts, more.starts);
        assert_eq!(reason.text, text);
    }
}

#[test]
fn nothing_is_no_thread_and_a_scratch_is_too_shallow() {
    let thread = &threads()[0];
    let report = thread.clone().above_go(2.0).judged();
    assert_eq!((report.verdict, report.reasons[0].check), (Verdict::Bad, Check::Root), "{report:?}");
    let mut sections = thread.sections();
    sections.stations.iter_mut().for_each(Vec::clear);
    let report = gauge::judge(&thread.nominal, &sections, thread.full_mm(), None);
    assert_eq!((report.verdict, report.reasons.len()), (Verdict::None, 0));
}

#[test]
fn the_reason_is_told_in_words_with_numbers() {
    let thread = threads()[0].clone();
    let long = thread.clone().above_go(-0.02).with(Errors { lead: 0.001, ..Errors::default() });
    let text = &long.judged().reasons[0].text;
    assert_eq!(
        text,
        "GO does not go on: virtual pitch diameter 18.6776 mm, at most 18.6630 (lead 20.0 µm long over 20.00 mm)"
    );
    let deep = thread.above_no_go(-0.008).judged();
    assert_eq!(
        deep.reasons[0].text,
        "NO-GO goes on: pitch diameter 18.4950 mm, at least 18.5030 (cut 4.0 µm too deep)"
    );
}

#[test]
fn another_size_is_refused_without_figures() {
    let thread = &threads()[0];
    let sections = thread.sections();
    for (diameters, check, cause, says) in [
        ([22.503, 22.663], Check::Grooves, Cause::Ridge, "no ridge is left between the grooves at 22.663 mm"),
        ([14.503, 14.663], Check::Root, Cause::Size, "the groove does not reach the pitch line"),
    ] {
        let nominal = gauge::Nominal { pitch_diameter_mm: diameters, ..thread.nominal.clone() };
        let report = gauge::judge(&nominal, &sections, thread.full_mm(), None);
        assert_eq!(report.verdict, Verdict::Bad, "{report:?}");
        let [reason] = &report.reasons[..] else { panic!("{report:?}") };
        assert_eq!((reason.check, reason.cause), (check, cause));
        assert!(reason.text.starts_with(says), "{}", reason.text);
        let none =
            gauge::Report { verdict: Verdict::Bad, reasons: report.reasons.clone(), ..Default::default() };
        assert_eq!(report, none);
    }
}

/// Depth is blamed only where another depth would help, and nothing that weighs as much is left out.
#[test]
fn causes_are_those_that_would_help() {
    for thread in threads() {
        let tolerance = tolerance(&thread);
        let all = 0.5 * tolerance * thread.tangent();
        let long = Errors { lead: 1.5 * all / thread.nominal.gauge_mm, ..Errors::default() };
        let shallow = thread.clone().above_go(0.4 * tolerance).with(long);
        let [reason] = &shallow.judged().reasons[..] else { panic!("{shallow:?}") };
        assert!(reason.cause == Cause::Lead && !reason.text.contains("shallow"), "{}", reason.text);
        let both = Errors { drunken: 0.5 * all, lead: all / thread.nominal.gauge_mm, ..Errors::default() };
        let text = thread.clone().with(both).judged().reasons[0].text.clone();
        assert!(text.contains("lead") && text.contains("helix uneven"), "{text}");
        let little = Errors { runout: 0.05 * tolerance, ..Errors::default() };
        let text = thread.clone().above_go(0.6 * tolerance).with(little).judged().reasons[0].text.clone();
        assert!(!text.contains("runs out"), "{text}");
    }
}
