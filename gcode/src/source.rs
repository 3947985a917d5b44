//! The lines of a program, in constant memory, with a way back for loops and subroutines.
