//! How far a tool is from touching a surface. In: where its tip is, mm. Out: the deviation, mm, and where it
//! touches.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | ψ, g, H | mm | height of the surface at x, y; its gradient and Hessian |
//! | n | – | normal of the surface, upwards |
//! | t | mm | tip of the tool: its lowest point, on its axis |
//! | R, r | mm | radius of the tool and of its corner: r = R is a ball, r = 0 is flat |
//! | e | mm | from the point x, y of the surface to the middle of the corner that is nearest to it |
//! | d | mm | deviation: positive where the tool stands off, negative where it cuts too deep |
//!
//! ```text
//! e = t + r ẑ + (R − r) g/|g| − (x, y, ψ)
//! eₓ + e_z gₓ = 0,   e_y + e_z g_y = 0        e is normal to the surface                             (M96)
//! d = e·n − r
//! ```
//! For a ball that is the distance of its centre from the surface, less its radius. The two equations are
//! solved by Newton's method, from the contact of the cycle before: the parameter of the path has no part in
//! it, so what is early or late along the path is not an error of shape. An error δ in x, y makes one of
//! δ²/2r in d. A second contact elsewhere under the tool is found by looking for it every [`SEARCH`] cycles;
//! the one that cuts deepest counts.

use shape::{Formula, Gradient, Tool};

/// Most steps of Newton's method from one start.
const STEPS: usize = 20;
/// Residual that is good enough, mm: its square is far below a nanometre.
const RESIDUAL_MM: f64 = 1e-7;
/// A surface with less slope is level: the flat of a tool lies on it.
const LEVEL: f64 = 1e-9;
/// Directions in which a contact is searched for when there is none to start from, and now and then for a
/// deeper one.
const DIRECTIONS: u32 = 12;
/// How far from the tip, in radii of the tool.
const RINGS: [f64; 2] = [0.7, 0.95];
/// Cycles from one such search to the next.
const SEARCH: u32 = 32;

/// Where a tool touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touch {
    /// d.
    pub(super) deviation_mm: f64,
    /// x and y.
    pub(super) at: [f64; 2],
}

/// Measures a tool against a surface.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    formula: Formula,
    tool: Tool,
    last: Option<[f64; 2]>,
    /// Cycles since all contacts were looked for.
    since: u32,
}

/// One evaluation: what is left of the equations, and the step that Newton's method takes.
struct Trial {
    residual: f64,
    step: [f64; 2],
    /// Whether the point is nearer than those around it.
    nearest: bool,
    deviation_mm: f64,
}

impl Probe {
    pub(super) fn new(formula: Formula, tool: Tool) -> Probe {
        Probe { formula, tool, last: None, since: 0 }
    }

    /// Forgets where it was last.
    pub(super) fn lift(&mut self) {
        self.last = None;
    }

    /// Where a tool with this tip touches; `None` if no contact is found.
    pub(super) fn touch(&mut self, tip: [f64; 3]) -> Option<Touch> {
        self.since += 1;
        let near = self.last.and_then(|last| self.solve(tip, last));
        let touch = match near {
            Some(near) if self.since < SEARCH => Some(near),
            _ => {
                self.since = 0;
                let found = self.search(tip).into_iter().chain(near);
                found.min_by(|a, b| a.deviation_mm.total_cmp(&b.deviation_mm))
            }
        };
        self.last = touch.map(|touch| touch.at);
        touch
    }

    /// Looks for contacts from everywhere under the tool; the one that cuts deepest counts.
    fn search(&self, tip: [f64; 3]) -> Option<Touch> {
        let start = |share: f64, direction: u32| {
            let angle = core::f64::consts::TAU * f64::from(direction) / f64::from(DIRECTIONS);
            let reach = share * self.tool.radius_mm;
            [tip[0] + reach * libm::cos(angle), tip[1] + reach * libm::sin(angle)]
        };
        let rings = RINGS.into_iter().flat_map(|share| (0..DIRECTIONS).map(move |i| (share, i)));
        let starts = rings.map(|(share, i)| start(share, i)).chain([[tip[0], tip[1]]]);
        let touches =
            starts.filter_map(|start| self.solve(tip, start)).filter(|touch| self.reaches(tip, touch));
        touches.min_by(|a, b| a.deviation_mm.total_cmp(&b.deviation_mm))
    }

    /// Whether a contact lies under the tool.
    fn reaches(&self, tip: [f64; 3], touch: &Touch) -> bool {
        let off = libm::hypot(touch.at[0] - tip[0], touch.at[1] - tip[1]);
        off <= self.tool.radius_mm + touch.deviation_mm.abs() + 1e-6
    }

