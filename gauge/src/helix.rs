//! From grooves at all angles to a thread. In: the cuts of each station along the axis, mm. Out: the cuts by
//! number of groove, and how the thread differs from an even one.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | i, j, n | – | number of a groove along the axis, of an angle; how many angles there are |
//! | A, P | mm | advance along Z in a turn, signed; distance of grooves |
//! | H | mm | where a thread without errors has the groove, less what is common to all |
//! | d, e | mm, – | deviation of the middle of a groove; error of the lead per length |
//! | q | mm | what is left of d: drunkenness |
//!
//! ```text
//! (M154) H = i P + j A/n,   d = z − H;   e: least squares of d over H within each angle and start
//!        start k: mean over angles of d − e H less that of all starts;   q = d − e H − start
//!        drunken: max q − min q in a turn
//! ```
//! A groove is numbered by the angle before: it has gone on by A/n there. After a turn the numbers are off by
//! the number of starts, or there are other ones than were meant. A lead that is wrong by a tenth goes on by
//! next to the same in a step, so this holds for threads that are far from what they should be.
//!
//! Within an angle and a start means: turns are compared with each other at the same angle, so that
//! drunkenness makes no error of the lead where a thread does not have whole turns.

use std::collections::BTreeMap;

use crate::{groove::Cut, nominal::Nominal, window};

/// The cuts of a thread by their places along it.
#[derive(Clone, Debug)]
pub(crate) struct Thread {
    pub(crate) cuts: Vec<Cut>,
    /// By how many grooves a turn goes on, signed as the advance; none if there is less than a turn.
    pub(crate) goes_on: Option<i64>,
}

/// How a thread differs from an even one of the nominal lead; mm.
#[derive(Clone, Debug)]
pub(crate) struct Helix {
    /// e.
    pub(crate) lead: f64,
    /// Largest minus smallest offset of the starts.
    pub(crate) starts: f64,
    /// q of each cut.
    pub(crate) rest: Vec<f64>,
    /// Largest range of q within a turn.
    pub(crate) drunken: f64,
    /// Change of h_s along the thread, per length.
    pub(crate) taper: f64,
    /// Range of h_s less that, averaged at each angle: what a dial shows while the thread is turned.
    pub(crate) runout: f64,
}

/// Gives every cut its number of groove, counted from those about the middle of the thread, mm: what lies
/// beyond its ends need not be one.
pub(crate) fn link(nominal: &Nominal, middle_mm: f64, stations: Vec<Vec<Cut>>) -> Thread {
    let (n, advance) = (stations.len() as f64, nominal.advance_mm());
    let mut before: Option<(usize, Vec<Cut>)> = None;
    let mut first: Option<(usize, Cut)> = None;
    let mut cuts = Vec::new();
    for (station, mut here) in stations.into_iter().enumerate().filter(|(_, here)| !here.is_empty()) {
        let far = |cut: &Cut| (cut.middle - middle_mm).abs();
        let middle =
            (0..here.len()).min_by(|a, b| far(&here[*a]).total_cmp(&far(&here[*b]))).unwrap_or_default();
        let step = |from: usize| advance * (station - from) as f64 / n;
        let shift = before.as_ref().and_then(|(from, there)| {
            nearest(there, here[middle].middle - step(*from), f64::INFINITY).map(|cut| cut.groove)
        });
        let shift = shift.map_or(0, |groove| groove - middle as i64);
        for (at, cut) in here.iter_mut().enumerate() {
            (cut.station, cut.groove) = (station, at as i64 + shift);
            cut.nominal = nominal.pitch_mm * cut.groove as f64 + advance * station as f64 / n;
        }
        first = first.or(Some((station, here[middle])));
        cuts.extend_from_slice(&here);
        before = Some((station, here));
    }
    let goes_on = first.zip(before).and_then(|((begin, cut), (end, there))| {
        let step = advance * (n + begin as f64 - end as f64) / n;
        let back = nearest(&there, cut.middle - step, 0.5 * nominal.pitch_mm)?;
        Some(cut.groove - back.groove)
    });
    Thread { cuts, goes_on }
}

/// The cut nearest to a place, if it is within reach.
fn nearest(cuts: &[Cut], place: f64, reach: f64) -> Option<&Cut> {
    let far = |cut: &&Cut| (cut.middle - place).abs();
    cuts.iter().min_by(|a, b| far(a).total_cmp(&far(b))).filter(|cut| far(cut) <= reach)
}

