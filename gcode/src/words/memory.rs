//! Parameters: numbered, named and those of the calls of subroutines.
