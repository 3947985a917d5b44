//! What must hold for any bytes: no panic, an end, an answer that names a place.
//!
//! One function for each part that reads what others wrote. libFuzzer drives them from `fuzz_targets/`, with
//! coverage; `tests/mutations` drives the same ones with mutations of programs that are known, on a stable
//! compiler.

use std::{io, path::Path, sync::Arc};

use gauge::pickup::{self, Asked, pick_up};
use gcode::canon::{LinuxcncPrinter, PlainPrinter, Units};
use gcode::files::{MachineFile, ParameterFile, Tool, ToolTable};
use gcode::{
    Call, DecimalPoint, Diagnostic, Dialect, Job, Limits, MachineCode, Options, Place, Pose, Problem,
    Program, Sink, Step, alone,
};
use interpreter::Interpreter;
use machine::{Machine, Part, SMALL_MILL};
use metrology::Thread;
use protocol::CodePacket;
use protocol::code_file::{CodeFile, VERSION};
use rig::journal::{State, has_other_version, latest};
use rig::observe::Summary;
use rig::replay::Arrivals;
use rig::resume;
use shape::{Formula, Gradient, Number, Series};
use sim_plant::{Plant, Scenario};
use zerocopy::FromBytes as _;

/// Small, so that every loop ends soon.
const LIMITS: Limits = Limits {
    blocks_without_motion: 300,
    moves_of_block: 100_000,
    call_depth: 10,
    expression_depth: 16,
    line_length: 512,
    subroutine_bytes: 1 << 16,
};
/// Calls that a program may make; what it sends then is refused.
const CALLS: u32 = 600;
/// Diagnostics that are rendered.
const RENDERED: u32 = 3;

/// Every line of the bytes as a line of each dialect.
pub fn lexer(bytes: &[u8]) {
    for dialect in Dialect::ALL {
        let options = options(dialect);
        for line in bytes.split(|byte| *byte == b'\n').take(64) {
            match alone::line(line, &options) {
                Ok(read) => assert!(read.words.iter().all(|(_, value)| value.is_finite()), "{read}"),
                Err(problem) => check_problem(&problem),
            }
        }
    }
}

/// The bytes as a value of each dialect: finite, or a reason.
pub fn expression(bytes: &[u8]) {
    for dialect in Dialect::ALL {
        match alone::value(bytes, &options(dialect)) {
            Ok(value) => assert!(value.is_none_or(f64::is_finite), "{value:?}"),
            Err(problem) => check_problem(&problem),
        }
    }
}

/// The bytes as the text of a formula: one that machine code carries and that has a value, or a reason and
/// its place.
pub fn formula(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match interpreter::formula::parse(&text, &["x", "y"]) {
        Ok(formula) => {
            let (codes, constants) = formula.encode();
            assert_eq!(Formula::decode(&codes, &constants), Ok(formula));
            let value = formula.eval([0.5; 2]);
            let series = formula.eval(Gradient::variables(Series::variable(0.5), Series::constant(0.5)));
            let same = series.value.value() == value || !value.is_finite();
            assert!(same, "{text}: {value} {series:?}");
        }
        Err(misread) => {
            assert!(text.get(misread.span.clone()).is_some(), "{misread:?}");
            assert!(!misread.message.is_empty() && !misread.help.is_empty(), "{misread:?}");
        }
    }
}

/// The bytes as the name of a thread: one with finite limits whose own name is read as the same, or a reason
/// and its place.
pub fn thread_name(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match text.parse::<Thread>() {
        Ok(thread) => {
            let limits = thread.limits();
            let mut sizes = limits.members().flat_map(|(_, member)| member.sizes_mm());
            assert!(sizes.all(|(_, mm)| mm.is_finite() && mm > 0.0), "{text}: {limits:?}");
            assert_eq!(thread.to_string().parse(), Ok(thread), "{text}");
        }
        Err(misread) => {
            assert!(text.get(misread.span.clone()).is_some(), "{misread:?}");
            assert!(!misread.message.is_empty() && !misread.help.is_empty(), "{misread:?}");
        }
    }
}

