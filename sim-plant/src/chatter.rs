//! Regenerative chatter: the tool gives way across the groove in one mode, and meets what a turn before left.
//! In: stiffness and thickness of the chip, how far the spindle turns, in steps of a control cycle. Out: the
//! place of the tool beside where its slide holds it, mm; how thick the chip is in the mean.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | p | mm | tool beside the slide, positive into the material |
//! | m, c, k | kg … | mode: k N/mm, frequency ω/2π Hz, damping ζ; m = k/ω², c = 2ζω m |
//! | θ | turn | angle of the spindle, unwrapped, in the direction it turns |
//! | h, h₀ | mm | thickness of the chip; what it is when nothing swings |
//! | K | N/mm | force across the groove for each mm of that: specific force, width of the chip, radial share |
//! | q(θ) | mm | where the surface lies beside that of a tool which does not give way |
//!
//! ```text
//! m p″ + c p′ + k p = −F,   F = K max(0, h),   h = h₀ + p − q(θ − 1)                              (M234)
//! q(θ) = p  if h > 0,  else q(θ − 1) − h₀: a tool out of the material leaves what it finds         (M235)
//! ```
//! Source: Tlusty and Polacek (1963), Tobias and Fishwick (1958); with the chip lost and found again Tlusty
//! and Ismail (CIRP Annals 30, 1981). The delay is a turn of the *angle*: at a varied speed it is not a fixed
//! time. A control cycle is taken in steps of at most 1/64 period, each exact for a force that stays (which
//! is taken in the middle of the step, so that it neither takes damping away nor brings any).
//!
//! The model is that of a tool each of whose edges meets what the one before left a turn ago, as a chaser
//! with several teeth does. A single point meets in a thread what the *pass* before left: what that
//! regenerates depends on the angle of each pass, and is not modelled.

use core::f64::consts::TAU;

/// Places in a turn whose surface is kept.
const PLACES: usize = 4096;
/// Steps in a period of the mode at least.
const STEPS: f64 = 64.0;

/// A mode of the tool across the groove.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChatterMode {
    /// Stiffness k, N/mm.
    pub stiffness_n_mm: f64,
    /// Frequency, Hz.
    pub hz: f64,
    /// Damping ζ, a share of the critical one.
    pub damping: f64,
}

/// The chip that a tool takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chip {
    /// K: force across the groove for each mm of its thickness, N/mm; 0 in the air.
    pub stiffness_n_mm: f64,
    /// h₀, mm.
    pub thickness_mm: f64,
}

/// The tool, and what it left within the last turn.
#[derive(Clone, Debug)]
pub struct Chatter {
    stiffness_n_mm: f64,
    step_s: f64,
    steps: u32,
    /// What becomes of place and speed in a step: of each by each.
    step: [[f64; 2]; 2],
    p: f64,
    v: f64,
    turns: f64,
    /// q at the middle of the last step, and that angle in places.
    left: (f64, f64),
    /// q of two turns, by places.
    surface: Vec<f64>,
}

impl Chatter {
    /// A tool at rest in the air, taken in steps of a control cycle, s.
    ///
    /// # Panics
    /// If a number is not positive, or the damping not below 1.
    pub fn new(mode: ChatterMode, cycle_s: f64) -> Chatter {
        let ChatterMode { stiffness_n_mm, hz, damping } = mode;
        assert!(stiffness_n_mm > 0.0 && hz > 0.0 && cycle_s > 0.0, "a mode has a stiffness and a frequency");
        assert!(damping > 0.0 && damping < 1.0, "damping {damping}");
        let steps = (cycle_s * hz * STEPS).ceil().max(1.0);
        let (step_s, omega) = (cycle_s / steps, TAU * hz);
        let damped = omega * (1.0 - damping * damping).sqrt();
        let decay = libm::exp(-damping * omega * step_s);
        let (sin, cos) = libm::sincos(damped * step_s);
        let lag = damping * omega / damped;
        Chatter {
            stiffness_n_mm,
            step_s,
            steps: steps as u32,
            step: [
                [decay * (cos + lag * sin), decay * sin / damped],
                [-decay * omega * omega / damped * sin, decay * (cos - lag * sin)],
            ],
            p: 0.0,
            v: 0.0,
            turns: 0.0,
            left: (0.0, 0.0),
            surface: vec![0.0; 2 * PLACES],
        }
    }

