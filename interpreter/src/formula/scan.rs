//! The words of a formula with their places. What passes here is well formed but for the order of its
//! operations.

use core::f64::consts;
use std::ops::Range;

use shape::{Function, Op};

use super::Misread;

/// Deepest nesting of brackets.
const DEEPEST: usize = 64;

/// What a word is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A number, a constant or a variable, as the operation that pushes it.
    Operand(Op),
    /// A function and its name.
    Function(Function, &'static str),
    /// `+ - * / ^`, a bracket.
    Sign(char),
}

/// A word of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Word {
    pub(super) kind: Kind,
    /// Bytes of the text.
    pub(super) span: Range<usize>,
}

/// Functions by their names.
const FUNCTIONS: [(&str, Function); 12] = [
    ("sqrt", Function::Sqrt),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
];

/// Names that mean something elsewhere, and what to write here.
const ELSEWHERE: [(&[&str], &str, &str); 5] = [
    (
        &["abs", "min", "max", "sign", "signum", "sgn", "if"],
        "has places without a tangent",
        "a path must be smooth: sqrt(u^2 + 1e-4) rounds the corner of abs(u); or write the job in parts",
    ),
    (
        &["floor", "ceil", "round", "trunc", "fract", "frac", "int", "mod"],
        "has steps",
        "a path must be smooth: write the job in parts, each with its own domain",
    ),
    (
        &["log", "log10", "lg", "log2"],
        "is not known",
        "write ln(u) for the natural logarithm, ln(u)/ln(10) for lg",
    ),
    (&["atan2", "hypot", "pow"], "takes two arguments", "write atan(u/v), sqrt(u^2 + v^2), u^v"),
    (&["cbrt", "cot", "sec", "csc"], "is not known", "write u^(1/3), 1/tan(u), 1/cos(u), 1/sin(u)"),
];

/// The words of `text`.
pub(super) fn scan(text: &str, variables: &[&str]) -> Result<Vec<Word>, Misread> {
    let mut words: Vec<Word> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let end = at + length(&text[at..], first);
        let span = at..end;
        at = end;
        if first.is_whitespace() {
            continue;
        }
        let kind = kind(text, &span, first, variables)?;
        follows(text, &words, kind, &span)?;
        match kind {
            Kind::Sign('(') if open.len() == DEEPEST => {
                let message = format!("more than {DEEPEST} brackets in one another");
                return Err(Misread::new(span, message, "write it with fewer brackets"));
            }
            Kind::Sign('(') => open.push(span.start),
            Kind::Sign(')') if open.pop().is_none() => {
                return Err(Misread::new(span, "this bracket was not opened", "open it, or take it away"));
            }
            _ => {}
        }
        words.push(Word { kind, span });
    }
    if wants_operand(words.last()) {
        let message = if words.is_empty() { "the formula is empty" } else { "the formula ends too early" };
        return Err(Misread::new(
            text.len()..text.len(),
            message,
            "write a number, a variable or a function here",
        ));
    }
    match open.last() {
        Some(start) => Err(Misread::new(*start..*start + 1, "this bracket is not closed", "close it with )")),
        None => Ok(words),
    }
}

/// Bytes of the word that begins with `first`.
fn length(text: &str, first: char) -> usize {
    let name = |c: char| c.is_alphanumeric() || c == '_';
    let run = |from: usize, good: &dyn Fn(char) -> bool| {
        text[from..].find(|c: char| !good(c)).map_or(text.len(), |end| from + end)
    };
    if first.is_ascii_digit() || first == '.' {
        let digit = |c: char| c.is_ascii_digit();
        let mut end = run(0, &digit);
        if text[end..].starts_with('.') {
            end = run(end + 1, &digit);
        }
        let exponent =
            text[end..].strip_prefix(['e', 'E']).map(|rest| rest.strip_prefix(['+', '-']).unwrap_or(rest));
        match exponent {
            Some(digits) if digits.starts_with(digit) => run(text.len() - digits.len(), &digit),
            _ => end,
        }
    } else if name(first) {
        run(0, &name)
    } else {
        first.len_utf8()
    }
}

