//! What the tests of the whole program share: the program, its examples, and a place that no other test sees.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)] // each test file uses its part

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
};

use interpreter::{Interpreter, Language};
use machine::Machine;
use process::ipc::time::{Moment, sleep_until};
use protocol::Item;
use rig::Rig;
use rig::observe::{Observation, Observer, Outcome, Record, Summary};
use sim_plant::Scenario;

/// The part programs that are shipped.
pub const EXAMPLES: [&str; 3] = ["m20x2", "worm-left", "internal-m30"];

/// The scenarios that are shipped.
pub const SCENARIOS: [&str; 3] = ["override-100-80-60", "override-in-pass", "bogged-spindle"];

/// The folder of the project.
pub fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A part program that is shipped.
pub fn example(name: &str) -> PathBuf {
    project().join("examples").join(name).with_extension("ngc")
}

/// A scenario that is shipped.
pub fn scenario(name: &str) -> PathBuf {
    project().join("examples/scenarios").join(name).with_extension("toml")
}

/// Machine code of a job or a program, which has no errors.
pub fn items(machine: &Machine, path: &Path) -> Vec<Item> {
    let program = interpreter::open(path, &Language::default(), machine).expect("it can be read");
    let items = Interpreter::new(program, machine).collect::<Result<Vec<Item>, _>>();
    items.unwrap_or_else(|error| panic!("{}: {}", path.display(), error.render(false)))
}

/// What is observed of machine code in the whole machine, to its end; `see` also sees every control cycle.
pub fn observed(
    machine: &Machine,
    items: &[Item],
    scenario: &str,
    mut see: impl FnMut(&Record),
) -> Observation {
    let scenario = Scenario::from_toml(scenario).expect("a scenario");
    let mut rig = Rig::new(machine, items.iter().copied(), scenario, 1).expect("a plant");
    let mut observer = Observer::new(machine, items);
    while rig.cycle(None, |record| {
        observer.cycle(record);
        see(record);
    }) {}
    let observation = observer.finish();
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    observation
}

/// A folder for one test: run folders, and the temporary files of the program. Its path is short, because
/// sockets live below it.
pub struct Place(tempfile::TempDir);

