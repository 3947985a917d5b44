//! Gauges from names of threads.

use gauge::{Edge, Nominal, NominalError, Side, Verdict};
use metrology::Thread;

use crate::made::{Errors, Made, threads};

fn named(name: &str) -> Result<Nominal, NominalError> {
    Nominal::of(&name.parse::<Thread>().expect("the name of a thread"))
}

#[test]
fn the_limits_are_those_that_tables_print() {
    for (at, name) in [(0, "M20x2-6g"), (1, "M6-6g"), (2, "M20x2-6H")] {
        let (nominal, printed) = (named(name).expect("it has limits"), &threads()[at].nominal);
        assert_eq!(nominal.pitch_diameter_mm, printed.pitch_diameter_mm, "{name}");
        assert_eq!((nominal.side, nominal.pitch_mm), (printed.side, printed.pitch_mm), "{name}");
        let root = nominal.root_go_mm.zip(printed.root_go_mm).map_or(1.0, |(a, b)| (a - b).abs());
        assert!(root < 1e-9, "{name}: {nominal:?}");
    }
    let screw = named("M20x2-6g").expect("it has limits");
    assert_eq!((screw.crest_mm, screw.gauge_mm), ([Some(19.682), Some(19.962)], 20.0));
    assert!(!screw.grows && named("M20x2-6g LH").expect("it has limits").grows);
    assert_eq!(
        named("Tr40x14P7-7e").map(|nominal| (nominal.starts, nominal.root_go_mm)),
        Ok((2, Some(33.0)))
    );
    assert_eq!(named("G 1/2 A external").map(|nominal| nominal.root_go_mm), Ok(None), "round roots");
}

#[test]
fn what_has_no_gauge_says_why() {
    for (name, why) in [
        ("M20x2", NominalError::Side),
        ("1/2-14 NPT", NominalError::Taper),
        ("BSW 1/2-12", NominalError::Side),
        ("Rd80 x 1/10 external", NominalError::NoLimits),
    ] {
        let refused = named(name).expect_err("there is none");
        assert_eq!(refused, why, "{name}");
        assert!(refused.to_string().contains("gauge"), "{refused}");
    }
}

/// Cut with the flanks that it asks for, in the middle of its class, a thread of any standard is good; a
/// twentieth of its tolerance beyond a limit it is not.
#[test]
fn a_thread_in_the_middle_of_its_class_is_good() {
    for name in [
        "M20x2-6g",
        "M20x2-6H",
        "M6-6g",
        "M6-6H",
        "M100x6-8g",
        "Tr40x7-7e",
        "Tr40x7-7H",
        "Tr40x14P7-7e",
        "1/4-20 UNC-2A",
        "1/4-20 UNC-3B",
        "1-8 UNC-2A",
        "G 1/2 A external",
        "G 1 internal",
        "1-5 ACME-2G external",
        "M20x2-6g LH",
    ] {
        let nominal = named(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (flank, pitch) = (nominal.flank_deg[0], nominal.pitch_mm);
        let flat_mm = if flank < 20.0 { 0.3 * pitch } else { 0.06 * pitch };
        let [least, most] = nominal.pitch_diameter_mm;
        let middle = Made {
            edge: Edge { flank_deg: nominal.flank_deg, flat_mm, nose_mm: 0.02 * pitch },
            pitch_diameter_mm: 0.5 * (least + most),
            length_mm: 10.0 * pitch * f64::from(nominal.starts),
            by_flank: nominal.side == Side::External,
            errors: Errors::default(),
            nominal,
        };
        let report = middle.judged();
        assert_eq!(report.verdict, Verdict::Good, "{name}: {report:?}");
        let beyond = 0.05 * (most - least);
        for bad in [middle.clone().above_go(beyond), middle.clone().above_no_go(-beyond)] {
            assert_eq!(bad.judged().verdict, Verdict::Bad, "{name}");
        }
    }
}
