//! Texts to formulas: what they mean, what is refused and where, and their derivatives against those that
//! exmex finds by symbols.

use exmex::{Differentiate, Express, FlatEx};
use interpreter::formula::{Misread, parse};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use shape::{Formula, Gradient, Number, Op, Series};

fn read(text: &str) -> Formula {
    parse(text, &["x", "y"]).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn value(text: &str) -> f64 {
    read(text).eval([3.0, 2.0])
}

fn refused(text: &str) -> Misread {
    parse(text, &["x", "y"]).expect_err(text)
}

#[test]
fn a_formula_means_what_it_means_on_paper() {
    for (text, wanted) in [
        ("-x^2", -9.0),
        ("(-x)^2", 9.0),
        ("-(x)^2", -9.0),
        ("2^3^2", 512.0),
        ("(2^3)^2", 64.0),
        ("2^-y", 0.25),
        ("2^-y^2", 0.0625),
        ("-2^-2", -0.25),
        ("2*-x^2", -18.0),
        ("x-y-1", 0.0),
        ("x-y+1", 2.0),
        ("12/x/y", 2.0),
        ("12/x*y", 8.0),
        ("x*12/y", 18.0),
        ("1+2*3^2", 19.0),
        ("x--y", 5.0),
        ("+x", 3.0),
        ("- - x", 3.0),
        (" \t x\n*y ", 6.0),
        ("X*Y", 6.0),
        ("((x))", 3.0),
        ("2*(x+y)*(x-y)", 10.0),
        ("-(x+y)^2*2", -50.0),
        ("1e3", 1000.0),
        ("2.5E-1*4", 1.0),
        ("1.e1+.5", 10.5),
        ("sqrt(x^2+16)", 5.0),
        ("-sqrt(x+1)^2", -4.0),
        ("sqrt(4)^3^2", 512.0),
        ("ln(e)", 1.0),
        ("pi-π", 0.0),
        ("cos(PI)", -1.0),
        ("(x+1)^0.5", 2.0),
        ("(x+1)^-1", 0.25),
        ("e^(y-2)", 1.0),
        ("x^y/9", 1.0),
        ("2", 2.0),
    ] {
        assert!((value(text) - wanted).abs() < 1e-14 * wanted.abs().max(1.0), "{text} = {}", value(text));
    }
}

#[test]
fn constants_are_computed_and_whole_powers_stay() {
    let ops = |text: &str| read(text).ops().collect::<Vec<_>>();
    assert_eq!(ops("2*3+sin(0)*4"), [Op::Constant(6.0)]);
    assert_eq!(ops("x^(1+1)"), [Op::Variable(0), Op::Powi(2)]);
    assert_eq!(ops("y^-1"), [Op::Variable(1), Op::Powi(-1)]);
    assert_eq!(ops("(2*3)*x"), [Op::Constant(6.0), Op::Variable(0), Op::Mul]);
    assert_eq!(ops("2^x").len(), 4);
    assert_eq!(ops("e^x").len(), 2);
    assert_eq!(ops("0.02*x^2 + 8*sin(x/15)*cos(y/20)").len(), 16);
}

#[test]
fn variables_are_those_that_are_named() {
    let formula = parse("t^2+1", &["t"]).unwrap();
    assert_eq!(formula.eval([2.0, 0.0]), 5.0);
    let error = parse("x+1", &["t"]).unwrap_err();
    assert_eq!((error.span, error.help.as_str()), (0..1, "the variable here is t; constants are pi and e"));
    assert_eq!(parse("5", &["t"]).unwrap().eval([0.0; 2]), 5.0);
}

#[test]
fn what_is_no_formula_is_refused_at_its_place_with_a_remedy() {
    for (text, span, message, help) in [
        ("", 0..0, "empty", "a number, a variable"),
        ("   ", 3..3, "empty", "a number, a variable"),
        ("2x", 1..2, "an operation is missing before x", "write 2*x"),
        ("x y", 2..3, "an operation is missing before y", "write x*y"),
        ("2(x+1)", 1..2, "missing before (", "write 2*("),
        ("(x)(y)", 3..4, "missing before (", "write )*("),
        ("x sin(y)", 2..5, "missing before sin", "write x*sin"),
        ("x+*y", 2..3, "something is missing before *", "a number, a variable"),
        ("x**2", 2..3, "something is missing before *", "powers are written with ^"),
        ("x+", 2..2, "ends too early", "a number, a variable"),
        ("sin x", 0..3, "the argument of sin needs brackets", "write sin(…)"),
        ("1+sin", 5..5, "ends too early", "a number, a variable"),
        ("sin()", 4..5, "something is missing before )", "a number"),
        ("(x+1", 0..1, "not closed", "close it"),
        ("x+1)", 3..4, "not opened", "open it"),
        ("[x]", 0..1, "not a bracket of a formula", "( and )"),
        ("0,02*x", 1..2, "no comma", "decimals have a point"),
        ("x+z", 2..3, "z is not known", "the variables here are x and y"),
        ("x2", 0..2, "x2 is not known", "the variables here are x and y"),
        ("2*abs(x)", 2..5, "the function abs has places without a tangent", "sqrt(u^2 + 1e-4)"),
        ("FLOOR(x)", 0..5, "the function floor has steps", "in parts"),
        ("min(x,y)", 0..3, "the function min has places without a tangent", "smooth"),
        ("log(x)", 0..3, "the function log is not known", "ln(u)"),
        ("atan2(x,y)", 0..5, "takes two arguments", "atan(u/v)"),
        ("x%2", 1..2, "remainder has steps", "parts"),
        ("1e999", 0..5, "not a number that a machine can hold", "decimal"),
        (".", 0..1, "not a number that a machine can hold", "decimal"),
        ("x^100", 0..5, "whole exponents go from -64 to 63", "(u^10)^10"),
        ("(-2)^x", 2..6, "needs a positive base", "whole exponent"),
        ("x+1/(2-2)", 2..8, "inf", "not by 0"),
        ("x+ln(-1)", 6..7, "NaN", "positive numbers"),
        ("x ² 2", 2..4, "not known here", "+ - * / ^"),
        ("x & y", 2..3, "'&' is not known here", "+ - * / ^"),
    ] {
        let error = refused(text);
        assert_eq!(error.span, span, "{text}: {error}");
        assert!(error.message.contains(message), "{text}: {error}");
        assert!(error.help.contains(help), "{text}: {error}");
    }
}

#[test]
fn hostile_texts_are_refused_and_no_more() {
    let nested = |depth: usize| format!("{}x{}", "(".repeat(depth), ")".repeat(depth));
    assert_eq!(read(&nested(64)).eval([3.0, 0.0]), 3.0);
    assert!(refused(&nested(65)).message.contains("64 brackets"));
    assert!(refused(&"x+".repeat(600)).message.contains("1200 characters"));
    assert!(refused(&format!("{}1", "x+".repeat(400))).message.contains("96 operations"));
    assert!(refused(&format!("{}x", "x^y^".repeat(100))).message.contains("96 operations"));
    assert_eq!(read(&format!("{}x", "-".repeat(90))).eval([3.0, 0.0]), 3.0);
    assert!(refused(&format!("{}x", "-".repeat(900))).message.contains("96 operations"));
    assert!(refused(&format!("{}x{}", "x+(".repeat(20), ")".repeat(20))).help.contains("fewer brackets"));
}

/// A smooth formula of x and y that exists wherever −1 ≤ x, y ≤ 1. Everything is in brackets, so both readers
/// agree.
fn smooth() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        Just("x".to_owned()),
        Just("y".to_owned()),
        (-30..30).prop_map(|c| format!("({:?})", f64::from(c) / 8.0)),
    ];
    leaf.prop_recursive(3, 16, 2, |inner| {
        let two = (inner.clone(), inner.clone());
        prop_oneof![
            (two.clone(), prop::sample::select(vec!["+", "-", "*"]))
                .prop_map(|((a, b), op)| format!("({a}{op}{b})")),
            two.clone().prop_map(|(a, b)| format!("({a}/(2+{b}*{b}))")),
            (inner.clone(), 0..5).prop_map(|(a, n)| format!("({a}^{n})")),
            inner.clone().prop_map(|a| format!("((1.5+sin({a}))^1.5)")),
            inner.clone().prop_map(|a| format!("(1+{a}*{a})^-1")).prop_map(|a| format!("({a})")),
            (inner.clone(), prop::sample::select(vec!["sin", "cos", "atan", "tanh"]))
                .prop_map(|(a, f)| format!("{f}({a})")),
            (inner.clone(), prop::sample::select(vec!["sinh", "cosh", "exp", "asin", "acos", "tan"]))
                .prop_map(|(a, f)| format!("{f}(tanh({a})/2)")),
            (inner, prop::sample::select(vec!["sqrt", "ln"]))
                .prop_map(|(a, f)| format!("{f}(1+({a})*({a}))")),
        ]
    })
}

