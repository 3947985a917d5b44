//! A regulator allocates when it is made, and never again, whatever it compensates and feeds forward.

use crate::stand::{follows, machine, run};
use allocation_counter::measure;
use machine::{Difference, Feedforward};
use protocol::Axis;
use regulator::Regulator;

#[test]
fn a_tick_allocates_nothing() {
    for (feedforward, centred) in
        [(Feedforward::Full, false), (Feedforward::DifferenceVa, false), (Feedforward::DifferenceVa, true)]
    {
        let machine = machine(|x| {
            (x.feedforward, x.difference) = (feedforward, Difference { centred, ..Difference::default() });
            x.backlash_mm = 0.012;
            x.screw_error = vec![[0.0, -9.0], [30.0, 2.0], [55.0, 6.0], [72.0, -3.0], [120.0, 12.0]];
        });
        let made = measure(|| drop(Regulator::new(&machine, Axis::X)));
        let mut cycles = 0;
        let all = measure(|| run(&machine, follows, |_, _, _| cycles += 1));
        assert!(made.count_total > 0 && cycles > 6000, "{made:?}, {cycles} cycles");
        assert_eq!(all.count_total, made.count_total, "{feedforward:?}");
    }
}
