//! The terminal that this runs in: taken, drawn on, and given back as it was, also when the program panics.

use std::{
    io,
    mem::ManuallyDrop,
    sync::mpsc::{Receiver, RecvTimeoutError, channel},
    thread::Builder,
    time::Duration,
};

use ratatui::{
    DefaultTerminal,
    crossterm::{
        event::{self, Event, KeyEvent},
        terminal,
    },
};

use crate::{desk::Desk, draw::draw};

/// A terminal that is taken.
#[derive(Debug)]
pub struct Screen {
    terminal: ManuallyDrop<DefaultTerminal>,
    keys: Receiver<KeyEvent>,
}

impl Drop for Screen {
    fn drop(&mut self) {
        // One that is gone cannot be given back. Ratatui would tell so on a standard error that is gone as
        // well, and a panic in a drop is the end of the process: so it is never dropped.
        if self.terminal.show_cursor().is_ok() {
            let _ = ratatui::try_restore();
        }
    }
}

/// Columns and lines of the terminal; `None` if it does not say.
pub fn size() -> Option<(u16, u16)> {
    let size = terminal::window_size().ok()?;
    (size.columns > 0 && size.rows > 0).then_some((size.columns, size.rows))
}

/// Columns that a text takes in a terminal: letters of some scripts take two.
pub fn width(text: &str) -> usize {
    ratatui::text::Line::raw(text).width()
}

impl Screen {
    /// Takes the terminal: other screen, no echo, keys one by one. A thread reads them, and ends with the
    /// process: where a terminal is gone, crossterm reads for ever, and nobody else may be held up by that.
    ///
    /// # Errors
    /// This is no terminal, it is gone, or there is no thread to spare.
    pub fn take() -> io::Result<Screen> {
        let (tells, keys) = channel();
        let screen = Screen { terminal: ManuallyDrop::new(ratatui::try_init()?), keys };
        let reads = move || {
            while let Ok(event) = event::read() {
                let Event::Key(key) = event else { continue };
                if tells.send(key).is_err() {
                    break;
                }
            }
        };
        Builder::new().name("keys".into()).spawn(reads)?;
        Ok(screen)
    }

    /// Draws what has changed, in the size that the terminal has now.
    ///
    /// # Errors
    /// The terminal is gone.
    pub fn draw(&mut self, desk: &mut Desk) -> io::Result<()> {
        let drawn = self.terminal.draw(|frame| {
            desk.is_drawn_on(frame.area().as_size());
            draw(frame, desk);
        });
        drawn.map(drop)
    }

    /// The next key, waited for at most so long.
    ///
    /// # Errors
    /// The terminal is gone.
    pub fn key(&mut self, wait: Duration) -> io::Result<Option<KeyEvent>> {
        match self.keys.recv_timeout(wait) {
            Ok(key) => Ok(Some(key)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(io::ErrorKind::UnexpectedEof.into()),
        }
    }
}
