//! The drive train alone: what it does is known in closed form, or from its twin.

use super::*;

const CYCLE_S: f64 = 0.0005;

fn frictionless() -> AxisTrain {
    AxisTrain {
        screw_coulomb_n: 0.0,
        screw_viscous_n_s_mm: 0.0,
        slide_coulomb_n: 0.0,
        slide_static_n: 0.0,
        slide_viscous_n_s_mm: 0.0,
        ..AxisTrain::default()
    }
}

fn of_x(train: &AxisTrain) -> Result<DriveTrain, PlantError> {
    let x = machine::Machine::plain().axis[&Axis::X].clone();
    DriveTrain::new(train, Axis::X, &train.facts(&x), CYCLE_S, &mut Seed(1))
}

fn built(train: &AxisTrain) -> DriveTrain {
    of_x(train).unwrap()
}

/// A torque alone; without one the brake holds.
fn of(command_nm: Option<f64>) -> Acting {
    Acting { command_nm, force_n: 0.0 }
}

fn torque(force_n: f64) -> Option<f64> {
    Some(force_n * 5e-3 / TAU)
}

#[test]
fn momentum_is_the_impulse_of_the_lagging_torque() {
    let mut train = built(&frictionless());
    for cycle in 1..=400 {
        train.advance(of(Some(1.0)));
        let (t, motion) = (CYCLE_S * f64::from(cycle), train.motion());
        let left = libm::exp(-t / 0.0005);
        assert!((motion.torque_nm - (1.0 - left)).abs() < 1e-12);
        let impulse = TAU / 5e-3 * (t - 0.0005 * (1.0 - left));
        let momentum = 12e-4 * (TAU / 5e-3).powi(2) * motion.motor_m_s + 110.0 * motion.slide_m_s;
        assert!((momentum / impulse - 1.0).abs() < 1e-9, "{momentum} of {impulse} N s at {t} s");
    }
}

#[test]
fn the_slide_swings_with_its_mode_while_the_brake_holds() {
    let mut train = built(&frictionless());
    train.advance(Acting { command_nm: None, force_n: 1000.0 });
    let (mut before, mut crossings, mut sizes) = (0.0, Vec::new(), Vec::new());
    for cycle in 0..400 {
        train.advance(of(None));
        let Motion { motor_m, slide_m, slide_m_s, .. } = *train.motion();
        assert_eq!(motor_m, 0.0);
        if before < 0.0 && slide_m >= 0.0 {
            crossings.push(f64::from(cycle) - slide_m / (slide_m - before));
        }
        before = slide_m;
        sizes.push(slide_m * slide_m + (slide_m_s / (TAU * 100.0)).powi(2));
    }
    let periods = (crossings.len() - 1) as f64;
    let hz = periods / ((crossings[crossings.len() - 1] - crossings[0]) * CYCLE_S);
    assert!((hz - 99.955).abs() < 0.1, "{hz} Hz");
    // Between the same phases of whole periods: 15 periods of 20 cycles.
    let damping = -libm::log(sizes[380] / sizes[80]) / (2.0 * TAU * 100.0 * 300.0 * CYCLE_S);
    assert!((damping - 0.03).abs() < 0.001, "{damping}");
}

#[test]
fn holds_below_breakaway_and_returns_elastically() {
    let mut train = built(&AxisTrain::default());
    for cycle in 0..=1000 {
        train.advance(of(torque(0.06 * f64::from(cycle))));
    }
    let loaded_um = 1e6 * train.motion().motor_m;
    // 60 N against the bristles of the screw, and of the guide behind the elastic mode.
    let guide = 1.0 / (1.0 / 1.5e7 + 1.0 / 4.34e7);
    let spring_um = 60e6 / (3e7 + guide);
    assert!((spring_um..1.2 * spring_um).contains(&loaded_um), "{loaded_um} of {spring_um} µm");
    for cycle in (0..=1000).rev() {
        train.advance(of(torque(0.06 * f64::from(cycle))));
    }
    // A fifth of the friction: ln(1/0.8) of the bristles' length forth, ln(1.2) back.
    let left_um = 1e6 * train.motion().motor_m;
    assert!(left_um < 0.25 * loaded_um, "{left_um} µm stayed of {loaded_um}");
}

#[test]
fn breaks_away_beyond_the_static_friction() {
    let sticky = AxisTrain { screw_static_n: Some(187.5), ..AxisTrain::default() };
    // 160 N of the guide, and 150 N or 187.5 N of the screw.
    for (train, force_n, moves) in [
        (AxisTrain::default(), 280.0, false),
        (AxisTrain::default(), 325.0, true),
        (sticky.clone(), 325.0, false),
        (sticky, 370.0, true),
    ] {
        let mut train = built(&train);
        for cycle in 0..4000 {
            train.advance(of(torque(force_n * (f64::from(cycle) / 2000.0).min(1.0))));
        }
        let moved_um = 1e6 * train.motion().motor_m;
        assert_eq!(moved_um > 50.0, moves, "{moved_um} µm at {force_n} N");
    }
}

