//! Wires with a disturbance on them. In: what the wires below carry. Out: what the disturbance makes of it.

use protocol::{Axis, AxisFrame, AxisStatus, CodePacket, Cycle, DriveCommand, Measurement, SpindleCommand};

use super::{Disturbance, Wire, Wires};

/// Wires on which a disturbance acts.
#[derive(Clone)]
pub struct Disturbed<D, W> {
    /// What becomes of the messages; a test may exchange it while the machine runs.
    pub disturbance: D,
    /// The wires below.
    pub wires: W,
    arrived: Arrived,
}

/// What has arrived last, so that a module can look at it.
#[derive(Clone, Default)]
struct Arrived {
    code: Option<CodePacket>,
    measurement: Option<Measurement>,
    frame: Option<AxisFrame>,
    status: Option<AxisStatus>,
    spindle: Option<SpindleCommand>,
    drive: Option<DriveCommand>,
}

impl<D, W> Disturbed<D, W> {
    pub(crate) fn new(disturbance: D, wires: W) -> Disturbed<D, W> {
        Disturbed { disturbance, wires, arrived: Arrived::default() }
    }
}

impl<D: Disturbance, W: Wires> Wires for Disturbed<D, W> {
    fn code<'a>(&'a mut self, now: Cycle, sent: Option<&'a CodePacket>) -> Option<&'a CodePacket> {
        if self.disturbance.is_idle() {
            return self.wires.code(now, sent);
        }
        let sent = self.wires.code(now, sent).copied();
        self.arrived.code = self.disturbance.carry(Wire::Code, now, sent);
        self.arrived.code.as_ref()
    }

    fn tick_measurement<'a>(
        &'a mut self,
        now: Cycle,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        if self.disturbance.is_idle() {
            return self.wires.tick_measurement(now, sent);
        }
        let sent = self.wires.tick_measurement(now, sent).copied();
        self.arrived.measurement = self.disturbance.carry(Wire::TickMeasurement, now, sent);
        self.arrived.measurement.as_ref()
    }

    fn measurement<'a>(
        &'a mut self,
        now: Cycle,
        axis: Axis,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        if self.disturbance.is_idle() {
            return self.wires.measurement(now, axis, sent);
        }
        let sent = self.wires.measurement(now, axis, sent).copied();
        self.arrived.measurement = self.disturbance.carry(Wire::Measurement(axis), now, sent);
        self.arrived.measurement.as_ref()
    }

    fn frame<'a>(&'a mut self, now: Cycle, axis: Axis, sent: Option<&'a AxisFrame>) -> Option<&'a AxisFrame> {
        if self.disturbance.is_idle() {
            return self.wires.frame(now, axis, sent);
        }
        let sent = self.wires.frame(now, axis, sent).copied();
        self.arrived.frame = self.disturbance.carry(Wire::Frame(axis), now, sent);
        self.arrived.frame.as_ref()
    }

    fn status<'a>(
        &'a mut self,
        now: Cycle,
        axis: Axis,
        sent: Option<&'a AxisStatus>,
    ) -> Option<&'a AxisStatus> {
        if self.disturbance.is_idle() {
            return self.wires.status(now, axis, sent);
        }
        let sent = self.wires.status(now, axis, sent).copied();
        self.arrived.status = self.disturbance.carry(Wire::Status(axis), now, sent);
        self.arrived.status.as_ref()
    }

    fn spindle<'a>(&'a mut self, now: Cycle, sent: Option<&'a SpindleCommand>) -> Option<&'a SpindleCommand> {
        if self.disturbance.is_idle() {
            return self.wires.spindle(now, sent);
        }
        let sent = self.wires.spindle(now, sent).copied();
        self.arrived.spindle = self.disturbance.carry(Wire::Spindle, now, sent);
        self.arrived.spindle.as_ref()
    }

    fn drive<'a>(
        &'a mut self,
        now: Cycle,
        axis: Axis,
        sent: Option<&'a DriveCommand>,
    ) -> Option<&'a DriveCommand> {
        if self.disturbance.is_idle() {
            return self.wires.drive(now, axis, sent);
        }
        let sent = self.wires.drive(now, axis, sent).copied();
        self.arrived.drive = self.disturbance.carry(Wire::Drive(axis), now, sent);
        self.arrived.drive.as_ref()
    }
}
