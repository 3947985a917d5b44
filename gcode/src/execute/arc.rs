//! Arcs and helices: G2 and G3 in three planes.
//!
//! In: a block and the state; the centre as I J K (from the start under G91.1, absolute under G90.1; lengths,
//! never diameters), or R; P turns. Out: an [`Arc`] with its centre, or what is wrong with the numbers.
//!
//! ```text
//! (1)  r1 = |start - centre|,  r2 = |end - centre|;  both at least 0.00005 inch
//! (2)  e = |r1 - r2|;  refused if e > 100 t, or if e > t and e > max(r1, r2)/1000;
//!      t = 2√2/100 mm or 2√2/1000 inch
//! (3)  R: with M the middle of the chord and h half of it, the centre is √(R² - h²) from M, to the left of
//!      the chord for G3 R+ and G2 R-, else to the right; h may exceed |R| by 0.00005 inch
//! (4)  length = hypot(r1 θ, way along the axis), θ counted over all turns
//! ```
//! The tolerances are those of LinuxCNC, so that an arc that passes there passes here. Whether a machine
//! makes it is for the machine to say.

use std::f64::consts::{SQRT_2, TAU};

use super::{Done, Output, compensation, feed, straight};
use crate::block::{AXES, Block};
use crate::canon::{A, Arc, B, C, Call, Plane, Pose, Units};
use crate::codes::G;
use crate::problem::{Blame, Problem, short};
use crate::state::State;

/// What an arc may be too short by, mm.
const RADIUS_TOLERANCE: f64 = 0.00005 * 25.4;
/// What the end of an arc may miss its circle by, relative to the radius.
const SPIRAL: f64 = 0.001;
/// A miss that is worth a warning, mm.
const WORTH_A_WARNING: f64 = 0.01;
/// `h / |R|` so near to 1 is a half circle.
const HALF_CIRCLE: f64 = 1.0 - 1e-12;
/// Letters of centres, in the order of the axes.
const CENTERS: [char; 3] = ['I', 'J', 'K'];

/// G2 and G3.
pub(super) fn arc(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    compensation::arc_allowed(block, state)?;
    feed::ready(block, state)?;
    let arc = programmed(code, block, state, out)?;
    let plane = state.modes.plane;
    feed::inverse_time(|from| length(&arc, plane, from), block, state, out)?;
    if state.compensation.is_on() {
        return compensation::arc(arc, block, state, out);
    }
    out.call(Call::ArcFeed(arc))?;
    state.axes.position = end(&arc, state.modes.plane);
    Ok(())
}

/// G2, G35.
fn is_clockwise(code: G) -> bool {
    matches!(code, G(20 | 350))
}

/// Where an arc ends.
fn end(arc: &Arc, plane: Plane) -> Pose {
    let (first, second, along) = plane.axes();
    let mut end = [0.0; 6];
    [end[first], end[second], end[along]] = [arc.end[0], arc.end[1], arc.along];
    [end[A], end[B], end[C]] = arc.rotary;
    end
}

/// The arc as it is programmed, from the programmed point: of G2 and G3, and of threads by G35 and G36.
///
/// # Errors
/// Its words contradict each other, or are missing.
pub(crate) fn programmed(
    code: G,
    block: &Block,
    state: &State,
    out: &mut Output,
) -> Result<Arc, Box<Problem>> {
    let (first, second, along) = state.modes.plane.axes();
    let by_center = CENTERS.into_iter().any(|letter| block.has(letter));
    match (by_center, block.has('R')) {
        (false, false) => {
            let [one, other] = [CENTERS[first], CENTERS[second]];
            let message = format!("{code} has neither a centre ({one}, {other}) nor a radius (R)");
            let help = "add the one or the other; write G1 for a straight move";
            return Err(Problem::error("missing-word", Blame::G(code), message, help));
        }
        (true, true) => {
            let message = format!("{code} has a centre and a radius");
            return Err(Problem::error("bad-value", Blame::Word('R'), message, "leave one of the two out"));
        }
        _ => {}
    }
    let turns = turns(block)?;
    let target = straight::target(block, state)?;
    let (start, end) =
        ([state.axes.position[first], state.axes.position[second]], [target[first], target[second]]);
    let center = if by_center {
        let center = center_of_words(code, block, state)?;
        check_radii(start, center, end, block, state, out)?;
        center
    } else {
        center_of_radius(code, block, state, start, end)?
    };
    let turns = if is_clockwise(code) { -turns } else { turns };
    Ok(Arc { end, center, turns, along: target[along], rotary: [target[A], target[B], target[C]] })
}

