//! What one block does: tool, spindle, feed and modes first, then the move or cycle, then M05, M09 and stops.
//!
//! In: a [`Line`] and what it does ([`Deed`]). Out: calls. Most of it is executed as an equivalent block of RS274/NGC:
//!
//! | here | there | | here | there |
//! |---|---|---|---|---|
//! | G98 G99 | G94 G95 | | G50 X Z | G92 X Z |
//! | G96 S, G50 S | G96 S D | | U W | X Z, absolute |
//! | G04 X U P | G4 P | | G10 L2, G28, G30, G52, G53 | the same |

use super::codes::Deed;
use super::corner::{self, Pending};
use super::line::Line;
use super::{Done, pecks, single, threads, tool};
use crate::block::Block;
use crate::canon::{FeedMode, Place, Position, X, Z};
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
    highest: Option<f64>,
    /// The last S of G96.
    surface: Option<f64>,
    /// The last F of a thread.
    pub(super) lead: Option<f64>,
    /// G50 has set coordinates: G52 would lose them.
    preset: bool,
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
    if !modal.shape_only {
        tool::call(line, state, out)?;
    }
    begin(line, equivalent);
    equivalent.comment.clone_from(&line.block.comment);
    spindle(line, modal, equivalent, state, out)?;
    feed(line, deed, modal, equivalent, state, out)?;
    modes(line, modal, equivalent, state)?;
    if let Some(code) = line.block.g(group::MOTION) {
        if code != modal.motion {
            modal.single = single::Words::default();
        }
        modal.motion = code;
    }
    let Deed::G(code) = deed else { return execute::execute(equivalent, state, out) };
    match code.0 {
        0 | 10 | 20 | 30 => {
            let end = target(line, corner.unwrap_or(state.position))?;
            return travel(code, line, end, modal, equivalent, state, out);
        }
        40 | 100 | 280 | 300 | 500 | 520 | 530 => {
            once(code, line, modal, equivalent, state)?;
            return execute::execute(equivalent, state, out);
        }
        _ => {}
    }
    execute::execute(equivalent, state, out)?;
    match code.0 {
        320 => threads::single_move(line, modal, state, out),
        760 => threads::cycle(line, modal, state, out),
        900 | 920 | 940 => single::cycle(code, line, modal, equivalent, state, out),
        740 | 750 => pecks::cycle(code, line, modal, equivalent, state, out),
        _ => Ok(()),
    }
}

/// M05, M09 and stops, which act behind the move.
pub(super) fn last(line: &Line, modal: &Modal, equivalent: &mut Block, state: &mut State, out: &mut Output) -> Done {
    let stop = line.block.m(m_group::STOP);
    if let (Some(code), Some(pending)) = (stop, &modal.pending) {
        return Err(corner::alone(pending, &code.to_string()));
    }
    begin(line, equivalent);
    let off = [(m_group::SPINDLE, M(5)), (m_group::FLOOD, M(9))];
    for (group, code) in off {
        if line.block.m(group) == Some(code) {
            equivalent.add_m(group, code, Span::default())?;
        }
    }
    if let Some(code) = stop {
        equivalent.add_m(m_group::STOP, code, span_of(line, Blame::M(code)))?;
    }
    if equivalent.is_empty() { Ok(()) } else { execute::execute(equivalent, state, out) }
}

/// Makes the equivalent block an empty one at the place of the line.
pub(super) fn begin(line: &Line, equivalent: &mut Block) {
    equivalent.clear(line.block.file, line.block.line);
    (equivalent.n, equivalent.n_digits) = (line.block.n, line.block.n_digits);
}

fn span_of(line: &Line, blame: Blame) -> Span {
    line.block.span(blame).unwrap_or_default()
}

