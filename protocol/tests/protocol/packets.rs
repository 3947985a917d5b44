//! Machine code as packets: every item travels, each kind within its size; damaged, cut off and foreign bytes
//! are refused.
#![allow(clippy::unwrap_used)]

use motion::MOST_CHANGES;
use proptest::prelude::*;
use protocol::*;
use shape::{
    Branch, Contour, Correction, Formula, Function, Meeting, Op, Pattern, Quadric, Ruled, Seam, SeamCurve,
    Side, Surface, Tool,
};

/// Numbers and positions that take the most bytes.
const LONG: f64 = 0.1;
const FAR: Position = Position(i64::MIN);

fn long_item(code: Code) -> Item {
    Item { line: u32::MAX, code }
}

fn bytes_of(item: &Item) -> usize {
    CodePacket::pack(u64::MAX, item).as_bytes().len()
}

/// A law in which everything occurs, of its own windows.
fn busy_law(number: usize) -> AxisLaw {
    let own = 1.0 + 0.1 * number as f64;
    AxisLaw {
        start: FAR,
        end: Position(number as i64),
        stroke_mm: own * 0.1,
        stroke_c0_deg: own * 0.2,
        stroke_dc_deg: own * 0.3,
        unload_mm: own * 0.01,
        unload_dc_deg: own * 0.02,
        lead_mm: own * 0.7,
        steepest_mm: own * 0.7,
        run_in_c0_deg: own * 0.4,
        run_in_dc_deg: own * 0.6,
        run_in_lambda: own * 0.11,
        brake_c_deg: own * 1.3,
        brake_dc_deg: own * 0.9,
        brake_lambda: own * 0.13,
        retract_mm: own * 0.17,
        retract_c_deg: own * 1.7,
        retract_dc_deg: own * 0.19,
    }
}

/// A pass that moves every axis in its own way.
fn busy_pass() -> ThreadPass {
    ThreadPass {
        out: WayOut { axis: 7, leaves: 7, clear: Position(i64::MIN), free: Position(i64::MAX) },
        pass: u32::MAX,
        start: u32::MAX,
        s_rpm: LONG,
        direction: -LONG,
        start_angle_deg: LONG,
        lead_mm: LONG,
        thread_end_deg: LONG,
        max_ratio: LONG,
        depth_mm: LONG,
        return_ratio: LONG,
        dwell_s: LONG,
        axes: std::array::from_fn(busy_law),
        corners: [Corner { c_deg: LONG, dc_deg: LONG, x_mm: [LONG; 2], z_mm: [LONG; 2] }; MOST_CHANGES],
    }
}

/// As many operations and constants as there may be: sums of constants and powers of the variable.
fn long_formula() -> Formula {
    let sum = |n: usize| [Op::Constant(LONG * n as f64), Op::Add];
    let mut ops = vec![Op::Variable(0)];
    ops.extend((0..Formula::CONSTANTS).flat_map(sum));
    ops.resize(Formula::OPS, Op::Powi(-2));
    Formula::new(&ops).unwrap()
}

fn work(shape: Shape) -> Code {
    let (origin, correction) = ([FAR; 3], Correction::Exact);
    Code::Work(Work { shape, origin, feed_mm_min: LONG, chord_mm: LONG, correction })
}

fn surface(pattern: Pattern) -> Shape {
    let tool = Tool { radius_mm: LONG, corner_mm: LONG };
    Shape::Surface(Surface { x: [LONG; 2], y: [LONG; 2], tool, pattern, clear_mm: LONG })
}

fn seam(curve: SeamCurve) -> Shape {
    Shape::Seam(Seam {
        curve,
        t: [0.0, LONG],
        branch: Branch::Negative,
        idle_beta_deg: LONG,
        moved: Some([LONG; 2]),
    })
}

fn meeting() -> Meeting {
    let first = Ruled { at: [LONG; 3], axis: [LONG; 3], zero: [LONG; 3], radius_mm: LONG, slope: LONG };
    let second = Quadric { at: [LONG; 3], axis: [LONG; 3], c: [LONG; 4] };
    Meeting { first, second, leaving: true, share: LONG }
}

