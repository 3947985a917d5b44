//! A program as the house writes it. In: lines of either dialect. Out: the same lines with one blank between
//! words and none in them, letters of words large, blocks between O words set in by two blanks each, nothing
//! behind their ends.
//!
//! What a program means does not change by it: comments, expressions, names and the digits of numbers stay as
//! they are, and a line that is not a row of words keeps all but the blanks around it.

use gcode::Dialect;

use crate::blocks::Blocks;
use crate::scan::{Kind, Token, label_of, scan};

const STEP: usize = 2;

/// The lines as they should be; `None` for one that stays as it is.
pub fn formatted<'a>(
    lines: impl IntoIterator<Item = &'a str>,
    dialect: Dialect,
) -> impl Iterator<Item = Option<String>> {
    let mut open = Blocks::default();
    lines.into_iter().map(move |line| {
        let tokens = scan(line, dialect);
        let level = depth(line, &tokens, dialect, &mut open);
        let new = written(line, &tokens, level);
        (new != line).then_some(new)
    })
}

/// How deep a line is in blocks of O words; `open` are those that it leaves open.
fn depth(line: &str, tokens: &[Token], dialect: Dialect, open: &mut Blocks) -> usize {
    let first = tokens.iter().find(|token| token.kind != Kind::Sign);
    let Some(first) = first.filter(|first| dialect == Dialect::Linuxcnc && first.kind == Kind::Label) else {
        return open.depth();
    };
    let (label, word) = label_of(&line[first.at.clone()]);
    let step = open.word(&label, &word, 0);
    open.depth() - usize::from(step.begins)
}

/// A line set in by so many steps.
fn written(line: &str, tokens: &[Token], level: usize) -> String {
    let ends_in_blanks = tokens.last().is_some_and(|last| line[last.at.clone()].starts_with(';'));
    let text = if ends_in_blanks { line } else { line.trim_end() };
    let Some(first) = tokens.first() else { return text.trim().to_owned() };
    let begins = &line[first.at.clone()];
    // What counts only at the beginning of a line is left where it is; and so is what may be anything.
    if begins.starts_with([';', '/', '%']) || !line.is_ascii() || line.contains('\0') {
        return text.to_owned();
    }
    let set_in = " ".repeat(level * STEP);
    if first.kind == Kind::Comment && level == 0 {
        // A comment on a line of its own may be in line with those above it.
        return text.to_owned();
    }
    match row(line, tokens) {
        Some(row) => set_in + &row,
        None => set_in + text.trim_start(),
    }
}

/// A row of words and comments, or of values that are set; `None` of anything else.
fn row(line: &str, tokens: &[Token]) -> Option<String> {
    let mut row = String::new();
    let mut tokens = tokens.iter().peekable();
    let mut end = 0;
    while let Some(token) = tokens.next() {
        let text = &line[token.at.clone()];
        let gap = &line[end..token.at.start];
        end = token.at.end;
        match token.kind {
            Kind::Comment if row.is_empty() => row.push_str(text),
            // Comments behind words may stand in a column.
            Kind::Comment => row.extend([if gap.is_empty() { " " } else { gap }, text]),
            Kind::Word(letter) => {
                if !row.is_empty() {
                    row.push(' ');
                }
                row.push(letter);
                let number: String = text.chars().skip(1).filter(|c| !c.is_whitespace()).collect();
                if number.is_empty() {
                    end = value(line, end, &mut tokens)?;
                    row.push_str(line[token.at.end..end].trim());
                } else {
                    row.push_str(&number);
                }
            }
            _ => return None,
        }
    }
    Some(row)
}

/// The end of a value that is a parameter, or an expression in brackets.
fn value<'a>(
    line: &str,
    from: usize,
    tokens: &mut std::iter::Peekable<impl Iterator<Item = &'a Token>>,
) -> Option<usize> {
    let (mut depth, mut end) = (0_i32, from);
    loop {
        let token = tokens.next()?;
        let text = &line[token.at.clone()];
        end = token.at.end.max(end);
        match (token.kind, text) {
            (Kind::Comment, _) => return None,
            (_, "[") => depth += 1,
            (_, "]") => depth -= 1,
            (Kind::Sign, _) => {}
            _ if depth > 0 => {}
            (Kind::Parameter, _) => {}
            _ => return None,
        }
        let goes_on = depth > 0 || matches!(text, "-" | "+" | "#");
        if !goes_on {
            return (depth == 0).then_some(end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::formatted;
    use gcode::Dialect;

    fn written(text: &str, dialect: Dialect) -> String {
        let lines = formatted(text.lines(), dialect);
        text.lines().zip(lines).map(|(line, new)| new.unwrap_or_else(|| line.to_owned()) + "\n").collect()
    }

    #[test]
    fn rows_of_words_are_spaced() {
        let ngc = "g0x1 0.5y-2(to)z[#1 + 2]f#<in>    ; here  \nn10g1 z-1   \n o1 if [1]\nm3s100\n(deep)\no1 else\n;@ x\n/g0x1 \no1 endif\n#1=3\n";
        let wanted = "G0 X10.5 Y-2 (to) Z[#1 + 2] F#<in>    ; here  \nN10 G1 Z-1\no1 if [1]\n  M3 S100\n  (deep)\no1 else\n;@ x\n/g0x1\no1 endif\n#1=3\n";
        assert_eq!(written(ngc, Dialect::Linuxcnc), wanted);
        assert_eq!(written(wanted, Dialect::Linuxcnc), wanted, "once is enough");
        let fanuc = "O1000(A)\ng00x42.z2.t0101\nif[#1eq2]goto10\ng01x#101,r2.\nG65P9100A-10.B[#1*2]\n";
        let wanted = "O1000(A)\nG00 X42. Z2. T0101\nif[#1eq2]goto10\ng01x#101,r2.\nG65 P9100 A-10. B[#1*2]\n";
        assert_eq!(written(fanuc, Dialect::Fanuc), wanted);
    }
}
