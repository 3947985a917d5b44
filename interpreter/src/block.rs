//! A block: the words of a line sorted into codes and values, each checked to stand only once and to be of use.
//! In: the words of a line and the motion in force. Out: a block, or every reason why it is none.

use crate::codes::{G, M, g_code, m_code};
use crate::diagnostic::{Diagnostic, Spot};
use crate::words::{Line, Word};

/// The motion in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    /// None: axis words need a G code.
    None,
    Rapid,
    Feed,
    Thread,
}

/// What a block tells the axes to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Task {
    Nothing,
    Line(Motion),
    ThreadMove,
    ThreadCycle,
}

/// One block of the program.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    g: Vec<(G, Spot)>,
    m: Vec<(M, Spot)>,
    words: Vec<Word>,
    pub(crate) task: Task,
    /// The whole block.
    pub(crate) spot: Spot,
}

/// Words that only some codes use, and which.
const USERS: [(char, &str); 9] = [
    ('P', "G4 and G76"),
    ('I', "G76"),
    ('J', "G76"),
    ('K', "G33 and G76"),
    ('R', "G76"),
    ('Q', "G76"),
    ('H', "G76"),
    ('E', "G76"),
    ('L', "G76"),
];

impl Block {
    /// Sorts the words of a line.
    pub(crate) fn new(line: &Line, motion: Motion) -> Result<Block, Vec<Diagnostic>> {
        let mut wrong = Vec::new();
        let mut block = Block {
            g: Vec::new(),
            m: Vec::new(),
            words: Vec::new(),
            task: Task::Nothing,
            spot: whole_line(line),
        };
        let mut groups: Vec<(char, u32, Spot)> = Vec::new();
        for word in &line.words {
            let code = match word.letter {
                'G' => g_code(word).map(|(code, group)| {
                    block.g.push((code, word.spot));
                    group
                }),
                'M' => m_code(word).map(|(code, group)| {
                    block.m.push((code, word.spot));
                    group
                }),
                _ => {
                    block.add(word, &mut wrong);
                    continue;
                }
            };
            match code {
                Err((code, message, help)) => wrong.push(Diagnostic::error(code, word.spot, message, help)),
                Ok(group) if groups.iter().any(|(l, g, _)| (*l, *g) == (word.letter, group)) => {
                    let message = format!("a second {} word of one modal group", word.letter);
                    let help = "they exclude each other: put them in different blocks, or leave one out";
                    wrong.push(Diagnostic::error("modal-group", word.spot, message, help));
                }
                Ok(group) => groups.push((word.letter, group, word.spot)),
            }
        }
        if !wrong.is_empty() {
            return Err(wrong);
        }
        block.task = block.find_task(motion).map_err(|error| vec![error])?;
        block.check_use(&mut wrong);
        if wrong.is_empty() { Ok(block) } else { Err(wrong) }
    }

    fn add(&mut self, word: &Word, wrong: &mut Vec<Diagnostic>) {
        let letter = word.letter;
        let (code, message, help) = match letter {
            'A' | 'B' | 'C' | 'U' | 'V' | 'W' | 'Y' => {
                ("no-such-axis", format!("this lathe has no axis {letter}"), "its axes are X and Z")
            }
            'D' => ("unknown-word", "no code of this machine uses D".to_owned(), "leave it out"),
            _ if self.word(letter).is_some() => {
                ("repeated-word", format!("{letter} stands in this block already"), "leave one of them out")
            }
            _ => {
                self.words.push(*word);
                return;
            }
        };
        wrong.push(Diagnostic::error(code, word.spot, message, help));
    }

    /// The word of a letter.
    pub(crate) fn word(&self, letter: char) -> Option<Word> {
        self.words.iter().find(|word| word.letter == letter).copied()
    }

    /// The value of a word that a code needs.
    pub(crate) fn needed(&self, letter: char, code: &str, meaning: &str) -> Result<Word, Diagnostic> {
        self.word(letter).ok_or_else(|| {
            let message = format!("{code} needs {letter}: {meaning}");
            Diagnostic::error("missing-word", self.spot_of_task(), message, format!("add a {letter} word"))
        })
    }

