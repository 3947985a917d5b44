//! What strangers may say at the gate of a machine, and what may be said to whoever calls.

// Its own package names the rest.
#[allow(dead_code)]
#[path = "../../hosts/src/proof.rs"]
mod proof;

use proof::{GREETING, Greeted, Known, NUMBER, Number, PROOF, Role, Secret, Stranger, VERDICT, Verdict};

const SECRET: Secret = [1; 32];
const MACHINE: Number = [5; NUMBER];
const CALLER: Number = [6; NUMBER];

/// What a machine and a caller with the same key say to each other, behind how many bytes come at a time.
#[allow(dead_code)]
pub fn dialogue() -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    for (role, at_a_time) in [(Role::Operator, 0), (Role::Hall, 7), (Role::Operator, 255)] {
        let mut stranger = Stranger::new(MACHINE);
        let greeting = stranger.greeting();
        let Some(greeted) = Greeted::by(&greeting, CALLER) else { continue };
        let proof = greeted.proof(role, &SECRET);
        all.push([&[at_a_time][..], &proof].concat());
        stranger.room().copy_from_slice(&proof);
        stranger.came(PROOF, &SECRET);
        for verdict in [Verdict::Welcome, Verdict::OtherKey, Verdict::Full] {
            let verdict = stranger.verdict(verdict, &SECRET);
            all.push([&[at_a_time][..], &greeting, &verdict].concat());
        }
    }
    all
}

/// The first byte tells how many of the rest come at a time. Nobody is let in, and nobody believes that he
/// is, but by a proof under the key; of a stranger no more than a proof is read.
pub fn door(bytes: &[u8]) {
    let Some((at_a_time, said)) = bytes.split_first() else { return };
    let mut stranger = Stranger::new(MACHINE);
    let (mut known, mut read) = (Known::NotYet, 0);
    for mut part in said.chunks(usize::from(*at_a_time).max(1)) {
        while known == Known::NotYet && !part.is_empty() {
            let room = stranger.room();
            let count = part.len().min(room.len());
            room[..count].copy_from_slice(&part[..count]);
            known = stranger.came(count, &SECRET);
            (read, part) = (read + count, &part[count..]);
        }
    }
    assert!(read <= PROOF, "{read} bytes were read");
    if let Known::Caller(role) = known {
        let own = std::array::from_fn(|n| said[1 + n]);
        let greeted = Greeted::by(&stranger.greeting(), own).expect("a machine");
        assert_eq!(said[..PROOF], greeted.proof(role, &SECRET), "only that lets in");
    }
    let Some((greeting, said)) = said.split_first_chunk::<GREETING>() else { return };
    let (Some(greeted), Some(told)) = (Greeted::by(greeting, CALLER), said.first_chunk::<VERDICT>()) else {
        return;
    };
    if greeted.verdict(told, &SECRET) == Some(Verdict::Welcome) {
        let number = std::array::from_fn(|n| greeting[GREETING - NUMBER + n]);
        let mut stranger = Stranger::new(number);
        stranger.room().copy_from_slice(&greeted.proof(Role::Operator, &SECRET));
        assert_eq!(stranger.came(PROOF, &SECRET), Known::Caller(Role::Operator));
        assert_eq!(*told, stranger.verdict(Verdict::Welcome, &SECRET), "only that is believed");
    }
}
