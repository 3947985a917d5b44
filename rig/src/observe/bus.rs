//! Whether `[bus]` is right, as the servo error tells. In: once per control cycle what each regulator said.
//! Out: what is believed and what it looks like, where that differs.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | e | mm | servo error, of what was measured against where the axis should have been then |
//! | v, a | mm/s, mm/s² | commanded speed, commanded acceleration |
//! | k | 1/s | gain of the position loop |
//! | δ | s | how much longer messages are under way, there and back, than believed |
//! | x | mm/s | commanded acceleration behind the lag of that loop |
//! | T | s | control cycle |
//!
//! A measurement that is older by δ seems to lag by v δ, a command that acts later by δ makes the axis lag
//! by as much. At an even speed the position loop takes the error away, and with an older measurement the
//! axis is silently elsewhere. It shows where the speed changes, but not which of the two ways is wrong:
//! ```text
//! e′ = a δ − k e,  so  e = δ x,  x′ = a − k x                                                  (M134)
//! δ = Σ x e / Σ x²,  of which  (Σ x e)² / (Σ x² Σ e²)  of the error is explained
//! ```
//! Wrong masses, friction and cogging leave errors of another shape: they explain little of it.

use machine::{Feedforward, Machine};
use protocol::{Axis, AxisState, AxisStatus, PerAxis};

/// Share of the servo error that has to be explained.
const EXPLAINED: f64 = 0.8;
/// And it is explained by whole cycles, but for this share of one.
const WHOLE: f64 = 0.3;

/// What timed motion has shown so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Bus {
    /// Gain of the position loop and x, of each axis that is asked.
    axes: PerAxis<Option<[f64; 2]>>,
    cycle_s: f64,
    /// Input and output as believed, control cycles.
    believed: u32,
    xe: f64,
    xx: f64,
    ee: f64,
}

impl Bus {
    /// Of the axes whose speed is fed forward as it has to be.
    pub(super) fn of(machine: &Machine) -> Bus {
        let mut axes = PerAxis::default();
        for (axis, config) in machine.axes().filter(|(_, config)| config.feedforward == Feedforward::Full) {
            axes[axis.index()] = Some([config.position_gain_1_s, 0.0]);
        }
        let believed = machine.bus.input_cycles + machine.bus.output_cycles;
        Bus { axes, cycle_s: machine.general.cycle_s, believed, ..Bus::default() }
    }

    /// Takes a control cycle (M134).
    pub(super) fn cycle(&mut self, statuses: &[(Axis, AxisStatus)]) {
        for (axis, status) in statuses {
            let Some([gain, x]) = &mut self.axes[axis.index()] else { continue };
            if status.state() != AxisState::Streaming {
                *x = 0.0;
                continue;
            }
            *x += self.cycle_s * (status.acceleration_mm_s2 - *gain * *x);
            if status.velocity_mm_s != 0.0 {
                let e = status.servo_error_mm;
                (self.xe, self.xx, self.ee) = (self.xe + *x * e, self.xx + *x * *x, self.ee + e * e);
            }
        }
    }

    /// How many control cycles more messages seem to be under way, if that explains the servo error.
    fn more(&self) -> Option<i64> {
        let cycles = self.xe / self.xx / self.cycle_s;
        let explained = self.xe * self.xe / (self.xx * self.ee);
        let whole = (cycles - cycles.round()).abs() <= WHOLE;
        (whole && cycles.round() != 0.0 && explained >= EXPLAINED).then_some(cycles.round() as i64)
    }

    /// What is to be told of it.
    pub(super) fn told(&self) -> Option<String> {
        let (more, believed) = (self.more()?, self.believed);
        let looks_like = u32::try_from(i64::from(believed) + more).ok()?;
        Some(format!(
            "input_cycles and output_cycles of [bus] are {believed} together, and the servo error where axes change \
             their speed is what it would be if {looks_like} were right: axes and threads lie off in motion; check \
             [bus], and velocity_lead_s, whose errors look the same"
        ))
    }
}
