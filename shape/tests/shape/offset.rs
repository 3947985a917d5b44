//! The tool on a surface and beside a contour, against distances that are found by search, without any
//! derivative.

use proptest::prelude::*;
use shape::{Contour, Curve, Formula, Function, Leg, Op, Pattern, Side, Surface, Tool, Touch};

/// `a x + b y + c sin(x/p + q) cos(y/s)`: gentle enough for the tools below, steep enough never to be level
/// if `tilted`.
#[derive(Clone, Copy, Debug)]
struct Wave {
    a: f64,
    b: f64,
    c: f64,
    p: f64,
    q: f64,
    s: f64,
}

impl Wave {
    fn z(&self, x: f64, y: f64) -> f64 {
        let Wave { a, b, c, p, q, s } = *self;
        a * x + b * y + c * libm::sin(x / p + q) * libm::cos(y / s)
    }

    fn formula(&self) -> Formula {
        use Op::{Add, Apply, Constant, Div, Mul, Variable};
        let Wave { a, b, c, p, q, s } = *self;
        let (x, y) = (Variable(0), Variable(1));
        let plane = [Constant(a), x, Mul, Constant(b), y, Mul, Add];
        let sine = [x, Constant(p), Div, Constant(q), Add, Apply(Function::Sin)];
        let cosine = [y, Constant(s), Div, Apply(Function::Cos)];
        let wave = [&[Constant(c)][..], &sine, &[Mul], &cosine, &[Mul, Add]].concat();
        Formula::new(&[&plane[..], &wave].concat()).expect("it is a formula")
    }
}

fn wave(tilted: bool) -> impl Strategy<Value = Wave> {
    let tilt = if tilted { 0.5..1.5 } else { -1.0..1.0 };
    (tilt, -1.0..1.0, -2.0..2.0, 14.0..30.0, 0.0..6.0, 14.0..30.0).prop_map(|(a, b, c, p, q, s)| Wave {
        a,
        b,
        c,
        p,
        q,
        s,
    })
}

fn pattern() -> impl Strategy<Value = Pattern> {
    prop_oneof![
        (any::<bool>(), 2..9_u32, any::<bool>()).prop_map(|(along_y, count, zigzag)| Pattern::Lines {
            along_y,
            count,
            zigzag
        }),
        (1..7_u32).prop_map(|count| Pattern::Rings { count }),
        Just(Pattern::Curve { t: [0.0, 6.0] }),
    ]
}

/// Least value of a function near a place, by a net that is drawn together.
fn least(f: impl Fn(f64, f64) -> f64, [mut x, mut y]: [f64; 2], mut reach: f64) -> f64 {
    let mut best = f(x, y);
    while reach > 1e-11 {
        let (x0, y0) = (x, y);
        for i in -4..=4 {
            for j in -4..=4 {
                let (u, v) = (x0 + reach * f64::from(i) / 4.0, y0 + reach * f64::from(j) / 4.0);
                let value = f(u, v);
                if value < best {
                    (best, x, y) = (value, u, v);
                }
            }
        }
        reach *= 0.6;
    }
    best
}

/// Distance of a point of the surface from the disc that a ball of the radius of the corner goes round.
fn from_core(tool: &Tool, tip: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    let beside = (libm::hypot(x - tip[0], y - tip[1]) - (tool.radius_mm - tool.corner_mm)).max(0.0);
    libm::hypot(beside, z - tip[2] - tool.corner_mm)
}

/// x(t) and y(t) of a curve within the domain.
fn plan() -> [Formula; 2] {
    use Op::{Add, Apply, Constant, Mul, Variable};
    [(12.0, Function::Sin, 0.0), (9.0, Function::Cos, 1.0)].map(|(radius, function, middle)| {
        let ops = [Variable(0), Apply(function), Constant(radius), Mul, Constant(middle), Add];
        Formula::new(&ops).expect("it is a formula")
    })
}