fn long_curve() -> Curve {
    let rows = [[LONG; 3]; 3];
    Curve { target: [FAR; 8], way: [LONG; 3], start: rows, end: rows, length_mm: LONG }
}

/// The longest item of each kind, and its bytes: whoever changes what is sent sees here what it costs.
#[test]
fn each_kind_of_item_has_its_largest_size() {
    let feed = Feed::PerRevolution(LONG);
    let target = [FAR; 8];
    let arc = Arc { plane: Plane::ALL[2], target, center: [FAR; 2], turns: i32::MIN };
    let surface_speed = SpindleSpeed::Surface { mm_s: LONG, max_rpm: LONG, axis_mm: FAR };
    let contour = Contour { x: [LONG; 2], radius_mm: LONG, side: Side::Left };
    let lines = Pattern::Lines { along_y: true, count: u32::MAX, zigzag: true };
    let variation = Variation { shape: VariationShape::Random, share: LONG, revolutions: LONG };
    let table = [
        ("line", Code::Line { target, feed }, 96),
        ("arc", Code::Arc { arc, feed }, 120),
        ("piece of a curve", Code::Curve { curve: long_curve(), feed }, 272),
        ("path mode", Code::PathMode(PathMode::Blend { tolerance_mm: LONG, merge_mm: LONG }), 32),
        ("dwell", Code::Dwell { seconds: LONG }, 23),
        ("spindle", Code::Spindle { mode: SpindleMode::Counterclockwise, speed: surface_speed }, 42),
        ("variation", Code::Variation(Some(variation)), 33),
        ("tool", Code::Tool { number: u32::MAX }, 20),
        ("coolant", Code::Coolant { mist: true, flood: true }, 17),
        ("output", Code::Output { number: 63, set: Set::Digital(true), in_step: true }, 19),
        ("analog output", Code::Output { number: 3, set: Set::Analog(LONG), in_step: true }, 26),
        ("wait for an input", Code::Await { input: 63, until: Until::Low, within_s: LONG }, 25),
        ("pause", Code::Pause, 15),
        ("optional pause", Code::OptionalPause, 15),
        ("pass", Code::Pass(busy_pass()), 1921),
        ("formula", Code::Formula { slot: u8::MAX, formula: long_formula() }, 370),
        ("contour", work(Shape::Contour(contour, [Axis::C, Axis::C])), 87),
        ("lines", work(surface(lines)), 124),
        ("rings", work(surface(Pattern::Rings { count: u32::MAX })), 122),
        ("curve", work(surface(Pattern::Curve { t: [LONG; 2] })), 133),
        ("seam of formulas", work(seam(SeamCurve::Formulas)), 103),
        ("seam of polynomials", work(seam(SeamCurve::Polynomials([[LONG; 8]; 6]))), 487),
        ("meeting", work(seam(SeamCurve::Meeting(meeting()))), 280),
        ("end", Code::End, 15),
    ];
    let found = table.map(|(name, code, _)| (name, bytes_of(&long_item(code))));
    assert_eq!(found, table.map(|(name, _, bytes)| (name, bytes)));
    let longest = found.iter().map(|(_, bytes)| *bytes).max().unwrap();
    assert!(longest <= CodePacket::LONGEST, "{longest}");
}

/// Bit for bit, which `PartialEq` does not see of −0 and what is not a number.
fn same_bits(one: &Item, other: &Item) -> bool {
    CodePacket::pack(0, one) == CodePacket::pack(0, other) && format!("{one:?}") == format!("{other:?}")
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        Just(-0.0),
        Just(f64::NAN),
        Just(f64::INFINITY),
        (-1000i32..1000).prop_map(|n| f64::from(n) / 8.0),
        any::<f64>(),
    ]
}

fn position() -> impl Strategy<Value = Position> {
    prop_oneof![Just(Position(0)), any::<i64>().prop_map(Position), (-100i64..100).prop_map(Position)]
}

