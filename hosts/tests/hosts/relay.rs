//! A way into a network namespace: sockets of the file system are in none, so a process that lives in one
//! carries what comes by such a socket to an address of that network.

use std::{
    io::{Read as _, Write as _},
    net::TcpStream,
    os::unix::net::{UnixListener, UnixStream},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread::Builder,
};

use crate::place::{Host, Place, until};

/// Where the socket is, in the process that carries.
const SOCKET: &str = "PITCHLOCK_RELAY";

/// A process of the network of host A that carries requests. It goes with this.
pub(crate) struct Relay {
    child: Child,
    path: PathBuf,
}

impl Drop for Relay {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Relay {
    /// Starts it: this program again, with the test below alone.
    pub(crate) fn start(place: &Place) -> Relay {
        let path = place.at("relay");
        let this = std::env::current_exe().expect("its own name");
        let mut command: Command = place.command(Host::A, &this);
        command.args(["relay::carries", "--exact", "--ignored"]).env(SOCKET, &path);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
        until("the relay is there", 10.0, || UnixStream::connect(&path).is_ok());
        Relay { child, path }
    }

    /// Sends a request to an address, and reads the answer to its end.
    pub(crate) fn asks(&self, address: &str, request: &str) -> Vec<u8> {
        let mut stream = UnixStream::connect(&self.path).expect("the relay");
        write!(stream, "{address}\n{request}").expect("sent");
        let mut answer = Vec::new();
        // Who is not there does not answer.
        let _ = stream.read_to_end(&mut answer);
        answer
    }
}

/// The process: the first line is the address.
#[test]
#[ignore = "a process of other tests"]
fn carries() {
    let Some(path) = std::env::var_os(SOCKET) else { return };
    let listener = UnixListener::bind(Path::new(&path)).expect("a socket");
    for stream in listener.incoming().flatten() {
        Builder::new().spawn(move || carry(stream)).expect("a thread");
    }
}

fn carry(mut from: UnixStream) -> Option<()> {
    let mut address = Vec::new();
    let mut byte = [0];
    while from.read(&mut byte).ok()? == 1 && byte != *b"\n" {
        address.push(byte[0]);
    }
    let mut to = TcpStream::connect(String::from_utf8(address).ok()?).ok()?;
    let (mut out, mut request) = (to.try_clone().ok()?, from.try_clone().ok()?);
    Builder::new().spawn(move || std::io::copy(&mut request, &mut out)).ok()?;
    std::io::copy(&mut to, &mut from).ok()?;
    from.shutdown(std::net::Shutdown::Both).ok()
}
