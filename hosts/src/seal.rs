//! Trust: a key that both hosts have, and a keyed hash (BLAKE3) over everything that crosses the wire. In:
//! bytes. Out: sealed bytes, and back; strangers and what was there before are refused.
//!
//! Each session has keys of its own, one for each direction, made of the common key and a number from either
//! side that was never used before. So what was recorded in one session is a stranger in any other, and what
//! went one way is one on the way back. Within a session messages are counted. What is sealed can be read by
//! whoever listens.

use std::{
    fs,
    io::{ErrorKind, Read as _, Write as _},
    os::unix::fs::{MetadataExt as _, OpenOptionsExt as _},
    path::Path,
};

use crate::LinkError;

/// Bytes of a key.
const KEY: usize = 32;
/// Bytes of a hash in a message.
pub const TAG: usize = 32;
/// Bytes of the name of a session.
pub const NAME: usize = 16;

/// A number that is used once.
pub type Nonce = u128;

/// The common key.
#[derive(Clone)]
pub struct Key([u8; KEY]);

impl std::fmt::Debug for Key {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str("Key")
    }
}

/// Bytes that nobody can guess.
fn random<const N: usize>() -> Result<[u8; N], LinkError> {
    let mut bytes = [0; N];
    let read = fs::File::open("/dev/urandom").and_then(|mut file| file.read_exact(&mut bytes));
    read.map(|()| bytes).map_err(|error| LinkError::broken("/dev/urandom", error))
}

/// A number that was never used before.
///
/// # Errors
/// The system has no random numbers.
pub fn nonce() -> Result<Nonce, LinkError> {
    random().map(Nonce::from_le_bytes)
}

impl Key {
    /// Reads a key: 64 hexadecimal digits, in a file that nobody but its owner can read.
    ///
    /// # Errors
    /// [`LinkError::Input`] with the remedy.
    pub fn read(path: &Path) -> Result<Key, LinkError> {
        let wrong = |error: &dyn std::fmt::Display| LinkError::file(path, error);
        let found = fs::metadata(path).map_err(|error| {
            wrong(&format!(
                "{error}\nhelp: `pitchlock-link key {}` makes one; copy it to the other host",
                path.display()
            ))
        })?;
        if !found.is_file() {
            return Err(wrong(&"is not a file"));
        }
        // Whoever reads this has its own number.
        let own = fs::metadata("/proc/self").map_or(found.uid(), |process| process.uid());
        if ![own, 0].contains(&found.uid()) {
            return Err(wrong(
                &"belongs to somebody else, who can read and change it\nhelp: copy it, and chmod 600 the copy",
            ));
        }
        if found.mode() & 0o077 != 0 {
            return Err(wrong(&format!("others can read this key\nhelp: chmod 600 {}", path.display())));
        }
        let text = intake::text(path, 4096).map_err(|error| wrong(&error))?;
        Key::of(&text)
            .ok_or_else(|| wrong(&"a key is 64 hexadecimal digits, as `pitchlock-link key FILE` makes one"))
    }

    /// The key of such a text.
    pub fn of(text: &str) -> Option<Key> {
        blake3::Hash::from_hex(text.trim()).ok().map(|hash| Key(*hash.as_bytes()))
    }

    /// Makes a file with a new key.
    ///
    /// # Errors
    /// [`LinkError::Input`] if there is one already, or it cannot be made.
    pub fn make(path: &Path) -> Result<(), LinkError> {
        let key = blake3::Hash::from_bytes(random()?);
        let file = fs::OpenOptions::new().write(true).create_new(true).mode(0o600).open(path);
        let mut file = file.map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => LinkError::file(
                path,
                "is there already\nhelp: a key that is used is not overwritten; name another file",
            ),
            _ => LinkError::file(path, error),
        })?;
        writeln!(file, "{}", key.to_hex()).map_err(|error| {
            // Half a key is none.
            let _ = fs::remove_file(path);
            LinkError::file(path, error)
        })
    }

    /// What is proved at the gate.
    pub fn gate(&self) -> [u8; KEY] {
        self.derived("pitchlock link 1 gate", &[])
    }

    /// A key for one use, of this one and what else it is to depend on.
    fn derived(&self, what: &str, nonces: &[Nonce]) -> [u8; KEY] {
        let mut hash = blake3::Hasher::new_derive_key(what);
        hash.update(&self.0);
        for nonce in nonces {
            hash.update(&nonce.to_le_bytes());
        }
        *hash.finalize().as_bytes()
    }
}

