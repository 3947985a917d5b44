//! A mill that loses its power in any cycle, gone on with by new controls. Judged by the truth of the plant
//! against the geometry of the program: below the top of the part the tool is nowhere but on the programmed
//! path, straight over it, or straight over where it stood; and all of the path is cut at the end.

use std::{collections::BTreeMap, f64::consts::TAU, fmt::Write as _};

use machine::Machine;
use protocol::{Axis, Code, Feed, Item, PerAxis, Position};
use rig::{
    Rig,
    journal::{Keeper, Origin, State},
    observe::{Observer, Outcome, Record},
    resume::{Plan, Refusal, Stands, plan},
    wires::Straight,
};
use sim_plant::{Plant, Scenario};
use testing::{Seed, count};

use crate::stand::compiled;

/// Cuts, unless `PITCHLOCK_CUTS` says otherwise.
const CUTS: u64 = 10;
/// Tolerance of G64, what the axes follow behind, and the distance of the samples, mm.
const NEAR_MM: f64 = 0.05;
const SAMPLE_MM: f64 = 0.05;
/// Far beyond the end of every program here, control cycles.
const PATIENCE: u64 = 400_000;

/// An ellipse in chords, which becomes a curve; a pocket of arcs with a helix into it; holes; another tool
/// and a slot with corners.
fn program(path: &str) -> String {
    let mut text =
        format!("G17 G21 G90 G94 {path}\nT1 M6\nM3 S3000\nG0 X30 Y0\nG0 Z3\nG1 Z-2 F400\nG1 F1500\n");
    for n in 1..=240 {
        let angle = TAU * f64::from(n) / 240.0;
        let _ = writeln!(text, "G1 X{:.4} Y{:.4}", 30.0 * libm::cos(angle), 20.0 * libm::sin(angle));
    }
    text += "G0 Z5\nG0 X10 Y0\nG1 Z0 F800\nG3 X10 Y0 Z-3 I-10 J0 F1200\nG3 X10 Y0 I-10 J0\nG2 X-10 Y0 I-10 J0\nG0 Z5\n\
        G98 G81 X40 Y30 Z-6 R2 F300\nG83 X-40 Y30 Z-8 R2 Q3 F300\nG80\nG0 Z20\nM5\nT2 M6\nM3 S4000\nM8\n\
        G0 X-50 Y-40\nG0 Z3\nG1 Z-1.5 F300\nG1 X50 F2000\nG1 Y-45\nG1 X-50 Y-42\nG4 P0.2\nG1 Z2\nG0 Z20\nM9\nM5\nM2\n";
    text
}

fn place(axes: &PerAxis<Position>) -> [f64; 3] {
    [Axis::X, Axis::Y, Axis::Z].map(|axis| axes[axis.index()].mm())
}

fn slides(record: &Record) -> [f64; 3] {
    [Axis::X, Axis::Y, Axis::Z].map(|axis| record.truth.axes[axis.index()].slide_mm)
}

/// What is programmed below the top of the part, in samples, and which of it was cut.
struct Programmed {
    samples: Vec<([f64; 3], bool)>,
    /// Samples by where they lie from above.
    cells: BTreeMap<(i64, i64), Vec<usize>>,
    looks: u64,
}

/// Every second cycle is looked at: at the highest feed the tool goes a thirtieth of a millimetre meanwhile.
const EVERY: u64 = 2;
const CELL_MM: f64 = 0.5;

fn cell([x, y, _]: [f64; 3]) -> (i64, i64) {
    ((x / CELL_MM).floor() as i64, (y / CELL_MM).floor() as i64)
}

