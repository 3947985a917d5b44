//! A panel on host A, and the whole machine on host B with its interpreter and the launcher that the panel
//! is of. In: the socket between both, as either host has it. Out: the same socket on the other one, byte by
//! byte. The page, its secret and whoever comes by HTTP stay on A.

use std::{io::Write as _, os::unix::net::UnixStream, path::PathBuf, time::Duration};

use process::ipc::time::Moment;

use crate::{
    LinkError,
    door::Door,
    hello::Wants,
    lower::{NAP, OFF, heard},
    message::Message,
    pipe::Pipe,
    session::Session,
    talk::{Said, Told, beats, leave, say},
    upper::{AGAIN, CallArgs, Caller, PATIENT_S, refused, send_files},
    wire::{Event, Wire},
};

/// So long the last word may take.
const LAST_WORD: Duration = Duration::from_millis(400);

/// The socket that is carried, if there is one.
#[derive(Default)]
struct Carried(Option<Pipe>);

impl Carried {
    fn begins(
        &mut self,
        number: u32,
        socket: UnixStream,
        wire: &Wire,
        of: &Session,
    ) -> Result<(), LinkError> {
        self.0 = Some(Pipe::new(number, socket, &of.voice, wire.shuts(number))?);
        Ok(())
    }

    fn of(&self, number: u32) -> Option<&Pipe> {
        self.0.as_ref().filter(|pipe| pipe.number() == number)
    }

    /// What the other host says of it. What it says of one that was before comes late, and to nothing.
    fn takes(&mut self, message: Message, session: &Session) -> Result<(), LinkError> {
        match message {
            Message::Bytes(number, bytes) => {
                let taken = self.of(number).is_none_or(|pipe| pipe.put(bytes));
                return if taken { Ok(()) } else { self.shuts(number, session) };
            }
            Message::Took(number, count) => self.of(number).into_iter().for_each(|pipe| pipe.took(count)),
            Message::Shut(number) if self.of(number).is_some() => self.0 = None,
            _ => {}
        }
        Ok(())
    }

    /// Nothing more is read of it here: the other host hears that.
    fn shuts(&mut self, number: u32, session: &Session) -> Result<(), LinkError> {
        if self.of(number).is_none() {
            return Ok(());
        }
        self.0 = None;
        session.voice.say(&Message::Shut(number))
    }
}

/// Carries it on host B until the panel ends, or the session.
///
/// # Errors
/// [`LinkError`].
pub(crate) fn carry_down(wire: &Wire, door: &mut Door, session: &mut Session) -> Result<(), LinkError> {
    let (mut carried, mut place) = (Carried::default(), None);
    loop {
        match wire.wait(NAP) {
            Some(Event::Frame(bytes)) => match heard(door, session, &bytes)? {
                Some(Message::Press(what)) => say(&Said::Press(what)),
                Some(Message::Open(number)) => {
                    let path: &PathBuf = place.as_ref().ok_or_else(|| too_early(&"a socket"))?;
                    match UnixStream::connect(path) {
                        Ok(socket) => carried.begins(number, socket, wire, session)?,
                        // Its launcher is about to end, and why is said soon.
                        Err(_) => session.voice.say(&Message::Shut(number))?,
                    }
                }
                Some(message) => carried.takes(message, session)?,
                None => {}
            },
            Some(Event::Line(line)) => match serde_json::from_str(&line) {
                Ok(Told::Panel { socket, .. }) => {
                    place = Some(socket);
                    session.voice.say(&Message::Go)?;
                }
                Ok(Told::Refuse(text)) => return last_word(Message::Refused(text), wire, session),
                Ok(Told::Lost(text)) => return Err(LinkError::Broken(text)),
                Ok(Told::Over) => return last_word(Message::Over, wire, session),
                Ok(Told::Seen(seen)) => door.sees(seen),
                Ok(_) => {}
                Err(error) => return Err(LinkError::broken("a line of the launcher", error)),
            },
            Some(Event::Shut(number)) => carried.shuts(number, session)?,
            Some(Event::Closed) => return Err(LinkError::Broken(OFF.into())),
            Some(Event::Gone) | None => {}
        }
        session.lives()?;
    }
}

/// Says the last word, and waits a moment until the other host has heard it and ends, too.
pub(crate) fn last_word(word: Message, wire: &Wire, session: &mut Session) -> Result<(), LinkError> {
    session.voice.say(&word)?;
    let deadline = Moment::now().after(LAST_WORD);
    while !deadline.passed() {
        match wire.wait(LAST_WORD) {
            Some(Event::Frame(bytes)) if session.is_named_in(&bytes) && session.hear(&bytes).is_err() => {
                break;
            }
            _ => {}
        }
    }
    Ok(())
}

fn too_early(what: &dyn std::fmt::Display) -> LinkError {
    LinkError::Broken(format!("{what} before the machine has started"))
}

/// Runs the end at the panel.
///
/// # Errors
/// [`LinkError`].
pub fn run(args: &CallArgs) -> Result<(), LinkError> {
    let mut caller = Caller::new(args)?;
    caller.wire.hear_the_parent()?;
    beats()?;
    let (run, mut session) = caller.call(&Wants::Panel, PATIENT_S)?;
    session.voice.beat()?;
    say(&Said::Welcome { run });
    let carried = carry_up(&caller, &mut session);
    let over = LinkError::Broken("it is over".into());
    session.ends(carried.as_ref().err().unwrap_or(&over));
    session.told().into_iter().for_each(|text| say(&Said::Note(text)));
    carried.unwrap_or_else(|error| leave(&error));
    say(&Said::Outcome(serde_json::Value::Null));
    Ok(())
}

/// Carries it on host A.
fn carry_up(caller: &Caller, session: &mut Session) -> Result<(), LinkError> {
    let wire = &caller.wire;
    let (mut carried, mut place, mut goes) = (Carried::default(), None, false);
    let (mut number, mut again) = (0, Moment::now());
    loop {
        match wire.wait(AGAIN) {
            Some(Event::Frame(bytes)) => match session.hear(&bytes)? {
                Some(Message::Refused(text)) => return Err(refused(&caller.at, &text)),
                Some(Message::Over) => return Ok(()),
                Some(Message::Go) => {
                    goes = true;
                    say(&Said::Started);
                }
                Some(message) => carried.takes(message, session)?,
                None => {}
            },
            Some(Event::Line(line)) => match serde_json::from_str(&line) {
                Ok(Told::Panel { socket, first }) => place = Some((socket, first)),
                Ok(Told::Press(what)) => session.voice.say(&Message::Press(what))?,
                Ok(told) => send_files(session, &told)?,
                Err(error) => return Err(LinkError::broken("a line of the launcher", error)),
            },
            Some(Event::Shut(number)) => carried.shuts(number, session)?,
            Some(Event::Closed) => return Err(LinkError::Broken("its panel has ended".into())),
            Some(Event::Gone) => session.is_cut(),
            None => {}
        }
        session.lives()?;
        if let Some((path, first)) = place.as_ref().filter(|_| goes && carried.0.is_none() && again.passed())
        {
            (number, again) = (number + 1, Moment::now().after(AGAIN));
            let socket = UnixStream::connect(path)
                .and_then(|mut socket| socket.write_all(first.as_bytes()).map(|()| socket));
            let socket = socket.map_err(|error| LinkError::file(path, error))?;
            session.voice.say(&Message::Open(number))?;
            carried.begins(number, socket, wire, session)?;
        }
    }
}
