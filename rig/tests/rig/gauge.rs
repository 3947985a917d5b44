//! The virtual gauge on a whole machine: the thread of an example passes GO and NO-GO of its class, and one
//! that is cut wrongly does not.

use std::collections::BTreeMap;

use gauge::{Nominal, Side};
use machine::{Machine, Tool};
use rig::{
    Rig,
    observe::{GaugeAsked, GaugeReport, Observer, PartVerdict, PassReport},
};
use sim_plant::Scenario;

use crate::stand::compiled;

/// M20x2-6g of ISO 965.
fn m20x2() -> Nominal {
    Nominal {
        name: "M20x2-6g".into(),
        side: Side::External,
        flank_deg: [30.0; 2],
        pitch_mm: 2.0,
        starts: 1,
        grows: false,
        pitch_diameter_mm: [18.503, 18.663],
        crest_mm: [Some(19.682), Some(19.962)],
        root_go_mm: Some(17.797),
        root_mm: [None; 2],
        taper: 0.0,
        plane_mm: 0.0,
        gauge_mm: 20.0,
        tap_mm: None,
        blunt_turns: None,
        left_out: &[],
    }
}

/// The thread of a program on the built-in lathe with an insert of this nose.
fn gauged(program: &str, nose_mm: f64, scenario: &str) -> (GaugeReport, Vec<PassReport>) {
    let mut machine = Machine::default();
    let (insert, angle_deg) = (Tool { name: "insert".into(), ..Tool::default() }, Some(60.0));
    machine.tools.insert("1".into(), insert.clone());
    machine.tools.insert("3".into(), Tool { angle_deg, nose_mm: Some(nose_mm), ..insert });
    gauged_on(&machine, program, scenario)
}

fn gauged_on(machine: &Machine, program: &str, scenario: &str) -> (GaugeReport, Vec<PassReport>) {
    let items = compiled(machine, program);
    let scenario = Scenario::from_toml(scenario).expect("the scenarios of the tests are sound");
    let asked = GaugeAsked { nominal: m20x2(), origins_mm: BTreeMap::new(), passes: None };
    let mut observer = Observer::new(machine, &items).with_gauge(asked);
    let mut rig = Rig::new(machine, items.iter().copied(), scenario, 1).expect("a machine");
    while rig.cycle(None, |record| observer.cycle(record)) {}
    let observation = observer.finish();
    let report = observation.gauge.expect("a gauge was asked for");
    println!("{report:?}");
    (report, observation.passes)
}

fn example() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/m20x2.ngc");
    std::fs::read_to_string(path).expect("the example is there")
}

/// The example for an insert of this nose: a point that is round ends earlier.
fn in_class() -> String {
    with_depth("K2.392")
}

fn with_depth(k: &str) -> String {
    let program = example();
    assert!(program.contains(" K2.969 "), "the depth of a sharp tool");
    program.replace(" K2.969 ", &format!(" {k} "))
}

/// H/6, as the class allows at most: with it a depth of 0.6134 P from the nominal diameter is the basic
/// profile.
const NOSE_MM: f64 = 0.288_675;

/// The built-in lathe knows no shape of its tools. The example is in the middle of its class there, as far
/// as the point of the tool stands where it is taken to be.
#[test]
fn the_example_is_a_good_thread_of_its_class_on_the_built_in_lathe() {
    let (report, passes) = gauged_on(&Machine::default(), &example(), "");
    assert_eq!((report.verdict, &report.reasons[..]), (PartVerdict::Good, &[][..]));
    let off_mm = 2e-3 * passes.last().expect("there are passes").tool.x_max_um;
    for mm in [report.pitch_diameter_min_mm, report.pitch_diameter_max_mm, report.virtual_pitch_diameter_mm] {
        assert!((mm - 18.583 - off_mm).abs() < 0.002, "{report:?}");
    }
    assert_eq!(report.crest_mm.len(), 2, "the crest was turned");
    assert!(report.crest_mm.iter().all(|mm| (mm - 19.82).abs() < 0.02), "{report:?}");
}

