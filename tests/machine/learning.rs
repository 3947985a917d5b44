//! What comes back with every turn of a motor is learned from pass to pass: the same threads, seen at the
//! tool, of motors that cog, with learning and without.

use std::f64::consts::TAU;

use machine::PLAIN_LATHE;
use protocol::{Axis, AxisState};

use crate::shop::{EXAMPLES, Place, example};

/// How often a turn of 5 mm the motors cog.
const PER_TURN: f64 = 24.0;

/// Amplitude of what comes back so often a turn in the way of the slide beside the helix, pass by pass, µm.
fn amplitudes(place: &Place, program: &str, learning: bool) -> Vec<f64> {
    let machine = PLAIN_LATHE
        .replace("mode_damping = 0.03", "mode_damping = 0.03\ncogging_nm = 0.05\ncogging_per_rev = 24")
        .replace("in_position_mm = 0.002", &format!("learning = {learning}\nin_position_mm = 0.002"));
    let file = place.write("cogging.toml", machine).display().to_string();
    place.run(&example(program), "run", &["--in-process", "--trace", "mcap", "--machine", &file]);
    let mut sums: Vec<[f64; 3]> = Vec::new();
    rig::trace::read(&place.at("run/trace.mcap"), |row| {
        let Some(z) = row.axis(Axis::Z).filter(|z| z.state == AxisState::Locked && row.pass > 0) else {
            return;
        };
        sums.resize(sums.len().max(row.pass as usize), [0.0; 3]);
        let (sin, cos) = libm::sincos(TAU * PER_TURN * z.true_mm / 5.0);
        let off = 1e3 * (z.slide - z.programmed);
        let sum = &mut sums[row.pass as usize - 1];
        *sum = [sum[0] + off * cos, sum[1] + off * sin, sum[2] + 0.5];
    })
    .expect("the trace can be read");
    std::fs::remove_dir_all(place.at("run")).expect("the run left its folder");
    sums.iter().map(|[cos, sin, half]| (cos * cos + sin * sin).sqrt() / half).collect()
}

#[test]
fn cogging_is_a_fifth_within_three_passes_and_stays_so() {
    let place = Place::new();
    for program in EXAMPLES {
        let (without, with) = (amplitudes(&place, program, false), amplitudes(&place, program, true));
        assert!(without.len() > 5 && without.iter().all(|um| *um > 0.5), "{program}: {without:?}");
        for (pass, (without, with)) in without.iter().zip(&with).enumerate().skip(2) {
            assert!(with * 5.0 < *without, "{program}, pass {}: {with} µm, {without} µm without", pass + 1);
        }
    }
}
