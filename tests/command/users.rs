//! Another user of the same computer: nothing that he puts where everybody may put something keeps this user
//! from running his machine, has anything of his removed or changed, or lets the other one look into a run.
//! Each attack is made in a mount namespace with a shared memory of its own, by two users that exist in no
//! list.

use std::{fs, os::unix::fs::PermissionsExt as _, process::Command};

use crate::{
    endings::slow_machine,
    shop::{Answer, Place, can_be_private},
};

const SHORT: &str = "G18 G21 G90 G94 G8\nG0 X50 Z90\nG1 X50.1 F3000\nM2\n";
const VICTIM: u32 = 65_001;
const OTHER: u32 = 65_002;

/// A place with a folder of the victim and one of the other user. Temporary files of both lie in a place with
/// a short name.
fn place() -> Place {
    let place = Place::new();
    let open = |path: &std::path::Path, mode| {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("it is ours");
    };
    open(place.path(), 0o755);
    for (name, user) in [("v", VICTIM), ("o", OTHER)] {
        let path = place.at(name);
        fs::create_dir(&path).expect("a folder");
        open(&path, 0o755);
        std::os::unix::fs::chown(&path, Some(user), Some(user)).expect("root may");
    }
    fs::copy(place.pitchlock().get_program(), place.at("pitchlock")).expect("room");
    open(&place.at("pitchlock"), 0o755);
    fs::write(place.at("v/short.ngc"), SHORT).expect("room");
    place
}

