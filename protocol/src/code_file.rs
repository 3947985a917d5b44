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
//! What is read was written by `write` and nothing else: every other byte sequence is refused with the
//! reason, and no more memory is taken than the file is long.

use std::{
    io::{Read, Write},
    path::Path,
};

use serde::{Deserialize, Serialize};

use crate::{checksum::crc32, code::Item, refused::Refused};

/// What a file begins with.
pub const MAGIC: [u8; 4] = *b"PLMC";
/// Version of the format. Any change of [`CodeFile`] or of what it holds makes a new one.
pub const VERSION: u16 = 7;
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

/// The same, as it is read: a text is part of the bytes, so that its length is no promise that memory is
/// taken for.
#[derive(Deserialize)]
struct Content<'a> {
    program: &'a str,
    machine: &'a str,
    cycle_s: f64,
    interpolator_cycle_s: f64,
    items: Vec<Item>,
}

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
        self.check_items()?;
        let content = bincode::serde::encode_to_vec(self, bincode::config::standard())
            .map_err(|error| CodeFileError::Content(error.to_string()))?;
        let length = content.len() as u64;
        if length > LONGEST {
            return Err(CodeFileError::TooLong(length));
        }
        file.write_all(&MAGIC)?;
        file.write_all(&VERSION.to_le_bytes())?;
        file.write_all(&length.to_le_bytes())?;
        file.write_all(&crc32(&content).to_le_bytes())?;
        Ok(file.write_all(&content)?)
    }

    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`CodeFileError`] for everything that [`CodeFile::write`] did not write.
    pub fn read(file: &mut impl Read) -> Result<CodeFile, CodeFileError> {
        if field(file)? != MAGIC {
            return Err(CodeFileError::Foreign);
        }
        match u16::from_le_bytes(field(file)?) {
            VERSION => {}
            other => return Err(CodeFileError::OtherVersion(other)),
        }
        let length = u64::from_le_bytes(field(file)?);
        if length > LONGEST {
            return Err(CodeFileError::TooLong(length));
        }
        let checksum = u32::from_le_bytes(field(file)?);
        let mut content = Vec::new();
        file.take(length + 1).read_to_end(&mut content)?;
        let present = content.len() as u64;
        if present < length {
            return Err(CodeFileError::Truncated { missing: length - present });
        }
        if present > length {
            return Err(CodeFileError::Trailing);
        }
        if crc32(&content) != checksum {
            return Err(CodeFileError::Damaged);
        }
        CodeFile::from_content(&content)
    }

    /// Opens a file for a machine.
    ///
    /// # Errors
    /// As [`CodeFile::read`] and [`CodeFile::check_machine`].
    pub fn open(path: &Path, machine: &Identity) -> Result<CodeFile, CodeFileError> {
        let file = CodeFile::read(&mut std::io::BufReader::new(std::fs::File::open(path)?))?;
        file.check_machine(machine)?;
        Ok(file)
    }

    /// Whether a file holds machine code, by its ending.
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mc"))
    }

    /// Refuses a machine other than the one the program was compiled for.
    ///
    /// # Errors
    /// [`CodeFileError::OtherMachine`] if name or cycles differ.
    pub fn check_machine(&self, machine: &Identity) -> Result<(), CodeFileError> {
        let (compiled, present) = (self.machine.to_string(), machine.to_string());
        if compiled == present { Ok(()) } else { Err(CodeFileError::OtherMachine { compiled, present }) }
    }

    fn from_content(content: &[u8]) -> Result<CodeFile, CodeFileError> {
        let limited = bincode::config::standard().with_limit::<{ LONGEST as usize }>();
        let (read, used): (Content, usize) = bincode::serde::borrow_decode_from_slice(content, limited)
            .map_err(|error| CodeFileError::Content(error.to_string()))?;
        if used != content.len() {
            return Err(CodeFileError::Trailing);
        }
        let Content { program, machine, cycle_s, interpolator_cycle_s, items } = read;
        let machine = Identity { name: machine.into(), cycle_s, interpolator_cycle_s };
        let file = CodeFile { program: program.into(), machine, items };
        file.check_items()?;
        Ok(file)
    }

    fn check_items(&self) -> Result<(), CodeFileError> {
        for (number, item) in self.items.iter().enumerate() {
            let refused = |reason| CodeFileError::Item { number, line: item.line, reason };
            item.check().map_err(refused)?;
        }
        Ok(())
    }
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
