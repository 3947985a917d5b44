//! Random threads that are no single helix: chains, leads by a table, arcs, rigid taps. In: a seed. Out: a
//! machine, blocks of a program, what it is made of. Limits, ends and reports are judged; a groove has only
//! what has one lead.

use core::fmt::Write as _;

use machine::ProgramDialect;
use testing::Seed;

use super::lathe::Drawn;
use super::machines;
use super::thread::round;

const HEAD: &str = "G18 G21 G90 G8 G94 G97\n";

/// A speed, and the way in which Z gets to a lead of 2.5 mm at it, with some to spare.
fn speed(seed: &mut Seed) -> (f64, f64) {
    let s_rpm = seed.scale(50.0, 1000.0).round();
    let v = 2.5 * s_rpm / 60.0;
    (s_rpm, v * (v / 1000.0 + 0.06) + 1.0)
}

/// A cylinder, a cone and a cylinder of other leads; or one thread with its leads by a table.
pub(super) fn chain(seed: &mut Seed) -> Drawn {
    let (s_rpm, run) = speed(seed);
    let leads = [0, 1, 2].map(|_| round(seed.between(0.6, 2.5)));
    let lengths = [0, 1, 2].map(|_| round(run * (1.5 + seed.unit())));
    let [a, b, c] = [lengths[0], lengths[0] + lengths[1], lengths[0] + lengths[1] + lengths[2]];
    let (x, z) = (round(seed.between(12.0, 18.0)), round(run));
    let machine = machines::lathe(seed, x + 8.0, z);
    let mut pass = format!("G0 X{:.3}\nG0 Z{z:.3}\nG0 X{x:.3}\n", x + 8.0);
    let tabled = seed.chance(0.5);
    let _ = match tabled {
        true => writeln!(
            pass,
            "(lead_table, Z{:.3} K{}, Z{:.3} K{}, Z{:.3} K{})\nG33 Z{:.3} K{}\n(lead_table, off)",
            z - 0.3 * a,
            leads[0],
            z - a,
            leads[1],
            z - b,
            leads[2],
            z - c,
            leads[0]
        ),
        false => {
            let up = round(seed.signed() * 0.15 * lengths[1]);
            let along = leads[1] * libm::hypot(up, lengths[1]) / lengths[1];
            writeln!(
                pass,
                "G33 Z{:.3} K{}\nG33 X{:.3} Z{:.3} K{along:.6}\nG33 Z{:.3} K{}",
                z - a,
                leads[0],
                x + up,
                z - b,
                z - c,
                leads[2]
            )
        }
    };
    let _ = writeln!(pass, "G0 X{:.3}\nG0 Z{z:.3}", x + 8.0);
    let turn = if seed.chance(0.3) { "M4" } else { "M3" };
    let blocks = vec![format!("{HEAD}{turn} S{s_rpm}\n"), pass, "M5\nM2\n".into()];
    (machine, blocks, vec![if tabled { "g33-lead-table" } else { "g33-chain" }])
}

/// A barrel or a hollow of the other dialect, which writes diameters.
pub(super) fn arc(seed: &mut Seed) -> Drawn {
    let (s_rpm, run) = speed(seed);
    let lead = round(seed.between(0.6, 2.5));
    let length = run * (3.0 + 2.0 * seed.unit());
    let radius = length * seed.between(1.5, 5.0);
    let (x, z) = (round(seed.between(12.0, 18.0)), round(run));
    let mut machine = machines::lathe(seed, x + 14.0, z);
    machine.general.dialect = ProgramDialect::Fanuc;
    let word = if seed.chance(0.5) { "G36" } else { "G35" };
    let blocks = vec![
        format!("G97 S{s_rpm} M03\nG00 X{:.3} Z{z:.3}\n", 2.0 * (x + 14.0)),
        format!(
            "G00 X{:.3}\n{word} X{:.3} Z{:.3} R{radius:.3} F{lead:.3}\nG00 X{:.3}\nG00 Z{z:.3}\n",
            2.0 * x,
            2.0 * (x + seed.signed() * 0.1 * length),
            z - length,
            2.0 * (x + 14.0)
        ),
        "M05\nM30\n".into(),
    ];
    (machine, blocks, vec!["g35-arc"])
}

/// A rigid tap, right-hand or left-hand, out up to twice as fast.
pub(super) fn tap(seed: &mut Seed) -> Drawn {
    let s_rpm = seed.scale(50.0, 1500.0).round();
    let lead = round(seed.between(0.4, 2.0));
    let start = round(2.0 + 3.0 * lead + lead * s_rpm / 60.0 * 0.1);
    let depth = round(lead * seed.between(2.0, 10.0));
    let machine = machines::lathe(seed, 20.0, start + 10.0);
    let turn = if seed.chance(0.4) { "M4" } else { "M3" };
    let faster = if seed.chance(0.4) { format!(" I{:.2}", seed.between(1.0, 2.0)) } else { String::new() };
    let blocks = vec![
        format!("{HEAD}{turn} S{s_rpm}\nG0 X0\nG0 Z{start:.3}\n"),
        format!("G33.1 Z{:.3} K{lead}{faster}\n", -depth),
        format!("G0 Z{:.3}\nM5\nM2\n", start + 5.0),
    ];
    (machine, blocks, vec!["g33.1-tap"])
}
