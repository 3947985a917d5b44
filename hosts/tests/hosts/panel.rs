//! The panel on host A, the machine on host B: what is seen and pressed, what is left when either is gone.

use std::{
    fs,
    process::{Child, Stdio},
};

use serde_json::{Value, json};

use crate::{
    hall::look,
    place::{Cable, Host, Place, control, ended, project, signal, summary, until, wait_s},
    relay::Relay,
};

/// A panel on host A.
struct Panel {
    launcher: Option<Child>,
    relay: Relay,
    address: String,
    token: String,
}

impl Drop for Panel {
    fn drop(&mut self) {
        if let Some(mut launcher) = self.launcher.take() {
            let _ = launcher.kill();
            let _ = launcher.wait();
        }
    }
}

impl Panel {
    fn start(place: &Place, arguments: &[&str]) -> Panel {
        let said = place.at("panel.txt");
        let mut command = place.command(Host::A, &control());
        command.arg("panel").args(arguments).args(["--at", &place.address, "--key"]).arg(place.at("key"));
        command.stdout(Stdio::null()).stderr(fs::File::create(&said).expect("a file"));
        let launcher = command.spawn().expect("it starts");
        let read = || fs::read_to_string(&said).unwrap_or_default();
        until("the panel is there", 20.0, || read().contains("panel: http://"));
        let text = read();
        let line = text.lines().find_map(|line| line.strip_prefix("panel: http://")).expect("an address");
        let (address, token) = line.split_once("/#").expect("a secret");
        let (address, token) = (address.to_owned(), token.to_owned());
        Panel { launcher: Some(launcher), relay: Relay::start(place), address, token }
    }

    /// One at which m20x2 was started, at this pace, and cuts.
    fn in_a_pass(place: &Place, pace: &str) -> Panel {
        let program = project("examples/m20x2.ngc").display().to_string();
        let panel = Panel::start(place, &[&program, "--pace", pace, "--trace", "none"]);
        panel.press("take-seat", Value::Null);
        panel.press("start", Value::Null);
        until("a pass is seen", 60.0, || panel.state()["passes"][0]["pass"] == 1);
        panel
    }

    fn request(&self, line: &str, body: &str) -> Value {
        let (address, token) = (&self.address, &self.token);
        let head = format!("{line} HTTP/1.1\r\nHost: {address}\r\nAuthorization: Bearer {token}\r\n");
        let kind = format!("Content-Type: application/json\r\nContent-Length: {}\r\n\r\n", body.len());
        let answer = self.relay.asks(address, &(head + &kind + body));
        let text = String::from_utf8_lossy(&answer);
        let body = text.split_once("\r\n\r\n").map_or("", |(_, body)| body);
        serde_json::from_str(body).unwrap_or(Value::Null)
    }

    fn state(&self) -> Value {
        self.request("GET /api/state", "")
    }

    /// Presses; in which cycle that was.
    fn press(&self, word: &str, value: Value) -> u64 {
        let answer = self.ask(word, value);
        answer["cycle"].as_u64().unwrap_or_else(|| panic!("{word}: {answer}"))
    }

    fn ask(&self, word: &str, value: Value) -> Value {
        self.request("POST /api/do", &json!({ "id": 1, "do": word, "as": "a", "value": value }).to_string())
    }

    fn is(&self, mode: &str) {
        until(mode, 60.0, || self.state()["mode"] == mode);
    }

    /// Ctrl-C ends it.
    fn ends(&mut self, place: &Place) {
        let launcher = self.launcher.take().expect("it is there");
        signal(launcher.id(), "INT");
        let status = ended(launcher, 20.0).status;
        let said = fs::read_to_string(place.at("panel.txt")).expect("words");
        assert!(status.success(), "{status}: {said}; at the machine: {}", place.said());
    }
}

/// Whoever stands there hears why it is over.
#[test]
fn a_machine_that_is_told_to_end_ends_the_panel_from_far() {
    let mut place = Place::new(None);
    place.serve(&[]);
    let mut panel = Panel::in_a_pass(&place, "2");
    place.signal_serve("TERM");
    assert_eq!(ended(panel.launcher.take().expect("it is there"), 20.0).status.code(), Some(1));
    let said = fs::read_to_string(place.at("panel.txt")).expect("words");
    assert!(said.contains("was told to end"), "{said}");
    assert_eq!(place.serve_ends(20.0), Some(0), "{}", place.said());
    assert_eq!(summary_of(&place, 0)["outcome"], "stopped");
    assert!(place.links(Host::B).is_empty() && place.is_clean(Host::B));
}

