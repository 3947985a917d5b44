//! Why an axis could not be tuned, and what to do about it.

use protocol::{Axis, DriveState};

/// What a commissioning run refuses.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The machine file has no such axis.
    #[error("the machine has no axis {0}: add [axis.{name}] to the machine file", name = .0.name())]
    NoAxis(Axis),
    /// The axis stands too near to the end of its travel.
    #[error("{0} has {1:.1} {unit} of travel to one side and needs {2:.1}: move it towards the middle of its travel", unit = .0.unit())]
    Travel(Axis, f64, f64),
    /// The drive does not come into operation, or left it.
    #[error(
        "the drive of {0} is in state {state} at {2:.3} s of the test: clear its fault and check its supply",
        state = .1.map_or("unknown".into(), |state| format!("{state:?}"))
    )]
    Drive(Axis, Option<DriveState>, f64),
    /// Torque was commanded and nothing moved.
    #[error("{0} did not move: it should have gone {1:.3} {unit} and went {2:.3}; check the brake, the coupling and the encoder", unit = .0.unit())]
    DidNotMove(Axis, f64, f64),
    /// The axis was too far from where it should have been.
    #[error(
        "{0} was {1:.3} {unit} from its reference in a test move: with its present gains it does not follow, or swings; \
         lower velocity_bandwidth_hz and position_gain_1_s, or correct mass_kg",
        unit = .0.unit()
    )]
    Lost(Axis, f64),
    /// The drive could give no more torque, or was asked for more.
    #[error(
        "the torque of {0} was at its limit of {1} N·m in a test move: it is too heavy for acceleration_{unit}_s2, or \
         swings with its present gains; lower velocity_bandwidth_hz or the acceleration",
        unit = .0.unit()
    )]
    TorqueLimited(Axis, f64),
    /// A test move cannot be planned within the limits of the axis.
    #[error(
        "a test move of {0} over {1:.3} {unit} at {2:.3} {unit}/s cannot be planned: check its limits of speed, \
         acceleration and jerk",
        unit = .0.unit()
    )]
    Unplanned(Axis, f64, f64),
    /// The test moves do not determine a value.
    #[error("the test moves of {0} do not show its {1}: {2}")]
    Untold(Axis, &'static str, &'static str),
    /// Friction turned with the speed while the frequency response was measured, or noise covered it.
    #[error(
        "the frequency response of {0} cannot be used: {1}. At {2:.1} {unit}/s friction bends it: give the axis more \
         travel, or a higher velocity_{unit}_s",
        unit = .0.unit()
    )]
    Response(Axis, &'static str, f64),
    /// A value came out that no axis has, or is known too badly to be used.
    #[error("{0}: {1} came out as {2:.4} ± {3:.2}, which cannot be used: {4}")]
    Implausible(Axis, &'static str, f64, f64, &'static str),
    /// No gains reach the wanted margins.
    #[error(
        "{0}: no gain of the {1} loop reaches a phase margin of {2:.0}° and a gain margin of {3:.1}: ask for less"
    )]
    NoGain(Axis, &'static str, f64, f64),
}
