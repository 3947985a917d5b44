//! The door of the lower level: greetings and what comes before a run. In: bytes from the wire. Out: answers,
//! and the session that a run begins in.

use process::ipc::time::Moment;
use serde_json::Value;

use crate::{
    LinkError,
    hello::{Answer, Hello, Identity, Verdict, Wants, hex, of_hex, opened, sealed},
    message::{FILE, Message},
    seal::{self, Greeting, Key, Level, Nonce},
    session::{Session, Voice},
    talk::{CHANGED, Said, say},
    wire::Mouths,
};

/// Sessions that have begun and are not yet a run, at most; the oldest goes of those that have said nothing.
const BEFORE: usize = 4;
/// Most files of a run.
const FILES: usize = 1000;
/// Why nobody else is let in.
const BUSY: &str = "the machine runs another program, or somebody stands at it: wait until that has ended";

/// A session that is not yet a run.
struct Before {
    /// The greeting that it began with.
    of: Nonce,
    /// Our own number.
    own: Nonce,
    name: String,
    /// Hash of the machine file that was compared.
    machine: String,
    session: Session,
    files: Vec<(String, Vec<u8>)>,
    wants: Wants,
}

/// A run that is asked for.
pub struct Asked {
    /// Its name.
    pub run: String,
    /// Hash of the machine file that was compared for it.
    pub compared: String,
    /// The session in which everything of it is said.
    pub session: Session,
    /// Its files.
    pub files: Vec<(String, Vec<u8>)>,
    /// Its arguments, the program first.
    pub words: Vec<String>,
    /// It is run by a panel.
    pub by_panel: bool,
}

/// The door.
pub struct Door {
    key: Key,
    here: Identity,
    /// The machine file cannot be read, and is compared when something is asked for.
    unread: bool,
    mouths: Mouths,
    before: Vec<Before>,
    /// The run that is on.
    on: Option<String>,
    /// What became of the last one, and its name.
    outcome: Option<(String, Value)>,
    /// What the machine did when that was said last, and whether it is asked for anew.
    seen: Option<(Value, Moment)>,
    looks: bool,
}

impl Door {
    /// A door for those with this key who are as this host is.
    pub fn new(key: Key, here: Identity, mouths: Mouths, outcome: Option<(String, Value)>) -> Door {
        Door {
            key,
            here,
            unread: false,
            mouths,
            before: Vec::new(),
            on: None,
            outcome,
            seen: None,
            looks: false,
        }
    }

    /// What comes when no run is on, or is of another session than that. Gives the run that it asks for.
    ///
    /// # Errors
    /// It cannot be answered.
    pub fn hears(&mut self, bytes: &[u8]) -> Result<Option<Asked>, LinkError> {
        if Greeting::Hello.is(bytes) {
            // Who has passed the gate and has another key is nobody who is answered.
            let hello = opened::<Hello>(Greeting::Hello, &self.key, bytes);
            return hello.map_or(Ok(None), |hello| self.greeted(hello).map(|()| None));
        }
        let Some(at) = self.before.iter().position(|before| before.session.is_named_in(bytes)) else {
            return Ok(None);
        };
        // Who loses messages here begins anew.
        let before = &mut self.before[at];
        let had_spoken = before.session.has_spoken;
        let heard = before.session.hear(bytes);
        if !had_spoken && before.session.has_spoken && before.wants != Wants::Ping {
            // Its files may take longer than silence may.
            before.session.voice.beat()?;
        }
        let Ok(Some(message)) = heard else { return Ok(None) };
        match message {
            Message::Ping(bytes) => before.session.voice.say(&Message::Pong(bytes))?,
            Message::File(name, bytes) => {
                let all = before.files.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
                let another = before.files.last().is_none_or(|(last, _)| *last != name);
                if another && before.files.len() == FILES || all + bytes.len() > FILE {
                    let text = format!("a run has at most {FILES} files and {} MB of them", FILE >> 20);
                    before.session.voice.say(&Message::Refused(text))?;
                    return Ok(None);
                }
                match before.files.last_mut().filter(|_| !another) {
                    Some((_, file)) => file.extend(bytes),
                    None => before.files.push((name, bytes)),
                }
            }
            Message::Begin(_) if self.on.is_some() || before.wants == Wants::Ping => {
                before.session.voice.say(&Message::Refused(BUSY.into()))?;
            }
            Message::Begin(words) => {
                let Before { name, machine, session, files, wants, .. } = self.before.swap_remove(at);
                self.on = Some(name.clone());
                let (run, compared, by_panel) = (name, machine, wants == Wants::Panel);
                return Ok(Some(Asked { run, compared, session, files, words, by_panel }));
            }
            _ => {}
        }
        Ok(None)
    }

