//! Which faults make every axis leave its pass. In: a fault that a module has told. Out: whether the tool has
//! to be out of the material soon.

use protocol::Fault;

/// Faults after which nobody cuts on, whatever the policy says.
pub(crate) fn makes_leave(fault: Fault) -> bool {
    use Fault::{
        AxisFault, AxisJump, DriveFault, EmergencyStop, EncoderGlitch, EncoderPlausibility, EncoderStands,
        FollowingError, ForceTooHigh, LateAnswers, MeasurementGap, OtherAxis, PowerLost, RegulatorSilent,
        SpindleNotAtSpeed, SpindleReversed, SpindleRunaway, ThreadError,
    };
    matches!(
        fault,
        AxisFault
            | AxisJump
            | DriveFault
            | EmergencyStop
            | EncoderGlitch
            | EncoderPlausibility
            | EncoderStands
            | FollowingError
            | ForceTooHigh
            | LateAnswers
            | MeasurementGap
            | OtherAxis
            | PowerLost
            | RegulatorSilent
            | SpindleNotAtSpeed
            | SpindleReversed
            | SpindleRunaway
            | ThreadError
    )
}

#[cfg(test)]
mod tests {
    use protocol::Fault;

    #[test]
    fn what_the_table_of_faults_lets_leave_a_pass_makes_leave() {
        let leaves = |fault: &Fault| fault.row().reaction.starts_with("leaves the pass");
        // A stop is judged where it is pressed: a machine may finish the pass then.
        let said = Fault::ALL.into_iter().filter(leaves).filter(|fault| *fault != Fault::Stopped);
        for fault in said {
            assert!(super::makes_leave(fault), "{fault:?}");
        }
    }
}
