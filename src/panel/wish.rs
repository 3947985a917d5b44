//! What somebody wants while nothing runs. In: presses. Out: that a program or work by hand begins, and at
//! which line; or why not. Where a program begins is chosen first, and shown with all that is in force
//! there; Start begins there if it is still so.

use std::fs;

use ::panel::{HandAsked, ToPanel};
use protocol::operator::Request;
use serde_json::{Map, Value, json};

use super::{
    live::{Live, fields},
    mode::{Mode, Press},
};
use crate::{
    error::CliError,
    run::{self, RunArgs},
};

/// What is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wish {
    /// The program that is loaded.
    Start,
    /// Work by hand.
    Hand,
    /// The next start begins at this line, or at the beginning; whose press that is.
    From(u64, Option<u32>),
}

/// Where the next start begins.
#[derive(Debug, Default)]
pub(super) struct Begins {
    pub(super) line: Option<u32>,
    /// What was shown of it.
    shown: Value,
    /// The program whose lines were seen beside that.
    program: Vec<u8>,
}

impl Begins {
    /// What is in force at a line, and how the tool gets there; at the beginning nothing is shown.
    ///
    /// # Errors
    /// The program is not begun there, and why.
    pub(super) fn at(asked: &RunArgs, line: Option<u32>) -> Result<Begins, CliError> {
        if line.is_none() {
            return Ok(Begins::default());
        }
        let shown = run::judged(&RunArgs { from: line, ..asked.clone() })?.2;
        let program = fs::read(&asked.program)
            .map_err(|error| CliError::Input(format!("{}: {error}", asked.program.display())))?;
        Ok(Begins { line, shown, program })
    }

    /// Whether it is still what was shown.
    ///
    /// # Errors
    /// It is not, and what to do.
    pub(super) fn is_as_shown(&self, asked: &RunArgs) -> Result<(), CliError> {
        let now = Begins::at(asked, self.line)?;
        let line = self.line.unwrap_or_default();
        let text = || {
            format!(
                "the program, or what is in force at line {line}, is not what was shown: choose the line again"
            )
        };
        let same = now.shown == self.shown && now.program == self.program;
        if same { Ok(()) } else { Err(CliError::Input(text())) }
    }
}

impl Live {
    /// What somebody wants: a start of a program that is loaded, work by hand, a line to begin at, or
    /// nothing; everything else is refused.
    pub(super) fn wish(&mut self, loaded: bool) -> Option<Wish> {
        self.look();
        self.mode = Mode::Off;
        while let Some(press) = self.web.link.press() {
            let start = press.kind == protocol::OperatorRequest::pack(0, Request::CycleStart).kind;
            let wish = match &press.hand {
                Some(HandAsked::On) => Press::Hand,
                Some(HandAsked::JogOn) => Press::JogOn,
                Some(HandAsked::Offset { .. }) => Press::Table,
                Some(HandAsked::Play(_)) => Press::Play,
                Some(HandAsked::ToolIn(_)) => Press::Tool,
                Some(HandAsked::From(_)) => Press::From,
                Some(_) => Press::Block,
                None if start => Press::Start,
                None => Press::Always,
            };
            let wanted = match (self.mode.refuses(wish), wish, &press.hand) {
                (None, Press::Table, Some(HandAsked::Offset { of, words, add })) => {
                    self.sets_when_off(press.ticket, of, words, *add);
                    continue;
                }
                (Some(why), ..) => Err(why),
                (None, Press::Start | Press::From, _) if !loaded => {
                    Err("no program is loaded: by-hand works without one")
                }
                (None, Press::From, Some(HandAsked::From(line))) => Ok(Wish::From(press.ticket, *line)),
                (None, Press::Hand, _) => Ok(Wish::Hand),
                (None, ..) => Ok(Wish::Start),
            };
            match wanted {
                Err(why) => self.refuse(press.ticket, "not-running", why),
                Ok(Wish::From(ticket, line)) => return Some(Wish::From(ticket, line)),
                Ok(wish) => {
                    // Whoever has the answer sees nothing of the run before any more.
                    let begins = json!({ "state": "starting", "words": "the run is made ready", "outcome": null, "part": null });
                    self.stands(fields(&begins));
                    self.look();
                    self.web.link.answer(&ToPanel::Taken { ticket: press.ticket, cycle: 0 });
                    return Some(wish);
                }
            }
        }
        None
    }

    /// Somebody has chosen a line to begin at.
    pub(super) fn chooses(&mut self, ticket: u64, asked: &RunArgs, line: Option<u32>, begins: &mut Begins) {
        match Begins::at(asked, line) {
            Ok(chosen) => {
                *begins = chosen;
                self.shows_begins(begins);
                // Whoever has the answer sees it.
                self.look();
                self.web.link.answer(&ToPanel::Taken { ticket, cycle: 0 });
            }
            Err(error) => self.refuse(ticket, "bad-line", &error.to_string()),
        }
    }

    /// Where the next start begins.
    pub(super) fn shows_begins(&mut self, begins: &Begins) {
        self.stands(Map::from_iter([("from".to_owned(), begins.shown.clone())]));
    }
}
