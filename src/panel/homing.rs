//! The reference run that is in hand. In: what every control cycle shows, and which axis is asked for. Out:
//! which axis it is of, how far it has come, and what is left of its way, mm.

use machine::{AxisConfig, Machine, Method};
use protocol::{Axis, AxisStatus, ByHand, Code, Item, MachineState, PerAxis};
use rig::observe::Record;

use super::plan;

/// What is in hand of work by hand.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InHand {
    /// Where it leads the axes, mm; a jog leads nowhere, it goes on as long as its key is pressed.
    target: Option<PerAxis<f64>>,
    /// The axis of which it is the reference run.
    references: Option<Axis>,
}

impl InHand {
    /// What was given.
    pub(super) fn of(items: &[Item]) -> InHand {
        let mut at = PerAxis::default();
        let (mut jogs, mut references) = (false, None);
        for item in items {
            at = plan::end(item, &at);
            match item.code {
                Code::ByHand(ByHand::Begins { jogs: is_jog, .. }) => jogs |= is_jog,
                Code::ByHand(ByHand::References(axis)) => references = Some(axis),
                _ => {}
            }
        }
        InHand { target: (!jogs && references.is_none()).then(|| at.map(protocol::Position::mm)), references }
    }
}

/// Who asks for reference runs.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asked {
    /// A program, which begins with all of them.
    Program,
    /// Somebody at the machine, of this axis.
    ByHand(Option<Axis>),
}

/// An axis goes if it is faster: one that comes to rest may be commanded a billionth of a millimetre past its
/// place and back. No way of a run is as slow.
const GOES: f64 = 5e-4;

/// How far a reference run has come.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Search,
    BackOff,
    Latch,
    Home,
}

/// An axis that has a reference run.
#[derive(Clone, Copy, Debug)]
struct Run {
    axis: Axis,
    method: Method,
    /// Direction of its search.
    way: f64,
    home_mm: f64,
}

/// Follows the reference runs of a machine, in their order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Homing {
    runs: Vec<Run>,
    now: Option<(Run, Phase)>,
    /// What is given by hand.
    in_hand: Option<InHand>,
}

impl Homing {
    /// Of a machine.
    pub(super) fn of(machine: &Machine) -> Homing {
        let runs = machine.reference_runs().into_iter().map(|(axis, reference)| Run {
            axis,
            method: reference.method,
            way: reference.way(),
            home_mm: machine.axis.get(&axis).map_or(0.0, |config: &AxisConfig| config.home_mm),
        });
        Homing { runs: runs.collect(), ..Homing::default() }
    }

    /// One control cycle of work by hand.
    pub(super) fn by_hand(&mut self, record: &Record, in_hand: InHand) {
        self.in_hand = Some(in_hand);
        self.cycle(record, Asked::ByHand(in_hand.references));
    }

    /// One control cycle.
    pub(super) fn cycle(&mut self, record: &Record, asked: Asked) {
        let Record { truth, axes, machine } = record;
        if matches!(machine.state(), MachineState::Starting | MachineState::Ended | MachineState::Fault) {
            self.now = None;
            return;
        }
        let of = |own: Axis| axes.iter().find(|(axis, _)| *axis == own).map(|(_, status)| *status);
        self.now = self.now.filter(|(run, phase)| *phase != Phase::Home || !run.is_home(of(run.axis)));
        let is_wanted = |run: &&Run| {
            let asked = match asked {
                Asked::Program => true,
                Asked::ByHand(axis) => axis == Some(run.axis),
            };
            asked && machine.is_unreferenced(run.axis)
        };
        self.now = match self.now {
            None => self.runs.iter().find(is_wanted).map(|run| {
                let on = truth.measurement.axes[run.axis.index()].is_switched();
                (*run, run.begins(on))
            }),
            Some((run, _)) if !machine.is_unreferenced(run.axis) => Some((run, Phase::Home)),
            // Its ways are told apart by their directions.
            Some((run, phase)) => {
                let speed = of(run.axis).map_or(0.0, |status| status.velocity_mm_s * run.way);
                let next = match phase {
                    Phase::Search if speed < -GOES => Phase::BackOff,
                    Phase::BackOff if speed > GOES => Phase::Latch,
                    phase => phase,
                };
                Some((run, next))
            }
        };
    }

    /// Whether there is one.
    pub(super) fn goes(&self) -> bool {
        self.now.is_some()
    }

    /// The axis that is referenced now, for people.
    pub(super) fn axis(&self) -> Option<String> {
        self.now.map(|(run, _)| run.name())
    }

    /// What it does, for people.
    pub(super) fn words(&self) -> Option<String> {
        let (run, phase) = self.now?;
        let does = match (phase, run.method) {
            (Phase::Search, _) => "fast to its switch",
            (Phase::BackOff, _) => "off its switch",
            (Phase::Latch, Method::Switch) => "slowly back to its switch",
            (Phase::Latch, Method::SwitchAndIndex) => "slowly to the index behind its switch",
            (Phase::Latch, Method::Index) => "slowly to the next index",
            (Phase::Home, _) => "its position is known, and it goes home",
        };
        Some(format!("reference run of {}: {does}", run.name()))
    }

    /// What is left to where each axis is led, mm, where that is known; `planned` is where the program leads
    /// them.
    pub(super) fn to_go_mm(&self, axis: Axis, at_mm: f64, planned: Option<&PerAxis<f64>>) -> Option<f64> {
        let target = match (self.now, self.in_hand) {
            (Some((run, Phase::Home)), _) => (run.axis == axis).then_some(run.home_mm),
            (Some(_), _) => None,
            (None, Some(in_hand)) => in_hand.target.map(|target| target[axis.index()]),
            (None, None) => planned.map(|target| target[axis.index()]),
        };
        target.map(|target| target - at_mm)
    }

