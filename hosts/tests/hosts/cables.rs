//! A cable between both hosts: the same numbers as in one process; cut, frozen, with frames that are lost.

use serde_json::Value;

use crate::place::{Cable, Host, Place, control, count, ended, project, signal, summary, until, wait_s};

/// Programs with their machines, those that differ most first.
const EXAMPLES: [(&str, &str); 31] = [
    ("m20x2.ngc", "machines/small-lathe"),
    ("mill/circle.ngc", "machines/small-mill"),
    ("tap-m8.ngc", "machines/small-lathe"),
    ("positioner/points.toml", "machines/positioner"),
    ("fanuc/shaft-m24.nc", "machines/small-lathe"),
    ("mill/contour.ngc", "machines/small-mill"),
    ("shaft.ngc", "machines/small-lathe"),
    ("worm-left.ngc", "machines/small-lathe"),
    ("internal-m30.ngc", "machines/small-lathe"),
    ("chain.ngc", "machines/small-lathe"),
    ("lead-table.ngc", "machines/small-lathe"),
    ("blunt-start.ngc", "machines/small-lathe"),
    ("two-inserts.ngc", "machines/small-lathe"),
    ("scroll.ngc", "machines/small-lathe"),
    ("tap-npt.ngc", "machines/small-lathe"),
    ("varied.ngc", "machines/small-lathe"),
    ("fanuc/taper-g32.nc", "machines/small-lathe"),
    ("fanuc/tap-peck.nc", "machines/small-lathe"),
    ("fanuc/grooves-macro.nc", "machines/small-lathe"),
    ("fanuc/variable-lead.nc", "machines/small-lathe"),
    ("fanuc/barrel.nc", "machines/small-lathe"),
    ("fanuc/domed-face.nc", "machines/small-lathe"),
    ("fanuc/two-starts.nc", "machines/small-lathe"),
    ("mill/tap-m6.ngc", "machines/small-mill"),
    ("positioner/cylinders.toml", "machines/positioner"),
    ("positioner/wave.toml", "machines/positioner"),
    ("shape/contour.toml", "machines/small-mill"),
    ("shape/inline.ngc", "machines/small-mill"),
    ("shape/wave.toml", "machines/small-mill"),
    ("rechucked/thread.ngc", "machines/small-lathe"),
    ("bar-feeder/pin.ngc", "bar-feeder/lathe"),
];

/// How many of them, unless `PITCHLOCK_FAR` says otherwise.
const SOME: u64 = 3;

#[test]
fn examples_are_the_same_on_two_hosts_and_in_one_process() {
    let some = count("PITCHLOCK_FAR", SOME).min(EXAMPLES.len() as u64) as usize;
    let mut machines: Vec<_> = EXAMPLES[..some].iter().map(|(_, machine)| *machine).collect();
    machines.sort_unstable();
    machines.dedup();
    for machine in machines {
        let Some(cable) = Cable::lay() else { return };
        let mut place = Place::new(Some(cable));
        let file = project("examples").join(machine).with_extension("toml").display().to_string();
        place.serve(&["--machine", &file]);
        for (program, _) in EXAMPLES[..some].iter().filter(|(_, on)| *on == machine) {
            let program = project("examples").join(program);
            let (far, alone) =
                (place.run(&program, &["--machine", &file]), place.alone(&program, &["--machine", &file]));
            let what = program.display();
            for field in ["trace_hash", "cycles", "passes", "moves", "outcome"] {
                assert_eq!(far[field], alone[field], "{what}: {field}");
            }
            println!("{what}: {} cycles, {} s", far["cycles"], far["wall_s"]);
        }
    }
}

/// Many short passes: more machine code than all queues hold, so the cable is needed to the end.
fn many_passes(place: &Place, number: u32) -> std::path::PathBuf {
    let pass = |n: u32| format!("G0 X{:.2}\nG33 Z-8 K2\nG0 X20\nG0 Z20\n", 9.9 - 0.005 * f64::from(n));
    let passes: String = (0..number).map(pass).collect();
    place.write("many.ngc", &format!("G18 G21 G90 G8\nM3 S1500\nG0 X20 Z20\n{passes}M5\nM2\n"))
}

/// Moments of a run, s: a sequence of Weyl, the same every time.
fn moments(number: u64) -> impl Iterator<Item = f64> {
    (1..=number).map(|n| 0.1 + 1.4 * (n as f64 * 0.618_033_988_75).fract())
}

/// Where the tool is clear of the groove, whose crest is at 10 mm.
const CLEAR_MM: f64 = 12.0;
/// Where it stands in front of the part, as before each pass.
const FRONT_MM: f64 = 19.0;

