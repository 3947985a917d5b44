//! Machine code in a file (`.mc`), as `pitchlock compile` writes it.
//!
//! | bytes | |
//! |---|---|
//! | 4 | `PLMC` |
//! | 2 | version of the format, little-endian, [`VERSION`] |
//! | 8 | length of the content, bytes, little-endian |
//! | 4 | CRC-32 of the content, little-endian |
//! | … | content: a [`CodeFile`] through serde and bincode 2, standard configuration |
//!
//! What is read was written by a [`CodeWriter`] and nothing else: every other byte sequence is refused with
//! the reason. A writer takes items one by one and fills in the head at the end; a [`CodeReader`] looks at a
//! file twice, once for its checksum and once for its items, and gives them one by one: the memory that both
//! take does not depend on the length of the file. That matters because an item of two bytes takes hundreds
//! of times as many in memory.

use std::{
    fs::File,
    io::{BufReader, Cursor, Read, Seek, SeekFrom, Write},
    path::Path,
};

use serde::{Deserialize, Serialize};

use crate::{checksum::Crc, code::Item, refused::Refused};

/// What a file begins with.
pub const MAGIC: [u8; 4] = *b"PLMC";
/// Version of the format. Any change of [`CodeFile`] or of what it holds makes a new one.
pub const VERSION: u16 = 14;
/// Longest content that is read, bytes: a program of some ten million moves.
pub const LONGEST: u64 = 1 << 30;

/// By what a file knows the machine that it is for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Its name.
    pub name: String,
    /// Its control cycle, s.
    pub cycle_s: f64,
    /// Its interpolator cycle, s.
    pub interpolator_cycle_s: f64,
}

/// A compiled program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CodeFile {
    /// Name of the part program.
    pub program: String,
    /// The machine it was compiled for; passes are laid out for the limits of its axes.
    pub machine: Identity,
    /// The machine code.
    pub items: Vec<Item>,
}

/// What stands before the items: program, machine, control cycle, interpolator cycle, number of items.
type Beginning = (String, String, f64, f64, u64);

/// Most bytes of the beginning, or of an item.
const LONGEST_PART: usize = 1 << 16;
/// Bytes before the content.
const HEAD: u64 = 18;

/// Why a machine-code file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CodeFileError {
    /// The operating system cannot read or write it.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// Something else.
    #[error("this is not a machine-code file of pitchlock (it does not begin with PLMC)")]
    Foreign,
    /// Of another release.
    #[error(
        "this is machine code of version {0}, and version {VERSION} is needed: compile the program again"
    )]
    OtherVersion(u16),
    /// It ends before its end.
    #[error("the machine-code file is cut off: {missing} bytes are missing; compile the program again")]
    Truncated {
        /// How many bytes at least.
        missing: u64,
    },
    /// It goes on after its end.
    #[error("the machine-code file goes on after its end; compile the program again")]
    Trailing,
    /// Longer than any program.
    #[error("{0} bytes of machine code are more than a file may hold ({LONGEST})")]
    TooLong(u64),
    /// Its bytes changed after it was written.
    #[error("the machine-code file is damaged (its checksum is wrong); compile the program again")]
    Damaged,
    /// The checksum is right, but the content is not what this version writes.
    #[error("the machine-code file was not written by pitchlock: {0}")]
    Content(String),
    /// An item that no interpreter makes.
    #[error("item {number} of the machine code (line {line} of the program): {reason}")]
    Item {
        /// Number of the item, from 0.
        number: usize,
        /// Line of the part program.
        line: u32,
        /// What is wrong with it.
        reason: Refused,
    },
    /// A program has other items than those it was said to have.
    #[error(
        "it has {given} items, and {said} were counted before: it has changed meanwhile, compile it again"
    )]
    Recounted {
        /// So many were said, and
        said: u64,
        /// so many came, or one more than were said.
        given: u64,
    },
    /// Made for another machine.
    #[error(
        "compiled for machine {compiled:?}, and this is {present:?}: compile the program for this machine"
    )]
    OtherMachine {
        /// Machine named in the file, and its cycles.
        compiled: String,
        /// The machine at hand, and its cycles.
        present: String,
    },
}

impl CodeFile {
    /// A program compiled for a machine.
    pub fn new(program: &str, machine: &Identity, items: Vec<Item>) -> CodeFile {
        CodeFile { program: program.into(), machine: machine.clone(), items }
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`CodeFileError::Io`]; [`CodeFileError::Item`] for what could not be read again.
    pub fn write(&self, file: &mut impl Write) -> Result<(), CodeFileError> {
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = CodeWriter::new(&mut bytes, &self.program, &self.machine, self.items.len() as u64)?;
        self.items.iter().try_for_each(|item| writer.put(item))?;
        writer.finish()?;
        Ok(file.write_all(bytes.get_ref())?)
    }

