//! Values: operators, functions, numbers.

use super::recorded::{blamed, messages, value};
use proptest::prelude::*;

#[test]
fn operators_of_one_rank_go_from_left_to_right() {
    for (expression, expected) in [
        ("[2+3*4]", "14.000000"),
        ("[2**3**2]", "64.000000"),
        ("[7 mod 4 * 2]", "6.000000"),
        ("[-2**2]", "4.000000"),
        ("[3 gt 2 gt 1]", "0.000000"),
        ("[1 or 1 and 0]", "0.000000"),
        ("[5 eq 2+3]", "1.000000"),
        ("[2-3+4*5/2-1]", "8.000000"),
        ("[4*-2]", "-8.000000"),
        ("--3", "3.000000"),
        ("-[1+1]", "-2.000000"),
    ] {
        assert_eq!(value(expression), expected, "{expression}");
    }
}

#[test]
fn functions_take_degrees_and_round_as_they_say() {
    for (expression, expected) in [
        ("sin[30]", "0.500000"),
        ("ATAN[1]/[-1]", "135.000000"),
        ("atan[-2]/[-2]", "-135.000000"),
        ("fix[-2.8]", "-3.000000"),
        ("fup[-2.2]", "-2.000000"),
        ("round[-2.5]", "-3.000000"),
        ("exp[ln[7]]", "7.000000"),
        ("[acos[0.5]+asin[0.5]]", "90.000000"),
        ("exists[#<nothing>]", "0.000000"),
        ("exists[#<_x>]", "1.000000"),
        ("exists[#100]", "1.000000"),
        ("exists[#[5600+50]]", "0.000000"),
        ("[-1 mod 4]", "3.000000"),
        ("t a n [ 4 5 ]", "1.000000"),
        ("fix[tan[45]]", "1.000000"),
        ("fix[100*sin[30]]", "50.000000"),
        ("fup[10*cos[60]]", "5.000000"),
        ("[cos[90] lt 0]", "1.000000"),
    ] {
        assert_eq!(value(expression), expected, "{expression}");
    }
}

#[test]
fn numbers_near_each_other_are_equal() {
    assert_eq!(value("[0.1+0.2 eq 0.3]"), "1.000000");
    assert_eq!(value("[1 eq 1.001]"), "0.000000");
    assert_eq!(value("[1 ne 1.0000009]"), "0.000000");
    assert_eq!(value("[1 ge 1.0000009]"), "1.000000");
    assert_eq!(value("[1.0000009 gt 1]"), "1.000000", "GT and LT are exact");
}

#[test]
fn what_has_no_value_is_refused_where_it_stands() {
    for (text, code, blamed_bytes) in [
        ("G0 X[1/0]", "arithmetic", "1/0"),
        ("G0 X[2+3*4", "missing-bracket", "[2+3*4"),
        ("G0 Xsqrt[-4]", "arithmetic", "sqrt[-4]"),
        ("G0 Xfoo[4]", "unknown-function", "foo"),
        ("G0 X[1 2 % 3]", "unknown-operator", "%"),
        ("G0 X[[0-1]**0.5]", "arithmetic", "[0-1]**0.5"),
        ("G0 X1.2.3", "bad-number", "1.2.3"),
        ("G0 X.", "bad-number", "."),
        ("G0 Y Z3", "missing-value", "Z"),
        ("G0 X", "missing-value", ""),
        ("G0 Xatan[1]", "missing-value", ""),
        ("G0 X#0", "bad-parameter", "#0"),
        ("G0 X#1.5", "bad-parameter", "#1.5"),
        ("G0 X#<nothing>", "unknown-name", "#<nothing>"),
        ("G0 X#<nothing", "missing-bracket", "#<nothing"),
    ] {
        assert_eq!(blamed(text), (1, code, blamed_bytes.to_owned()), "{text}");
    }
}

#[test]
fn brackets_have_a_limit_that_is_named() {
    let deep = |depth: usize| format!("#1={}1{}\nM2", "[".repeat(depth), "]".repeat(depth));
    assert!(super::recorded::errors(&deep(60)).is_empty());
    let outcome = super::recorded::outcome(&deep(1000));
    assert_eq!(outcome.errors[0].code, "expression-too-deep");
    assert!(outcome.errors[0].message.contains("expression_depth"));
}

proptest! {
    /// A number means the f64 nearest to what is written, however it is written.
    #[test]
    fn numbers_are_read_as_the_standard_library_reads_them(text in "[0-9]{0,25}\\.?[0-9]{1,25}") {
        let outcome = super::recorded::outcome(&format!("#1={text}\nM2"));
        prop_assert_eq!(outcome.program.parameter(1), text.parse::<f64>().ok());
    }

    /// No text makes the reader fail in another way than by a diagnostic.
    #[test]
    fn any_expression_is_a_value_or_an_error(text in "[-+*/\\[\\]0-9. #<>a-z]{0,40}") {
        let outcome = super::recorded::outcome(&format!("#1={text}\nM2"));
        let value = outcome.program.parameter(1);
        prop_assert!(value.is_some_and(f64::is_finite));
    }
}

#[test]
fn all_values_of_a_line_are_those_before_it() {
    assert_eq!(messages("#1=5\n#1=6 #2=#1\n(debug,#1 #2)"), ["6.000000 5.000000"]);
}
