//! What each standard promises of any thread that it has, whatever its size.

use metrology::{Limits, Member, Side, Size, Thread};
use proptest::prelude::*;

const PITCHES: [f64; 25] = [
    0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.75, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0,
    4.5, 5.0, 5.5, 6.0, 8.0,
];

fn limits(name: &str) -> Limits {
    name.parse::<Thread>().unwrap_or_else(|misread| panic!("{name}: {misread}")).limits()
}

fn side(name: &str, side: Side) -> Member {
    let found = limits(name).members().find(|(of, _)| *of == side).map(|(_, member)| member.clone());
    found.unwrap_or_else(|| panic!("{name} has no such member"))
}

fn size(member: &Member, size: Size) -> f64 {
    member.get(size).unwrap_or_else(|| panic!("{member:?} has no {size:?}"))
}

/// A tolerance, mm.
fn tolerance(member: &Member, max: Size, min: Size) -> f64 {
    size(member, max) - size(member, min)
}

fn pitch_tolerance(name: &str, of: Side) -> f64 {
    tolerance(&side(name, of), Size::PitchMax, Size::PitchMin)
}

/// What is printed to a micrometre differs by less than this from what is meant, mm.
const UM: f64 = 1e-3;

/// A diameter in tenths and a pitch that fits on it.
fn metric() -> impl Strategy<Value = (f64, f64)> {
    let sizes = (10_u32..3550, proptest::sample::select(PITCHES.to_vec()));
    sizes
        .prop_map(|(tenths, pitch)| (f64::from(tenths) / 10.0, pitch))
        .prop_filter("it fits", |(d, p)| *d >= 3.0 * p)
}

