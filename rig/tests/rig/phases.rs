//! Where the grooves of a thread lie round the part: passes and starts, roughed by one tool and finished by
//! another one of other lengths at another speed, the override turned at random moments. Asked is the truth
//! of the slide and of the spindle, and the words of the program; no law and no report.

use machine::Machine;
use protocol::{Axis, AxisState, Code, ThreadPass, operator::Request};
use rig::observe::Outcome;
use testing::Seed;

use crate::stand::{Stand, compiled};

/// What passes, starts and tools may lie apart at the tool, µm.
const PHASE_UM: f64 = 1.5;
/// How much farther along the second tool stands, mm.
const LONGER_MM: f64 = 1.737;

/// A thread of two starts: its program, the lead, and where each of its passes starts with the tool's length
/// added, mm.
struct Drawn {
    program: String,
    lead_mm: f64,
    starts_mm: Vec<f64>,
    speeds: [f64; 2],
}

fn drawn(seed: &mut Seed) -> Drawn {
    let speed = |seed: &mut Seed| (50.0 * libm::pow(40.0, seed.unit())).round();
    let speeds = [speed(seed), speed(seed)];
    let lead_mm = 0.8 + 0.1 * seed.below(8) as f64;
    let turns = 6.0 + speeds[0].max(speeds[1]) / 60.0 * 0.7;
    let end = 8.0 - lead_mm * turns;
    let mut program = "G18 G21 G90 G8 G94 G97\n".to_owned();
    let mut starts_mm = Vec::new();
    for (tool, s_rpm) in speeds.iter().enumerate() {
        let (number, longer) = (3 + 2 * tool, LONGER_MM * tool as f64);
        program += &format!("T{number} M6\nG43.1 X0 Z{longer}\nM3 S{s_rpm}\n");
        for (depth, start) in [(0.2, 0.0), (0.2, 0.5), (0.3, 0.0), (0.3, 0.5)] {
            // One lead more or less is the same groove.
            let z = 8.0 + lead_mm * (start + tool as f64);
            program += &format!(
                "G0 X15 Z{z:.9}\nG0 X{:.3}\nG33 Z{end:.9} K{lead_mm}\nG0 X15\n",
                10.0 - depth - 0.1 * tool as f64
            );
            starts_mm.push(z + longer);
        }
        program += "G0 Z40\n";
    }
    Drawn { program: program + "M2\n", lead_mm, starts_mm, speeds }
}

/// Mean over the angle of how far each pass lies from its groove, µm.
fn means_um(machine: &Machine, drawn: &Drawn, seed: &mut Seed, plant: u64) -> Vec<f64> {
    let items = compiled(machine, &drawn.program);
    let passes: Vec<ThreadPass> = items
        .iter()
        .filter_map(|item| if let Code::Pass(pass) = &item.code { Some(*pass) } else { None })
        .collect();
    assert_eq!(passes.len(), drawn.starts_mm.len());
    // In every other pass the override is turned somewhere.
    let presses: Vec<Option<(f64, Request)>> = (0..passes.len())
        .map(|_| {
            let request = Request::SpindleOverride(50.0 + 10.0 * seed.below(6) as f64);
            (seed.below(2) == 0).then(|| (seed.unit(), request))
        })
        .collect();
    let mut pressed = vec![false; passes.len()];
    let mut sums = vec![[0.0; 2]; passes.len()];
    let stand = Stand { machine, items: &items, scenario: "", seed: plant };
    let observation = stand.run(|record| {
        let truth = record.truth;
        let (_, status) = record.axes.iter().find(|(axis, _)| *axis == Axis::Z).expect("a lathe");
        let at = (status.pass as usize).checked_sub(1)?;
        let (pass, law) = (passes.get(at)?, passes.get(at)?.axis(Axis::Z));
        let locked_deg = law.run_in_c0_deg + law.run_in_dc_deg;
        let c = status.angle_deg;
        if status.state() != AxisState::Locked || !(locked_deg..pass.thread_end_deg).contains(&c) {
            return None;
        }
        let z = truth.axes[Axis::Z.index()].slide_mm;
        let turns = (z - drawn.starts_mm[at]) / drawn.lead_mm + truth.spindle_deg / 360.0;
        let off_um = 1e3 * drawn.lead_mm * (turns - turns.round());
        sums[at][0] += off_um * truth.spindle_rpm.abs();
        sums[at][1] += truth.spindle_rpm.abs();
        let share = (c - locked_deg) / (pass.thread_end_deg - locked_deg);
        let (from, request) = presses[at]?;
        (share >= from && !std::mem::replace(&mut pressed[at], true)).then_some(request)
    });
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    sums.iter().map(|[sum, weight]| sum / weight).collect()
}

/// Two hundred by `PITCHLOCK_PHASES=200`.
#[test]
fn passes_starts_and_tools_lie_in_one_groove_at_any_speed_and_override() {
    let machine = Machine::default();
    let (count, mut worst) = (testing::count("PITCHLOCK_PHASES", 3), 0.0f64);
    for case in 0..count {
        let mut seed = Seed::of_case(case);
        let drawn = drawn(&mut seed);
        let means = means_um(&machine, &drawn, &mut seed, case + 1);
        let (low, high) = means.iter().fold((f64::MAX, f64::MIN), |(l, h), um| (l.min(*um), h.max(*um)));
        assert!(high - low <= PHASE_UM, "case {case}: {means:.2?} µm, {:?}\n{}", drawn.speeds, drawn.program);
        worst = worst.max(high - low);
    }
    println!("passes, starts and tools, 50 to 2000 1/min, {count} threads: at most {worst:.2} µm apart");
}
