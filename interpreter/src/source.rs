//! The lines of a part program. In: its text. Out: the lines that belong to the program: all of them, or those
//! between the first two lines that hold a % alone.

use std::ops::Range;

/// A program, line by line.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    text: String,
    lines: Vec<Range<usize>>,
    next: usize,
    /// The program stands between two % lines.
    tape: bool,
}

/// A line and its number, from 1.
pub(crate) type Numbered<'a> = (u32, &'a str);

impl Source {
    pub(crate) fn new(text: String) -> Source {
        let mut lines = Vec::new();
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let length = line.trim_end_matches('\n').trim_end_matches('\r').len();
            lines.push(start..start + length);
            start += line.len();
        }
        let mut source = Source { text, lines, next: 0, tape: false };
        let first = source.lines.iter().position(|line| !source.text[line.clone()].trim().is_empty());
        if let Some(first) = first.filter(|first| source.is_tape_mark(*first)) {
            (source.tape, source.next) = (true, first + 1);
        }
        source
    }

    /// Takes the next line.
    pub(crate) fn take(&mut self) -> Option<Numbered<'_>> {
        let index = self.next;
        if index >= self.lines.len() || self.ends_at(index) {
            return None;
        }
        self.next += 1;
        Some(self.line(index))
    }

    /// The lines not taken yet.
    pub(crate) fn rest(&self) -> impl Iterator<Item = Numbered<'_>> {
        let end = (self.next..self.lines.len()).find(|index| self.ends_at(*index));
        (self.next..end.unwrap_or(self.lines.len())).map(|index| self.line(index))
    }

    /// Whether the next line is the % that ends the program.
    pub(crate) fn at_end_mark(&self) -> bool {
        self.next < self.lines.len() && self.ends_at(self.next)
    }

    /// Number of the last line, from 1.
    pub(crate) fn last_line(&self) -> u32 {
        self.lines.len().max(1) as u32
    }

    fn ends_at(&self, index: usize) -> bool {
        self.tape && self.is_tape_mark(index)
    }

    fn is_tape_mark(&self, index: usize) -> bool {
        self.text[self.lines[index].clone()].trim() == "%"
    }

    fn line(&self, index: usize) -> Numbered<'_> {
        (index as u32 + 1, &self.text[self.lines[index].clone()])
    }
}

#[cfg(test)]
mod tests {
    use super::Source;

    fn lines(text: &str) -> Vec<(u32, String)> {
        let mut source = Source::new(text.to_owned());
        std::iter::from_fn(|| source.take().map(|(number, line)| (number, line.to_owned()))).collect()
    }

    #[test]
    fn lines_are_numbered_and_lose_their_ends() {
        assert_eq!(lines("a\r\nb\n\nc"), [(1, "a".into()), (2, "b".into()), (3, "".into()), (4, "c".into())]);
    }

    #[test]
    fn only_what_stands_between_percent_signs_is_the_program() {
        assert_eq!(lines("\n %\nG0\n%\nrest"), [(3, "G0".into())]);
        assert_eq!(lines("G0\n%\n").len(), 2, "a % that comes later is a line like others");
    }

    #[test]
    fn the_rest_stops_at_the_end_mark() {
        let mut source = Source::new("%\na\nb\n%\nc\n".into());
        source.take();
        assert_eq!(source.rest().collect::<Vec<_>>(), [(3, "b")]);
        assert!(!source.at_end_mark());
        source.take();
        assert!(source.at_end_mark() && source.take().is_none());
    }
}
