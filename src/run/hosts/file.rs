//! The machine file while the machine waits for programs: it is read again when it was changed. In: its
//! arguments. Out: the name of the machine, and the hash by which both computers compare it.

use std::{
    fs,
    os::unix::fs::MetadataExt as _,
    time::{Duration, SystemTime},
};

use process::ipc::time::Moment;

use crate::{args::MachineArgs, error::CliError, words};

/// How often it is looked whether the file is another one.
const LOOKS: Duration = Duration::from_millis(500);

/// What tells that a file is another one without reading it: when it was written, its length, its number.
type Stamp = Option<(SystemTime, u64, u64)>;

/// The file as it was read last.
pub(super) struct Compared<'a> {
    args: &'a MachineArgs,
    /// Name of the machine.
    pub(super) name: String,
    /// BLAKE3 of its text.
    pub(super) hash: String,
    /// It was changed behind that, and cannot be read.
    is_wrong: bool,
    stamp: Stamp,
    looked: Moment,
}

fn stamp(args: &MachineArgs) -> Stamp {
    let found = fs::metadata(args.machine.as_ref()?).ok()?;
    Some((found.modified().ok()?, found.len(), found.ino()))
}

impl<'a> Compared<'a> {
    /// Reads it.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn read(args: &'a MachineArgs) -> Result<Compared<'a>, CliError> {
        // First when it was written: a change behind that is seen later.
        let stamp = stamp(args);
        let (machine, text) = args.read()?;
        let hash = rig::hash::hex_of_text(&text);
        Ok(Compared { args, name: machine.general.name, hash, is_wrong: false, stamp, looked: Moment::now() })
    }

    /// Whether it is time for a look, which this counts as.
    pub(super) fn is_due(&mut self) -> bool {
        let is_due = self.looked.elapsed() > LOOKS;
        if is_due {
            self.looked = Moment::now();
        }
        is_due
    }

    /// The hash, if it is that of the file as it is.
    pub(super) fn compared(&self) -> Option<String> {
        Some(self.hash.clone()).filter(|_| !self.is_wrong)
    }

    /// Reads it again if it was changed; whether it is another one now. What is wrong with it is told, and
    /// refused when a run is asked for: it may be mended by then.
    pub(super) fn has_changed(&mut self) -> bool {
        let now = stamp(self.args);
        if now == self.stamp {
            return false;
        }
        match Compared::read(self.args) {
            Ok(read) => {
                let before = std::mem::replace(self, read);
                before.compared() != self.compared()
            }
            Err(error) => {
                self.stamp = now;
                words::say(&format!("error: {error}\n"));
                !std::mem::replace(&mut self.is_wrong, true)
            }
        }
    }
}