impl Programmed {
    /// Of exact lines and arcs, from where the axes stand at first.
    fn new(machine: &Machine, items: &[Item]) -> Programmed {
        let mut programmed = Programmed { samples: Vec::new(), cells: BTreeMap::new(), looks: 0 };
        let mut from = place(&machine.home());
        for item in items {
            let Some(target) = item.code.target() else { continue };
            let to = place(target);
            let between = |share: f64| std::array::from_fn(|i| from[i] + share * (to[i] - from[i]));
            match &item.code {
                Code::Line { feed, .. } => {
                    let length = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
                    let steps = (length / SAMPLE_MM).ceil().max(1.0) as u32;
                    let places = (0..=steps).map(|n| between(f64::from(n) / f64::from(steps)));
                    places.for_each(|place| programmed.add(place, *feed != Feed::Rapid));
                }
                Code::Arc { arc, .. } => {
                    let centre = [arc.center[0].mm(), arc.center[1].mm()];
                    let radius = libm::hypot(from[0] - centre[0], from[1] - centre[1]);
                    let angle = |place: [f64; 3]| libm::atan2(place[1] - centre[1], place[0] - centre[0]);
                    let sign = f64::from(arc.turns.signum());
                    let swept = (sign * (angle(to) - angle(from))).rem_euclid(TAU);
                    let swept = if swept < 1e-6 { TAU } else { swept };
                    let steps = (radius * swept / SAMPLE_MM).ceil() as u32;
                    for n in 0..=steps {
                        let share = f64::from(n) / f64::from(steps);
                        let at = angle(from) + sign * share * swept;
                        let [_, _, z] = between(share);
                        let [across, along] = [radius * libm::cos(at), radius * libm::sin(at)];
                        let place = [centre[0] + across, centre[1] + along, z];
                        programmed.add(place, true);
                    }
                }
                other => panic!("an exact path has no {other:?}"),
            }
            from = to;
        }
        programmed
    }

    /// A rapid leads through the air, or where was cut before: nothing has to be cut there.
    fn add(&mut self, place: [f64; 3], cuts: bool) {
        if place[2] < 0.0 {
            self.cells.entry(cell(place)).or_default().push(self.samples.len());
            self.samples.push((place, !cuts));
        }
    }

    /// The tool is here. How far it is off the path and off what is over the path, if it is in the part.
    fn cut(&mut self, at: [f64; 3]) -> Option<f64> {
        self.looks += 1;
        if at[2] > 0.0 || !self.looks.is_multiple_of(EVERY) {
            return None;
        }
        let (x, y) = cell(at);
        let mut nearest = f64::INFINITY;
        for near in (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (x, y))) {
            for index in self.cells.get(&near).into_iter().flatten() {
                let (place, done) = &mut self.samples[*index];
                let [dx, dy, dz] = std::array::from_fn(|i| at[i] - place[i]);
                let aside = libm::hypot(dx, dy);
                *done |= libm::hypot(aside, dz) < NEAR_MM;
                nearest = nearest.min(libm::hypot(aside, dz.min(0.0)));
            }
        }
        Some(nearest)
    }

    fn is_complete(&self) -> bool {
        self.samples.iter().all(|(_, done)| *done)
    }

    fn missing(&self) -> Vec<[f64; 3]> {
        self.samples.iter().filter(|(_, done)| !done).map(|(place, _)| *place).take(3).collect()
    }
}

/// A run cut behind a cycle, in which something is written, so many records of the journal are lost: what it
/// knows, the machine that is switched on again.
fn cut(
    machine: &Machine,
    items: &[Item],
    [seed, at, lost]: [u64; 3],
    mut see: impl FnMut(&Record),
) -> (State, Plant) {
    let mut rig = Rig::new(machine, items.iter().copied(), Scenario::none(), seed).expect("a rig");
    let mut keeper = Keeper::new(machine, Origin { seed, ..Origin::default() }, items);
    let mut written = Vec::new();
    for _ in 0..at {
        rig.cycle(None, |record| {
            see(record);
            written.extend(keeper.cycle(record));
        });
    }
    written.extend(keeper.last());
    let mut plant = rig.lose_power(|_| {});
    plant.switch_on(Scenario::none()).expect("the same machine");
    (written[(written.len() - 1).saturating_sub(lost as usize)], plant)
}

