//! From a curve of a parameter to pieces by length that a chain can plan: a walker that goes along the curve
//! step by step. In: a curve, its parameter at both ends. Out: pieces, each a `motion::Path`, with absolute
//! positions at both ends, mm and degrees, and the parameter as a function of the way.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | t | – | parameter; w half of a step in it, signed |
//! | σ | mm | speed of the tip by t, \|dr/dt\|; dots are derivatives by t |
//! | s, L | mm | way of the tip from the start of a piece, and all of it |
//! | e | mm | how far the piece is from the curve |
//!
//! At five places of a step (0, ¼, ½, ¾, 1) the series of the curve gives σ, σ̇, σ̈. A polynomial through all
//! nine values at three of them has the integral
//!
//! ```text
//! from −1 to 1:  w/105 (41 (σ₋ + σ₊) + 128 σ₀ + 6 w (σ̇₋ − σ̇₊) + w²/3 (σ̈₋ + σ̈₊ + 16 σ̈₀))
//! from −1 to 0:  w/40320 (17007 σ₋ + 24576 σ₀ − 1263 σ₊ + w (2727 σ̇₋ − 5040 σ̇₀ + 423 σ̇₊)
//!                        + w² (169 σ̈₋ + 1024 σ̈₀ − 41 σ̈₊))                                       (M86)
//! ```
//! exact up to degree 9 and 8. The length is that of both halves of the step; from that of the whole it may
//! differ by 1e-10, so its own error is a thousandth of this.
//!
//! The piece is M84 of the derivatives by s at both ends (M83), and so is t(s). At the three inner places it
//! is compared with the curve. Its error grows with L⁸, which gives the next step, or a shorter one for
//! another try. Neighbouring pieces have the same derivatives where they meet, and every piece begins on the
//! true curve, so nothing adds up.
//!
//! What lies between two places is not seen, so they are at most 0.5 mm apart. A bump exp(−(s/b)²) of a
//! micrometre or more shows at one of them from b = 0.065 mm on, which is 0.1 mm wide at half its height; a
//! narrower one may be missed.
//!
//! Source: two-point Hermite interpolation; Hermite's quadrature on three places, derived here.

use core::fmt;

use motion::Path;

use crate::curve::Curve;
use crate::series::{Series, length};

/// At inner places a piece lies so near to its curve, mm or degrees.
const NEAR: f64 = 1e-10;
/// The parameter of a way is right to this share of its step.
const IN_TIME: f64 = 1e-9;
/// Rounding of positions and of a parameter, relative.
const ROUNDED: f64 = 8.0 * f64::EPSILON;
/// Lengths by a whole step and by its halves differ by less, relative.
const ALIKE: f64 = 1e-10;
/// Places where a piece is compared with its curve are so near to each other, mm.
const APART_MM: f64 = 0.5;
/// Longest piece, mm.
const MOST_MM: f64 = 4.0 * APART_MM;
/// Shortest piece that is tried, mm.
const LEAST_MM: f64 = 1e-3;
/// Of the step that would just be near enough, this share is taken.
const SAFETY: f64 = 0.9;
/// After a piece that was not good enough the next try is at most this share of it: 15 steps lead from the
/// longest to the shortest.
const SHORTER: f64 = 0.6;

/// A piece of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<const N: usize> {
    /// The piece, from its start.
    pub path: Path<N>,
    /// The parameter at its start and at its end.
    pub t: [f64; 2],
    /// Where the axes are at its start on the curve, mm and degrees,
    pub from: [f64; N],
    /// and at its end.
    pub to: [f64; N],
    /// The parameter as a function of the way on it.
    pub clock: Clock,
}

/// The parameter along a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    start: f64,
    gone: Path<1>,
}

impl Clock {
    /// The parameter after a way of `s` mm on the piece, right to 1e-9 of its step.
    #[must_use]
    pub fn parameter(&self, s: f64) -> f64 {
        let [[gone], ..] = self.gone.at(s);
        self.start + gone
    }
}

