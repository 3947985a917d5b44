//! Calls that wait until the next corner is known.
//!
//! The last move of a compensated contour waits, because an inside corner ends it earlier. What is called
//! after it also waits, so that the order stays: other moves at the same point of the plane, F, spindle,
//! coolant, dwell, comments. What else may be called while compensation is on goes at once, as in LinuxCNC:
//! messages, units, T.

use crate::canon::{Call, Place, Plane, Pose};
use crate::geometry::track::{Point, Track};

/// A call that owns its text.
#[derive(Clone, Debug, PartialEq)]
enum Held {
    Comment(String),
    Note(String),
    Other(Call<'static>),
}

impl Held {
    /// The call, if it is one that waits.
    fn new(call: Call<'_>) -> Option<Held> {
        Some(match call {
            Call::Comment(text) => Held::Comment(text.to_owned()),
            Call::Note(text) => Held::Note(text.to_owned()),
            Call::StraightTraverse(to) => Held::Other(Call::StraightTraverse(to)),
            Call::StraightFeed(to) => Held::Other(Call::StraightFeed(to)),
            Call::ArcFeed(arc) => Held::Other(Call::ArcFeed(arc)),
            Call::Dwell(time) => Held::Other(Call::Dwell(time)),
            Call::SetFeedMode(mode) => Held::Other(Call::SetFeedMode(mode)),
            Call::SetFeedRate(feed) => Held::Other(Call::SetFeedRate(feed)),
            Call::SetSpindleMode(limit) => Held::Other(Call::SetSpindleMode(limit)),
            Call::SetSpindleSpeed(speed) => Held::Other(Call::SetSpindleSpeed(speed)),
            Call::StartSpindle(turn) => Held::Other(Call::StartSpindle(turn)),
            Call::StopSpindle => Held::Other(Call::StopSpindle),
            Call::OrientSpindle(angle, direction) => Held::Other(Call::OrientSpindle(angle, direction)),
            Call::WaitSpindleOrient(time) => Held::Other(Call::WaitSpindleOrient(time)),
            Call::SetMotionControlMode(mode) => Held::Other(Call::SetMotionControlMode(mode)),
            Call::MistOn => Held::Other(Call::MistOn),
            Call::MistOff => Held::Other(Call::MistOff),
            Call::FloodOn => Held::Other(Call::FloodOn),
            Call::FloodOff => Held::Other(Call::FloodOff),
            _ => return None,
        })
    }

    fn call(&self) -> Call<'_> {
        match self {
            Held::Comment(text) => Call::Comment(text),
            Held::Note(text) => Call::Note(text),
            Held::Other(call) => *call,
        }
    }
}

/// The last move of a contour and what was called after it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Waiting {
    calls: Vec<(Place, Held)>,
    track: Option<Track>,
}

impl Waiting {
    /// Whether nothing waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.calls.is_empty()
    }

    /// Whether a call has to wait after others.
    pub(crate) fn delays(&self, call: &Call<'_>) -> bool {
        !self.calls.is_empty() && Held::new(*call).is_some()
    }

    /// Puts a call after the others.
    pub(crate) fn push(&mut self, place: Place, call: Call<'_>) {
        self.calls.extend(Held::new(call).map(|held| (place, held)));
    }

    /// Puts a move of the contour after the others.
    pub(super) fn push_move(&mut self, place: Place, call: Call<'_>, track: Track) {
        self.push(place, call);
        self.track = Some(track);
    }

    /// The way of the tool's centre along the move of the contour that waits.
    pub(super) fn track(&self) -> Option<&Track> {
        self.track.as_ref()
    }

    /// Ends the move of the contour with the centre of the tool at `corner`, which is sent as `tip`, and
    /// takes the moves after it along. `false` if nothing is left of that move.
    pub(super) fn end_at(&mut self, corner: Point, tip: Point, plane: Plane) -> bool {
        let left = self.track.as_mut().is_some_and(|track| track.end_at(corner));
        let (first, second, _) = plane.axes();
        for (_, held) in &mut self.calls {
            match held {
                Held::Other(Call::StraightTraverse(to) | Call::StraightFeed(to)) => {
                    (to[first], to[second]) = (tip[0], tip[1]);
                }
                Held::Other(Call::ArcFeed(arc)) => arc.end = tip,
                _ => {}
            }
        }
        left
    }

    /// Place of the move of the contour that waits.
    pub(super) fn place(&self) -> Option<Place> {
        self.calls.first().map(|(place, _)| *place)
    }

    /// Hands out all calls in their order.
    pub(crate) fn take(&mut self) -> Waiting {
        std::mem::take(self)
    }

    /// The calls in their order.
    pub(crate) fn calls(&self) -> impl Iterator<Item = (Place, Call<'_>)> {
        self.calls.iter().map(|(place, held)| (*place, held.call()))
    }

    /// G20, G21: lengths in other units, which go out before all that waits; F only where `feeds`.
    pub(super) fn scale(&mut self, factor: f64, feeds: bool) {
        if let Some(track) = &mut self.track {
            track.scale(factor);
        }
        for (_, held) in &mut self.calls {
            match held {
                Held::Other(Call::StraightTraverse(to) | Call::StraightFeed(to)) => scale_lengths(to, factor),
                Held::Other(Call::ArcFeed(arc)) => {
                    for length in arc.end.iter_mut().chain(&mut arc.center) {
                        *length *= factor;
                    }
                    arc.along *= factor;
                }
                Held::Other(Call::SetFeedRate(feed)) if feeds => *feed *= factor,
                _ => {}
            }
        }
    }
}

fn scale_lengths(position: &mut Pose, factor: f64) {
    for length in &mut position[..3] {
        *length *= factor;
    }
}
