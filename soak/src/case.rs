//! A case: a machine, a program, a seed of the plant and what happens. In: what was drawn. Out: the same as
//! files that a person can run, and ready to be run here.

use interpreter::Interpreter;
use machine::Machine;
use protocol::{Code, Item, ThreadPass};

use crate::event::Event;

/// What is run for one seed.
#[derive(Clone, Debug)]
pub struct Case {
    /// What it was drawn from.
    pub seed: u64,
    /// The machine.
    pub machine: Machine,
    /// The program in blocks; the first and the last belong to every program, each of the others can be left
    /// out.
    pub blocks: Vec<String>,
    /// What the program is made of, for the counts.
    pub kinds: Vec<&'static str>,
    /// Seed of the plant.
    pub plant_seed: u64,
    /// What happens.
    pub events: Vec<Event>,
}

/// A case whose program has been read.
#[derive(Clone, Debug)]
pub struct Ready {
    /// The machine.
    pub machine: Machine,
    /// Its machine code.
    pub items: Vec<Item>,
    /// What it should take, s.
    pub time_s: f64,
}

impl Case {
    /// The program as text.
    pub fn program(&self) -> String {
        self.blocks.concat()
    }

    /// The machine file.
    ///
    /// # Errors
    /// What of it cannot be written as TOML.
    pub fn machine_file(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(&self.machine)
    }

    /// Reads the program; nothing if the machine refuses it, or the file of the machine would be refused.
    pub fn ready(&self) -> Option<Ready> {
        self.machine.check().ok()?;
        // Nobody reads what is wrong with it: the first error is the last that is looked for.
        let read = Interpreter::of_text("soak.ngc", self.program(), &self.machine);
        let items: Vec<Item> = read.collect::<Result<_, _>>().ok()?;
        let time_s = interpreter::time_s(&items, &self.machine).ok()?;
        Some(Ready { machine: self.machine.clone(), items, time_s })
    }

    /// The scenario that the plant plays.
    pub fn scenario(&self) -> String {
        let mut text = String::new();
        self.events.iter().for_each(|event| event.scenario(&mut text));
        text
    }

    /// The seed and what happens, as a person reads it.
    pub fn told(&self) -> String {
        let events: Vec<String> = self.events.iter().map(Event::told).collect();
        format!("{}; {}", self.kinds.join(", "), events.join("; "))
    }
}

impl Ready {
    /// The passes of the program in their order.
    pub fn passes(&self) -> impl Iterator<Item = &ThreadPass> {
        self.items.iter().filter_map(|item| match &item.code {
            Code::Pass(pass) => Some(pass),
            _ => None,
        })
    }
}
