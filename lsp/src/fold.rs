//! What can be folded: subroutines, loops, branches, the contours of cycles, what a tool does. In: lines.
//! Out: ranges of lines, from 0.

use std::sync::Arc;

use gcode::Dialect;

use crate::blocks::Blocks;
use crate::scan::{Kind, Token, label_of, scan};

/// First and last line of each range.
pub(crate) fn folds(lines: &[Arc<str>], dialect: Dialect) -> Vec<(u32, u32)> {
    let mut folds = Folds::default();
    for (number, line) in (0..).zip(lines) {
        // Most lines of a long program are moves, and none of these.
        if line.bytes().any(|c| b"oOtTwWeEnNpP".contains(&c)) {
            folds.line(number, line, dialect);
        }
    }
    folds.finish(lines.len() as u32)
}

#[derive(Default)]
struct Folds {
    found: Vec<(u32, u32)>,
    open: Blocks,
    program: Option<u32>,
    tool: Option<u32>,
    /// Blocks by their numbers, and contours that were asked for: line, first, last.
    blocks: Vec<(u32, u32)>,
    contours: Vec<(u32, u32)>,
}

impl Folds {
    fn line(&mut self, number: u32, line: &str, dialect: Dialect) {
        let tokens = scan(line, dialect);
        let text = |token: &Token| &line[token.at.clone()];
        let value = |letter: char| {
            let token = tokens.iter().find(|token| token.kind == Kind::Word(letter))?;
            text(token)[1..].trim().parse::<u32>().ok()
        };
        let first = tokens.iter().find(|token| token.kind != Kind::Sign);
        if let Some(label) = first.filter(|token| token.kind == Kind::Label) {
            let (label, word) = label_of(text(label));
            if dialect != Dialect::Linuxcnc || word.is_empty() {
                self.end_program(number);
                self.program = Some(number);
            } else {
                let step = self.open.word(&label, &word, number);
                self.add(step.ends, if step.begins { number.saturating_sub(1) } else { number });
            }
        }
        if tokens.iter().any(|token| token.kind == Kind::Word('T')) {
            self.end_tool(number);
            self.tool = Some(number);
        }
        if dialect != Dialect::Linuxcnc {
            if let Some(block) = value('N') {
                self.blocks.push((block, number));
            }
            if let (Some(from), Some(to)) = (value('P'), value('Q'))
                && matches!(value('G'), Some(70..=73))
            {
                self.contours.push((from, to));
            }
            self.flow(number, line, &tokens);
        }
    }

    /// WHILE … DO n and END n.
    fn flow(&mut self, number: u32, line: &str, tokens: &[Token]) {
        for two in tokens.windows(2) {
            let [name, loops] = [0, 1].map(|at: usize| &line[two[at].at.clone()]);
            if two[0].kind != Kind::Name {
                continue;
            }
            match name.to_uppercase().as_str() {
                "DO" => self.open.begin(loops.trim(), number),
                "END" => {
                    let begun = self.open.end(loops.trim());
                    self.add(begun, number);
                }
                _ => {}
            }
        }
    }

    fn end_program(&mut self, number: u32) {
        self.end_tool(number);
        let begun = self.program.take();
        self.add(begun, number.saturating_sub(1));
    }

    fn end_tool(&mut self, number: u32) {
        let begun = self.tool.take();
        self.add(begun, number.saturating_sub(1));
    }

    /// Keeps a range of lines, if it has more than one; `from` is where it has begun, if it has.
    fn add(&mut self, from: Option<u32>, to: u32) {
        self.found.extend(from.filter(|from| to > *from).map(|from| (from, to)));
    }

    fn finish(mut self, lines: u32) -> Vec<(u32, u32)> {
        self.end_program(lines);
        let place =
            |wanted: u32| self.blocks.iter().find(|(block, _)| *block == wanted).map(|(_, line)| *line);
        let contours: Vec<_> =
            self.contours.iter().filter_map(|(from, to)| Some((place(*from)?, place(*to)?))).collect();
        for (from, to) in contours {
            self.add(Some(from), to);
        }
        self.found.sort_unstable();
        self.found.dedup();
        self.found
    }
}

#[cfg(test)]
mod tests {
    use super::folds;
    use gcode::Dialect;

    fn of(text: &str, dialect: Dialect) -> Vec<(u32, u32)> {
        folds(&text.lines().map(Into::into).collect::<Vec<_>>(), dialect)
    }

    #[test]
    fn blocks_of_both_dialects_fold() {
        let ngc = "o1 sub\no2 while [1]\no3 if [1]\nG0\no3 else\nG1\no3 endif\no2 endwhile\no1 endsub\nT1 M6\nG0\nG1\nT2\nM2";
        assert_eq!(of(ngc, Dialect::Linuxcnc), [(0, 8), (1, 7), (2, 3), (4, 6), (9, 11), (12, 13)]);
        assert_eq!(of("o1 do\nG0\no1 while [0]\no1 endsub", Dialect::Linuxcnc), [(0, 2)]);
        let fanuc =
            "O1\nG71 P10 Q20 U1.\nN10 G00 X1.\nG01 Z1.\nN20 X2.\nWHILE [1] DO 1\nG00\nEND 1\nM30\nO2\nM99";
        assert_eq!(of(fanuc, Dialect::Fanuc), [(0, 8), (2, 4), (5, 7), (9, 10)]);
    }
}
