//! The gate: whoever has the key gets in, however many there are who have not, and however they behave; and
//! whoever does not get in is told why.

use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    process::Command,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
    time::Duration,
};

use hosts::{
    LinkError,
    call::call,
    places::{HALLS, OPERATORS},
    proof::{GREETING, Greeted, PROOF, Role, Secret, VERDICT, Verdict},
    seal::{self, Key},
    wire::Wire,
};
use process::ipc::time::Moment;
use testing::Seed;

use crate::{
    place::{Host, LINK, Place, control, until, wait_s},
    refusals::{text, waiting},
};

/// A gate in this process, with Zenoh behind it.
pub(super) struct Gate {
    pub(super) wire: Wire,
    pub(super) address: String,
    pub(super) key: Key,
    secret: Secret,
    pub(super) folder: tempfile::TempDir,
}

impl Gate {
    pub(super) fn open() -> Gate {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key");
        Key::make(&path).expect("made");
        let key = Key::read(&path).expect("its own");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("a port").to_string();
        let wire = Wire::behind_a_gate(listener, &key, folder.path()).expect("a wire");
        Gate { wire, address, secret: key.gate(), key, folder }
    }

    /// Somebody calls as this.
    fn calls(&self, role: Role) -> Result<TcpStream, LinkError> {
        call(&self.address, &self.secret, role, Duration::from_secs(1))
    }

    /// Somebody connects, and has been greeted.
    fn greeted(&self) -> (TcpStream, [u8; GREETING]) {
        let mut stream = TcpStream::connect(&self.address).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(10))).expect("its own");
        let mut greeting = [0; GREETING];
        stream.read_exact(&mut greeting).expect("a greeting");
        (stream, greeting)
    }
}

/// A proof for this greeting.
fn proof(greeting: &[u8; GREETING], role: Role, secret: &Secret) -> (Greeted, [u8; PROOF]) {
    let own = seal::nonce().expect("a number").to_le_bytes();
    let greeted = Greeted::by(greeting, own).expect("a machine");
    let proof = greeted.proof(role, secret);
    (greeted, proof)
}

/// What the machine says last; `None` if it says nothing more.
fn verdict(stream: &mut TcpStream, greeted: &Greeted, secret: &Secret) -> Option<Verdict> {
    let mut bytes = [0; VERDICT];
    stream.read_exact(&mut bytes).ok()?;
    greeted.verdict(&bytes, secret)
}

/// A hundred who say nothing: each goes soon, and whoever has the key gets in beside them, and again.
#[test]
fn a_hundred_silent_strangers_keep_no_operator_out() {
    let gate = Gate::open();
    let silent: Vec<_> = (0..100).map(|_| TcpStream::connect(&gate.address).expect("a connection")).collect();
    for _ in 0..20 {
        drop(gate.calls(Role::Operator).expect("let in"));
    }
    // The last sixteen are heard out for 2 s, and no longer.
    until("each of them is gone", 10.0, || gate.wire.refused() == 100);
    for mut stream in silent {
        stream.set_read_timeout(Some(Duration::from_secs(10))).expect("its own");
        let mut all = Vec::new();
        let read = stream.read_to_end(&mut all);
        assert!(all.len() >= GREETING && all.len() <= GREETING + VERDICT, "{read:?}: {all:?}");
    }
}

/// Strangers who come again and again, as fast as they can, from the same address: the gate is still a gate.
#[test]
fn a_flood_of_connections_keeps_no_operator_out() {
    let gate = Gate::open();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut last = Vec::new();
            while !over.load(Relaxed) {
                last.extend(TcpStream::connect(&gate.address));
                if last.len() > 200 {
                    last.clear();
                }
            }
        });
        wait_s(0.2);
        let all: Vec<_> = (0..5)
            .map(|_| call(&gate.address, &gate.secret, Role::Operator, Duration::from_secs(20)))
            .collect();
        over.store(true, Relaxed);
        assert!(all.iter().all(Result::is_ok), "{all:?}");
    });
    assert!(gate.wire.refused() > 100, "{} were there", gate.wire.refused());
}

/// Twenty halls get the sixteen places of halls; operators have their own, of which halls get none.
#[test]
fn twenty_halls_keep_no_operator_out_and_are_told_that_all_places_are_taken() {
    let gate = Gate::open();
    let all: Vec<_> = (0..20).map(|_| gate.calls(Role::Hall)).collect();
    let (halls, others): (Vec<_>, Vec<_>) = all.into_iter().partition(Result::is_ok);
    assert_eq!((halls.len(), others.len()), (HALLS, 4));
    for other in others {
        let error = other.expect_err("not let in");
        assert!(error.to_string().contains("all places for halls"), "{error}");
        assert!(matches!(error, LinkError::Refused(_)), "{error:?}");
    }
    let mut operators: Vec<_> = (0..OPERATORS).map(|_| gate.calls(Role::Operator).expect("let in")).collect();
    let error = gate.calls(Role::Operator).expect_err("one too many");
    assert!(error.to_string().contains("all places for operators"), "{error}");
    // Whoever goes leaves his place to the next one.
    drop(operators.pop());
    call(&gate.address, &gate.secret, Role::Operator, Duration::from_secs(10)).expect("let in");
    drop(halls);
    call(&gate.address, &gate.secret, Role::Hall, Duration::from_secs(10)).expect("let in");
}

