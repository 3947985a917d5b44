//! A spindle that turns back and meets its index again.

use super::*;

/// An index that is met again lies where it lay: whatever was lost or gained on the way forth or back is
/// corrected to that, a fault beyond what is tolerated, and another index beyond eight counts.
#[test]
fn pulses_lost_before_turning_back_are_known_when_the_index_is_met_again() {
    for (shift, sign, forth) in (-8..=8)
        .flat_map(|shift| [1.0, -1.0].map(|sign| (shift, sign, true)))
        .chain((-8..=8).map(|shift| (shift, 1.0, false)))
    {
        let to_the_turn = |tolerated: i64| {
            let mut bench = Bench { tolerated, ..Bench::new(2500, 0.5) };
            assert_eq!(bench.turn_on(sign * 20.0, 0.8, true), None);
            bench.shift += if forth { shift.clamp(-4, 4) } else { 0 };
            assert_eq!(bench.turn_on(sign * 20.0, 0.3, true), None);
            bench.shift += if forth { shift - shift.clamp(-4, 4) } else { 0 };
            assert_eq!(bench.turn_on(sign * 20.0, 0.3, true), None);
            assert_eq!(bench.turn_on(sign * -20.0, 0.1, true), None);
            bench.shift += if forth { 0 } else { shift.clamp(-4, 4) };
            assert_eq!(bench.turn_on(sign * -20.0, 0.1, true), None);
            bench.shift += if forth { 0 } else { shift - shift.clamp(-4, 4) };
            let fault = bench.turn_on(sign * -20.0, 0.9, true);
            (bench, fault)
        };
        let (bench, fault) = to_the_turn(8);
        let true_count = bench.count(bench.before) - bench.shift;
        let off = bench.encoder.count(&bench.shown) - true_count;
        assert!(fault.is_none() && off.abs() <= 1, "{shift} {sign} {forth}: {off} counts off, {fault:?}");
        let (_, fault) = to_the_turn(0);
        let named = fault.is_some_and(|found| found.fault == Fault::EncoderPulsesLost);
        assert!(named || shift.abs() <= 2 && fault.is_none(), "{shift} {sign} {forth}: {fault:?}");
    }
    let mut bench = Bench { tolerated: 20, ..Bench::new(2500, 0.5) };
    assert_eq!(bench.turn_on(20.0, 0.8, true), None);
    for _ in 0..3 {
        bench.shift -= 4;
        assert_eq!(bench.turn_on(20.0, 0.2, true), None);
    }
    assert_eq!(bench.turn_on(-20.0, 1.0, true), found(Fault::EncoderPlausibility, 12));
    // A latch may differ by a count when it comes from the other side, and by none otherwise.
    let mut bench = Bench::new(2500, 0.5);
    assert_eq!(bench.turn_on(20.0, 0.8, true), None);
    bench.shift -= 1;
    assert_eq!(bench.turn_on(-20.0, 0.8, true), None);
}
