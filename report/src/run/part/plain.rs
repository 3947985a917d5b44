//! Threads that are drawn by crest and root alone, as on a drawing. In: places of passes, mm. Out: a
//! [`Plain`] for each length along Z that is threaded.

use rig::observe::Summary;

use super::Cuts;
use super::thread::sign_of;

/// A thread as a drawing has it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plain {
    /// 1 of a screw, −1 of a nut.
    pub(super) sign: f64,
    /// Where it is, lower and higher Z.
    pub(super) ends_mm: [f64; 2],
    /// Z and radius of its root, from end to end: two places, of a chain or an arc more.
    pub(super) root_mm: Vec<[f64; 2]>,
    /// How far the crest is from it.
    depth_mm: f64,
}

impl Plain {
    /// Whether it is cut at a place.
    pub(super) fn is_at(&self, z: f64) -> bool {
        (self.ends_mm[0]..=self.ends_mm[1]).contains(&z)
    }

    /// Radius of the root.
    pub(super) fn root_at(&self, z: f64) -> f64 {
        let behind = self.root_mm.partition_point(|place| place[0] < z).clamp(1, self.root_mm.len() - 1);
        let [[from, a], [to, b]] = [self.root_mm[behind - 1], self.root_mm[behind]];
        a + (b - a) * (z - from) / (to - from).max(f64::MIN_POSITIVE)
    }

    /// Radius of the crest, if the program says how deep the thread is.
    pub(super) fn crest_at(&self, z: f64) -> Option<f64> {
        (self.depth_mm > 0.0).then(|| self.root_at(z) + self.sign * self.depth_mm)
    }
}

/// The threads that are not drawn groove by groove over `drawn`: of passes over one length the deepest.
pub(super) fn threads(summary: &Summary, passes: &[Cuts], drawn: Option<[f64; 2]>) -> Vec<Plain> {
    let mut found: Vec<Plain> = Vec::new();
    for (pass, cuts) in summary.passes.iter().zip(passes) {
        // How wide a tap is, nobody says.
        let Some([first, last]) = cuts.full.filter(|_| pass.tap.is_none()) else { continue };
        let [a, b] = if first[0] <= last[0] { [first, last] } else { [last, first] };
        let between = |place: &&[f64; 2]| !pass.lead_changes.is_empty() && a[0] < place[0] && place[0] < b[0];
        let inner = cuts.tips[0].iter().filter(between);
        let mut root_mm: Vec<[f64; 2]> = [a, b].iter().chain(inner).map(|[z, x]| [*z, x.abs()]).collect();
        root_mm.sort_by(|one, other| one[0].total_cmp(&other[0]));
        let ends_mm = [a[0], b[0]];
        let plain =
            Plain { sign: sign_of(summary, pass, first[1]), ends_mm, root_mm, depth_mm: pass.depth_mm };
        let middle = 0.5 * (a[0] + b[0]);
        let meets = |[low, high]: [f64; 2]| plain.ends_mm[0] <= high && plain.ends_mm[1] >= low;
        if drawn.is_some_and(meets) {
            continue;
        }
        match found.iter_mut().find(|other| other.sign == plain.sign && meets(other.ends_mm)) {
            Some(other) if plain.sign * (other.root_at(middle) - plain.root_at(middle)) > 0.0 => {
                *other = plain
            }
            Some(_) => {}
            None => found.push(plain),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rig::observe::PassReport;

    /// The root of a pass goes straight from end to end, and along its turns where its lead changes: of a
    /// barrel.
    #[test]
    fn the_root_of_an_arc_goes_along_it() {
        let arc = |z: f64| 20.0 - z * z / 100.0;
        let tips: Vec<[f64; 2]> = (-10..=10).rev().map(|z| [f64::from(z), arc(f64::from(z))]).collect();
        let full = Some([[8.0, arc(8.0)], [-8.0, arc(-8.0)]]);
        let cuts = [Cuts { tips: [tips, Vec::new()], full }];
        for (lead_changes, at_crown) in [(Vec::new(), arc(8.0)), (vec![[0.0, 9.0, 0.0, 0.0]], 20.0)] {
            let pass = PassReport { lead_changes, lead_mm: -1.0, ..PassReport::default() };
            let summary = Summary { passes: vec![pass], ..Summary::default() };
            let [thread] = &threads(&summary, &cuts, None)[..] else { panic!("one thread") };
            assert_eq!((thread.ends_mm, thread.root_at(0.0)), ([-8.0, 8.0], at_crown));
            assert!((thread.root_at(7.9) - arc(7.9)).abs() < 0.02 && thread.crest_at(0.0).is_none());
        }
    }
}
