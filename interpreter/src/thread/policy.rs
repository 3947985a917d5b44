//! What the program says of leaving a thread, in comments: `(on_hold, leave)`, `(on_stop, finish)`,
//! `(on_fault, leave)`. It stays until it is said otherwise. In: the text of a comment. Out: bits of the
//! passes that follow ([`WayOut::leaves`]).

use gcode::Problem;
use gcode::problem::Blame;
use protocol::WayOut;

/// Words of the program, and what each of them is about.
const WORDS: [(&str, u32); 3] =
    [("on_hold", WayOut::ON_HOLD), ("on_stop", WayOut::ON_STOP), ("on_fault", WayOut::ON_FAULT)];

/// What was said so far; the rest is for the machine file to say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Policy {
    said: u32,
    leaves: u32,
}

impl Policy {
    /// Takes a comment; most of them say nothing of threads.
    ///
    /// # Errors
    /// It begins with one of the words, and a comma with `leave` or `finish` does not follow.
    pub(crate) fn comment(&mut self, text: &str) -> Result<(), Box<Problem>> {
        let text = text.trim();
        let ends = |c: char| !(c.is_alphanumeric() || c == '_');
        let (word, rest) = text.split_at(text.find(ends).unwrap_or(text.len()));
        let begins = |known: &str| word.eq_ignore_ascii_case(known);
        let Some((word, bit)) = WORDS.into_iter().find(|(known, _)| begins(known)) else { return Ok(()) };
        let value = rest.trim().strip_prefix(',').map(str::trim);
        let is = |wanted: &str| value.is_some_and(|value| value.eq_ignore_ascii_case(wanted));
        let leaves = is("leave");
        if !leaves && !is("finish") {
            let message = match value {
                None if !rest.is_empty() => format!("a comma is missing behind {word}"),
                None | Some("") => format!("{word} does not say what it wants"),
                Some(other) => format!("{word} cannot be {other:?}"),
            };
            let help = format!("write ({word}, leave) or ({word}, finish)");
            return Err(Problem::error("bad-value", Blame::Block, message, help));
        }
        self.said |= bit;
        self.leaves = if leaves { self.leaves | bit } else { self.leaves & !bit };
        Ok(())
    }

    /// What makes the axes leave a pass, if the machine file says `otherwise` of what the program does not.
    pub(crate) fn leaves(self, otherwise: u32) -> u32 {
        otherwise & !self.said | self.leaves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: u32 = WayOut::ON_STOP | WayOut::ON_FAULT;

    #[test]
    fn words_stay_until_they_are_said_otherwise() {
        let mut policy = Policy::default();
        for (text, leaves) in [
            ("a remark, leave", MACHINE),
            ("on_holding, finish", MACHINE),
            ("what on_hold does", MACHINE),
            ("on_hold, leave", MACHINE | WayOut::ON_HOLD),
            (" ON_STOP , Finish ", WayOut::ON_HOLD | WayOut::ON_FAULT),
            ("on_fault,finish", WayOut::ON_HOLD),
            ("on_hold, finish", 0),
            ("on_stop, leave", WayOut::ON_STOP),
        ] {
            policy.comment(text).expect("a policy, or a remark");
            assert_eq!(policy.leaves(MACHINE), leaves, "{text}");
        }
    }

    #[test]
    fn what_is_misspelt_is_said_with_its_remedy_and_changes_nothing() {
        let mut policy = Policy::default();
        for text in [
            "on_hold, leav",
            "on_hold",
            "ON_FAULT,",
            "on_stop, leave, now",
            "on_hold leave",
            "on_stop: finish",
            " On_Fault = finish",
        ] {
            let problem = policy.comment(text).expect_err(text);
            assert!(problem.help.starts_with("write (on_") && problem.help.contains("finish"), "{problem:?}");
        }
        assert_eq!(policy, Policy::default());
    }
}