fn planned(machine: &Machine, items: &[Item], state: &State, plant: &Plant) -> Result<Plan, Refusal> {
    let here = plant.measurement().axes.map(|axis| axis.position);
    plan(machine, || items.iter().copied(), state, &here)
}

/// Runs what a plan says to its end, or to a cycle; how many there were.
fn goes_on(
    machine: &Machine,
    items: &[Item],
    (plan, plant): (&Plan, Plant),
    until: u64,
    mut see: impl FnMut(&Record),
) -> (Rig<impl Iterator<Item = Item>, Straight>, u64) {
    let rest: Vec<Item> = plan.executed(items.iter().copied()).collect();
    let mut rig = Rig::on_plant(machine, plant, rest.into_iter(), Straight);
    let mut cycles = 0;
    while cycles < until && rig.cycle(None, &mut see) {
        cycles += 1;
    }
    (rig, cycles)
}

fn mill() -> Machine {
    Machine::from_toml(machine::SMALL_MILL).expect("a mill")
}

/// A program as it is executed, and as exact lines and arcs; how many cycles it takes without a cut.
struct Work {
    machine: Machine,
    items: Vec<Item>,
    exact: Vec<Item>,
    cycles: u64,
}

impl Work {
    /// The text of a program is given the path that it keeps to. Uncut it does what it says.
    fn new(machine: Machine, text: impl Fn(&str) -> String) -> Work {
        let [items, exact] = ["G64 P0.01", "G61"].map(|path| compiled(&machine, &text(path)));
        let mut whole = Programmed::new(&machine, &exact);
        let mut rig = Rig::new(&machine, items.iter().copied(), Scenario::none(), 1).expect("a rig");
        let (mut cycles, mut off_mm) = (0, 0.0_f64);
        while rig.cycle(None, |record| off_mm = off_mm.max(whole.cut(slides(record)).unwrap_or(0.0))) {
            cycles += 1;
        }
        assert!(off_mm < NEAR_MM && whole.is_complete(), "{off_mm} mm, {:?}", whole.missing());
        Work { machine, items, exact, cycles }
    }

    /// It is cut behind a cycle, so many records of the journal are lost, and it is gone on with: the plan,
    /// and how far the tool was off path and column in the part, mm.
    fn finished(&self, at: u64, lost: u64) -> (Plan, f64) {
        let Work { machine, items, exact, .. } = self;
        let mut part = Programmed::new(machine, exact);
        let (known, plant) = cut(machine, items, [1, at, lost], |record| {
            part.cut(slides(record));
        });
        let what = format!("cut in cycle {at}, {lost} records lost");
        let plan = planned(machine, items, &known, &plant).unwrap_or_else(|error| panic!("{what}: {error}"));
        let stands = plant.measurement().axes.map(|axis| axis.position);
        let [stood_x, stood_y, _] = place(&stands);
        let mut observer = Observer::new(machine, items);
        let mut observed_mm = 0.0_f64;
        let (_, length) = goes_on(machine, items, (&plan, plant), PATIENCE, |record| {
            observer.cycle(record);
            let at = slides(record);
            let off_mm = part.cut(at).unwrap_or(0.0);
            // Straight up from where it stood.
            let over_mm = libm::hypot(at[0] - stood_x, at[1] - stood_y);
            observed_mm = observed_mm.max(off_mm.min(over_mm));
        });
        assert!(length < PATIENCE, "{what}: the program does not end");
        let seen = observer.finish();
        let ended = (seen.outcome, &seen.faults[..]);
        assert_eq!(ended, (Outcome::Completed, &[][..]), "{what}: {:?}", plan.stands);
        assert!(observed_mm < NEAR_MM, "{what}: {observed_mm:.3} mm off the path, {:?}", plan.way);
        assert!(part.is_complete(), "{what}: {:?} is not cut, {:?}", part.missing(), plan.stands);
        (plan, observed_mm)
    }
}

