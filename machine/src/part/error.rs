//! Why a part cannot be what it is said to be, and what to write. Values in mm.

/// Why a part cannot be what it is said to be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PartError {
    /// Not TOML, an unknown key, or a value of the wrong type; the text shows the place.
    #[error("{0}")]
    Syntax(String),
    /// A file beside the program that is not about a part.
    #[error("there is no [part] in it, and it lies beside the program")]
    NotAPart,
    /// The comma behind `part` is missing.
    #[error("a comma is missing behind part")]
    Comma,
    /// No kind of stock.
    #[error("the stock cannot be {0:?}")]
    Kind(String),
    /// A word that this stock does not have.
    #[error("{0:?} says nothing of this stock")]
    Word(String),
    /// Something is said twice.
    #[error("{0} is said twice")]
    Twice(&'static str),
    /// Something is missing.
    #[error("the {0} of the stock is missing")]
    Missing(&'static str),
    /// A block on a lathe.
    #[error("a lathe cuts no block")]
    OnLathe,
    /// A bar, a tube or a profile on a mill.
    #[error("a mill cuts a block and nothing else")]
    OnMill,
    /// A value that no part has.
    #[error("the {what} of the stock cannot be {value}: {allowed}")]
    Value {
        /// Of what.
        what: &'static str,
        /// The value given, mm.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
}

impl PartError {
    /// What to write.
    pub fn help(&self) -> &'static str {
        match self {
            PartError::NotAPart => "rename it, or describe the stock in [part]",
            _ => {
                "write (part, bar D40 L60), (part, tube D40 I20 L60 Z1 C-50) or (part, profile Z0 D20 Z-30 D20 Z-30 D40 \
                 Z-60 D40), on a mill (part, block X0 Y0 Z-20 X100 Y60 Z0); in a file [part] with stock, diameter_mm, \
                 inner_mm, length_mm, face_mm, profile_mm, chuck_mm, or from_mm and to_mm of a block"
            }
        }
    }
}
