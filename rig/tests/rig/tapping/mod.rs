//! Rigid taps as an outside observer sees them: how far the tool is off its helix on the way in, while the
//! spindle turns round and on the way out, whatever is pressed or fails. The helix is that of the program:
//! one lead a turn, wherever it lies. `cargo test -p rig tapping -- --nocapture` prints the figures.

mod faults;
mod mill;

use machine::{Machine, Reaction};
use protocol::{DriveState, Fault, Item, MachineState, Module};
use rig::Rig;
use rig::observe::{Observation, Observer, Outcome, Record, TOOL_IN_THREAD};
use rig::supervisor::Supervisor;
use sim_plant::Scenario;
use testing::Seed;

use crate::stand::compiled;

/// A tap of the tests, right-handed unless `left`.
#[derive(Clone, Copy, Debug)]
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
            "G18 G21 G90 G8 G97\n{turns} S{s_rpm:.3}\nG0 X0 Z{start_mm:.3}\n\
             G33.1 Z{:.3} K{lead_mm} I{faster:.3}\nG0 Z20\nM5\nM2\n",
            -depth_mm
        )
    }
}

/// The built-in lathe with a spindle that takes 0.4 s from 800 1/min to 800 the other way, by its drive's
/// ramp.
fn lathe() -> Machine {
    turning(5000.0, 5000.0)
}

/// The same with the ramp that the controller believes, and the true one.
fn turning(believed: f64, truly: f64) -> Machine {
    let light = machine::SMALL_LATHE
        .replace("ramp_rpm_s = 800.0 ", &format!("ramp_rpm_s = {believed:.1} "))
        .replace("inertia_kg_m2 = 0.15 ", &format!("ramp_rpm_s = {truly:.1}\ninertia_kg_m2 = 0.06 "));
    Machine::from_toml(&light).expect("a lathe with a lighter spindle")
}

/// What was seen of a tap, mm and µm.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Farthest off the helix while the tool was in the hole: on the way in, about the turn, on the way out.
    off_um: [f64; 3],
    /// How much less deep than programmed it came, µm.
    short_um: f64,
    /// The tool was in the hole in the end.
    inside: bool,
    fault: u32,
}

impl Seen {
    fn most_um(&self) -> f64 {
        self.off_um.into_iter().fold(0.0, f64::max)
    }
}

/// Moments of a tap, control cycles.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    /// The axes have seen the index; the spindle slows down; it turns outwards; the axes are back.
    index: u64,
    brakes: u64,
    turns: u64,
    back: u64,
}

/// Watches the tool.
struct Watch {
    tap: Tap,
    /// Where the helix lies, from the first cycle in the hole; the span of the error in each part.
    zero: Option<f64>,
    spans: [Option<[f64; 2]>; 3],
    deepest_mm: f64,
    before_mm: f64,
    seen: Seen,
    moments: Moments,
}

impl Watch {
    fn new(tap: Tap) -> Watch {
        Watch {
            tap,
            zero: None,
            spans: [None; 3],
            deepest_mm: f64::INFINITY,
            before_mm: f64::INFINITY,
            seen: Seen::default(),
            moments: Moments::default(),
        }
    }

    fn look(&mut self, record: &Record) {
        let (truth, tap, cycle) = (record.truth, &self.tap, record.truth.cycle.0);
        let z = truth.axes[2].slide_mm;
        if record.machine.fault != 0 && self.seen.fault == 0 {
            self.seen.fault = record.machine.fault;
        }
        let (inwards, turned) = match tap.left {
            false => (truth.spindle_rpm, truth.spindle_deg),
            true => (-truth.spindle_rpm, -truth.spindle_deg),
        };
        let threads = record.machine.state() == MachineState::Threading;
        let begun = threads && record.axes.iter().all(|(_, status)| status.state().has_begun());
        let first = |moment: &mut u64, now: bool| *moment = if *moment == 0 && now { cycle } else { *moment };
        first(&mut self.moments.index, begun);
        first(&mut self.moments.brakes, begun && inwards < 0.97 * tap.s_rpm);
        first(&mut self.moments.turns, begun && inwards < 0.0);
        first(&mut self.moments.back, self.moments.turns > 0 && !begun);
        let deeper = z < self.before_mm;
        (self.before_mm, self.deepest_mm) = (z, self.deepest_mm.min(z));
        self.seen.inside = z < 0.0;
        if z >= 0.0 {
            return;
        }
        let phase = z + tap.lead_mm * turned / 360.0;
        let zero = *self.zero.get_or_insert(phase);
        // A tap that is entered again is in the same thread if it is a whole number of leads off.
        let off = phase - zero;
        let e = 1e3 * (off - tap.lead_mm * (off / tap.lead_mm).round());
        let part = match truth.spindle_rpm.abs() < 0.1 * tap.s_rpm {
            true => 1,
            false => 2 * usize::from(!deeper),
        };
        let [low, high] = self.spans[part].unwrap_or([e, e]);
        self.spans[part] = Some([low.min(e), high.max(e)]);
    }

