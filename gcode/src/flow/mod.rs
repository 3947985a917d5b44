//! Which line comes next: O-words, M98, M99.