/// The summary of a run on host B, when it is there.
fn summary_of(place: &Place, number: usize) -> Value {
    let read = || {
        let text = fs::read_to_string(place.runs().get(number)?.join("summary.json")).ok()?;
        serde_json::from_str::<Value>(&text).ok()
    };
    until("the run is summed up", 30.0, || read().is_some());
    read().expect("it was there")
}

/// The hash of a run of host B that is repeated from its folder.
fn repeated(place: &Place, number: usize) -> Value {
    let mut command = place.command(Host::B, &control());
    command.arg("run").arg(&place.runs()[number]).args(["--in-process", "--json", "--trace", "none"]);
    let output = command.args(["--out", "again"]).output().expect("it starts");
    let _ = fs::remove_dir_all(place.at("b/again"));
    summary(&output)["trace_hash"].clone()
}

#[test]
fn a_program_that_is_started_and_operated_from_far_is_the_same_and_is_repeated() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    let program = project("examples/m20x2.ngc");
    let alone = place.alone(&program, &[]);
    place.serve(&[]);
    let name = program.display().to_string();
    let mut panel = Panel::start(&place, &[&name, "--pace", "20", "--trace", "none"]);
    until("the machine is seen", 10.0, || panel.state()["program"]["name"] == "m20x2.ngc");
    let seen = panel.state();
    assert_eq!((&seen["mode"], &seen["program"]["name"]), (&"off".into(), &"m20x2.ngc".into()), "{seen}");
    panel.press("take-seat", Value::Null);
    // Nothing is pressed but start: the same numbers as without a panel.
    panel.press("start", Value::Null);
    panel.is("auto");
    until("a pass is seen", 60.0, || panel.state()["passes"][0]["pass"] == 1);
    panel.is("off");
    assert_eq!(summary_of(&place, 0)["trace_hash"], alone["trace_hash"]);
    // Presses have their cycle, and are repeated.
    panel.press("start", Value::Null);
    panel.is("auto");
    until("it moves", 60.0, || panel.state()["passes"][0]["pass"] == 1);
    let turned = panel.press("spindle-override", json!(80));
    let held = panel.press("hold", Value::Null);
    assert!(0 < turned && turned < held, "{turned} {held}");
    panel.is("held");
    assert_eq!(panel.state()["knobs"]["spindle_pct"].as_f64(), Some(80.0), "{}", panel.state());
    panel.press("start", Value::Null);
    panel.is("off");
    let second = summary_of(&place, 1);
    assert_eq!(second["outcome"], "completed");
    assert_ne!(second["trace_hash"], alone["trace_hash"]);
    assert_eq!(repeated(&place, 1), second["trace_hash"], "the session is repeated bit for bit");
    panel.ends(&place);
    assert!(place.is_clean(Host::A));
    until("the machine waits again", 5.0, || !place.links(Host::B).is_empty());
    assert_eq!(place.run(&program, &[])["trace_hash"], alone["trace_hash"]);
}

