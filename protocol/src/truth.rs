//! The true state of the plant, for the observer of a run. No controller subscribes to it.

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    measurement::Measurement,
    message::Message,
    module::{Doom, Module},
    units::{Cycle, PerAxis},
};

/// One axis without encoder and without quantum.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisTruth {
    /// True position of the nut, mm: what the encoder of the motor would show if it and the screw were
    /// perfect.
    pub motor_mm: f64,
    /// True position of the slide behind backlash and elasticity, mm.
    pub slide_mm: f64,
    /// True speed of the nut, mm/s.
    pub velocity_mm_s: f64,
    /// True torque of the motor, N·m.
    pub torque_nm: f64,
    /// Force on the slide until the next cycle, from the cut and from a scenario, N, in the direction of the
    /// axis.
    pub force_n: f64,
}

/// What a threading tool takes off, and what that costs, until the next cycle; all zero if nothing is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct CutTruth {
    /// Chip area in the plane of the spindle axis (M74), mm².
    pub area_mm2: f64,
    /// Tangential force (M75), N.
    pub force_n: f64,
    /// Force that pushes X out of the cut, N.
    pub radial_n: f64,
    /// Force on Z against the motion along the thread, N.
    pub axial_n: f64,
    /// Torque that holds the spindle back (M76), N·m.
    pub torque_nm: f64,
}

/// The plant at one control cycle, with the measurement it gave out.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Truth {
    /// When it is true.
    pub cycle: Cycle,
    /// True spindle angle, unwrapped degrees clockwise; the index lies at every multiple of 360.
    pub spindle_deg: f64,
    /// True spindle speed, 1/min, signed.
    pub spindle_rpm: f64,
    /// True torque of the spindle motor at the spindle, N·m, signed.
    pub spindle_torque_nm: f64,
    /// Answers of regulators that came after their cycle, so far (real time).
    pub late_answers: u64,
    /// What is cut.
    pub cut: CutTruth,
    /// The axes.
    pub axes: PerAxis<AxisTruth>,
    /// What was measured.
    pub measurement: Measurement,
    /// Code of the module that a scenario wants killed, frozen or thawed in this cycle
    /// ([`Module::code`]); 0 for none.
    pub doomed: u32,
    /// Code of what happens to it ([`Doom`]); 0 for nothing.
    pub doom: u32,
    /// Events of the scenario that did not happen yet, the first 64 of them: the lowest bit is event 1.
    pub pending: u64,
}

impl Truth {
    /// The module that is to be killed, frozen or thawed in this cycle, and which of that.
    pub fn doom(&self) -> Option<(Doom, Module)> {
        Some((Doom::from_code(self.doom)?, Module::from_code(self.doomed)?))
    }
}

impl Message for Truth {
    const NAME: &str = "pitchlock/truth/9";
}
