//! Constant surface speed: G96 with D, its axis under offsets, G97, feeds per revolution, threads.

use interpreter::check;
use machine::Machine;
use protocol::{Code, SpindleMode, SpindleSpeed};

use crate::{good, listing};

/// Lines and speeds of the spindle's items.
fn speeds(source: &str) -> Vec<(u32, SpindleMode, SpindleSpeed)> {
    let spindle = |item: &protocol::Item| match item.code {
        Code::Spindle { mode, speed } => Some((item.line, mode, speed)),
        _ => None,
    };
    good(source).items.iter().filter_map(spindle).collect()
}

/// mm/s, highest 1/min, X of the axis in mm.
fn surface(speed: SpindleSpeed) -> [f64; 3] {
    let SpindleSpeed::Surface { mm_s, max_rpm, axis_mm } = speed else { panic!("{speed:?}") };
    [mm_s, max_rpm, axis_mm.mm()]
}

#[test]
fn metres_and_feet_a_minute() {
    let highest = Machine::plain().spindle.max_rpm;
    let metric = speeds("G96 D1500 S180 M3\nM2\n");
    assert_eq!(
        (metric[0].0, metric[0].1, surface(metric[0].2)),
        (1, SpindleMode::Clockwise, [3000.0, 1500.0, 0.0])
    );
    let inch = speeds("G20\nG96 S100 M4\nM2\n");
    assert_eq!(
        surface(inch[0].2),
        [100.0 * 304.8 / 60.0, highest, 0.0],
        "D left out: what the spindle can do"
    );
    assert_eq!(inch[0].1, SpindleMode::Counterclockwise);
    let fast = speeds("G96 D90000 S180 M3\nM2\n");
    assert_eq!(surface(fast[0].2)[1], highest);
}

#[test]
fn the_axis_of_the_spindle_lies_where_x0_is_programmed() {
    let items = speeds("G10 L2 P2 X3\nG96 D1500 S60 M3\nG0 X20 Z5\nG55\nG0 X21\nG0 X22\nM2\n");
    let axes: Vec<(u32, f64)> =
        items[..2].iter().map(|(line, _, speed)| (*line, surface(*speed)[2])).collect();
    assert_eq!(axes, [(2, 0.0), (4, 3.0)]);
    assert_eq!(items[2].1, SpindleMode::Stop);
    assert_eq!(items.len(), 3, "nothing is sent twice");
}

#[test]
fn g97_returns_to_a_constant_speed() {
    let items = speeds("G96 D1500 S60 M3\nG0 X20 Z5\nG97 S400\nG0 X30\nM2\n");
    assert_eq!(items[1], (3, SpindleMode::Clockwise, SpindleSpeed::Rpm(400.0)));
    let kept = speeds("G96 D1500 S60 M3\nG97\nM2\n");
    assert_eq!(kept[1].2, SpindleSpeed::Rpm(60.0), "S is read as 1/min, as LinuxCNC does");
    let check = check("test.ngc", "G96 D1500 S9000 M3\nG97\nM2\n", &Machine::plain());
    let errors: Vec<_> = check.diagnostics.iter().map(|one| (one.line, one.code)).collect();
    assert_eq!(errors, [(2, "speed-limit")]);
}

#[test]
fn words_of_one_block_make_one_item() {
    let check = good("G97 S500 M3\nG96 D1500 S60\nM5\nM3\nG97 S300\nM2\n");
    let lines: Vec<u32> = check.items.iter().map(|item| item.line).collect();
    assert_eq!(lines, [1, 2, 3, 4, 5, 6, 6], "{}", listing(&check.items));
}

#[test]
fn feed_per_revolution_goes_with_it() {
    good("G96 D1500 S60 M3\nG0 X20 Z5\nG95 G1 X10 F0.2\nM2\n");
    good("G18 G96 D1500 S60 M3\nG0 X20 Z5\nG97 S400\nG33 Z-10 K1\nG0 X25\nM2\n");
}

/// Items of a program with a thread under G96: speeds, and how many passes each of them is for. The program
/// warns of it, and of nothing else.
fn under_g96(source: &str, machine: &Machine) -> Vec<(SpindleSpeed, usize)> {
    let check = check("test.ngc", source, machine);
    let codes: Vec<_> = check.diagnostics.iter().map(|one| one.code).collect();
    assert!(codes.iter().all(|code| *code == "constant-surface-thread"), "{:?}", check.diagnostics);
    assert!(!codes.is_empty() && check.is_good());
    let mut found = Vec::new();
    for item in &check.items {
        match item.code {
            Code::Spindle { speed, .. } => found.push((speed, 0)),
            Code::Pass(pass) => {
                let (speed, passes) = found.last_mut().expect("the spindle turns");
                assert_eq!(*speed, SpindleSpeed::Rpm(pass.s_rpm), "proved for what it turns at");
                *passes += 1;
            }
            _ => {}
        }
    }
    found
}

