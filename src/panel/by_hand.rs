//! Work by hand at the panel. In: what somebody asks for. Out: machine code and requests for the machine,
//! or why there are none; what is shown of it.

use ::panel::{HandAsked, ToPanel};
use protocol::{Item, operator::Request};
use rig::observe::Record;
use serde_json::{Map, Value, json};

use super::{
    hand::{Given, Hand, NotGiven},
    live::Live,
    mode::{Doing, Mode, Press},
    session::{Presses, Who},
    tables,
};
use crate::{error::CliError, run::Setup};

impl Live {
    /// A run begins, which may be work by hand.
    pub(super) fn begins_by_hand(&mut self, setup: &Setup) -> Result<(), CliError> {
        let hand = setup.by_hand.then(|| Hand::new(&setup.folder.language, &setup.machine));
        self.hand = hand.transpose().map_err(CliError::Input)?;
        Ok(())
    }

    /// Takes what somebody asks of work by hand.
    pub(super) fn takes_by_hand(&mut self, ticket: u64, asked: &HandAsked, taken: &mut Presses) {
        let press = match asked {
            HandAsked::On => Press::Hand,
            HandAsked::JogOn => Press::JogOn,
            HandAsked::Offset { .. } => Press::Table,
            HandAsked::Play(_) => Press::Play,
            HandAsked::From(_) => Press::From,
            HandAsked::ToolIn(number) => return self.takes_tool(ticket, *number, &mut taken.requests),
            _ => Press::Block,
        };
        let Some(hand) = self.hand.as_mut().filter(|_| self.mode.refuses(press).is_none()) else {
            let why = self.mode.refuses(press).unwrap_or("this run is no work by hand");
            return self.refuse(ticket, "not-now", why);
        };
        let mut send = |request, who| {
            self.session.sent(request, who);
            taken.requests.push(request);
        };
        if press == Press::JogOn {
            return send(Request::Jog(true), Who::Panel(ticket));
        }
        match hand.give(asked) {
            Err(NotGiven::NotReferenced(why)) => self.refuse(ticket, "not-referenced", &why),
            Err(NotGiven::Bad(why)) => {
                let code = if press == Press::Table { "bad-offset" } else { "bad-block" };
                self.refuse(ticket, code, &why);
            }
            Ok(Given { items, messages, jogs, text }) => {
                taken.items.extend(items);
                taken.messages.extend(messages);
                // The key is pressed before the jog begins.
                if jogs {
                    send(Request::Jog(true), Who::Keyboard);
                }
                send(Request::Block, Who::Panel(ticket));
                self.session.gives(text);
                let table = hand.table(self.tables.files());
                self.shows_tables(tables::shown(Ok(&table)));
                self.mode = if jogs { Mode::Jog } else { Mode::Mdi };
                // Whoever has the answer sees no machine that waits any more.
                let mut shown = Map::new();
                self.shows_hand(&mut shown);
                self.web.link.answer(&ToPanel::Set(shown));
            }
        }
    }

    /// Somebody says that a tool is in.
    pub(super) fn takes_tool(&mut self, ticket: u64, number: u32, requests: &mut Vec<Request>) {
        let refused = self.mode.refuses(Press::Tool).map(str::to_owned);
        match refused.map_or_else(|| self.change.says(number), Err) {
            Ok(()) => {
                self.session.sent(Request::CycleStart, Who::Panel(ticket));
                requests.push(Request::CycleStart);
            }
            Err(why) => {
                self.refuse(ticket, "not-now", &why);
            }
        }
    }

    /// Somebody sets words of a coordinate system or a tool while the machine is off.
    pub(super) fn sets_when_off(&mut self, ticket: u64, of: &str, words: &[(char, f64)], add: bool) {
        match self.tables.set(of, words, add) {
            Ok(()) => self.web.link.answer(&ToPanel::Taken { ticket, cycle: 0 }),
            Err(why) => self.refuse(ticket, "bad-offset", &why),
        }
        self.shows_tables(self.tables.kept());
    }

    /// Offsets and tools are these now.
    pub(super) fn shows_tables(&mut self, shown: Value) {
        if self.still.get("offsets") != Some(&shown) {
            self.stands(Map::from_iter([("offsets".to_owned(), shown)]));
        }
    }

    /// A program that goes on may have put another zero in force, or moved one.
    pub(super) fn shows_zero(&mut self, record: &Record) {
        if let Some(notes) = self.known.zero_now(record.machine) {
            let now = self.tables.so_far(notes);
            self.shows_tables(now);
        }
    }

    /// What is shown of modes and of work by hand.
    pub(super) fn shows_hand(&self, shown: &mut Map<String, Value>) {
        shown.insert("mode".into(), json!(self.mode.name()));
        shown.insert("recording".into(), json!(!self.session.is_full()));
        let hand = self.hand.as_ref().map(|hand| {
            json!({
                "in_force": hand.in_force(),
                "x_is_diameter": hand.x_is_diameter(),
                "waits": hand.doing() == Doing::Nothing,
            })
        });
        if let Some(hand) = &self.hand {
            shown.insert("origin_mm".into(), json!(hand.origin_mm()));
        }
        shown.insert("by_hand".into(), json!(hand));
    }

    /// All that was given by hand in the run that is over, and what of it outlives it.
    pub(crate) fn given(&mut self) -> Option<(Vec<Item>, interpreter::Outlasting)> {
        self.hand.take().map(|hand| (hand.whole(), hand.outlasting()))
    }
}
