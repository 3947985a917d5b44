//! What a canned cycle does in one hole.
//!
//! In: a [`Hole`], and the tool above it at R. Out: strokes along the axis across the plane, dwells and
//! spindle codes; the tool is then at the clearance, unless G88 leaves it to the operator.
//!
//! | code | down | at the bottom | up |
//! |---|---|---|---|
//! | G81 | feed | | rapid to clear |
//! | G82 | feed | dwell | rapid to clear |
//! | G73 | pecks of Q, back a little after each | | rapid to clear |
//! | G83 | pecks of Q, back to R after each and down to a little above | | rapid to clear |
//! | G84, G74 | feed, overrides off | reverse, dwell | feed to clear, reverse |
//! | the same of FANUC | in step with the spindle, deeper by Q each time | dwell, reverse | in step to R, rapid to clear |
//! | G85 | feed | | feed to R, rapid to clear |
//! | G86 | feed | dwell, stop the spindle | rapid to clear, start |
//! | G87 | bar beside the hole, oriented; to the axis, start | feed to the shoulder, back | beside, rapid |
//! | G88 | feed | dwell, stop the spindle and the program | by hand, start |
//! | G89 | feed | dwell | feed to clear |

use super::super::{Done, Output};
use crate::canon::{Call, Plane, Pose, Turn};
use crate::codes::G;
use crate::problem::{Blame, Problem};
use crate::state::{Overrides, State};
use crate::state::{Rigid, depths};

/// G87: the boring bar passes the hole beside its axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bar {
    /// How far beside, along first and second axis.
    beside: [f64; 2],
    /// The end of the bore above the bottom.
    shoulder: f64,
}

impl Bar {
    /// I, J, K: two are distances in the plane, the one of the axis across it is the shoulder, under G91 from
    /// the bottom.
    pub(super) fn new(offset: [f64; 3], bottom: f64, state: &State) -> Bar {
        let (first, second, along) = state.modes.plane.axes();
        let shoulder = if state.modes.incremental { bottom + offset[along] } else { offset[along] };
        Bar { beside: [offset[first], offset[second]], shoulder }
    }
}

/// One hole: coordinates along the axis across the plane, program units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hole {
    /// The cycle.
    pub(super) code: G,
    /// Where the feed begins.
    pub(super) r: f64,
    /// Its bottom.
    pub(super) bottom: f64,
    /// Where the tool is left.
    pub(super) clear: f64,
    /// Dwell, s.
    pub(super) dwell: f64,
    /// Depth of a peck.
    pub(super) peck: f64,
    /// How far a peck goes back.
    pub(super) back: f64,
    /// G87.
    pub(super) bar: Bar,
    /// The spindle before.
    pub(super) turning: Option<Turn>,
    /// The overrides before.
    pub(super) overrides: Overrides,
    /// G84 and G74 tap in step with the spindle.
    pub(super) rigid: Option<Rigid>,
}

/// Moves of a hole.
pub(super) struct Strokes<'a, 'o> {
    /// The plane.
    pub(super) plane: Plane,
    /// The hole, along first and second axis.
    pub(super) at: [f64; 2],
    /// Where the tool is.
    pub(super) position: &'a Pose,
    /// Receiver.
    pub(super) out: &'a mut Output<'o>,
}

impl Strokes<'_, '_> {
    fn point(&self, at: [f64; 2], height: f64) -> Pose {
        let (first, second, along) = self.plane.axes();
        let mut point = *self.position;
        [point[first], point[second], point[along]] = [at[0], at[1], height];
        point
    }

    /// A rapid over or in the hole.
    pub(super) fn rapid(&mut self, height: f64) -> Done {
        self.rapid_at(self.at, height)
    }

    fn rapid_at(&mut self, at: [f64; 2], height: f64) -> Done {
        let point = self.point(at, height);
        self.out.call(Call::StraightTraverse(point))
    }

    fn feed(&mut self, height: f64) -> Done {
        let point = self.point(self.at, height);
        self.out.call(Call::StraightFeed(point))
    }

    fn dwell(&mut self, seconds: f64) -> Done {
        self.out.call(Call::Dwell(seconds))
    }

    fn start(&mut self, turn: Turn) -> Done {
        self.out.call(Call::StartSpindle(turn))
    }

    fn stop(&mut self) -> Done {
        self.out.call(Call::StopSpindle)
    }
}

impl Hole {
    /// Refuses what cannot be done.
    pub(super) fn check(&self) -> Done {
        let code = self.code;
        let refuse =
            |kind, message: String, help: &str| Err(Problem::error(kind, Blame::G(code), message, help));
        match (code.0, self.turning) {
            (740 | 840, None) if self.rigid.is_some() => {}
            (740 | 840 | 860 | 870 | 880, None) => {
                return refuse(
                    "spindle-not-turning",
                    format!("the spindle is not turning in {code}"),
                    "start it first",
                );
            }
            (740, Some(Turn::Clockwise)) => {
                let message = "the spindle turns clockwise, and G74 taps left-hand threads".to_owned();
                return refuse("spindle-direction", message, "use M4, or G84 for a right-hand thread");
            }
            (840, Some(Turn::Counterclockwise)) => {
                let message =
                    "the spindle turns counterclockwise, and G84 taps right-hand threads".to_owned();
                return refuse("spindle-direction", message, "use M3, or G74 for a left-hand thread");
            }
            _ => {}
        }
        Ok(())
    }

    /// How many pecks it takes, where it takes pecks.
    pub(super) fn peck_count(&self) -> f64 {
        ((self.r - self.bottom) / self.peck).ceil()
    }

