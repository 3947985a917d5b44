//! What torque each place of a turn of the motor needs beyond what is believed: above all its cogging, which
//! no drive measures. In: every control cycle, where the motor stands and what torque its drive gives. Out:
//! torque to feed forward at a place, N·m.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | x, θ | mm, – | position of the motor as measured; where in its turn that is, 0 … 1 |
//! | τ | N·m | torque that the drive gives, as it believes |
//! | M | kg | moving mass as believed |
//! | N, T | –, s | half width of the look, in control cycles of T |
//! | d | N·m | torque that neither accelerated nor was known to be needed |
//! | d̄ | N·m | its mean over about a turn: friction, weight |
//! | n | turns | learned from so far, 1 … 2 |
//! | U(θ) | N·m | what has been learned: a table of 256 places |
//! | n_g, T, φ | –, N·m, rad | cogging as believed: how often a turn, torque, phase |
//!
//! ```text
//! d = Σ (N − |i|)/N² (τ(i) − U(i)) − M lead/2π (x(N) − 2 x(0) + x(−N))/(N T)²,   −N < i < N
//! U(θ) ← U + 256 Δturns/n (d − d̄),   fed forward: U − mean of U                                  (M133)
//! ```
//! A second difference over N cycles is the acceleration averaged by a triangle: torque is averaged by the
//! same one. A triangle turns no frequency round, it only makes fast ones small; so what is learned never
//! drives what it came from. Where U is right the drive has nothing left to do, d is d̄, and nothing changes
//! any more: an error of M or of the torque constant makes the way there longer, not its end another.
//!
//! What is believed of cogging fills the table at the start:
//!
//! ```text
//! U(θ) = Σ T sin(n_g 2π θ + φ)/sinc²(n_g/256),   sinc u = sin(π u)/(π u)                            (M133)
//! ```
//! Between two places it is in proportion, which makes a sine smaller by sinc². It is fed forward wholly
//! until something is learned, and for good where nothing shall be; of an axis with a reference run not
//! before that run, since nobody knows where in its turn the motor stands.
//!
//! It is learned while the axis moves evenly, and slowly enough that every place is seen. It is fed forward,
//! at any speed, by how much it explains of the torque over the last turns: all from four fifths on, nothing
//! below a half. So noise is not fed forward. A table that explains less than none would is forgotten: the
//! motor is not where it was.

use core::array;
use core::f64::consts::{PI, TAU};

use machine::{AxisConfig, Feedforward};
use protocol::Cycle;

/// Places of a turn.
const PLACES: usize = 256;
/// Half width of the look, s: what comes 400 times a second is not seen any more.
const LOOK_S: f64 = 2.5e-3;
/// The same in control cycles, at most.
const WIDEST: usize = 16;
/// How long an axis has to have moved evenly before anything is learned, s: the loops have settled.
const SETTLED_S: f64 = 0.05;
/// Even is an axis whose acceleration is below this share of its limit.
const EVEN: f64 = 0.01;
/// Slowest motion that teaches, turns per s: below it friction is not that of a sliding axis.
const SLOWEST: f64 = 0.1;
/// Turns that are averaged in the end, and over which is judged what the table explains.
const TURNS: f64 = 2.0;
/// Shares of the squares that it leaves, from which on it is fed forward, and up to which wholly.
const SOME: f64 = 0.5;
const WHOLE: f64 = 0.2;
/// Largest torque that is learned, a share of the limit of the drive: no good motor cogs more.
const LARGEST: f64 = 0.03;

/// One look at the motor.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    motor_mm: f64,
    /// Torque that was not known to be needed there.
    torque_nm: f64,
}

/// What a motor needs over its turn.
#[derive(Clone, Debug)]
pub struct Learning {
    places: [f64; PLACES],
    mean_nm: f64,
    /// The last looks, a ring.
    looks: [Look; 2 * WIDEST + 1],
    next: usize,
    half: usize,
    period_s: f64,
    lead_mm: f64,
    /// Torque by acceleration, N·m s²/mm.
    inertia: f64,
    uneven_mm_s2: f64,
    largest_nm: f64,
    /// The cycle that comes next.
    due: Cycle,
    /// Looks since the axis moves evenly.
    even: u32,
    /// Turns that d̄ and that the table are made of; the way they were made in.
    steady_turns: f64,
    steady_nm: f64,
    forwards: bool,
    /// Whether anything is learned beyond what is believed.
    learns: bool,
    turns: f64,
    /// The table as it is believed.
    believed: [f64; PLACES],
    /// Squares of what is left with the table, and of what would be without one, over the last turns.
    left: f64,
    bare: f64,
}

