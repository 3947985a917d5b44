//! A surface Z = ψ(X, Y) under a tool. In: a leg of its pattern, and the parameter. Out: the tip of the tool
//! there, by [`Tool::tip`] (M87), with its derivatives.

use serde::{Deserialize, Serialize};

use crate::{Curve, Formula, Gradient, Leg, Pattern, Plan, Point, Series, Tool};

/// A surface. Formula 0 is ψ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Domain: lowest and highest X, mm.
    pub x: [f64; 2],
    /// Lowest and highest Y, mm.
    pub y: [f64; 2],
    /// The tool.
    pub tool: Tool,
    /// Its paths.
    pub pattern: Pattern,
    /// Z of the tip of the tool, from the zero of the formulas, at which it moves freely over the part, mm.
    pub clear_mm: f64,
}

/// The tip of the tool along one leg, as a [`Curve`] of the parameter of its plan. Axes: X, Y, Z.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceCurve<'a> {
    tool: Tool,
    plan: Plan,
    formulas: [&'a Formula; 3],
}

impl Surface {
    /// How many legs its pattern has.
    #[must_use]
    pub fn legs(&self) -> u32 {
        self.pattern.legs(self.x, self.y)
    }

    /// Leg `k`, counted from 0; `None` behind the last.
    #[must_use]
    pub fn leg(&self, k: u32) -> Option<Leg> {
        self.pattern.leg(self.x, self.y, k)
    }

    /// The tip of the tool along a plan. Formulas: ψ(x, y), and x(t), y(t) of a pattern that is a curve.
    #[must_use]
    pub fn curve<'a>(&self, plan: Plan, formulas: [&'a Formula; 3]) -> SurfaceCurve<'a> {
        SurfaceCurve { tool: self.tool, plan, formulas }
    }

    /// The tip of the tool while it touches at X, Y; `formula` is ψ.
    #[must_use]
    pub fn tip(&self, formula: &Formula, [x, y]: [f64; 2]) -> [f64; 3] {
        self.tool.tip([x, y], formula.eval(Gradient::variables(x, y)))
    }
}

impl SurfaceCurve<'_> {
    /// The tool.
    #[must_use]
    pub fn tool(&self) -> &Tool {
        &self.tool
    }

    /// The point of contact, seen from above.
    #[must_use]
    pub fn contact(&self, t: f64) -> [Series; 2] {
        match self.plan {
            Plan::Line { from, to } => {
                let [_, length] = self.plan.t();
                std::array::from_fn(|i| {
                    let share = (to[i] - from[i]) / length;
                    Series([from[i] + share * t, share, 0.0, 0.0])
                })
            }
            Plan::Curve { .. } => {
                let variables = [Series::variable(t), Series::default()];
                [self.formulas[1].eval(variables), self.formulas[2].eval(variables)]
            }
        }
    }
}

impl Curve<3> for SurfaceCurve<'_> {
    fn at(&self, t: f64) -> Point<3> {
        let [x, y] = self.contact(t);
        let tip = self.tool.tip([x, y], self.formulas[0].eval(Gradient::variables(x, y)));
        Point { axes: tip, tip }
    }
}