proptest! {
    /// Positions shift a zone and leave its width; what is limited lies in order; a screw goes into its nut.
    #[test]
    fn metric_zones_are_shifted_and_ordered((d, pitch) in metric()) {
        let screws = ["e", "f", "g", "h"].map(|position| side(&format!("M{d}x{pitch}-6{position}"), Side::External));
        let [nut, wide_nut] = ["4H", "4G"].map(|class| side(&format!("M{d}x{pitch}-{class}"), Side::Internal));
        prop_assert_eq!(size(&screws[3], Size::MajorMax), d);
        prop_assert_eq!(size(&nut, Size::MajorMin), d);
        for screw in &screws {
            let first = &screws[0];
            for (max, min) in [(Size::MajorMax, Size::MajorMin), (Size::PitchMax, Size::PitchMin)] {
                prop_assert!((tolerance(screw, max, min) - tolerance(first, max, min)).abs() < UM / 2.0);
            }
            let order = [Size::MajorMax, Size::PitchMax, Size::FlatMinorMax, Size::MinorMin].map(|of| size(screw, of));
            prop_assert!(order.is_sorted_by(|above, below| above > below), "{order:?}");
            prop_assert!(screw.get(Size::MinorMax).is_none_or(|root| root > size(screw, Size::MinorMin)));
            prop_assert!(size(screw, Size::PitchMax) <= size(&nut, Size::PitchMin));
            prop_assert!(size(screw, Size::FlatMinorMax) <= size(&nut, Size::MinorMin));
        }
        for at in 1..4 {
            prop_assert!(size(&screws[at], Size::PitchMax) > size(&screws[at - 1], Size::PitchMax));
        }
        let up = size(&wide_nut, Size::PitchMin) - size(&nut, Size::PitchMin);
        let down = size(&screws[3], Size::PitchMax) - size(&screws[2], Size::PitchMax);
        prop_assert!((up - down).abs() < UM / 2.0, "G lies above as g lies below");
    }

    /// A grade is a quarter wider than the one before: four steps of R40, 1.259, and what rounding makes of
    /// it.
    #[test]
    fn metric_grades_are_steps((d, pitch) in metric().prop_filter("all grades", |(_, pitch)| *pitch >= 0.8)) {
        for (of, letter, grades) in [(Side::External, 'h', 3..=9), (Side::Internal, 'H', 4..=8)] {
            let name = |grade: u8| match of {
                Side::External => format!("M{d}x{pitch}-{grade}{letter}6h"),
                Side::Internal => format!("M{d}x{pitch}-{grade}{letter}6H"),
            };
            // The pair 22 x 3 is published with tolerances of its own.
            prop_assume!((d, pitch) != (22.0, 3.0));
            let widths: Vec<f64> = grades.map(|grade| pitch_tolerance(&name(grade), of)).collect();
            for pair in widths.windows(2) {
                let ratio = pair[1] / pair[0];
                prop_assert!((1.22..1.3).contains(&ratio), "{d}x{pitch}: {widths:?}");
            }
        }
        let crest = |grade| tolerance(&side(&format!("M{d}x{pitch}-6h{grade}h"), Side::External), Size::MajorMax, Size::MajorMin);
        prop_assert!(crest(4) < crest(6) && crest(6) < crest(8));
    }

    /// MJ is M with another root: what does not touch it is the same.
    #[test]
    fn mj_differs_at_the_root_alone((d, pitch) in metric()) {
        let [m, mj] = ["M", "MJ"].map(|letters| side(&format!("{letters}{d}x{pitch}-4h6h"), Side::External));
        for of in [Size::MajorMax, Size::MajorMin, Size::PitchMax, Size::PitchMin] {
            prop_assert_eq!(m.get(of), mj.get(of));
        }
        prop_assert!(size(&mj, Size::MinorMin) > size(&m, Size::MinorMin));
        prop_assert!(size(&mj, Size::RootRadiusMin) > pitch / 8.0 - UM);
    }

    /// T_d3 = 1.25 T_d2 + |es|, where es is what the pitch diameter lies below its basic size.
    #[test]
    fn trapezoidal_roots_follow_their_flanks(d in 8_u32..=300, pitch in proptest::sample::select(vec![
        1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 14.0, 16.0, 18.0, 20.0, 22.0, 24.0, 28.0, 32.0, 36.0, 40.0, 44.0
    ]), grade in 7_u8..=9) {
        let d = f64::from(d);
        prop_assume!(d >= 2.5 * pitch);
        let (screw, nut) = (side(&format!("Tr{d}x{pitch}-{grade}e"), Side::External), side(&format!("Tr{d}x{pitch}-{grade}H"), Side::Internal));
        let es = d - pitch / 2.0 - size(&screw, Size::PitchMax);
        let td2 = tolerance(&screw, Size::PitchMax, Size::PitchMin);
        let td3 = tolerance(&screw, Size::MinorMax, Size::MinorMin);
        prop_assert!((td3 - 1.25 * td2 - es).abs() < 1.1 * UM, "{td3} {td2} {es}");
        prop_assert!(tolerance(&nut, Size::PitchMax, Size::PitchMin) > td2);
        prop_assert_eq!(size(&screw, Size::MajorMax), d);
        prop_assert!(size(&nut, Size::MinorMin) - size(&screw, Size::MinorMax) >= 0.3 - 1e-9, "clearance of both crests");
        let two = pitch_tolerance(&format!("Tr{d}x{}P{pitch}-{grade}e", 2.0 * pitch), Side::External);
        prop_assert!((two - 1.12 * td2).abs() < UM);
    }

    /// 1.5, 1, 0.75 and 1.95, 1.3, 0.975 of one tolerance; an allowance for 1A and 2A alone.
    #[test]
    fn unified_classes_share_one_tolerance(
        sixteenths in 4_u32..=64,
        tpi in proptest::sample::select(vec![6_u32, 7, 8, 10, 11, 12, 13, 14, 16, 18, 20, 24, 28, 32]),
        series in proptest::sample::select(vec!["UN", "UNS", "UNR", "UNRS"]),
    ) {
        let d = f64::from(sixteenths) / 16.0;
        prop_assume!(d * f64::from(tpi) >= 3.0);
        let width = |class: &str, of| pitch_tolerance(&format!("{d}-{tpi} {series}-{class}"), of) / 25.4;
        let t = width("2A", Side::External);
        for (class, factor) in [("1A", 1.5), ("3A", 0.75)] {
            prop_assert!((width(class, Side::External) - factor * t).abs() < 1.4e-4, "{class}");
        }
        for (class, factor) in [("1B", 1.95), ("2B", 1.3), ("3B", 0.975)] {
            prop_assert!((width(class, Side::Internal) - factor * t).abs() < 1.6e-4, "{class}");
        }
        let major = |class: &str| size(&side(&format!("{d}-{tpi} {series}-{class}"), Side::External), Size::MajorMax) / 25.4;
        prop_assert_eq!(major("1A"), major("2A"));
        prop_assert!((major("3A") - major("2A") - 0.3 * t).abs() < 0.7e-4);
        let nut = side(&format!("{d}-{tpi} {series}-2B"), Side::Internal);
        let order = [Size::MajorMin, Size::PitchMax, Size::PitchMin, Size::MinorMax, Size::MinorMin].map(|of| size(&nut, of));
        prop_assert!(order.is_sorted_by(|above, below| above > below), "{order:?}");
    }

    /// Finer classes are narrower and closer; the root has one and a half tolerances.
    #[test]
    fn acme_classes_are_ordered(eighths in 2_u32..=40, tpi in proptest::sample::select(vec![2_u32, 3, 4, 5, 6, 8, 10, 12, 14, 16])) {
        let d = f64::from(eighths) / 8.0;
        prop_assume!(d * f64::from(tpi) >= 2.5);
        let screws = [2, 3, 4].map(|class| side(&format!("{d}-{tpi} ACME-{class}G"), Side::External));
        for pair in screws.windows(2) {
            prop_assert!(size(&pair[0], Size::PitchMax) <= size(&pair[1], Size::PitchMax));
            prop_assert!(tolerance(&pair[0], Size::PitchMax, Size::PitchMin) > tolerance(&pair[1], Size::PitchMax, Size::PitchMin));
        }
        for screw in screws {
            let [pitch, root] = [(Size::PitchMax, Size::PitchMin), (Size::MinorMax, Size::MinorMin)].map(|(max, min)| tolerance(&screw, max, min) / 25.4);
            prop_assert!((root - 1.5 * pitch).abs() < 1.6e-4, "{root} {pitch}");
        }
    }
}

