//! What the axes are told in a tick, and what of it each of them gets.

use protocol::{Axis, AxisCommand, Cycle, Position};

use super::InHand;

/// What every axis is told in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // lives on the stack for one tick
pub(crate) enum Order {
    /// Follow the setpoint of the frame.
    Stream,
    /// Hold, or go on with the pass in hand.
    Hold,
    /// Cut this pass.
    Arm(InHand),
    /// Give up a pass that has not begun to move.
    CallOff,
    /// Leave the pass in hand in this cycle, or at once if it is over.
    Leave(Cycle),
    /// Come to rest at once.
    Stop,
    /// The drive of this axis takes this offset; the others hold.
    Reference(Axis, Position),
}

impl Order {
    /// The command of one axis.
    pub(crate) fn of(&self, axis: Axis) -> AxisCommand {
        match self {
            Order::Stream => AxisCommand::Stream,
            Order::Hold => AxisCommand::Hold,
            Order::CallOff => AxisCommand::CallOff,
            Order::Leave(at) => AxisCommand::Leave { at: *at },
            Order::Stop => AxisCommand::Stop,
            Order::Reference(own, home_offset) if *own == axis => {
                AxisCommand::Reference { home_offset: *home_offset }
            }
            Order::Reference(..) => AxisCommand::Hold,
            Order::Arm(InHand { pass, not_before }) => AxisCommand::Arm {
                pass: pass.pass,
                s_rpm: pass.s_rpm,
                direction: pass.direction,
                not_before: *not_before,
                out: pass.out,
                law: *pass.axis(axis),
                changes: pass.changes(axis),
            },
        }
    }
}
