//! A program that is read forward to a line, for whoever begins there. In: the program before its next line.
//! Out: which line that is, and what stands in the way of beginning there.

use super::Program;
use super::reader::Reader;

/// Why a program cannot be begun before its next line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Waits {
    /// The last move of a contour with cutter compensation ends where the next one says.
    Contour,
    /// A corner is rounded or chamfered by the next move.
    Corner,
}

impl Program {
    /// Number of the line of the program itself that is read next, from 1; none while a subroutine is
    /// executed. Lines that a loop repeats have the number behind it.
    pub fn next_line(&self) -> Option<u32> {
        let files = self.reader.files();
        (self.reader.depth() == 0 && files.current() == 0).then(|| files.mark().lines + 1)
    }

    /// Number of the line that was read last, if it is one of the program's own file, and not of a file of a
    /// subroutine.
    pub fn line_read(&self) -> Option<u32> {
        let place = self.reader.block().place();
        (place.file == 0).then_some(place.line)
    }

    /// Whether a loop is open.
    pub fn is_in_loop(&self) -> bool {
        match &self.reader {
            Reader::Ngc(reader) => reader.is_in_loop(),
            Reader::Fanuc(reader) => reader.is_in_loop(),
            Reader::Job(_) => false,
        }
    }

    /// What was read and waits for what follows.
    pub fn waits(&self) -> Option<Waits> {
        let corner = matches!(&self.reader, Reader::Fanuc(reader) if reader.is_at_corner());
        match self.waiting.is_empty() {
            _ if corner => Some(Waits::Corner),
            true => None,
            false => Some(Waits::Contour),
        }
    }

    /// Parameters that are not 0, or variables that are not vacant, with their names: #1 to #30 of the
    /// program and #31 to #999 (of FANUC the common ones), then global names.
    pub fn variables(&self) -> Vec<(String, f64)> {
        let shared = |number: u32| self.reader.shared(number);
        let own = |number: u32| Some(self.state.parameter(number)).filter(|value| *value != 0.0);
        let value = |number: u32| shared(number).unwrap_or_else(|| own(number));
        let numbered = (1..1000).filter_map(|number| Some((format!("#{number}"), value(number)?)));
        numbered.chain(self.state.memory.globals_in_force()).collect()
    }
}
