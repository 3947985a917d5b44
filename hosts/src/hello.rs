//! The first message: what either host is. In: two of them. Out: what they differ in, by name, before
//! anything moves.

use std::path::PathBuf;

use protocol::{CodePacket, Credit, Payload};
use serde::{Deserialize, Serialize};

use crate::{
    LinkError,
    seal::{Greeting, Key, Nonce},
};

/// Arguments of either end: what it needs to be let in.
#[derive(Clone, Debug, clap::Args)]
pub struct HostArgs {
    /// File with the key that both hosts have.
    #[arg(long, value_name = "FILE")]
    pub key: PathBuf,
    /// Version of the control on this host.
    #[arg(long, value_name = "VERSION")]
    pub control: String,
    /// BLAKE3 of its machine file.
    #[arg(long, value_name = "HASH")]
    pub machine: String,
}

impl HostArgs {
    /// The key, and what this host is.
    ///
    /// # Errors
    /// [`LinkError::Input`] if the key cannot be had.
    pub fn read(&self) -> Result<(Key, Identity), LinkError> {
        Ok((Key::read(&self.key)?, self.identity()))
    }

    /// What this host is.
    pub fn identity(&self) -> Identity {
        Identity::here(&self.control, &self.machine)
    }
}

/// What a host is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the control.
    pub version: String,
    /// BLAKE3 of its machine file, hexadecimal.
    pub machine: String,
    /// `little` or `big`.
    pub byte_order: String,
    /// Name, version and most bytes of what crosses the wire.
    pub messages: String,
}

impl Identity {
    /// This host with a control of this version and a machine file with this hash.
    pub fn here(version: &str, machine: &str) -> Identity {
        let message = |name: &str, bytes: usize| format!("{name} ({bytes} B)");
        let code = message(CodePacket::NAME, CodePacket::MOST_BYTES);
        let credit = message(<Credit as Payload>::NAME, Credit::MOST_BYTES);
        Identity {
            version: version.into(),
            machine: machine.into(),
            byte_order: if cfg!(target_endian = "little") { "little" } else { "big" }.into(),
            messages: format!("{code}, {credit}"),
        }
    }

    /// What somebody in a hall and this lower level differ in: only who runs programs needs all to be the
    /// same.
    pub fn hall_difference(&self, hall: &Identity) -> Option<String> {
        self.difference(&Identity { version: hall.version.clone(), ..self.clone() })
    }

    /// What this lower level and an upper one differ in, with the remedy, as the upper one reads it.
    pub fn difference(&self, upper: &Identity) -> Option<String> {
        let rows = [
            ("version", &self.version, &upper.version, "install the same pitchlock on both"),
            ("messages", &self.messages, &upper.messages, "install the same pitchlock on both"),
            ("byte order", &self.byte_order, &upper.byte_order, "use two computers of the same byte order"),
            ("machine file", &self.machine, &upper.machine, "give both the same file with --machine"),
        ];
        let other = rows.into_iter().find(|(_, here, there, _)| here != there);
        other.map(|(what, here, there, help)| {
            let short = |text: &str| {
                if what == "machine file" { text.chars().take(16).collect() } else { text.to_owned() }
            };
            format!("the {what} differs: {} there, {} here\nhelp: {help}", short(here), short(there))
        })
    }
}

/// What somebody wants.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wants {
    /// To run a program.
    Run,
    /// To know what became of the run with this name.
    Outcome(String),
    /// To measure the way there and back.
    Ping,
    /// To stand at the machine, with a panel.
    Panel,
    /// To see what the machine does.
    Look,
}

/// The first message.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// A number that was never used before, hexadecimal.
    pub nonce: String,
    /// Name by which whoever says it is called back, hexadecimal.
    pub back: String,
    /// What it is for.
    pub wants: Wants,
    /// Who says it.
    pub identity: Identity,
}

/// What the lower level says to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Verdict {
    /// A session may begin.
    Welcome,
    /// It may not, and why.
    Refused(String),
    /// What became of the run that was asked for.
    Outcome(serde_json::Value),
    /// That is not known yet.
    NotYet,
    /// What the machine does, and how old that is, s.
    Seen(serde_json::Value, f64),
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// The number of the message that it answers.
    pub of: String,
    /// A number of its own.
    pub nonce: String,
    /// What it says.
    pub verdict: Verdict,
}

/// A number as text.
pub fn hex(nonce: Nonce) -> String {
    format!("{nonce:032x}")
}

/// And back.
pub fn of_hex(text: &str) -> Option<Nonce> {
    Nonce::from_str_radix(text, 16).ok().filter(|_| text.len() == 32)
}

/// Puts either of both on the wire.
///
/// # Errors
/// None that is known.
pub fn sealed(what: Greeting, key: &Key, body: &impl Serialize) -> Result<Vec<u8>, LinkError> {
    let body = serde_json::to_vec(body).map_err(|error| LinkError::broken("a greeting", error))?;
    Ok(what.seal(key, &body))
}

/// Takes it off, if it is of somebody with the same key.
pub fn opened<T: for<'a> Deserialize<'a>>(what: Greeting, key: &Key, bytes: &[u8]) -> Option<T> {
    serde_json::from_slice(&what.open(key, bytes)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each difference is told by its name, with both values and a remedy; without one there is nothing to
    /// tell.
    #[test]
    fn every_difference_has_its_name_and_its_remedy() {
        let lower = Identity::here("0.1.0", &"a1".repeat(32));
        assert_eq!(lower.difference(&lower), None);
        let other = |what: &str| {
            let mut upper = lower.clone();
            match what {
                "version" => upper.version = "0.2.0".into(),
                "machine file" => upper.machine = "b2".repeat(32),
                "byte order" => upper.byte_order = "big".into(),
                _ => upper.messages = "pitchlock/code-packet/10".into(),
            }
            upper
        };
        for what in ["version", "machine file", "byte order", "messages"] {
            let upper = other(what);
            let told = lower.difference(&upper).expect(what);
            assert!(told.contains(&format!("the {what} differs")) && told.contains("\nhelp: "), "{told}");
        }
    }

    #[test]
    fn a_number_is_text_and_back() {
        for nonce in [0, 1, u128::MAX] {
            assert_eq!(of_hex(&hex(nonce)), Some(nonce));
        }
        assert_eq!([of_hex(""), of_hex("12"), of_hex(&"g".repeat(32))], [None; 3]);
    }
}
