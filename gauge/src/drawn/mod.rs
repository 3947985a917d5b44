//! A groove as a drawing has it: root and lead along its way. In: rows, mm. Out: root, lead and turns at any
//! place of it.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | a | mm | place along the axis of the thread: Z, or the radius of a thread on a face |
//! | r(a) | mm | root: radius, or Z of a thread on a face |
//! | K₀, K₁, L | mm | leads along a at two rows, and how far those are apart |
//! | u(a) | – | turns from the lowest row up to a |
//!
//! ```text
//! (M225) K² = K₀² + (K₁² − K₀²) s/L at s from a row: the lead grows by the same in every turn;
//!        u = 2 s/(K₀ + K)
//! ```
//! It is a drawing, made without any law of an axis: what is cut is held against it as a part is held
//! against its own.

mod judge;
mod text;

pub use judge::{DrawnReport, Spot, judge_drawn};

/// Rows closer than this are one place, mm.
const SAME_MM: f64 = 1e-9;
/// Widest that a groove may stray if nothing is said, mm.
const WITHIN_MM: f64 = 0.02;

/// A row of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    along_mm: f64,
    root_mm: f64,
    lead_mm: f64,
    /// Radius of the arc of the root from the row before: positive where it bulges out of the part.
    arc_mm: Option<f64>,
}

/// Which side of the part it is cut into.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DrawnSide {
    /// A screw: deeper is nearer to the axis.
    #[default]
    External,
    /// A nut: deeper is farther from the axis.
    Internal,
    /// A face: deeper is lower Z.
    Face,
}

/// A groove as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// What was written, for people.
    pub text: String,
    /// Which side it is cut into.
    pub side: DrawnSide,
    /// Wound to the left: Z grows with the angle of the spindle; on a face, the radius falls.
    pub left_hand: bool,
    /// Angle between the flanks of the tool where nobody else tells it, degrees.
    pub angle_deg: Option<f64>,
    /// How far it may stray along its axis and in depth, mm.
    pub within_mm: f64,
    /// At least two, from the lowest along the axis on.
    rows: Vec<Row>,
}

impl Drawn {
    /// Whether it runs along the radius.
    #[must_use]
    pub fn on_face(&self) -> bool {
        self.side == DrawnSide::Face
    }

    /// Its ends along the axis, mm.
    #[must_use]
    pub fn ends_mm(&self) -> [f64; 2] {
        [self.rows[0].along_mm, self.rows[self.rows.len() - 1].along_mm]
    }

    /// 1 where its turns grow with the angle of the spindle towards higher places, else −1.
    fn turns_sign(&self) -> f64 {
        if self.left_hand == self.on_face() { -1.0 } else { 1.0 }
    }

    /// Pairs of rows that are apart.
    fn legs(&self) -> impl Iterator<Item = (&Row, &Row)> {
        let pairs = self.rows.windows(2).map(|pair| (&pair[0], &pair[1]));
        pairs.filter(|(low, high)| high.along_mm - low.along_mm > SAME_MM)
    }

    /// u and the lead at a place between the ends (M225).
    fn turns(&self, along_mm: f64) -> (f64, f64) {
        let (mut turns, mut lead) = (0.0, self.rows[0].lead_mm);
        for (low, high) in self.legs() {
            let length = high.along_mm - low.along_mm;
            let s = (along_mm - low.along_mm).clamp(0.0, length);
            let [k0, k1] = [low.lead_mm, high.lead_mm];
            lead = libm::sqrt(k0 * k0 + (k1 * k1 - k0 * k0) * s / length);
            turns += 2.0 * s / (k0 + lead);
            if s < length {
                break;
            }
        }
        (turns, lead)
    }

    /// r at a place between the ends, mm.
    fn root_mm(&self, along_mm: f64) -> f64 {
        let leg = self.legs().find(|(_, high)| along_mm <= high.along_mm).or_else(|| self.legs().last());
        let Some((low, high)) = leg else { return self.rows[0].root_mm };
        let length = high.along_mm - low.along_mm;
        let s = (along_mm - low.along_mm).clamp(0.0, length);
        match high.arc_mm {
            None => low.root_mm + (high.root_mm - low.root_mm) * s / length,
            Some(arc_mm) => {
                let (low_at, high_at) = ([low.along_mm, low.root_mm], [high.along_mm, high.root_mm]);
                on_arc(low_at, high_at, arc_mm * self.out_sign(), low.along_mm + s)
            }
        }
    }

    /// 1 where out of the part is up, −1 where it is down.
    fn out_sign(&self) -> f64 {
        if self.side == DrawnSide::Internal { -1.0 } else { 1.0 }
    }
}

/// Height of an arc through two points, whose radius is positive where it bulges upwards.
fn on_arc([a0, r0]: [f64; 2], [a1, r1]: [f64; 2], radius: f64, a: f64) -> f64 {
    let half = 0.5 * libm::hypot(a1 - a0, r1 - r0);
    let [along, across] = [(a1 - a0) / (2.0 * half), (r1 - r0) / (2.0 * half)];
    // The centre lies beside the middle of the chord, below it where the arc bulges upwards.
    let beside = libm::sqrt((radius * radius - half * half).max(0.0)) * radius.signum();
    let [ca, cr] = [0.5 * (a0 + a1) + beside * across, 0.5 * (r0 + r1) - beside * along];
    cr + libm::sqrt((radius * radius - (a - ca) * (a - ca)).max(0.0)) * radius.signum()
}