/// The basic profile is no 6g thread: it lacks the 38 µm that g leaves to a coating. Deeper by that and by
/// half of the tolerance it is one, as large as its tool makes it.
#[test]
fn an_example_is_judged_by_what_its_tool_leaves() {
    let (basic, _) = gauged(&with_depth("K2.274"), NOSE_MM, "");
    let words = "GO does not go on: virtual pitch diameter 18.7";
    assert!(basic.reasons[0].starts_with(words) && basic.reasons[0].ends_with("too shallow)"), "{basic:?}");
    let (deeper, passes) = gauged(&in_class(), NOSE_MM, "");
    assert_eq!((deeper.verdict, &deeper.reasons[..]), (PartVerdict::Good, &[][..]));
    // The tip is meant to lie 2.392 mm below 19.82 mm; it is half a pitch wide H/2 − NOSE_MM above itself.
    // How far it stood off at full depth is measured elsewhere: the last three passes go all as deep.
    let meant_mm = 19.82 - 2.392 + 2.0 * (0.75_f64.sqrt() - NOSE_MM);
    let finishing = &passes[passes.len() - 3..];
    let low_um = finishing.iter().map(|pass| pass.tool.x_min_um).fold(f64::INFINITY, f64::min);
    let high_um = finishing.iter().map(|pass| pass.tool.x_max_um).fold(f64::NEG_INFINITY, f64::max);
    println!("depth off by {low_um:.2} to {high_um:.2} µm");
    let off_um = |mm: f64| 0.5e3 * (mm - meant_mm);
    assert!(off_um(deeper.pitch_diameter_min_mm) >= low_um - 0.2, "{deeper:?}");
    assert!(off_um(deeper.pitch_diameter_max_mm) <= high_um + 0.2, "{deeper:?}");
    assert!(deeper.lead_error_um.abs() < 2.0 && deeper.drunkenness_um < 4.0, "{deeper:?}");
}

/// A lead that is long by 10 µm a turn, 100 µm over the gauge.
#[test]
fn a_wrong_pitch_is_refused_because_of_its_lead() {
    let program = in_class().replace("G76 P2 ", "G76 P2.01 ");
    let (report, _) = gauged(&program, NOSE_MM, "");
    assert!((report.lead_error_um - 100.0).abs() < 2.0, "{report:?}");
    assert_eq!(report.verdict, PartVerdict::Bad);
    assert!(report.reasons[0].contains("(lead ") && report.reasons[0].contains(" long over "), "{report:?}");
}

/// A pass that is left in a hold and cut again, and one in which the override is turned, leave the same
/// thread.
#[test]
fn a_thread_that_was_held_or_turned_slower_passes_the_same_gauge() {
    let program = in_class();
    let (quiet, passes) = gauged(&program, NOSE_MM, "");
    let finish = passes.len() - 2;
    let held = format!(
        "[[event]]\nat = {{ pass = {finish}, angle_deg = 2500 }}\nfeed_hold = true\n\
         [[event]]\nat = {{ time_s = 200 }}\ncycle_start = true\n"
    );
    let slower =
        format!("[[event]]\nat = {{ pass = {finish}, angle_deg = 2500 }}\nspindle_override_pct = 70\n");
    let left = program.replace("\nT3 ", "\n(on_hold, leave)\nT3 ");
    for (program, scenario) in [(&left, &held), (&program, &slower)] {
        let (report, passes) = gauged(program, NOSE_MM, scenario);
        assert_eq!((report.verdict, passes.len() >= finish + 2), (PartVerdict::Good, true), "{report:?}");
        let change = report.virtual_pitch_diameter_mm - quiet.virtual_pitch_diameter_mm;
        assert!(change.abs() < 0.01 && report.drunkenness_um < 8.0, "{report:?}");
        assert_ne!(report, quiet, "something happened");
    }
}
