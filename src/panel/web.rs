//! The process of the panel as the launcher has it: the socket on which the panel listens, its secret, the
//! child, the link to it. A panel that dies is started again on the same socket.

use std::{
    io::Read as _,
    net::{SocketAddr, TcpListener},
    os::{
        fd::OwnedFd,
        unix::{net::UnixStream, process::CommandExt as _},
    },
    process::{Child, Command, Stdio},
    time::Duration,
};

use ::panel::{Link, ToPanel};
use process::ipc::time::Moment;

use super::args::PanelArgs;
use crate::error::CliError;

/// A panel that has died is not started again before so long.
const AGAIN: Duration = Duration::from_millis(500);
/// Bytes of the secret: 256 bits.
const SECRET: usize = 32;

/// The process of a panel.
pub(crate) struct Web {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
    child: Option<Child>,
    pub(crate) link: Link,
    begun: Moment,
    /// How often it was started.
    pub(crate) starts: u64,
}

impl Drop for Web {
    fn drop(&mut self) {
        self.end();
    }
}

/// Numbers that nobody can guess.
fn secret() -> std::io::Result<String> {
    let mut bytes = [0; SECRET];
    std::fs::File::open("/dev/urandom")?.read_exact(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

impl Web {
    /// Opens the socket and starts the process.
    pub(crate) fn open(args: &PanelArgs) -> Result<Web, CliError> {
        let place = args.place();
        let refused = |error: std::io::Error| {
            let (address, port) = place;
            CliError::Input(format!("--listen {address} --port {port}: {error}; give another port, or none"))
        };
        let listener = TcpListener::bind(place).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let failed =
            |error: std::io::Error| CliError::Machine(format!("the panel cannot be started: {error}"));
        let token = secret().map_err(failed)?;
        let (child, link) = start(&listener, &token).map_err(failed)?;
        Ok(Web { listener, address, token, child: Some(child), link, begun: Moment::now(), starts: 1 })
    }

    /// The page without its secret, and the secret.
    pub(crate) fn url_and_token(&self) -> (String, &str) {
        (format!("http://{}/", self.address), &self.token)
    }

    /// Starts a panel that is gone again, not too often, and says whether.
    pub(crate) fn look(&mut self) -> bool {
        let gone = self.link.is_broken()
            || self.child.as_mut().is_some_and(|child| !matches!(child.try_wait(), Ok(None)));
        if gone && self.child.is_some() {
            self.end();
        }
        if self.child.is_some() || self.begun.elapsed() < AGAIN {
            return false;
        }
        self.begun = Moment::now();
        // Without memory or files for it there is no panel, and a later look tries again.
        let Ok((child, link)) = start(&self.listener, &self.token) else { return false };
        self.child = Some(child);
        self.link = link;
        self.starts += 1;
        true
    }

    /// Ends the process; it may be gone already.
    fn end(&mut self) {
        if let Some(mut child) = self.child.take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// This program again as the process of a panel: the link is its standard input, the socket on which it
/// listens its standard output.
fn start(listener: &TcpListener, token: &str) -> std::io::Result<(Child, Link)> {
    let (ours, theirs) = UnixStream::pair()?;
    let mut command = Command::new(std::env::current_exe()?);
    command.arg("panel-server").process_group(0);
    command.stdin(Stdio::from(OwnedFd::from(theirs)));
    command.stdout(Stdio::from(OwnedFd::from(listener.try_clone()?)));
    let child = command.spawn()?;
    let mut link = Link::new(ours)?;
    link.offer(&ToPanel::Token(token.to_owned()));
    Ok((child, link))
}
