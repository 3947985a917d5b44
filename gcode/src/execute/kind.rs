//! Rapid or feed.

use crate::canon::{Call, Pose};

/// Whether a move cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// As fast as the machine can.
    Traverse,
    /// At the feed.
    Feed,
}

impl Kind {
    /// The call of a move to a point.
    pub(crate) fn call(self, target: Pose) -> Call<'static> {
        match self {
            Kind::Traverse => Call::StraightTraverse(target),
            Kind::Feed => Call::StraightFeed(target),
        }
    }
}