/// Mean of a value over the cuts of each group.
fn means<K: Ord>(
    cuts: &[Cut],
    group: impl Fn(&Cut) -> K,
    value: impl Fn(usize) -> f64,
) -> BTreeMap<K, (f64, f64)> {
    let mut sums: BTreeMap<K, (f64, f64)> = BTreeMap::new();
    for (i, cut) in cuts.iter().enumerate() {
        let (n, sum) = sums.entry(group(cut)).or_default();
        (*n, *sum) = (*n + 1.0, *sum + value(i));
    }
    sums.into_iter().map(|(key, (n, sum))| (key, (n, sum / n))).collect()
}

/// Offset of each start: from the others at the same angle if all are seen at any, else its mean.
fn offsets(
    cuts: &[Cut],
    starts: u32,
    start: impl Fn(&Cut) -> i64 + Copy,
    value: impl Fn(usize) -> f64 + Copy,
) -> BTreeMap<i64, (f64, f64)> {
    let mut stations: BTreeMap<usize, Vec<(i64, f64)>> = BTreeMap::new();
    for ((station, k), (_, mean)) in means(cuts, |cut| (cut.station, start(cut)), value) {
        stations.entry(station).or_default().push((k, mean));
    }
    let mut offsets: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    for all in stations.values().filter(|all| all.len() == starts as usize) {
        let middle = all.iter().map(|(_, mean)| mean).sum::<f64>() / f64::from(starts);
        for (k, mean) in all {
            let (n, sum) = offsets.entry(*k).or_default();
            (*n, *sum) = (*n + 1.0, *sum + mean - middle);
        }
    }
    if offsets.is_empty() {
        return means(cuts, start, value);
    }
    offsets.values_mut().for_each(|(n, sum)| *sum /= *n);
    offsets
}

/// Largest minus smallest mean.
fn range<K>(means: &BTreeMap<K, (f64, f64)>) -> f64 {
    let values = || means.values().map(|(_, mean)| *mean);
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}

/// Slope of a value over H by least squares, its means and those of H taken within groups; `None` if no group
/// is long enough.
fn slope<K: Ord>(
    cuts: &[Cut],
    group: impl Fn(&Cut) -> K + Copy,
    value: impl Fn(usize) -> f64 + Copy,
) -> Option<f64> {
    let (along, of) = (means(cuts, group, |i| cuts[i].nominal), means(cuts, group, value));
    let (mut spread, mut common) = (0.0, 0.0);
    for (i, cut) in cuts.iter().enumerate() {
        let key = group(cut);
        let h = cut.nominal - along[&key].1;
        spread += h * h;
        common += h * (value(i) - of[&key].1);
    }
    (spread > 1e-6).then(|| common / spread)
}

impl Helix {
    /// Of the cuts of a thread in the order of H; at least one.
    pub(crate) fn of(nominal: &Nominal, cuts: &[Cut]) -> Helix {
        let starts = i64::from(nominal.starts);
        let start = |cut: &Cut| cut.groove.rem_euclid(starts);
        let deviation = |i: usize| cuts[i].middle - cuts[i].nominal;
        let within = slope(cuts, |cut| (cut.station, start(cut)), deviation);
        let lead = within.or_else(|| slope(cuts, |_| (), deviation)).unwrap_or(0.0);
        let even = |i: usize| deviation(i) - lead * cuts[i].nominal;
        let offsets = offsets(cuts, nominal.starts, start, even);
        let rest: Vec<f64> = (0..cuts.len()).map(|i| even(i) - offsets[&start(&cuts[i])].1).collect();
        let places: Vec<f64> = cuts.iter().map(|cut| cut.nominal).collect();
        let turn = window::begins(&places, nominal.lead_mm());
        let drunken = window::ranges(&turn, |i| rest[i]).into_iter().fold(0.0, f64::max);
        let taper = slope(cuts, |cut| cut.station, |i| cuts[i].simple);
        let taper = taper.or_else(|| slope(cuts, |_| (), |i| cuts[i].simple)).unwrap_or(0.0);
        let round = means(cuts, |cut| cut.station, |i| cuts[i].simple - taper * cuts[i].nominal);
        Helix { lead, starts: range(&offsets), rest, drunken, taper, runout: range(&round) }
    }
}
