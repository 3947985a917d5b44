//! One groove of a section against the limits. In: the flanks of the groove over height, mm. Out: a [`Cut`].
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | h | mm | height over the pitch line of the GO gauge at the middle of the groove (M150) |
//! | z₁(h), z₂(h) | mm | flanks of the groove (M152) |
//! | h_r, h_c | mm | heights between which a GO gauge has flanks |
//! | a, b | mm | where the flanks of a counterpart with the nominal angles have to be at h = 0 |
//!
//! ```text
//! (M153) simple pitch line: z₂(h_s) − z₁(h_s) = w
//!        a = max (z₁(h) + h t₁),   b = min (z₂(h) − h t₂)   over h_r ≤ h ≤ h_c
//! ```
//! The flanks of the part: a straight line through the middle of what lies between root and crest, by least
//! squares. A groove that ends above h_r is asked at its deepest point: there a counterpart stands on it. How
//! much a groove stands in the way of a counterpart beyond what it does at the pitch line is `lean`; how much
//! wider it is than the widest of its places alone would make it is `apart`.

use crate::{nominal::Nominal, section::Groove};

/// Heights at which flanks are looked at.
const HEIGHTS: usize = 25;
/// Those of them between which the angles of the flanks are fitted: away from the nose and from the crest.
const FITTED: std::ops::Range<usize> = 6..22;
/// Halvings that find the pitch line: of a millimetre, far below a nanometre.
const HALVINGS: usize = 48;

/// One groove at one angle, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    /// Number of the groove along the axis, and of the angle.
    pub(crate) groove: i64,
    pub(crate) station: usize,
    /// Where a thread without errors has it, less what is common to all, mm.
    pub(crate) nominal: f64,
    /// Its middle, mm.
    pub(crate) middle: f64,
    /// h_s.
    pub(crate) simple: f64,
    /// a and b.
    pub(crate) clears: [f64; 2],
    /// Tangents of the flanks of the part; none where there is too little of them.
    pub(crate) tangents: Option<[f64; 2]>,
    /// h of its deepest point.
    pub(crate) root: f64,
    /// Width that the flanks take from a counterpart beyond what they take at the simple pitch line, mm.
    pub(crate) lean: f64,
    /// How much wider it is at the pitch line than one place alone would make it, mm.
    pub(crate) apart: f64,
    /// Flanks at the height of the crest that is asked for at least, or that the stock has.
    pub(crate) crest: [f64; 2],
}

/// Measures grooves of a thread.
#[derive(Clone, Debug)]
pub(crate) struct Measure<'a> {
    nominal: &'a Nominal,
    tangents: [f64; 2],
    heights: [f64; 2],
    /// h at which the ridge beside the groove must still be there.
    pub(crate) crest: f64,
}

impl<'a> Measure<'a> {
    /// For a thread in a stock of this diameter, if that is known.
    pub(crate) fn new(nominal: &'a Nominal, crest_mm: Option<f64>) -> Measure<'a> {
        let heights = nominal.flank_heights_mm(crest_mm);
        let least = nominal.crest_mm[if nominal.sign() > 0.0 { 0 } else { 1 }];
        let crest = least.map_or(heights[1], |mm| nominal.height_mm(mm));
        Measure { nominal, tangents: nominal.tangents(), heights, crest }
    }

    /// The measures of a groove.
    pub(crate) fn cut(&self, groove: &Groove) -> Cut {
        let line = self.nominal.line_mm(groove.middle());
        let at = |h: f64| groove.at(line + h);
        let root = groove.root() - line;
        let simple = self.simple(root, &at);
        let heights: [f64; HEIGHTS] = core::array::from_fn(|i| {
            let [low, high] = self.heights;
            low + (high - low) * i as f64 / (HEIGHTS - 1) as f64
        });
        let flanks = heights.map(|h| at(h).map(|ends| (h, ends)));
        let [t1, t2] = self.tangents;
        let clear = |(h, [z1, z2]): (f64, [f64; 2])| [z1 + h * t1, z2 - h * t2];
        let widest = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        let ends = at(simple).unwrap_or([groove.middle(); 2]);
        let there = clear((simple, ends));
        let tip = root.max(self.heights[0]);
        let lowest = at(tip).map_or(there, |ends| clear((tip, ends)));
        let clears = flanks.iter().flatten().map(|flank| clear(*flank)).fold(widest(there, lowest), widest);
        let apart = (ends[1] - ends[0] - groove.widest_alone(line + simple)).max(0.0);
        Cut {
            groove: 0,
            station: 0,
            nominal: 0.0,
            middle: 0.5 * (ends[0] + ends[1]),
            simple,
            clears,
            tangents: slopes(&flanks[FITTED]),
            root,
            lean: (clears[0] - there[0]) + (there[1] - clears[1]),
            apart,
            crest: at(self.crest).unwrap_or(ends),
        }
    }

    /// h_s (M153); the root of a groove that is wider than w from there on.
    fn simple(&self, root: f64, at: &dyn Fn(f64) -> Option<[f64; 2]>) -> f64 {
        let w = self.nominal.width_mm();
        let (mut low, mut high) =
            (root, root.max(0.0) + 4.0 * self.nominal.pitch_mm / self.nominal.tangent());
        for _ in 0..HALVINGS {
            let h = 0.5 * (low + high);
            match at(h) {
                Some([z1, z2]) if z2 - z1 >= w => high = h,
                _ => low = h,
            }
        }
        high
    }
}

/// Slopes of both flanks by least squares, as tangents of their angles to a plane across the axis.
fn slopes(flanks: &[Option<(f64, [f64; 2])>]) -> Option<[f64; 2]> {
    let n = flanks.iter().flatten().count() as f64;
    if n < 0.5 * flanks.len() as f64 {
        return None;
    }
    let there = || flanks.iter().flatten();
    let middle = there().map(|(h, _)| h).sum::<f64>() / n;
    let spread: f64 = there().map(|(h, _)| (h - middle) * (h - middle)).sum();
    let slope = |side: usize| there().map(|(h, z)| (h - middle) * z[side]).sum::<f64>() / spread;
    Some([-slope(0), slope(1)])
}
