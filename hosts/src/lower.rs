//! The link on host B, in the interpreter's place: it takes machine code off the wire, sends it to the
//! interpolator, and the credit back. In: what comes through the door. Out: a run, told to `pitchlock serve`.

use std::{
    fmt::Display,
    fs,
    io::BufRead,
    net::TcpListener,
    os::fd::AsFd as _,
    path::{Path, PathBuf},
    time::Duration,
};

use process::{
    ipc::{Member, Patience, Process, channel, time::Moment},
    shell::{START_S, deliver},
};
use protocol::{CodePacket, Credit, Payload as _};
use serde_json::Value;

use crate::{
    LinkError,
    door::{Asked, Door},
    hello::HostArgs,
    message::Message,
    panel,
    seal::Key,
    session::Session,
    talk::{Said, Told, beats, hear, leave, say},
    wire::{Event, Wire},
};

/// How long nothing is looked at when nothing comes.
pub(crate) const NAP: Duration = Duration::from_millis(100);
/// Why a launcher that is gone ends the link.
pub(crate) const OFF: &str = "`pitchlock serve` there is gone, and the machine comes to rest";
/// Events that are taken before anything else is looked at again.
const ROUND: usize = 256;

/// Arguments of the lower end.
#[derive(Clone, Debug, clap::Args)]
pub struct LowerArgs {
    #[command(flatten)]
    host: HostArgs,
    /// Empty folder for the files of a run.
    #[arg(long, value_name = "DIR")]
    pub into: PathBuf,
}

/// What became of a run, with its name.
type Became = (String, Value);

/// What the launcher says first: the key, if it was read before, and what became of the run before, with its
/// name.
fn before(parent: &mut impl BufRead) -> Result<(Option<Key>, Option<Became>), LinkError> {
    let wrong = |error: &dyn Display| LinkError::broken("the first line of the launcher", error);
    let mut line = String::new();
    parent.read_line(&mut line).map_err(|error| wrong(&error))?;
    let Told::Before { key, outcome } = serde_json::from_str(&line).map_err(|error| wrong(&error))? else {
        return Err(wrong(&"is another one"));
    };
    let named = |value: Value| value["run"].as_str().map(str::to_owned).map(|run| (run, value));
    Ok((key.and_then(|text| Key::of(&text)), outcome.and_then(named)))
}

/// Runs the lower end of the link: one run, or none if nobody asks for one.
///
/// # Errors
/// [`LinkError`].
pub fn run(args: &LowerArgs) -> Result<(), LinkError> {
    let mut parent = hear()?;
    let (key, before) = before(&mut parent)?;
    let key = key.map_or_else(|| Key::read(&args.host.key), Ok)?;
    // The launcher holds the address, from the first run to the last: it is the standard output here.
    let listener = std::io::stdout().as_fd().try_clone_to_owned().map(TcpListener::from);
    let listener = listener.map_err(|error| LinkError::broken("the address", error))?;
    let wire = Wire::behind_a_gate(listener, &key, &args.into)?;
    wire.hear(parent)?;
    let mut door = Door::new(key, args.host.identity(), wire.mouths(), before);
    say(&Said::Listening);
    let asked = loop {
        match wire.wait(NAP) {
            Some(Event::Frame(bytes)) => {
                if let Some(asked) = door.hears(&bytes)? {
                    break asked;
                }
            }
            Some(Event::Closed) => return Ok(()),
            Some(Event::Line(line)) => match serde_json::from_str(&line) {
                Ok(Told::Seen(seen)) => door.sees(seen),
                Ok(Told::Compared(machine)) => door.compares(machine),
                _ => {}
            },
            Some(Event::Shut(_) | Event::Gone) | None => {}
        }
    };
    let Asked { run, compared, mut session, files, words, by_panel } = asked;
    if let Err(error) = put(&args.into, files) {
        // Nothing has moved, and the next one may be smaller.
        panel::last_word(Message::Refused(error.to_string()), &wire, &mut session)?;
        say(&Said::Note(error.to_string()));
        return Ok(());
    }
    // The machine does not go on beside a link that is stopped.
    beats()?;
    say(&match by_panel {
        true => Said::Panel { words, compared },
        false => Said::Run { run, words, compared },
    });
    let carried = match by_panel {
        true => panel::carry_down(&wire, &mut door, &mut session),
        false => carry(&wire, &mut door, &mut session),
    };
    if let Err(error) = &carried {
        session.ends(error);
    }
    session.told().into_iter().for_each(|text| say(&Said::Note(text)));
    if wire.refused() > 0 {
        say(&Said::Note(format!("refused at the gate: {} who have not the key", wire.refused())));
    }
    carried.unwrap_or_else(|error| leave(&error));
    Ok(())
}

