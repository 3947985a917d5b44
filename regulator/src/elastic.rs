//! What the drive train gives between motor and slide, as believed. In: the motion that the slide shall do,
//! mm and s. Out: the motion of the motor that makes it do so.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | s, v, a, j, dj | mm … mm/s⁴ | motion of the slide as commanded |
//! | n | mm | the nut |
//! | ω | rad/s | mode of the slide against the standing motor |
//!
//! ```text
//! n = s + a/ω²,   n′ = v + j/ω²,   n″ = a + dj/ω²                                                 (M131)
//! ```
//! From m s″ = k (n − s) with k = m ω²: the nut stands ahead by what the spring needs to accelerate the
//! slide. Of what is commanded near the mode nothing reaches the motor, so it does not swing, however lightly
//! it is damped; damping is left out.

use core::f64::consts::TAU;

use machine::AxisConfig;
use motion::Sample;

/// The spring between motor and slide.
#[derive(Clone, Copy, Debug)]
pub struct Elastic {
    /// 1/ω², s².
    compliance: f64,
}

impl Elastic {
    /// What is believed of an axis; rigid if nothing is.
    pub fn of(config: &AxisConfig) -> Elastic {
        let compliance = |mode_hz: f64| 1.0 / (TAU * mode_hz * TAU * mode_hz);
        Elastic { compliance: config.mode_hz.map_or(0.0, compliance) }
    }

    /// How far the nut stands ahead of the slide, mm.
    pub fn ahead_mm(&self, slide: &Sample) -> f64 {
        self.compliance * slide.a
    }

    /// The motion of the nut.
    pub fn nut(&self, slide: &Sample) -> Sample {
        let Sample { s, v, a, j, dj } = *slide;
        let c = self.compliance;
        Sample { s: s + c * a, v: v + c * j, a: a + c * dj, j, dj }
    }
}
