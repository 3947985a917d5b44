//! The magnets of a motor lie where they lie in the machine, and not where it was switched on: what is
//! believed of them holds behind a reference run, wherever that began. Judged at the tool, in a thread.

use std::f64::consts::TAU;

use machine::{Machine, Method};
use protocol::{Axis, AxisState, AxisStatus};
use rig::{
    observe::Record,
    trial::{self, Trial},
};
use sim_plant::Scenario;

use crate::references::{PLAIN, most_mm};

/// The plain lathe, its Z with a motor that cogs, and with these keys; believed or not.
fn lathe(method: Option<Method>, off_mm: f64, believed: bool) -> Machine {
    let method = method.map(|method| match method {
        Method::Switch => "switch",
        Method::SwitchAndIndex => "switch-and-index",
        Method::Index => "index",
    });
    let reference = method.map_or(String::new(), |method| {
        let run = "position_mm = 120\nsearch_mm_s = 40\nlatch_mm_s = 2";
        format!("[axis.z.reference]\nmethod = \"{method}\"\n{run}\n\n")
    });
    let cogging = "cogging_nm = 0.05\ncogging_per_rev = 24\ncogging_deg = 40";
    let text = PLAIN.replacen("[spindle]", &format!("{reference}[spindle]"), 1).replacen(
        "[plant.axis.z]",
        &format!("[plant.axis.z]\nhome_off_mm = {off_mm}\n{cogging}"),
        1,
    );
    let mut machine = Machine::from_toml(&text).expect("a sound machine");
    let z = machine.axis.get_mut(&Axis::Z).expect("it has a Z");
    // Home is 20 turns: the phase at home is that at 0.
    z.cogging = if believed { vec![[24.0, 0.05, 40.0]] } else { Vec::new() };
    machine
}

/// Amplitude of what comes back with the magnets in the way of the slide beside where Z is led, on the helix,
/// µm.
fn swing_um(machine: &Machine, seed: u64) -> f64 {
    let trial = Trial { s_rpm: 300.0, delta_x_mm: 0.0, turns: 10.0, lead_mm: -2.5, ..Trial::default() };
    let items = trial::program(machine, &[trial]).expect("it can be cut");
    let (mut sum, mut half) = ([0.0; 2], 0.0);
    let mut see = |record: &Record| {
        let locked =
            |(axis, status): &&(Axis, AxisStatus)| *axis == Axis::Z && status.state() == AxisState::Locked;
        if let Some((_, status)) = record.axes.iter().find(locked) {
            let slide_mm = record.truth.axes[Axis::Z.index()].slide_mm;
            let (sin, cos) = libm::sincos(TAU * 24.0 * slide_mm / 5.0);
            let off_um = 1e3 * (slide_mm - status.commanded_mm);
            sum = [sum[0] + off_um * cos, sum[1] + off_um * sin];
            half += 0.5;
        }
    };
    let seen = trial::run(machine, &items, &Scenario::none(), seed, &mut see).expect("a machine");
    assert!(seen.faults.is_empty() && half > 1000.0, "{:?}", seen.faults);
    libm::hypot(sum[0], sum[1]) / half
}

#[test]
fn what_is_believed_of_magnets_holds_behind_a_run_wherever_it_began() {
    let bare = swing_um(&lathe(None, 0.0, false), 1);
    // The worst of such as need no run.
    let known = (1..=8).map(|seed| swing_um(&lathe(None, 0.0, true), seed)).fold(0.0, f64::max);
    println!("without a run: not believed {bare:.3} µm, believed {known:.3} µm");
    assert!(bare > 5.0 * known, "{bare} µm, believed {known} µm");
    // Whole turns, half a period of the magnets, some of one.
    for off_mm in [0.0, 5.0, -0.104, -0.737, 1.3] {
        let mut methods = vec![Method::Switch, Method::SwitchAndIndex];
        methods.extend((off_mm < 2.5).then_some(Method::Index));
        for method in methods {
            let behind = swing_um(&lathe(Some(method), off_mm, true), 1);
            println!("{method:?}, switched on {off_mm} mm beside: {behind:.3} µm");
            // What is believed lies beside by what the position of its axis does; and a hundredth.
            let beside = 0.01 + TAU * 24.0 * most_mm(&lathe(None, 0.0, true), method) / 5.0;
            assert!(behind < known + beside * bare, "{method:?}, {off_mm}: {behind} µm, {known} µm");
        }
    }
}
