//! What the pages of the language say is what the language does: every example is run, every code is in a
//! table, every diagnostic is explained.
//!
//! An example is a fence of a language page. Its first line says how it is run and what it must lead to:
//! ```text
//! ngc, nc-fanuc       the dialect; the canonical calls are made and thrown away
//! machine             run for the built-in lathe as well
//! error=a,b           the codes of its diagnostics, in alphabetic order; without it there must be none
//! file=o100.ngc       a subroutine file for the examples of this page; it is not run itself
//! ```
//! Rows of a table behind `<!-- run: … -->` are examples, too: the code in the first cell, the program in the
//! third, its lines divided by ⏎, the last one (M2, M30) left out.

mod codes;
mod diagnostics;
mod examples;
mod jobs;
mod pages;
