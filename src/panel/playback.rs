//! `pitchlock panel RUN_DIR`: a recorded run is shown again. In: a run folder, what somebody asks of the
//! player. Out: the cycles of the run, as they are made again from what its modules got, at any speed. There
//! is no machine, and no key of one does anything.

use std::{path::Path, process::ExitCode, time::Duration};

use ::panel::{HandAsked, Play, ToPanel};
use process::{
    ipc::time::{Moment, sleep_until},
    shell::Pace,
};
use rig::observe::{Observer, Record};
use serde_json::json;

use super::{
    known::{Known, Shown, stays},
    live::{Live, fields},
    mode::{Mode, Press},
    scope::Rows,
    view,
};
use crate::{
    error::CliError,
    offsets::Table,
    replay::{Again, Recorded},
    run::{RunArgs, folder::changed, interrupts::Interrupts},
};

/// Between two looks at the panel.
const LOOK: Duration = Duration::from_millis(10);
/// Most cycles that are made between two looks: those of a second and more.
const AT_ONCE: u64 = 4096;

/// Where the player is.
struct Player<'a> {
    recorded: &'a Recorded,
    run: Shown<'a>,
    again: Again,
    observer: Observer,
    /// The next cycle.
    next: u64,
    until: u64,
    /// Seconds of the machine in each on the wall.
    speed: f64,
    /// It goes to this cycle as fast as it can, and stands.
    to: Option<u64>,
    /// Cycles that are due, with what is left of one.
    due: f64,
    /// Files of the folder that are not what they were.
    changed: Vec<String>,
    /// Whether all of it was what was recorded, when it has come to its end.
    same: Option<bool>,
}

/// Plays a run until somebody ends the command.
pub(super) fn playback(asked: &RunArgs, quiet: bool) -> Result<ExitCode, CliError> {
    if asked.says_more_than_of_panels() {
        let text = "is played as it was: leave out all options but --pace, --port, --listen and --json; \
                    pitchlock run RUN_DIR runs it again with others";
        return Err(CliError::file(&asked.program, text));
    }
    let recorded = Recorded::open(&asked.program)?;
    let (program, path, language) = recorded.program();
    let machine = &recorded.machine;
    let run = Shown { machine, program, path, language: &language, folder: &asked.program, pace: Pace::ONE };
    let mut interrupts = Interrupts::catch()?;
    let mut live = Live::open(asked, quiet)?;
    live.mode = Mode::Playback;
    let (again, observer) = recorded.begun()?;
    let until = recorded.summary.cycles;
    let speed = asked.pace.map_or(1.0, |pace| pace.to_string().parse().unwrap_or(1000.0));
    let changed = changed(&asked.program, &recorded.summary);
    let (to, due, same) = (None, 0.0, None);
    let mut player =
        Player { recorded: &recorded, run, again, observer, next: 0, until, speed, to, due, changed, same };
    player.begins(&mut live, &asked.program);
    player.goes(&mut live, 1)?;
    live.look();
    let mut before = Moment::now();
    while !interrupts.is_wished() {
        player.asked(&mut live, &asked.program)?;
        let cycle_s = player.run.machine.general.cycle_s;
        player.due += before.elapsed().as_secs_f64() * player.speed / cycle_s;
        before = Moment::now();
        let most = player.to.map_or(player.due as u64, |to| to - player.next).min(AT_ONCE);
        // The scope misses nothing of a recording: it waits for the panel.
        let most = if live.web.link.has_room() { most } else { 0 };
        player.due = (player.due - most as f64).clamp(0.0, 1.0);
        let stands = player.goes(&mut live, most)?;
        live.look();
        if stands {
            sleep_until(before.after(LOOK));
        }
    }
    Ok(ExitCode::SUCCESS)
}

