//! A curve thinned so that no peak is lost. In: samples in any number, in any order of x. Out: for each of a
//! fixed number of intervals of x its lowest and its highest sample, both at their true places, and where
//! samples are missing.
//!
//! An interval without a sample is a gap if there were more than one in an interval beside it. Where samples
//! are as far apart as intervals, or farther, a gap is wider than twice the distances beside it.

/// The samples of one interval: the lowest and the highest as (x, y), and how many there were.
#[derive(Clone, Copy, Debug)]
struct Slot {
    low: (f64, f64),
    high: (f64, f64),
    count: u32,
}

/// The envelope of a curve over a known interval.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    from: f64,
    width: f64,
    /// Samples so near each other belong together, in intervals.
    near: f64,
    slots: Vec<Option<Slot>>,
}

impl Envelope {
    /// An empty curve over `from..=to` that will keep at most `2 * slots` points.
    pub(super) fn new(from: f64, to: f64, slots: usize) -> Envelope {
        assert!(slots > 0, "an envelope has an interval");
        let width = ((to - from) / slots as f64).max(f64::MIN_POSITIVE);
        Envelope { from, width, near: 1.0, slots: vec![None; slots] }
    }

    /// The same of samples that may be so far apart although none is missing.
    pub(super) fn with_steps(self, step: f64) -> Envelope {
        Envelope { near: (step / self.width).max(1.0), ..self }
    }

    /// Takes a sample; one outside the interval is left out.
    pub(super) fn add(&mut self, x: f64, y: f64) {
        let place = (x - self.from) / self.width;
        let last = self.slots.len() - 1;
        if !y.is_finite() || !(0.0..=self.slots.len() as f64).contains(&place) {
            return;
        }
        let empty = Slot { low: (x, y), high: (x, y), count: 0 };
        let slot = self.slots[(place as usize).min(last)].get_or_insert(empty);
        slot.count = slot.count.saturating_add(1);
        if y < slot.low.1 {
            slot.low = (x, y);
        }
        if y > slot.high.1 {
            slot.high = (x, y);
        }
    }

    /// The points in the order of x, each interval giving one or two.
    pub(super) fn points(&self) -> Vec<(f64, f64)> {
        self.strokes().into_iter().flatten().collect()
    }

    /// The same points; nothing where the pen is lifted over a gap.
    pub(super) fn strokes(&self) -> Vec<Option<(f64, f64)>> {
        let filled: Vec<(usize, Slot)> =
            self.slots.iter().enumerate().filter_map(|(at, slot)| Some((at, (*slot)?))).collect();
        let mut points = Vec::with_capacity(2 * filled.len());
        for (index, (_, Slot { low, high, .. })) in filled.iter().enumerate() {
            if self.is_gap(&filled, index) {
                points.push(None);
            }
            let (first, second) = if low.0 <= high.0 { (low, high) } else { (high, low) };
            points.push(Some(*first));
            if first.0 != second.0 {
                points.push(Some(*second));
            }
        }
        points
    }

    /// Whether samples are missing before one of the intervals that have some.
    fn is_gap(&self, filled: &[(usize, Slot)], index: usize) -> bool {
        let way = |index: usize| Some(filled.get(index)?.0 - filled.get(index.checked_sub(1)?)?.0);
        let Some(here) = way(index).filter(|here| *here as f64 > self.near) else { return false };
        let is_dense = filled[index - 1].1.count > 1 || filled[index].1.count > 1;
        let beside = [way(index - 1), way(index + 1)].into_iter().flatten().max();
        is_dense || beside.is_some_and(|beside| here > 2 * beside)
    }
}

#[cfg(test)]
mod tests {
    use super::Envelope;

    #[test]
    fn a_single_spike_survives_among_a_million_samples() {
        let mut envelope = Envelope::new(0.0, 1.0, 100);
        for i in 0..1_000_000 {
            envelope.add(f64::from(i) * 1e-6, if i == 123_456 { 7.0 } else { 0.0 });
        }
        let points = envelope.points();
        assert!(points.len() <= 200 && points.contains(&(0.123456, 7.0)), "{}", points.len());
        assert!(points.is_sorted_by_key(|point| point.0));
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let mut envelope = Envelope::new(0.0, 1.0, 10);
        [(-0.1, 1.0), (1.0, 2.0), (1.1, 3.0), (0.5, f64::NAN)]
            .into_iter()
            .for_each(|(x, y)| envelope.add(x, y));
        assert_eq!(envelope.points(), [(1.0, 2.0)]);
    }

    /// Between which samples the pen is lifted, of samples so far apart over a hundred intervals.
    fn lifted(step: f64, missing: std::ops::Range<f64>) -> Vec<(f64, f64)> {
        let mut envelope = Envelope::new(0.0, 100.0, 100);
        let places = (0..).map(|i| step * f64::from(i)).take_while(|x| *x <= 100.0);
        places.filter(|x| !missing.contains(x)).for_each(|x| envelope.add(x, 1.0));
        let strokes = envelope.strokes();
        let around = strokes.windows(3).filter(|three| three[1].is_none());
        around.filter_map(|three| Some((three[0]?.0, three[2]?.0))).collect()
    }

    #[test]
    fn the_pen_is_lifted_where_samples_are_missing_and_nowhere_else() {
        for step in [0.1, 0.3, 0.7, 1.0, 1.3, 1.9, 2.5, 7.0] {
            assert_eq!(lifted(step, 0.0..0.0), [], "every {step}");
            let gaps = lifted(step, 40.5..70.5);
            let [(before, after)] = gaps[..] else { panic!("every {step}: {gaps:?}") };
            assert!(before <= 40.5 && after >= 70.5 && after - before < 31.0 + 2.0 * step, "{gaps:?}");
        }
        assert_eq!(lifted(0.25, 50.0..51.0), [(49.0, 51.0)], "one interval, of many samples");
    }
}