    /// Whether a G code stands in this block.
    pub(crate) fn has(&self, code: G) -> bool {
        self.g.iter().any(|(g, _)| *g == code)
    }

    /// Whether an M code stands in this block.
    pub(crate) fn has_m(&self, code: M) -> bool {
        self.m.iter().any(|(m, _)| *m == code)
    }

    /// Whether the block does nothing but set distance modes, units and a target.
    pub(crate) fn only_moves(&self) -> bool {
        self.m.is_empty()
            && self.words.iter().all(|word| matches!(word.letter, 'X' | 'Z'))
            && !self.has(G::Dwell)
    }

    /// The code that moves the axes, or the whole block.
    pub(crate) fn spot_of_task(&self) -> Spot {
        let moves = |code: &G| matches!(code, G::Rapid | G::Feed | G::ThreadMove | G::ThreadCycle | G::Dwell);
        self.g.iter().find(|(code, _)| moves(code)).map_or(self.spot, |(_, spot)| *spot)
    }

    fn find_task(&self, motion: Motion) -> Result<Task, Diagnostic> {
        let axis = self.word('X').or(self.word('Z'));
        let code = self.g.iter().map(|(code, _)| *code);
        let code = code.into_iter().find_map(|code| match code {
            G::Rapid => Some(Task::Line(Motion::Rapid)),
            G::Feed => Some(Task::Line(Motion::Feed)),
            G::ThreadMove => Some(Task::ThreadMove),
            G::ThreadCycle => Some(Task::ThreadCycle),
            _ => None,
        });
        match (code, axis, motion) {
            (Some(task), ..) => Ok(task),
            (None, None, _) => Ok(Task::Nothing),
            (None, Some(_), Motion::Rapid | Motion::Feed) => Ok(Task::Line(motion)),
            (None, Some(_), Motion::Thread) => Ok(Task::ThreadMove),
            (None, Some(word), Motion::None) => Err(Diagnostic::error(
                "no-motion-mode",
                word.spot,
                format!("{} without a motion in force", word.letter),
                "write G0, G1 or G33 in this block; G76 does not stay in force",
            )),
        }
    }

    /// Refuses words that nothing in the block uses: no word is ignored in silence.
    fn check_use(&self, wrong: &mut Vec<Diagnostic>) {
        let (dwell, cycle) = (self.has(G::Dwell), self.task == Task::ThreadCycle);
        for word in &self.words {
            let used = match word.letter {
                'P' => dwell || cycle,
                'K' => cycle || self.task == Task::ThreadMove,
                'I' | 'J' | 'R' | 'Q' | 'H' | 'E' | 'L' => cycle,
                'X' => !cycle,
                _ => true,
            };
            if !used {
                wrong.push(unused(word));
            }
        }
        if dwell && cycle {
            let message = "P cannot serve both G4 and G76";
            wrong.push(Diagnostic::error(
                "repeated-word",
                self.spot,
                message,
                "put G4 in a block of its own",
            ));
        }
    }
}

fn unused(word: &Word) -> Diagnostic {
    let letter = word.letter;
    if letter == 'X' {
        let help = "X of the drive line is where the tool stands: go there with G0 in a block before";
        return Diagnostic::error("unused-word", word.spot, "G76 takes no X", help);
    }
    let users = USERS.iter().find(|(known, _)| *known == letter).map_or("no code", |(_, users)| *users);
    let help = format!("{letter} belongs to {users}: leave it out or write the code");
    Diagnostic::error("unused-word", word.spot, format!("nothing in this block uses {letter}"), help)
}

fn whole_line(line: &Line) -> Spot {
    match (line.words.first(), line.words.last()) {
        (Some(first), Some(last)) => Spot { end: last.spot.end, ..first.spot },
        _ => Spot::default(),
    }
}
