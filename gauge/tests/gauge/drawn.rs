//! Grooves that are drawn, against spots that are made by other formulas than the drawing has: the way of a
//! lead that grows is a parabola of the turns, an arc is drawn from its centre.

use gauge::{Drawn, DrawnReport, Spot, Verdict, judge_drawn};

const STATIONS: u32 = 72;

/// What is wrong on purpose: parts of the lead, turns, mm.
#[derive(Clone, Copy, Debug, Default)]
struct Wrong {
    lead: f64,
    turns: f64,
    shallow_mm: f64,
    ends_mm: Option<f64>,
}

/// A pass whose place after n turns, and whose radius there, are told; towards the chuck if the place falls.
fn pass(number: u32, turns: f64, tangent: f64, wrong: Wrong, at: impl Fn(f64) -> [f64; 2]) -> Vec<Spot> {
    let steps = (turns * f64::from(STATIONS)) as u32;
    let spot = |step: u32| {
        let angle = f64::from(step) / f64::from(STATIONS);
        let [z_mm, radius_mm] = at((angle + wrong.turns) * (1.0 + wrong.lead));
        let radius_mm = radius_mm + wrong.shallow_mm;
        Spot { pass: number, station: (step + 17) % STATIONS, z_mm, radius_mm, tangent }
    };
    (0..steps).map(spot).filter(|spot| wrong.ends_mm.is_none_or(|z| spot.z_mm >= z)).collect()
}

fn drawn(text: &str) -> Drawn {
    text.parse().unwrap_or_else(|misread| panic!("{text}: {misread:?}"))
}

/// Lead 3 to Z 0, growing to 5 over 40 mm, then 5; right-hand.
fn grows(n: f64) -> f64 {
    let (z0, n0) = (12.0, 4.0);
    let growth = 0.2;
    let turns = 10.0;
    match n - n0 {
        m if m < 0.0 => z0 - 3.0 * n,
        m if m < turns => -(3.0 * m + 0.5 * growth * m * m),
        m => -40.0 - 5.0 * (m - turns),
    }
}

const GROWS: &str = "Z8 D28 K3, Z0, Z-40 K5, Z-55, within 0.02";

fn variable(wrong: Wrong) -> Vec<Spot> {
    pass(1, 18.0, 0.26, wrong, |n| [grows(n), 14.0])
}

fn judged(text: &str, spots: &[Spot]) -> DrawnReport {
    judge_drawn(&drawn(text), STATIONS, spots)
}

fn refused(text: &str, spots: &[Spot], why: &str) {
    let report = judged(text, spots);
    assert_eq!(report.verdict, Verdict::Bad);
    assert!(report.reasons.iter().any(|reason| reason.contains(why)), "{why}: {:?}", report.reasons);
}

#[test]
fn a_lead_that_grows_is_as_drawn_and_one_that_does_not_is_not() {
    let good = judged(GROWS, &variable(Wrong::default()));
    assert_eq!((good.verdict, &good.reasons[..]), (Verdict::Good, &[][..]));
    assert!(good.place_um < 1e-6 && good.lead_error_um.abs() < 1e-6, "{good:?}");
    assert!((good.turns - (8.0 / 3.0 + 10.0 + 3.0)).abs() < 1e-9, "{good:?}");
    let wrong = Wrong { lead: 2e-3, ..Wrong::default() };
    refused(GROWS, &variable(wrong), " long over 63.0 mm");
    refused("Z8 D28 K3, Z0, Z-40 K5.05, Z-55", &variable(Wrong::default()), " short over 63.0 mm");
    refused("Z8 D28 K3, Z-55", &variable(Wrong::default()), " long over 63.0 mm");
    refused(&format!("LH, {GROWS}"), &variable(Wrong::default()), "winds the other way");
}

#[test]
fn depth_is_judged_at_every_turn() {
    for (shallow_mm, why) in [(0.03, "30.0 µm too shallow"), (-0.03, "30.0 µm too deep")] {
        refused(GROWS, &variable(Wrong { shallow_mm, ..Wrong::default() }), why);
    }
    refused(GROWS, &variable(Wrong { ends_mm: Some(-50.0), ..Wrong::default() }), "not cut at Z -5");
    let mut dent = variable(Wrong::default());
    dent[500].radius_mm += 0.03;
    refused(GROWS, &dent, "30.0 µm too shallow at Z -");
    assert_eq!(judged(GROWS, &[]).verdict, Verdict::None);
}

