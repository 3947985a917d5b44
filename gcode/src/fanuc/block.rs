//! What one block does: units, then tool, spindle, feed and modes, then the move or cycle, then M05, M09 and stops.
//!
//! In: a [`Line`] and what it does ([`Deed`]). Out: calls. Most of it is executed as an equivalent block of RS274/NGC:
//!
//! | here | there | | here | there |
//! |---|---|---|---|---|
//! | G98 G99 | G94 G95 | | G50 X Z | G92 X Z |
//! | G96 S, G50 S | G96 S D | | U W | X Z, absolute |
//! | G04 X U P | G4 P | | G10 L2, G28, G30, G52, G53 | the same |
//! | G61, G64 | G61.1, G64 | | G09 | G61.1 for one block |

use super::codes::Deed;
use super::corner::{self, Pending};
use super::line::Line;
use super::{Done, once, pecks, rates, single, stops, threads, tool};
use crate::block::Block;
use crate::canon::{Place, Position, X, Z};
use crate::codes::{G, M, group, m_group};
use crate::execute::{self, Output};
use crate::problem::{Blame, Problem, Span, short};
use crate::state::State;

/// What stays in force from block to block, beyond [`State`].
#[derive(Clone, Debug)]
pub(super) struct Modal {
    /// The code of group 01 in force.
    pub(super) motion: G,
    /// G50 S: highest speed of the spindle at G96, 1/min.
    pub(super) highest: Option<f64>,
    /// The last S of G96.
    pub(super) surface: Option<f64>,
    /// The last F of a thread.
    pub(super) lead: Option<f64>,
    /// G50 has set coordinates: G52 would lose them.
    pub(super) preset: bool,
    /// Words of G90, G92 and G94.
    pub(super) single: single::Words,
    /// First lines of the cycles.
    pub(super) first: FirstLines,
    /// A contour is read for its shape: tools and compensation wait for G70.
    pub(super) shape_only: bool,
    /// A move whose end is a corner that is cut off or rounded: it waits for the next move.
    pub(super) pending: Option<Pending>,
}

/// What the first of two lines said, until it says something else.
#[derive(Clone, Debug, Default)]
pub(super) struct FirstLines {
    /// G71, G72: depth of cut (U, W) and retract (R).
    pub(super) rough: [Option<(f64, f64)>; 2],
    /// G73: U, W, R.
    pub(super) pattern: Option<(f64, f64, u32)>,
    /// G74 and G75: R.
    pub(super) retract: Option<f64>,
    /// G76.
    pub(super) thread: Option<threads::First>,
}

impl Default for Modal {
    fn default() -> Modal {
        Modal {
            motion: G(0),
            highest: None,
            surface: None,
            lead: None,
            preset: false,
            single: single::Words::default(),
            first: FirstLines::default(),
            shape_only: false,
            pending: None,
        }
    }
}

impl Modal {
    /// The units change: lengths times a factor. The surface speed is forgotten, it has other units than lengths.
    fn convert(&mut self, factor: f64) {
        self.lead = self.lead.map(|lead| lead * factor);
        self.surface = None;
        self.single.convert(factor);
        let first = &mut self.first;
        for rough in &mut first.rough {
            *rough = rough.map(|(depth, retract)| (depth * factor, retract * factor));
        }
        first.pattern = first.pattern.map(|(x, z, passes)| (x * factor, z * factor, passes));
        first.retract = first.retract.map(|retract| retract * factor);
        if let Some(thread) = &mut first.thread {
            thread.convert(factor);
        }
    }
}

/// Executes all but what concerns flow, contours, and the codes that come last ([`last`]).
///
/// # Errors
/// The block contradicts itself or the state.
pub(super) fn run(
    line: &Line,
    deed: Deed,
    modal: &mut Modal,
    equivalent: &mut Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    if let Some(pending) = modal.pending.take() {
        corner::undisturbed(line)?;
        let next = target(line, pending.end)?;
        corner::close(&pending, deed, next, equivalent, state, out)?;
        return rest(line, deed, Some(pending.end), modal, equivalent, state, out);
    }
    rest(line, deed, None, modal, equivalent, state, out)
}

