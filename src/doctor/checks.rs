//! What of a computer real time depends on, as its files say. In: the folder in which its file system begins.
//! Out: checks, each with what was found and what would help. Nothing is changed.

use std::{
    fs::{self, OpenOptions},
    path::{Path, PathBuf},
};

use process::ipc::{Process, computer, real_time};
use serde::Serialize;

/// A processor that takes no longer than this to wake is awake enough, µs.
const WAKES_US: u64 = 10;
/// Share of the time that real-time processes have to have.
const SHARE: f64 = 0.9;
/// Capabilities, by their bits: to lock memory, to raise priorities.
const IPC_LOCK: u64 = 1 << 14;
const SYS_NICE: u64 = 1 << 23;

/// One of them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Check {
    /// What is looked at.
    pub(crate) name: String,
    /// Whether it is as it should be.
    pub(crate) ok: bool,
    /// What was found.
    pub(crate) found: String,
    /// What helps, or would if it were otherwise.
    pub(crate) remedy: String,
}

/// A file system.
struct System<'a>(&'a Path);

/// All of them, of the system below a folder, of whose shared memory a machine needs so many bytes.
pub(crate) fn checks(root: &Path, needed: u64) -> Vec<Check> {
    let system = System(root);
    vec![
        system.kernel(),
        system.governor(),
        system.isolation(),
        system.throttling(),
        system.idle_states(),
        system.swap(),
        system.irqbalance(),
        system.hypervisor(),
        system.room(needed),
        system.memlock(),
        system.rtprio(),
    ]
}

fn check(name: &str, ok: bool, found: impl Into<String>, remedy: &str) -> Check {
    Check { name: name.into(), ok, found: found.into(), remedy: remedy.into() }
}

