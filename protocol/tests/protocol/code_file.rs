//! Machine-code files: what is written can be read, and nothing else can.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use protocol::{
    Arc, Axis, AxisLaw, ByHand, Code, Curve, Feed, Item, PathMode, PerAxis, Plane, Position, Refused, Set,
    Shape, SpindleMode, SpindleSpeed, ThreadPass, Until, Variation, VariationShape, Work,
    code_file::{CodeFile, CodeFileError, CodeReader, CodeWriter, Identity, VERSION},
};
use shape::{
    Branch, Contour, Correction, Formula, Function, Op, Pattern, Seam, SeamCurve, Side, Surface, Tool,
};

/// Bytes before the content.
const HEAD: usize = 18;

fn bytes_of(file: &CodeFile) -> Vec<u8> {
    let mut bytes = Vec::new();
    file.write(&mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> Result<CodeFile, CodeFileError> {
    CodeFile::read(&mut &bytes[..])
}

/// A small lathe.
fn lathe() -> Identity {
    Identity { name: "small lathe".into(), cycle_s: 0.0005, interpolator_cycle_s: 0.002 }
}

fn program(items: Vec<Item>) -> CodeFile {
    CodeFile::new("part.ngc", &lathe(), items)
}

fn pass() -> ThreadPass {
    let law = AxisLaw {
        lead_mm: -2.0,
        run_in_dc_deg: 90.0,
        run_in_lambda: 0.25,
        brake_c_deg: 3600.0,
        brake_dc_deg: 90.0,
        brake_lambda: 0.25,
        ..AxisLaw::default()
    };
    let mut pass = ThreadPass { s_rpm: 600.0, direction: 1.0, max_ratio: 1.2, ..ThreadPass::default() };
    pass.axes[2] = law;
    pass
}

fn any_arc() -> impl Strategy<Value = Arc> {
    let mm = || (-1e3..1e3).prop_map(Position::from_mm);
    let turns = prop_oneof![1..100, -100..0];
    let plane = prop::sample::select(&Plane::ALL);
    (plane, prop::array::uniform8(mm()), prop::array::uniform2(mm()), turns).prop_filter_map(
        "no radius",
        |(plane, target, center, turns)| {
            let arc = Arc { plane, target, center, turns };
            arc.check().is_ok().then_some(arc)
        },
    )
}

fn any_speed() -> impl Strategy<Value = SpindleSpeed> {
    let surface = (0.0..1e4, 1e-3..1e5, any::<i64>())
        .prop_map(|(mm_s, max_rpm, axis)| SpindleSpeed::Surface { mm_s, max_rpm, axis_mm: Position(axis) });
    prop_oneof![(0.0..1e5).prop_map(SpindleSpeed::Rpm), surface]
}

fn any_path_mode() -> impl Strategy<Value = PathMode> {
    let blend = (0.0..=10.0, 0.0..=10.0)
        .prop_map(|(tolerance_mm, merge_mm)| PathMode::Blend { tolerance_mm, merge_mm });
    prop_oneof![Just(PathMode::ExactStop), Just(PathMode::ExactPath), blend]
}

fn any_formula() -> impl Strategy<Value = Formula> {
    let (x, y) = (Op::Variable(0), Op::Variable(1));
    (prop::num::f64::NORMAL, -64..=63, prop::sample::select(&Function::ALL)).prop_map(
        move |(number, exponent, function)| {
            let ops = [Op::Constant(number), x, Op::Powi(exponent), Op::Mul, y, Op::Apply(function), Op::Add];
            Formula::new(&ops).unwrap()
        },
    )
}

fn any_trace() -> impl Strategy<Value = Work> {
    let contour = (-1e3..1e3, 0.0..10.0)
        .prop_map(|(x, radius_mm)| Contour { x: [x, 2e3], radius_mm, side: Side::Right })
        .prop_map(|contour| Shape::Contour(contour, [Axis::Z, Axis::X]));
    let pattern = prop_oneof![
        (any::<[bool; 2]>(), 2_u32..1000).prop_map(|([along_y, zigzag], count)| Pattern::Lines {
            along_y,
            count,
            zigzag
        }),
        (1_u32..1000).prop_map(|count| Pattern::Rings { count }),
        (0.0..1e3).prop_map(|end| Pattern::Curve { t: [-1.0, end] }),
    ];
    let surface = (pattern, -1e3..0.0, 0.0..1e3).prop_map(|(pattern, low, clear_mm)| {
        let tool = Tool { radius_mm: 3.0, corner_mm: 1.0 };
        Shape::Surface(Surface { x: [low, 1.0], y: [low, 2.0], tool, pattern, clear_mm })
    });
    let seam = prop::array::uniform6(prop::array::uniform8(-1e6..1e6)).prop_map(|coefficients| {
        let curve = SeamCurve::Polynomials(coefficients);
        Shape::Seam(Seam {
            curve,
            t: [0.0, 1.0],
            branch: Branch::Positive,
            idle_beta_deg: -720.0,
            moved: None,
        })
    });
    let origin = prop::array::uniform3(any::<i64>().prop_map(Position));
    (prop_oneof![contour, surface, seam], origin, 1e-3..1e5, 1e-6..1.0).prop_map(
        |(work, origin, feed_mm_min, chord_mm)| {
            let seam = matches!(work, Shape::Seam(_));
            let correction = if seam { Correction::Exact } else { Correction::Mixed };
            Work { shape: work, origin, feed_mm_min, chord_mm, correction }
        },
    )
}

fn any_item() -> impl Strategy<Value = Item> {
    let target = prop::array::uniform8(any::<i64>().prop_map(Position));
    let feed = prop_oneof![
        Just(Feed::Rapid),
        (1e-3..1e5).prop_map(Feed::PerMinute),
        (1e-6..100.0).prop_map(Feed::PerRevolution)
    ];
    let feed_of_arc =
        prop_oneof![(1e-3..1e5).prop_map(Feed::PerMinute), (1e-6..100.0).prop_map(Feed::PerRevolution)];
    let mode = prop_oneof![
        Just(SpindleMode::Stop),
        Just(SpindleMode::Clockwise),
        Just(SpindleMode::Counterclockwise)
    ];
    let code = prop_oneof![
        (target, feed).prop_map(|(target, feed)| Code::Line { target, feed }),
        (0.0..1e4).prop_map(|seconds| Code::Dwell { seconds }),
        (mode, any_speed()).prop_map(|(mode, speed)| Code::Spindle { mode, speed }),
        any_path_mode().prop_map(Code::PathMode),
        (any_arc(), feed_of_arc).prop_map(|(arc, feed)| Code::Arc { arc, feed }),
        (1e-3..1e3, -1.0..1.0).prop_map(|(length_mm, bend)| {
            let rows = [[0.6, -0.8, 0.0], [bend, 0.0, bend], [0.0, bend, 0.0]];
            let curve =
                Curve { target: PerAxis::default(), way: [bend; 3], start: rows, end: rows, length_mm };
            Code::Curve { curve, feed: Feed::PerMinute(100.0) }
        }),
        any::<u32>().prop_map(|number| Code::Tool { number }),
        any::<(bool, bool)>().prop_map(|(mist, flood)| Code::Coolant { mist, flood }),
        (0_u8..64, any::<(bool, bool)>())
            .prop_map(|(number, (on, in_step))| { Code::Output { number, set: Set::Digital(on), in_step } }),
        (0_u8..4, -1e9..1e9, any::<bool>()).prop_map(|(number, value, in_step)| {
            Code::Output { number, set: Set::Analog(value), in_step }
        }),
        (0_u8..64, 1e-3..1e5).prop_map(|(input, within_s)| Code::Await {
            input,
            until: Until::Fall,
            within_s
        }),
        Just(Code::Pause),
        Just(Code::OptionalPause),
        Just(Code::ByHand(ByHand::Waits)),
        any::<bool>().prop_map(|jogs| Code::ByHand(ByHand::Begins { at: PerAxis::default(), jogs })),
        (0.001..0.5, 0.25..1000.0).prop_map(|(share, revolutions)| {
            Code::Variation(Some(Variation { shape: VariationShape::Random, share, revolutions }))
        }),
        Just(Code::Variation(None)),
        (1e-3..1e5).prop_map(|s_rpm| Code::Pass(ThreadPass { s_rpm, ..pass() })),
        (0_u8..6, any_formula()).prop_map(|(slot, formula)| Code::Formula { slot, formula }),
        any_trace().prop_map(Code::Work),
        Just(Code::End),
    ];
    (any::<u32>(), code).prop_map(|(line, code)| Item { line, code })
}

proptest! {
    #[test]
    fn what_is_written_can_be_read(items in prop::collection::vec(any_item(), 0..40)) {
        let file = program(items);
        prop_assert_eq!(read(&bytes_of(&file)).unwrap(), file);
    }

    #[test]
    fn a_single_wrong_byte_is_refused(
        items in prop::collection::vec(any_item(), 0..8), place: prop::sample::Index, flip in 1u8..,
    ) {
        let mut bytes = bytes_of(&program(items));
        let place = place.index(bytes.len());
        bytes[place] ^= flip;
        prop_assert!(read(&bytes).is_err(), "byte {}", place);
    }

    #[test]
    fn a_part_of_a_file_is_refused(items in prop::collection::vec(any_item(), 0..8), end: prop::sample::Index) {
        let bytes = bytes_of(&program(items));
        let error = read(&bytes[..end.index(bytes.len())]).unwrap_err();
        let cut_off = matches!(error, CodeFileError::Truncated { .. });
        prop_assert!(cut_off, "{}", error);
    }

    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(read(&bytes).is_err());
    }

    #[test]
    fn any_content_with_a_right_checksum_is_read_or_refused(content in prop::collection::vec(any::<u8>(), 0..400)) {
        if let Ok(file) = read(&with_head(&content)) {
            prop_assert!(file.items.iter().all(|item| item.check().is_ok()));
        }
    }
}

/// Magic and version.
fn head() -> Vec<u8> {
    [&b"PLMC"[..], &VERSION.to_le_bytes()].concat()
}

fn with_head(content: &[u8]) -> Vec<u8> {
    let mut bytes = head();
    bytes.extend((content.len() as u64).to_le_bytes());
    bytes.extend(crc32fast::hash(content).to_le_bytes());
    bytes.extend(content);
    bytes
}

#[test]
fn each_kind_of_wrong_file_has_its_message() {
    let bytes = bytes_of(&program(vec![Item { line: 1, code: Code::End }]));
    let foreign = read(b"G1 X10 Z-20 F100").unwrap_err();
    assert!(matches!(foreign, CodeFileError::Foreign), "{foreign}");

    let mut later = bytes.clone();
    later[4] += 1;
    let error = read(&later).unwrap_err();
    assert_eq!(
        error.to_string(),
        format!(
            "this is machine code of version {}, and version {VERSION} is needed: compile the program again",
            VERSION + 1
        )
    );

    let error = read(&bytes[..bytes.len() - 3]).unwrap_err();
    assert!(matches!(error, CodeFileError::Truncated { missing: 3 }), "{error}");

    let longer = [&bytes[..], b"\n"].concat();
    assert!(matches!(read(&longer), Err(CodeFileError::Trailing)));

    let inside = with_head(&[&bytes[HEAD..], b"\0"].concat());
    assert!(matches!(read(&inside), Err(CodeFileError::Trailing)));

    let mut damaged = bytes;
    damaged[HEAD + 3] ^= 1;
    assert!(matches!(read(&damaged), Err(CodeFileError::Damaged)));
}

#[test]
fn hostile_lengths_take_no_memory() {
    let mut bytes = head();
    bytes.extend(u64::MAX.to_le_bytes());
    assert!(matches!(read(&bytes), Err(CodeFileError::TooLong(u64::MAX))));

    // A name of 2^60 bytes, and an empty program with 2^60 items.
    let huge = [&[253][..], &(1u64 << 60).to_le_bytes()].concat();
    assert!(matches!(read(&with_head(&huge)), Err(CodeFileError::Content(_))));
    let items = [&[0; 18][..], &huge].concat();
    assert!(matches!(read(&with_head(&items)), Err(CodeFileError::Content(_))));
}

#[test]
fn a_file_is_none_before_all_that_was_said_is_there() {
    let item = Item { line: 1, code: Code::Pause };
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = CodeWriter::new(&mut bytes, "part.ngc", &lathe(), 2).unwrap();
    writer.put(&item).unwrap();
    let error = writer.finish().unwrap_err();
    assert!(matches!(error, CodeFileError::Recounted { said: 2, given: 1 }), "{error}");
    assert!(matches!(read(bytes.get_ref()), Err(CodeFileError::Foreign)));

    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = CodeWriter::new(&mut bytes, "part.ngc", &lathe(), 1).unwrap();
    writer.put(&item).unwrap();
    let error = writer.put(&item).unwrap_err();
    assert!(matches!(error, CodeFileError::Recounted { said: 1, given: 2 }), "{error}");
}

#[test]
fn an_impossible_item_is_neither_written_nor_read() {
    let wrong = Item { line: 9, code: Code::Dwell { seconds: f64::NAN } };
    let file = program(vec![Item { line: 1, code: Code::End }, wrong]);
    let expected = Refused::NotFinite("dwell");
    for error in [
        file.write(&mut Vec::new()).unwrap_err(),
        read(&with_head(&bincode::serde::encode_to_vec(&file, bincode::config::standard()).unwrap()))
            .unwrap_err(),
    ] {
        assert!(
            matches!(error, CodeFileError::Item { number: 1, line: 9, reason } if reason == expected),
            "{error}"
        );
    }
}

#[test]
fn a_file_belongs_to_its_machine() {
    let mut machine = lathe();
    let file = CodeReader::new(std::io::Cursor::new(bytes_of(&program(Vec::new())))).unwrap();
    file.check_machine(&machine).unwrap();
    machine.interpolator_cycle_s = 0.004;
    let error = file.check_machine(&machine).unwrap_err();
    assert!(error.to_string().contains("compile the program for this machine"), "{error}");
}
