//! What was pressed, and in which cycle of the machine. In: requests as they are sent to the plant, and what
//! the plant tells of those it took. Out: the cycle of each press, and all of them as events of a scenario:
//! so that a session can be repeated.

use std::{collections::VecDeque, fmt::Write as _};

use protocol::{Item, OperatorRequest, operator::Request};
use rig::observe::Message;

/// Most presses that are kept: one in every tenth of a second of a working day, and more.
const MOST: usize = 1 << 19;

/// What was pressed, for the machine.
#[derive(Default)]
pub(crate) struct Presses {
    /// Machine code by hand.
    pub(crate) items: Vec<Item>,
    /// What that tells its operator.
    pub(crate) messages: Vec<Message>,
    /// What is sent to the plant behind it.
    pub(crate) requests: Vec<Request>,
}

/// Who pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Who {
    /// Somebody at the panel, with this ticket.
    Panel(u64),
    /// Somebody at the terminal.
    Keyboard,
    /// The launcher by itself. It does that again when a run is repeated.
    Launcher,
}

/// The presses of a run.
#[derive(Debug, Default)]
pub(crate) struct Session {
    /// On their way to the plant.
    sent: VecDeque<(Request, Who)>,
    /// The cycle in whose measurement each was first seen, and what it was.
    pressed: Vec<(u64, Request)>,
    /// Blocks by hand, in their order.
    blocks: Vec<String>,
}

impl Session {
    /// A block by hand was given, and a request for it follows.
    pub(crate) fn gives(&mut self, text: String) {
        self.blocks.push(text);
    }

    /// A request was sent to the plant.
    pub(crate) fn sent(&mut self, request: Request, who: Who) {
        self.sent.push_back((request, who));
    }

    /// The plant took a request in this cycle, so that the next measurement shows it. Who pressed it; those
    /// that were sent before it have been lost.
    pub(crate) fn taken(&mut self, cycle: u64, request: Request) -> Option<Who> {
        while let Some((sent, who)) = self.sent.pop_front() {
            if sent == request {
                if who != Who::Launcher && self.pressed.len() < MOST {
                    self.pressed.push((cycle + 1, request));
                }
                return Some(who);
            }
        }
        None
    }

    /// The run is over: those of the panel that the plant has not taken.
    pub(crate) fn lost(&mut self) -> Vec<u64> {
        let of_panel = |(_, who)| if let Who::Panel(ticket) = who { Some(ticket) } else { None };
        self.sent.drain(..).filter_map(of_panel).collect()
    }

    /// Whether there is no room for another press: from here on the session cannot be repeated.
    pub(crate) fn is_full(&self) -> bool {
        self.pressed.len() >= MOST
    }

    /// How many wait for the plant.
    pub(crate) fn waiting(&self) -> usize {
        self.sent.len()
    }

    /// What was pressed as events of a scenario; nothing if nothing was.
    pub(crate) fn events(&self) -> Option<String> {
        let mut text = String::new();
        if self.is_full() {
            let _ = writeln!(
                text,
                "# More than {MOST} presses: what came later is not here, and this is no repetition.\n"
            );
        }
        let mut blocks = self.blocks.iter();
        for (cycle, request) in &self.pressed {
            if *request == Request::Block {
                blocks.next().into_iter().for_each(|block| {
                    let _ = writeln!(text, "# {}", block.replace(|letter: char| letter.is_control(), " "));
                });
            }
            let _ = writeln!(text, "[[event]]\nat = {{ cycle = {cycle} }}\n{}\n", action(*request));
        }
        (!text.is_empty()).then_some(text)
    }
}

/// A request as the action of an event.
fn action(request: Request) -> String {
    match request {
        Request::SpindleOverride(pct) => format!("spindle_override_pct = {pct:?}"),
        Request::FeedOverride(pct) => format!("feed_override_pct = {pct:?}"),
        Request::RapidOverride(pct) => format!("rapid_override_pct = {pct:?}"),
        Request::FeedHold => "feed_hold = true".into(),
        Request::CycleStart => "cycle_start = true".into(),
        Request::Stop => "stop = true".into(),
        Request::SingleBlock(on) => format!("single_block = {on}"),
        Request::OptionalStop(on) => format!("optional_stop = {on}"),
        Request::Abort => "abort = true".into(),
        Request::EmergencyStop => "emergency_stop = true".into(),
        Request::Jog(on) => format!("jog = {on}"),
        Request::Block => "block = true".into(),
    }
}

/// A press of the panel, if it is one.
pub(crate) fn request(kind: u32, value: f64) -> Option<Request> {
    OperatorRequest { kind, value, ..OperatorRequest::default() }.unpack().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every request comes back out of the scenario that it was written into, even one by one.
    #[test]
    fn what_was_pressed_is_a_scenario() {
        let all = [
            Request::SpindleOverride(62.537_219_8),
            Request::FeedOverride(0.0),
            Request::RapidOverride(100.0),
            Request::FeedHold,
            Request::CycleStart,
            Request::Stop,
            Request::SingleBlock(true),
            Request::SingleBlock(false),
            Request::OptionalStop(false),
            Request::OptionalStop(true),
            Request::Abort,
            Request::EmergencyStop,
            Request::Jog(true),
            Request::Jog(false),
            Request::Block,
        ];
        for alone in all {
            let mut session = Session::default();
            session.sent(alone, Who::Panel(1));
            assert_eq!(session.taken(7, alone), Some(Who::Panel(1)));
            let text = session.events().expect("something was pressed");
            assert!(text.contains("cycle = 8"), "{text}");
            let scenario = sim_plant::Scenario::from_toml(&format!("panel = \"recorded\"\n{text}"));
            assert!(scenario.is_ok_and(|scenario| !scenario.is_empty()), "{text}");
        }
    }

    #[test]
    fn a_lost_press_has_no_cycle_and_the_launcher_presses_by_itself() {
        let mut session = Session::default();
        session.sent(Request::FeedHold, Who::Panel(1));
        session.sent(Request::CycleStart, Who::Keyboard);
        session.sent(Request::EmergencyStop, Who::Launcher);
        assert_eq!(session.waiting(), 3);
        assert_eq!(session.taken(10, Request::CycleStart), Some(Who::Keyboard));
        assert_eq!(session.taken(11, Request::EmergencyStop), Some(Who::Launcher));
        assert_eq!(session.taken(12, Request::Abort), None);
        session.sent(Request::Stop, Who::Keyboard);
        session.sent(Request::Abort, Who::Panel(9));
        assert_eq!((session.lost(), session.waiting()), (vec![9], 0));
        let text = session.events().expect("something was pressed");
        assert_eq!(text, "[[event]]\nat = { cycle = 11 }\ncycle_start = true\n\n");
    }

    /// There is an end to what is kept, and it is said.
    #[test]
    fn a_session_that_is_too_long_says_so() {
        let mut session = Session::default();
        for cycle in 0..MOST as u64 {
            assert!(!session.is_full());
            session.sent(Request::FeedHold, Who::Panel(cycle));
            session.taken(cycle, Request::FeedHold);
        }
        assert!(session.is_full());
        session.sent(Request::Stop, Who::Panel(1));
        assert_eq!(session.taken(1 << 40, Request::Stop), Some(Who::Panel(1)), "it is done all the same");
        let text = session.events().expect("something was pressed");
        assert!(text.starts_with("# More than 524288 presses") && !text.contains("stop = true"));
    }
}
