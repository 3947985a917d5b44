//! The machine as processes: start them, watch them, record, bring the machine to rest, end them.

use std::time::Duration;

use process::{
    ipc::{NameSpace, Process, hosts, of_the_living, time::Moment, total},
    shell::Clock,
};
use protocol::{Doom, operator::Request};
use rig::{
    observe::{self, Summary},
    standstill::Standstill,
    supervisor::{End, Supervisor},
};

use super::{
    Setup,
    channels::{Channels, counted},
    children::Started,
    endings::{Death, Endings},
    gives::Gives,
    hosts::seen,
    interrupts::{Interrupts, Wish},
    recorder::{Recorded, Recorder, axes},
    rendezvous::rendezvous,
    watchdog::{Hunger, Watchdog},
};
use crate::{
    error::CliError,
    panel::{Live, Presses, Who, hand},
};

/// How long the launcher sleeps when nobody wakes it.
const NAP: Duration = Duration::from_millis(20);
/// The same when something is wrong.
const SHORT_NAP: Duration = Duration::from_millis(1);
/// The plant has made an end so many control cycles after it was told to.
const LAST_CYCLES: u64 = 4096;

/// Runs the machine to its end.
pub(crate) fn run(
    setup: &Setup,
    interrupts: &mut Interrupts,
    live: Option<&mut Live>,
) -> Result<Recorded, CliError> {
    let axes = axes(&setup.machine);
    let mut space = NameSpace::create(&axes)?;
    let channels = Channels::open(&mut space, &setup.machine, setup.clock)?;
    let mut started = Vec::new();
    for host in hosts(setup.layout, &axes) {
        started.push(Started::start(setup, &space.address(), host)?);
    }
    rendezvous(&mut space, &channels, &mut started, interrupts, setup.watchdog_s)?;
    let mut by_hand = started.iter_mut().find_map(Started::takes_by_hand).map(Gives::new);
    by_hand.iter_mut().for_each(|gives| gives.give(&[hand::BEGINS]));
    let recorder = Recorder::new(setup, false, interrupts.asked())?;
    let begun = Moment::now();
    space.start()?;
    let mut launch = Launch {
        setup,
        supervisor: Supervisor::new(&setup.machine, &setup.program.watched),
        standstill: Standstill::new(&setup.machine, &setup.scenario),
        watchdog: Watchdog::new(setup.watchdog_s),
        hunger: Hunger::new(setup.watchdog_s),
        endings: Endings::default(),
        frozen: Vec::new(),
        wish: Wish::None,
        quits: None,
        space,
        channels,
        started,
        interrupts,
        recorder,
        live,
        by_hand,
    };
    launch.run()?;
    let counts = launch.end()?;
    let Launch { recorder, channels, mut started, endings, .. } = launch;
    let mut recorded = recorder.finish(&setup.folder.named, setup.clock);
    let summary = &mut recorded.summary;
    summary.deadline_misses = channels.late_answers();
    summary.processes = started.iter().map(Started::report).collect();
    summary.real_time = started.iter_mut().filter_map(Started::said).collect();
    summary.channels = counts;
    endings.tell(summary);
    complete(summary, setup, begun);
    Ok(recorded)
}

/// What only the launcher knows of a run.
pub(crate) fn complete(summary: &mut Summary, setup: &Setup, begun: Moment) {
    summary.seed = setup.seed;
    summary.wall_s = begun.elapsed().as_secs_f64();
}

/// A machine that runs.
struct Launch<'a> {
    setup: &'a Setup,
    recorder: Recorder,
    live: Option<&'a mut Live>,
    /// Where machine code by hand goes.
    by_hand: Option<Gives>,
    channels: Channels,
    // Behind the channels, which are ports in it.
    started: Vec<Started>,
    space: NameSpace,
    interrupts: &'a mut Interrupts,
    supervisor: Supervisor,
    standstill: Standstill,
    watchdog: Watchdog,
    hunger: Hunger,
    endings: Endings,
    /// Who was killed because it did not answer.
    frozen: Vec<Process>,
    /// What the operator wanted so far.
    wish: Wish,
    /// The plant was told to make an end when this was the newest cycle.
    quits: Option<u64>,
}

