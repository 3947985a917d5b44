//! The blocks of a chain in the order of the path, and their blends. In: blocks, one behind the other. Out:
//! blocks whose path is settled, and the position of the axes on it.
//!
//! ```text
//! blocks: | gone, within reach | settled: the machine is on the first | their blends are not known yet |
//! ```
//! A blend may reach over several corners, back to blocks that came before. So a block is settled as soon as
//! no blend that is not known yet can reach it, and one that the machine has left is kept while its blends
//! reach on. How wide a blend is depends on what lies around it alone (`width.rs`), not on when it arrived.

use std::collections::VecDeque;

use super::junction::{Junction, junction};
use super::sweep;
use super::zone::Bend;
use super::{BLOCKS, Block, SAME};
use crate::blend::Blend;
use crate::limits::Limits;
use crate::sample::Sample;

/// Most corners over which a blend reaches, on either side: what a place costs is bounded by it.
pub(super) const CORNERS: usize = 16;
/// Farthest that a blend reaches over other corners, mm. To the next one it may reach farther.
pub(super) const REACH_MM: f64 = 4.0;
/// So much of the way to a stop the blend of another corner may take: laws overlap on the rest.
pub(super) const CLEAR_OF_STOP: f64 = 0.8;

/// A block and the junction at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<const N: usize, T> {
    pub(super) block: Block<N, T>,
    /// Way from the start of the chain to its end, mm.
    pub(super) end: f64,
    /// `None`: what follows is not known.
    pub(super) junction: Option<Junction<N>>,
    /// How wide a blend that reaches this junction may be, as soon as it is known.
    pub(super) room: Option<f64>,
    /// As soon as it is known.
    pub(super) blend: Option<Blend<N>>,
}

impl<const N: usize, T> Piece<N, T> {
    pub(super) fn length(&self) -> f64 {
        self.block.path.length()
    }

    /// How much of a way of `way` mm to the junction at its end a blend may take.
    pub(super) fn blended_of(&self, way: f64) -> f64 {
        match self.junction {
            Some(Junction::Stop(tolerance)) if tolerance > 0.0 => CLEAR_OF_STOP * way,
            _ => way,
        }
    }

    pub(super) fn stops(&self) -> bool {
        matches!(self.junction, Some(Junction::Stop(_)))
    }
}

/// Blends that reach a piece: of the junctions before it and behind it, nearest first, with their ways from
/// its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reaching<'a, const N: usize> {
    pub(super) blend: &'a Blend<N>,
    pub(super) at: f64,
}

/// The blocks.
#[derive(Clone, Debug)]
pub(super) struct Pieces<const N: usize, T> {
    pub(super) ring: VecDeque<Piece<N, T>>,
    /// Those that the machine has left.
    gone: usize,
    /// The first one that is not settled, the first junction without room, the first without a blend.
    settled: usize,
    pub(super) roomed: usize,
    pub(super) blended: usize,
}

impl<const N: usize, T: Copy> Pieces<N, T> {
    pub(super) fn new() -> Pieces<N, T> {
        Pieces { ring: VecDeque::new(), gone: 0, settled: 0, roomed: 0, blended: 0 }
    }

    /// Takes the memory of all the blocks that there may be, and writes to it.
    pub(super) fn take_memory(&mut self, block: Block<N, T>) {
        let piece = Piece { block, end: 0.0, junction: None, room: None, blend: None };
        self.ring = VecDeque::with_capacity(BLOCKS + CORNERS + 1);
        self.ring.resize(BLOCKS + CORNERS + 1, piece);
        self.ring.clear();
    }

    /// Blocks that the machine has not left.
    pub(super) fn len(&self) -> usize {
        self.ring.len() - self.gone
    }

    /// Blocks that are not settled.
    pub(super) fn pending(&self) -> usize {
        self.ring.len() - self.settled
    }

    /// The block that the machine is on.
    pub(super) fn front(&self) -> Option<&Piece<N, T>> {
        self.ring.get(self.gone)
    }

    /// Those that are settled, from the one that the machine is on.
    pub(super) fn ahead(&self) -> impl Iterator<Item = &Piece<N, T>> {
        self.ring.range(self.gone..self.settled)
    }

    /// The settled block that ends `way` mm behind the start of the one that the machine is on.
    pub(super) fn ending_at(&self, way: f64) -> Option<usize> {
        let mut end = 0.0;
        let k = self.ahead().position(|piece| {
            end += piece.length();
            end >= way - SAME
        })?;
        (end <= way + SAME).then_some(self.gone + k)
    }

    /// The block that the machine has left last.
    pub(super) fn left_last(&self) -> Option<usize> {
        self.gone.checked_sub(1)
    }

    /// Length of the block that the machine is on, if that is settled, mm.
    pub(super) fn settled_length(&self) -> Option<f64> {
        self.ahead().next().map(Piece::length)
    }

    /// The machine leaves the front one.
    pub(super) fn leave(&mut self) {
        self.gone += 1;
        if self.gone > CORNERS {
            self.ring.pop_front();
            for cursor in [&mut self.gone, &mut self.settled, &mut self.roomed, &mut self.blended] {
                *cursor -= 1; // all of them are behind what is gone
            }
        }
    }

