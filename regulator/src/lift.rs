//! The axis that lifts the tool out of a groove, as every axis of the pass sees it. In: the way out, what is
//! measured of that axis. Out: whether the tool is free, and how far it has to go.

use protocol::{DriveState, Position, WayOut, measurement::AxisMeasurement};

/// What is known of it in a cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift {
    axis: usize,
    /// The tool is out of the groove.
    pub(crate) is_free: bool,
    /// How far it is from there, mm; without torque it never gets there.
    pub(crate) mm: f64,
    enabled: bool,
    calls: bool,
}

impl Lift {
    /// Nobody lifts: no pass is or was in hand.
    pub(crate) const NONE: Lift =
        Lift { axis: usize::MAX, is_free: false, mm: 0.0, enabled: false, calls: false };

    /// By what is measured of the axis that lifts, and where it is, mm, without the jumps of its encoder.
    pub(crate) fn of(out: &WayOut, measured: &AxisMeasurement, mm: f64) -> Lift {
        let at = Position::from_mm(mm);
        let drive = measured.drive();
        let enabled = drive.state() == Some(DriveState::OperationEnabled);
        Lift {
            axis: out.axis as usize,
            is_free: out.is_free(at),
            mm: if enabled { out.free.mm_from(at).abs() } else { f64::INFINITY },
            enabled,
            calls: drive.calls(),
        }
    }

    /// Whether it is another axis than this, and on its way, or will be as soon as it has heard (`hears`).
    pub(crate) fn is_on_its_way(&self, axis: usize, hears: bool) -> bool {
        self.axis != axis && self.enabled && !self.is_free && (self.calls || hears)
    }
}