/// Any law: parts that are missing, like those of another axis, or half made.
fn law() -> impl Strategy<Value = AxisLaw> {
    let part = || prop_oneof![Just([0.0; 3]), Just([0.5; 3]), prop::array::uniform3(number())];
    let more = (number(), any::<bool>());
    (position(), position(), part(), part(), more, part(), part(), part()).prop_map(
        |(start, end, stroke, unload, (lead_mm, with_brake), run_in, brake, retract)| {
            let retract = if with_brake { [0.0, brake[0], brake[1]] } else { retract };
            AxisLaw {
                start,
                end,
                stroke_mm: stroke[0],
                stroke_c0_deg: stroke[1],
                stroke_dc_deg: stroke[2],
                unload_mm: unload[0],
                unload_dc_deg: unload[1],
                lead_mm,
                steepest_mm: 0.0,
                run_in_c0_deg: run_in[0],
                run_in_dc_deg: run_in[1],
                run_in_lambda: run_in[2],
                brake_c_deg: brake[0],
                brake_dc_deg: brake[1],
                brake_lambda: brake[2],
                retract_mm: retract[0],
                retract_c_deg: retract[1],
                retract_dc_deg: retract[2],
            }
        },
    )
}

/// Corners, some of them, and what no sender makes of them.
fn corners() -> impl Strategy<Value = Corners> {
    let corner = (prop::array::uniform2(number()), prop::array::uniform4(number()));
    prop::collection::vec(corner, 0..=MOST_CHANGES).prop_map(|some| {
        let mut corners = Corners::default();
        for (corner, ([c_deg, dc_deg], [x, x_grows, z, z_grows])) in corners.iter_mut().zip(some) {
            *corner = Corner { c_deg, dc_deg, x_mm: [x, x_grows], z_mm: [z, z_grows] };
        }
        corners
    })
}

fn pass() -> impl Strategy<Value = ThreadPass> {
    let laws = prop::collection::vec(prop_oneof![Just(AxisLaw::default()), law()].boxed(), 8);
    let out = (0u32..8, 0u32..8, position(), position());
    (any::<[u32; 2]>(), prop::array::uniform8(number()), out, laws, corners()).prop_map(
        |(
            [pass, start],
            [s_rpm, direction, start_angle_deg, lead_mm, end, max_ratio, depth_mm, dwell_s],
            out,
            laws,
            corners,
        )| {
            let mut axes: PerAxis<AxisLaw> = laws.try_into().unwrap();
            for (axis, law) in Axis::ALL.into_iter().zip(&mut axes) {
                let locked_deg = law.run_in_c0_deg + law.run_in_dc_deg;
                law.steepest_mm = Changes::of(&corners, axis).steepest_mm(law.lead_mm, locked_deg);
            }
            let thread_end_deg = end;
            ThreadPass {
                out: WayOut { axis: out.0, leaves: out.1, clear: out.2, free: out.3 },
                pass,
                start,
                s_rpm,
                direction,
                start_angle_deg,
                lead_mm,
                thread_end_deg,
                max_ratio,
                depth_mm,
                return_ratio: dwell_s / 2.0,
                dwell_s,
                axes,
                corners,
            }
        },
    )
}

/// A packet of every kind.
fn packets() -> Vec<CodePacket> {
    let wave = [Op::Variable(0), Op::Constant(15.0), Op::Div, Op::Apply(Function::Sin)];
    let codes = [
        Code::Line { target: [Position(7_000_000_000); 8], feed: Feed::PerMinute(100.0) },
        Code::PathMode(PathMode::Blend { tolerance_mm: 0.02, merge_mm: 0.01 }),
        Code::Spindle { mode: SpindleMode::Clockwise, speed: SpindleSpeed::Rpm(600.0) },
        Code::Coolant { mist: true, flood: false },
        Code::Formula { slot: 1, formula: Formula::new(&wave).unwrap() },
        work(Shape::Contour(
            Contour { x: [0.0, 1.0], radius_mm: 1.0, side: Side::Right },
            [Axis::X, Axis::Z],
        )),
        Code::End,
    ];
    codes.iter().map(|code| CodePacket::pack(0, &Item { line: 1, code: *code })).collect()
}

