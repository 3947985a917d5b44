//! Packets of formulas and traces: what is packed can be unpacked, and what no interpreter sends is refused.
#![allow(clippy::unwrap_used)]

use protocol::*;
use shape::{
    Branch, Contour, Correction, Formula, Function, Meeting, Op, Pattern, Quadric, Ruled, Seam, SeamCurve,
    Side, Surface, Tool,
};

/// 0.02 x² + 8 sin(x/15), and traces of every kind of work that refers to formulas.
fn formula() -> Formula {
    let (x, number) = (Op::Variable(0), Op::Constant);
    let ops = [x, Op::Powi(2), number(0.02), Op::Mul, x, number(15.0), Op::Div, Op::Apply(Function::Sin)];
    Formula::new(&[&ops[..], &[number(8.0), Op::Mul, Op::Add]].concat()).unwrap()
}

fn trace(work: Shape) -> Work {
    let origin = [Position(7), Position(i64::MIN), Position(-9)];
    let seam = matches!(work, Shape::Seam(_));
    let correction = if seam { Correction::Exact } else { Correction::PublishedSigns };
    Work { shape: work, origin, feed_mm_min: 1500.0, chord_mm: 0.002, correction }
}

fn contour() -> Contour {
    Contour { x: [10.0, -3.0], radius_mm: 2.0, side: Side::Left }
}

fn surface(pattern: Pattern) -> Surface {
    let tool = Tool { radius_mm: 3.0, corner_mm: 3.0 };
    Surface { x: [0.0, 100.0], y: [-40.0, 40.0], tool, pattern, clear_mm: 250.0 }
}

fn seam(curve: SeamCurve) -> Seam {
    Seam { curve, t: [0.0, 6.25], branch: Branch::Positive, idle_beta_deg: 0.5, moved: Some([0.01, -2.0]) }
}

fn meeting() -> Meeting {
    let first =
        Ruled { at: [1.0; 3], axis: [0.0, 0.0, 1.0], zero: [1.0, 0.0, 0.0], radius_mm: 30.0, slope: 0.0 };
    let second = Quadric { at: [0.0; 3], axis: [0.0, 1.0, 0.0], c: [-400.0, 0.0, 0.0, 1.0] };
    Meeting { first, second, leaving: true, share: 0.5 }
}

fn traces() -> Vec<Work> {
    let coefficients = std::array::from_fn(|i| std::array::from_fn(|k| i as f64 - 0.3 * k as f64));
    let patterns = [
        Pattern::Lines { along_y: true, count: 1_000_000, zigzag: false },
        Pattern::Rings { count: 40 },
        Pattern::Curve { t: [1.0, -1.0] },
    ];
    let seams = [SeamCurve::Formulas, SeamCurve::Polynomials(coefficients), SeamCurve::Meeting(meeting())];
    let mut works = vec![Shape::Contour(contour(), [Axis::Z, Axis::X])];
    works.extend(patterns.map(|pattern| Shape::Surface(surface(pattern))));
    works.extend(seams.map(|curve| Shape::Seam(seam(curve))));
    works.into_iter().map(trace).collect()
}

#[test]
fn every_formula_and_trace_travels() {
    let formulas = [formula(), Formula::default()].map(|formula| Code::Formula { slot: 5, formula });
    for code in formulas.into_iter().chain(traces().into_iter().map(Code::Work)) {
        let item = Item { line: 5, code };
        assert_eq!(CodePacket::pack(3, &item).unpack(3), Ok(item));
    }
}

#[test]
fn formulas_that_no_interpreter_sends_are_refused() {
    let pack = |slot, formula| CodePacket::pack(0, &Item { line: 1, code: Code::Formula { slot, formula } });
    assert_eq!(pack(6, formula()).unpack(0), Err(Refused::OutOfRange("number of a formula")));
}

