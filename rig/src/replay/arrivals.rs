//! What reached the modules of a run otherwise than in lock step, as a run folder keeps it: one line for each
//! change. In: arrivals as they are told, records as they are observed. Out: text, and back; or why a run
//! cannot be made again by it.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use protocol::{
    Arrival, AxisStatus, Differs, Input, MachineStatus, Module, OperatorRequest, PerAxis, Request, Taken,
};

use super::sealed::{sealed, unsealed};
use crate::observe::Record;

/// First line, with the version.
const TITLE: &str = "pitchlock arrivals 1";
/// Lines before the first change in a file that grows.
const HEAD_LINES: usize = 5;
/// The version of all crates.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Most changes that are kept: one in every cycle of a quarter of an hour.
pub const MOST: usize = 1 << 20;
/// Most bytes of the text of so many.
pub const MOST_BYTES: u64 = 64 << 20;

/// A line behind every so many changes says what stands before it, so that damage is found where it is.
const CHECKED: usize = 64;
/// How such a line begins, and the last one.
const WHOLE: &str = "whole";
/// See there.
const END: &str = "end";

/// From a cycle on something else is taken for an input.
pub type Change = (u64, Input, Taken);

/// The arrivals of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrivals {
    /// The machine ran in one process: it obeys the scenario by itself, and these are what came from outside.
    pub one_process: bool,
    /// The first cycle that was not recorded any more.
    pub until: u64,
    /// It ran in real time, and its seed, of a record that was not finished.
    pub real_time: bool,
    /// See there.
    pub seed: Option<u64>,
    /// The version of pitchlock that made it, if it says so.
    pub by: Option<String>,
    /// Of a record that was not finished: what came behind the last change is damaged, and not known.
    pub damaged: bool,
    /// The record says that it ends here.
    pub ended: bool,
    /// Why the run cannot be made again.
    pub gap: Option<String>,
    /// In the order in which they were told: those of one input are in the order of their cycles.
    pub changes: Vec<Change>,
}

impl Arrivals {
    /// Takes a change.
    pub fn note(&mut self, cycle: u64, input: Input, taken: Taken) {
        if self.changes.len() < MOST {
            self.changes.push((cycle, input, taken));
        } else {
            self.miss(format!("more than {MOST} messages did not come when they were due"));
        }
    }

    /// Something was not recorded; the first reason counts.
    pub fn miss(&mut self, why: String) {
        self.gap.get_or_insert(why);
    }

    /// The text of a file.
    pub fn text(&self) -> String {
        let machine = if self.one_process { "one-process" } else { "processes" };
        let mut text = format!("{TITLE}\nby {VERSION} {VERSION}\nmachine {machine}\nuntil {}\n", self.until);
        if let Some(gap) = &self.gap {
            let _ = writeln!(text, "incomplete {gap}");
            return text;
        }
        let (mut hash, mut hashed) = (blake3::Hasher::new(), 0);
        let mut check = |text: &mut String, word: &str, changes: usize| {
            hash.update(&text.as_bytes()[hashed..]);
            hashed = text.len();
            let _ = writeln!(text, "{word} {}", checked(changes, &hash));
        };
        for (number, change) in (1..).zip(&self.changes) {
            text += &line(change);
            if number % CHECKED == 0 {
                check(&mut text, WHOLE, number);
            }
        }
        check(&mut text, END, self.changes.len());
        text
    }

    /// What such a file begins with while the machine runs; the lines of its changes follow. Every line is
    /// there twice, with its number and a hash.
    pub fn head(one_process: bool, real_time: bool, seed: u64) -> String {
        let machine = if one_process { "one-process" } else { "processes" };
        let clock = if real_time { "real" } else { "virtual" };
        Arrivals::live(
            0,
            &format!("{TITLE}\nby {VERSION} {VERSION}\nmachine {machine}\nclock {clock}\nseed {seed}\n"),
        )
    }

    /// Lines of a file that grows, from the one with this number on.
    pub fn live(first: usize, lines: &str) -> String {
        sealed(first, lines)
    }

    /// The other version of pitchlock that made it: the machine that it simulates may move otherwise.
    pub fn by_other(&self) -> Option<&str> {
        self.by.as_deref().filter(|by| *by != VERSION)
    }

    /// What is left of such a file: everything before the first line that is damaged.
    pub fn left(bytes: &[u8]) -> Arrivals {
        let (lines, damaged) = unsealed(bytes);
        let mut arrivals = Arrivals { damaged: damaged || lines.len() < HEAD_LINES, ..Arrivals::default() };
        for line in lines.iter().skip(1) {
            // A whole line of another version.
            arrivals.damaged |= arrivals.line(line).is_none();
        }
        arrivals
    }

