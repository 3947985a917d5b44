//! Lines in a row as one: what a CAM system has divided finely is put together again (G64 Q).
//! In: blocks one by one. Out: blocks of which each stands for one or several, in the same order.
//!
//! Lines of one feed and one path mode are put together while every point between stays within Q mm of the line from
//! the start of the first to the end of the last, and they go forwards along it. Where the corners are not rounded (G61),
//! or Q is 0, only lines that lie exactly in line are. Blends come on top: the path leaves the program by P + Q at most.

use super::{Block, Corner};
use crate::path::Path;

/// Most points between: one more, and the line is let go of.
const BETWEEN: usize = 64;
/// Lines that lie in line by their numbers do so within this, mm.
const IN_LINE: f64 = 1e-9;

/// Puts lines together before they are appended to a [`Chain`](super::Chain). It holds one block back.
///
/// ```
/// use motion::Path;
/// use motion::chain::{Block, Corner, Feed, Merge};
/// let line = |x, y| {
///     let path = Path::line([x, y], &[true; 2]).expect("it has a length");
///     Block { path, feed: Feed::PerSecond(20.0), corner: Corner::Blend(0.02), room: 1.0, tag: () }
/// };
/// let mut merge = Merge::new([true; 2]);
/// assert!(merge.push(line(1.0, 0.001), 0.002).is_none());
/// assert!(merge.push(line(1.0, -0.001), 0.002).is_none()); // a thousandth beside the straight way
/// let both = merge.push(line(0.0, 1.0), 0.002).expect("a corner"); // lets go of what came before it
/// assert_eq!((both.count, both.block.path.length()), (2, 2.0));
/// assert_eq!(merge.flush().map(|last| last.count), Some(1));
/// ```
#[derive(Clone, Debug)]
pub struct Merge<const N: usize, T> {
    metric: [bool; N],
    held: Option<Merged<N, T>>,
    /// Q of the line in hand, mm.
    within: f64,
    /// Where its parts meet, mm from its start.
    points: [[f64; N]; BETWEEN],
}

/// A block that stands for several.
#[derive(Clone, Copy, Debug)]
pub struct Merged<const N: usize, T> {
    /// From the start of the first to the end of the last, with the tag of the first.
    pub block: Block<N, T>,
    /// How many there were, at least 1.
    pub count: usize,
}

impl<const N: usize, T: Copy> Merge<N, T> {
    /// Nothing in hand. `metric` says which axes make the length of a line, as for [`Path::line`].
    #[must_use]
    pub fn new(metric: [bool; N]) -> Merge<N, T> {
        Merge { metric, held: None, within: 0.0, points: [[0.0; N]; BETWEEN] }
    }

    /// Takes the next block; `within` is its Q, mm. Gives the block before it, if the next one does not continue it.
    pub fn push(&mut self, block: Block<N, T>, within: f64) -> Option<Merged<N, T>> {
        if let Some(longer) = self.longer(&block, within) {
            let joint = self.held.map_or([0.0; N], |held| end_of(&held.block.path));
            if let Some(point) = self.points.get_mut(longer.count - 2) {
                *point = joint;
            }
            self.held = Some(longer);
            return None;
        }
        self.within = within;
        self.held.replace(Merged { block, count: 1 })
    }

    /// Gives the block in hand: none follows now.
    pub fn flush(&mut self) -> Option<Merged<N, T>> {
        self.held.take()
    }

    /// The block in hand with another line at its end, if they can be one.
    fn longer(&self, next: &Block<N, T>, within: f64) -> Option<Merged<N, T>> {
        let held = self.held.as_ref()?;
        let (last, count) = (&held.block, held.count);
        let alike = last.feed == next.feed && last.corner == next.corner && within == self.within;
        if !alike || count > BETWEEN || !last.path.is_line() || !next.path.is_line() {
            return None;
        }
        let tolerance = match last.corner {
            Corner::Stop => return None,
            Corner::Exact(_) => IN_LINE,
            Corner::Blend(_) => within.max(IN_LINE),
        };
        let (joint, way) = (end_of(&last.path), end_of(&next.path));
        let end: [f64; N] = core::array::from_fn(|i| joint[i] + way[i]);
        let square = dot(&end, &end);
        let mut gone = 0.0;
        for point in self.points.iter().take(count - 1).chain([&joint]) {
            let share = dot(point, &end) / square;
            let off: [f64; N] = core::array::from_fn(|i| point[i] - share * end[i]);
            let forwards = share > gone && share < 1.0;
            if !forwards || dot(&off, &off).sqrt() > tolerance {
                return None;
            }
            gone = share;
        }
        let path = Path::line(end, &self.metric)?;
        let block = Block { path, room: last.room.min(next.room), ..*last };
        Some(Merged { block, count: count + 1 })
    }
}

fn end_of<const N: usize>(path: &Path<N>) -> [f64; N] {
    let [end, ..] = path.at(path.length());
    end
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