/// Puts the files of a run where its launcher finds them.
fn put(into: &Path, files: Vec<(String, Vec<u8>)>) -> Result<(), LinkError> {
    for (name, bytes) in files {
        let wrong = |error| {
            LinkError::file(Path::new(&name), format!("does not fit on the machine's computer: {error}"))
        };
        fs::write(into.join(&name), bytes).map_err(wrong)?;
    }
    Ok(())
}

/// What came, of this session; what is not is for the door.
pub(crate) fn heard(
    door: &mut Door,
    session: &mut Session,
    bytes: &[u8],
) -> Result<Option<Message>, LinkError> {
    if session.is_named_in(bytes) {
        return session.hear(bytes);
    }
    door.hears(bytes).map(|_| None)
}

/// Waits until the launcher of this host has read the program; its answer.
fn place(wire: &Wire, door: &mut Door, session: &mut Session) -> Result<Option<(String, bool)>, LinkError> {
    loop {
        match wire.wait(NAP) {
            Some(Event::Frame(bytes)) => {
                if let Some(Message::Press(what)) = heard(door, session, &bytes)? {
                    say(&Said::Press(what));
                }
            }
            Some(Event::Line(line)) => match serde_json::from_str(&line) {
                Ok(Told::Join { address, real }) => return Ok(Some((address, real))),
                Ok(Told::Refuse(text)) => {
                    return panel::last_word(Message::Refused(text), wire, session).map(|()| None);
                }
                Ok(Told::Seen(seen)) => door.sees(seen),
                Ok(_) => {}
                Err(error) => return Err(LinkError::broken("a line of the launcher", error)),
            },
            Some(Event::Closed) => return Err(LinkError::Broken(OFF.into())),
            Some(Event::Shut(_) | Event::Gone) | None => {}
        }
        session.lives()?;
    }
}

/// From the place in the machine until nothing more is wanted.
fn carry(wire: &Wire, door: &mut Door, session: &mut Session) -> Result<(), LinkError> {
    let Some((address, real)) = place(wire, door, session)? else { return Ok(()) };
    let mut member = Member::join(&address, Process::Interpreter)?;
    wire.wakes(member.doorbell());
    let mut code = member.sender(channel::MACHINE_CODE, Patience::Forever)?;
    let mut credit = member.receiver(channel::CREDIT)?;
    let interpolator = member.waker(Process::Interpolator)?;
    member.start(&[&code, &credit, &interpolator], Moment::in_s(START_S))?;
    session.voice.say(&Message::Go)?;
    let (mut enough, mut off) = (false, None);
    while !enough && !member.is_gone(Process::Interpolator) {
        let (mut any, mut taken) = (false, 0);
        while taken < ROUND
            && let Some(event) = wire.look()
        {
            taken += 1;
            let bytes = match event {
                Event::Frame(bytes) if off.is_none() => bytes,
                Event::Line(line) => {
                    if let Ok(Told::Seen(seen)) = serde_json::from_str(&line) {
                        door.sees(seen);
                    }
                    continue;
                }
                // The other host hears it at once; the machine here comes to rest without its launcher.
                Event::Closed => {
                    let why = LinkError::Broken(OFF.into());
                    session.ends(&why);
                    off = Some(why);
                    continue;
                }
                Event::Frame(_) | Event::Shut(_) | Event::Gone => continue,
            };
            match heard(door, session, &bytes)? {
                Some(Message::Code(bytes)) => {
                    let packet = CodePacket::from_payload(&bytes);
                    let packet =
                        packet.ok_or_else(|| LinkError::Broken("machine code of another size".into()))?;
                    deliver(&mut code, &packet)?;
                    any = true;
                }
                Some(Message::Press(what)) => say(&Said::Press(what)),
                Some(Message::Computes) => say(&Said::Computes),
                _ => {}
            }
        }
        if any && !real {
            interpolator.wake()?;
        }
        while let Some(given) = credit.receive()? {
            session.voice.say(&Message::Credit(given))?;
            enough |= given == Credit::ENOUGH;
        }
        if !enough {
            if off.is_none() {
                session.lives()?;
            }
            if taken < ROUND {
                member.wait_at_most(NAP)?;
            }
        }
    }
    if let Some(why) = off {
        return Err(why);
    }
    if !enough {
        session.voice.say(&Message::Credit(Credit::ENOUGH))?;
    }
    Ok(member.finish(&[code.count(), credit.count()])?)
}
