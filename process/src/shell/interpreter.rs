//! The process of the interpreter: yields machine code as fast as there is credit.

use std::{
    io::{ErrorKind, Read, Write},
    path::PathBuf,
};

use machine::Machine;
use protocol::{
    CodePacket, Credit, Item,
    code_file::{CodeFile, CodeFileError, CodeReader},
};

use crate::{
    ipc::{Process, channel, time::Moment},
    shell::{Clock, LanguageArgs, ProcessArgs, START_S, ShellError, Wait, deliver},
};

use interpreter::{Interpreter, open};

/// Arguments of the interpreter.
#[derive(Clone, Debug, clap::Args)]
pub struct InterpreterArgs {
    /// Part program (G-code), job (`.toml`), or machine code made by `pitchlock compile` (`.mc`).
    pub program: PathBuf,
    /// Items come one by one from standard input, as `Given` reads them, and the program is none.
    #[arg(long)]
    pub by_hand: bool,
    /// The line at which the program is begun.
    #[arg(long)]
    pub from: Option<u32>,
    /// How it is read.
    #[command(flatten)]
    pub language: LanguageArgs,
    /// What every process needs.
    #[command(flatten)]
    pub process: ProcessArgs,
}

/// Sends a whole program, item by item.
///
/// # Errors
/// [`ShellError`]: a diagnostic of the program, or the interpolator cannot be reached.
pub fn run(args: &InterpreterArgs) -> Result<(), ShellError> {
    let machine = args.process.read_machine()?;
    let mut member = args.process.join(Process::Interpreter)?;
    let mut code = member.sender(channel::MACHINE_CODE, args.process.patience(&machine))?;
    let mut credit = member.receiver(channel::CREDIT)?;
    let interpolator = member.waker(Process::Interpolator)?;
    let items = items(args, &machine)?;
    member.start(&[&code, &credit, &interpolator], Moment::in_s(START_S))?;

    let mut taken = 0;
    'program: for (sequence, item) in (0..).zip(items) {
        let packet = CodePacket::pack(sequence, &item?);
        let mut wait = Wait::on(Process::Interpolator);
        while sequence >= taken + channel::CODE_DEPTH {
            let news = credit.receive()?;
            if news == Some(Credit::ENOUGH) || wait.is_in_vain(&mut member) {
                break 'program;
            }
            match news {
                Some(news) => taken = news.taken,
                // It has no deadline, so it sleeps until it is woken, in real time too.
                None => wait.sleep(&mut member, Clock::Virtual)?,
            }
        }
        deliver(&mut code, &packet)?;
        if args.process.clock == Clock::Virtual {
            interpolator.wake()?;
        }
    }
    Ok(member.finish(&[code.count(), credit.count()])?)
}

type Items = Box<dyn Iterator<Item = Result<Item, ShellError>>>;

/// The program, item by item, of either kind of file.
fn items(args: &InterpreterArgs, machine: &Machine) -> Result<Items, ShellError> {
    let path = &args.program;
    if args.by_hand {
        return Ok(Box::new(Given { input: std::io::stdin().lock(), given: 0 }));
    }
    if CodeFile::is_named(path) {
        let path = path.clone();
        let wrong = move |error: CodeFileError| ShellError::Input(format!("{}: {error}", path.display()));
        let items = CodeReader::open(&args.program, &machine.identity()).map_err(&wrong)?;
        return Ok(Box::new(items.map(move |item| item.map_err(&wrong))));
    }
    let program = open(path, &args.language.language(), machine)
        .map_err(|error| ShellError::Input(error.to_string()))?;
    let interpreter = Interpreter::new(program, machine);
    let items: Box<dyn Iterator<Item = _>> = match args.from {
        None => Box::new(interpreter),
        Some(line) => {
            let begun = interpreter.from_line(line, machine);
            Box::new(begun.map_err(|refused| ShellError::Input(refused.to_string()))?)
        }
    };
    Ok(Box::new(items.map(|item| item.map_err(|error| ShellError::Input(error.render(false))))))
}

/// Most bytes that an item has on its way, which go before it.
type Length = u16;

/// Items that somebody gives one by one. It waits for the next one as long as whoever gives them is there.
struct Given<R> {
    input: R,
    given: u64,
}

impl<R: Read> Given<R> {
    fn read(&mut self) -> Result<Option<Item>, ShellError> {
        let wrong = |what: &dyn core::fmt::Display| ShellError::Input(format!("items by hand: {what}"));
        let mut length = [0; size_of::<Length>()];
        match self.input.read_exact(&mut length) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(None),
            read => read.map_err(|error| wrong(&error))?,
        }
        let mut bytes = vec![0; Length::from_le_bytes(length).into()];
        self.input.read_exact(&mut bytes).map_err(|error| wrong(&error))?;
        let packet = CodePacket::from_bytes(&bytes).and_then(|packet| packet.unpack(self.given));
        self.given += 1;
        packet.map(Some).map_err(|refused| wrong(&refused))
    }
}

impl<R: Read> Iterator for Given<R> {
    type Item = Result<Item, ShellError>;

    fn next(&mut self) -> Option<Result<Item, ShellError>> {
        self.read().transpose()
    }
}

/// Writes items for an interpreter that takes them by hand; `given` counts them, from 0.
///
/// # Errors
/// It is gone.
pub fn give(items: &[Item], given: &mut u64, to: &mut impl Write) -> std::io::Result<()> {
    let mut bytes = Vec::new();
    for item in items {
        let packet = CodePacket::pack(*given, item);
        let length = Length::try_from(packet.as_bytes().len()).unwrap_or(Length::MAX);
        bytes.extend(length.to_le_bytes());
        bytes.extend(packet.as_bytes());
        *given += 1;
    }
    to.write_all(&bytes)
}

#[cfg(test)]
mod tests {
    use protocol::{ByHand, Code};

    use super::*;

    #[test]
    fn items_come_as_they_were_given_and_damage_is_named() {
        let items = [(0, Code::ByHand(ByHand::Waits)), (1, Code::Dwell { seconds: 0.25 }), (1, Code::End)];
        let items = items.map(|(line, code)| Item { line, code });
        let (mut given, mut pipe) = (0, Vec::new());
        give(&items[..1], &mut given, &mut pipe).expect("room");
        give(&items[1..], &mut given, &mut pipe).expect("room");
        let read = |bytes: &[u8]| -> Result<Vec<Item>, String> {
            let given = Given { input: bytes, given: 0 };
            given.map(|item| item.map_err(|error| error.to_string())).collect()
        };
        assert_eq!(read(&pipe).as_deref(), Ok(&items[..]));
        // Cut off anywhere: what is whole, and then the end or an error.
        for end in 0..pipe.len() {
            assert!(read(&pipe[..end]).map_or(true, |whole| items.starts_with(&whole)), "{end}");
        }
        let mut damaged = pipe.clone();
        damaged[2] ^= 1;
        assert!(read(&damaged).is_err_and(|error| error.contains("by hand")));
    }
}
