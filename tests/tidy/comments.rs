//! Comments: no wider than the code, for rustfmt does not wrap them.

use super::{files, none, read};

/// As `max_width` of `rustfmt.toml`.
const WIDTH: usize = 110;

/// Whether a line is a comment that could be wrapped: a row of a table cannot, nor can one long word.
fn is_wide(line: &str) -> bool {
    let Some(comment) = line.trim_start().strip_prefix("//") else { return false };
    let comment = comment.trim_start_matches(['/', '!']).trim();
    line.chars().count() > WIDTH && !comment.starts_with('|') && comment.contains(' ')
}

#[test]
fn comments_are_as_narrow_as_code() {
    let mut findings = Vec::new();
    let mut count = 0;
    for path in files(&[".rs"]) {
        let text = read(&path);
        count += text.lines().filter(|line| line.trim_start().starts_with("//")).count();
        let wide = text.lines().enumerate().filter(|(_, line)| is_wide(line));
        findings.extend(
            wide.map(|(at, line)| format!("{}:{}: {} columns", path.display(), at + 1, line.chars().count())),
        );
    }
    assert!(count > 5000, "only {count} lines of comments were recognised");
    none(&findings);
}

#[test]
fn a_comment_is_wide_beyond_the_width_of_code() {
    let words = |width: usize| format!("    /// {}", "a ".repeat(width / 2 - 4));
    assert_eq!((words(110).len(), is_wide(&words(110)), is_wide(&words(112))), (110, false, true));
    assert!(
        !is_wide(&format!("//! | {} |", "a ".repeat(100))) && !is_wide(&format!("// {}", "a".repeat(200)))
    );
    assert!(!is_wide(&format!("let a = \"{}\";", "a ".repeat(100))));
    assert!(super::read("rustfmt.toml").contains(&format!("max_width = {WIDTH}\n")));
}
