//! The launcher's end of the socket to the panel. In: what is seen, answers, rows of the scope. Out: presses.
//! Nothing here waits: while the panel does not read, there is at most one state, [`MOST_ANSWERS`] bytes of
//! answers and [`MOST_ROWS`] bytes of rows on the way, and what does not fit is counted. Messages go before
//! rows.

use std::{
    collections::VecDeque,
    io::{ErrorKind, Read as _, Write as _},
    net::Shutdown,
    os::{
        fd::{AsFd as _, BorrowedFd},
        unix::net::UnixStream,
    },
};

use crate::wire::{FromPanel, ToPanel};

/// Most bytes of answers that wait for a panel that does not read.
const MOST_ANSWERS: usize = 16 << 10;
/// Most bytes of rows that do: four seconds of a lathe at 0.5 ms.
const MOST_ROWS: usize = 4 << 20;
/// Most bytes of presses that are read at once, and that a press may have.
const MOST_READ: usize = 4 << 10;

/// A link to a panel.
#[derive(Debug)]
pub struct Link {
    stream: UnixStream,
    /// What is being written, how much of it the socket has taken, and whether it is rows.
    now: Vec<u8>,
    taken: usize,
    of_rows: bool,
    /// Messages behind it, and rows behind these.
    out: Vec<u8>,
    rows: VecDeque<Vec<u8>>,
    rows_bytes: usize,
    /// Bytes of the state that was offered last: it is in no answer's way.
    state_bytes: usize,
    read: Vec<u8>,
    dropped: u64,
    broken: bool,
}

impl Link {
    /// A link by this socket.
    ///
    /// # Errors
    /// The system refuses a socket that does not wait.
    pub fn new(stream: UnixStream) -> std::io::Result<Link> {
        stream.set_nonblocking(true)?;
        Ok(Link {
            stream,
            now: Vec::new(),
            taken: 0,
            of_rows: false,
            out: Vec::new(),
            rows: VecDeque::new(),
            rows_bytes: 0,
            state_bytes: 0,
            read: Vec::new(),
            dropped: 0,
            broken: false,
        })
    }

    /// Whether the panel has taken all messages that were on the way.
    pub fn is_free(&mut self) -> bool {
        while !self.broken && (self.taken < self.now.len() || self.goes_on()) {
            match self.stream.write(&self.now[self.taken..]) {
                Ok(0) => self.broken = true,
                Ok(written) => self.taken += written,
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => self.broken = true,
            }
        }
        !self.broken && self.messages() == 0
    }

    /// Begins with what is to be written next, if there is anything.
    fn goes_on(&mut self) -> bool {
        self.now.clear();
        self.taken = 0;
        self.of_rows = self.out.is_empty();
        if !self.of_rows {
            std::mem::swap(&mut self.now, &mut self.out);
            return true;
        }
        let Some(rows) = self.rows.pop_front() else { return false };
        self.rows_bytes -= rows.len();
        self.now = rows;
        true
    }

    /// Bytes of messages on the way.
    fn messages(&self) -> usize {
        self.out.len() + if self.of_rows { 0 } else { self.now.len() - self.taken }
    }

    /// Sends rows of the scope, as long as not too many are on the way, and says whether.
    pub fn rows(&mut self, numbers: &[f64]) -> bool {
        self.is_free();
        let room = self.has_room() && !self.broken;
        match serde_json::to_vec(&ToPanel::Rows(numbers.len())) {
            Ok(mut frame) if room => {
                frame.push(b'\n');
                frame.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
                self.rows_bytes += frame.len();
                self.rows.push_back(frame);
                self.is_free();
            }
            _ => self.dropped += 1,
        }
        room
    }

    /// Whether there is room for more rows.
    pub fn has_room(&self) -> bool {
        self.rows_bytes < MOST_ROWS
    }

