//! Canned cycles along the axis across the plane: G73, G74, G81 to G89.
//!
//! In: a block and the state; the depth is the word of the axis across the plane (Z in G17, Y in G18, X in
//! G19). Out: forevery hole the moves to it, the strokes of the cycle (`hole.rs`), all of them in exact path
//! mode.
//!
//! ```text
//! level L0   where the axis across the plane stood before the first cycle in a row
//! G90        R and depth as programmed;      G91   R from L0, depth from R, holes in steps
//! clear      R (G99), or the higher of R and L0 (G98)
//! first hole (up to R if L0 is below it) · over the hole · down to R;   next holes over at clear, down to R
//! ```
//! What is sticky: R, depth, P, Q, I, J, K, as long as the same cycle is in force.

mod hole;

use super::{Done, Output, feed, modes, straight, thin};
use crate::block::{AXES, Block};
use crate::canon::{Call, FeedMode, PathMode, Plane};
use crate::codes::{G, group};
use crate::problem::{Blame, Problem, short};
use crate::state::{Rigid, State, Sticky};
use hole::{Bar, Hole, Strokes};

/// Whether a code is one of them.
pub(super) fn is_cycle(code: G) -> bool {
    matches!(code.0, 730 | 740 | 810..=890)
}

/// Executes a cycle.
pub(super) fn cycle(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    if state.cycle.refused && block.g(group::MOTION).is_none() {
        return Ok(());
    }
    state.cycle.refused = false;
    straight::some_axis(code, block)?;
    if state.modes.feed_mode == FeedMode::InverseTime {
        let message = format!("{code} makes several moves, and under G93 every move needs an F of its own");
        return Err(Problem::error("bad-value", Blame::G(code), message, "use G94 or G95 and a feed"));
    }
    feed::ready(block, state)?;
    if state.compensation.is_on() {
        let message = format!("{code} while {} is on", state.compensation.code());
        return Err(Problem::error("compensation-on", Blame::G(code), message, "end it with G40 first"));
    }
    let before = match state.cycle.code {
        Some((other, plane)) if plane == state.modes.plane && other == code => state.cycle,
        Some((_, plane)) if plane == state.modes.plane => {
            Sticky { level: state.cycle.level, ..Sticky::default() }
        }
        _ => Sticky::default(),
    };
    let words = words(code, block, state, before)?;
    let repeats = repeats(block)?;
    let pattern = Pattern::new(code, block, state, &words)?;
    if pattern.hole.rigid.is_some() && state.rigid.is_none() {
        out.warn(floating(code, &pattern.hole, state));
    }
    pattern.bound(repeats, block, state)?;
    if matches!(code.0, 730 | 830) && block.has('Q') && words.peck != before.peck {
        let cuts = pattern.hole.peck_count();
        thin::doubt(("a peck", Blame::Word('Q')), words.peck, cuts, state.units.program(), None, out);
    }
    state.cycle = Sticky { code: Some((code, state.modes.plane)), level: Some(pattern.level), ..words };
    pattern.drill(repeats, block, state, out)
}

/// The words of the block, or those that stick. `level` and `code` are those of `before`.
fn words(code: G, block: &Block, state: &State, before: Sticky) -> Result<Sticky, Box<Problem>> {
    let (.., along) = state.modes.plane.axes();
    let sticks = before.code.is_some();
    let missing = |letter: char, what: &str| {
        let message = format!("{code} lacks {letter}, {what}");
        // G18 is the plane of lathes, whose holes are along Z.
        let plane = if letter == 'Y' { "; for a hole along Z write G17 before it" } else { "" };
        let help = format!("add {letter}; it stays for the holes that follow{plane}");
        Problem::error("missing-word", Blame::G(code), message, help)
    };
    let pick = |letter: char, stuck: f64, what: &str| match straight::word(letter, block, state) {
        Some(value) => Ok(value),
        None if sticks => Ok(stuck),
        None => Err(missing(letter, what)),
    };
    let mut words = before;
    words.r = pick('R', before.r, "where the feed begins")?;
    words.depth = pick(AXES[along], before.depth, "the bottom of the hole")?;
    match code.0 {
        820 | 860 | 880 | 890 => words.dwell = pick('P', before.dwell, "the dwell at the bottom in s")?,
        740 | 840 => words.dwell = block.get('P').unwrap_or(before.dwell),
        730 | 830 => words.peck = pick('Q', before.peck, "the depth of a peck")?,
        870 => {
            for (n, letter) in ['I', 'J', 'K'].into_iter().enumerate() {
                words.offset[n] =
                    pick(letter, before.offset[n], "which is part of where the bar passes the hole")?;
            }
        }
        _ => {}
    }
    if words.dwell < 0.0 {
        let message = format!("the dwell P{} is negative", short(words.dwell));
        return Err(Problem::error("bad-value", Blame::Word('P'), message, "give a time in s"));
    }
    if matches!(code.0, 730 | 830) && words.peck <= 0.0 {
        let message = format!("the peck Q{} is not greater than 0", short(words.peck));
        return Err(Problem::error("bad-value", Blame::Word('Q'), message, "give the depth of one peck"));
    }
    Ok(words)
}

