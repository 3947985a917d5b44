//! An ideal machine: regulators that follow their laws by the true spindle angle without error, and a plant
//! that is where it should be, plus exactly the errors that a test asks for. In: passes. Out: the records of
//! a run.

use machine::{Machine, Part};
use protocol::{
    Axis, AxisLaw, AxisState, AxisStatus, Code, Cycle, Item, MachineState, MachineStatus, Position,
    ThreadPass, Truth,
};

use crate::observe::{GaugeAsked, Observation, Observer, Record};

/// Errors to inject into one pass.
#[derive(Clone, Copy, Default)]
pub(crate) struct Injected {
    /// Offset from the helix in the middle of the thread, µm.
    pub(crate) phase_um: f64,
    /// Growth of the offset, µm per turn.
    pub(crate) lead_error_um_per_rev: f64,
    /// The slide lies this much further than the motor, µm.
    pub(crate) slide_um: f64,
    /// And this much, as a function of the axis and the angle, µm.
    pub(crate) slide_at_um: Option<fn(Axis, f64) -> f64>,
    /// Servo error of X and Z as a function of state and angle since the state began to be possible, µm.
    pub(crate) servo_um: Option<fn(Axis, AxisState, f64) -> f64>,
    /// The run stops dead at this angle.
    pub(crate) broken_off_deg: Option<f64>,
}

/// The ideal machine.
pub(crate) struct Ideal {
    pub(crate) machine: Machine,
    /// Actual over programmed speed of the spindle.
    pub(crate) ratio: f64,
    /// True angle at the start, degrees.
    pub(crate) spindle_deg: f64,
    pub(crate) truth: Truth,
    pub(crate) status: MachineStatus,
    /// The tool of every pass, and the part with its zero on the machine: X, Z.
    pub(crate) tool: u32,
    pub(crate) part: Option<(Part, [f64; 2])>,
    /// Where zero of the program lies, X and Z, if nobody has described the part.
    pub(crate) zero: Option<[f64; 2]>,
    pub(crate) gauge: Option<GaugeAsked>,
}

/// A pass by 2 mm/rev along -Z at 600 1/min, X going in by 1 mm, ten turns of thread.
pub(crate) fn pass(number: u32) -> ThreadPass {
    let mut pass = ThreadPass {
        pass: number,
        s_rpm: 600.0,
        direction: 1.0,
        lead_mm: -2.0,
        max_ratio: 1.37,
        depth_mm: 0.2,
        ..ThreadPass::default()
    };
    lay_out(&mut pass);
    pass
}

/// Lays out the laws of a pass from its lead and start angle.
pub(crate) fn lay_out(pass: &mut ThreadPass) {
    let (start, locked) = (pass.start_angle_deg, pass.start_angle_deg + 540.0);
    let end = locked + 3600.0;
    let out = AxisLaw { retract_c_deg: end, retract_dc_deg: 180.0, ..AxisLaw::default() };
    pass.thread_end_deg = end;
    pass.axes[Axis::X.index()] = AxisLaw {
        start: Position::from_mm(12.0),
        end: Position::from_mm(12.0),
        stroke_mm: -1.0,
        stroke_c0_deg: start + 40.0,
        stroke_dc_deg: 500.0,
        retract_mm: 1.0,
        ..out
    };
    pass.axes[Axis::Z.index()] = AxisLaw {
        start: Position::from_mm(5.0),
        lead_mm: pass.lead_mm,
        run_in_c0_deg: start + 180.0,
        run_in_dc_deg: 360.0,
        run_in_lambda: 0.5,
        brake_c_deg: end,
        brake_dc_deg: 180.0,
        brake_lambda: 0.5,
        ..out
    };
}

impl Ideal {
    /// A spindle that turns at the programmed speed from an odd angle.
    pub(crate) fn new() -> Ideal {
        let mut truth = Truth::default();
        truth.measurement.panel.spindle_override_pct = 100.0;
        Ideal {
            machine: Machine::plain(),
            ratio: 1.0,
            spindle_deg: -1234.5,
            truth,
            status: MachineStatus::default(),
            tool: 0,
            part: None,
            zero: None,
            gauge: None,
        }
    }

