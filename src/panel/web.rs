//! The process of the panel as the launcher has it: the socket on which the panel listens, its secret, the
//! child, the link to it. A panel that dies is started again on the same socket. Or that process is on
//! another computer, and so is all of this but the link.

use std::{
    io::{Read as _, Write as _},
    net::{SocketAddr, TcpListener},
    os::{
        fd::{AsFd as _, OwnedFd},
        unix::{
            net::{UnixListener, UnixStream},
            process::CommandExt as _,
        },
    },
    process::{Child, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use ::panel::{Link, ToPanel};
use process::ipc::time::{Moment, sleep_until};
use serde_json::{Map, Value, json};

use super::{args::PanelArgs, mode::Mode};
use crate::{error::CliError, screen, words};

/// A panel that has died is not started again before so long.
const AGAIN: Duration = Duration::from_millis(500);
/// Behind the end of its link so long, in such looks, until it has gone by itself; then it is ended.
const GOES: Duration = Duration::from_millis(500);
const NAP: Duration = Duration::from_millis(5);
/// Bytes of the secret: 256 bits.
const SECRET: usize = 32;

/// The process of a panel on this computer, and the socket on which it listens.
pub(crate) struct Server {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
    child: Option<Child>,
    begun: Option<Moment>,
}

impl Drop for Server {
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

fn failed(error: std::io::Error) -> CliError {
    CliError::Machine(format!("the panel cannot be started: {error}"))
}

impl Server {
    /// Opens the socket.
    pub(crate) fn open(args: &PanelArgs) -> Result<Server, CliError> {
        let place = args.place();
        let refused = |error: std::io::Error| {
            let (address, port) = place;
            CliError::Input(format!("--listen {address} --port {port}: {error}; give another port, or none"))
        };
        let listener = TcpListener::bind(place).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        Ok(Server { listener, address, token: secret().map_err(failed)?, child: None, begun: None })
    }

    /// Says where it is.
    pub(crate) fn says_where(&self, json: bool, quiet: bool) {
        let (url, token) = (format!("http://{}/", self.address), &self.token);
        if json {
            screen::print(&format!("{}\n", json!({ "url": url, "token": token })));
        } else if !quiet {
            words::say(&format!("panel: {url}#{token}\n"));
        }
    }

    /// What it hears first.
    pub(crate) fn first(&self) -> ToPanel {
        ToPanel::Token(self.token.clone())
    }

    /// This program again as the process of a panel: its link to the launcher is its standard input, the
    /// socket on which it listens its standard output.
    pub(crate) fn start(&mut self, link: UnixStream) -> std::io::Result<()> {
        self.begun = Some(Moment::now());
        let mut command = Command::new(std::env::current_exe()?);
        command.arg("panel-server").process_group(0);
        command.stdin(Stdio::from(OwnedFd::from(link)));
        command.stdout(Stdio::from(OwnedFd::from(self.listener.try_clone()?)));
        self.child = Some(command.spawn()?);
        Ok(())
    }

    /// Whether there is none, and one may be started: not too often.
    pub(crate) fn is_due(&mut self) -> bool {
        if self.child.as_mut().is_some_and(|child| !matches!(child.try_wait(), Ok(None))) {
            self.end();
        }
        self.child.is_none() && self.begun.is_none_or(|begun| begun.elapsed() >= AGAIN)
    }

    /// Its launcher has ended the link: it goes by itself when it has shown what it heard last.
    fn goes(&mut self) {
        let until = Moment::now().after(GOES);
        let lives = |child: &mut Child| matches!(child.try_wait(), Ok(None));
        while self.child.as_mut().is_some_and(lives) && Moment::now() < until {
            sleep_until(Moment::now().after(NAP));
        }
    }

    /// Ends the process; it may be gone already.
    fn end(&mut self) {
        if let Some(mut child) = self.child.take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Where the process of the panel is.
enum Home {
    /// On this computer.
    Here(Server),
    /// On another one, whose link comes by this socket. Whoever leads this process may ask what the machine
    /// does, and is told by the other one.
    There(UnixListener, Arc<AtomicBool>, UnixStream),
}

/// A panel.
pub(crate) struct Web {
    home: Home,
    pub(crate) link: Link,
}

impl Web {
    /// Opens the socket and starts the process.
    pub(crate) fn open(args: &PanelArgs) -> Result<Web, CliError> {
        let mut server = Server::open(args)?;
        let link = begun(&mut server).map_err(failed)?;
        Ok(Web { home: Home::Here(server), link })
    }

    /// A panel on another computer; its link comes by the socket that is standard output here.
    pub(crate) fn there(looked: Arc<AtomicBool>) -> Result<Web, CliError> {
        let listener = std::io::stdout().as_fd().try_clone_to_owned().map(UnixListener::from);
        let listener = listener.and_then(|listener| listener.set_nonblocking(true).map(|()| listener));
        // Until it comes nobody is at the other end.
        let nobody = UnixStream::pair().and_then(|(ours, _)| Link::new(ours));
        let leads = std::io::stdin().as_fd().try_clone_to_owned().map_err(failed)?;
        let home = Home::There(listener.map_err(failed)?, looked, leads.into());
        Ok(Web { home, link: nobody.map_err(failed)? })
    }

    /// It is told no more: it shows what it has heard, and goes.
    pub(crate) fn goes(&mut self) {
        self.link.ends();
        if let Home::Here(server) = &mut self.home {
            server.goes();
        }
    }

    /// Says where it is, if it is here.
    pub(crate) fn says_where(&self, json: bool, quiet: bool) {
        if let Home::Here(server) = &self.home {
            server.says_where(json, quiet);
        }
    }

    /// Tells whoever has asked for it what the machine does. Nobody asks again before that, so this never
    /// waits.
    pub(crate) fn is_asked(&mut self, seen: impl FnOnce() -> Value) {
        if let Home::There(_, looked, leads) = &mut self.home
            && looked.swap(false, Ordering::Relaxed)
        {
            // Who is gone is seen elsewhere.
            let _ = writeln!(leads, "{}", seen());
        }
    }

    /// Begins anew with a panel that is gone, not too often, and says whether.
    pub(crate) fn look(&mut self) -> bool {
        let link = match &mut self.home {
            Home::Here(server) => {
                if self.link.is_broken() {
                    server.end();
                }
                // Without memory or files for it there is no panel, and a later look tries again.
                server.is_due().then(|| begun(server).ok()).flatten()
            }
            Home::There(listener, ..) => listener.accept().and_then(|(link, _)| Link::new(link)).ok(),
        };
        link.map(|link| self.link = link).is_some()
    }
}

/// Starts the process of a panel; the link to it.
fn begun(server: &mut Server) -> std::io::Result<Link> {
    let (ours, theirs) = UnixStream::pair()?;
    server.start(theirs)?;
    let mut link = Link::new(ours)?;
    link.offer(&server.first());
    Ok(link)
}

/// What a hall sees of a machine at which somebody stands: of what was shown last.
pub(super) fn in_a_hall(still: &Map<String, Value>, last: &Map<String, Value>, mode: Mode) -> Value {
    if mode == Mode::Off {
        return json!({ "mode": mode.name(), "panel": true });
    }
    let of = |name: &str| last.get(name).or_else(|| still.get(name)).cloned().unwrap_or(Value::Null);
    json!({
        "mode": mode.name(),
        "panel": true,
        "program": of("program")["name"],
        "cycle": of("cycle"),
        "time_s": of("time_s"),
        "line": of("line"),
        "faults": of("faults"),
    })
}
