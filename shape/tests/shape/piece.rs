//! Pieces of curves (M84, M86): near the curve, of its length, joined without jumps; what cannot be followed
//! is refused.

use core::cell::{Cell, RefCell};
use core::f64::consts::{PI, TAU};

use proptest::prelude::*;
use shape::{Curve, Function, Number, Piece, PieceError, Point, Series, Walker};

/// A curve in X, Y, Z with a rotary axis that goes along and is not part of the way.
struct By<F>(F);

fn by<F: Fn(Series) -> [Series; 4]>(curve: F) -> By<F> {
    By(curve)
}

impl<F: Fn(Series) -> [Series; 4]> Curve<4> for By<F> {
    fn at(&self, t: f64) -> Point<4> {
        let axes = (self.0)(Series::variable(t));
        Point { axes, tip: [axes[0], axes[1], axes[2]] }
    }
}

const NONE: Series = Series([0.0; 4]);

fn sin(t: Series) -> Series {
    t.apply(Function::Sin)
}

fn cos(t: Series) -> Series {
    t.apply(Function::Cos)
}

fn number(value: f64) -> Series {
    Series::constant(value)
}

fn walk(curve: &impl Curve<4>, ends: [f64; 2]) -> Result<Vec<Piece<4>>, PieceError> {
    let mut walker = Walker::new(ends);
    let mut pieces = Vec::new();
    while let Some(piece) = walker.next(curve)? {
        pieces.push(piece);
        assert!(pieces.len() < 100_000, "at {} of {ends:?}", walker.t());
    }
    Ok(pieces)
}

/// Everything that holds for the pieces of any curve. Gives their length, mm.
fn holds(curve: &impl Curve<4>, ends: [f64; 2], pieces: &[Piece<4>]) -> f64 {
    const SAMPLES: u32 = 40;
    let mut t = ends[0];
    for piece in pieces {
        assert_eq!(piece.t[0], t);
        t = piece.t[1];
        let (length, [from, to]) = (piece.path.length(), piece.t);
        assert!(length <= 2.0 + 1e-9);
        for k in 0..=SAMPLES {
            let s = length * f64::from(k) / f64::from(SAMPLES);
            let t = piece.parameter(s);
            let ([p, p1, ..], point) = (piece.path.at(s), curve.at(t));
            for (i, axis) in point.axes.iter().enumerate() {
                // The parameter is right to 1e-9 of the step, which is this far on the curve.
                let slack = 1e-9 * (axis.derivative(1) * (to - from)).abs();
                let off = (piece.from[i] + p[i] - axis.value()).abs() - 1e-14 * piece.from[i].abs();
                assert!(off <= 1.5e-10 + slack, "axis {i} is {off} off at {t}");
            }
            // The feed is that of the tip.
            let pace = p1[..3].iter().map(|p| p * p).sum::<f64>().sqrt();
            assert!((pace - 1.0).abs() < 1e-6, "{pace} at {t}");
        }
        let [here, there] = [from, to].map(|t| curve.at(t).axes.map(|axis| axis.value()));
        assert_eq!((piece.from, piece.to), (here, there));
    }
    assert_eq!(t, ends[1]);
    for pair in pieces.windows(2) {
        let jumps = pair[0].path.jumps(&pair[1].path);
        let (shorter, turns) =
            (pair[0].path.length().min(pair[1].path.length()), pair[1].path.shares()[3].max(1.0));
        for (n, jump) in jumps.iter().enumerate() {
            let most = 1e-11 * turns * shorter.powi(-(n as i32));
            assert!(
                jump.iter().all(|jump| jump.abs() <= most),
                "p{} jumps by {jump:?} at {}",
                n + 1,
                pair[0].t[1]
            );
        }
        assert_eq!(pair[0].to, pair[1].from);
    }
    pieces.iter().map(|piece| piece.path.length()).sum()
}