impl Player<'_> {
    /// Shows what stays the same, at the beginning.
    fn begins(&self, live: &mut Live, dir: &Path) {
        let (program, machine) = stays(&self.run, &self.observer);
        live.rows = Rows::of(self.run.machine);
        live.begins(&program, &machine, Known::of(&self.run));
        let begun = live.tables.begins(Table::of(self.run.language, self.run.machine, None));
        live.shows_tables(begun);
        live.stands(fields(&json!({ "part": view::part(&self.recorded.summary, dir) })));
        self.shows(live, dir);
    }

    /// Shows what the player does.
    fn shows(&self, live: &mut Live, dir: &Path) {
        let until_s = self.until as f64 * self.run.machine.general.cycle_s;
        let speed = self.to.is_none().then_some(self.speed);
        let playback = json!({ "of": dir.display().to_string(), "speed": speed, "until_s": until_s,
            "outcome": self.recorded.summary.outcome, "changed": self.changed, "same": self.same });
        if live.still.get("playback") != Some(&playback) {
            live.stands(fields(&json!({ "playback": playback, "mode": Mode::Playback.name() })));
        }
    }

    /// Makes so many cycles; whether it stands behind them.
    fn goes(&mut self, live: &mut Live, most: u64) -> Result<bool, CliError> {
        let end = (self.next + most).min(self.until);
        let stops = end == self.until || self.to == Some(end);
        let Player { again, observer, next, .. } = self;
        while *next < end {
            let last = stops && *next + 1 == end;
            let goes_on = again.step(|exchange, seen| {
                if seen {
                    observer.cycle(&exchange.record);
                    live.plays(&exchange.record, observer, last);
                }
            })?;
            *next = if goes_on { *next + 1 } else { end };
        }
        if end == self.until {
            self.same = Some(self.observer.trace_hash() == self.recorded.summary.trace_hash);
        }
        if stops {
            (self.speed, self.to, self.due) = (0.0, None, 0.0);
        }
        Ok(self.to.is_none())
    }

    /// Takes what somebody asks.
    fn asked(&mut self, live: &mut Live, dir: &Path) -> Result<(), CliError> {
        while let Some(press) = live.web.link.press() {
            let Some(HandAsked::Play(play)) = press.hand else {
                let why = live.mode.refuses(Press::Always).unwrap_or_default();
                live.refuse(press.ticket, "not-now", why);
                continue;
            };
            let cycle_s = self.run.machine.general.cycle_s;
            match play {
                // So that what is shown is where it stands.
                Play::Speed(0.0) => self.to = Some((self.next + 1).min(self.until)),
                Play::Speed(speed) => {
                    (self.speed, self.to, self.due) = (speed, None, 0.0);
                    // One that goes on from the end begins again.
                    if self.next >= self.until {
                        self.back(live, dir)?;
                    }
                }
                Play::Step(cycles) => self.to = Some((self.next + cycles).min(self.until)),
                Play::Seek(time_s) => {
                    // Cycle 0 is the first that is shown.
                    let to = ((time_s / cycle_s).round() as u64 + 1).min(self.until);
                    if to < self.next {
                        self.back(live, dir)?;
                    }
                    self.to = Some(to);
                }
            }
            live.web
                .link
                .answer(&ToPanel::Taken { ticket: press.ticket, cycle: self.next.saturating_sub(1) });
        }
        self.shows(live, dir);
        Ok(())
    }

    /// Back to the beginning.
    fn back(&mut self, live: &mut Live, dir: &Path) -> Result<(), CliError> {
        (self.again, self.observer) = self.recorded.begun()?;
        self.next = 0;
        self.begins(live, dir);
        Ok(())
    }
}

impl Live {
    /// One cycle of a recording; `last`: it stands there.
    fn plays(&mut self, record: &Record, observer: &Observer, last: bool) {
        self.cycle(record, observer);
        if last {
            self.sends_rows();
            let mut shown = fields(&view::seen(record, observer, None, &mut self.known));
            self.shows_hand(&mut shown);
            self.shows_zero(record);
            self.stands(shown);
        }
    }
}
