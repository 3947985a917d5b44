//! The least interval that holds every value seen. In: values of any unit. Out: its ends.

/// Such an interval; it holds nothing at first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Span(Option<(f64, f64)>);

impl Span {
    /// Takes a value.
    pub(super) fn add(&mut self, value: f64) {
        let (low, high) = self.0.unwrap_or((value, value));
        self.0 = Some((low.min(value), high.max(value)));
    }

    /// Smallest and largest; zeros if nothing was seen.
    pub(super) fn ends(self) -> (f64, f64) {
        self.0.unwrap_or_default()
    }

    /// The same; nothing if nothing was seen.
    pub(super) fn seen(self) -> Option<(f64, f64)> {
        self.0
    }

    /// How far they are apart.
    pub(super) fn width(self) -> f64 {
        let (low, high) = self.ends();
        high - low
    }
}
