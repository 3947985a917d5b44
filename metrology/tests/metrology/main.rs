//! Limits against published tables, the rules of each standard over any thread, and names.

mod compare;
mod names;
mod page;
mod reference;
mod rules;
mod tables;
