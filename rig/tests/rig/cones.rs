//! Cones that are left on the way in and in the thread. A tool that lifts for a long way goes on as fast as
//! the cone rises; where it has not reached the part yet, Z stands in front of it. An outside observer knows
//! the cone from the same program undisturbed.

use machine::Machine;
use protocol::{Axis, AxisState};

use crate::stand::{Stand, compiled};

/// From X 0.5 or 10 at Z 9.5 over 36 mm, 3.53 mm along Z a turn, on X by the slope.
const CONES: [(f64, f64, f64); 5] =
    [(0.5, 0.3, 708.0), (0.5, 1.0, 708.0), (0.5, 2.25, 708.0), (0.5, 2.25, 300.0), (40.0, -0.9, 708.0)];
const LENGTH_MM: f64 = 35.6;
/// What the servo is off at the slide, and what is allowed beside it, mm: on the steepest cone a count of the
/// spindle moves X by 0.8 µm, and one of them may be rounding.
const TOLERANCE_MM: f64 = 0.0128;

fn program((from, slope, rpm): (f64, f64, f64)) -> String {
    let (to, lead) = (from + slope * LENGTH_MM, 3.53 * (1.0 + slope * slope).sqrt());
    let clear = from.max(to) + 4.0;
    format!(
        "G18 G21 G90 G8 G94 G97\nM3 S{rpm}\nG0 X{clear:.4} Z9.5\nG0 X{from:.4}\n\
         G33 X{to:.4} Z{:.4} K{lead:.6}\nG0 X{clear:.4}\nG0 Z9.5\nM5\nM2\n",
        9.5 - LENGTH_MM
    )
}

/// What was seen of a cycle: where the slides are, and what X does.
type Seen = (u64, [f64; 2], AxisState);

fn run(machine: &Machine, program: &str, scenario: &str) -> Vec<Seen> {
    let items = compiled(machine, program);
    let mut seen = Vec::new();
    Stand { machine, items: &items, scenario, seed: 1 }.run(|record| {
        let slides = [Axis::X, Axis::Z].map(|axis| record.truth.axes[axis.index()].slide_mm);
        seen.push((record.truth.cycle.0, slides, record.axes[0].1.state()));
        None
    });
    seen
}

#[test]
fn a_cone_is_left_from_its_run_in_and_its_thread_without_cutting_into_it() {
    let mut machine = Machine::plain();
    machine.axis.get_mut(&Axis::X).into_iter().for_each(|x| x.home_mm = 90.0);
    for cone in CONES {
        let program = program(cone);
        let whole = run(&machine, &program, "");
        let cut: Vec<[f64; 2]> =
            whole.iter().filter(|seen| seen.2 == AxisState::Locked).map(|seen| seen.1).collect();
        let (first, last) = (cut[0], cut[cut.len() - 1]);
        // Z falls: the cone at a place.
        let cone_at = |z: f64| {
            let i = cut.partition_point(|at| at[1] > z).clamp(1, cut.len() - 1);
            let ([x0, z0], [x1, z1]) = (cut[i - 1], cut[i]);
            x0 + (z - z0) / (z1 - z0) * (x1 - x0)
        };
        let stages = [AxisState::WaitingForC0, AxisState::RunIn];
        let of = |stage: AxisState| whole.iter().filter(move |seen| seen.2 == stage).map(|seen| seen.0);
        let way_in = stages.into_iter().flat_map(of).step_by(9);
        let moments: Vec<u64> = way_in.chain(of(AxisState::Locked).step_by(97)).collect();
        assert!(moments.len() > 15, "{} moments", moments.len());
        for at in moments {
            let scenario = format!("[[event]]\nat = {{ cycle = {at} }}\nemergency_stop = true\n");
            let (mut leaves, mut end) = (false, 0.0);
            for (cycle, [x, z], state) in run(&machine, &program, &scenario) {
                leaves |= state == AxisState::Leaving;
                end = x;
                if leaves && (last[1]..first[1]).contains(&z) {
                    let deeper = cone_at(z) - x;
                    assert!(
                        deeper <= TOLERANCE_MM,
                        "{cone:?}, stopped in {at}: {deeper} mm too deep in {cycle}, Z {z}"
                    );
                }
            }
            // Who had only armed stays in front of the part.
            assert!(
                !leaves || end > first[0].max(last[0]) + 3.0,
                "{cone:?}, stopped in {at}: X ends at {end}"
            );
        }
    }
}