    /// How many moves it makes at most, without those that lead to it.
    pub(super) fn moves(&self) -> f64 {
        match self.code.0 {
            730 => 2.0 * self.peck_count() + 2.0,
            830 => 3.0 * self.peck_count() + 2.0,
            870 => 9.0,
            850 => 3.0,
            _ => 2.0,
        }
    }

    /// Makes it.
    pub(super) fn make(&self, strokes: &mut Strokes) -> Done {
        match self.code.0 {
            730 | 830 => self.pecks(strokes),
            740 | 840 => self.tap(strokes),
            850 => {
                strokes.feed(self.bottom)?;
                strokes.feed(self.r)?;
                strokes.rapid(self.clear)
            }
            860 | 880 => self.stopped(strokes),
            870 => self.back_bore(strokes),
            890 => {
                strokes.feed(self.bottom)?;
                strokes.dwell(self.dwell)?;
                strokes.feed(self.clear)
            }
            code => {
                strokes.feed(self.bottom)?;
                if code == 820 {
                    strokes.dwell(self.dwell)?;
                }
                strokes.rapid(self.clear)
            }
        }
    }

    /// G73 and G83. The pecks are counted: far from 0 a small Q may not change the depth. There may be one
    /// more than the depth asks for, which is what rounding left of it, as in LinuxCNC.
    fn pecks(&self, strokes: &mut Strokes) -> Done {
        let mut depth = self.r - self.peck;
        for _ in 0..self.peck_count() as u64 {
            if depth <= self.bottom {
                break;
            }
            strokes.feed(depth)?;
            if self.code == G(830) {
                strokes.rapid(self.r)?;
            }
            strokes.rapid(depth + self.back)?;
            depth -= self.peck;
        }
        strokes.feed(self.bottom)?;
        strokes.rapid(self.clear)
    }

    /// G74 and G84: tapping in a floating holder.
    fn tap(&self, strokes: &mut Strokes) -> Done {
        let (turn, reverse) = match self.code.0 {
            740 => (Turn::Counterclockwise, Turn::Clockwise),
            _ => (Turn::Clockwise, Turn::Counterclockwise),
        };
        if let Some(rigid) = self.rigid {
            return self.tap_rigidly(rigid, turn, strokes);
        }
        strokes.out.call(Call::EnableFeedOverride(false))?;
        strokes.out.call(Call::EnableSpeedOverride(false))?;
        strokes.feed(self.bottom)?;
        strokes.stop()?;
        strokes.start(reverse)?;
        strokes.dwell(self.dwell)?;
        strokes.feed(self.clear)?;
        strokes.stop()?;
        strokes.start(turn)?;
        if self.overrides.feed {
            strokes.out.call(Call::EnableFeedOverride(true))?;
        }
        if self.overrides.speed {
            strokes.out.call(Call::EnableSpeedOverride(true))?;
        }
        Ok(())
    }

    /// The same in step with the spindle, which stands behind it if it stood before.
    fn tap_rigidly(&self, Rigid { lead, peck }: Rigid, turn: Turn, strokes: &mut Strokes) -> Done {
        if self.turning.is_none() {
            strokes.start(turn)?;
        }
        for depth in depths(self.r, self.bottom, peck) {
            let bottom = strokes.point(strokes.at, depth);
            strokes.out.call(Call::StartSpeedFeedSynch {
                lead,
                velocity: false,
                start_deg: 0.0,
                growth: 0.0,
            })?;
            strokes.out.call(Call::RigidTap(bottom, 1.0, self.dwell))?;
            strokes.out.call(Call::StopSpeedFeedSynch)?;
        }
        if self.turning.is_none() {
            strokes.stop()?;
        }
        strokes.rapid(self.clear)
    }

    /// G86 and G88.
    fn stopped(&self, strokes: &mut Strokes) -> Done {
        strokes.feed(self.bottom)?;
        strokes.dwell(self.dwell)?;
        strokes.stop()?;
        if self.code == G(880) {
            strokes.out.call(Call::ProgramStop)?;
            strokes.out.call(Call::MoveByHand)?;
        } else {
            strokes.rapid(self.clear)?;
        }
        self.turning.map_or(Ok(()), |turn| strokes.start(turn))
    }

    /// G87.
    fn back_bore(&self, strokes: &mut Strokes) -> Done {
        let Some(turn) = self.turning else { return Ok(()) };
        let beside = [0, 1].map(|n| strokes.at[n] + self.bar.beside[n]);
        strokes.rapid_at(beside, self.r)?;
        orient(turn, strokes)?;
        strokes.rapid_at(beside, self.bottom)?;
        strokes.rapid(self.bottom)?;
        strokes.start(turn)?;
        strokes.feed(self.bar.shoulder)?;
        strokes.feed(self.bottom)?;
        orient(turn, strokes)?;
        strokes.rapid_at(beside, self.bottom)?;
        strokes.rapid_at(beside, self.clear)?;
        strokes.rapid(self.clear)?;
        strokes.start(turn)
    }
}

/// Stops the spindle at the index, in the direction it turned.
fn orient(turn: Turn, strokes: &mut Strokes) -> Done {
    strokes.stop()?;
    // LinuxCNC's numbers of its directions, which are not those of M19 P: 2 clockwise, 3 counterclockwise.
    let direction = if turn == Turn::Clockwise { 2 } else { 3 };
    strokes.out.call(Call::OrientSpindle(0.0, direction))
}