    /// p, mm.
    pub fn place_mm(&self) -> f64 {
        self.p
    }

    /// The cut has been going on for long, and nothing swings.
    pub fn settle(&mut self, chip: &Chip) {
        (self.p, self.v) = (-chip.stiffness_n_mm * chip.thickness_mm / self.stiffness_n_mm, 0.0);
        self.surface.fill(self.p);
        self.left.1 = self.p;
    }

    /// Kicks the tool: it has this speed from now on besides the one it has, mm/s.
    pub fn kick(&mut self, mm_s: f64) {
        self.v += mm_s;
    }

    /// One control cycle, in which the spindle turns by so many turns in its direction: the mean thickness of
    /// the chip, mm. `watch` sees p after every step.
    pub fn advance(&mut self, chip: &Chip, turned: f64, mut watch: impl FnMut(f64)) -> f64 {
        let (step, mut sum) = (turned.abs() / f64::from(self.steps), 0.0);
        for _ in 0..self.steps {
            let middle = (self.turns + 0.5 * step) * PLACES as f64;
            let p = self.p + 0.5 * self.step_s * self.v;
            let met = self.met(middle);
            let h = chip.thickness_mm + p - met;
            let cuts = h > 0.0 && chip.stiffness_n_mm > 0.0;
            let force = if cuts { chip.stiffness_n_mm * h } else { 0.0 };
            let q = match () {
                () if chip.stiffness_n_mm == 0.0 => 0.0,
                () if cuts => p,
                () => met - chip.thickness_mm,
            };
            self.leave(middle, q);
            sum += if cuts { h } else { 0.0 };
            let rest = -force / self.stiffness_n_mm;
            let [[pp, pv], [vp, vv]] = self.step;
            let (u, v) = (self.p - rest, self.v);
            (self.p, self.v) = (rest + pp * u + pv * v, vp * u + vv * v);
            self.turns += step;
            watch(self.p);
        }
        sum / f64::from(self.steps)
    }

    /// What a turn before left at an angle, in places.
    fn met(&self, at: f64) -> f64 {
        let at = at - PLACES as f64;
        let below = at.floor();
        let [from, to] = [below, below + 1.0].map(|place| self.surface[place_of(place)]);
        from + (to - from) * (at - below)
    }

    /// The surface up to an angle, in places: a straight line from the last one.
    fn leave(&mut self, at: f64, q: f64) {
        let (before, q_before) = self.left;
        let last = at.floor();
        let first = (before.floor() + 1.0).max(last - PLACES as f64);
        let mut place = first;
        while place <= last {
            let share = (place - before) / (at - before);
            self.surface[place_of(place)] = q_before + (q - q_before) * share;
            place += 1.0;
        }
        self.left = (at, q);
    }
}

