//! Two hosts on one computer: programs, folders and addresses of their own; with an administrator also
//! networks.

use std::{
    fs,
    net::TcpListener,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    sync::atomic::{AtomicU32, Ordering},
};

use process::ipc::time::{Moment, sleep_until};
use serde_json::Value;
use tempfile::TempDir;

/// The link, as it was built.
pub(crate) const LINK: &str = env!("CARGO_BIN_EXE_pitchlock-link");

/// The control beside it.
pub(crate) fn control() -> PathBuf {
    let path = Path::new(LINK).with_file_name("pitchlock");
    assert!(
        path.exists(),
        "{}: build it first, by `cargo build --bin pitchlock` in the project",
        path.display()
    );
    path
}

/// A file of the project.
pub(crate) fn project(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// Sleeps.
pub(crate) fn wait_s(seconds: f64) {
    sleep_until(Moment::in_s(seconds));
}

/// Waits until something is so, so many seconds at most.
pub(crate) fn until(what: &str, most_s: f64, mut so: impl FnMut() -> bool) {
    let deadline = Moment::in_s(most_s);
    while !so() {
        assert!(!deadline.passed(), "{what}: not within {most_s} s");
        wait_s(0.01);
    }
}

/// Which host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Host {
    /// With the program.
    A,
    /// With the machine.
    B,
}

/// Two network namespaces with a cable between them. They go with this.
pub(crate) struct Cable {
    name: String,
}

/// Runs a command of the system.
fn system(line: &str) -> bool {
    let mut words = line.split(' ');
    let program = words.next().unwrap_or_default();
    let done = Command::new(program).args(words).stdout(Stdio::null()).stderr(Stdio::null()).status();
    done.is_ok_and(|status| status.success())
}

