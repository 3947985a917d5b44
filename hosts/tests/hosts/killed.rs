//! The launcher at the machine is killed, and addresses that it cannot have: both are named at once.

use std::{fs, net::TcpListener, path::Path, process::Stdio};

use crate::{
    place::{Host, Place, control, ended, project, signal, until},
    refusals::{text, waiting},
};

/// Whoever waits for a launcher that was killed hears of it within this, s.
const NAMED_S: f64 = 5.0;

/// In a program, and where somebody stands at it.
#[test]
fn a_launcher_that_is_killed_is_named_within_five_seconds() {
    let mut place = waiting();
    let program = project("examples/m20x2.ngc");
    let run = place.far(&program, &["--trace", "none", "--pace", "2"]).spawn().expect("it starts");
    place.cuts(1);
    place.kill_serve();
    let output = ended(run, NAMED_S);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    assert!(text(&output).contains("`pitchlock serve` there is gone"), "{}", text(&output));
    until("nothing of it is left", 60.0, || place.links(Host::B).is_empty() && place.is_clean(Host::B));
    assert!(place.is_clean(Host::A), "nothing is left");

    place.serve(&[]);
    let said = place.at("panel.txt");
    let mut panel = place.command(Host::A, &control());
    panel.args(["panel", "short.ngc", "--at", &place.address, "--key"]).arg(place.at("key"));
    panel.current_dir(place.at("")).stdout(Stdio::null()).stderr(fs::File::create(&said).expect("a file"));
    let panel = panel.spawn().expect("it starts");
    let read = || fs::read_to_string(&said).unwrap_or_default();
    until("the panel is there", 20.0, || read().contains("panel: http://"));
    place.kill_serve();
    let status = ended(panel, NAMED_S).status;
    assert_eq!(status.code(), Some(1), "{}", read());
    assert!(read().contains("`pitchlock serve` there is gone"), "{}", read());
}

/// The run is over, and the launcher is killed before it has told what became of it: the address is its own,
/// so that nobody answers there says that it will never be told.
#[test]
fn a_launcher_that_is_killed_before_it_has_summed_up_is_named_within_five_seconds() {
    let mut place = Place::new(None);
    for _ in 0..5 {
        place.serve(&[]);
        let (program, links) = (project("examples/m20x2.ngc"), place.links(Host::B));
        let run = place.far(&program, &[]).spawn().expect("it starts");
        // From the end of its link to the beginning of the next one it sums up.
        until("the link has ended with the run", 60.0, || place.links(Host::B) != links);
        place.kill_serve();
        let output = ended(run, NAMED_S);
        let named = "it has not summed up the run: nobody answers";
        if text(&output).contains(named) {
            assert_eq!(output.status.code(), Some(1), "{}", text(&output));
            return;
        }
        // It was told just then: once more.
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        until("nothing of it is left", 60.0, || place.links(Host::B).is_empty());
    }
    panic!("each of five runs was summed up before its launcher was killed");
}

/// Nothing of a run is lost, and nobody is told of a link that is.
#[test]
fn a_machine_that_is_told_to_end_while_it_sums_up_says_how_the_run_ended() {
    let mut place = Place::new(None);
    for name in ["TERM", "HUP", "INT"] {
        place.serve(&[]);
        let (program, links) = (project("examples/m20x2.ngc"), place.links(Host::B));
        let run = place.far(&program, &[]).spawn().expect("it starts");
        until("the link has ended with the run", 60.0, || place.links(Host::B) != links);
        place.signal_serve(name);
        let output = ended(run, 20.0);
        assert_eq!(output.status.code(), Some(0), "{name}: {}\n{}", text(&output), place.said());
        let folder = place.runs().pop().expect("a run folder");
        assert!(folder.join("report.html").exists(), "{name}");
        // Ctrl-C is for the run, or for what waits behind it.
        if name != "INT" {
            assert_eq!(place.serve_ends(10.0), Some(0), "{name}: {}", place.said());
        }
        assert!(place.is_clean(Host::B) || name == "INT", "{name}");
    }
}

/// The process of the link at the machine is killed, too: its end of the connection says so.
#[test]
fn a_link_that_is_killed_at_the_machine_is_named_before_silence_would_be() {
    let place = waiting();
    let run = place.far(&project("examples/m20x2.ngc"), &["--trace", "none", "--pace", "2"]).spawn();
    let run = run.expect("it starts");
    until("the run has begun", 20.0, || {
        place.runs().first().is_some_and(|run| run.join("journal.bin").exists())
    });
    place.links(Host::B).iter().for_each(|link| signal(*link, "KILL"));
    let output = ended(run, NAMED_S);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    let named = "the process of the link on the other host has ended";
    assert!(text(&output).contains(named), "{}", text(&output));
}

#[test]
fn an_address_that_cannot_be_had_is_said_with_the_remedy() {
    let place = Place::new(None);
    let _taken = TcpListener::bind(&place.address).expect("its address");
    let serves = |program: &Path, before: &[&str], address: &str| {
        let mut command = place.command(Host::B, program);
        command.args(before).args(["serve", "--listen", address, "--key"]).arg(place.at("key"));
        let output = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
        let output = ended(output.expect("it starts"), 20.0);
        assert_eq!(output.status.code(), Some(2), "{address}: {}", text(&output));
        text(&output)
    };
    for (address, remedy) in [
        (place.address.as_str(), "`ss -ltnp` names it"),
        ("192.0.2.7:7447", "`ip address` lists those"),
        ("224.0.0.1:7447", "`ip address` lists those"),
        ("255.255.255.255:7447", "`ip address` lists those"),
        ("7447", "HOST:PORT"),
        ("127.0.0.1", "HOST:PORT"),
        ("127.0.0.1:70000", "HOST:PORT"),
        ("nowhere.invalid:7447", "no computer of this name is known here"),
    ] {
        let said = serves(&control(), &[], address);
        assert!(said.contains(&format!("--listen {address}: ")) && said.contains("help: "), "{said}");
        assert!(said.contains(remedy), "{address}: {said}");
    }
    // A port that is not for everybody, asked for by somebody who is not an administrator.
    let known = fs::read_to_string("/proc/sys/net/ipv4/ip_unprivileged_port_start").unwrap_or_default();
    if known.trim() != "1024" || !Path::new("/usr/bin/setpriv").exists() {
        eprintln!("left out: a port of an administrator needs `setpriv`");
        return;
    }
    let nobody = ["--reuid=65534", "--regid=65534", "--clear-groups", "--"];
    let program = control().display().to_string();
    let said = serves(Path::new("/usr/bin/setpriv"), &[&nobody[..], &[&program]].concat(), "127.0.0.1:80");
    assert!(said.contains("a port below 1024 is for an administrator"), "{said}");
}
