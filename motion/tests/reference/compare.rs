//! Reading of a reference file, and the comparison of one column. Units as the files say.

use motion::Sample;
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// The parsed file; panics with its path if it is missing or of another shape.
pub(crate) fn read<T: DeserializeOwned>(name: &str) -> T {
    let folder = std::env::var_os("PITCHLOCK_REFERENCE_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/reference"), PathBuf::from);
    let path = folder.join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// `|got − want| <= 1e-12 scale + relative |want|`.
pub(crate) fn close(at: &str, got: f64, want: f64, scale: f64, relative: f64) {
    let error = (got - want).abs();
    assert!(
        error <= 1e-12 * scale + relative * want.abs(),
        "{at}: {got:e} instead of {want:e} (scale {scale:e})"
    );
}

/// A parameter of a case: 1e-9 of itself.
pub(crate) fn parameter(at: &str, got: f64, want: f64) {
    close(at, got, want, want.abs(), 1e-9);
}

/// Every row against the law, each column on its own scale. `columns` of the file must be `names`, the first is the
/// abscissa; `row` gives the values in their order, the abscissa first. `peaks` are peak values the case itself
/// states, 0 where it states none: a column whose samples all fall on zeros of the law holds nothing but residues,
/// and its scale is then that peak.
pub(crate) fn rows<const N: usize>(
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

/// The values of a sample, path first.
pub(crate) fn values(sample: Sample) -> [f64; 5] {
    [sample.s, sample.v, sample.a, sample.j, sample.dj]
}