/// Cuts, unless `PITCHLOCK_CUTS` says otherwise.
const CUTS: u64 = 4;

#[test]
fn a_cable_that_is_cut_in_a_thread_leaves_a_machine_at_rest_and_both_hosts_clean() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    let program = many_passes(&place, 150);
    place.serve(&[]);
    let cable = || place.cable.as_ref().expect("laid");
    for (n, moment) in (1..).zip(moments(count("PITCHLOCK_CUTS", CUTS))) {
        let run = place.far(&program, &["--trace", "none", "--pace", "10"]).spawn().expect("it starts");
        place.cuts(n);
        wait_s(moment);
        cable().plug(false);
        let output = ended(run, 5.0);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("is lost: nothing was heard of the other host"), "{said}");
        until("host A is clean", 1.0, || place.is_clean(Host::A));
        let summary = || {
            let text = std::fs::read_to_string(place.runs()[n - 1].join("summary.json")).unwrap_or_default();
            serde_json::from_str::<Value>(&text).ok()
        };
        until("host B is clean", 3.0, || place.is_clean(Host::B) && summary().is_some());
        let summary = summary().expect("it is there");
        let faults = summary["faults"].as_array().expect("faults");
        let named = |fault: &Value| {
            fault["source"] == "pitchlock-link"
                && fault["text"].as_str().is_some_and(|text| text.contains("cable"))
        };
        assert!(faults.len() == 1 && named(&faults[0]), "cut {n} at {moment} s: {faults:?}");
        assert_eq!(summary["outcome"], "faulted");
        let journal = place.journal(&place.runs()[n - 1]).expect("a journal");
        let rests = |axis: &str| {
            let axis = &journal["axes"][axis];
            assert_eq!(axis["state"], "streaming", "{journal}");
            axis["measured"].as_f64().expect("a position")
        };
        let (x, z) = (rests("x"), rests("z"));
        assert!(x > CLEAR_MM || z > FRONT_MM, "the tool is out of the groove: {journal}");
        let passes = journal["passes"].as_u64().expect("a number");
        assert!((2..150).contains(&passes), "{passes} passes: the cable was cut in the thread");
        println!("cut {n} at {moment:.2} s: {passes} passes, both hosts clean");
        cable().plug(true);
        until("the machine waits again", 5.0, || !place.links(Host::B).is_empty());
    }
    let after = place.run(&project("examples/m20x2.ngc"), &[]);
    assert_eq!(after["trace_hash"], place.alone(&project("examples/m20x2.ngc"), &[])["trace_hash"]);
}

#[test]
fn a_link_that_is_frozen_for_a_tenth_of_a_second_recovers_by_itself() {
    let Some(cable) = Cable::lay() else { return };
    let mut place = Place::new(Some(cable));
    let program = many_passes(&place, 60);
    place.serve(&[]);
    let alone = place.alone(&program, &[]);
    let run = place.far(&program, &["--json", "--trace", "none", "--pace", "30"]).spawn().expect("it starts");
    until("the run has begun", 20.0, || {
        place.runs().first().is_some_and(|run| run.join("journal.bin").exists())
    });
    for host in [Host::A, Host::B, Host::A, Host::B] {
        let [link] = place.links(host)[..] else { panic!("one link at {host:?}: {:?}", place.links(host)) };
        signal(link, "STOP");
        wait_s(0.1);
        signal(link, "CONT");
        wait_s(0.2);
    }
    let summary = summary(&ended(run, 120.0));
    assert_eq!(summary["trace_hash"], alone["trace_hash"], "{summary}");
}

#[test]
fn one_frame_lost_in_a_hundred_changes_nothing() {
    let Some(cable) = Cable::lay() else { return };
    if !cable.loses_one_of_a_hundred() {
        return;
    }
    let mut place = Place::new(Some(cable));
    let program = many_passes(&place, 60);
    place.serve(&[]);
    let (far, alone) = (place.run(&program, &[]), place.alone(&program, &[]));
    assert_eq!(far["trace_hash"], alone["trace_hash"], "{far}");
    assert_eq!(far["passes"], alone["passes"]);
    let mut doctor = place.command(Host::A, &control());
    doctor.args(["doctor", "--at", &place.address, "--key"]).arg(place.at("key"));
    let output = doctor.output().expect("it starts");
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{table}{} frames were lost", place.cable.as_ref().expect("laid").lost());
    let rows: Vec<&str> = table.lines().skip(2).collect();
    assert!(rows.len() == 3 && rows.iter().all(|row| row.ends_with("| 0 |")), "{table}");
    assert!(place.cable.as_ref().expect("laid").lost() > 0, "frames were lost, and came again");
}
