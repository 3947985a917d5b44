//! A formula in a file and on the wire: its operations and its constants, as many as there are. Neither
//! writing nor reading allocates.

use core::fmt::{Formatter, Result as Written};
use core::marker::PhantomData;

use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Formula, FormulaError};

/// A formula.
#[derive(Serialize, Deserialize)]
pub(super) struct Stored {
    codes: Row<u8, { Formula::OPS }>,
    constants: Row<f64, { Formula::CONSTANTS }>,
}

impl From<Formula> for Stored {
    fn from(formula: Formula) -> Stored {
        let codes = formula.codes.iter().take_while(|code| **code != 0).count();
        let constants = formula.codes.iter().take(codes).filter(|code| **code == 1).count();
        Stored {
            codes: Row { all: formula.codes, count: codes },
            constants: Row { all: formula.constants, count: constants },
        }
    }
}

impl TryFrom<Stored> for Formula {
    type Error = FormulaError;

    fn try_from(stored: Stored) -> Result<Formula, FormulaError> {
        Formula::decode(stored.codes.items(), stored.constants.items())
    }
}

/// At most `N` values.
struct Row<T, const N: usize> {
    all: [T; N],
    count: usize,
}

impl<T, const N: usize> Row<T, N> {
    fn items(&self) -> &[T] {
        self.all.get(..self.count).unwrap_or_default()
    }
}

impl<T: Serialize, const N: usize> Serialize for Row<T, N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut row = serializer.serialize_seq(Some(self.count))?;
        self.items().iter().try_for_each(|item| row.serialize_element(item))?;
        row.end()
    }
}

impl<'de, T: Deserialize<'de> + Copy + Default, const N: usize> Deserialize<'de> for Row<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Row<T, N>, D::Error> {
        struct Each<T, const N: usize>(PhantomData<T>);

        impl<'de, T: Deserialize<'de> + Copy + Default, const N: usize> Visitor<'de> for Each<T, N> {
            type Value = Row<T, N>;

            fn expecting(&self, text: &mut Formatter<'_>) -> Written {
                write!(text, "at most {N} values")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Row<T, N>, A::Error> {
                let mut row = Row { all: [T::default(); N], count: 0 };
                while let Some(value) = values.next_element()? {
                    *row.all.get_mut(row.count).ok_or_else(|| A::Error::custom(FormulaError::TooLong))? =
                        value;
                    row.count += 1;
                }
                Ok(row)
            }
        }

        deserializer.deserialize_seq(Each(PhantomData))
    }
}
