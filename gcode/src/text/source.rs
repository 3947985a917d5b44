//! The lines of a part program.
//!
//! In: a file, standard input or a text. Out: its lines as bytes, without their ends, each with its number;
//! and a way back to any of them. A file is never in memory as a whole: one buffer moves over it, and a jump
//! within the buffer costs no system call. What cannot seek is spooled to an unnamed temporary file first.
//! If the first line that is not blank holds a `%` alone, the program stands between it and the next such
//! line; text that is no block may stand above the first. Bytes become UTF-8 here ([`super::encoding`]),
//! UTF-16 at once, that of a file in a temporary one: what comes after knows no other text. Padding of tapes
//! (NUL, DEL) and of DOS (Ctrl-Z) at the ends of a line is left out, with all returns.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use super::encoding::{self, ByteOrder};
use super::ends::{line_end, too_long, unreadable};
use super::tape;
use crate::problem::Problem;

/// Bytes that are read at once.
const BUFFER: usize = 1 << 16;
/// Lines between the places that are kept to find a line again.
const FAR: u32 = 256;

/// What lines can be read from.
trait Input: Read + Seek {}
impl<T: Read + Seek> Input for T {}

/// The beginning of a line, to come back to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Mark {
    /// Bytes before it.
    pub(crate) offset: u64,
    /// Lines before it.
    pub(crate) lines: u32,
}

/// A line that was taken: its bytes are [`Source::bytes`] until the next one is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Line {
    /// Where it begins.
    pub(crate) mark: Mark,
    start: usize,
    end: usize,
    /// It was not UTF-8: the text is [`Source::foreign`].
    foreign: bool,
    /// It is longer than a line may be, padding included.
    long: bool,
}

impl Line {
    /// Its number, from 1.
    pub(crate) fn number(&self) -> u32 {
        self.mark.lines + 1
    }
}

/// A program, line by line.
pub(crate) struct Source {
    name: Arc<str>,
    input: Box<dyn Input>,
    buffer: Vec<u8>,
    /// Bytes of the buffer that hold text, and the place of the first of them in the input.
    filled: usize,
    base: u64,
    /// The byte of the buffer at which the next line begins, and the lines before it.
    next: usize,
    lines: u32,
    longest: usize,
    /// Bytes before the text, and the byte that ends a line.
    first: u64,
    ends: u8,
    /// The line that was taken last, if it was not UTF-8.
    foreign: String,
    /// The program stands between two % lines.
    tape: bool,
    /// Its second % was met.
    closed: bool,
    beginning: Mark,
    /// The last line of the text above the first %, 0 without one; and whether it is remarks alone.
    leader: u32,
    remarks: bool,
    /// Two lines that were taken not long ago, [`FAR`] lines apart: a text that is asked for again is near.
    recent: [Mark; 2],
}

impl Source {
    /// Opens a file. `longest`: bytes that a line may have.
    ///
    /// # Errors
    /// The file cannot be opened or read.
    pub(crate) fn open(path: &Path, longest: usize) -> io::Result<Source> {
        let file = encoding::file_in_utf8(intake::open(path)?)?;
        Ok(Source::of_file(&path.display().to_string(), file, longest))
    }

    fn of_file(name: &str, file: File, longest: usize) -> Source {
        Source::new(name, Box::new(file), longest, usize::MAX)
    }

    /// Reads a text.
    pub(crate) fn from_text(name: &str, text: Vec<u8>, longest: usize) -> Source {
        let text = encoding::text_in_utf8(text);
        let room = text.len() + 1;
        Source::new(name, Box::new(Cursor::new(text)), longest, room)
    }

    /// Reads what cannot seek to its end and goes on from a temporary file that has no name.
    ///
    /// # Errors
    /// The input cannot be read, or the temporary file cannot be made or written.
    pub(crate) fn from_reader(name: &str, mut reader: impl Read, longest: usize) -> io::Result<Source> {
        let mut file = intake::unnamed()?;
        io::copy(&mut reader, &mut file)?;
        file.rewind()?;
        Ok(Source::of_file(name, encoding::file_in_utf8(file)?, longest))
    }

    /// `room`: no larger buffer is needed.
    fn new(name: &str, input: Box<dyn Input>, longest: usize, room: usize) -> Source {
        let mut source = Source {
            name: name.into(),
            input,
            buffer: vec![0; BUFFER.max(2 * longest + 2).min(room)],
            filled: 0,
            base: 0,
            next: 0,
            lines: 0,
            longest,
            first: 0,
            ends: b'\n',
            foreign: String::new(),
            tape: false,
            closed: false,
            beginning: Mark::default(),
            leader: 0,
            remarks: true,
            recent: [Mark::default(); 2],
        };
        if source.begin().and_then(|()| source.find_tape()).is_err() {
            // What cannot be read is reported when the first line is taken.
            (source.next, source.lines) = (0, 0);
        }
        source
    }

