//! The arguments of `pitchlock panel`, and of `run --panel`.

use std::net::{IpAddr, Ipv4Addr};

use clap::{Args, FromArgMatches};

use crate::run::RunArgs;

pub(crate) const HELP: &str = "Examples:
  pitchlock panel examples/m20x2.ngc              loads the program; start, and start again, from the page
  pitchlock panel examples/m20x2.ngc --terminal   the same in this terminal, with keys, as by ssh
  pitchlock panel --join                          in this terminal a panel that others have started
  pitchlock panel                                 without a program: jog, and give blocks by hand
  pitchlock panel part.ngc --machine my-lathe.toml --pace 0.2
  pitchlock panel runs/part-1                     plays a run that is over: pause, step, speed
  pitchlock panel runs/part-1/trace.mcap          opens a trace in the scope
  pitchlock panel part.ngc --at 10.0.0.2:7447 --key shop.key     the machine of another computer
  pitchlock run part.ngc --panel                  starts at once, and ends with the run
  pitchlock run runs/part-1                       repeats a session from its folder, bit for bit

The address that is printed opens in any browser. Its secret lets whoever knows it press: pass it on to nobody who may
not. docs/panel.md is the reference of page and API.

The page is software and no emergency stop. Ctrl-C ends the run in hand, then the command.";

/// Where the panel is.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct PanelArgs {
    /// Port of the panel; 0 takes a free one [default: 0].
    #[arg(long, value_name = "PORT")]
    pub(crate) port: Option<u16>,
    /// Address of this computer at which the panel is; others can reach any but the loopback. HTTP is not
    /// encrypted [default: 127.0.0.1].
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) listen: Option<IpAddr>,
}

impl PanelArgs {
    /// Address and port.
    pub(crate) fn place(&self) -> (IpAddr, u16) {
        (self.listen.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST)), self.port.unwrap_or(0))
    }

    /// Whether any of it was said.
    pub(crate) fn is_said(&self) -> bool {
        self.port.is_some() || self.listen.is_some()
    }
}

/// What comes of work by hand, and stands for a program where none is named.
pub(crate) const BY_HAND: &str = "by-hand.mc";

/// Arguments of `pitchlock panel`: those of a run, with or without a program.
#[derive(Clone, Debug, Args)]
#[command(mut_arg("program", |program| program.required(false).default_value(BY_HAND)))]
pub(crate) struct PanelCommandArgs {
    #[command(flatten)]
    pub(crate) run: RunArgs,
    /// Show the panel in this terminal, with keys, as by ssh; it ends with the terminal.
    #[arg(long)]
    pub(crate) terminal: bool,
    /// Show a panel that others have started in this terminal. Its address with the secret is asked for, or
    /// taken from PITCHLOCK_PANEL. What it runs is said where it was started: nothing else goes with it.
    #[arg(long, exclusive = true)]
    pub(crate) join: bool,
    /// As a terminal starts it.
    #[arg(long, hide = true)]
    pub(crate) led: bool,
    /// As `pitchlock serve` starts it, for a panel on another computer.
    #[arg(long, hide = true)]
    pub(crate) there: bool,
}

impl RunArgs {
    /// Whether options of a run are given, beside those of its panel.
    pub(super) fn says_more_than_of_panels(&self) -> bool {
        let command = PanelCommandArgs::augment_args(clap::Command::new("panel").no_binary_name(true));
        let matches = command.try_get_matches_from([&self.program]).ok();
        let Some(PanelCommandArgs { run, .. }) =
            matches.and_then(|matches| PanelCommandArgs::from_arg_matches(&matches).ok())
        else {
            return true;
        };
        let RunArgs { pace, with_panel, json, .. } = *self;
        let plain = RunArgs { pace, with_panel, json, panel: self.panel.clone(), ..run };
        format!("{plain:?}") != format!("{self:?}")
    }
}
