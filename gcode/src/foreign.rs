//! Languages of other controls, which are not read here.
//!
//! In: the beginning of a text. Out: the name of the control, by how its programs begin, or by a line that
//! none of the dialects has. Such a program is refused once, by that name, and not word by word.

use crate::guess::{Words, without_comments};
use crate::text::readable;

/// Lines at the beginning of a program that may tell its language.
const FIRST: usize = 3;

/// Whether a line can only be of another control.
type Sign = (&'static str, fn(&Words) -> bool);

const SIGNS: [Sign; 12] = [
    ("Okuma OSP", |words| words.text.starts_with(b"callo")),
    ("Okuma OSP", |words| words.text == b"rts"),
    // NLAP: N is taken for that of a number.
    ("Okuma OSP", |words| words.text.starts_with(b"lap")),
    ("Okuma OSP", |words| words.has(b"vzof") || words.has(b"vuacm[") || words.has(b"vdout[")),
    ("Sinumerik", |words| words.has(b"diamon") || words.has(b"lims=") || words.has(b"t=\"")),
    ("Sinumerik", |words| words.text.starts_with(b"workpiece") || words.text.starts_with(b"cycle9")),
    ("Sinumerik", |words| words.text == b"msg" || words.text.starts_with(b"proc") || words.has(b"gotof")),
    ("Sinumerik", |words| words.text.starts_with(b"_") || words.text.starts_with(b"$a")),
    ("Sinumerik or Okuma OSP", |words| sets_a_name(words.text)),
    ("Heidenhain", |words| words.has(b"toolcall")),
    ("Fagor", |words| words.values(b't').any(has_point_inside)),
    ("Mazatrol", |words| words.text.starts_with(b"mazatrol") || words.text.starts_with(b"unounit")),
];

/// Its name; `None` if it is none that is known.
pub fn foreign(text: &[u8]) -> Option<&'static str> {
    let text = readable(text);
    let mut first = text.lines().map(str::trim).filter(|line| !line.is_empty()).take(FIRST);
    first.by_ref().find_map(begins).or_else(|| okuma_name(&text)).or_else(|| {
        let mut bare = Vec::new();
        text.lines().find_map(|line| {
            without_comments(line.as_bytes(), &mut bare);
            // Names may contain anything.
            let words = Words { text: if bare.contains(&b'<') { b"" } else { &bare }, feeds: false };
            SIGNS.iter().find(|(_, is_there)| is_there(&words)).map(|(control, _)| *control)
        })
    })
}

/// How programs begin.
fn begins(line: &str) -> Option<&'static str> {
    let line = line.to_ascii_uppercase();
    let words: Vec<&str> = line.split_whitespace().collect();
    match words.as_slice() {
        [one] if one.starts_with('$') && one.ends_with('%') => Some("Okuma OSP"),
        [first, ..] if first.starts_with("%_N_") || first.starts_with(";$PATH=") => Some("Sinumerik"),
        ["%MPF" | "%SPF" | "MPF" | "SPF", ..] => Some("Sinumerik"),
        ["BEGIN" | "0", "PGM", ..] | ["0", "BEGIN", "PGM", ..] => Some("Heidenhain"),
        ["%PM", ..] => Some("Philips"),
        [first, ..] if names_a_part(first) => Some("Fagor"),
        [first, ..] if is_numbered(first) => Some("Fagor, NUM or HNC (% with a number)"),
        _ => None,
    }
}

/// `%00042`: a number behind the sign that begins a tape, which stands alone in the dialects.
fn is_numbered(word: &str) -> bool {
    let number = word.strip_prefix('%').map(|rest| rest.split(',').next().unwrap_or_default());
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// `%SHAFT,MX,`: the name of a part, and what may be done with it.
fn names_a_part(word: &str) -> bool {
    let mut parts = word.strip_prefix('%').unwrap_or_default().split(',');
    let name = parts.next().unwrap_or_default();
    let rights = parts.next().unwrap_or_default();
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && !rights.is_empty()
        && rights.bytes().all(|c| c.is_ascii_alphabetic())
}

/// `OPULL` in the first line: programs of the dialects have numbers there, those of LinuxCNC names in `< >`.
fn okuma_name(text: &str) -> Option<&'static str> {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && *line != "%")?;
    let name = first.split('(').next().unwrap_or_default().trim_end();
    let rest = name.strip_prefix(['O', 'o'])?;
    let letters = rest.starts_with(|c: char| c.is_ascii_alphabetic());
    (letters && rest.len() <= 4 && rest.bytes().all(|byte| byte.is_ascii_alphanumeric()))
        .then_some("Okuma OSP")
}

