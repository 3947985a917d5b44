//! Random programs of a lathe: threads with timed motion around them, timed motion alone, roughing, the other
//! dialect. In: a seed. Out: a machine, blocks of a program, what it is made of.

use core::fmt::Write as _;

use machine::{Machine, ProgramDialect};
use testing::Seed;

use super::machines;
use super::thread::{Thread, round};

/// What is drawn: a machine, a program in blocks, its kinds.
pub(super) type Drawn = (Machine, Vec<String>, Vec<&'static str>);

const HEAD: &str = "G18 G21 G90 G8 G94 G97\n";
const END: &str = "M5\nM2\n";

pub(super) fn thread(seed: &mut Seed) -> Drawn {
    let thread = Thread::draw(seed);
    let (x, z) = (thread.drive_line(), thread.before());
    let away = thread.before() - thread.towards * (thread.lead + 1.0);
    let machine = machines::lathe(seed, round(x + thread.outward), round(away));
    let turn = if thread.reverse { "M4" } else { "M3" };
    let mut blocks = vec![format!("{HEAD}{turn} S{}\n", thread.s_rpm)];
    let mut kinds = vec![];
    // Timed motion stays where there is no material: before the face, and off the crest.
    if seed.chance(0.3) {
        blocks.push(beside(seed, x, away, thread.towards));
        kinds.push("timed-motion");
    }
    let (passes, kind) = thread.blocks(seed);
    blocks.extend(passes);
    kinds.push(kind);
    if seed.chance(0.3) {
        blocks.push(format!("G0 X{x:.4}\nG0 Z{z:.4}\n"));
        blocks.push(beside(seed, x, away, thread.towards));
        kinds.push("timed-motion");
    }
    blocks.push(END.into());
    (machine, blocks, kinds)
}

/// Lines, arcs and a dwell in front of the part.
fn beside(seed: &mut Seed, x: f64, z: f64, towards: f64) -> String {
    let mut text = format!("G0 X{x:.4}\nG0 Z{z:.4}\n{}\n", mode(seed));
    let feed = seed.scale(600.0, 4000.0).round();
    for _ in 0..1 + seed.below(4) {
        let (to_x, to_z) = (x + seed.signed() * 3.0, z - towards * seed.between(0.0, 8.0));
        let _ = match seed.below(4) {
            0 => writeln!(text, "G0 X{to_x:.3} Z{to_z:.3}"),
            3 => writeln!(text, "G4 P{:.3}", seed.between(0.01, 0.1)),
            _ => writeln!(text, "G1 X{to_x:.3} Z{to_z:.3} F{feed}"),
        };
    }
    let _ = writeln!(text, "G0 Z{z:.4}\nG0 X{x:.4}\nG64");
    text
}

fn mode(seed: &mut Seed) -> &'static str {
    seed.of(&["G64 P0.01", "G64 P0.1", "G64", "G61", "G61.1"])
}

/// A contour of lines and arcs, with feeds by the minute or by the revolution.
pub(super) fn timed(seed: &mut Seed) -> Drawn {
    let machine = machines::lathe(seed, 22.0, 10.0);
    let s_rpm = seed.scale(200.0, 2500.0).round();
    let mut blocks = vec![format!("{HEAD}{}\nM3 S{s_rpm}\n", mode(seed))];
    let by_revolution = seed.chance(0.3);
    let feed = seed.scale(600.0, 5000.0);
    let word = if by_revolution { format!("G95 F{:.4}", feed / s_rpm) } else { format!("F{feed:.0}") };
    blocks.push(format!("{word}\nG0 X20 Z2\n"));
    for _ in 0..2 + seed.below(5) {
        let (x, z) = (seed.between(14.0, 30.0), seed.between(-14.0, 6.0));
        let radius = seed.between(1.0, 5.0);
        blocks.push(match seed.below(7) {
            0 => format!("G0 X{x:.3} Z{z:.3}\n"),
            1 => format!("G91\nG2 X{radius:.3} Z{:.3} I{radius:.3}\nG90\n", -radius),
            2 => format!("G91\nG3 X{:.3} Z{radius:.3} K{radius:.3}\nG90\n", -radius),
            3 => format!("G4 P{:.3}\n", seed.between(0.005, 0.1)),
            _ => format!("G1 X{x:.3} Z{z:.3}\n"),
        });
    }
    blocks.push(END.into());
    (machine, blocks, vec!["timed-motion"])
}

/// G71 around a contour with a fillet.
pub(super) fn roughing(seed: &mut Seed) -> Drawn {
    let machine = machines::lathe(seed, 18.0, 6.0);
    let s_rpm = seed.scale(300.0, 2000.0).round();
    let (x, z) = (seed.between(8.0, 12.0), seed.between(-8.0, -4.0));
    let feed = seed.scale(1500.0, 5000.0).round();
    let contour = format!(
        "o100 sub\n  G1 X{x:.3} Z2\n  Z{z:.3} A1\n  X{:.3}\n  Z{:.3}\n  X17\no100 endsub\n",
        x + 3.0,
        z - 3.0
    );
    let blocks = vec![
        format!("{HEAD}{}\nM3 S{s_rpm}\nF{feed}\nG0 X17 Z3\n", mode(seed)),
        format!("{contour}G71 Q100 I{:.2} R0.5\n", seed.between(2.0, 4.0)),
        END.into(),
    ];
    (machine, blocks, vec!["roughing"])
}

/// G92 and G76 of the other dialect, which writes diameters.
pub(super) fn fanuc(seed: &mut Seed) -> Drawn {
    let thread = Thread { outward: 1.0, towards: -1.0, reverse: false, ..Thread::draw(seed) };
    let (x, z) = (thread.drive_line(), thread.before());
    let mut machine = machines::lathe(seed, x, z);
    machine.general.dialect = ProgramDialect::Fanuc;
    let (dx, lead, end) = (2.0 * x, thread.lead, thread.end());
    let cuts: String = match seed.chance(0.5) {
        true => {
            let to = |share: f64| 2.0 * (thread.crest - share * thread.height);
            let taper =
                if seed.chance(0.4) { format!(" R{:.3}", -seed.between(0.1, 0.6)) } else { String::new() };
            format!("G92 X{:.3} Z{end:.3}{taper} F{lead:.3}\nX{:.3}\n", to(0.6), to(1.0))
        }
        false => {
            let (p, q) = ((1000.0 * thread.height).round(), (600.0 * thread.height).round());
            let root = 2.0 * (thread.crest - thread.height);
            format!(
                "G76 P01{:02}60 Q50 R0.03\nG76 X{root:.3} Z{end:.3} P{p} Q{q} F{lead:.3}\n",
                seed.below(12)
            )
        }
    };
    let blocks = vec![
        format!("G97 S{} M03\nG00 X{dx:.3} Z{z:.3}\n", thread.s_rpm),
        cuts,
        format!("G00 X{dx:.3}\nM05\nM30\n"),
    ];
    (machine, blocks, vec!["fanuc-thread"])
}
