//! Which lines become one, within half of Q of G64. Of so few lines none becomes a curve.

use interpreter::Check;
use protocol::{Axis, Code, Feed};

use crate::good;

/// X and Z of the ends of lines, mm, and the lines of the program that they are from.
fn ends(check: &Check) -> Vec<(u32, [f64; 2])> {
    let end = |item: &protocol::Item| match item.code {
        Code::Line { target, .. } => {
            Some((item.line, [Axis::X, Axis::Z].map(|axis| target[axis.index()].mm())))
        }
        _ => None,
    };
    check.items.iter().filter_map(end).collect()
}

/// Ends of the lines of a program that begins at X10 Z0 in line 1.
fn merged(words: &str, rest: &str) -> Vec<(u32, [f64; 2])> {
    ends(&good(&format!("G0 X10 Z0 F100 {words}\n{rest}\nM2\n"))).split_off(1)
}

#[test]
fn very_short_lines_become_one() {
    let nearly = "G1 Z-0.04\nX10.002 Z-0.08\nX10 Z-0.12\nX10.1";
    assert_eq!(merged("G64 P0.02 Q0.01", nearly), [(4, [10.0, -0.12]), (5, [10.1, -0.12])]);
    assert_eq!(merged("G64 P0.1", nearly), [(4, [10.0, -0.12]), (5, [10.1, -0.12])]);
    assert_eq!(merged("G64 P0.02 Q0.001", nearly).len(), 4, "half of Q is for blends");
    assert_eq!(merged("G64 P0.004", nearly).len(), 4, "a tenth of P is 0.4 um");
    assert_eq!(merged("G64 P0.02 Q0", nearly).len(), 4);
    assert_eq!(merged("G61", nearly).len(), 4);
}

#[test]
fn only_what_goes_on_is_merged() {
    let q = "G64 P0.02 Q0.01";
    assert_eq!(merged(q, "G1 Z-0.05\nZ-0.02\nZ-0.08").len(), 3, "there and back");
    assert_eq!(merged(q, "G1 Z-0.05\nZ0").len(), 2, "back to the start");
    assert_eq!(merged(q, "G1 Z-0.05\nZ-0.08 F50\nZ-0.09").len(), 2, "another feed");
    assert_eq!(merged(q, "G1 Z-0.05\nG0 Z-0.08\nZ-0.09").len(), 3, "rapids");
    for between in ["G4 P1", "M8", "M0", "G64 P0.03 Q0.01", "G61", "S100 M3"] {
        let ends = merged(q, &format!("G1 Z-0.05\nZ-0.06\n{between}\nZ-0.08\nZ-0.09"));
        assert_eq!(ends[0], (3, [10.0, -0.06]), "{between}");
        assert!(ends.len() >= 2, "{between}");
    }
}

#[test]
fn they_become_a_fifth_of_a_millimetre_at_most() {
    let lines: String = (1..=50).map(|n| format!("G1 Z-{}\n", f64::from(n) / 100.0)).collect();
    let expected = [(21, [10.0, -0.2]), (41, [10.0, -0.4]), (51, [10.0, -0.5])];
    assert_eq!(merged("G64 P0.02 Q0.01", &lines), expected);
    assert_eq!(merged("G64 P0.02 Q0.01", "G1 Z-1\nZ-2").len(), 2, "long ones stay");
}

#[test]
fn a_hundred_lines_at_most() {
    let lines: String = (1..=250).map(|n| format!("G1 Z-{}\n", f64::from(n) / 1000.0)).collect();
    let expected = [(101, [10.0, -0.1]), (201, [10.0, -0.2]), (251, [10.0, -0.25])];
    assert_eq!(merged("G64 P0.02 Q0.01", &lines), expected);
}

#[test]
fn feeds_are_kept() {
    let check = good("G0 X10 Z0 G64 P0.02 Q0.01\nG1 Z-0.05 F80\nZ-0.1\nZ-0.2 F90\nM2\n");
    let feed =
        |item: &protocol::Item| if let Code::Line { feed, .. } = item.code { Some(feed) } else { None };
    let feeds: Vec<Feed> = check.items.iter().filter_map(feed).collect();
    assert_eq!(feeds, [Feed::Rapid, Feed::PerMinute(80.0), Feed::PerMinute(90.0)]);
}