/// What a command answered.
pub struct Answer {
    pub status: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Answer {
    fn from(output: Output) -> Answer {
        let text = |bytes| String::from_utf8(bytes).expect("the program speaks UTF-8");
        Answer { status: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

impl Place {
    pub fn new() -> Place {
        Place(tempfile::Builder::new().prefix("plt").tempdir().unwrap())
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// A file or folder of this place.
    pub fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.at(name);
        fs::write(&path, text).unwrap();
        path
    }

    /// Takes a run folder away, so that another run may have its name.
    pub fn clear(&self, out: &str) {
        if self.at(out).exists() {
            fs::remove_dir_all(self.at(out)).unwrap();
        }
    }

    /// The program, working in this place.
    pub fn pitchlock(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pitchlock"));
        command.current_dir(self.path()).env("TMPDIR", self.path()).stdin(Stdio::null());
        command
    }

    /// Gives a command line and waits for the answer.
    pub fn ask(&self, arguments: &[&str]) -> Answer {
        self.pitchlock().args(arguments).output().unwrap().into()
    }

    /// The same, with a text on its standard input.
    pub fn tell(&self, arguments: &[&str], text: &str) -> Answer {
        let path = self.write("standard-input", text);
        let input = fs::File::open(path).unwrap();
        self.pitchlock().args(arguments).stdin(input).output().unwrap().into()
    }

    /// Runs a program to its good end, with a new run folder of that name, and gives what it says.
    pub fn run(&self, program: &Path, out: &str, arguments: &[&str]) -> Summary {
        self.clear(out);
        let mut command = self.pitchlock();
        command.arg("run").arg(program).args(arguments).args(["--json", "--out", out]);
        let answer = Answer::from(command.output().unwrap());
        assert_eq!(answer.status, Some(0), "{} {arguments:?}: {}", program.display(), answer.stderr);
        serde_json::from_str(&answer.stdout).expect("--json prints the summary and nothing else")
    }

    /// The same in one process and without a trace; `scenario` may name one of the shipped ones.
    pub fn run_inside(&self, program: &Path, scenario_name: Option<&str>) -> Summary {
        self.run_with(program, "inside", scenario_name, &[])
    }

    /// The same on the plain lathe.
    pub fn run_plain(&self, program: &Path, scenario_name: Option<&str>) -> Summary {
        let machine = project().join("examples/machines/plain-lathe.toml").display().to_string();
        self.run_with(program, "plain", scenario_name, &["--machine", &machine])
    }

    fn run_with(&self, program: &Path, out: &str, scenario_name: Option<&str>, more: &[&str]) -> Summary {
        let scenario = scenario_name.map(|name| scenario(name).display().to_string());
        let mut arguments = [&["--in-process", "--trace", "none"], more].concat();
        arguments.extend(scenario.iter().flat_map(|path| ["--scenario", path.as_str()]));
        self.run(program, &format!("{out}-{}", scenario_name.unwrap_or("quiet")), &arguments)
    }

    /// Starts a run over processes and leaves it alone. The run folder is called `run`.
    pub fn start(&self, program: &Path) -> Child {
        self.clear("run");
        let mut command = self.pitchlock();
        command.arg("run").arg(program).args(["--json", "--out", "run"]);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }
}

/// Waits for a condition, and not for ever.
pub fn until(what: &str, mut condition: impl FnMut() -> bool) {
    let deadline = Moment::in_s(60.0);
    while !condition() {
        assert!(!deadline.passed(), "waited in vain: {what}");
        wait_s(0.002);
    }
}

/// Lets time pass for processes that are watched from outside.
pub fn wait_s(seconds: f64) {
    sleep_until(Moment::in_s(seconds));
}

/// The processes that a launcher has started: name of the command and process id.
pub fn children(launcher: &Child) -> Vec<(String, u32)> {
    let pid = launcher.id();
    let pids = fs::read_to_string(format!("/proc/{pid}/task/{pid}/children")).unwrap_or_default();
    let child = |pid: &str| {
        let command = fs::read_to_string(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        let words: Vec<&str> = command.split('\0').collect();
        let axis = words.iter().position(|word| *word == "--axis").map_or("", |at| words[at + 1]);
        let name = format!("{} {axis}", words.get(1).unwrap_or(&"")).trim_end().replace(' ', "-");
        (name, pid.parse().unwrap())
    };
    pids.split_whitespace().map(child).collect()
}

/// Sends a signal, as in `KILL`, to a process that this test has started.
pub fn signal(pid: u32, signal: &str) {
    // It may have ended by itself meanwhile.
    let _ =
        Command::new("kill").arg(format!("-{signal}")).arg(pid.to_string()).stderr(Stdio::null()).status();
}

/// Whether any process is left that was told of this place.
pub fn alive(place: &Place) -> bool {
    let told = place.path().display().to_string();
    let of_entry = |entry: fs::DirEntry| fs::read_to_string(entry.path().join("cmdline")).unwrap_or_default();
    fs::read_dir("/proc").unwrap().flatten().map(of_entry).any(|command| command.contains(&told))
}

/// Name spaces that this place knows of.
pub fn name_spaces(place: &Place) -> Vec<String> {
    let users = fs::read_dir(place.path()).unwrap().flatten();
    let users = users.filter(|entry| entry.file_name().to_string_lossy().starts_with("pitchlock-"));
    let spaces = users.flat_map(|user| fs::read_dir(user.path()).into_iter().flatten().flatten());
    spaces.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

/// Shared memory of name spaces of this place: markers that name it, and what carries one of the ids.
pub fn shared_memory(place: &Place, ids: &std::collections::BTreeSet<String>) -> Vec<String> {
    let told = place.path().display().to_string();
    let ours = |entry: &fs::DirEntry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        let marker = name.starts_with("pitchlock-")
            && fs::read_to_string(entry.path()).is_ok_and(|text| text.contains(&told));
        marker || ids.iter().any(|id| name.contains(id.as_str()))
    };
    let left = fs::read_dir("/dev/shm").unwrap().flatten().filter(ours);
    left.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

/// Whether this user may have file systems of his own; if not, which test is left out is said.
pub fn can_be_private(test: &str) -> bool {
    let tried = Command::new("unshare").args(["-m", "true"]).stderr(Stdio::null()).status();
    let can = tried.is_ok_and(|status| status.success());
    if !can {
        eprintln!("left out: {test} needs an administrator, and unshare");
    }
    can
}

/// A script in a mount namespace of its own, in this place; `$0` is the program.
pub fn private(place: &Place, script: &str) -> Command {
    let mut command = Command::new("unshare");
    command.args(["-m", "sh", "-c", script, env!("CARGO_BIN_EXE_pitchlock")]);
    command.current_dir(place.path()).env("TMPDIR", place.path()).stdin(Stdio::null());
    command
}

/// Memory of a child that ends, kB.
pub fn peak_kb(command: &mut Command) -> (Answer, u64) {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut peak = 0;
    while child.try_wait().expect("it was started here").is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or("0");
        let kb = line.trim().trim_end_matches("kB").trim().parse().unwrap_or(0);
        peak = peak.max(kb);
        wait_s(0.002);
    }
    (Answer::from(child.wait_with_output().expect("it was started here")), peak)
}
