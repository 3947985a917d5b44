//! One point of a law of motion. In: values of a law. Out: sums, multiples, and the same point seen in real
//! time.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | s, v, a, j, dj | mm, mm/s … mm/s⁴ | path and its derivatives with respect to the parameter p |
//! | r | – | actual spindle speed over programmed speed |
//! | r', r'', r''' | 1/s … 1/s³ | its derivatives by time |

use core::ops::{Add, Mul, Neg, Sub};

/// Value of a law and its derivatives with respect to its time-like parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Path, mm.
    pub s: f64,
    /// First derivative, mm/s.
    pub v: f64,
    /// Second derivative, mm/s².
    pub a: f64,
    /// Third derivative, mm/s³.
    pub j: f64,
    /// Fourth derivative, mm/s⁴.
    pub dj: f64,
}

impl Sample {
    /// The same point in real time when the master runs at ratio r (actual over programmed speed, ≥ 0), given
    /// with its derivatives by time (M8). The path stays: position follows the spindle at any speed.
    ///
    /// ```text
    /// v_t  = r v
    /// a_t  = r² a + r' v
    /// j_t  = r³ j + 3 r r' a + r'' v
    /// dj_t = r⁴ dj + 6 r² r' j + 3 r'² a + 4 r r'' a + r''' v
    /// ```
    ///
    /// Speed and acceleration feedforward must use these values: a spindle that slows down brakes its axes
    /// too.
    ///
    /// ```
    /// let steady = motion::Sample { s: 1.0, v: 20.0, ..Default::default() };
    /// let braked = steady.driven([0.5, -2.0, 0.0, 0.0]);
    /// assert_eq!((braked.s, braked.v, braked.a), (1.0, 10.0, -40.0));
    /// ```
    #[must_use]
    pub fn driven(self, [r, r1, r2, r3]: [f64; 4]) -> Sample {
        let Sample { s, v, a, j, dj } = self;
        let rr = r * r;
        Sample {
            s,
            v: r * v,
            a: rr * a + r1 * v,
            j: r * (rr * j + 3.0 * r1 * a) + r2 * v,
            dj: rr * (rr * dj + 6.0 * r1 * j) + (3.0 * r1 * r1 + 4.0 * r * r2) * a + r3 * v,
        }
    }

    /// Uniform motion: path `s`, speed `v`, nothing else.
    #[must_use]
    pub fn uniform(s: f64, v: f64) -> Sample {
        Sample { s, v, ..Sample::default() }
    }

    /// The motion of N axes when this is that of s along a path: `p` holds the position and its derivatives 1
    /// … 4 by s at this s (M55).
    #[must_use]
    pub fn along<const N: usize>(&self, p: &[[f64; N]; 5]) -> [Sample; N] {
        let ([p, p1, p2, p3, p4], Sample { v, a, j, dj, .. }) = (p, *self);
        core::array::from_fn(|i| Sample {
            s: p[i],
            v: p1[i] * v,
            a: p1[i] * a + p2[i] * v * v,
            j: p1[i] * j + 3.0 * p2[i] * v * a + p3[i] * v * v * v,
            dj: p1[i] * dj
                + p2[i] * (4.0 * v * j + 3.0 * a * a)
                + 6.0 * p3[i] * v * v * a
                + p4[i] * v * v * v * v,
        })
    }

    /// A law run backwards, `s(p) → end − s(T − p)`, given the sample at `T − p`: odd derivatives keep their
    /// sign.
    #[inline]
    pub(crate) fn reversed(self, end: f64) -> Sample {
        Sample { s: end - self.s, v: self.v, a: -self.a, j: self.j, dj: -self.dj }
    }
}

impl Add for Sample {
    type Output = Sample;
    fn add(self, o: Sample) -> Sample {
        Sample { s: self.s + o.s, v: self.v + o.v, a: self.a + o.a, j: self.j + o.j, dj: self.dj + o.dj }
    }
}

impl Sub for Sample {
    type Output = Sample;
    fn sub(self, o: Sample) -> Sample {
        self + -o
    }
}

impl Neg for Sample {
    type Output = Sample;
    fn neg(self) -> Sample {
        Sample { s: -self.s, v: -self.v, a: -self.a, j: -self.j, dj: -self.dj }
    }
}

impl Mul<f64> for Sample {
    type Output = Sample;
    fn mul(self, k: f64) -> Sample {
        Sample { s: self.s * k, v: self.v * k, a: self.a * k, j: self.j * k, dj: self.dj * k }
    }
}
