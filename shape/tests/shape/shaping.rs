//! Ratios and curvature beyond the reference file: closed forms, orders of convergence, random curves and
//! surfaces, and the surface of the tip against numerical differentiation.

use proptest::prelude::*;
use shape::{
    Correction, Formula, Function, Op, Place, Section, Sections, Series, Tool, Touch, chord_feed, leader,
    radius, tangent_feed,
};

/// A circle of radius `r` as Y(X) left of its lowest point and right of it: Y = −(r² − X²)^½.
fn circle(r: f64, x: f64) -> (f64, Section) {
    let y = -(r * r - x * x).sqrt();
    let slope = -x / y;
    let second = -(1.0 + slope * slope) / y;
    (y, Section { slope, second, third: -3.0 * slope * second / y })
}

proptest! {
    #[test]
    fn on_a_circle_one_half_is_exact(r in 1.0..500.0_f64, at in -0.9..0.9_f64, step in -0.09..0.09_f64) {
        prop_assume!(step.abs() > 1e-3);
        let (x, h) = (at * r, step * r);
        let ((y, section), (next, _)) = (circle(r, x), circle(r, x + h));
        // With the arc s as the length of the step; M38 has that of the tangent, which is longer or shorter
        // by the second order.
        let s = r * (libm::asin((x + h) / r) - libm::asin(x / r));
        let m = section.exact_m(h, (next - y) / h) * 2.0 * section.turn(h) / (s * section.curvature());
        prop_assert!((m - 0.5).abs() < 1e-9, "{m}");
        prop_assert!((section.curvature() - 1.0 / r).abs() < 1e-12 / r);
    }

    #[test]
    fn a_section_is_that_of_the_curve_whatever_the_parameter(
        a in 0.2..5.0_f64, b in -2.0..2.0_f64, c in -2.0..2.0_f64, f in prop::array::uniform4(-3.0..3.0_f64),
    ) {
        // Y = f0 + f1 u + f2 u² + f3 u³ with u = X − X0 = a t + b t² + c t³.
        let composed = [
            f[0], f[1] * a, f[1] * b + f[2] * a * a, f[1] * c + 2.0 * f[2] * a * b + f[3] * a * a * a,
        ];
        let section = Section::of(&Series([7.0, a, b, c]), &Series(composed));
        let wanted = [f[1], 2.0 * f[2], 6.0 * f[3]];
        for (got, want) in [section.slope, section.second, section.third].into_iter().zip(wanted) {
            prop_assert!((got - want).abs() < 1e-8, "{got} {want}");
        }
    }

    #[test]
    fn the_tip_moves_on_the_surface_of_m93(
        x in -3.0..3.0_f64, y in -3.0..3.0_f64, corner in 0.2..0.6_f64, rest in prop::sample::select(vec![0.0, 0.3]),
    ) {
        let tool = Tool { radius_mm: corner + rest, corner_mm: corner };
        prop_assume!(rest == 0.0 || surface(x, y).level() > 0.25);
        let under = surface(x, y).under(&tool).expect("the surface is bent less than the tool");
        let tip = |x: f64, y: f64| tip(x, y, &tool);
        prop_assert!((under.z - tip(x, y)[2]).abs() < 1e-14);
        // Along two directions of the contact the tip moves along the tangent plane, and its gradient changes
        // by H.
        let d = 1e-5;
        for (dx, dy) in [(d, 0.0), (0.0, d)] {
            let (p, q) = (tip(x + dx, y + dy), tip(x - dx, y - dy));
            let (a, b) = (surface(x + dx, y + dy).slope, surface(x - dx, y - dy).slope);
            let way = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
            let [gx, gy] = under.slope;
            prop_assert!((way[2] - gx * way[0] - gy * way[1]).abs() < 1e-9 * d, "gradient");
            let [hxx, hxy, hyy] = under.second;
            let bend = [hxx * way[0] + hxy * way[1], hxy * way[0] + hyy * way[1]];
            for axis in 0..2 {
                prop_assert!((a[axis] - b[axis] - bend[axis]).abs() < 2e-6 * d, "{bend:?}");
            }
        }
    }

    #[test]
    fn a_step_keeps_its_leader_and_exact_keeps_all(step in prop::array::uniform3(-1.0..1.0_f64)) {
        let path = [Series([0.0, 1.0, 0.3, 0.0]), Series([0.0, -0.5, 0.1, 0.2]), Series([1.0, 0.7, 0.0, -0.1])];
        for surface in [None, Some(surface(0.4, 0.9))] {
            let place = Place { path, surface };
            for correction in Correction::ALL {
                let made = place.step(correction, step);
                prop_assert_eq!(made[leader(step)], step[leader(step)]);
                prop_assert!(made.iter().all(|way| way.is_finite()));
                if correction == Correction::Exact {
                    prop_assert!((0..3).all(|axis| (made[axis] - step[axis]).abs() < 1e-15));
                }
            }
        }
    }
}