    /// Sends this if nothing is on the way, and says whether. What is not sent is counted: a newer state
    /// takes its place.
    pub fn offer(&mut self, message: &ToPanel) -> bool {
        let free = self.is_free();
        if free {
            self.put(message);
            self.state_bytes = self.out.len();
            self.is_free();
        } else {
            self.dropped += 1;
        }
        free
    }

    /// Sends this behind what is on the way, as long as that is not much.
    pub fn answer(&mut self, message: &ToPanel) {
        if self.is_free() || self.messages() < MOST_ANSWERS + self.state_bytes {
            self.put(message);
            self.is_free();
        } else {
            self.dropped += 1;
        }
    }

    fn put(&mut self, message: &ToPanel) {
        match serde_json::to_vec(message) {
            Ok(line) if !self.broken => {
                self.out.extend(line);
                self.out.push(b'\n');
            }
            _ => self.dropped += 1,
        }
    }

    /// What can be read as soon as somebody presses something; nothing if nobody will.
    pub fn waits(&self) -> Option<BorrowedFd<'_>> {
        (!self.broken).then(|| self.stream.as_fd())
    }

    /// The next press, if one has come. What is none breaks the link.
    pub fn press(&mut self) -> Option<FromPanel> {
        if !self.read.contains(&b'\n') && !self.broken {
            let mut block = [0; MOST_READ];
            match self.stream.read(&mut block) {
                Ok(0) => self.broken = true,
                Ok(read) => self.read.extend(&block[..read]),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
                Err(_) => self.broken = true,
            }
        }
        let Some(end) = self.read.iter().position(|byte| *byte == b'\n') else {
            self.broken |= self.read.len() > MOST_READ;
            return None;
        };
        let press = serde_json::from_slice(&self.read[..end]);
        self.read.drain(..=end);
        self.broken |= press.is_err();
        press.ok()
    }

    /// Nothing more comes: the panel shows what it has heard and goes.
    pub fn ends(&mut self) {
        self.is_free();
        // It may be gone already.
        let _ = self.stream.shutdown(Shutdown::Write);
    }

    /// Whether the panel is gone, or sends what nobody understands.
    pub fn is_broken(&self) -> bool {
        self.broken
    }

    /// How many messages did not fit.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead as _, BufReader};

    use super::*;

    fn state(number: u64) -> ToPanel {
        let padding = "x".repeat(5000);
        let fields = serde_json::json!({ "cycle": number, "padding": padding });
        ToPanel::Set(fields.as_object().cloned().unwrap_or_default())
    }

    /// Nobody reads for a hundred thousand states: nothing waits and nothing grows; then what comes is whole,
    /// in order, and the newest states come.
    #[test]
    fn a_panel_that_does_not_read_costs_nothing() {
        let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
        let mut link = Link::new(ours).expect("it need not wait");
        let mut offered = Vec::new();
        for number in 0..100_000 {
            if link.offer(&state(number)) {
                offered.push(number);
            }
            if number % 10 == 0 {
                link.answer(&ToPanel::Taken { ticket: number, cycle: number });
            }
        }
        assert!(link.dropped() > 90_000 && !link.is_broken(), "{}", link.dropped());
        assert!(link.messages() < MOST_ANSWERS + 12_000, "{} bytes wait", link.messages());
        let mut lines = BufReader::new(theirs).lines();
        let mut seen = Vec::new();
        for newest in 100_000..100_200 {
            if link.offer(&state(newest)) {
                offered.push(newest);
            }
            let line = lines.next().expect("it comes").expect("it can be read");
            match serde_json::from_str::<ToPanel>(&line).expect("a whole message") {
                ToPanel::Set(fields) => seen.extend(fields["cycle"].as_u64()),
                ToPanel::Taken { ticket, cycle } => assert_eq!(ticket, cycle),
                other => panic!("{other:?}"),
            }
        }
        assert!(!seen.is_empty() && seen == offered[..seen.len()], "in order, none between left out");
        assert!(offered.last().is_some_and(|last| *last > 100_000), "it goes on where it is now");
    }

    /// Rows that nobody takes are kept up to a bound; a state comes before those that wait, and all that were
    /// taken come whole and in order.
    #[test]
    fn rows_wait_up_to_a_bound_and_messages_go_before_them() {
        let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
        let mut link = Link::new(ours).expect("it need not wait");
        let given = (0..2000).filter(|number| link.rows(&[f64::from(*number); 1000])).count();
        assert!((500..1000).contains(&given) && !link.has_room(), "{given}");
        assert!(link.offer(&state(7)), "rows are in nobody's way");
        assert!(!link.offer(&state(8)), "one state is");
        let mut reader = BufReader::new(theirs);
        let (mut next, mut line, mut seen) = (0, String::new(), None);
        while next < given {
            link.is_free();
            line.clear();
            reader.read_line(&mut line).expect("it can be read");
            match serde_json::from_str(&line).expect("a whole message") {
                ToPanel::Rows(count) => {
                    let mut bytes = vec![0; 8 * count];
                    link.is_free();
                    std::io::Read::read_exact(&mut reader, &mut bytes).expect("they come");
                    assert_eq!(bytes[..8], (next as f64).to_le_bytes());
                    next += 1;
                }
                ToPanel::Set(_) => seen = Some(next),
                other => panic!("{other:?}"),
            }
        }
        assert!(seen.is_some_and(|seen| seen < given / 2), "{seen:?} of {given}");
    }

    /// A state that is long and on its way drops no answer.
    #[test]
    fn an_answer_goes_behind_a_state_of_any_length() {
        let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
        let mut link = Link::new(ours).expect("it need not wait");
        let long = serde_json::json!({ "padding": "x".repeat(40 * MOST_ANSWERS) });
        assert!(link.offer(&ToPanel::Set(long.as_object().cloned().unwrap_or_default())));
        assert!(!link.is_free(), "it fills the socket");
        link.answer(&ToPanel::Taken { ticket: 7, cycle: 9 });
        assert_eq!(link.dropped(), 0);
        let reads = std::thread::Builder::new().spawn(move || BufReader::new(theirs).lines().nth(1));
        let reads = reads.expect("a thread");
        while !reads.is_finished() {
            link.is_free();
        }
        let answer = reads.join().expect("it ends").expect("it comes").expect("it can be read");
        let answer = serde_json::from_str(&answer).expect("a whole message");
        assert!(matches!(answer, ToPanel::Taken { ticket: 7, cycle: 9 }));
    }

    #[test]
    fn presses_come_as_they_were_sent_and_nonsense_breaks_the_link() {
        let (ours, mut theirs) = UnixStream::pair().expect("a pair of sockets");
        let mut link = Link::new(ours).expect("it need not wait");
        assert_eq!(link.press(), None);
        theirs.write_all(b"{\"ticket\":1,\"kind\":4,\"value\":0.0}\n{\"ticket\":2,\"ki").expect("room");
        assert_eq!(link.press(), Some(FromPanel { ticket: 1, kind: 4, ..FromPanel::default() }));
        assert_eq!(link.press(), None);
        theirs.write_all(b"nd\":1,\"value\":60.5}\nstop!\n").expect("room");
        assert_eq!(link.press(), Some(FromPanel { ticket: 2, kind: 1, value: 60.5, hand: None }));
        assert!(!link.is_broken());
        assert_eq!((link.press(), link.is_broken()), (None, true));

        let (ours, mut theirs) = UnixStream::pair().expect("a pair of sockets");
        let mut link = Link::new(ours).expect("it need not wait");
        theirs.write_all(&[b'1'; 3 * MOST_READ]).expect("room");
        (0..4).for_each(|_| assert_eq!(link.press(), None));
        assert!(link.is_broken(), "a line without an end");

        let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
        let mut link = Link::new(ours).expect("it need not wait");
        drop(theirs);
        link.offer(&state(1));
        assert!(link.is_broken() && !link.offer(&state(2)), "nobody is there");
    }
}