impl Launch<'_> {
    /// Until the last measurement, the death of the plant, or the patience of the operator.
    fn run(&mut self) -> Result<(), CliError> {
        let mut force = false;
        while !self.channels.ended() {
            let news = self.take()?;
            self.look_at_the_keyboard()?;
            self.look_at_the_panel()?;
            self.look_for_the_dead()?;
            let recorded = self.record(force)?;
            self.endings.ends(self.supervisor.end());
            match self.supervisor.end() {
                None => {}
                Some(End::PlantGone) => return Ok(()),
                Some(End::Rest | End::NoRest(_)) => {
                    let now = self.channels.unanswered(Process::Plant);
                    if self.quits.is_none() {
                        self.space.quit()?;
                    }
                    if now > *self.quits.get_or_insert(now) + LAST_CYCLES {
                        self.kill_frozen(Process::Plant);
                    }
                }
            }
            if self.wish == Wish::End {
                return Ok(());
            }
            // In real time messages may be lost: whoever has finished has told what there is of his.
            let comes_to_its_end = self.setup.clock == Clock::Real && self.channels.last_has_come();
            if comes_to_its_end && news > 0 {
                self.watchdog.calm();
            }
            force = comes_to_its_end && self.all_is_told()?;
            if !comes_to_its_end {
                self.look_for_the_frozen(news)?;
            }
            if news == 0 && !recorded {
                let nap = if self.supervisor.is_watching() { NAP } else { SHORT_NAP };
                match self.live.as_ref().and_then(|live| live.waits()) {
                    Some(press) => self.space.launcher().wait_beside(press, nap)?,
                    None => self.space.launcher().wait_at_most(nap)?,
                }
            }
        }
        Ok(())
    }

    /// Takes what has come. Whoever is to be killed or stopped in a cycle is so before it is recorded.
    fn take(&mut self) -> Result<usize, CliError> {
        let mut dooms: Vec<(Process, Doom)> = Vec::new();
        let fell = &self.setup.fell;
        let mut stands = false;
        let news = self.channels.drain(|truth| {
            let named = fell.iter().filter(|fell| fell.cycle == truth.cycle.0);
            let scenario = truth.doom().map(|(doom, module)| (Process::of(module), doom));
            let before = dooms.len();
            dooms.extend(named.map(|fell| (fell.process, fell.doom)).chain(scenario));
            stands |= dooms.len() > before;
        })?;
        self.hear_of_arrivals()?;
        for (process, doom) in dooms {
            self.started.iter_mut().filter(|one| one.host.holds(process)).for_each(|one| one.doom(doom));
            self.look_for_the_dead()?;
        }
        if stands && self.setup.clock == Clock::Virtual {
            self.space.go_on()?;
        }
        Ok(news)
    }

    /// What modules tell of their inputs.
    fn hear_of_arrivals(&mut self) -> Result<(), CliError> {
        let Launch { channels, recorder, live, .. } = self;
        channels.arrivals(|arrival| {
            recorder.arrivals.take(arrival);
            live.iter_mut().for_each(|live| live.arrived(arrival));
        })
    }

    /// Takes what was pressed at the panel.
    fn look_at_the_panel(&mut self) -> Result<(), CliError> {
        let Presses { items, messages, requests } =
            self.live.as_mut().map(|live| live.presses()).unwrap_or_default();
        if let Some(gives) = &mut self.by_hand {
            gives.give(&items);
            self.recorder.gives(&items, messages);
        }
        requests.into_iter().try_for_each(|request| self.ask(Some(request), None))
    }

    fn look_at_the_keyboard(&mut self) -> Result<(), CliError> {
        let there = self.started.iter_mut().map(Started::wish).max();
        let wish = self.interrupts.wish().max(there.unwrap_or(Wish::None));
        if wish == self.wish {
            return Ok(());
        }
        let before = std::mem::replace(&mut self.wish, wish);
        if before == Wish::None {
            self.ask(Some(Request::Stop), Some(Who::Keyboard))?;
        }
        if before < Wish::EmergencyStop && wish >= Wish::EmergencyStop {
            let request = self.supervisor.emergency_stop();
            self.ask(request, Some(Who::Keyboard))?;
        }
        if wish == Wish::End {
            self.endings.broken_off();
        }
        wish.words(before).for_each(|words| self.recorder.say(words));
        Ok(())
    }

    /// Buries those who have died since the last look. The machine is stopped first: in lock step it waits
    /// for the dead until it hears of the death.
    fn look_for_the_dead(&mut self) -> Result<(), CliError> {
        for index in 0..self.started.len() {
            if self.started[index].has_ended()? {
                let (host, ending) = (self.started[index].host.clone(), self.started[index].ending());
                let said = format!("{} {ending}", host.in_words());
                let ending = host.of_whom().map(|names| format!("of {names} {ending}")).unwrap_or(ending);
                let process = host.beats();
                host.modules.iter().try_for_each(|module| self.channels.last_words(*module))?;
                self.hear_of_arrivals()?;
                let cycle = self.channels.unanswered(process);
                let missed = self.recorder.hungry_since().filter(|_| process == Process::Interpreter);
                let frozen = self.frozen.contains(&process);
                let over = self.channels.ended();
                self.endings.died(Death { process, name: host.name, ending, cycle, missed, over, frozen });
                host.modules.into_iter().try_for_each(|module| self.is_dead(module))?;
                self.recorder.say(&said);
            }
        }
        Ok(())
    }

    /// Nobody waits any more for a module that is dead, and the machine is asked for what has to follow.
    fn is_dead(&mut self, process: Process) -> Result<(), CliError> {
        match process.module() {
            Some(module) => {
                let request = self.supervisor.died(module, self.channels.unanswered(process));
                self.ask(request, Some(Who::Launcher))?;
            }
            None => self.supervisor.plant_died(),
        }
        // What it has told goes with it.
        self.hear_of_arrivals()?;
        self.channels.bury(process);
        Ok(self.space.bury(process)?)
    }

    /// Kills whoever holds the machine up; the next look finds them dead.
    fn look_for_the_frozen(&mut self, news: usize) -> Result<(), CliError> {
        let mut frozen = Vec::from_iter(self.channels.silent());
        if news > 0 {
            self.watchdog.calm();
            let hungry =
                self.setup.clock == Clock::Real && self.hunger.look(&mut self.space, &self.started)?;
            frozen.extend(hungry.then_some(Process::Interpreter));
        } else {
            frozen.extend(self.watchdog.look(&mut self.space, &self.started)?);
        }
        frozen.extend(self.started.iter_mut().filter_map(|one| one.is_dumb().then(|| one.host.beats())));
        frozen.into_iter().for_each(|process| self.kill_frozen(process));
        Ok(())
    }

    fn kill_frozen(&mut self, process: Process) {
        for one in self.started.iter_mut().filter(|one| one.host.holds(process) && one.lives()) {
            self.frozen.push(one.host.beats());
            one.doom(Doom::Kill);
            self.recorder.say(&format!("{} does not answer any more: it is killed", one.host.in_words()));
        }
    }

    fn record(&mut self, force: bool) -> Result<bool, CliError> {
        let Launch { setup, recorder, supervisor, standstill, endings, live, started, .. } = self;
        let mut looks = started.iter_mut().find_map(Started::looked_at);
        // In real time somebody may stand at the panel.
        let alone = setup.clock == Clock::Virtual && live.is_none();
        let mut request = None;
        // Until the plant hears that it may go it makes cycles that belong to no run.
        let any = self.channels.record(force, |record| {
            if supervisor.end().is_none() {
                recorder.cycle(record);
                live.iter_mut().for_each(|live| live.cycle(record, recorder.observer()));
                let now = || seen(setup, record, recorder.observer());
                looks.take().into_iter().for_each(|link| link.shows(now()));
                if let Some(waits_for) = standstill.cycle(record).filter(|_| alone) {
                    request = endings.waits(record.truth.cycle.0, waits_for, supervisor).or(request);
                }
                request = supervisor.cycle(record).or(request);
            }
        });
        self.ask(request, Some(Who::Launcher))?;
        Ok(any)
    }

    /// Asks the plant for something; `who` does, unless that is known already.
    fn ask(&mut self, request: Option<Request>, who: Option<Who>) -> Result<(), CliError> {
        match request {
            // Without a plant there is no panel any more.
            Some(request) if !self.endings.has_died(Process::Plant) => {
                if let Some((live, who)) = self.live.as_mut().zip(who) {
                    live.sent(request, who);
                }
                self.channels.operate(request)
            }
            _ => Ok(()),
        }
    }

    /// Lets everybody finish and go; whoever does not is ended.
    fn end(&mut self) -> Result<Vec<observe::Channel>, CliError> {
        // An interpreter that waits for machine code by hand gets no more.
        self.by_hand = None;
        self.watchdog.waits_for(&self.started);
        while self.wish != Wish::End && self.someone_is_busy()? {
            self.recorder_is_fed()?;
            self.look_at_the_keyboard()?;
            self.look_for_the_dead()?;
            process::ipc::time::sleep_until(Moment::in_s(0.001));
        }
        self.hear_of_arrivals()?;
        // Who has not told his counts by now never will.
        let dead = self.space.unfinished()?;
        let mut counts = self.space.end()?;
        counts.extend(self.channels.counts());
        self.watchdog.waits_for(&self.started);
        while self.wish != Wish::End && self.started.iter().any(Started::lives) {
            for one in &mut self.started {
                one.has_ended()?;
            }
            if self.watchdog.have_had_time(&self.started) {
                break;
            }
            self.look_at_the_keyboard()?;
            process::ipc::time::sleep_until(Moment::in_s(0.001));
        }
        // Whoever is still there although all others have gone hangs.
        if self.wish != Wish::End {
            let all: Vec<Process> = self.started.iter().map(|one| one.host.beats()).collect();
            all.into_iter().for_each(|one| self.kill_frozen(one));
            self.look_for_the_dead()?;
        }
        self.started.iter_mut().for_each(Started::end);
        let counts = of_the_living(total(counts), &axes(&self.setup.machine), &dead);
        Ok(counts.into_iter().map(counted).collect())
    }

    /// Whether somebody alive has not finished. Who does not although he has long known is taken for frozen.
    fn someone_is_busy(&mut self) -> Result<bool, CliError> {
        self.is_busy(|_| true)
    }

    /// Whether whoever tells of cycles has told the last one. An interpreter may still wait for machine code.
    fn all_is_told(&mut self) -> Result<bool, CliError> {
        Ok(!self.is_busy(|process| process != Process::Interpreter)?)
    }

    fn is_busy(&mut self, counts: impl Fn(Process) -> bool) -> Result<bool, CliError> {
        let unfinished = self.space.unfinished()?;
        let living =
            |process: &Process| self.started.iter().any(|one| one.host.holds(*process) && one.lives());
        let busy: Vec<Process> =
            unfinished.into_iter().filter(|process| counts(*process) && living(process)).collect();
        if self.watchdog.have_had_time(&self.started) {
            busy.iter().for_each(|process| self.kill_frozen(*process));
        }
        Ok(!busy.is_empty())
    }

    /// What comes late is recorded, so that nobody waits for a place in a queue.
    fn recorder_is_fed(&mut self) -> Result<(), CliError> {
        if self.channels.drain(|_| {})? > 0 {
            self.watchdog.calm();
        }
        self.hear_of_arrivals()
    }
}
