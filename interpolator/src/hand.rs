//! Work by hand. In: the panel of each tick. Out: whether another block is there to be begun, and whether the
//! jog in hand goes on. A jog whose key was let go comes to rest and is over, whatever the panel shows later:
//! who wants to go on gives another.

use protocol::Panel;

/// What is known of blocks by hand.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hand {
    /// What [`Panel::BLOCK`] showed when the last one began.
    odd: bool,
    /// The block in hand.
    pub(crate) jog: Jog,
}

/// Whether a block by hand is a jog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Jog {
    /// It is none.
    #[default]
    No,
    /// Its key is pressed.
    Pressed,
    /// Its key was let go: it comes to rest on its path, and is over.
    LetGo,
}

impl Hand {
    /// The panel of a tick.
    pub(crate) fn look(&mut self, panel: &Panel) {
        if self.jog == Jog::Pressed {
            self.jog = Jog::begins(true, panel);
        }
    }

    /// Whether a block is there that has not begun.
    pub(crate) fn is_given(&self, panel: &Panel) -> bool {
        self.odd != panel.pressed(Panel::BLOCK)
    }

    /// It begins.
    pub(crate) fn begins(&mut self, panel: &Panel) {
        self.odd = panel.pressed(Panel::BLOCK);
    }
}

impl Jog {
    /// A block by hand begins.
    pub(crate) fn begins(jogs: bool, panel: &Panel) -> Jog {
        match (jogs, panel.pressed(Panel::JOG)) {
            (false, _) => Jog::No,
            (true, true) => Jog::Pressed,
            (true, false) => Jog::LetGo,
        }
    }
}
