//! What each structure feeds forward, and where it has it from (M54, M67). In: the commanded motion about the
//! present. Out: the reference of the position loop, speed, acceleration, and the speed that friction is
//! reckoned for.
//!
//! | structure | speed | acceleration | friction | position loop |
//! |---|---|---|---|---|
//! | `none` | – | – | – | every cycle |
//! | `difference-v` | backward | – | – | every n cycles, rounded |
//! | `difference-va` | backward | backward | – | every n cycles, rounded |
//! | `difference-v`, centred | centred about t_v | – | centred about t_a | every n cycles, rounded |
//! | `difference-va`, centred | centred about t_v | centred about t_a | centred about t_a | every n cycles, rounded |
//! | `analytic-v` | law at t_v | – | – | every cycle |
//! | `analytic-va-no-lead` | law at 0 | law at 0 | – | every cycle |
//! | `full` | law at t_v | law at t_a | law at t_a | every cycle |
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | t_v, t_a | s | leads of speed and of acceleration and friction, after the present; the way to the drive is part of them |
//! | q, n, T, h = n T | mm, –, s, s | quantum of positions, control cycles between two of them, control cycle |
//! | x̂ | mm | position of the motor, rounded: q round(x/q) |
//!
//! ```text
//! backward:         v = (x̂(t) − x̂(t − h))/h               a = (x̂(t) − 2 x̂(t − h) + x̂(t − 2h))/h²  (M67)
//! centred about l:  v = (x̂(l + h/2) − x̂(l − h/2))/h       a = (x̂(l + h) − 2 x̂(l) + x̂(l − h))/h²
//! ```
//! Backward differences are those of a control whose position loop runs slower and sees counts of a position
//! alone. They remember the positions that were sent. Before the first one the axis stood where it is: motion
//! begins without a jump.

use machine::{AxisConfig, Feedforward as Structure};

use crate::reference::Motor;

/// What the loops get in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feed {
    /// Reference of the position loop, mm at the axis.
    pub position_mm: f64,
    /// Speed, mm/s at the motor.
    pub v: f64,
    /// Acceleration, mm/s² at the motor.
    pub a: f64,
    /// Where the motor is when it is fed forward, mm.
    pub place_mm: f64,
    /// Speed that friction is fed forward for, mm/s at the motor; `None` for no friction.
    pub friction_v: Option<f64>,
}

/// Where speed and acceleration come from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Nothing,
    /// The law, at a lead in s.
    Law(f64),
    /// Differences of positions that were sent.
    Backward,
    /// Differences about a lead in s.
    Centred(f64),
}

/// A row of the table: what is fed forward.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    speed: Source,
    /// Of acceleration and friction.
    ahead: Source,
    acceleration: bool,
    friction: bool,
}

/// The feedforward of one axis.
#[derive(Clone, Debug)]
pub struct Feedforward {
    row: Row,
    rounded: Option<Rounded>,
}

/// Rounded positions: how, and the last two that were sent.
#[derive(Clone, Copy, Debug)]
struct Rounded {
    quantum_mm: f64,
    cycles: u64,
    step_s: f64,
    sent: Option<[f64; 2]>,
}

impl Feedforward {
    /// The structure that an axis of the machine file asks for.
    /// The drive takes what is fed forward `output_s` later.
    pub fn new(config: &AxisConfig, cycle_s: f64, output_s: f64) -> Feedforward {
        use Source::{Backward, Centred, Law, Nothing};
        let (t_v, t_a) = (config.velocity_lead_s + output_s, config.acceleration_lead_s + output_s);
        let row = |speed, ahead, acceleration, friction| Row { speed, ahead, acceleration, friction };
        let centred = config.difference.centred;
        let row = match config.feedforward {
            Structure::None => row(Nothing, Nothing, false, false),
            Structure::DifferenceV if centred => row(Centred(t_v), Centred(t_a), false, true),
            Structure::DifferenceVa if centred => row(Centred(t_v), Centred(t_a), true, true),
            Structure::DifferenceV => row(Backward, Nothing, false, false),
            Structure::DifferenceVa => row(Backward, Backward, true, false),
            Structure::AnalyticV => row(Law(t_v), Nothing, false, false),
            Structure::AnalyticVaNoLead => row(Law(0.0), Law(0.0), true, false),
            Structure::Full => row(Law(t_v), Law(t_a), true, true),
        };
        let differences = matches!(config.feedforward, Structure::DifferenceV | Structure::DifferenceVa);
        let rounded = differences.then(|| Rounded {
            quantum_mm: config.difference.quantum_mm,
            cycles: u64::from(config.difference.cycles),
            step_s: f64::from(config.difference.cycles) * cycle_s,
            sent: None,
        });
        Feedforward { row, rounded }
    }

