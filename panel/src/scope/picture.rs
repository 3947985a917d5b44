//! What is drawn. In: rows of the ring, an x for each. Out: curves of so many points that between two of them
//! nothing is lost: where rows are more, each point has the lowest and the highest value of its rows.

use std::ops::Range;

use super::{ring::Ring, spectrum::Spectrum};

/// Passes, or turns, that are laid over each other: the newest.
const MOST_CURVES: usize = 16;

/// Values that are compared at once: a processor does so with several at a time.
const LANES: usize = 8;

/// The lowest and the highest of some values, of those that are numbers; neither is one where none is.
pub(crate) fn extremes<'a>(parts: impl IntoIterator<Item = &'a [f64]>) -> [f64; 2] {
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let mut take = |lane: usize, value: f64| {
        low[lane] = if value < low[lane] { value } else { low[lane] };
        high[lane] = if value > high[lane] { value } else { high[lane] };
    };
    for part in parts {
        let (whole, rest) = part.as_chunks::<LANES>();
        whole.iter().for_each(|values| (0..LANES).for_each(|lane| take(lane, values[lane])));
        rest.iter().enumerate().for_each(|(lane, value)| take(lane, *value));
    }
    let [low, high] =
        [low.into_iter().fold(f64::INFINITY, f64::min), high.into_iter().fold(f64::NEG_INFINITY, f64::max)];
    if low > high { [f64::NAN; 2] } else { [low, high] }
}

/// Places along x with the lowest and the highest value of each signal there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Curve {
    /// Number of the pass, or of the turn; 0 over time.
    pub(crate) number: i64,
    pub(crate) x: Vec<f64>,
    /// By signal.
    pub(crate) low: Vec<Vec<f64>>,
    pub(crate) high: Vec<Vec<f64>>,
}

impl Curve {
    /// Of rows, or lines, that follow each other, each with its x; by the lowest and the highest value of a
    /// signal in some of them: within a window, of so many points.
    pub(crate) fn of(
        extremes: impl Fn(usize, Range<usize>) -> [f64; 2],
        rows: impl ExactSizeIterator<Item = (f64, usize)>,
        signals: &[usize],
        (from, span, points): (f64, f64, usize),
        number: i64,
    ) -> Curve {
        let each = rows.len() <= points;
        let mut curve = Curve { number, ..Curve::default() };
        let mut parts: Vec<Range<usize>> = Vec::new();
        let mut place = None;
        for (x, row) in rows {
            let here =
                (from..=from + span).contains(&x).then(|| ((x - from) / span * points as f64) as usize);
            match parts.last_mut() {
                _ if here.is_none() => {}
                Some(part) if !each && here == place => part.end = row + 1,
                _ => {
                    curve.x.push(x);
                    parts.push(row..row + 1);
                }
            }
            place = here;
        }
        for signal in signals {
            let values = parts.iter().map(|part| extremes(*signal, part.clone()));
            let (low, high) = values.map(|[low, high]| (low, high)).unzip();
            curve.low.push(low);
            curve.high.push(high);
        }
        curve
    }
}

/// What is drawn, and of what.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Drawn {
    pub(crate) curves: Vec<Curve>,
    /// Where x begins, and how far it goes.
    pub(crate) window: (f64, f64),
    /// First and last cycle of a stretch of time, and how many between them are not there.
    pub(crate) cycles: [u64; 2],
    pub(crate) missing: u64,
    /// Of a spectrum: where the highest line of each signal lies, and how high it is.
    pub(crate) peaks: Option<Vec<[f64; 2]>>,
}

/// First and last cycle of rows, and how many between them are not there.
fn cycles(ring: &Ring, rows: &Range<usize>) -> ([u64; 2], u64) {
    if rows.is_empty() {
        return ([0, 0], 0);
    }
    let [first, last] = [rows.start, rows.end - 1].map(|row| ring.cycle(row));
    let apart = last.saturating_sub(first).saturating_add(1);
    ([first, last], apart.saturating_sub(rows.len() as u64))
}

