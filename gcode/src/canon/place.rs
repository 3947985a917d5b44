//! Where a call comes from.

/// Where a call comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// File: 0 is the program, others are subroutine files in the order they were opened.
    pub file: u16,
    /// Line, from 1.
    pub line: u32,
    /// N word of the line that was being read when the call was made: moves that wait for the next one
    /// (compensation) are sent while a later line is read.
    pub n: Option<u32>,
    /// How many digits N was written with, so that N0010 can be printed as it stands; 0 with a blank after
    /// the N.
    pub n_digits: u8,
}
