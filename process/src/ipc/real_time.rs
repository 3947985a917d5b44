//! The set-up of a process that has deadlines, as the trade does it: each item is done, or refused with what
//! would help. In: the process, files of the system (`/proc`, `/sys`, `/dev`). Out: a report; what has to be
//! held open.
//!
//! The ladder of priorities, SCHED_FIFO. On a kernel with PREEMPT_RT the threads of its interrupts have 50.
//!
//! | process | priority |
//! |---|---|
//! | `real-time`, and `sim-plant` where it has a process of its own: they beat the time | 80 |
//! | a regulator in a process of its own | 78 |
//! | interpolator, whose deadline is an interpolator cycle | 70 |
//! | interpreter, launcher, panel | none |
//!
//! Linux takes the processor from real-time processes for a part of each second unless they rest by
//! themselves: all of ours sleep between two looks, and none spins.

use std::{
    fs::{self, File, OpenOptions},
    io::Write as _,
    path::Path,
};

use iceoryx2_bb_posix::{process::Process as System, scheduler::Scheduler};
use serde::Serialize;

use super::{Process, time};

/// Stack that is touched, bytes: more than any shell uses.
const STACK: usize = 256 << 10;
/// Heap that is touched, bytes, in blocks that come from the heap proper.
const HEAP: usize = 4 << 20;
const BLOCK: usize = 64 << 10;
const PAGE: usize = 4096;
/// What the kernel calls the lowest and the highest priority of SCHED_FIFO.
const FIFO: (u32, u32) = (1, 99);

/// One thing of the set-up.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Item {
    /// Which.
    pub what: &'static str,
    /// Whether it is done.
    pub done: bool,
    /// What was done; or why not, and what would help.
    pub text: String,
}

/// The set-up of a process.
#[derive(Debug)]
pub struct SetUp {
    /// All items, in the order in which they were tried.
    pub items: Vec<Item>,
    /// As long as it is open, processors do not sleep deeper than wakes in no time.
    _awake: Option<File>,
    /// The end of the touched heap: what lies before it stays with this process.
    _heap: Vec<u8>,
}

impl SetUp {
    /// What was refused.
    pub fn refused(&self) -> impl Iterator<Item = &Item> {
        self.items.iter().filter(|item| !item.done)
    }
}

/// The priority of a process in real time, if it has one.
pub fn priority(process: Process) -> Option<u32> {
    match process {
        Process::Plant => Some(80),
        Process::Regulator(_) => Some(78),
        Process::Interpolator => Some(70),
        Process::Interpreter | Process::Launcher => None,
    }
}

/// Sets this process up; its files are those below `root`, which is `/` but for tests. All ports have to be
/// open: pages that are locked are pages that are there.
pub fn set_up(root: &Path, process: Process) -> SetUp {
    let mut items = vec![memory()];
    touch_stack();
    let heap = touch_heap();
    items.push(done("stack and heap", format!("{} kB and {} MB touched", STACK >> 10, HEAP >> 20)));
    let (awake, item) = stay_awake(root);
    items.push(item);
    items.push(processor(root, process));
    items.extend(priority(process).map(fifo));
    items.push(throttling(root));
    SetUp { items, _awake: awake, _heap: heap }
}

fn done(what: &'static str, text: String) -> Item {
    Item { what, done: true, text }
}

fn refused(what: &'static str, text: String) -> Item {
    Item { what, done: false, text }
}

fn memory() -> Item {
    match time::lock_memory() {
        Ok(()) => done("memory", "all pages locked, now and later".into()),
        Err(error) => refused("memory", format!("memory is not locked: {error}; `ulimit -l unlimited`")),
    }
}

/// Pages of the stack that calls will reach later are made now.
#[inline(never)]
fn touch_stack() {
    let mut stack = [0_u8; STACK];
    for page in stack.chunks_mut(PAGE) {
        page[0] = 1;
    }
    std::hint::black_box(&stack);
}

/// The same of the heap. What is given back stays with the process, since a block behind it is kept.
fn touch_heap() -> Vec<u8> {
    let block = || {
        let mut block = vec![0_u8; BLOCK];
        block.chunks_mut(PAGE).for_each(|page| page[0] = 1);
        std::hint::black_box(block)
    };
    let mut blocks: Vec<Vec<u8>> = (0..HEAP / BLOCK).map(|_| block()).collect();
    blocks.pop().unwrap_or_default()
}

/// Processors are kept from states that they need long to wake from.
fn stay_awake(root: &Path) -> (Option<File>, Item) {
    let what = "processor states";
    let path = root.join("dev/cpu_dma_latency");
    let asked = OpenOptions::new().write(true).open(path).and_then(|mut file| {
        file.write_all(&0_i32.to_ne_bytes())?;
        Ok(file)
    });
    match asked {
        Ok(file) => (Some(file), done(what, "/dev/cpu_dma_latency is held at 0 µs".into())),
        Err(error) => {
            let text = format!(
                "/dev/cpu_dma_latency: {error}; start as administrator, or give this user that file; else \
                 processor.max_cstate=1 on the kernel's command line"
            );
            (None, refused(what, text))
        }
    }
}

