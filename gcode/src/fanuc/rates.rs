//! Speed and feed: S, G96 G97, G50 S, M03 M04; F, G98 G99.
//!
//! In: a run.line. Out: the words of the equivalent block: G96 with D, G94 and G95.

use std::f64::consts::PI;

use super::codes::{self, Deed};
use super::execution::Execution;
use crate::bounds::NO_HIGHEST_SPEED;
use crate::canon::{FeedMode, Units, X};
use crate::codes::{G, M, group, m_group};
use crate::execute::Done;
use crate::problem::{Blame, Problem};

/// S, G96 G97, G50 S, M03 M04.
pub(super) fn spindle(run: &mut Execution) -> Done {
    let span = run.span_of(Blame::Word('S'));
    let of_g92 = run.line.block.g(group::MOTION) == Some(G(920)) && codes::is_idle(G(920), run.line);
    let limit = (run.line.block.g(group::ONCE) == Some(G(500)) || of_g92) && run.line.has('S');
    let mode = run.line.block.g(group::SPINDLE_MODE);
    let mut speed = run.line.plain('S');
    if limit {
        run.modal.highest = speed.take().filter(|highest| *highest > 0.0);
    }
    let surface = match mode {
        Some(code) => code == G(960),
        None => run.state.spindle.constant_surface.is_some(),
    };
    if let (Some(G(970)), None, true) = (mode, speed, run.state.spindle.constant_surface.is_some()) {
        speed = Some(held(run)?);
    }
    if surface {
        run.modal.surface = speed.or(run.modal.surface);
        speed = speed.or(run.modal.surface.filter(|_| mode.is_some()));
    }
    match mode {
        Some(G(960)) => {
            if speed.is_none() {
                let message = "G96 needs S, the surface speed";
                return Err(Problem::error(
                    "missing-word",
                    Blame::G(G(960)),
                    message,
                    "add S in m/min, such as G96 S180",
                ));
            }
            if run.modal.highest.is_none() {
                let message =
                    "G96 without G50 S before it: nothing limits the speed of the spindle as X comes near 0";
                let help = "give the highest speed, 1/min, such as G50 S2500";
                run.out.warn(Problem::warning("no-highest-speed", Blame::G(G(960)), message, help));
            }
            run.add_g(group::SPINDLE_MODE, G(960))?;
            run.equivalent.add('D', run.modal.highest.unwrap_or(NO_HIGHEST_SPEED), span)?;
        }
        Some(code) => run.add_g(group::SPINDLE_MODE, code)?,
        None if limit && surface => {
            run.equivalent.add_g(group::SPINDLE_MODE, G(960), span)?;
            run.equivalent.add('D', run.modal.highest.unwrap_or(NO_HIGHEST_SPEED), span)?;
            speed = Some(run.state.spindle.speed);
        }
        None => {}
    }
    if let Some(speed) = speed {
        run.equivalent.add('S', speed, span)?;
    }
    match run.line.block.m(m_group::SPINDLE).filter(|code| *code != M(5)) {
        Some(code) => run.add_m(m_group::SPINDLE, code),
        None => Ok(()),
    }
}

/// G97 without S: the spindle keeps the speed that G96 gives it where the tool is, 1/min.
fn held(run: &Execution) -> Result<f64, Box<Problem>> {
    let (steps, diameter) = match run.line.units {
        Some(Units::Inch) => (12.0, 2.0 * run.state.axes.position[X].abs()),
        _ => (1000.0, 2.0 * run.state.axes.position[X].abs()),
    };
    let speed = run.state.spindle.speed * steps / (PI * diameter);
    let speed = run.modal.highest.map_or(speed, |highest| speed.min(highest));
    if speed <= NO_HIGHEST_SPEED {
        return Ok(speed.round());
    }
    let message = "G97 without S keeps the speed of the spindle, and at X0 nothing bounds it";
    let help = "add S in 1/min, such as G97 S1200, or G50 S before G96";
    Err(Problem::error("missing-word", Blame::G(G(970)), message, help))
}

/// F, G98 G99. F of a thread under G98 is a lead only.
pub(super) fn feed(deed: Deed, run: &mut Execution) -> Done {
    let mut mode = run.state.modes.feed_mode;
    if let Some(code) = run.line.block.g(group::FEED_MODE) {
        let (new, there) = match code.0 {
            980 => (FeedMode::PerMinute, G(940)),
            _ => (FeedMode::PerRevolution, G(950)),
        };
        if new != mode {
            let span = run.span_of(Blame::G(code));
            run.equivalent.add_g(group::FEED_MODE, there, span)?;
        }
        mode = new;
    }
    let Some(value) = run.line.plain('F') else { return Ok(()) };
    let thread = matches!(deed, Deed::G(G(320 | 340 | 350 | 360 | 920 | 760)));
    if thread {
        run.modal.lead = Some(value);
    }
    if run.line.is_bare('F') && (thread || mode == FeedMode::PerRevolution) && value != 0.0 {
        let message = format!("F{value} has no decimal point: it is taken as {value} per revolution");
        let help = format!("some controls count hundredths or less here; write F{value}. to be sure");
        run.out.warn(Problem::warning("no-decimal-point", Blame::Word('F'), message, help));
    }
    if thread && mode == FeedMode::PerMinute {
        return Ok(());
    }
    run.add('F', value)
}