/// The lead of a pass is proved for one speed: that of G96 at the crest of a cycle, or where a G33 begins.
#[test]
fn a_thread_keeps_the_speed_of_g96_where_it_begins() {
    let machine = Machine::plain();
    let rpm_at = |radius: f64| 1000.0 * 60.0 / (std::f64::consts::TAU * radius);
    let near =
        |speed: SpindleSpeed, rpm: f64| matches!(speed, SpindleSpeed::Rpm(is) if (is - rpm).abs() < 1e-6);
    let cycle = "G18 G96 D1500 S60 M3\nG0 X20 Z5\nG76 P1 Z-20 I-1 J0.1 K0.5 H2\nG0 X30\nM2\n";
    let [before, thread, after, end] = under_g96(cycle, &machine)[..] else { panic!("four speeds") };
    assert!(near(thread.0, rpm_at(19.0)) && thread.1 > 5, "{thread:?}");
    assert_eq!(
        (surface(before.0), surface(after.0), end.0),
        ([1000.0, 1500.0, 0.0], [1000.0, 1500.0, 0.0], SpindleSpeed::Rpm(0.0))
    );
    let twice =
        "G18 G96 D1500 S60 M3\nG0 X20 Z5\nG33 Z-20 K1\nG0 X25\nG0 Z5\nG0 X19.8\nG33 Z-20 K1\nG0 X25\nM2\n";
    let speeds = under_g96(twice, &machine);
    let threads: Vec<_> = speeds.iter().filter(|(_, passes)| *passes == 1).collect();
    assert!(near(threads[0].0, rpm_at(20.0)) && near(threads[1].0, rpm_at(19.8)), "{speeds:?}");
    // D bounds it there, too.
    let small = cycle.replace("D1500", "D300");
    assert!(near(under_g96(&small, &machine)[1].0, 300.0));
    // FANUC's cycles are the same.
    let mut machine = machine;
    machine.general.dialect = machine::ProgramDialect::Fanuc;
    let fanuc = "G50 S1500\nG96 S60 M03\nG00 X40. Z5.\nG76 P021060 Q50 R0.03\nG76 X36.773 Z-20. P614 Q200 F1.\nG00 X60.\nM30\n";
    assert!(under_g96(fanuc, &machine)[1].1 > 3);
}

/// A chain is one pass: its later legs begin at another X, and keep the speed of the first. The next one has
/// its own again.
#[test]
fn a_chain_keeps_the_speed_of_its_first_leg() {
    let chain = "G33 X12.5 Z-15 K2\nG33 Z-30 K2\nG33 X14 Z-40 K2\nG33 Z-50 K2\nG0 X18\n";
    let source = format!("G18 G21 G90\nG96 S60 D1200 M3\nG0 X8.5 Z8\n{chain}G0 Z8\nG0 X9\n{chain}M5\nM2\n");
    let speeds = under_g96(&source, &Machine::plain());
    let threads: Vec<_> = speeds.iter().filter(|(_, passes)| *passes > 0).collect();
    let rpm_at = |radius: f64| 1000.0 * 60.0 / (std::f64::consts::TAU * radius);
    let [(SpindleSpeed::Rpm(first), 1), (SpindleSpeed::Rpm(second), 1)] = threads[..] else {
        panic!("two chains, each of one pass: {speeds:?}")
    };
    assert!((first - rpm_at(8.5)).abs() < 1e-6 && (second - rpm_at(9.0)).abs() < 1e-6, "{speeds:?}");
}

#[test]
fn fanuc_programs_say_it_with_g50() {
    let mut machine = Machine::plain();
    machine.general.dialect = machine::ProgramDialect::Fanuc;
    let source =
        "G50 S1200\nG96 S150 M03\nG00 X40. Z2.\nG50 S900\nG01 Z0. F0.2\nG97 S500\nG61 G01 Z-1.\nM30\n";
    let check = check("O1", source, &machine);
    assert!(check.diagnostics.is_empty(), "{:?}", check.diagnostics);
    let spindle = |item: &protocol::Item| match item.code {
        Code::Spindle { speed, .. } => Some((item.line, speed)),
        _ => None,
    };
    let speeds: Vec<_> = check.items.iter().filter_map(spindle).collect();
    assert_eq!((speeds[0].0, surface(speeds[0].1)), (2, [2500.0, 1200.0, 0.0]));
    assert_eq!((speeds[1].0, surface(speeds[1].1)), (4, [2500.0, 900.0, 0.0]));
    assert_eq!(speeds[2], (6, SpindleSpeed::Rpm(500.0)));
    let stop = Code::PathMode(protocol::PathMode::ExactStop);
    assert!(check.items.iter().any(|item| item.line == 7 && item.code == stop));
}

/// What the threading macros of controls with a button for it ask for: an own state (M73), a tool by its
/// number, G76 under G96 with words that are computed, a lead in threads per inch, a taper at the end.
#[test]
fn a_threading_macro_is_cut() {
    let text = "o<thread> sub\nM73\nG7 G18 G21 G90\nM6 T#3 G43\n#14=[#<_x> * 2] #13=#<_z>\n\
                o90 if [#4 LT 0]\n#4=ABS[25.4 / #4]\no90 endif\n#<minor>=[#1 - 1.2 * #4]\n\
                G96 D600 S#2\nM3\nG95 F0.25\nG4 P1\n\
                G0 X[#1 + 4] Z#13\nG76 P#4 Z#5 I-2 J0.2 K[#1 - #<minor>] R1.5 Q29.5 H1 E[2 * #4] L2\n\
                G0 X#14\nG0 Z#13\nM5\no<thread> endsub\n\
                S300 M3\nG7 G18 G0 X60 Z8\no<thread> call [30] [40] [3] [-16] [-20]\nM2\n";
    let checked = check("thread.ngc", text, &Machine::plain());
    let said: Vec<_> = checked.diagnostics.iter().map(|one| (one.line, one.code)).collect();
    let told = [(4, "unknown-tool"), (15, "constant-surface-thread"), (15, "thin-chip")];
    assert_eq!(said, told, "there is no tool table, and 0.1 n^(1/1.5) ends with less than 0.025 mm");
    let depths: Vec<f64> = checked.passes.iter().filter_map(|pass| pass.depth_mm).collect();
    let height = 0.6 * 25.4 / 16.0;
    assert!(depths.len() > 5 && (depths[0] - 0.1).abs() < 1e-6, "J is a diameter: {depths:?}");
    assert!(depths.iter().rev().take(2).all(|depth| (depth - height).abs() < 1e-6), "{depths:?}");
}
