//! A smaller sweep: what is held, and what is not.

use machine::Machine;

use super::{Condition, MEDIAN_UM, PASSES, Row, WORST_UM, rows, tables::Over, with_finer_encoder};
use crate::stand::Stand;

/// Two of the hardest passes and two gentler ones under beliefs that are wrong in every direction.
fn small(machine: Machine) -> Vec<Row> {
    let stand = Stand { machine, seed: 1, progress: false };
    let conditions = Condition::all(&[120.0, 60.0], &[-15.0, 15.0], &[-40.0, 40.0], &[1]);
    rows(&stand, &conditions, &[PASSES[0], PASSES[1], PASSES[5], PASSES[9]]).expect("every pass can be cut")
}

#[test]
fn wrong_beliefs_cost_little() {
    let rows = small(with_finer_encoder(&Machine::plain()));
    assert_eq!(rows.len(), 2 * 2 * 2 * 4);
    let all = Over::all(&rows);
    assert!(all.median <= MEDIAN_UM, "median {} µm", all.median);
    assert!(all.worst <= WORST_UM, "worst {} µm", all.worst);
    assert!(rows.iter().all(|row| row.approach_max_abs_um > 0.05), "no approach is without any error");
}

/// With the encoder that the machine has, the one pass in which X moves 22 mm a turn goes beyond what is
/// asked for.
#[test]
fn the_encoder_shows_where_x_moves_far_in_a_turn() {
    let (far, near): (Vec<Row>, Vec<Row>) =
        small(Machine::plain()).into_iter().partition(|row| row.delta_x_mm == 10.0);
    assert!(Over::all(&near).worst <= WORST_UM, "{} µm", Over::all(&near).worst);
    assert!(Over::all(&far).worst <= 3.0, "{} µm", Over::all(&far).worst);
}

/// What a wrong mass leaves at the end has its sign.
#[test]
fn a_wrong_mass_shows_at_the_end() {
    for row in small(Machine::plain())
        .iter()
        .filter(|row| row.override_pct == 120.0 && row.peak_acceleration() > 1000.0)
    {
        assert!(row.end_um * row.mass_error_pct < 0.0, "{row:?}");
    }
}

#[test]
fn every_pass_can_be_followed_at_the_highest_override() {
    let machine = Machine::plain();
    for [s_rpm, delta_x_mm, delta_c_deg] in PASSES {
        let trial = rig::trial::Trial { s_rpm, delta_x_mm, delta_c_deg, ..Default::default() };
        let pass = trial.pass(&machine, 1).expect("it can be followed at the programmed speed");
        assert!(pass.max_ratio >= 1.2 - 1e-9, "{trial:?}: {}", pass.max_ratio);
    }
}
