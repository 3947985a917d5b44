//! Whether the loop of an axis swings. In: its servo error, cycle by cycle, mm. Out: how far it swung last,
//! as long as it does.
//!
//! An encoder that jumps does so out of the quiet; a loop that is too fast for what moves goes to and fro
//! first, farther and farther. Both end in the same fault, and need another remedy.

use machine::Machine;
use protocol::PerAxis;

/// A half swing takes no longer, s: slower ones are no matter of a loop.
const LONGEST_S: f64 = 0.02;
/// So many in a row are a swing.
const HALVES: u32 = 4;

/// Watches one servo error.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swing {
    /// A half swing goes farther than this, mm, and takes no more control cycles.
    least_mm: f64,
    longest: u32,
    /// The farthest of the half swing in hand, mm, and its control cycles.
    farthest_mm: f64,
    cycles: u32,
    /// Half swings in a row before it, and how far the last one went, mm.
    halves: u32,
    last_mm: f64,
}

impl Swing {
    /// Those of every axis.
    pub(super) fn of(machine: &Machine) -> PerAxis<Swing> {
        let longest = (LONGEST_S / machine.general.cycle_s) as u32;
        let mut swings = PerAxis::<Swing>::default();
        for (axis, config) in machine.axes() {
            swings[axis.index()] = Swing { least_mm: config.in_position_mm, longest, ..Swing::default() };
        }
        swings
    }

    pub(super) fn cycle(&mut self, error_mm: f64) {
        self.cycles = self.cycles.saturating_add(1);
        let far_and_quick = self.farthest_mm.abs() > self.least_mm && self.cycles <= self.longest;
        if error_mm * self.farthest_mm < 0.0 {
            self.halves = if far_and_quick { self.halves + 1 } else { 0 };
            (self.last_mm, self.farthest_mm, self.cycles) = (self.farthest_mm.abs(), error_mm, 0);
        } else if error_mm.abs() > self.farthest_mm.abs() {
            self.farthest_mm = error_mm;
        }
        if self.cycles > self.longest {
            self.halves = 0;
        }
    }

    /// What to look at if it swings.
    pub(super) fn told(&self) -> Option<String> {
        let swings = self.halves >= HALVES;
        swings.then(|| {
            format!(
                "it swings, by {:.0} µm last: the loop is too fast for what moves; check screw_lead_mm and mass_kg, \
                 [bus], then the gains",
                1e3 * self.last_mm
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A servo error that swings at so many Hz, by so many µm, for 0.1 s, and is then this, mm.
    fn swings(hz: f64, um: f64, then_mm: f64) -> Option<String> {
        let [mut swing, ..] = Swing::of(&Machine::plain());
        let error =
            |cycle: u32| 1e-3 * um * libm::sin(core::f64::consts::TAU * hz * 5e-4 * f64::from(cycle) + 0.1);
        (0..200).for_each(|cycle| swing.cycle(error(cycle)));
        swing.cycle(then_mm);
        swing.told()
    }

    #[test]
    fn a_loop_that_swings_is_told_from_a_jump_out_of_the_quiet() {
        let told = swings(120.0, 9.0, 0.05).expect("it swings");
        assert!(told.contains("by 9 µm") && told.contains("screw_lead_mm"), "{told}");
        for (hz, um) in [(120.0, 1.0), (10.0, 9.0), (0.0, 0.0)] {
            assert_eq!(swings(hz, um, 0.05), None, "{hz} Hz, {um} µm");
        }
    }
}
