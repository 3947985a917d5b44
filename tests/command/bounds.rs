//! A pass takes as long as it takes: no bound in time of the computer or of the machine ends it.

use rig::observe::{Outcome, PassEnd, Summary};

use crate::shop::{Answer, Place, project};

/// Six turns at 4 1/min: 90 s on the machine, a turn longer than any time in which something is found to be
/// silent.
const SLOW: &str = "G18 G21 G90 G8\nM3 S4\nG0 X20 Z150\nG0 X9\nG33 Z138 K2\nG0 X20\nG0 Z150\nM5\nM2\n";
/// In the run-in of that pass.
const DIES: u64 = 30_000;

/// Its interpolator dies, and nothing happens above the regulators any more; the launcher has the shortest
/// patience that it can have.
#[test]
fn a_pass_longer_than_every_bound_is_cut_to_its_end() {
    let place = Place::new();
    let program = place.write("slow.ngc", SLOW);
    let machine = project().join("examples/machines/plain-lathe.toml");
    let mut command = place.pitchlock();
    command.arg("run").arg(&program).arg("--machine").arg(&machine);
    command.args(["--json", "--trace", "none", "--out", "run", "--watchdog-s", "0.001"]);
    command.arg("--fell").arg(format!("interpolator:kill@{DIES}"));
    let answer = Answer::from(command.output().expect("it starts"));
    assert_eq!(answer.status, Some(1), "{}", answer.stderr);
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("the summary");
    let dead = &summary.faults[0];
    assert_eq!(
        (dead.source.as_str(), dead.code.as_str(), dead.cycle),
        ("interpolator", "process-died", DIES)
    );
    assert!(summary.faults[1..].iter().all(|fault| fault.code == "emergency-stop"), "{:?}", summary.faults);
    assert_eq!(summary.outcome, Outcome::Faulted);
    let pass = &summary.passes[0];
    assert_eq!((pass.complete, pass.end), (true, PassEnd::Complete));
    let seconds = (pass.end_cycle - DIES) as f64 * summary.cycle_s;
    assert!(seconds > 90.0, "{seconds} s after the death");
    assert!(pass.helix_max_abs_um < 1.5, "{} µm", pass.helix_max_abs_um);
}