/// What is said before there is a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Greeting {
    /// The upper level begins.
    Hello,
    /// The lower level answers.
    Answer,
}

impl Greeting {
    /// The first byte of such a message.
    fn mark(self) -> u8 {
        if self == Greeting::Hello { b'H' } else { b'A' }
    }

    fn key(self, key: &Key) -> [u8; KEY] {
        let what = if self == Greeting::Hello { "pitchlock link 1 hello" } else { "pitchlock link 1 answer" };
        key.derived(what, &[])
    }

    /// Puts a greeting under the common key.
    pub fn seal(self, key: &Key, body: &[u8]) -> Vec<u8> {
        let mut bytes = vec![self.mark()];
        bytes.extend(body);
        bytes.extend(blake3::keyed_hash(&self.key(key), &bytes).as_bytes());
        bytes
    }

    /// Whether it is one at all, whoever sent it.
    pub fn is(self, bytes: &[u8]) -> bool {
        bytes.first() == Some(&self.mark())
    }

    /// What stands in it, whoever sealed it.
    pub fn says(self, bytes: &[u8]) -> Option<&[u8]> {
        bytes.get(1..bytes.len().checked_sub(TAG)?).filter(|_| self.is(bytes))
    }

    /// Its body, if it was sealed by somebody with the same key.
    pub fn open(self, key: &Key, bytes: &[u8]) -> Option<Vec<u8>> {
        let (said, tag) = bytes.split_at_checked(bytes.len().checked_sub(TAG)?)?;
        let tag: [u8; TAG] = tag.try_into().ok()?;
        // This comparison takes the same time for any bytes.
        (blake3::keyed_hash(&self.key(key), said) == tag && self.is(said)).then(|| said[1..].to_vec())
    }
}

/// The first byte of a message within a session.
const SESSION: u8 = b'S';
const COUNTER: usize = 8;
const HEAD: usize = 1 + NAME + COUNTER;

/// Which of both hosts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Host A, with the interpreter.
    Upper,
    /// Host B, with everything that has deadlines.
    Lower,
}

/// The name of a session: no secret.
pub type Name = [u8; NAME];

/// What seals the messages of one direction of a session.
#[derive(Debug)]
pub struct Sealer {
    key: [u8; KEY],
    name: Name,
    next: u64,
}

/// What opens them on the other side.
#[derive(Debug)]
pub struct Opener {
    key: [u8; KEY],
    name: Name,
    next: u64,
}

/// Why a message is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unwelcome {
    /// Nobody with the key of this session has sent it, or it was changed on its way.
    Stranger,
    /// It was there before.
    Replayed,
    /// So many before it have not come.
    Lost(u64),
}

/// Both ends of a session at one host, from a number of either.
pub fn session(key: &Key, upper: Nonce, lower: Nonce, at: Level) -> (Sealer, Opener) {
    let nonces = [upper, lower];
    let name: Name = key.derived("pitchlock link 1 name", &nonces)[..NAME].try_into().unwrap_or_default();
    let down = key.derived("pitchlock link 1 downwards", &nonces);
    let up = key.derived("pitchlock link 1 upwards", &nonces);
    let (out, back) = if at == Level::Upper { (down, up) } else { (up, down) };
    (Sealer { key: out, name, next: 0 }, Opener { key: back, name, next: 0 })
}

impl Sealer {
    /// The name of its session.
    pub fn name(&self) -> Name {
        self.name
    }

    /// Seals the next message.
    pub fn seal(&mut self, body: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEAD + body.len() + TAG);
        bytes.push(SESSION);
        bytes.extend(self.name);
        bytes.extend(self.next.to_le_bytes());
        bytes.extend(body);
        bytes.extend(blake3::keyed_hash(&self.key, &bytes).as_bytes());
        self.next += 1;
        bytes
    }
}

impl Opener {
    /// Whether a message says that it is of this session. Whether it is, only opening it tells.
    pub fn is_named_in(&self, bytes: &[u8]) -> bool {
        bytes.first() == Some(&SESSION) && bytes.get(1..1 + NAME) == Some(&self.name)
    }

