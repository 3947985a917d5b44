//! Threads that are picked up from touches: how far off phase and lead are, how often the stated confidence
//! holds, and which threads are refused.

use gauge::pickup::{Asked, Found, NotFound, Touch, pick_up};
use testing::Seed;

const SEEDS: u64 = 500;
const M20: Asked = Asked { lead_mm: -2.0, starts: 1, noise_mm: 0.005, lead_error_mm: 0.01 };

/// Shares of a turn at which a thread is touched: not in even steps, or another lead would fit as well.
const SHARES: [f64; 5] = [0.0, 0.5, 0.2, 0.8, 0.35];

/// Five touches of a thread, four turns or so apart; the probe is off by up to 5 µm.
fn touches(seed: &mut Seed, lead_mm: f64, z_mm: f64, taper: f64) -> Vec<Touch> {
    let touch = |(n, share): (usize, f64)| {
        let turns = n as f64 * 4.0 + share + 0.1 * seed.unit();
        let true_z = z_mm + lead_mm * turns;
        let off = [seed.signed(), seed.signed()];
        Touch {
            // As an encoder with an index shows it, within its turn.
            angle_deg: 360.0 * (turns - turns.floor()),
            z_mm: true_z + 0.005 * off[0],
            x_mm: Some(9.0 + taper * true_z + 0.005 * off[1]),
        }
    };
    SHARES.into_iter().enumerate().map(touch).collect()
}

/// How far off the phase is, where the groove truly is at the angle that is told, mm.
fn phase_off(found: &Found, lead_mm: f64, z_mm: f64) -> f64 {
    let turns = (found.phase_mm.value - z_mm) / lead_mm - found.angle_deg / 360.0;
    (turns - turns.round()) * lead_mm
}

#[test]
fn five_touches_find_phase_and_lead_and_the_confidence_holds() {
    let (mut phases, mut leads, mut held) = (Vec::new(), Vec::new(), [0_u32; 3]);
    let mut refused = 0;
    for number in 0..SEEDS {
        let mut seed = Seed::of_case(number);
        // A worn lead within what it may be off, a phase that nobody knows, a taper of 1:16.
        let (lead_mm, z_mm) = (-2.0 + 0.005 * seed.signed(), 5.0 * seed.unit());
        let Ok(found) = pick_up(&touches(&mut seed, lead_mm, z_mm, 1.0 / 32.0), &M20) else {
            refused += 1;
            continue;
        };
        let phase = phase_off(&found, lead_mm, z_mm).abs();
        let lead = (found.lead_mm.value - lead_mm).abs();
        let taper = found.taper.expect("X was measured");
        phases.push(phase);
        leads.push(lead);
        held[0] += u32::from(phase <= found.phase_mm.within);
        held[1] += u32::from(lead <= found.lead_mm.within);
        held[2] += u32::from((taper.value - 1.0 / 32.0).abs() <= taper.within);
    }
    phases.sort_by(f64::total_cmp);
    let at_95 = 1e3 * phases[phases.len() * 95 / 100];
    let worst_lead = 1e3 * leads.iter().fold(0.0_f64, |most, off| most.max(*off));
    let share = held.map(|held| 100.0 * f64::from(held) / phases.len() as f64);
    println!("phase {at_95:.2} µm at 95 %, lead {worst_lead:.2} µm/rev, held {share:?} %, refused {refused}");
    assert!(at_95 < 3.0 && worst_lead < 1.0);
    assert!(share.iter().all(|share| (93.0..=97.0).contains(share)), "{share:?}");
    assert!(refused <= 3, "{refused} of {SEEDS} sound threads are refused");
}

#[test]
fn a_wrong_thread_is_refused() {
    for number in 0..SEEDS {
        let mut seed = Seed::of_case(number);
        for lead_mm in [-1.75, -2.5, -1.5, 2.0, -25.4 / 13.0, -2.02] {
            let found = pick_up(&touches(&mut seed, lead_mm, 1.0, 0.0), &M20);
            assert!(
                matches!(found, Err(NotFound::BadFit(_) | NotFound::OtherLead(_))),
                "lead {lead_mm}, seed {number}: {found:?}"
            );
        }
        // One touch beside the groove.
        let mut beside = touches(&mut seed, -2.0, 1.0, 0.0);
        beside[2].z_mm += 0.05;
        assert!(matches!(pick_up(&beside, &M20), Err(NotFound::BadFit(_))), "seed {number}");
    }
}

#[test]
fn starts_are_told_apart_by_their_lead_and_the_start_point_enters_the_groove() {
    let asked = Asked { lead_mm: 4.0, starts: 2, ..M20 };
    let exact = |turns: f64, start: f64| Touch {
        angle_deg: 360.0 * turns,
        z_mm: -20.3 + 4.0 * (turns + start / 2.0),
        x_mm: None,
    };
    let touches = [exact(0.1, 0.0), exact(2.4, 1.0), exact(3.9, 0.0), exact(5.2, 1.0)];
    let found = pick_up(&touches, &asked).expect("it is one thread");
    assert!((found.lead_mm.value - 4.0).abs() < 1e-9 && found.taper.is_none() && found.farthest_mm < 1e-9);
    for near in [-33.0, 0.0, 8.1] {
        let start = found.start_near(near).value;
        let grooves = (start + 20.3) / 2.0;
        assert!((grooves - grooves.round()).abs() < 1e-9 && (start - near).abs() <= 1.0 + 1e-9, "{start}");
    }
    assert!(found.start_near(500.0).within > found.start_near(-10.0).within);
}

#[test]
fn touches_that_say_too_little_are_refused() {
    let at = |angle_deg, z_mm| Touch { angle_deg, z_mm, x_mm: None };
    let two = [at(0.0, 0.0), at(0.0, -2.0)];
    assert_eq!(pick_up(&two, &M20), Err(NotFound::TooFew));
    assert_eq!(pick_up(&[at(0.0, 0.0); 4], &M20), Err(NotFound::OnePlace));
    let far = [at(0.0, 0.0), at(0.0, -2.0), at(0.0, -200.0)];
    assert_eq!(pick_up(&far, &M20), Err(NotFound::Ambiguous(50.0)));
    let wrong = [at(0.0, 0.0), at(f64::NAN, -2.0), at(0.0, -4.0)];
    assert_eq!(pick_up(&wrong, &M20), Err(NotFound::Number));
    assert_eq!(pick_up(&far, &Asked { noise_mm: 0.0, ..M20 }), Err(NotFound::Number));
    let cone = |x: f64, z_mm| Touch { x_mm: Some(x), ..at(0.0, z_mm) };
    let bent = [cone(9.0, 0.0), cone(9.2, -2.0), cone(9.0, -4.0)];
    assert!(matches!(pick_up(&bent, &M20), Err(NotFound::BadTaper(_))));
}