#[test]
fn another_key_and_a_proof_that_was_there_before_are_refused_and_told() {
    let gate = Gate::open();
    let mut other = gate.secret;
    other[31] ^= 1;
    let error = call(&gate.address, &other, Role::Operator, Duration::from_secs(5)).expect_err("not let in");
    assert!(error.to_string().contains("has another key\nhelp: "), "{error}");
    // A proof that was good is said again.
    let (mut stream, greeting) = gate.greeted();
    let (greeted, good) = proof(&greeting, Role::Operator, &gate.secret);
    stream.write_all(&good).expect("said");
    assert_eq!(verdict(&mut stream, &greeted, &gate.secret), Some(Verdict::Welcome));
    let (mut again, _) = gate.greeted();
    again.write_all(&good).expect("said");
    assert_eq!(verdict(&mut again, &greeted, &gate.secret), Some(Verdict::OtherKey));
    assert_eq!(gate.wire.refused(), 2);
}

/// Bytes one after the other: in time they are a proof, and else there is no more than 2 s for them.
#[test]
fn slow_bytes_are_a_proof_if_they_come_in_time() {
    let gate = Gate::open();
    let (mut stream, greeting) = gate.greeted();
    let (greeted, good) = proof(&greeting, Role::Hall, &gate.secret);
    for byte in good {
        stream.write_all(&[byte]).expect("said");
        wait_s(0.01);
    }
    assert_eq!(verdict(&mut stream, &greeted, &gate.secret), Some(Verdict::Welcome));
    let (mut stream, greeting) = gate.greeted();
    let (greeted, good) = proof(&greeting, Role::Hall, &gate.secret);
    let begun = Moment::now();
    // He would need five seconds: the gate ends it, whoever writes.
    let said = good.iter().take_while(|byte| {
        wait_s(0.1);
        stream.write_all(&[**byte]).is_ok()
    });
    assert!(said.count() < PROOF && begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    assert_ne!(verdict(&mut stream, &greeted, &gate.secret), Some(Verdict::Welcome));
}

#[test]
fn random_bytes_are_nobody_and_the_gate_goes_on() {
    let gate = Gate::open();
    let mut seed = Seed::new(63);
    for number in 0..200 {
        let (mut stream, _) = gate.greeted();
        let first = [b'O', b'H', b'G', 0][number % 4];
        let mut bytes: Vec<u8> = (0..seed.below(3 * PROOF)).map(|_| seed.below(256) as u8).collect();
        bytes.iter_mut().take(1).for_each(|byte| *byte = first);
        // He may be gone while this is said.
        let _ = stream.write_all(&bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let mut all = Vec::new();
        let _ = stream.read_to_end(&mut all);
        assert!(all.first() != Some(&b'W') && all.len() <= VERDICT, "{all:?}");
    }
    assert_eq!(gate.wire.refused(), 200);
    drop(gate.calls(Role::Operator).expect("let in"));
}

/// What `pitchlock run --at` says of whoever does not let it in.
#[test]
fn who_is_not_let_in_is_told_why_before_anything_moves() {
    let place = Place::new(None);
    let program = place.write("short.ngc", "G21 G90\nG0 X50\nM2\n");
    let run = |place: &Place| {
        let output = place.far(&program, &[]).output().expect("it starts");
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        text(&output)
    };
    // Somebody else listens there, who speaks first, and one who says nothing.
    let listener = TcpListener::bind(&place.address).expect("its address");
    let speaks = std::thread::Builder::new().spawn(move || {
        let (mut stream, _) = listener.accept().expect("a caller");
        stream.write_all(b"220 mail.example.com ESMTP, and what else it says\r\n").expect("said");
        listener
    });
    let speaks = speaks.expect("a thread");
    let said = run(&place);
    assert!(said.contains("is not a pitchlock") && said.contains("help: "), "{said}");
    let _silent = speaks.join().expect("it spoke");
    let said = run(&place);
    assert!(said.contains("says nothing") && said.contains("help: "), "{said}");
    let said = {
        let mut command = place.command(Host::A, &control());
        command.arg("run").arg(&program).args(["--at", "nowhere", "--key"]).arg(place.at("key"));
        text(&command.output().expect("it starts"))
    };
    assert!(said.contains("nowhere") && said.contains("HOST:PORT"), "{said}");
    assert!(place.is_clean(Host::A), "nothing is left");
}

/// All places are taken by halls that do nothing; a program is run beside them, and a ninth operator is told.
#[test]
fn a_program_is_run_beside_all_the_halls_there_may_be() {
    let place = waiting();
    let key = Key::read(&place.at("key")).expect("its key");
    let calls = |role| call(&place.address, &key.gate(), role, Duration::from_secs(5));
    let _strangers: Vec<_> = (0..100).map(|_| TcpStream::connect(&place.address)).collect();
    let _halls: Vec<_> = (0..HALLS).map(|_| calls(Role::Hall).expect("let in")).collect();
    assert_eq!(place.run(&place.at("short.ngc"), &[])["outcome"], "completed");
    let mut ping = Command::new(LINK);
    ping.args(["ping", "--count", "1", "--control", "0", "--machine", "0", "--at", &place.address]);
    ping.arg("--key").arg(place.at("key"));
    let _operators: Vec<_> = (0..OPERATORS).map(|_| calls(Role::Operator).expect("let in")).collect();
    let output = ping.output().expect("it starts");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("all places for operators"), "{}", text(&output));
}
