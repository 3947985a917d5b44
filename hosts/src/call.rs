//! Calling a machine: the other side of its gate. In: an address, a key. Out: a connection on which Zenoh may
//! speak, or why there is none.

use std::{
    io::{ErrorKind, Read as _, Write as _},
    net::{SocketAddr, TcpStream, ToSocketAddrs as _},
    time::Duration,
};

use process::ipc::time::{Moment, sleep_until};

use crate::{
    LinkError,
    proof::{GREETING, Greeted, Role, Secret, VERDICT, Verdict},
    seal,
};

/// So long nobody is there at all until that is said.
const NOBODY: Duration = Duration::from_secs(3);
/// So long whoever is there may take until he says something. A machine between two runs takes less.
const GREETS: Duration = Duration::from_secs(2);
/// So long a connection may take.
const CONNECTS: Duration = Duration::from_secs(1);
/// How long nobody is called when it was in vain.
const AGAIN: Duration = Duration::from_millis(100);

/// Why one call was in vain.
enum InVain {
    /// Nobody is there.
    Nobody(std::io::Error),
    /// Somebody is there who says nothing, or not all.
    Silent,
    /// All places are taken.
    Full,
    /// It will be in vain again.
    For(LinkError),
}

/// Calls until somebody lets us in.
///
/// # Errors
/// Why nobody does, with the remedy: [`LinkError::Input`], [`LinkError::Refused`] or [`LinkError::Nobody`].
pub fn call(at: &str, secret: &Secret, role: Role, patience: Duration) -> Result<TcpStream, LinkError> {
    let deadline = Moment::now().after(patience);
    let mut nobody = Moment::now().after(NOBODY);
    loop {
        let left = deadline.since(Moment::now()).max(AGAIN);
        let why = match once(at, secret, role, left) {
            Ok(stream) => return Ok(stream),
            Err(why) => why,
        };
        let over = match why {
            InVain::For(error) => return Err(error),
            InVain::Nobody(_) => nobody.passed(),
            InVain::Silent | InVain::Full => {
                nobody = Moment::now().after(NOBODY);
                false
            }
        };
        if over || deadline.passed() {
            return Err(told(at, role, &why));
        }
        sleep_until(Moment::now().after(AGAIN));
    }
}

/// What is said when there is no patience left.
fn told(at: &str, role: Role, why: &InVain) -> LinkError {
    match why {
        InVain::Nobody(error) => LinkError::Nobody(format!(
            "nobody answers at {at}: {error}\nhelp: start `pitchlock serve --listen {at}` there, and see that no firewall is \
             between"
        )),
        InVain::Full => LinkError::Refused(match role {
            Role::Operator => format!(
                "all places for operators at {at} are taken\nhelp: end another `pitchlock run --at`, `panel --at` or \
                 `doctor --at` that is there"
            ),
            Role::Hall => {
                format!("all places for halls at {at} are taken\nhelp: end another `pitchlock hall`")
            }
        }),
        InVain::Silent | InVain::For(_) => LinkError::Nobody(format!(
            "whoever listens at {at} says nothing\nhelp: see that it is `pitchlock serve`, of the same version, and \
             that it is not held up"
        )),
    }
}

/// Calls once.
fn once(at: &str, secret: &Secret, role: Role, most: Duration) -> Result<TcpStream, InVain> {
    let wrong = |error: std::io::Error| {
        let help = match error.kind() {
            ErrorKind::InvalidInput => "HOST:PORT, as in 10.0.0.2:7447",
            _ => "no computer of this name is known here: give its address, as in 10.0.0.2:7447",
        };
        InVain::For(LinkError::Input(format!("{at}: {error}\nhelp: {help}")))
    };
    let all: Vec<SocketAddr> = at.to_socket_addrs().map_err(wrong)?.collect();
    let mut nobody = std::io::Error::from(ErrorKind::AddrNotAvailable);
    let connected = all.iter().find_map(|address| {
        let stream = TcpStream::connect_timeout(address, CONNECTS.min(most));
        stream.map_err(|error| nobody = error).ok()
    });
    let mut stream = connected.ok_or(InVain::Nobody(nobody))?;
    let silent = |_| InVain::Silent;
    let deadline = Moment::now().after(GREETS.min(most));
    stream.set_write_timeout(Some(GREETS)).map_err(silent)?;
    let mut greeting = [0; GREETING];
    all_of(&mut stream, &mut greeting, deadline).map_err(silent)?;
    let other = || {
        InVain::For(LinkError::Refused(format!(
            "who answers at {at} is not a pitchlock, or one of another version\nhelp: --at names the address at which \
             `pitchlock serve --listen` waits, of the same version"
        )))
    };
    let own = seal::nonce().map_err(InVain::For)?;
    let greeted = Greeted::by(&greeting, own.to_le_bytes()).ok_or_else(other)?;
    stream.write_all(&greeted.proof(role, secret)).map_err(silent)?;
    let mut verdict = [0; VERDICT];
    all_of(&mut stream, &mut verdict, deadline).map_err(silent)?;
    match greeted.verdict(&verdict, secret).ok_or_else(other)? {
        Verdict::Welcome => Ok(stream),
        Verdict::Full => Err(InVain::Full),
        Verdict::OtherKey => Err(InVain::For(LinkError::Refused(format!(
            "{at} has another key\nhelp: copy the file that --key names there to this host"
        )))),
    }
}

/// Reads all of this in time, however slowly it comes.
fn all_of(stream: &mut TcpStream, all: &mut [u8], deadline: Moment) -> std::io::Result<()> {
    let mut have = 0;
    while have < all.len() {
        let left = deadline.since(Moment::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut all[have..])? {
            0 => return Err(ErrorKind::UnexpectedEof.into()),
            more => have += more,
        }
    }
    Ok(())
}
