//! How far values stand inside each other.

use super::cursor::Cursor;
use crate::problem::Problem;

/// Brackets, signs and `#` that stand inside each other.
#[derive(Clone, Copy)]
pub(crate) struct Depth {
    deepest: u32,
    here: u32,
}

impl Depth {
    /// Outside of everything; `deepest` of them may stand inside each other.
    #[inline]
    pub(crate) fn new(deepest: u32) -> Depth {
        Depth { deepest, here: 0 }
    }

    /// Goes one deeper. `holder` is what the dialect calls its parameters.
    ///
    /// # Errors
    /// The limit is reached.
    pub(crate) fn enter(&mut self, cursor: &mut Cursor, holder: &str) -> Result<(), Box<Problem>> {
        if self.here >= self.deepest {
            return Err(self.too_deep(cursor, holder));
        }
        self.here += 1;
        Ok(())
    }

    /// Comes out again.
    pub(crate) fn leave(&mut self) {
        self.here -= 1;
    }

    #[cold]
    fn too_deep(self, cursor: &mut Cursor, holder: &str) -> Box<Problem> {
        let deepest = self.deepest;
        let message =
            format!("more than {deepest} brackets, signs or # inside each other, the limit expression_depth");
        let help = format!("compute part of it into a {holder} on an earlier line, as in #1=[...]");
        cursor.error_here("expression-too-deep", message, help)
    }
}
