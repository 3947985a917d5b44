//! Threads that follow each other, and leads that grow: where the tool is, against the programmed path.

mod round;
mod table;
mod tools;

use gcode::problem::Severity;
use interpreter::{Check, check};
use machine::{Machine, ProgramDialect, RunOut};
use protocol::{Axis, Code, ThreadPass};

use crate::{good, passes};

/// A programmed leg: its end, X a radius, the lead along its path where it begins, and its growth in a turn.
#[derive(Clone, Copy)]
struct Leg(f64, f64, f64, f64);

/// Where a tool is on a path, so many turns after its start: the lead integrated in small steps, by nothing
/// but its meaning.
struct Programmed {
    /// Turns, X, Z.
    places: Vec<[f64; 3]>,
}

const STEPS: usize = 4000;

impl Programmed {
    fn of(from: [f64; 2], legs: &[Leg]) -> Programmed {
        let (mut at, mut turns, mut places) = (from, 0.0, vec![[0.0, from[0], from[1]]]);
        for Leg(x, z, lead, growth) in legs.iter().copied() {
            let length = libm::hypot(x - at[0], z - at[1]);
            // Up to where a lead that falls would turn round.
            let (mut low, mut high) = (0.0, if growth < 0.0 { -lead / growth } else { 1e4 });
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                let reached = lead * middle + 0.5 * growth * middle * middle >= length;
                if reached { high = middle } else { low = middle }
            }
            for step in 1..=STEPS {
                let n = high * step as f64 / STEPS as f64;
                let share = (lead * n + 0.5 * growth * n * n) / length;
                places.push([turns + n, at[0] + share * (x - at[0]), at[1] + share * (z - at[1])]);
            }
            (at, turns) = ([x, z], turns + high);
        }
        Programmed { places }
    }

    fn turns(&self) -> f64 {
        self.places.last().map_or(0.0, |place| place[0])
    }

    fn at(&self, turns: f64) -> [f64; 2] {
        let behind = self.places.partition_point(|place| place[0] < turns).clamp(1, self.places.len() - 1);
        let [a, b] = [self.places[behind - 1], self.places[behind]];
        let share = (turns - a[0]) / (b[0] - a[0]);
        [1, 2].map(|i| a[i] + share * (b[i] - a[i]))
    }
}

/// Angle from the index to the start of the path.
fn turn_deg(pass: &ThreadPass) -> f64 {
    let law = pass.axis(pass.along());
    law.run_in_c0_deg + 0.5 * law.run_in_dc_deg
}

/// Largest distance of a pass from a path outside of the windows of its corners, from the end of the run-in
/// to the end of the thread, mm; and how many places were looked at.
fn off(pass: &ThreadPass, path: &Programmed) -> (f64, usize) {
    let along = pass.axis(pass.along());
    let (locked, turn) = (along.run_in_c0_deg + along.run_in_dc_deg, turn_deg(pass));
    let laws = [Axis::X, Axis::Z].map(|axis| (pass.axis(axis).start.mm(), pass.law(axis)));
    let inside =
        |c: f64| pass.corners().any(|corner| (corner.c_deg..corner.c_deg + corner.dc_deg).contains(&c));
    let (mut most, mut looks, mut c) = (0.0f64, 0, locked);
    while c < pass.thread_end_deg {
        if !inside(c) {
            let [x, z] = path.at((c - turn) / 360.0);
            let [(x0, x_law), (z0, z_law)] = &laws;
            most = most.max(libm::hypot(x0 + x_law.at(c).s - x, z0 + z_law.at(c).s - z));
            looks += 1;
        }
        c += 3.7;
    }
    (most, looks)
}

fn only_pass(check: &Check) -> ThreadPass {
    let all = passes(&check.items);
    assert_eq!(all.len(), 1, "one chain is one pass");
    all[0]
}

/// A lathe that reads FANUC programs.
fn fanuc_lathe() -> Machine {
    let mut machine = Machine::plain();
    machine.general.dialect = ProgramDialect::Fanuc;
    machine
}

