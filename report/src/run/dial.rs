//! A polar picture on straight axes, which the bundle of the plotting script has. In: values around a circle,
//! the range of the values. Out: traces and a layout with rings, spokes and their numbers.
//!
//! A value r at the angle θ is drawn at the distance r − r₀ from the middle, with r₀ the value of the middle
//! itself.

use serde_json::{Value, json};

use crate::colours::{EDGE, GRID};
use crate::paint::column;

/// Degrees between spokes.
const SPOKES_DEG: f64 = 30.0;
/// The ray on which the rings have their numbers, degrees.
const NUMBERS_DEG: f64 = 45.0;
/// At least this many rings, and fewer than three times as many.
const RINGS: f64 = 4.0;
/// The numbers of spokes stand this far out, in radii of the edge.
const OUTSIDE: f64 = 1.08;

/// From the value in the middle to the value at the edge.
pub(super) struct Dial {
    middle: f64,
    edge: f64,
}

impl Dial {
    /// A dial of values in `middle..=edge`.
    pub(super) fn new(middle: f64, edge: f64) -> Dial {
        assert!(middle < edge, "a dial has a radius");
        Dial { middle, edge }
    }

    fn radius(&self) -> f64 {
        self.edge - self.middle
    }

    fn at(&self, (deg, value): (f64, f64)) -> (f64, f64) {
        let (sin, cos) = libm::sincos(deg.to_radians());
        ((value - self.middle) * cos, (value - self.middle) * sin)
    }

    /// A trace through points of angle in degrees and value; pointed at, it tells both.
    pub(super) fn trace(&self, points: &[(f64, f64)], mode: &str, name: &str) -> Value {
        let at: Vec<_> = points.iter().map(|point| self.at(*point)).collect();
        let told: Vec<String> =
            points.iter().map(|(deg, value)| format!("{value:.2} µm at {deg:.1}°")).collect();
        json!({ "type": "scatter", "mode": mode, "name": name, "x": column(at.iter().map(|at| Some(at.0))),
                "y": column(at.iter().map(|at| Some(at.1))), "hovertext": told, "hoverinfo": "text+name" })
    }

    /// Rings at round values, in their order.
    fn rings(&self) -> Vec<f64> {
        let least = self.radius() / RINGS;
        let power = libm::pow(10.0, libm::floor(libm::log10(least)));
        let step = power * [5.0, 2.0, 1.0].into_iter().find(|step| step * power <= least).unwrap_or(1.0);
        let first = libm::floor(self.middle / step) as i64 + 1;
        (first..).map(|ring| ring as f64 * step).take_while(|value| *value < self.edge).collect()
    }

    /// The axes, which are not seen, and on them the grid.
    pub(super) fn layout(&self) -> Value {
        let reach = 1.15 * self.radius();
        let ring = |value: f64, color: &str| {
            let r = value - self.middle;
            json!({ "type": "circle", "xref": "x", "yref": "y", "x0": -r, "x1": r, "y0": -r, "y1": r, "layer": "below",
                    "line": { "color": color, "width": 1 } })
        };
        let spoke = |deg: f64, color: &str| {
            let (x, y) = self.at((deg, self.edge));
            json!({ "type": "line", "xref": "x", "yref": "y", "x0": 0, "x1": x, "y0": 0, "y1": y, "layer": "below",
                    "line": { "color": color, "width": 1 } })
        };
        let number = |(x, y): (f64, f64), text: String| json!({ "xref": "x", "yref": "y", "x": x, "y": y, "text": text, "showarrow": false });
        let rings = self.rings();
        let decimals =
            rings.windows(2).next().map_or(0.0, |two| libm::ceil(-libm::log10(two[1] - two[0]))).max(0.0);
        let spokes: Vec<f64> = (0..12).map(|spoke| SPOKES_DEG * f64::from(spoke)).collect();
        let shapes = rings.iter().map(|value| ring(*value, GRID));
        let shapes = shapes.chain(spokes.iter().map(|deg| spoke(*deg, GRID)));
        let shapes = shapes.chain([ring(self.edge, EDGE), spoke(NUMBERS_DEG, EDGE)]);
        let outside = self.middle + OUTSIDE * self.radius();
        let angles = spokes.iter().map(|deg| number(self.at((*deg, outside)), format!("{deg:.0}°")));
        let values = rings.iter().map(|value| {
            let text = format!("{value:.*}", decimals as usize);
            number(self.at((NUMBERS_DEG, *value)), text)
        });
        let axis = json!({ "visible": false, "range": [-reach, reach] });
        let mut y = axis.clone();
        y["scaleanchor"] = json!("x");
        json!({ "xaxis": axis, "yaxis": y, "shapes": shapes.collect::<Vec<_>>(),
                "annotations": angles.chain(values).collect::<Vec<_>>() })
    }
}

#[cfg(test)]
mod tests {
    use super::Dial;

    #[test]
    fn rings_stand_at_round_values_inside_of_the_edge() {
        assert_eq!(Dial::new(-6.0, 2.6).rings(), [-4.0, -2.0, 0.0, 2.0]);
        let fine = Dial::new(-0.3, 0.13).rings();
        assert_eq!(fine.len(), 4, "{fine:?}");
        for reach in [0.5, 1.0, 3.7, 12.0, 99.0, 250.0] {
            let rings = Dial::new(-3.0 * reach, 1.3 * reach).rings();
            assert!((4..12).contains(&rings.len()), "{reach}: {rings:?}");
            assert!(rings.iter().any(|ring| ring.abs() < 1e-9 * reach), "{reach}: zero is drawn, {rings:?}");
        }
    }

    /// Zero degrees to the right, 90 upwards; the middle is the lowest value.
    #[test]
    fn a_value_is_drawn_at_its_distance_from_the_middle() {
        let dial = Dial::new(-3.0, 1.0);
        for ((deg, value), (x, y)) in [
            ((0.0, 0.0), (3.0, 0.0)),
            ((90.0, 1.0), (0.0, 4.0)),
            ((180.0, -1.0), (-2.0, 0.0)),
            ((45.0, -3.0), (0.0, 0.0)),
        ] {
            let at = dial.at((deg, value));
            assert!((at.0 - x).abs() < 1e-12 && (at.1 - y).abs() < 1e-12, "{at:?}");
        }
    }
}