#[test]
fn a_broken_away_screw_slides_with_its_coulomb_friction() {
    let mut train = built(&AxisTrain { screw_static_n: Some(250.0), ..AxisTrain::default() });
    for _ in 0..20_000 {
        train.advance(of(torque(if train.motion().motor_m < 1e-3 { 500.0 } else { 400.0 })));
    }
    let v = train.motion().motor_m_s;
    // 400 N less 150 N and 120 N, over 2600 N s/m.
    assert!((v - 0.05).abs() < 5e-5, "{v} m/s");
}

#[test]
fn the_damping_of_the_bristles_shortens_the_swing_of_a_slide_at_rest() {
    // What is left of the swing after 20 ms.
    let left = |slide_bristle_n_s_mm: f64| {
        let mut train = built(&AxisTrain {
            slide_bristle_n_s_mm,
            mode_damping: 0.0,
            slide_viscous_n_s_mm: 0.0,
            ..AxisTrain::default()
        });
        train.advance(Acting { command_nm: None, force_n: 100.0 });
        let mut swing_m = || {
            let places = (0..20).map(|_| {
                train.advance(of(None));
                train.motion().slide_m
            });
            let (least, most) =
                places.fold((f64::MAX, f64::MIN), |(least, most), y| (least.min(y), most.max(y)));
            most - least
        };
        let [first, _, third] = [swing_m(), swing_m(), swing_m()];
        third / first
    };
    // exp(−15 N·s/mm · 20 ms / (2 · 110 kg)) by the damping alone.
    let by_damping = left(15.0) / left(0.0);
    assert!((by_damping / 0.2557 - 1.0).abs() < 0.1, "{by_damping}");
}

#[test]
fn slides_at_the_speed_where_friction_takes_the_force() {
    let mut train = built(&AxisTrain::default());
    for _ in 0..20_000 {
        train.advance(of(torque(150.0 + 120.0 + 2600.0 * 0.05)));
    }
    let v = train.motion().motor_m_s;
    assert!((v - 0.05).abs() < 5e-5, "{v} m/s");
}

#[test]
fn the_nut_goes_through_its_backlash_before_it_takes_the_slide_along() {
    let mut train = built(&AxisTrain { backlash_mm: 0.02, ..AxisTrain::default() });
    // Pushes until the motor is there, then lets the brake hold it.
    let push = |train: &mut DriveTrain, force_n: f64, way_um: f64| {
        while 1e6 * train.motion().motor_m * force_n.signum() < way_um * force_n.signum() {
            train.advance(of(torque(force_n)));
        }
        (0..2000).for_each(|_| train.advance(of(None)));
        1e6 * train.motion().slide_m
    };
    // Half of it lies on either side of home.
    assert_eq!(push(&mut train, 170.0, 9.0), 0.0);
    let there_um = push(&mut train, 320.0, 110.0);
    // The slide may coast a little when the motor stops.
    let behind_um = 1e6 * train.motion().motor_m - there_um;
    assert!((7.0..10.5).contains(&behind_um), "{behind_um}");
    // Back through almost all of it, and then with the slide.
    let back_um = 1e6 * train.motion().motor_m - 16.0;
    assert!((push(&mut train, -170.0, back_um) - there_um).abs() < 0.1);
    let home_um = push(&mut train, -320.0, 0.0);
    let behind_um = 1e6 * train.motion().motor_m - home_um;
    assert!((-10.5..-7.0).contains(&behind_um), "{behind_um}");
}

#[test]
fn a_flank_pushes_and_does_not_pull() {
    let train = built(&AxisTrain { backlash_mm: 0.02, ..AxisTrain::default() });
    assert_eq!(train.push(9e-6, 1.0), 0.0);
    assert_eq!(train.push(11e-6, -1.0), 0.0);
    assert_eq!(train.push(-11e-6, 1.0), 0.0);
    assert!((train.push(20e-6, 0.0) - 434.2).abs() < 0.1 && (train.push(-20e-6, 0.0) + 434.2).abs() < 0.1);
    assert!(train.push(11e-6, 0.1) > 400.0);
}

#[test]
fn the_error_of_the_screw_is_a_lever() {
    let screw_error = vec![[0.0, 0.0], [60.0, 0.0], [61.0, 40.0], [70.0, 40.0]];
    let mut train = built(&AxisTrain { screw_error, ..frictionless() });
    train.advance(of(torque(100.0)));
    let mut work = 0.0;
    for _ in 0..200 {
        let before = train.motion().motor_m;
        train.advance(of(torque(100.0)));
        work += 100.0 * (train.motion().motor_m - before);
    }
    let Motion { motor_m_s: v, slide_m_s: w, .. } = *train.motion();
    let motor_kg = 12e-4 * (TAU / 5e-3).powi(2);
    let moving = 0.5 * (motor_kg * v * v + 110.0 * w * w);
    assert!((moving / work - 1.0).abs() < 0.01, "{moving} J of {work} J");
    let (nut_m, nut_m_s) = train.nut();
    assert!(nut_m > train.motion().motor_m && nut_m_s != v, "{nut_m} {nut_m_s}");
}

