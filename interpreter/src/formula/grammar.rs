//! What belongs together in a formula. In: words that `scan` has passed. Out: operations in the order of a
//! [`Formula`].
//!
//! [`Climb::part`] reads operands and the operations between them as long as these bind tightly enough, and
//! reads what binds more tightly first (precedence climbing). `^` binds more tightly than a sign, and from
//! right to left.
//!
//! [`Formula`]: shape::Formula

use std::ops::Range;
use std::slice::Iter;

use shape::Op;

use super::Misread;
use super::constant::{fold, power};
use super::scan::{Kind, Word};

/// How tightly an operation of two operands binds: sums least.
const SUM: u8 = 0;
const PRODUCT: u8 = 1;
const POWER: u8 = 2;

/// A formula or a part of one: its operations, and from its first to its last operand, bytes of the text.
struct Part {
    operations: Vec<Op>,
    span: Range<usize>,
}

/// The operations of the words of a formula.
pub(super) fn operations(words: &[Word]) -> Result<Vec<Op>, Misread> {
    Ok(Climb { words: words.iter() }.part(SUM)?.operations)
}

/// The words that are left.
struct Climb<'w> {
    words: Iter<'w, Word>,
}

impl Climb<'_> {
    /// Operands joined by operations that bind at least as tightly as `least`.
    fn part(&mut self, least: u8) -> Result<Part, Misread> {
        let mut left = self.operand()?;
        while let Some((sign, binds)) = self.joins().filter(|(_, binds)| *binds >= least) {
            self.words.next();
            let right = self.part(if binds == POWER { POWER } else { binds + 1 })?;
            left = match sign {
                '^' => left.power(right)?,
                '/' => left.join(Op::Div, right)?,
                '*' => left.join(Op::Mul, right)?,
                '-' => left.join(Op::Sub, right)?,
                _ => left.join(Op::Add, right)?,
            };
        }
        Ok(left)
    }

    /// An operand behind its signs: a word, or what is in the brackets of a function or in brackets alone.
    fn operand(&mut self) -> Result<Part, Misread> {
        let mut negations = 0;
        while let Some(Kind::Sign(sign @ ('+' | '-'))) = self.peek() {
            self.words.next();
            negations += usize::from(sign == '-');
        }
        if negations > 0 {
            let part = self.part(POWER)?;
            return (0..negations).try_fold(part, |part, _| part.under(Op::Neg));
        }
        let Word { kind, span } = self.words.next().expect("`scan` lets no formula end before an operand");
        match *kind {
            Kind::Operand(op) => Ok(Part { operations: vec![op], span: span.clone() }),
            Kind::Function(function, _) => self.operand()?.under(Op::Apply(function)),
            Kind::Sign(_) => {
                let inside = self.part(SUM)?;
                self.words.next(); // the closing bracket
                Ok(inside)
            }
        }
    }

    fn peek(&self) -> Option<Kind> {
        self.words.as_slice().first().map(|word| word.kind)
    }

    /// The operation of two operands that comes next, and how tightly it binds; none at the end and before
    /// `)`.
    fn joins(&self) -> Option<(char, u8)> {
        match self.peek()? {
            Kind::Sign(sign @ ('+' | '-')) => Some((sign, SUM)),
            Kind::Sign(sign @ ('*' | '/')) => Some((sign, PRODUCT)),
            Kind::Sign('^') => Some(('^', POWER)),
            _ => None,
        }
    }
}

impl Part {
    /// Under a function, or with its sign changed.
    fn under(mut self, op: Op) -> Result<Part, Misread> {
        self.operations.push(op);
        self.folded()
    }

    fn join(self, op: Op, right: Part) -> Result<Part, Misread> {
        let operations = [self.operations, right.operations, vec![op]].concat();
        Part { operations, span: self.span.start..right.span.end }.folded()
    }

    fn power(self, exponent: Part) -> Result<Part, Misread> {
        let span = self.span.start..exponent.span.end;
        let operations = power([self.operations, exponent.operations])
            .map_err(|(message, help)| Misread::new(span.clone(), message, help))?;
        Part { operations, span }.folded()
    }

    /// The same with its constants computed.
    fn folded(self) -> Result<Part, Misread> {
        let Part { operations, span } = self;
        match fold(operations) {
            Ok(operations) => Ok(Part { operations, span }),
            Err(value) => {
                let message = format!("this part of the formula is {value}, not a number");
                let help = "roots and logarithms are of positive numbers, quotients not by 0";
                Err(Misread::new(span, message, help))
            }
        }
    }
}
