//! Buttons in chains of threads: as in any other pass, and about each corner. Besides, the tool is never
//! deeper than the chain: it does not dig into a cone that rises in front of it while it lifts.

use std::collections::BTreeSet;

use super::{BUTTONS, HEAD, Job, POLICIES, Request, at_random, at_random_on, with};
use crate::stand::{Stand, compiled};
use machine::{Machine, ProgramDialect};
use protocol::{Axis, AxisState, Code, ThreadPass};
use testing::Seed;

/// Deeper than the chain by no more than this, mm: a way out is not taken that digs by 0.02 mm, and an axis
/// swings by some µm.
const DIGS_MM: f64 = 0.03;

/// A cylinder, a cone that rises, a cylinder with another lead, at a speed.
fn chain(s_rpm: u32) -> String {
    let [a, b, c] = if s_rpm > 1000 { [-16, -32, -56] } else { [2, -2, -8] };
    format!(
        "M3 S{s_rpm}\nG0 X16 Z8\nG0 X9.5\nG33 Z{a} K1\nG33 X{} Z{b} K1\nG33 Z{c} K1.5\nG0 X16\nG0 Z10\nM5\nM2\n",
        9.5 + 0.4 * f64::from(a - b)
    )
}

/// A cylinder, and a cone so steep that it rises faster than the tool lifts at first.
fn steep(s_rpm: u32) -> String {
    format!(
        "M3 S{s_rpm}\nG0 X34 Z20\nG0 X9.5\nG33 Z-10 K2\nG33 X25.5 Z-18 K2.4\nG33 Z-34 K2\nG0 X34\nG0 Z20\nM5\nM2\n"
    )
}

/// A cone that falls, in a bore, and a lead that gets shorter.
const FALLS: &str =
    "M4 S400\nG0 X7 Z8\nG0 X10.5\nG33 Z3 K1.5\nG33 X9 Z0 K1.5\nG33 Z-5 K1\nG0 X7\nG0 Z10\nM5\nM2\n";

/// On a face, with two leads.
const FACE: &str = "M3 S400\nG0 X12 Z2\nG0 Z-0.4\nG33 X18 K1\nG33 X26 K2\nG0 Z2\nG0 X12\nM5\nM2\n";

#[test]
fn presses_in_a_chain() {
    for s_rpm in [100, 600, 2000] {
        at_random(&format!("chain S{s_rpm}"), &chain(s_rpm), 24);
    }
}

#[test]
fn presses_in_a_chain_in_a_bore() {
    at_random("chain in a bore", FALLS, 24);
}

#[test]
fn presses_in_a_chain_on_a_face() {
    at_random("chain on a face", FACE, 24);
}

/// A barrel between two cylinders, a hollow, the same on a face: threads along arcs, in FANUC's words.
#[test]
fn presses_in_threads_along_arcs() {
    let fanuc = |policy| {
        let mut machine = with(policy);
        machine.general.dialect = ProgramDialect::Fanuc;
        machine
    };
    let of = |s_rpm: u32, middle: &str| {
        format!(
            "%\nO0001\nG97 S{s_rpm} M03\nG00 X40. Z8.\nG00 X20.\nG32 Z0. F1.\n{middle}\nG32 Z-26. F1.5\nG00 X40.\n\
             Z10.\nM30\n%\n"
        )
    };
    for s_rpm in [100, 400] {
        at_random_on("barrel", &of(s_rpm, "G36 X20. Z-18. R20. F1."), fanuc, 12);
        at_random_on("hollow", &of(s_rpm, "G35 X20. Z-18. R40. F1."), fanuc, 12);
    }
    let of = |arc: &str| {
        format!(
            "%\nO0001\nG97 S300 M03\nG00 X24. Z4.\nG00 Z-0.6\nG32 X34. F1.\n{arc} X52. Z-0.6 R20. F1.\nG32 X64. F1.5\n\
             G00 Z4.\nX24.\nM30\n%\n"
        )
    };
    at_random_on("dome on a face", &of("G36"), fanuc, 12);
    at_random_on("hollow on a face", &of("G35"), fanuc, 12);
}

/// The cycles in which an undisturbed run is at the borders and the corner of each window.
fn borders(job: &Job) -> BTreeSet<u64> {
    let pass: ThreadPass = *job.pass(1);
    let borders =
        pass.corners().flat_map(|corner| [0.0, 0.5, 1.0].map(|at| corner.c_deg + at * corner.dc_deg));
    let mut left: Vec<f64> = borders.collect();
    let mut cycles = BTreeSet::new();
    let stand = Stand { machine: &job.machine, items: &job.items, scenario: "", seed: 7 };
    stand.run(|record| {
        let (_, status) = record.axes.iter().find(|(axis, _)| *axis == Axis::Z).expect("a lathe");
        if status.pass == 1 && left.first().is_some_and(|at| status.angle_deg >= *at) {
            left.remove(0);
            cycles.insert(record.truth.cycle.0);
        }
        None
    });
    assert!(left.is_empty() && !cycles.is_empty());
    cycles
}

