//! Arguments of the processes, as the launcher gives them.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use interpreter::{Dialect, Language};
use machine::ProgramDialect;

use super::Clock;

/// Arguments of every process of a machine.
#[derive(Clone, Debug, clap::Args)]
pub struct ProcessArgs {
    /// Name space of the machine, as the launcher gives it.
    #[arg(long, value_name = "ADDRESS")]
    pub address: String,
    /// Machine file (TOML); without it the built-in small lathe.
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// How processes wait for each other.
    #[arg(long, value_enum, default_value_t)]
    pub clock: Clock,
    /// In real time do not start unless everything that it needs is granted.
    #[arg(long)]
    pub strict_set_up: bool,
    /// Stay on this processor.
    #[arg(long, value_name = "N")]
    pub processor: Option<usize>,
}

/// How a program is to be read.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct LanguageArgs {
    /// Dialect of the part program; without it that of the machine file, which is auto unless it says so.
    #[arg(long, value_name = "DIALECT", value_parser = dialect())]
    pub dialect: Option<ProgramDialect>,
    /// Leave out lines that begin with `/`, which is `/1`; `=1,2` those that begin with `/1` or `/2`.
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, value_delimiter = ',')]
    #[arg(default_missing_value = "1", value_parser = clap::value_parser!(u8).range(1..=9))]
    pub block_delete: Vec<u8>,
    /// Take warnings for errors: a program that has any is not run.
    #[arg(long)]
    pub strict: bool,
    /// Tool table (LinuxCNC's format).
    #[arg(long, value_name = "FILE")]
    pub tools: Option<PathBuf>,
    /// Parameter file (LinuxCNC's .var): offsets, and all other parameters that are set at the start. `run`
    /// writes it back when the program has come to its end.
    #[arg(long, value_name = "FILE")]
    pub parameters: Option<PathBuf>,
    /// Machine description of LinuxCNC (.ini): its parameters, tools, subroutines and startup code; travel,
    /// and speeds that are not beyond those of the machine file.
    #[arg(long, value_name = "FILE")]
    pub ini: Option<PathBuf>,
    /// Folder with subroutine files, besides that of the program; may be given several times.
    #[arg(long, value_name = "DIR")]
    pub subroutines: Vec<PathBuf>,
    /// The line at which the program is begun.
    #[arg(skip)]
    pub from: Option<u32>,
}

impl LanguageArgs {
    /// What the interpreter takes.
    pub fn language(&self) -> Language {
        let LanguageArgs { dialect, block_delete, strict, tools, parameters, ini, subroutines, from } =
            self.clone();
        Language { dialect, block_delete, strict, tools, parameters, ini, subroutines, from }
    }
}

/// A value with its name and what it means.
pub type Named<T> = (T, &'static str, &'static str);

/// The dialects by their names.
const DIALECTS: [Named<ProgramDialect>; 3] = [
    (ProgramDialect::Auto, "auto", "by what only one of them has, else linuxcnc"),
    (ProgramDialect::Linuxcnc, Dialect::Linuxcnc.name(), Dialect::Linuxcnc.about()),
    (
        ProgramDialect::Fanuc,
        Dialect::Fanuc.name(),
        "FANUC lathe programs, G-code system A; on a mill FANUC and Haas mill programs",
    ),
];

/// Reads one of some values by its name.
pub fn one_of<T: Copy + Send + Sync + 'static>(
    values: &'static [Named<T>],
) -> impl TypedValueParser<Value = T> {
    let possible = values.iter().map(|(_, name, help)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(possible).map(move |given| {
        let found = values.iter().find(|(_, name, _)| *name == given);
        found.expect("only these names pass the parser before").0
    })
}

fn dialect() -> impl TypedValueParser<Value = ProgramDialect> {
    one_of(&DIALECTS)
}