/// Z = 0.1 X² − 0.05 XY + 0.4 sin(X + Y/2).
fn height(x: f64, y: f64) -> f64 {
    0.1 * x * x - 0.05 * x * y + 0.4 * libm::sin(x + 0.5 * y)
}

fn surface(x: f64, y: f64) -> Touch {
    let (sin, cos) = libm::sincos(x + 0.5 * y);
    Touch {
        z: height(x, y),
        slope: [0.2 * x - 0.05 * y + 0.4 * cos, -0.05 * x + 0.2 * cos],
        second: [0.2 - 0.4 * sin, -0.05 - 0.2 * sin, -0.1 * sin],
    }
}

/// Where the tip of a tool is that touches at (x, y).
fn tip(x: f64, y: f64, tool: &Tool) -> [f64; 3] {
    let [gx, gy] = surface(x, y).slope;
    let g = (gx * gx + gy * gy).sqrt();
    let w = (1.0 + g * g).sqrt();
    let rest = tool.radius_mm - tool.corner_mm;
    let aside = tool.corner_mm / w + if rest > 0.0 { rest / g } else { 0.0 };
    [x - aside * gx, y - aside * gy, height(x, y) + tool.corner_mm * (1.0 / w - 1.0)]
}

#[test]
fn the_surface_of_a_formula() {
    // The same surface as a formula, x and y being variables 0 and 1.
    let (x, y, constant) = (Op::Variable(0), Op::Variable(1), Op::Constant);
    let squares = [constant(0.1), x, Op::Powi(2), Op::Mul, constant(0.05), x, Op::Mul, y, Op::Mul, Op::Sub];
    let wave =
        [constant(0.4), x, constant(0.5), y, Op::Mul, Op::Add, Op::Apply(Function::Sin), Op::Mul, Op::Add];
    let formula = Formula::new(&[&squares[..], &wave].concat()).expect("a formula");
    assert!((formula.eval([0.7, -1.1]) - height(0.7, -1.1)).abs() < 1e-15);
    let (got, want) = (Touch::at(&formula, [0.7, -1.1]), surface(0.7, -1.1));
    let all = |at: &Touch| [&[at.z], &at.slope[..], &at.second].concat();
    assert!(
        all(&got).iter().zip(all(&want)).all(|(got, want)| (got - want).abs() < 1e-15),
        "{got:?} {want:?}"
    );
}

#[test]
fn a_tool_that_is_blunter_than_the_surface_does_not_fit() {
    let bowl = Touch { z: 0.0, slope: [0.0, 0.0], second: [0.5, 0.0, 0.1] };
    let ball = |radius_mm: f64| Tool { radius_mm, corner_mm: radius_mm };
    let fitted = bowl.under(&ball(1.0)).expect("a ball of 1 mm fits into a radius of 2 mm");
    // A radius of 2 mm becomes one of 1 mm, one of 10 mm one of 9 mm.
    assert!((fitted.second[0] - 1.0).abs() < 1e-15 && (fitted.second[2] - 1.0 / 9.0).abs() < 1e-15);
    for too_blunt in [2.5, 30.0] {
        assert_eq!(bowl.under(&ball(too_blunt)), None);
    }
}

