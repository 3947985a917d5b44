//! A session of two hosts: what is said is sealed and counted, what is heard is opened, and a beat says every
//! [`BEAT`] that the other one lives. In: messages. Out: messages, or why there is no session any more.

use std::{
    sync::{Arc, Mutex, PoisonError, Weak},
    time::Duration,
};

use process::ipc::time::{Moment, sleep_until};

use crate::{
    LinkError,
    message::Message,
    seal::{Greeting, Opener, Sealer, Unwelcome},
    wire::Mouth,
};

/// How often either host says that it lives.
const BEAT: Duration = Duration::from_millis(200);
/// So long nothing may be heard of the other one. A frozen link and a cable that is pulled for less go
/// unnoticed.
pub const SILENCE: Duration = Duration::from_secs(2);
/// So long the last word may take to be on its way: who says it ends.
const ON_ITS_WAY: Duration = Duration::from_millis(100);
/// So long what has come is looked at when the connection has ended.
const LEFT: Duration = Duration::from_millis(300);

/// What says things in a session, one after the other.
#[derive(Clone)]
pub struct Voice(Arc<(Mutex<Sealer>, Mouth)>);

impl Voice {
    /// A voice without a beat.
    pub fn new(sealer: Sealer, mouth: Mouth) -> Voice {
        Voice(Arc::new((Mutex::new(sealer), mouth)))
    }

    /// Says something.
    ///
    /// # Errors
    /// What Zenoh says.
    pub fn say(&self, message: &Message) -> Result<(), LinkError> {
        let (sealer, mouth) = &*self.0;
        // Numbers go out in their order, so the next one waits until this one is on its way.
        let mut sealer = sealer.lock().unwrap_or_else(PoisonError::into_inner);
        mouth.say(sealer.seal(&message.bytes()))
    }

    /// Beats from here on, as long as anybody has this voice.
    ///
    /// # Errors
    /// There is no thread for it.
    pub fn beat(&self) -> Result<(), LinkError> {
        let this = Arc::downgrade(&self.0);
        let beats =
            |this: &Weak<_>| this.upgrade().is_some_and(|voice| Voice(voice).say(&Message::Beat).is_ok());
        let beat = move || {
            while beats(&this) {
                sleep_until(Moment::now().after(BEAT));
            }
        };
        let thread = std::thread::Builder::new().name("beat".into()).spawn(beat);
        thread.map(drop).map_err(|error| LinkError::broken("a thread", error))
    }
}

/// What was not taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    /// Of nobody with the key of this session, or changed on the way.
    pub strangers: u64,
    /// There before.
    pub replayed: u64,
}

/// A session at one host.
pub struct Session {
    /// What it says.
    pub voice: Voice,
    opener: Opener,
    heard: Moment,
    /// When the connection ended.
    cut: Option<Moment>,
    /// A message of it has come: whoever greeted has the key, and is not a recording of one.
    pub has_spoken: bool,
    /// What was not taken so far.
    pub refusals: Refusals,
}

impl Session {
    /// A session that has just begun.
    pub fn new(voice: Voice, opener: Opener) -> Session {
        Session {
            voice,
            opener,
            heard: Moment::now(),
            cut: None,
            has_spoken: false,
            refusals: Refusals::default(),
        }
    }

    /// Whether bytes claim to be of this session.
    pub fn is_named_in(&self, bytes: &[u8]) -> bool {
        self.opener.is_named_in(bytes)
    }

    /// The message in these bytes; `None` for what is to be ignored: a beat, and what strangers sent.
    ///
    /// # Errors
    /// Messages of the other host were lost, or it says that it ends.
    pub fn hear(&mut self, bytes: &[u8]) -> Result<Option<Message>, LinkError> {
        if Greeting::Answer.is(bytes) {
            // A greeting that was repeated is answered as often.
            return Ok(None);
        }
        let body = match self.opener.open(bytes) {
            Ok(body) => body,
            Err(Unwelcome::Stranger) => {
                self.refusals.strangers += 1;
                return Ok(None);
            }
            Err(Unwelcome::Replayed) => {
                self.refusals.replayed += 1;
                return Ok(None);
            }
            Err(Unwelcome::Lost(lost)) => {
                let text = match lost {
                    1 => "a message of the other host was lost: the connection broke".into(),
                    _ => format!("{lost} messages of the other host were lost: the connection broke"),
                };
                return Err(LinkError::Broken(text));
            }
        };
        (self.heard, self.has_spoken) = (Moment::now(), true);
        match Message::of(body) {
            None => Err(LinkError::Broken("the other host sent a message that nobody sends".into())),
            Some(Message::Beat) => Ok(None),
            Some(Message::Bye(why)) => Err(LinkError::Broken(format!("the other host ended: {why}"))),
            Some(message) => Ok(Some(message)),
        }
    }

    /// The connection has ended. What came by it before may not have been heard yet.
    pub fn is_cut(&mut self) {
        self.cut.get_or_insert_with(Moment::now);
    }

    /// Whether the other host lives.
    ///
    /// # Errors
    /// [`LinkError::Silent`]: nothing was heard of it for [`SILENCE`]; its end of the connection has ended.
    pub fn lives(&self) -> Result<(), LinkError> {
        if self.cut.is_some_and(|cut| cut.elapsed() > LEFT) {
            return Err(LinkError::Broken("the process of the link on the other host has ended".into()));
        }
        if self.heard.elapsed() < SILENCE { Ok(()) } else { Err(LinkError::Silent(SILENCE)) }
    }

    /// Says that this host ends, and why, unless nobody would hear it.
    pub fn ends(&self, why: &LinkError) {
        if !matches!(why, LinkError::Silent(_)) {
            // What it is about is told here, too.
            let _ = self.voice.say(&Message::Bye(why.to_string()));
            sleep_until(Moment::now().after(ON_ITS_WAY));
        }
    }

    /// What was refused, to be told.
    pub fn told(&self) -> Option<String> {
        let Refusals { strangers, replayed } = self.refusals;
        (self.refusals != Refusals::default()).then(|| {
            format!(
                "refused on the link: {strangers} messages of strangers, {replayed} that were there before"
            )
        })
    }
}
