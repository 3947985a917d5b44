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
        ("1/2-14 NPT", NominalError::Side),
        ("BSW 1/2-12", NominalError::Side),
        ("Rd80 x 1/10 external", NominalError::NoLimits),
    ] {
        let refused = named(name).expect_err("there is none");
        assert_eq!(refused, why, "{name}");
        assert!(refused.to_string().contains("gauge"), "{refused}");
    }
}

/// A screw of NPT grows away from its face at Z 0, a nut shrinks; E1 is that of ASME B1.20.1, a turn to
/// either side.
#[test]
fn a_taper_is_held_against_its_plane_from_the_face() {
    let close = |a: f64, b: f64| assert!((a - b).abs() < 3e-4, "{a} {b}");
    for (name, taper, plane) in
        [("1/2-14 NPT external", -1.0 / 16.0, -0.320 * 25.4), ("1/2-14 NPT internal", 1.0 / 16.0, 0.0)]
    {
        let nominal = named(name).expect("it has limits");
        let [least, most] = nominal.pitch_diameter_mm;
        close(0.5 * (least + most), 0.77843 * 25.4);
        close(most - least, 2.0 * 25.4 / 14.0 / 16.0);
        assert_eq!(nominal.taper, taper, "{name}");
        close(nominal.plane_mm, plane);
    }
    for (name, taper, plane, turns) in
        [("R1/2", -1.0 / 16.0, -8.2, 1.0), ("Rc1/2", 1.0 / 16.0, 0.0, 1.25), ("R3", -1.0 / 16.0, -20.6, 1.5)]
    {
        let nominal = named(name).expect("it has limits");
        let [least, most] = nominal.pitch_diameter_mm;
        assert!((most - least - 2.0 * turns * nominal.pitch_mm / 16.0).abs() < 1e-3, "{name}");
        assert_eq!((nominal.taper, nominal.plane_mm), (taper, plane), "{name}");
    }
}

/// A larger cone stops its gauge earlier, by sixteen times as much; a cylinder has no plane.
#[test]
fn the_gauge_of_a_taper_stands_off_its_plane() {
    for (larger_mm, standoff_mm) in [(0.0, 0.0), (0.05, 0.8), (-0.05, -0.8)] {
        let mut cone = crate::made::cone();
        let [least, most] = cone.nominal.pitch_diameter_mm;
        cone.pitch_diameter_mm = 0.5 * (least + most) + larger_mm;
        let report = cone.judged();
        let told = report.standoff_mm.expect("it has a plane");
        assert!((told - standoff_mm).abs() < 0.02, "{larger_mm}: {told}");
        assert_eq!(report.verdict, Verdict::Good, "{larger_mm}: {report:?}");
    }
    assert_eq!(crate::made::threads()[0].judged().standoff_mm, None);
}

#[test]
fn numbers_say_what_a_name_says() {
    let written = "P2 D2 18.503..18.663 A60 external crest 19.682..19.962 root ..17.797 length 20";
    let numbers: Nominal = written.parse().expect("numbers");
    let named: Nominal = "M20x2-6g".parse().expect("a name");
    let printed = Nominal { root_mm: [None, Some(17.797)], root_go_mm: Some(17.797), ..named.clone() };
    assert_eq!(numbers, Nominal { name: written.into(), ..printed });
    assert!((named.root_go_mm.expect("a root") - 17.797).abs() < 1e-9);
    let other = "p 7 a 30 lh d2 36,02..36,375 internal STARTS 2 taper 1:16 at -3";
    let other: Nominal = other.parse().expect("numbers");
    assert_eq!((other.flank_deg, other.starts, other.grows), ([15.0; 2], 2, true));
    assert_eq!((other.taper, other.plane_mm, other.gauge_mm), (1.0 / 16.0, -3.0, 36.375));
    assert_eq!((other.side, other.pitch_diameter_mm), (Side::Internal, [36.02, 36.375]));
    let tapped: Nominal = "Rc1/2 TAP 19,5 ".parse().expect("a tapered nut");
    assert_eq!((tapped.name.as_str(), tapped.tap_mm), ("Rc1/2 tap 19.5", Some(19.5)));
    let again: Nominal = tapped.name.parse().expect("its own name");
    assert_eq!(again, tapped);
}

