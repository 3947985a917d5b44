//! What a type needs to travel between processes.

use std::fmt::Debug;

use zerocopy::{FromBytes, Immutable, IntoBytes};

/// A message: plain bytes without pointers or padding, of a type whose name carries a version.
///
/// Both ends of a channel must agree on name and size of what it carries. Whoever changes the layout of a
/// message changes the version in its name.
pub trait Message: IntoBytes + FromBytes + Immutable + Copy + Debug + 'static {
    /// Name and version, `pitchlock/axis-frame/1`.
    const NAME: &str;
}

/// What a channel carries: a [`Message`], always as long as its type, or something that is as long as what it
/// holds.
pub trait Payload: Copy + Debug + 'static {
    /// Name and version, as that of a [`Message`].
    const NAME: &str;
    /// Most bytes.
    const MOST_BYTES: usize;

    /// The bytes that travel.
    fn bytes(&self) -> &[u8];

    /// What has travelled; `None` for a number of bytes that it cannot have.
    fn from_payload(bytes: &[u8]) -> Option<Self>;
}

impl<T: Message> Payload for T {
    const NAME: &str = T::NAME;
    const MOST_BYTES: usize = size_of::<T>();

    fn bytes(&self) -> &[u8] {
        self.as_bytes()
    }

    fn from_payload(bytes: &[u8]) -> Option<T> {
        T::read_from_bytes(bytes).ok()
    }
}
