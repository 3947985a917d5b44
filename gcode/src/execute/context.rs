//! M70 to M73: save the modes and restore them, at once or by the return from a subroutine.
//!
//! A restoring builds the block that would set what has changed and executes it, so the calls come in the
//! usual order.

use super::{Done, Output, execute};
use crate::block::Block;
use crate::canon::{FeedMode, PathMode, Plane, Turn, Units};
use crate::codes::{G, M, g_group, group, m_group, system_code};
use crate::problem::{Blame, Problem, Span};
use crate::state::{Context, G92_APPLIED, Saved, State};

/// M70 saves, M71 forgets, M72 restores, M73 saves and has the return restore.
pub(super) fn save_or_restore(code: M, state: &mut State, out: &mut Output) -> Done {
    let level = state.progress.call_level;
    match code.0 {
        71 => state.contexts.set(level, Context::default()),
        72 => {
            let Some(saved) = state.contexts.at(level).copied() else {
                let message = "M72 has nothing to restore: nothing was saved in this subroutine";
                return Err(Problem::error(
                    "nothing-saved",
                    Blame::M(code),
                    message,
                    "save with M70 or M73 first",
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
            let context = Context { saved: Some(saved(state)), on_return: on_return && level > 0 };
            state.contexts.set(level, context);
        }
    }
    Ok(())
}

fn saved(state: &State) -> Saved {
    Saved {
        feed: state.modes.feed,
        spindle: state.spindle,
        path: state.modes.path,
        coolant: state.coolant,
        overrides: state.overrides,
        g: g_codes_of(state),
    }
}

/// A subroutine has been entered, which made `call_level` its level.
pub(crate) fn on_call(state: &mut State) {
    state.contexts.take(state.progress.call_level);
}

/// A subroutine is left; `call_level` is still its level.
///
/// # Errors
/// A saved mode cannot be restored.
pub(crate) fn on_return(state: &mut State, out: &mut Output) -> Done {
    match state.contexts.take(state.progress.call_level) {
        Context { saved: Some(saved), on_return: true } => restore(&saved, state, out),
        _ => Ok(()),
    }
}

/// The G codes in force, in the order of LinuxCNC's list of them.
fn g_codes_of(state: &State) -> [G; 12] {
    let pick = |first: bool, codes: [u16; 2]| G(codes[usize::from(!first)]);
    [
        G(match state.modes.plane {
            Plane::Xy => 170,
            Plane::Xz => 180,
            Plane::Yz => 190,
        }),
        state.compensation.code(),
        pick(state.units.program() == Units::Inch, [200, 210]),
        pick(state.modes.incremental, [910, 900]),
        G(match state.modes.feed_mode {
            FeedMode::InverseTime => 930,
            FeedMode::PerMinute => 940,
            FeedMode::PerRevolution => 950,
        }),
        system_code(state.axes.system()),
        pick(state.axes.tool_offset() == [0.0; 6], [490, 430]),
        pick(state.modes.retract_to_start, [980, 990]),
        pick(state.spindle.constant_surface.is_some(), [960, 970]),
        pick(state.modes.absolute_centers, [901, 911]),
        pick(state.modes.diameter, [70, 80]),
        pick(state.parameter(G92_APPLIED) != 0.0, [923, 922]),
    ]
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
    let off = state.coolant.mist && !saved.coolant.mist || state.coolant.flood && !saved.coolant.flood;
    if off {
        codes.push((M(9), None));
    }
    if saved.coolant.mist && (off || !state.coolant.mist) {
        codes.push((M(7), None));
    }
    if saved.coolant.flood && (off || !state.coolant.flood) {
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

/// Fills the block that restores feed, speed and G codes. F and S are always in it, and G64 unless
/// compensation is on, where only a path mode that has changed is restored, and refused.
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
    let changed =
        saved.path.mode != state.modes.path.mode || saved.path.naivecam != state.modes.path.naivecam;
    if !changed && state.compensation.is_on() {
        return Ok(());
    }
    let path = match saved.path.mode {
        PathMode::ExactPath => G(610),
        PathMode::ExactStop => G(611),
        PathMode::Continuous(tolerance) => {
            block.add('P', tolerance, nowhere)?;
            if saved.path.naivecam_programmed {
                block.add('Q', saved.path.naivecam, nowhere)?;
            }
            G(640)
        }
    };
    if path == G(640) || saved.path.mode != state.modes.path.mode {
        block.add_g(group::PATH, path, nowhere)?;
    }
    Ok(())
}