/// How far a peck goes back (G73), or how far above its bottom the next one begins to feed (G83): D, which
/// holds for its block, or that of the machine. Program units.
fn clearance(code: G, block: &Block, state: &State) -> Result<f64, Box<Problem>> {
    match block.get('D') {
        Some(value) if value < 0.0 => {
            let message = format!("the clearance D{} is negative", short(value));
            let help = "give how far a peck goes back, 0 or greater";
            Err(Problem::error("bad-value", Blame::Word('D'), message, help))
        }
        Some(value) => Ok(value),
        None => {
            let of_machine = state.settings.peck_clearances[usize::from(code == G(830))];
            Ok(of_machine * state.units.per_machine_unit())
        }
    }
}

/// L.
fn repeats(block: &Block) -> Result<i64, Box<Problem>> {
    let Some(value) = block.get('L') else { return Ok(1) };
    block.integer('L').filter(|count| *count >= 1).ok_or_else(|| {
        let message = format!("L{} cannot be a number of holes", short(value));
        Problem::error("bad-value", Blame::Word('L'), message, "give a whole number from 1 on")
    })
}

/// G84 and G74 where every tap is rigid: F a minute is the lead times S, F a turn the lead. A spindle that
/// stands, or has no speed, makes none.
fn rigid(code: G, state: &State) -> Option<Rigid> {
    let (speed, feed) = (state.spindle.speed, state.modes.feed);
    let taps = state.settings.rigid_taps && matches!(code.0, 740 | 840) && state.spindle.turning.is_some();
    let by_minute = state.modes.feed_mode == FeedMode::PerMinute;
    let lead = if by_minute { feed / speed } else { feed };
    let known = taps && state.spindle.constant_surface.is_none() && lead.is_finite() && lead > 0.0;
    known.then_some(Rigid { lead, peck: 0.0 })
}

/// What an owner of a floating holder has to know.
fn floating(code: G, hole: &Hole, state: &State) -> Box<Problem> {
    let lead = hole.rigid.map_or(0.0, |rigid| rigid.lead) * state.units.mm();
    let message = format!(
        "{code} of LinuxCNC feeds a floating holder at F; here it is tapped in step with the spindle, with a lead of {}",
        state.units.program().length(lead)
    );
    let help = "see that F is the lead times S (G94), or the lead (G95); G33.1 Z K says the lead itself";
    Problem::warning("rigid-tap", Blame::G(code), message, help)
}

/// The holes of a block.
struct Pattern {
    /// What is done in each.
    hole: Hole,
    plane: Plane,
    /// Where the axis across the plane stood before the first cycle in a row.
    level: f64,
    /// Where it is taken to stand now.
    height: f64,
    /// Along the first and second axis: the first hole (G90), or where the tool stands (G91).
    at: [f64; 2],
    /// From hole to hole.
    step: [f64; 2],
    /// From hole to hole in polar coordinates: length and degrees.
    polar_step: [f64; 2],
}