    /// Reads the first bytes: how the text is written, and what ends its lines.
    fn begin(&mut self) -> io::Result<()> {
        self.refill()?;
        if let ByteOrder::Utf8 = ByteOrder::of(self.buffer.get(..self.filled).unwrap_or(&[])) {
            self.first = 3;
        }
        let text = self.buffer.get(..self.filled).unwrap_or(&[]);
        if text.contains(&b'\r') && !text.contains(&b'\n') {
            self.ends = b'\r';
        }
        self.beginning.offset = self.first;
        self.recent = [self.beginning; 2];
        self.go(self.beginning)
    }

    /// Looks for the `%` that may come first, or behind text, and stands after it or at the beginning.
    fn find_tape(&mut self) -> io::Result<()> {
        let mut last = 0;
        while let Some(line) = self.raw_line()? {
            let text = self.bytes(&line).trim_ascii();
            if text == b"%" {
                let beginning = self.mark();
                if last == 0 || self.goes_on()? {
                    (self.tape, self.beginning, self.leader) = (true, beginning, last);
                }
                break;
            }
            let (is_blank, is_remark) = (text.is_empty(), tape::is_remark(text));
            if !tape::is_text(text) || line.number() > tape::LONGEST {
                break;
            }
            if !is_blank {
                last = line.number();
                self.remarks &= is_remark;
            }
        }
        self.go(self.beginning)
    }