#[test]
fn two_at_once_are_each_by_itself() {
    let plain = built(&AxisTrain::default());
    let heavy = built(&AxisTrain { slide_mass_kg: 300.0, slide_coulomb_n: 70.0, ..AxisTrain::default() });
    let worn = built(&AxisTrain { backlash_mm: 0.01, screw_wobble_um: 3.0, ..AxisTrain::default() });
    let sticky = built(&AxisTrain {
        screw_static_n: Some(190.0),
        screw_stribeck_mm_s: 2.5,
        screw_bristle_n_s_mm: 40.0,
        slide_bristle_n_s_mm: 15.0,
        ..AxisTrain::default()
    });
    let hanging = built(&AxisTrain {
        gravity_n: -700.0,
        torque_constant_pct: 7.0,
        cogging_nm: 0.1,
        backlash_mm: 0.004,
        ..AxisTrain::default()
    });
    for beside in [heavy, worn, sticky, hanging] {
        let (mut one, mut other, mut first, mut second) =
            (plain.clone(), beside.clone(), plain.clone(), beside);
        for cycle in 0..4000 {
            let force_n = 900.0 * libm::sin(0.01 * f64::from(cycle));
            let acting = Acting { command_nm: torque(force_n).filter(|_| cycle < 3000), force_n: 50.0 };
            let there = of(torque(-force_n));
            one.advance(acting);
            other.advance(there);
            first.advance_both(acting, &mut second, there);
            assert_eq!((one.motion(), other.motion()), (first.motion(), second.motion()), "cycle {cycle}");
        }
    }
}

#[test]
fn a_motor_that_gives_more_than_its_drive_believes_moves_more() {
    let mut train = built(&AxisTrain { torque_constant_pct: 8.0, ..frictionless() });
    for _ in 0..400 {
        train.advance(of(Some(1.0)));
    }
    let Motion { motor_m_s: v, slide_m_s: w, torque_nm, .. } = *train.motion();
    let impulse = TAU / 5e-3 * (0.2 - 0.0005);
    let momentum = 12e-4 * (TAU / 5e-3).powi(2) * v + 110.0 * w;
    assert!((momentum / impulse - 1.08).abs() < 1e-9, "{momentum} N s");
    assert!((torque_nm - 1.0).abs() < 1e-9 && (train.torque_nm() - 1.08).abs() < 1e-9);
}

#[test]
fn cogging_gives_back_what_it_takes() {
    let plain = AxisTrain { mode_damping: 0.0, ..frictionless() };
    let mut train = built(&AxisTrain { cogging_nm: 0.2, cogging_per_rev: 24, ..plain });
    let energy = |train: &DriveTrain| {
        let Motion { motor_m: x, motor_m_s: v, slide_m: y, slide_m_s: w, .. } = *train.motion();
        let motor_kg = 12e-4 * (TAU / 5e-3).powi(2);
        let spring = 110.0 * (TAU * 100.0 * (x - y)).powi(2);
        0.5 * (motor_kg * v * v + 110.0 * w * w + spring)
    };
    // Sets off, and runs out without torque: 24 teeth a turn of 5 mm take 2 · 0.2/24 J and give them back.
    (0..100).for_each(|_| train.advance(of(Some(2.0))));
    (0..100).for_each(|_| train.advance(of(Some(0.0))));
    let (mut least, mut most) = (f64::INFINITY, 0.0f64);
    for _ in 0..4000 {
        train.advance(of(Some(0.0)));
        (least, most) = (least.min(energy(&train)), most.max(energy(&train)));
    }
    assert!(((most - least) / (2.0 * 0.2 / 24.0) - 1.0).abs() < 0.02, "{least} J to {most} J");
}

#[test]
fn what_hangs_rests_at_home_on_a_flank() {
    for gravity_n in [-700.0, 700.0] {
        let mut train = built(&AxisTrain { gravity_n, backlash_mm: 0.02, ..AxisTrain::default() });
        (0..1000).for_each(|_| train.advance(of(None)));
        let Motion { motor_m, slide_m, .. } = *train.motion();
        assert!(motor_m == 0.0 && slide_m.abs() < 1e-9, "{motor_m} {slide_m}");
        // The motor carries it: both ways the slide comes along from the first micrometre on.
        for push_n in [400.0, -400.0] {
            let mut train = train.clone();
            while train.motion().motor_m.abs() < 8e-6 {
                train.advance(of(torque(push_n - gravity_n)));
            }
            let Motion { motor_m, slide_m, .. } = *train.motion();
            assert!((slide_m / motor_m) > 0.2, "slide {slide_m} m, motor {motor_m} m");
        }
    }
}

#[test]
fn refuses_what_the_step_cannot_follow() {
    let stiff = AxisTrain { slide_mass_kg: 0.1, ..AxisTrain::default() };
    let refusal = of_x(&stiff).unwrap_err().to_string();
    assert!(refusal.starts_with("plant.axis.x.slide_presliding_n_mm = 15000: with mode_hz"), "{refusal}");
}
