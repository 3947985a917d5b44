//! Files that others made: what is no file is refused at once, what is too long is refused by its length, and
//! the memory that reading takes is bounded for each byte of the file.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

use machine::Machine;
use protocol::{
    Code, Item,
    code_file::{CodeFile, CodeReader},
};
use rig::observe::Summary;

use crate::shop::{Answer, Place, example};

const SHORT: &str = "G18 G21 G90 G94 G8\nG0 X50 Z90\nG1 X50.1 F3000\nM2\n";

/// Every place of a command line at which a file is named; `FILE` stands for it.
const PLACES: [(&str, &str); 9] = [
    ("program", "check FILE"),
    ("program of a run", "run FILE --in-process --trace none --out run"),
    ("what a program means", "canon FILE"),
    ("machine file", "check short.ngc --machine FILE"),
    ("scenario", "run short.ngc --in-process --trace none --out run --scenario FILE"),
    ("tool table", "check short.ngc --tools FILE"),
    ("job", "check FILE.toml"),
    ("machine code", "check FILE.mc"),
    ("parameters", "canon -p FILE short.ngc"),
];

fn ask(place: &Place, words: &str, file: &str) -> Answer {
    let words: Vec<String> = words.split(' ').map(|word| word.replace("FILE", file)).collect();
    let mut command = Command::new("timeout");
    command.arg("20").arg(place.pitchlock().get_program()).args(words);
    command.current_dir(place.path()).env("TMPDIR", place.path()).stdin(Stdio::null());
    Answer::from(command.output().expect("timeout is part of every system"))
}

/// A pipe that nobody writes to, a device without an end, a folder.
#[test]
fn what_is_no_file_is_refused_instead_of_waited_for() {
    let place = Place::new();
    place.write("short.ngc", SHORT);
    for ending in ["", ".toml", ".mc"] {
        let pipe = place.at(&format!("pipe{ending}"));
        assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
        std::os::unix::fs::symlink("/dev/zero", place.at(&format!("zero{ending}"))).expect("a link");
        fs::create_dir(place.at(&format!("folder{ending}"))).expect("a folder");
    }
    for (what, words) in PLACES {
        for file in ["pipe", "zero", "folder"] {
            let answer = ask(&place, words, file);
            assert_eq!(answer.status, Some(2), "{what}, {file}: {}", answer.stderr);
            let said = &answer.stderr;
            let named =
                ["is a pipe", "is a device", "irectory", "a folder"].iter().any(|word| said.contains(word));
            assert!(named && said.contains(file), "{what}, {file}: {said}");
        }
    }
}

#[test]
fn a_pipe_is_named_where_a_subroutine_or_a_trace_is_asked_for_and_where_a_file_is_written() {
    let place = Place::new();
    let pipe = |name: &str| {
        assert!(Command::new("mkfifo").arg(place.at(name)).status().expect("mkfifo").success());
    };
    let says = |words: &[&str], status: Option<i32>| {
        let answer = place.ask(words);
        assert!(answer.stderr.contains("is a pipe"), "{words:?}: {}", answer.stderr);
        assert_eq!(answer.status, status, "{words:?}: {}", answer.stderr);
    };
    place.write("short.ngc", SHORT);
    place.write("calls.nc", "O1000\nM98 P1001\nM30\n%\n");
    pipe("O1001.nc");
    says(&["check", "calls.nc", "--dialect", "fanuc"], Some(2));
    pipe("out.mc");
    says(&["compile", "short.ngc", "-o", "out.mc"], Some(2));
    says(&["tune", "--axis", "z", "-o", "out.mc"], Some(2));
    says(&["canon", "short.ngc", "out.mc"], Some(2));
    let run = place.ask(&["run", "short.ngc", "--in-process", "--quiet", "--trace", "none", "--out", "run"]);
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    pipe("run/trace.csv");
    says(&["report", "run"], Some(2));
    // A file is replaced as a whole, also through a link.
    std::os::unix::fs::symlink("code.mc", place.at("link.mc")).expect("a link");
    for out in ["code.mc", "link.mc"] {
        let made = place.ask(&["compile", "short.ngc", "-o", out]);
        assert_eq!(made.status, Some(0), "{}", made.stderr);
    }
    assert!(fs::symlink_metadata(place.at("link.mc")).is_ok_and(|found| found.is_symlink()));
    let left = fs::read_dir(place.path()).expect("it is ours").flatten();
    assert!(!left.into_iter().any(|entry| entry.file_name().to_string_lossy().ends_with(".new")));
}

#[test]
fn a_file_that_is_too_long_is_refused_by_its_length() {
    let place = Place::new();
    place.write("short.ngc", SHORT);
    // Sparse: nothing of it is on the disk.
    let long = fs::File::create(place.at("long")).expect("a file");
    long.set_len(1 << 40).expect("a sparse file");
    fs::rename(place.at("long"), place.at("long.toml")).expect("a name");
    for (what, words) in PLACES {
        if ["machine file", "scenario", "tool table", "parameters"].contains(&what) {
            let answer = ask(&place, words, "long.toml");
            assert_eq!(answer.status, Some(2), "{what}: {}", answer.stderr);
            assert!(
                answer.stderr.contains("the most that such a file may have"),
                "{what}: {}",
                answer.stderr
            );
        }
    }
    let folder = place.at("folder");
    fs::create_dir(&folder).expect("a folder");
    fs::rename(place.at("long.toml"), folder.join("summary.json")).expect("a name");
    let answer = ask(&place, "report FILE", "folder");
    assert_eq!(answer.status, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("the most that such a file may have"), "{}", answer.stderr);
}