    /// Whether anything but blanks follows.
    fn goes_on(&mut self) -> io::Result<bool> {
        while let Some(line) = self.raw_line()? {
            if !self.bytes(&line).trim_ascii().is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Reads what stands above the first `%` as LinuxCNC does: that `%` begins nothing. `all`: not only
    /// remarks.
    pub(crate) fn keep_leader(&mut self, all: bool) {
        if (all || self.remarks) && std::mem::take(&mut self.leader) > 0 {
            self.tape = false;
            self.beginning = Mark { offset: self.first, lines: 0 };
            // What cannot be read is reported when the first line is taken.
            let _ = self.go(self.beginning);
        }
    }

    /// The last line of a text that stands above the first `%` and is no part of the program.
    pub(crate) fn leader(&self) -> Option<u32> {
        (self.leader > 0).then_some(self.leader)
    }

    /// Name of the file.
    pub(crate) fn name(&self) -> &Arc<str> {
        &self.name
    }

    /// Whether the program stands between `%` lines.
    pub(crate) fn is_tape(&self) -> bool {
        self.tape
    }

    /// Whether the `%` that ends the program was met.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed
    }

    /// Where the program begins: after the first `%`, if there is one.
    pub(crate) fn beginning(&self) -> Mark {
        self.beginning
    }

    /// Where the next line begins.
    pub(crate) fn mark(&self) -> Mark {
        Mark { offset: self.base + self.next as u64, lines: self.lines }
    }

    /// Goes to a place where a line begins; it is taken next.
    ///
    /// # Errors
    /// The input cannot seek.
    pub(crate) fn go(&mut self, mark: Mark) -> io::Result<()> {
        self.lines = mark.lines;
        let offset = mark.offset.max(self.first);
        match offset.checked_sub(self.base).map(usize::try_from) {
            Some(Ok(next)) if next <= self.filled => self.next = next,
            _ => {
                self.input.seek(SeekFrom::Start(offset))?;
                (self.base, self.next, self.filled) = (offset, 0, 0);
            }
        }
        Ok(())
    }

    /// Takes the next line; `None` at the end of the program (of the file, or at its second `%`).
    ///
    /// # Errors
    /// The line is longer than may be, or the file cannot be read. The next call goes on after it.
    pub(crate) fn take(&mut self) -> Result<Option<Line>, Box<Problem>> {
        let number = self.lines + 1;
        let line = self.raw_line().map_err(|error| unreadable(number, &error))?;
        let Some(mut line) = line else { return Ok(None) };
        let last = self.recent[1];
        if last.lines.abs_diff(line.mark.lines) >= FAR {
            self.recent = [last, line.mark];
        }
        if line.long {
            return Err(too_long(number, self.longest));
        }
        let text = self.bytes(&line);
        if self.tape && text.trim_ascii() == b"%" {
            self.closed = true;
            return self.go(line.mark).map(|()| None).map_err(|error| unreadable(number, &error));
        }
        if let Some(text) = encoding::foreign(text) {
            (self.foreign, line.foreign) = (text, true);
        }
        Ok(Some(line))
    }

    /// The bytes of the line taken last.
    pub(crate) fn bytes(&self, line: &Line) -> &[u8] {
        if line.foreign {
            return self.foreign.as_bytes();
        }
        self.buffer.get(line.start..line.end).unwrap_or(&[])
    }

    /// The text of a line of any number, read again; what cannot be printed becomes `?`.
    pub(crate) fn text(&mut self, number: u32) -> String {
        let back = self.mark();
        let text = self.text_at(number).unwrap_or_default();
        match self.go(back) {
            Ok(()) => text,
            Err(_) => String::new(),
        }
    }

    /// All lines of a text as they are read, each with a line feed at its end; those above the first % blank.
    pub(crate) fn whole(text: &[u8]) -> String {
        let mut source = Source::from_text("", text.to_vec(), text.len());
        let (mut whole, begun) = (String::new(), source.go(Mark::default()));
        while let (Ok(()), Ok(Some(line))) = (&begun, source.raw_line()) {
            if line.number() > source.leader {
                whole += &encoding::printable(source.bytes(&line));
            }
            whole.push('\n');
        }
        whole
    }

    fn text_at(&mut self, number: u32) -> io::Result<String> {
        let before = self.recent.into_iter().filter(|mark| mark.lines < number);
        self.go(before.max_by_key(|mark| mark.lines).unwrap_or_default())?;
        while let Some(line) = self.raw_line()? {
            if line.number() == number {
                return Ok(encoding::printable(self.bytes(&line)));
            }
        }
        Ok(String::new())
    }

    /// The next line of the file; one that is too long is cut right after its limit.
    fn raw_line(&mut self) -> io::Result<Option<Line>> {
        let mut searched = 0;
        loop {
            let unread = self.buffer.get(self.next..self.filled).unwrap_or(&[]);
            if let Some(length) = line_end(unread.get(searched..).unwrap_or(&[]), self.ends) {
                let length = searched + length;
                return Ok(Some(self.cut(length, length + 1)));
            }
            searched = unread.len();
            if searched > self.longest + 1 {
                let line = self.cut(self.longest + 1, 0);
                self.skip_rest()?;
                return Ok(Some(Line { long: true, ..line }));
            }
            if self.refill()? == 0 {
                let last = self.filled - self.next;
                return Ok((last > 0).then(|| self.cut(last, last)));
            }
        }
    }

    /// Makes the next `length` bytes a line and goes on after `whole` bytes.
    fn cut(&mut self, length: usize, whole: usize) -> Line {
        let (mark, start) = (self.mark(), self.next);
        let text = self.buffer.get(start..start + length).unwrap_or(&[]);
        let before = text.iter().take_while(|byte| matches!(byte, b'\r' | 0 | 0x7f)).count();
        let rest = text.get(before..).unwrap_or(&[]);
        let after = rest.iter().rev().take_while(|byte| matches!(byte, b'\r' | 0 | 0x7f | 0x1a)).count();
        let (start, end) = (start + before, start + length - after);
        self.next += whole;
        self.lines += 1;
        let long = length - usize::from(rest.ends_with(b"\r")) > self.longest;
        Line { mark, start, end, foreign: false, long }
    }

    /// Goes after the end of the line, keeping the bytes before it in the buffer.
    fn skip_rest(&mut self) -> io::Result<()> {
        let lines = self.lines;
        let mut offset = self.base + self.next as u64;
        let mut chunk = [0; 4096];
        self.input.seek(SeekFrom::Start(offset))?;
        loop {
            let read = self.input.read(&mut chunk)?;
            let end = line_end(chunk.get(..read).unwrap_or(&[]), self.ends);
            offset += end.map_or(read, |end| end + 1) as u64;
            if end.is_some() || read == 0 {
                break;
            }
        }
        // The buffer still shows the line that is refused; the next one is read anew.
        self.input.seek(SeekFrom::Start(offset))?;
        (self.base, self.lines) = (offset, lines);
        (self.next, self.filled) = (0, 0);
        Ok(())
    }

    /// Moves what is not taken yet to the front of the buffer and reads more after it.
    fn refill(&mut self) -> io::Result<usize> {
        self.buffer.copy_within(self.next..self.filled, 0);
        (self.base, self.filled) = (self.base + self.next as u64, self.filled - self.next);
        self.next = 0;
        let Some(room) = self.buffer.get_mut(self.filled..) else { return Ok(0) };
        let read = loop {
            match self.input.read(room) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                other => break other?,
            }
        };
        self.filled += read;
        Ok(read)
    }
}
