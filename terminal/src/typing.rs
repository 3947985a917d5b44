//! A line that is typed: a block, or any request. In: keys. Out: the word and the value of what is asked for.

use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use serde_json::{Value, json};

/// Most characters that are typed: those of a block.
const LONGEST: usize = 512;

/// What is typed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) is_block: bool,
    pub(crate) text: String,
}

/// Whoever types.
#[derive(Debug, Default)]
pub(crate) struct Typing {
    line: Option<Line>,
    before: String,
}

impl Typing {
    /// The line, while there is one.
    pub(crate) fn line(&self) -> Option<&Line> {
        self.line.as_ref()
    }

    /// A line begins.
    pub(crate) fn begins(&mut self, is_block: bool) {
        self.line = Some(Line { is_block, text: String::new() });
    }

    /// It is given up.
    pub(crate) fn forget(&mut self) {
        self.line = None;
    }

    /// A key while a line is typed.
    pub(crate) fn key(&mut self, event: &KeyEvent) -> Option<(String, Value)> {
        let line = self.line.as_mut()?;
        match event.code {
            KeyCode::Esc => self.line = None,
            KeyCode::Backspace => drop(line.text.pop()),
            KeyCode::Up => line.text.clone_from(&self.before),
            KeyCode::Char(letter)
                if !event.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT)
                    && line.text.chars().count() < LONGEST =>
            {
                line.text.push(letter);
            }
            KeyCode::Enter if line.text.trim().is_empty() => self.line = None,
            KeyCode::Enter => {
                let text = std::mem::take(&mut line.text);
                self.before.clone_from(&text);
                if line.is_block {
                    return Some(("mdi".into(), json!(text.trim())));
                }
                self.line = None;
                let Some((word, value)) = text.trim().split_once(' ') else {
                    return Some((text.trim().into(), Value::Null));
                };
                // A value is JSON, or else a text as it stands.
                return Some((
                    word.into(),
                    serde_json::from_str(value).unwrap_or_else(|_| json!(value.trim())),
                ));
            }
            _ => {}
        }
        None
    }
}
