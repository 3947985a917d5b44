//! The text of a document, edited in place. Lines and columns count from 0, columns in UTF-16 units as the
//! protocol has them.

use std::sync::Arc;

use gen_lsp_types::{Position, Range};

/// A text by its lines. A copy of it costs a counter a line.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    lines: Vec<Arc<str>>,
}

impl Text {
    pub(crate) fn new(text: &str) -> Text {
        Text { lines: split(text) }
    }

    pub(crate) fn lines(&self) -> &[Arc<str>] {
        &self.lines
    }

    pub(crate) fn line(&self, number: u32) -> &str {
        self.lines.get(number as usize).map_or("", |line| line)
    }

    /// The whole of it, with line feeds.
    pub(crate) fn source(&self) -> String {
        let mut source = String::with_capacity(self.lines.iter().map(|line| line.len() + 1).sum());
        for (number, line) in self.lines.iter().enumerate() {
            if number > 0 {
                source.push('\n');
            }
            source.push_str(line);
        }
        source
    }

    /// Puts a text in the place of a range; what lies beyond the end is the end.
    pub(crate) fn edit(&mut self, range: Range, new: &str) {
        let last = self.lines.len() - 1;
        let place = |at: Position| {
            let line = (at.line as usize).min(last);
            let column = if at.line as usize > last { u32::MAX } else { at.character };
            (line, byte_of(&self.lines[line], column))
        };
        let (from, to) = (place(range.start), place(range.end));
        let to = to.max(from);
        let joined = [&self.lines[from.0][..from.1], new, &self.lines[to.0][to.1..]].concat();
        self.lines.splice(from.0..=to.0, split(&joined));
    }
}

fn split(text: &str) -> Vec<Arc<str>> {
    text.replace("\r\n", "\n").split(['\n', '\r']).map(Arc::from).collect()
}

/// The byte at which a column begins.
pub(crate) fn byte_of(line: &str, column: u32) -> usize {
    let mut units = 0;
    for (byte, c) in line.char_indices() {
        if units >= column {
            return byte;
        }
        units += c.len_utf16() as u32;
    }
    line.len()
}

/// The column at which a byte lies.
pub(crate) fn column_of(line: &str, byte: usize) -> u32 {
    line.char_indices().take_while(|(at, _)| *at < byte).map(|(_, c)| c.len_utf16() as u32).sum()
}

/// Bytes of a line as a range of the protocol.
pub(crate) fn range(number: u32, line: &str, bytes: std::ops::Range<usize>) -> Range {
    let at = |byte| Position::new(number, column_of(line, byte));
    Range::new(at(bytes.start), at(bytes.end))
}

#[cfg(test)]
mod tests {
    use gen_lsp_types::{Position, Range};
    use testing::Seed;

    use super::{Text, byte_of, column_of};

    fn between(from: (u32, u32), to: (u32, u32)) -> Range {
        Range::new(Position::new(from.0, from.1), Position::new(to.0, to.1))
    }

    #[test]
    fn edits_replace_insert_and_join() {
        let mut text = Text::new("G0 X1\r\n(ä𝄞) X2\nM2");
        text.edit(between((0, 4), (0, 5)), "12");
        text.edit(between((1, 4), (1, 4)), "!");
        assert_eq!(text.source(), "G0 X12\n(ä𝄞!) X2\nM2");
        text.edit(between((0, 6), (1, 6)), "\nG1\n");
        assert_eq!(text.source(), "G0 X12\nG1\n X2\nM2");
        text.edit(between((1, 0), (99, 0)), "M30");
        assert_eq!(text.source(), "G0 X12\nM30");
        text.edit(between((0, 0), (99, 99)), "");
        assert_eq!((text.source().as_str(), text.lines().len()), ("", 1));
    }

    #[test]
    fn columns_are_utf_16() {
        let line = "aä𝄞b";
        for (byte, column) in [(0, 0), (1, 1), (3, 2), (7, 4), (8, 5)] {
            assert_eq!((byte_of(line, column), column_of(line, byte)), (byte, column));
        }
        assert_eq!(byte_of(line, 99), line.len());
    }

    /// Any edit is the same as that of the whole text.
    #[test]
    fn random_edits_are_those_of_the_whole() {
        let mut random = Seed::new(7);
        let mut text = Text::new("G0 X1\nG1 Z2 F3\n\nM2\n");
        for _ in 0..2000 {
            let source = text.source();
            let places: Vec<(u32, u32, usize)> = {
                let mut offset = 0;
                let lines = source.split('\n').enumerate();
                lines
                    .flat_map(|(number, line)| {
                        let begin = offset;
                        offset += line.len() + 1;
                        (0..=line.len()).map(move |column| (number as u32, column as u32, begin + column))
                    })
                    .collect()
            };
            let mut pick = || places[random.below(places.len())];
            let (a, b) = (pick(), pick());
            let (a, b) = if a.2 <= b.2 { (a, b) } else { (b, a) };
            let new = ["", "X", "\n", "G2 X1\nM5", "\r\n"][(a.2 + b.2) % 5];
            text.edit(between((a.0, a.1), (b.0, b.1)), new);
            let wanted = [&source[..a.2], &new.replace("\r\n", "\n"), &source[b.2..]].concat();
            assert_eq!(text.source(), wanted);
            if wanted.len() > 400 {
                text = Text::new(&wanted[..200]);
            }
        }
    }
}
