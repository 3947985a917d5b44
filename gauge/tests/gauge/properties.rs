//! What holds for any thread.

use gauge::{Place, Sections, Side};
use proptest::prelude::*;

use crate::made::{Errors, Made, threads};

fn any_thread() -> impl Strategy<Value = Made> {
    let um = |most: f64| (-most..most).prop_map(|um: f64| 1e-3 * um);
    let errors = (um(1.0), um(20.0), um(20.0), um(1.0), um(10.0), um(20.0));
    (0..6_usize, errors, um(100.0), 0.4..1.0).prop_map(|(at, errors, above, share)| {
        let (lead, drunken, start, taper, runout, pass) = errors;
        let mut made = threads()[at].clone().above_go(above);
        made.length_mm *= share;
        made.with(Errors { lead, drunken, start, taper, runout, pass })
    })
}

fn judged(made: &Made, sections: &Sections, by: f64) -> gauge::Report {
    gauge::judge(&made.nominal, sections, made.full_mm().map(|z| z + by), made.crest_mm())
}

/// The same sections, every place changed.
fn each(sections: &Sections, change: impl Fn(Place) -> Place) -> Sections {
    let stations = sections.stations.iter().map(|places| places.iter().copied().map(&change).collect());
    Sections { edges: sections.edges.clone(), stations: stations.collect() }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// No counterpart goes on that is larger than the largest simple pitch diameter would let in.
    #[test]
    fn the_virtual_size_is_never_looser_than_the_simple_one(made in any_thread()) {
        let report = made.judged();
        let [low, high] = report.pitch_diameter_mm;
        match made.nominal.side {
            Side::External => prop_assert!(report.virtual_mm >= high - 1e-6, "{report:?}"),
            Side::Internal => prop_assert!(report.virtual_mm <= low + 1e-6, "{report:?}"),
        }
    }

    /// The order of the passes, and where the part stands, say nothing of it.
    #[test]
    fn order_and_place_do_not_matter(made in any_thread(), by in -500.0..500.0) {
        let sections = made.sections();
        let report = judged(&made, &sections, 0.0);
        let mut turned = each(&sections, |place| Place { z_mm: place.z_mm + by, ..place });
        turned.stations.iter_mut().for_each(|places| places.reverse());
        let other = judged(&made, &turned, by);
        prop_assert!((report.virtual_mm - other.virtual_mm).abs() < 1e-8);
        for (a, b) in report.pitch_diameter_mm.iter().zip(other.pitch_diameter_mm) {
            prop_assert!((a - b).abs() < 1e-8);
        }
        prop_assert!((report.lead_error_um - other.lead_error_um).abs() < 1e-4);
    }

    /// What is cut in the air of a groove changes nothing.
    #[test]
    fn a_pass_in_the_air_changes_nothing(made in any_thread(), up in 0.0..0.3) {
        let sections = made.sections();
        let mut more = sections.clone();
        for places in &mut more.stations {
            let air = |place: &Place| Place { radius_mm: place.radius_mm + made.sign() * up, ..*place };
            let air: Vec<Place> = places.iter().map(air).collect();
            places.extend(air);
        }
        prop_assert_eq!(judged(&made, &sections, 0.0), judged(&made, &more, 0.0));
    }

    /// More material taken off never makes a thread tighter.
    #[test]
    fn a_deeper_pass_never_makes_it_tighter(made in any_thread(), down in 0.0..0.05) {
        let sections = made.sections();
        let deeper =
            each(&sections, |place| Place { radius_mm: place.radius_mm - made.sign() * down, ..place });
        let [before, after] = [&sections, &deeper].map(|sections| judged(&made, sections, 0.0).virtual_mm);
        prop_assert!(made.sign() * (after - before) <= 1e-8, "{before} {after}");
    }
}