impl<const N: usize> Piece<N> {
    /// The parameter after a way of `s` mm on the piece, right to 1e-9 of its step.
    #[must_use]
    pub fn parameter(&self, s: f64) -> f64 {
        self.clock.parameter(s)
    }
}

/// What one try brought.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there is one of it at a time, and it must not allocate
pub enum Walked<const N: usize> {
    /// The next piece.
    Piece(Piece<N>),
    /// Nothing yet: the piece was too long, or not near enough to the curve. The next try is a shorter one.
    Shorter,
    /// The walker has come to the end.
    Over,
}

/// Why a curve cannot be followed, and at which parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PieceError {
    /// A formula has no value there, or no derivative.
    NotFinite {
        /// The parameter.
        t: f64,
    },
    /// The tip stands still while the parameter goes on.
    StandsStill {
        /// The parameter.
        t: f64,
    },
    /// It bends too sharply even for the shortest piece: a corner, a step, a cusp.
    Unresolved {
        /// The parameter.
        t: f64,
    },
}

impl PieceError {
    /// The parameter.
    #[must_use]
    pub fn t(&self) -> f64 {
        match *self {
            PieceError::NotFinite { t } | PieceError::StandsStill { t } | PieceError::Unresolved { t } => t,
        }
    }
}

impl fmt::Display for PieceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PieceError::NotFinite { t } => {
                write!(f, "the curve has no finite value or slope at {t}; change the formula or the range")
            }
            PieceError::StandsStill { t } => {
                write!(f, "the curve stands still at {t}; choose another parameter, or leave this place out")
            }
            PieceError::Unresolved { t } => write!(
                f,
                "the curve bends too sharply near {t} for a piece of {LEAST_MM} mm; end it there, or make it smooth"
            ),
        }
    }
}

impl core::error::Error for PieceError {}

/// Goes along a curve. It is given the same curve every time.
///
/// ```
/// use shape::{Curve, Function, Number, Point, Series, Walker};
/// struct Circle;
/// impl Curve<2> for Circle {
///     fn at(&self, t: f64) -> Point<2> {
///         let t = Series::variable(t);
///         let [x, y] = [Function::Cos, Function::Sin].map(|f| t.apply(f) * 10.0);
///         Point { axes: [x, y], tip: [x, y, Series::default()] }
///     }
/// }
/// let mut walker = Walker::new([0.0, std::f64::consts::PI]);
/// let (mut length, mut pieces) = (0.0, 0);
/// while let Some(piece) = walker.next(&Circle)? {
///     length += piece.path.length();
///     pieces += 1;
/// }
/// assert!((length - 10.0 * std::f64::consts::PI).abs() < 1e-11 && pieces < 20);
/// # Ok::<(), shape::PieceError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walker<const N: usize> {
    t: f64,
    end: f64,
    /// Length to be tried next, mm; none before the first piece.
    step: Option<f64>,
    /// What is known of the curve where the walker stands; nothing before the first piece.
    here: Option<Knot<N>>,
    /// Where the axes stand when it begins ([`Curve::near`]).
    near: [f64; N],
}

impl<const N: usize> Walker<N> {
    /// From one parameter to another; the first may be the larger one.
    #[must_use]
    pub fn new([from, to]: [f64; 2]) -> Walker<N> {
        Walker { t: from, end: to, step: None, here: None, near: [0.0; N] }
    }

    /// The same from where the axes stand: where they can be at several places for one point of the curve, it
    /// begins with that which is nearest to it ([`Curve::near`]). Without this they stand at 0.
    #[must_use]
    pub fn standing(self, axes: [f64; N]) -> Walker<N> {
        Walker { near: axes, ..self }
    }

    /// The parameter where it stands.
    #[must_use]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// The next piece; `None` at the end. For callers without a deadline: as many calls of
    /// [`Walker::attempt`] as it takes.
    ///
    /// # Errors
    /// [`PieceError`]; the walker stands where the piece would have begun.
    pub fn next<C: Curve<N>>(&mut self, curve: &C) -> Result<Option<Piece<N>>, PieceError> {
        loop {
            match self.attempt(curve)? {
                Walked::Piece(piece) => return Ok(Some(piece)),
                Walked::Shorter => {}
                Walked::Over => return Ok(None),
            }
        }
    }

