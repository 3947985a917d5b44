//! Smooth curves in space by their length, in pieces: the direction turns in waves about two angles.
//!
//! The tangent is (cos ψ cos θ, cos ψ sin θ, sin ψ) with angles θ(s), ψ(s), sums of sines; its derivatives
//! are those of products, the position is its integral (Gauss–Legendre, five points on each of many parts).

use crate::programs::N;
use motion::Path;
use testing::Seed;

/// A value with two derivatives by s.
type Jet = [f64; 3];

/// Nodes and weights on −1 … 1.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];
/// Parts of a piece whose integrals are taken.
const PARTS: u32 = 4;

/// Size, rate by mm and phase of a wave; a rate of 0 is a constant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave(pub(crate) f64, pub(crate) f64, pub(crate) f64);

/// A curve: curvature `turn` everywhere, and waves about it and about the plane.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) heading: f64,
    pub(crate) turn: f64,
    pub(crate) waves: Vec<Wave>,
    pub(crate) climb: Vec<Wave>,
}

impl Curve {
    pub(crate) fn circle(radius: f64) -> Curve {
        Curve { heading: 0.0, turn: 1.0 / radius, waves: Vec::new(), climb: Vec::new() }
    }

    /// Which turns by a radian in some `radius` mm.
    pub(crate) fn random(random: &mut Seed, heading: f64, radius: f64) -> Curve {
        let mut wave = |size: f64| {
            let rate = random.between(0.2, 1.0) / radius;
            Wave(random.between(0.0, size), rate, random.between(0.0, 6.3))
        };
        let (waves, climb) = (vec![wave(1.0), wave(0.5)], vec![wave(0.3)]);
        let mut curve = Curve { heading: 0.0, turn: random.between(-1.0, 1.0) / radius, waves, climb };
        curve.heading = heading - curve.angle(0.0)[0];
        curve
    }

    fn angle(&self, s: f64) -> Jet {
        let [angle, first, second] = sum(&self.waves, s);
        [self.heading + self.turn * s + angle, self.turn + first, second]
    }

    pub(crate) fn heading(&self, s: f64) -> f64 {
        self.angle(s)[0]
    }

    /// p₁, p₂, p₃ at `s`.
    pub(crate) fn direction(&self, s: f64) -> [[f64; N]; 3] {
        let ([sin, cos], [up, flat]) = (turned(self.angle(s)), turned(sum(&self.climb, s)));
        let axes = [product(flat, cos), product(flat, sin), up];
        std::array::from_fn(|n| axes.map(|jet| jet[n]))
    }

    /// From one way to another, mm.
    fn way(&self, from: f64, to: f64) -> [f64; N] {
        let half = 0.5 * (to - from) / f64::from(PARTS);
        let mut way = [0.0; N];
        for part in 0..PARTS {
            let middle = from + half * f64::from(2 * part + 1);
            for (node, weight) in GAUSS {
                let [p1, ..] = self.direction(middle + node * half);
                way = std::array::from_fn(|i| way[i] + weight * half * p1[i]);
            }
        }
        way
    }

    /// The piece between two ways.
    pub(crate) fn piece(&self, from: f64, to: f64) -> Path<N> {
        let [p1, p2, p3] = self.direction(from);
        let [q1, q2, q3] = self.direction(to);
        Path::piece(&[[0.0; N], p1, p2, p3], &[self.way(from, to), q1, q2, q3], to - from).expect("a length")
    }
}

fn sum(waves: &[Wave], s: f64) -> Jet {
    waves.iter().fold([0.0; 3], |[a, b, c], Wave(size, rate, phase)| {
        let (sin, cos) = libm::sincos(rate * s + phase);
        [a + size * sin, b + size * rate * cos, c - size * rate * rate * sin]
    })
}

/// Sine and cosine of an angle.
fn turned([angle, first, second]: Jet) -> [Jet; 2] {
    let (sin, cos) = libm::sincos(angle);
    [
        [sin, cos * first, cos * second - sin * first * first],
        [cos, -sin * first, -sin * second - cos * first * first],
    ]
}

fn product(a: Jet, b: Jet) -> Jet {
    [a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2]]
}
