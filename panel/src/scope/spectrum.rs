//! Spectra: how much of a signal comes at which frequency, or how often in a turn of the spindle. In: rows of
//! the ring, without a gap. Out: amplitudes, in the unit of the signal.
//!
//! | symbol | unit | is |
//! |---|---|---|
//! | x_k | of the signal | sample k of n, n a power of two |
//! | T | s | control cycle |
//! | R | turns | whole turns that the samples go over |
//! | A_m | of the signal | amplitude of line m: a sine of amplitude a that lies on a line has A = a |
//!
//! * (M240) window of Hann, w_k = ½ − ½ cos(2πk/n); A_m = 4/n |Σ w_k (x_k − x̄) e^(−2πi mk/n)| with
//!   x̄ = 2/n Σ w_k x_k; of samples in time line m lies at m/(nT) Hz. Between two lines a sine is 15 % lower
//!   at most.
//! * (M241) of samples at equal angles it lies at m/R per revolution. Each sample is the cubic through the
//!   four cycles about its angle; lines are shown up to an eighth of a cycle's share of the turn, where that
//!   is 1 % off at most.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::ring::Ring;

/// Most samples: the newest of the rows.
const MOST: usize = 16_384;
/// Fewer turns than this are no spectrum of a turn.
const LEAST_TURNS: f64 = 2.0;
/// Cycles in a period of the fastest that is shown over turns.
const CYCLES_OF_A_PERIOD: f64 = 8.0;

/// Amplitudes by signal, at lines that lie so far apart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spectrum {
    /// Hz, or 1/revolution.
    pub(crate) step: f64,
    pub(crate) amplitudes: Vec<Vec<f64>>,
    /// The rows that it is of.
    pub(crate) rows: Range<usize>,
}

impl Spectrum {
    /// By frequency, of the newest of these rows; nothing if they are less than 16.
    pub(crate) fn of_time(ring: &Ring, rows: Range<usize>, signals: &[usize]) -> Option<Spectrum> {
        let samples = (1 << rows.len().checked_ilog2()?).min(MOST);
        if samples < 16 {
            return None;
        }
        let rows = rows.end - samples..rows.end;
        let of = |column: &usize| amplitudes(rows.clone().map(|row| ring.value(*column, row)).collect());
        let step = 1.0 / (samples as f64 * ring.cycle_s());
        Some(Spectrum { step, amplitudes: signals.iter().map(of).collect(), rows })
    }

    /// By revolution, of the newest whole turns in which the spindle went on one way; nothing if they are
    /// less than two.
    pub(crate) fn of_turns(ring: &Ring, rows: Range<usize>, signals: &[usize]) -> Option<Spectrum> {
        let from = rows.start.max(rows.end.saturating_sub(MOST));
        let step = |row: usize| (ring.angle_deg(row) - ring.angle_deg(row - 1)) / 360.0;
        let last = rows.end.checked_sub(1)?;
        let way = (last > from).then(|| step(last).signum())?;
        let first = (from + 1..=last).rev().find(|row| way * step(*row) <= 0.0).unwrap_or(from);
        let turned = |row: usize| way * (ring.angle_deg(row) - ring.angle_deg(last)) / 360.0;
        let turns = (-turned(first)).floor();
        if turns.is_nan() || turns < LEAST_TURNS {
            return None;
        }
        let begins = (first..last).rev().find(|row| turned(*row) <= -turns).unwrap_or(first);
        let samples = (last - begins).next_power_of_two().min(MOST);
        let longest = (begins + 1..=last).map(|row| way * step(row)).fold(0.0, f64::max);
        let lines = (turns / (CYCLES_OF_A_PERIOD * longest)) as usize;
        let of = |column: &usize| {
            let mut row = begins;
            let sample = |number: usize| {
                let angle = turns * (number as f64 / samples as f64 - 1.0);
                while row + 1 < last && turned(row + 1) <= angle {
                    row += 1;
                }
                let share = (angle - turned(row)) / (way * step(row + 1));
                cubic(
                    |at: isize| ring.value(*column, row.saturating_add_signed(at).clamp(first, last)),
                    share,
                )
            };
            let mut all = amplitudes((0..samples).map(sample).collect());
            all.truncate(lines + 1);
            all
        };
        let amplitudes = signals.iter().map(of).collect();
        Some(Spectrum { step: 1.0 / turns, amplitudes, rows: begins..last + 1 })
    }

