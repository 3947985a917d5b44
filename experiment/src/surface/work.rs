//! What is shaped in the experiment: plane curves Z = f(X), and paths on surfaces Z = ψ(X, Y), of some under
//! a ball. In: the texts of their formulas. Out: the path of the point that moves, with its derivatives, and
//! the surface that it has to stay on. mm.

use interpreter::formula;
use shape::{Formula, Gradient, Op, Place, Series, Tool, Touch};

use crate::ExperimentError;

/// Rounds of the search for a contact; each takes away three quarters of what is missed, or more.
const MOST_ROUNDS: usize = 60;

/// Texts and figures of a work. A plane curve is written Z = f(X), with Y = 0.
pub(super) struct Text {
    pub(super) name: &'static str,
    pub(super) is_surface: bool,
    /// ψ of x and y, or f of x.
    pub(super) psi: &'static str,
    /// x and y of t where the tool touches, seen from above; t is in mm.
    pub(super) path: [&'static str; 2],
    pub(super) t: [f64; 2],
    /// Step of the parameter that is shown first.
    pub(super) h_mm: f64,
    pub(super) ball_mm: f64,
    /// Whether X leads throughout, as in the paper, or the axis with the largest way.
    pub(super) x_leads: bool,
}

/// The works. Those named in the reference values come first, with their paths and steps.
pub(super) const TEXTS: [Text; 7] = [
    Text { psi: "12*sin(0.15*x) + 0.004*x^2", t: [-20.0, 0.0], h_mm: 0.5, ..curve("c1") },
    Text { psi: "3*sin(0.4*x) - 0.02*x^2", t: [0.0, 4.0], h_mm: 0.1, ..curve("c2") },
    Text {
        psi: "-sqrt(900 - x^2)",
        path: ["30*sin(t/30)", "0"],
        t: [0.0, 44.0],
        h_mm: 0.5,
        x_leads: false,
        ..curve("circle")
    },
    Text {
        psi: "0.01*x^2 - 0.006*y^2 + 0.008*x*y",
        path: ["t", "5 + 0.7*t + 0.01*t^2"],
        t: [-10.0, 0.0],
        h_mm: 0.5,
        ..surface("quad_twist")
    },
    Text {
        psi: "6*sin(0.12*x)*cos(0.09*y)",
        path: ["t", "2 - 0.5*t + 0.008*t^2"],
        t: [1.0, 9.0],
        h_mm: 0.4,
        ..surface("sin_cos")
    },
    Text {
        psi: "(x^2 - y^2)/40",
        path: ["18*cos(t/15)", "12*sin(t/15)"],
        t: [0.0, 94.0],
        h_mm: 0.5,
        x_leads: false,
        ..surface("saddle")
    },
    Text {
        psi: "0.02*x^2 + 8*sin(x/15)*cos(y/20)",
        path: ["t", "30"],
        t: [0.0, 100.0],
        h_mm: 0.5,
        ball_mm: 6.0,
        x_leads: false,
        ..surface("wave")
    },
];

const fn curve(name: &'static str) -> Text {
    Text { is_surface: false, ..surface(name) }
}

const fn surface(name: &'static str) -> Text {
    let (t, path) = ([0.0, 1.0], ["t", "0"]);
    Text { name, is_surface: true, psi: "0", path, t, h_mm: 1.0, ball_mm: 0.0, x_leads: true }
}

fn read(text: &str, variables: &[&str]) -> Result<Formula, ExperimentError> {
    formula::parse(text, variables).map_err(|error| ExperimentError::Machine(format!("{text}: {error}")))
}

/// Every work with its formulas read.
///
/// # Errors
/// None but for a mistake in the texts.
pub(super) fn all() -> Result<Vec<Work>, ExperimentError> {
    TEXTS.iter().map(Work::new).collect()
}

/// A work with its formulas read.
pub(super) struct Work {
    pub(super) text: &'static Text,
    psi: Formula,
    path: [Formula; 2],
    tool: Tool,
}

impl Work {
    fn new(text: &'static Text) -> Result<Work, ExperimentError> {
        let radius_mm = 0.5 * text.ball_mm;
        let path = [read(text.path[0], &["t"])?, read(text.path[1], &["t"])?];
        Ok(Work {
            psi: read(text.psi, &["x", "y"])?,
            path,
            tool: Tool { radius_mm, corner_mm: radius_mm },
            text,
        })
    }

    /// The same part with a straight path through a place, in a direction seen from above; t is 0 there.
    pub(super) fn towards(&self, at: [f64; 2], direction: [f64; 2]) -> Work {
        let straight = |axis: usize| {
            let ops =
                [Op::Variable(0), Op::Constant(direction[axis]), Op::Mul, Op::Constant(at[axis]), Op::Add];
            Formula::new(&ops).unwrap_or_default()
        };
        Work { path: [straight(0), straight(1)], ..*self }
    }

    /// The point that moves, the tip of the ball or the point of contact, about a place of the parameter.
    pub(super) fn path(&self, t: f64) -> [Series; 3] {
        let [x, y] = self.contact(t);
        self.tool.tip([x, y], self.psi.eval(Gradient::variables(x, y)))
    }

    fn contact(&self, t: f64) -> [Series; 2] {
        self.path.each_ref().map(|formula| formula.eval([Series::variable(t), Series::default()]))
    }

    /// The same with the slopes of the surface on which it moves; a plane curve has none.
    pub(super) fn place(&self, t: f64) -> Place {
        let surface = || Touch::at(&self.psi, self.contact(t).map(|axis| axis.value())).under(&self.tool);
        Place { path: self.path(t), surface: self.text.is_surface.then(surface).flatten() }
    }

    /// Where the point is at a place of the parameter, mm.
    pub(super) fn point(&self, t: f64) -> [f64; 3] {
        self.path(t).map(|axis| axis.value())
    }

    /// Height of the surface on which the point moves, at X and Y, and its gradient. A tool touches beside
    /// its tip: the place of contact is found by going back by what the tip misses, which is a contraction
    /// where the ball fits.
    pub(super) fn height(&self, at: [f64; 2]) -> (f64, [f64; 2]) {
        let surface = |[x, y]: [f64; 2]| self.psi.eval(Gradient::variables(x, y));
        let mut contact = at;
        for _ in 0..MOST_ROUNDS {
            let [x, y, _] = self.tool.tip(contact, surface(contact));
            let missed = [at[0] - x, at[1] - y];
            contact = [contact[0] + missed[0], contact[1] + missed[1]];
            if missed.iter().all(|way| way.abs() < 1e-14) {
                break;
            }
        }
        let surface = surface(contact);
        (self.tool.tip(contact, surface)[2], [surface.x, surface.y])
    }

    /// Height of a point over that surface, mm: along Z, and along its normal.
    pub(super) fn over(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let (height, [gx, gy]) = self.height([x, y]);
        [z - height, (z - height) / (1.0 + gx * gx + gy * gy).sqrt()]
    }
}