fn fanuc(source: &str) -> Check {
    let check = check("o0001.nc", &format!("%\nO0001\n{source}M30\n%\n"), &fanuc_lathe());
    assert!(
        check.diagnostics.iter().all(|diagnostic| diagnostic.severity != Severity::Error),
        "{:?}",
        check.diagnostics
    );
    check
}

const CYLINDER_CONE_CYLINDER: [Leg; 3] =
    [Leg(20.0, -20.0, 2.0, 0.0), Leg(25.0, -30.0, 2.0, 0.0), Leg(25.0, -50.0, 3.0, 0.0)];

#[test]
fn threads_that_follow_each_other_are_one_pass_that_goes_along_each_of_them() {
    let check =
        good("S400 M3\nG0 X20 Z5\nG33 Z-20 K2\n(a cone)\nG33 X25 Z-30 K2\n\nG33 Z-50 K3\nG0 X35\nZ5\nM2\n");
    let pass = only_pass(&check);
    let path = Programmed::of([20.0, 5.0], &CYLINDER_CONE_CYLINDER);
    let (most, looks) = off(&pass, &path);
    assert!(most < 1e-6 && looks > 2000, "{most} mm over {looks} places");
    assert_eq!(pass.corners().count(), 2);
    let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
    assert_eq!((x.end.mm(), z.end.mm(), x.retract_mm), (35.0, -50.0, 10.0));
    // The way out is free of the thickest thread.
    assert!(pass.out.clear.mm() == 35.0 && pass.out.free.mm() > 25.0);
    let note = &check.passes[0];
    assert_eq!((note.corners.len(), note.corners[0].line, note.corners[1].line), (2, 5, 7));
    let corner = note.corners[0];
    assert!((corner.at_mm[0] - 20.0).abs() < 1e-9 && (corner.at_mm[1] + 20.0).abs() < 1e-9, "{corner:?}");
    assert!(corner.off_mm > 1e-4 && corner.off_mm < 0.2 && corner.window_deg > 1.0, "{corner:?}");
}

/// The distance from the corner that `check` tells is the largest one from the programmed path.
#[test]
fn what_a_corner_is_rounded_by_is_told() {
    let check = good("S400 M3\nG0 X20 Z5\nG33 Z-20 K2\nG33 Z-50 K4\nG0 X35\nM2\n");
    let pass = only_pass(&check);
    let path = Programmed::of([20.0, 5.0], &[Leg(20.0, -20.0, 2.0, 0.0), Leg(20.0, -50.0, 4.0, 0.0)]);
    let (corner, law) = (pass.corners[0], pass.law(Axis::Z));
    let looks = (0..=1000).map(|look| corner.c_deg + corner.dc_deg * f64::from(look) / 1000.0);
    let from = |c: f64| 5.0 + law.at(c).s - path.at((c - turn_deg(&pass)) / 360.0)[1];
    let most = looks.map(|c| from(c).abs()).fold(0.0, f64::max);
    let told = check.passes[0].corners[0].off_mm;
    assert!((told - most).abs() < 1e-3 * most, "told {told}, is {most}");
    // By formula: 0.0707 of the jump of the lead times the window in turns.
    let formula =
        0.5 * (1.0 / 6.0 - 1.0 / (4.0 * core::f64::consts::PI.powi(2))) * 2.0 * corner.dc_deg / 360.0;
    assert!((told / formula - 1.0).abs() < 1e-6, "told {told}, by formula {formula}");
}

#[test]
fn both_dialects_make_the_same_chain() {
    let linuxcnc = good("G7\nS400 M3\nG0 X40 Z5\nG33 Z-20 K2\nG33 X50 Z-30 K[2*SQRT[125]/10]\nG0 X60\nM2\n");
    // F is the lead along Z, the longer way; G32 is modal.
    let same = fanuc("G97 S400 M03\nG00 X40. Z5.\nG32 Z-20. F2.\nX50. Z-30. F2.\nG00 X60.\n");
    let [one, other] = [only_pass(&linuxcnc), only_pass(&same)];
    for axis in [Axis::X, Axis::Z] {
        for c in (0..12_000).map(f64::from) {
            let [a, b] = [one.law(axis).at(c).s, other.law(axis).at(c).s];
            assert!((a - b).abs() < 1e-9, "{axis:?} at {c}: {a} and {b}");
        }
    }
}

