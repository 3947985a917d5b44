//! What lies behind the encoders of the motors: backlash, screw, elasticity; what compensation and linear
//! scales make of it. The figures are those of docs/behind-the-motor.md.

use std::fs;

use crate::shop::{Place, example, project};
use machine::Machine;
use protocol::Axis;
use rig::observe::{Outcome, PassReport, ServoError};
use rig::trial::{self, Trial};
use sim_plant::{Belief, Scenario};

/// A figure of the document may be this far from what is measured: µm, and a share of it.
const TOLERANCE: [f64; 2] = [0.3, 0.15];
/// Where encoders and scales lie within their steps, and where the spindle stands; an odd number of them.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=9;

fn read(path: &str) -> String {
    fs::read_to_string(project().join(path)).expect("shipped")
}

/// The row of a table in the document holds what was measured.
#[track_caller]
fn documented(label: &str, measured: &[f64]) {
    let text = read("docs/behind-the-motor.md");
    let begin = format!("| {label} |");
    let row = text.lines().find_map(|line| line.strip_prefix(&begin)).unwrap_or_default();
    let figures: Vec<f64> =
        row.split('|').filter_map(|cell| cell.trim().replace('−', "-").parse().ok()).collect();
    let close =
        |(figure, is): (&f64, &f64)| (figure - is).abs() <= TOLERANCE[0] + TOLERANCE[1] * figure.abs();
    assert!(
        figures.len() == measured.len() && figures.iter().zip(measured).all(close),
        "{label}: the document says {figures:?}, measured {measured:.2?}"
    );
}

/// Largest of a measure over passes.
fn worst(passes: &[PassReport], of: fn(&PassReport) -> f64) -> f64 {
    passes.iter().map(of).fold(0.0, f64::max)
}

/// The M20x2 on a machine file; slide errors in the thread: X, X after a turn, Z from its helix.
fn m20x2(name: &str, machine: &str) -> [f64; 3] {
    let place = Place::new();
    let file = place.write("machine.toml", machine).display().to_string();
    let arguments = ["--in-process", "--trace", "none", "--machine", &file];
    let summary = place.run(&example("m20x2"), "run", &arguments);
    assert_eq!(summary.outcome, Outcome::Completed, "{name}: {:?}", summary.faults);
    assert!(summary.passes.len() == 15 && summary.passes.iter().all(|pass| pass.complete), "{name}");
    assert!(summary.thread.phase_spread_um <= 0.1, "{name}: {} µm", summary.thread.phase_spread_um);
    [
        worst(&summary.passes, |pass| pass.x_slide.thread_max_abs_um),
        worst(&summary.passes, |pass| pass.x_slide.settled_max_abs_um),
        worst(&summary.passes, |pass| pass.slide_helix_max_abs_um),
    ]
}

fn without_compensation(machine: &str) -> String {
    let (before, rest) = machine.split_once("screw_error = [ ").expect("the table that is believed");
    let (_, after) = rest.split_once("\n]").expect("its end");
    format!("{before}screw_error = []{after}").replace("backlash_mm = 0.011", "backlash_mm = 0.0")
}

fn with_scales(machine: &str) -> String {
    let scale = "scale_step_mm = 0.0001";
    machine
        .replace("[axis.x]\n", &format!("[axis.x]\n{scale}\n"))
        .replace("[axis.z]\n", &format!("[axis.z]\n{scale}\n"))
}

/// What the head of the worn lathe's file says to compare.
#[test]
fn a_worn_lathe_is_better_with_compensation_and_good_with_scales() {
    let worn = read("examples/machines/worn-lathe.toml");
    let without = m20x2("without", &without_compensation(&worn));
    let compensated = m20x2("compensated", &worn);
    let scaled = m20x2("scaled", &with_scales(&worn));
    for (better, than, factor) in
        [(compensated, without, [2.0, 2.5, 3.0]), (scaled, compensated, [2.5, 6.0, 3.0])]
    {
        for i in 0..3 {
            assert!(better[i] * factor[i] <= than[i], "{better:.2?} against {than:.2?}");
        }
    }
    documented("without compensation", &without);
    documented("with compensation", &compensated);
    documented("with compensation and linear scales", &scaled);
    documented(
        "with linear scales alone",
        &m20x2("scales alone", &with_scales(&without_compensation(&worn))),
    );
}

