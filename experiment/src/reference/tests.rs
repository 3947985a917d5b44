//! What agrees with the reference, by its own rule; and that the rule can fail.

use super::*;

fn compared(printed: &'static str, seeds: &[f64]) -> Compared {
    Compared::of(printed, seeds.to_vec())
}

#[test]
fn a_figure_agrees_within_five_per_cent_a_digit_or_the_spread() {
    assert!(compared("796", &[760.0, 761.0]).agrees() && !compared("796", &[750.0, 751.0]).agrees());
    assert!(compared("0.3", &[0.39, 0.39]).agrees() && !compared("0.3", &[0.41, 0.41]).agrees());
    assert!(compared("1.00", &[1.0, 1.4]).agrees() && !compared("1.00", &[1.2, 1.25]).agrees());
    assert!(!compared("1.0", &[]).agrees());
}

/// Three rows that differ most in what they ask of the plant, at the seeds of the page.
#[test]
fn the_reference_comes_out() {
    let stand = Stand { machine: machine::Machine::plain(), seed: 1, progress: false };
    for (structure, at) in [(&STRUCTURES[0], 0), (&STRUCTURES[4], 0), (FULL, 0)] {
        let cases: Vec<Case> = seeds(&stand, structure, AS_PRINTED, OVERRIDES[at]).collect();
        let measured = stand.each(&cases, Case::run).expect("every pass can be cut");
        let row = Row::of(structure, at, &measured);
        assert!(row.agrees, "{row:?}");
    }
}

/// Without the breakaway of the screw the end of the approach is half of what it is in the reference.
#[test]
fn a_screw_without_breakaway_does_not() {
    let stand = Stand { machine: machine::Machine::plain(), seed: 1, progress: false };
    let switches = Switches { breakaway: false, ..AS_PRINTED };
    let cases: Vec<Case> = seeds(&stand, FULL, switches, 100.0).collect();
    let measured = stand.each(&cases, Case::run).expect("every pass can be cut");
    let row = Row::of(FULL, 0, &measured);
    assert!(row.end_um < 0.2 && !row.figures[2].agrees(), "{row:?}");
}

/// An observer that looks at the encoder every 1 ms lets through half as much again of its counts as one that
/// looks every 0.5 ms.
#[test]
fn an_observer_that_looks_less_often_is_noisier() {
    let stand = Stand { machine: machine::Machine::plain(), seed: 1, progress: false };
    let widest = |observer_cycles| {
        let switches = Switches { observer_cycles, ..AS_PRINTED };
        let cases: Vec<Case> = seeds(&stand, FULL, switches, 100.0).collect();
        let row = Row::of(FULL, 0, &stand.each(&cases, Case::run).expect("every pass can be cut"));
        row.approach_max_um - row.approach_min_um
    };
    let (often, seldom) = (widest(1), widest(2));
    assert!(seldom > 1.3 * often, "{seldom} µm, {often} µm");
}
