//! The proof that whoever calls has the key, before a byte of his reaches Zenoh. In: bytes of somebody. Out:
//! bytes, and who he is.
//!
//! | who | says | bytes |
//! |---|---|---|
//! | machine | `pitchlock gate 1`, and a number that was never used before | 16 + 16 |
//! | caller | what he is, a number of his own, and the keyed hash of that and both numbers | 1 + 16 + 32 |
//! | machine | its verdict, and the keyed hash of that and both numbers | 1 + 32 |
//!
//! So a proof that was recorded is one for a number that never comes again, and a caller knows that whoever
//! lets him in has the key as well. Nothing here waits, or takes memory by what a stranger says.

/// What the machine says first.
const MARK: &[u8; 16] = b"pitchlock gate 1";
/// Bytes of a number.
pub const NUMBER: usize = 16;
/// Bytes of a hash.
const HASH: usize = 32;
/// Bytes of what the machine says first, of a proof, and of a verdict.
pub const GREETING: usize = MARK.len() + NUMBER;
/// The same.
pub const PROOF: usize = 1 + NUMBER + HASH;
/// The same.
pub const VERDICT: usize = 1 + HASH;

/// A number that is used once.
pub type Number = [u8; NUMBER];
/// What both have: made of the common key, and for this alone.
pub type Secret = [u8; HASH];

/// What somebody is who calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Runs programs, stands at the machine, measures the way.
    Operator,
    /// Looks.
    Hall,
}

impl Role {
    fn byte(self) -> u8 {
        if self == Role::Operator { b'O' } else { b'H' }
    }

    fn of(byte: u8) -> Option<Role> {
        [Role::Operator, Role::Hall].into_iter().find(|role| role.byte() == byte)
    }
}

/// What becomes of somebody who calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// He is let in.
    Welcome,
    /// His proof is not one under this key.
    OtherKey,
    /// All places are taken.
    Full,
}

impl Verdict {
    fn byte(self) -> u8 {
        match self {
            Verdict::Welcome => b'W',
            Verdict::OtherKey => b'K',
            Verdict::Full => b'F',
        }
    }
}

/// The hash of what one of both says; `what` tells a proof from a verdict.
fn hash(secret: &Secret, [what, said]: [u8; 2], machine: &Number, caller: &Number) -> blake3::Hash {
    let mut bytes = [0; 2 + 2 * NUMBER];
    (bytes[0], bytes[1]) = (what, said);
    bytes[2..2 + NUMBER].copy_from_slice(machine);
    bytes[2 + NUMBER..].copy_from_slice(caller);
    blake3::keyed_hash(secret, &bytes)
}

const OF_CALLER: u8 = b'C';
const OF_MACHINE: u8 = b'M';

/// What is known of somebody at the gate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// Not all of his proof has come.
    NotYet,
    /// He has no proof.
    Stranger,
    /// He has.
    Caller(Role),
}

/// Somebody who has not proved anything, at the machine.
#[derive(Debug)]
pub struct Stranger {
    number: Number,
    said: [u8; PROOF],
    has: usize,
}

impl Stranger {
    /// Somebody new. The number is one that was never used before.
    pub fn new(number: Number) -> Stranger {
        Stranger { number, said: [0; PROOF], has: 0 }
    }

    /// What he is told first.
    pub fn greeting(&self) -> [u8; GREETING] {
        let mut bytes = [0; GREETING];
        bytes[..MARK.len()].copy_from_slice(MARK);
        bytes[MARK.len()..].copy_from_slice(&self.number);
        bytes
    }

    /// Where to put what he says next: so much is read of him at most, and nothing beyond his proof.
    pub fn room(&mut self) -> &mut [u8] {
        &mut self.said[self.has..]
    }

    /// So many bytes have come there. Who he is.
    pub fn came(&mut self, count: usize, secret: &Secret) -> Known {
        self.has = (self.has + count).min(PROOF);
        let role = Role::of(self.said[0]);
        if self.has > 0 && role.is_none() {
            return Known::Stranger;
        }
        let (Some(role), PROOF) = (role, self.has) else { return Known::NotYet };
        let told: [u8; HASH] = std::array::from_fn(|n| self.said[1 + NUMBER + n]);
        // This comparison takes the same time for any bytes.
        let proved = hash(secret, [OF_CALLER, role.byte()], &self.number, &self.his()) == told;
        if proved { Known::Caller(role) } else { Known::Stranger }
    }

    /// His own number, as far as it has come.
    fn his(&self) -> Number {
        std::array::from_fn(|n| self.said[1 + n])
    }

    /// What he is told last.
    pub fn verdict(&self, verdict: Verdict, secret: &Secret) -> [u8; VERDICT] {
        let mut bytes = [0; VERDICT];
        bytes[0] = verdict.byte();
        let hash = hash(secret, [OF_MACHINE, verdict.byte()], &self.number, &self.his());
        bytes[1..].copy_from_slice(hash.as_bytes());
        bytes
    }
}

/// What somebody is told who goes before he has proved anything.
pub fn full() -> [u8; VERDICT] {
    let mut bytes = [0; VERDICT];
    bytes[0] = Verdict::Full.byte();
    bytes
}

