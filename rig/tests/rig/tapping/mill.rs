//! Taps of a mill, both ways of writing them.

use machine::{Machine, ProgramDialect, SMALL_MILL};
use protocol::Axis;

use super::*;

/// Two holes in three pecks by FANUC, and two by LinuxCNC's G84, ten seeds: every tap is on its helix, and no
/// deeper than it was told.
#[test]
fn a_mill_taps_within_five_micrometres_in_pecks_too() {
    let mut machine = Machine::from_toml(SMALL_MILL).expect("the built-in mill");
    let [x, y, z] = [Axis::X, Axis::Y, Axis::Z].map(|axis| machine.axis[&axis].home_mm);
    let of = |machine: &Machine, program: &str, taps: usize| {
        let items = compiled(machine, program);
        let mut told = Vec::new();
        for seed in 1..=10 {
            let stand = crate::stand::Stand { machine, items: &items, scenario: "", seed };
            let observation = stand.run(|_| None);
            assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
            told.extend(observation.passes.iter().filter_map(|pass| pass.tap));
            assert_eq!(told.len(), taps * seed as usize, "every peck is told");
        }
        let off = |of: fn(&rig::observe::TapReport) -> f64| told.iter().map(of).fold(0.0, f64::max);
        let most =
            [off(|tap| tap.in_um), off(|tap| tap.turn_um), off(|tap| tap.out_um), off(|tap| tap.short_um)];
        println!("in, turn, out, short: {most:.2?} µm");
        assert!(most[..3].iter().all(|um| *um <= 5.0) && most[3] < 50.0, "{most:?}");
        assert!(told.iter().all(|tap| tap.short_um > 0.0), "{told:?}");
    };
    let holes = format!("X{:.3} Y{:.3} Z{:.3} R{:.3}", x + 10.0, y + 5.0, z - 35.0, z - 20.0);
    let linuxcnc = format!("G17 G21 G90 G94 G98\nS600 M3\nF600 G84 {holes}\nX{:.3}\nG80\nM5\nM2\n", x + 20.0);
    of(&machine, &linuxcnc, 2);
    machine.general.dialect = ProgramDialect::Fanuc;
    let fanuc =
        format!("G17 G21 G90 G94 G98\nM29 S600\nG84 {holes} Q6. F600.\nX{:.3}\nG80\nM05\nM30\n", x + 20.0);
    of(&machine, &fanuc, 6);
}