/// P.
fn turns(block: &Block) -> Result<i32, Box<Problem>> {
    let Some(value) = block.get('P') else { return Ok(1) };
    let turns = block.integer('P').filter(|turns| (1..=i64::from(i32::MAX)).contains(turns));
    turns.and_then(|turns| i32::try_from(turns).ok()).ok_or_else(|| {
        let message = format!("P{} cannot be a number of turns", short(value));
        Problem::error(
            "bad-value",
            Blame::Word('P'),
            message,
            "give a whole number from 1; 1 is up to one full turn",
        )
    })
}

/// The centre that I, J, K name.
fn center_of_words(code: G, block: &Block, state: &State) -> Result<[f64; 2], Box<Problem>> {
    let (first, second, along) = state.modes.plane.axes();
    if block.has(CENTERS[along]) {
        let letter = CENTERS[along];
        let message = format!(
            "{letter} does not belong to the centre of an arc in the plane {}",
            name(state.modes.plane)
        );
        let help = format!("use {} and {}, or select another plane", CENTERS[first], CENTERS[second]);
        return Err(Problem::error("unused-word", Blame::Word(letter), message, help));
    }
    let mut center = [0.0; 2];
    for (value, axis) in center.iter_mut().zip([first, second]) {
        let word = block.get(CENTERS[axis]);
        *value = match (word, state.modes.absolute_centers) {
            (Some(word), true) => word,
            (word, false) => state.axes.position[axis] + word.unwrap_or(0.0),
            (None, true) => {
                let message = format!("{code} lacks {}: with G90.1 the centre is a point", CENTERS[axis]);
                return Err(Problem::error("missing-word", Blame::G(code), message, "add it, or use G91.1"));
            }
        };
    }
    Ok(center)
}

/// Equations 1 and 2.
fn check_radii(
    start: [f64; 2],
    center: [f64; 2],
    end: [f64; 2],
    block: &Block,
    state: &State,
    out: &mut Output,
) -> Done {
    let [r1, r2] = [distance(center, start), distance(center, end)];
    let mm = state.units.mm();
    let blame = Blame::Word(CENTERS.into_iter().find(|letter| block.has(*letter)).unwrap_or('I'));
    if r1.min(r2) * mm < RADIUS_TOLERANCE {
        let message =
            format!("the radius of the arc is {} at its start and {} at its end", short(r1), short(r2));
        return Err(Problem::error("arc-radius", blame, message, "put the centre away from both"));
    }
    let miss = (r1 - r2).abs();
    let tolerance = match state.units.program() {
        Units::Millimetre => 2.0 * 0.01 * SQRT_2,
        Units::Inch => 2.0 * 0.001 * SQRT_2,
    };
    let message = || {
        let [start, end, center] = [start, end, center].map(|point| at(point, state.modes.plane));
        let [r1, r2, miss] = [r1, r2, miss].map(short);
        format!(
            "the centre {center} is {r1} from the start {start} and {r2} from the end {end}: {miss} off the circle"
        )
    };
    let help = read_otherwise(&Points { start, center, end }, block, state, tolerance)
        .unwrap_or("give end and centre with more digits, or correct the one that is wrong");
    if miss > 100.0 * tolerance || (miss > tolerance && miss / r1.max(r2) > SPIRAL) {
        return Err(Problem::error("arc-radius", blame, message(), help));
    }
    if miss * mm > WORTH_A_WARNING {
        out.warn(Problem::warning("arc-radius", blame, message(), help));
    }
    Ok(())
}

/// An arc in the plane.
struct Points {
    start: [f64; 2],
    center: [f64; 2],
    end: [f64; 2],
}

