//! Two sockets that are one way: what comes by the one goes out by the other. In: one on the network, one of
//! this host. Out: bytes, until either ends.

use std::{
    io::{Read, Write},
    net::{Shutdown, TcpStream},
    os::unix::net::UnixStream,
    thread::Builder,
    time::Duration,
};

use crate::LinkError;

/// Somebody on the network has taken nothing for so long: he is given up. Longer than the silence that ends a
/// session, so that this alone decides nothing.
const STUCK: Duration = Duration::from_secs(3);
/// Most bytes that are read at once.
const BLOCK: usize = 64 << 10;

/// Carries bytes both ways, in threads of their own. `ended` is called when nothing goes by here any more.
///
/// # Errors
/// The system has no thread or no socket for it.
pub fn join(
    net: TcpStream,
    here: UnixStream,
    ended: impl FnOnce() + Send + 'static,
) -> Result<(), LinkError> {
    let wrong = |error: std::io::Error| LinkError::broken("a connection", error);
    net.set_nodelay(true).map_err(wrong)?;
    net.set_read_timeout(None).map_err(wrong)?;
    net.set_write_timeout(Some(STUCK)).map_err(wrong)?;
    let ends = |net: &TcpStream, here: &UnixStream| {
        // Either may be gone already.
        let _ = net.shutdown(Shutdown::Both);
        let _ = here.shutdown(Shutdown::Both);
    };
    let (other_net, other_here) = (net.try_clone().map_err(wrong)?, here.try_clone().map_err(wrong)?);
    let inwards = move || {
        carry(&other_net, &other_here);
        ends(&other_net, &other_here);
    };
    let outwards = move || {
        carry(&here, &net);
        ends(&net, &here);
        ended();
    };
    Builder::new().name("joined-in".into()).spawn(inwards).map_err(wrong)?;
    Builder::new().name("joined-out".into()).spawn(outwards).map(drop).map_err(wrong)
}

/// One way, to its end.
fn carry(mut from: impl Read, mut to: impl Write) {
    let mut block = vec![0; BLOCK];
    loop {
        match from.read(&mut block) {
            Ok(count @ 1..) => {
                if to.write_all(&block[..count]).is_err() {
                    return;
                }
            }
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            _ => return,
        }
    }
}
