//! Everything that reads what others wrote gets mutations of what is known, thousands of each in a run of the
//! tests and as many as one likes at night:
//! `PITCHLOCK_MUTATIONS=10000000 cargo test --release --test mutations`. No panic, an end of every program
//! within its limits, and no more memory than the length of the input explains. (This test counts the bytes
//! that are taken, and no time: work is bounded by lines and calls.)
//!
//! A failure tells the number of its mutation; `PITCHLOCK_MUTATION=number` runs that one alone.

mod corpus;
mod kept;
mod memory;
mod mutate;
#[allow(unreachable_pub)]
#[path = "../../fuzz/src/lib.rs"]
mod targets;

use std::{env, fs, path::Path};

use corpus::{FANUC, FANUC_MILL, PRESSES, SMALL_JOBS};
use machine::Machine;
use mutate::mutation;
use protocol::{
    Arc, Axis, Code, CodePacket, Curve, Feed, Item, PathMode, PerAxis, Plane, Position, Set, Shape,
    SpindleMode, SpindleSpeed, Until, Work, code_file::CodeFile,
};
use shape::{
    Branch, Contour, Correction, Formula, Function, Op, Pattern, Seam, SeamCurve, Side, Surface, Tool,
};

/// What a job may take beside its longest line, bytes: the places of its surface, those of the path on it.
const JOB_MEMORY: u64 = 96 << 20;
/// What a plant that cuts keeps of its part, bytes: 18 numbers at each of 50 001 places of Z.
const PLANT_MEMORY: u64 = 18 * 50_001 * 8;
/// Mutations of each target in a run of the tests.
const MUTATIONS: u64 = 10_000;
/// What reading may take beside the input, bytes, and how often the input.
const MEMORY: u64 = 2 << 20;
const PER_BYTE: u64 = 256;

/// The value of a variable of the environment, if it is set.
fn asked(variable: &str) -> Option<u64> {
    env::var(variable).ok().map(|value| value.parse().expect("a whole number"))
}

/// The files below a folder that have an ending.
fn programs(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(&folder).expect("the folder exists").flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    let named = paths.into_iter().filter(|path| path.extension().is_some_and(|found| found == ending));
    named.map(|path| fs::read(path).expect("it can be read")).collect()
}

fn all_programs() -> Vec<Vec<u8>> {
    let mut all = programs("tests/conformance/programs", "ngc");
    all.extend(programs("examples", "ngc"));
    all.extend(programs("examples/bar-feeder", "ngc"));
    all.extend(fanuc_programs());
    all.extend(mill_programs());
    all
}

fn fanuc_programs() -> Vec<Vec<u8>> {
    let mut all = programs("examples/fanuc", "nc");
    all.extend(FANUC.iter().map(|text| text.as_bytes().to_vec()));
    all
}

fn mill_programs() -> Vec<Vec<u8>> {
    FANUC_MILL.iter().map(|text| text.as_bytes().to_vec()).collect()
}

