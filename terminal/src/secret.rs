//! A line with a secret behind `#`, typed in a terminal: what comes behind that is not shown.

use std::{
    io::{self, Write as _},
    time::Duration,
};

use ratatui::crossterm::{
    event::{self, Event, KeyCode, KeyEventKind, KeyModifiers},
    terminal::{disable_raw_mode, enable_raw_mode},
};

/// Between two looks at whether somebody ends it.
const LOOK: Duration = Duration::from_millis(100);
/// Most characters of it.
const LONGEST: usize = 1024;

/// The terminal tells keys one by one, until this is dropped.
struct Raw;

impl Drop for Raw {
    fn drop(&mut self) {
        // One that is gone cannot be given back.
        let _ = disable_raw_mode();
    }
}

/// Asks for it on standard error. Nothing where somebody ends that: by Ctrl-C, Ctrl-D, or as `ends` says.
///
/// # Errors
/// The terminal is gone.
pub fn secret(asks: &str, mut ends: impl FnMut() -> bool) -> io::Result<Option<String>> {
    enable_raw_mode()?;
    let raw = Raw;
    let mut shown = io::stderr();
    let mut show = |text: &str| write!(shown, "{text}").and_then(|()| shown.flush());
    show(asks)?;
    let mut line = String::new();
    let typed = loop {
        if ends() {
            break None;
        }
        if !event::poll(LOOK)? {
            continue;
        }
        let Event::Key(key) = event::read()? else { continue };
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        match key.code {
            _ if key.kind == KeyEventKind::Release => {}
            KeyCode::Char('c' | 'd') if control => break None,
            KeyCode::Enter => break Some(line),
            KeyCode::Backspace => {
                let last = line.pop();
                if last.is_some() && !line.contains('#') {
                    show("\u{8} \u{8}")?;
                }
            }
            KeyCode::Char(letter) if !control && line.chars().count() < LONGEST => {
                if !line.contains('#') {
                    show(letter.encode_utf8(&mut [0; 4]))?;
                }
                line.push(letter);
            }
            _ => {}
        }
    };
    drop(raw);
    show("\n")?;
    Ok(typed)
}
