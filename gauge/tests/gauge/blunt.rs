//! Blunt starts that are made up, right and wrong on purpose: slices of the ridge are taken away at every
//! angle up to where it is to begin.

use gauge::{Check, Nominal, Place, Report, Sections, Verdict};

use crate::made::{Made, cone, threads};

/// What is taken away: turns behind the face, step of the slices, and which of them are left out, mm.
struct Taken {
    turns: f64,
    step_mm: f64,
    but_mm: [f64; 2],
}

/// The ridge in front of the grooves is taken away, as long as they are so near to the face.
fn without_ridge(made: &Made, taken: &Taken) -> Sections {
    let mut sections = made.sections();
    let lead = made.nominal.pitch_mm * f64::from(made.nominal.starts);
    let slices = (taken.turns * lead / taken.step_mm).ceil();
    for places in &mut sections.stations {
        let behind = |place: &Place| -place.z_mm / lead;
        // The deepest pass of each groove is the first one.
        let grooves: Vec<Place> = places.iter().copied().step_by(5).collect();
        for groove in grooves.into_iter().filter(|place| (0.0..taken.turns).contains(&behind(place))) {
            for slice in 1..=slices as u32 {
                let beside = taken.turns * lead * f64::from(slice) / slices;
                let radius_mm = groove.radius_mm + 0.5 * made.nominal.taper * beside;
                if !(taken.but_mm[0]..taken.but_mm[1]).contains(&beside) {
                    places.push(Place { z_mm: groove.z_mm + beside, radius_mm, edge: 0 });
                }
            }
        }
    }
    sections
}

fn judged(made: &Made, asked: [f64; 2], taken: &Taken) -> Report {
    let nominal = Nominal { blunt_turns: Some(asked), ..made.nominal.clone() };
    let lead = nominal.pitch_mm * f64::from(nominal.starts);
    let full_mm = [made.full_mm()[0], -(taken.turns + 0.6) * lead];
    gauge::judge(&nominal, &without_ridge(made, taken), full_mm, made.crest_mm())
}

#[test]
fn a_ridge_begins_where_it_was_taken_away_to() {
    for made in threads().into_iter().chain([cone()]) {
        let name = &made.nominal.name;
        let turns = if made.nominal.starts > 1 { 0.41 } else { 0.93 };
        let step_mm = 0.05 * made.nominal.pitch_mm;
        let taken = |turns: f64| Taken { turns, step_mm, but_mm: [0.0; 2] };
        let asked = [turns - 0.02, turns + 0.02];
        let good = judged(&made, asked, &taken(turns));
        assert_eq!(good.verdict, Verdict::Good, "{name}: {good:?}");
        let [gone, whole] = good.blunt_turns.expect("it is asked for");
        let near = 1.0 / crate::made::STATIONS as f64 + 1e-9;
        assert!((0.0..near).contains(&(gone - turns)) && (0.0..near).contains(&(turns - whole)), "{name}");
        let standing = [0.3, 0.75].map(|share| share * made.nominal.pitch_mm);
        for (taken, why) in [
            (taken(turns - 0.1), "stands at"),
            (taken(turns + 0.1), "whole from"),
            (Taken { but_mm: standing, ..taken(turns) }, "stands at"),
            (Taken { step_mm: 0.7 * made.nominal.pitch_mm, ..taken(turns) }, "stands at"),
        ] {
            let bad = judged(&made, asked, &taken);
            let reason = bad.reasons.iter().find(|reason| reason.check == Check::Start);
            assert_eq!(bad.verdict, Verdict::Bad, "{name}: {why}, {bad:?}");
            assert!(reason.is_some_and(|reason| reason.text.contains(why)), "{name}: {why}, {bad:?}");
        }
    }
}

#[test]
fn a_thread_that_is_not_asked_to_begin_bluntly_may_and_one_that_is_has_to() {
    let made = &threads()[0];
    assert_eq!(made.judged().blunt_turns, None);
    let none = Taken { turns: 0.0, step_mm: 1.0, but_mm: [0.0; 2] };
    let bad = judged(made, [0.9, 1.0], &none);
    assert_eq!(bad.verdict, Verdict::Bad, "{bad:?}");
}

#[test]
fn a_name_says_where_the_ridge_begins() {
    let read: Nominal = "M20x2-6g blunt 0.9..1".parse().expect("a name");
    assert_eq!((read.blunt_turns, read.name.as_str()), (Some([0.9, 1.0]), "M20x2-6g blunt 0.9..1"));
    let numbers: Nominal = "P2 D2 18.503..18.663 A60 external BLUNT 0.5..0.7".parse().expect("numbers");
    assert_eq!(numbers.blunt_turns, Some([0.5, 0.7]));
    for wrong in ["1", "1..0.9", "0..1", "0.9..", "0.9..9", "x..y"] {
        let refused = format!("M20x2-6g blunt {wrong}").parse::<Nominal>().expect_err("refused");
        assert_eq!(refused.span, 8.."M20x2-6g blunt ".len() + wrong.len(), "{wrong}");
        assert!(refused.help.contains("blunt 0.9..1"), "{wrong}: {refused:?}");
    }
}
