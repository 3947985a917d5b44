//! What is written is what is read, and what is wrong is named.

use std::path::{Path, PathBuf};

use protocol::Axis;

use super::{Format, Row, TraceWriter, columns, find, read};
use crate::observe::tests::ideal::{Ideal, Injected, pass};

const AXES: [Axis; 2] = [Axis::X, Axis::Z];

fn rows() -> Vec<Row> {
    let injected = Injected { phase_um: 1.0 / 3.0, slide_um: -2.0, ..Injected::default() };
    let mut rows = Vec::new();
    Ideal::new().run(&[(pass(1), injected)], |observer, record| {
        rows.push(Row::of(record, observer, 0.0005));
    });
    rows
}

fn write(folder: &Path, format: Format, rows: &[Row]) -> PathBuf {
    let path = folder.join(format.file_name());
    let mut writer = TraceWriter::create(&path, format, &AXES).expect("created");
    rows.iter().for_each(|row| writer.row(row).expect("written"));
    writer.finish().expect("finished");
    path
}

#[test]
fn both_formats_give_back_every_bit() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows = rows();
    for format in [Format::Csv, Format::Mcap] {
        let path = write(folder.path(), format, &rows);
        let mut back = Vec::new();
        read(&path, |row| back.push(row)).expect("read");
        assert!(back == rows, "{format:?} changed a row");
        assert_eq!(find(folder.path()), Some(path.clone()));
        let bytes = super::bytes(format, &AXES, rows.iter().cloned()).expect("written");
        assert!(std::fs::read(path).expect("a file") == bytes, "{format:?} in memory is the same");
    }
}

#[test]
fn numbers_give_back_every_row() {
    for row in rows() {
        let mut numbers = Vec::new();
        row.numbers(|number| numbers.push(number));
        assert_eq!(numbers.len(), columns(&AXES).len());
        assert_eq!(Row::from_numbers(&AXES, &numbers).as_ref(), Ok(&row));
        assert!(Row::from_numbers(&AXES, &numbers[1..]).is_err());
    }
}

#[test]
fn rows_tell_what_was_observed() {
    let rows = rows();
    let thread = rows.iter().find(|row| row.spindle_true_deg > 0.0).expect("a row in the thread");
    assert_eq!((thread.pass, thread.axes.len()), (1, 2));
    let z = thread.axis(Axis::Z).expect("z");
    assert!((z.true_mm - z.programmed).abs() < 4e-3 && (z.slide - z.true_mm + 0.002).abs() < 1e-12);
    assert_eq!(rows.last().map(|row| row.pass), Some(0));
}

#[test]
fn columns_come_in_the_documented_order() {
    let names = columns(&AXES).join(", ");
    assert!(names.starts_with(
        "cycle, t_s, spindle_true_deg, spindle_counts, spindle_rpm, override_pct, x_programmed, x_commanded, \
         x_measured, x_true, x_velocity, x_acceleration, x_jerk, x_servo_error, x_torque, x_state, z_programmed"
    ));
    assert!(
        names.ends_with(
            "z_state, pass, line, x_slide, z_slide, x_force, z_force, chip_area, cutting_force, cutting_torque, \
             spindle_torque, trace, commanded_deviation, commanded_angle, commanded_feed, true_deviation, true_angle, \
             true_feed, tool, motion"
        ),
        "{names}"
    );
}

#[test]
fn a_damaged_trace_is_refused_by_place() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = write(folder.path(), Format::Csv, &rows()[..3]);
    let text = std::fs::read_to_string(&path).expect("text");
    for (from, to, told) in [
        ("armed", "asleep", "column x_state: cannot read \"asleep\""),
        ("x_torque", "x_twist", "column 15 is x_twist, expected x_torque"),
        (",motion", "", "column motion is missing"),
        (",none\n", ",idle\n", "column motion: cannot read \"idle\""),
    ] {
        std::fs::write(&path, text.replacen(from, to, 1)).expect("written");
        let refused = read(&path, |_| {}).expect_err(to).to_string();
        assert!(refused.contains(told) && refused.contains("trace.csv"), "{refused}");
    }
    let path = write(folder.path(), Format::Mcap, &rows()[..3]);
    let mut bytes = std::fs::read(&path).expect("bytes");
    bytes.truncate(bytes.len() / 4);
    std::fs::write(&path, bytes).expect("written");
    assert!(read(&path, |_| {}).expect_err("cut short").to_string().contains("trace.mcap"));
}