fn followed(curve: &impl Curve<4>, ends: [f64; 2]) -> (f64, usize) {
    let pieces = walk(curve, ends).expect("a smooth curve");
    (holds(curve, ends, &pieces), pieces.len())
}

fn near(length: f64, right: f64) {
    assert!((length / right - 1.0).abs() <= 1e-12, "{length} mm, not {right}");
}

#[test]
fn m86_circles_of_any_radius() {
    for (radius, most) in [(0.05, 12), (0.5, 16), (10.0, 40), (300.0, 1060)] {
        for ends in [[0.0, TAU], [1.0, -2.0]] {
            let circle = by(|t| [cos(t) * radius + number(700.0), sin(t) * radius, NONE, t * (180.0 / PI)]);
            let (length, pieces) = followed(&circle, ends);
            near(length, radius * (ends[1] - ends[0]).abs());
            assert!(pieces <= most, "{pieces} pieces of {radius} mm");
        }
    }
}

#[test]
fn m86_a_helix() {
    let helix = by(|t| [cos(t) * 8.0, sin(t) * 8.0, t * 1.5, NONE]);
    near(followed(&helix, [-3.0, 40.0]).0, 43.0 * libm::hypot(8.0, 1.5));
}

/// y = x²/2 has the length (x √(1 + x²) + asinh x)/2, here in a twentieth of its size, and where the slope is
/// 1000 the parameter hardly moves.
#[test]
fn m86_slopes_up_to_a_thousand() {
    let parabola = by(|t| [t, t * t * 10.0, NONE, NONE]);
    let length = |x: f64| 0.025 * (x * libm::sqrt(1.0 + x * x) + libm::asinh(x));
    near(followed(&parabola, [-50.0, 0.15]).0, length(1000.0) + length(3.0));
    // An exponential rises from 1e-3 to 1e3: with y = eˣ and r = √(1 + y²) the length is r + ln(y/(1 + r)).
    let rise = by(|t| [t, t.apply(Function::Exp), NONE, NONE]);
    let length = |x: f64| {
        let y = libm::exp(x);
        let r = libm::sqrt(1.0 + y * y);
        r + libm::log(y / (1.0 + r))
    };
    near(followed(&rise, [-7.0, 7.0]).0, length(7.0) - length(-7.0));
}

/// A catenary has the length sinh, a cycloid 4 (cos a/2 − cos b/2); that of an astroid leaves out its cusps.
#[test]
fn m86_closed_forms() {
    let catenary = by(|t| [t, t.apply(Function::Cosh), NONE, NONE]);
    near(followed(&catenary, [-3.0, 2.0]).0, libm::sinh(3.0) + libm::sinh(2.0));
    let cycloid = by(|t| [(t - sin(t)) * 5.0, (number(1.0) - cos(t)) * 5.0, NONE, NONE]);
    near(followed(&cycloid, [0.1, TAU - 0.2]).0, 20.0 * (libm::cos(0.05) + libm::cos(0.1)));
    let astroid = by(|t| [cos(t).powi(3) * 30.0, sin(t).powi(3) * 30.0, NONE, NONE]);
    let square = |x: f64| libm::sin(x) * libm::sin(x);
    near(followed(&astroid, [0.05, 1.5]).0, 45.0 * (square(1.5) - square(0.05)));
}

/// Through many inflections, far from the zero of the axes.
#[test]
fn m86_a_sine_over_a_metre() {
    let sine = by(|t| [t + number(1000.0), sin(t * 0.2) * 8.0, NONE, NONE]);
    let (there, pieces) = followed(&sine, [0.0, 1000.0]);
    let (back, _) = followed(&sine, [1000.0, 0.0]);
    assert!((there / back - 1.0).abs() < 1e-12 && pieces < 2500, "{there} mm in {pieces} pieces, {back}");
}