/// The other side: somebody who calls, and was greeted.
#[derive(Debug)]
pub struct Greeted {
    machine: Number,
    own: Number,
}

impl Greeted {
    /// By these bytes; `None` if no machine says such. His own number was never used before either.
    pub fn by(bytes: &[u8; GREETING], own: Number) -> Option<Greeted> {
        let machine = bytes.strip_prefix(MARK)?.try_into().ok()?;
        Some(Greeted { machine, own })
    }

    /// His proof.
    pub fn proof(&self, role: Role, secret: &Secret) -> [u8; PROOF] {
        let mut bytes = [0; PROOF];
        bytes[0] = role.byte();
        bytes[1..=NUMBER].copy_from_slice(&self.own);
        let hash = hash(secret, [OF_CALLER, role.byte()], &self.machine, &self.own);
        bytes[1 + NUMBER..].copy_from_slice(hash.as_bytes());
        bytes
    }

    /// What he is told last; `None` if no machine says such. Only who has the key can let him in; that he is
    /// not let in anybody may say.
    pub fn verdict(&self, bytes: &[u8; VERDICT], secret: &Secret) -> Option<Verdict> {
        let all = [Verdict::Welcome, Verdict::OtherKey, Verdict::Full];
        let verdict = all.into_iter().find(|verdict| verdict.byte() == bytes[0])?;
        let told: [u8; HASH] = std::array::from_fn(|n| bytes[1 + n]);
        let sealed = hash(secret, [OF_MACHINE, bytes[0]], &self.machine, &self.own) == told;
        Some(if verdict == Verdict::Welcome && !sealed { Verdict::OtherKey } else { verdict })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECRET: Secret = [1; HASH];

    /// Bytes come, so many at a time; who it is then.
    fn comes(stranger: &mut Stranger, bytes: &[u8], at_a_time: usize) -> Known {
        let mut known = Known::NotYet;
        for part in bytes.chunks(at_a_time) {
            let room = stranger.room();
            let count = part.len().min(room.len());
            room[..count].copy_from_slice(&part[..count]);
            known = stranger.came(count, &SECRET);
        }
        known
    }

    #[test]
    fn who_has_the_key_is_let_in_as_what_he_is_and_learns_that_by_the_same_key() {
        for (role, at_a_time) in [(Role::Operator, PROOF), (Role::Hall, 1), (Role::Operator, 7)] {
            let mut stranger = Stranger::new([5; NUMBER]);
            let greeted = Greeted::by(&stranger.greeting(), [6; NUMBER]).expect("a machine");
            let proof = greeted.proof(role, &SECRET);
            assert_eq!(comes(&mut stranger, &proof, at_a_time), Known::Caller(role));
            for verdict in [Verdict::Welcome, Verdict::Full] {
                let told = stranger.verdict(verdict, &SECRET);
                assert_eq!(greeted.verdict(&told, &SECRET), Some(verdict));
            }
            let liar = stranger.verdict(Verdict::Welcome, &[2; HASH]);
            assert_eq!(greeted.verdict(&liar, &SECRET), Some(Verdict::OtherKey), "he has not the key");
        }
    }

    #[test]
    fn another_key_another_role_and_a_proof_that_was_there_before_are_strangers() {
        let greeted = Greeted::by(&Stranger::new([5; NUMBER]).greeting(), [6; NUMBER]).expect("a machine");
        let proof = greeted.proof(Role::Hall, &SECRET);
        assert_eq!(comes(&mut Stranger::new([5; NUMBER]), &proof, PROOF), Known::Caller(Role::Hall));
        assert_eq!(comes(&mut Stranger::new([7; NUMBER]), &proof, PROOF), Known::Stranger, "said again");
        let other = greeted.proof(Role::Hall, &[2; HASH]);
        assert_eq!(comes(&mut Stranger::new([5; NUMBER]), &other, PROOF), Known::Stranger);
        for bit in 0..8 * PROOF {
            let mut damaged = proof;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(comes(&mut Stranger::new([5; NUMBER]), &damaged, 3), Known::Stranger, "bit {bit}");
        }
        // What the machine says is no proof of anybody, either.
        let mut mirror = Stranger::new([5; NUMBER]);
        let verdict = mirror.verdict(Verdict::Welcome, &SECRET);
        assert_eq!(
            comes(&mut mirror, &[&[b'O'; 1 + NUMBER][..], &verdict[1..]].concat(), 9),
            Known::Stranger
        );
    }

    #[test]
    fn of_a_stranger_no_more_than_a_proof_is_read_and_one_byte_tells_who_is_none() {
        let mut stranger = Stranger::new([5; NUMBER]);
        assert_eq!(comes(&mut stranger, &[b'O'; PROOF - 1], 10), Known::NotYet);
        assert_eq!(comes(&mut stranger, &[0; 100], 100), Known::Stranger);
        assert!(stranger.room().is_empty());
        assert_eq!(comes(&mut Stranger::new([5; NUMBER]), b"GET / HTTP/1.1\r\n", 1), Known::Stranger);
        assert!(Greeted::by(b"SSH-2.0-OpenSSH_9.6 and so on...", [6; NUMBER]).is_none());
    }
}
