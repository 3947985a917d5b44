//! `pitchlock lsp`: what an editor asks of part programs, on standard input and output.

use std::process::ExitCode;

use clap::Args;
use lsp::Settings;
use process::shell::LanguageArgs;

use crate::{args::MachineArgs, error::CliError, words};

pub(crate) const HELP: &str =
    "An editor starts it; docs/editor.md says how VS Code, Neovim, Helix and Emacs are told to.
Example, as Helix is told in languages.toml:
  [language-server.pitchlock]
  command = \"pitchlock\"
  args = [\"lsp\", \"--machine\", \"my-lathe.toml\"]

The editor may say more as it starts (initialization options): machine, dialect, tools, subroutines, docs.";

#[derive(Clone, Debug, Args)]
pub(crate) struct LspArgs {
    #[command(flatten)]
    language: LanguageArgs,
    #[command(flatten)]
    machine: MachineArgs,
    /// Standard input and output, as editors ask for it; there is no other way.
    #[arg(long, hide = true)]
    stdio: bool,
}

/// Serves an editor until it ends.
pub(crate) fn lsp(args: &LspArgs) -> Result<ExitCode, CliError> {
    let shop = args.machine.with_language(&args.language)?;
    words::say(&shop.notes);
    let (connection, threads) = lsp_server::Connection::stdio();
    let settings = Settings { machine: shop.machine, language: shop.language.language(), docs: None };
    let served = ::lsp::serve(&connection, settings);
    // The writer ends when nobody can send any more.
    drop(connection);
    let written = threads.join().map_err(|error| CliError::Machine(error.to_string()));
    served.map_err(CliError::Machine).and(written).map(|()| ExitCode::SUCCESS)
}