#[test]
fn numbers_that_are_wrong_are_told_by_their_word() {
    for (text, word, message) in [
        ("P2 D2 18.5", "18.5", "\"18.5\" behind D2 is not a range"),
        ("P2 D2", "", "behind D2 a range, as in 18.503..18.663 is missing"),
        ("P2 D2 ..18.6", "P2 D2 ..18.6", "D2 with both limits of the pitch diameter is missing"),
        ("P2 A60", "P2 A60", "D2 with both limits"),
        ("P2 D2 18.5..18.6 A6o", "A6o", "\"A6o\" is not understood"),
        ("P2 D2 18.5..18.6 extern", "extern", "\"extern\" is not understood"),
        ("P2 D2 18.5..18.6 P3", "P3", "\"P3\" is said twice"),
        ("P2 D2 18.5..18.6 internal external", "external", "said twice"),
        ("P2 D2 18.5..18.6 starts 1.5", "P2 D2 18.5..18.6 starts 1.5", "no 1.5 starts"),
        ("P2 D2 18.5..18.6 taper 1:0", "1:0", "is not a taper"),
        ("P2 D2 18.7..18.6", "P2 D2 18.7..18.6", "range of pitch diameters"),
        ("P2 D2 18.5..18.6 A2", "P2 D2 18.5..18.6 A2", "flanks"),
        ("P-2 D2 18.5..18.6", "P-2 D2 18.5..18.6", "a pitch"),
        ("M20x2-6z", "6z", ""),
        ("M20x2", "M20x2", "neither"),
        ("M20x2-6H tap 19", " tap 19", "a nut that is tapered"),
        ("1/2-14 NPT external tap 19", " tap 19", "a nut that is tapered"),
        ("Rc1/2 tap 0", " tap 0", "\"0\" behind tap is not a length"),
        ("Rc1/2 tap 19 tap 19", "tap", "not understood"),
    ] {
        let wrong = text.parse::<Nominal>().expect_err(text);
        assert!(wrong.message.contains(message), "{text}: {wrong}");
        assert!(text[wrong.span.clone()].contains(word) || word == "6z", "{text}: {wrong:?}");
        assert!(!wrong.help.is_empty(), "{text}");
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
        "1/4-28 UNJF-3A",
        "1-8 UNJC-3B",
        "2-4 BUTT-2A",
        "2-4 PUSH-BUTT-2B",
        "G 1/2 A external",
        "G 1 internal",
        "1-5 ACME-2G external",
        "M20x2-6g LH",
    ] {
        let nominal = named(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (flank, pitch) = (0.5 * nominal.flank_deg.iter().sum::<f64>(), nominal.pitch_mm);
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

#[test]
fn capitals_alone_are_a_screw_where_it_says_external() {
    assert_eq!(named("M20X2-6G EXTERNAL"), named("M20x2-6g external"));
    assert_eq!(named("M20X2-6G").map(|nut| nut.side), Ok(Side::Internal));
    assert!("M20x2-6G external".parse::<Nominal>().is_err(), "small letters are there");
    assert!("M20X2-6H EXTERNAL".parse::<Nominal>().is_ok());
}

#[test]
fn what_no_gauge_looks_at_is_told() {
    assert_eq!(named("M20x2-6g").map(|screw| screw.left_out.len()), Ok(0));
    assert_eq!(named("MJ6x1-4h6h").map(|screw| screw.left_out.len()), Ok(1));
    assert_eq!(named("1/2-14 NPT external").map(|screw| screw.left_out.len()), Ok(1));
}

#[test]
fn a_thread_without_limits_is_told_by_numbers() {
    for (name, numbers) in [
        (
            "BSW 1/2-12 external",
            "P2.1167 D2 least..most A55 external or internal: its basic pitch diameter is 11.34",
        ),
        ("Rd105 x 1/4 external", "P6.3500 D2 least..most A30"),
    ] {
        let wrong = name.parse::<Nominal>().expect_err(name);
        assert!(wrong.help.contains(numbers), "{name}: {}", wrong.help);
    }
}