/// What to write where an arc that misses its end fits in another reading of its words: posts differ in both.
fn read_otherwise(arc: &Points, block: &Block, state: &State, tolerance: f64) -> Option<&'static str> {
    let Points { start, center, end } = *arc;
    let fits = |start: [f64; 2], center: [f64; 2], end: [f64; 2]| {
        let [r1, r2] = [distance(center, start), distance(center, end)];
        r1.min(r2) > tolerance && (r1 - r2).abs() <= tolerance
    };
    let (first, second, _) = state.modes.plane.axes();
    let words = [first, second].map(|axis| block.get(CENTERS[axis]).unwrap_or(0.0));
    let relative = !state.modes.absolute_centers;
    if state.modes.plane == Plane::Xz && !state.modes.diameter && relative {
        let radii = |[z, x]: [f64; 2]| [z, x / 2.0];
        let [z, x] = radii(start);
        if fits(radii(start), [z + words[0], x + words[1]], radii(end)) {
            return Some(
                "with X as a diameter the arc fits: write G7 before it, or read the program with --dialect fanuc",
            );
        }
    }
    let [of_start, of_program] = [[start[0] + words[0], start[1] + words[1]], words];
    let other = if relative { of_program } else { of_start };
    (other != center && fits(start, other, end)).then_some(match relative {
        true => "with the centre as a point of the program (G90.1) the arc fits: here it counts from the start of the arc",
        false => "with the centre counted from the start of the arc (G91.1) the arc fits: here it is a point",
    })
}

/// Equation 3.
fn center_of_radius(
    code: G,
    block: &Block,
    state: &State,
    start: [f64; 2],
    end: [f64; 2],
) -> Result<[f64; 2], Box<Problem>> {
    let radius = block.get('R').unwrap_or(0.0);
    let refuse =
        |message: String, help: &str| Err(Problem::error("arc-radius", Blame::Word('R'), message, help));
    let (first, second, _) = state.modes.plane.axes();
    if start == end {
        let message = format!(
            "the arc ends where it starts, {}: R{} names no circle",
            at(end, state.modes.plane),
            short(radius)
        );
        return refuse(message, "give the centre for a full circle, or another end");
    }
    let middle: [f64; 2] = std::array::from_fn(|n| (end[n] + start[n]) / 2.0);
    let half = distance(middle, end);
    let size = radius.abs();
    if size == 0.0 || (half - size) * state.units.mm() > RADIUS_TOLERANCE {
        let [half, size] = [short(half), short(size)];
        let message =
            format!("the radius {size} does not reach the end: it is at least {half}, half of the chord");
        return refuse(message, &format!("give a greater R, or correct {} or {}", AXES[first], AXES[second]));
    }
    let ratio = if half / size > HALF_CIRCLE { 1.0 } else { half / size };
    let chord = libm::atan2(end[1] - start[1], end[0] - start[0]);
    let to_the_right = is_clockwise(code) == (radius > 0.0);
    let across = if to_the_right { straight::minus_quarter(chord) } else { -straight::minus_quarter(-chord) };
    let offset = size * libm::cos(libm::asin(ratio));
    Ok([middle[0] + offset * libm::cos(across), middle[1] + offset * libm::sin(across)])
}

/// Equation 4.
fn length(arc: &Arc, plane: Plane, start: &Pose) -> f64 {
    let (first, second, along) = plane.axes();
    let from = [start[first], start[second]];
    let way = distance(arc.center, from) * sweep(arc, from);
    libm::hypot(way, arc.along - start[along])
}

/// The angle of an arc over all its turns, radians, positive.
fn sweep(arc: &Arc, start: [f64; 2]) -> f64 {
    let angle = |point: [f64; 2]| libm::atan2(point[1] - arc.center[1], point[0] - arc.center[0]);
    let (from, to) = (angle(start), angle(arc.end));
    let part = if arc.turns > 0 { to - from } else { from - to };
    let part = if part <= 0.0 { part + TAU } else { part };
    part + f64::from(arc.turns.unsigned_abs() - 1) * TAU
}

fn distance(one: [f64; 2], other: [f64; 2]) -> f64 {
    libm::hypot(one[0] - other[0], one[1] - other[1])
}

fn name(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "XY (G17)",
        Plane::Xz => "ZX (G18)",
        Plane::Yz => "YZ (G19)",
    }
}

/// A point of the plane as a program writes it.
fn at(point: [f64; 2], plane: Plane) -> String {
    let (first, second, _) = plane.axes();
    format!("{}{} {}{}", AXES[first], short(point[0]), AXES[second], short(point[1]))
}