impl Learning {
    /// What an axis of the machine file believes and learns; `None` if it shall do neither.
    pub fn of(config: &AxisConfig, cycle_s: f64) -> Option<Learning> {
        let asked = config.learning || !config.cogging.is_empty();
        if !asked || config.feedforward != Feedforward::Full {
            return None;
        }
        let half = ((LOOK_S / cycle_s).round() as usize).clamp(1, WIDEST);
        let places = believed(&config.cogging);
        let mut learning = Learning {
            places,
            mean_nm: 0.0,
            looks: [Look::default(); 2 * WIDEST + 1],
            next: 0,
            half,
            period_s: cycle_s,
            lead_mm: config.screw_lead_mm,
            inertia: config.mass_kg * 1e-6 * config.screw_lead_mm / TAU,
            uneven_mm_s2: EVEN * config.acceleration_mm_s2,
            largest_nm: LARGEST * config.torque_limit_nm,
            due: Cycle(0),
            even: 0,
            steady_turns: 0.0,
            steady_nm: 0.0,
            forwards: true,
            learns: config.learning,
            turns: 0.0,
            believed: places,
            left: 0.0,
            bare: places.iter().map(|nm| nm * nm).sum::<f64>() / PLACES as f64,
        };
        if config.reference.is_some() {
            learning.forget();
        }
        Some(learning)
    }

    /// Takes where the motor stands in a cycle, mm, and what its drive gives, N·m; and the acceleration
    /// commanded, mm/s². Where cycles are missing it begins anew.
    pub fn look(&mut self, cycle: Cycle, motor_mm: f64, torque_nm: f64, commanded_mm_s2: f64) {
        if !self.learns {
            return;
        }
        if cycle != self.due {
            self.even = 0;
        }
        self.due = cycle.after(1);
        let width = 2 * self.half + 1;
        self.looks[self.next] = Look { motor_mm, torque_nm: torque_nm - self.known_nm(motor_mm) };
        self.next = (self.next + 1) % width;
        self.even = if commanded_mm_s2.abs() > self.uneven_mm_s2 { 0 } else { self.even.saturating_add(1) };
        if f64::from(self.even) * self.period_s > SETTLED_S && self.even as usize > width {
            self.learn();
        }
    }

    /// The oldest look is the next one to be written.
    fn seen(&self, i: usize) -> &Look {
        let width = 2 * self.half + 1;
        let at = self.next + i;
        &self.looks[if at < width { at } else { at - width }]
    }

    fn learn(&mut self) {
        let half = self.half;
        let [first, middle, last] = [0, half, 2 * half].map(|i| self.seen(i).motor_mm);
        let way_mm = (last - first) / (2 * half) as f64;
        let turned = way_mm.abs() / self.lead_mm;
        if turned < SLOWEST * self.period_s || turned * PLACES as f64 > 1.0 {
            return;
        }
        let n = half as f64;
        let share = |i: usize| (half - i.abs_diff(half)) as f64 / (n * n);
        let torque_nm: f64 = (1..2 * half).map(|i| share(i) * self.seen(i).torque_nm).sum();
        let acceleration = (last - 2.0 * middle + first) / (n * self.period_s * n * self.period_s);
        self.take(middle, way_mm > 0.0, turned, torque_nm - self.inertia * acceleration);
    }

    /// Takes d at a place.
    fn take(&mut self, motor_mm: f64, forwards: bool, turned: f64, torque_nm: f64) {
        if forwards != self.forwards {
            (self.forwards, self.steady_turns) = (forwards, 0.0);
        }
        self.steady_turns = (self.steady_turns + turned).min(1.0);
        self.steady_nm += turned / self.steady_turns * (torque_nm - self.steady_nm);
        if self.steady_turns < 1.0 {
            return;
        }
        let place = self.place(motor_mm) as usize % PLACES;
        let left_nm = torque_nm - self.steady_nm;
        let needed_nm = left_nm + self.places[place] - self.mean_nm;
        self.turns = (self.turns + turned).min(TURNS);
        let fading = turned / self.turns.max(1.0);
        self.left += fading * (left_nm * left_nm - self.left);
        self.bare += fading * (needed_nm * needed_nm - self.bare);
        if self.turns >= TURNS && self.left > self.bare {
            return self.forget();
        }
        let before_nm = self.places[place];
        let learned_nm = before_nm + fading * PLACES as f64 * left_nm;
        self.places[place] = learned_nm.clamp(-self.largest_nm, self.largest_nm);
        self.mean_nm += (self.places[place] - before_nm) / PLACES as f64;
    }