    /// Tries one piece: 4 evaluations of the curve, one more at the start. After at most 16 calls there is a
    /// piece or an error.
    ///
    /// # Errors
    /// [`PieceError`]; the walker stands where the piece would have begun.
    pub fn attempt<C: Curve<N>>(&mut self, curve: &C) -> Result<Walked<N>, PieceError> {
        let left = self.end - self.t;
        if left == 0.0 {
            return Ok(Walked::Over);
        }
        if !left.is_finite() {
            return Err(PieceError::NotFinite { t: if self.t.is_finite() { self.end } else { self.t } });
        }
        let start = match self.here {
            Some(knot) => knot,
            None => Knot::of(curve, self.t, left.signum(), &self.near)?,
        };
        // What is left is gone in one step or in two alike, not in one and a stub.
        let most = self.step.unwrap_or_else(|| start.guess()).min(SAFETY * MOST_MM) / start.speed();
        let whole = left.abs() <= most * (1.0 + ROUNDED);
        let h = if whole { left } else { left.signum() * most.min(0.5 * left.abs()) };
        let tried = h.abs() * start.speed();
        let (step, fault) = match Step::of(curve, &start, if whole { self.end } else { self.t + h }) {
            Ok(Step { piece, end, excess }) if excess <= 1.0 => {
                let next = tried * (SAFETY * eighth_root(1.0 / excess)).clamp(0.3, 3.0);
                (self.t, self.step, self.here) = (piece.t[1], Some(next), Some(end));
                return Ok(Walked::Piece(piece));
            }
            Ok(Step { excess, .. }) => {
                let share = (SAFETY * eighth_root(1.0 / excess)).clamp(0.1, SHORTER);
                (share * tried, PieceError::Unresolved { t: self.t })
            }
            Err(why) => (0.25 * tried, why),
        };
        if tried <= LEAST_MM * (1.0 + ROUNDED) {
            return Err(fault);
        }
        (self.step, self.here) = (Some(step.max(LEAST_MM)), Some(start));
        Ok(Walked::Shorter)
    }
}

/// What is known of a curve at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot<const N: usize> {
    t: f64,
    /// Position and its derivatives 1 … 3 by s, of every axis,
    axes: [[f64; N]; 4],
    /// and of the parameter.
    clock: [[f64; 1]; 4],
    /// σ, σ̇, σ̈ by |t|.
    speeds: [f64; 3],
}

impl<const N: usize> Knot<N> {
    /// The curve about `t`, by the turns nearest to `near`; s grows in the sense of ±1.
    fn of<C: Curve<N>>(curve: &C, t: f64, sense: f64, near: &[f64; N]) -> Result<Knot<N>, PieceError> {
        let point = curve.near(t, near);
        if !point.axes.iter().chain(&point.tip).all(Series::is_finite) {
            return Err(PieceError::NotFinite { t });
        }
        let way = length(&point.tip);
        let onwards = (way * sense).reversed();
        if !(way.derivative(1) > 0.0 && way.is_finite() && onwards.is_finite()) {
            return Err(PieceError::StandsStill { t });
        }
        let by_way = point.axes.map(|axis| axis.of(onwards));
        let axes = core::array::from_fn(|n| by_way.map(|axis| axis.derivative(n)));
        let clock = core::array::from_fn(|n| [if n == 0 { t } else { onwards.derivative(n) }]);
        let speeds = [1, 2, 3].map(|n| way.derivative(n));
        Ok(Knot { t, axes, clock, speeds })
    }

    /// σ.
    fn speed(&self) -> f64 {
        self.speeds[0]
    }

