//! Where the tip of a tool is each time the spindle goes through one of some angles (M158). In: true angle of
//! the spindle, degrees, and place of the tip in every control cycle of a pass, mm. Out: numbers of angles,
//! and the place at each.

/// Where a tip was, and at which angle.
#[derive(Clone, Copy, Debug)]
struct Seen<const N: usize> {
    pass: u32,
    deg: f64,
    tip: [f64; N],
}

/// Watches a tip from cycle to cycle.
#[derive(Clone, Debug)]
pub(super) struct Crossings<const N: usize> {
    stations: usize,
    before: Option<Seen<N>>,
}

impl<const N: usize> Crossings<N> {
    /// Of so many angles.
    pub(super) fn new(stations: usize) -> Crossings<N> {
        Crossings { stations, before: None }
    }

    /// How many angles there are.
    pub(super) fn stations(&self) -> usize {
        self.stations
    }

    /// Takes a control cycle of a pass (M158).
    pub(super) fn cycle(
        &mut self,
        pass: u32,
        deg: f64,
        tip: [f64; N],
        mut each: impl FnMut(usize, [f64; N]),
    ) {
        let now = Seen { pass, deg, tip };
        let Some(before) = self.before.replace(now).filter(|before| before.pass == pass) else { return };
        let n = self.stations;
        let [a, b] = [before.deg, now.deg].map(|deg| deg * n as f64 / 360.0);
        let (first, last) = (a.min(b).floor() as i64 + 1, a.max(b).floor() as i64);
        for k in (first..=last).take(n) {
            let share = (k as f64 - a) / (b - a);
            let place = std::array::from_fn(|i| before.tip[i] + share * (now.tip[i] - before.tip[i]));
            each(k.rem_euclid(n as i64) as usize, place);
        }
    }

    /// Forgets where the tip was: the pass is over, and may be cut again from its start.
    pub(super) fn pass_ends(&mut self) {
        self.before = None;
    }
}
