//! `pitchlock campaign`: by hand and on a cluster.

mod cluster;
mod one_table;

use std::fs;

use crate::shop::Place;

/// A soak of so many seeds, so many a job.
fn soak(seeds: u64, per_job: u64) -> String {
    format!("command = [\"soak\", \"--seeds\", \"{{seeds}}\"]\nseeds = \"0..{seeds}\"\nper_job = {per_job}\n")
}

/// The bytes of the table in a folder.
fn table(place: &Place, folder: &str) -> Vec<u8> {
    fs::read(place.at(folder).join("campaign.parquet")).expect("a table")
}

/// Makes a whole campaign; what it printed.
fn made(place: &Place, arguments: &[&str]) -> String {
    let answer = place.ask(&[&["campaign"], arguments].concat());
    assert_eq!(answer.status, Some(0), "{arguments:?}: {}", answer.stderr);
    answer.stdout
}

/// The processes that somebody with this number has started, in whatever thread.
fn started_by(pid: u32) -> Vec<u32> {
    let threads = fs::read_dir(format!("/proc/{pid}/task")).into_iter().flatten().flatten();
    let of = |thread: fs::DirEntry| fs::read_to_string(thread.path().join("children")).unwrap_or_default();
    threads
        .map(of)
        .flat_map(|all| all.split_whitespace().filter_map(|pid| pid.parse().ok()).collect::<Vec<_>>())
        .collect()
}
