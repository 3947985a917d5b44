//! The six laws of an approach, from rest to rest. In: signed length in mm, duration in s. Out: way, speed,
//! acceleration at a time (mm, s), where the pieces of the law meet, and its peaks.
//!
//! | law | where it is from | pieces |
//! |---|---|---|
//! | sin² acceleration | `motion::Stroke`, which moves X to depth (M2) | 2 |
//! | sin² jerk | `motion::Ramp` up and down, which moves Z onto the lead and every feed (M13, M15) | 4 |
//! | trapezoidal speed | acceleration +, 0, − for a third of the time each | 3 |
//! | trapezoidal acceleration | jerk +, 0, −, 0, + for T/8, T/4, T/4, T/4, T/8 | 5 |
//! | cubic | way 3u² − 2u³, u = t/T: acceleration falls evenly | 1 |
//! | quintic | way 10u³ − 15u⁴ + 6u⁵ | 1 |

use motion::{Ramp, Sample, Stroke};
use serde::Serialize;

/// A law by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Profile {
    TrapezoidalSpeed,
    TrapezoidalAcceleration,
    Cubic,
    Quintic,
    #[serde(rename = "sin2-acceleration")]
    Sin2Acceleration,
    #[serde(rename = "sin2-jerk")]
    Sin2Jerk,
}

impl Profile {
    pub(super) const ALL: [Profile; 6] = [
        Profile::TrapezoidalSpeed,
        Profile::TrapezoidalAcceleration,
        Profile::Cubic,
        Profile::Quintic,
        Profile::Sin2Acceleration,
        Profile::Sin2Jerk,
    ];

    /// As a page calls it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Profile::TrapezoidalSpeed => "trapezoidal speed",
            Profile::TrapezoidalAcceleration => "trapezoidal acceleration",
            Profile::Cubic => "cubic",
            Profile::Quintic => "quintic",
            Profile::Sin2Acceleration => "sin² acceleration",
            Profile::Sin2Jerk => "sin² jerk",
        }
    }

    /// Peaks of speed, acceleration and jerk as multiples of length/durationⁿ; a step of the acceleration is
    /// an infinite jerk.
    pub(super) fn peaks(self) -> [f64; 3] {
        match self {
            Profile::TrapezoidalSpeed => [1.5, 4.5, f64::INFINITY],
            Profile::TrapezoidalAcceleration => [2.0, 16.0 / 3.0, 128.0 / 3.0],
            Profile::Cubic => [1.5, 6.0, f64::INFINITY],
            Profile::Quintic => [1.875, 10.0 / 3.0_f64.sqrt(), 60.0],
            Profile::Sin2Acceleration => {
                let peak = Stroke::new(1.0, 1.0).peak();
                [peak.v, peak.a, peak.j]
            }
            Profile::Sin2Jerk => {
                let peak = half(1.0, 1.0).peak();
                [peak.v, peak.a, peak.j]
            }
        }
    }

    /// The law over `length` mm in `duration` > 0 s.
    pub(super) fn law(self, length: f64, duration: f64) -> Law {
        let third = duration / 3.0;
        let eighth = duration / 8.0;
        let [_, a, _] = self.peaks().map(|peak| peak * length / (duration * duration));
        match self {
            Profile::TrapezoidalSpeed => {
                Law::of_pieces(&[(third, a, 0.0), (third, 0.0, 0.0), (third, -a, 0.0)])
            }
            Profile::TrapezoidalAcceleration => {
                let j = a / eighth;
                Law::of_pieces(&[
                    (eighth, 0.0, j),
                    (2.0 * eighth, a, 0.0),
                    (2.0 * eighth, a, -j),
                    (2.0 * eighth, -a, 0.0),
                    (eighth, -a, j),
                ])
            }
            Profile::Cubic => Law::of_pieces(&[(duration, a, -2.0 * a / duration)]),
            Profile::Quintic => {
                Law { ends: vec![duration], at: Box::new(move |t| quintic(length, duration, t)) }
            }
            Profile::Sin2Acceleration => {
                let stroke = Stroke::new(length, duration);
                Law { ends: vec![0.5 * duration, duration], at: Box::new(move |t| stroke.at(t)) }
            }
            Profile::Sin2Jerk => {
                let (ramp, middle) = (half(length, duration), 0.5 * duration);
                let at = move |t: f64| {
                    if t < middle {
                        ramp.at(t)
                    } else {
                        ramp.braking_at(t - middle) + Sample::uniform(ramp.distance(), 0.0)
                    }
                };
                Law { ends: [1.0, 2.0, 3.0, 4.0].map(|n| 0.25 * n * duration).to_vec(), at: Box::new(at) }
            }
        }
    }
}

