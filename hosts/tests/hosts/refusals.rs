//! Who is not let in, and why: each difference by its name, before anything moves.

use hosts::{
    call::call,
    hello::{Answer, Hello, Identity, Verdict, Wants, hex, of_hex, opened, sealed},
    message::Message,
    proof::Role,
    seal::{self, Greeting, Key, Level, Opener, Sealer},
    wire::{Event, Wire},
};
use process::ipc::time::Moment;
use std::{
    net::TcpStream,
    process::{Command, Output, Stdio},
    time::Duration,
};

use crate::place::{Host, LINK, Place, control, ended, project, signal, summary, until, wait_s};

const SHORT: &str = "G18 G21 G90 G94\nG0 X50 Z90\nG1 X49 F600\nM2\n";

pub(crate) fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// A machine that waits, a short program, and the hash of the machine file.
pub(crate) fn waiting() -> Place {
    let mut place = Place::new(None);
    place.write("short.ngc", SHORT);
    place.serve(&[]);
    place
}

/// The machine has not moved, and takes a run as before.
fn works_as_before(place: &Place, runs: usize) {
    assert_eq!(place.runs().len(), runs, "nothing has moved");
    let after = place.run(&place.at("short.ngc"), &[]);
    assert_eq!(after["outcome"], "completed");
}

#[test]
fn another_machine_file_is_refused_before_anything_moves() {
    let place = waiting();
    let machine = project("examples/machines/small-mill.toml").display().to_string();
    let program = place.write("mill.ngc", "G21 G90\nG0 X1\nM2\n");
    let output = place.far(&program, &["--machine", &machine]).output().expect("it starts");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("the machine file differs"), "{}", text(&output));
    works_as_before(&place, 0);
}

#[test]
fn another_version_is_refused_before_anything_moves() {
    let place = waiting();
    let machine = machine_hash(&place);
    let upper = |version: &str| {
        let mut link = Command::new(LINK);
        link.args([
            "ping",
            "--count",
            "1",
            "--at",
            &place.address,
            "--control",
            version,
            "--machine",
            &machine,
        ]);
        link.arg("--key").arg(place.at("key")).output().expect("it starts")
    };
    let output = upper("9.9.9");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("the version differs: 0.1.0 there, 9.9.9 here"), "{}", text(&output));
    let output = upper(env!("CARGO_PKG_VERSION"));
    assert!(output.status.success(), "{}", text(&output));
    works_as_before(&place, 0);
}

#[test]
fn another_key_is_refused_before_anything_moves() {
    let place = waiting();
    place.make_key("other");
    let mut command = place.command(Host::A, &control());
    command
        .arg("run")
        .arg(place.at("short.ngc"))
        .args(["--at", &place.address, "--key"])
        .arg(place.at("other"));
    let output = command.output().expect("it starts");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("has another key"), "{}", text(&output));
    works_as_before(&place, 0);
}

#[test]
fn nobody_at_the_address_is_said_with_the_remedy() {
    let place = Place::new(None);
    let program = place.write("short.ngc", SHORT);
    let output = place.far(&program, &[]).output().expect("it starts");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(
        text(&output).contains("nobody answers at") && text(&output).contains("pitchlock serve"),
        "{}",
        text(&output)
    );
    assert!(place.is_clean(Host::A), "nothing is left");
}

/// The hash of the machine file that this machine has, as a greeting says it.
fn machine_hash(place: &Place) -> String {
    let mut command = place.command(Host::A, &control());
    let text = command.arg("machine").output().expect("it starts").stdout;
    blake3::hash(&text).to_hex().to_string()
}

/// Somebody who speaks as the upper level does, byte by byte.
pub(crate) struct Speaker {
    wire: Wire,
    key: Key,
    machine: String,
}