/// Where a place lies in the ring.
fn place_of(place: f64) -> usize {
    (place as i64).rem_euclid(2 * PLACES as i64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODE: ChatterMode = ChatterMode { stiffness_n_mm: 20_000.0, hz: 120.0, damping: 0.04 };
    const CYCLE_S: f64 = 0.0005;

    /// Places p at the end of every cycle of a second at a speed, 1/min.
    fn run(chatter: &mut Chatter, chip: &Chip, rpm: f64, seconds: f64) -> Vec<f64> {
        let cycles = (seconds / CYCLE_S) as usize;
        (0..cycles)
            .map(|_| {
                chatter.advance(chip, rpm / 60.0 * CYCLE_S, |_| ());
                chatter.place_mm()
            })
            .collect()
    }

    #[test]
    fn m234_in_the_air_it_swings_and_dies_away_as_its_mode_says() {
        let mut chatter = Chatter::new(MODE, CYCLE_S);
        chatter.kick(1.0);
        let swing = run(&mut chatter, &Chip::default(), 300.0, 0.2);
        let (omega, zeta) = (TAU * MODE.hz, MODE.damping);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        for (n, p) in swing.iter().enumerate() {
            let t = (n + 1) as f64 * CYCLE_S;
            let exact = libm::exp(-zeta * omega * t) * libm::sin(damped * t) / damped;
            assert!((p - exact).abs() < 1e-12, "{p}, not {exact} at {t} s");
        }
    }

    #[test]
    fn m234_a_steady_cut_bends_the_tool_by_its_force() {
        let chip = Chip { stiffness_n_mm: 800.0, thickness_mm: 0.1 };
        let mut chatter = Chatter::new(MODE, CYCLE_S);
        let swing = run(&mut chatter, &chip, 300.0, 8.0);
        let bent = -800.0 * 0.1 / 20_000.0;
        let last = swing[swing.len() - 1];
        assert!((last - bent).abs() < 1e-9, "{last}, not {bent}");
    }

    #[test]
    fn the_delay_is_a_turn_whatever_the_speed_does() {
        // A soft cut that hardly feels: the surface is that of the free swing, and is met a turn later.
        let chip = Chip { stiffness_n_mm: 1e-6, thickness_mm: 1.0 };
        for rpm in [60.0, 300.0, 2000.0] {
            let mut chatter = Chatter::new(MODE, CYCLE_S);
            chatter.kick(1.0);
            let (mut turns, mut course, mut speed) = (0.0, vec![], rpm);
            while turns < 2.5 {
                let turned = speed / 60.0 * CYCLE_S;
                chatter.advance(&chip, turned, |_| ());
                turns += turned;
                course.push((turns, chatter.place_mm()));
                speed *= 1.0002;
                if turns > 1.0 + 2.0 * turned {
                    let met = chatter.met(turns * PLACES as f64);
                    let after =
                        course.partition_point(|(at, _)| *at < turns - 1.0).clamp(1, course.len() - 1);
                    let ((t0, p0), (t1, p1)) = (course[after - 1], course[after]);
                    let expected = p0 + (p1 - p0) * ((turns - 1.0 - t0) / (t1 - t0));
                    // Half a cycle of the swing is a straight line to so much.
                    assert!((met - expected).abs() < 6e-5, "{rpm}: {met}, not {expected} at {turns}");
                }
            }
        }
    }

    #[test]
    fn m235_a_tool_out_of_the_material_cuts_nothing_and_leaves_what_is_there() {
        let chip = Chip { stiffness_n_mm: 1500.0, thickness_mm: 0.05 };
        let mut chatter = Chatter::new(MODE, CYCLE_S);
        run(&mut chatter, &chip, 300.0, 0.5);
        chatter.kick(-400.0);
        let mut least = f64::INFINITY;
        for _ in 0..4 {
            least = least.min(chatter.advance(&chip, 300.0 / 60.0 * CYCLE_S, |_| ()));
        }
        assert_eq!(least, 0.0, "it was out");
        // Nothing is cut twice, and nothing is forgotten: over many turns the mean chip is that of the feed.
        let turns = 60;
        let cycles = turns * (0.2 / CYCLE_S) as usize;
        let sum: f64 = (0..cycles).map(|_| chatter.advance(&chip, 300.0 / 60.0 * CYCLE_S, |_| ())).sum();
        let mean = sum / cycles as f64;
        assert!((mean - 0.05).abs() < 0.05 * 0.03, "{mean}");
    }

    #[test]
    fn a_spindle_that_stands_or_jumps_is_taken_as_it_is() {
        let chip = Chip { stiffness_n_mm: 1500.0, thickness_mm: 0.05 };
        let mut chatter = Chatter::new(MODE, CYCLE_S);
        for turned in [0.0, 0.0, 3.7, -0.2, 1e9, 0.0, 0.001] {
            assert!(chatter.advance(&chip, turned, |p| assert!(p.is_finite())).is_finite(), "{turned}");
        }
    }
}