/// The processors of a list of the kernel, such as `2-3,5`.
pub fn processors_of(list: &str) -> Vec<usize> {
    let range = |part: &str| {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        Some(first.trim().parse::<usize>().ok()?..=last.trim().parse::<usize>().ok()?)
    };
    list.split(',').filter_map(range).flatten().collect()
}

/// Stays on an isolated processor, if there is one: the interpolator and regulators on the next ones, as far
/// as there are any.
fn processor(root: &Path, process: Process) -> Item {
    let what = "isolated processor";
    let list = fs::read_to_string(root.join("sys/devices/system/cpu/isolated")).unwrap_or_default();
    let isolated = processors_of(&list);
    let place = match process {
        Process::Plant => 0,
        Process::Interpolator => 1,
        other => 2 + other.number(),
    };
    let Some(processor) = (!isolated.is_empty()).then(|| isolated[place % isolated.len()]) else {
        let text =
            "the kernel keeps no processor free for this; isolcpus=… (and nohz_full=…) on its command line";
        return refused(what, text.into());
    };
    match time::pin_to(processor) {
        Ok(()) => done(what, format!("stays on processor {processor}")),
        Err(error) => refused(what, format!("{error}; let this user have processor {processor}")),
    }
}

/// Real-time priority; where it is refused, as high a priority as others may have.
fn fifo(priority: u32) -> Item {
    let what = "priority";
    let fallback = time::be_punctual();
    // That library counts from 0 to 255.
    let share = ((priority - FIFO.0) * u32::from(u8::MAX)).div_ceil(FIFO.1 - FIFO.0);
    let mut own = System::from_self();
    let asked = own.set_scheduler(Scheduler::Fifo).is_ok()
        && own.set_priority(u8::try_from(share).unwrap_or(u8::MAX)).is_ok();
    if asked && in_force() == Some(priority) {
        return done(what, format!("SCHED_FIFO {priority}"));
    }
    let text = match fallback {
        Ok(()) => {
            "SCHED_FIFO is refused, nice -20 is in force: more answers will be late; `ulimit -r 99`".into()
        }
        Err(error) => {
            format!(
                "SCHED_FIFO is refused, more answers will be late ({error}); `ulimit -r 99`, or `ulimit -e 40`"
            )
        }
    };
    let more = " (rtprio in /etc/security/limits.conf), or start as administrator";
    refused(what, text + more)
}

/// The real-time priority that this process has, as the kernel says.
fn in_force() -> Option<u32> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the name, which may hold anything: the state is field 3, the priority is 40.
    text.rsplit_once(')')?.1.split_whitespace().nth(40 - 3)?.parse().ok()
}

/// Nothing has to be done: it is said how the processor is shared.
fn throttling(root: &Path) -> Item {
    let number = |name: &str| {
        let text = fs::read_to_string(root.join("proc/sys/kernel").join(name)).ok()?;
        text.trim().parse::<i64>().ok()
    };
    let text = match (number("sched_rt_runtime_us"), number("sched_rt_period_us")) {
        (Some(run), Some(period)) if run >= 0 && run < period => {
            format!("real-time processes may run for {run} of {period} µs: this one sleeps in every cycle")
        }
        _ => "this kernel does not throttle real-time processes; this one sleeps in every cycle all the same"
            .into(),
    };
    done("throttling", text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_processors_are_read_as_the_kernel_writes_them() {
        assert_eq!(processors_of("2-3,5\n"), [2, 3, 5]);
        assert_eq!(processors_of("1\n"), [1]);
        assert!(processors_of("\n").is_empty() && processors_of("").is_empty());
    }

    /// Below a folder in which there is nothing, everything that is a file is refused with a remedy.
    #[test]
    fn what_a_system_does_not_have_is_refused_with_a_remedy() {
        let nothing = Path::new("/nonexistent");
        let (file, item) = stay_awake(nothing);
        assert!(file.is_none() && !item.done && item.text.contains("max_cstate"), "{item:?}");
        let item = processor(nothing, Process::Plant);
        assert!(!item.done && item.text.contains("isolcpus"), "{item:?}");
        let item = throttling(nothing);
        assert!(item.done && item.text.contains("does not throttle"), "{item:?}");
    }

    #[test]
    fn the_ladder_has_those_who_beat_the_time_at_the_top() {
        let axis = Process::Regulator(protocol::Axis::X);
        let ladder =
            [Process::Plant, axis, Process::Interpolator].map(|one| priority(one).expect("a deadline"));
        assert!(ladder.is_sorted_by(|higher, lower| higher > lower) && ladder[2] > 50, "{ladder:?}");
        assert_eq!([Process::Interpreter, Process::Launcher].map(priority), [None, None]);
    }
}
