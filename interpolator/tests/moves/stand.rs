//! An ideal machine around an interpolator: drives are enabled, axes stand where they were told to, the
//! spindle turns as commanded.

use interpolator::{In, Interpolator, Out};
use machine::Machine;
use protocol::{
    AxisState, AxisStatus, Code, CodePacket, Cycle, Feed, Item, MachineState, Measurement, Panel, PerAxis,
    Position, units::AXES,
};

/// Operation enabled, as CiA 402 reports it.
const ENABLED: u32 = 0x0237;

pub(crate) struct Stand {
    pub(crate) machine: Machine,
    pub(crate) upper: Interpolator,
    pub(crate) panel: Panel,
    pub(crate) out: Option<Out>,
    /// Items that have not been sent.
    pub(crate) items: std::collections::VecDeque<Item>,
    sent: u64,
    ticks: u64,
    turned: f64,
}

impl Stand {
    pub(crate) fn new(items: impl IntoIterator<Item = Item>) -> Stand {
        let machine = Machine::plain();
        Stand {
            upper: Interpolator::new(&machine),
            machine,
            panel: Panel::default(),
            out: None,
            items: items.into_iter().collect(),
            sent: 0,
            ticks: 0,
            turned: 0.0,
        }
    }

    /// As many items as the interpolator wants.
    pub(crate) fn send(&mut self, most: usize) {
        for _ in 0..most {
            if !self.upper.wants() {
                return;
            }
            let Some(item) = self.items.pop_front() else { return };
            self.upper.push(&CodePacket::pack(self.sent, &item)).expect("a good item");
            self.sent += 1;
        }
    }

    /// One tick; what came out.
    pub(crate) fn tick(&mut self) -> Out {
        let tick_s = self.machine.general.interpolator_cycle_s;
        let rpm = self.out.map_or(0.0, |out| out.spindle.rpm);
        self.turned += rpm / 60.0 * tick_s * self.machine.spindle_counts();
        let cycle = Cycle(self.ticks * self.machine.cycles_per_tick());
        let mut measurement = Measurement {
            cycle,
            spindle_count: self.turned.floor() as i64,
            panel: self.panel,
            ..Measurement::default()
        };
        let mut axes = PerAxis::<AxisStatus>::default();
        for (axis, config) in self.machine.axes() {
            let i = axis.index();
            let at =
                self.out.map_or(Position::from_mm(config.home_mm), |out| out.frames[i].setpoint.position);
            (measurement.axes[i].position, measurement.axes[i].status_word) = (at, ENABLED);
            (axes[i].state, axes[i].in_position) = (AxisState::Streaming as u32, 1);
            axes[i].commanded_mm = at.mm();
            axes[i].cycle = Cycle(cycle.0.saturating_sub(1));
        }
        let out = self.upper.tick(&In { measurement: &measurement, axes: &axes }).expect("a new measurement");
        self.ticks += 1;
        self.out = Some(out);
        out
    }

    /// X and Z of the last setpoint, mm.
    pub(crate) fn at(&self) -> [f64; 2] {
        let out = self.out.expect("a tick");
        [0, 2].map(|i| out.frames[i].setpoint.position.mm())
    }

    /// Speed along the path, mm/s.
    pub(crate) fn speed(&self) -> f64 {
        let out = self.out.expect("a tick");
        let [x, z] = [0, 2].map(|i| out.frames[i].setpoint.velocity_mm_s);
        libm::hypot(x, z)
    }

    pub(crate) fn state(&self) -> MachineState {
        MachineState::from_code(self.out.expect("a tick").status.state).expect("a state")
    }

    /// Runs to the end with everything sent in time; points at every tick.
    pub(crate) fn run(&mut self, mut each: impl FnMut(&mut Stand, u64)) -> Vec<[f64; 2]> {
        let mut points = Vec::new();
        for n in 0..1_000_000 {
            self.send(usize::MAX);
            each(self, n);
            let out = self.tick();
            points.push(self.at());
            if out.spindle.finished != 0 {
                return points;
            }
        }
        panic!("the program does not end");
    }
}

/// A point of the lathe.
pub(crate) fn point(x: f64, z: f64) -> PerAxis<Position> {
    let mut point = [Position(0); AXES];
    (point[0], point[2]) = (Position::from_mm(x), Position::from_mm(z));
    point
}

pub(crate) fn line(number: u32, x: f64, z: f64, feed: Feed) -> Item {
    Item { line: number, code: Code::Line { target: point(x, z), feed } }
}

pub(crate) fn code(number: u32, code: Code) -> Item {
    Item { line: number, code }
}