/// A pass that lies aside does nothing as long as its flanks stay in the groove.
#[test]
fn a_pass_aside_widens_the_groove_by_what_its_flanks_reach() {
    let last = variable(Wrong::default());
    let beside = |turns: f64, shallow_mm: f64| {
        let wrong = Wrong { turns, shallow_mm, ..Wrong::default() };
        let mut all = pass(2, 18.0, 0.26, wrong, |n| [grows(n), 14.0]);
        all.extend(&last);
        judged(GROWS, &all)
    };
    let good = beside(0.02, 0.5);
    assert_eq!(good.verdict, Verdict::Good, "0.02 turns are 60 to 100 µm, and 0.5 mm of 0.26 are 130");
    let bad = beside(0.04, 0.5);
    assert!((bad.place_um - (0.04 * 5.0e3 - 130.0)).abs() < 1.0, "{bad:?}");
    assert_eq!(bad.verdict, Verdict::Bad);
    let close = beside(0.0055, 0.0);
    assert!(close.place_um < 15.0 && close.reasons.concat().contains(" apart"), "{close:?}");
    let deep = beside(0.02, 0.0);
    assert_eq!(deep.verdict, Verdict::Bad);
    assert!((60.0..100.0).contains(&deep.passes_um), "{deep:?}");
}

/// R 150 about a centre on Z -20, crown at diameter 38; lead 2.
#[test]
fn a_barrel_and_a_hollow_are_arcs() {
    for (bulges, text) in [(1.0, "Z-2 D35.832168 K2, Z-38 R150"), (-1.0, "Z-2 D40.167832 K2, Z-38 R-150")] {
        let radius = |z: f64| {
            let sagitta = 150.0 - ((150.0_f64 * 150.0) - (z + 20.0) * (z + 20.0)).sqrt();
            19.0 - bulges * sagitta
        };
        let arc = |wrong| pass(1, 25.0, 0.5, wrong, |n| [4.0 - 2.0 * n, radius(4.0 - 2.0 * n)]);
        let good = judged(text, &arc(Wrong::default()));
        assert_eq!((good.verdict, &good.reasons[..]), (Verdict::Good, &[][..]));
        assert!(good.depth_um.iter().all(|um| um.abs() < 0.01), "{good:?}");
        refused(text, &arc(Wrong { shallow_mm: 0.05, ..Wrong::default() }), "too shallow");
        refused(text.split(" R").next().expect("a text"), &arc(Wrong::default()), "too");
    }
}

/// A scroll: the radius grows with the angle.
#[test]
fn a_scroll_runs_along_the_radius() {
    let spots = |wrong: f64| {
        let wrong = Wrong { lead: wrong, ..Wrong::default() };
        let spots = pass(3, 8.5, 0.3, wrong, |n| [12.0 + 4.0 * n, -1.0]);
        let turned = |spot: Spot| Spot { z_mm: spot.radius_mm, radius_mm: spot.z_mm, ..spot };
        spots.into_iter().map(turned).collect::<Vec<_>>()
    };
    let text = "face, D30 Z-1 K4, D86";
    assert_eq!(judged(text, &spots(0.0)).verdict, Verdict::Good);
    refused(text, &spots(2e-3), "55.9 µm long over 28.0 mm");
    refused(&format!("LH, {text}"), &spots(0.0), "winds the other way");
    refused("face, D30 Z-1.1 K4, D86", &spots(0.0), "100.0 µm too shallow");
}

#[test]
fn a_drawing_that_is_none_is_refused_with_its_place() {
    for (text, why) in [
        ("Z0 D20", "missing"),
        ("Z0 D20 K2", "2 to 64 rows"),
        ("Z0 D20 K2, Z-10, Z-5", "one way"),
        ("Z0 D20 K2, Z-40 R10", "does not reach"),
        ("Z0 D20 K2, Z0 D30", "no length"),
        ("Z0 D20 K2, Z-10, within 0", "no tolerance"),
        ("Z0 D20 K-2, Z-10", "above 0"),
        ("Z0 D20 K0.001, Z-100000", "at most 10000"),
        ("Z0 D20 K2 Q5, Z-10", "\"Q5\""),
        ("Z0 D20 K2,, Z-10", "empty"),
        ("Z0 D20 K1e400, Z-10", "\"K1e400\""),
        ("A200, Z0 D20 K2, Z-10", "no angle"),
        ("Zé D20 K2, Z-10", "\"Zé\""),
    ] {
        let misread = text.parse::<Drawn>().expect_err(text);
        assert!(misread.message.contains(why), "{text}: {misread:?}");
        assert!(misread.help.contains("Z0 D29 K3") && text.get(misread.span).is_some(), "{text}");
    }
}
