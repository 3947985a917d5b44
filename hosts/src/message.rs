//! What travels within a session. In: messages. Out: bytes, and back; what nobody sends is refused.

use protocol::Credit;

/// Most bytes of the files that a program is made of.
pub const FILE: usize = 64 << 20;
/// Most bytes of a part of one: a message that takes long to be sent is given up.
pub const PART: usize = 64 << 10;
/// Most bytes of the name of one.
const FILE_NAME: usize = 255;

/// A message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Message {
    /// Whoever sends it lives.
    Beat,
    /// A packet of machine code, downwards.
    Code(Vec<u8>),
    /// How much of it was taken, upwards.
    Credit(Credit),
    /// Somebody at the upper level presses: 1 stop, 2 emergency stop.
    Press(u8),
    /// A file that the run is made of, or another part of the file before.
    File(String, Vec<u8>),
    /// All files have come: arguments of the run, the program first.
    Begin(Vec<String>),
    /// The machine has started.
    Go,
    /// The run is not begun, and why.
    Refused(String),
    /// The sender ends, and why.
    Bye(String),
    /// To be sent back.
    Ping(Vec<u8>),
    /// What was.
    Pong(Vec<u8>),
    /// The socket with this number is there, downwards.
    Open(u32),
    /// Bytes of it.
    Bytes(u32, Vec<u8>),
    /// So many of them have been taken.
    Took(u32, u32),
    /// It is not there any more.
    Shut(u32),
    /// What was asked for has come to its end, upwards.
    Over,
    /// The interpreter computes, downwards: nobody else would know.
    Computes,
}

/// Whether a name is that of a file in a folder, and nothing else.
pub fn is_file_name(name: &str) -> bool {
    let plain = |letter: char| !letter.is_control() && letter != '/' && letter != '\0';
    !name.is_empty() && name.len() <= FILE_NAME && !name.starts_with('.') && name.chars().all(plain)
}

impl Message {
    /// As bytes.
    pub fn bytes(&self) -> Vec<u8> {
        let with = |kind: u8, body: &[u8]| [&[kind], body].concat();
        match self {
            Message::Beat => vec![0],
            Message::Code(bytes) => with(1, bytes),
            Message::Credit(credit) => with(2, &credit.taken.to_le_bytes()),
            Message::Press(what) => with(3, &[*what]),
            Message::File(name, bytes) => {
                [&[4], &(name.len() as u16).to_le_bytes()[..], name.as_bytes(), bytes].concat()
            }
            Message::Begin(words) => with(5, words.join("\0").as_bytes()),
            Message::Go => vec![6],
            Message::Refused(text) => with(7, text.as_bytes()),
            Message::Bye(text) => with(8, text.as_bytes()),
            Message::Ping(bytes) => with(9, bytes),
            Message::Pong(bytes) => with(10, bytes),
            Message::Open(number) => with(11, &number.to_le_bytes()),
            Message::Bytes(number, bytes) => [&[12], &number.to_le_bytes()[..], bytes].concat(),
            Message::Took(number, count) => [&[13], &number.to_le_bytes()[..], &count.to_le_bytes()].concat(),
            Message::Shut(number) => with(14, &number.to_le_bytes()),
            Message::Over => vec![15],
            Message::Computes => vec![16],
        }
    }

    /// Of bytes; `None` if nobody sends such.
    pub fn of(bytes: &[u8]) -> Option<Message> {
        let (kind, body) = bytes.split_first()?;
        let text = || String::from_utf8(body.to_vec()).ok();
        let empty = |message| body.is_empty().then_some(message);
        let number = || Some(u32::from_le_bytes(body.try_into().ok()?));
        match kind {
            0 => empty(Message::Beat),
            1 => Some(Message::Code(body.to_vec())),
            2 => Some(Message::Credit(Credit { taken: u64::from_le_bytes(body.try_into().ok()?) })),
            3 => match body {
                [what @ 1..=2] => Some(Message::Press(*what)),
                _ => None,
            },
            4 => {
                let (length, rest) = body.split_first_chunk()?;
                let (name, bytes) = rest.split_at_checked(usize::from(u16::from_le_bytes(*length)))?;
                let name = std::str::from_utf8(name).ok().filter(|name| is_file_name(name))?;
                (bytes.len() <= PART).then(|| Message::File(name.into(), bytes.to_vec()))
            }
            5 => text().map(|text| Message::Begin(text.split('\0').map(str::to_owned).collect())),
            6 => empty(Message::Go),
            7 => text().map(Message::Refused),
            8 => text().map(Message::Bye),
            9 => Some(Message::Ping(body.to_vec())),
            10 => Some(Message::Pong(body.to_vec())),
            11 => number().map(Message::Open),
            12 => {
                let (number, bytes) = body.split_first_chunk()?;
                Some(Message::Bytes(u32::from_le_bytes(*number), bytes.to_vec()))
            }
            13 => {
                let (number, count) = body.split_first_chunk()?;
                let count = u32::from_le_bytes(count.try_into().ok()?);
                Some(Message::Took(u32::from_le_bytes(*number), count))
            }
            14 => number().map(Message::Shut),
            15 => empty(Message::Over),
            16 => empty(Message::Computes),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_travels() {
        let all = [
            Message::Beat,
            Message::Code(vec![1, 2, 3]),
            Message::Credit(Credit::ENOUGH),
            Message::Press(2),
            Message::File("part.ngc".into(), b"M2\n".to_vec()),
            Message::Begin(vec!["part.ngc".into(), "--seed".into(), "7".into()]),
            Message::Go,
            Message::Refused("line 3: …".into()),
            Message::Bye(String::new()),
            Message::Ping(vec![0; 64]),
            Message::Pong(Vec::new()),
            Message::Open(1),
            Message::Bytes(2, vec![1, 2]),
            Message::Bytes(u32::MAX, Vec::new()),
            Message::Took(3, 4),
            Message::Shut(5),
            Message::Over,
            Message::Computes,
        ];
        for message in all {
            assert_eq!(Message::of(&message.bytes()).as_ref(), Some(&message));
        }
    }

    #[test]
    fn what_nobody_sends_is_no_message() {
        let file = |name: &str| Message::File(name.into(), vec![1]).bytes();
        let short = [&[11, 1][..], &[12, 0, 0], &[13, 0, 0, 0, 0, 1], &[14], &[15, 0], &[16, 0], &[17]];
        let all = [&[][..], &[0, 0], &[2, 1], &[3, 0], &[3, 3], &[4], &[4, 9, 0, b'a'], &[7, 0xff]];
        for bytes in all.into_iter().chain(short) {
            assert_eq!(Message::of(bytes), None, "{bytes:?}");
        }
        for name in ["", ".hidden", "../etc", "a/b", "/etc/passwd", "a\0b", &"n".repeat(256)] {
            assert_eq!(Message::of(&file(name)), None, "{name:?}");
        }
    }
}