impl Speaker {
    pub(crate) fn new(place: &Place) -> Speaker {
        let key = Key::read(&place.at("key")).expect("its key");
        let mut wire = Wire::that_calls().expect("a wire");
        let net = call(&place.address, &key.gate(), Role::Operator, Duration::from_secs(10)).expect("let in");
        wire.over(net).expect("a wire");
        Speaker { wire, key, machine: machine_hash(place) }
    }

    /// A greeting, and the session that it opens.
    pub(crate) fn greets(&self) -> (Vec<u8>, Sealer, Opener) {
        let own = seal::nonce().expect("a number");
        let identity = Identity::here(env!("CARGO_PKG_VERSION"), &self.machine);
        let (nonce, back) = (hex(own), hex(self.wire.name));
        let hello = Hello { nonce, back, wants: Wants::Run, identity };
        let greeting = sealed(Greeting::Hello, &self.key, &hello).expect("sealed");
        let deadline = Moment::in_s(10.0);
        loop {
            assert!(!deadline.passed(), "nobody answers");
            self.says(&greeting);
            let Some(Event::Frame(bytes)) = self.wire.wait(Duration::from_millis(100)) else {
                continue;
            };
            let answer = opened::<Answer>(Greeting::Answer, &self.key, &bytes);
            let Some(answer) = answer.filter(|answer| answer.of == hello.nonce) else { continue };
            assert_eq!(answer.verdict, Verdict::Welcome);
            let theirs = of_hex(&answer.nonce).expect("a number");
            let (sealer, opener) = seal::session(&self.key, own, theirs, Level::Upper);
            return (greeting, sealer, opener);
        }
    }

    /// Greets so often while a run of somebody else is on, and reads no answer.
    pub(crate) fn greets_in_vain(&self, number: usize) {
        for _ in 0..number {
            let (nonce, back) = (hex(seal::nonce().expect("a number")), hex(self.wire.name));
            let identity = Identity::here(env!("CARGO_PKG_VERSION"), &self.machine);
            let hello = Hello { nonce, back, wants: Wants::Run, identity };
            self.says(&sealed(Greeting::Hello, &self.key, &hello).expect("sealed"));
        }
    }

    pub(crate) fn says(&self, bytes: &[u8]) {
        self.wire.mouth().say(bytes.to_vec()).expect("said");
    }

    /// What comes back in a session within half a second.
    pub(crate) fn hears(&self, opener: &mut Opener) -> Vec<Message> {
        let (deadline, mut all) = (Moment::in_s(0.5), Vec::new());
        while !deadline.passed() {
            if let Some(Event::Frame(bytes)) = self.wire.wait(Duration::from_millis(50))
                && let Ok(body) = opener.open(&bytes)
            {
                all.extend(Message::of(body).filter(|message| *message != Message::Beat));
            }
        }
        all
    }
}

/// What was recorded says nothing: neither twice in its session, nor in another one, nor behind a greeting
/// that was recorded, too.
#[test]
fn what_was_there_before_is_not_taken_again() {
    let place = waiting();
    let speaker = Speaker::new(&place);
    let (greeting, mut sealer, mut opener) = speaker.greets();
    let ping = sealer.seal(&Message::Ping(vec![7; 8]).bytes());
    speaker.says(&ping);
    assert_eq!(speaker.hears(&mut opener), [Message::Pong(vec![7; 8])]);
    speaker.says(&ping);
    assert_eq!(speaker.hears(&mut opener), [], "a message that was there before");
    // All of a run, but its last word was never said: in its own session it would begin.
    let file = sealer.seal(&Message::File("short.ngc".into(), SHORT.into()).bytes());
    let begin = sealer.seal(&Message::Begin(vec!["short.ngc".into()]).bytes());
    // Four others that have spoken push that session out; what is recorded of it is nobody's then.
    let mut last = None;
    for _ in 0..4 {
        let (greeting, mut sealer, opener) = speaker.greets();
        speaker.says(&sealer.seal(&Message::Ping(vec![8; 8]).bytes()));
        last = Some((greeting, sealer, opener));
    }
    for bytes in [&greeting, &file, &begin, &file, &begin] {
        speaker.says(bytes);
    }
    wait_s(0.5);
    let (_, mut sealer, mut opener) = last.expect("four");
    // Greetings alone, said again and again, push nobody out who has spoken.
    (0..20).for_each(|_| speaker.says(&greeting));
    // The machine lives, and has begun nothing.
    speaker.says(&sealer.seal(&Message::Ping(vec![9; 8]).bytes()));
    assert!(speaker.hears(&mut opener).contains(&Message::Pong(vec![9; 8])));
    drop(speaker);
    works_as_before(&place, 0);
}

