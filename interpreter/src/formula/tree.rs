//! What belongs together in a formula. exmex reads the words and knows the precedence of their operations; its values
//! are trees instead of numbers, so that evaluating the expression builds the tree of it.
//!
//! To exmex an operand is `$` and the number of its word, and a bracket that belongs to no function is `#`, a function
//! that marks its content as a whole. It applies a sign before any operation of two operands, and `^` from left to
//! right; [`Tree::power`] turns both round, down to what is marked as a whole.

use std::fmt::Write;
use std::str::FromStr;

use exmex::{
    BinOp, ExResult, Express, FlatEx, MakeOperators, MatchLiteral, Operator, literal_matcher_from_pattern,
};
use shape::{Function, Op};

use super::scan::{Kind, Word};

/// A formula or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tree {
    /// The operand of this number among the words.
    Word(usize),
    /// What stood in brackets.
    Whole(Box<Tree>),
    /// Under a function, or with its sign changed.
    Under(Op, Box<Tree>),
    /// Sum, difference, product, quotient.
    Join(Op, Box<Tree>, Box<Tree>),
    /// Base and exponent.
    Power(Box<Tree>, Box<Tree>),
}

impl Default for Tree {
    fn default() -> Tree {
        Tree::Word(0)
    }
}

impl FromStr for Tree {
    type Err = std::num::ParseIntError;

    fn from_str(text: &str) -> Result<Tree, Self::Err> {
        text.trim_start_matches('$').parse().map(Tree::Word)
    }
}

impl Tree {
    fn under(self, op: Op) -> Tree {
        Tree::Under(op, Box::new(self))
    }

    fn apply(self, function: Function) -> Tree {
        self.under(Op::Apply(function))
    }

    fn join(op: Op, left: Tree, right: Tree) -> Tree {
        Tree::Join(op, Box::new(left), Box::new(right))
    }

    /// A power, before the sign of its base, and after the powers in its exponent.
    fn power(self, exponent: Tree) -> Tree {
        match self {
            Tree::Under(Op::Neg, base) => base.power(exponent).under(Op::Neg),
            Tree::Power(base, first) => Tree::Power(base, Box::new(first.power(exponent))),
            base => Tree::Power(Box::new(base), Box::new(exponent)),
        }
    }
}

literal_matcher_from_pattern!(Operand, r"^\$[0-9]+");

#[derive(Clone, Debug)]
struct Operations;

impl MakeOperators<Tree> for Operations {
    fn make<'a>() -> Vec<Operator<'a, Tree>> {
        let binary = |apply: fn(Tree, Tree) -> Tree, prio| BinOp { apply, prio, is_commutative: false };
        vec![
            Operator::make_bin_unary("+", binary(|a, b| Tree::join(Op::Add, a, b), 0), |a| a),
            Operator::make_bin_unary("-", binary(|a, b| Tree::join(Op::Sub, a, b), 0), |a| a.under(Op::Neg)),
            Operator::make_bin("*", binary(|a, b| Tree::join(Op::Mul, a, b), 1)),
            Operator::make_bin("/", binary(|a, b| Tree::join(Op::Div, a, b), 1)),
            Operator::make_bin("^", binary(Tree::power, 2)),
            Operator::make_unary("#", |a| Tree::Whole(Box::new(a))),
            Operator::make_unary("sqrt", |a| a.apply(Function::Sqrt)),
            Operator::make_unary("exp", |a| a.apply(Function::Exp)),
            Operator::make_unary("ln", |a| a.apply(Function::Ln)),
            Operator::make_unary("sin", |a| a.apply(Function::Sin)),
            Operator::make_unary("cos", |a| a.apply(Function::Cos)),
            Operator::make_unary("tan", |a| a.apply(Function::Tan)),
            Operator::make_unary("asin", |a| a.apply(Function::Asin)),
            Operator::make_unary("acos", |a| a.apply(Function::Acos)),
            Operator::make_unary("atan", |a| a.apply(Function::Atan)),
            Operator::make_unary("sinh", |a| a.apply(Function::Sinh)),
            Operator::make_unary("cosh", |a| a.apply(Function::Cosh)),
            Operator::make_unary("tanh", |a| a.apply(Function::Tanh)),
        ]
    }
}

/// The tree of words that `scan` has passed.
pub(super) fn grow(words: &[Word]) -> ExResult<Tree> {
    let mut text = String::new();
    let mut function = false;
    for (index, word) in words.iter().enumerate() {
        let written = match word.kind {
            Kind::Operand(_) => write!(text, "${index} "),
            Kind::Function(name) => write!(text, "{name}"),
            Kind::Sign('(') if !function => write!(text, "#("),
            Kind::Sign(sign) => write!(text, "{sign}"),
        };
        debug_assert!(written.is_ok(), "a String takes any text");
        function = matches!(word.kind, Kind::Function(_));
    }
    FlatEx::<Tree, Operations, Operand>::parse_wo_compile(&text)?.eval(&[])
}
