//! The asset that is not ours: it is the file that was reviewed, and no page can be broken out of by it.

use std::{path::Path, process::Command};

use report::page::PLOTTING_SCRIPT;

/// `SHA256SUMS` as coreutils reads it.
#[test]
fn the_asset_is_the_one_that_was_reviewed() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let checked =
        Command::new("sha256sum").args(["--check", "--strict", "SHA256SUMS"]).current_dir(assets).output();
    let checked = checked.expect("sha256sum of coreutils is there");
    let said = String::from_utf8_lossy(&checked.stdout);
    assert!(checked.status.success(), "{said}{}", String::from_utf8_lossy(&checked.stderr));
    assert!(said.contains("plotly-cartesian.min.js: OK"), "{said}");
}

/// The version that the notice names is the one that its first lines name.
#[test]
fn the_asset_is_what_its_notice_says() {
    let notice = include_str!("../assets/README.md");
    let head: String = PLOTTING_SCRIPT.lines().take(6).collect();
    let version = head.split(" v").nth(1).and_then(|rest| rest.split('*').next()).expect("a version");
    assert!(head.contains("Licensed under the MIT license") && head.contains("cartesian"), "{head}");
    assert!(notice.contains(&format!("plotly.js {version},")), "{version}");
}

#[test]
fn the_asset_cannot_end_its_script_element() {
    assert!(!PLOTTING_SCRIPT.to_lowercase().contains("</script"));
}
