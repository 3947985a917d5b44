//! The computer with the machine has no room for what comes, or for what a run leaves.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::{
    place::{Host, Place, control, project, summary},
    refusals::text,
};

/// A small file system, until it is dropped.
struct Small(PathBuf);

impl Drop for Small {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// One in this place, if there may be any.
fn small(place: PathBuf, size: &str) -> Option<Small> {
    let mut mount = Command::new("mount");
    mount.args(["-t", "tmpfs", "-o", size, "tmpfs"]).arg(&place).stderr(Stdio::null());
    let made = mount.status().is_ok_and(|status| status.success());
    if !made {
        eprintln!("left out: a small file system needs an administrator");
    }
    made.then_some(Small(place))
}

/// It would wait, and answer nobody.
#[test]
fn too_few_files_that_may_be_open_are_named_before_it_waits() {
    let place = Place::new(None);
    let mut limited = place.command(Host::B, Path::new("sh"));
    limited.args(["-c", "ulimit -n 24; exec \"$0\" serve --listen \"$1\" --key \"$2\""]).arg(control());
    let output = limited.arg(&place.address).arg(place.at("key")).output().expect("it starts");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    assert!(text(&output).contains("a process may open 24 files at once"), "{}", text(&output));
}

/// It is not told to run itself.
#[test]
fn a_full_folder_of_temporary_files_is_named_by_doctor() {
    let place = Place::new(None);
    let Some(_small) = small(place.at("a/tmp"), "size=32k") else { return };
    let output = place.command(Host::A, &control()).arg("doctor").output().expect("it starts");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    let said = text(&output);
    assert!(said.contains("with room in both") && !said.contains("run `pitchlock doctor`"), "{said}");
}

/// What cannot be written there is told here, behind what became of the run.
#[test]
fn a_run_that_was_completed_on_a_full_disk_is_told_as_such() {
    let mut place = Place::new(None);
    fs::create_dir(place.at("b/runs")).expect("a folder");
    let Some(_small) = small(place.at("b/runs"), "size=1m") else { return };
    place.serve(&[]);
    let output = place.far(&project("examples/m20x2.ngc"), &["--json"]).output().expect("it starts");
    assert_eq!(output.status.code(), Some(1), "{}\n{}", text(&output), place.said());
    assert_eq!(summary(&output)["outcome"], "completed", "{}", text(&output));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains(&format!("on the computer at {}: ", place.address)), "{said}");
    assert!(said.contains("No space left on device"), "{said}");
}

#[test]
fn files_without_room_are_refused_and_the_machine_waits_on() {
    let mut place = Place::new(None);
    let Some(_small) = small(place.at("b/tmp"), "size=300k") else { return };
    place.write("short.ngc", "G18 G21 G90 G94\nG0 X50 Z90\nM2\n");
    let long = place.write("long.ngc", &format!("G21\n{}G0 X25\nM2\n", "(nothing at all)\n".repeat(50_000)));
    place.serve(&[]);
    let output = place.far(&long, &[]).output().expect("it starts");
    assert_eq!(output.status.code(), Some(2), "{}\n{}", text(&output), place.said());
    assert!(text(&output).contains("long.ngc: does not fit on the machine's computer"), "{}", text(&output));
    assert!(place.runs().is_empty(), "nothing has moved");
    assert_eq!(place.run(&place.at("short.ngc"), &[])["outcome"], "completed");
}
