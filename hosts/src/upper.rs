//! The link on host A, in the interpolator's place: it takes machine code from the interpreter, sends it, and
//! gives the credit that comes back. In: what `pitchlock run --at` says. Out: what became of the run.

use std::time::Duration;

use process::{
    ipc::{Member, Patience, Process, channel, time::Moment},
    shell::{START_S, deliver},
};
use protocol::{Credit, Payload as _};

use crate::{
    LinkError,
    call::call,
    door::named,
    hello::{Answer, Hello, HostArgs, Identity, Verdict, Wants, hex, of_hex, opened, sealed},
    message::{FILE, Message, PART, is_file_name},
    proof::Role,
    seal::{self, Greeting, Key, Level},
    session::{Session, Voice},
    talk::{Said, Told, beats, leave, say},
    wire::{Event, Wire},
};

/// How often a greeting is repeated.
pub(crate) const AGAIN: Duration = Duration::from_millis(100);
/// So long somebody is called who does not answer.
pub(crate) const PATIENT_S: f64 = 5.0;
/// So long it may take until a run that has ended is summed up.
const SUMMED_UP_S: f64 = 60.0;

/// Arguments of whoever calls.
#[derive(Clone, Debug, clap::Args)]
pub struct CallArgs {
    /// Address of the lower level, HOST:PORT.
    #[arg(long, value_name = "ADDRESS")]
    pub at: String,
    #[command(flatten)]
    host: HostArgs,
}

/// Somebody who calls the lower level.
pub struct Caller {
    /// The wire.
    pub wire: Wire,
    key: Key,
    here: Identity,
    pub(crate) at: String,
    role: Role,
}

impl Caller {
    /// Reads the key. Nobody is called yet.
    ///
    /// # Errors
    /// [`LinkError::Input`].
    pub fn new(args: &CallArgs) -> Result<Caller, LinkError> {
        let (key, here) = args.host.read()?;
        Caller::of(key, here, &args.at, Role::Operator)
    }

    /// The same of somebody with this key who is as this host is.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn of(key: Key, here: Identity, at: &str, role: Role) -> Result<Caller, LinkError> {
        Ok(Caller { wire: Wire::that_calls()?, key, here, at: at.to_owned(), role })
    }

    /// Greets until there is an answer.
    ///
    /// # Errors
    /// Nobody answers in time, or who does lets nobody in, or refuses.
    pub fn call(&mut self, wants: &Wants, patience_s: f64) -> Result<(String, Session), LinkError> {
        let (own, answer) = self.answer(wants, patience_s)?;
        match (answer.verdict, of_hex(&answer.nonce)) {
            (Verdict::Welcome, Some(theirs)) => {
                let (sealer, opener) = seal::session(&self.key, own, theirs, Level::Upper);
                let run = named(&sealer.name());
                Ok((run, Session::new(Voice::new(sealer, self.wire.mouth()), opener)))
            }
            (Verdict::Refused(text), _) => Err(LinkError::Input(format!("{} refuses: {text}", self.at))),
            _ => Err(LinkError::Broken(format!("{} gives an answer that nobody gives", self.at))),
        }
    }

    /// An answer to a greeting, and our own number in it.
    pub(crate) fn answer(
        &mut self,
        wants: &Wants,
        patience_s: f64,
    ) -> Result<(seal::Nonce, Answer), LinkError> {
        let own = seal::nonce()?;
        let (nonce, back) = (hex(own), hex(self.wire.name));
        let hello = Hello { nonce, back, wants: wants.clone(), identity: self.here.clone() };
        let (deadline, mut again) = (Moment::in_s(patience_s), Moment::now());
        while !deadline.passed() {
            if !self.wire.is_there() {
                let left = deadline.since(Moment::now());
                self.wire.over(call(&self.at, &self.key.gate(), self.role, left)?)?;
            }
            if again.passed() {
                self.wire.mouth().say(sealed(Greeting::Hello, &self.key, &hello)?)?;
                again = Moment::now().after(AGAIN);
            }
            match self.wire.wait(AGAIN) {
                Some(Event::Frame(bytes)) => {
                    let answer = opened::<Answer>(Greeting::Answer, &self.key, &bytes);
                    if let Some(answer) = answer.filter(|answer| answer.of == hello.nonce) {
                        return Ok((own, answer));
                    }
                }
                Some(Event::Closed) => {
                    return Err(LinkError::Broken("whoever wanted the run is gone".into()));
                }
                Some(Event::Line(_) | Event::Shut(_) | Event::Gone) | None => {}
            }
        }
        Err(LinkError::Nobody(format!(
            "nobody answers at {}, but its gate\nhelp: see that the computer there is not held up",
            self.at
        )))
    }

    /// What is known of a run by whoever waits there: asked again until that is something, or so long.
    fn became_of(&mut self, run: &str, patience_s: f64) -> Result<Verdict, LinkError> {
        let deadline = Moment::in_s(patience_s);
        loop {
            let left_s = deadline.since(Moment::now()).as_secs_f64();
            let (_, Answer { verdict, .. }) = self.answer(&Wants::Outcome(run.into()), left_s)?;
            if !matches!(verdict, Verdict::NotYet) || deadline.passed() {
                return Ok(verdict);
            }
            process::ipc::time::sleep_until(Moment::now().after(AGAIN));
        }
    }

    /// Why a run has not begun, if anybody there knows.
    fn why_not(&mut self, run: &str) -> Option<LinkError> {
        match self.became_of(run, PATIENT_S) {
            Ok(Verdict::Outcome(value)) => value["error"].as_str().map(|text| refused(&self.at, text)),
            _ => None,
        }
    }

    /// What became of a run.
    fn outcome(&mut self, run: &str) -> Result<serde_json::Value, LinkError> {
        match self.became_of(run, SUMMED_UP_S) {
            Ok(Verdict::Outcome(value)) => Ok(value),
            Ok(Verdict::Refused(text)) => Err(LinkError::Broken(text)),
            Ok(_) => Err(LinkError::Broken(format!("{} does not sum up the run", self.at))),
            Err(error) => {
                let text = error.to_string();
                let first = text.lines().next().unwrap_or_default();
                Err(LinkError::Broken(format!("it has not summed up the run: {first}")))
            }
        }
    }
}

