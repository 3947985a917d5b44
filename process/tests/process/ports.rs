//! Ports, wake-ups and name spaces, with owner and members in one process.
#![allow(clippy::unwrap_used)]

use std::{io::Write as _, os::unix::fs::OpenOptionsExt as _, time::Duration};

use process::ipc::{
    ChannelCount, IpcError, Keep, Member, NameSpace, Patience, Port, Process, Undelivered, channel,
    time::Moment, total,
};
use protocol::{Axis, Code, CodePacket, Credit, Cycle, DriveCommand, Item, Measurement};

const AXES: [Axis; 2] = [Axis::X, Axis::Z];
const SHORT: Patience = Patience::Bounded(Duration::from_micros(200));

fn join(space: &NameSpace, process: Process) -> Member {
    Member::join(&space.address(), process).unwrap()
}

fn connect(ports: &[&dyn Port]) {
    let deadline = Moment::in_s(5.0);
    while !ports.iter().all(|port| port.connected().unwrap()) {
        assert!(!deadline.passed(), "not connected");
    }
}

/// Some machine code.
fn dwell(sequence: u64) -> CodePacket {
    CodePacket::pack(sequence, &Item { line: 7, code: Code::Dwell { seconds: 0.5 } })
}

fn shared_memory_of(address: &str) -> Vec<String> {
    let id = address.rsplit('/').next().unwrap();
    let names = std::fs::read_dir("/dev/shm").unwrap().flatten();
    names.filter_map(|entry| entry.file_name().into_string().ok()).filter(|name| name.contains(id)).collect()
}

#[test]
fn a_lossless_channel_keeps_order_and_counts() {
    let space = NameSpace::create(&AXES).unwrap();
    let (one, other) = (join(&space, Process::Interpreter), join(&space, Process::Interpolator));
    let mut sender = one.sender(channel::MACHINE_CODE, SHORT).unwrap();
    let mut receiver = other.receiver(channel::MACHINE_CODE).unwrap();
    connect(&[&sender, &receiver]);
    for sequence in 0..1000 {
        sender.send(&dwell(sequence)).unwrap();
        if sequence % 3 == 2 {
            for expected in sequence - 2..=sequence {
                assert_eq!(receiver.receive().unwrap(), Some(dwell(expected)));
            }
        }
    }
    let bytes = (0..1000).map(|sequence| dwell(sequence).as_bytes().len() as u64).sum();
    let expected = ChannelCount {
        name: "machine-code".into(),
        sent: 1000,
        received: 999,
        bytes,
        ..ChannelCount::default()
    };
    assert_eq!(total([sender.count(), receiver.count()]), [expected]);
}

#[test]
fn a_full_queue_is_an_error_in_bounded_time_and_nothing_queued_is_lost() {
    let space = NameSpace::create(&AXES).unwrap();
    let (one, other) = (join(&space, Process::Interpreter), join(&space, Process::Interpolator));
    let mut sender = one.sender(channel::MACHINE_CODE, SHORT).unwrap();
    let mut receiver = other.receiver(channel::MACHINE_CODE).unwrap();
    connect(&[&sender, &receiver]);
    for sequence in 0..channel::CODE_DEPTH {
        sender.send(&dwell(sequence)).unwrap();
    }
    let refused = sender.send(&dwell(0));
    assert_eq!(refused, Err(Undelivered::Full("machine-code".into())));
    for sequence in 0..channel::CODE_DEPTH {
        assert_eq!(receiver.receive().unwrap(), Some(dwell(sequence)));
    }
    assert!(receiver.receive().unwrap().is_none());
    sender.send(&dwell(0)).unwrap();
    assert!(receiver.receive().unwrap().is_some());
    assert_eq!(receiver.count().lost, 1, "the refused message shows as a gap");
    for sequence in 0..channel::CODE_DEPTH {
        sender.send(&dwell(sequence)).unwrap();
    }
    for _ in 0..3 {
        assert!(sender.send(&dwell(7)).is_err());
        sender.comes_again();
    }
    while receiver.receive().unwrap().is_some() {}
    sender.send(&dwell(7)).unwrap();
    assert_eq!(receiver.receive().unwrap(), Some(dwell(7)));
    assert_eq!(receiver.count().lost, 1, "what was sent again until it was taken is not lost");
}