/// The pass of the published experiment on the small lathe, twice: servo error and slide error of X, each
/// measure the median over the seeds.
fn trials_of_x(machine: &Machine) -> [[Measures; 2]; 2] {
    let items = trial::program(machine, &[Trial::default(); 2]).expect("the machine can follow it");
    let run = |seed| {
        let observed = trial::run(machine, &items, &Scenario::none(), seed, &mut |_| {}).expect("a plant");
        assert_eq!(observed.outcome, Outcome::Completed, "{:?}", observed.faults);
        observed.passes
    };
    let runs: Vec<Vec<PassReport>> = SEEDS.map(run).collect();
    let median = |pass: usize, error: fn(&PassReport) -> &ServoError| {
        [0, 1, 2, 3, 4].map(|measure| {
            let mut of_seeds: Vec<f64> =
                runs.iter().map(|run| measures(error(&run[pass]))[measure]).collect();
            of_seeds.sort_by(f64::total_cmp);
            of_seeds[of_seeds.len() / 2]
        })
    };
    [0, 1].map(|pass| [median(pass, |pass| &pass.x), median(pass, |pass| &pass.x_slide)])
}

/// Approach from and to, its end, thread, thread from one turn on, µm.
type Measures = [f64; 5];

fn measures(error: &ServoError) -> Measures {
    let ServoError { approach_min_um, approach_max_um, end_um, thread_max_abs_um, settled_max_abs_um } =
        *error;
    [approach_min_um, approach_max_um, end_um, thread_max_abs_um, settled_max_abs_um]
}

/// The reference simulation has 0…+6 µm at the slide behind the encoder of a motor and about +3 µm in the
/// thread.
#[test]
fn an_encoder_at_the_motor_does_not_see_what_the_slide_does() {
    let [[servo, slide], _] = trials_of_x(&Machine::plain());
    assert!(servo[..2].iter().all(|um| um.abs() <= 2.0), "{servo:.2?}");
    let [_, to, end, thread, settled] = slide;
    assert!(to >= 5.0 && (2.0..4.0).contains(&end), "{slide:.2?}");
    assert!(thread <= 4.0 && settled >= 2.0, "{slide:.2?}");
    documented("encoder at the motor, servo error", &servo);
    documented("encoder at the motor, slide", &slide);
}

/// The small lathe with linear scales of 0.1 µm.
fn scaled(position_gain_1_s: f64) -> Machine {
    let mut machine = Machine::plain();
    for axis in machine.axis.values_mut() {
        axis.scale_step_mm = Some(1e-4);
        axis.position_gain_1_s = position_gain_1_s;
    }
    machine
}

#[test]
fn a_linear_scale_takes_the_constant_part_away() {
    let [[servo, slide], [_, reversed]] = trials_of_x(&scaled(40.0));
    let [.., end, thread, settled] = slide;
    assert!(end.abs() <= 1.5 && thread <= 1.5 && settled <= 0.4, "{slide:.2?}");
    let apart = servo.into_iter().zip(slide).map(|(servo, slide)| (servo - slide).abs());
    assert!(apart.fold(0.0, f64::max) <= 0.1, "the scale sees the slide: {servo:.2?}, {slide:.2?}");
    documented("linear scale of 0.1 µm, slide", &slide);
    documented("the same, after a reversal", &reversed);
}

/// The reference simulation has −2.5…+4.2 µm in the approach, +1.0 at its end, −0.2…+0.4 in the thread.
#[test]
fn a_controller_that_knows_its_machine_has_the_figures_of_the_reference_simulation() {
    let mut machine = scaled(60.0);
    (machine.spindle.encoder_lines, machine.spindle.stroke_observer_hz) = (1024, 30.0);
    for axis in [Axis::X, Axis::Z] {
        let belief = Belief::of_truth(&machine, axis).expect("the truth");
        belief.put_into(machine.axis.get_mut(&axis).expect("a lathe"));
    }
    let [_, [_, slide]] = trials_of_x(&machine);
    // A controller that takes the ripple of the spindle off follows its law more closely than the reference.
    for (measured, reference) in slide.into_iter().zip([-2.5, 4.2, 1.0]) {
        assert!((0.65..=1.25).contains(&(measured / reference)), "{slide:.2?} against {reference} µm");
    }
    assert!(slide[4] <= 0.4, "{slide:.2?}");
    documented("controller of the reference, after a reversal", &slide);
}
