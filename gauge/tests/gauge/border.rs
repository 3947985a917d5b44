//! At the border of a limit the verdict turns where it should, within 0.5 µm of the pitch diameter. What each
//! error costs is worked out by hand here.

use gauge::Verdict;

use crate::made::{Errors, Made, cone, threads};

/// How far the border may be off, mm of diameter.
const BORDER_MM: f64 = 5e-4;

/// The largest amount between 0 and `most` of which the thread is good.
fn turns_at(most: f64, made: &dyn Fn(f64) -> Made) -> f64 {
    let good = |amount: f64| made(amount).judged().verdict == Verdict::Good;
    assert!(good(0.0), "{:?}", made(0.0).judged());
    assert!(!good(most), "{:?}", made(most).judged());
    let (mut low, mut high) = (0.0, most);
    for _ in 0..14 {
        let middle = 0.5 * (low + high);
        if good(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// An error that costs `per` mm of diameter for each mm uses up `margin` mm there.
fn border(name: &str, margin: f64, per: f64, made: &dyn Fn(f64) -> Made) {
    let at = turns_at(3.0 * margin / per, made);
    assert!((at * per - margin).abs() < BORDER_MM, "{name}: turns at {at}, {} of {margin}", at * per);
}

#[test]
fn depth_turns_the_verdict_at_the_limit() {
    for thread in threads().into_iter().chain([cone()]) {
        let name = &thread.nominal.name;
        let errors = thread.errors;
        border(name, 0.02, 1.0, &|mm| thread.clone().with(errors).above_go(mm - 0.02));
        border(name, 0.02, 1.0, &|mm| thread.clone().with(errors).above_no_go(0.02 - mm));
    }
}

#[test]
fn errors_of_the_helix_turn_the_verdict_at_the_limit() {
    for thread in threads() {
        let (name, t, margin) = (&thread.nominal.name, thread.tangent(), 0.03);
        let with = |errors: Errors| thread.clone().above_go(-margin).with(errors);
        let gauge = thread.nominal.gauge_mm;
        border(name, margin, 2.0 * gauge / t, &|lead| with(Errors { lead, ..Errors::default() }));
        border(name, margin, 2.0 * gauge / t, &|lead| with(Errors { lead: -lead, ..Errors::default() }));
        border(name, margin, 4.0 / t, &|drunken| with(Errors { drunken, ..Errors::default() }));
        if thread.nominal.starts == 2 {
            border(name, margin, 2.0 / t, &|start| with(Errors { start, ..Errors::default() }));
        }
    }
}

#[test]
fn errors_of_the_diameter_turn_the_verdict_at_the_limit() {
    for thread in threads() {
        let (name, margin) = (&thread.nominal.name, 0.03);
        let with = |errors: Errors| thread.clone().above_go(-margin).with(errors);
        border(name, margin, 2.0, &|runout| with(Errors { runout, ..Errors::default() }));
        let loose = |errors: Errors| thread.clone().above_no_go(margin).with(errors);
        border(name, margin, 2.0, &|runout| loose(Errors { runout, ..Errors::default() }));
        border(name, margin, 2.0 / thread.tangent(), &|pass| loose(Errors { pass, ..Errors::default() }));
        // The thread ends where the last of its grooves has its middle, a station from its end at most.
        let half = 0.5 * thread.length_mm;
        border(name, margin, half, &|taper| with(Errors { taper, ..Errors::default() }));
    }
}

/// Flanks that are steeper by a small angle lean into the counterpart at the crest.
#[test]
fn flanks_turn_the_verdict_at_the_limit() {
    for thread in threads().into_iter().filter(|thread| thread.crest_mm().is_some()) {
        let margin = 0.02;
        let crest = 0.5 * (thread.sign() * (thread.crest_mm().expect("it is known") - thread.limits()[0]));
        let height = crest + 0.5 * margin;
        let tangent = |deg: f64| libm::tan(deg.to_radians());
        let flank = thread.nominal.flank_deg[0];
        let steep = |by: f64| {
            let mut made = thread.clone().above_go(-margin);
            made.edge.flank_deg = made.edge.flank_deg.map(|deg| deg - by);
            made
        };
        let at = turns_at(2.0, &steep);
        let costs = 2.0 * (tangent(flank) - tangent(flank - at)) * height / tangent(flank);
        assert!((costs - margin).abs() < BORDER_MM, "{}: {at}°, {costs}", thread.nominal.name);
    }
}
