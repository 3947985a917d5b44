//! Where the tool is by the measure of the control. In: a machine, the true place of a slide. Out: the place
//! in the frame in which the part is made.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | x, p | mm | true place of the slide; the same by the measure of the control |
//! | H, h | mm | home in truth; home as believed; of an axis with a reference run its mark |
//! | L, l | mm | way per turn of the motor in truth; as believed |
//! | e | – | what is believed of the error of the screw, mm on a mm |
//!
//! ```text
//! x = H + (p − h) (L/l − e)
//! ```
//! Who measured a tool or a screw wrongly gets another part, in another place, and every pass of it is there:
//! no pass is beside its groove by that, and no control could know it. Behind a reference run H and h are
//! where the switch or the index is, which is known.

use machine::Machine;
use protocol::{Axis, Truth};

use super::excuse;

/// The measure of an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    axis: Axis,
    true_home_mm: f64,
    home_mm: f64,
    scale: f64,
}

impl Frame {
    pub(crate) fn of(machine: &Machine, axis: Axis) -> Frame {
        let Some(config) = machine.axis.get(&axis) else {
            return Frame { axis, true_home_mm: 0.0, home_mm: 0.0, scale: 1.0 };
        };
        let lead_mm = excuse::in_truth(machine, axis, "screw_lead_mm", config.screw_lead_mm);
        let believed = match config.screw_error.as_slice() {
            [[from_mm, from_um], .., [to_mm, to_um]] => (to_um - from_um) / (to_mm - from_mm) / 1000.0,
            _ => 0.0,
        };
        let scale = lead_mm / config.screw_lead_mm - believed;
        if let Some(reference) = config.reference {
            return Frame {
                axis,
                true_home_mm: reference.position_mm,
                home_mm: reference.position_mm,
                scale,
            };
        }
        Frame {
            axis,
            true_home_mm: config.home_mm + excuse::in_truth(machine, axis, "home_off_mm", 0.0),
            home_mm: config.home_mm,
            scale,
        }
    }

    /// p, mm.
    pub(crate) fn place_mm(&self, truth: &Truth) -> f64 {
        self.home_mm + (truth.axes[self.axis.index()].slide_mm - self.true_home_mm) / self.scale
    }
}

#[cfg(test)]
mod tests {
    use machine::Machine;
    use protocol::{Axis, Truth};

    use super::Frame;

    /// Where a slide is measured that is truly at 20 mm, with these beside what is believed.
    fn measured(home_off_mm: f64, lead_mm: f64, screw_error: &[[f64; 2]]) -> f64 {
        let mut machine = Machine::plain();
        let z = machine.axis.get_mut(&Axis::Z).expect("a lathe");
        (z.home_mm, z.screw_lead_mm, z.screw_error) = (100.0, 5.0, screw_error.to_vec());
        let truth = machine.plant["axis"]["z"].as_table_mut().expect("its truth");
        truth.insert("home_off_mm".into(), home_off_mm.into());
        truth.insert("screw_lead_mm".into(), lead_mm.into());
        let mut there = Truth::default();
        there.axes[Axis::Z.index()].slide_mm = 20.0;
        Frame::of(&machine, Axis::Z).place_mm(&there)
    }

    #[test]
    fn what_was_measured_wrongly_is_taken_off() {
        assert_eq!(measured(0.0, 5.0, &[]), 20.0);
        assert!((measured(0.005, 5.0, &[]) - 19.995).abs() < 1e-12);
        // 80 mm from home a screw that is longer by 1e-4 is 8 µm beyond, but for what is believed of it.
        assert!((measured(0.0, 5.0005, &[]) - 20.008).abs() < 1e-6);
        assert!((measured(0.0, 5.0005, &[[-100.0, -10.0], [100.0, 10.0]]) - 20.0).abs() < 1e-9);
    }
}