/// Runs the upper end of the link.
///
/// # Errors
/// [`LinkError`].
pub fn run(args: &CallArgs) -> Result<(), LinkError> {
    let mut caller = Caller::new(args)?;
    caller.wire.hear_the_parent()?;
    beats()?;
    let (run, mut session) = caller.call(&Wants::Run, PATIENT_S)?;
    session.voice.beat()?;
    say(&Said::Welcome { run: run.clone() });
    let mut began = false;
    let carried = carry(&caller, &mut session, &mut began);
    if let Err(error) = &carried {
        session.ends(error);
    }
    session.told().into_iter().for_each(|text| say(&Said::Note(text)));
    carried.unwrap_or_else(|error| {
        let is_told = began || matches!(error, LinkError::Input(_));
        let why = if is_told { None } else { caller.why_not(&run) };
        leave(&why.unwrap_or(error))
    });
    drop(session);
    say(&Said::Outcome(caller.outcome(&run)?));
    Ok(())
}

/// What the other computer refuses: nothing of what it names is here.
pub(crate) fn refused(at: &str, text: &str) -> LinkError {
    LinkError::Input(format!("on the computer at {at}: {text}"))
}

/// Sends the files of a run.
pub(crate) fn send_files(session: &Session, told: &Told) -> Result<(), LinkError> {
    let Told::Send { folder, files, words } = told else { return Ok(()) };
    let mut all = 0;
    for name in files {
        let path = folder.join(name);
        if !is_file_name(name) {
            let help = "a name for the other computer is UTF-8 without control characters, and begins with no dot: rename it";
            return Err(LinkError::file(&path, help));
        }
        let bytes = intake::bytes(&path, FILE as u64).map_err(|error| LinkError::file(&path, error))?;
        all += bytes.len();
        if all > FILE {
            return Err(LinkError::file(
                &path,
                format!("a run on another host has at most {} MB of files", FILE >> 20),
            ));
        }
        let parts = bytes.chunks(PART).chain(bytes.is_empty().then_some(&[][..]));
        for part in parts {
            session.voice.say(&Message::File(name.clone(), part.to_vec()))?;
        }
    }
    session.voice.say(&Message::Begin(words.clone()))
}

/// From the files of the run until nothing more is wanted; whether it has begun.
fn carry(Caller { wire, at, .. }: &Caller, session: &mut Session, began: &mut bool) -> Result<(), LinkError> {
    let address = loop {
        match wire.wait(AGAIN) {
            Some(Event::Frame(bytes)) => match session.hear(&bytes)? {
                Some(Message::Refused(text)) => return Err(refused(at, &text)),
                Some(Message::Go) => {
                    *began = true;
                    say(&Said::Started);
                }
                _ => {}
            },
            Some(Event::Line(line)) => match serde_json::from_str(&line) {
                Ok(Told::Join { address, .. }) => break address,
                Ok(told) => send_files(session, &told)?,
                Err(error) => return Err(LinkError::broken("a line of the launcher", error)),
            },
            Some(Event::Closed) => return Err(LinkError::Broken("its launcher has ended the run".into())),
            Some(Event::Gone) => session.is_cut(),
            Some(Event::Shut(_)) | None => session.lives()?,
        }
    };
    let mut member = Member::join(&address, Process::Interpolator)?;
    wire.wakes(member.doorbell());
    let mut code = member.receiver(channel::MACHINE_CODE)?;
    let mut credit = member.sender(channel::CREDIT, Patience::Forever)?;
    let interpreter = member.waker(Process::Interpreter)?;
    member.start(&[&code, &credit, &interpreter], Moment::in_s(START_S))?;
    let mut enough = false;
    while !enough {
        while let Some(packet) = code.receive()? {
            session.voice.say(&Message::Code(packet.bytes().to_vec()))?;
        }
        while let Some(event) = wire.look() {
            match event {
                Event::Frame(bytes) => match session.hear(&bytes)? {
                    Some(Message::Credit(given)) => {
                        enough |= given == Credit::ENOUGH;
                        deliver(&mut credit, &given)?;
                        interpreter.wake()?;
                    }
                    Some(Message::Refused(text)) => return Err(refused(at, &text)),
                    _ => {}
                },
                Event::Line(line) => match serde_json::from_str(&line) {
                    Ok(Told::Press(what)) => session.voice.say(&Message::Press(what))?,
                    Ok(Told::Computes) => session.voice.say(&Message::Computes)?,
                    _ => {}
                },
                Event::Closed => return Err(LinkError::Broken("its launcher has ended the run".into())),
                Event::Gone => session.is_cut(),
                Event::Shut(_) => {}
            }
        }
        session.lives()?;
        if !enough {
            member.wait_at_most(AGAIN)?;
        }
    }
    Ok(member.finish(&[code.count(), credit.count()])?)
}
