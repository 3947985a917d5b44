//! Threads that are drawn by crest and root alone, as on a drawing. In: places of passes, mm. Out: a
//! [`Plain`] for each length along Z that is threaded.

use rig::observe::Summary;

use super::Cuts;
use super::thread::sign_of;

/// A thread as a drawing has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plain {
    /// 1 of a screw, −1 of a nut.
    pub(super) sign: f64,
    /// Where it is, lower and higher Z.
    pub(super) ends_mm: [f64; 2],
    /// Radius of its root at the ends, and how far the crest is from it.
    root_mm: [f64; 2],
    depth_mm: f64,
}

impl Plain {
    /// Whether it is cut at a place.
    pub(super) fn is_at(&self, z: f64) -> bool {
        (self.ends_mm[0]..=self.ends_mm[1]).contains(&z)
    }

    /// Radius of the root.
    pub(super) fn root_at(&self, z: f64) -> f64 {
        let [[from, to], [a, b]] = [self.ends_mm, self.root_mm];
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
        let plain = Plain {
            sign: sign_of(summary, pass, first[1]),
            ends_mm: [a[0], b[0]],
            root_mm: [a[1].abs(), b[1].abs()],
            depth_mm: pass.depth_mm,
        };
        let meets = |[low, high]: [f64; 2]| plain.ends_mm[0] <= high && plain.ends_mm[1] >= low;
        if drawn.is_some_and(meets) {
            continue;
        }
        match found.iter_mut().find(|other| other.sign == plain.sign && meets(other.ends_mm)) {
            Some(other) if plain.sign * (other.root_mm[1] - plain.root_mm[1]) > 0.0 => *other = plain,
            Some(_) => {}
            None => found.push(plain),
        }
    }
    found
}