/// Rows over time, s.
pub(crate) fn over_time(
    ring: &Ring,
    rows: Range<usize>,
    signals: &[usize],
    points: usize,
    window: (f64, f64),
) -> Drawn {
    let (cycle_s, (from, span)) = (ring.cycle_s(), window);
    let (cycles, missing) = cycles(ring, &rows);
    let x = ring.cycles(rows.clone()).zip(rows).map(|(cycle, row)| (cycle * cycle_s, row));
    let whole = ((from / cycle_s).round() * cycle_s, span + 0.5 * cycle_s, points);
    let curve = Curve::of(|column, rows| ring.extremes(column, rows), x, signals, whole, 0);
    Drawn { curves: vec![curve], window, cycles, missing, peaks: None }
}

/// The spectrum of rows, by frequency or by revolution; without curves where there is none: cycles are
/// missing, or rows or turns are too few.
pub(crate) fn spectrum(
    ring: &Ring,
    rows: Range<usize>,
    signals: &[usize],
    points: usize,
    by_revolution: bool,
) -> Drawn {
    let (all, missing) = cycles(ring, &rows);
    let spectrum = match (missing, by_revolution) {
        (0, false) => Spectrum::of_time(ring, rows, signals),
        (0, true) => Spectrum::of_turns(ring, rows, signals),
        _ => None,
    };
    let Some(spectrum) = spectrum else {
        return Drawn { window: (0.0, 1.0), cycles: all, missing, ..Drawn::default() };
    };
    let (cycles, missing) = cycles(ring, &spectrum.rows);
    let x = (0..spectrum.lines()).map(|line| (line as f64 * spectrum.step, line));
    let window = (0.0, spectrum.lines() as f64 * spectrum.step);
    let which: Vec<_> = (0..signals.len()).collect();
    let amplitudes = |signal: usize, lines: Range<usize>| extremes([&spectrum.amplitudes[signal][lines]]);
    let curve = Curve::of(amplitudes, x, &which, (window.0, window.1, points), 0);
    Drawn { curves: vec![curve], window, cycles, missing, peaks: Some(spectrum.peaks()) }
}

/// Rows that belong together over the angle of the spindle.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    number: i64,
    rows: Range<usize>,
    /// Angle that is 0 in it, degrees.
    zero_deg: f64,
}

/// Stretches of rows that have the same number, without those that have none or whose beginning is gone.
fn stretches(
    ring: &Ring,
    number: impl Fn(usize) -> Option<i64>,
    zero: impl Fn(usize) -> f64,
) -> Vec<Stretch> {
    let mut all: Vec<Stretch> = Vec::new();
    let mut before = None;
    for row in 0..ring.rows() {
        let now = number(row);
        match (now, all.last_mut()) {
            (Some(_), Some(last)) if now == before => last.rows.end = row + 1,
            (Some(number), _) => all.push(Stretch { number, rows: row..row + 1, zero_deg: zero(row) }),
            (None, _) => {}
        }
        before = now;
    }
    let whole = |stretch: &Stretch| stretch.rows.start > 0 || ring.oldest() == 0;
    all.retain(whole);
    all.split_off(all.len().saturating_sub(MOST_CURVES))
}

/// Passes over the angle from the index at which each began, degrees, in the direction of the spindle; with
/// how far the longest goes.
pub(crate) fn passes(ring: &Ring, signals: &[usize], points: usize, window: Option<(f64, f64)>) -> Drawn {
    let number = |row| Some(ring.pass(row) as i64).filter(|pass| *pass > 0);
    // The cycle that first shows the index is less than half a turn away from it.
    let zero = |row| (ring.angle_deg(row) / 360.0).round() * 360.0;
    let stretches = stretches(ring, number, zero);
    over_angle(ring, &stretches, signals, points, window)
}

/// Turns of the spindle over each other.
pub(crate) fn turns(ring: &Ring, signals: &[usize], points: usize, window: Option<(f64, f64)>) -> Drawn {
    let turn = |row| (ring.angle_deg(row) / 360.0).floor();
    let stretches = stretches(ring, |row| Some(turn(row) as i64), |row| turn(row) * 360.0);
    over_angle(ring, &stretches, signals, points, Some(window.unwrap_or((0.0, 360.0))))
}