    /// How many lines there are.
    pub(crate) fn lines(&self) -> usize {
        self.amplitudes.first().map_or(0, Vec::len)
    }

    /// Of each signal where its highest line lies, and how high it is.
    pub(crate) fn peaks(&self) -> Vec<[f64; 2]> {
        let highest = |all: &Vec<f64>| {
            let most = all.iter().enumerate().max_by(|one, other| one.1.total_cmp(other.1));
            most.map_or([0.0; 2], |(line, amplitude)| [line as f64 * self.step, *amplitude])
        };
        self.amplitudes.iter().map(highest).collect()
    }
}

/// The cubic through the values at −1, 0, 1, 2.
fn cubic(value: impl Fn(isize) -> f64, share: f64) -> f64 {
    let u = share;
    let [a, b, c, d] = [-1, 0, 1, 2].map(value);
    -a * u * (u - 1.0) * (u - 2.0) / 6.0 + b * (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0
        - c * (u + 1.0) * u * (u - 2.0) / 2.0
        + d * (u + 1.0) * u * (u - 1.0) / 6.0
}

/// (M240), lines 0 to n/2 − 1 of a power of two of samples.
fn amplitudes(samples: Vec<f64>) -> Vec<f64> {
    let count = samples.len() as f64;
    let window: Vec<f64> =
        (0..samples.len()).map(|k| 0.5 - 0.5 * libm::cos(TAU * k as f64 / count)).collect();
    let mean = 2.0 / count * window.iter().zip(&samples).map(|(w, x)| w * x).sum::<f64>();
    let mut lines: Vec<_> = window.iter().zip(&samples).map(|(w, x)| (w * (x - mean), 0.0)).collect();
    transform(&mut lines);
    lines.truncate(samples.len() / 2);
    lines.into_iter().map(|(re, im)| 4.0 / count * libm::hypot(re, im)).collect()
}

/// Σ z_k e^(−2πi mk/n) in place, by halves (Cooley and Tukey); n is a power of two above 1.
fn transform(z: &mut [(f64, f64)]) {
    let bits = z.len().ilog2();
    for place in 0..z.len() {
        let other = place.reverse_bits() >> (usize::BITS - bits);
        if place < other {
            z.swap(place, other);
        }
    }
    for level in 0..bits {
        let half = 1 << level;
        for k in 0..half {
            let (sin, cos) = libm::sincos(-PI * k as f64 / half as f64);
            for at in (k..z.len()).step_by(2 * half) {
                let ((a, b), (c, d)) = (z[at], z[at + half]);
                let (re, im) = (c * cos - d * sin, c * sin + d * cos);
                (z[at], z[at + half]) = ((a + re, b + im), (a - re, b - im));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE_S: f64 = 5e-4;

    /// Rows with an angle, degrees, and a signal.
    fn ring(count: usize, angle_deg: impl Fn(f64) -> f64, signal: impl Fn(f64, f64) -> f64) -> Ring {
        let mut ring = Ring::default();
        ring.begin(["cycle", "spindle_true_deg", "signal"].map(str::to_owned).to_vec(), CYCLE_S, count);
        for cycle in 0..count {
            let angle = angle_deg(cycle as f64 * CYCLE_S);
            ring.take(&[cycle as f64, angle, signal(cycle as f64 * CYCLE_S, TAU * angle / 360.0)]);
        }
        ring
    }

    /// The sum itself, line by line.
    #[test]
    fn the_transform_is_the_sum_that_it_stands_for() {
        let mut seed = testing::Seed::new(5);
        let samples: Vec<_> = (0..64).map(|_| (seed.signed(), seed.signed())).collect();
        let mut lines = samples.clone();
        transform(&mut lines);
        for (m, line) in lines.iter().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for (k, (a, b)) in samples.iter().enumerate() {
                let (sin, cos) = libm::sincos(-TAU * (m * k) as f64 / 64.0);
                (re, im) = (re + a * cos - b * sin, im + a * sin + b * cos);
            }
            assert!((re - line.0).abs() < 1e-12 && (im - line.1).abs() < 1e-12, "line {m}");
        }
    }

    /// On a line a sine has its amplitude, whatever stands beside it; between two lines it is lower by what
    /// the window says; nothing else is higher than its skirts.
    #[test]
    fn a_sine_has_its_amplitude_at_its_frequency() {
        let line_hz = 1.0 / (4096.0 * CYCLE_S);
        for (lines, lowest) in [(100.0, 1.0 - 1e-9), (100.25, 0.95), (100.5, 0.848), (2000.0, 1.0 - 1e-9)] {
            let hz = lines * line_hz;
            let ring = ring(5000, |_| 0.0, |t, _| 250.0 + 0.7 * libm::sin(TAU * hz * t + 0.4));
            let spectrum = Spectrum::of_time(&ring, 0..5000, &[2]).expect("it is long enough");
            assert_eq!((spectrum.rows.clone(), spectrum.lines()), (904..5000, 2048));
            let [[at, amplitude]] = spectrum.peaks()[..] else { panic!("one signal") };
            assert!((at - hz).abs() <= 0.501 * line_hz, "{hz} Hz is seen at {at}");
            assert!((0.7 * lowest..0.7 * (1.0 + 1e-9)).contains(&amplitude), "{amplitude} at {lines}");
            let far = |line: usize| (line as f64 - lines).abs() > 8.0;
            let beside = (0..2048).filter(|line| far(*line)).map(|line| spectrum.amplitudes[0][line]);
            assert!(beside.fold(0.0, f64::max) < 1e-3, "of 0.7");
        }
    }

    /// A spindle that changes its speed by half: over turns what comes seven times in each stays one line,
    /// and over time it does not; backwards too.
    #[test]
    fn what_comes_with_each_turn_is_one_line_at_any_speed() {
        for way in [1.0, -1.0] {
            let angle = |t: f64| way * 360.0 * (5.0 * t + 1.25 * t * t);
            let ring =
                ring(4000, angle, |_, turned| 3.0 + 0.2 * libm::sin(7.0 * turned) - 0.05 * turned.signum());
            let spectrum = Spectrum::of_turns(&ring, 0..4000, &[2]).expect("it turns");
            assert!((spectrum.step - 1.0 / 14.0).abs() < 1e-12, "of 14.99 turns 14: {}", spectrum.step);
            let [[order, amplitude]] = spectrum.peaks()[..] else { panic!("one signal") };
            assert!((order - 7.0).abs() < 1e-9 && (amplitude - 0.2).abs() < 2e-4, "{amplitude} at {order}");
            let [[_, smeared]] = Spectrum::of_time(&ring, 0..4000, &[2]).expect("rows").peaks()[..] else {
                panic!("one signal")
            };
            assert!(smeared < 0.1, "{smeared}");
        }
        // Nearly as often as is shown, with eight cycles in a period.
        let ring = ring(4096, |t| 360.0 * 5.0 * t, |_, turned| libm::sin(49.0 * turned));
        let spectrum = Spectrum::of_turns(&ring, 0..4096, &[2]).expect("it turns");
        let [[order, amplitude]] = spectrum.peaks()[..] else { panic!("one signal") };
        assert!((order - 49.0).abs() < 1e-9 && (amplitude - 1.0).abs() < 0.01, "{amplitude} at {order}");
        assert!((49.8..50.1).contains(&((spectrum.lines() - 1) as f64 * spectrum.step)));
    }

    #[test]
    fn too_little_has_no_spectrum() {
        let stands = ring(1000, |_| 90.0, |t, _| t);
        assert_eq!(Spectrum::of_turns(&stands, 0..1000, &[2]), None);
        assert_eq!(Spectrum::of_time(&stands, 5..20, &[2]), None);
        assert_eq!(Spectrum::of_time(&stands, 7..7, &[2]), None);
        // It turned round: the turns before that are others.
        let back = ring(4000, |t| 360.0 * (5.0 * t - 2.0 * t * t).abs(), |t, _| t);
        assert_eq!(Spectrum::of_turns(&back, 0..2800, &[2]), None);
        assert!(Spectrum::of_turns(&back, 0..2000, &[2]).is_some());
        assert_eq!(Spectrum::of_turns(&back, 0..1, &[2]), None);
        assert_eq!(Spectrum::of_turns(&back, 0..0, &[2]), None);
    }
}