    /// Reads and checks a file, and keeps all of its items.
    ///
    /// # Errors
    /// [`CodeFileError`] for everything that [`CodeFile::write`] did not write.
    pub fn read(file: &mut impl Read) -> Result<CodeFile, CodeFileError> {
        let mut bytes = Vec::new();
        file.take(HEAD + LONGEST + 1).read_to_end(&mut bytes)?;
        let mut reader = CodeReader::new(Cursor::new(bytes))?;
        let items = reader.by_ref().collect::<Result<_, _>>()?;
        Ok(CodeFile { program: reader.program, machine: reader.machine, items })
    }

    /// Whether a file holds machine code, by its ending.
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mc"))
    }
}

/// Writes a file item by item. It is none before all of it is there: its head comes last.
#[derive(Debug)]
pub struct CodeWriter<W> {
    file: W,
    crc: Crc,
    length: u64,
    /// Items that were put, and how many there will be.
    given: u64,
    count: u64,
}

impl<W: Write + Seek> CodeWriter<W> {
    /// Begins a file, which is empty, for the program of this name with so many items.
    ///
    /// # Errors
    /// [`CodeFileError::Io`]
    pub fn new(
        mut file: W,
        program: &str,
        machine: &Identity,
        count: u64,
    ) -> Result<CodeWriter<W>, CodeFileError> {
        file.write_all(&[0; HEAD as usize])?;
        let mut writer = CodeWriter { file, crc: Crc::new(), length: 0, given: 0, count };
        let Identity { name, cycle_s, interpolator_cycle_s } = machine;
        writer.encode(&(program, name, cycle_s, interpolator_cycle_s, count))?;
        Ok(writer)
    }

    /// The next item.
    ///
    /// # Errors
    /// [`CodeFileError::Item`] for what could not be read again; [`CodeFileError::Recounted`] behind the last
    /// one; [`CodeFileError::TooLong`]; [`CodeFileError::Io`].
    pub fn put(&mut self, item: &Item) -> Result<(), CodeFileError> {
        item.check().map_err(|reason| CodeFileError::Item {
            number: usize::try_from(self.given).unwrap_or(usize::MAX),
            line: item.line,
            reason,
        })?;
        self.given += 1;
        if self.given > self.count {
            return Err(CodeFileError::Recounted { said: self.count, given: self.given });
        }
        self.encode(item)
    }

    /// Ends the file; its length, bytes.
    ///
    /// # Errors
    /// [`CodeFileError::Recounted`] if items are missing; [`CodeFileError::Io`].
    pub fn finish(mut self) -> Result<u64, CodeFileError> {
        if self.given < self.count {
            return Err(CodeFileError::Recounted { said: self.count, given: self.given });
        }
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(&MAGIC)?;
        self.file.write_all(&VERSION.to_le_bytes())?;
        self.file.write_all(&self.length.to_le_bytes())?;
        self.file.write_all(&self.crc.sum().to_le_bytes())?;
        self.file.flush()?;
        Ok(HEAD + self.length)
    }

    /// The next part of the content.
    fn encode(&mut self, part: &impl Serialize) -> Result<(), CodeFileError> {
        let bytes = bincode::serde::encode_to_vec(part, bincode::config::standard())
            .map_err(|error| CodeFileError::Content(error.to_string()))?;
        self.length += bytes.len() as u64;
        if self.length > LONGEST {
            return Err(CodeFileError::TooLong(self.length));
        }
        self.crc.add(&bytes);
        Ok(self.file.write_all(&bytes)?)
    }
}

/// Reads a file item by item. The first error ends it.
#[derive(Debug)]
pub struct CodeReader<R> {
    /// Name of the part program.
    pub program: String,
    /// The machine it was compiled for.
    pub machine: Identity,
    content: std::io::Take<R>,
    /// Items that were given, and how many there are.
    given: u64,
    count: u64,
}

impl CodeReader<BufReader<File>> {
    /// Opens a file for a machine.
    ///
    /// # Errors
    /// As [`CodeReader::new`]; [`CodeFileError::OtherMachine`] if name or cycles differ.
    pub fn open(path: &Path, machine: &Identity) -> Result<Self, CodeFileError> {
        let reader = CodeReader::new(BufReader::new(intake::open(path)?))?;
        reader.check_machine(machine)?;
        Ok(reader)
    }
}

