//! Limits against published tables, the rules of each standard over any thread, and names.

mod compare;
mod reference;
mod tables;
