//! Values in a row. In: an array of the text of a job. Out: as many values as there must be, or how many there are.

use serde::de::{Deserialize, Deserializer, Error};

/// N values in square brackets, no more and no fewer. (An array of fixed length that serde reads leaves what is behind
/// its last value unread.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row<T, const N: usize>(pub(crate) [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Row<T, N> {
    fn deserialize<D: Deserializer<'de>>(values: D) -> Result<Row<T, N>, D::Error> {
        let values = Vec::deserialize(values)?;
        let found = values.len();
        let wrong = |_| D::Error::custom(format!("{found} values where there must be {N}"));
        values.try_into().map(Row).map_err(wrong)
    }
}