/// Every size of ISO 228-1 and ASME B1.20.1, for there are few.
#[test]
fn pipe_threads_are_ordered_and_taper_by_a_sixteenth() {
    for name in
        ["1/16", "1/8", "1/4", "3/8", "1/2", "3/4", "1", "1 1/4", "1 1/2", "2", "2 1/2", "3", "4", "5", "6"]
    {
        let [a, b] = ["A", "B"].map(|class| side(&format!("G{name}{class}"), Side::External));
        let widths = [&a, &b].map(|screw| tolerance(screw, Size::PitchMax, Size::PitchMin));
        assert!((widths[1] - 2.0 * widths[0]).abs() < 1e-9, "{name}: class B is twice as wide");
        assert!((tolerance(&a, Size::MajorMax, Size::MajorMin) - 2.0 * widths[0]).abs() < 1e-9, "{name}");
        let npt: Thread = format!("{name} NPT").parse().expect("a size");
        let (profile, limits) = (npt.profile(), npt.limits());
        let screw = limits.external.expect("a screw");
        let turn = size(&screw, Size::HandTightMax) - size(&screw, Size::HandTight);
        assert!((turn - profile.pitch_mm / 16.0).abs() < 1e-3, "{name}: {turn}");
        let cone = size(&screw, Size::HandTight) - size(&screw, Size::SmallEnd);
        assert!((cone - size(&screw, Size::HandTightLength) / 16.0).abs() < 1e-3, "{name}: {cone}");
    }
}

