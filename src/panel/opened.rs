//! `pitchlock panel FILE.csv`: a trace is shown in the scope. In: a file. Out: its rows, all of them. There
//! is no machine.

use std::{path::Path, process::ExitCode, time::Duration};

use ::panel::{MachineSeen, ProgramSeen};
use process::ipc::time::{Moment, sleep_until};
use rig::trace;
use serde_json::json;

use super::{
    known::Known,
    live::{Live, fields},
    mode::Mode,
    scope::{LOT, Rows},
};
use crate::{
    error::CliError,
    run::{RunArgs, interrupts::Interrupts},
};

/// Most rows of a trace that is opened: five minutes at a cycle of 0.5 ms, some 300 MB in the panel.
const MOST_ROWS: usize = 600_000;

/// Between two looks at the panel.
const LOOK: Duration = Duration::from_millis(10);

/// Whether this is a trace that is to be opened.
pub(super) fn is_trace(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "csv" || ending == "mcap")
}

/// Shows a trace in the scope until somebody ends the command.
pub(super) fn opened(asked: &RunArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let path = &asked.program;
    if asked.says_more_than_of_panels() || asked.pace.is_some() {
        let text = "is a trace, and shown as it is: leave out all options but --port, --listen and --json";
        return Err(CliError::file(path, text));
    }
    let (mut rows, mut first, mut second) = (Rows::default(), None, None);
    trace::read(path, |row| {
        if first.is_none() {
            rows.axes = row.axes.iter().map(|(axis, _)| *axis).collect();
        }
        second = second.or((row.cycle > 0).then_some((row.cycle, row.t_s)));
        first = first.or(Some(row.cycle));
        rows.most += 1;
    })
    .map_err(|error| CliError::Input(error.to_string()))?;
    if rows.most == 0 || rows.most > MOST_ROWS {
        let text = format!("has {} rows: the scope opens 1 to {MOST_ROWS}", rows.most);
        return Err(CliError::file(path, text));
    }
    rows.cycle_s = second.map_or(1.0, |(cycle, t_s)| t_s / cycle as f64);
    let mut interrupts = Interrupts::catch()?;
    let mut live = Live::open(asked, quiet)?;
    live.mode = Mode::Playback;
    let name = path.display().to_string();
    let machine = MachineSeen { cycle_s: rows.cycle_s, pace: "0".into(), ..MachineSeen::default() };
    live.rows = rows;
    live.begins(
        &ProgramSeen { name: name.clone(), ..ProgramSeen::default() },
        &machine,
        (Known::default(), Vec::new()),
    );
    let words = format!("{name}: a trace, in the scope; there is no machine");
    live.stands(fields(&json!({ "mode": Mode::Playback.name(), "state": "ready", "words": words })));
    while !interrupts.is_wished() {
        live.look();
        if live.told_anew() {
            live.sends_all(path, &mut interrupts)?;
        }
        while let Some(press) = live.web.link.press() {
            live.refuse(
                press.ticket,
                "not-now",
                "this is a trace: there is no machine, and nothing that plays",
            );
        }
        sleep_until(Moment::now().after(LOOK));
    }
    Ok(ExitCode::SUCCESS)
}

impl Live {
    /// Sends all rows of a trace, as fast as the panel takes them.
    fn sends_all(&mut self, path: &Path, interrupts: &mut Interrupts) -> Result<(), CliError> {
        let mut ends = false;
        trace::read(path, |row| {
            self.rows.take(&row);
            while self.rows.taken >= LOT && !ends {
                self.web.link.is_free();
                if self.web.link.has_room() {
                    self.sends_rows();
                } else {
                    ends = interrupts.is_wished() || self.web.link.is_broken();
                    sleep_until(Moment::now().after(LOOK));
                }
            }
            if ends {
                self.rows.lot.clear();
            }
        })?;
        self.sends_rows();
        Ok(())
    }
}