impl<R> CodeReader<R> {
    /// Refuses a machine other than the one the program was compiled for.
    ///
    /// # Errors
    /// [`CodeFileError::OtherMachine`] if name or cycles differ.
    pub fn check_machine(&self, machine: &Identity) -> Result<(), CodeFileError> {
        let (compiled, present) = (self.machine.to_string(), machine.to_string());
        if compiled == present { Ok(()) } else { Err(CodeFileError::OtherMachine { compiled, present }) }
    }
}

impl<R: Read + Seek> CodeReader<R> {
    /// Looks at all bytes of a file, and goes back to its first item.
    ///
    /// # Errors
    /// [`CodeFileError`] for a file that is foreign, cut off, damaged, or of another version.
    pub fn new(mut file: R) -> Result<CodeReader<R>, CodeFileError> {
        if field(&mut file)? != MAGIC {
            return Err(CodeFileError::Foreign);
        }
        match u16::from_le_bytes(field(&mut file)?) {
            VERSION => {}
            other => return Err(CodeFileError::OtherVersion(other)),
        }
        let length = u64::from_le_bytes(field(&mut file)?);
        if length > LONGEST {
            return Err(CodeFileError::TooLong(length));
        }
        let checksum = u32::from_le_bytes(field(&mut file)?);
        if checksum_of(&mut file, length)? != checksum {
            return Err(CodeFileError::Damaged);
        }
        file.seek(SeekFrom::Start(HEAD))?;
        let mut content = file.take(length);
        let (program, name, cycle_s, interpolator_cycle_s, count): Beginning = decode(&mut content)?;
        let machine = Identity { name, cycle_s, interpolator_cycle_s };
        Ok(CodeReader { program, machine, content, given: 0, count })
    }
}

impl<R: Read> CodeReader<R> {
    fn item(&mut self) -> Result<Item, CodeFileError> {
        let number = usize::try_from(self.given).unwrap_or(usize::MAX);
        let item: Item = decode(&mut self.content)?;
        item.check().map_err(|reason| CodeFileError::Item { number, line: item.line, reason })?;
        self.given += 1;
        if self.given == self.count && self.content.limit() > 0 {
            return Err(CodeFileError::Trailing);
        }
        Ok(item)
    }
}

impl<R: Read> Iterator for CodeReader<R> {
    type Item = Result<Item, CodeFileError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.given >= self.count {
            // A file without any item may go on, too.
            let goes_on = self.count == 0 && self.content.limit() > 0;
            self.content.set_limit(0);
            return goes_on.then_some(Err(CodeFileError::Trailing));
        }
        let item = self.item();
        if item.is_err() {
            self.count = self.given;
            self.content.set_limit(0);
        }
        Some(item)
    }
}

/// The checksum of so many bytes, with which a file ends.
fn checksum_of(file: &mut impl Read, length: u64) -> Result<u32, CodeFileError> {
    let (mut crc, mut left, mut block) = (Crc::new(), length, [0; 8192]);
    loop {
        let most = usize::try_from(left.saturating_add(1)).unwrap_or(usize::MAX).min(block.len());
        let present = file.read(&mut block[..most])?;
        match (present as u64, left) {
            (0, 0) => return Ok(crc.sum()),
            (0, missing) => return Err(CodeFileError::Truncated { missing }),
            (present, left) if present > left => return Err(CodeFileError::Trailing),
            (present, _) => left -= present,
        }
        crc.add(&block[..present]);
    }
}

/// The next part of the content.
fn decode<T: serde::de::DeserializeOwned>(content: &mut impl Read) -> Result<T, CodeFileError> {
    let limited = bincode::config::standard().with_limit::<LONGEST_PART>();
    bincode::serde::decode_from_std_read(content, limited)
        .map_err(|error| CodeFileError::Content(error.to_string()))
}

impl std::fmt::Display for Identity {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}, {} s, {} s", self.name, self.cycle_s, self.interpolator_cycle_s)
    }
}

/// A field of the head. A file too short for a head with the right beginning is cut off, any other is
/// foreign.
fn field<const N: usize>(file: &mut impl Read) -> Result<[u8; N], CodeFileError> {
    let mut bytes = Vec::with_capacity(N);
    file.take(N as u64).read_to_end(&mut bytes)?;
    let present = bytes.len() as u64;
    bytes.try_into().map_err(|_| CodeFileError::Truncated { missing: N as u64 - present })
}