/// Two million pauses of two bytes: they took a gigabyte.
#[test]
fn machine_code_is_read_item_by_item() {
    let place = Place::new();
    let items: Vec<Item> = vec![Item { line: 1, code: Code::Pause }; 200_000];
    let path = place.at("pauses.mc");
    let mut bytes = Vec::new();
    CodeFile::new("pauses.ngc", &Machine::default().identity(), items)
        .write(&mut bytes)
        .expect("it is sound");
    assert!(bytes.len() < 700_000, "{}", bytes.len());
    fs::write(&path, &bytes).expect("room");
    let mut count = 0;
    let memory = allocation_counter::measure(|| {
        let reader = CodeReader::open(&path, &Machine::default().identity()).expect("it is sound");
        count = reader.filter(Result::is_ok).count();
    });
    assert_eq!(count, 200_000);
    assert!(memory.bytes_max < 512 * 1024, "{} bytes", memory.bytes_max);
    assert_eq!(ask(&place, "check FILE", "pauses.mc").status, Some(0));
}

/// Ten thousand tools are kept, and a million are not: each would take a kilobyte.
#[test]
fn machine_code_with_very_many_tools_is_refused() {
    let place = Place::new();
    let items: Vec<Item> = (0..70_000).map(|number| Item { line: 1, code: Code::Tool { number } }).collect();
    let mut bytes = Vec::new();
    CodeFile::new("tools.ngc", &Machine::default().identity(), items).write(&mut bytes).expect("it is sound");
    place.write("tools.mc", bytes);
    let answer = ask(&place, "check FILE", "tools.mc");
    assert_eq!(answer.status, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("cut it in several programs"), "{}", answer.stderr);
}

/// A compressed trace whose one record says to have gigabytes, and has them: all zeros.
#[test]
fn a_trace_that_unpacks_to_very_much_is_refused() {
    let place = Place::new();
    place.run(&example("internal-m30"), "run", &["--in-process"]);
    let path = place.at("run/trace.mcap");
    let bomb = bomb(400 << 20);
    assert!(bomb.len() < 200_000, "{}", bomb.len());
    fs::write(&path, bomb).expect("room");
    // A summary without the hash of its trace, as older ones are: with it the trace would not be read at all.
    let summary = place.at("run/summary.json");
    let text = fs::read_to_string(&summary).expect("it was written");
    let without: Vec<&str> = text.lines().filter(|line| !line.contains("\"trace_file_hash\"")).collect();
    assert_ne!(without.len(), text.lines().count(), "it has one");
    fs::write(&summary, without.join("\n")).expect("room");
    let (answer, kb) = crate::shop::peak_kb(place.pitchlock().args(["report", "run"]));
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let page = fs::read_to_string(place.at("run/report.html")).expect("a page");
    assert!(page.contains("The trace ends early"), "it is said");
    assert!(kb < 200_000, "{kb} kB");
}

/// An MCAP file with one chunk, compressed, that holds one record of so many bytes.
fn bomb(bytes: u64) -> Vec<u8> {
    let mut writer = mcap::WriteOptions::new()
        .chunk_size(None)
        .compression_threads(0)
        .create(std::io::Cursor::new(Vec::new()))
        .expect("a file in memory");
    let data = vec![0; usize::try_from(bytes).expect("it fits")];
    let schema = writer.add_schema("pitchlock/msg/Cycle", "ros2msg", b"").expect("a schema");
    let channel = writer.add_channel(schema, "/other", "cdr", &Default::default()).expect("a channel");
    let header =
        mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
    writer.write_to_known_channel(&header, &data).expect("a message");
    writer.finish().expect("an end");
    writer.into_inner().into_inner()
}

/// Moves of a program that changes.
const MOVES: usize = 4_000;

/// A program that is changed while it runs is not run behind its first error.
#[test]
fn a_program_that_changes_under_a_run_ends_it() {
    let place = Place::new();
    // Long lines: the interpreter has not read to the end when the machine begins.
    let blocks = format!("G1 X50.1 F3000 ({0})\nG1 X50.0 F3000 ({0})\n", "-".repeat(200)).repeat(MOVES / 2);
    let program = format!("G18 G21 G90 G94 G64\nG0 X50 Z90\n{blocks}M2\n");
    let path = place.write("long.ngc", program);
    for inside in [true, false] {
        let out = format!("run-{inside}");
        let mut command = place.pitchlock();
        command.arg("run").arg(&path).args(["--json", "--out", &out]);
        if inside {
            command.arg("--in-process");
        }
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        crate::shop::until("the machine runs", || place.at(&out).join("trace.mcap").exists());
        crate::shop::wait_s(0.05);
        spoil(&place.at(&out).join("long.ngc"));
        let answer = Answer::from(child.wait_with_output().expect("it was started here"));
        assert_eq!(answer.status, Some(1), "{}", answer.stderr);
        let summary: Summary = serde_json::from_str(&answer.stdout).expect("the summary");
        let died = summary.faults.iter().find(|fault| fault.code == "process-died");
        assert_eq!(died.expect("it is a fault").source, "interpreter", "{:?}", summary.faults);
        assert!(summary.moves.count < MOVES as u64, "{}", summary.moves.count);
    }
}

/// Writes what is not a program over all of a file but its beginning.
fn spoil(path: &Path) {
    use std::os::unix::fs::FileExt as _;
    let file = fs::File::options().write(true).open(path).expect("it is there");
    let length = file.metadata().expect("it is there").len();
    let wrong = b"G1 X!!!!! F3000\n".repeat(4096);
    let mut at = length / 2;
    while at < length {
        file.write_all_at(&wrong, at).expect("room");
        at += wrong.len() as u64;
    }
}
