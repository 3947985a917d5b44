//! What a type needs to travel between processes.

use std::fmt::Debug;

use zerocopy::{FromBytes, Immutable, IntoBytes};

/// A message: plain bytes without pointers or padding, of a type whose name carries a version.
///
/// Both ends of a channel must agree on name and size of what it carries. Whoever changes the layout of a message changes
/// the version in its name.
pub trait Message: IntoBytes + FromBytes + Immutable + Copy + Debug + 'static {
    /// Name and version, `pitchlock/axis-frame/1`.
    const NAME: &str;
}