    /// Places count from elsewhere: what was learned is forgotten, what is believed is not.
    pub fn begin_anew(&mut self) {
        self.forget();
        self.places = self.believed;
        self.bare = self.places.iter().map(|nm| nm * nm).sum::<f64>() / PLACES as f64;
        self.looks = [Look::default(); 2 * WIDEST + 1];
        (self.even, self.steady_turns, self.steady_nm) = (0, 0.0, 0.0);
    }

    fn forget(&mut self) {
        self.places = [0.0; PLACES];
        (self.mean_nm, self.turns, self.left, self.bare) = (0.0, 0.0, 0.0, 0.0);
    }

    /// Where in its turn the motor stands, in places.
    fn place(&self, motor_mm: f64) -> f64 {
        let turns = motor_mm / self.lead_mm;
        (turns - turns.floor()) * PLACES as f64
    }

    /// What is fed forward at a place, N·m; between two places in proportion.
    pub fn torque_nm(&self, motor_mm: f64) -> f64 {
        let share = ((SOME - self.left / self.bare) / (SOME - WHOLE)).clamp(0.0, 1.0);
        if self.bare == 0.0 || share == 0.0 { 0.0 } else { share * self.known_nm(motor_mm) }
    }

    /// What the motor needs at a place as far as that is known, N·m.
    fn known_nm(&self, motor_mm: f64) -> f64 {
        let place = self.place(motor_mm) - 0.5;
        let below = place.floor();
        let at = (below as isize).rem_euclid(PLACES as isize) as usize;
        let (here, next) = (self.places[at], self.places[(at + 1) % PLACES]);
        here + (place - below) * (next - here) - self.mean_nm
    }
}

/// The table of cogging as believed, in rows of times a turn, N·m, degrees.
fn believed(rows: &[[f64; 3]]) -> [f64; PLACES] {
    array::from_fn(|place| {
        let turn = (place as f64 + 0.5) / PLACES as f64;
        let torque_nm = |[times, torque_nm, phase_deg]: &[f64; 3]| {
            let u = PI * times / PLACES as f64;
            let sinc = libm::sin(u) / u;
            torque_nm / (sinc * sinc) * libm::sin(TAU * times * turn + phase_deg.to_radians())
        };
        rows.iter().map(torque_nm).sum()
    })
}

#[cfg(test)]
mod tests {
    use machine::Machine;
    use protocol::Axis;

    use super::*;

    const T: f64 = 5e-4;
    const COGGING_NM: f64 = 0.05;

    fn learning() -> Learning {
        believing(&[], true)
    }

    fn believing(cogging: &[[f64; 3]], learning: bool) -> Learning {
        let plain = Machine::plain().axis[&Axis::Z].clone();
        let config = AxisConfig { learning, cogging: cogging.to_vec(), ..plain };
        Learning::of(&config, T).expect("it believes or learns")
    }

    /// A motor with a tenth more mass and torque than is believed, led at a speed by a stiff loop. Way of the
    /// motor about where it should be over its last turn, mm.
    struct Motor {
        cycle: u64,
        x: f64,
        v: f64,
        due: f64,
        integral: f64,
        shift: f64,
    }

    impl Motor {
        const NEW: Motor = Motor { cycle: 0, x: 0.0, v: 0.0, due: 0.0, integral: 0.0, shift: 0.0 };

        fn needed(&self, mm: f64) -> f64 {
            COGGING_NM * libm::sin(TAU * (24.0 * mm / 5.0 + self.shift))
        }

        fn turns(&mut self, learning: &mut Learning, turns: f64, speed: f64) -> f64 {
            let [mut low, mut high] = [f64::MAX, f64::MIN];
            let (inertia, end) = (1.1 * learning.inertia, self.due + 5.0 * turns * speed.signum());
            while (end - self.due) * speed > 0.0 {
                self.due += speed * T;
                let error = self.due - self.x;
                self.integral += 30.0 * error * T;
                let loops = 0.05 * (100.0 * error + speed - self.v) + self.integral;
                let torque = loops + learning.torque_nm(self.x);
                learning.look(Cycle(self.cycle), self.x, torque, 0.0);
                self.cycle += 1;
                self.v += T / inertia * (1.1 * torque - self.needed(self.x) - 0.3);
                self.x += self.v * T;
                if (end - self.due).abs() < 5.0 {
                    (low, high) = (low.min(error), high.max(error));
                }
            }
            high - low
        }
    }

