//! A curve thinned so that no peak is lost. In: samples in any number, in any order of x. Out: for each of a
//! fixed number of intervals of x its lowest and its highest sample, both at their true places.

/// Lowest and highest sample of one interval, as (x, y).
type Slot = Option<((f64, f64), (f64, f64))>;

/// The envelope of a curve over a known interval.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    from: f64,
    width: f64,
    slots: Vec<Slot>,
}

impl Envelope {
    /// An empty curve over `from..=to` that will keep at most `2 * slots` points.
    pub(super) fn new(from: f64, to: f64, slots: usize) -> Envelope {
        assert!(slots > 0, "an envelope has an interval");
        let width = ((to - from) / slots as f64).max(f64::MIN_POSITIVE);
        Envelope { from, width, slots: vec![None; slots] }
    }

    /// Takes a sample; one outside the interval is left out.
    pub(super) fn add(&mut self, x: f64, y: f64) {
        let place = (x - self.from) / self.width;
        let last = self.slots.len() - 1;
        if !y.is_finite() || !(0.0..=self.slots.len() as f64).contains(&place) {
            return;
        }
        let slot = &mut self.slots[(place as usize).min(last)];
        let (low, high) = slot.get_or_insert(((x, y), (x, y)));
        if y < low.1 {
            *low = (x, y);
        }
        if y > high.1 {
            *high = (x, y);
        }
    }

    /// The points in the order of x, each interval giving one or two.
    pub(super) fn points(&self) -> Vec<(f64, f64)> {
        let mut points = Vec::with_capacity(2 * self.slots.len());
        for (low, high) in self.slots.iter().flatten() {
            let (first, second) = if low.0 <= high.0 { (low, high) } else { (high, low) };
            points.push(*first);
            if first.0 != second.0 {
                points.push(*second);
            }
        }
        points
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
}