#[test]
fn work_by_hand_from_far_survives_its_page_and_is_repeated() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    place.serve(&[]);
    let mut panel = Panel::start(&place, &["--pace", "20", "--trace", "none"]);
    panel.press("take-seat", Value::Null);
    panel.press("by-hand", Value::Null);
    panel.is("ready");
    panel.press("mdi", json!("G21 G91 G0 Z-12.5"));
    panel.is("ready");
    // A hall sees that somebody stands there.
    let entry = format!("[[machine]]\nname = \"one\"\nat = \"{}\"\n", place.address);
    place.write("hall.toml", &format!("[hall]\nkey = \"key\"\n{entry}"));
    until("the hall sees it", 10.0, || {
        let seen = look(&place).1[0]["seen"].clone();
        seen["mode"] == "ready" && seen["panel"] == true && seen["time_s"].as_f64() > Some(0.0)
    });
    assert_eq!(panel.ask("mdi", json!("G1 X"))["refused"], "bad-block");
    panel.press("jog", json!({ "axis": "X", "mm_min": 1200, "step_mm": -1.5 }));
    panel.is("ready");
    // The process of the page is killed: another one knows all that is seen, and the machine stayed on.
    let server = |end: &str| {
        let launcher = panel.launcher.as_ref().expect("it is there").id();
        let all =
            fs::read_to_string(format!("/proc/{launcher}/task/{launcher}/children")).unwrap_or_default();
        let of =
            |pid: &str| fs::read_to_string(format!("/proc/{pid}/cmdline")).is_ok_and(|l| l.contains(end));
        all.split(' ').find(|pid| !pid.is_empty() && of(pid)).and_then(|pid| pid.parse::<u32>().ok())
    };
    let first = server("panel-server").expect("a server");
    signal(first, "KILL");
    until("another page is there", 10.0, || {
        server("panel-server").is_some_and(|now| now != first) && panel.state()["mode"] == "ready"
    });
    assert!(panel.state()["machine"]["name"].is_string(), "{}", panel.state());
    panel.press("take-seat", Value::Null);
    panel.press("spindle", json!(300));
    panel.is("ready");
    panel.press("abort", Value::Null);
    panel.is("off");
    let summary = summary_of(&place, 0);
    assert_eq!(summary["faults"], json!([]));
    assert_eq!(repeated(&place, 0), summary["trace_hash"]);
    panel.ends(&place);
}

/// Control cycles in which Z moves, of a trace with every cycle.
fn moving(place: &Place, run: usize) -> Vec<u64> {
    let text = fs::read_to_string(place.runs()[run].join("trace.csv")).expect("a trace");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let columns: Vec<_> = lines.next().expect("a head").split(',').collect();
    let column = columns.iter().position(|name| name.starts_with("z_velocity")).expect("a column of Z");
    let speed = |line: &str| line.split(',').nth(column).and_then(|cell| cell.parse::<f64>().ok());
    let moves = lines.enumerate().filter(|(_, line)| speed(line).is_some_and(|speed| speed != 0.0));
    moves.map(|(cycle, _)| cycle as u64).collect()
}

/// From the last sign of the key on an axis stands within so many cycles: 150 ms.
const STANDS: u64 = 300;

#[test]
fn a_cable_that_is_cut_in_a_jog_brings_the_axis_to_rest_in_150_ms() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    place.serve(&[]);
    let cable = || place.cable.as_ref().expect("laid");
    let mut panel = Panel::start(&place, &["--pace", "1", "--trace", "full-csv"]);
    panel.press("take-seat", Value::Null);
    panel.press("by-hand", Value::Null);
    panel.is("ready");
    panel.press("jog", json!({ "axis": "Z", "mm_min": 900, "way": "-" }));
    let mut last = 0;
    for _ in 0..30 {
        last = panel.ask("jog-on", Value::Null)["cycle"].as_u64().unwrap_or(last);
    }
    cable().plug(false);
    let output = ended(panel.launcher.take().expect("it is there"), 6.0);
    assert_eq!(output.status.code(), Some(1));
    let said = fs::read_to_string(place.at("panel.txt")).expect("words");
    assert!(said.contains("is lost: nothing was heard of the other host"), "{said}");
    let summary = summary_of(&place, 0);
    assert_eq!((&summary["outcome"], &summary["faults"]), (&"stopped".into(), &json!([])), "{summary}");
    until("host B is clean", 5.0, || place.is_clean(Host::B));
    let moving = moving(&place, 0);
    assert!(last > 0 && moving.contains(&last), "the axis moved when the cable was cut, in {last}");
    let stands = moving.iter().max().expect("it moved") + 1;
    assert!(stands <= last + STANDS, "its last sign was in {last}, and it stands from {stands} on");
    cable().plug(true);
    until("the machine waits again", 5.0, || !place.links(Host::B).is_empty());
    let program = project("examples/m20x2.ngc");
    assert_eq!(place.run(&program, &[])["trace_hash"], place.alone(&program, &[])["trace_hash"]);
}