/// Bytes of strangers change nothing in a run that is on.
#[test]
fn strangers_change_nothing_in_a_run_and_are_counted() {
    let place = waiting();
    let program = project("examples/m20x2.ngc");
    let alone = place.alone(&program, &[]);
    let child =
        place.far(&program, &["--json", "--trace", "none", "--pace", "20"]).spawn().expect("it starts");
    until("the run has begun", 20.0, || !place.runs().is_empty());
    let speaker = Speaker::new(&place);
    let other = {
        place.make_key("other");
        Key::read(&place.at("other")).expect("its key")
    };
    let (mut sealer, _) = seal::session(&other, 1, 2, Level::Upper);
    for number in 0..50u8 {
        speaker.says(&sealer.seal(&Message::Press(2).bytes()));
        speaker.says(&Greeting::Hello.seal(&other, b"{}"));
        speaker.says(&vec![number; usize::from(number) * 7]);
        drop(TcpStream::connect(&place.address));
        wait_s(0.01);
    }
    let output = ended(child, 60.0);
    assert_eq!(summary(&output)["trace_hash"], alone["trace_hash"]);
    until("strangers are told", 5.0, || place.said().contains("at the gate: 50 who have not the key"));
}

/// Two at once: the second is told that the machine is busy. And Ctrl-C where the program is stops the
/// machine.
#[test]
fn a_machine_that_runs_refuses_another_program_and_ctrl_c_stops_it_from_far() {
    let place = waiting();
    let mut first = place.far(&project("examples/m20x2.ngc"), &["--trace", "none", "--pace", "2", "--json"]);
    let first = first.stderr(Stdio::piped()).spawn().expect("it starts");
    until("the run has begun", 20.0, || {
        place.runs().first().is_some_and(|run| run.join("journal.bin").exists())
    });
    let second = place.far(&place.at("short.ngc"), &[]).output().expect("it starts");
    assert_eq!(second.status.code(), Some(2), "{}", text(&second));
    assert!(text(&second).contains("runs another program"), "{}", text(&second));
    wait_s(0.5);
    signal(first.id(), "INT");
    let output = ended(first, 20.0);
    let summary = summary(&output);
    assert_eq!(
        (output.status.code(), &summary["outcome"]),
        (Some(1), &"stopped".into()),
        "{}",
        text(&output)
    );
    works_as_before(&place, 1);
}

/// What is pressed before there is a machine to hear it ends the run here, and nothing moves there.
#[test]
fn a_stop_before_the_machine_has_started_moves_nothing() {
    let place = waiting();
    let links = place.links(Host::B);
    links.iter().for_each(|link| signal(*link, "STOP"));
    let mut run = place.far(&place.at("short.ngc"), &["--trace", "none"]);
    let run = run.stderr(Stdio::piped()).spawn().expect("it starts");
    wait_s(1.0);
    signal(run.id(), "INT");
    let output = ended(run, 20.0);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    assert!(text(&output).contains("interrupted while the machine was starting"), "{}", text(&output));
    links.iter().for_each(|link| signal(*link, "CONT"));
    wait_s(1.0);
    assert!(place.runs().is_empty(), "{:?}", place.runs());
    works_as_before(&place, 0);
}