impl Pattern {
    fn new(code: G, block: &Block, state: &State, words: &Sticky) -> Result<Pattern, Box<Problem>> {
        let (first, second, along) = state.modes.plane.axes();
        let height = state.axes.position[along];
        let level = words.level.unwrap_or(height);
        let (r, bottom) = match state.modes.incremental {
            true => (words.r + level, words.r + level + words.depth),
            false => (words.r, words.depth),
        };
        if r < bottom {
            let letter = AXES[along];
            let [shown, r] = [short(bottom), short(r)];
            let message = format!(
                "{code} feeds from R to the bottom, but R is at {letter}{r} and the bottom at {letter}{shown}"
            );
            return Err(Problem::error("bad-value", Blame::Word('R'), message, "put R above the bottom"));
        }
        let here = [state.axes.position[first], state.axes.position[second]];
        let given = [first, second].map(|axis| straight::word(AXES[axis], block, state));
        let mut pattern = Pattern {
            hole: Hole {
                code,
                r,
                bottom,
                clear: if state.modes.retract_to_start { level.max(r) } else { r },
                dwell: words.dwell,
                peck: words.peck,
                back: clearance(code, block, state)?,
                bar: Bar::new(words.offset, bottom, state),
                turning: state.spindle.turning,
                overrides: state.overrides,
                rigid: state.rigid.or_else(|| rigid(code, state)),
            },
            plane: state.modes.plane,
            level,
            height: if level < r { r } else { height },
            at: here,
            step: [0.0; 2],
            polar_step: [0.0; 2],
        };
        pattern.hole.check()?;
        if block.has('@') || block.has('^') {
            straight::check_polar(block, state)?;
        }
        if state.modes.incremental {
            pattern.step = given.map(|word| word.unwrap_or(0.0));
            pattern.polar_step = ['@', '^'].map(|letter| block.get(letter).unwrap_or(0.0));
        } else if block.has('@') || block.has('^') {
            pattern.at =
                straight::polar_point(here, block, state).ok_or_else(|| straight::at_origin(block, state))?;
        } else {
            pattern.at = [0, 1].map(|n| given[n].unwrap_or(here[n]));
        }
        Ok(pattern)
    }

    /// Refuses what would hardly ever end.
    fn bound(&self, repeats: i64, block: &Block, state: &State) -> Done {
        let (holes, most) = (repeats as f64, state.settings.moves_of_block);
        if holes * (2.0 + self.hole.moves()) <= most as f64 {
            return Ok(());
        }
        let code = self.hole.code;
        let message = format!("{code} would make more than {most} moves: the limit moves_of_block");
        let (blame, help) = match (code.0, block.has('Q') || !block.has('L')) {
            (730 | 830, true) => ('Q', "give a greater Q"),
            _ => ('L', "give a smaller L"),
        };
        Err(Problem::error("bad-value", Blame::Word(blame), message, help))
    }

    /// Sends all the holes; the state is then above the last.
    fn drill(mut self, repeats: i64, block: &Block, state: &mut State, out: &mut Output) -> Done {
        let (first, second, along) = self.plane.axes();
        let r = self.hole.r;
        if self.height < r && self.level >= r {
            let message = format!(
                "the tool stands below R and goes to the first hole on a slant, up to {}{}",
                AXES[along],
                short(self.hole.clear)
            );
            let help = "move up before the cycle where R is raised, or use G98";
            out.warn(Problem::warning("slanting-rapid", Blame::Word('R'), message, help));
        }
        if self.level < r {
            state.axes.position[along] = r;
            out.call(Call::StraightTraverse(state.axes.position))?;
        }
        if self.hole.code == G(880) {
            let message = "G88 stops in the hole, and what follows takes the tool to be out of it";
            let help = "move the tool out by hand at the stop, or use G86";
            out.warn(Problem::warning("retract-by-hand", Blame::G(G(880)), message, help));
        }
        let exact = state.modes.path.mode == PathMode::ExactPath;
        if !exact {
            out.call(Call::SetMotionControlMode(PathMode::ExactPath))?;
        }
        for n in 0..repeats {
            self.at = self.next().ok_or_else(|| straight::at_origin(block, state))?;
            let mut strokes = Strokes { plane: self.plane, at: self.at, position: &state.axes.position, out };
            let over = if n == 0 && self.height > r { self.height } else { self.hole.clear };
            strokes.rapid(over)?;
            if over > r {
                strokes.rapid(r)?;
            }
            self.hole.make(&mut strokes)?;
        }
        [state.axes.position[first], state.axes.position[second]] = self.at;
        state.axes.position[along] = self.hole.clear;
        if !exact {
            out.call(Call::SetMotionControlMode(state.modes.path.mode))?;
            out.call(modes::merge(state))?;
        }
        Ok(())
    }

    /// The next hole; `None` if it takes the angle of the origin.
    fn next(&self) -> Option<[f64; 2]> {
        let at = [0, 1].map(|n| self.at[n] + self.step[n]);
        if self.polar_step == [0.0; 2] {
            return Some(at);
        }
        straight::polar_step(at, self.polar_step[0], self.polar_step[1])
    }
}
