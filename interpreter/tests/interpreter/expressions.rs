//! Expressions: every operator and function, by the value an X word gets.

use protocol::{Axis, Code};

use crate::good;

fn value(expression: &str) -> f64 {
    let check = good(&format!("G0 X[[{expression}]+50]\nM2\n"));
    let Code::Line { target, .. } = check.items[0].code else { panic!("no line for {expression}") };
    target[Axis::X.index()].mm() - 50.0
}

#[test]
fn every_operator_and_its_precedence() {
    for (expression, expected) in [
        ("2+3*4", 14.0),
        ("2*3**2", 18.0),
        ("10-4-3", 3.0),
        ("100/5/2", 10.0),
        ("2**3**2", 64.0),
        ("7 mod 4 * 2", 6.0),
        ("1+2 gt 2*1", 1.0),
        ("3 lt 4 and 4 lt 5", 1.0),
        ("1 or 0 and 0", 0.0),
        ("1 xor 1 or 1", 1.0),
        ("5 eq 2+3", 1.0),
        ("[2+3]*[4-1]", 15.0),
        ("3 gt 2 gt 1", 0.0),
        ("2 ge 2", 1.0),
        ("2 le 1", 0.0),
        ("1 ne 1", 0.0),
        ("1 eq 1.00001", 1.0),
        ("1 ne 1.001", 1.0),
        ("0.5 and 2", 1.0),
        ("-1 xor 3", 0.0),
        ("-1 mod 4", 3.0),
        ("-5 mod -3", 1.0),
        ("5.5 mod 2", 1.5),
        ("2**-1", 0.5),
        ("0**0", 1.0),
        ("[0-8]**3/64", -8.0),
    ] {
        let got = value(&format!("[{expression}]*1"));
        assert!((got - expected).abs() < 2e-9, "{expression} = {got}, not {expected}");
    }
}

#[test]
fn every_function() {
    for (expression, expected) in [
        ("abs[-3.5]", 3.5),
        ("acos[0.5]", 60.0),
        ("asin[-.5]", -30.0),
        ("atan[-1]/[1]", -45.0),
        ("atan[5]/[0]/2", 45.0),
        ("cos[60]", 0.5),
        ("exp[1]", std::f64::consts::E),
        ("fix[-2.8]", -3.0),
        ("fup[-2.2]", -2.0),
        ("fup[2.2]", 3.0),
        ("ln[10]", std::f64::consts::LN_10),
        ("round[2.5]", 3.0),
        ("round[-2.5]", -3.0),
        ("S I N[30]", 0.5),
        ("sqrt[2]", std::f64::consts::SQRT_2),
        ("tan[45]", 1.0),
        ("-abs[-2]", -2.0),
        ("4*-2", -8.0),
        ("3--1", 4.0),
        ("3-+1", 2.0),
        ("-[3]-[-4]", 1.0),
    ] {
        let got = value(expression);
        assert!((got - expected).abs() < 2e-9, "{expression} = {got}, not {expected}");
    }
}

#[test]
fn a_word_takes_a_number_a_parameter_a_function_or_brackets() {
    let check = good("#1=3\nG0 X-[-#1] Z+#1\nX sqrt[16] Z-#1\nM2\n");
    assert_eq!(crate::listing(&check.items), "2 rapid X3 Z3\n3 rapid X4 Z-3\n4 end\n");
}
