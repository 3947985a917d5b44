//! How wide the blends of corners are: as wide as the tolerance allows, over other corners too. In: corners
//! with the ways between them, mm. Out: half the width of each blend, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | sᵢ, Δᵢ, Pᵢ | mm, –, mm | place of a corner, the jump of p₁ there, how far the path may be led away |
//! | rᵢ | mm | half the width of its blend |
//! | W(s) | mm | how far all blends lead away from the path at s, at most |
//! | Rᵢ | mm | the widest that all blends may be which reach sᵢ |
//!
//! ```text
//! W(s) = Σ |Δⱼ| B1(s − sⱼ; rⱼ)
//! Rᵢ = max r:  Σ |Δⱼ| B1(sᵢ − sⱼ; r) ≤ Pᵢ;  0 where the machine stops and beside arcs
//! rⱼ = min over i of max(Rᵢ, |sᵢ − sⱼ|), 0.8 |sᵢ − sⱼ| where laws overlap at a stop (M194)        (M172)
//! ```
//! Then W ≤ Pᵢ at every corner: whatever reaches it is at most as wide as Rᵢ, and B1 grows with r. Between
//! two corners W is convex, since every B1 is, so it is nowhere larger than at the larger of both. No blend
//! reaches a stop, and none reaches over an arc.
//!
//! Where both lines of a corner are equally long, its blend ends at a corner: then the blends of an even
//! division add up to the curvature of the curve and to nothing else (M60).

use super::junction::{Junction, Turn};
use super::pieces::{CLEAR_OF_STOP, CORNERS, Piece, Pieces, REACH_MM};
use crate::blend::{Blend, aside};

/// Lines whose lengths differ by less, relative, are equally long.
const ALIKE: f64 = 1e-3;
/// Halvings, in ratio, of the range in which R lies: from a hundredfold it comes to two per cent.
const HALVINGS: u32 = 8;

impl<const N: usize, T: Copy> Pieces<N, T> {
    /// Makes the blends known that can be known now.
    pub(super) fn widen(&mut self) {
        while let Some(room) = self.room(self.roomed) {
            self.ring[self.roomed].room = Some(room);
            self.roomed += 1;
        }
        while let Some(blend) = self.blend(self.blended) {
            self.ring[self.blended].blend = Some(blend);
            self.blended += 1;
        }
    }

    /// The corner at the end of a block, if blends of others may reach over it.
    pub(super) fn crossed(&self, k: usize) -> Option<&Turn<N>> {
        match &self.ring.get(k)?.junction {
            Some(Junction::Corner(turn)) if !turn.alone => Some(turn),
            _ => None,
        }
    }

    /// The widest that a blend of a corner may be, whatever the tolerance: to the nearer other end of its
    /// lines, or so far over other corners.
    fn widest(&self, k: usize) -> f64 {
        let shorter = self.ring[k].length().min(self.ring[k + 1].length());
        let here = self.ring[k].end;
        let back = k.checked_sub(CORNERS).map_or(f64::INFINITY, |j| here - self.ring[j].end);
        let on = self.ring.get(k + CORNERS).map_or(f64::INFINITY, |piece| piece.end - here);
        REACH_MM.max(shorter).min(back).min(on)
    }

    /// R of the junction at the end of a block; `None` if too little is known of what follows.
    fn room(&self, k: usize) -> Option<f64> {
        let piece = self.ring.get(k)?;
        piece.junction?;
        let Some(turn) = self.crossed(k) else { return Some(0.0) };
        let most = self.widest(k).min(turn.widest);
        let mut near = [(0.0, 0.0); 2 * CORNERS + 1];
        near[0] = (0.0, turn.size);
        let mut count = 1;
        let mut add = |way: f64, size: f64| {
            near[count] = (way, size);
            count += 1;
        };
        for j in k + 1..=k + CORNERS {
            let way = match self.ring.get(j) {
                Some(next) => next.end - piece.end,
                None => return None,
            };
            if way >= most {
                break;
            }
            self.ring[j].junction?;
            let Some(turn) = self.crossed(j) else { break };
            add(way, turn.size);
        }
        for j in (k.saturating_sub(CORNERS)..k).rev() {
            let way = piece.end - self.ring[j].end;
            let Some(turn) = self.crossed(j).filter(|_| way < most) else { break };
            add(way, turn.size);
        }
        Some(widest_within(&near[..count], most, turn.tolerance))
    }

    /// The blend of the junction at the end of a block, where the room of all that it may reach is known.
    fn blend(&self, k: usize) -> Option<Blend<N>> {
        if k >= self.roomed {
            return None;
        }
        let turn = match &self.ring[k].junction {
            Some(Junction::Corner(turn)) => turn,
            Some(Junction::Fixed(blend)) => return Some(*blend),
            _ => return Some(Blend::NONE),
        };
        if turn.size == 0.0 {
            return Some(Blend::NONE);
        }
        let here = self.ring[k].end;
        let lengths = [self.ring[k].length(), self.ring[k + 1].length()];
        let mut half = turn.widest.min(self.widest(k));
        half = if turn.alone { half.min(lengths[0]).min(lengths[1]) } else { half.min(self.ring[k].room?) };
        let mut end = 0.0;
        for piece in self.ring.range(k + 1..) {
            let way = piece.end - here;
            if CLEAR_OF_STOP * way >= half {
                break;
            }
            half = half.min(piece.room?.max(piece.blended_of(way)));
        }
        for j in (0..k).rev() {
            let way = here - self.ring[j].end;
            if CLEAR_OF_STOP * way >= half {
                break;
            }
            half = half.min(self.ring[j].room?.max(self.ring[j].blended_of(way)));
        }
        half = half.min(here - (self.ring[0].end - self.ring[0].length()));
        if (lengths[0] - lengths[1]).abs() <= ALIKE * lengths[0].min(lengths[1]) {
            for Piece { end: place, .. } in self.ring.range(k + 1..) {
                if place - here > half * (1.0 + ALIKE) {
                    break;
                }
                end = (place - here).min(half);
            }
            half = if end > 0.0 { end } else { half };
        }
        Some(Blend::new([turn.jump, [0.0; N], [0.0; N]], half))
    }
}

/// The widest half width up to `most` for all corners, given by their ways and sizes, that leads away by no
/// more than `tolerance` at the way 0. B1 grows in proportion to r at least.
fn widest_within(corners: &[(f64, f64)], most: f64, tolerance: f64) -> f64 {
    let away = |r: f64| corners.iter().map(|(way, size)| size * aside(*way, r)).sum::<f64>();
    let at_most = away(most);
    if at_most <= tolerance {
        return most;
    }
    let (mut low, mut high) = (most * tolerance / at_most, most);
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        if away(middle) <= tolerance {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