/// The first half of a stroke with sin² jerk: onto twice the mean speed without a stretch of constant
/// acceleration.
fn half(length: f64, duration: f64) -> Ramp {
    Ramp::new(2.0 * length / duration, 0.5 * duration, 0.5)
}

fn quintic(length: f64, duration: f64, t: f64) -> Sample {
    let u = t / duration;
    let (v, a) = (30.0 * u * u * (1.0 - u) * (1.0 - u), 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u));
    Sample {
        s: length * u * u * u * (10.0 - u * (15.0 - 6.0 * u)),
        v: length / duration * v,
        a: length / (duration * duration) * a,
        ..Sample::default()
    }
}

/// A motion that consists of smooth pieces.
pub(super) struct Law {
    /// When each piece ends, s.
    pub(super) ends: Vec<f64>,
    /// Way, speed and acceleration at a time from 0 to the last end, s.
    pub(super) at: Box<dyn Fn(f64) -> Sample>,
}

impl Law {
    /// Pieces of constant jerk: duration, acceleration at the start, jerk of each; from rest at 0.
    fn of_pieces(pieces: &[(f64, f64, f64)]) -> Law {
        let mut laid = Vec::with_capacity(pieces.len());
        let (mut end, mut s, mut v) = (0.0, 0.0, 0.0);
        let mut ends = Vec::with_capacity(pieces.len());
        for &(duration, a, j) in pieces {
            let piece = move |t: f64| Sample {
                s: s + t * (v + t * (a / 2.0 + t * j / 6.0)),
                v: v + t * (a + t * j / 2.0),
                a: a + t * j,
                ..Sample::default()
            };
            laid.push((end, piece));
            Sample { s, v, .. } = piece(duration);
            end += duration;
            ends.push(end);
        }
        let at = move |t: f64| {
            let piece = laid.iter().rev().find(|(begin, _)| *begin <= t);
            piece.map_or(Sample::default(), |(begin, piece)| piece(t - begin))
        };
        Law { ends, at: Box::new(at) }
    }

    /// When the motion is over, s.
    pub(super) fn duration(&self) -> f64 {
        self.ends.last().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From rest to rest over the length, speed and acceleration being derivatives, with the peaks that are
    /// stated.
    #[test]
    fn every_law_goes_the_way_and_has_its_peaks() {
        let (length, duration, steps) = (-5.0, 0.2, 24_000);
        for profile in Profile::ALL {
            let law = profile.law(length, duration);
            let name = profile.name();
            let dt = duration / f64::from(steps);
            assert_eq!(law.duration(), *law.ends.last().unwrap(), "{name}");
            assert!((law.duration() - duration).abs() < 1e-15, "{name}");
            let end = (law.at)(duration);
            assert!((end.s - length).abs() < 1e-12 && end.v.abs() < 1e-11, "{name}: {end:?}");
            let (mut largest, mut before) = ([0.0_f64; 2], (law.at)(0.0));
            for step in 1..=steps {
                let t = dt * f64::from(step);
                let now = (law.at)(t);
                let middle = (law.at)(t - 0.5 * dt);
                assert!(((now.s - before.s) / dt - middle.v).abs() < 1e-4, "{name} at {t}: {middle:?}");
                let whole = law.ends.iter().all(|end| (t - 0.5 * dt - end).abs() > dt);
                assert!(
                    !whole || ((now.v - before.v) / dt - middle.a).abs() < 1e-2,
                    "{name} at {t}: {middle:?}"
                );
                largest = [largest[0].max(middle.v.abs()), largest[1].max(middle.a.abs())];
                before = now;
            }
            let [v, a, _] = profile.peaks();
            let stated = [v * 25.0, a * 125.0];
            for (largest, stated) in largest.into_iter().zip(stated) {
                assert!((largest / stated - 1.0).abs() < 1e-3, "{name}: {largest} for {stated}");
            }
        }
    }
}
