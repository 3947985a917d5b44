//! Lines of loops and subroutines are read once and done again: the same as if the program had them once for
//! each turn.

use std::fmt::Write;

use super::recorded::{calls, outcome};

/// What a turn may do, every operation of it. `#1` counts the turns, from 0.
const BODY: &str = "\
N20 #2 = [[2 + #1] * 3 - #1 / 7 ** 2] #<depth> = -#2
#<_wide> = [#<depth> + ABS[#1 - 4] + EXP[0.1 * #1] + #<_metric>]
#[10 + #1] = [ATAN[#1 + 1]/[2] + #5420] ; indirect
#3 = #[10 + #1]
#4 = [[#1 mod 3] eq 1 or #1 gt 6 and #1 ne 8 xor [#1 le 2]]
G1 X#2 Y[-[#3]] Z-.5 F[100 + #1]
G#4 X[SIN[30 * #1] - COS[#1] + SQRT[#1] + TAN[#1]] (a comment)
M[8 + #1 mod 2]
";

const START: &str = "F100\n#<_wide> = 0\n#<depth> = 0\n";

fn unrolled(body: &str, turns: usize) -> Vec<String> {
    let mut text = START.to_owned();
    for turn in 0..turns {
        write!(text, "#1 = {turn}\n{body}").expect("a text takes any line");
    }
    calls(&text)
}

#[test]
fn every_turn_of_a_loop_does_what_its_lines_do() {
    let expected = unrolled(BODY, 9);
    assert!(expected.len() > 9 * 4);
    let turn = format!("{BODY}#1 = [#1 + 1]\n");
    for text in [
        format!("{START}#1 = 0\no1 while [#1 lt 9]\n{turn}o1 endwhile"),
        format!("{START}#1 = 0\no1 do\n{turn}o1 while [#1 lt 9]"),
        format!("{START}#1 = 0\no1 repeat [9]\n{turn}o1 endrepeat"),
        format!("{START}#1 = 0\no1 while [1]\no2 if [#1 ge 9]\no1 break\no2 endif\n{turn}o1 endwhile"),
    ] {
        assert_eq!(calls(&text), expected, "{text}");
    }
}

#[test]
fn every_call_has_its_own_arguments_and_names() {
    let sub = "o<s> sub\n#<mine> = [#1 + #2]\nG0 X#<mine> Y#3\no<s> endsub [#<mine> * 2]\n";
    let looped = format!(
        "{sub}#<n> = 0\no1 while [#<n> lt 5]\no<s> call [#<n>] [1]\nG0 Z#<_value>\n#<n> = [#<n> + 1]\no1 endwhile"
    );
    let mut text = String::new();
    for n in 0..5 {
        writeln!(text, "G0 X{} Y0\nG0 Z{}", n + 1, 2 * (n + 1)).unwrap();
    }
    assert_eq!(calls(&looped), calls(&text));
}

#[test]
fn each_turn_takes_its_own_branch() {
    let body =
        "o2 if [[#1 mod 3] eq 0]\nG0 X#1\no2 elseif [[#1 mod 3] eq 1]\nG0 Y#1\no2 else\nG0 Z#1\no2 endif\n";
    let looped = format!("#1 = 0\no1 while [#1 lt 9]\n{body}#1 = [#1 + 1]\no1 endwhile");
    let text: String = (0..9).map(|n| format!("G0 {}{n}\n", ["X", "Y", "Z"][n % 3])).collect();
    assert_eq!(calls(&looped), calls(text.trim_end()));
}

#[test]
fn loops_longer_than_what_is_remembered_do_the_same() {
    let lines: String = (0..2500).map(|n| format!("G0 X[#1 + {n}]\n")).collect();
    let looped = format!("#1 = 0\no1 repeat [3]\n{lines}#1 = [#1 + 1]\no1 endrepeat");
    let mut text = String::new();
    for turn in 0..3 {
        (0..2500).for_each(|n| writeln!(text, "G0 X{}", turn + n).unwrap());
    }
    assert_eq!(calls(&looped), calls(text.trim_end()));
}

#[test]
fn what_fails_in_a_later_turn_is_found_at_its_place() {
    for (line, code) in [
        ("G0 X[1 / [3 - #1]]", "arithmetic"),
        ("G0 X[SQRT[2 - #1]]", "arithmetic"),
        ("G0 X#[3000 * #1 - 400]", "bad-parameter"),
        ("M[#1 * 4]", "unknown-m-code"),
        ("#[5399 + #1] = 2", "bad-parameter"),
        ("G0 X[EXP[#1 * 300]]", "arithmetic"),
    ] {
        let outcome =
            outcome(&format!("F1\n#1 = 0\no1 while [#1 lt 9]\n#1 = [#1 + 1]\n{line}\no1 endwhile\nM2\n"));
        let errors: Vec<_> = outcome.errors.iter().map(|error| (error.line, error.code)).collect();
        assert_eq!(errors, [(5, code)], "{line}");
        assert!(outcome.errors[0].span.end <= line.len(), "{line}");
    }
}

#[test]
fn a_name_that_is_not_set_in_this_call_is_unknown() {
    let text = "o1 sub\no2 if [#1]\n#<mine> = 1\no2 endif\nG0 X#<mine>\no1 endsub\no1 call [1]\no1 call [1]\no1 call [0]\nM2\n";
    let outcome = outcome(text);
    let errors: Vec<_> = outcome.errors.iter().map(|error| (error.line, error.code)).collect();
    assert_eq!(errors, [(5, "unknown-name")]);
    assert_eq!(outcome.sink.calls.iter().filter(|call| call.starts_with("StraightTraverse")).count(), 2);
}
