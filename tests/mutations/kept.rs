//! What a run keeps of itself, and what is measured for the next one.

use machine::Machine;
use rig::journal::{Book, Medium, State};
use rig::trace::{Format, Row, TraceWriter};
use zerocopy::IntoBytes as _;

use crate::{corpus::ARRIVALS, mutate, mutate_within, targets};

/// A medium that keeps what is written in memory.
#[derive(Default)]
struct Memory(Vec<u8>);

impl Medium for Memory {
    fn append(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.0.extend_from_slice(bytes);
        Ok(())
    }

    fn replace(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.0 = bytes.to_vec();
        Ok(())
    }

    fn sync(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The summary of a short run.
pub(super) fn summaries() -> Vec<Vec<u8>> {
    let machine = Machine::plain();
    let program = "G18 G21 G90 G94 G8\nG0 X50 Z90\nG1 X50.1 F3000\nM2\n";
    let items = interpreter::check("short.ngc", program, &machine).items;
    let mut rig =
        rig::Rig::new(&machine, items.iter().copied(), sim_plant::Scenario::none(), 1).expect("a plant");
    let mut observer = rig::observe::Observer::new(&machine, &items);
    while rig.cycle(None, |record| observer.cycle(record)) {}
    let summary = observer.finish().summary("short.ngc", "virtual");
    vec![serde_json::to_vec(&summary).expect("it can be written")]
}

#[test]
fn summary() {
    mutate(targets::summary, &summaries());
}

/// How a run folder says that its program is read.
#[test]
fn language() {
    let texts = [
        "dialect = \"fanuc\"\nblock_delete = [1, 2]\nstrict = true\nsubroutines = []\nfrom = 28\n",
        "dialect = \"linuxcnc\"\nblock_delete = true\ntools = \"tools.tbl\"\nparameters = \"a.var\"\nini = \"b.ini\"\n",
    ];
    mutate(targets::language, &texts.map(|text| text.as_bytes().to_vec()));
}

#[test]
fn arrivals() {
    mutate(targets::arrivals, &[ARRIVALS.as_bytes().to_vec()]);
}

/// Whatever line is lost, changed or put elsewhere: where the record breaks is named.
#[test]
fn where_a_record_is_damaged_is_named() {
    let mut arrivals = rig::replay::Arrivals { until: 5000, ..Default::default() };
    for cycle in 0..300 {
        arrivals.note(10 * cycle, protocol::Input::Drive(protocol::Axis::X), protocol::Taken::This(cycle));
    }
    let text = arrivals.text();
    let lines: Vec<&str> = text.lines().collect();
    for at in 4..lines.len() {
        let mut damaged = lines.clone();
        let lost = damaged.remove(at);
        let read = rig::replay::Arrivals::from_text(&(damaged.join("\n") + "\n"));
        if at == lines.len() - 1 {
            assert!(!read.expect("the rest is whole").ended);
            continue;
        }
        let told = read.expect_err(lost);
        // The block in which it lies, by the check before it.
        let before = (0..at).rev().find(|line| lines[*line].starts_with("whole")).unwrap_or(0);
        let cycle = lines[before].split(' ').nth(1).and_then(|n| n.parse::<u64>().ok());
        let cycle = cycle.filter(|_| before > 0).map_or(0, |changes| 10 * (changes - 1));
        let words = format!("behind line {}, from control cycle {cycle} on", before + 1);
        assert!(told.contains(&words), "{lost}: {told}, {words}");
    }
}

/// A record that is whole and then is not: no line is taken for another one.
#[test]
fn arrivals_live() {
    let whole = rig::replay::Arrivals::from_text(ARRIVALS).expect("it is one");
    let text = rig::replay::Arrivals::head(false, false, 7) + &whole.lines_from(0);
    mutate(targets::arrivals_live, &[text.into_bytes()]);
}

/// A journal of some states, and what they say.
#[test]
fn journal() {
    let state = State { passes: 1, step: 7, line: 6, cycle: 4711, ..State::nothing() };
    let ended = State { machine: protocol::MachineState::Ended as u32, ..state };
    let mut book = Book::new(Memory::default());
    let mut corpus: Vec<_> = [State::nothing(), state, ended].map(|state| state.as_bytes().to_vec()).into();
    [State::nothing(), state, ended].iter().for_each(|state| {
        book.write(state).expect("there is room");
    });
    corpus.push(book.medium().0.clone());
    mutate(targets::journal, &corpus);
}

/// What a trace may take beside its bytes: records and blocks, packed and unpacked.
const TRACE_MEMORY: u64 = 16 << 20;

/// Traces of a few cycles in both forms.
#[test]
fn trace() {
    let machine = Machine::plain();
    let items = interpreter::check("short.ngc", "G18 G21 G90 G94 G8\nG0 X50 Z90\nM2\n", &machine).items;
    let place = tempfile::tempdir().expect("a folder");
    let axes = [protocol::Axis::X, protocol::Axis::Z];
    let forms = [Format::Mcap, Format::Csv];
    let paths = forms.map(|form| place.path().join(form.file_name()));
    let mut writers: Vec<_> = std::iter::zip(&paths, forms)
        .map(|(path, form)| TraceWriter::create(path, form, &axes).expect("it can be written"))
        .collect();
    let mut rig =
        rig::Rig::new(&machine, items.iter().copied(), sim_plant::Scenario::none(), 1).expect("a plant");
    let mut observer = rig::observe::Observer::new(&machine, &items);
    for _ in 0..8 {
        rig.cycle(None, |record| {
            observer.cycle(record);
            let row = Row::of(record, &observer, machine.general.cycle_s);
            writers.iter_mut().for_each(|writer| writer.row(&row).expect("there is room"));
        });
    }
    writers.into_iter().for_each(|writer| {
        writer.finish().expect("there is room");
    });
    let corpus = paths.map(|path| std::fs::read(path).expect("it was written"));
    mutate_within(TRACE_MEMORY, targets::trace, &corpus);
}

#[test]
fn touches() {
    let texts = [
        "# angle Z X\n12.0 -3.1021 9.1\n190.5 -12.098 9.1\n81.0 -19.488 9.1\n7 -25.0\n",
        "1,2\n2,3\n9 -20.5\n",
    ];
    mutate(targets::touches, &texts.map(|text| text.as_bytes().to_vec()));
}

/// What is said at the gate of a machine.
#[test]
fn door() {
    mutate(targets::door, &targets::dialogue());
}