#[test]
fn a_mill_that_is_cut_in_any_cycle_finishes_its_part_and_nothing_else() {
    let work = Work::new(mill(), program);
    assert!(work.items.iter().any(|item| matches!(item.code, Code::Curve { .. })), "the ellipse is a curve");
    let (mut random, mut stood, mut most_mm) = (Seed::new(239), [0; 4], 0.0_f64);
    for _ in 0..count("PITCHLOCK_CUTS", CUTS) {
        let [at, lost] = [random.within(1..work.cycles), random.within(0..4) * random.within(0..2)];
        let (plan, off_mm) = work.finished(at, lost);
        most_mm = most_mm.max(off_mm);
        stood[match plan.stands {
            Stands::OnRapid(_) => 0,
            Stands::OnContour(_) => 1,
            Stands::Above => 2,
            Stands::InPass(_) | Stands::AtRest => 3,
        }] += 1;
    }
    println!("on a rapid, on a contour, over the part, at rest: {stood:?}; {most_mm:.4} mm off at most");
    assert!(stood[1] > 2, "{stood:?}");
}

/// At a corner the next move begins before the last one has come to its end, of which up to 0.25 mm is uncut
/// then. It is cut in every cycle from before to behind two of them.
#[test]
fn a_mill_that_is_cut_while_two_moves_overlap_leaves_nothing_between_them() {
    let text = |path: &str| {
        format!("G17 G21 G90 G94 {path}\nG0 X-2\nG1 Z-0.2 F900\nG1 X0 F3000\nG1 Y2\nG1 X2 Y1\nM2\n")
    };
    let mut machine = mill();
    machine.axis.get_mut(&Axis::Z).expect("a mill has Z").home_mm = 0.5;
    let work = Work::new(machine, text);
    let (mut near, mut both, mut cycle) = (Vec::new(), 0, 0);
    cut(&work.machine, &work.items, [1, work.cycles, 0], |record| {
        cycle += 1;
        let [x, y, z] = slides(record);
        let away = |tip_y: f64| libm::hypot(x, y - tip_y);
        if z < 0.0 && (away(0.0) < 0.26 || away(2.0) < 0.26) {
            near.push(cycle);
        }
        both += u64::from(z < 0.0 && x < -0.004 && y > 0.001);
    });
    assert!(near.len() > 100 && both > 5, "{near:?}, {both} with both axes between the lines");
    near.into_iter().for_each(|at| _ = work.finished(at, 0));
}

/// Home is beside the part and lower than its top: the way over the part is as high as the program has led
/// the tool.
#[test]
fn a_mill_whose_home_is_low_goes_over_its_part() {
    let mut machine = mill();
    machine.axis.get_mut(&Axis::Z).expect("a mill has Z").home_mm = -20.0;
    let text = |path: &str| {
        format!(
            "G17 G21 G90 G94 {path}\nM3 S3000\nG0 Z30\nG0 X50 Y0\nG0 Z2\nG1 Z-5 F300\nG1 X60 F1500\nG1 X60 Y30\nG0 Z2\n\
             G0 X80\nG1 Z-5 F300\nG1 X90 F1500\nG0 Z30\nM5\nM2\n"
        )
    };
    let work = Work::new(machine, text);
    let mut sideways = 0;
    for share in 1..16 {
        let (plan, _) = work.finished(work.cycles * share / 16, 0);
        let ways: Vec<[f64; 3]> = plan.way.iter().filter_map(|item| item.code.target()).map(place).collect();
        for pair in ways.windows(2) {
            if pair[0][..2] != pair[1][..2] {
                assert!(pair[0][2] >= 30.0, "{:?}: {ways:?}", plan.stands);
                sideways += 1;
            }
        }
    }
    assert!(sideways > 4, "{sideways}");
}

