//! Values in a row. In: an array of the text of a job. Out: as many values as there must be, or how many
//! there are.

use std::fmt::{self, Formatter};
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

/// N values in square brackets, no more and no fewer. (An array of fixed length that serde reads leaves what
/// is behind its last value unread.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row<T, const N: usize>(pub(crate) [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Row<T, N> {
    fn deserialize<D: Deserializer<'de>>(values: D) -> Result<Row<T, N>, D::Error> {
        values.deserialize_seq(Values(PhantomData))
    }
}

struct Values<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for Values<T, N> {
    type Value = Row<T, N>;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{N} values in square brackets")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut row: A) -> Result<Row<T, N>, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = row.next_element()? {
            values.push(value);
        }
        let found = values.len();
        let wrong = |_| A::Error::custom(format!("{found} values where there must be {N}"));
        values.try_into().map(Row).map_err(wrong)
    }
}
