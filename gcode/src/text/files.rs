//! The files of a program. In: the program, and folders with subroutine files. Out: the line that comes next,
//! in whichever file the program is.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::source::{Line, Mark, Source};
use crate::problem::{Blame, Problem};

/// More files than this no program has.
const MOST: usize = u16::MAX as usize;

/// The program (file 0) and the subroutine files in the order they were opened.
pub(crate) struct Files {
    sources: Vec<Source>,
    current: usize,
    folders: Vec<PathBuf>,
    longest: usize,
    /// Bytes that subroutine files may have, and how many of them are left.
    limit: u64,
    left: u64,
}

impl Files {
    /// `limit`: bytes of all subroutine files; `longest`: bytes of a line.
    pub(crate) fn new(program: Source, folders: Vec<PathBuf>, limit: u64, longest: usize) -> Files {
        Files { sources: vec![program], current: 0, folders, longest, limit, left: limit }
    }

    /// The file that the program is in.
    pub(crate) fn current(&self) -> usize {
        self.current
    }

    /// A file.
    pub(crate) fn get(&self, file: usize) -> Option<&Source> {
        self.sources.get(file)
    }

    /// A file, to read a line of it again.
    pub(crate) fn get_mut(&mut self, file: usize) -> Option<&mut Source> {
        self.sources.get_mut(file)
    }

    /// Takes the next line; `None` at the end of the file.
    ///
    /// # Errors
    /// The line is too long, or the file cannot be read.
    #[inline]
    pub(crate) fn take(&mut self) -> Result<Option<Line>, Box<Problem>> {
        match self.sources.get_mut(self.current) {
            Some(source) => source.take(),
            None => Ok(None),
        }
    }

    /// The bytes of the line taken last.
    #[inline]
    pub(crate) fn bytes(&self, line: &Line) -> &[u8] {
        self.sources.get(self.current).map_or(&[], |source| source.bytes(line))
    }

    /// Where the next line begins.
    pub(crate) fn mark(&self) -> Mark {
        self.sources.get(self.current).map_or(Mark::default(), Source::mark)
    }

    /// Goes to a line of a file.
    ///
    /// # Errors
    /// The file cannot seek.
    pub(crate) fn go(&mut self, file: usize, mark: Mark) -> Result<(), Box<Problem>> {
        self.current = file;
        match self.sources.get_mut(file).map(|source| source.go(mark)) {
            Some(Err(error)) => {
                let message = format!("line {} cannot be gone to: {error}", mark.lines + 1);
                let help = "copy the program to a disk that can be read";
                Err(Problem::error("unreadable", Blame::Block, message, help))
            }
            _ => Ok(()),
        }
    }

    /// Opens the file of a subroutine, `stem.ngc` in the first folder that has it; `None` if none has.
    ///
    /// # Errors
    /// It cannot be read, or is too large.
    pub(crate) fn open(&mut self, stem: &str) -> Result<Option<usize>, Box<Problem>> {
        for path in self.candidates(stem) {
            match intake::open(&path) {
                Ok(file) => return self.load(&path, file).map(Some),
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                Err(error) => return Err(unreadable(&path, &error)),
            }
        }
        Ok(None)
    }

    /// Opens a file by its whole name, in the first folder that has it; `None` if none has.
    ///
    /// # Errors
    /// It cannot be read, or is too large.
    pub(crate) fn open_file(&mut self, name: &str) -> Result<Option<usize>, Box<Problem>> {
        let paths: Vec<PathBuf> = self.folders.iter().map(|folder| folder.join(name)).collect();
        for path in paths {
            match intake::open(&path) {
                Ok(file) => return self.load(&path, file).map(Some),
                Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::IsADirectory) => {}
                Err(error) => return Err(unreadable(&path, &error)),
            }
        }
        Ok(None)
    }

    /// The files that are looked for: none for names that would lead out of the folders.
    pub(crate) fn candidates(&self, stem: &str) -> Vec<PathBuf> {
        if stem.contains(['/', '\\']) || stem.starts_with('.') {
            return Vec::new();
        }
        self.folders.iter().map(|folder| folder.join(format!("{stem}.ngc"))).collect()
    }

    fn load(&mut self, path: &Path, file: File) -> Result<usize, Box<Problem>> {
        let mut text = Vec::new();
        file.take(self.left + 1).read_to_end(&mut text).map_err(|error| unreadable(path, &error))?;
        let Some(left) = self.left.checked_sub(text.len() as u64).filter(|_| self.sources.len() < MOST)
        else {
            let message = format!(
                "with {} the subroutine files have more than {} bytes, the limit subroutine_bytes",
                path.display(),
                self.limit
            );
            let help = "make them smaller, or call fewer of them";
            return Err(Problem::error("file-too-large", Blame::Block, message, help));
        };
        self.left = left;
        self.sources.push(Source::from_text(&path.display().to_string(), text, self.longest));
        Ok(self.sources.len() - 1)
    }
}

fn unreadable(path: &Path, error: &io::Error) -> Box<Problem> {
    let message = format!("the subroutine file {} cannot be read: {error}", path.display());
    Problem::error("unreadable", Blame::Block, message, "check the file and who may read it")
}
