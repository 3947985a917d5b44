//! The keys. The table is the only place that says what there is: it is drawn, and keys are looked up in it.

use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Does {
    /// A request without a value.
    Ask(&'static str),
    /// A request whose value is the opposite of a field of the state.
    Switch(&'static str, &'static str),
    /// A knob: request, field of `knobs`, per cent more, highest.
    Turn(&'static str, &'static str, f64, f64),
    /// The keys of the machine are taken, or given back.
    Seat,
    /// The tool that is waited for is in.
    ToolIn,
    /// A recording plays, or stands.
    Play,
    /// A jog or a step: which of the axes that the page of keys names, and whether towards higher values.
    Jog(usize, bool),
    /// The next length of a step.
    Step,
    /// The feed of jogs, by this factor.
    Feed(f64),
    /// A block is typed.
    Block,
    /// Any request is typed.
    Order,
    /// Positions of the work, or of the machine.
    Frame,
    /// The terminal is left.
    Leave,
    /// What was begun here ends, whatever it does.
    End,
}

/// A key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As it is told.
    pub code: KeyCode,
    /// As it is called.
    pub name: &'static str,
    /// What it does, in a word or two.
    pub words: &'static str,
    /// What it does.
    pub does: Does,
}

const fn key(code: KeyCode, name: &'static str, words: &'static str, does: Does) -> Key {
    Key { code, name, words, does }
}

/// Every key, in the order in which they are shown.
pub const KEYS: [Key; 31] = [
    key(KeyCode::Char('k'), "k", "keys: take, give back", Does::Seat),
    key(KeyCode::Char('s'), "s", "start", Does::Ask("start")),
    key(KeyCode::Char(' '), "space", "hold", Does::Ask("hold")),
    key(KeyCode::Char('S'), "S", "stop", Does::Ask("stop")),
    key(KeyCode::Char('A'), "A", "abort", Does::Ask("abort")),
    key(KeyCode::Char('E'), "E", "emergency stop", Does::Ask("emergency-stop")),
    key(KeyCode::Char('b'), "b", "single block", Does::Switch("single-block", "single_block")),
    key(KeyCode::Char('1'), "1", "stop at M1", Does::Switch("optional-stop", "optional_stop")),
    key(KeyCode::Char('t'), "t", "tool is in", Does::ToolIn),
    key(
        KeyCode::Char('v'),
        "v",
        "spindle −10, +10 %",
        Does::Turn("spindle-override", "spindle_pct", -10.0, 200.0),
    ),
    key(
        KeyCode::Char('V'),
        "V",
        "spindle −10, +10 %",
        Does::Turn("spindle-override", "spindle_pct", 10.0, 200.0),
    ),
    key(KeyCode::Char('f'), "f", "feed −10, +10 %", Does::Turn("feed-override", "feed_pct", -10.0, 200.0)),
    key(KeyCode::Char('F'), "F", "feed −10, +10 %", Does::Turn("feed-override", "feed_pct", 10.0, 200.0)),
    key(KeyCode::Char('r'), "r", "rapid −10, +10 %", Does::Turn("rapid-override", "rapid_pct", -10.0, 100.0)),
    key(KeyCode::Char('R'), "R", "rapid −10, +10 %", Does::Turn("rapid-override", "rapid_pct", 10.0, 100.0)),
    key(KeyCode::Char('o'), "o", "by hand", Does::Ask("by-hand")),
    key(KeyCode::Left, "←", "jog", Does::Jog(0, false)),
    key(KeyCode::Right, "→", "jog", Does::Jog(0, true)),
    key(KeyCode::Down, "↓", "jog", Does::Jog(1, false)),
    key(KeyCode::Up, "↑", "jog", Does::Jog(1, true)),
    key(KeyCode::PageDown, "page down", "jog", Does::Jog(2, false)),
    key(KeyCode::PageUp, "page up", "jog", Does::Jog(2, true)),
    key(KeyCode::Char('j'), "j", "jog or step", Does::Step),
    key(KeyCode::Char(','), ",", "feed of jogs", Does::Feed(0.5)),
    key(KeyCode::Char('.'), ".", "feed of jogs", Does::Feed(2.0)),
    key(KeyCode::Char('m'), "m", "block", Does::Block),
    key(KeyCode::Char(':'), ":", "any request", Does::Order),
    key(KeyCode::Char('p'), "p", "play, pause", Does::Play),
    key(KeyCode::Char('w'), "w", "work, machine", Does::Frame),
    key(KeyCode::Char('q'), "q", "leave", Does::Leave),
    key(KeyCode::Char('c'), "Ctrl-C", "end", Does::End),
];

/// The axes of the keys of jogs: left and right, up and down, page up and down.
pub(crate) fn axes(kinematics: &str) -> [&'static str; 3] {
    if kinematics == "lathe" { ["Z", "X", ""] } else { ["X", "Y", "Z"] }
}

/// The key that was told.
pub(crate) fn of(event: &KeyEvent) -> Option<&'static Key> {
    let control = event.modifiers.contains(KeyModifiers::CONTROL);
    KEYS.iter().find(|key| key.code == event.code && (key.does == Does::End) == control)
}