    /// The body of a message.
    ///
    /// # Errors
    /// [`Unwelcome`]; behind a gap it counts on.
    pub fn open<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], Unwelcome> {
        let end = bytes.len().checked_sub(TAG).filter(|end| *end >= HEAD).ok_or(Unwelcome::Stranger)?;
        let (said, tag) = bytes.split_at(end);
        let tag: [u8; TAG] = tag.try_into().map_err(|_| Unwelcome::Stranger)?;
        if !self.is_named_in(said) || blake3::keyed_hash(&self.key, said) != tag {
            return Err(Unwelcome::Stranger);
        }
        let number = said[1 + NAME..HEAD].try_into().map_or(0, u64::from_le_bytes);
        if number < self.next {
            return Err(Unwelcome::Replayed);
        }
        let lost = number - self.next;
        self.next = number + 1;
        if lost > 0 { Err(Unwelcome::Lost(lost)) } else { Ok(&said[HEAD..]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(byte: u8) -> Key {
        Key([byte; KEY])
    }

    #[test]
    fn a_session_takes_each_message_of_its_own_once_and_counts_what_is_lost() {
        let (mut upper, _) = session(&key(1), 5, 6, Level::Upper);
        let (_, mut lower) = session(&key(1), 5, 6, Level::Lower);
        let all: Vec<_> = (0..5u8).map(|body| upper.seal(&[body])).collect();
        assert_eq!(lower.open(&all[0]), Ok(&[0][..]));
        assert_eq!(lower.open(&all[0]), Err(Unwelcome::Replayed));
        assert_eq!(lower.open(&all[1]), Ok(&[1][..]));
        assert_eq!(lower.open(&all[4]), Err(Unwelcome::Lost(2)));
        assert_eq!(lower.open(&all[3]), Err(Unwelcome::Replayed));
    }

    #[test]
    fn another_key_another_session_and_the_way_back_are_strangers() {
        let (mut upper, mut own) = session(&key(1), 5, 6, Level::Upper);
        let message = upper.seal(b"code");
        assert_eq!(own.open(&message), Err(Unwelcome::Stranger), "its own message comes back");
        for (key, a, b) in [(key(2), 5, 6), (key(1), 7, 6), (key(1), 5, 7)] {
            let (_, mut other) = session(&key, a, b, Level::Lower);
            assert_eq!(other.open(&message), Err(Unwelcome::Stranger));
        }
    }

    #[test]
    fn one_bit_that_is_changed_anywhere_makes_a_stranger() {
        let (mut upper, _) = session(&key(1), 5, 6, Level::Upper);
        let (_, mut lower) = session(&key(1), 5, 6, Level::Lower);
        let (message, hello) = (upper.seal(b"code"), Greeting::Hello.seal(&key(1), b"hello"));
        for bit in 0..8 * message.len() {
            let mut damaged = message.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(lower.open(&damaged), Err(Unwelcome::Stranger), "bit {bit}");
        }
        for bit in 0..8 * hello.len() {
            let mut damaged = hello.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(Greeting::Hello.open(&key(1), &damaged), None, "bit {bit}");
        }
        for end in 0..message.len() {
            assert_eq!(lower.open(&message[..end]), Err(Unwelcome::Stranger), "{end} bytes");
        }
        assert_eq!(lower.open(&message), Ok(&b"code"[..]));
    }

    #[test]
    fn a_greeting_is_opened_by_the_same_key_alone_and_is_no_answer() {
        let hello = Greeting::Hello.seal(&key(1), b"hello");
        assert_eq!(Greeting::Hello.open(&key(1), &hello).as_deref(), Some(&b"hello"[..]));
        assert_eq!(Greeting::Hello.open(&key(2), &hello), None);
        assert_eq!(Greeting::Answer.open(&key(1), &hello), None);
    }

    #[test]
    fn a_key_that_others_can_read_is_refused_with_the_remedy() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key");
        assert!(Key::read(&path).expect_err("none").to_string().contains("pitchlock-link key"));
        Key::make(&path).expect("made");
        assert!(Key::make(&path).is_err(), "no key is overwritten");
        Key::read(&path).expect("its own key");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("its own file");
        assert!(Key::read(&path).expect_err("open").to_string().contains("chmod 600"));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).expect("its own file");
        fs::write(&path, "abc").expect("written");
        assert!(Key::read(&path).expect_err("short").to_string().contains("64 hexadecimal digits"));
    }
}