    fn solve(&self, tip: [f64; 3], start: [f64; 2]) -> Option<Touch> {
        let mut at = start;
        for _ in 0..STEPS {
            let trial = self.trial(tip, at);
            if trial.residual <= RESIDUAL_MM {
                let touch = Touch { deviation_mm: trial.deviation_mm, at };
                return trial.nearest.then_some(touch);
            }
            let length = libm::hypot(trial.step[0], trial.step[1]);
            let share = (0.5 * self.tool.radius_mm / length).min(1.0);
            at = [at[0] + share * trial.step[0], at[1] + share * trial.step[1]];
        }
        None
    }

    fn trial(&self, tip: [f64; 3], at: [f64; 2]) -> Trial {
        let Gradient { value: psi, x, y } = self.formula.eval(variables(at));
        let (value, g, bend) = (psi.value, [psi.x, psi.y], [[x.x, x.y], [y.x, y.y]]);
        let (slope, flat) = (libm::hypot(g[0], g[1]), self.tool.radius_mm - self.tool.corner_mm);
        let ahead = if slope > LEVEL { g.map(|part| part / slope) } else { [0.0; 2] };
        let e: [f64; 2] = core::array::from_fn(|i| tip[i] + flat * ahead[i] - at[i]);
        let up = tip[2] + self.tool.corner_mm - value;
        let left = [e[0] + up * g[0], e[1] + up * g[1]];
        // The flat of the tool turns with the gradient.
        let turn = if slope > LEVEL { flat / slope } else { 0.0 };
        let by = |i: usize, j: usize| {
            let one = if i == j { 1.0 } else { 0.0 };
            let across = |k: usize| if i == k { 1.0 - ahead[i] * ahead[k] } else { -ahead[i] * ahead[k] };
            let turned = turn * (across(0) * bend[0][j] + across(1) * bend[1][j]);
            turned - one - g[i] * g[j] + up * bend[i][j]
        };
        let [a, b, c, d] = [by(0, 0), by(0, 1), by(1, 0), by(1, 1)];
        let determinant = a * d - b * c;
        let normal = libm::sqrt(1.0 + slope * slope);
        Trial {
            residual: libm::hypot(left[0], left[1]),
            step: [(b * left[1] - d * left[0]) / determinant, (c * left[0] - a * left[1]) / determinant],
            nearest: determinant > 0.0 && a + d < 0.0,
            deviation_mm: (up - e[0] * g[0] - e[1] * g[1]) / normal - self.tool.corner_mm,
        }
    }
}

/// Both variables with first and second derivatives.
pub(super) fn variables([x, y]: [f64; 2]) -> [Gradient<Gradient<f64>>; 2] {
    let [x, y] = Gradient::variables(x, y);
    Gradient::variables(x, y)
}

#[cfg(test)]
mod tests {
    use super::Probe;
    use shape::{Formula, Function, Op, Tool};

    const BALL: Tool = Tool { radius_mm: 3.0, corner_mm: 3.0 };
    const BULL: Tool = Tool { radius_mm: 2.5, corner_mm: 1.5 };
    const FLAT: Tool = Tool { radius_mm: 1.0, corner_mm: 0.0 };

    /// `0.02 x² + 8 sin(x/15) cos(y/20)`.
    fn wave() -> Formula {
        let by = |variable, divisor, function| {
            [Op::Variable(variable), Op::Constant(divisor), Op::Div, Op::Apply(function)]
        };
        let mut ops = vec![Op::Constant(0.02), Op::Variable(0), Op::Powi(2), Op::Mul, Op::Constant(8.0)];
        ops.extend(by(0, 15.0, Function::Sin));
        ops.push(Op::Mul);
        ops.extend(by(1, 20.0, Function::Cos));
        ops.extend([Op::Mul, Op::Add]);
        Formula::new(&ops).expect("complete")
    }

    /// Where the tip is when the tool stands off by `d` over a point of the wave, by its gradient as one
    /// writes it down.
    fn tip(tool: Tool, [x, y]: [f64; 2], d: f64) -> [f64; 3] {
        let z = 0.02 * x * x + 8.0 * libm::sin(x / 15.0) * libm::cos(y / 20.0);
        let g = gradient([x, y]);
        let slope = libm::hypot(g[0], g[1]);
        let normal = (1.0 + slope * slope).sqrt();
        let off = tool.corner_mm + d;
        let flat = tool.radius_mm - tool.corner_mm;
        let across = |i: usize| -off * g[i] / normal - flat * g[i] / slope;
        [x + across(0), y + across(1), z + off / normal - tool.corner_mm]
    }

