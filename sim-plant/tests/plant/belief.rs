//! What the built-in machine file says of itself: mass 5 % low, friction 20 % low.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::Axis;
use sim_plant::Belief;

#[test]
fn the_built_in_machine_is_a_little_wrong() {
    let machine = Machine::plain();
    for axis in [Axis::X, Axis::Z] {
        let config = &machine.axis[&axis];
        let mut wrong = config.clone();
        Belief::of_truth(&machine, axis).unwrap().off_by(-0.05, -0.2).put_into(&mut wrong);
        assert!((wrong.mass_kg / config.mass_kg - 1.0).abs() < 1e-3, "{} kg", wrong.mass_kg);
        assert!((wrong.coulomb_n - config.coulomb_n).abs() < 1e-9);
        assert!((wrong.presliding_n_mm - config.presliding_n_mm).abs() < 1e-9);
        assert!((wrong.viscous_n_s_mm - config.viscous_n_s_mm).abs() < 1e-9);
    }
}

#[test]
fn a_missing_axis_is_named() {
    let error = Belief::of_truth(&Machine::plain(), Axis::B).unwrap_err();
    assert!(error.to_string().contains("[axis.b]"), "{error}");
}
