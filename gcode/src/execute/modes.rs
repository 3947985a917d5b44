//! Modes that only change the state: planes, units, G7 G8, distance, feed, path and retract modes, and F.

use super::{Done, Output, check, compensation};
use crate::block::Block;
use crate::canon::{Call, FeedMode, PathMode, Plane, Units};
use crate::codes::G;
use crate::problem::{Blame, Problem, short};
use crate::state::State;

/// G93, G94, G95. G94 and G95 forget F, which may have had another meaning, even where they are in force
/// already; after G93 it is the block of each move that has an F.
pub(super) fn feed_mode(code: G, state: &mut State, out: &mut Output) -> Done {
    let (mode, note) = match code.0 {
        930 => (FeedMode::InverseTime, "feed mode set to inverse time"),
        950 => (FeedMode::PerRevolution, "feed mode set to units per revolution"),
        _ => (FeedMode::PerMinute, "feed mode set to units per minute"),
    };
    out.call(Call::Note(note))?;
    out.call(Call::SetFeedMode(mode))?;
    state.modes.feed_mode = mode;
    if mode != FeedMode::InverseTime {
        state.modes.feed = 0.0;
        out.call(Call::SetFeedRate(0.0))?;
    }
    Ok(())
}

/// F. Under G93 it belongs to the move of the block, which `motion` is if there is one.
pub(super) fn feed(block: &Block, motion: Option<G>, state: &mut State, out: &mut Output) -> Done {
    let Some(feed) = block.get('F') else { return Ok(()) };
    if state.modes.feed_mode == FeedMode::InverseTime {
        if matches!(motion, None | Some(G(0 | 800))) {
            let message = "F does nothing here: under G93 it is for the move of its block alone";
            let help = "write it into the block of the move";
            out.warn(Problem::warning("no-effect", Blame::Word('F'), message, help));
        }
        return Ok(());
    }
    if feed < 0.0 {
        let message = format!("the feed F{} is negative", short(feed));
        return Err(Problem::error("bad-value", Blame::Word('F'), message, "give a feed greater than 0"));
    }
    state.modes.feed = feed;
    out.call(Call::SetFeedRate(feed))
}

/// The other modal codes.
pub(super) fn set(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    match code.0 {
        170 | 180 | 190 | 171 | 181 | 191 => plane(code, state, out),
        200 | 210 => units(code, state, out),
        70 | 80 => diameter(code.0 == 70, state, out),
        610 | 611 | 640 => path(code, block, state, out),
        900 | 910 => {
            let notes = ["distance mode changed to absolute", "distance mode changed to incremental"];
            switch(&mut state.modes.incremental, code.0 == 910, notes, out)
        }
        901 | 911 => {
            let notes = ["IJK distance mode changed to incremental", "IJK distance mode changed to absolute"];
            switch(&mut state.modes.absolute_centers, code.0 == 901, notes, out)
        }
        _ => retract(code, state, out),
    }
}

fn switch(mode: &mut bool, on: bool, notes: [&str; 2], out: &mut Output) -> Done {
    if *mode == on {
        return Ok(());
    }
    *mode = on;
    out.call(Call::Note(notes[usize::from(on)]))
}

fn diameter(on: bool, state: &mut State, out: &mut Output) -> Done {
    let notes = ["Lathe diameter mode changed to radius", "Lathe diameter mode changed to diameter"];
    switch(&mut state.modes.diameter, on, notes, out)
}

fn plane(code: G, state: &mut State, out: &mut Output) -> Done {
    let plane = match code.0 {
        170 => Plane::Xy,
        180 => Plane::Xz,
        190 => Plane::Yz,
        _ => {
            let message = format!("{code} selects a plane of the axes U, V, W, which are not available");
            return Err(Problem::error("not-available", Blame::G(code), message, "use G17, G18 or G19"));
        }
    };
    if plane != state.modes.plane {
        check::compensation_off(Blame::G(code), "change the plane", state)?;
    }
    state.modes.plane = plane;
    out.call(Call::SelectPlane(plane))
}

/// G20 and G21: positions and offsets keep their place.
fn units(code: G, state: &mut State, out: &mut Output) -> Done {
    let units = if code.0 == 200 { Units::Inch } else { Units::Millimetre };
    out.call(Call::UseLengthUnits(units))?;
    if units == state.units.program() {
        return Ok(());
    }
    let factor = state.units.change(units);
    let whole = !state.settings.stand_alone;
    state.axes.scale(factor, whole);
    compensation::scale(factor, state, out);
    state.cycle.scale(factor);
    state.spline.onwards = None;
    if whole {
        state.modes.scale(factor);
    }
    Ok(())
}

/// G61, G61.1, G64 P Q R.
fn path(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "change the path mode", state)?;
    let negative = ['P', 'Q'].into_iter().find(|letter| block.get(*letter).is_some_and(|value| value < 0.0));
    if let Some(letter) = negative.filter(|_| !state.settings.stand_alone) {
        let message = format!("{letter}{} is not a tolerance", short(block.get(letter).unwrap_or(0.0)));
        let help = "give a length, 0 or greater; without P and Q the path may be left by as much as the machine allows";
        return Err(Problem::error("bad-value", Blame::Word(letter), message, help));
    }
    let given = |letter| block.get(letter).filter(|value| *value >= 0.0);
    let mode = match code.0 {
        610 => PathMode::ExactPath,
        611 => PathMode::ExactStop,
        _ => PathMode::Continuous(given('P').unwrap_or(0.0)),
    };
    if let Some(hardness) = block.get('R').filter(|_| code == G(640)) {
        out.call(Call::SetPlannerMode((hardness > 0.0).then(|| hardness.clamp(0.1, 1.0))))?;
    }
    state.modes.path.mode = mode;
    out.call(Call::SetMotionControlMode(mode))?;
    if let PathMode::Continuous(tolerance) = mode {
        state.modes.path.naivecam = given('Q').unwrap_or(tolerance);
        state.modes.path.naivecam_programmed = given('Q').is_some();
        out.call(merge(state))?;
    }
    Ok(())
}

/// What is in force of G64 Q.
pub(super) fn merge(state: &State) -> Call<'static> {
    Call::SetNaivecamTolerance {
        tolerance: state.modes.path.naivecam,
        programmed: state.modes.path.naivecam_programmed,
    }
}

fn retract(code: G, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "change the retract mode", state)?;
    state.modes.retract_to_start = code.0 == 980;
    out.call(Call::Note(match state.modes.retract_to_start {
        true => "retract mode set to old_z",
        false => "retract mode set to r_plane",
    }))
}