    #[test]
    fn what_a_turn_needs_is_learned_within_some_turns_either_way() {
        for speed in [15.0, -6.0] {
            let (mut learning, mut motor) = (learning(), Motor::NEW);
            let before = motor.turns(&mut learning, 2.0, speed);
            let after = motor.turns(&mut learning, 13.0, speed);
            assert!(after < before / 5.0, "{before} mm before, {after} mm after at {speed} mm/s");
            let worst = (0..500).map(|i| 0.01 * f64::from(i)).fold(0.0, |worst: f64, mm| {
                worst.max((learning.torque_nm(mm) - motor.needed(mm) / 1.1).abs())
            });
            assert!(worst < 0.15 * COGGING_NM, "{worst} N·m at {speed} mm/s");
        }
    }

    #[test]
    fn what_is_believed_is_fed_forward_at_its_phase_and_is_never_changed_without_learning() {
        let mut learning = believing(&[[24.0, 0.05, 70.0], [64.0, 0.02, -20.0]], false);
        let wave = |mm: f64, times, degrees: f64| libm::sin(TAU * times * mm / 5.0 + degrees.to_radians());
        for cycle in 0..20_000 {
            let mm = -40.0 + 15.0 * T * cycle as f64;
            let due_nm = 0.05 * wave(mm, 24.0, 70.0) + 0.02 * wave(mm, 64.0, -20.0);
            let off_nm = learning.torque_nm(mm) - due_nm;
            assert!(off_nm.abs() < 0.007, "{off_nm} N·m at {mm} mm");
            learning.look(Cycle(cycle), mm, 10.0 * due_nm, 0.0);
        }
        let [mut cos, mut sin] = [0.0; 2];
        for mm in (0..5000).map(|i| 1e-3 * f64::from(i)) {
            cos += learning.torque_nm(mm) * wave(mm, 64.0, 70.0) / 2500.0;
            sin += learning.torque_nm(mm) * wave(mm, 64.0, -20.0) / 2500.0;
        }
        assert!(cos.abs() < 1e-4 && (sin - 0.02).abs() < 1e-4, "{sin} and {cos} N·m");
    }

    #[test]
    fn learning_begins_with_what_is_believed_and_takes_off_what_is_wrong_of_it() {
        let off = |cogging, learns| { Motor::NEW }.turns(&mut believing(&[cogging], learns), 8.0, 15.0);
        let bare = off([24.0, 0.0, 0.0], false);
        let [believed, learned] = [false, true].map(|learns| off([24.0, 0.041, 8.0], learns));
        assert!(
            believed < bare / 3.0 && learned < believed / 3.0,
            "{bare} mm, believed {believed} mm, learned {learned} mm"
        );
    }

    #[test]
    fn a_motor_that_is_not_where_it_was_is_learned_anew() {
        let (mut learning, mut motor) = (learning(), Motor::NEW);
        motor.turns(&mut learning, 12.0, 15.0);
        motor.shift = 0.5;
        let shifted = motor.turns(&mut learning, 1.0, 15.0);
        let after = motor.turns(&mut learning, 16.0, 15.0);
        assert!(after < shifted / 5.0, "{shifted} mm, {after} mm after");
    }

    #[test]
    fn nothing_is_learned_of_motion_that_is_uneven_too_fast_or_too_slow() {
        for (speed, acceleration) in [(15.0, 100.0), (60.0, 0.0), (0.3, 0.0)] {
            let mut learning = learning();
            for cycle in 0..20_000 {
                let mm = speed * T * cycle as f64;
                learning.look(Cycle(cycle), mm, libm::sin(mm), acceleration);
            }
            assert_eq!(learning.places, [0.0; PLACES], "{speed} mm/s, {acceleration} mm/s²");
        }
    }

    #[test]
    fn noise_is_not_fed_forward_and_nothing_is_learned_beyond_a_bound() {
        let (mut learning, mut random) = (learning(), 12345u64);
        for cycle in 0..200_000 {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let noise = (random >> 40) as f64 / f64::from(1 << 24) - 0.5;
            learning.look(Cycle(cycle), 15.0 * T * cycle as f64, noise, 0.0);
            assert!(learning.places.iter().all(|nm| nm.abs() <= learning.largest_nm));
            assert_eq!(learning.torque_nm(0.02 * cycle as f64), 0.0);
        }
    }
}
