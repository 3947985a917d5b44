//! Formulas: ns to evaluate one as a number, and with its gradient as series; ns for one piece of a curve
//! over a surface, which is what a tick of the interpolator makes of a trace; and the text of a formula read.
//!
//! The surface is that of `examples/shape/wave.toml`, under its ball.
#![allow(missing_docs, clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use interpreter::formula::parse;
use shape::{Formula, Gradient, Pattern, Plan, Series, Surface, Tool, Walker};

const WAVE: &str = "0.02*x^2 + 8*sin(x/15)*cos(y/20)";
const PLACE: [f64; 2] = [31.0, 17.0];
const PLAN: Plan = Plan::Line { from: [0.0, 17.0], to: [100.0, 17.0] };

fn wave() -> Formula {
    parse(WAVE, &["x", "y"]).unwrap()
}

fn surface() -> Surface {
    let tool = Tool { radius_mm: 3.0, corner_mm: 3.0 };
    Surface { x: [0.0, 100.0], y: [0.0, 80.0], tool, pattern: Pattern::Rings { count: 1 }, clear_mm: 5.0 }
}

fn formulas(criterion: &mut Criterion) {
    let wave = wave();
    criterion.bench_function("formula/number", |bench| bench.iter(|| wave.eval(black_box(PLACE))));
    criterion.bench_function("formula/gradient of series", |bench| {
        bench.iter(|| {
            let [x, y] = black_box(PLACE);
            wave.eval(Gradient::variables(Series::variable(x), Series([y, 0.0, 0.0, 0.0])))
        });
    });
    criterion.bench_function("formula/text", |bench| bench.iter(|| parse(black_box(WAVE), &["x", "y"])));
}

fn pieces(criterion: &mut Criterion) {
    let (wave, surface) = (wave(), surface());
    let curve = surface.curve(PLAN, [&wave; 3]);
    let start = Walker::new(PLAN.t());
    let mut walker = start;
    criterion.bench_function("piece of a curve", |bench| {
        bench.iter(|| {
            if walker.next(&curve).unwrap().is_none() {
                walker = start;
            }
            walker.t()
        });
    });
}

criterion_group!(all, formulas, pieces);
criterion_main!(all);
