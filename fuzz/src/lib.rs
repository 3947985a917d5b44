//! What must hold for any bytes: no panic, an end, an answer that names a place.
//!
//! One function for each part that reads what others wrote. libFuzzer drives them from `fuzz_targets/`, with
//! coverage; `tests/mutations` drives the same ones with mutations of programs that are known, on a stable
//! compiler.

mod door;
mod kept;

use std::{
    io,
    path::Path,
    sync::{Arc, LazyLock},
};

use gcode::canon::{LinuxcncPrinter, PlainPrinter, Units};
use gcode::files::{MachineFile, ParameterFile, Tool, ToolTable};
use gcode::{
    Call, DecimalPoint, Diagnostic, Dialect, Job, Limits, MachineCode, Options, Place, Pose, Problem,
    Program, Sink, Step, alone,
};
use interpreter::Interpreter;
use machine::{Machine, POSITIONER, Part, SMALL_MILL};
use metrology::Thread;
use protocol::CodePacket;
use protocol::code_file::{CodeFile, VERSION};
use shape::{Formula, Gradient, Number, Series};
use sim_plant::{Plant, Scenario};

pub use door::{dialogue, door};
pub use kept::{arrivals, arrivals_live, journal, language, summary, touches, trace};

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

/// Machines that are read once: the built-in lathe, a mill and a positioner.
static LATHE: LazyLock<Machine> = LazyLock::new(Machine::default);
static MILL: LazyLock<Machine> = LazyLock::new(|| Machine::from_toml(SMALL_MILL).expect("it is shipped"));
static SEAMER: LazyLock<Machine> = LazyLock::new(|| Machine::from_toml(POSITIONER).expect("it is shipped"));

/// The bytes as a scenario for the built-in machine.
pub fn scenario(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match Scenario::from_toml(&text) {
        Ok(scenario) => {
            let _ = Plant::new(&LATHE, scenario, 1).map_err(|error| error.to_string());
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

/// The bytes as the text of a job.
pub fn job_text(bytes: &[u8]) {
    executed(Program::from_job("fuzz", bytes, &options(Dialect::Linuxcnc)), bytes);
}

/// The bytes as a job, planned: a seam for the built-in positioner, anything else for the built-in mill.
pub fn job(bytes: &[u8]) {
    let is_seam = String::from_utf8_lossy(bytes).contains("seam");
    let machine = if is_seam { &*SEAMER } else { &*MILL };
    let options = options(Dialect::Linuxcnc);
    let program = Program::from_job("fuzz", bytes, &options);
    let mut rendered = 0;
    for item in Interpreter::new(program, machine).take(usize::try_from(CALLS).unwrap_or(usize::MAX)) {
        match item {
            Ok(item) => assert_eq!(item.check(), Ok(())),
            Err(diagnostic) => check_diagnostic(&diagnostic, &mut rendered),
        }
    }
}

/// The bytes as a document of somebody at the panel: a request that the plant takes, or refused by name; or
/// what he wants to see in the scope, whose picture is bounded.
pub fn press(bytes: &[u8]) {
    assert!(panel::scoped(bytes).is_none_or(|length| length < 8 << 20));
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
    executed(Program::from_text("fuzz", bytes, &options), bytes);
}

/// A program to its end, and what it calls, printed.
fn executed(mut program: Program, bytes: &[u8]) {
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