impl System<'_> {
    /// A file of one line or more; nothing if there is none.
    fn text(&self, path: &str) -> String {
        fs::read_to_string(self.0.join(path)).unwrap_or_default().trim().to_owned()
    }

    /// Folders below one whose names are a word and a number.
    fn numbered(&self, folder: &str, word: &str) -> Vec<PathBuf> {
        let is_one = |path: &PathBuf| {
            let number =
                path.file_name().and_then(|name| name.to_str()?.strip_prefix(word)?.parse::<u32>().ok());
            number.is_some()
        };
        let entries = fs::read_dir(self.0.join(folder)).into_iter().flatten().flatten();
        let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_one).collect();
        found.sort();
        found
    }

    fn processors(&self) -> Vec<PathBuf> {
        self.numbered("sys/devices/system/cpu", "cpu")
    }

    fn kernel(&self) -> Check {
        let version = self.text("proc/version");
        let ok = self.text("sys/kernel/realtime") == "1" || version.contains("PREEMPT_RT");
        let found = version.split_whitespace().take(3).collect::<Vec<_>>().join(" ");
        let found = found + if ok { ", PREEMPT_RT" } else { ", without PREEMPT_RT" };
        check("kernel", ok, found, "a kernel with PREEMPT_RT (Debian: apt install linux-image-rt-amd64)")
    }

    fn governor(&self) -> Check {
        let read = |processor: PathBuf| fs::read_to_string(processor.join("cpufreq/scaling_governor")).ok();
        let mut found: Vec<String> =
            self.processors().into_iter().filter_map(read).map(|name| name.trim().to_owned()).collect();
        found.sort();
        found.dedup();
        let ok = found.iter().all(|name| name == "performance");
        let found =
            if found.is_empty() { "none: the system sets no frequency".into() } else { found.join(", ") };
        check("governor", ok, found, "cpupower frequency-set -g performance")
    }

    fn isolation(&self) -> Check {
        let list = self.text("sys/devices/system/cpu/isolated");
        let found =
            if list.is_empty() { "no processor is kept free".into() } else { format!("processors {list}") };
        let remedy = "isolcpus=N nohz_full=N rcu_nocbs=N on the kernel's command line, N the last processors";
        check("isolated processors", !list.is_empty(), found, remedy)
    }

    fn throttling(&self) -> Check {
        let number = |name: &str| self.text(&format!("proc/sys/kernel/{name}")).parse::<f64>().ok();
        let (run, period) = (number("sched_rt_runtime_us"), number("sched_rt_period_us"));
        let (ok, found) = match (run, period) {
            (Some(run), Some(period)) if run >= 0.0 => {
                (run >= SHARE * period, format!("real-time processes may run for {run} of {period} µs"))
            }
            _ => (true, "real-time processes are not throttled".into()),
        };
        check("throttling", ok, found, "sysctl kernel.sched_rt_runtime_us=950000")
    }

    fn idle_states(&self) -> Check {
        let us = |path: PathBuf| fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
        let mut slowest = 0;
        for processor in self.processors() {
            let states = fs::read_dir(processor.join("cpuidle")).into_iter().flatten().flatten();
            for state in states.map(|state| state.path()) {
                if us(state.join("disable")).unwrap_or(0) == 0 {
                    slowest = slowest.max(us(state.join("latency")).unwrap_or(0));
                }
            }
        }
        // Opened and closed again it asks for nothing.
        let held = OpenOptions::new().write(true).open(self.0.join("dev/cpu_dma_latency")).is_ok();
        let found = match (slowest, held) {
            (..=WAKES_US, _) => format!("processors wake within {slowest} µs"),
            (_, true) => format!("up to {slowest} µs to wake, which /dev/cpu_dma_latency keeps off"),
            (_, false) => format!("up to {slowest} µs to wake, and /dev/cpu_dma_latency may not be written"),
        };
        let remedy = "start as administrator, or give this user /dev/cpu_dma_latency; or processor.max_cstate=1 \
                      intel_idle.max_cstate=0 on the kernel's command line";
        check("processor states", slowest <= WAKES_US || held, found, remedy)
    }

    fn swap(&self) -> Check {
        let swaps = self.text("proc/swaps");
        let names: Vec<_> = swaps.lines().skip(1).filter_map(|line| line.split_whitespace().next()).collect();
        let found = if names.is_empty() { "none".into() } else { names.join(", ") };
        check("swap", names.is_empty(), found, "swapoff -a")
    }

    fn irqbalance(&self) -> Check {
        let named = |path: &PathBuf| {
            fs::read_to_string(path.join("comm")).is_ok_and(|name| name.trim() == "irqbalance")
        };
        let runs = self.numbered("proc", "").iter().any(named);
        let remedy =
            "systemctl disable --now irqbalance, or IRQBALANCE_BANNED_CPULIST with the isolated processors";
        check("irqbalance", !runs, if runs { "it moves interrupts about" } else { "does not run" }, remedy)
    }

    fn hypervisor(&self) -> Check {
        let cpuinfo = self.text("proc/cpuinfo");
        let guest = cpuinfo.lines().any(|line| {
            line.starts_with("flags") && line.split_whitespace().any(|flag| flag == "hypervisor")
        });
        let found = if guest { "this is a virtual machine" } else { "none" };
        let remedy = "run on the computer itself: a virtual machine is woken when its host has time";
        check("hypervisor", !guest, found, remedy)
    }

    fn room(&self, needed: u64) -> Check {
        let free = computer::free_bytes(&self.0.join("dev/shm"));
        let found = free.map_or("there is no /dev/shm".into(), |free| format!("{} kB are free", free >> 10));
        let remedy = "mount -o remount,size=64M /dev/shm (of a container: --shm-size 64m)";
        check("room in /dev/shm", free.is_some_and(|free| free >= needed), found, remedy)
    }

    /// A limit of this process, as the system writes it; and whether it has a capability that lifts it.
    fn limit(&self, name: &str, capability: u64) -> (String, bool) {
        let limits = self.text("proc/self/limits");
        let soft = limits.lines().find_map(|line| line.strip_prefix(name)?.split_whitespace().next());
        let status = self.text("proc/self/status");
        let held = status
            .lines()
            .find_map(|line| u64::from_str_radix(line.strip_prefix("CapEff:")?.trim(), 16).ok());
        (soft.unwrap_or("unknown").to_owned(), held.is_some_and(|held| held & capability != 0))
    }

    fn memlock(&self) -> Check {
        let (soft, lifted) = self.limit("Max locked memory", IPC_LOCK);
        let found = if lifted { "lifted for this user".into() } else { format!("{soft} bytes") };
        let remedy = "ulimit -l unlimited (memlock in /etc/security/limits.conf)";
        check("limit of locked memory", lifted || soft == "unlimited", found, remedy)
    }

    fn rtprio(&self) -> Check {
        let (soft, lifted) = self.limit("Max realtime priority", SYS_NICE);
        // Whoever beats the time has the highest.
        let highest = real_time::priority(Process::Plant).unwrap_or_default();
        let enough = soft.parse::<u32>().map_or(soft == "unlimited", |most| most >= highest);
        let found = if lifted { "lifted for this user".into() } else { soft };
        let remedy = "ulimit -r 99 (rtprio in /etc/security/limits.conf)";
        check("limit of real-time priority", lifted || enough, found, remedy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A computer as it is set up for real time, file by file.
    const GOOD: [(&str, &str); 16] = [
        ("proc/version", "Linux version 6.12.9-rt (builder) #1 SMP PREEMPT_RT"),
        ("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n"),
        ("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n"),
        ("sys/devices/system/cpu/cpu1/cpuidle/state0/latency", "0\n"),
        ("sys/devices/system/cpu/cpu1/cpuidle/state1/latency", "133\n"),
        ("sys/devices/system/cpu/cpu1/cpuidle/state1/disable", "1\n"),
        ("sys/devices/system/cpu/isolated", "1\n"),
        ("proc/sys/kernel/sched_rt_runtime_us", "950000\n"),
        ("proc/sys/kernel/sched_rt_period_us", "1000000\n"),
        ("proc/swaps", "Filename Type Size Used Priority\n"),
        ("proc/1/comm", "systemd\n"),
        ("proc/cpuinfo", "flags\t\t: fpu vme nonstop_tsc\n"),
        ("dev/shm/there", ""),
        (
            "proc/self/limits",
            "Max locked memory         unlimited            unlimited            bytes     \n\
                              Max realtime priority     99                   99                        ",
        ),
        ("proc/self/status", "Name:\tx\nCapEff:\t0000000000000000\n"),
        ("dev/null", ""),
    ];

    fn computer(but: &[(&str, &str)]) -> tempfile::TempDir {
        let place = tempfile::tempdir().expect("a folder");
        for (path, text) in GOOD.iter().chain(but) {
            let path = place.path().join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("it is made");
            fs::write(path, text).expect("it is written");
        }
        place
    }

    fn wrong(but: &[(&str, &str)]) -> Vec<Check> {
        let place = computer(but);
        checks(place.path(), 4096).into_iter().filter(|check| !check.ok).collect()
    }

    #[test]
    fn a_computer_that_is_set_up_has_nothing_wrong() {
        assert_eq!(wrong(&[]), []);
        let place = computer(&[]);
        let all = checks(place.path(), 4096);
        assert!(all.iter().all(|check| !check.found.is_empty() && check.remedy.len() > 8), "{all:#?}");
    }

    /// Each file that says something else makes one check fail, which shows what was found.
    #[test]
    fn what_is_otherwise_is_named_with_its_remedy() {
        let limits = "Max locked memory         8388608              8388608              bytes     \n\
                      Max realtime priority     99                   99                        ";
        let low = "Max locked memory         unlimited            unlimited            bytes     \n\
                   Max realtime priority     79                   99                        ";
        for (path, text, name, found, remedy) in [
            (
                "proc/version",
                "Linux version 6.12.9 (x) PREEMPT_DYNAMIC",
                "kernel",
                "without",
                "linux-image-rt",
            ),
            (
                "sys/devices/system/cpu/cpu1/cpufreq/scaling_governor",
                "powersave",
                "governor",
                "powersave",
                "-g",
            ),
            ("sys/devices/system/cpu/isolated", "\n", "isolated processors", "no processor", "isolcpus"),
            ("proc/sys/kernel/sched_rt_runtime_us", "400000", "throttling", "400000 of 1000000", "sysctl"),
            (
                "sys/devices/system/cpu/cpu1/cpuidle/state1/disable",
                "0",
                "processor states",
                "133",
                "max_cstate",
            ),
            ("proc/swaps", "Filename Type\n/dev/sda2 partition 9 0 -2\n", "swap", "/dev/sda2", "swapoff"),
            ("proc/812/comm", "irqbalance\n", "irqbalance", "moves", "systemctl"),
            ("proc/cpuinfo", "flags : fpu hypervisor lahf\n", "hypervisor", "virtual machine", "host"),
            ("proc/self/limits", limits, "limit of locked memory", "8388608", "ulimit -l"),
            ("proc/self/limits", low, "limit of real-time priority", "79", "ulimit -r"),
        ] {
            let found_wrong = wrong(&[(path, text)]);
            let [check] = &found_wrong[..] else { panic!("{path}: {found_wrong:#?}") };
            assert_eq!(check.name, name);
            assert!(check.found.contains(found) && check.remedy.contains(remedy), "{check:?}");
        }
    }

    #[test]
    fn what_lifts_a_limit_counts() {
        let low = "Max locked memory  1 1 bytes\nMax realtime priority  0 0";
        let limits = |held: u64| {
            wrong(&[("proc/self/limits", low), ("proc/self/status", &format!("CapEff:\t{held:016x}\n"))])
                .len()
        };
        assert_eq!([0, IPC_LOCK, SYS_NICE, IPC_LOCK | SYS_NICE].map(limits), [2, 1, 1, 0]);
        // A file that may be written keeps processors awake.
        let sleepy = ("sys/devices/system/cpu/cpu1/cpuidle/state1/disable", "0");
        assert_eq!(wrong(&[sleepy, ("dev/cpu_dma_latency", "")]), []);
        assert_eq!(wrong(&[("proc/sys/kernel/sched_rt_runtime_us", "-1")]), []);
        assert_eq!(wrong(&[("sys/kernel/realtime", "1"), ("proc/version", "Linux version 5")]), []);
    }

    #[test]
    fn shared_memory_that_is_not_there_or_too_small_is_said() {
        let place = computer(&[]);
        let room = |needed| checks(place.path(), needed).into_iter().find(|check| !check.ok);
        assert!(room(u64::MAX).is_some_and(|check| check.found.contains("kB are free")));
        fs::remove_dir_all(place.path().join("dev")).expect("it is there");
        assert!(room(1).is_some_and(|check| check.found.contains("no /dev/shm")));
    }
}
