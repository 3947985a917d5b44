//! Name spaces across processes that live, die and are killed. This test program starts itself in other
//! roles.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::{
    collections::BTreeSet,
    fs,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

use process::ipc::{
    IpcError, Member, NameSpace, Patience, Process, Undelivered, channel,
    time::{Moment, sleep_until},
    total,
};
use protocol::{Axis, Code, CodePacket, Cycle, DriveCommand, Item, Measurement};

const AXES: [Axis; 2] = [Axis::X, Axis::Z];
const ROLE: &str = "PITCHLOCK_TEST_ROLE";
const ADDRESS: &str = "PITCHLOCK_TEST_ADDRESS";
/// So many that others have time to do harm meanwhile, on a busy computer too.
const CYCLES: u64 = 10_000;
const END: Item = Item { line: 1, code: Code::End };

fn command(role: &str, address: &str) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "processes::in_another_role", "--ignored", "--nocapture", "--quiet"]);
    command.env(ROLE, role).env(ADDRESS, address).stdout(Stdio::piped());
    command
}

fn spawn(role: &str, address: &str) -> Child {
    command(role, address).spawn().unwrap()
}

#[test]
#[ignore = "what a process started by the other tests does"]
fn in_another_role() {
    let Ok(role) = std::env::var(ROLE) else { return };
    let address = std::env::var(ADDRESS).unwrap();
    match role.as_str() {
        "owner" => owner(),
        "tidy-owner" => drop(NameSpace::create(&AXES).unwrap()),
        "plant" => plant(&address),
        "regulator-x" => regulator(&address, Axis::X),
        "regulator-z" => regulator(&address, Axis::Z),
        "deaf-interpolator" => deaf_interpolator(&address),
        "interpreter" => interpreter(&address),
        other => panic!("no role {other}"),
    }
}

fn owner() {
    let space = NameSpace::create(&AXES).unwrap();
    let children = AXES.map(|axis| {
        let mut regulator = command(&Process::Regulator(axis).name(), &space.address());
        regulator.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    });
    println!("\naddress={}", space.address());
    for mut child in children {
        child.wait().unwrap();
    }
}

fn plant(address: &str) {
    let mut member = Member::join(address, Process::Plant).unwrap();
    let mut measurements = member.sender(channel::MEASUREMENT, Patience::Forever).unwrap();
    let mut commands = AXES.map(|axis| member.receiver(channel::DRIVE_COMMAND.of(axis)).unwrap());
    let wakers = AXES.map(|axis| member.waker(Process::Regulator(axis)).unwrap());
    let [x, z] = &commands;
    member.start(&[&measurements, x, z, &wakers[0], &wakers[1]], Moment::in_s(10.0)).unwrap();
    for n in 0..CYCLES {
        let last = u32::from(n + 1 == CYCLES);
        measurements.send(&Measurement { cycle: Cycle(n), last, ..Measurement::default() }).unwrap();
        wakers.iter().for_each(|waker| waker.wake().unwrap());
        for receiver in &mut commands {
            let answer = loop {
                match receiver.receive().unwrap() {
                    Some(answer) => break answer,
                    None => member.wait().unwrap(),
                }
            };
            assert_eq!(answer.cycle, Cycle(n));
        }
    }
    let [x, z] = &commands;
    member.finish(&[measurements.count(), x.count(), z.count()]).unwrap();
}

fn regulator(address: &str, axis: Axis) {
    let mut member = Member::join(address, Process::Regulator(axis)).unwrap();
    let mut measurements = member.receiver(channel::MEASUREMENT).unwrap();
    let mut commands = member.sender(channel::DRIVE_COMMAND.of(axis), Patience::Forever).unwrap();
    let plant = member.waker(Process::Plant).unwrap();
    member.start(&[&measurements, &commands, &plant], Moment::in_s(10.0)).unwrap();
    loop {
        let Some(measurement) = measurements.receive().unwrap() else {
            member.wait().unwrap();
            continue;
        };
        commands.send(&DriveCommand { cycle: measurement.cycle, ..DriveCommand::default() }).unwrap();
        plant.wake().unwrap();
        if measurement.last != 0 {
            return member.finish(&[measurements.count(), commands.count()]).unwrap();
        }
    }
}

fn deaf_interpolator(address: &str) {
    let mut member = Member::join(address, Process::Interpolator).unwrap();
    let code = member.receiver(channel::MACHINE_CODE).unwrap();
    member.start(&[&code], Moment::in_s(10.0)).unwrap();
    loop {
        member.wait().unwrap();
    }
}

fn interpreter(address: &str) {
    let mut member = Member::join(address, Process::Interpreter).unwrap();
    let mut code = member.sender(channel::MACHINE_CODE, Patience::Forever).unwrap();
    member.start(&[&code], Moment::in_s(10.0)).unwrap();
    for _ in 0..channel::CODE_DEPTH {
        code.send(&CodePacket::pack(0, &END)).unwrap();
    }
    println!("\nfull");
    let error = code.send(&CodePacket::pack(0, &END)).unwrap_err();
    assert!(matches!(error, Undelivered::Receivers { reached: 0, expected: 1, .. }), "{error}");
    assert_eq!(code.count().sent, channel::CODE_DEPTH);
    while !member.is_gone(Process::Interpolator) {
        member.wait().unwrap();
    }
    member.finish(&[code.count()]).unwrap();
}

/// Waits for a condition, and not for ever.
fn until(what: &str, mut condition: impl FnMut() -> bool) {
    let deadline = Moment::in_s(20.0);
    while !condition() {
        assert!(!deadline.passed(), "in vain: {what}");
        sleep_until(Moment::in_s(0.002));
    }
}

fn present(missing: &[Process], awaited: &[Process]) -> bool {
    !awaited.iter().any(|process| missing.contains(process))
}

