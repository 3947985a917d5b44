//! The tree of a formula as operations. What holds no variable is computed here, by the formula itself.

use std::ops::Range;

use shape::{Formula, Function, Op};

use super::Misread;
use super::scan::{Kind, Word};
use super::tree::Tree;

/// The operations of `tree`, in the order of a formula.
pub(super) fn lower(tree: &Tree, words: &[Word]) -> Result<Vec<Op>, Misread> {
    let operations = match tree {
        Tree::Word(index) => match words.get(*index).map(|word| word.kind) {
            Some(Kind::Operand(op)) => vec![op],
            _ => vec![],
        },
        Tree::Whole(inside) => lower(inside, words)?,
        Tree::Under(op, inside) => [lower(inside, words)?, vec![*op]].concat(),
        Tree::Join(op, left, right) => [lower(left, words)?, lower(right, words)?, vec![*op]].concat(),
        Tree::Power(base, exponent) => {
            let parts = [lower(base, words)?, lower(exponent, words)?];
            power(parts).map_err(|(message, help)| Misread::new(place(tree, words), message, help))?
        }
    };
    fold(operations).map_err(|value| {
        let message = format!("this part of the formula is {value}, not a number");
        Misread::new(
            place(tree, words),
            message,
            "roots and logarithms are of positive numbers, quotients not by 0",
        )
    })
}

/// A power as operations; else what is wrong with it, and the remedy.
fn power([base, exponent]: [Vec<Op>; 2]) -> Result<Vec<Op>, (String, String)> {
    if let [Op::Constant(n)] = exponent.as_slice() {
        let n = *n;
        if n == 0.5 {
            return Ok([base, vec![Op::Apply(Function::Sqrt)]].concat());
        }
        if n == n.trunc() {
            let (least, most) = Formula::EXPONENTS.into_inner();
            if n < f64::from(least) || n > f64::from(most) {
                let message = format!("whole exponents go from {least} to {most}");
                return Err((message, "write it as a power of a power, such as (u^10)^10".into()));
            }
            #[expect(clippy::cast_possible_truncation, reason = "whole and small")]
            return Ok([base, vec![Op::Powi(n as i32)]].concat());
        }
    }
    if base == [Op::Constant(core::f64::consts::E)] {
        return Ok([exponent, vec![Op::Apply(Function::Exp)]].concat());
    }
    let ln = fold([base, vec![Op::Apply(Function::Ln)]].concat()).map_err(|_| {
        (
            "a power with such an exponent needs a positive base".into(),
            "only a whole exponent takes any base".into(),
        )
    })?;
    Ok([exponent, ln, vec![Op::Mul, Op::Apply(Function::Exp)]].concat())
}

/// Operations without a variable as their value; the value, if it is not finite.
fn fold(operations: Vec<Op>) -> Result<Vec<Op>, f64> {
    if operations.len() == 1 || operations.iter().any(|op| matches!(op, Op::Variable(_))) {
        return Ok(operations);
    }
    match Formula::new(&operations).map(|formula| formula.eval([0.0; 2])) {
        Ok(value) if value.is_finite() => Ok(vec![Op::Constant(value)]),
        Ok(value) => Err(value),
        Err(_) => Ok(operations),
    }
}

/// From the first to the last operand of a tree, bytes of the text.
fn place(tree: &Tree, words: &[Word]) -> Range<usize> {
    match tree {
        Tree::Word(index) => words.get(*index).map(|word| word.span.clone()).unwrap_or_default(),
        Tree::Whole(inside) | Tree::Under(_, inside) => place(inside, words),
        Tree::Join(_, first, last) | Tree::Power(first, last) => {
            place(first, words).start..place(last, words).end
        }
    }
}
