//! Lines that are put together (G64 Q): within Q, forwards, in order, nothing lost.

use crate::programs::{Line, N, Place, end_of, program, through};
use crate::rounded::{distance, nearest};
use crate::seed::Seed;
use crate::stand::{Stand, ask};
use motion::Path;
use motion::chain::{Block, Corner, Feed, Merge, Merged};

const BLEND: Corner = Corner::Blend(0.02);
const FEED: Feed = Feed::PerSecond(50.0);

fn merged(blocks: &[Line], within: f64) -> Vec<Merged<N, Place>> {
    let mut merge = Merge::new([true; N]);
    let mut out: Vec<_> = blocks.iter().filter_map(|block| merge.push(*block, within)).collect();
    out.extend(merge.flush());
    assert!(merge.flush().is_none());
    out
}

/// What came in comes out in order, and every end of a block that was put together lies within Q of its line.
fn holds(blocks: &[Line], within: f64) -> Vec<Merged<N, Place>> {
    let out = merged(blocks, within);
    let mut number = 0;
    for Merged { block, count } in &out {
        assert_eq!(block.tag.number, number, "order");
        let parts = &blocks[number..number + count];
        let last = parts.last().expect("at least one");
        let at =
            |tag: &Place, from: [f64; N]| -> [f64; N] { std::array::from_fn(|i| tag.start[i] + from[i]) };
        let (end, wanted) = (at(&block.tag, end_of(&block.path)), at(&last.tag, end_of(&last.path)));
        assert!(distance(&end, &wanted) <= 1e-9, "ends at {end:?}, not {wanted:?}");
        let mut gone = 0.0;
        for part in &parts[1..] {
            let point: [f64; N] = std::array::from_fn(|i| part.tag.start[i] - block.tag.start[i]);
            let off = nearest(&block.path, &point, 0.0);
            assert!(off <= within.max(1e-9) * (1.0 + 1e-9), "{off} mm beside the line of {count}");
            let share = block.path.at(1.0)[0].iter().zip(&point).map(|(d, p)| d * p).sum::<f64>();
            assert!(share > gone && share < block.path.length(), "backwards");
            gone = share;
            assert_eq!((part.feed, part.corner), (block.feed, block.corner));
            assert!(block.room <= part.room);
        }
        assert!(*count <= 65, "{count} lines in one");
        number += count;
    }
    assert_eq!(number, blocks.len(), "nothing is lost");
    out
}

#[test]
fn random_programs_are_put_together_within_q_and_still_run() {
    let mut saved = 0;
    for number in 0..300 {
        let mut random = Seed::new(20_000 + number);
        let blocks = program(&mut random);
        let out = holds(&blocks, if random.chance(0.2) { 0.0 } else { random.scale(1e-3, 1.0) });
        saved += blocks.len() - out.len();
        if number % 10 == 0 {
            let program: Vec<Line> = out.iter().map(|merged| merged.block).collect();
            let mut stand = Stand::new(&program);
            stand.run(&ask());
            stand.ends();
        }
    }
    assert!(saved > 300, "only {saved} blocks saved");
}

#[test]
fn a_finely_divided_curve_becomes_chords() {
    // Chords of a circle with the radius R leave it by c²/8R: those of 2 sqrt(2 R Q) leave it by Q.
    const RADIUS: f64 = 50.0;
    const WITHIN: f64 = 0.01;
    let points: Vec<[f64; N]> = (0..=2000)
        .map(|k| f64::from(k) * 0.1 / RADIUS)
        .map(|angle| [RADIUS * libm::cos(angle), RADIUS * libm::sin(angle), 0.0])
        .collect();
    let out = holds(&through(&points, FEED, BLEND), WITHIN);
    let longest = 2.0 * (2.0 * RADIUS * WITHIN).sqrt();
    for Merged { block, .. } in &out[..out.len() - 1] {
        let length = block.path.length();
        assert!(length <= longest + 1e-6 && length > longest - 0.2, "{length} of {longest}");
    }
}

#[test]
fn lines_in_line_are_one_whatever_q_is() {
    let points: Vec<[f64; N]> =
        (0..=10).map(|k| f64::from(k) * 0.1).map(|t| [300.0 + 2.0 * t, 7.0 - t, 0.3 * t]).collect();
    for corner in [BLEND, Corner::Exact(1e-3)] {
        let out = holds(&through(&points, FEED, corner), 0.0);
        assert_eq!(out.len(), 1);
        assert!((out[0].block.path.length() - distance(&points[0], &points[10])).abs() < 1e-12);
    }
    assert_eq!(holds(&through(&points, FEED, Corner::Stop), 1.0).len(), 10, "G61.1 stops at every end");
}

#[test]
fn what_turns_back_or_aside_or_differs_stays_apart() {
    let zigzag: Vec<[f64; N]> = (0..20).map(|k| [f64::from(k), f64::from(k % 2), 0.0]).collect();
    assert_eq!(holds(&through(&zigzag, FEED, BLEND), 0.4).len(), 19);
    // In line, but there and back: within any Q of a line, not forwards along it.
    let back = [[0.0; N], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
    assert_eq!(holds(&through(&back, FEED, BLEND), 10.0).len(), 3);
    let nowhere = [[0.0; N], [2.0, 0.0, 0.0], [0.0; N]];
    assert_eq!(holds(&through(&nowhere, FEED, BLEND), 10.0).len(), 2);
    // Within Q only if the lines are rounded.
    let bent = [[0.0; N], [1.0, 0.005, 0.0], [2.0, 0.0, 0.0]];
    assert_eq!(holds(&through(&bent, FEED, BLEND), 0.01).len(), 1);
    assert_eq!(holds(&through(&bent, FEED, Corner::Exact(1e-3)), 0.01).len(), 2);

    let mut blocks = through(&[[0.0; N], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]], FEED, BLEND);
    blocks[1].feed = Feed::PerSecond(51.0);
    assert_eq!(holds(&blocks, 1.0).len(), 3, "another feed");
    blocks[1] = Block { feed: FEED, corner: Corner::Blend(0.03), ..blocks[1] };
    assert_eq!(holds(&blocks, 1.0).len(), 3, "another tolerance");
    let arc = Path::arc([0, 1], [0.0, -1e6], [1.0, -1e6], 1, [0.0; N], &[true; N]).expect("nearly straight");
    blocks[1] = Block { path: arc, corner: BLEND, ..blocks[1] };
    assert_eq!(merged(&blocks, 1.0).len(), 3, "an arc");
    let mut merge = Merge::new([true; N]);
    assert!(merge.push(blocks[0], 0.1).is_none());
    assert!(merge.push(blocks[2], 0.2).is_some(), "another Q");
}

/// A line that never bends is let go of: memory is bounded.
#[test]
fn a_long_row_is_let_go_of_in_parts() {
    let points: Vec<[f64; N]> = (0..=200).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    let counts: Vec<usize> =
        holds(&through(&points, FEED, BLEND), 0.0).iter().map(|merged| merged.count).collect();
    assert_eq!(counts, [65, 65, 65, 5]);
}