/// Values as they stand in programs.
fn values() -> Vec<Vec<u8>> {
    let texts = [
        "[1+2*3]",
        "-[#31**2]",
        "SQRT[ABS[-16]]",
        "ATAN[1]/[2]",
        "[1 LT 2 AND 3 GE 4]",
        "#[30+#31]",
        "EXISTS[#<a>]",
        "1.25",
        "[SIN[30]+COS[60]*TAN[45]]",
        "ROUND[2.5]",
        "[#101 MOD 7 XOR #102]",
        "##100",
        "ACOS[0.5]",
        "[2**3**2]",
        "FUP[1.2]",
        "[[[1]]]",
        "ATAN[1,2]",
        "POW[2,3]",
        "BIN[#100]",
        "[#0 EQ #1]",
        "LN[EXP[1]]",
        "-#100",
        "#<_x>",
        "[10 MOD 3]",
    ];
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

/// Formulas as they stand in jobs.
fn formulas() -> Vec<Vec<u8>> {
    let texts = [
        "0.02*x^2 + 8*sin(x/15)*cos(y/20)",
        "-x^2 - 2^-y^2",
        "sqrt(x^2 + 1e-4) + ln(1 + exp(-y))",
        "(1 + x/10)^1.5 * e^(y/7) - pi",
        "asin(x/50) + acos(y/50) + atan(x*y)",
        "sinh(x)*cosh(y) - tanh(x/y)/tan(1.5)",
        "((x + 1)*(y - 2.5E-1))^-3",
    ];
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

/// Names of threads, one of each form.
fn thread_names() -> Vec<Vec<u8>> {
    let texts = [
        "M20x2-6g/6H",
        "M16xPh3P1.5-4g6g LH",
        "MJ6x1-4h6h/4H5H",
        "Tr40x14(P7)LH-8e/8H",
        "1/4-20 UNC-2A/2B",
        "1 1/8-8 UNRS-3A external",
        "#10-32 UNF-3A",
        "1.125-5 ACME-3G internal",
        "NPT 1 1/2-11.5",
        "G1 1/4-B",
        "Rp1/2",
        "BSW 3/16-24",
        "Rd105 × 1/4",
        "module worm m3 z1=2 d44",
    ];
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

/// One item of everything, and the passes of an example.
fn items() -> [Vec<Item>; 2] {
    let point = |x: f64, z: f64| {
        let mut point: PerAxis<Position> = [Position(0); 8];
        (point[0], point[2]) = (Position::from_mm(x), Position::from_mm(z));
        point
    };
    let feed = Feed::PerRevolution(0.2);
    let center = [Position::from_mm(-2.0), Position::from_mm(18.0)];
    let surface = SpindleSpeed::Surface { mm_s: 2000.0, max_rpm: 1500.0, axis_mm: Position(0) };
    let wave = [Op::Variable(0), Op::Constant(15.0), Op::Div, Op::Apply(Function::Sin), Op::Powi(-2)];
    let contour = Contour { x: [10.0, -3.0], radius_mm: 2.0, side: Side::Left };
    let pattern = Pattern::Lines { along_y: true, count: 80, zigzag: false };
    let tool = Tool { radius_mm: 3.0, corner_mm: 1.0 };
    let surface_of_lines = Surface { x: [0.0, 100.0], y: [-40.0, 40.0], tool, pattern, clear_mm: 25.0 };
    let curve = SeamCurve::Polynomials([[0.5; 8]; 6]);
    let seam = Seam { curve, t: [0.0, 6.25], branch: Branch::Positive, idle_beta_deg: 0.0, moved: None };
    let work = |work: Shape| {
        let (origin, correction) = ([Position(7); 3], Correction::Exact);
        Code::Work(Work { shape: work, origin, feed_mm_min: 1500.0, chord_mm: 0.002, correction })
    };
    let codes = [
        Code::Spindle { mode: SpindleMode::Clockwise, speed: SpindleSpeed::Rpm(600.0) },
        Code::Spindle { mode: SpindleMode::Clockwise, speed: surface },
        Code::PathMode(PathMode::Blend { tolerance_mm: 0.02, merge_mm: 0.0 }),
        Code::Coolant { mist: false, flood: true },
        Code::Line { target: point(10.0, 0.0), feed: Feed::Rapid },
        Code::Line { target: point(18.0, 0.0), feed },
        Code::Output { number: 5, set: Set::Digital(true), in_step: true },
        Code::Await { input: 5, until: Until::High, within_s: 2.0 },
        Code::Pause,
        Code::Arc { arc: Arc { plane: Plane::Zx, target: point(20.0, -2.0), center, turns: 1 }, feed },
        Code::Curve {
            curve: Curve {
                target: point(20.1, -2.0),
                way: [0.1, 0.0, 0.0],
                start: [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
                end: [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
                length_mm: 0.1,
            },
            feed,
        },
        Code::Formula { slot: 0, formula: Formula::new(&wave).expect("it is complete") },
        work(Shape::Contour(contour, [Axis::Z, Axis::X])),
        work(Shape::Surface(surface_of_lines)),
        work(Shape::Seam(seam)),
        Code::End,
    ];
    let items: Vec<Item> = (1..).zip(codes).map(|(line, code)| Item { line, code }).collect();
    let threads = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/m20x2.ngc"));
    let threads = threads.expect("the example can be read");
    let compiled = interpreter::Interpreter::of_text("m20x2.ngc", threads, &Machine::plain());
    [items, compiled.map_while(Result::ok).collect()]
}

/// The same as machine-code files.
fn code_files() -> Vec<Vec<u8>> {
    let file = |items: Vec<Item>| {
        let mut bytes = Vec::new();
        CodeFile::new("mutated.ngc", &Machine::plain().identity(), items)
            .write(&mut bytes)
            .expect("it is sound");
        bytes
    };
    items().into_iter().map(file).collect()
}

/// The same as packets, each the first of a program.
fn code_packets() -> Vec<Vec<u8>> {
    let all = items().into_iter().flatten();
    all.map(|item| CodePacket::pack(0, &item).as_bytes().to_vec()).collect()
}

/// Tells which mutation is at work when the target panics.
struct Watched<'a>(u64, &'a [u8]);

impl Drop for Watched<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let Watched(number, bytes) = self;
            eprintln!("mutation {number}: {:?}", String::from_utf8_lossy(bytes));
        }
    }
}

fn mutate(target: fn(&[u8]), corpus: &[Vec<u8>]) {
    mutate_within(MEMORY, target, corpus);
}

/// The same with so many bytes beside the input.
fn mutate_within(memory_bytes: u64, target: fn(&[u8]), corpus: &[Vec<u8>]) {
    for bytes in corpus {
        target(bytes);
    }
    let one = asked("PITCHLOCK_MUTATION");
    let first = one.or(asked("PITCHLOCK_FIRST_MUTATION")).unwrap_or(0);
    let count = one.map(|_| 1).or(asked("PITCHLOCK_MUTATIONS")).unwrap_or(MUTATIONS);
    for number in first..first + count {
        let bytes = mutation(corpus, number);
        let _watched = Watched(number, &bytes);
        let memory = allocation_counter::measure(|| target(&bytes));
        let most = memory_bytes + PER_BYTE * bytes.len() as u64;
        assert!(memory.bytes_max < most, "{} bytes taken for {}", memory.bytes_max, bytes.len());
        assert_eq!(memory.bytes_current, 0, "bytes kept");
    }
}

#[test]
fn lexer() {
    mutate(targets::lexer, &all_programs());
}

#[test]
fn expression() {
    mutate(targets::expression, &values());
}

#[test]
fn formula() {
    mutate(targets::formula, &formulas());
}

#[test]
fn thread_name() {
    mutate(targets::thread_name, &thread_names());
}

#[test]
fn program_linuxcnc() {
    mutate(targets::program_linuxcnc, &all_programs());
}

#[test]
fn program_fanuc() {
    mutate(targets::program_fanuc, &fanuc_programs());
}

#[test]
fn program_fanuc_mill() {
    mutate(targets::program_fanuc_mill, &mill_programs());
}

#[test]
fn code_file() {
    mutate(targets::code_file, &code_files());
}

#[test]
fn code_packet() {
    mutate(targets::code_packet, &code_packets());
}

/// Machine files that are shipped, and one with M codes of its own.
fn machine_files() -> Vec<Vec<u8>> {
    let mut all = programs("examples/machines", "toml");
    let codes = "\n[m_codes]\n31 = \"ignore\"\n132 = \"wait\"\n";
    all.push([machine::PLAIN_LATHE, codes].concat().into_bytes());
    all
}

/// Scenarios that are shipped, and one of everything.
fn scenarios() -> Vec<Vec<u8>> {
    let mut all = programs("examples/scenarios", "toml");
    all.push(include_bytes!("../../examples/bar-feeder/answers.toml").to_vec());
    all.push(EVENTS.into());
    all
}

/// What the shipped ones lack.
const EVENTS: &str = "[[event]]\nat = { time_s = 1.5 }\nfeed_hold = true\n[[event]]\nat = { pass = 2, angle_deg = 720 }\nstop = true\n\
    [[event]]\nat = { cycle = 100 }\nspindle_override_pct = 80\n[[event]]\nat = { time_s = 60 }\ncycle_start = true\n";

/// Descriptions of parts, tool tables and parameters as they are documented.
fn parts() -> Vec<Vec<u8>> {
    vec![
        b"[stock]\ndiameter_mm = 40.0\nlength_mm = 80.0\nbore_mm = 10.0\n[thread]\nname = \"M20x2-6g\"\n"
            .to_vec(),
    ]
}

fn tables() -> Vec<Vec<u8>> {
    let mut all = programs("examples/first-hour", "tbl");
    all.push(b"5161 0.000000\n5221 1.5\n5222 -2.25\n5601 3\n".to_vec());
    all.push(
        b"[TRAJ]\nLINEAR_UNITS = mm\n[RS274NGC]\nPARAMETER_FILE = a.var\n[EMCIO]\nTOOL_TABLE = t.tbl\n"
            .to_vec(),
    );
    all
}

fn jobs() -> Vec<Vec<u8>> {
    let mut all = programs("examples/shape", "toml");
    all.extend(programs("examples/positioner", "toml"));
    all
}

#[test]
fn machine_file() {
    mutate_within(MEMORY + PLANT_MEMORY, targets::machine_file, &machine_files());
}

#[test]
fn scenario() {
    mutate(targets::scenario, &scenarios());
}

#[test]
fn part() {
    mutate(targets::part, &parts());
}

#[test]
fn tables_of_linuxcnc() {
    mutate(targets::tables, &tables());
}

#[test]
fn job_text() {
    mutate_within(JOB_MEMORY, targets::job_text, &jobs());
}

/// Jobs of all kinds that are planned soon.
fn small_jobs() -> Vec<Vec<u8>> {
    let mut all = programs("examples/positioner", "toml");
    all.extend(SMALL_JOBS.iter().map(|text| text.as_bytes().to_vec()));
    all
}

/// Surfaces, contours and seams are planned as well. One in a thousand has a number in it that makes its way
/// as long as is looked at, which takes seconds.
#[test]
fn job() {
    // The longest line that a job may have is provided for at its beginning.
    mutate_within(JOB_MEMORY, targets::job, &small_jobs());
}

#[test]
fn press() {
    mutate(targets::press, &PRESSES.map(|text| text.as_bytes().to_vec()));
}

/// A queue takes packets in the tick of the interpolator.
#[test]
fn reading_a_packet_allocates_nothing() {
    let packets: Vec<CodePacket> =
        items().into_iter().flatten().map(|item| CodePacket::pack(0, &item)).collect();
    let memory = allocation_counter::measure(|| {
        assert!(packets.iter().all(|packet| packet.unpack(0).is_ok()));
    });
    assert_eq!(memory.count_total, 0);
}
