//! Bounds of the derivatives of a line with the blends of corners that reach it. In: the direction of the
//! line, blends and their ways from its start, mm. Out: bounds of |p₁| … |p₄| of every axis over each of
//! three stretches, mm⁰ … 1/mm³.
//!
//! B1⁗ is constant between the ends and the quarters of a bump (M61), ±4/r³. So p₄ of the whole line is
//! constant between neighbouring places of that kind, p₃ goes straight and p₂ is a parabola:
//!
//! ```text
//! p₄ jumps at sⱼ − r, −r/2, +r/2, +r by Δⱼ/r³ times 4, −8, 8, −4
//! max |p₂| at an end or p₂ − p₃²/2p₄;  max |p₁| ≤ the larger end + h²/8 max |p₃|                  (M173)
//! ```
//! So those of p₂, p₃ and p₄ are reached.

use super::pieces::{CORNERS, Reaching};
use super::zone::Bend;
use crate::blend::bump;

/// Where p₄ jumps in a bump, in half widths from its corner, and by how much, by Δ/r³.
const STEPS: [(f64, f64); 4] = [(-1.0, 4.0), (-0.5, -8.0), (0.5, 8.0), (1.0, -4.0)];
/// Most places at which p₄ jumps, and borders of stretches.
const PLACES: usize = STEPS.len() * 2 * CORNERS + 2;

/// A place where p₄ jumps by so many of the jumps of p₁ of a blend; a border of two stretches has none.
#[derive(Clone, Copy)]
struct Place<'a, const N: usize> {
    at: f64,
    step: f64,
    jump: Option<&'a [f64; N]>,
}

/// Bounds over 0 … `borders`\[0\] … `borders`\[1\] … `length` of a line.
pub(super) fn bounds<'a, const N: usize>(
    direction: &[f64; N],
    length: f64,
    borders: [f64; 2],
    blends: impl Iterator<Item = Reaching<'a, N>>,
) -> [Bend<N>; 3] {
    let mut places = [Place { at: 0.0, step: 0.0, jump: None }; PLACES];
    let mut count = 0;
    let mut p = [*direction, [0.0; N], [0.0; N], [0.0; N]];
    let mut add = |place: Place<'a, N>| {
        let mut k = count;
        while k > 0 && places[k - 1].at > place.at {
            places[k] = places[k - 1];
            k -= 1;
        }
        places[k] = place;
        count += 1;
    };
    borders.into_iter().for_each(|at| add(Place { at, step: 0.0, jump: None }));
    for Reaching { blend, at } in blends {
        let (half, jump) = (blend.half(), blend.corner());
        if at.abs() < half {
            let [_, first, second, third, _] = bump(-at, half);
            for (p, b) in p.iter_mut().zip([first, second, third]) {
                p.iter_mut().zip(jump).for_each(|(p, jump)| *p += jump * b);
            }
        }
        for (share, step) in STEPS {
            let (place, step) = (at + share * half, step / (half * half * half));
            if place <= 0.0 {
                p[3].iter_mut().zip(jump).for_each(|(p, jump)| *p += jump * step);
            } else if place < length {
                add(Place { at: place, step, jump: Some(jump) });
            }
        }
    }
    let mut stretches = [Bend([[0.0; N]; 4]); 3];
    let (mut stretch, mut from) = (0, 0.0);
    for place in &places[..count] {
        let to = place.at.clamp(from, length);
        go_on(&mut p, to - from, &mut stretches[stretch]);
        from = to;
        match place.jump {
            Some(jump) => p[3].iter_mut().zip(jump).for_each(|(p, jump)| *p += jump * place.step),
            None => stretch += 1,
        }
    }
    go_on(&mut p, length - from, &mut stretches[2]);
    stretches
}

/// Goes on by `h` mm with a constant p₄, and widens the bounds of the stretch.
fn go_on<const N: usize>(p: &mut [[f64; N]; 4], h: f64, stretch: &mut Bend<N>) {
    if h <= 0.0 {
        return;
    }
    let Bend(most) = stretch;
    for i in 0..N {
        let [p1, p2, p3, p4] = [p[0][i], p[1][i], p[2][i], p[3][i]];
        let end = [p1 + h * (p2 + h * (p3 / 2.0 + h * p4 / 6.0)), p2 + h * (p3 + h * p4 / 2.0), p3 + h * p4];
        let turns = p3 * end[2] < 0.0;
        let within = if turns { (p2 - p3 * p3 / (2.0 * p4)).abs() } else { 0.0 };
        let third = p3.abs().max(end[2].abs());
        let first = p1.abs().max(end[0].abs()) + 0.125 * h * h * third;
        let bounds = [first, p2.abs().max(end[1].abs()).max(within), third, p4.abs()];
        most.iter_mut().zip(bounds).for_each(|(most, bound)| most[i] = most[i].max(bound));
        (p[0][i], p[1][i], p[2][i]) = (end[0], end[1], end[2]);
    }
}
