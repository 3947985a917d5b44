//! Reads jobs. In: lines that begin with `;@`, or a file that is nothing but a job. Out: a [`Job`].

use super::files::Files;
use super::source::Line;
use crate::canon::Job;
use crate::problem::{Blame, Problem};

/// How a line of a job begins.
const MARK: &str = ";@";
/// Most bytes of a job.
pub(crate) const LONGEST: usize = 512 << 10;

/// Whether a line belongs to a job.
pub(crate) fn begins(line: &[u8]) -> bool {
    line.trim_ascii_start().starts_with(MARK.as_bytes())
}

/// What a line of a job holds behind its mark; `None` of any other line.
pub fn job_line(line: &str) -> Option<&str> {
    line.trim_ascii_start().strip_prefix(MARK)
}

/// Whether a comment after a semicolon looks like a line of a job without being one.
pub(crate) fn is_nearly(comment: &str) -> bool {
    let text = comment.trim_start_matches(';');
    text.starts_with('@') || (text.trim_start().starts_with('@') && text.contains('='))
}

/// Reads a job to its end. `first` is its first line, which has been taken.
///
/// # Errors
/// A line that is not text, a job that is too long, or a file that cannot be read.
pub(crate) fn read(files: &mut Files, first: &Line) -> Result<Job, Box<Problem>> {
    let mut job = Job { line: first.number(), ..Job::default() };
    let mut bytes = blanked(files.bytes(first));
    loop {
        append(&mut job, &bytes)?;
        let (file, mark) = (files.current(), files.mark());
        let Some(line) = files.take()? else { return Ok(job) };
        if !begins(files.bytes(&line)) {
            files.go(file, mark)?;
            return Ok(job);
        }
        bytes = blanked(files.bytes(&line));
    }
}

/// Reads a file that is a job.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_file(files: &mut Files) -> Result<Job, Box<Problem>> {
    let mut job = Job { line: 1, is_file: true, ..Job::default() };
    while let Some(line) = files.take()? {
        let bytes = files.bytes(&line).to_vec();
        append(&mut job, &bytes)?;
    }
    Ok(job)
}

/// Adds a line to the text of a job.
fn append(job: &mut Job, line: &[u8]) -> Result<(), Box<Problem>> {
    let refuse = |job: &Job, message: &str, help: &str| {
        let line = job.line + job.text.matches('\n').count() as u32;
        Problem::error("job", Blame::Line(line), message, help)
    };
    let Ok(line) = std::str::from_utf8(line) else {
        return Err(refuse(job, "a line of a job is not UTF-8 text", "save the file as UTF-8"));
    };
    if job.text.len() + line.len() >= LONGEST {
        return Err(refuse(job, "a job has at most 512 KiB", "write it shorter"));
    }
    job.text.push_str(line.trim_end());
    job.text.push('\n');
    Ok(())
}

/// A line with blanks for its mark.
fn blanked(line: &[u8]) -> Vec<u8> {
    let mut bytes = line.to_vec();
    let at = bytes.len() - bytes.trim_ascii_start().len();
    bytes.iter_mut().skip(at).take(MARK.len()).for_each(|byte| *byte = b' ');
    bytes
}
