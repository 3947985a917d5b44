//! The diameter that was turned or bored before the thread: its crest. In: the true place of the tip in every
//! control cycle of motion at a feed, mm. Out: the least and the largest diameter along the thread, if all of
//! it was turned.
//!
//! The length of the thread is looked at in [`BINS`] places; in each the tip that reached deepest counts. A
//! tip that goes across the axis rather than along it (facing, a shoulder) leaves no diameter.

use gauge::Side;

const BINS: usize = 128;

/// Collects what tools leave.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    side: Side,
    /// Where the thread is at full depth, along Z.
    along_mm: [f64; 2],
    /// Radius in each place; none where nothing was turned.
    radii_mm: Vec<Option<f64>>,
    before: Option<[f64; 2]>,
}

impl Turned {
    pub(super) fn new(side: Side, along_mm: [f64; 2]) -> Turned {
        Turned { side, along_mm, radii_mm: vec![None; BINS], before: None }
    }

    /// Takes a control cycle: X from the axis and Z, if the tool is moved at a feed.
    pub(super) fn cycle(&mut self, tip: Option<[f64; 2]>) {
        let before = std::mem::replace(&mut self.before, tip);
        let (Some([x0, z0]), Some([x, z])) = (before, tip) else { return };
        let [low, high] = self.along_mm;
        if (z - z0).abs() <= (x - x0).abs() || !(low..=high).contains(&z) || low >= high {
            return;
        }
        let bin = ((z - low) / (high - low) * BINS as f64) as usize;
        let Some(radius) = self.radii_mm.get_mut(bin) else { return };
        let deepest = match self.side {
            Side::External => f64::min,
            Side::Internal => f64::max,
        };
        *radius = Some(radius.map_or(x.abs(), |other| deepest(other, x.abs())));
    }

    /// Least and largest diameter, mm; `None` if some of the length was not turned.
    pub(super) fn diameters_mm(&self) -> Option<[f64; 2]> {
        let radii: Option<Vec<f64>> = self.radii_mm.iter().copied().collect();
        let radii = radii?;
        let least = radii.iter().copied().reduce(f64::min)?;
        let largest = radii.iter().copied().reduce(f64::max)?;
        Some([2.0 * least, 2.0 * largest])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(side: Side, ways: &[[[f64; 2]; 2]]) -> Turned {
        let mut turned = Turned::new(side, [-20.0, -1.0]);
        for [from, to] in ways {
            let at = |step: i32| [0, 1].map(|i| from[i] + (to[i] - from[i]) * f64::from(step) / 2000.0);
            (0..=2000).for_each(|step| turned.cycle(Some(at(step))));
            turned.cycle(None);
        }
        turned
    }

    #[test]
    fn the_deepest_cut_along_the_thread_counts() {
        let rough = [[10.5, 1.0], [10.5, -25.0]];
        let fine = [[9.91, 1.0], [9.91, -25.0]];
        let facing = [[10.5, -5.0], [0.0, -5.0]];
        assert_eq!(turned(Side::External, &[rough, fine, facing]).diameters_mm(), Some([19.82, 19.82]));
        assert_eq!(turned(Side::Internal, &[rough, fine]).diameters_mm(), Some([21.0, 21.0]));
        let half = [[9.91, 1.0], [9.91, -12.0]];
        assert_eq!(turned(Side::External, &[half]).diameters_mm(), None, "not all of it");
        let both = turned(Side::External, &[rough, half]).diameters_mm();
        assert_eq!(both, Some([19.82, 21.0]), "a step");
    }
}