/// `corner`: where the move before ended as it was programmed, if its end was cut off.
fn rest(
    line: &Line,
    deed: Deed,
    corner: Option<Position>,
    modal: &mut Modal,
    equivalent: &mut Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    units(line, modal, equivalent, state, out)?;
    if !modal.shape_only {
        tool::call(line, state, out)?;
    }
    begin(line, equivalent);
    equivalent.comment.clone_from(&line.block.comment);
    rates::spindle(line, modal, equivalent, state, out)?;
    rates::feed(line, deed, modal, equivalent, state, out)?;
    modes(line, modal, equivalent, state)?;
    stops::modal(line, state, out)?;
    if let Some(code) = line.block.g(group::MOTION) {
        if code != modal.motion {
            modal.single = single::Words::default();
        }
        modal.motion = code;
    }
    // U and W count from the point as these modes show it.
    execute::execute(equivalent, state, out)?;
    begin(line, equivalent);
    stops::begin(line, deed, state, out)?;
    let Deed::G(code) = deed else { return Ok(()) };
    match code.0 {
        0 | 10 | 20 | 30 => {
            let end = target(line, corner.unwrap_or(state.position))?;
            travel(code, line, end, modal, equivalent, state, out)?;
            stops::end(line, modal, state, out)
        }
        40 | 100 | 280 | 300 | 500 | 520 | 530 => {
            once::once(code, line, modal, equivalent, state)?;
            execute::execute(equivalent, state, out)
        }
        320 => threads::single_move(line, modal, state, out),
        760 => threads::cycle(line, modal, state, out),
        900 | 920 | 940 => single::cycle(code, line, modal, equivalent, state, out),
        740 | 750 => pecks::cycle(code, line, modal, equivalent, state, out),
        _ => Ok(()),
    }
}

/// M05, M09 and stops, which act behind the move.
pub(super) fn last(
    line: &Line,
    modal: &Modal,
    equivalent: &mut Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    begin(line, equivalent);
    for group in [m_group::SPINDLE, m_group::FLOOD, m_group::STOP] {
        let acts_last = |code: &M| group == m_group::STOP || matches!(code, M(5 | 9));
        let Some(code) = line.block.m(group).filter(acts_last) else { continue };
        if modal.pending.is_some() {
            return Err(corner::not_at_its_end(code));
        }
        equivalent.add_m(group, code, span_of(line, Blame::M(code)))?;
    }
    if equivalent.is_empty() { Ok(()) } else { execute::execute(equivalent, state, out) }
}

/// Makes the equivalent block an empty one at the place of the line.
pub(super) fn begin(line: &Line, equivalent: &mut Block) {
    equivalent.clear(line.block.file, line.block.line);
    (equivalent.n, equivalent.n_digits) = (line.block.n, line.block.n_digits);
}

pub(super) fn span_of(line: &Line, blame: Blame) -> Span {
    line.block.span(blame).unwrap_or_default()
}

/// G20, G21: before all other words, which count in the new units.
fn units(
    line: &Line,
    modal: &mut Modal,
    equivalent: &mut Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    let Some(code) = line.block.g(group::UNITS) else { return Ok(()) };
    begin(line, equivalent);
    equivalent.add_g(group::UNITS, code, span_of(line, Blame::G(code)))?;
    let before = state.units;
    execute::execute(equivalent, state, out)?;
    if state.units != before {
        modal.convert(before.mm() / state.units.mm());
    }
    Ok(())
}

