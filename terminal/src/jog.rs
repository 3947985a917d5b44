//! A key that is held down, as a terminal tells it: once, after a while again and again, and never that it
//! was let go. In: keys with the time since the client began. Out: what is asked of the machine.
//!
//! A tap moves nothing: a jog begins with the first repeat, and is let go when repeats have been silent for
//! [`SILENT`]. Meanwhile it is confirmed every [`BEAT`]; if that does not arrive, the machine itself lets go.

use std::time::Duration;

/// The second press of a key within so long is a repeat of the first.
pub const REPEATS: Duration = Duration::from_millis(750);
/// Repeats that are silent for so long have ended.
pub const SILENT: Duration = Duration::from_millis(120);
/// Between two confirmations.
pub const BEAT: Duration = Duration::from_millis(25);

/// Where a key leads.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// The axis.
    pub axis: String,
    /// Towards higher values.
    pub positive: bool,
}

/// What is asked of the machine.
#[derive(Clone, Debug, PartialEq)]
pub enum Asks {
    /// A jog begins.
    Begin(Way),
    /// It goes on.
    Confirm,
    /// Its key was let go.
    LetGo,
}

/// The key of a jog.
#[derive(Debug, Default)]
pub struct Jog {
    held: Option<Way>,
    /// When it was told last.
    last: Duration,
    /// When the machine was told last, if a jog goes on.
    told: Option<Duration>,
}

impl Jog {
    /// A key is told.
    pub fn pressed(&mut self, way: Way, now: Duration) -> Option<Asks> {
        let repeats = self.held.as_ref() == Some(&way) && now.saturating_sub(self.last) <= REPEATS;
        self.last = now;
        match (repeats, self.told) {
            (true, Some(_)) => None,
            (true, None) => {
                self.told = Some(now);
                Some(Asks::Begin(way))
            }
            (false, told) => {
                (self.held, self.told) = (Some(way), None);
                told.map(|_| Asks::LetGo)
            }
        }
    }

    /// Time goes by.
    pub fn beat(&mut self, now: Duration) -> Option<Asks> {
        let told = self.told?;
        if now.saturating_sub(self.last) > SILENT {
            self.forget();
            return Some(Asks::LetGo);
        }
        if now.saturating_sub(told) < BEAT {
            return None;
        }
        self.told = Some(now);
        Some(Asks::Confirm)
    }

    /// No jog goes on any more.
    pub fn forget(&mut self) {
        (self.held, self.told) = (None, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    fn way(positive: bool) -> Way {
        Way { axis: "Z".into(), positive }
    }

    #[test]
    fn a_tap_moves_nothing() {
        let mut jog = Jog::default();
        assert_eq!(jog.pressed(way(true), ms(0)), None);
        assert!((1..2000).all(|now| jog.beat(ms(now)).is_none()));
        assert_eq!(jog.pressed(way(true), ms(2000)), None, "another tap, much later");
        assert_eq!(jog.pressed(way(false), ms(2010)), None, "another key");
    }

    /// The first press, after half a second repeats every 30 ms, then silence: whenever that begins, the
    /// jog is let go within SILENT and a millisecond, confirmed at every BEAT until then, and never after.
    #[test]
    fn a_jog_goes_on_with_the_repeats_of_its_key_and_ends_with_them() {
        for repeats in 1..40 {
            let mut jog = Jog::default();
            let presses: Vec<u64> = std::iter::once(0).chain((0..repeats).map(|n| 500 + 30 * n)).collect();
            let last = *presses.last().expect("there are some");
            let mut asked = Vec::new();
            for now in 0..last + 1000 {
                if presses.contains(&now) {
                    asked.extend(jog.pressed(way(true), ms(now)).map(|asks| (now, asks)));
                }
                asked.extend(jog.beat(ms(now)).map(|asks| (now, asks)));
            }
            assert_eq!(asked[0], (500, Asks::Begin(way(true))));
            assert_eq!(asked.last(), Some(&(last + SILENT.as_millis() as u64 + 1, Asks::LetGo)));
            let between = &asked[..asked.len() - 1];
            assert!(between[1..].iter().all(|(_, asks)| *asks == Asks::Confirm));
            assert!(between.windows(2).all(|pair| pair[1].0 - pair[0].0 == 25), "{between:?}");
        }
    }

    #[test]
    fn another_key_lets_go_of_the_first() {
        let mut jog = Jog::default();
        jog.pressed(way(true), ms(0));
        assert_eq!(jog.pressed(way(true), ms(30)), Some(Asks::Begin(way(true))));
        assert_eq!(jog.pressed(way(false), ms(60)), Some(Asks::LetGo));
        assert_eq!(jog.beat(ms(100)), None);
        assert_eq!(jog.pressed(way(false), ms(120)), Some(Asks::Begin(way(false))));
        jog.forget();
        assert_eq!(jog.beat(ms(150)), None, "the machine has refused it");
    }
}
