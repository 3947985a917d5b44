//! A program, block by block.
