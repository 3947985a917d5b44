//! Whether the axes stand, as they are measured: a servo that lags is still on its way when its command has
//! come to rest. In: a measurement each tick. Out: whether none of them has moved for a while.

use machine::Machine;
use protocol::{Measurement, PerAxis, Position};

/// An axis stands that is slower than this, mm/s, for so long, s.
const STANDS_MM_S: f64 = 0.2;
const STOOD_S: f64 = 0.05;
/// A motor at rest flickers by so many counts.
const FLICKER: f64 = 2.0;

/// How long the axes have stood.
#[derive(Clone, Debug)]
pub(crate) struct Standing {
    /// How far each may move in a tick, mm.
    most: PerAxis<f64>,
    before: Option<PerAxis<Position>>,
    ticks: u64,
    enough: u64,
}

impl Standing {
    pub(crate) fn new(machine: &Machine) -> Standing {
        let tick_s = machine.general.interpolator_cycle_s;
        let mut most = [f64::INFINITY; protocol::units::AXES];
        for (axis, config) in machine.axes() {
            let count_mm = config.screw_lead_mm / f64::from(config.encoder_counts);
            most[axis.index()] = STANDS_MM_S * tick_s + FLICKER * count_mm;
        }
        Standing { most, before: None, ticks: 0, enough: (STOOD_S / tick_s).ceil() as u64 }
    }

    /// One tick; whether the commands rest. A screw that is wound up unwinds when its drive lets go.
    pub(crate) fn update(&mut self, measurement: &Measurement, rests: bool) {
        let now = std::array::from_fn(|i| measurement.axes[i].position);
        let before = self.before.replace(now).unwrap_or(now);
        let stand = (0..now.len()).all(|i| now[i].mm_from(before[i]).abs() <= self.most[i]);
        self.ticks = if stand && rests { self.ticks + 1 } else { 0 };
    }

    /// Whether they have stood long enough.
    pub(crate) fn holds(&self) -> bool {
        self.ticks >= self.enough
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lets Z go at a speed for some ticks, its counts flickering by `flicker`; whether all stand then.
    fn go(standing: &mut Standing, z_mm: &mut f64, ticks: u32, mm_s: f64, flicker: f64) -> bool {
        for tick in 0..ticks {
            *z_mm += mm_s * 0.002;
            let mut measurement = Measurement::default();
            let off = if tick % 2 == 0 { flicker } else { 0.0 };
            measurement.axes[protocol::Axis::Z.index()].position = Position::from_mm(*z_mm + off);
            standing.update(&measurement, true);
        }
        standing.holds()
    }

    #[test]
    fn axes_stand_once_they_have_rested_for_a_while_and_until_they_move() {
        let (mut standing, mut z_mm) = (Standing::new(&Machine::plain()), 5.0);
        let count_mm = 5.0 / 131_072.0;
        assert!(!go(&mut standing, &mut z_mm, 100, 1.0, 0.0), "it moves at 1 mm/s");
        assert!(!go(&mut standing, &mut z_mm, 24, 0.0, count_mm), "not for long enough");
        assert!(go(&mut standing, &mut z_mm, 2, 0.0, count_mm), "it stands, and flickers by a count");
        assert!(!go(&mut standing, &mut z_mm, 1, 2.0, 0.0), "it moves again");
        assert!(go(&mut standing, &mut z_mm, 26, 0.1, 0.0), "as slowly as an axis creeps that stands");
        standing.update(&Measurement::default(), true);
        assert!(!standing.holds(), "a jump");
        for _ in 0..100 {
            standing.update(&Measurement::default(), false);
        }
        assert!(!standing.holds(), "its command does not rest");
    }
}
