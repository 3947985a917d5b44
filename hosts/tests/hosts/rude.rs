//! Whoever is slow, rude or many: files that take long, too many of them, clients that do not read, a flood
//! beside a stop.

use std::{
    fmt::Write as _,
    process::{Child, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    time::Duration,
};

use hosts::{
    call::call,
    message::Message,
    proof::Role,
    seal::{self, Greeting, Key, Level},
    wire::Way,
};
use protocol::{Code, CodePacket, Item, Payload as _};
use serde_json::Value;

use crate::{
    place::{Cable, Host, Place, control, ended, project, signal, summary, until, wait_s},
    refusals::{Speaker, text, waiting},
};

/// A process that is let go, and ended, with this.
struct Stopped(Child, Vec<u32>);

impl Drop for Stopped {
    fn drop(&mut self) {
        self.1.iter().for_each(|pid| signal(*pid, "CONT"));
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Whoever looks and is then stopped does not read what it asked for; the run beside it is as ever.
#[test]
fn clients_that_do_not_read_hold_nobody_up() {
    let place = waiting();
    let program = project("examples/m20x2.ngc");
    let alone = place.alone(&program, &[]);
    let entry = format!("[[machine]]\nname = \"one\"\nat = \"{}\"\n", place.address);
    place.write("hall.toml", &format!("[hall]\nkey = \"key\"\n{entry}"));
    let run = place.far(&program, &["--json", "--trace", "none", "--pace", "10"]).spawn().expect("it starts");
    until("the run has begun", 20.0, || !place.runs().is_empty());
    let mut stopped = Vec::new();
    for _ in 0..3 {
        let mut script = place.command(Host::A, std::path::Path::new("script"));
        let line = format!("{} hall {}", control().display(), place.at("hall.toml").display());
        script.args(["--quiet", "--command", &line, "/dev/null"]).stdin(Stdio::null());
        let Ok(hall) = script.stdout(Stdio::null()).stderr(Stdio::null()).spawn() else { continue };
        stopped.push(Stopped(hall, Vec::new()));
    }
    until("all of them look", 10.0, || place.links_of("hall").len() == stopped.len());
    wait_s(0.5);
    for (one, link) in stopped.iter_mut().zip(place.links_of("hall")) {
        signal(link, "STOP");
        one.1.push(link);
    }
    assert_eq!(summary(&ended(run, 60.0))["trace_hash"], alone["trace_hash"]);
}

/// Somebody with the key who takes all that anybody is told, and reads nothing of it: he is given up, and the
/// run goes on.
#[test]
fn who_listens_to_all_and_reads_nothing_ends_no_run() {
    use zenoh::Wait as _;
    let place = waiting();
    let program = project("examples/m20x2.ngc");
    let alone = place.alone(&program, &[]);
    let run = place.far(&program, &["--json", "--trace", "none", "--pace", "4"]).spawn().expect("it starts");
    until("the run has begun", 20.0, || !place.runs().is_empty());
    let key = Key::read(&place.at("key")).expect("its key");
    let net = call(&place.address, &key.gate(), Role::Operator, Duration::from_secs(10)).expect("let in");
    let way = Way::make().expect("a socket");
    let (path, given_up) = (way.path.clone(), Arc::new(AtomicBool::new(false)));
    let gone = Arc::clone(&given_up);
    way.leads(net, move || gone.store(true, Relaxed)).expect("a way");
    let mut config = zenoh::Config::default();
    for (key, value) in [
        ("mode", "\"peer\"".to_owned()),
        ("connect/endpoints", format!("[\"unixsock-stream/{}\"]", path.display())),
        ("scouting/multicast/enabled", "false".into()),
        ("scouting/gossip/enabled", "false".into()),
    ] {
        config.insert_json5(key, &value).expect("a key of it");
    }
    let session = zenoh::open(config).wait().expect("somebody");
    let (heard, hears) = std::sync::mpsc::channel();
    let subscriber = session.declare_subscriber("pitchlock/**").callback(move |_| {
        let _ = heard.send(());
        // He stands there as long as the run does.
        wait_s(12.0);
    });
    let subscriber = subscriber.wait().expect("all of it");
    let speaker = Speaker::new(&place);
    until("he has heard of something", 10.0, || hears.try_recv().is_ok());
    // Somebody else is told much: it goes to him, too.
    speaker.greets_in_vain(30_000);
    until("he is given up", 12.0, || given_up.load(Relaxed));
    let output = ended(run, 60.0);
    assert_eq!(summary(&output)["trace_hash"], alone["trace_hash"], "{}", text(&output));
    drop((subscriber, session));
}

/// All files of a run may take longer than silence may.
#[test]
fn files_that_take_longer_than_silence_may_are_waited_for() {
    let Some(cable) = Cable::lay() else { return };
    if !cable.is_slow() {
        return;
    }
    let mut place = Place::new(Some(cable));
    place.serve(&[]);
    let mut long = String::from("G18 G21 G90 G94\n");
    (0..240_000).for_each(|number| {
        let _ = writeln!(long, "(of no use but that it is long, and it is {number:08} times)");
    });
    long += "G0 X50 Z90\nM2\n";
    let program = place.write("long.ngc", &long);
    let begun = process::ipc::time::Moment::now();
    let far = place.run(&program, &[]);
    assert_eq!(far["outcome"], "completed", "{far}");
    assert!(begun.elapsed().as_secs_f64() > 2.5, "the cable was slow");
    assert_eq!(far["trace_hash"], place.alone(&program, &[])["trace_hash"]);
}

#[test]
fn a_run_of_too_many_files_is_refused() {
    let place = waiting();
    let speaker = Speaker::new(&place);
    let (_, mut sealer, mut opener) = speaker.greets();
    for number in 0..1001 {
        speaker.says(&sealer.seal(&Message::File(format!("{number}.ngc"), b"M2\n".to_vec()).bytes()));
    }
    let all = speaker.hears(&mut opener);
    let refused =
        |message: &Message| matches!(message, Message::Refused(text) if text.contains("at most 1000"));
    assert!(all.iter().any(refused), "{all:?}");
    assert!(place.runs().is_empty());
}

/// What is pressed as soon as the run is asked for is heeded when there is a machine: it moves nothing.
#[test]
fn a_press_before_the_machine_has_started_there_stops_it() {
    let place = waiting();
    let speaker = Speaker::new(&place);
    let (_, mut sealer, mut opener) = speaker.greets();
    speaker.says(&sealer.seal(&Message::File("short.ngc".into(), b"G4 P5\nM2\n".to_vec()).bytes()));
    let words = ["short.ngc", "--trace", "none"].map(str::to_owned).to_vec();
    speaker.says(&sealer.seal(&Message::Begin(words).bytes()));
    speaker.says(&sealer.seal(&Message::Press(1).bytes()));
    let items = [Item { line: 1, code: Code::Dwell { seconds: 5.0 } }, Item { line: 2, code: Code::End }];
    let read = || {
        let text = std::fs::read_to_string(place.runs().first()?.join("summary.json")).ok()?;
        serde_json::from_str::<Value>(&text).ok()
    };
    until("the run is over", 30.0, || {
        speaker.says(&sealer.seal(&Message::Beat.bytes()));
        if speaker.hears(&mut opener).contains(&Message::Go) {
            for (number, item) in (0..).zip(&items) {
                let packet = CodePacket::pack(number, item).bytes().to_vec();
                speaker.says(&sealer.seal(&Message::Code(packet).bytes()));
            }
        }
        read().is_some()
    });
    let summary = read().expect("it was there");
    assert_eq!(summary["outcome"], "stopped", "{summary}");
    assert!(summary["simulated_s"].as_f64() < Some(4.0), "it was stopped in its dwell: {summary}");
}

/// Strangers say thousands of things while Ctrl-C is on its way.
#[test]
fn a_stop_comes_through_a_flood_of_strangers() {
    let place = waiting();
    let program = project("examples/m20x2.ngc");
    let run = place.far(&program, &["--trace", "none", "--pace", "2", "--json"]).spawn().expect("it starts");
    until("the run has begun", 20.0, || {
        place.runs().first().is_some_and(|run| run.join("journal.bin").exists())
    });
    let speaker = Speaker::new(&place);
    place.make_key("other");
    let other = Key::read(&place.at("other")).expect("its key");
    let (mut sealer, _) = seal::session(&other, 1, 2, Level::Upper);
    for number in 0..6000_u32 {
        speaker.says(&sealer.seal(&Message::Press(2).bytes()));
        speaker.says(&Greeting::Hello.seal(&other, &[b'{'; 300]));
        if number == 3000 {
            signal(run.id(), "INT");
        }
    }
    let output = ended(run, 20.0);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    assert_eq!(summary(&output)["outcome"], "stopped");
}