    /// The same lines of the changes from one on.
    pub fn lines_from(&self, first: usize) -> String {
        let lines: String = self.changes.iter().skip(first).map(line).collect();
        Arrivals::live(HEAD_LINES + first, &lines)
    }

    /// The arrivals of a text.
    ///
    /// # Errors
    /// Names the line that is not one of them.
    pub fn from_text(text: &str) -> Result<Arrivals, String> {
        let mut arrivals = Arrivals::default();
        let mut lines = (1..).zip(text.lines());
        if lines.next().is_none_or(|(_, line)| line != TITLE) {
            return Err(format!("line 1: {TITLE} is expected: another version of pitchlock made it"));
        }
        let mut hash = blake3::Hasher::new();
        hash.update(TITLE.as_bytes()).update(b"\n");
        // So far it is whole: this line, and the cycle of the change before it.
        let (mut whole, mut cycle) = (1, 0);
        for (number, line) in lines {
            let words = line.split_once(' ').filter(|(first, _)| [WHOLE, END].contains(first));
            if let Some((first, told)) = words {
                if told != checked(arrivals.changes.len(), &hash) {
                    return Err(format!(
                        "line {number}: the lines behind line {whole}, from control cycle {cycle} on, are not those that were \
                         written: the record is damaged there"
                    ));
                }
                (whole, cycle) = (number, arrivals.changes.last().map_or(0, |change| change.0));
                arrivals.ended = first == END;
            } else {
                arrivals.line(line).ok_or_else(|| format!("line {number}: {line:?} is not understood"))?;
                arrivals.ended = false;
            }
            hash.update(line.as_bytes()).update(b"\n");
        }
        Ok(arrivals)
    }

    fn line(&mut self, line: &str) -> Option<()> {
        let (first, rest) = line.split_once(' ')?;
        match (first, rest) {
            ("machine", "one-process") => self.one_process = true,
            ("machine", "processes") => self.one_process = false,
            // Twice: a bit that turns over makes no other version of it.
            ("by", versions) => {
                let twice = versions.split_once(' ').filter(|(one, other)| one == other);
                self.by = twice.map(|(version, _)| version.into());
            }
            ("clock", clock) => self.real_time = clock == "real",
            ("seed", seed) => self.seed = Some(seed.parse().ok()?),
            ("until", cycle) => self.until = cycle.parse().ok()?,
            ("incomplete", why) => self.miss(why.into()),
            _ => {
                let (input, taken) = rest.split_once(' ')?;
                let taken = match taken {
                    "due" => Taken::Due,
                    "nothing" => Taken::Nothing,
                    which => Taken::This(which.parse().ok()?),
                };
                self.changes.push((first.parse().ok()?, Input::from_name(input)?, taken));
            }
        }
        Some(())
    }
}

/// So many changes, and the hash of all before, in words.
fn checked(changes: usize, before: &blake3::Hasher) -> String {
    format!("{changes} {}", &before.finalize().to_hex()[..16])
}

/// A change as a line.
fn line((cycle, input, taken): &Change) -> String {
    let taken = match taken {
        Taken::Due => "due".into(),
        Taken::Nothing => "nothing".into(),
        Taken::This(which) => which.to_string(),
    };
    format!("{cycle} {} {taken}\n", input.name())
}

/// Collects the arrivals of a run in the launcher: what modules tell, and what the recorder sees.
#[derive(Clone, Debug, Default)]
pub struct Collector {
    arrivals: Arrivals,
    /// How many each module has told; `None` is the plant.
    told: BTreeMap<Option<Module>, u64>,
    next: u64,
    ticks: u64,
    axes: PerAxis<Differs>,
    machine: Differs,
}

impl Collector {
    /// For a machine whose interpolator ticks every so many control cycles.
    pub fn new(one_process: bool, ticks: u64) -> Collector {
        let arrivals = Arrivals { one_process, ..Arrivals::default() };
        Collector { arrivals, ticks, ..Collector::default() }
    }

