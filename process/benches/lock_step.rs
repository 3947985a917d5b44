//! Where the time of lock step goes: a control cycle of the machine's processes beside the same processes
//! without modules, and beside nothing but shared memory and futexes. All of them on one processor, as
//! `pitchlock run` has them in virtual time.
//!
//! | row | processes | a cycle is |
//! |---|---|---|
//! | `futexes` | plant, two regulators | two are woken, both answer, the last one wakes: three switches |
//! | `channels` | the same | a measurement to each, a command of each, by channels and bells |
//! | `machine` | those, interpolator, interpreter, launcher | all modules, while the program dwells; the launcher takes every record, and writes none |
//!
//! So `futexes` is what taking turns costs, `channels` less that what messages cost, `machine` less that what
//! modules cost, and the interpolator in every fourth cycle. `cargo bench -p process --bench lock_step`

use std::{
    path::PathBuf,
    process::{Child, Command},
    sync::atomic::Ordering::SeqCst,
    time::Duration,
};

use criterion::{Criterion, Throughput};
use iceoryx2::prelude::{SemanticString, ZeroCopySend};
use iceoryx2_bb_concurrency::atomic::AtomicU32;
use iceoryx2_bb_posix::access_mode::AccessMode;
use iceoryx2_bb_system_types::file_name::FileName;
use iceoryx2_cal::{
    dynamic_storage::{
        DynamicStorage as _, DynamicStorageBuilder as _,
        posix_shared_memory::{Builder, Configuration, Storage},
    },
    named_concept::{NamedConceptBuilder as _, NamedConceptConfiguration as _},
};
use process::{
    ipc::{
        IpcError, Member, NameSpace, Patience, Process, channel,
        time::{Moment, pin_to, processors, sleep_until},
    },
    shell::{
        Clock, LanguageArgs, Pace, ProcessArgs, ShellError, interpolator, interpreter, plant, regulator,
    },
};
use protocol::{Axis, Cycle, DriveCommand, Measurement};
use rustix::thread::futex::{self, Flags};

type Failure = Box<dyn std::error::Error>;

const AXES: [Axis; 2] = [Axis::X, Axis::Z];
/// So long everybody may take to come up.
const START_S: f64 = 20.0;
/// How long nothing is looked at while others come up or go.
const NAP: Duration = Duration::from_millis(2);

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    // This program is also each of its processes.
    match words[..] {
        ["--spoke", name, number] => spoke(name, number.parse()?),
        ["--regulator", address, axis] => Ok(answers(address, named(axis))?),
        ["--machine", address, process, program] => Ok(module(address, process, program)?),
        _ => {
            bench();
            Ok(())
        }
    }
}

fn bench() {
    // Inherited by the others.
    pin_to(processors()[0]).expect("a processor");
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("lock step");
    group.throughput(Throughput::Elements(1)).sample_size(10);
    for (name, takes) in [
        ("futexes", futexes as fn(u64) -> Result<Duration, Failure>),
        ("channels", channels),
        ("machine", machine),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|cycles| takes(cycles).unwrap_or_else(|error| panic!("{name}: {error}")));
        });
    }
    group.finish();
    criterion.final_summary();
}

/// Starts this program as one of its processes.
fn start(words: &[&str]) -> std::io::Result<Child> {
    Command::new(std::env::current_exe()?).args(words).spawn()
}

fn named(axis: &str) -> Axis {
    let known = AXES.into_iter().find(|known| known.name() == axis);
    known.unwrap_or_else(|| panic!("{axis} is not an axis of this machine"))
}

/// Until something is so; whoever ends early is an error.
fn until(children: &mut [Child], mut so: impl FnMut() -> Result<bool, IpcError>) -> Result<(), Failure> {
    let deadline = Moment::in_s(START_S);
    while !so()? {
        for child in &mut *children {
            if let Some(status) = child.try_wait()?.filter(|status| !status.success()) {
                return Err(format!("a process ended early: {status}").into());
            }
        }
        if deadline.passed() {
            return Err("a process does not come up, or does not go".into());
        }
        sleep_until(Moment::now().after(NAP));
    }
    Ok(())
}

fn collect(children: Vec<Child>) -> Result<(), Failure> {
    for mut child in children {
        let status = child.wait()?;
        if !status.success() {
            return Err(format!("a process ended with {status}").into());
        }
    }
    Ok(())
}

/// A word of shared memory that somebody may sleep on. It has a line of the processor's cache to itself.
#[derive(Debug, Default, ZeroCopySend)]
#[type_name("pitchlock/bench-word/1")]
#[repr(C)]
#[repr(align(64))]
struct Word(AtomicU32);

