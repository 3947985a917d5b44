//! A hall: ten machines on two hosts in one view, which changes nothing on any of them.

use std::{
    fmt::Write as _,
    fs,
    process::{Child, Output, Stdio},
};

use process::ipc::time::Moment;
use serde_json::Value;

use crate::place::{Cable, Host, Place, control, ended, project, signal, summary, until};

/// Machines beside the one that every place has, on either host.
struct More(Vec<Child>);

impl Drop for More {
    fn drop(&mut self) {
        for child in &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// A machine waits on one of the hosts, at this address.
fn serves(place: &Place, host: Host, address: &str, key: &str) -> Child {
    let said = place.at(&format!("serve-{}.txt", address.replace(':', "-")));
    let mut command = place.command(host, &control());
    command.args(["serve", "--listen", address, "--key"]).arg(place.at(key)).stdin(Stdio::null());
    let words = fs::File::create(&said).expect("a file");
    let child = command.stdout(Stdio::null()).stderr(words).spawn().expect("it starts");
    until("a machine waits", 30.0, || fs::read_to_string(&said).is_ok_and(|text| text.contains("waits at")));
    child
}

/// What the hall shows, looked at from host A.
pub(crate) fn look(place: &Place) -> (Output, Vec<Value>) {
    let mut command = place.command(Host::A, &control());
    let output = command.arg("hall").arg(place.at("hall.toml")).arg("--json").output().expect("it starts");
    let document: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)));
    let machines = document["machines"].as_array().expect("machines").clone();
    (output, machines)
}

fn answering(machines: &[Value]) -> usize {
    machines.iter().filter(|machine| machine["answers"] == true).count()
}

/// Machines on each host.
const EACH: u16 = 5;
/// A machine that is gone shows within this, s.
const SHOWS_S: f64 = 2.0;

#[test]
fn ten_machines_on_two_hosts_are_one_view_that_changes_nothing() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    place.make_key("other");
    place.serve(&[]);
    let (mut hall, mut more) = (String::from("[hall]\nkey = \"key\"\n"), More(Vec::new()));
    for (host, network) in [(Host::B, 2), (Host::A, 1)] {
        for number in 0..EACH {
            let address = format!("10.77.0.{network}:{}", 7447 + number);
            let _ = writeln!(hall, "[[machine]]\nname = \"{host:?} {number}\"\nat = \"{address}\"");
            if address != place.address {
                more.0.push(serves(&place, host, &address, "key"));
            }
        }
    }
    place.write("hall.toml", &hall);
    let (output, machines) = look(&place);
    assert_eq!((output.status.code(), answering(&machines)), (Some(0), 10), "{machines:?}");
    assert!(machines.iter().all(|machine| machine["seen"]["mode"] == "off"), "{machines:?}");

    // A program runs, and the hall looks all the time.
    let program = project("examples/m20x2.ngc");
    let alone = place.alone(&program, &[]);
    let run = place.far(&program, &["--json", "--trace", "none", "--pace", "20"]).spawn().expect("it starts");
    until("the run is seen, its pass, and what is done of it", 30.0, || {
        let seen = &look(&place).1[0]["seen"];
        seen["mode"] == "auto" && seen["program"] == "m20x2.ngc" && seen["passes"][0].as_u64() >= Some(1)
    });
    let run = ended(run, 120.0);
    assert_eq!(summary(&run)["trace_hash"], alone["trace_hash"], "the hall changes nothing");
    until("it is off again", 20.0, || look(&place).1[0]["seen"]["mode"] == "off");

    // One is killed, and one has another key: each is named.
    let killed = more.0.first_mut().expect("others");
    signal(killed.id(), "KILL");
    killed.wait().expect("it ends");
    let at = Moment::now();
    until("it is missed", 20.0, || answering(&look(&place).1) == 9);
    let mut last = more.0.pop().expect("others");
    signal(last.id(), "INT");
    last.wait().expect("it ends");
    println!("a machine that was killed is missed after {:.1} s", at.elapsed().as_secs_f64());
    more.0.push(serves(&place, Host::A, "10.77.0.1:7451", "other"));
    let (output, machines) = look(&place);
    assert_eq!(output.status.code(), Some(1));
    let why = machines[9]["why"].as_str().unwrap_or_default();
    assert!(why.contains("10.77.0.1:7451 has another key"), "{machines:?}");
    assert!(machines[1]["silent_s"].as_f64() >= Some(1.0) && machines[1]["why"].is_null(), "{machines:?}");
}

/// A hall that is drawn again and again: its text.
struct Drawn {
    child: Child,
    said: std::path::PathBuf,
}

impl Drop for Drawn {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drawn {
    /// In a terminal that `script` makes; `None`, which is said, without it.
    fn start(place: &Place) -> Option<Drawn> {
        let said = place.at("drawn.txt");
        let line = format!("{} hall {}", control().display(), place.at("hall.toml").display());
        let mut command = place.command(Host::A, std::path::Path::new("script"));
        command.args(["--quiet", "--flush", "--command", &line]).arg(&said);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let child = command.spawn().ok()?;
        Some(Drawn { child, said })
    }

    /// The newest picture.
    fn newest(&self) -> String {
        let text = fs::read(&self.said).unwrap_or_default();
        String::from_utf8_lossy(&text).rsplit("\u{1b}[H\u{1b}[J").next().unwrap_or_default().to_owned()
    }
}

#[test]
fn a_machine_whose_cable_is_cut_is_missed_within_two_seconds_and_comes_back() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    place.serve(&[]);
    let text = format!("[hall]\nkey = \"key\"\n[[machine]]\nname = \"lathe\"\nat = \"{}\"\n", place.address);
    place.write("hall.toml", &text);
    let Some(drawn) = Drawn::start(&place) else {
        eprintln!("left out: a terminal needs `script` (util-linux)");
        return;
    };
    until("it is seen", 20.0, || drawn.newest().contains("1 machines, 0 do not answer"));
    for _ in 0..2 {
        place.cable.as_ref().expect("laid").plug(false);
        until("it is missed", SHOWS_S, || drawn.newest().contains("does not answer for"));
        place.cable.as_ref().expect("laid").plug(true);
        until("it is back", 10.0, || drawn.newest().contains("1 machines, 0 do not answer"));
    }
}
