//! The machine in this process.

use std::{cell::RefCell, rc::Rc};

use process::{
    ipc::{Process, time::Moment},
    shell::Beat,
};
use protocol::{Doom, Item, Module, operator::Request};
use rig::{Rig, observe::Record, standstill::Standstill, supervisor::Supervisor, wires::Straight};

use super::{
    Setup,
    channels::SILENT_S,
    endings::{Death, Endings},
    interrupts::{Interrupts, Wish},
    processes::complete,
    recorder::{Recorded, Recorder},
};
use crate::error::CliError;

/// Control cycles between two looks at the keyboard, while nobody waits for the wall.
const LOOK_EVERY: u64 = 256;

/// Runs the machine to its end. Ctrl-C does what it does to processes.
pub(crate) fn run(setup: &Setup, interrupts: &mut Interrupts) -> Result<Recorded, CliError> {
    let begun = Moment::now();
    let unreadable = Rc::<RefCell<Option<String>>>::default();
    let mut rig = machine(setup, Rc::clone(&unreadable))?;
    let mut recorder = Recorder::new(setup, true, interrupts.asked())?;
    let mut supervisor = Supervisor::new(&setup.machine, &setup.program.watched);
    let mut standstill = Standstill::new(&setup.machine, &setup.scenario);
    let mut endings = Endings::default();
    let mut doomed = Doomed::new(setup);
    let (mut cycle, mut wish) = (0, Wish::None);
    let mut request = None;
    let mut beat = Beat::new(setup.clock, setup.pace, setup.machine.general.cycle_s);
    let look_every = if setup.pace.waits() { 1 } else { LOOK_EVERY };
    loop {
        beat.wait();
        let asked = request.take();
        recorder.arrivals.asked(cycle, asked);
        let (mut wanted, mut dead) = (None, Vec::new());
        let goes_on = rig.cycle(asked, |record| {
            recorder.cycle(record);
            dead = doomed.cycle(record);
            for (module, death) in &dead {
                endings.died(death.clone());
                wanted = supervisor.died(*module, record.truth.cycle.0).or(wanted);
            }
            if let Some(waits_for) = standstill.cycle(record) {
                wanted = endings.waits(record.truth.cycle.0, waits_for, &mut supervisor).or(wanted);
            }
            wanted = supervisor.cycle(record).or(wanted);
        });
        if let Some(text) = unreadable.borrow_mut().take() {
            dead.push(unread(&text, cycle));
            endings.died(unread(&text, cycle).1);
            wanted = supervisor.died(Module::Interpreter, cycle).or(wanted);
            recorder.say(&text);
        }
        // One that was frozen does not thaw any more.
        for (module, _) in dead {
            rig.kill(module);
            recorder.arrivals.killed(cycle, module);
        }
        request = wanted;
        cycle += 1;
        if cycle % look_every == 0 && interrupts.wish() != wish {
            let before = std::mem::replace(&mut wish, interrupts.wish());
            request = match wish {
                Wish::EmergencyStop => supervisor.emergency_stop(),
                _ if before == Wish::None => Some(Request::Stop),
                _ => request,
            };
            wish.words(before).for_each(|words| recorder.say(words));
        }
        if wish == Wish::End {
            endings.broken_off();
        }
        if !goes_on || wish == Wish::End || supervisor.end().is_some() {
            break;
        }
    }
    endings.ends(supervisor.end());
    let mut recorded = recorder.finish(&setup.folder.named, setup.clock);
    endings.tell(&mut recorded.summary);
    complete(&mut recorded.summary, setup, begun);
    Ok(recorded)
}

type Items = Box<dyn Iterator<Item = Item>>;

/// The machine before its first cycle; if the run goes on with another one, the machine of that, switched on.
fn machine(setup: &Setup, unreadable: Rc<RefCell<Option<String>>>) -> Result<Rig<Items>, CliError> {
    let items = items(setup, unreadable)?;
    if let Some(resumed) = &setup.resumed {
        let items: Items = Box::new(resumed.plan.executed(items));
        return Ok(Rig::on_plant(&setup.machine, resumed.plant.clone(), items, Straight));
    }
    Rig::new(&setup.machine, items, setup.scenario.clone(), setup.seed)
        .map_err(|error| CliError::Input(error.to_string()))
}

/// The machine code of the program; what cannot be read any more is left in `unreadable`, and nothing that
/// stands behind it is run.
fn items(setup: &Setup, unreadable: Rc<RefCell<Option<String>>>) -> Result<Items, CliError> {
    let items = setup.program.items(&setup.folder.program, &setup.folder.language, &setup.machine)?;
    let read =
        move |item: Result<Item, String>| item.map_err(|text| *unreadable.borrow_mut() = Some(text)).ok();
    Ok(Box::new(items.map_while(read).fuse()))
}

/// The interpreter as it ends when it meets an error in a program that was good.
fn unread(text: &str, cycle: u64) -> (Module, Death) {
    let ending = format!(
        "met an error, though the program was good when it was checked: it has changed since. {text}"
    );
    let (process, missed) = (Process::Interpreter, None);
    let death = Death { process, name: process.name(), ending, cycle, missed, over: false, frozen: false };
    (Module::Interpreter, death)
}

/// What the scenario does to modules. One that is frozen for a second on the machine is killed, as it is in
/// real time.
struct Doomed {
    patience: u64,
    /// Who is frozen, and since which control cycle.
    frozen: Vec<(Module, u64)>,
    dead: Vec<Module>,
}

impl Doomed {
    fn new(setup: &Setup) -> Doomed {
        let patience = (SILENT_S / setup.machine.general.cycle_s).ceil() as u64;
        Doomed { patience, frozen: Vec::new(), dead: Vec::new() }
    }

    /// One control cycle: who is dead from it on.
    fn cycle(&mut self, record: &Record) -> Vec<(Module, Death)> {
        let now = record.truth.cycle.0;
        let mut dead = Vec::new();
        match record.truth.doom() {
            Some((Doom::Kill, module)) => dead.push((module, now, false)),
            Some((Doom::Freeze, module)) if self.frozen.iter().all(|(frozen, _)| *frozen != module) => {
                self.frozen.push((module, now));
            }
            Some((Doom::Thaw, module)) => self.frozen.retain(|(frozen, _)| *frozen != module),
            Some((Doom::Freeze, _)) | None => {}
        }
        let over = self.frozen.iter().filter(|(_, since)| now - since >= self.patience);
        dead.extend(over.map(|(module, since)| (*module, *since, true)));
        dead.retain(|(module, ..)| !self.dead.contains(module));
        self.dead.extend(dead.iter().map(|(module, ..)| *module));
        self.frozen.retain(|(module, _)| !self.dead.contains(module));
        let death = |(module, cycle, frozen)| {
            let (process, ending) = (Process::of(module), "was killed by the scenario".into());
            let name = process.name();
            (module, Death { process, name, ending, cycle, missed: None, over: false, frozen })
        };
        dead.into_iter().map(death).collect()
    }
}