#[test]
fn a_lead_that_grows_follows_its_formula() {
    for (k, run_out) in
        [(0.1, RunOut::Within), (-0.04, RunOut::Within), (0.1, RunOut::Beyond), (-0.04, RunOut::Beyond)]
    {
        let mut machine = fanuc_lathe();
        machine.threading.run_out = run_out;
        let source = format!("%\nO0001\nG97 S500 M03\nG00 X40. Z4.\nG34 Z-40. F2. K{k}\nG00 X50.\nM30\n%\n");
        let check = check("o0001.nc", &source, &machine);
        assert!(check.diagnostics.is_empty(), "{:?}", check.diagnostics);
        let pass = only_pass(&check);
        let (law, turn) = (pass.law(Axis::Z), turn_deg(&pass));
        let z = pass.axis(Axis::Z);
        let mut c = z.run_in_c0_deg + z.run_in_dc_deg;
        let mut looks = 0;
        while c < pass.thread_end_deg {
            let n = (c - turn) / 360.0;
            let formula = -(2.0 * n + 0.5 * k * n * n);
            assert!((law.at(c).s - formula).abs() < 1e-9, "after {n} turns {} {formula}", law.at(c).s);
            let lead = -(2.0 + k * n) * 500.0 / 60.0;
            assert!((law.at(c).v - lead).abs() < 1e-9, "after {n} turns");
            (c, looks) = (c + 5.3, looks + 1);
        }
        assert!(looks > 800, "{looks}");
        let beyond = -40.0 - z.end.mm();
        match run_out {
            RunOut::Within => assert!(beyond.abs() < 1e-6, "{beyond}"),
            RunOut::Beyond => assert!(beyond > 0.01 && beyond < 3.0, "{beyond}"),
        }
        let turns = Programmed::of([20.0, 4.0], &[Leg(20.0, -40.0, 2.0, k)]).turns();
        let end = check.passes[0].end_lead_mm.expect("it changes");
        assert!((end + 2.0 + k * turns).abs() < 1e-3, "{end} after {turns} turns");
    }
}

/// A table of leads: blocks that go on from each other, each beginning with the lead that the one before ends
/// with.
#[test]
fn a_table_of_leads_is_a_chain_that_grows_piece_by_piece() {
    // Leads 2, 3, 2.5, 4 at Z 0, -10, -20, -40: growth (b² - a²)/(2 l).
    let rows: [(f64, f64); 4] = [(0.0, 2.0), (-10.0, 3.0), (-20.0, 2.5), (-40.0, 4.0)];
    let mut source = String::from("G97 S300 M03\nG00 X40. Z5.\nG32 Z0. F2.\n");
    let mut legs = vec![Leg(20.0, 0.0, 2.0, 0.0)];
    for pair in rows.windows(2) {
        let ((from, a), (to, b)) = (pair[0], pair[1]);
        let k = (b * b - a * a) / (2.0 * (from - to));
        source += &format!("G34 Z{to:.1} F{a:.4} K{k:.12}\n");
        legs.push(Leg(20.0, to, a, k));
    }
    let check = fanuc(&(source + "G32 Z-60. F4.\nG00 X50.\n"));
    legs.push(Leg(20.0, -60.0, 4.0, 0.0));
    let pass = only_pass(&check);
    let (most, looks) = off(&pass, &Programmed::of([20.0, 5.0], &legs));
    assert!(most < 1e-5 && looks > 1500, "{most} mm over {looks} places");
    // Leads meet: what rounds the corners is small.
    assert!(
        check.passes[0].corners.iter().all(|corner| corner.off_mm < 1e-4),
        "{:?}",
        check.passes[0].corners
    );
}

