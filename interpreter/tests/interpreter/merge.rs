//! G64 Q: which lines become one.

use interpreter::Check;
use proptest::prelude::*;
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
fn lines_within_q_become_one() {
    let nearly = "G1 Z-1\nX10.004 Z-2\nX9.997 Z-3\nX10 Z-4\nX12";
    assert_eq!(merged("G64 P0.02 Q0.01", nearly), [(5, [10.0, -4.0]), (6, [12.0, -4.0])]);
    assert_eq!(merged("G64 P0.02 Q0.001", nearly).len(), 5);
    assert_eq!(merged("G64 P0.02", nearly).len(), 5, "Q is not P");
    assert_eq!(merged("G61", nearly).len(), 5);
}

#[test]
fn only_what_goes_on_is_merged() {
    let q = "G64 P0.02 Q0.01";
    assert_eq!(merged(q, "G1 Z-5\nZ-2\nZ-8").len(), 3, "there and back");
    assert_eq!(merged(q, "G1 Z-5\nZ0").len(), 2, "back to the start");
    assert_eq!(merged(q, "G1 Z-5\nZ-8 F50\nZ-9").len(), 2, "another feed");
    assert_eq!(merged(q, "G1 Z-5\nG0 Z-8\nZ-9").len(), 3, "rapids");
    for between in ["G4 P1", "M8", "M0", "G64 P0.03 Q0.01", "G61", "S100 M3"] {
        let ends = merged(q, &format!("G1 Z-5\nZ-6\n{between}\nZ-8\nZ-9"));
        assert_eq!(ends[0], (3, [10.0, -6.0]), "{between}");
        assert!(ends.len() >= 2, "{between}");
    }
}

#[test]
fn a_hundred_lines_at_most() {
    let lines: String = (1..=250).map(|n| format!("G1 Z-{}\n", f64::from(n) / 10.0)).collect();
    let expected = [(101, [10.0, -10.0]), (201, [10.0, -20.0]), (251, [10.0, -25.0])];
    assert_eq!(merged("G64 P0.02 Q0.01", &lines), expected);
}

proptest! {
    /// Every programmed end lies within Q of the lines that are left, and the last one is kept exactly.
    #[test]
    fn no_end_is_farther_away_than_q(steps in prop::collection::vec((-0.02..0.02_f64, 0.01..0.5_f64), 2..60)) {
        let (mut x, mut z, mut program, mut points) = (10.0, 0.0, String::new(), vec![[10.0, 0.0]]);
        for (dx, dz) in steps {
            (x, z) = (x + dx, z - dz);
            let [x, z] = [x, z].map(|mm: f64| (mm * 1e4).round() / 1e4);
            program.push_str(&format!("G1 X{x} Z{z}\n"));
            points.push([x, z]);
        }
        let ends = merged("G64 P0.02 Q0.01", &program);
        prop_assert_eq!(ends.last().map(|(_, end)| *end), points.last().copied());
        let mut from = 0;
        for (line, end) in ends {
            let to = line as usize - 1;
            let [a, b] = [points[from], end];
            let length = libm::hypot(b[0] - a[0], b[1] - a[1]);
            for p in &points[from..=to] {
                let aside = ((p[0] - a[0]) * (b[1] - a[1]) - (p[1] - a[1]) * (b[0] - a[0])) / length;
                prop_assert!(aside.abs() <= 0.01 + 1e-9, "{aside} in line {line}");
            }
            from = to;
        }
    }
}

#[test]
fn feeds_are_kept() {
    let check = good("G0 X10 Z0 G64 P0.02 Q0.01\nG1 Z-1 F80\nZ-2\nZ-3 F90\nM2\n");
    let feed =
        |item: &protocol::Item| if let Code::Line { feed, .. } = item.code { Some(feed) } else { None };
    let feeds: Vec<Feed> = check.items.iter().filter_map(feed).collect();
    assert_eq!(feeds, [Feed::Rapid, Feed::PerMinute(80.0), Feed::PerMinute(90.0)]);
}