/// The derivatives of `text` at a place: `orders` of x and of y, by symbols.
fn by_symbols(text: &str, orders: &[usize], [x, y]: [f64; 2]) -> Option<f64> {
    let mut expression = FlatEx::<f64>::parse(text).expect("exmex reads it");
    let names: Vec<String> = expression.var_names().to_vec();
    for order in orders {
        match names.iter().position(|name| *name == ["x", "y"][*order]) {
            Some(index) => expression = expression.partial(index).expect("it is smooth"),
            None => return Some(0.0),
        }
    }
    let place: Vec<f64> = names.iter().map(|name| if name == "x" { x } else { y }).collect();
    let value = expression.eval(&place).expect("both values are there");
    value.is_finite().then_some(value)
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-8 * (1.0 + a.abs().max(b.abs()))
}

/// Whether the derivatives of `text` at a place are those that are found by symbols.
fn agrees_with_symbols(text: &str, place: [f64; 2]) -> Result<(), TestCaseError> {
    let formula = match parse(text, &["x", "y"]) {
        Ok(formula) => formula,
        Err(error) => {
            prop_assert!(
                error.message.contains("96 operations") || error.message.contains("16 values"),
                "{error}"
            );
            return Ok(());
        }
    };
    let check = |found: f64, orders: &[usize]| {
        let wanted = by_symbols(text, orders, place);
        // By symbols some are 0/0 where they exist.
        prop_assert!(
            wanted.is_none_or(|wanted| close(found, wanted)),
            "{text} {orders:?}: {found} {wanted:?}"
        );
        Ok(())
    };
    check(formula.eval(place), &[])?;
    // Along x with y held, and the other way round: value and both slopes as series.
    for along in [0, 1] {
        let mut path = place.map(Series::constant);
        path[along] = Series::variable(place[along]);
        let psi = formula.eval(Gradient::variables(path[0], path[1]));
        for n in 1..=3 {
            check(psi.value.derivative(n), &vec![along; n])?;
        }
        for (by, slope) in [(0, psi.x), (1, psi.y)] {
            for n in 0..=2 {
                check(slope.derivative(n), &[vec![along; n], vec![by]].concat())?;
            }
        }
    }
    Ok(())
}