/// A script with `victim COMMAND`, `other COMMAND` and `run FOLDER`; what it printed.
fn script(place: &Place, text: &str) -> String {
    let whole = format!(
        "mount -t tmpfs -o mode=1777,size=64m tmpfs /dev/shm || exit 9
         mount -t tmpfs -o mode=1777 tmpfs /mnt || exit 9; export TMPDIR=/mnt; V={VICTIM}; O={OTHER}; cd {0}/v
         victim() {{ setpriv --reuid $V --regid $V --clear-groups timeout -s KILL 60 \"$@\"; }}
         other() {{ setpriv --reuid $O --regid $O --clear-groups timeout -s KILL 60 \"$@\"; }}
         run() {{ victim {0}/pitchlock run short.ngc --trace none --out $1 >$1.log 2>&1; echo \"$1 $?\"; }}
         umask 022
         {text}",
        place.path().display()
    );
    let mut command = Command::new("unshare");
    command.args(["-m", "sh", "-c", &whole]).current_dir(place.path());
    let answer = Answer::from(command.output().expect("unshare"));
    assert_ne!(answer.status, Some(9), "{}", answer.stderr);
    answer.stdout + &answer.stderr
}

/// What somebody can put where the marker of a run would stand: none of it is waited for, followed or
/// removed, and the next run of the victim, of root and the doctor go as ever.
#[test]
fn nothing_at_a_markers_name_hinders_a_start() {
    if !can_be_private("nothing_at_a_markers_name_hinders_a_start") {
        return;
    }
    for (what, attack) in [
        ("a pipe", "other mkfifo -m 666 /dev/shm/pitchlock-0badf1f0"),
        (
            "a link to a file of the victim",
            "victim touch own; other ln -s $PWD/own /dev/shm/pitchlock-0badf1f0",
        ),
        (
            "a link to a pipe",
            "other mkfifo -m 666 ../o/pipe; other ln -s $PWD/../o/pipe /dev/shm/pitchlock-0badf1f0",
        ),
        ("a folder", "other mkdir /dev/shm/pitchlock-0badf1f0"),
        ("a file", "other sh -c 'echo 1 /tmp/pitchlock-65001/0badf1f0 > /dev/shm/pitchlock-0badf1f0'"),
        ("a device", "mknod -m 666 /dev/shm/pitchlock-0badf1f0 c 1 5"),
    ] {
        let place = place();
        let told = script(
            &place,
            &format!(
                "{attack}; run r1; timeout -s KILL 60 ../pitchlock doctor >/dev/null; echo doctor $?; ls -d /dev/shm/*"
            ),
        );
        assert!(told.contains("r1 0") && told.contains("doctor 0"), "{what}: {told}");
        assert!(told.contains("/dev/shm/pitchlock-0badf1f0"), "{what} is not ours to remove: {told}");
    }
}

/// A marker that is a link to a file of the victim, whose text the other one has written, once had a folder
/// of the victim removed.
#[test]
fn no_link_has_a_folder_of_the_victim_removed() {
    if !can_be_private("no_link_has_a_folder_of_the_victim_removed") {
        return;
    }
    let place = place();
    let told = script(
        &place,
        "victim mkdir -p precious/0badf1f2; victim touch precious/0badf1f2/file
         other mkdir $TMPDIR/evil; other ln -s $PWD/precious $TMPDIR/evil/pitchlock-$V
         victim sh -c \"umask 077; printf '1 %s/evil/pitchlock-65001/0badf1f2' $TMPDIR > downloaded\"
         other ln -s $PWD/downloaded /dev/shm/pitchlock-0badf1f2
         run r1; ls precious/0badf1f2
         victim cp downloaded /dev/shm/pitchlock-0badf1f3; victim sed -i s/f1f2/f1f3/ /dev/shm/pitchlock-0badf1f3
         victim mv precious/0badf1f2 precious/0badf1f3; victim chmod 600 /dev/shm/pitchlock-0badf1f3
         run r2; ls precious/0badf1f3",
    );
    assert!(told.contains("r1 0") && told.contains("r2 0"), "{told}");
    assert_eq!(told.matches("file\n").count(), 2, "{told}");
}

/// The folder for temporary files is one for all: the name that the victim would take may be taken.
#[test]
fn squatted_names_hinder_no_start() {
    if !can_be_private("squatted_names_hinder_no_start") {
        return;
    }
    for attack in ["mkdir -m 777", "touch", "ln -s $PWD", "mkfifo"] {
        let place = place();
        let told = script(
            &place,
            &format!(
                "other {attack} $TMPDIR/pitchlock-$V; run r1; run r2; victim test -e /dev/shm/pitchlock-* && echo left
                 ls $TMPDIR | grep -c . ; timeout -s KILL 60 ../pitchlock doctor >/dev/null; echo doctor $?"
            ),
        );
        assert!(
            told.contains("r1 0") && told.contains("r2 0") && told.contains("doctor 0"),
            "{attack}: {told}"
        );
        assert!(!told.contains("left"), "{attack}: {told}");
        // Root is a victim like any other.
        let told = script(
            &place,
            &format!(
                "other {attack} $TMPDIR/pitchlock-0; ../pitchlock run short.ngc --trace none --out r3 >/dev/null; echo r3 $?"
            ),
        );
        assert!(told.contains("r3 0"), "{attack}: {told}");
    }
}

/// The folder of a panel at which one works by hand has a name that nobody foresees.
#[test]
fn squatted_names_hinder_no_panel() {
    if !can_be_private("squatted_names_hinder_no_panel") {
        return;
    }
    let place = place();
    let told = script(
        &place,
        "other sh -c 'mkdir -m 777 $(seq -f \"$TMPDIR/pitchlock-by-hand-%.0f\" $0 $(($0+5000)))' $$
         victim ../pitchlock panel >panel.log 2>&1 & child=$!
         until grep -q http panel.log || ! kill -0 $child 2>/dev/null; do sleep 0.05; done
         cat panel.log; kill $child; wait $child",
    );
    assert!(told.contains("panel: http://"), "{told}");
}

/// Whoever may change what is in a folder may put another program into a run: `--out` takes no folder of
/// somebody else, no link of his, none that is open to everybody, and leaves it as it is.
#[test]
fn a_folder_that_others_may_change_is_no_run_folder() {
    if !can_be_private("a_folder_that_others_may_change_is_no_run_folder") {
        return;
    }
    let place = place();
    let told = script(
        &place,
        "other mkdir -m 777 $TMPDIR/his; victim mkdir -m 700 own link; other ln -s $PWD/link $TMPDIR/link
         victim mkdir open; victim chmod 777 open; run $TMPDIR/his; run $TMPDIR/link; run open; run own
         cat $TMPDIR/his.log; echo left $(ls $TMPDIR/his; ls link; ls open)",
    );
    for word in
        ["/his 2", "/link 2", "open 2", "own 0", "/his: is another user's, or others may write into it"]
    {
        assert!(told.contains(word), "{word}: {told}");
    }
    assert!(told.contains("left\n"), "{told}");
}

/// Files beside those of a run, under its prefix, stay where they are, and the run is wiped around them.
#[test]
fn planted_files_hinder_no_wipe() {
    if !can_be_private("planted_files_hinder_no_wipe") {
        return;
    }
    let place = place();
    fs::copy(crate::shop::example("m20x2"), place.at("v/long.ngc")).expect("room");
    let told = script(
        &place,
        "victim ../pitchlock run long.ngc --out long >long.log 2>&1 & child=$!
         until [ -e long/trace.mcap ]; do sleep 0.01; done
         id=$(ls /dev/shm | grep ^pitchlock- | cut -c11-); other touch /dev/shm/pl${id}_x
         other mkdir /dev/shm/pl${id}_y; other mkfifo /dev/shm/pl${id}_z
         wait $child; echo long $?; run r1; echo left $(ls /dev/shm | grep -v _[xyz]$)",
    );
    assert!(told.contains("long 0") && told.contains("r1 0"), "{told}");
    assert!(told.ends_with("left\n"), "{told}");
}

/// What a run has in shared memory and in temporary files, another user can neither read nor write, remove or
/// enter.
#[test]
fn a_run_is_closed_to_other_users() {
    if !can_be_private("a_run_is_closed_to_other_users") {
        return;
    }
    let place = place();
    fs::copy(crate::shop::example("m20x2"), place.at("v/long.ngc")).expect("room");
    let told = script(
        &place,
        "victim ../pitchlock run long.ngc --json >json 2>err & child=$!
         until [ -e runs/long-1/trace.mcap ]; do sleep 0.01; done
         address=$(ls -d $TMPDIR/pitchlock-$V/*); echo files $(ls /dev/shm | wc -l)
         other sh -c 'for file in /dev/shm/*; do cat $file >/dev/null 2>&1 && echo reads $file
            (echo >>$file) 2>/dev/null && echo writes $file; rm -f $file 2>/dev/null; [ -e $file ] || echo removed $file; done'
         other ls $address 2>/dev/null && echo enters
         other sh -c 'cat runs/long-1/machine.toml' 2>/dev/null && echo looks
         other ../pitchlock regulator --axis x --address $address 2>&1; echo joined $?
         wait $child; echo long $?",
    );
    let files = told.split("files ").nth(1).and_then(|rest| rest.split('\n').next()?.parse::<u32>().ok());
    assert!(files.expect("a number") > 40, "the run had begun: {told}");
    for word in ["reads", "writes", "removed", "enters", "looks", "joined 0"] {
        assert!(!told.contains(word), "{word}: {told}");
    }
    assert!(told.contains("long 0"), "{told}");
}

/// Whoever may neither lock memory nor raise priorities is told so, by the doctor with the limits that are
/// too low and by every process that wants them in real time; the machine runs all the same.
#[test]
fn a_user_who_may_lock_no_memory_and_raise_no_priority_is_told_and_runs() {
    if !can_be_private("a_user_who_may_lock_no_memory_and_raise_no_priority_is_told_and_runs") {
        return;
    }
    let place = place();
    fs::write(place.at("v/slow.toml"), slow_machine()).expect("room");
    let told = script(
        &place,
        "prlimit --pid $$ --memlock=65536:65536 --nice=0:0 || exit 9
         victim ../pitchlock doctor; echo doctor $?
         victim ../pitchlock run short.ngc --machine slow.toml --clock real --trace none --out r1 2>&1; ls r1
         victim ../pitchlock run short.ngc --machine slow.toml --trace none --out r2 >r2.log 2>&1; echo r2 $?; cat r2.log",
    );
    let (doctor, runs) = told.split_once("doctor 0").unwrap_or_else(|| panic!("{told}"));
    for limit in ["locking memory (ulimit -l)", "raising the priority (ulimit -e)"] {
        let note = doctor.lines().find(|line| line.contains(limit)).unwrap_or_else(|| panic!("{doctor}"));
        assert!(note.starts_with("note") && note.contains("real time needs `ulimit"), "{note}");
    }
    let (real, lock_step) = runs.split_once("r2 0").unwrap_or_else(|| panic!("{runs}"));
    for warning in ["memory is not locked", "more answers will be late"] {
        assert!(real.contains(warning), "{warning}: {real}");
        assert!(!lock_step.contains(warning), "{warning}: {lock_step}");
    }
    assert!(real.contains("summary.json"), "{real}");
}