    /// Control cycles from one position to the next.
    pub fn cycles(&self) -> u64 {
        self.rounded.map_or(1, |rounded| rounded.cycles)
    }

    /// Farthest look back and ahead of the present, s, both ≥ 0.
    pub fn reach_s(&self) -> [f64; 2] {
        let about = |source| match source {
            Source::Nothing | Source::Backward => [0.0, 0.0],
            Source::Law(lead) => [-lead, lead],
            Source::Centred(lead) => {
                let step_s = self.rounded.map_or(0.0, |rounded| rounded.step_s);
                [step_s - lead, step_s + lead]
            }
        };
        let ([back, ahead], [also_back, also_ahead]) = (about(self.row.speed), about(self.row.ahead));
        [back.max(also_back).max(0.0), ahead.max(also_ahead).max(0.0)]
    }

    /// The axis has no command: what was sent is forgotten.
    pub fn rest(&mut self) {
        if let Some(rounded) = &mut self.rounded {
            rounded.sent = None;
        }
    }

    /// What is fed forward now. Structures that hold positions are asked every [`Feedforward::cycles`]
    /// cycles.
    pub fn feed(&mut self, motor: &Motor) -> Feed {
        let Row { speed, ahead, acceleration, friction } = self.row;
        let [_, v, _] = self.derivatives(speed, motor);
        let [place_mm, friction_v, a] = self.derivatives(ahead, motor);
        if let Some(rounded) = &mut self.rounded {
            rounded.send(motor);
        }
        let position_mm = motor.sampled_mm;
        Feed {
            position_mm: self.rounded.map_or(position_mm, |rounded| rounded.round(position_mm)),
            v,
            a: if acceleration { a } else { 0.0 },
            place_mm,
            friction_v: friction.then_some(friction_v),
        }
    }

    /// Position, speed and acceleration from a source; 0 of what it does not know.
    fn derivatives(&self, source: Source, motor: &Motor) -> [f64; 3] {
        match (source, self.rounded) {
            (Source::Law(lead_s), _) => {
                let sample = motor.at(lead_s);
                [sample.s, sample.v, sample.a]
            }
            (Source::Backward, Some(rounded)) => rounded.backward(motor),
            (Source::Centred(lead_s), Some(rounded)) => rounded.centred(motor, lead_s),
            (Source::Nothing | Source::Backward | Source::Centred(_), _) => [0.0; 3],
        }
    }
}

impl Rounded {
    fn round(&self, mm: f64) -> f64 {
        (mm / self.quantum_mm).round() * self.quantum_mm
    }

    fn at(&self, motor: &Motor, lead_s: f64) -> f64 {
        self.round(motor.at(lead_s).s)
    }

    /// Remembers the present position.
    fn send(&mut self, motor: &Motor) {
        let now = self.at(motor, 0.0);
        self.sent = Some([now, self.sent.map_or(now, |[last, _]| last)]);
    }

    fn backward(&self, motor: &Motor) -> [f64; 3] {
        let (h, now) = (self.step_s, self.at(motor, 0.0));
        let [last, before] = self.sent.unwrap_or([now; 2]);
        [now, (now - last) / h, (now - 2.0 * last + before) / (h * h)]
    }

    fn centred(&self, motor: &Motor, l: f64) -> [f64; 3] {
        let (h, x) = (self.step_s, |lead_s| self.at(motor, lead_s));
        [x(l), (x(l + 0.5 * h) - x(l - 0.5 * h)) / h, (x(l + h) - 2.0 * x(l) + x(l - h)) / (h * h)]
    }
}
