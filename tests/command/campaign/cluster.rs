//! A campaign on a cluster: Slurm on this computer, with two nodes of which one dies.

use std::fs;
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
use std::process::{Child, Command, Stdio};

use process::ipc::time::Moment;

use super::{made, soak, table};
use crate::shop::{Place, signal, until, wait_s};

/// A cluster of two nodes on this computer, of which one is killed in the middle;
/// `PITCHLOCK_CAMPAIGN=2000` has so many seeds.
#[test]
fn a_cluster_loses_a_node_and_no_row() {
    let Some(cluster) = Cluster::start() else { return };
    let seeds =
        std::env::var("PITCHLOCK_CAMPAIGN").map_or(48, |text| text.parse().expect("a number of seeds"));
    let place = &cluster.place;
    // Twelve jobs, or more that are not too long to be made again.
    let per_job = (seeds / 12).clamp(1, 40);
    place.write("seeds.toml", soak(seeds, per_job));
    made(place, &["seeds.toml", "--out", "whole"]);
    let script = made(place, &["seeds.toml", "--out", "spread", "--slurm"]);
    place.write("array.sh", script);
    let submitted = cluster.command("sbatch").arg("array.sh").output().expect("it is there");
    assert!(submitted.status.success(), "{}", String::from_utf8_lossy(&submitted.stderr));
    let there =
        || fs::read_dir(place.at("spread/jobs")).map_or(0, |entries| entries.flatten().count() as u64);
    until("some jobs are made", || there() >= 3);
    // Between two jobs it has none.
    until("a node dies in a job", || cluster.kill_node("n1"));
    // Slurm begins a task anew when what it was begun with has expired.
    let mut last = (0, Moment::now());
    while there() < seeds.div_ceil(per_job) || !cluster.queue().trim().is_empty() {
        if there() > last.0 {
            last = (there(), Moment::now());
        }
        assert!(last.1.elapsed().as_secs() < 300, "nothing was made for five minutes: {}", cluster.queue());
        wait_s(0.1);
    }
    made(place, &["seeds.toml", "--out", "spread", "--merge"]);
    assert_eq!(table(place, "spread"), table(place, "whole"));
}

/// Slurm on this computer, for an administrator; everything of it lies in one place.
struct Cluster {
    place: Place,
    daemons: Vec<(&'static str, Gone)>,
}

impl Cluster {
    /// None where there is no Slurm, or nobody who may start it; which test is left out is said.
    fn start() -> Option<Cluster> {
        let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let administrator = fs::metadata("/proc/self").is_ok_and(|found| found.uid() == 0);
        let all = ["munged", "slurmctld", "slurmd", "sbatch"];
        let has = |program: &&str| Command::new(program).arg("-V").output().is_ok();
        if !administrator || !all.iter().all(has) {
            eprintln!(
                "left out: a campaign on a cluster needs an administrator, Slurm and MUNGE (slurm-wlm)"
            );
            return None;
        }
        let place = Place::new();
        let at = place.path().display();
        // Key and socket of MUNGE are nobody else's business.
        fs::create_dir(place.at("munge")).expect("a folder");
        fs::set_permissions(place.path(), fs::Permissions::from_mode(0o755)).expect("it is ours");
        place.write("munge/key", [7; 1024]);
        fs::set_permissions(place.at("munge/key"), fs::Permissions::from_mode(0o600)).expect("it is ours");
        let port = 20_000 + std::process::id() % 20_000;
        let (control, first, last) = (port, port + 1, port + 2);
        let name = name.trim();
        let text = format!(
            "ClusterName=one\nSlurmctldHost={name}(127.0.0.1)\nSlurmctldPort={control}\nSlurmUser=root\nSlurmdUser=root\n\
             AuthType=auth/munge\nAuthInfo=socket={at}/munge/socket,cred_expire=10\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n\
             StateSaveLocation={at}/state\nSlurmdSpoolDir={at}/spool-%n\nSlurmctldPidFile={at}/ctld.pid\nSlurmdPidFile={at}/%n.pid\n\
             SlurmctldLogFile={at}/ctld.log\nSlurmdLogFile={at}/%n.log\nSelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\n\
             SlurmdTimeout=5\nMpiDefault=none\nNodeName=n[1-2] NodeHostname={name} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=1\n\
             PartitionName=all Nodes=n[1-2] Default=YES State=UP\n"
        );
        place.write("slurm.conf", text);
        let mut cluster = Cluster { place, daemons: Vec::new() };
        let munge = |name: &str| cluster.place.at("munge").join(name).display().to_string();
        let words = [
            "--foreground".into(),
            "--force".into(),
            format!("--key-file={}", munge("key")),
            format!("--socket={}", munge("socket")),
            format!("--pid-file={}", munge("pid")),
            format!("--log-file={}", munge("log")),
            format!("--seed-file={}", munge("seed")),
        ];
        let socket = cluster.place.at("munge/socket");
        cluster.begin("munged", &words);
        until("MUNGE is there", || socket.exists());
        cluster.begin("slurmctld", &["-D".into(), "-c".into()]);
        cluster.begin("slurmd", &["-D".into(), "-N".into(), "n1".into()]);
        cluster.begin("slurmd", &["-D".into(), "-N".into(), "n2".into()]);
        let idle = || cluster.command("sinfo").args(["-h", "-t", "idle", "-o", "%D"]).output();
        until("two nodes are idle", || idle().is_ok_and(|output| output.stdout.starts_with(b"2")));
        Some(cluster)
    }

    fn begin(&mut self, program: &'static str, words: &[String]) {
        let mut command = self.command(program);
        command.args(words).stdout(Stdio::null()).stderr(Stdio::null());
        self.daemons.push((program, Gone(command.spawn().expect("it is there"))));
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command
            .current_dir(self.place.path())
            .env("SLURM_CONF", self.place.at("slurm.conf"))
            .stdin(Stdio::null());
        command
    }

    /// What waits and what runs.
    fn queue(&self) -> String {
        let output = self.command("squeue").arg("-h").output().expect("it is there");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Ends a node, and all that runs on it, as a loss of power does: nobody is left to say that another has
    /// ended. False if nothing runs on it.
    fn kill_node(&self, node: &str) -> bool {
        let (_, Gone(daemon)) =
            self.daemons.iter().find(|(program, _)| *program == "slurmd").expect("a node");
        let of = |pid: u32, what: &str| fs::read_to_string(format!("/proc/{pid}/{what}")).unwrap_or_default();
        let (place, node) = (self.place.path().display().to_string(), format!("SLURMD_NODENAME={node}\0"));
        let all = fs::read_dir("/proc").expect("processes").flatten();
        let pids = all.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
        let tasks: Vec<u32> = pids
            .filter(|pid| {
                let environment = of(*pid, "environ");
                environment.contains(&place) && environment.contains(&node)
            })
            .collect();
        // Who has started them and waits for their end.
        let parent = |pid: &u32| {
            of(*pid, "status").lines().find_map(|line| line.strip_prefix("PPid:")?.trim().parse().ok())
        };
        let steps =
            tasks.iter().filter_map(parent).filter(|pid| of(*pid, "cmdline").starts_with("slurmstepd"));
        let all: Vec<u32> = [daemon.id()].into_iter().chain(steps).chain(tasks.iter().copied()).collect();
        if tasks.is_empty() {
            return false;
        }
        for how in ["STOP", "KILL"] {
            all.iter().for_each(|pid| signal(*pid, how));
        }
        true
    }
}

/// A process of a test; dropping it ends it.
struct Gone(Child);

impl Drop for Gone {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
