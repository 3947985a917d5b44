//! What lies between the modules of a [`Rig`](crate::Rig). Every message goes through the wires on its way:
//! enters what a module has sent, leaves what arrives, which may be the same, something else or nothing.
//! [`Straight`] wires change nothing and cost nothing; [`Disturbed`] wires delay, lose, double, damage or
//! freeze what other wires carry, and can be stacked.
//!
//! ```
//! use machine::Machine;
//! use protocol::Axis;
//! use rig::{Rig, wires::{Late, Straight, Wire, Wires}};
//! use sim_plant::Scenario;
//!
//! // The frames of X come two ticks late.
//! let wires = Straight.with(Late::new(2, |wire, _now| wire == Wire::Frame(Axis::X)));
//! let nothing_to_do = std::iter::empty();
//! let mut rig = Rig::with_wires(&Machine::default(), nothing_to_do, Scenario::none(), 1, wires)?;
//! for _ in 0..1000 {
//!     assert!(rig.cycle(None, |record| assert_eq!(record.machine.fault, 0)));
//! }
//! # Ok::<(), sim_plant::PlantError>(())
//! ```

mod disturbance;
mod disturbed;
mod tampering;

pub use disturbance::{Damaging, Disturbance, Doubling, Freezing, Late, Losing, Message, Which};
pub use disturbed::Disturbed;
pub(crate) use tampering::Tamperer;

use protocol::{Axis, AxisFrame, AxisStatus, CodePacket, Cycle, DriveCommand, Measurement, SpindleCommand};

/// One wire, by what it carries and for whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wire {
    /// Machine code to the interpolator: as many packets a tick as it wants.
    Code,
    /// The measurement of a tick to the interpolator. Without it the interpolator does nothing.
    TickMeasurement,
    /// The measurement of every cycle to the regulator of an axis. Without it the regulator does nothing.
    Measurement(Axis),
    /// The frame of the tick before to the regulator of an axis.
    Frame(Axis),
    /// The status of an axis, every cycle, to the interpolator, which looks at the latest one that has
    /// arrived.
    Status(Axis),
    /// The spindle command of the tick before to the plant, where the latest one that has arrived is in
    /// force.
    Spindle,
    /// The drive command of an axis, every cycle, to the plant. Without a new one the drive goes on with the
    /// one before.
    Drive(Axis),
}

/// What lies between the modules. Each method carries one message: it is called once for each message that
/// may arrive (`sent` is `None` if nobody has sent one), in the cycle in which the message is due, and gives
/// what arrives instead. Unless a wire says otherwise, it is straight.
pub trait Wires {
    /// [`Wire::Code`].
    fn code<'a>(&'a mut self, _now: Cycle, sent: Option<&'a CodePacket>) -> Option<&'a CodePacket> {
        sent
    }

    /// [`Wire::TickMeasurement`].
    fn tick_measurement<'a>(
        &'a mut self,
        _now: Cycle,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        sent
    }

    /// [`Wire::Measurement`].
    fn measurement<'a>(
        &'a mut self,
        _now: Cycle,
        _axis: Axis,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        sent
    }

    /// [`Wire::Frame`].
    fn frame<'a>(
        &'a mut self,
        _now: Cycle,
        _axis: Axis,
        sent: Option<&'a AxisFrame>,
    ) -> Option<&'a AxisFrame> {
        sent
    }

    /// [`Wire::Status`].
    fn status<'a>(
        &'a mut self,
        _now: Cycle,
        _axis: Axis,
        sent: Option<&'a AxisStatus>,
    ) -> Option<&'a AxisStatus> {
        sent
    }

    /// [`Wire::Spindle`].
    fn spindle<'a>(
        &'a mut self,
        _now: Cycle,
        sent: Option<&'a SpindleCommand>,
    ) -> Option<&'a SpindleCommand> {
        sent
    }

    /// [`Wire::Drive`].
    fn drive<'a>(
        &'a mut self,
        _now: Cycle,
        _axis: Axis,
        sent: Option<&'a DriveCommand>,
    ) -> Option<&'a DriveCommand> {
        sent
    }

    /// These wires, and on them a disturbance.
    fn with<D: Disturbance>(self, disturbance: D) -> Disturbed<D, Self>
    where
        Self: Sized,
    {
        Disturbed::new(disturbance, self)
    }
}

/// Wires on which every message arrives as it was sent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Straight;

impl Wires for Straight {}