    /// Answers a greeting.
    fn greeted(&mut self, hello: Hello) -> Result<(), LinkError> {
        let (Some(of), Some(back)) = (of_hex(&hello.nonce), of_hex(&hello.back)) else { return Ok(()) };
        let difference = match &hello.wants {
            // Who asks how a run has ended moves nothing.
            Wants::Look | Wants::Outcome(_) => self.here.hall_difference(&hello.identity),
            _ if self.unread => {
                let machine = hello.identity.machine.clone();
                Identity { machine, ..self.here.clone() }.difference(&hello.identity)
            }
            _ => self.here.difference(&hello.identity),
        };
        let (own, verdict) = match (difference, hello.wants) {
            (Some(text), _) => (0, Verdict::Refused(text)),
            (None, Wants::Look) => (0, self.looked_at()),
            (None, Wants::Outcome(run)) => (0, self.became_of(&run)),
            (None, _) if self.on.is_some() => (0, Verdict::Refused(BUSY.into())),
            (None, wants) => (self.welcome((of, back), hello.identity.machine, wants)?, Verdict::Welcome),
        };
        let answer = Answer { of: hello.nonce, nonce: hex(own), verdict };
        // An answer that finds no place is asked for again; a summary is long, and needs its time.
        let mouth = match &answer.verdict {
            Verdict::Outcome(_) => self.mouths.to(back),
            _ => self.mouths.to(back).that_does_not_wait(),
        };
        mouth.say(sealed(Greeting::Answer, &self.key, &answer)?)
    }

    /// Somebody looks: what is known is said at once, and asked for anew, once at a time.
    fn looked_at(&mut self) -> Verdict {
        if !std::mem::replace(&mut self.looks, true) {
            say(&Said::Look);
        }
        match &self.seen {
            Some((seen, at)) => Verdict::Seen(seen.clone(), at.elapsed().as_secs_f64()),
            None => Verdict::NotYet,
        }
    }

    /// The machine file has this hash from now on, or none. Who was compared with another one has to ask
    /// again.
    pub fn compares(&mut self, machine: Option<String>) {
        self.unread = machine.is_none();
        self.here.machine = machine.unwrap_or_default();
        for before in self.before.drain(..) {
            // Who is gone hears nothing.
            let _ = before.session.voice.say(&Message::Refused(CHANGED.into()));
        }
    }

    /// What the machine does.
    pub fn sees(&mut self, seen: Value) {
        self.seen = Some((seen, Moment::now()));
        self.looks = false;
    }

    fn became_of(&self, run: &str) -> Verdict {
        match &self.outcome {
            Some((name, outcome)) if name == run => {
                say(&Said::Fetched);
                Verdict::Outcome(outcome.clone())
            }
            _ if self.on.as_deref() == Some(run) => Verdict::NotYet,
            _ => Verdict::Refused(
                "nothing is known of that run here: its run folder tells how it ended".into(),
            ),
        }
    }

    /// A session for a greeting, which may have come before. Our number in it.
    fn welcome(
        &mut self,
        (of, back): (Nonce, Nonce),
        machine: String,
        wants: Wants,
    ) -> Result<Nonce, LinkError> {
        if let Some(before) = self.before.iter().find(|before| before.of == of) {
            return Ok(before.own);
        }
        let own = seal::nonce()?;
        let (sealer, opener) = seal::session(&self.key, of, own, Level::Lower);
        let name = named(&sealer.name());
        let session = Session::new(Voice::new(sealer, self.mouths.to(back)), opener);
        if self.before.len() == BEFORE {
            // A greeting can be said again by anybody who has heard it; what follows it cannot.
            self.before.remove(self.before.iter().position(|before| !before.session.has_spoken).unwrap_or(0));
        }
        self.before.push(Before { of, own, name, machine, session, files: Vec::new(), wants });
        Ok(own)
    }
}

/// The name of a session as text.
pub fn named(name: &seal::Name) -> String {
    name.iter().map(|byte| format!("{byte:02x}")).collect()
}
