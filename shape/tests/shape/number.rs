//! Series, gradients and formulas against closed forms, finite differences and each other.

use proptest::prelude::*;
use shape::{Formula, FormulaError, Function, Gradient, Number, Op, Series, length};

/// A place inside the domain of a function, from a number 0 … 1.
fn inside(function: Function, at: f64) -> f64 {
    match function {
        Function::Sqrt | Function::Ln => 0.2 + 4.0 * at,
        Function::Asin | Function::Acos => 1.8 * at - 0.9,
        Function::Tan => 2.6 * at - 1.3,
        _ => 4.0 * at - 2.0,
    }
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs()))
}

/// Coefficients of a function at u by its derivatives, written down one by one.
fn closed_form(function: Function, u: f64) -> [f64; 4] {
    let (s, c) = libm::sincos(u);
    let (sh, ch) = (libm::sinh(u), libm::cosh(u));
    let w = 1.0 - u * u;
    let asin = [1.0 / libm::sqrt(w), u / libm::pow(w, 1.5), (1.0 + 2.0 * u * u) / libm::pow(w, 2.5)];
    let [d1, d2, d3] = match function {
        Function::Sqrt => [0.5 * libm::pow(u, -0.5), -0.25 * libm::pow(u, -1.5), 0.375 * libm::pow(u, -2.5)],
        Function::Exp => [libm::exp(u); 3],
        Function::Ln => [1.0 / u, -1.0 / (u * u), 2.0 / (u * u * u)],
        Function::Sin => [c, -s, -c],
        Function::Cos => [-s, -c, s],
        Function::Tan => [1.0 / (c * c), 2.0 * s / (c * c * c), (2.0 + 4.0 * s * s) / (c * c * c * c)],
        Function::Asin => asin,
        Function::Acos => asin.map(|d| -d),
        Function::Atan => {
            let q = 1.0 + u * u;
            [1.0 / q, -2.0 * u / (q * q), (6.0 * u * u - 2.0) / (q * q * q)]
        }
        Function::Sinh => [ch, sh, ch],
        Function::Cosh => [sh, ch, sh],
        Function::Tanh => {
            [1.0 / (ch * ch), -2.0 * sh / (ch * ch * ch), (4.0 * sh * sh - 2.0) / (ch * ch * ch * ch)]
        }
    };
    [u.apply(function), d1, d2, d3]
}

#[test]
fn every_function_has_the_derivatives_of_its_closed_form() {
    for function in Function::ALL {
        for at in 0..=200 {
            let u = inside(function, f64::from(at) / 200.0);
            let series = Series::variable(u).apply(function);
            let known = closed_form(function, u);
            for (n, d) in known.iter().enumerate() {
                assert!(close(series.derivative(n), *d, 1e-12), "{function:?} at {u}, derivative {n}");
            }
            let [x, _] = Gradient::variables(Series::variable(u), Series::constant(0.0));
            let slope = x.apply(function).x;
            for n in 0..3 {
                assert!(close(slope.derivative(n), known[n + 1], 1e-11), "{function:?} at {u}, gradient {n}");
            }
        }
    }
}

#[test]
fn outside_of_its_domain_a_function_is_not_finite_and_says_so() {
    for (function, u) in
        [(Function::Sqrt, -1.0), (Function::Ln, -0.1), (Function::Asin, 1.1), (Function::Acos, -1.1)]
    {
        assert!(!u.apply(function).is_finite());
        assert!(!Series::variable(u).apply(function).is_finite());
    }
    // A root exists at 0, its slope does not.
    assert!(!Series::variable(0.0).sqrt().is_finite());
    assert!(!(Series::variable(1.0) / Series::constant(0.0)).is_finite());
}

#[test]
fn powers_exist_at_zero_with_their_derivatives() {
    for n in 0..6 {
        let mut wanted = [0.0; 4];
        if let Some(c) = wanted.get_mut(n) {
            *c = 1.0;
        }
        assert_eq!(Series::variable(0.0).powi(i32::try_from(n).unwrap()).0, wanted);
    }
    assert!(close(2.0_f64.powi(-3), 0.125, 0.0));
    assert!(!Series::variable(0.0).powi(-1).is_finite());
    assert!(Number::powi(1.0, i32::MIN).is_finite());
}

/// A series with a value and a slope in sensible ranges.
fn series() -> impl Strategy<Value = Series> {
    prop::array::uniform4(-2.0..2.0_f64).prop_map(Series)
}