    fn gradient([x, y]: [f64; 2]) -> [f64; 2] {
        [
            0.04 * x + 8.0 / 15.0 * libm::cos(x / 15.0) * libm::cos(y / 20.0),
            -8.0 / 20.0 * libm::sin(x / 15.0) * libm::sin(y / 20.0),
        ]
    }

    /// Places at which the flat of a tool does not cut into the wave beside its contact: it turns faster with
    /// the slope than the surface bends.
    fn grid(tool: Tool) -> impl Iterator<Item = [f64; 2]> {
        let all = (0..=25)
            .flat_map(|i| (0..=20).map(move |j| [0.3 + 3.9 * f64::from(i), 0.2 + 3.9 * f64::from(j)]));
        all.filter(move |at| {
            let [x, y] = gradient(*at);
            libm::hypot(x, y) >= 0.2 * (tool.radius_mm - tool.corner_mm)
        })
    }

    #[test]
    fn a_tool_that_stands_off_is_seen_where_it_stands_off() {
        for tool in [BALL, BULL, FLAT] {
            let mut probe = Probe::new(wave(), tool);
            for at in grid(tool) {
                for d in [0.0, 0.005, -0.003, 0.25] {
                    let touch = probe.touch(tip(tool, at, d)).expect("it touches");
                    assert!((touch.deviation_mm - d).abs() <= 1e-10, "{tool:?} {at:?} {d}: {touch:?}");
                    let off = libm::hypot(touch.at[0] - at[0], touch.at[1] - at[1]);
                    assert!(off <= 1e-5, "{tool:?} {at:?} {d}: {touch:?}");
                }
            }
        }
    }

    /// Every place is looked for anew, as at the beginning of a run.
    #[test]
    fn a_contact_is_found_without_one_to_begin_from() {
        for tool in [BALL, BULL, FLAT] {
            for at in grid(tool) {
                let touch = Probe::new(wave(), tool).touch(tip(tool, at, 0.001)).expect("it touches");
                assert!((touch.deviation_mm - 0.001).abs() <= 1e-10, "{tool:?} {at:?}: {touch:?}");
            }
        }
    }

    /// A ball of 6 mm touches the floor of a trough and comes to its wall.
    #[test]
    fn a_second_contact_is_found_when_it_cuts_deeper() {
        let ops = [Op::Constant(3.0), Op::Variable(0), Op::Constant(6.0), Op::Div, Op::Powi(8), Op::Mul];
        let trough = Formula::new(&ops).expect("complete");
        let height = |x: f64| 3.0 * (x / 6.0).powi(8);
        let centre = |x: f64| {
            let (slope, r) = (4.0 * (x / 6.0).powi(7), BALL.radius_mm);
            let normal = libm::hypot(slope, 1.0);
            [x - r * slope / normal, height(x) + r / normal]
        };
        let deepest = |c: [f64; 2]| {
            let places = (-20_000..=70_000).map(|i| 1e-4 * f64::from(i));
            let off = places.map(|x| libm::hypot(x - c[0], height(x) - c[1]));
            off.fold(f64::INFINITY, f64::min) - BALL.radius_mm
        };
        let mut probe = Probe::new(trough, BALL);
        let mut seen = 0;
        for step in 0..=400_u32 {
            let c = centre(2.4 + 0.003 * f64::from(step));
            let touch = probe.touch([c[0], 0.0, c[1] - BALL.radius_mm]).expect("it touches");
            if step % 32 == 0 {
                let want = deepest(c);
                assert!((touch.deviation_mm - want).abs() < 1e-6, "{step}: {touch:?} for {want}");
                seen += u32::from(want < -0.01);
            }
        }
        assert!(seen > 4, "{seen} times it cut into the wall");
    }

    #[test]
    fn early_or_late_is_no_deviation_on_a_plane() {
        let ops = [Op::Variable(0), Op::Constant(0.75), Op::Mul];
        let plane = Formula::new(&ops).expect("complete");
        let mut probe = Probe::new(plane, BALL);
        // The normal is (−0.6, 0, 0.8): the tip of a ball of 3 mm is 3/0.8 − 3 mm above the plane.
        for step in 0..100 {
            let x = 0.3 * f64::from(step);
            let touch = probe.touch([x, -x, 0.75 * x + 0.75 + 0.01]).expect("it touches");
            assert!((touch.deviation_mm - 0.008).abs() <= 1e-12, "{touch:?}");
        }
    }

    #[test]
    fn where_a_formula_does_not_exist_nothing_is_measured() {
        let root = Formula::new(&[Op::Variable(0), Op::Apply(Function::Sqrt)]).expect("complete");
        assert_eq!(Probe::new(root, BALL).touch([-20.0, 0.0, 0.0]), None);
    }
}
