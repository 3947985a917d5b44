//! Short lists of a `summary.json` that may be somebody else's. In: a list, each of whose elements is long in
//! memory and may be two bytes in the file. Out: the same, or an error where there are too many.

use std::{fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer,
    de::{Error as _, SeqAccess, Visitor},
};

/// Most elements of a list that is short in every summary that is ours.
const FEW: usize = 256;

/// Reads a list.
///
/// # Errors
/// It has more elements than [`FEW`].
pub(super) fn few<'de, D: Deserializer<'de>, T: Deserialize<'de>>(from: D) -> Result<Vec<T>, D::Error> {
    struct Few<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for Few<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a list of at most {FEW}")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
            let mut few = Vec::new();
            while let Some(one) = list.next_element()? {
                if few.len() == FEW {
                    return Err(A::Error::custom(format_args!("this list has more than {FEW} elements")));
                }
                few.push(one);
            }
            Ok(few)
        }
    }
    from.deserialize_seq(Few(PhantomData))
}