#[test]
fn a_chain_leaves_no_limit_and_says_up_to_which_speed() {
    let machine = Machine::plain();
    for s in [50, 200, 800, 1500] {
        let source =
            format!("S{s} M3\nG0 X20 Z12\nG33 Z-40 K1\nG33 X25 Z-60 K1.5\nG33 Z-90 K1\nG0 X35\nM2\n");
        let pass = only_pass(&good(&source));
        assert!(machine.can_follow(&pass) && pass.max_ratio >= 1.0, "S{s}: {}", pass.max_ratio);
        for axis in [Axis::X, Axis::Z] {
            let limits = machine.axis[&axis].limits();
            let law = pass.law(axis);
            let mut c = 0.0;
            while c < pass.done_deg() {
                let now = law.at(c).driven([pass.max_ratio, 0.0, 0.0, 0.0]);
                let shares = [now.v / limits.v, now.a / limits.a, now.j / limits.j, now.dj / limits.dj];
                assert!(
                    shares.iter().all(|share| share.abs() <= 1.0 + 1e-9),
                    "S{s} {axis:?} {c}: {shares:?}"
                );
                c += 0.6;
            }
        }
    }
}

#[test]
fn a_chain_travels_as_one_item() {
    let check = good("S400 M3\nG0 X20 Z5\nG33 Z-20 K2\nG33 X25 Z-30 K2\nG33 Z-50 K3\nG0 X35\nM2\n");
    let item = check.items.iter().find(|item| matches!(item.code, Code::Pass(_))).expect("a pass");
    let packet = protocol::CodePacket::pack(0, item);
    assert_eq!(packet.unpack(0).expect("it is read again"), *item);
    assert_eq!(packet.as_bytes().len(), check.passes[0].packet_bytes);
    assert!(packet.as_bytes().len() < 400, "{}", packet.as_bytes().len());
}

/// A program with one error, which stands in a line and has these words in its message and its help.
fn refused(program: &str, line: u32, message: &str, help: &str) {
    let check = check("t.ngc", program, &Machine::plain());
    let errors: Vec<_> = check.diagnostics.iter().filter(|found| found.severity == Severity::Error).collect();
    assert_eq!(errors.len(), 1, "{program}: {errors:?}");
    let error = errors[0];
    assert_eq!(error.line, line, "{error:?}");
    assert!(error.message.contains(message) && error.help.contains(help), "{error:?}");
}

#[test]
fn what_is_no_chain_is_refused_with_a_remedy() {
    let refused = |blocks: &str, line: u32, message: &str, help: &str| {
        refused(&format!("S400 M3\nG0 X20 Z5\n{blocks}G0 X35\nM2\n"), line, message, help);
    };
    refused("G33 Z-20 K2\nG33 Z-10 K2\n", 4, "goes one way along Z", "put a G0 between");
    refused("G33 Z-20 K2\nG33 X30 K2\n", 4, "goes one way along Z", "put a G0 between");
    refused("G33 X25 K2\nG33 Z-10 K2\n", 4, "goes one way along X", "put a G0 between");
    refused("G33 Z-20 K2\nM8\nG33 Z-40 K2\n", 5, "something stands between", "one chain");
    let blocks = |n: u32| {
        (1..=n).map(|i| format!("G33 Z{} K{}\n", -20.0 * f64::from(i), 1 + i % 2)).collect::<String>()
    };
    refused(&blocks(14), 16, "12 corners at most", "put a G0 between");
    refused("G34 Z-20 K0.1\n", 3, "there is no code G34", "a chain of short G33");
    // Corners 1 mm apart at this speed: the lead has no room to change.
    refused("G33 Z-20 K2\nG33 Z-20.5 K9\nG33 Z-40 K2\n", 3, "there is room for", "highest spindle speed");
}

#[test]
fn a_lead_that_falls_to_nothing_is_refused_with_a_remedy() {
    let source = "%\nO0001\nG97 S400 M03\nG00 X40. Z4.\nG34 Z-40. F2. K-0.1\nG00 X50.\nM30\n%\n";
    let check = check("o0001.nc", source, &fanuc_lathe());
    let error = check.diagnostics.iter().find(|found| found.severity == Severity::Error).expect("refused");
    assert!(error.line == 5 && error.message.contains("falls to nothing after 20 mm"), "{error:?}");
    assert!(error.help.contains("K") && error.help.contains("F"), "{error:?}");
}