#[test]
fn a_latest_value_channel_keeps_the_newest_and_loses_nothing() {
    let space = NameSpace::create(&AXES).unwrap();
    let (one, other) = (join(&space, Process::Interpolator), join(&space, Process::Interpreter));
    let mut sender = one.sender(channel::CREDIT, Patience::Forever).unwrap();
    let mut receiver = other.receiver(channel::CREDIT).unwrap();
    connect(&[&sender, &receiver]);
    for taken in 0..5 {
        sender.send(&Credit { taken }).unwrap();
    }
    assert_eq!(receiver.receive().unwrap(), Some(Credit { taken: 4 }));
    assert_eq!(receiver.receive().unwrap(), None);
    assert_eq!((receiver.count().received, receiver.count().lost), (1, 0));
}

#[test]
fn a_missing_receiver_is_an_error() {
    let space = NameSpace::create(&AXES).unwrap();
    let (plant, x) = (join(&space, Process::Plant), join(&space, Process::Regulator(Axis::X)));
    let mut sender = plant.sender(channel::MEASUREMENT, SHORT).unwrap();
    let receiver = x.receiver(channel::MEASUREMENT).unwrap();
    assert!(receiver.connected().unwrap());
    assert!(!sender.connected().unwrap());
    let refused = sender.send(&Measurement::default());
    let expected = Undelivered::Receivers { name: "measurement".into(), reached: 1, expected: 2 };
    assert_eq!(refused, Err(expected));
    sender.expect_one_less();
    sender.send(&Measurement::default()).unwrap();
}

#[test]
fn a_channel_has_no_more_ends_than_the_table_says() {
    let space = NameSpace::create(&AXES).unwrap();
    let one = join(&space, Process::Plant);
    let _sender = one.sender(channel::TRUTH, SHORT).unwrap();
    assert!(matches!(one.sender(channel::TRUTH, SHORT), Err(IpcError::Bus { name, .. }) if name == "truth"));
    let y = one.sender(channel::DRIVE_COMMAND.of(Axis::Y), SHORT);
    assert!(matches!(y, Err(IpcError::Bus { name, .. }) if name == "drive-command/y"));
}

#[test]
fn two_machines_do_not_see_each_other() {
    let (one, other) = (NameSpace::create(&AXES).unwrap(), NameSpace::create(&AXES).unwrap());
    assert_ne!(one.address(), other.address());
    let mut sender =
        join(&one, Process::Regulator(Axis::X)).sender(channel::DRIVE_COMMAND.of(Axis::X), SHORT).unwrap();
    let mut receiver = join(&other, Process::Plant).receiver(channel::DRIVE_COMMAND.of(Axis::X)).unwrap();
    assert!(!sender.connected().unwrap() && !receiver.connected().unwrap());
    assert!(sender.send(&DriveCommand::default()).is_err());
    assert!(receiver.receive().unwrap().is_none());
}

#[test]
fn a_wake_up_before_the_wait_is_not_lost() {
    let space = NameSpace::create(&AXES).unwrap();
    let (plant, mut x) = (join(&space, Process::Plant), join(&space, Process::Regulator(Axis::X)));
    let waker = plant.waker(Process::Regulator(Axis::X)).unwrap();
    connect(&[&waker]);
    for _ in 0..3 {
        waker.wake().unwrap();
        waker.wake().unwrap();
        x.wait().unwrap();
    }
    x.wait_at_most(Duration::from_millis(1)).unwrap();
}

