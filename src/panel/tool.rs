//! A tool that somebody puts in. In: the status of every control cycle, and which tool somebody says is in.
//! Out: whether the machine may go on; that is a cycle start.

use protocol::{MachineState, MachineStatus};

/// What is known of a change of the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change {
    /// The tool that the machine waits for.
    wanted: Option<u32>,
    /// Somebody has said that it is in: a second press would end the pause behind this one.
    said: bool,
}

impl Change {
    /// One control cycle.
    pub(crate) fn cycle(&mut self, machine: &MachineStatus) {
        let wanted = (machine.state() == MachineState::ToolChange).then_some(machine.tool);
        if wanted != self.wanted {
            *self = Change { wanted, said: false };
        }
    }

    /// Somebody says that this tool is in.
    pub(crate) fn says(&mut self, number: u32) -> Result<(), String> {
        match self.wanted {
            None => Err("no tool is waited for".into()),
            Some(_) if self.said => Err("that has been said, and the machine goes on".into()),
            Some(wanted) if wanted != number => {
                Err(format!("the machine waits for T{wanted}, and not for T{number}"))
            }
            Some(_) => {
                self.said = true;
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right tool, once; behind the change, and at the next one, it has not been said.
    #[test]
    fn a_tool_is_said_to_be_in_once_and_only_the_one_that_is_wanted() {
        let status = |state: MachineState, tool: u32| MachineStatus {
            state: state as u32,
            tool,
            ..MachineStatus::default()
        };
        let mut change = Change::default();
        change.cycle(&status(MachineState::Moving, 1));
        assert!(change.says(1).is_err_and(|why| why.contains("no tool")));
        change.cycle(&status(MachineState::ToolChange, 3));
        assert!(change.says(1).is_err_and(|why| why.contains("waits for T3")));
        assert_eq!(change.says(3), Ok(()));
        change.cycle(&status(MachineState::ToolChange, 3));
        assert!(change.says(3).is_err_and(|why| why.contains("goes on")));
        change.cycle(&status(MachineState::Ready, 3));
        assert!(change.says(3).is_err());
        change.cycle(&status(MachineState::ToolChange, 0));
        assert_eq!(change.says(0), Ok(()), "the spindle is emptied");
    }
}