    /// The error of each part, about the middle of the whole.
    fn seen(&self) -> Seen {
        let all = self.spans.iter().flatten();
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [one, other]| {
            (low.min(*one), high.max(*other))
        });
        let off = |span: &Option<[f64; 2]>| {
            span.map_or(0.0, |ends| {
                ends.map(|e| (e - 0.5 * (low + high)).abs()).into_iter().fold(0.0, f64::max)
            })
        };
        Seen {
            off_um: [off(&self.spans[0]), off(&self.spans[1]), off(&self.spans[2])],
            short_um: 1e3 * (self.deepest_mm + self.tap.depth_mm),
            ..self.seen
        }
    }
}

/// Runs to the end, with somebody who watches over it as the launcher does.
fn run(
    machine: &Machine,
    tap: Tap,
    items: &[Item],
    scenario: &str,
    seed: u64,
) -> (Observation, Seen, Moments) {
    let mut watch = Watch::new(tap);
    let scenario = Scenario::from_toml(scenario).expect("a scenario");
    let mut rig = Rig::new(machine, items.iter().copied(), scenario, seed).expect("a machine");
    let mut observer = Observer::new(machine, items);
    let mut supervisor = Supervisor::new(machine, items);
    let (mut request, mut known_dead) = (None, false);
    for cycle in 0..400_000 {
        let now = request.take();
        let more = rig.cycle(now, |record| {
            watch.look(record);
            observer.cycle(record);
            request = supervisor.cycle(record);
        });
        if rig.is_dead(Module::Interpolator) && !known_dead {
            known_dead = true;
            request = supervisor.died(Module::Interpolator, cycle).or(request);
        }
        if !more || supervisor.end().is_some() {
            return (observer.finish(), watch.seen(), watch.moments);
        }
    }
    panic!("the program does not end: {tap:?} {:?}", watch.seen());
}

/// The tap of the issue: within 5 µm of its helix throughout, and never deeper than programmed.
#[test]
fn an_m8_is_tapped_within_five_micrometres_through_the_turn() {
    let machine = lathe();
    let items = compiled(&machine, &M8.program());
    let mut worst = ([0.0_f64; 3], [f64::INFINITY, 0.0_f64]);
    for seed in 1..=10 {
        let (observation, seen, moments) = run(&machine, M8, &items, "", seed);
        println!("seed {seed}: {seen:?} {moments:?}");
        assert!(observation.outcome == Outcome::Completed && !seen.inside, "{:?}", observation.faults);
        for (most, um) in worst.0.iter_mut().zip(seen.off_um) {
            *most = most.max(um);
        }
        worst.1 = [worst.1[0].min(seen.short_um), worst.1[1].max(seen.short_um)];
        let told = observation.passes[0].tap.expect("it is told what the tap did");
        let parts = [told.in_um, told.turn_um, told.out_um].into_iter().fold(0.0, f64::max);
        assert!(
            (parts - seen.most_um()).abs() < 1.0 && (told.short_um - seen.short_um).abs() < 0.1,
            "{told:?}"
        );
    }
    println!("worst of ten: in, turn, out {:.2?} µm; short of the depth {:.1?} µm", worst.0, worst.1);
    assert!(worst.0.iter().all(|um| *um <= 5.0), "{worst:?}");
    assert!(worst.1[0] > 0.0 && worst.1[1] < 20.0, "{worst:?}");
}

/// A drawn tap on a drawn spindle that can make it.
fn drawn(random: &mut Seed) -> (Machine, Tap) {
    let ramp = random.scale(300.0, 6000.0);
    let machine = turning(ramp, ramp);
    let lead_mm = 0.25 + 2.75 * random.unit();
    let (start_mm, depth_mm) = (3.0 + 3.0 * lead_mm, lead_mm * (2.0 + 10.0 * random.unit()));
    let top = machine.tap_top_rpm(360.0 * (start_mm + depth_mm) / lead_mm) / 1.25;
    let s_rpm = random.scale(50.0, 2000.0).min(top);
    let faster = if random.below(3) == 0 { 1.0 + random.unit() } else { 1.0 };
    (machine, Tap { s_rpm, lead_mm, start_mm, depth_mm, faster, left: random.below(2) == 0 })
}