/// While it is pulled states and rows of the scope wait, and what does not fit is left out; nobody is given
/// up.
#[test]
fn a_cable_that_is_pulled_for_a_second_is_not_noticed() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    let program = project("examples/m20x2.ngc");
    let alone = place.alone(&program, &[]);
    place.serve(&[]);
    let mut panel = Panel::in_a_pass(&place, "8");
    for _ in 0..2 {
        place.cable.as_ref().expect("laid").plug(false);
        wait_s(1.0);
        place.cable.as_ref().expect("laid").plug(true);
        let cycle = panel.state()["cycle"].as_u64();
        until("it is seen to go on", 20.0, || panel.state()["cycle"].as_u64() > cycle);
    }
    panel.is("off");
    assert_eq!(summary_of(&place, 0)["trace_hash"], alone["trace_hash"]);
    panel.ends(&place);
}

#[test]
fn whoever_stands_there_is_killed_in_a_program_and_the_machine_comes_to_rest() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    place.serve(&[]);
    let program = project("examples/m20x2.ngc");
    let mut panel = Panel::in_a_pass(&place, "2");
    // Two at once: the second one is told that the machine is somebody's.
    let second = place.far(&program, &[]).output().expect("it starts");
    let text = String::from_utf8_lossy(&second.stderr).into_owned();
    assert!(second.status.code() == Some(2) && text.contains("somebody stands at it"), "{text}");
    let launcher = panel.launcher.take().expect("it is there");
    signal(launcher.id(), "KILL");
    ended(launcher, 5.0);
    let summary = summary_of(&place, 0);
    assert_eq!((&summary["outcome"], &summary["faults"]), (&"stopped".into(), &json!([])), "{summary}");
    until("the machine waits again", 10.0, || !place.links(Host::B).is_empty());
    assert!(place.said().contains("the link to the panel was lost"), "{}", place.said());
}

/// Nobody reaches the machine by it, so it is as if nobody stood there.
#[test]
fn a_link_that_is_stopped_at_the_machine_in_a_program_brings_it_to_rest() {
    let mut place = Place::new(None);
    place.serve(&[]);
    let mut panel = Panel::in_a_pass(&place, "2");
    let links = place.links(Host::B);
    links.iter().for_each(|link| signal(*link, "STOP"));
    assert_eq!(ended(panel.launcher.take().expect("it is there"), 15.0).status.code(), Some(1));
    let summary = summary_of(&place, 0);
    assert_eq!((&summary["outcome"], &summary["faults"]), (&"stopped".into(), &json!([])), "{summary}");
    until("the machine waits again", 10.0, || {
        let now = place.links(Host::B);
        !now.is_empty() && now != links
    });
    assert!(place.said().contains("pitchlock-link here does not answer any more"), "{}", place.said());
}

#[test]
fn what_is_not_for_the_machine_of_another_computer_is_refused_with_the_remedy() {
    let place = Place::new(None);
    place.write("part.ngc", "G21\nM2\n");
    for (arguments, what) in [
        (&["panel", "part.ngc", "--tools", "t.tbl"][..], "the machine has its own"),
        (&["panel", "part.ngc", "--out", "runs/a"], "run folders are made by `pitchlock serve`"),
        (&["panel", "--in-process"], "leave it out"),
        (&["run", "part.ngc", "--resume"], "go on with it there: its run folder is on that computer"),
        (&["run", "part.ngc", "--from", "2", "--dry-run"], "leave it out"),
        (&["run", "part.ngc", "--panel"], "pitchlock panel PROGRAM --at"),
    ] {
        let mut command = place.command(Host::A, &control());
        command.current_dir(place.at("")).args(arguments).args(["--at", &place.address, "--key", "key"]);
        let output = command.output().expect("it starts");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && text.contains(what), "{arguments:?}: {text}");
    }
}

/// Who stands there hears why the machine is gone.
#[test]
fn a_launcher_of_a_panel_that_is_killed_there_is_told_here() {
    let mut place = Place::new(None);
    place.serve(&[]);
    let mut panel = Panel::start(&place, &[]);
    let launchers = place.processes(|words| words.contains(&"--there"));
    assert_eq!(launchers.len(), 1, "the launcher of the panel");
    signal(launchers[0], "KILL");
    let output = ended(panel.launcher.take().expect("it runs"), 10.0);
    let said = fs::read_to_string(place.at("panel.txt")).unwrap_or_default();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("the panel ended: signal: 9"), "{said}");
}