#[test]
fn a_press_at_every_cycle_around_each_corner_of_a_chain() {
    let job = Job::new(&chain(600), with(POLICIES[1]));
    let around = |border: u64| border.saturating_sub(9)..border + 3;
    let mut way = job.begin();
    for at in borders(&job).into_iter().flat_map(around).collect::<BTreeSet<u64>>() {
        way.to(at);
        for button in [Request::FeedHold, Request::Stop, Request::Abort, Request::EmergencyStop] {
            job.press_from(way.clone(), &format!("{button:?} at {at}"), &[(at, button)], at + 1500);
        }
    }
}

/// By how much the tool is deeper than the chain at most, in mm, when it is told to leave.
fn digs(machine: &Machine, program: &str, at_share: f64, button: Request, seed: u64) -> f64 {
    let items = compiled(machine, &format!("{HEAD}{program}"));
    let pass = items
        .iter()
        .find_map(|item| if let Code::Pass(pass) = &item.code { Some(*pass) } else { None })
        .expect("a chain");
    let law = pass.law(Axis::X);
    let (x, start_mm) = (pass.axis(Axis::X), pass.axis(Axis::X).start.mm());
    let outwards = (pass.out.clear.mm() - start_mm).signum();
    let begins = pass.corners[0].c_deg - 200.0;
    let ends = pass.corners[pass.corners().count() - 1].c_deg;
    let at_deg = begins + at_share * (ends - begins);
    let (mut pressed, mut most) = (false, 0.0f64);
    let stand = Stand { machine, items: &items, scenario: "", seed };
    stand.run(|record| {
        let state = |axis: Axis| record.axes.iter().find(|(other, _)| *other == axis).expect("a lathe").1;
        let (along, across) = (state(Axis::Z), state(Axis::X));
        let c = along.angle_deg;
        let in_groove = !pass.out.is_free(protocol::Position::from_mm(across.commanded_mm));
        let follows = along.pass == pass.pass && along.state() >= AxisState::Locked && c < x.leaves_deg();
        if pressed && follows && in_groove {
            let deeper = (start_mm + law.at(c).s - across.commanded_mm) * outwards;
            most = most.max(deeper);
        }
        let now = !pressed && follows && c >= at_deg;
        pressed |= now;
        let goes_on = pressed && record.truth.cycle.0.is_multiple_of(2000);
        now.then_some(button).or(goes_on.then_some(Request::CycleStart))
    });
    assert!(pressed, "it is in the chain at {at_deg} degrees");
    most
}

/// In front of a cone that rises faster than the tool lifts at first, it goes on along the chain until it can
/// leave: one that lifted at once would be met by the cone 0.1 mm deep.
#[test]
fn a_cone_that_rises_faster_than_the_tool_lifts_does_not_meet_it() {
    let machine = with(POLICIES[1]);
    for s_rpm in [900, 1200] {
        for share in 0..40 {
            let at_share = f64::from(share) / 160.0;
            for button in [BUTTONS[0], BUTTONS[2], BUTTONS[4]] {
                let dug = digs(&machine, &steep(s_rpm), at_share, button, 1);
                assert!(dug <= DIGS_MM, "S{s_rpm}: {dug} mm deeper, {button:?} at {at_share}");
            }
        }
    }
}

/// Whatever makes it leave, wherever: on the way up the cone, before it, behind it.
#[test]
fn a_tool_that_leaves_does_not_dig_into_a_cone_in_front_of_it() {
    let machine = with(POLICIES[1]);
    let mut most = 0.0f64;
    for case in 0..testing::count("PITCHLOCK_PRESSES", 60) {
        let mut seed = Seed::of_case(case);
        let s_rpm = [100, 300, 600, 1000, 2000][case as usize % 5];
        let buttons = [BUTTONS[0], BUTTONS[2], BUTTONS[4]];
        let (at_share, button) = (seed.unit(), buttons[seed.below(buttons.len())]);
        let dug = digs(&machine, &chain(s_rpm), at_share, button, 1 + case);
        assert!(dug <= DIGS_MM, "case {case}, S{s_rpm}: {dug} mm deeper, {button:?} at {at_share}");
        most = most.max(dug);
    }
    println!("leaving a chain: at most {:.1} µm deeper than it", 1e3 * most);
}
