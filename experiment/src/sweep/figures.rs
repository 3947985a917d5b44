//! Pictures of the sweep. In: rows. Out: how many cases stay below an error; error over acceleration.

use serde_json::{Value, json};

use super::{MASS_ERRORS, MEDIAN_UM, Row, WORST_UM};
use report::paint::{BLUE, Figure, GREEN, GREY, ORANGE, axis, line};

/// Colours of [`MASS_ERRORS`].
const COLORS: [&str; 3] = [ORANGE, BLUE, GREEN];

pub(super) fn all(rows: &[Row]) -> Vec<Figure> {
    vec![shares(rows), approach(rows), end(rows)]
}

/// Rows of each error of mass, with its name and colour.
fn by_mass(rows: &[Row]) -> impl Iterator<Item = (Vec<&Row>, String, &'static str)> {
    MASS_ERRORS.into_iter().zip(COLORS).map(|(mass, color)| {
        let chosen = rows.iter().filter(|row| row.mass_error_pct == mass).collect();
        (chosen, format!("mass {mass:+.0} %"), color)
    })
}

fn upright(x: f64) -> Value {
    json!({ "type": "line", "xref": "x", "yref": "paper", "x0": x, "x1": x, "y0": 0, "y1": 1,
            "line": { "color": GREY, "width": 1, "dash": "dash" } })
}

/// Share of the cases below an error.
fn shares(rows: &[Row]) -> Figure {
    let curves = by_mass(rows).map(|(chosen, name, color)| {
        let mut errors: Vec<f64> = chosen.iter().map(|row| row.approach_max_abs_um).collect();
        errors.sort_by(f64::total_cmp);
        let step = 100.0 / errors.len().max(1) as f64;
        let points: Vec<_> = errors.iter().zip(1..).map(|(um, n)| (*um, step * f64::from(n))).collect();
        line(&points, &name, color, ("x", "y"))
    });
    let mut x = axis("largest servo error in the approach (µm)");
    x["rangemode"] = json!("tozero");
    Figure {
        title: "How many cases stay below an error".into(),
        caption: format!(
            "Share of the cases whose largest servo error in the approach is below a value, for each error of the mass \
             that the controller believes. Dashed: what is asked of the median ({MEDIAN_UM} µm) and of the worst \
             ({WORST_UM} µm). Good: every curve reaches 50 % left of the first line and 100 % left of the second."
        ),
        alt: "Cumulative share of cases over their largest servo error, one curve an error of mass.".into(),
        plot: json!({
            "data": curves.collect::<Vec<_>>(),
            "layout": { "xaxis": x, "yaxis": axis("share of cases (%)"),
                        "shapes": [upright(MEDIAN_UM), upright(WORST_UM)] },
        }),
        aspect: 0.45,
    }
}

/// A figure of each case over the peak acceleration of its stroke.
fn over_acceleration(rows: &[Row], y: &str, of: fn(&Row) -> f64) -> Value {
    let clouds = by_mass(rows).map(|(chosen, name, color)| {
        let points: Vec<_> = chosen.iter().map(|row| (1e-3 * row.peak_acceleration(), of(row))).collect();
        let mut cloud = line(&points, &name, color, ("x", "y"));
        cloud["mode"] = json!("markers");
        cloud["marker"] = json!({ "color": color, "size": 5, "opacity": 0.6 });
        cloud
    });
    json!({
        "data": clouds.collect::<Vec<_>>(),
        "layout": { "xaxis": axis("peak acceleration at the actual speed (m/s²)"), "yaxis": axis(y) },
    })
}

fn approach(rows: &[Row]) -> Figure {
    Figure {
        title: "Error in the approach over acceleration".into(),
        caption: "Every case as a point. What lies at the left, where nothing accelerates, is the count of the spindle \
                  encoder through its observer, and friction; what rises to the right is a wrong belief."
            .into(),
        alt: "Cloud of points: largest servo error over peak acceleration, coloured by the error of mass.".into(),
        plot: over_acceleration(rows, "largest servo error (µm)", |row| row.approach_max_abs_um),
        aspect: 0.45,
    }
}

fn end(rows: &[Row]) -> Figure {
    Figure {
        title: "Error at the end of the approach over acceleration".into(),
        caption: "The sign tells the belief: a mass believed too low leaves the axis behind, one believed too high \
                  carries it too far. It dies away in the first turn of the thread."
            .into(),
        alt: "Cloud of points: servo error at the end over peak acceleration; positive for a mass believed too low, \
              negative for one believed too high."
            .into(),
        plot: over_acceleration(rows, "servo error at the end (µm)", |row| row.end_um),
        aspect: 0.45,
    }
}