fn over_angle(
    ring: &Ring,
    stretches: &[Stretch],
    signals: &[usize],
    points: usize,
    window: Option<(f64, f64)>,
) -> Drawn {
    let angle = |stretch: &Stretch, row: usize| {
        let from_zero = |row| ring.angle_deg(row) - stretch.zero_deg;
        let backwards = window.is_none() && from_zero(stretch.rows.end - 1) < 0.0;
        if backwards { -from_zero(row) } else { from_zero(row) }
    };
    let longest = stretches.iter().map(|stretch| angle(stretch, stretch.rows.end - 1)).fold(1.0, f64::max);
    let (from, span) = window.unwrap_or((0.0, longest));
    let curve = |stretch: &Stretch| {
        let rows = stretch.rows.clone().map(|row| (angle(stretch, row), row));
        Curve::of(
            |column, rows| ring.extremes(column, rows),
            rows,
            signals,
            (from, span, points),
            stretch.number,
        )
    };
    let curves = stretches.iter().map(curve).collect();
    Drawn { curves, window: (from, span), ..Drawn::default() }
}

#[cfg(test)]
mod tests {
    use super::{
        super::ring::tests::{filled, row},
        *,
    };

    #[test]
    fn lowest_and_highest_of_every_point_are_those_of_its_rows() {
        let ring = filled(0..3000, 3000);
        let column = ring.column("z_error").expect("it is there");
        let all = || (0..3000).map(|row| (row as f64, row));
        let value = |column, rows| ring.extremes(column, rows);
        let curve = Curve::of(value, all(), &[column], (0.0, 3000.0, 100), 0);
        assert_eq!(curve.x.len(), 100);
        for (place, x) in curve.x.iter().enumerate() {
            let next = curve.x.get(place + 1).map_or(3000, |next| *next as u64);
            assert!((29..=31).contains(&(next - *x as u64)), "{x}");
            let values = (*x as u64..next).map(|cycle| row(cycle)[5]);
            let (low, high) =
                values.fold((f64::MAX, f64::MIN), |(low, high), one| (low.min(one), high.max(one)));
            assert_eq!((curve.low[0][place], curve.high[0][place]), (low, high), "{x}");
        }
        // Where there is room for every row, every row is there.
        let few = Curve::of(value, (100..160).map(|row| (row as f64, row)), &[column], (100.0, 59.0, 100), 0);
        assert_eq!(few.low, few.high);
        assert_eq!(few.low[0], (100..160).map(|cycle| row(cycle)[5]).collect::<Vec<_>>());
    }

    #[test]
    fn passes_lie_over_each_other_from_their_index_on() {
        let ring = filled(0..3000, 3000);
        let column = ring.column("z_error").expect("it is there");
        let Drawn { curves, window, .. } = passes(&ring, &[column], 4000, None);
        assert_eq!(window, (0.0, 3.0 * 419.0), "from the index of cycle 1080 to cycle 1499");
        let numbers: Vec<_> = curves.iter().map(|curve| curve.number).collect();
        assert_eq!(numbers, [1, 2]);
        assert_eq!(curves[0].x, curves[1].x, "both from their own index");
        assert_eq!(curves[1].low[0][0], row(2280)[5]);
        let near = passes(&ring, &[column], 10, Some((300.0, 60.0))).curves;
        assert!(near[0].x.len() <= 11 && near[0].x[0] == 300.0, "{:?}", near[0].x);
        // Of a pass whose index is gone nobody knows where it began.
        let late = passes(&filled(0..3000, 1800), &[column], 4000, None).curves;
        assert_eq!(late.iter().map(|curve| curve.number).collect::<Vec<_>>(), [2]);
        let Drawn { curves: turns, window, .. } = turns(&ring, &[column], 4000, None);
        assert_eq!((turns.len(), window), (16, (0.0, 360.0)));
        assert_eq!(turns[3].x, (0..120).map(|cycle| 3.0 * f64::from(cycle)).collect::<Vec<_>>());
    }
}
