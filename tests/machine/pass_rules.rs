//! The two rules of a pass against broken wires. Self-contained: what has begun is cut to its end whoever is
//! gone. Same index: every axis takes the same index, or none moves.

use crate::stand::{Stand, compiled};
use protocol::{Axis, AxisState, Code, Fault, MachineState, ThreadPass};

/// One pass of G33 with a rapid in X behind it: its run-out.
const PROGRAM: &str = "G18 G21 G90 G8\nM3 S600\nG0 X20 Z20\nG0 X9\nG33 Z-20 K2\nG0 X20\nG0 Z20\nM5\nM2\n";

/// A load on the spindle in the middle of the pass.
const BOGGED: &str =
    "[[event]]\nat = { pass = 1, angle_deg = 1500 }\nspindle_load = { torque_nm = 51.0, for_s = 0.2 }\n";

fn the_pass() -> ThreadPass {
    let mut passes = compiled(PROGRAM).into_iter().filter_map(|item| match item.code {
        Code::Pass(pass) => Some(pass),
        _ => None,
    });
    passes.next_back().expect("the program cuts a pass")
}

#[test]
fn a_pass_is_cut_to_its_end_without_the_interpolator() {
    for scenario in ["", BOGGED] {
        let mut machine = Stand::new(compiled(PROGRAM), scenario);
        machine.until("both axes count C", |machine| {
            machine.all_in(&[AxisState::WaitingForC0, AxisState::RunIn, AxisState::Locked])
        });
        machine.kill_interpolator();
        machine.until("both axes are through", |machine| {
            machine.all_in(&[AxisState::Streaming, AxisState::Fault])
        });
        machine.run(1000);
        let pass = the_pass();
        for axis in [Axis::X, Axis::Z] {
            let off_mm = machine.true_mm(axis) - pass.axis(axis).end.mm();
            assert!(off_mm.abs() < 0.002, "{axis:?} rests {off_mm} mm beside the end of its law");
        }
        let observed = machine.observed();
        assert_eq!(observed.passes.len(), 1);
        let cut = &observed.passes[0];
        assert!(cut.complete && cut.same_index, "{cut:#?}");
        assert!(cut.thread_cycles > 1000 && cut.helix_max_abs_um <= 3.0, "{cut:#?}");
    }
}

/// Arms the pass with one wire too slow by so many ticks, and gives what became of it.
fn armed_late(axis: Axis, ticks: usize) -> Stand {
    let mut machine = Stand::new(compiled(PROGRAM), "");
    let begins = |machine: &Stand| machine.machine_status.state == MachineState::Threading as u32;
    machine.until("the pass is armed", begins);
    machine.delay_frames(axis, ticks);
    machine
}

#[test]
fn one_late_frame_calls_the_pass_off_on_every_axis() {
    for (axis, ticks) in [Axis::X, Axis::Z].into_iter().flat_map(|axis| (1..=8).map(move |n| (axis, n))) {
        let what = format!("{axis:?} late by {ticks} ticks");
        let mut machine = armed_late(axis, ticks);
        let before = [Axis::X, Axis::Z].map(|axis| machine.true_mm(axis));
        let rests = [AxisState::Streaming, AxisState::Armed, AxisState::WaitingForC0, AxisState::Fault];
        for _ in 0..4000 {
            machine.cycle();
            assert!(machine.all_in(&rests), "{what}: {:?}", machine.statuses().collect::<Vec<_>>());
        }
        assert_eq!(machine.machine_status.fault, Fault::PassCalledOff as u32, "{what}");
        let named = usize::from(machine.machine_status.fault_axis);
        // One that is told too late to call the pass off has armed in time, and then not been heard.
        assert_eq!(named, axis.index() + 1, "{what}");
        assert!(machine.all_in(&[AxisState::Streaming, AxisState::Fault]), "{what}: nobody stays armed");
        for (axis, before) in [Axis::X, Axis::Z].into_iter().zip(before) {
            let moved_um = 1e3 * (machine.true_mm(axis) - before);
            assert!(moved_um.abs() < 2.0, "{what}: {axis:?} moved {moved_um} µm");
        }
        // Beyond the four ticks between arming and the first index that counts, the regulator says no by
        // itself.
        let refused = machine.statuses().any(|(other, status)| other == axis && status.refused > 0);
        assert_eq!(refused, ticks > 3, "{what}");
        assert!(machine.observed().passes.is_empty(), "{what}");
    }
}

#[test]
fn wires_in_order_cut_the_pass() {
    let mut machine = armed_late(Axis::X, 0);
    machine.until("the program ends", |machine| machine.machine_status.state == MachineState::Ended as u32);
    let observed = machine.observed();
    assert!(observed.faults.is_empty() && observed.passes[0].complete, "{observed:#?}");
}
