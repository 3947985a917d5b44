//! Numbered and named parameters.

use super::recorded::{blamed, errors, messages, outcome};

#[test]
fn parameters_may_stand_for_parameters() {
    assert_eq!(
        messages("#10=11 #11=12\n(debug,#10)\n#1=##10 #2=#[5+6]\n(debug,#1 #2)"),
        ["11.000000", "12.000000 12.000000"]
    );
}

#[test]
fn names_that_begin_with_an_underscore_belong_to_the_program() {
    let text =
        "o1 sub\n(debug,#<_g> #<l>)\n#<l>=9\n#<_g>=7\no1 endsub\n#<_g>=1 #<l>=2\no1 call\n(debug,#<_g> #<l>)";
    assert_eq!(messages(text), ["1.000000 ######", "7.000000 2.000000"]);
}

#[test]
fn a_name_is_known_from_the_next_line_on() {
    assert_eq!(blamed("#<a>=5 #<b>=[#<a>/2]"), (1, "unknown-name", "#<a>".to_owned()));
}

#[test]
fn what_tells_the_state_is_read_and_cannot_be_set() {
    assert_eq!(
        messages("G0 X3 Y4\n(debug,#5420 #5421 #<_x> #5220)"),
        ["3.000000 4.000000 3.000000 1.000000"]
    );
    for text in ["#5420=1", "#5400=1", "#<_x>=1", "#<_value>=1"] {
        assert_eq!(errors(&format!("{text}\nM2")), [(1, "bad-parameter")], "{text}");
    }
}

#[test]
fn a_line_with_an_error_sets_nothing() {
    let outcome = outcome("#1=1\n#1=2 #2=[1/0]\nM2\n");
    assert_eq!(outcome.errors.len(), 1);
    assert_eq!(outcome.program.parameter(1), Some(1.0));
}

#[test]
fn parameters_end_where_the_control_says() {
    assert!(errors("#5601=1\nM2").is_empty());
    assert_eq!(blamed("#5602=1"), (1, "bad-parameter", "#5602".to_owned()));
}

#[test]
fn names_of_the_state_tell_what_is_in_force() {
    let text = "(debug,#<_feed_hold> #<_feed_override> #<_speed_override> #<_adaptive_feed>)";
    assert_eq!(
        messages(&format!("{text}\nM53 P0\n{text}\nM53\nM49\nM52\n{text}")),
        [
            "1.000000 1.000000 1.000000 0.000000",
            "0.000000 1.000000 1.000000 0.000000",
            "1.000000 0.000000 0.000000 1.000000"
        ]
    );
}
