//! Which modules share a process: the table of both layouts. In: the axes of a machine. Out: its processes,
//! each with the modules that live in it.

use protocol::Axis;

use super::Process;

/// How the modules of a machine are shared out to processes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Each in a process of its own.
    #[default]
    Apart,
    /// Those that have to answer within a control cycle are one process.
    Together,
}

/// Name of the process of those that have to answer within a control cycle.
const REAL_TIME: &str = "real-time";

/// A process as the operating system knows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Host {
    /// Its name: that of its module, if it has one alone.
    pub name: String,
    /// Who lives in it. The first one beats its time.
    pub modules: Vec<Process>,
}

impl Host {
    fn of(module: Process) -> Host {
        Host { name: module.name(), modules: vec![module] }
    }

    /// The module that beats its time, and by which it is started.
    pub fn beats(&self) -> Process {
        self.modules[0]
    }

    /// Whether a module lives in it.
    pub fn holds(&self, module: Process) -> bool {
        self.modules.contains(&module)
    }

    /// Those who live in it, if it has no name of theirs.
    pub fn of_whom(&self) -> Option<String> {
        let names: Vec<_> = self.modules.iter().map(|module| module.name()).collect();
        (names.len() > 1).then(|| names.join(", "))
    }

    /// Its name; where several live in it, with theirs.
    pub fn in_words(&self) -> String {
        self.of_whom().map_or_else(|| self.name.clone(), |names| format!("{} ({names})", self.name))
    }
}

/// The processes of a machine with these axes, but for the launcher.
///
/// ```
/// use process::ipc::{Layout, hosts};
/// use protocol::Axis;
///
/// let names = |layout| hosts(layout, &[Axis::X, Axis::Z]).into_iter().map(|host| host.in_words());
/// let apart = ["interpreter", "interpolator", "sim-plant", "regulator-x", "regulator-z"];
/// assert!(names(Layout::Apart).eq(apart));
/// let together = ["interpreter", "interpolator", "real-time (sim-plant, regulator-x, regulator-z)"];
/// assert!(names(Layout::Together).eq(together));
/// ```
pub fn hosts(layout: Layout, axes: &[Axis]) -> Vec<Host> {
    let members = Process::members(axes);
    match layout {
        Layout::Apart => members.into_iter().map(Host::of).collect(),
        Layout::Together => {
            let hurries = |module: &Process| matches!(module, Process::Plant | Process::Regulator(_));
            let (modules, others): (Vec<_>, Vec<_>) = members.into_iter().partition(hurries);
            let mut hosts: Vec<Host> = others.into_iter().map(Host::of).collect();
            hosts.push(Host { name: REAL_TIME.into(), modules });
            hosts
        }
    }
}