#[test]
fn gradients_and_series_are_the_derivatives_found_by_symbols() {
    let all = || {
        let config = ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() };
        let place = prop::array::uniform2(-1.0..1.0_f64);
        TestRunner::new(config)
            .run(&(smooth(), place), |(text, place)| agrees_with_symbols(&text, place))
            .unwrap();
    };
    // Third derivatives by symbols are deep expressions.
    let deep = std::thread::Builder::new().stack_size(1 << 28).spawn(all).unwrap();
    deep.join().unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_text_is_a_formula_or_refused_at_a_place_inside_of_it(text in any::<String>()) {
        if let Err(error) = parse(&text, &["x", "y"]) {
            prop_assert!(text.get(error.span).is_some() && !error.help.is_empty());
        }
    }

    #[test]
    fn any_words_are_a_formula_or_refused_at_a_place_inside_of_them(
        words in prop::collection::vec(prop::sample::select(vec![
            "x", "y", "1", "2.5e-1", "e", "π", "+", "-", "*", "/", "^", "(", ")", "sin(", "ln(", "abs", " ", ",", "#", "$1", "{x}",
        ]), 0..60),
    ) {
        let text = words.concat();
        match parse(&text, &["x", "y"]) {
            Ok(formula) => { let _: Series = formula.eval([Series::variable(0.5); 2]); }
            Err(error) => prop_assert!(text.get(error.span).is_some() && !error.help.is_empty()),
        }
    }
}