    /// Whether somebody gives blocks by hand, so that nobody knows how many there will be.
    pub(super) fn is_by_hand(&self) -> bool {
        self.in_hand.is_some()
    }
}

impl Run {
    fn name(&self) -> String {
        self.axis.name().to_ascii_uppercase()
    }

    fn begins(&self, on_switch: bool) -> Phase {
        match self.method {
            Method::Index => Phase::Latch,
            _ if on_switch => Phase::BackOff,
            _ => Phase::Search,
        }
    }

    /// Whether the axis stands at its home.
    fn is_home(&self, status: Option<AxisStatus>) -> bool {
        // Closer than a count of any drive.
        const THERE_MM: f64 = 1e-6;
        status.is_none_or(|status| {
            status.velocity_mm_s == 0.0 && (status.commanded_mm - self.home_mm).abs() < THERE_MM
        })
    }
}

#[cfg(test)]
mod tests {
    use machine::ReferenceConfig;
    use protocol::{MachineStatus, Truth};

    use super::*;

    fn machine(method: Method) -> Machine {
        let mut machine = Machine::plain();
        let x = machine.axis.get_mut(&Axis::X).expect("a lathe");
        x.reference = Some(ReferenceConfig {
            method,
            position_mm: 75.0,
            search_mm_s: -40.0,
            latch_mm_s: 2.0,
            sequence: 0,
        });
        x.home_mm = 60.0;
        machine
    }

    /// What is said in a cycle in which X goes so fast, from there, and is referenced or not; and what X and
    /// Z have to go.
    fn said(
        homing: &mut Homing,
        asked: Asked,
        [at_mm, speed]: [f64; 2],
        lost: bool,
    ) -> (String, [Option<f64>; 2]) {
        let truth = Truth::default();
        let x = AxisStatus { commanded_mm: at_mm, velocity_mm_s: speed, ..AxisStatus::default() };
        let status = MachineStatus {
            state: MachineState::Moving as u32,
            unreferenced: u8::from(lost) << Axis::X.index(),
            ..MachineStatus::default()
        };
        let axes = [(Axis::X, x), (Axis::Z, AxisStatus::default())];
        let record = Record { truth: &truth, axes: &axes, machine: &status };
        match asked {
            Asked::ByHand(_) => homing.by_hand(&record, InHand { references: Some(Axis::X), target: None }),
            Asked::Program => homing.cycle(&record, asked),
        }
        let planned = PerAxis::default();
        let left =
            [(Axis::X, at_mm), (Axis::Z, 0.0)].map(|(axis, at)| homing.to_go_mm(axis, at, Some(&planned)));
        (homing.words().unwrap_or_default(), left)
    }

    #[test]
    fn a_reference_run_is_told_with_its_axis_and_its_phase_and_only_the_way_home_has_a_known_length() {
        for asked in [Asked::Program, Asked::ByHand(Some(Axis::X))] {
            let mut homing = Homing::of(&machine(Method::SwitchAndIndex));
            let unknown = [None, None];
            for (place, lost, words, left) in [
                ([101.0, 0.0], true, "reference run of X: fast to its switch", unknown),
                ([90.0, -40.0], true, "reference run of X: fast to its switch", unknown),
                // It is held there, and goes on.
                ([89.0, 9e-7], true, "reference run of X: fast to its switch", unknown),
                ([89.0, -4e-6], true, "reference run of X: fast to its switch", unknown),
                ([89.0, 0.0], true, "reference run of X: fast to its switch", unknown),
                ([88.0, -40.0], true, "reference run of X: fast to its switch", unknown),
                ([75.0, 0.0], true, "reference run of X: fast to its switch", unknown),
                ([75.5, 20.0], true, "reference run of X: off its switch", unknown),
                ([76.5, -9e-7], true, "reference run of X: off its switch", unknown),
                ([76.5, 3e-6], true, "reference run of X: off its switch", unknown),
                ([76.5, 0.0], true, "reference run of X: off its switch", unknown),
                ([75.5, -2.0], true, "reference run of X: slowly to the index behind its switch", unknown),
                (
                    [71.5, 0.0],
                    false,
                    "reference run of X: its position is known, and it goes home",
                    [Some(-11.5), None],
                ),
                (
                    [63.0, -90.0],
                    false,
                    "reference run of X: its position is known, and it goes home",
                    [Some(-3.0), None],
                ),
            ] {
                let told = said(&mut homing, asked, place, lost);
                assert_eq!(told, (words.to_owned(), left), "{asked:?} at {place:?}");
            }
            let (words, _) = said(&mut homing, asked, [60.0, 0.0], false);
            assert_eq!((words.as_str(), homing.goes()), ("", false), "{asked:?}: it is home");
        }
    }

    #[test]
    fn a_run_by_the_index_alone_begins_with_its_last_way_and_one_that_nobody_asks_for_does_not_begin() {
        let mut homing = Homing::of(&machine(Method::Index));
        let (words, left) = said(&mut homing, Asked::Program, [60.0, 0.0], true);
        assert_eq!((words.as_str(), left[0]), ("reference run of X: slowly to the next index", None));
        let mut homing = Homing::of(&machine(Method::Switch));
        let truth = Truth::default();
        let status = MachineStatus {
            state: MachineState::Moving as u32,
            unreferenced: 1 << Axis::X.index(),
            ..MachineStatus::default()
        };
        let axes = [(Axis::X, AxisStatus { velocity_mm_s: -5.0, ..AxisStatus::default() })];
        homing.cycle(&Record { truth: &truth, axes: &axes, machine: &status }, Asked::ByHand(None));
        assert!(!homing.goes(), "it is a jog");
    }
}
