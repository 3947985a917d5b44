//! What M70 and M73 saved.

use super::modes::{Coolant, Overrides, Path, Spindle};
use crate::codes::G;

/// What M70 and M73 saved, by level of subroutine calls.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contexts {
    levels: Vec<Context>,
}

/// What was saved on one level.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Context {
    pub(crate) saved: Option<Saved>,
    /// M73: restored by the return.
    pub(crate) on_return: bool,
}

/// The modes that M70 saves. Motion code, position and offsets are not among them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Saved {
    pub(crate) feed: f64,
    pub(crate) spindle: Spindle,
    pub(crate) path: Path,
    pub(crate) coolant: Coolant,
    pub(crate) overrides: Overrides,
    /// The G codes in force.
    pub(crate) g: [G; 12],
}

impl Contexts {
    /// What was saved on a level.
    pub(crate) fn at(&self, level: u32) -> Option<&Saved> {
        self.levels.get(level as usize)?.saved.as_ref()
    }

    /// Saves on a level, or forgets what was saved there.
    pub(crate) fn set(&mut self, level: u32, context: Context) {
        let level = level as usize;
        if self.levels.len() <= level {
            self.levels.resize(level + 1, Context::default());
        }
        if let Some(slot) = self.levels.get_mut(level) {
            *slot = context;
        }
    }

    /// Forgets what was saved on a level, and hands it out.
    pub(crate) fn take(&mut self, level: u32) -> Context {
        self.levels.get_mut(level as usize).map(std::mem::take).unwrap_or_default()
    }
}