/// Places half a millimetre apart at most, the last pieces alike.
#[test]
fn a_straight_line_has_pieces_of_nearly_two_millimetres() {
    let line = by(|t| [t * 3.0, t * 4.0, NONE, t * 9.0]);
    let (length, pieces) = followed(&line, [0.0, 200.0]);
    near(length, 1000.0);
    assert!(pieces <= 560, "{pieces}");
    let ends = [0.0, 0.4001];
    let pieces = walk(&line, ends).expect("smooth");
    near(holds(&line, ends, &pieces), 2.0005);
    assert!(pieces.iter().all(|piece| piece.path.length() > 0.9));
}

/// Whatever the speed of the tip does, also where it grows along a step.
#[test]
fn places_are_half_a_millimetre_apart() {
    for rate in [0.3, 3.0, 30.0] {
        let seen = RefCell::new(Vec::new());
        let line = by(|t| {
            let way = (t * rate).apply(Function::Exp);
            seen.borrow_mut().push(way.value());
            [way, NONE, NONE, NONE]
        });
        let pieces = walk(&line, [-2.0 / rate, 5.0 / rate]).expect("smooth").len();
        let mut seen = seen.into_inner();
        seen.sort_by(f64::total_cmp);
        let apart = seen.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!((0.3..=0.5 + 1e-9).contains(&apart), "{apart} mm at {rate}");
        // Hardly a try fails.
        assert!(seen.len() < 5 * pieces, "{} evaluations for {pieces} pieces", seen.len());
    }
}

/// Flat for long, so that pieces are as long as they may be, then a bump.
fn bump(height: f64, at: f64, width: f64) -> By<impl Fn(Series) -> [Series; 4]> {
    by(move |t| {
        let u = (t - number(at)) * (1.0 / width);
        [t, NONE, (-(u * u)).apply(Function::Exp) * height, NONE]
    })
}

#[test]
fn a_bump_on_a_line_is_seen() {
    let ends = [0.0, 100.0];
    let (length, _) = followed(&bump(5.0, 31.0, 1.2), ends);
    // The trapezium rule is as exact as its numbers where nothing is left at both ends.
    let slope = |u: f64| 5.0 / 1.2 * 2.0 * u * libm::exp(-u * u);
    let rise = |k: u32| libm::hypot(1.0, slope((f64::from(k) * 0.001 - 31.0) / 1.2));
    near(length, (0..100_000).map(rise).sum::<f64>() * 0.001);
}

/// Where a corner is a little round, the pieces are short, and long again behind it.
#[test]
fn m86_a_corner_of_a_hundredth() {
    let corner = by(|t| [t, (t * t + number(1e-4)).sqrt(), NONE, NONE]);
    let ends = [-20.0, 20.0];
    let pieces = walk(&corner, ends).expect("smooth");
    holds(&corner, ends, &pieces);
    let shortest = pieces.iter().map(|piece| piece.path.length()).fold(f64::INFINITY, f64::min);
    assert!(shortest < 0.01 && pieces.len() < 200, "{shortest} mm, {} pieces", pieces.len());
}

#[test]
fn what_cannot_be_followed_is_refused_with_its_place() {
    let refused = |curve: &dyn Fn(Series) -> [Series; 4], ends| walk(&by(curve), ends).expect_err("no curve");
    let root = refused(&|t| [t, (number(2.0) - t).sqrt(), NONE, NONE], [0.0, 3.0]);
    assert!((root.t() - 2.0).abs() < 0.01, "{root:?}");
    let still = refused(&|_| [number(1.0), number(2.0), NONE, NONE], [0.0, 1.0]);
    assert_eq!(still, PieceError::StandsStill { t: 0.0 });
    let turning = refused(&|t| [number(1.0), number(2.0), NONE, t], [0.0, 1.0]);
    assert_eq!(turning, PieceError::StandsStill { t: 0.0 });
    let cusp = refused(&|t| [t * t, t * t * t, NONE, NONE], [-1.0, 1.0]);
    assert!(cusp.t().abs() < 0.1, "{cusp:?}");
    let nowhere = refused(&|t| [t * t, t, NONE, NONE], [0.0, f64::INFINITY]);
    assert_eq!(nowhere, PieceError::NotFinite { t: f64::INFINITY });
    let corner = refused(&|t| [t, (t * t).sqrt(), NONE, NONE], [-1.0, 2.0]);
    assert!(matches!(corner, PieceError::Unresolved { .. }) && corner.t().abs() < 0.01, "{corner:?}");
    let step = refused(&|t| [t, (t * 1e9).apply(Function::Tanh), NONE, NONE], [-1.0, 2.0]);
    assert!(step.t().abs() < 0.01, "{step:?}");
    assert!(corner.to_string().contains("bends too sharply"));
}

