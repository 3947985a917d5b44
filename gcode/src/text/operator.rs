//! How operators between two values are written. What they are worth, and which come first, is for the
//! dialect to say.

use super::cursor::Cursor;

/// An operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    /// `**`, which is read as [`Operator::Times`] first.
    Power,
    Times,
    Divide,
    Modulo,
    Plus,
    Minus,
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
    And,
    Or,
    ExclusiveOr,
}

/// Operators that are written as words.
const NAMES: [(&str, Operator); 10] = [
    ("lt", Operator::Less),
    ("le", Operator::LessOrEqual),
    ("gt", Operator::Greater),
    ("ge", Operator::GreaterOrEqual),
    ("eq", Operator::Equal),
    ("ne", Operator::NotEqual),
    ("mod", Operator::Modulo),
    ("and", Operator::And),
    ("or", Operator::Or),
    ("xor", Operator::ExclusiveOr),
];

impl Operator {
    /// Takes an operator, if one comes next.
    #[inline]
    pub(crate) fn take(cursor: &mut Cursor) -> Option<Operator> {
        let sign = match cursor.peek()? {
            b'+' => Operator::Plus,
            b'-' => Operator::Minus,
            b'*' => Operator::Times,
            b'/' => Operator::Divide,
            b'a'..=b'z' => return cursor.take_name(&NAMES),
            _ => return None,
        };
        cursor.skip();
        Some(sign)
    }
}
