//! A lathe with a C axis: it turns with the others, in degrees, and holds its angle while a thread is cut.
#![allow(clippy::unwrap_used)]

use machine::{Machine, PLAIN_LATHE};
use protocol::Axis;
use rig::observe::Outcome;

use crate::stand::{Stand, compiled};

/// The small lathe with an axis C: another Z, in degrees.
fn lathe_with_c() -> Machine {
    let (_, z) = PLAIN_LATHE.split_once("[axis.z]").unwrap();
    let (z, _) = z.split_once("[spindle]").unwrap();
    let c = z.replace("mm", "deg").replace("home_deg = 100.0", "home_deg = 0.0");
    Machine::from_toml(&format!("{PLAIN_LATHE}\n[axis.c]{c}")).unwrap()
}

#[test]
fn c_goes_along_and_holds_still_in_a_thread() {
    let program = "G18 G21 G90 G8 G94 G97\nG0 X22 Z8 C90\nG1 C100 F600\nM3 S600\nG76 P2 Z0 I-1 J0.299 K0.3\n\
                   G0 X40 C0\nM5\nM2\n";
    let machine = lathe_with_c();
    let items = compiled(&machine, program);
    let (mut at, mut cut, mut strayed) = (0.0, 0, 0.0_f64);
    let seen = Stand { machine: &machine, items: &items, scenario: "", seed: 3 }.run(|record| {
        at = record.truth.axes[Axis::C.index()].motor_mm;
        if record.axes.iter().any(|(_, axis)| axis.pass != 0) {
            (cut, strayed) = (cut + 1, strayed.max((at - 100.0).abs()));
        }
        None
    });
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!((seen.passes.len(), seen.moves.limit_violations), (2, 0));
    assert!(cut > 1000 && strayed < 0.001 && at.abs() < 0.001, "{cut} cycles, {strayed}, {at}");
    assert!(seen.passes.iter().all(|pass| pass.helix_max_abs_um < 5.0 && pass.complete));
}
