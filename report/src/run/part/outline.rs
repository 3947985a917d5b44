//! What edges leave of a part. In: places of tips in the section, mm. Out: the surface over Z, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z_i, y_i, v_i(x) | mm | place of a tip; height of its edge over it at a distance (M160) |
//! | y_c(z) | mm | the crest: what was there before, or what another pass has left |
//!
//! ```text
//! (M161) y(z) = min (y_c(z), min (y_i + v_i(z − z_i)))   over all places i
//! ```

use gauge::Edge;

/// An edge at a place, z and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tip {
    pub(super) edge: Edge,
    pub(super) at: [f64; 2],
}

/// Edges at their places.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// By Z.
    tips: Vec<Tip>,
    /// How far along Z any of them can reach below the crest.
    reach_mm: f64,
}

impl Outline {
    /// Of edges that cut nothing above a height.
    pub(super) fn new(tips: impl Iterator<Item = Tip>, top_mm: f64) -> Outline {
        let mut tips: Vec<Tip> = tips.filter(|tip| tip.at[1] < top_mm).collect();
        tips.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
        let mut outline = Outline { tips, reach_mm: 0.0 };
        for Tip { edge, at: [_, y] } in &outline.tips {
            let is_below = |x: f64| y + edge.height_mm(x).min(edge.height_mm(-x)) < top_mm;
            let mut reach = outline.reach_mm.max(FIRST_MM);
            while is_below(reach) {
                reach *= 2.0;
            }
            outline.reach_mm = reach;
        }
        outline
    }

    /// How far along Z from the tips anything is cut, mm.
    pub(super) fn reach_mm(&self) -> f64 {
        self.reach_mm
    }

    /// y(z) below a crest (M161).
    pub(super) fn at(&self, z: f64, crest: f64) -> f64 {
        let first = self.tips.partition_point(|tip| tip.at[0] < z - self.reach_mm);
        let near = self.tips[first..].iter().take_while(|tip| tip.at[0] <= z + self.reach_mm);
        near.map(|tip| tip.at[1] + tip.edge.height_mm(z - tip.at[0])).fold(crest, f64::min)
    }
}

/// The first guess of a reach.
const FIRST_MM: f64 = 0.1;

/// Leaves out points that lie on the line between their neighbours, to a tolerance across it.
pub(super) fn thinned(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let mut is_kept = vec![false; points.len()];
    let mut open = Vec::new();
    if let Some(last) = points.len().checked_sub(1) {
        (is_kept[0], is_kept[last]) = (true, true);
        open.push((0, last));
    }
    while let Some((from, to)) = open.pop() {
        let ((x0, y0), (x1, y1)) = (points[from], points[to]);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = libm::hypot(dx, dy).max(f64::MIN_POSITIVE);
        let off = |at: usize| ((points[at].0 - x0) * dy - (points[at].1 - y0) * dx).abs() / length;
        let farthest = (from + 1..to).map(|at| (at, off(at))).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((at, _)) = farthest.filter(|(_, off)| *off > tolerance) {
            is_kept[at] = true;
            open.extend([(from, at), (at, to)]);
        }
    }
    points.iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}