    /// Length of a first step, mm: a part of the smallest radius that the derivatives speak of.
    fn guess(&self) -> f64 {
        let most = |row: &[f64; N]| row.iter().fold(0.0_f64, |most, p| most.max(p.abs()));
        let [_, _, second, third] = &self.axes;
        let bend = most(second).max(libm::sqrt(most(third)));
        (0.25 / bend).clamp(LEAST_MM, MOST_MM)
    }
}

/// A try: the piece, what is known of the curve at its end, and its error as a multiple of the one that may
/// be, to be compared with 1. Where places are too far apart, it counts as one, too.
struct Step<const N: usize> {
    piece: Piece<N>,
    end: Knot<N>,
    excess: f64,
}

impl<const N: usize> Step<N> {
    fn of<C: Curve<N>>(curve: &C, start: &Knot<N>, to: f64) -> Result<Step<N>, PieceError> {
        let h = to - start.t;
        // Turns count from the start of the piece: one of more than half a turn is not near its curve, and
        // cut.
        let at = |t: f64| Knot::of(curve, t, h.signum(), &start.axes[0]);
        let knot = |share: f64| at(start.t + share * h);
        let (quarter, middle, three, end) = (knot(0.25)?, knot(0.5)?, knot(0.75)?, at(to)?);
        let [first, second] = [[start, &quarter, &middle], [&middle, &three, &end]]
            .map(|knots| ways(0.25 * h, knots.map(|knot| knot.speeds)));
        let whole = ways(0.5 * h, [start, &middle, &end].map(|knot| knot.speeds))[1];
        let length = first[1] + second[1];
        let unresolved = PieceError::Unresolved { t: start.t };
        let path = Path::piece(&start.axes, &end.axes, length).ok_or(unresolved)?;
        let gone = Path::piece(&start.clock, &end.clock, length).ok_or(unresolved)?;
        let clock = Clock { start: start.t, gone };
        let [from, to] = [start.axes[0], end.axes[0]];
        let piece = Piece { path, t: [start.t, end.t], from, to, clock };

        let mut excess = worst(0.0, (whole - length).abs() / (ALIKE * length));
        // A piece of twice the length has places twice as far apart: as an error that grows with L⁸.
        let apart = [first[0], first[1] - first[0], second[0], second[1] - second[0]];
        excess = apart.iter().fold(excess, |most, way| worst(most, (way / APART_MM).powi(8)));
        let in_time = IN_TIME * h.abs() + ROUNDED * start.t.abs().max(end.t.abs());
        for (knot, s) in [(&quarter, first[0]), (&middle, first[1]), (&three, first[1] + second[0])] {
            let [at, ..] = path.at(s);
            for ((at, from), axis) in at.iter().zip(from).zip(knot.axes[0]) {
                excess = worst(excess, (at - (axis - from)).abs() / (NEAR + ROUNDED * axis.abs()));
            }
            excess = worst(excess, (piece.parameter(s) - knot.t).abs() / in_time);
        }
        Ok(Step { piece, end, excess })
    }
}

/// Ways over the first half and over all of a step of 2 w by σ, σ̇, σ̈ at its start, middle and end (M86),
/// mm.
pub(crate) fn ways(w: f64, [[a0, a1, a2], [b0, b1, b2], [c0, c1, c2]]: [[f64; 3]; 3]) -> [f64; 2] {
    let half = 17_007.0 * a0 + 24_576.0 * b0 - 1263.0 * c0
        + w * (2727.0 * a1 - 5040.0 * b1 + 423.0 * c1 + w * (169.0 * a2 + 1024.0 * b2 - 41.0 * c2));
    let all = 41.0 * (a0 + c0) + 128.0 * b0 + w * (6.0 * (a1 - c1) + w / 3.0 * (a2 + c2 + 16.0 * b2));
    [w.abs() / 40_320.0 * half, w.abs() / 105.0 * all]
}

/// The larger one; a comparison with what is no number does not pass.
fn worst(excess: f64, other: f64) -> f64 {
    if other.is_nan() { f64::INFINITY } else { excess.max(other) }
}

fn eighth_root(x: f64) -> f64 {
    libm::sqrt(libm::sqrt(libm::sqrt(x)))
}