#[test]
fn traces_that_no_interpreter_sends_are_refused() {
    let unpack = |trace: Work| CodePacket::pack(0, &Item { line: 1, code: Code::Work(trace) }).unpack(0);
    let refused = |work: Shape| unpack(trace(work)).unwrap_err();
    let on_contour = |change: fn(&mut Contour)| {
        let mut contour = contour();
        change(&mut contour);
        refused(Shape::Contour(contour, [Axis::X, Axis::Y]))
    };
    assert_eq!(on_contour(|contour| contour.x[0] = f64::NAN), Refused::NotFinite("domain of a contour"));
    assert_eq!(on_contour(|contour| contour.x = [3.0; 2]), Refused::OutOfRange("domain of a contour"));
    assert_eq!(on_contour(|contour| contour.radius_mm = -1.0), Refused::OutOfRange("radius of a tool"));
    for axes in [[Axis::X; 2], [Axis::X, Axis::C]] {
        assert_eq!(refused(Shape::Contour(contour(), axes)), Refused::OutOfRange("axes of a contour"));
    }
    let on_surface = |change: fn(&mut Surface)| {
        let mut surface = surface(Pattern::Rings { count: 3 });
        change(&mut surface);
        refused(Shape::Surface(surface))
    };
    let rings = |count| Pattern::Rings { count };
    assert_eq!(on_surface(|surface| surface.y[1] = -50.0), Refused::OutOfRange("domain of a surface"));
    assert_eq!(on_surface(|surface| surface.tool.radius_mm = 0.0), Refused::OutOfRange("radius of a tool"));
    assert_eq!(on_surface(|surface| surface.tool.corner_mm = 4.0), Refused::OutOfRange("corner of a tool"));
    assert_eq!(on_surface(|surface| surface.clear_mm = f64::INFINITY), Refused::NotFinite("clearance"));
    for pattern in [rings(0), rings(u32::MAX), Pattern::Lines { along_y: false, count: 1, zigzag: true }] {
        assert_eq!(refused(Shape::Surface(surface(pattern))), Refused::OutOfRange("number of paths"));
    }
    let curve = Pattern::Curve { t: [0.0; 2] };
    assert_eq!(refused(Shape::Surface(surface(curve))), Refused::OutOfRange("domain of a curve"));
    let nowhere = Seam { moved: Some([0.0, f64::NAN]), ..seam(SeamCurve::Formulas) };
    assert_eq!(refused(Shape::Seam(nowhere)), Refused::NotFinite("seam"));
    let far = Seam { t: [0.0, 1e7], ..seam(SeamCurve::Formulas) };
    assert_eq!(refused(Shape::Seam(far)), Refused::OutOfRange("domain of a seam"));
    let led = Work { correction: Correction::None, ..trace(Shape::Seam(seam(SeamCurve::Formulas))) };
    assert_eq!(unpack(led), Err(Refused::OutOfRange("correction of a seam")));
    let mut broken = meeting();
    broken.second.c[3] = f64::NAN;
    assert_eq!(refused(Shape::Seam(seam(SeamCurve::Meeting(broken)))), Refused::NotFinite("seam"));
    let askew: [fn(&mut Meeting); 3] = [
        |meeting| meeting.first.axis[2] = 1.0 + 1e-8,
        |meeting| meeting.second.axis[1] = -0.9,
        |meeting| meeting.first.zero = [0.6, 0.0, 0.8],
    ];
    for change in askew {
        let mut broken = meeting();
        change(&mut broken);
        let refused = refused(Shape::Seam(seam(SeamCurve::Meeting(broken))));
        assert_eq!(refused, Refused::OutOfRange("axes of a seam"));
    }

    let good = traces()[0];
    assert_eq!(unpack(Work { feed_mm_min: 0.0, ..good }), Err(Refused::OutOfRange("feed")));
    assert_eq!(unpack(Work { chord_mm: f64::NAN, ..good }), Err(Refused::NotFinite("chord error")));
    for chord_mm in [0.0, 9e-7, 1.1] {
        assert_eq!(unpack(Work { chord_mm, ..good }), Err(Refused::OutOfRange("chord error")));
    }
}

/// A layout that cannot be compared field by field: whoever changes it has to change the version in the name
/// of the packet.
#[test]
fn the_bytes_of_a_trace_are_those_of_this_version() {
    let of = |trace: &Work| {
        let packet = CodePacket::pack(0, &Item { line: 1, code: Code::Work(*trace) });
        crc32fast::hash(packet.as_bytes())
    };
    let known = [
        2_096_176_440,
        3_482_204_624,
        1_146_252_521,
        1_039_731_059,
        3_902_803_791,
        2_576_247_164,
        1_588_508_411,
    ];
    assert_eq!(traces().iter().map(of).collect::<Vec<_>>(), known);
}
