//! M70 to M73: save the modes and restore them, at once or by the return from a subroutine.
//!
//! A restoring builds the block that would set what has changed and executes it, so the calls come in the usual order.

use crate::block::Block;
use crate::canon::{FeedMode, PathMode, Plane, Turn, Units};
use crate::codes::{G, M, g_group, group, m_group};
use crate::problem::{Blame, Problem, Span};
use crate::state::{G92_APPLIED, Overrides, Spindle, State};

use super::{Done, Output, execute};

/// What M70 and M73 saved, by level of subroutine calls.
#[derive(Clone, Debug, Default)]
pub struct Contexts {
    levels: Vec<Context>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Context {
    saved: Option<Saved>,
    /// M73: restored by the return.
    on_return: bool,
}

/// The modes that M70 saves. Motion code, position and offsets are not among them.
#[derive(Clone, Copy, Debug)]
struct Saved {
    feed: f64,
    spindle: Spindle,
    path: PathMode,
    naivecam: f64,
    naivecam_programmed: bool,
    mist: bool,
    flood: bool,
    overrides: Overrides,
    g: [G; 12],
}

impl Saved {
    fn of(state: &State) -> Saved {
        Saved {
            feed: state.feed,
            spindle: state.spindle,
            path: state.path,
            naivecam: state.naivecam,
            naivecam_programmed: state.naivecam_programmed,
            mist: state.mist,
            flood: state.flood,
            overrides: state.overrides,
            g: g_codes_of(state),
        }
    }
}

/// M70 saves, M71 forgets, M72 restores, M73 saves and has the return restore.
pub(super) fn save_or_restore(code: M, state: &mut State, out: &mut Output) -> Done {
    let level = state.call_level as usize;
    let context = at_level(state, level);
    match code.0 {
        71 => *context = Context::default(),
        72 => {
            let Some(saved) = context.saved else {
                let message = "M72 has nothing to restore: nothing was saved in this subroutine";
                return Err(Problem::error(
                    "nothing-saved",
                    Blame::M(code),
                    message,
                    "save with M70 or M73 before",
                ));
            };
            restore(&saved, state, out)?;
        }
        _ => {
            let on_return = code.0 == 73;
            if on_return && level == 0 {
                let message = "M73 outside of a subroutine: there is no return that restores";
                out.warn(Problem::warning(
                    "no-effect",
                    Blame::M(code),
                    message,
                    "use M70, and M72 to restore",
                ));
            }
            let saved = Saved::of(state);
            *at_level(state, level) = Context { saved: Some(saved), on_return: on_return && level > 0 };
        }
    }
    Ok(())
}

fn at_level(state: &mut State, level: usize) -> &mut Context {
    let levels = &mut state.contexts.levels;
    if levels.len() <= level {
        levels.resize(level + 1, Context::default());
    }
    &mut levels[level]
}

/// A subroutine has been entered; [`State::call_level`] is its level.
pub(crate) fn on_call(state: &mut State) {
    let level = state.call_level as usize;
    if let Some(context) = state.contexts.levels.get_mut(level) {
        *context = Context::default();
    }
}

/// A subroutine is left; [`State::call_level`] is still its level.
///
/// # Errors
/// A saved mode cannot be restored.
pub(crate) fn on_return(state: &mut State, out: &mut Output) -> Done {
    let level = state.call_level as usize;
    let Some(context) = state.contexts.levels.get_mut(level) else { return Ok(()) };
    match std::mem::take(context) {
        Context { saved: Some(saved), on_return: true } => restore(&saved, state, out),
        _ => Ok(()),
    }
}

/// The G codes in force, in the order of LinuxCNC's list of them.
fn g_codes_of(state: &State) -> [G; 12] {
    let pick = |first: bool, codes: [u16; 2]| G(codes[usize::from(!first)]);
    [
        G(match state.plane {
            Plane::Xy => 170,
            Plane::Xz => 180,
            Plane::Yz => 190,
        }),
        state.compensation.code(),
        pick(state.units == Units::Inch, [200, 210]),
        pick(state.incremental, [910, 900]),
        G(match state.feed_mode {
            FeedMode::InverseTime => 930,
            FeedMode::PerMinute => 940,
            FeedMode::PerRevolution => 950,
        }),
        system_code(state.system),
        pick(state.tool_offset == [0.0; 6], [490, 430]),
        pick(state.retract_to_start, [980, 990]),
        pick(state.spindle.constant_surface.is_some(), [960, 970]),
        pick(state.absolute_centers, [901, 911]),
        pick(state.diameter, [70, 80]),
        pick(state.parameter(G92_APPLIED) != 0.0, [923, 922]),
    ]
}

/// G54 to G59.3.
pub(super) fn system_code(system: u8) -> G {
    match u16::from(system) {
        system @ 1..=6 => G(530 + 10 * system),
        system => G(584 + system),
    }
}

/// The M codes, some with P, that bring spindle, coolant and overrides back.
fn m_codes_for(saved: &Saved, state: &State) -> Vec<(M, Option<bool>)> {
    let mut codes = Vec::new();
    if saved.spindle.turning != state.spindle.turning {
        let code = match saved.spindle.turning {
            None => M(5),
            Some(Turn::Clockwise) => M(3),
            Some(Turn::Counterclockwise) => M(4),
        };
        codes.push((code, None));
    }
    let off = state.mist && !saved.mist || state.flood && !saved.flood;
    if off {
        codes.push((M(9), None));
    }
    if saved.mist && (off || !state.mist) {
        codes.push((M(7), None));
    }
    if saved.flood && (off || !state.flood) {
        codes.push((M(8), None));
    }
    let (then, now) = (saved.overrides, state.overrides);
    match (then.feed, then.speed) {
        both if both == (now.feed, now.speed) => {}
        (true, true) => codes.push((M(48), None)),
        (false, false) => codes.push((M(49), None)),
        (feed, speed) => codes.extend([(M(50), Some(feed)), (M(51), Some(speed))]),
    }
    if then.adaptive != now.adaptive {
        codes.push((M(52), Some(then.adaptive)));
    }
    if then.hold != now.hold {
        codes.push((M(53), Some(then.hold)));
    }
    codes
}

/// Executes the codes that differ between now and then.
fn restore(saved: &Saved, state: &mut State, out: &mut Output) -> Done {
    let mut block = Block::default();
    block.clear(out.place.file, out.place.line);
    let is_units = |code: &G| g_group(*code) == Some(group::UNITS);
    if let Some(code) = saved.g.iter().find(|code| is_units(code) && !g_codes_of(state).contains(code)) {
        block.add_g(group::UNITS, *code, Span::default())?;
        execute(&block, state, out)?;
        block.clear(out.place.file, out.place.line);
    }
    fill(saved, state, &mut block)?;
    for (code, p) in m_codes_for(saved, state) {
        if p.is_some() && !block.is_empty() {
            execute(&block, state, out)?;
            block.clear(out.place.file, out.place.line);
        }
        if let Some(on) = p {
            block.add('P', f64::from(on), Span::default())?;
        }
        block.add_m(crate::codes::m_group(code).unwrap_or(m_group::SPINDLE), code, Span::default())?;
        execute(&block, state, out)?;
        block.clear(out.place.file, out.place.line);
    }
    if block.is_empty() { Ok(()) } else { execute(&block, state, out) }
}

/// Fills the block that restores feed, speed and G codes. F and S are always in it, and G64 unless compensation is on,
/// where only a path mode that has changed is restored, and refused.
fn fill(saved: &Saved, state: &State, block: &mut Block) -> Done {
    let nowhere = Span::default();
    let now = g_codes_of(state);
    for code in saved.g.iter().filter(|code| !now.contains(code)) {
        let Some(group) = g_group(*code) else { continue };
        block.add_g(group, *code, nowhere)?;
    }
    block.add('F', saved.feed, nowhere)?;
    block.add('S', saved.spindle.speed, nowhere)?;
    let mode = block.g(group::SPINDLE_MODE);
    if let (Some(G(960)), Some(highest)) = (mode, saved.spindle.constant_surface) {
        block.add('D', highest, nowhere)?;
    }
    let changed = saved.path != state.path || saved.naivecam != state.naivecam;
    if !changed && state.compensation.is_on() {
        return Ok(());
    }
    let path = match saved.path {
        PathMode::ExactPath => G(610),
        PathMode::ExactStop => G(611),
        PathMode::Continuous(tolerance) => {
            block.add('P', tolerance, nowhere)?;
            if saved.naivecam_programmed {
                block.add('Q', saved.naivecam, nowhere)?;
            }
            G(640)
        }
    };
    if path == G(640) || saved.path != state.path {
        block.add_g(group::PATH, path, nowhere)?;
    }
    Ok(())
}