/// ISO 7-1 prints the tolerance of a gauge length as ± mm, of parallel nuts as ± a diameter: ours come
/// from whole and quarter turns. Size, of a screw, of a nut, of its diameter.
#[test]
fn jointing_threads_have_the_tolerances_that_iso_7_prints() {
    for (name, screw_mm, nut_mm, parallel_mm) in [
        ("1/16", 0.9, 1.1, 0.071),
        ("1/8", 0.9, 1.1, 0.071),
        ("1/4", 1.3, 1.7, 0.104),
        ("3/8", 1.3, 1.7, 0.104),
        ("1/2", 1.8, 2.3, 0.142),
        ("3/4", 1.8, 2.3, 0.142),
        ("1", 2.3, 2.9, 0.180),
        ("2", 2.3, 2.9, 0.180),
        ("2 1/2", 3.5, 3.5, 0.216),
        ("6", 3.5, 3.5, 0.216),
    ] {
        for (letters, member, off_mm, within) in [
            ("R", Side::External, screw_mm / 16.0, 0.05 / 16.0),
            ("Rc", Side::Internal, nut_mm / 16.0, 0.05 / 16.0),
            ("Rp", Side::Internal, parallel_mm, 1e-3),
        ] {
            let thread = side(&format!("{letters}{name}"), member);
            let half = 0.5 * tolerance(&thread, Size::PitchMax, Size::PitchMin);
            assert!((half - off_mm).abs() < within, "{letters}{name}: {half} {off_mm}");
            assert!(
                (size(&thread, Size::PitchMax) - size(&thread, Size::Pitch) - half).abs() < 1e-9,
                "{name}"
            );
        }
    }
    let screw = side("R1/2", Side::External);
    assert_eq!([Size::GaugeLength, Size::EffectiveLength].map(|of| size(&screw, of)), [8.2, 13.2]);
}

/// A diametral pitch is a module of 25.4/DP.
#[test]
fn a_worm_of_a_diametral_pitch_is_one_of_its_module() {
    let [one, other] = ["worm DP10 z1=2 d44", "module worm m2.54 z1=2 d44"].map(|name| {
        let thread: Thread = name.parse().expect("a worm");
        (thread.limits(), thread.profile())
    });
    assert_eq!(one, other);
}

/// Flanks, triangle, lead and diameters that a gauge measures on.
#[test]
fn profiles_are_those_of_the_standards() {
    let close = |got: f64, want: f64| (got - want).abs() < 1e-6;
    for (name, flank, height) in [
        ("M20x2", 30.0, 0.8660254),
        ("1/4-20 UNC", 30.0, 0.8660254),
        ("Tr40x7", 15.0, 1.8660254),
        ("1/2-10 ACME", 14.5, 1.9333569),
        ("G1/2", 27.5, 0.9604910),
        ("BSW 3/16-24", 27.5, 0.9604910),
        ("NPT 1/2", 30.0, 0.8660254),
    ] {
        let profile = name.parse::<Thread>().expect("a name").profile();
        assert_eq!(profile.flank_deg, [flank; 2], "{name}");
        assert!(close(profile.triangle_mm() / profile.pitch_mm, height), "{name}: {}", profile.triangle_mm());
        assert!(
            profile.minor_mm < profile.pitch_diameter_mm && profile.pitch_diameter_mm < profile.major_mm,
            "{name}"
        );
    }
    let two: Thread = "Tr40x14P7 LH".parse().expect("a name");
    let profile = two.profile();
    assert_eq!(
        (profile.lead_mm(), profile.pitch_mm, profile.starts, profile.left_hand),
        (14.0, 7.0, 2, true)
    );
    assert_eq!("NPT 1/2".parse::<Thread>().expect("a name").profile().taper, 1.0 / 16.0);
    assert!(close("M20x2".parse::<Thread>().expect("a name").profile().pitch_diameter_mm, 18.700962));
}