/// `TEST=1`: variables of the dialects are `#`, and a letter may stand in front of a value.
fn sets_a_name(text: &[u8]) -> bool {
    let letters = text.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
    let name = |byte: &&u8| byte.is_ascii_alphanumeric() || **byte == b'_';
    let end = letters + text[letters..].iter().take_while(name).count();
    letters > 1 && text.get(end) == Some(&b'=') && text.get(end + 1) != Some(&b'=')
}

/// `T1.1`: a tool and its offset. `T1.0` is tool 1, as some posts write whole numbers.
fn has_point_inside(digits: &[u8]) -> bool {
    let point = digits.iter().position(|byte| *byte == b'.');
    point.is_some_and(|at| at > 0 && digits[at + 1..].iter().any(|byte| *byte != b'0'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_of_other_controls_are_known() {
        for (text, control) in [
            ("$SHAFT.MIN%\n(X)\n", Some("Okuma OSP")),
            ("OTURN (A PULL OF THE BAR)\nG0 X20. Z20.\n", Some("Okuma OSP")),
            ("G0 X2\nCALL O100 LENG=3\nM2\n", Some("Okuma OSP")),
            ("G0 X2\nNLAP1 G81\nG0 X10\n", Some("Okuma OSP")),
            ("%_N_SHAFT_MPF\n;$PATH=/_N_MPF_DIR\n", Some("Sinumerik")),
            ("%MPF  90\n", Some("Sinumerik")),
            ("N10 G18 G90 DIAMON\nN20 G96 S200 LIMS=3000 M4\n", Some("Sinumerik")),
            ("N10 T=\"FINISHER\" D1\n", Some("Sinumerik")),
            ("MSG(\"TURN\")\n", Some("Sinumerik")),
            ("N10 _DRESS_SETUP(\"N_20\",1)\n", Some("Sinumerik")),
            ("TEST=1\n", Some("Sinumerik or Okuma OSP")),
            ("N30 SB=1500 M13\n", Some("Sinumerik or Okuma OSP")),
            ("BEGIN PGM 1 MM\n", Some("Heidenhain")),
            ("0  BEGIN PGM 1 MM\n", Some("Heidenhain")),
            ("%PM\n\nN9000\n", Some("Philips")),
            ("%00042\nN0010 G53 X0 Z50\n", Some("Fagor, NUM or HNC (% with a number)")),
            ("%1234\nT0101\n", Some("Fagor, NUM or HNC (% with a number)")),
            ("N10 G90 G95\nN20 T2.2\n", Some("Fagor")),
            ("%SHAFT,MX,\nN10 G54\nG0 X10\n", Some("Fagor")),
            ("UNo UNIT ADD IN/OUT\n", Some("Mazatrol")),
            ("%\nO1000\nG0 X1\n", None),
            ("%\nO1000 (T1.1 CALL OUT, DIAMOND TOOL)\nT0101\nG0 X1.5\n", None),
            ("o<turn> sub\nT1 M6\n", None),
            ("(begin preamble)\nG18 G54 G90\nM6 T1.0\nM3 S800.00\n", None),
            ("Only a remark\n", None),
            ("#1=2 #2=3\nIF [#1 EQ 2] THEN #3=4\nG1 X=5\n(MSG=5)\n", None),
            ("#<diamond> = 2\no<toolcall> call\n#<vzofs> = 1\n", None),
            ("", None),
        ] {
            assert_eq!(foreign(text.as_bytes()), control, "{text}");
        }
    }
}