#[test]
fn the_series_of_m_is_right_to_second_order() {
    let section = |x: f64| Section { slope: libm::exp(x), second: libm::exp(x), third: libm::exp(x) };
    let remainder = |h: f64| {
        let exact = (libm::exp(0.3 + h) - libm::exp(0.3)) / h;
        (section(0.3).exact_m(h, exact) - section(0.3).series_m(h)).abs()
    };
    let ratio = remainder(0.02) / remainder(0.01);
    assert!((3.8..4.2).contains(&ratio), "{ratio}");
    assert!((section(0.3).series_m(0.02) - 0.5).abs() > 1e-4, "the first-order term is not nothing");
}

/// Largest error of Z of the next point over a stretch of a path on `height`, with a step.
fn worst(correction: Correction, h: f64) -> f64 {
    let y = |x: f64| 0.3 + 0.6 * libm::sin(x);
    let steps = (2.0 / h) as usize;
    let error = |index: usize| {
        let x = h * index as f64;
        let Touch { slope, second, .. } = surface(x, y(x));
        let section = |slope, second| Section { slope, second, third: 0.0 };
        let sections = Sections {
            xoz: section(slope[0], second[0]),
            yoz: section(slope[1], second[2]),
            xoy: section(0.6 * libm::cos(x), -0.6 * libm::sin(x)),
            mixed: second[1],
        };
        let ways = [y(x + h) - y(x), height(x + h, y(x + h)) - height(x, y(x))];
        let [k1, k2] = sections.ratios(correction, h, ways);
        (height(x, y(x)) + k2 * h - height(x + h, y(x) + k1 * h)).abs()
    };
    (0..steps).map(error).fold(0.0, f64::max)
}

#[test]
fn orders_of_the_next_point() {
    // h² without the right signs or without the mixed term, h³ with both, rounding where it is exact.
    for (correction, order) in [
        (Correction::None, 2.0),
        (Correction::Published, 2.0),
        (Correction::PublishedSigns, 2.0),
        (Correction::Mixed, 3.0),
    ] {
        let found = libm::log2(worst(correction, 0.01) / worst(correction, 0.005));
        assert!((found - order).abs() < 0.1, "{correction:?}: {found}");
    }
    assert!(worst(Correction::Exact, 0.01) < 1e-14);
}

#[test]
fn curvature_in_space() {
    // A helix of radius 4 and 3 mm per radian: R = (4² + 3²)/4.
    let helix =
        [Series([4.0, 0.0, -2.0, 0.0]), Series([0.0, 4.0, 0.0, -4.0 / 6.0]), Series([0.0, 3.0, 0.0, 0.0])];
    assert!((radius(&helix) - 6.25).abs() < 1e-14);
    let straight = [Series([0.0, 1.0, 0.0, 0.0]), Series([0.0, 2.0, 0.0, 0.0]), Series([0.0; 4])];
    assert_eq!(radius(&straight), f64::INFINITY);
    // A chord of a circle lies δ within it; a step along its tangent ends δ beside it.
    let (r, delta, dt) = (10.0_f64, 0.01, 1e-3);
    let half = 0.5 * chord_feed(r - 0.5 * delta, delta, dt) * dt;
    assert!((r - (r * r - half * half).sqrt() - delta).abs() < 1e-14);
    let step = tangent_feed(r, delta, dt) * dt;
    assert!(((r * r + step * step).sqrt() - r - delta).abs() < 1e-5);
}

#[test]
fn on_a_surface_led_by_y_the_roles_are_swapped() {
    // Seen with X and Y exchanged, the same path on the same surface gives the same step.
    let surface = Touch { z: 0.0, slope: [0.2, -0.3], second: [0.05, 0.02, -0.04] };
    let swapped = Touch { z: 0.0, slope: [-0.3, 0.2], second: [-0.04, 0.02, 0.05] };
    let [x, y, z] =
        [Series([0.0, 0.4, 0.1, 0.0]), Series([0.0, 1.0, -0.2, 0.1]), Series([0.0, -0.22, 0.0, 0.0])];
    for correction in Correction::ALL {
        let one = Place { path: [x, y, z], surface: Some(surface) }.step(correction, [0.04, 0.1, -0.02]);
        let other = Place { path: [y, x, z], surface: Some(swapped) }.step(correction, [0.1, 0.04, -0.02]);
        assert_eq!(one, [other[1], other[0], other[2]], "{correction:?}");
    }
}
