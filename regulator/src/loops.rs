//! The position loop and the feedforwards of mass and friction (M54).
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | Kv | 1/s | gain of the position loop |
//! | M | kg | moving mass as believed |
//! | Fc | N | Coulomb friction as believed |
//! | s0 | N/mm | stiffness of friction before it slides |
//! | z | mm | deflection of that stiffness: dz = v − s0\|v\|z/Fc |
//! | b | N·s/mm | viscous friction as believed |
//! | G | N | weight along the axis as believed; the motor gives −G from its first torque on |
//!
//! Enters: the reference in mm and s, the measured position of the axis in mm. Leaves: velocities in mm/s for
//! the drive, torque in N·m at the motor.
//!
//! Friction has no sign that switches, it has a deflection. At a stop v is 0, z stays, and with it the force:
//! a stopped slide leans on its friction, and taking the torque off would let it spring back by up to Fc/s0
//! (6 µm on the small lathe). On the way back z runs through zero to the other side within about two such
//! lengths, as the friction itself does: no step of the torque, and a slide that dithers by less than that
//! never gets the full force. Only the way commanded moves z, neither time nor noise of a measurement. |z| ≤
//! Fc/s0 at any speed, because the step is implicit.

use machine::{AxisConfig, Bus};
use protocol::AxisMeasurement;

use crate::{feedforward::Feedforward, learning::Learning, reference::Motor};

/// Output of the loops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Position loop, mm/s.
    pub target_velocity_mm_s: f64,
    /// Velocity feedforward, mm/s.
    pub velocity_offset_mm_s: f64,
    /// Torque feedforward, N·m.
    pub torque_offset_nm: f64,
}

/// The loops of one axis.
#[derive(Clone, Debug)]
pub struct Loops {
    feedforward: Feedforward,
    learning: Option<Learning>,
    /// What was commanded last, while there is a command.
    held: Option<Command>,
    position_gain: f64,
    mass: f64,
    weight: f64,
    friction: Friction,
    metres_per_radian: f64,
    step_s: f64,
}

impl Loops {
    /// The loops as an axis of the machine file sets them.
    pub fn new(config: &AxisConfig, bus: &Bus, cycle_s: f64) -> Loops {
        let feedforward = Feedforward::new(config, cycle_s, bus.output_s(cycle_s));
        Loops {
            step_s: cycle_s * feedforward.cycles() as f64,
            feedforward,
            learning: Learning::of(config, cycle_s),
            held: None,
            position_gain: config.position_gain_1_s,
            mass: config.mass_kg,
            weight: config.gravity_n,
            friction: Friction {
                coulomb: config.coulomb_n,
                stiffness: config.presliding_n_mm,
                viscous: config.viscous_n_s_mm,
                z: 0.0,
            },
            metres_per_radian: config.screw_lead_mm / 1000.0 / std::f64::consts::TAU,
        }
    }

    /// Farthest look back and ahead of the present, s, both ≥ 0: of feedforward, and back to when a
    /// measurement was made, `input_s` ago.
    pub fn reach_s(&self, input_s: f64) -> [f64; 2] {
        let [back_s, ahead_s] = self.feedforward.reach_s();
        [back_s.max(input_s), ahead_s]
    }

    /// The axis has no command; the next one begins at rest.
    pub fn rest(&mut self) -> Command {
        self.held = None;
        self.feedforward.rest();
        Command { torque_offset_nm: self.torque_nm(0.0), ..Command::default() }
    }

    /// Positions count from elsewhere: the next command begins at rest, what the turn of the motor has taught
    /// is begun anew.
    pub fn forget(&mut self) {
        self.held = None;
        self.feedforward.rest();
        if let Some(learning) = &mut self.learning {
            learning.begin_anew();
        }
    }

    /// One control cycle (M54); structures that hold positions repeat their command in between. The velocity
    /// PI that follows lives in the drive.
    pub fn tick(&mut self, motor: &Motor, measured_mm: f64, measured: &AxisMeasurement) -> Command {
        let due = motor.reference.cycle.0.is_multiple_of(self.feedforward.cycles());
        if let (false, Some(held)) = (due, self.held) {
            return held;
        }
        let feed = self.feedforward.feed(motor);
        let friction = feed.friction_v.map_or(0.0, |v| self.friction.force(v, self.step_s));
        let force = self.mass * feed.a / 1000.0 + friction;
        let learned_nm = self.learning.as_mut().map_or(0.0, |learning| {
            learning.look(motor.reference.cycle, measured.position.mm(), measured.torque_nm, feed.a);
            learning.torque_nm(feed.place_mm)
        });
        let command = Command {
            target_velocity_mm_s: self.position_gain * (feed.position_mm - measured_mm),
            velocity_offset_mm_s: feed.v,
            torque_offset_nm: self.torque_nm(force) + learned_nm,
        };
        self.held = Some(command);
        command
    }

    /// Torque that gives a force to what moves, N·m, N.
    fn torque_nm(&self, force: f64) -> f64 {
        (force - self.weight) * self.metres_per_radian
    }
}

/// Friction as believed: Coulomb with presliding, and viscous.
#[derive(Clone, Debug)]
struct Friction {
    coulomb: f64,
    stiffness: f64,
    viscous: f64,
    z: f64,
}

impl Friction {
    /// Force at speed `v` after one more step; the deflection is stepped implicitly, so any speed is stable.
    fn force(&mut self, v: f64, step_s: f64) -> f64 {
        if self.coulomb == 0.0 {
            return self.viscous * v;
        }
        let relax = self.stiffness * v.abs() / self.coulomb * step_s;
        self.z = (self.z + v * step_s) / (1.0 + relax);
        self.stiffness * self.z + self.viscous * v
    }
}
