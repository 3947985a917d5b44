//! Three processes in lock-step: a plant that publishes measurements and two regulators that answer each of
//! them. Prints cycles per second.
//!
//! `cargo run --release -p process --example lock_step [cycles] [processor]`
//!
//! With a processor number all of them share that one, which is what `pitchlock run` does in virtual time.
#![allow(clippy::print_stdout)] // the figures are the purpose

use std::process::{Child, Command};

use process::ipc::{
    IpcError, Member, NameSpace, Patience, Process, channel,
    time::{Moment, pin_to, sleep_until},
    total,
};
use protocol::{Axis, Cycle, DriveCommand, Measurement};

const AXES: [Axis; 2] = [Axis::X, Axis::Z];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["plant", address, cycles] => plant(address, cycles.parse()?)?,
        ["regulator", axis, address] => regulator(Axis::from_name(axis).ok_or("no such axis")?, address)?,
        [cycles, processor] => launch(cycles, Some(processor.parse()?))?,
        [cycles] => launch(cycles, None)?,
        _ => launch("100000", None)?,
    }
    Ok(())
}

fn launch(cycles: &str, processor: Option<usize>) -> Result<(), Box<dyn std::error::Error>> {
    processor.map_or(Ok(()), pin_to)?; // inherited by the others
    let mut space = NameSpace::create(&AXES)?;
    let (address, program) = (space.address(), std::env::current_exe()?);
    let spawn =
        |arguments: &[&str]| -> std::io::Result<Child> { Command::new(&program).args(arguments).spawn() };
    let mut children = vec![
        spawn(&["plant", &address, cycles])?,
        spawn(&["regulator", "x", &address])?,
        spawn(&["regulator", "z", &address])?,
    ];
    // This machine has neither interpreter nor interpolator.
    let absent = |process: Process| matches!(process, Process::Interpreter | Process::Interpolator);
    wait_until(&mut children, || Ok(space.missing(&[])?.into_iter().all(absent)))?;
    space.start()?;
    wait_until(&mut children, || Ok(space.unfinished()?.into_iter().all(absent)))?;
    for count in total(space.end()?) {
        println!("{count:?}");
    }
    for child in &mut children {
        child.wait()?;
    }
    Ok(())
}

fn wait_until(
    children: &mut [Child],
    mut done: impl FnMut() -> Result<bool, IpcError>,
) -> Result<(), Box<dyn std::error::Error>> {
    while !done()? {
        for child in &mut *children {
            if let Some(status) = child.try_wait()? {
                return Err(format!("a process ended early: {status}").into());
            }
        }
        sleep_until(Moment::in_s(0.002));
    }
    Ok(())
}

fn plant(address: &str, cycles: u64) -> Result<(), IpcError> {
    let mut member = Member::join(address, Process::Plant)?;
    let mut measurements = member.sender(channel::MEASUREMENT, Patience::Forever)?;
    let mut x = member.receiver(channel::DRIVE_COMMAND.of(Axis::X))?;
    let mut z = member.receiver(channel::DRIVE_COMMAND.of(Axis::Z))?;
    let wake_x = member.waker(Process::Regulator(Axis::X))?;
    let wake_z = member.waker(Process::Regulator(Axis::Z))?;
    member.start(&[&measurements, &x, &z, &wake_x, &wake_z], Moment::in_s(5.0))?;
    let begin = Moment::now();
    for n in 0..cycles {
        let last = u32::from(n + 1 == cycles);
        measurements.send(&Measurement { cycle: Cycle(n), last, ..Measurement::default() })?;
        wake_x.wake()?;
        wake_z.wake()?;
        for commands in [&mut x, &mut z] {
            loop {
                match commands.receive()? {
                    Some(command) => break assert_eq!(command.cycle, Cycle(n)),
                    None => member.wait()?,
                }
            }
        }
    }
    println!("{:.0} cycles/s", cycles as f64 / begin.elapsed().as_secs_f64());
    member.finish(&[measurements.count(), x.count(), z.count()])
}

fn regulator(axis: Axis, address: &str) -> Result<(), IpcError> {
    let mut member = Member::join(address, Process::Regulator(axis))?;
    let mut measurements = member.receiver(channel::MEASUREMENT)?;
    let mut commands = member.sender(channel::DRIVE_COMMAND.of(axis), Patience::Forever)?;
    let plant = member.waker(Process::Plant)?;
    member.start(&[&measurements, &commands, &plant], Moment::in_s(5.0))?;
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
