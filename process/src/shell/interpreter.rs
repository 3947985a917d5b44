//! The process of the interpreter: yields machine code as fast as there is credit.

use std::path::PathBuf;

use machine::Machine;
use protocol::{
    CodePacket, Credit, Item,
    code_file::{CodeFile, CodeFileError, CodeReader},
};

use crate::{
    ipc::{Process, channel, time::Moment},
    shell::{LanguageArgs, ProcessArgs, START_S, ShellError, Wait, deliver},
};

use interpreter::{Interpreter, open};

/// Arguments of the interpreter.
#[derive(Clone, Debug, clap::Args)]
pub struct InterpreterArgs {
    /// Part program (G-code), job (`.toml`), or machine code made by `pitchlock compile` (`.mc`).
    pub program: PathBuf,
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
                None => wait.sleep(&mut member, args.process.clock)?,
            }
        }
        deliver(&mut code, &packet)?;
        interpolator.wake()?;
    }
    Ok(member.finish(&[code.count(), credit.count()])?)
}

type Items = Box<dyn Iterator<Item = Result<Item, ShellError>>>;

/// The program, item by item, of either kind of file.
fn items(args: &InterpreterArgs, machine: &Machine) -> Result<Items, ShellError> {
    let path = &args.program;
    if CodeFile::is_named(path) {
        let path = path.clone();
        let wrong = move |error: CodeFileError| ShellError::Input(format!("{}: {error}", path.display()));
        let items = CodeReader::open(&args.program, &machine.identity()).map_err(&wrong)?;
        return Ok(Box::new(items.map(move |item| item.map_err(&wrong))));
    }
    let program = open(path, &args.language.language(), machine)
        .map_err(|error| ShellError::Input(error.to_string()))?;
    let interpreter = Interpreter::new(program, machine);
    Ok(Box::new(interpreter.map(|item| item.map_err(|error| ShellError::Input(error.render(false))))))
}
