//! Reference values, computed with 50 digits elsewhere: files of `tests/reference`, or of the folder that the
//! variable `PITCHLOCK_REFERENCE_DIR` names. In: the name of a file. Out: its content; comparisons with it.
//! Units as the files say.

use std::path::PathBuf;

use serde::de::DeserializeOwned;

/// The parsed file.
///
/// # Panics
/// With its path, if it is missing or of another shape.
pub fn read<T: DeserializeOwned>(name: &str) -> T {
    let folder = std::env::var_os("PITCHLOCK_REFERENCE_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/reference"), PathBuf::from);
    let path = folder.join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// `|got − want| <= 1e-12 scale + relative |want|`.
///
/// # Panics
/// If not.
#[track_caller]
pub fn close(at: &str, got: f64, want: f64, scale: f64, relative: f64) {
    let error = (got - want).abs();
    assert!(
        error <= 1e-12 * scale + relative * want.abs(),
        "{at}: {got:e} instead of {want:e} (scale {scale:e})"
    );
}

/// A parameter of a case: 1e-9 of itself.
///
/// # Panics
/// If it differs by more.
#[track_caller]
pub fn parameter(at: &str, got: f64, want: f64) {
    close(at, got, want, want.abs(), 1e-9);
}

/// Every row against the law, each column on its own scale. `columns` of the file must be `names`, the first
/// is the abscissa; `row` gives the values in their order, the abscissa first. `peaks` are peak values the
/// case itself states, 0 where it states none: a column whose samples all fall on zeros of the law holds
/// nothing but residues, and its scale is then that peak.
///
/// # Panics
/// If a column is missing or a value differs.
#[track_caller]
pub fn rows<const N: usize>(
    at: &str,
    names: [&str; N],
    columns: &[String],
    samples: &[Vec<f64>],
    peaks: [f64; N],
    row: impl Fn(f64) -> [f64; N],
) {
    assert_eq!(columns, names, "{at}: columns");
    assert!(!samples.is_empty(), "{at}: no samples");
    for (column, name) in names.iter().enumerate() {
        let scale = samples.iter().map(|sample| sample[column].abs()).fold(peaks[column], f64::max);
        for sample in samples {
            assert_eq!(sample.len(), N, "{at}: row {sample:?}");
            let got = row(sample[0])[column];
            close(&format!("{at}: {name} at {}", sample[0]), got, sample[column], scale, 1e-9);
        }
    }
}