    /// Cuts the passes and hands every record to the observer and to `watch`.
    pub(crate) fn run(
        &mut self,
        passes: &[(ThreadPass, Injected)],
        mut watch: impl FnMut(&Observer, &Record),
    ) -> Observation {
        let item = |(index, (pass, _)): (usize, &(ThreadPass, Injected))| Item {
            line: 10 + index as u32,
            code: Code::Pass(*pass),
        };
        let tool = Item { line: 1, code: Code::Tool { number: self.tool } };
        let items: Vec<Item> = std::iter::once(tool).chain(passes.iter().enumerate().map(item)).collect();
        let mut observer = Observer::new(&self.machine, &items);
        if let Some((part, origin)) = &self.part {
            observer = observer.of_part(part, &passes.iter().map(|(pass, _)| (pass.pass, *origin)).collect());
        }
        if let Some(zero) = self.zero {
            observer = observer.lying_at(&passes.iter().map(|(pass, _)| (pass.pass, zero)).collect());
        }
        if let Some(asked) = &self.gauge {
            observer = observer.with_gauge(asked.clone());
        }
        for (pass, injected) in passes {
            self.cut(pass, injected, &mut |record| {
                observer.cycle(record);
                watch(&observer, record);
            });
        }
        self.status.state = MachineState::Ended as u32;
        let rest = self.resting();
        self.status.cycle = self.truth.cycle;
        observer.cycle(&Record { truth: &self.truth, axes: &rest, machine: &self.status });
        observer.finish()
    }

    fn resting(&self) -> Vec<(Axis, AxisStatus)> {
        let status = AxisStatus { state: AxisState::Streaming as u32, ..AxisStatus::default() };
        self.machine.axes().map(|(axis, _)| (axis, status)).collect()
    }

    fn cut(&mut self, pass: &ThreadPass, injected: &Injected, take: &mut impl FnMut(&Record)) {
        let step = 6.0 * pass.s_rpm * self.ratio * self.machine.general.cycle_s * pass.direction;
        let not_before = self.truth.cycle.0 + 20;
        let mut index_deg = None;
        loop {
            let turn = (self.spindle_deg * pass.direction / 360.0).floor();
            self.spindle_deg += step;
            if (self.spindle_deg * pass.direction / 360.0).floor() > turn {
                self.truth.measurement.index_number += 1;
                self.truth.measurement.index_cycle = self.truth.cycle;
                if self.truth.cycle.0 >= not_before && index_deg.is_none() {
                    index_deg = Some(360.0 * (turn + 1.0) * pass.direction);
                }
            }
            self.truth.spindle_deg = self.spindle_deg;
            self.truth.spindle_rpm = pass.s_rpm * self.ratio * pass.direction;
            if self.machine.is_tick(self.truth.cycle) {
                self.status.cycle = self.truth.cycle;
                self.status.state = MachineState::Threading as u32;
            }
            let c = index_deg.map(|index| pass.direction * (self.spindle_deg - index));
            let mut axes = self.resting();
            for (axis, status) in &mut axes {
                *status = self.axis(pass, injected, *axis, c);
            }
            self.truth.measurement.cycle = self.truth.cycle;
            take(&Record { truth: &self.truth, axes: &axes, machine: &self.status });
            self.truth.cycle = self.truth.cycle.after(1);
            if c.is_some_and(|c| {
                c > pass.done_deg() + 20.0 || injected.broken_off_deg.is_some_and(|at| c > at)
            }) {
                return;
            }
        }
    }

    /// Status of an axis at angle `c`, and its truth.
    fn axis(&mut self, pass: &ThreadPass, injected: &Injected, axis: Axis, c: Option<f64>) -> AxisStatus {
        let law = pass.axis(axis);
        let state = state(law, c);
        let c = c.unwrap_or(0.0);
        let sample = pass.law(axis).at(c).driven([self.ratio, 0.0, 0.0, 0.0]);
        let commanded_mm = law.start.mm() + sample.s;
        let servo_um = injected.servo_um.map_or(0.0, |servo| servo(axis, state, c));
        let truth = &mut self.truth.axes[axis.index()];
        truth.motor_mm = commanded_mm;
        if axis == Axis::Z {
            let middle = 0.5 * (law.locked_deg() + pass.thread_end_deg);
            let grown = injected.lead_error_um_per_rev * (c - middle) / 360.0;
            truth.motor_mm += 1e-3 * (injected.phase_um + grown);
        }
        let slide_um = injected.slide_um + injected.slide_at_um.map_or(0.0, |at| at(axis, c));
        truth.slide_mm = truth.motor_mm + 1e-3 * slide_um;
        self.truth.measurement.axes[axis.index()].position = Position::from_mm(truth.motor_mm);
        AxisStatus {
            cycle: Cycle(self.truth.cycle.0),
            state: state as u32,
            pass: pass.pass,
            line: 9 + pass.pass,
            commanded_mm,
            velocity_mm_s: sample.v,
            acceleration_mm_s2: sample.a,
            jerk_mm_s3: sample.j,
            servo_error_mm: 1e-3 * servo_um,
            angle_deg: c,
            ..AxisStatus::default()
        }
    }
}

fn state(law: &AxisLaw, c: Option<f64>) -> AxisState {
    match c {
        None => AxisState::Armed,
        Some(c) if c < law.begins_deg() => AxisState::WaitingForC0,
        Some(c) if c < law.locked_deg() => AxisState::RunIn,
        Some(c) if c < law.leaves_deg() => AxisState::Locked,
        Some(c) if c < law.done_deg() => AxisState::RunOut,
        Some(_) => AxisState::Streaming,
    }
}
