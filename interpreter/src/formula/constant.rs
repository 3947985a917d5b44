//! Operations of which some are constants. What holds no variable is computed here, by the formula itself;
//! powers become products, roots, or exp and ln.

use shape::{Formula, Function, Op};

/// A power as operations; else what is wrong with it, and the remedy.
pub(super) fn power([base, exponent]: [Vec<Op>; 2]) -> Result<Vec<Op>, (String, String)> {
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
pub(super) fn fold(operations: Vec<Op>) -> Result<Vec<Op>, f64> {
    if operations.len() == 1 || operations.iter().any(|op| matches!(op, Op::Variable(_))) {
        return Ok(operations);
    }
    match Formula::new(&operations).map(|formula| formula.eval([0.0; 2])) {
        Ok(value) if value.is_finite() => Ok(vec![Op::Constant(value)]),
        Ok(value) => Err(value),
        Err(_) => Ok(operations),
    }
}