/// S, G96 G97, G50 S, M03 M04.
fn spindle(line: &Line, modal: &mut Modal, equivalent: &mut Block, state: &State, out: &mut Output) -> Done {
    let span = span_of(line, Blame::Word('S'));
    let limit = line.block.g(group::ONCE) == Some(G(500)) && line.has('S');
    let mode = line.block.g(group::SPINDLE_MODE);
    let mut speed = line.plain('S');
    if limit {
        modal.highest = speed.take().filter(|highest| *highest > 0.0);
    }
    let surface = match mode {
        Some(code) => code == G(960),
        None => state.spindle.constant_surface.is_some(),
    };
    if let (Some(G(970)), None, true) = (mode, speed, state.spindle.constant_surface.is_some()) {
        let message = "G97 behind G96 needs S: the speed in force is a surface speed";
        return Err(Problem::error("missing-word", Blame::G(G(970)), message, "add S in 1/min, such as G97 S1200"));
    }
    if surface {
        modal.surface = speed.or(modal.surface);
        speed = speed.or(modal.surface.filter(|_| mode.is_some()));
    }
    match mode {
        Some(G(960)) => {
            if speed.is_none() {
                let message = "G96 needs S, the surface speed";
                return Err(Problem::error("missing-word", Blame::G(G(960)), message, "add S in m/min, such as G96 S180"));
            }
            if modal.highest.is_none() {
                let message = "G96 without G50 S before it: nothing bounds the speed of the spindle as X comes near 0";
                let help = "give the highest speed, 1/min, such as G50 S2500";
                out.warn(Problem::warning("no-highest-speed", Blame::G(G(960)), message, help));
            }
            equivalent.add_g(group::SPINDLE_MODE, G(960), span_of(line, Blame::G(G(960))))?;
            equivalent.add('D', modal.highest.unwrap_or(1e30), span)?;
        }
        Some(code) => equivalent.add_g(group::SPINDLE_MODE, code, span_of(line, Blame::G(code)))?,
        None if limit && surface => {
            equivalent.add_g(group::SPINDLE_MODE, G(960), span)?;
            equivalent.add('D', modal.highest.unwrap_or(1e30), span)?;
            speed = Some(state.spindle.speed);
        }
        None => {}
    }
    if let Some(speed) = speed {
        equivalent.add('S', speed, span)?;
    }
    match line.block.m(m_group::SPINDLE).filter(|code| *code != M(5)) {
        Some(code) => equivalent.add_m(m_group::SPINDLE, code, span_of(line, Blame::M(code))),
        None => Ok(()),
    }
}

/// F, G98 G99. F of a thread under G98 is a lead only.
fn feed(
    line: &Line,
    deed: Deed,
    modal: &mut Modal,
    equivalent: &mut Block,
    state: &State,
    out: &mut Output,
) -> Done {
    let mut mode = state.feed_mode;
    if let Some(code) = line.block.g(group::FEED_MODE) {
        let (new, there) = match code.0 {
            980 => (FeedMode::PerMinute, G(940)),
            _ => (FeedMode::PerRevolution, G(950)),
        };
        if new != mode {
            equivalent.add_g(group::FEED_MODE, there, span_of(line, Blame::G(code)))?;
        }
        mode = new;
    }
    let Some(value) = line.plain('F') else { return Ok(()) };
    let thread = matches!(deed, Deed::G(G(320 | 920 | 760)));
    if thread {
        modal.lead = Some(value);
    }
    if line.is_bare('F') && (thread || mode == FeedMode::PerRevolution) && value != 0.0 {
        let message = format!("F{value} has no decimal point: it is taken as {value} per revolution");
        let help = format!("some controls count hundredths or less here; write F{value}. to be sure");
        out.warn(Problem::warning("no-decimal-point", Blame::Word('F'), message, help));
    }
    if thread && mode == FeedMode::PerMinute {
        return Ok(());
    }
    equivalent.add('F', value, span_of(line, Blame::Word('F')))
}

/// Codes that are the same in both languages.
fn modes(line: &Line, modal: &Modal, equivalent: &mut Block, state: &State) -> Done {
    for group in [group::PLANE, group::UNITS, group::COORDINATES, group::COMPENSATION] {
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
                return Err(Problem::error("repeated-word", Blame::Word(incremental), message, "leave one of them out"));
            }
            (Some(value), None) => end[axis] = scale * value,
            (None, Some(value)) => end[axis] += scale * value,
            (None, None) => {}
        }
    }
    Ok(end)
}