#[test]
fn a_packet_that_is_cut_off_or_goes_on_is_refused() {
    for packet in packets() {
        let bytes = packet.as_bytes();
        assert!(packet.unpack(0).is_ok());
        assert_eq!(CodePacket::from_bytes(bytes), Ok(packet));
        for length in 0..bytes.len() {
            let cut = CodePacket::from_bytes(&bytes[..length]).unwrap();
            assert_eq!(cut.unpack(0), Err(Refused::Unreadable("machine code")), "{length} of {packet:?}");
        }
        for behind in [0, 1, 255] {
            let longer = CodePacket::from_bytes(&[bytes, &[behind]].concat()).unwrap();
            assert_eq!(longer.unpack(0), Err(Refused::Unreadable("machine code")), "{packet:?}");
        }
    }
    let too_long = CodePacket::from_bytes(&[0; CodePacket::LONGEST + 1]);
    assert_eq!(too_long, Err(Refused::OutOfRange("length of a packet")));
}

/// A length that claims more than there can be takes no memory, and codes that stand for nothing are none.
#[test]
fn what_no_version_writes_cannot_be_read() {
    let unreadable = |bytes: &[u8]| {
        let packet = CodePacket::from_bytes(bytes).unwrap();
        assert_eq!(packet.unpack(0), Err(Refused::Unreadable("machine code")), "{bytes:?}");
    };
    unreadable(&[0, 1, 15]); // no such kind
    unreadable(&[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3]); // a line at no such feed
    unreadable(&[0, 1, 11, 0, 97]); // a formula of 97 operations
    unreadable(&[0, 1, 11, 0, 253, 255, 255, 255, 255, 255, 255, 255, 255]);
    unreadable(&[0, 1, 11, 0, 1, 99, 0]); // of one that does not exist
    unreadable(&[0, 1, 11, 0, 1, 4, 0]); // of a sum of nothing
    unreadable(&[0, 1, 6, 2, 0]); // mist neither on nor off
    unreadable(&[0, 1, 14, 1, 3]); // a variation of no such shape
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_pass_travels_bit_for_bit(pass in pass(), sequence in any::<u64>(), line in any::<u32>()) {
        let item = Item { line, code: Code::Pass(pass) };
        let packet = CodePacket::pack(sequence, &item);
        match packet.unpack(sequence) {
            Ok(read) => prop_assert!(same_bits(&read, &item)),
            Err(refused) => prop_assert_eq!(Err(refused), item.check()),
        }
        // Whether or not it could be cut, nothing of it is lost in a file.
        let bytes = bincode::serde::encode_to_vec(pass, bincode::config::standard()).unwrap();
        let read: (ThreadPass, usize) =
            bincode::serde::decode_from_slice(&bytes, bincode::config::standard()).unwrap();
        prop_assert_eq!(format!("{:?}", read.0), format!("{pass:?}"));
        prop_assert_eq!(read.1, bytes.len());
    }

    #[test]
    fn any_bytes_are_an_item_that_travels_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..CodePacket::LONGEST + 8),
        kind in 0..14u8,
    ) {
        let bytes = [&[0, 1, kind], &bytes[..]].concat();
        if let Ok(item) = CodePacket::from_bytes(&bytes).and_then(|packet| packet.unpack(0)) {
            prop_assert!(item.check().is_ok());
            prop_assert!(CodePacket::pack(0, &item).unpack(0).is_ok());
        }
    }

    #[test]
    fn a_damaged_packet_is_refused_or_an_item_that_could_have_been_sent(
        which in 0..7usize, place in any::<prop::sample::Index>(), bit in 0..8u8,
    ) {
        let mut bytes = packets()[which].as_bytes().to_vec();
        let place = place.index(bytes.len());
        bytes[place] ^= 1 << bit;
        if let Ok(item) = CodePacket::from_bytes(&bytes).unwrap().unpack(0) {
            prop_assert!(item.check().is_ok());
        }
    }
}
