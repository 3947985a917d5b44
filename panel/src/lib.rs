//! The panel in a browser: what is seen of a machine that runs, and what somebody presses.
//!
//! It is a process of its own behind one socket. What comes down that socket is the newest state and what
//! became of presses; what goes up are presses. The other end is [`Link`], in the launcher, which never
//! waits: a panel that is slow, hangs or dies costs what it does not show, and nothing else.

mod by_hand;
mod link;
mod press;
mod scope;
mod seen;
mod server;
mod wire;

pub use link::Link;
pub use press::{DOES, Does, Refusal, pressed};
pub use scope::scoped;
pub use seen::{AxisSeen, Fault, Knobs, MachineSeen, Message, PassSeen, ProgramSeen, Seen, SpindleSeen};
pub use server::serve;
pub use wire::{FromPanel, HandAsked, Play, Point, ToPanel};

/// Makes a file of rows of the scope: its ending, `csv` or `mcap`, the columns, the numbers row by row.
pub type Save = fn(&str, &[String], &[f64]) -> Result<Vec<u8>, String>;

/// The pages, as they are sent: path, kind, content.
pub const PAGES: [(&str, &str, &str); 5] = [
    ("/", "text/html; charset=utf-8", include_str!("../pages/index.html")),
    ("/panel.css", "text/css; charset=utf-8", include_str!("../pages/panel.css")),
    ("/panel.js", "text/javascript; charset=utf-8", include_str!("../pages/panel.js")),
    ("/icon.svg", "image/svg+xml", include_str!("../pages/icon.svg")),
    ("/scope.js", "text/javascript; charset=utf-8", include_str!("../pages/scope.js")),
];
