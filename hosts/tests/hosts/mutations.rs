//! Any bytes at the door: what nobody with the key has sealed changes nothing, and what somebody with it has
//! sealed breaks nothing.

use std::time::Duration;

use hosts::{
    call::call,
    door::Door,
    hello::{Answer, Hello, Identity, Verdict, Wants, hex, of_hex, opened, sealed},
    message::Message,
    proof::Role,
    seal::{self, Greeting, Key, Level, Sealer},
    wire::{Event, Wire},
};
use protocol::Credit;
use testing::{Seed, count};

use crate::gate::Gate;

/// Mutations, unless `PITCHLOCK_MUTATIONS` says otherwise.
const MUTATIONS: u64 = 5000;

/// Other bytes than these: some are changed, left out, doubled, put in, or taken from others.
fn mutated(from: &[u8], others: &[Vec<u8>], seed: &mut Seed) -> Vec<u8> {
    let mut bytes = from.to_vec();
    for _ in 0..=seed.below(3) {
        let at = seed.below(bytes.len() + 1);
        match seed.below(5) {
            0 if at < bytes.len() => bytes[at] ^= 1 << seed.below(8),
            1 => bytes.truncate(at),
            2 => bytes.insert(at, seed.below(256) as u8),
            3 => {
                let other = &others[seed.below(others.len())];
                bytes.splice(at.., other[seed.below(other.len() + 1)..].iter().copied());
            }
            _ => {
                let tail = bytes[at..].to_vec();
                bytes.extend(tail);
            }
        }
    }
    bytes
}

/// One of each that is said.
fn messages() -> Vec<Message> {
    vec![
        Message::Beat,
        Message::Code(vec![1; 200]),
        Message::Credit(Credit { taken: 7 }),
        Message::Press(1),
        Message::File("part.ngc".into(), b"M2\n".to_vec()),
        Message::Go,
        Message::Refused("why".into()),
        Message::Ping(vec![3; 8]),
        Message::Open(1),
        Message::Bytes(1, b"{\"ticket\":1}\n".to_vec()),
        Message::Took(1, 4096),
        Message::Shut(1),
        Message::Over,
    ]
}

#[test]
fn a_message_of_any_bytes_is_none_or_comes_back() {
    let corpus: Vec<_> = messages().iter().map(Message::bytes).collect();
    let mut seed = Seed::new(61);
    let mut some = 0;
    for number in 0..20 * count("PITCHLOCK_MUTATIONS", MUTATIONS) as usize {
        let bytes = mutated(&corpus[number % corpus.len()], &corpus, &mut seed);
        if let Some(message) = Message::of(&bytes) {
            some += 1;
            assert_eq!(message.bytes(), bytes, "{bytes:?}");
        }
    }
    assert!(some > 1000, "{some} are messages");
}

/// Both ends of a wire in this process, a door at one, and a key that both have.
struct Hosts {
    door: Door,
    lower: Wire,
    upper: Wire,
    key: Key,
    here: Identity,
    _folder: tempfile::TempDir,
}

impl Hosts {
    fn new() -> Hosts {
        let Gate { wire: lower, address, key, folder, .. } = Gate::open();
        let mut upper = Wire::that_calls().expect("a wire");
        let net = call(&address, &key.gate(), Role::Operator, Duration::from_secs(5)).expect("let in");
        upper.over(net).expect("a wire");
        let here = Identity::here("0.1.0", &"a1".repeat(32));
        let door = Door::new(key.clone(), here.clone(), lower.mouths(), None);
        Hosts { door, lower, upper, key, here, _folder: folder }
    }

    fn hello(&self, wants: Wants) -> (u128, Hello) {
        let own = seal::nonce().expect("a number");
        let (nonce, back) = (hex(own), hex(self.upper.name));
        (own, Hello { nonce, back, wants, identity: self.here.clone() })
    }

    /// A session for a run.
    fn welcome(&mut self) -> Sealer {
        let (own, hello) = self.hello(Wants::Run);
        let greeting = sealed(Greeting::Hello, &self.key, &hello).expect("sealed");
        for _ in 0..100 {
            self.upper.mouth().say(greeting.clone()).expect("said");
            if let Some(Event::Frame(bytes)) = self.lower.wait(Duration::from_millis(100)) {
                assert!(self.door.hears(&bytes).expect("heard").is_none());
            }
            while let Some(event) = self.upper.wait(Duration::from_millis(20)) {
                let Event::Frame(bytes) = event else { continue };
                let answer = opened::<Answer>(Greeting::Answer, &self.key, &bytes);
                if let Some(answer) = answer.filter(|answer| answer.of == hello.nonce) {
                    assert_eq!(answer.verdict, Verdict::Welcome);
                    let theirs = of_hex(&answer.nonce).expect("a number");
                    return seal::session(&self.key, own, theirs, Level::Upper).0;
                }
            }
        }
        panic!("nobody answers")
    }
}

#[test]
fn any_bytes_at_the_door_begin_nothing_and_who_has_a_session_keeps_it() {
    let mut hosts = Hosts::new();
    let mut sealer = hosts.welcome();
    // What a session that is not this one has said, greetings, and what stands around them.
    let (mut other, _) = seal::session(&hosts.key, 1, 2, Level::Upper);
    let mut corpus: Vec<_> = messages().iter().map(|message| other.seal(&message.bytes())).collect();
    let ping = sealer.seal(&Message::Ping(vec![1; 8]).bytes());
    assert!(hosts.door.hears(&ping).expect("heard").is_none());
    corpus.push(ping);
    let wants = [Wants::Run, Wants::Ping, Wants::Panel, Wants::Look, Wants::Outcome("a".into())];
    for wants in wants {
        corpus.push(sealed(Greeting::Hello, &hosts.key, &hosts.hello(wants).1).expect("sealed"));
    }
    let mut seed = Seed::new(62);
    for number in 0..count("PITCHLOCK_MUTATIONS", MUTATIONS) as usize {
        let from = &corpus[number % corpus.len()];
        let bytes = mutated(from, &corpus, &mut seed);
        // Greetings that are whole may have come back: they begin no run either.
        assert!(hosts.door.hears(&bytes).expect("heard").is_none(), "{bytes:?}");
        if number % 7 == 0 {
            // Somebody with the key greets with nonsense.
            let body = Greeting::Hello.says(from).unwrap_or(from);
            let nonsense = Greeting::Hello.seal(&hosts.key, &mutated(body, &corpus, &mut seed));
            assert!(hosts.door.hears(&nonsense).expect("heard").is_none());
        }
        while hosts.upper.look().is_some() {}
    }
    // Who has spoken is still there, and may begin.
    let file = sealer.seal(&Message::File("part.ngc".into(), b"M2\n".to_vec()).bytes());
    assert!(hosts.door.hears(&file).expect("heard").is_none());
    let begin = sealer.seal(&Message::Begin(vec!["part.ngc".into()]).bytes());
    let asked = hosts.door.hears(&begin).expect("heard").expect("a run");
    assert_eq!((asked.words, asked.files.len()), (vec!["part.ngc".to_owned()], 1));
}
