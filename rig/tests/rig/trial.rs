//! Trial passes: the machine accepts them, and they are the laws that were asked for.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::Axis;
use rig::{
    observe::Outcome,
    trial::{Trial, TrialError, program, run},
};
use sim_plant::Scenario;

/// Passes that differ in everything, both directions of the spindle and of each axis among them.
fn trials() -> [Trial; 4] {
    let plain = Trial::default();
    [
        plain,
        Trial { delta_x_mm: -5.0, lead_mm: 2.0, turns: 3.0, ..plain },
        Trial { s_rpm: 600.0, direction: -1.0, delta_x_mm: 3.0, delta_c_deg: 540.0, ..plain },
        Trial { s_rpm: 200.0, delta_x_mm: 0.0, delta_c_deg: 180.0, turns: 0.5, ..plain },
    ]
}

#[test]
fn trials_are_cut_as_asked() {
    let (machine, trials) = (Machine::plain(), trials());
    let items = program(&machine, &trials).unwrap();
    assert!(items.iter().all(|item| item.check().is_ok()));
    let mut cycles = 0;
    let seen = run(&machine, &items, &Scenario::none(), 3, &mut |_| cycles += 1).unwrap();
    assert_eq!((seen.outcome, cycles), (Outcome::Completed, seen.cycles), "{:?}", seen.faults);
    assert_eq!(seen.passes.len(), trials.len());
    for (pass, trial) in seen.passes.iter().zip(&trials) {
        assert!(pass.complete && pass.same_index, "{pass:#?}");
        assert_eq!((pass.programmed_rpm, pass.direction), (trial.s_rpm, trial.direction));
        assert_eq!((pass.delta_x_mm, pass.lead_mm), (trial.delta_x_mm, trial.lead_mm));
        let [begins, locked, leaves, _] = pass.x_moments_deg;
        if trial.delta_x_mm != 0.0 {
            assert!((locked - begins - trial.delta_c_deg).abs() < 1e-9, "{pass:#?}");
            assert!((leaves - locked - 360.0 * trial.turns).abs() < 1e-9, "{pass:#?}");
        }
        assert_eq!(leaves, pass.z_moments_deg[2]);
        assert!(pass.helix_max_abs_um < 3.0 && pass.phase_um.abs() < 1.0, "{pass:#?}");
    }
}

/// The longest way that fits begins at one end of the travel and ends at the other.
#[test]
fn a_trial_moves_away_from_home_where_it_must() {
    let mut machine = Machine::plain();
    let x = machine.axis.get_mut(&Axis::X).unwrap();
    (x.home_mm, x.travel_mm) = (118.0, [110.0, 120.0]);
    let start = |machine: &Machine, delta_x_mm: f64| {
        let trial = Trial { delta_x_mm, delta_c_deg: 720.0, ..Trial::default() };
        trial.pass(machine, 1).map(|pass| pass.axis(Axis::X).start.mm())
    };
    assert_eq!(start(&machine, -5.0), Ok(118.0));
    assert_eq!(start(&machine, 5.0), Ok(115.0));
    assert_eq!(start(&machine, -10.0), Ok(120.0));
    assert_eq!(
        start(&machine, 11.0),
        Err(TrialError::Travel { axis: Axis::X, needed_mm: 11.0, travel_mm: 10.0 })
    );
}

/// 5.1 − 5 is a little less than 0.1: by rounding, no place is left where the axis may begin.
#[test]
fn a_way_as_long_as_the_travel_fits() {
    let mut machine = Machine::plain();
    let x = machine.axis.get_mut(&Axis::X).unwrap();
    (x.home_mm, x.travel_mm) = (2.0, [0.1, 5.1]);
    let pass = Trial::default().pass(&machine, 1).unwrap();
    assert_eq!(pass.axis(Axis::X).start.mm(), 0.1);
}

#[test]
fn what_cannot_be_is_refused() {
    let machine = Machine::plain();
    let refused = |trial: Trial| program(&machine, &[trial]).unwrap_err();
    let plain = Trial::default();
    for bad in [
        Trial { s_rpm: 0.0, ..plain },
        Trial { s_rpm: f64::NAN, ..plain },
        Trial { direction: 0.5, ..plain },
        Trial { delta_c_deg: 0.0, ..plain },
        Trial { turns: -1.0, ..plain },
        Trial { lead_mm: f64::INFINITY, ..plain },
        Trial { delta_x_mm: f64::NAN, ..plain },
    ] {
        assert!(matches!(refused(bad), TrialError::Value { .. }), "{bad:?}");
    }
    let fast = refused(Trial { delta_c_deg: 90.0, ..plain });
    assert!(matches!(fast, TrialError::TooFast { axis: Axis::X, most_pct } if most_pct < 100.0), "{fast}");
    assert!(matches!(refused(Trial { turns: 200.0, ..plain }), TrialError::Travel { axis: Axis::Z, .. }));
    let mill = Machine::from_toml(machine::SMALL_MILL).unwrap();
    let on_a_mill = program(&mill, &[plain]).map(|items| mill.can_follow(&pass_of(&items)));
    assert_ne!(on_a_mill, Ok(true), "a mill cuts no threads");
}

fn pass_of(items: &[protocol::Item]) -> protocol::ThreadPass {
    let pass = items.iter().find_map(|item| match item.code {
        protocol::Code::Pass(pass) => Some(pass),
        _ => None,
    });
    pass.unwrap()
}

/// The override changes how fast a pass is made, and nothing else of it.
#[test]
fn the_override_stands_from_the_start() {
    let machine = Machine::plain();
    let items = program(&machine, &[Trial::default()]).unwrap();
    for pct in [120.0, 100.0, 40.0] {
        let seen = run(&machine, &items, &Scenario::spindle_override(pct), 1, &mut |_| ()).unwrap();
        let pass = &seen.passes[0];
        assert_eq!((pass.override_min_pct, pass.override_max_pct), (pct, pct));
        assert!((pass.rpm_min - 3.0 * pct).abs() < 0.02 * 3.0 * pct, "{pass:#?}");
        assert!((pass.x_moments_deg[0] - 10.8).abs() < 1e-9, "{pass:#?}");
    }
}