fn succeeds(mut child: Child) -> bool {
    child.wait().unwrap().success()
}

#[test]
fn three_processes_in_lock_step_lose_nothing() {
    lock_step(false);
}

/// Whoever wakes a process for nothing makes it look, and that is all.
#[test]
fn forged_wake_ups_change_nothing() {
    lock_step(true);
}

fn lock_step(forged: bool) {
    let mut space = NameSpace::create(&AXES).unwrap();
    let children = ["regulator-z", "sim-plant", "regulator-x"]
        .map(|name| spawn(name.trim_start_matches("sim-"), &space.address()));
    let all = [Process::Plant, Process::Regulator(Axis::X), Process::Regulator(Axis::Z)];
    until("everybody is connected", || present(&space.missing(&[]).unwrap(), &all));
    space.start().unwrap();
    let wakers = all.map(|process| space.launcher().waker(process).unwrap());
    let mut wakes = 0;
    until("everybody has finished", || {
        (0..if forged { 300 } else { 0 }).for_each(|_| wakers.iter().for_each(|waker| waker.wake().unwrap()));
        wakes += 1;
        present(&space.unfinished().unwrap(), &all)
    });
    assert!(wakes > 3, "they had no time to do harm");
    let counts = total(space.end().unwrap());
    assert!(children.into_iter().all(succeeds));
    let names: Vec<_> = counts.iter().map(|count| count.name.as_str()).collect();
    assert_eq!(names, ["drive-command/x", "drive-command/z", "measurement"]);
    for (count, messages) in counts.iter().zip([CYCLES, CYCLES, 2 * CYCLES]) {
        assert_eq!((count.sent, count.received, count.lost), (messages, messages, 0), "{}", count.name);
    }
}

#[test]
fn a_sender_that_waits_for_the_dead_is_set_free() {
    let mut space = NameSpace::create(&AXES).unwrap();
    let mut deaf = spawn("deaf-interpolator", &space.address());
    let mut interpreter = spawn("interpreter", &space.address());
    let all = [Process::Interpreter, Process::Interpolator];
    until("both are connected", || present(&space.missing(&[]).unwrap(), &all));
    space.start().unwrap();
    // The sender has filled the queue before its receiver dies, however busy the computer is.
    let mut said = BufReader::new(interpreter.stdout.take().unwrap()).lines();
    assert!(said.by_ref().map_while(Result::ok).any(|line| line == "full"));
    deaf.kill().unwrap();
    deaf.wait().unwrap();
    space.bury(Process::Interpolator).unwrap();
    until("the interpreter is free", || present(&space.unfinished().unwrap(), &all[..1]));
    space.end().unwrap();
    assert!(succeeds(interpreter));
}

#[test]
fn nobody_joins_but_children_of_the_owner() {
    let folder = TemporaryFolder::new("join");
    let mut owner = folder.spawn("owner");
    let address = address_of(&mut owner);
    let error = Member::join(&address, Process::Plant).unwrap_err();
    assert!(matches!(error, IpcError::Orphaned { owner: pid } if pid == owner.id() as i32), "{error}");
    owner.kill().unwrap();
    owner.wait().unwrap();
    until("nothing is left", || folder.is_tidy());
}

#[test]
fn a_killed_owner_takes_its_processes_along() {
    let folder = TemporaryFolder::new("owner");
    let mut owner = folder.spawn("owner");
    let address = address_of(&mut owner);
    owner.kill().unwrap();
    owner.wait().unwrap();
    until("nothing is left", || folder.is_tidy());
    assert!(!Path::new(&address).exists());
}

#[test]
fn kills_during_start_up_never_spoil_the_next_start() {
    let folder = TemporaryFolder::new("kill");
    let mut ids = BTreeSet::new();
    for attempt in 0..60 {
        let mut owner = folder.spawn("owner");
        sleep_until(Moment::now().after(Duration::from_micros(1000 + 400 * attempt)));
        owner.kill().unwrap();
        owner.wait().unwrap();
        ids.extend(folder.ids());
    }
    assert!(ids.len() > 10, "the kills came too early to prove anything: {}", ids.len());
    until("nothing is left", || folder.is_tidy());
    let left: Vec<_> = fs::read_dir("/dev/shm").unwrap().flatten().map(|entry| entry.file_name()).collect();
    for name in left.iter().filter_map(|name| name.to_str()) {
        assert!(!ids.iter().any(|id| name.contains(id.as_str())), "{name}");
    }
}

fn address_of(owner: &mut Child) -> String {
    let lines = BufReader::new(owner.stdout.take().unwrap()).lines();
    let address =
        lines.map_while(Result::ok).find_map(|line| line.strip_prefix("address=").map(str::to_owned));
    address.unwrap()
}

/// A place for name spaces that no other test sees.
struct TemporaryFolder(PathBuf);

impl TemporaryFolder {
    fn new(name: &str) -> TemporaryFolder {
        let path = std::env::temp_dir().join(format!("plt{}{name}", std::process::id()));
        fs::create_dir(&path).unwrap();
        TemporaryFolder(path)
    }

    fn spawn(&self, role: &str) -> Child {
        command(role, "").env("TMPDIR", &self.0).spawn().unwrap()
    }

    /// The name spaces in it.
    fn ids(&self) -> Vec<String> {
        let users = fs::read_dir(&self.0).unwrap().flatten();
        let entries = users.flat_map(|user| fs::read_dir(user.path()).unwrap().flatten());
        entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
    }

    /// Starts an owner that ends as it should, and says whether it left nothing, of itself or of others.
    fn is_tidy(&self) -> bool {
        assert!(succeeds(self.spawn("tidy-owner")), "a start after kills has to succeed");
        self.ids().is_empty()
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}
