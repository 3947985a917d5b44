//! The modes of the machine, as whoever stands at it knows them. In: what a control cycle shows, and whether
//! work by hand is in hand. Out: the mode; what may be pressed in it, and why not.
//!
//! | mode | it is this when |
//! |---|---|
//! | playback | a recording is played |
//! | off | no run goes on |
//! | faulted | a fault is latched, or the emergency stop is pressed |
//! | stopping | stop or abort is pressed, or the program is over |
//! | tool-change | a tool is to be put in by hand |
//! | held | feed hold is pressed |
//! | auto | none of these, and a program runs |
//! | ready | none of these: work by hand, and the machine waits for a block |
//! | jog, MDI | none of these: a block by hand is in hand, that jogs or does not |

use protocol::{MachineState, Panel};
use rig::observe::Record;

/// A mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mode {
    #[default]
    Off,
    Ready,
    Auto,
    Mdi,
    Jog,
    ToolChange,
    Held,
    Stopping,
    Faulted,
    Playback,
}

/// What work by hand does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Doing {
    /// It waits for a block.
    Nothing,
    /// A block is in hand.
    Block,
    /// A jog is.
    Jog,
}

/// What is pressed, as far as modes tell it from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Press {
    Start,
    /// Hold, stop, abort, emergency stop, single block, an override, letting go of a jog key.
    Always,
    /// Work by hand begins.
    Hand,
    /// A block by hand, or a jog.
    Block,
    /// The jog key is confirmed.
    JogOn,
    /// An offset or a tool is set.
    Table,
    /// A recording is played.
    Play,
    /// A tool is said to be in.
    Tool,
    /// It is said where the next start begins.
    From,
}

impl Mode {
    /// Every mode, in the order of the documentation.
    #[cfg(test)]
    pub(crate) const ALL: [Mode; 10] = [
        Mode::Off,
        Mode::Ready,
        Mode::Auto,
        Mode::Mdi,
        Mode::Jog,
        Mode::ToolChange,
        Mode::Held,
        Mode::Stopping,
        Mode::Faulted,
        Mode::Playback,
    ];