/// The bytes as a program of LinuxCNC.
pub fn program_linuxcnc(bytes: &[u8]) {
    program(bytes, Dialect::Linuxcnc);
}

/// The bytes as a FANUC program of a lathe.
pub fn program_fanuc(bytes: &[u8]) {
    program(bytes, Dialect::Fanuc);
}

/// The bytes as a FANUC program of a mill.
pub fn program_fanuc_mill(bytes: &[u8]) {
    program(bytes, Dialect::FanucMill);
}

/// The bytes as a machine-code file, and as the content of one with a right head.
pub fn code_file(bytes: &[u8]) {
    let _ = CodeFile::read(&mut &bytes[..]);
    let content = bytes.get(HEAD..).unwrap_or(bytes);
    if let Ok(file) = CodeFile::read(&mut with_head(content).as_slice()) {
        let mut written = Vec::new();
        file.write(&mut written).expect("what can be read can be written");
        let again = CodeFile::read(&mut written.as_slice()).expect("what was written can be read");
        assert_eq!(format!("{file:?}"), format!("{again:?}"));
    }
}

/// The bytes as a machine file, with its plant: refused with a reason, or a machine that a plant can be built
/// of.
pub fn machine_file(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match Machine::from_toml(&text) {
        Ok(machine) => {
            if let Err(error) = Plant::new(&machine, Scenario::none(), 1) {
                assert!(!error.to_string().is_empty());
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// The bytes as a scenario for the built-in machine.
pub fn scenario(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match Scenario::from_toml(&text) {
        Ok(scenario) => {
            let _ = Plant::new(&Machine::default(), scenario, 1).map_err(|error| error.to_string());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// The bytes as the file beside a program that describes its part.
pub fn part(bytes: &[u8]) {
    let _ = Part::from_toml(&String::from_utf8_lossy(bytes)).map_err(|error| error.to_string());
}

/// The bytes as a tool table, a file of parameters, and a machine description of LinuxCNC: the first of them
/// can be written and read again.
pub fn tables(bytes: &[u8]) {
    let text = gcode::readable(bytes);
    if let Ok(table) = ToolTable::parse("fuzz", &text) {
        let again = ToolTable::parse("fuzz", &table.to_text()).expect("what was written can be read");
        assert_eq!(table.iter().count(), again.iter().count());
    }
    let mut rendered = 0;
    if let Err(diagnostic) = ParameterFile::parse("fuzz", &text) {
        check_diagnostic(&diagnostic, &mut rendered);
    }
    if let Err(diagnostic) = MachineFile::parse("fuzz", &text, Path::new("")) {
        check_diagnostic(&diagnostic, &mut rendered);
    }
}

/// The bytes as a job of the built-in mill.
pub fn job(bytes: &[u8]) {
    let machine = Machine::from_toml(SMALL_MILL).expect("it is shipped");
    let options = options(Dialect::Linuxcnc);
    let program = Program::from_job("fuzz", bytes, &options);
    let mut rendered = 0;
    for item in Interpreter::new(program, &machine).take(usize::try_from(CALLS).unwrap_or(usize::MAX)) {
        match item {
            Ok(item) => assert_eq!(item.check(), Ok(())),
            Err(diagnostic) => check_diagnostic(&diagnostic, &mut rendered),
        }
    }
}

/// The bytes as the summary of a run: what can be read can be written and read again.
pub fn summary(bytes: &[u8]) {
    if let Ok(summary) = serde_json::from_slice::<Summary>(bytes) {
        let text = serde_json::to_string(&summary).expect("it can be written");
        assert!(serde_json::from_str::<Summary>(&text).is_ok(), "{text}");
    }
}

/// The bytes as the arrivals of a run: refused by a line, or written and read again as the same.
pub fn arrivals(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    match Arrivals::from_text(text) {
        Ok(arrivals) if arrivals.gap.is_none() => {
            // It is written by this version, whoever wrote what was read.
            let again = Arrivals::from_text(&arrivals.text());
            let by = again.as_ref().ok().and_then(|again| again.by.clone());
            assert_eq!(again, Ok(Arrivals { by, ..arrivals }));
        }
        Ok(_) => {}
        Err(refused) => assert!(refused.starts_with("line "), "{refused}"),
    }
}

/// The bytes as the arrivals of a run whose processes were all killed: the lines before the first damaged one.
pub fn arrivals_live(bytes: &[u8]) {
    let left = Arrivals::left(bytes);
    let changes: Vec<u64> = left.changes.iter().map(|(cycle, ..)| *cycle).collect();
    // A line that is whole and means something else was not written by us.
    let known = [5004, 5005, 7000, 7100];
    assert!(changes.iter().zip(known).all(|(read, written)| *read == written), "{changes:?}");
}

/// The bytes as a journal; and as what a whole record of one says, by which a program is gone on with from
/// where the machine is at home: refused, or a plan.
pub fn journal(bytes: &[u8]) {
    let _ = (latest::<State>(bytes), has_other_version::<State>(bytes));
    let mut content = [0; size_of::<State>()];
    content.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    let Ok(state) = State::read_from_bytes(&content) else { return };
    let machine = Machine::plain();
    let program =
        "G18 G21 G90 G8 G94 G97\nM3 S800\nG0 X12 Z12\nG1 Z5 F600\nG0 X9\nG33 Z-6 K1.5\nG0 X12\nM5\nM2\n";
    let items = || Interpreter::of_text("fuzz", program.to_string(), &machine).map_while(Result::ok);
    match resume::plan(&machine, items, &state, &machine.home()) {
        Ok(plan) => assert!(plan.before.iter().all(|item| item.check().is_ok()), "{plan:?}"),
        Err(refused) => assert!(!refused.to_string().is_empty()),
    }
}

/// The bytes as touches of a thread: refused by a line, or a thread that is found or not.
pub fn touches(bytes: &[u8]) {
    match pickup::touches(&String::from_utf8_lossy(bytes)) {
        Ok(touches) => {
            let asked = Asked { lead_mm: -2.0, starts: 2, noise_mm: 0.005, lead_error_mm: 0.01 };
            if let Ok(found) = pick_up(&touches, &asked) {
                assert!(found.lead_mm.value.is_finite() && found.phase_mm.value.is_finite(), "{found:?}");
            }
        }
        Err(refused) => assert!(refused.starts_with("line "), "{refused}"),
    }
}

/// The bytes as a document of somebody at the panel: a request that the plant takes, or refused by name.
pub fn press(bytes: &[u8]) {
    match panel::pressed(bytes) {
        Ok(Some(request)) => assert!(request.unpack().is_ok(), "{request:?}"),
        Ok(None) => {}
        Err(panel::Refusal { code, why }) => {
            let codes = ["bad-request", "bad-value", "unknown", "not-there-yet"];
            assert!(codes.contains(&code) && !why.is_empty(), "{code}: {why}");
        }
    }
}

/// The bytes as a packet of machine code: refused, or an item that travels again. Nothing is allocated.
pub fn code_packet(bytes: &[u8]) {
    let Ok(packet) = CodePacket::from_bytes(bytes) else { return };
    if let Ok(item) = packet.unpack(0) {
        assert_eq!(item.check(), Ok(()));
        let again = CodePacket::pack(0, &item);
        assert_eq!(again.unpack(0).map(|item| CodePacket::pack(0, &item)), Ok(again), "{item:?}");
    }
}

/// Bytes before the content of a machine-code file.
const HEAD: usize = 18;

fn with_head(content: &[u8]) -> Vec<u8> {
    let mut file = b"PLMC".to_vec();
    file.extend(VERSION.to_le_bytes());
    file.extend((content.len() as u64).to_le_bytes());
    file.extend(crc32fast::hash(content).to_le_bytes());
    file.extend(content);
    file
}

fn options(dialect: Dialect) -> Options {
    let parameters = (31..=40).chain(100..=120).map(|n| (n, f64::from(n) - 35.0)).collect();
    let machine_codes = Arc::new([(31, MachineCode::Ignore), (32, MachineCode::Wait)].into());
    Options { dialect, parameters, machine_codes, limits: LIMITS, ..Options::default() }
}

/// Mills and turning tools, with and without a length, a radius and an orientation.
fn tools() -> ToolTable {
    let mut table = ToolTable::default();
    for number in 1..=12 {
        let size = f64::from(number);
        let offset = [size - 4.0, 0.0, 10.0 * size, 0.0, 0.0, 0.0];
        let orientation = (number - 1).min(9) as u8;
        let angles = (95.0, 155.0);
        table.set(Tool {
            number,
            pocket: number,
            offset,
            diameter: 0.4 * size,
            front_angle: angles.0,
            back_angle: angles.1,
            orientation,
            ..Tool::default()
        });
    }
    table
}

/// Takes calls in both forms, and refuses them when they are too many.
struct Printers {
    linuxcnc: LinuxcncPrinter<io::Sink>,
    plain: PlainPrinter<io::Sink>,
    left: u32,
}

impl Sink for Printers {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        let Some(left) = self.left.checked_sub(1) else {
            let help = "nothing: it was long enough";
            return Err(Problem::error("too-long", gcode::problem::Blame::Block, "enough", help));
        };
        self.left = left;
        self.linuxcnc.call(place, call)?;
        self.plain.call(place, call)?;
        match call {
            Call::ThreadCycle(cycle) => {
                let mut left = 1000;
                let mut each = |_: Call<'static>| {
                    left -= 1;
                    if left > 0 { Ok(()) } else { Err(()) }
                };
                // A thread of very many passes is refused by whoever has to cut it.
                let _ = cycle.expand(&mut each);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn job(&mut self, place: Place, job: &Job, tools: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        self.linuxcnc.job(place, job, tools)?;
        self.plain.job(place, job, tools)
    }
}

fn program(bytes: &[u8], dialect: Dialect) {
    let mut options = options(dialect);
    options.tools = tools();
    // Machines differ in what they take a coordinate without a decimal point for.
    options.decimal_point = match bytes.len() % 4 {
        0 => None,
        1 => Some(DecimalPoint::Conventional),
        2 => Some(DecimalPoint::PocketCalculator),
        _ => Some(DecimalPoint::Refuse),
    };
    let mut program = Program::from_text("fuzz", bytes, &options);
    let mut sink = Printers {
        linuxcnc: LinuxcncPrinter::new(io::sink()),
        plain: PlainPrinter::new(io::sink(), Units::Millimetre),
        left: CALLS,
    };
    let lines = bytes.iter().filter(|byte| **byte == b'\n').count() as u64 + 2;
    let most = (u64::from(CALLS) + lines) * LIMITS.blocks_without_motion;
    let mut rendered = 0;
    for step in 0.. {
        assert!(step < most, "no end after {step} lines");
        match program.step(&mut sink) {
            Ok(Step::More) => {}
            Ok(Step::Ended) => break,
            Err(diagnostic) => check_diagnostic(&diagnostic, &mut rendered),
        }
    }
    for warning in program.take_warnings() {
        check_diagnostic(&warning, &mut rendered);
    }
}

fn check_problem(problem: &Problem) {
    assert!(!problem.message.is_empty() && !problem.help.is_empty(), "{problem:?}");
}

fn check_diagnostic(diagnostic: &Diagnostic, rendered: &mut u32) {
    let Diagnostic { text, span, message, help, .. } = diagnostic;
    assert!(!message.is_empty() && !help.is_empty(), "{diagnostic:?}");
    assert!(text.get(span.clone()).is_some(), "{diagnostic:?}");
    if *rendered < RENDERED {
        *rendered += 1;
        assert!(diagnostic.render(false).contains(diagnostic.code));
    }
}