/// Codes that are the same in both languages.
fn modes(line: &Line, modal: &Modal, equivalent: &mut Block, state: &State) -> Done {
    for group in [group::PLANE, group::COORDINATES, group::COMPENSATION] {
        let Some(code) = line.block.g(group) else { continue };
        let again = code != G(400) && code == state.compensation.code();
        if group != group::COMPENSATION || !again && !modal.shape_only {
            equivalent.add_g(group, code, span_of(line, Blame::G(code)))?;
        }
    }
    for group in [m_group::MIST, m_group::FLOOD] {
        if let Some(code) = line.block.m(group).filter(|code| *code != M(9)) {
            equivalent.add_m(group, code, span_of(line, Blame::M(code)))?;
        }
    }
    Ok(())
}

/// The end point of the words X Z U W; `from` is where the move before ended.
///
/// # Errors
/// X and U, or Z and W, stand in one block.
pub(super) fn target(line: &Line, from: Position) -> Result<Position, Box<Problem>> {
    let mut end = from;
    for (absolute, incremental, axis, scale) in [('X', 'U', X, 0.5), ('Z', 'W', Z, 1.0)] {
        match (line.length(absolute), line.length(incremental)) {
            (Some(_), Some(_)) => {
                let message = format!("{absolute} and {incremental} both move the same axis");
                return Err(Problem::error(
                    "repeated-word",
                    Blame::Word(incremental),
                    message,
                    "leave one of them out",
                ));
            }
            (Some(value), None) => end[axis] = scale * value,
            (None, Some(value)) => end[axis] += scale * value,
            (None, None) => {}
        }
    }
    Ok(end)
}

/// Adds X and Z of a point to the equivalent block, those axes alone that the line names.
pub(super) fn add_point(line: &Line, end: &Position, equivalent: &mut Block) -> Done {
    for (letters, letter, value) in [(['X', 'U'], 'X', 2.0 * end[X]), (['Z', 'W'], 'Z', end[Z])] {
        if let Some(named) = letters.into_iter().find(|letter| line.has(*letter)) {
            equivalent.add(letter, value, span_of(line, Blame::Word(named)))?;
        }
    }
    Ok(())
}

/// G00, G01, G02, G03.
fn travel(
    code: G,
    line: &Line,
    end: Position,
    modal: &mut Modal,
    equivalent: &mut Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    let from = state.position;
    let cut = if code == G(10) { corner::of(line, &from, &end)? } else { None };
    if let Some(cut) = cut {
        modal.pending = Some(Pending { end, cut, place: line.block.place() });
        return Ok(());
    }
    equivalent.add_g(group::MOTION, code, span_of(line, Blame::G(code)))?;
    add_point(line, &end, equivalent)?;
    if matches!(code.0, 20 | 30) {
        if line.length('R').is_some_and(|radius| radius <= 0.0) {
            let message = format!("R{} is no radius", short(line.length('R').unwrap_or(0.0)));
            let help = "R is greater than 0; an arc of more than 180 degrees is written with I and K";
            return Err(Problem::error("bad-value", Blame::Word('R'), message, help));
        }
        for letter in ['I', 'K', 'R'] {
            if let Some(value) = line.length(letter) {
                equivalent.add(letter, value, span_of(line, Blame::Word(letter)))?;
            }
        }
    }
    execute::execute(equivalent, state, out)
}

/// One move to a point (Z, X, a radius); `center` of an arc is seen from its start.
pub(super) fn go(
    code: G,
    end: [f64; 2],
    center: Option<[f64; 2]>,
    place: Place,
    equivalent: &mut Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    let nowhere = Span::default();
    equivalent.clear(place.file, place.line);
    (equivalent.n, equivalent.n_digits) = (place.n, place.n_digits);
    equivalent.add_g(group::MOTION, code, nowhere)?;
    equivalent.add('X', 2.0 * end[1], nowhere)?;
    equivalent.add('Z', end[0], nowhere)?;
    if let Some([k, i]) = center {
        equivalent.add('I', i, nowhere)?;
        equivalent.add('K', k, nowhere)?;
    }
    execute::execute(equivalent, state, out)
}