/// UNJ is UN with another root, and a nut that is clear of it. The root is an arc that touches both flanks:
/// seen from the pitch line it goes to H/2 − R.
#[test]
fn unj_differs_at_the_root_and_at_the_crest_of_the_nut() {
    for (size, tpi, series) in
        [("1/4", 28.0, "F"), ("1/4", 20.0, "C"), ("1/2", 13.0, "C"), ("1", 12.0, "F"), ("#10", 32.0, "F")]
    {
        let of = |letter: &str, class: &str, member| {
            side(&format!("{size}-{tpi} UN{letter}{series}-{class}"), member)
        };
        let [un, unj] = ["", "J"].map(|letter| of(letter, "3A", Side::External));
        for size in [Size::MajorMax, Size::MajorMin, Size::PitchMax, Size::PitchMin] {
            assert_eq!(un.get(size), unj.get(size));
        }
        let pitch = 25.4 / tpi;
        let below = |of: Size, root: Size| 0.5 * (self::size(&unj, of) - self::size(&unj, root)) / pitch;
        // The apex of the flanks is √3/4 of a pitch below the pitch line, and the arc ends R above it.
        let apex = 0.75_f64.sqrt() / 2.0;
        let [deep, shallow] = [below(Size::PitchMin, Size::MinorMin), below(Size::PitchMax, Size::MinorMax)];
        let places = 0.0001 * tpi;
        assert!(
            (apex - deep - 0.15011).abs() < places && (apex - shallow - 0.18042).abs() < places,
            "{deep} {shallow}"
        );
        let [un, unj] = ["", "J"].map(|letter| of(letter, "3B", Side::Internal));
        for size in [Size::MajorMin, Size::PitchMax, Size::PitchMin] {
            assert_eq!(un.get(size), unj.get(size));
        }
        // The crest of its nut does not meet the largest radius, and leaves less of the thread than UN.
        let nut = self::size(&unj, Size::MinorMin);
        let screw = side(&format!("{size}-{tpi} UNJ{series}-3A"), Side::External);
        assert!(nut > self::size(&un, Size::MinorMin) && nut > self::size(&screw, Size::MinorMax));
        assert!(unj.get(Size::MinorMax).is_none());
    }
}

/// Both flanks of a buttress thread and its diameters belong together: the crest is 0.16316 p wide, and the
/// nut is clear of the screw at both crests.
#[test]
fn buttress_sizes_follow_from_their_flanks() {
    for (name, lower) in
        [("2-4 BUTT", 45.0), ("2-4 PUSH-BUTT", 7.0), ("1-12 BUTT", 45.0), ("10-2.5 BUTT LH", 45.0)]
    {
        let thread: Thread = name.parse().expect("a buttress thread");
        let profile = thread.profile();
        assert_eq!(profile.flank_deg, if lower == 45.0 { [45.0, 7.0] } else { [7.0, 45.0] });
        let p = profile.pitch_mm;
        assert!((profile.triangle_mm() / p - 0.89064).abs() < 1e-5);
        let tangents: f64 = profile.flank_deg.iter().map(|deg| libm::tan(deg.to_radians())).sum();
        let crest = 0.5 * p - 0.5 * (profile.major_mm - profile.pitch_diameter_mm) * tangents;
        assert!((crest / p - 0.16316).abs() < 1e-5, "{crest}");
        let limits = thread.limits();
        let (screw, nut) = (limits.external.expect("a screw"), limits.internal.expect("a nut"));
        assert!(size(&screw, Size::MajorMax) < size(&nut, Size::MajorMin));
        assert!(size(&screw, Size::MinorMax) < size(&nut, Size::MinorMin));
        let allowance = size(&nut, Size::PitchMin) - size(&screw, Size::PitchMax);
        let third = side(&format!("{}-3A", name.trim_end_matches(" LH")), Side::External);
        assert!((allowance - tolerance(&third, Size::PitchMax, Size::PitchMin)).abs() < UM);
        // Deepest and highest root of the screw lie apart as its flanks and its least radius allow.
        assert!(size(&screw, Size::MinorMin) < size(&screw, Size::MinorMax));
    }
}
