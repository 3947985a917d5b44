//! The true state of the plant, for the observer of a run. No controller subscribes to it.

use iceoryx2::prelude::ZeroCopySend;
use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{Cycle, Measurement, PerAxis};

/// One axis without encoder and without quantum.
#[rustfmt::skip]
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisTruth {
    /// True position at the motor (what its encoder would show if it were perfect), mm.
    pub motor_mm: f64,
    /// True position of the slide behind the elastic mode, mm.
    pub slide_mm: f64,
    /// True speed at the motor, mm/s.
    pub velocity_mm_s: f64,
    /// True torque of the motor, N·m.
    pub torque_nm: f64,
}

/// The plant at one control cycle, with the measurement it gave out.
#[rustfmt::skip]
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend, IntoBytes, FromBytes, Immutable)]
#[type_name("pitchlock/truth/4")]
#[repr(C)]
pub struct Truth {
    /// When it is true.
    pub cycle: Cycle,
    /// True spindle angle, unwrapped degrees clockwise; the index lies at every multiple of 360.
    pub spindle_deg: f64,
    /// True spindle speed, 1/min, signed.
    pub spindle_rpm: f64,
    /// Answers of regulators that came after their cycle, so far (real time).
    pub late_answers: u64,
    /// The axes.
    pub axes: PerAxis<AxisTruth>,
    /// What was measured.
    pub measurement: Measurement,
}