#[test]
fn two_hundred_taps_stay_on_their_helix_and_above_their_depth() {
    let mut worst = [0.0_f64; 2];
    for seed in 1..=200 {
        let mut random = Seed::new(seed);
        let (machine, tap) = drawn(&mut random);
        let items = compiled(&machine, &tap.program());
        let mut scenario = String::new();
        let overridden = seed % 2 == 0;
        if overridden {
            for _ in 0..3 {
                let (at, pct) = (1.0 + 6.0 * random.unit(), 40 + random.below(81));
                scenario +=
                    &format!("[[event]]\nat = {{ time_s = {at:.4} }}\nspindle_override_pct = {pct}\n");
            }
        }
        let (observation, seen, _) = run(&machine, tap, &items, &scenario, seed);
        let which = usize::from(overridden);
        worst[which] = worst[which].max(seen.most_um());
        println!("seed {seed}: {:.2?} µm, short {:.1} µm, {tap:?}", seen.off_um, seen.short_um);
        assert_eq!(observation.outcome, Outcome::Completed, "seed {seed}: {:?} {tap:?}", observation.faults);
        assert!(seen.short_um > -1.0 && !seen.inside, "seed {seed}: {seen:?} {tap:?}");
    }
    println!("worst of 200: {worst:.2?} µm, without and with overrides");
    assert!(worst[0] <= 5.0 && worst[1] <= 6.0, "{worst:?}");
}

/// How a run ends after something has happened in the hole.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ends {
    /// The tool is out.
    Out,
    /// It may be in the hole; then it is said.
    Anywhere,
}

/// What is done or fails: its name, the action, how it ends, how far the tool may be off, µm. Where the
/// encoder fails nobody knows the angle: the bound is what the ramp of the drive is believed to a hundredth
/// of a lead or so.
const ACTIONS: [(&str, &str, Ends, f64); 12] = [
    ("hold", "feed_hold = true", Ends::Out, 5.0),
    ("stop", "stop = true", Ends::Out, 5.0),
    ("abort", "abort = true", Ends::Out, 5.0),
    ("emergency stop", "emergency_stop = true", Ends::Anywhere, 5.0),
    ("interpolator dead", "kill = \"interpolator\"", Ends::Anywhere, 5.0),
    ("interpolator hangs", "freeze = \"interpolator\"", Ends::Anywhere, 5.0),
    ("drive of X", "drive_fault = \"x\"", Ends::Anywhere, 5.0),
    ("counts lost", "encoder_glitch_counts = -40", Ends::Anywhere, 200.0),
    ("encoder dead", "encoder_stands = true", Ends::Anywhere, 200.0),
    ("spindle without torque", "spindle_fault = \"stall\"", Ends::Anywhere, 5.0),
    ("spindle jams", "spindle_fault = \"jam\"", Ends::Anywhere, 200.0),
    ("spindle does the opposite", "spindle_fault = \"reversal\"", Ends::Anywhere, 200.0),
];

fn borders(machine: &Machine, tap: Tap, items: &[Item], seed: u64) -> [u64; 5] {
    let (_, _, Moments { index, brakes, turns, back }) = run(machine, tap, items, "", seed);
    [index, (index + brakes) / 2, brakes, turns, back]
}

#[test]
fn whatever_happens_the_tool_stays_on_its_helix() {
    let mut machine = lathe();
    machine.threading.on_hold = Reaction::Leave;
    let items = compiled(&machine, &M8.program());
    let borders = borders(&machine, M8, &items, 3);
    for (name, action, ends, most_um) in ACTIONS {
        let mut worst = [0.0_f64, f64::INFINITY];
        for border in borders {
            for near in [-40, -9, -6, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 9, 40_i64] {
                let at = border.saturating_add_signed(near);
                let later = at + 6000;
                let scenario = format!(
                    "[[event]]\nat = {{ cycle = {at} }}\n{action}\n[[event]]\nat = {{ cycle = {later} }}\ncycle_start = true\n"
                );
                let (observation, seen, _) = run(&machine, M8, &items, &scenario, 3);
                let said = observation.warnings.iter().any(|warning| warning.code == TOOL_IN_THREAD);
                worst = [worst[0].max(seen.most_um()), worst[1].min(seen.short_um)];
                let complete = observation.passes.iter().filter(|pass| pass.complete).count();
                assert!(name != "hold" || complete == 1, "{at}: {complete} complete");
                let at = format!("{name} at {at}, {near} of {border}: {seen:?}, {:?}", observation.faults);
                assert!(seen.most_um() <= most_um, "{at}");
                assert!(!seen.inside || ends == Ends::Anywhere && said, "{at}");
                assert!(ends == Ends::Anywhere || seen.fault == 0 && seen.short_um > 0.0, "{at}");
            }
        }
        println!("{name}: {:.2} µm off at most, {:.1} µm deeper at most", worst[0], -worst[1]);
    }
}