/// Every leg of a pattern at some places: the tool touches the surface there, and nowhere else nearby.
fn touches(wave: Wave, tool: Tool, pattern: Pattern) {
    let surface = Surface { x: [-16.0, 17.0], y: [-14.0, 12.0], tool, pattern, clear_mm: 50.0 };
    let (psi, [x, y]) = (wave.formula(), plan());
    let legs = (0..surface.legs()).map(|leg| surface.leg(leg).expect("there are so many"));
    for leg in legs {
        let plan = match leg {
            Leg::Cut(plan) => plan,
            Leg::Air { to } => {
                assert!(surface.tip(&psi, to).iter().all(|one| one.is_finite()));
                continue;
            }
        };
        let curve = surface.curve(plan, [&psi, &x, &y]);
        let [from, to] = plan.t();
        for share in [0.0, 0.37, 1.0] {
            let t = from + share * (to - from);
            let point = curve.at(t);
            let contact = curve.contact(t).map(|axis| axis.value());
            let tip = point.tip.map(|axis| axis.value());
            let gap = |x: f64, y: f64| from_core(&tool, tip, [x, y, wave.z(x, y)]);
            let distance = least(gap, contact, 0.5 * tool.radius_mm);
            let apart = (distance - tool.corner_mm).abs();
            assert!(apart < 1e-9, "{apart} at {contact:?}: {wave:?} {tool:?} {pattern:?}");
            // Nothing of the surface stands up into the tool.
            let above = |x: f64, y: f64| {
                let height = tool.height(libm::hypot(x - tip[0], y - tip[1]));
                height.map_or(f64::INFINITY, |height| tip[2] + height - wave.z(x, y))
            };
            let inside = [0, 1].map(|i| contact[i] + 1e-6 * (tip[i] - contact[i]));
            assert!(least(above, inside, tool.radius_mm) > -1e-9, "{contact:?}: {wave:?} {tool:?}");
            // The series is the path beside that place.
            let h = 1e-3;
            for (axis, beside) in point.tip.iter().zip(curve.at(t + h).tip) {
                assert!((axis.at(h) - beside.value()).abs() < 1e-9, "{axis:?} {beside:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn m87_a_ball_stands_on_the_surface(wave in wave(false), radius_mm in 0.5..6.0, pattern in pattern()) {
        touches(wave, Tool { radius_mm, corner_mm: radius_mm }, pattern);
    }

    #[test]
    fn m87_a_bull_nose_stands_on_the_surface(
        wave in wave(true), radius_mm in 1.0..4.0, corner in 0.1..0.9, pattern in pattern()
    ) {
        prop_assume!(wave.c.abs() < 1.0);
        touches(wave, Tool { radius_mm, corner_mm: corner * radius_mm }, pattern);
    }

    #[test]
    fn m87_a_flat_end_stands_on_the_surface(wave in wave(true), radius_mm in 1.0..4.0, pattern in pattern()) {
        prop_assume!(wave.c.abs() < 1.0);
        touches(wave, Tool { radius_mm, corner_mm: 0.0 }, pattern);
    }

    #[test]
    fn m88_the_centre_is_a_radius_beside_the_contour(
        wave in wave(false), radius_mm in 0.1..8.0, forwards in any::<bool>(), left in any::<bool>()
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let x = if forwards { [-20.0, 20.0] } else { [20.0, -20.0] };
        let contour = Contour { x, radius_mm, side };
        let f = wave.formula();
        for x in [-20.0, -3.3, 0.0, 11.0, 20.0] {
            let [cx, cy] = contour.curve(&f).at(x).axes.map(|axis| axis.value());
            let distance = least(|u, _| libm::hypot(u - cx, wave.z(u, 0.0) - cy), [x, 0.0], radius_mm);
            prop_assert!((distance - radius_mm).abs() < 1e-9);
            prop_assert_eq!(cy > wave.z(cx, 0.0), forwards == left, "on the wrong side");
        }
    }

    #[test]
    fn m89_curvatures_are_those_of_spheres_and_planes(
        radius in 20.0..90.0, x in -9.0..9.0, y in -9.0..9.0, angle in 0.0..6.0, tool_radius in 1.0..9.0
    ) {
        use Op::{Apply, Constant, Mul, Neg, Sub, Variable};
        let (u, v) = (Variable(0), Variable(1));
        let below = [Constant(radius * radius), u, u, Mul, Sub, v, v, Mul, Sub, Apply(Function::Sqrt)];
        let ball = Tool { radius_mm: tool_radius, corner_mm: tool_radius };
        let along = [libm::cos(angle), libm::sin(angle)];
        for (bowl, bends) in [(false, -1.0 / radius), (true, 1.0_f64 / radius)] {
            let ops = if bowl { [&below[..], &[Neg]].concat() } else { below.to_vec() };
            let touch = Touch::at(&Formula::new(&ops).expect("it is a formula"), [x, y]);
            prop_assert!(f64::abs(touch.hollow() - bends) < 1e-12);
            let parting = touch.parting(&ball, along);
            prop_assert!(f64::abs(parting.ridge() - (1.0 / tool_radius - bends)) < 1e-12);
            prop_assert!(!parting.gouges());
            let large = Tool { radius_mm: 1.01 * radius, corner_mm: 1.01 * radius };
            prop_assert_eq!(touch.parting(&large, along).gouges(), bowl);
            prop_assert!((parting.height(parting.distance(0.01)) - 0.01).abs() < 1e-12);
        }
    }
}

#[test]
fn patterns_go_from_border_to_border_without_a_gap() {
    let tool = Tool { radius_mm: 1.0, corner_mm: 1.0 };
    let (x, y) = ([-3.0, 7.0], [2.0, 6.0]);
    let patterns = [
        Pattern::Lines { along_y: false, count: 5, zigzag: true },
        Pattern::Lines { along_y: true, count: 2, zigzag: true },
        Pattern::Rings { count: 3 },
    ];
    for pattern in patterns {
        let surface = Surface { x, y, tool, pattern, clear_mm: 0.0 };
        let mut at = None;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for leg in 0..surface.legs() {
            let Some(Leg::Cut(shape::Plan::Line { from, to })) = surface.leg(leg) else { panic!("a line") };
            assert!(at.is_none_or(|at| at == from), "{pattern:?}, leg {leg}: {at:?} {from:?}");
            assert_ne!(from, to, "{pattern:?}, leg {leg}");
            for point in [from, to] {
                (low, high) = ([0, 1].map(|i| low[i].min(point[i])), [0, 1].map(|i| high[i].max(point[i])));
            }
            at = Some(to);
        }
        assert_eq!((low, high), ([x[0], y[0]], [x[1], y[1]]), "{pattern:?}");
        assert_eq!(surface.leg(surface.legs()), None);
    }
}

#[test]
fn one_way_lines_are_joined_through_the_air_and_rings_of_a_square_end_in_a_point() {
    let tool = Tool { radius_mm: 1.0, corner_mm: 1.0 };
    let one_way = Pattern::Lines { along_y: false, count: 3, zigzag: false };
    let surface = Surface { x: [0.0, 4.0], y: [0.0, 4.0], tool, pattern: one_way, clear_mm: 0.0 };
    assert_eq!(surface.leg(1), Some(Leg::Air { to: [0.0, 2.0] }));
    let square = Surface { pattern: Pattern::Rings { count: 2 }, ..surface };
    assert_eq!(square.legs(), 10);
    assert_eq!(square.leg(9), Some(Leg::Cut(shape::Plan::Line { from: [1.0, 1.0], to: [2.0, 2.0] })));
}
