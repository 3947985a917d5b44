//! The section of the part at one angle. In: the places of the tip there, mm. Out: grooves in the order of Z,
//! each with the places that may have cut some of it.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z_i, y_i | mm | a place of the tip: along the axis, and its radius as in (M150) |
//! | z₁(y), z₂(y) | mm | flanks of a groove at a height: towards lower Z, towards higher Z |
//!
//! ```text
//! (M152) z₁(y) = min (z_i − x₁(y − y_i)),   z₂(y) = max (z_i + x₂(y − y_i))   over all places with y_i ≤ y
//! ```
//! What lies beside each other at the pitch line of the GO gauge without material between is one groove. A
//! place i has cut nothing that j does not cut if the same edge lies deeper there and
//! −(y_i − y_j) tan α₁ ≤ z_i − z_j ≤ (y_i − y_j) tan α₂, because x is concave (M151).

use crate::{
    edge::{Edge, Flank},
    nominal::Nominal,
};

/// Where the tip was when the spindle went through an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Along the axis, mm.
    pub z_mm: f64,
    /// Distance of the tip from the axis, mm.
    pub radius_mm: f64,
    /// Which edge: its number in [`Sections::edges`].
    pub edge: usize,
}

/// What tools did at angles of the spindle.
#[derive(Clone, Debug, PartialEq)]
pub struct Sections {
    /// The edges of the tools.
    pub edges: Vec<Edge>,
    /// Places at 360°/n · (0, 1 …), n of them.
    pub stations: Vec<Vec<Place>>,
}

/// A place of an edge in the coordinates of (M150).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tip {
    pub(crate) z: f64,
    pub(crate) y: f64,
    pub(crate) edge: usize,
    pub(crate) flanks: [Flank; 2],
}

impl Tip {
    /// The flanks that it cuts at a height, if it is that deep.
    fn at(&self, y: f64) -> Option<[f64; 2]> {
        let v = y - self.y;
        (v >= 0.0).then(|| [self.z - self.flanks[0].reach_mm(v), self.z + self.flanks[1].reach_mm(v)])
    }

    /// Whether it cuts nothing that another one does not cut.
    fn is_within(&self, other: &Tip) -> bool {
        let (z, deeper) = (self.z - other.z, self.y - other.y);
        let [t1, t2] = other.flanks.map(|flank| flank.tangent);
        self.edge == other.edge && deeper >= 0.0 && -deeper * t1 <= z && z <= deeper * t2
    }
}

/// One groove of a section: what cuts it.
#[derive(Clone, Debug)]
pub(crate) struct Groove {
    tips: Vec<Tip>,
    /// Its flanks at the pitch line of the GO gauge.
    ends: [f64; 2],
}

impl Groove {
    /// Its middle at the pitch line of the GO gauge.
    pub(crate) fn middle(&self) -> f64 {
        0.5 * (self.ends[0] + self.ends[1])
    }

    /// How much of a length it takes at the pitch line of the GO gauge.
    pub(crate) fn within(&self, [low, high]: [f64; 2]) -> f64 {
        self.ends[1].min(high) - self.ends[0].max(low)
    }

    /// z₁(y) and z₂(y) (M152); `None` below the groove.
    pub(crate) fn at(&self, y: f64) -> Option<[f64; 2]> {
        let all = self.tips.iter().filter_map(|tip| tip.at(y));
        all.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// The width at a height that the widest of its places would leave alone; 0 below all of them.
    pub(crate) fn widest_alone(&self, y: f64) -> f64 {
        self.tips.iter().filter_map(|tip| tip.at(y)).map(|[low, high]| high - low).fold(0.0, f64::max)
    }

    /// y of its deepest place.
    pub(crate) fn root(&self) -> f64 {
        self.tips.iter().map(|tip| tip.y).fold(f64::INFINITY, f64::min)
    }

    /// Takes a place, unless that cuts nothing new.
    fn take(&mut self, tip: Tip) {
        if !self.tips.iter().any(|other| tip.is_within(other)) {
            self.tips.retain(|other| !other.is_within(&tip));
            self.tips.push(tip);
        }
    }
}

/// The grooves of a section, by Z, and y of its deepest place.
pub(crate) fn grooves(nominal: &Nominal, edges: &[[Flank; 2]], places: &[Place]) -> (Vec<Groove>, f64) {
    let tip = |place: &Place| Tip {
        z: place.z_mm,
        y: nominal.sign() * place.radius_mm,
        edge: place.edge,
        flanks: edges[place.edge],
    };
    let all = places.iter().map(tip).map(|tip| (tip.at(nominal.line_mm(tip.z)), tip));
    let (mut deep, mut shallow, mut deepest) = (Vec::new(), Vec::new(), f64::INFINITY);
    for (ends, tip) in all {
        deepest = deepest.min(tip.y - nominal.line_mm(tip.z));
        match ends {
            Some(ends) => deep.push((ends, tip)),
            None => shallow.push(tip),
        }
    }
    deep.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
    let mut grooves: Vec<Groove> = Vec::new();
    for (ends, tip) in deep {
        match grooves.last_mut() {
            Some(groove) if ends[0] <= groove.ends[1] => {
                groove.ends[1] = groove.ends[1].max(ends[1]);
                groove.take(tip);
            }
            _ => grooves.push(Groove { tips: vec![tip], ends }),
        }
    }
    for tip in shallow {
        let after = grooves.partition_point(|groove| groove.middle() < tip.z);
        let near = [after.checked_sub(1), Some(after)].into_iter().flatten();
        let far =
            |at: &usize| grooves.get(*at).map_or(f64::INFINITY, |groove| (groove.middle() - tip.z).abs());
        let near =
            near.min_by(|a, b| far(a).total_cmp(&far(b))).filter(|at| far(at) < 0.5 * nominal.pitch_mm);
        if let Some(at) = near {
            grooves[at].take(tip);
        }
    }
    (grooves, deepest)
}