/// Three pecks of a FANUC program, with a dwell at each depth: one helix for all of them.
#[test]
fn pecks_find_their_thread_again() {
    let mut machine = lathe();
    machine.general.dialect = machine::ProgramDialect::Fanuc;
    let program = "G97 M05\nG00 X0. Z5.\nM29 S800\nG84 Z-20. R5. Q9. P200 F1.25\nG80\nG00 Z20.\nM30\n";
    let items = compiled(&machine, program);
    let (observation, seen, _) = run(&machine, M8, &items, "", 7);
    println!("{seen:?}");
    assert_eq!((observation.outcome, observation.passes.len()), (Outcome::Completed, 3));
    assert!(seen.most_um() <= 5.0 && (0.0..20.0).contains(&seen.short_um), "{seen:?}");
    let depths: Vec<f64> =
        observation.passes.iter().map(|pass| pass.tap.map_or(0.0, |tap| tap.short_um)).collect();
    assert!(depths.iter().all(|um| (0.0..20.0).contains(um)), "{depths:?}");
}

/// A drive that is a fifth weaker than it is believed to be still turns round in front of the depth; one that
/// has half of its ramp goes deeper, on its helix.
#[test]
fn a_weak_drive_of_the_spindle_goes_deeper_on_its_helix() {
    for (truly, deeper_mm) in [(5000.0, 0.0), (4100.0, 0.0), (2500.0, 5.0)] {
        let machine = turning(5000.0, truly);
        let items = compiled(&machine, &M8.program());
        let (observation, seen, _) = run(&machine, M8, &items, "", 5);
        println!("{truly} 1/min per s: {seen:?}");
        assert!(seen.most_um() <= 5.0 && seen.short_um > -1e3 * deeper_mm, "{seen:?}");
        assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    }
}

/// Without mains Z follows as long as its drive has energy; then the spindle runs out, and nobody can help
/// it.
#[test]
fn without_mains_z_follows_as_long_as_its_drive_can() {
    let machine = lathe();
    let items = compiled(&machine, &M8.program());
    let [_, inside, ..] = borders(&machine, M8, &items, 3);
    let scenario = format!("[[event]]\nat = {{ cycle = {inside} }}\npower_lost = true\n");
    let (mut watch, mut led_um) = (Watch::new(M8), 0.0_f64);
    let stand = crate::stand::Stand { machine: &machine, items: &items, scenario: &scenario, seed: 3 };
    let observation = stand.run(|record| {
        watch.look(record);
        let enabled = record.truth.measurement.axes[2].drive().state() == Some(DriveState::OperationEnabled);
        led_um = if enabled { watch.seen().most_um() } else { led_um };
        None
    });
    println!("led: {led_um:.2} µm, {:?}", watch.seen());
    assert!(led_um > 0.0 && led_um <= 5.0, "{led_um}");
    assert!(observation.warnings.iter().any(|warning| warning.code == TOOL_IN_THREAD), "it is told");
    assert_eq!(watch.seen().fault, Fault::PowerLost as u32);
}

/// A drive of Z that fails leaves nobody on the helix: the spindle is stopped at once, and it is told.
#[test]
fn a_dead_drive_of_z_stops_the_spindle() {
    let machine = lathe();
    let items = compiled(&machine, &M8.program());
    let [_, inside, ..] = borders(&machine, M8, &items, 3);
    let scenario = format!("[[event]]\nat = {{ cycle = {inside} }}\ndrive_fault = \"z\"\n");
    let (mut stood, stand) =
        (None, crate::stand::Stand { machine: &machine, items: &items, scenario: &scenario, seed: 3 });
    let observation = stand.run(|record| {
        let cycle = record.truth.cycle.0;
        if cycle > inside && stood.is_none() && record.truth.spindle_rpm.abs() < 1.0 {
            stood = Some(cycle - inside);
        }
        None
    });
    let ramp_cycles = (M8.s_rpm / machine.spindle.ramp_rpm_s / machine.general.cycle_s) as u64;
    println!("stands {stood:?} cycles later, by its ramp {ramp_cycles}");
    assert!(stood.is_some_and(|cycles| cycles < ramp_cycles + 60), "{stood:?}");
    assert!(observation.warnings.iter().any(|warning| warning.code == TOOL_IN_THREAD), "it is told");
}