    /// What a module tells.
    pub fn take(&mut self, arrival: &Arrival) {
        let Some((input, taken)) = arrival.unpack() else {
            return self.arrivals.miss("a module told something that is not understood".into());
        };
        let who = teller(input, arrival.cycle);
        let told = self.told.entry(who).or_default();
        let lost = arrival.number.saturating_sub(*told);
        *told = arrival.number.saturating_add(1);
        if lost > 0 {
            let who = who.map_or_else(|| "sim-plant".into(), Module::name);
            let text = format!("{lost} of what {who} told of its inputs did not reach the recorder");
            self.arrivals.miss(text);
        }
        if input != Input::Total {
            self.arrivals.note(arrival.cycle, input, taken);
        }
    }

    /// What is asked for at the panel in a cycle, by whoever runs the machine in one process.
    pub fn asked(&mut self, cycle: u64, request: Option<Request>) {
        let Some(request) = request else { return };
        let OperatorRequest { kind, value, .. } = OperatorRequest::pack(0, request);
        self.arrivals.note(cycle, Input::OperatorValue, Taken::This(value.to_bits()));
        self.arrivals.note(cycle, Input::Operator, Taken::This(kind.into()));
    }

    /// The same kills a module behind a cycle.
    pub fn killed(&mut self, cycle: u64, module: Module) {
        self.arrivals.note(cycle, Input::Killed, Taken::This(module.code().into()));
    }

    /// What the recorder sees.
    pub fn cycle(&mut self, record: &Record) {
        let Record { truth, axes, machine } = record;
        let now = truth.cycle.0;
        self.arrivals.until = now + 1;
        if self.arrivals.one_process {
            return;
        }
        if now > self.next {
            self.arrivals.note(self.next, Input::Truth, Taken::Nothing);
            self.arrivals.note(now, Input::Truth, Taken::Due);
        }
        self.next = now + 1;
        for (axis, status) in *axes {
            let seen = (*status != AxisStatus::default()).then_some(status.cycle.0);
            if let Some(taken) = self.axes[axis.index()].note(seen, Some(now)) {
                self.arrivals.note(now, Input::SeenAxis(*axis), taken);
            }
        }
        let seen = (**machine != MachineStatus::default()).then_some(machine.cycle.0);
        if let Some(taken) = self.machine.note(seen, Some(now - now % self.ticks)) {
            self.arrivals.note(now, Input::SeenMachine, taken);
        }
    }

    /// What has been collected.
    pub fn so_far(&self) -> &Arrivals {
        &self.arrivals
    }

    /// All of it.
    pub fn finish(self) -> Arrivals {
        self.arrivals
    }
}

/// Who tells of an input; `None` is the plant.
fn teller(input: Input, cycle: u64) -> Option<Module> {
    match input {
        Input::Total => Module::from_code(u32::try_from(cycle).unwrap_or(0)),
        Input::Code | Input::Lost | Input::TickMeasurement | Input::Status(_) => Some(Module::Interpolator),
        Input::Measurement(axis) | Input::Frame(axis) => Some(Module::Regulator(axis)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use protocol::Axis;

    use super::*;

    #[test]
    fn arrivals_are_read_as_they_were_written() {
        let mut arrivals = Arrivals { until: 4711, ..Arrivals::default() };
        arrivals.note(7, Input::Drive(Axis::Z), Taken::This(6));
        arrivals.note(8, Input::Drive(Axis::Z), Taken::Due);
        arrivals.note(9, Input::TickMeasurement, Taken::Nothing);
        let by = Some(VERSION.into());
        let whole = Arrivals { by, ended: true, ..arrivals.clone() };
        assert_eq!(Arrivals::from_text(&arrivals.text()), Ok(whole));
        // One that was being written, and is torn in its last line.
        let being_written = Arrivals::head(false, false, 7) + &arrivals.lines_from(0);
        let torn = |text: &str| Arrivals::left(text.as_bytes());
        let left = torn(&(being_written.clone() + "0a1b2c3d 8 10 tick-mea"));
        assert_eq!((left.seed, &left.changes, left.damaged), (Some(7), &arrivals.changes, true));
        assert!(!torn(&being_written).damaged && torn("").damaged);
        let left = torn(&being_written.replace("8 drive", "8 drove"));
        assert_eq!((left.changes.len(), left.damaged), (1, true));
        arrivals.miss("a word was lost".into());
        let read = Arrivals::from_text(&arrivals.text()).expect("it is one of ours");
        assert_eq!((read.gap, read.changes.len()), (arrivals.gap, 0));
        let wrong = format!("{TITLE}\nuntil 3\n1 drive-command/q due\n");
        let refused = Arrivals::from_text(&wrong).expect_err("there is no axis q");
        assert!(refused.starts_with("line 3"), "{refused}");
    }
}
