//! Rigid taps: G84 of a lathe, G84 and G74 of a mill. M29 announces them, and the spindle turns round in step
//! with Z: in with the hand of the code, out the other way.
//!
//! In: `M29 S`, `G84 Z R P F Q`. F is the lead under G99 of a lathe and G95 of a mill, else F/S is. Out: taps
//! from R to the bottom, Q deeper each time, every one of them out to R again, as FANUC does with the
//! parameter of full retraction. A spindle that stood stands behind them; one that turned turns on.
//!
//! Without M29 a FANUC control taps rigidly by a parameter (5200.0), Haas always does. A tap that goes at F =
//! lead times S in a floating holder goes at the same place rigidly, so it is taken as rigid, and that is
//! told.

use super::execution::Execution;
use crate::bounds::MOST_PECKS;
use crate::canon::{Call, FeedMode, Turn};
use crate::codes::G;
use crate::execute::Done;
use crate::problem::{Blame, Problem, short};
use crate::state::{Rigid, depths};

/// The finest taps of ISO 1501 have a pitch of 0.08 mm, those in shops 0.2 mm and more: less is a feed that
/// was meant as a lead.
const FINEST_MM: f64 = 0.07;

/// The lead of a tap, and its pecks.
///
/// # Errors
/// Speed or feed are missing or make no lead, G96 is on, there are too many pecks.
pub(super) fn rigid(code: G, way: f64, peck: f64, run: &mut Execution) -> Result<Rigid, Box<Problem>> {
    let refuse = |kind, blame, message: String, help: &str| Err(Problem::error(kind, blame, message, help));
    let (speed, feed) = (run.state.spindle.speed, run.state.modes.feed);
    if run.state.spindle.constant_surface.is_some() {
        let message = format!("{code} under G96: a tap has one speed");
        return refuse("bad-value", Blame::G(code), message, "select G97 and S in 1/min before it");
    }
    if speed <= 0.0 {
        let message = format!("{code} needs S, the speed of the tap");
        return refuse("missing-word", Blame::G(code), message, "give it with M29, as in M29 S500");
    }
    if feed <= 0.0 {
        let message = format!("{code} needs F, which says the lead");
        return refuse(
            "missing-word",
            Blame::G(code),
            message,
            "add F: the lead, or lead times S per minute",
        );
    }
    if peck < 0.0 || peck > 0.0 && way.abs() / peck > MOST_PECKS {
        let message = format!("Q{} cannot be the depth of a peck of {code}", short(peck));
        return refuse(
            "bad-value",
            Blame::Word('Q'),
            message,
            "Q is greater than 0 and takes at most some thousand pecks",
        );
    }
    if !run.modal.rigid {
        let message =
            format!("{code} without M29 is tapped rigidly, as Haas does; FANUC does so by parameter 5200.0");
        let help = "write M29 S before it; a floating holder does no harm";
        run.out.warn(Problem::warning("rigid-tap", Blame::G(code), message, help));
        run.modal.rigid = true;
    }
    let by_minute = run.state.modes.feed_mode == FeedMode::PerMinute;
    let lead = if by_minute { feed / speed } else { feed };
    let units = run.state.units;
    if by_minute && lead * units.mm() < FINEST_MM {
        let message = format!(
            "F{} a minute at S{} makes a lead of {}: no tap is that fine",
            short(feed),
            short(speed),
            units.program().length(lead * units.mm())
        );
        let help = "give F as lead times S, or select feeds per revolution (G99 of a lathe, G95 of a mill)";
        run.out.warn(Problem::warning("tap-lead", Blame::Word('F'), message, help));
    }
    Ok(Rigid { lead, peck })
}

/// G84 of a lathe, the tool at R.
///
/// # Errors
/// As [`rigid`]; the spindle turns the other way; what the receiver refuses.
pub(super) fn lathe(code: G, [r, bottom, peck, dwell_s]: [f64; 4], run: &mut Execution) -> Done {
    let Rigid { lead, peck } = rigid(code, bottom - r, peck, run)?;
    let before = run.state.spindle.turning;
    if before == Some(Turn::Counterclockwise) {
        let message = format!("the spindle turns counterclockwise, and {code} taps right-hand threads");
        return Err(Problem::error(
            "spindle-direction",
            Blame::G(code),
            message,
            "use M03, or M05 before it",
        ));
    }
    if before.is_none() {
        run.out.call(Call::StartSpindle(Turn::Clockwise))?;
    }
    for depth in depths(r, bottom, peck) {
        let mut to = run.state.axes.position;
        to[crate::canon::Z] = depth;
        run.out.call(Call::StartSpeedFeedSynch { lead, velocity: false, start_deg: 0.0, growth: 0.0 })?;
        run.out.call(Call::RigidTap(to, 1.0, dwell_s))?;
        run.out.call(Call::StopSpeedFeedSynch)?;
    }
    if before.is_none() { run.out.call(Call::StopSpindle) } else { Ok(()) }
}
