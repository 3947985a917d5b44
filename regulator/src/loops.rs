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
//!
//! Enters: the reference in mm and s, the measured position in mm. Leaves: velocities in mm/s for the drive, torque in
//! N·m at the motor.

use protocol::machine::AxisConfig;

use crate::reference::Reference;

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
    position_gain: f64,
    mass: f64,
    friction: Friction,
    metres_per_radian: f64,
    cycle_s: f64,
}

impl Loops {
    /// The loops as an axis of the machine file sets them.
    pub fn new(config: &AxisConfig, cycle_s: f64) -> Loops {
        Loops {
            position_gain: config.position_gain_1_s,
            mass: config.mass_kg,
            friction: Friction {
                coulomb: config.coulomb_n,
                stiffness: config.presliding_n_mm,
                viscous: config.viscous_n_s_mm,
                z: 0.0,
            },
            metres_per_radian: config.screw_lead_mm / 1000.0 / std::f64::consts::TAU,
            cycle_s,
        }
    }

    /// One control cycle (M54). The velocity PI that follows lives in the drive.
    pub fn tick(&mut self, reference: &Reference, measured_mm: f64) -> Command {
        let ahead = &reference.at_acceleration_lead;
        let force = self.mass * ahead.a / 1000.0 + self.friction.force(ahead.v, self.cycle_s);
        Command {
            target_velocity_mm_s: self.position_gain * (reference.now.s - measured_mm),
            velocity_offset_mm_s: reference.at_velocity_lead.v,
            torque_offset_nm: force * self.metres_per_radian,
        }
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
    /// Force at speed `v` after one more cycle; the deflection is stepped implicitly, so any speed is stable.
    fn force(&mut self, v: f64, cycle_s: f64) -> f64 {
        if self.coulomb == 0.0 {
            return self.viscous * v;
        }
        let relax = self.stiffness * v.abs() / self.coulomb * cycle_s;
        self.z = (self.z + v * cycle_s) / (1.0 + relax);
        self.stiffness * self.z + self.viscous * v
    }
}