proptest! {
    #[test]
    fn division_undoes_a_product(a in series(), b in series()) {
        prop_assume!(b.value().abs() > 0.3);
        let back = a * b / b;
        for (c, wanted) in back.0.iter().zip(a.0) {
            prop_assert!(close(*c, wanted, 1e-9));
        }
    }

    #[test]
    fn functions_and_their_inverses_give_the_parameter_back(a in series()) {
        let small = Series([a.value() * 0.5, a.0[1], a.0[2], a.0[3]]);
        let pairs = [
            (Function::Exp, Function::Ln), (Function::Sin, Function::Asin), (Function::Tan, Function::Atan),
        ];
        for (forth, back) in pairs {
            let same = small.apply(forth).apply(back);
            for (c, wanted) in same.0.iter().zip(small.0) {
                prop_assert!(close(*c, wanted, 1e-8), "{forth:?} {back:?}: {same:?} {small:?}");
            }
        }
    }

    #[test]
    fn m83_a_reversed_series_undoes_its_series(a in series()) {
        prop_assume!(a.0[1].abs() > 0.2);
        let same = Series([0.0, a.0[1], a.0[2], a.0[3]]).of(a.reversed());
        for (c, wanted) in same.0.iter().zip([0.0, 1.0, 0.0, 0.0]) {
            prop_assert!(close(*c, wanted, 1e-9), "{same:?}");
        }
    }

    #[test]
    fn angle_and_distance_of_a_point_give_the_point_back(x in series(), y in series()) {
        prop_assume!(libm::hypot(x.value(), y.value()) > 0.3);
        let (r, angle) = (x.hypot(y), y.atan2(x));
        prop_assert!(close(angle.value(), libm::atan2(y.value(), x.value()), 1e-15));
        let (across, along) = (r * angle.apply(Function::Sin), r * angle.apply(Function::Cos));
        for n in 0..4 {
            prop_assert!(close(along.0[n], x.0[n], 1e-9) && close(across.0[n], y.0[n], 1e-9));
        }
    }

    #[test]
    fn by_its_length_a_curve_has_speed_1(curve in prop::array::uniform3(series())) {
        let speed = curve.iter().map(|axis| axis.0[1] * axis.0[1]).sum::<f64>();
        prop_assume!(speed > 0.1);
        let t = length(&curve).reversed();
        let slopes = curve.map(|axis| axis.of(t).slope());
        let square = slopes.iter().fold(Series::default(), |sum, slope| sum + *slope * *slope);
        for (c, wanted) in square.0.iter().zip([1.0, 0.0, 0.0]) {
            prop_assert!(close(*c, wanted, 1e-8), "{square:?}");
        }
    }

    #[test]
    fn a_gradient_of_series_is_what_differences_find(x in -1.5..1.5_f64, y in -1.5..1.5_f64) {
        // Through (x, y) in the direction (1, 0.5), of 0.02 x² + 8 sin(x/1.5) cos(y/2) + sqrt(4 + x y).
        let wave = |x: f64, y: f64| {
            0.02 * x * x + 8.0 * libm::sin(x / 1.5) * libm::cos(y / 2.0) + libm::sqrt(4.0 + x * y)
        };
        let along = [Series([x, 1.0, 0.0, 0.0]), Series([y, 0.5, 0.0, 0.0])];
        let [gx, gy] = Gradient::variables(along[0], along[1]);
        let c = Gradient::constant;
        let psi = c(0.02) * gx.powi(2)
            + c(8.0) * (gx / c(1.5)).apply(Function::Sin) * (gy / c(2.0)).apply(Function::Cos)
            + (c(4.0) + gx * gy).sqrt();
        let h = 1e-3;
        let central = |f: &dyn Fn(f64) -> f64| [
            (f(h) - f(-h)) / (2.0 * h),
            (f(h) - 2.0 * f(0.0) + f(-h)) / (h * h),
        ];
        let [first, second] = central(&|h| wave(x + h, y + 0.5 * h));
        prop_assert!(close(psi.value.derivative(1), first, 1e-5) && close(psi.value.derivative(2), second, 1e-5));
        let [by_x, _] = central(&|h| wave(x + h, y));
        let [by_y, _] = central(&|h| wave(x, y + h));
        prop_assert!(close(psi.x.value(), by_x, 1e-5) && close(psi.y.value(), by_y, 1e-5));
        // The slope along the path is that of both partial derivatives, in every order.
        let chain = psi.x + psi.y * 0.5;
        for n in 0..3 {
            prop_assert!(close(psi.value.slope().0[n], chain.0[n], 1e-12));
        }
    }

    #[test]
    fn any_bytes_are_a_formula_that_can_be_evaluated_or_none(
        codes in prop::collection::vec(prop_oneof![0_u8..30, 120_u8..=255, any::<u8>()], 0..110),
        constants in prop::collection::vec(any::<f64>(), 0..40),
    ) {
        if let Ok(formula) = Formula::decode(&codes, &constants) {
            let (codes, constants) = formula.encode();
            prop_assert_eq!(Formula::decode(&codes, &constants), Ok(formula));
            let whole: Gradient<Series> = formula.eval([Gradient::constant(0.5); 2]);
            let value = formula.eval([0.5_f64; 2]);
            prop_assert!(whole.value.value() == value || (whole.value.value().is_nan() && value.is_nan()));
        }
    }

    #[test]
    fn any_operations_are_a_formula_that_comes_back_or_none(ops in prop::collection::vec(op(), 0..40)) {
        // Completed to one value, so that most of them are formulas.
        let mut whole = vec![Op::Variable(0)];
        for op in ops {
            if matches!(op, Op::Add | Op::Sub | Op::Mul | Op::Div) {
                whole.push(Op::Constant(1.5));
            }
            if !matches!(op, Op::Constant(_) | Op::Variable(_)) {
                whole.push(op);
            }
        }
        match Formula::new(&whole) {
            Ok(formula) => {
                prop_assert!(formula.ops().eq(whole.iter().copied()));
                let text = serde_json::to_string(&formula).unwrap();
                prop_assert_eq!(serde_json::from_str::<Formula>(&text).unwrap(), formula);
                let series = formula.eval([Series::variable(0.7); 2]);
                let value = formula.eval([0.7; 2]);
                prop_assert!(series.value() == value || (series.value().is_nan() && value.is_nan()));
            }
            Err(error) => prop_assert!(matches!(error, FormulaError::TooLong | FormulaError::OutOfRange)),
        }
    }
}

