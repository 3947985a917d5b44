//! The largest of a measure over every length of a gauge along a thread. In: places along the thread in their
//! order and a value at each, mm. Out: for each window of the length, first place to last, the largest value.
//!
//! A window ends at each of the places, and begins at the first one that is not farther from it than the
//! length. All windows together take as many steps as there are places: what is smaller than a later value is
//! forgotten.

use std::collections::VecDeque;

/// A length that is as long as another one but for rounding, mm.
const SAME_MM: f64 = 1e-9;

/// Number of the first place of each window.
pub(crate) fn begins(places: &[f64], length: f64) -> Vec<usize> {
    let mut first = 0;
    let begin = |(last, at): (usize, &f64)| {
        while first < last && at - places[first] > length + SAME_MM {
            first += 1;
        }
        first
    };
    places.iter().enumerate().map(begin).collect()
}

/// The largest value in each window.
pub(crate) fn largest(begins: &[usize], value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut kept: VecDeque<(usize, f64)> = VecDeque::new();
    let mut out = Vec::with_capacity(begins.len());
    for (last, first) in begins.iter().enumerate() {
        let next = value(last);
        while kept.back().is_some_and(|(_, before)| *before <= next) {
            kept.pop_back();
        }
        kept.push_back((last, next));
        while kept.front().is_some_and(|(at, _)| at < first) {
            kept.pop_front();
        }
        out.push(kept.front().map_or(next, |(_, most)| *most));
    }
    out
}

/// Largest minus smallest value in each window.
pub(crate) fn ranges(begins: &[usize], value: impl Fn(usize) -> f64) -> Vec<f64> {
    let (high, low) = (largest(begins, &value), largest(begins, |i| -value(i)));
    high.iter().zip(low).map(|(high, low)| high + low).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_those_that_are_found_one_by_one() {
        let mut seed = testing::Seed::new(7);
        for _ in 0..200 {
            let n = 1 + (40.0 * seed.unit()) as usize;
            let mut at = 0.0;
            let places: Vec<f64> = (0..n)
                .map(|_| {
                    at += seed.unit();
                    at
                })
                .collect();
            let values: Vec<f64> = (0..n).map(|_| seed.unit() - 0.5).collect();
            let length = 5.0 * seed.unit();
            let begins = begins(&places, length);
            let ranges = ranges(&begins, |i| values[i]);
            for last in 0..n {
                let within = (0..=last).filter(|i| places[last] - places[*i] <= length);
                let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
                within.for_each(|i| (low, high) = (low.min(values[i]), high.max(values[i])));
                assert!((ranges[last] - (high - low)).abs() < 1e-12, "{last} of {places:?}, {length}");
            }
        }
    }
}