#[test]
fn start_names_the_ports_that_found_nobody() {
    let space = NameSpace::create(&AXES).unwrap();
    let mut plant = join(&space, Process::Plant);
    let truth = plant.sender(channel::TRUTH, SHORT).unwrap();
    let waker = plant.waker(Process::Interpolator).unwrap();
    let error = plant.start(&[&truth, &waker], Moment::in_s(0.01)).unwrap_err();
    assert!(
        matches!(&error, IpcError::NotConnected(names) if names == &["truth", "wake/interpolator"]),
        "{error}"
    );
}

#[test]
fn wrong_addresses_are_refused() {
    for address in ["", "/", "/tmp", "/tmp/0123abcd", "/tmp/../etc", "0123abcd", "\0"] {
        let error = Member::join(address, Process::Plant).unwrap_err();
        assert!(matches!(error, IpcError::NoSuchAddress(_)), "{address:?}: {error}");
    }
}

#[test]
fn dropping_a_name_space_leaves_nothing() {
    let space = NameSpace::create(&AXES).unwrap();
    let address = space.address();
    assert!(!shared_memory_of(&address).is_empty());
    drop(space);
    assert_eq!(shared_memory_of(&address), Vec::<String>::new());
    assert!(!std::path::Path::new(&address).exists());
}

#[test]
fn a_new_name_space_wipes_the_abandoned_and_spares_the_living() {
    let living = NameSpace::create(&AXES).unwrap();
    let base = std::path::Path::new(&living.address()).parent().unwrap().to_owned();
    // As a launcher writes them: for its user alone.
    let write = |id: &str, text: &str| {
        let path = format!("/dev/shm/pitchlock-{id}");
        let _ = std::fs::remove_file(&path); // of a test that failed
        let mut options = std::fs::OpenOptions::new();
        let mut marker = options.write(true).create_new(true).mode(0o600).open(path).unwrap();
        marker.write_all(text.as_bytes()).unwrap();
    };
    let left = ["0000beef", "0000dead"].map(|id| {
        let (path, memory) = (base.join(id), format!("/dev/shm/pl{id}_something"));
        std::fs::create_dir_all(path.join("services")).unwrap();
        std::fs::write(&memory, "x").unwrap();
        write(id, &format!("1 {}", path.display()));
        (path, memory)
    });
    std::fs::remove_dir_all(&left[0].0).unwrap(); // as cleaners of temporary files do
    write("0000babe", "1 /tm"); // killed while writing
    drop(NameSpace::create(&AXES).unwrap());
    for (path, memory) in left {
        assert!(!path.exists() && !std::path::Path::new(&memory).exists());
    }
    for id in ["0000babe", "0000beef", "0000dead"] {
        assert!(!std::path::Path::new(&format!("/dev/shm/pitchlock-{id}")).exists());
    }
    assert!(!shared_memory_of(&living.address()).is_empty());
    join(&living, Process::Plant).sender(channel::TRUTH, SHORT).unwrap();
}

#[test]
fn the_table_of_channels_holds_together() {
    let rows = channel::all(&Axis::ALL);
    let mut names: Vec<_> = rows.iter().map(|row| row.name.clone()).collect();
    assert!(names.iter().all(|name| name.len() < 32), "a name has to fit into a count");
    names.sort();
    names.dedup();
    assert_eq!(names.len(), rows.len());
    for row in &rows {
        assert!(!row.senders.is_empty() && !row.receivers.is_empty() && row.depth > 0, "{}", row.name);
        assert!(row.receivers.iter().all(|process| !row.senders.contains(process)), "{}", row.name);
        let controller = |process: &Process| *process != Process::Launcher;
        assert!(row.name != "truth" || !row.receivers.iter().any(controller));
        assert_eq!(row.keep == Keep::Latest, row.name == "credit");
    }
    let measurement = rows.iter().find(|row| row.name == "measurement").unwrap();
    assert_eq!(measurement.receivers.len(), Axis::ALL.len());
    assert_eq!(measurement.message_bytes, size_of::<Measurement>());
    assert_eq!(Cycle(0), Measurement::default().cycle);
}