    pub(super) fn clear(&mut self) {
        self.ring.clear();
        (self.gone, self.settled, self.roomed, self.blended) = (0, 0, 0, 0);
    }

    /// Appends a block.
    pub(super) fn push(&mut self, block: Block<N, T>, axes: &[Limits; N]) {
        let begin = self.ring.back().map_or(0.0, |last| last.end);
        if let Some(last) = self.ring.back_mut() {
            last.junction = Some(junction(&last.block, &block, axes));
        }
        let end = begin + block.path.length();
        self.ring.push_back(Piece { block, end, junction: None, room: None, blend: None });
        self.widen();
    }

    /// Nothing follows.
    pub(super) fn close(&mut self) {
        if let Some(last) = self.ring.back_mut() {
            last.junction = last.junction.or(Some(Junction::Stop(0.0)));
        }
        self.widen();
    }

    /// The next block, if no blend that is not known yet can reach it; it counts as settled from now on.
    pub(super) fn settle(&mut self) -> Option<usize> {
        let k = self.settled;
        let end = self.ring.get(k)?.end;
        for j in k..self.ring.len() {
            let far = j > k && self.ring[j].end - end >= REACH_MM;
            if far || j - k >= CORNERS {
                break;
            }
            self.ring[j].junction?;
            if j >= self.blended {
                return None;
            }
            if self.crossed(j).is_none() {
                break;
            }
        }
        self.settled += 1;
        Some(k)
    }

    /// The blends that reach a piece: those of the junctions before it, then those behind it.
    pub(super) fn reaching(&self, k: usize) -> impl Iterator<Item = Reaching<'_, N>> {
        let mut at = 0.0;
        let before = self.ring.range(k.saturating_sub(CORNERS)..k).rev().filter_map(move |piece| {
            let here = at;
            at -= piece.length();
            let blend = piece.blend.as_ref()?;
            (blend.half() > -here).then_some(Reaching { blend, at: here })
        });
        let length = self.ring.get(k).map_or(0.0, Piece::length);
        let mut at = 0.0;
        let behind = self.ring.range(k..self.ring.len().min(k + CORNERS)).filter_map(move |piece| {
            at += piece.length();
            let blend = piece.blend.as_ref()?;
            (blend.half() > at - length).then_some(Reaching { blend, at })
        });
        before.chain(behind)
    }

    /// How far blends of the junctions before a block reach into it, and those of the ones behind it, mm.
    pub(super) fn reached(&self, k: usize) -> [f64; 2] {
        let length = self.ring[k].length();
        let (mut before, mut behind) = (0.0_f64, 0.0_f64);
        for Reaching { blend, at } in self.reaching(k) {
            if at <= 0.0 {
                before = before.max(blend.half() + at);
            } else {
                behind = behind.max(blend.half() - (at - length));
            }
        }
        [before, behind]
    }

    /// The borders of the stretches of a block: up to where the blends from behind it begin, where those from
    /// before it end, or where both are; then what is left.
    pub(super) fn borders(&self, k: usize) -> [f64; 2] {
        let length = self.ring[k].length();
        let [before, behind] = self.reached(k);
        let (first, second) = (before.min(length), (length - behind).max(0.0));
        [first.min(second), first.max(second)]
    }

    /// Bounds of the derivatives over these stretches of a block.
    pub(super) fn bends(&self, k: usize, borders: [f64; 2]) -> [Bend<N>; 3] {
        let path = &self.ring[k].block.path;
        let length = path.length();
        let mut bends = match path.is_line() {
            true => {
                let corners = self.reaching(k).filter(|reaching| reaching.blend.corner_only());
                sweep::bounds(&path.at(0.0)[1], length, borders, corners)
            }
            false => [Bend::of(path); 3],
        };
        let fixed = |k: usize| match self.ring.get(k)?.junction {
            Some(Junction::Fixed(blend)) => Some(blend),
            _ => None,
        };
        let ends = [0.0, borders[0], borders[1], length];
        if let Some((blend, before)) = k.checked_sub(1).and_then(|k| fixed(k).zip(self.ring.get(k))) {
            for (bend, _) in bends.iter_mut().zip(ends).filter(|(_, begin)| *begin < blend.half()) {
                *bend = bend.with(&blend, &before.block.path.shares());
            }
        }
        if let Some((blend, behind)) = fixed(k).zip(self.ring.get(k + 1)) {
            let reached = ends[1..].iter().map(|end| *end > length - blend.half());
            for (bend, _) in bends.iter_mut().zip(reached).filter(|(_, reached)| *reached) {
                *bend = bend.with(&blend, &behind.block.path.shares());
            }
        }
        bends
    }

    /// The motion of the axes on the front block, along the blended path (M55).
    pub(super) fn follow(&self, along: &Sample) -> [Sample; N] {
        let Some(piece) = self.front() else { return [Sample::default(); N] };
        let mut p = piece.block.path.at(along.s);
        for Reaching { blend, at } in self.reaching(self.gone) {
            blend.add(along.s - at, &mut p);
        }
        along.along(&p)
    }
}
