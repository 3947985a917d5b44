//! State machine of a drive (CiA 402, IEC 61800-7-201). In: the control word of each cycle, and whether the
//! drive tripped or stands still. Out: the state. At most one transition a cycle.
//!
//! | from | to | by | transition |
//! |---|---|---|---|
//! | not ready | switch-on disabled | itself | 1 |
//! | switch-on disabled | ready to switch on | shutdown | 2 |
//! | ready to switch on | switched on | switch on, enable | 3 |
//! | switched on | operation enabled | enable | 4 |
//! | operation enabled | switched on | switch on | 5 |
//! | switched on, operation enabled | ready to switch on | shutdown | 6, 8 |
//! | ready to switch on, switched on | switch-on disabled | disable voltage, quick stop | 7, 10 |
//! | operation enabled, quick stop active | switch-on disabled | disable voltage | 9, 12 |
//! | operation enabled | quick stop active | quick stop | 11 |
//! | quick stop active | operation enabled | enable | 16 |
//! | any | fault reaction | a trip | 13 |
//! | fault reaction | fault | itself, at standstill | 14 |
//! | fault | switch-on disabled | rising edge of fault reset | 15 |
//! | any | fault | the motor loses its torque | – |

use protocol::DriveState;

/// Commands as a drive reads them from the bits of the control word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Command {
    DisableVoltage,
    QuickStop,
    Shutdown,
    SwitchOn,
    Enable,
}

impl Command {
    /// Bit 0 switch on, 1 enable voltage, 2 quick stop (low active), 3 enable operation.
    fn of(word: u32) -> Command {
        match word & 0xF {
            bits if bits & 0b0010 == 0 => Command::DisableVoltage,
            bits if bits & 0b0100 == 0 => Command::QuickStop,
            bits if bits & 0b0001 == 0 => Command::Shutdown,
            bits if bits & 0b1000 == 0 => Command::SwitchOn,
            _ => Command::Enable,
        }
    }
}

/// The state, and the control word of the cycle before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StateMachine {
    state: DriveState,
    word_before: u32,
}

impl StateMachine {
    pub(crate) fn new() -> StateMachine {
        StateMachine { state: DriveState::NotReady, word_before: 0 }
    }

    pub(crate) fn state(&self) -> DriveState {
        self.state
    }

    /// Whether the motor has torque; otherwise the brake holds.
    pub(crate) fn powered(&self) -> bool {
        use DriveState::{FaultReaction, OperationEnabled, QuickStopActive};
        matches!(self.state, OperationEnabled | QuickStopActive | FaultReaction)
    }

    /// A cycle in which the motor is without torque: a fault that no reaction precedes.
    pub(crate) fn fail(&mut self, word: u32) {
        (self.state, self.word_before) = (DriveState::Fault, word);
    }

    /// One cycle.
    pub(crate) fn step(&mut self, word: u32, tripped: bool, standstill: bool) {
        use Command::{DisableVoltage, Enable, QuickStop, Shutdown, SwitchOn};
        use DriveState as S;
        let reset = word & !self.word_before & 0x80 != 0;
        self.word_before = word;
        if tripped && !matches!(self.state, S::FaultReaction | S::Fault) {
            self.state = S::FaultReaction;
            return;
        }
        self.state = match (self.state, Command::of(word)) {
            (S::NotReady, _) => S::SwitchOnDisabled,
            (S::SwitchOnDisabled, Shutdown) => S::ReadyToSwitchOn,
            (S::ReadyToSwitchOn, SwitchOn | Enable) => S::SwitchedOn,
            (S::ReadyToSwitchOn | S::SwitchedOn, DisableVoltage | QuickStop) => S::SwitchOnDisabled,
            (S::SwitchedOn, Enable) | (S::QuickStopActive, Enable) => S::OperationEnabled,
            (S::SwitchedOn | S::OperationEnabled, Shutdown) => S::ReadyToSwitchOn,
            (S::OperationEnabled, SwitchOn) => S::SwitchedOn,
            (S::OperationEnabled, QuickStop) => S::QuickStopActive,
            (S::OperationEnabled | S::QuickStopActive, DisableVoltage) => S::SwitchOnDisabled,
            (S::FaultReaction, _) if standstill => S::Fault,
            (S::Fault, _) if reset => S::SwitchOnDisabled,
            (state, _) => state,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::StateMachine;
    use protocol::DriveState as S;

    const WORDS: [u32; 6] = [0x00, 0x02, 0x06, 0x07, 0x0F, 0x80];

    /// The state that each of [`WORDS`] leads to, by the diagram of the standard.
    const DIAGRAM: [(S, [S; 6]); 8] = {
        use S::*;
        [
            (NotReady, [SwitchOnDisabled; 6]),
            (
                SwitchOnDisabled,
                [
                    SwitchOnDisabled,
                    SwitchOnDisabled,
                    ReadyToSwitchOn,
                    SwitchOnDisabled,
                    SwitchOnDisabled,
                    SwitchOnDisabled,
                ],
            ),
            (
                ReadyToSwitchOn,
                [
                    SwitchOnDisabled,
                    SwitchOnDisabled,
                    ReadyToSwitchOn,
                    SwitchedOn,
                    SwitchedOn,
                    SwitchOnDisabled,
                ],
            ),
            (
                SwitchedOn,
                [
                    SwitchOnDisabled,
                    SwitchOnDisabled,
                    ReadyToSwitchOn,
                    SwitchedOn,
                    OperationEnabled,
                    SwitchOnDisabled,
                ],
            ),
            (
                OperationEnabled,
                [
                    SwitchOnDisabled,
                    QuickStopActive,
                    ReadyToSwitchOn,
                    SwitchedOn,
                    OperationEnabled,
                    SwitchOnDisabled,
                ],
            ),
            (
                QuickStopActive,
                [
                    SwitchOnDisabled,
                    QuickStopActive,
                    QuickStopActive,
                    QuickStopActive,
                    OperationEnabled,
                    SwitchOnDisabled,
                ],
            ),
            (FaultReaction, [Fault; 6]),
            (Fault, [Fault, Fault, Fault, Fault, Fault, SwitchOnDisabled]),
        ]
    };

    #[test]
    fn every_word_in_every_state_does_what_the_diagram_says() {
        for (from, to) in DIAGRAM {
            for (word, expected) in WORDS.into_iter().zip(to) {
                let mut machine = StateMachine { state: from, word_before: 0 };
                machine.step(word, false, true);
                assert_eq!(machine.state(), expected, "{from:?} with {word:#04x}");
                let mut tripped = StateMachine { state: from, word_before: 0 };
                tripped.step(word, true, true);
                match from {
                    S::FaultReaction | S::Fault => assert_eq!(tripped.state(), expected),
                    _ => assert_eq!(tripped.state(), S::FaultReaction, "{from:?} tripped"),
                }
            }
        }
    }

    #[test]
    fn a_fault_reset_acts_on_its_rising_edge_only() {
        let mut machine = StateMachine { state: S::Fault, word_before: 0x80 };
        machine.step(0x80, false, true);
        assert_eq!(machine.state(), S::Fault);
        machine.step(0x00, false, true);
        machine.step(0x80, false, true);
        assert_eq!(machine.state(), S::SwitchOnDisabled);
    }

    #[test]
    fn a_fault_reaction_waits_for_standstill() {
        let mut machine = StateMachine { state: S::FaultReaction, word_before: 0 };
        machine.step(0x0F, false, false);
        assert!(machine.powered());
        machine.step(0x0F, false, true);
        assert_eq!((machine.state(), machine.powered()), (S::Fault, false));
    }
}