/// Adds X and Z of a point to the equivalent block, those axes alone that the line names.
fn add_point(line: &Line, end: &Position, equivalent: &mut Block) -> Done {
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
    if code == G(10) {
        if let Some(cut) = corner::of(line, &from, &end)? {
            execute::execute(equivalent, state, out)?;
            modal.pending = Some(Pending { end, cut, place: line.block.place() });
            return Ok(());
        }
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

/// Codes that act in their own block only.
fn once(code: G, line: &Line, modal: &mut Modal, equivalent: &mut Block, state: &State) -> Done {
    let span = span_of(line, Blame::G(code));
    let end = target(line, state.position)?;
    match code.0 {
        40 => {
            equivalent.add_g(group::ONCE, G(40), span)?;
            return equivalent.add('P', dwell(line)?, span);
        }
        100 => return origin(line, equivalent),
        500 => {
            modal.preset = true;
            equivalent.add_g(group::ONCE, G(920), span)?;
        }
        520 if modal.preset => {
            let message = "G52 behind G50 X Z: one shift would take the place of the other";
            return Err(Problem::error("not-available", Blame::G(code), message, "use G54 to G59, or G50 alone"));
        }
        530 if line.has_any("UW") => {
            let message = "G53 names a place of the machine: U and W are no place";
            return Err(Problem::error("unused-word", Blame::G(code), message, "use X and Z"));
        }
        300 if line.whole('P')?.is_some_and(|p| p != 2) => {
            let message = "there are two reference points: G28, and G30 or G30 P2";
            return Err(Problem::error("not-available", Blame::Word('P'), message, "leave P out"));
        }
        530 => {
            equivalent.add_g(group::MOTION, G(0), span)?;
            equivalent.add_g(group::ONCE, code, span)?;
        }
        _ => equivalent.add_g(group::ONCE, code, span)?,
    }
    if code == G(520) {
        for (letter, value) in [('X', line.length('X')), ('Z', line.length('Z'))] {
            if let Some(value) = value {
                equivalent.add(letter, value, span)?;
            }
        }
        return Ok(());
    }
    if !line.has_any("XZUW") {
        let message = format!("{code} needs the axes that it is for");
        return Err(Problem::error("missing-word", Blame::G(code), message, "add X, Z, U or W, such as U0 W0"));
    }
    add_point(line, &end, equivalent)
}

/// G04: seconds. P counts milliseconds.
fn dwell(line: &Line) -> Result<f64, Box<Problem>> {
    let given: Vec<char> = ['X', 'U', 'P'].into_iter().filter(|letter| line.has(*letter)).collect();
    let [letter] = given.as_slice() else {
        let message = "G04 needs one time";
        return Err(Problem::error("missing-word", Blame::G(G(40)), message, "write X or U in s, or P in ms"));
    };
    let seconds = match letter {
        'P' => line.whole('P')?.map_or(0.0, |milliseconds| milliseconds as f64 / 1000.0),
        // Without a decimal point these are milliseconds in any units.
        _ if line.is_bare(*letter) => line.plain(*letter).unwrap_or(0.0) / 1000.0,
        _ => line.plain(*letter).unwrap_or(0.0),
    };
    if seconds < 0.0 {
        let message = format!("a dwell of {} s", short(seconds));
        return Err(Problem::error("bad-value", Blame::Word(*letter), message, "give a time of 0 or more"));
    }
    Ok(seconds)
}

/// G10 L2 P X Z.
fn origin(line: &Line, equivalent: &mut Block) -> Done {
    let (Some(2), Some(system @ 1..=6)) = (line.whole('L')?, line.whole('P')?) else {
        let message = "of G10 there is L2 P1 to P6, which sets the offset of G54 to G59";
        let help = "keep the offsets of tools in the tool table";
        return Err(Problem::error("not-available", Blame::G(G(100)), message, help));
    };
    equivalent.add_g(group::ONCE, G(100), span_of(line, Blame::G(G(100))))?;
    equivalent.add('L', 2.0, span_of(line, Blame::Word('L')))?;
    equivalent.add('P', system as f64, span_of(line, Blame::Word('P')))?;
    for letter in ['X', 'Z'] {
        if let Some(value) = line.length(letter) {
            equivalent.add(letter, value, span_of(line, Blame::Word(letter)))?;
        }
    }
    Ok(())
}