    /// Its name.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Mode::Off => "off",
            Mode::Ready => "ready",
            Mode::Auto => "auto",
            Mode::Mdi => "mdi",
            Mode::Jog => "jog",
            Mode::ToolChange => "tool-change",
            Mode::Held => "held",
            Mode::Stopping => "stopping",
            Mode::Faulted => "faulted",
            Mode::Playback => "playback",
        }
    }

    /// The mode in a control cycle of a run; `by_hand`: what work by hand does, if it is that.
    pub(crate) fn of(record: &Record, by_hand: Option<Doing>) -> Mode {
        let panel = &record.truth.measurement.panel;
        let state = record.machine.state();
        match by_hand {
            _ if panel.pressed(Panel::EMERGENCY_STOP) || state == MachineState::Fault => Mode::Faulted,
            _ if panel.pressed(Panel::STOP) || panel.pressed(Panel::ABORT) => Mode::Stopping,
            _ if state == MachineState::Ended => Mode::Stopping,
            // Start releases a hold, and would say that the tool is in.
            _ if state == MachineState::ToolChange => Mode::ToolChange,
            _ if panel.pressed(Panel::FEED_HOLD) => Mode::Held,
            None => Mode::Auto,
            Some(Doing::Nothing) => Mode::Ready,
            Some(Doing::Block) => Mode::Mdi,
            Some(Doing::Jog) => Mode::Jog,
        }
    }

    /// Why something is not done in this mode; nothing if it is.
    pub(crate) fn refuses(self, press: Press) -> Option<&'static str> {
        use Mode::{Auto, Faulted, Held, Jog, Mdi, Off, Playback, Ready, Stopping, ToolChange};
        match (self, press) {
            (Playback, Press::Play) => None,
            (Playback, _) => Some("this is a recording: no key does anything but play, step and seek"),
            (_, Press::Play) => Some("this is no recording: pitchlock panel RUN_DIR plays one"),
            (Off, Press::Start | Press::Hand | Press::Table | Press::From) => None,
            (Ready, Press::Block | Press::Table) | (Jog, Press::JogOn) | (ToolChange, Press::Tool) => None,
            (Off, Press::Block) => Some("the machine is off: by-hand switches it on for work by hand"),
            (Off, _) => Some("no program runs; start starts it"),
            (Faulted, Press::Start | Press::Block | Press::Table) => {
                Some("the machine is in fault, and goes off")
            }
            (Stopping, Press::Start | Press::Block | Press::Table) => {
                Some("the machine comes to rest, and goes off")
            }
            (_, Press::From) => Some("the machine is on: where a start begins is said while it is off"),
            (_, Press::Tool) => Some("no tool is waited for"),
            (ToolChange, Press::Start) => Some("a tool is waited for: tool-change says that it is in"),
            (ToolChange, Press::Block | Press::Table) => {
                Some("a tool is waited for: say that it is in, or stop")
            }
            (Ready, Press::Start) => Some("nothing is held: give a block, or jog"),
            (Jog, Press::Start) => Some("a jog goes on while its key is pressed"),
            (_, Press::Hand) => Some("the machine is on"),
            (_, Press::JogOn) => Some("no jog goes on: press jog again"),
            (Auto, Press::Block) => Some("a program runs: stop or abort ends it"),
            (Auto, Press::Table) => {
                Some("a program runs, and was read with the offsets as they were: set them when it is over")
            }
            (Mdi | Jog, Press::Block | Press::Table) => Some("a block is in hand: wait for its end"),
            (Held, Press::Table) => Some("the machine is held: offsets are set when it is ready, or off"),
            (Held, Press::Block) => Some("the machine is held: start goes on, stop ends what is in hand"),
            (_, Press::Always) | (Auto | Mdi | Held, Press::Start) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use protocol::{MachineStatus, Truth};

    use super::*;

    /// The table of the documentation, cell by cell.
    #[test]
    fn every_press_in_every_mode_is_as_the_documentation_says() {
        let page = include_str!("../../docs/panel.md");
        let presses = [
            ("start", Press::Start),
            ("by-hand", Press::Hand),
            ("a block, a jog", Press::Block),
            ("jog-on", Press::JogOn),
            ("offset", Press::Table),
            ("play, step, seek", Press::Play),
            ("tool-change", Press::Tool),
            ("from", Press::From),
            ("all others", Press::Always),
        ];
        for (name, press) in presses {
            let row = page.lines().find(|line| line.starts_with(&format!("| {name} |")));
            let row = row.unwrap_or_else(|| panic!("docs/panel.md has no row of {name}"));
            let cells: Vec<_> = row.trim_matches('|').split('|').skip(1).map(str::trim).collect();
            assert_eq!(cells.len(), Mode::ALL.len(), "{row}");
            for (mode, cell) in Mode::ALL.into_iter().zip(cells) {
                let done = mode.refuses(press).is_none();
                assert_eq!(cell, if done { "yes" } else { "–" }, "{name} in {}", mode.name());
            }
        }
        let head: Vec<_> = Mode::ALL.iter().map(|mode| mode.name()).collect();
        assert!(page.contains(&format!("| press | {} |", head.join(" | "))), "{head:?}");
    }

    /// Every state of the machine with every button: the most urgent of them says the mode.
    #[test]
    fn the_mode_follows_from_what_a_cycle_shows() {
        use MachineState::{
            ByHand, Ended, Fault, Moving, Paused, Ready, Starting, Threading, ToolChange, Waiting,
        };
        let states = [Starting, Ready, Moving, Waiting, Threading, Ended, Fault, Paused, ByHand, ToolChange];
        let doings = [None, Some(Doing::Nothing), Some(Doing::Block), Some(Doing::Jog)];
        for state in states {
            for buttons in 0..256 {
                for doing in doings {
                    let mut truth = Truth::default();
                    truth.measurement.panel.buttons = buttons;
                    let machine = MachineStatus { state: state as u32, ..MachineStatus::default() };
                    let record = Record { truth: &truth, axes: &[], machine: &machine };
                    let mode = Mode::of(&record, doing);
                    let pressed = |button: u32| buttons & button != 0;
                    let urgent = [
                        (pressed(Panel::EMERGENCY_STOP) || state == Fault, Mode::Faulted),
                        (pressed(Panel::STOP | Panel::ABORT) || state == Ended, Mode::Stopping),
                        (state == ToolChange, Mode::ToolChange),
                        (pressed(Panel::FEED_HOLD), Mode::Held),
                        (doing.is_none(), Mode::Auto),
                    ];
                    let wanted = urgent.iter().find(|(is, _)| *is).map(|(_, mode)| *mode);
                    let wanted = wanted.unwrap_or(match doing {
                        Some(Doing::Jog) => Mode::Jog,
                        Some(Doing::Block) => Mode::Mdi,
                        _ => Mode::Ready,
                    });
                    assert_eq!(mode, wanted, "{state:?} {buttons:#b} {doing:?}");
                }
            }
        }
    }
}
