//! Parts that are not good, although the nut behind the screw is: they are judged at the tool, over all
//! contact, and the exit status says so. Beside each the same program on a machine that makes it well.

use machine::PLAIN_LATHE;
use rig::observe::{Outcome, PartVerdict, Summary};

use crate::shop::{Place, example};

/// M20 by 2, with flank infeed.
const THREAD: &str = "G18 G21 G90 G8 G97\nM3 S600\nG0 X11 Z8\nG76 P2 Z-22 I-1 J0.35 K1.2 R2 Q29.5 H1\n\
                      G0 X16\nG0 Z60\nM5\nM2\n";
/// The same, out over a taper of 20 mm.
const TAPER: &str = "G18 G21 G90 G8 G97\nM3 S600\nG0 X11 Z8\nG76 P2 Z-22 I-1 J0.35 K1.2 R2 L2 E20\n\
                     G0 X16\nG0 Z60\nM5\nM2\n";
/// One pass that does not say how deep it is.
const SINGLE: &str = "G18 G21 G90 G8 G97\nM3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z-22 K2\nG0 X12\nG0 Z60\nM5\nM2\n";

/// What a run leaves: its exit status, what it says on standard error, its summary.
fn run(program: &str, machine: &str, scenario: &str) -> (Option<i32>, String, Summary) {
    let place = Place::new();
    place.write("part.ngc", program);
    place.write("lathe.toml", machine);
    place.write("what.toml", scenario);
    let arguments = ["run", "part.ngc", "--machine", "lathe.toml", "--scenario", "what.toml", "--in-process"];
    let answer = place.ask(&[&arguments[..], &["--json", "--trace", "none", "--out", "run"]].concat());
    let summary = serde_json::from_str(&answer.stdout).expect("--json prints the summary and nothing else");
    (answer.status, answer.stderr, summary)
}

/// The built-in lathe with other values behind a key.
fn lathe(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(PLAIN_LATHE.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 2, "{from} of both axes");
        text.replace(from, to)
    })
}

#[track_caller]
fn is_bad(program: &str, machine: &str, scenario: &str, reason: &str) -> Summary {
    let (status, said, summary) = run(program, machine, scenario);
    assert_eq!(summary.outcome, Outcome::Completed, "{:?}", summary.faults);
    assert_eq!((status, summary.part.verdict), (Some(3), PartVerdict::Bad), "{said}");
    assert!(said.contains("not good: ") && said.contains(reason), "{said}");
    assert_eq!(said.matches("not good: ").count(), summary.part.reasons.len(), "{said}");
    // The nut would not have told.
    assert!(summary.passes.iter().all(|pass| pass.helix_max_abs_um < 5.0), "{summary:#?}");
    summary
}

#[test]
fn a_slide_that_swings_behind_its_nut_makes_a_bad_part() {
    let soft =
        lathe(&[("mode_hz = 100.0", "mode_hz = 20.0"), ("mode_damping = 0.03", "mode_damping = 0.005")]);
    let summary = is_bad(THREAD, &soft, "", "from its own groove at the tool");
    assert!(summary.at_the_tool()[0] > 30.0, "{:?}", summary.at_the_tool());
    let (status, said, summary) = run(THREAD, PLAIN_LATHE, "");
    assert_eq!((status, said.as_str(), summary.part.verdict), (Some(0), "", PartVerdict::Good));
}

#[test]
fn a_guide_that_sticks_makes_a_bad_part() {
    let stiff = lathe(&[
        ("slide_coulomb_n = 120.0", "slide_coulomb_n = 2000.0"),
        ("slide_static_n = 160.0", "slide_static_n = 2500.0"),
    ]);
    is_bad(THREAD, &stiff, "", "from the flank while the tool leaves");
    is_bad(SINGLE, &stiff, "", "of radius too shallow at the tool");
}

#[test]
fn a_blow_in_the_taper_at_the_end_makes_a_bad_part() {
    let load =
        "[[event]]\nat = { pass = 2, z_mm = -12 }\nspindle_load = { torque_nm = 1000, for_s = 0.01 }\n";
    let summary = is_bad(TAPER, PLAIN_LATHE, load, "pass 2 strays by ");
    let struck = &summary.passes[1];
    assert!(struck.helix_max_abs_um < 0.5 && struck.tool.helix_max_abs_um > 15.0, "{struck:#?}");
    // The law knows of no blow, the nut does.
    assert!(struck.limits_asked_pct.z_j < 100.0 && struck.limits_used_pct.z_j > 300.0, "{struck:#?}");
    assert_eq!(run(TAPER, PLAIN_LATHE, "").0, Some(0));
}

#[test]
fn what_a_part_may_be_off_is_said_by_the_machine_file() {
    let allowed =
        |um: &str| PLAIN_LATHE.replace("[threading]\n", &format!("[threading]\npart_error_um = {um}\n"));
    let (status, said, summary) = run(THREAD, &allowed("1.2"), "");
    assert_eq!((status, summary.part.error_um), (Some(3), 1.2));
    assert!(said.contains("threading.part_error_um allows 1.2 µm"), "{said}");
    assert_eq!(run(SINGLE, &allowed("4.0"), "").0, Some(0));
}

/// What the slide does in a good thread: it stands some micrometres behind its nut, the same in every pass.
#[test]
fn a_good_thread_stands_off_together() {
    let summary = Place::new().run_plain(&example("m20x2"), None);
    for pass in &summary.passes {
        assert!((2.9..3.2).contains(&pass.tool.phase_um), "{pass:#?}");
        assert!(pass.tool.helix_max_abs_um < 0.9 && pass.tool.contact_deg > 3700.0, "{pass:#?}");
        assert!(pass.tool.flank_um < 2.3, "{pass:#?}");
    }
    let [_, passes, depth, ends] = summary.at_the_tool();
    assert!(passes < 0.05 && depth < 3.5 && ends < 2.5, "{passes} {depth} {ends}");
}