/// The power goes again on the way up, over the part, and on the way down.
#[test]
fn a_lead_in_that_is_cut_as_well_is_begun_anew() {
    let machine = mill();
    let items = compiled(&machine, &program("G64 P0.01"));
    let (known, plant) = cut(&machine, &items, [1, 9000, 0], |_| {});
    let first = planned(&machine, &items, &known, &plant).expect("it goes on");
    let lead_in = {
        let mut begun = 0;
        let (_, all) = goes_on(&machine, &items, (&first, plant.clone()), PATIENCE, |record| {
            begun += u64::from(record.machine.line < first.line || record.truth.spindle_rpm.abs() < 1.0);
        });
        assert!(all < PATIENCE && begun > 500, "{begun}");
        begun
    };
    let mut random = Seed::new(240);
    for _ in 0..6 {
        let at = random.within(1..lead_in + 3000);
        let (rig, _) = goes_on(&machine, &items, (&first, plant.clone()), at, |_| {});
        let mut plant = rig.lose_power(|_| {});
        plant.switch_on(Scenario::none()).expect("the same machine");
        let again =
            planned(&machine, &items, &known, &plant).unwrap_or_else(|error| panic!("cycle {at}: {error}"));
        assert_eq!(again.modal.items, first.modal.items, "cycle {at}: {:?}", again.stands);
    }
}

#[test]
fn a_mill_is_refused_by_name_where_it_cannot_go_on() {
    let machine = mill();
    let items = compiled(&machine, &program("G64 P0.01"));
    let mut elsewhere = machine.home();
    elsewhere[Axis::X.index()] = Position::from_mm(-100.0);
    elsewhere[Axis::Z.index()] = Position::from_mm(-30.0);
    let refused =
        plan(&machine, || items.iter().copied(), &State::nothing(), &elsewhere).expect_err("elsewhere");
    let text = refused.to_string();
    assert!(text.contains("X -100.000 Y 0.000 Z -30.000") && text.contains("by hand"), "{text}");
}

/// A tap comes out of its hole with the spindle alone; over the hole it is begun anew.
#[test]
fn a_tap_that_stands_in_its_hole_is_refused_and_one_over_it_goes_on() {
    let machine = mill();
    let text = "G17 G21 G90 G94 G98\nS600 M3\nF600 G84 X10 Y5 Z10 R25\nX20\nG80\nM5\nM2\n";
    let items = compiled(&machine, text);
    let mut course = Vec::new();
    let mut rig = Rig::new(&machine, items.iter().copied(), Scenario::none(), 1).expect("a rig");
    while rig.cycle(None, |record| {
        let in_pass = record.axes.iter().any(|(_, status)| status.state().is_in_pass());
        course.push((in_pass, slides(record)));
    }) {}
    let deep = |in_pass: bool, [_, _, z]: [f64; 3]| in_pass && z < 24.0;
    let (mut random, mut refused) = (Seed::new(241), 0);
    let cycles: Vec<u64> = (0..8).map(|_| random.within(1000..course.len() as u64 - 1000)).collect();
    let first =
        |such: &dyn Fn(bool, [f64; 3]) -> bool| course.iter().position(|(in_pass, at)| such(*in_pass, *at));
    let in_hole = first(&deep).expect("it taps") as u64 + 200;
    let over = first(&|in_pass, _| in_pass).expect("it taps") as u64;
    for at in cycles.into_iter().chain([in_hole, over]) {
        let (known, plant) = cut(&machine, &items, [1, at, 0], |_| {});
        let (in_pass, place) = course[at as usize - 1];
        match planned(&machine, &items, &known, &plant) {
            Err(refusal) => {
                assert!(matches!(refusal, Refusal::Tap { line: 3 | 4 }), "cycle {at}: {refusal}");
                assert!(in_pass && place[2] < 25.0, "cycle {at}: {refusal} at {place:?}");
                refused += 1;
            }
            Ok(plan) => {
                assert!(!deep(in_pass, place), "cycle {at}: {:?} at {place:?}", plan.stands);
                let mut observer = Observer::new(&machine, &items);
                goes_on(&machine, &items, (&plan, plant), PATIENCE, |record| observer.cycle(record));
                let seen = observer.finish();
                assert_eq!(seen.outcome, Outcome::Completed, "cycle {at}: {:?}", seen.faults);
            }
        }
    }
    assert!(refused > 0);
}