impl Cable {
    /// Lays it; `None`, which is said, for those who may not.
    pub(crate) fn lay() -> Option<Cable> {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let name = format!("pl{}x{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let cable = Cable { name };
        let [a, b] = [Host::A, Host::B].map(|host| cable.space(host));
        let laid = system(&format!("ip netns add {a}"))
            && system(&format!("ip netns add {b}"))
            && system(&format!("ip link add v0 netns {a} type veth peer name v0 netns {b}"))
            && [(&a, 1), (&b, 2)].iter().all(|(space, number)| {
                system(&format!("ip -n {space} address add 10.77.0.{number}/24 dev v0"))
                    && system(&format!("ip -n {space} link set v0 up"))
                    && system(&format!("ip -n {space} link set lo up"))
            });
        if !laid {
            eprintln!("left out: two network namespaces need an administrator, and `ip` (iproute2)");
        }
        laid.then_some(cable)
    }

    fn space(&self, host: Host) -> String {
        format!("{}{}", self.name, if host == Host::A { "a" } else { "b" })
    }

    /// Pulls it, or plugs it in again.
    pub(crate) fn plug(&self, up: bool) {
        let state = if up { "up" } else { "down" };
        assert!(system(&format!("ip -n {} link set v0 {state}", self.space(Host::B))), "{state}");
    }

    /// Lets one of a hundred frames be lost in either direction; `false`, which is said, without nftables.
    pub(crate) fn loses_one_of_a_hundred(&self) -> bool {
        let rule = "table netdev loss { chain loss { type filter hook ingress device v0 priority 0; \
                    numgen random mod 100 < 1 counter drop; }; }";
        let set = |host| {
            let mut nft = Command::new("ip");
            nft.args(["netns", "exec", &self.space(host), "nft", rule]).stderr(Stdio::null());
            nft.status().is_ok_and(|status| status.success())
        };
        let all = set(Host::A) && set(Host::B);
        if !all {
            eprintln!("left out: lost frames need nftables");
        }
        all
    }

    /// Lets 40 Mbit a second through from host A; `false`, which is said, without `tc`.
    pub(crate) fn is_slow(&self) -> bool {
        let rule = format!(
            "ip netns exec {} tc qdisc add dev v0 root tbf rate 40mbit burst 64kbit latency 400ms",
            self.space(Host::A)
        );
        let slow = system(&rule);
        if !slow {
            eprintln!("left out: a slow cable needs `tc` (iproute2), and its token bucket");
        }
        slow
    }

    /// Frames that were lost.
    pub(crate) fn lost(&self) -> u64 {
        let of = |host| {
            let mut nft = Command::new("ip");
            nft.args(["netns", "exec", &self.space(host), "nft", "list", "ruleset"]);
            let text = String::from_utf8_lossy(&nft.output().expect("nft").stdout).into_owned();
            let counted =
                text.split("packets ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<u64>().ok());
            counted.expect("a counter")
        };
        of(Host::A) + of(Host::B)
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        for host in [Host::A, Host::B] {
            system(&format!("ip netns delete {}", self.space(host)));
        }
    }
}

/// Both hosts.
pub(crate) struct Place {
    folder: TempDir,
    /// Between them, if it is not loopback.
    pub(crate) cable: Option<Cable>,
    /// Where the machine can be called.
    pub(crate) address: String,
    serve: Option<Child>,
}

impl Drop for Place {
    fn drop(&mut self) {
        if let Some(mut serve) = self.serve.take() {
            signal(serve.id(), "INT");
            let deadline = Moment::in_s(5.0);
            while serve.try_wait().is_ok_and(|ended| ended.is_none()) && !deadline.passed() {
                wait_s(0.01);
            }
            let _ = serve.kill();
            let _ = serve.wait();
        }
    }
}

/// Sends a signal to a process that was started here, or by one that was.
pub(crate) fn signal(pid: u32, name: &str) {
    assert!(system(&format!("kill -{name} {pid}")), "kill -{name} {pid}");
}

impl Place {
    /// Two hosts with one key, over this cable or loopback.
    pub(crate) fn new(cable: Option<Cable>) -> Place {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["a/tmp", "b/tmp"] {
            fs::create_dir_all(folder.path().join(name)).expect("a folder");
        }
        let port = || {
            TcpListener::bind("127.0.0.1:0")
                .and_then(|listener| listener.local_addr())
                .expect("a port")
                .port()
        };
        let address = if cable.is_some() { "10.77.0.2:7447".into() } else { format!("127.0.0.1:{}", port()) };
        let place = Place { folder, cable, address, serve: None };
        place.make_key("key");
        place
    }

    /// A file or folder in it.
    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Makes a key.
    pub(crate) fn make_key(&self, name: &str) {
        let made = Command::new(LINK).arg("key").arg(self.at(name)).status().expect("it starts");
        assert!(made.success(), "a key");
    }

    /// Writes a program.
    pub(crate) fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.at(name);
        fs::write(&path, text).expect("written");
        path
    }

    /// A program on one of the hosts.
    pub(crate) fn command(&self, host: Host, program: &Path) -> Command {
        let (home, mut command) = (self.at(if host == Host::A { "a" } else { "b" }), Command::new(program));
        if let Some(cable) = &self.cable {
            command = Command::new("ip");
            command.args(["netns", "exec", &cable.space(host)]).arg(program);
        }
        command.env("TMPDIR", home.join("tmp")).current_dir(home);
        command
    }

    /// Has the machine wait on host B.
    pub(crate) fn serve(&mut self, arguments: &[&str]) {
        let command = self.command(Host::B, &control());
        self.serve_by(command, arguments);
    }

    /// The same with temporary files in this folder.
    pub(crate) fn serve_with_temporary(&mut self, folder: &Path) {
        let mut command = self.command(Host::B, &control());
        command.env("TMPDIR", folder);
        self.serve_by(command, &[]);
    }

    fn serve_by(&mut self, mut command: Command, arguments: &[&str]) {
        let said = fs::File::create(self.at("serve.txt")).expect("a file");
        command.args(["serve", "--listen", &self.address, "--key"]).arg(self.at("key")).args(arguments);
        let mut serve = command.stdout(Stdio::null()).stderr(said).spawn().expect("it starts");
        until("the machine waits", 20.0, || {
            let ended = serve.try_wait().expect("it is ours");
            assert!(ended.is_none(), "{ended:?}: {}", self.said());
            self.said().contains("the machine waits")
        });
        self.serve = Some(serve);
    }

    /// Its launcher is killed.
    pub(crate) fn kill_serve(&mut self) {
        let mut serve = self.serve.take().expect("it serves");
        // It is ours, and not collected yet: its number is that of nobody else.
        serve.kill().expect("it lives");
        serve.wait().expect("it has ended");
    }

    /// Sends its launcher a signal.
    pub(crate) fn signal_serve(&self, name: &str) {
        signal(self.serve.as_ref().expect("it serves").id(), name);
    }

    /// Its launcher ends by itself; its status.
    pub(crate) fn serve_ends(&mut self, most_s: f64) -> Option<i32> {
        ended(self.serve.take().expect("it serves"), most_s).status.code()
    }

    /// What the machine has said.
    pub(crate) fn said(&self) -> String {
        fs::read_to_string(self.at("serve.txt")).unwrap_or_default()
    }

    /// A run of a program of host A on the machine of host B.
    pub(crate) fn far(&self, program: &Path, arguments: &[&str]) -> Command {
        let mut command = self.command(Host::A, &control());
        command.arg("run").arg(program).args(["--at", &self.address, "--key"]).arg(self.at("key"));
        command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// The same, to its end: its summary.
    pub(crate) fn run(&self, program: &Path, arguments: &[&str]) -> Value {
        let all = [&["--json", "--trace", "none"], arguments].concat();
        summary(&self.far(program, &all).output().expect("it starts"))
    }

    /// The same program in one process on one host.
    pub(crate) fn alone(&self, program: &Path, arguments: &[&str]) -> Value {
        let mut command = self.command(Host::A, &control());
        command.arg("run").arg(program).args(["--in-process", "--json", "--trace", "none", "--out"]);
        command.arg(self.at("alone")).args(arguments);
        let _ = fs::remove_dir_all(self.at("alone"));
        summary(&command.output().expect("it starts"))
    }

    /// Run folders on host B, in the order of their numbers.
    pub(crate) fn runs(&self) -> Vec<PathBuf> {
        let all = fs::read_dir(self.at("b/runs")).into_iter().flatten().flatten().map(|entry| entry.path());
        let mut all: Vec<_> = all.collect();
        all.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
        all
    }

    /// What the journal of a run on host B says, also of one that is on.
    pub(crate) fn journal(&self, run: &Path) -> Option<Value> {
        let mut command = self.command(Host::B, &control());
        let output = command.arg("journal").arg(run).arg("--json").output().expect("it starts");
        serde_json::from_slice(&output.stdout).ok()
    }

    /// Waits until the run of this number cuts its second pass.
    pub(crate) fn cuts(&self, number: usize) {
        let pass = |run: &PathBuf| self.journal(run)?["pass"].as_u64();
        until("the run cuts", 30.0, || {
            self.runs().get(number - 1).and_then(pass).is_some_and(|pass| pass >= 2)
        });
    }

    /// Whether nothing of a machine is left on a host.
    pub(crate) fn is_clean(&self, host: Host) -> bool {
        let user = fs::read_dir(self.at(if host == Host::A { "a/tmp" } else { "b/tmp" })).expect("a folder");
        let kept = |entry: &fs::DirEntry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            ["serve", "by-hand"].iter().any(|what| name.contains(what))
        };
        let spaces = user.flatten().filter(|entry| !kept(entry));
        spaces.flat_map(|entry| fs::read_dir(entry.path()).into_iter().flatten()).count() == 0
    }

    /// Processes of the link on one host.
    pub(crate) fn links(&self, host: Host) -> Vec<u32> {
        if host == Host::A {
            [self.links_of("upper"), self.links_of("panel")].concat()
        } else {
            self.links_of("lower")
        }
    }

    /// Processes of the link that are this end of it.
    pub(crate) fn links_of(&self, end: &str) -> Vec<u32> {
        self.processes(|words| words.get(1) == Some(&end) && words[0].contains("pitchlock-link"))
    }

    /// Processes of either host with such words.
    pub(crate) fn processes(&self, such: impl Fn(&[&str]) -> bool) -> Vec<u32> {
        let place = self.folder.path().canonicalize().expect("a folder");
        let of = |entry: fs::DirEntry| {
            let pid: u32 = entry.file_name().to_str()?.parse().ok()?;
            let line = fs::read_to_string(entry.path().join("cmdline")).ok()?;
            let words: Vec<_> = line.split('\0').collect();
            let ours = fs::read_link(entry.path().join("cwd")).ok()?.starts_with(&place);
            (ours && such(&words)).then_some(pid)
        };
        fs::read_dir("/proc").expect("processes").flatten().filter_map(of).collect()
    }
}

/// The summary that a command has printed.
pub(crate) fn summary(output: &Output) -> Value {
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {} {said}", output.status))
}

/// Waits until a process has ended.
pub(crate) fn ended(child: Child, most_s: f64) -> Output {
    let reads = std::thread::Builder::new().spawn(move || child.wait_with_output()).expect("a thread");
    until("it ends", most_s, || reads.is_finished());
    reads.join().expect("it reads").expect("its own")
}

/// A number that whoever tests may give, or what it is without.
pub(crate) fn count(name: &str, without: u64) -> u64 {
    std::env::var(name).ok().map_or(without, |text| text.parse().expect(name))
}
