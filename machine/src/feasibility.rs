//! What the axes of a machine can do: reach a point, turn an arc, follow a pass. In: machine code that has
//! been checked.

use motion::Exit;
use protocol::{Arc, Axis, AxisLaw, Curve, PerAxis, Position, Setpoint, ThreadPass};

use crate::{AxisConfig, Kinematics, Machine};

/// Places that differ by less are one, mm: what the wire rounds to, and a sum of two strokes.
const SAME_MM: f64 = 1e-6;

/// A stop without a plan takes so much longer than one that uses the limits to the full.
const STOP_MARGIN: f64 = 1.1;

/// Fewest control cycles between the index of a pass and its first motion: every regulator has seen the index
/// by then.
const INDEX_CYCLES: f64 = 10.0;

impl Machine {
    /// Control cycles at programmed speed that a pass leaves free between its index and its first motion:
    /// what [`Machine::call_off_s`] asks for, and a cycle to spare.
    pub fn index_margin_cycles(&self) -> f64 {
        INDEX_CYCLES.max((self.call_off_cycles() + 1.0) * self.highest_ratio())
    }

    /// How far into a pass it can be called off: the angle since its index, in seconds at programmed speed.
    /// It is the same on every axis, so that all of them give the pass up or none does, and no axis moves
    /// before it.
    ///
    /// A status tells of the cycle before its tick, and a frame that calls the pass off acts a tick later.
    /// What the spindle turns meanwhile, at its highest override, is this angle; and what it turns while
    /// counts and commands are on the bus.
    pub fn call_off_s(&self) -> f64 {
        self.highest_ratio() * self.call_off_cycles() * self.general.cycle_s
    }

    fn call_off_cycles(&self) -> f64 {
        self.cycles_per_tick() as f64 + 1.0 + f64::from(self.bus.input_cycles + self.bus.output_cycles)
    }

    /// Highest speed of the spindle as a multiple of the programmed one.
    fn highest_ratio(&self) -> f64 {
        (self.spindle.override_max_pct / 100.0).max(1.0)
    }

    /// Whether no axis moves before a pass can be called off everywhere.
    fn can_call_off(&self, pass: &ThreadPass) -> bool {
        let free_deg = 6.0 * pass.s_rpm * self.call_off_s();
        self.axes().all(|(axis, _)| {
            let law = pass.axis(axis);
            if pass.returns() {
                return law.run_in_c0_deg >= free_deg;
            }
            let moves = law.stroke_mm != 0.0 || law.is_led();
            !moves || law.begins_deg() >= free_deg
        })
    }

    /// Feasibility rule: whether every axis can follow a pass up to the ratio it claims (M7, M11), within its
    /// travel, to the end the law names, which is not its start, and begins late enough to be called off. Of
    /// a pass that returns: whether the spindle can turn round for it, and the law stays within the travel
    /// even if it did not. The pass has been checked.
    pub fn can_follow(&self, pass: &ThreadPass) -> bool {
        let taps = pass.returns() && self.general.kinematics != Kinematics::Positioner;
        let lathe = self.general.kinematics == Kinematics::Lathe; // only a lathe cuts other threads
        let ends_elsewhere = |law: &AxisLaw| (law.end.mm() - law.start.mm()).abs() > SAME_MM;
        (lathe || taps)
            && self.can_call_off(pass)
            && self.can_turn_round(pass)
            && (taps || self.axes().any(|(axis, _)| ends_elsewhere(pass.axis(axis))))
            && self.axes().all(|(axis, config)| {
                let law = pass.axis(axis);
                let (start, way) = (law.start.mm(), pass.law(axis));
                let top = config.limits().top_ratio(&way.peak());
                let end = start + way.at(law.done_deg()).s;
                let travel = config.travel_mm[0]..=config.travel_mm[1];
                top >= pass.max_ratio * (1.0 - 1e-9)
                    && (taps || (end - law.end.mm()).abs() < SAME_MM)
                    && [start, start + law.stroke_mm, end].iter().all(|mm| travel.contains(mm))
            })
    }

    /// Time in which every axis can brake to rest from its setpoint, s; 0 at rest.
    pub fn stop_s(&self, setpoints: &PerAxis<Setpoint>) -> f64 {
        let stop_s = |(axis, config): (Axis, &AxisConfig)| {
            let Setpoint { velocity_mm_s, acceleration_mm_s2, .. } = setpoints[axis.index()];
            match (velocity_mm_s, acceleration_mm_s2) {
                (0.0, 0.0) => 0.0,
                (v, a) => STOP_MARGIN * Exit::stop_s(v, a, &config.limits()),
            }
        };
        self.axes().map(stop_s).fold(0.0, f64::max)
    }

    /// Whether a point lies within the travel of every axis.
    pub fn can_reach(&self, point: &PerAxis<Position>) -> bool {
        self.axes().all(|(axis, config)| {
            (config.travel_mm[0]..=config.travel_mm[1]).contains(&point[axis.index()].mm())
        })
    }

    /// Whether the whole of an arc lies within the travel of every axis; false for what is no arc from there.
    pub fn can_turn(&self, from: &PerAxis<Position>, arc: &Arc) -> bool {
        arc.bounds(from).is_ok_and(|corners| corners.iter().all(|corner| self.can_reach(corner)))
    }

    /// Whether a piece of a curve from a start exists and lies within the travel of every axis.
    pub fn can_curve(&self, from: &PerAxis<Position>, curve: &Curve) -> bool {
        curve.path(from).is_ok_and(|path| {
            let corner = |corner: PerAxis<f64>| std::array::from_fn(|axis| from[axis].moved(corner[axis]));
            path.bounds().into_iter().all(|bound| self.can_reach(&corner(bound)))
        })
    }
}
