//! M0 M1 M60, M2 M30 with what they put back, and the end of a tape.

use super::{Done, Output, compensation, coordinates};
use crate::canon::{Call, FeedMode, Plane};
use crate::codes::{G, M};
use crate::state::{Compensation, SYSTEM, State};

/// M0, M1, M60, M2, M30.
pub(super) fn stop(code: M, state: &mut State, out: &mut Output) -> Done {
    compensation::flush(state, out)?;
    match code.0 {
        0 => out.call(Call::ProgramStop),
        1 => out.call(Call::OptionalProgramStop),
        60 => {
            out.call(Call::PalletShuttle)?;
            out.call(Call::ProgramStop)
        }
        _ => end(code, state, out),
    }
}

/// M2 and M30: G54 G17 G90 G94 G40 G97 M5 M9 M48 G1, and F is forgotten. S stays, and the shift of G92 unless
/// the machine forgets it.
fn end(code: M, state: &mut State, out: &mut Output) -> Done {
    state.set_parameter(SYSTEM, 1.0);
    coordinates::enter(1, state);
    out.call(Call::SetG5xOffset(1, state.axes.g5x()))?;
    out.call(Call::SetXyRotation(state.axes.rotation()))?;
    if state.modes.plane != Plane::Xy {
        state.modes.plane = Plane::Xy;
        out.call(Call::SelectPlane(Plane::Xy))?;
    }
    (state.modes.incremental, state.modes.feed_mode, state.modes.feed) = (false, FeedMode::PerMinute, 0.0);
    out.call(Call::SetFeedMode(FeedMode::PerMinute))?;
    out.call(Call::SetFeedRate(0.0))?;
    if !state.overrides.feed {
        out.call(Call::EnableFeedOverride(true))?;
    }
    if !state.overrides.speed {
        out.call(Call::EnableSpeedOverride(true))?;
    }
    (state.overrides.feed, state.overrides.speed) = (true, true);
    state.compensation = Compensation::default();
    (state.spindle.turning, state.spindle.constant_surface) = (None, None);
    out.call(Call::StopSpindle)?;
    out.call(Call::SetSpindleMode(0.0))?;
    state.modes.motion = Some(G(10));
    if std::mem::take(&mut state.coolant.mist) {
        out.call(Call::MistOff)?;
    }
    if std::mem::take(&mut state.coolant.flood) {
        out.call(Call::FloodOff)?;
    }
    if state.settings.forgets_g92 {
        coordinates::suspend(G(921), state, out)?;
    }
    if code == M(30) {
        out.call(Call::PalletShuttle)?;
    }
    state.progress.ended = true;
    out.call(Call::ProgramEnd)?;
    out.call(Call::OnReset)
}

/// The second `%` of a tape: the text ends without M2.
pub(crate) fn finish(state: &mut State, out: &mut Output) -> Done {
    compensation::flush(state, out)?;
    state.progress.ended = true;
    out.call(Call::Finish)?;
    out.call(Call::OnReset)
}
