//! Random programs without a thread: a mill, with work from formulas, and a positioner. In: a seed. Out: a
//! machine, blocks of a program, what it is made of.

use core::fmt::Write as _;

use testing::Seed;

use super::lathe::Drawn;
use super::machines;

pub(super) fn mill(seed: &mut Seed) -> Drawn {
    let machine = machines::mill(seed);
    let s_rpm = seed.scale(500.0, 3000.0).round();
    let feed = seed.scale(1500.0, 8000.0).round();
    let mode = seed.of(&["G64 P0.01", "G64 P0.1", "G61", "G61.1"]);
    let z = machine.axis.get(&protocol::Axis::Z).map_or(0.0, |z| z.home_mm);
    let mut blocks = vec![format!("G17 G21 G90 G94\n{mode}\nM3 S{s_rpm}\nF{feed}\nG0 X0 Y0\n")];
    let mut kinds = vec!["timed-motion"];
    for _ in 0..1 + seed.below(4) {
        let at = |seed: &mut Seed| [seed.signed() * 25.0, seed.signed() * 25.0];
        let [x, y] = at(seed);
        let radius = seed.between(1.0, 8.0);
        blocks.push(match seed.below(6) {
            0 => format!("G0 X{x:.3} Y{y:.3} Z{:.3}\n", z - seed.between(0.0, 10.0)),
            1 => format!("G91\nG3 I{radius:.3} Z{:.3}\nG90\n", -seed.between(0.1, 2.0)),
            2 => format!("G91\nG2 X{radius:.3} Y{:.3} I{radius:.3}\nG90\n", -radius),
            3 => short_lines(seed),
            _ => format!("G1 X{x:.3} Y{y:.3}\n"),
        });
    }
    match seed.below(12) {
        0 => {
            kinds.push("formula");
            blocks.push(format!(
                "G10 L2 P1 X0 Y0 Z{:.3}\nG54\nG0 Z10\nG0 X0 Y0\n;@ kind = \"contour\"\n;@ y = \"{:.2}*sin(x/{:.2})\"\n\
                 ;@ x = [0, {:.2}]\n;@ depth_z_mm = -1\n;@ tool = {{ diameter_mm = 4, side = \"left\" }}\n",
                z - 20.0,
                seed.between(0.5, 2.0),
                seed.between(6.0, 12.0),
                seed.between(4.0, 12.0),
            ));
        }
        1 => {
            kinds.push("drilling");
            blocks.push(format!(
                "G98 G83 X{:.2} Y{:.2} Z{:.2} R{:.2} Q2\nG80\n",
                seed.signed() * 10.0,
                seed.signed() * 10.0,
                z - 8.0,
                z - 2.0
            ));
        }
        _ => {}
    }
    blocks.push("M5\nM2\n".into());
    (machine, blocks, kinds)
}

/// A circle in short lines, as CAM writes it.
fn short_lines(seed: &mut Seed) -> String {
    let (radius, count) = (seed.between(3.0, 10.0), 10 + seed.below(60));
    let mut text = String::new();
    for i in 0..=count {
        let angle = core::f64::consts::TAU * i as f64 / count as f64;
        let _ = writeln!(text, "G1 X{:.3} Y{:.3}", radius * libm::cos(angle), radius * libm::sin(angle));
    }
    text
}

pub(super) fn positioner(seed: &mut Seed) -> Drawn {
    let machine = machines::positioner(seed);
    let mut blocks = vec![format!("G17 G21 G90 G94\nG64 P0.05\nF{:.0}\n", seed.scale(300.0, 3000.0))];
    for _ in 0..1 + seed.below(4) {
        let mut text = String::from(if seed.chance(0.3) { "G0" } else { "G1" });
        for (name, reach) in [("X", 8.0), ("Y", 8.0), ("A", 10.0), ("C", 20.0)] {
            if seed.chance(0.7) {
                let _ = write!(text, " {name}{:.3}", reach * seed.signed());
            }
        }
        text.push('\n');
        if text.len() > 3 {
            blocks.push(text);
        }
    }
    blocks.push("M2\n".into());
    (machine, blocks, vec!["positioner"])
}