/// The turn of the hub, of each spoke, and how many have not answered.
type Words = Storage<[Word; 4]>;
const LEFT: usize = 3;
/// The last turn.
const END: u32 = u32::MAX;

fn place(name: &str) -> Result<(FileName, Configuration<[Word; 4]>), Failure> {
    let file = |text: &str| FileName::new(text.as_bytes()).map_err(|error| format!("{text}: {error:?}"));
    Ok((file("words")?, Configuration::default().prefix(&file(name)?)))
}

impl Word {
    /// Sleeps while it is this; what it is then.
    fn after(&self, turn: u32) -> Result<u32, Failure> {
        loop {
            let now = self.0.load(SeqCst);
            if now != turn {
                return Ok(now);
            }
            match futex::wait(&self.0, Flags::empty(), turn, None) {
                Ok(()) | Err(rustix::io::Errno::AGAIN | rustix::io::Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Becomes this, and wakes who sleeps on it.
    fn turns(&self, turn: u32) -> Result<(), Failure> {
        self.0.store(turn, SeqCst);
        futex::wake(&self.0, Flags::empty(), 1)?;
        Ok(())
    }
}

/// As many processes as regulators and a plant, and nothing between them but four words.
fn futexes(cycles: u64) -> Result<Duration, Failure> {
    let name = format!("pitchlock_bench_{}_", std::process::id());
    let (file, configuration) = place(&name)?;
    let storage: Words = Builder::new(&file)
        .config(&configuration)
        .has_ownership(true)
        .initializer(|words: &mut std::mem::MaybeUninit<[Word; 4]>, _| {
            words.write(Default::default());
            true
        })
        .create()
        .map_err(|error| format!("shared memory: {error:?}"))?;
    let words = storage.get();
    let children = vec![start(&["--spoke", &name, "1"])?, start(&["--spoke", &name, "2"])?];
    let mut turn = 0;
    let cycle = |turn: &mut u32| -> Result<(), Failure> {
        let before = *turn;
        *turn = before.wrapping_add(1) % END;
        words[LEFT].0.store(AXES.len() as u32, SeqCst);
        words[1].turns(*turn)?;
        words[2].turns(*turn)?;
        words[0].after(before).map(drop)
    };
    // The first one waits until both are there.
    cycle(&mut turn)?;
    let begun = Moment::now();
    for _ in 0..cycles {
        cycle(&mut turn)?;
    }
    let took = begun.elapsed();
    words[1].turns(END)?;
    words[2].turns(END)?;
    collect(children)?;
    Ok(took)
}

/// One of them: it answers each turn, the last of both wakes the hub.
fn spoke(name: &str, number: usize) -> Result<(), Failure> {
    let (file, configuration) = place(name)?;
    let storage: Words = Builder::new(&file)
        .config(&configuration)
        .has_ownership(false)
        .open(AccessMode::ReadWrite)
        .map_err(|error| format!("shared memory: {error:?}"))?;
    let words = storage.get();
    let mut turn = 0;
    loop {
        turn = words[number].after(turn)?;
        if turn == END {
            return Ok(());
        }
        if words[LEFT].0.fetch_sub(1, SeqCst) == 1 {
            words[0].turns(turn)?;
        }
    }
}

/// The same with a measurement to each regulator and a command of each, by the channels of the machine.
fn channels(cycles: u64) -> Result<Duration, Failure> {
    let mut space = NameSpace::create(&AXES)?;
    let address = space.address();
    let mut children = vec![start(&["--regulator", &address, "x"])?, start(&["--regulator", &address, "z"])?];
    let plant = std::thread::Builder::new().spawn(move || asks(&address, cycles))?;
    // This machine has neither interpreter nor interpolator.
    let absent = |process: Process| matches!(process, Process::Interpreter | Process::Interpolator);
    until(&mut children, || Ok(space.missing(&[])?.into_iter().all(absent)))?;
    space.start()?;
    while !space.unfinished()?.into_iter().all(absent) {
        sleep_until(Moment::now().after(NAP));
    }
    space.end()?;
    collect(children)?;
    plant.join().map_err(|_| "the plant panicked")?.map_err(Into::into)
}

/// The plant without a plant.
fn asks(address: &str, cycles: u64) -> Result<Duration, IpcError> {
    let mut member = Member::join(address, Process::Plant)?;
    let mut measurements = member.sender(channel::MEASUREMENT, Patience::Forever)?;
    let mut commands = AXES.map(|axis| member.receiver(channel::DRIVE_COMMAND.of(axis)));
    let wakers = AXES.map(|axis| member.waker(Process::Regulator(axis)));
    let ([Ok(x), Ok(z)], [Ok(wake_x), Ok(wake_z)]) = (&mut commands, &wakers) else {
        panic!("ports of a plant: {commands:?} {wakers:?}")
    };
    member.start(&[&measurements, &*x, &*z, wake_x, wake_z], Moment::in_s(START_S))?;
    let begun = Moment::now();
    for n in 0..cycles {
        let last = u32::from(n + 1 == cycles);
        measurements.send(&Measurement { cycle: Cycle(n), last, ..Measurement::default() })?;
        wake_x.wake()?;
        wake_z.wake()?;
        for commands in [&mut *x, &mut *z] {
            while commands.receive()?.is_none() {
                member.wait()?;
            }
        }
    }
    let took = begun.elapsed();
    let counts = [measurements.count(), x.count(), z.count()];
    member.finish(&counts)?;
    Ok(took)
}

/// A regulator without a regulator.
fn answers(address: &str, axis: Axis) -> Result<(), IpcError> {
    let mut member = Member::join(address, Process::Regulator(axis))?;
    let mut measurements = member.receiver(channel::MEASUREMENT)?;
    let mut commands = member.sender(channel::DRIVE_COMMAND.of(axis), Patience::Forever)?;
    let plant = member.waker(Process::Plant)?;
    member.start(&[&measurements, &commands, &plant], Moment::in_s(START_S))?;
    loop {
        let Some(measurement) = measurements.receive()? else {
            member.wait()?;
            continue;
        };
        commands.send(&DriveCommand { cycle: measurement.cycle, ..DriveCommand::default() })?;
        plant.wake()?;
        if measurement.last != 0 {
            return member.finish(&[commands.count(), measurements.count()]);
        }
    }
}

/// All processes of the built-in lathe, and a program that dwells for longer than anybody waits.
fn machine(cycles: u64) -> Result<Duration, Failure> {
    let program = std::env::temp_dir().join(format!("pitchlock-bench-{}.ngc", std::process::id()));
    std::fs::write(&program, "G21 G90\nG4 P86400\nM2\n")?;
    let mut space = NameSpace::create(&AXES)?;
    let (address, path) = (space.address(), program.display().to_string());
    let of = |process: &str| start(&["--machine", &address, process, &path]);
    let all = ["interpreter", "interpolator", "x", "z", "plant"].map(of).into_iter();
    let mut children = all.collect::<Result<Vec<_>, _>>()?;
    let member = space.launcher();
    let mut truths = member.receiver(channel::TRUTH)?;
    let mut statuses = member.receiver(channel::MACHINE_STATUS)?;
    let [mut x, mut z] = [Axis::X, Axis::Z].map(|axis| member.receiver(channel::AXIS_STATUS.of(axis)));
    let (x, z) = (x.as_mut().map_err(|_| "a port")?, z.as_mut().map_err(|_| "a port")?);
    let mut arrivals = member.receiver(channel::ARRIVAL)?;
    let operator = member.sender(channel::OPERATOR, Patience::Forever)?;
    until(&mut children, || {
        Ok(space.missing(&[&truths, &statuses, &*x, &*z, &arrivals, &operator])?.is_empty())
    })?;
    space.start()?;
    let begun = Moment::now();
    let (mut took, mut last) = (None, false);
    while !last {
        while let Some(truth) = truths.receive()? {
            if took.is_none() && truth.cycle.0 >= cycles {
                // Records come some hundred at once, so these were a few more cycles.
                took = Some(begun.elapsed().mul_f64(cycles as f64 / truth.cycle.0.max(1) as f64));
                space.quit()?;
            }
        }
        while statuses.receive()?.is_some() || x.receive()?.is_some() || z.receive()?.is_some() {}
        while arrivals.receive()?.is_some() {}
        last = took.is_some() && space.unfinished()?.is_empty();
        space.launcher().wait_at_most(NAP)?;
    }
    space.end()?;
    collect(children)?;
    std::fs::remove_file(&program)?;
    took.ok_or_else(|| "it was never measured".into())
}

/// One of them.
fn module(address: &str, process: &str, program: &str) -> Result<(), ShellError> {
    let args = ProcessArgs {
        address: address.into(),
        machine: None,
        clock: Clock::Virtual,
        strict_set_up: false,
        processor: None,
    };
    match process {
        "interpreter" => interpreter::run(&interpreter::InterpreterArgs {
            program: PathBuf::from(program),
            by_hand: false,
            from: None,
            language: LanguageArgs::default(),
            process: args,
        }),
        "interpolator" => interpolator::run(&args),
        "plant" => plant::run(&plant::PlantArgs {
            process: args,
            scenario: None,
            seed: 1,
            pace: Pace::MAX,
            stand_at: Vec::new(),
        }),
        axis => regulator::run(&regulator::RegulatorArgs { axis: named(axis), process: args }),
    }
}
