//! Blocks of a program that begin in one line and end in another. In: its words of the flow. Out: where what
//! ends has begun, and how much is open.

/// The labels of what has begun and not ended, and the line of each.
#[derive(Default)]
pub(crate) struct Blocks(Vec<(String, u32)>);

/// What an O word does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Step {
    /// The line at which the block has begun that it ends.
    pub(crate) ends: Option<u32>,
    /// It begins a block.
    pub(crate) begins: bool,
}

impl Blocks {
    /// Takes an O word in small letters.
    pub(crate) fn word(&mut self, label: &str, word: &str, line: u32) -> Step {
        let (ends, begins) = match word {
            "sub" | "if" | "do" | "repeat" => (None, true),
            "else" | "elseif" => (self.end(label), true),
            "endsub" | "endif" | "endwhile" | "endrepeat" => (self.end(label), false),
            // The end of a loop that `do` began, or the beginning of another one.
            "while" => {
                let ends = self.end(label);
                (ends, ends.is_none())
            }
            _ => return Step::default(),
        };
        if begins {
            self.begin(label, line);
        }
        Step { ends, begins }
    }

    pub(crate) fn begin(&mut self, label: &str, line: u32) {
        self.0.push((label.to_owned(), line));
    }

    /// Ends what has begun under a label, and forgets what began in it and did not end; the line at which it
    /// has begun.
    pub(crate) fn end(&mut self, label: &str) -> Option<u32> {
        let at = self.0.iter().rposition(|(open, _)| open == label)?;
        let line = self.0[at].1;
        self.0.truncate(at);
        Some(line)
    }

    /// How many are open.
    pub(crate) fn depth(&self) -> usize {
        self.0.len()
    }
}