fn op() -> impl Strategy<Value = Op> {
    prop_oneof![
        Just(Op::Add),
        Just(Op::Sub),
        Just(Op::Mul),
        Just(Op::Div),
        Just(Op::Neg),
        (-70..70).prop_map(Op::Powi),
        prop::sample::select(Function::ALL.to_vec()).prop_map(Op::Apply),
    ]
}

#[test]
fn what_is_no_formula_is_refused() {
    let error = |ops: &[Op]| Formula::new(ops).unwrap_err();
    assert_eq!(error(&[]), FormulaError::Incomplete);
    assert_eq!(error(&[Op::Add]), FormulaError::Incomplete);
    assert_eq!(error(&[Op::Variable(0), Op::Variable(1)]), FormulaError::Incomplete);
    assert_eq!(error(&[Op::Variable(2)]), FormulaError::OutOfRange);
    assert_eq!(error(&[Op::Constant(f64::NAN)]), FormulaError::OutOfRange);
    assert_eq!(error(&[Op::Variable(0), Op::Powi(64)]), FormulaError::OutOfRange);
    assert_eq!(error(&[Op::Variable(0); 17]), FormulaError::TooDeep);
    let sum = |n: usize, op: Op| {
        let mut ops = vec![op];
        ops.extend((1..n).flat_map(|_| [op, Op::Add]));
        Formula::new(&ops)
    };
    assert_eq!(sum(49, Op::Variable(0)).unwrap_err(), FormulaError::TooLong);
    assert_eq!(sum(33, Op::Constant(1.0)).unwrap_err(), FormulaError::TooLong);
    assert_eq!(sum(32, Op::Constant(1.0)).unwrap().eval([0.0; 2]), 32.0);
    // Behind the end there is nothing.
    assert_eq!(Formula::decode(&[2, 0, 2], &[]), Err(FormulaError::Incomplete));
    assert_eq!(Formula::decode(&[2, 0, 0], &[1.0]), Err(FormulaError::Incomplete));
    assert_eq!(Formula::decode(&[1], &[]), Err(FormulaError::OutOfRange));
    assert!(serde_json::from_str::<Formula>(r#"{"codes":[4],"constants":[]}"#).is_err());
    assert_eq!(Formula::default().eval([1.0; 2]), 0.0);
}