/// What the word at `span` is.
fn kind(text: &str, span: &Range<usize>, first: char, variables: &[&str]) -> Result<Kind, Misread> {
    let word = &text[span.clone()];
    let wrong = |message: String, help: &str| Err(Misread::new(span.clone(), message, help));
    match first {
        '+' | '-' | '*' | '/' | '^' | '(' | ')' => Ok(Kind::Sign(first)),
        '0'..='9' | '.' => match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Kind::Operand(Op::Constant(value))),
            _ => wrong(
                format!("{word} is not a number that a machine can hold"),
                "write a decimal such as 0.02 or 2e-2",
            ),
        },
        ',' => {
            wrong("there is no comma in a formula".into(), "decimals have a point, functions one argument")
        }
        '[' | ']' | '{' | '}' => wrong(format!("{first} is not a bracket of a formula"), "write ( and )"),
        '%' => wrong("the remainder has steps".into(), "a path must be smooth: write the job in parts"),
        '#' => {
            let help = "parameters such as #1 are not read in jobs: write the number";
            wrong("there are no parameters in a formula".into(), help)
        }
        _ if first.is_alphabetic() || first == '_' => named(word, span, variables),
        _ => wrong(format!("{first:?} is not known here"), "operations are + - * / ^"),
    }
}

/// What a name means.
fn named(word: &str, span: &Range<usize>, variables: &[&str]) -> Result<Kind, Misread> {
    let name = word.to_lowercase();
    if let Some(index) = variables.iter().position(|one| *one == name) {
        return Ok(Kind::Operand(Op::Variable(u8::try_from(index).unwrap_or(u8::MAX))));
    }
    if let Some((name, function)) = FUNCTIONS.iter().find(|(one, _)| *one == name) {
        return Ok(Kind::Function(*function, name));
    }
    match name.as_str() {
        "pi" | "π" => return Ok(Kind::Operand(Op::Constant(consts::PI))),
        "e" => return Ok(Kind::Operand(Op::Constant(consts::E))),
        _ => {}
    }
    if let Some((_, message, help)) = ELSEWHERE.iter().find(|(names, ..)| names.contains(&name.as_str())) {
        return Err(Misread::new(span.clone(), format!("the function {name} {message}"), *help));
    }
    let help = match variables {
        [] => "there are no variables here; constants are pi and e".to_owned(),
        [one] => format!("the variable here is {one}; constants are pi and e"),
        _ => format!("the variables here are {}; constants are pi and e", variables.join(" and ")),
    };
    Err(Misread::new(span.clone(), format!("{word} is not known"), help))
}

/// Whether behind this word an operand must come.
fn wants_operand(last: Option<&Word>) -> bool {
    !matches!(last.map(|word| word.kind), Some(Kind::Operand(_) | Kind::Sign(')')))
}

/// Whether a word of this kind may stand behind those before it.
fn follows(text: &str, words: &[Word], kind: Kind, span: &Range<usize>) -> Result<(), Misread> {
    let word = &text[span.clone()];
    let last = words.last();
    if let Some(Word { kind: Kind::Function(_, name), span }) = last
        && kind != Kind::Sign('(')
    {
        let message = format!("the argument of {name} needs brackets");
        return Err(Misread::new(span.clone(), message, format!("write {name}(…)")));
    }
    let starts = matches!(kind, Kind::Operand(_) | Kind::Function(..) | Kind::Sign('('));
    match (wants_operand(last), last) {
        (false, Some(last)) if starts => {
            let help = format!("write {}*{word}", &text[last.span.clone()]);
            Err(Misread::new(span.clone(), format!("an operation is missing before {word}"), help))
        }
        (true, _) if !starts && !matches!(kind, Kind::Sign('+' | '-')) => {
            let help = match word {
                "*" if matches!(last, Some(Word { kind: Kind::Sign('*'), .. })) => {
                    "powers are written with ^"
                }
                _ => "write a number, a variable or a function there",
            };
            Err(Misread::new(span.clone(), format!("something is missing before {word}"), help))
        }
        _ => Ok(()),
    }
}