/// Work per piece is bounded, and small as a rule.
#[test]
fn a_piece_takes_four_evaluations_as_a_rule() {
    let (count, most) = (Cell::new(0_u32), Cell::new(0_u32));
    let curve = by(|t| {
        count.set(count.get() + 1);
        [t, sin(t * 0.1) * 20.0 + cos(t * 1.7) * 0.5, NONE, NONE]
    });
    let mut walker = Walker::new([0.0, 500.0]);
    let (mut pieces, mut before) = (0, 0);
    while walker.next(&curve).expect("smooth").is_some() {
        pieces += 1;
        most.set(most.get().max(count.get() - before));
        before = count.get();
    }
    assert!(
        count.get() < 6 * pieces && most.get() <= 65,
        "{} for {pieces}, at most {}",
        count.get(),
        most.get()
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// As narrow as is promised, from a micrometre to as high as its top can be followed, and anywhere.
    #[test]
    fn bumps_of_any_width_are_seen(
        share in 0.0..1.0_f64, at in 10.0..30.0_f64, width in -2.73..1.0_f64, from in 0.0..3.0_f64,
    ) {
        let (width, ends) = (libm::exp(width), [from, 40.0]);
        // A radius of 0.05 mm or more.
        let curve = bump(1e-3 * libm::pow(width * width / 1e-4, share), at, width);
        let pieces = walk(&curve, ends).expect("smooth");
        for piece in &pieces {
            // Dense against the piece and against the bump.
            let length = piece.path.length();
            let samples = (100.0 * length / width.min(0.5)).ceil() as u32;
            for k in 0..=samples {
                let s = length * f64::from(k) / f64::from(samples);
                let [p, ..] = piece.path.at(s);
                let [.., bump, _] = curve.at(piece.from[0] + p[0]).axes;
                // Across the bump, which may be steep.
                let off = (piece.from[2] + p[2] - bump.value()).abs() / libm::hypot(1.0, bump.derivative(1));
                prop_assert!(off < 1e-9, "{off} at {}", piece.t[0]);
            }
        }
    }

    /// Sums of waves, with a rotary axis, from anywhere to anywhere.
    #[test]
    fn m86_any_smooth_curve(
        waves in prop::array::uniform4((0.01..30.0_f64, 0.02..3.0_f64, 0.0..TAU)),
        from in -50.0..50.0_f64, way in 0.01..40.0_f64, backwards in any::<bool>(), scale in 0.01..5.0_f64,
    ) {
        let wave = |k: usize, t: Series| {
            let (size, rate, phase) = waves[k];
            sin(t * rate + number(phase)) * size
        };
        // X always goes on, so fast that no radius is below 0.03 mm.
        let bend: f64 = waves.iter().map(|(size, rate, _)| size * rate * rate).sum();
        let pace = waves[0].0 * waves[0].1 + (0.03 * bend).sqrt();
        let curve = by(|t| {
            let t = t * scale;
            [t * pace + wave(0, t), wave(1, t), wave(2, t), wave(3, t)]
        });
        let ends = if backwards { [from + way, from] } else { [from, from + way] };
        let pieces = walk(&curve, ends).expect("smooth");
        holds(&curve, ends, &pieces);
    }
}
