//! M27: a sin² pulse of jerk has half the mean of a rectangular one, so a move takes the time of the fastest
//! one with rectangular jerk at half the limit. The fastest one is that of rsruckig, which shares no code
//! with us.

use crate::peer::{Asked, Peer, blocks};
use motion::Binding;

const MOVES: usize = 5000;

/// Our time over that of the peer at half the jerk limit.
fn ratio(peer: &mut Peer, asked: &Asked) -> f64 {
    let ours = asked.plan().expect("it was drawn so").duration();
    ours / peer.time(&asked.input(0.5)).unwrap_or_else(|| panic!("rsruckig refuses {asked:?}"))
}

/// A ramp of this block is slowed by the limit of the jerk rate.
fn jerk_rate_binds(asked: &Asked) -> bool {
    let block = asked.plan().expect("it was drawn so");
    [block.accel(), block.decel()]
        .iter()
        .any(|ramp| ramp.dv() != 0.0 && motion::Ramp::peak_jerk(ramp.dv(), &asked.limits).1 != Binding::Jerk)
}

#[test]
fn moves_from_rest_to_rest_take_the_optimal_time_at_half_the_jerk() {
    let mut peer = Peer::new();
    for asked in blocks(1, MOVES, true, f64::INFINITY) {
        let ratio = ratio(&mut peer, &asked);
        assert!((ratio - 1.0).abs() <= 1e-6, "{ratio} times that of rsruckig: {asked:?}");
    }
}

#[test]
fn blocks_with_feeds_at_their_ends_do_so_too() {
    let mut peer = Peer::new();
    for asked in blocks(2, MOVES, false, f64::INFINITY) {
        let ratio = ratio(&mut peer, &asked);
        assert!((ratio - 1.0).abs() <= 1e-6, "{ratio} times that of rsruckig: {asked:?}");
    }
}

#[test]
fn the_jerk_rate_alone_makes_a_move_slower() {
    let mut peer = Peer::new();
    let mut bound = 0;
    for asked in blocks(3, MOVES, true, 1e4) {
        let (binds, ratio) = (jerk_rate_binds(&asked), ratio(&mut peer, &asked));
        assert!(
            binds && ratio > 1.0 - 1e-6 || (ratio - 1.0).abs() <= 1e-6,
            "{ratio}, bound: {binds}: {asked:?}"
        );
        bound += usize::from(binds);
    }
    assert!((MOVES / 10..MOVES * 9 / 10).contains(&bound), "the jerk rate bound {bound} of {MOVES}");
}
