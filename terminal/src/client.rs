//! A WebSocket to a panel. In: its address and secret, requests. Out: documents. Nothing waits but the
//! beginning.

use std::{
    io::ErrorKind,
    net::{TcpStream, ToSocketAddrs as _},
    str::FromStr,
    time::Duration,
};

use serde_json::Value;
use tungstenite::{ClientRequestBuilder, Error, Message, WebSocket, http::Uri, protocol::WebSocketConfig};

/// Who has not answered by then is not there.
const PATIENCE: Duration = Duration::from_secs(3);
/// Most bytes of a message: a state with a long program and the way of its tool.
const MOST_BYTES: usize = 16 << 20;
/// By this name the panel speaks.
const PROTOCOL: &str = "pitchlock.panel.1";

/// Where a panel is, and its secret: `http://127.0.0.1:35075/#ecf3660c…`, as it is printed.
#[derive(Clone, PartialEq)]
pub struct At {
    address: String,
    token: String,
}

impl std::fmt::Debug for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "http://{}/", self.address)
    }
}

impl FromStr for At {
    type Err = String;

    fn from_str(text: &str) -> Result<At, String> {
        let parts = text.trim().strip_prefix("http://").and_then(|rest| rest.split_once('#'));
        let (address, token) = parts
            .map(|(address, token)| (address.trim_end_matches('/'), token))
            .filter(|(address, token)| {
                let plain = |letter: char| letter.is_ascii_alphanumeric() || ".:[]-".contains(letter);
                let secret = !token.is_empty() && token.chars().all(|letter| letter.is_ascii_hexdigit());
                address.contains(':') && address.chars().all(plain) && secret
            })
            .ok_or("is not the address of a panel with its secret: http://127.0.0.1:35075/#ecf3660c…")?;
        Ok(At { address: address.into(), token: token.into() })
    }
}

/// A panel that answers.
#[derive(Debug)]
pub struct Client(WebSocket<TcpStream>);

impl Client {
    /// Connects; takes as long as the panel does, 3 s for each step at most.
    ///
    /// # Errors
    /// Nobody is there, or lets nobody in by this secret.
    pub fn connect(at: &At) -> Result<Client, String> {
        let failed = |error: &dyn std::fmt::Display| format!("{at:?}: {error}");
        let place = at.address.to_socket_addrs().map_err(|error| failed(&error))?.next();
        let place = place.ok_or_else(|| failed(&"there is no such address"))?;
        let stream = TcpStream::connect_timeout(&place, PATIENCE).map_err(|error| failed(&error))?;
        let set = stream
            .set_nodelay(true)
            .and_then(|()| stream.set_read_timeout(Some(PATIENCE)))
            .and_then(|()| stream.set_write_timeout(Some(PATIENCE)));
        set.map_err(|error| failed(&error))?;
        let uri: Uri = format!("ws://{}/api/live", at.address).parse().map_err(|error| failed(&error))?;
        let request = ClientRequestBuilder::new(uri)
            .with_header("Authorization", format!("Bearer {}", at.token))
            .with_sub_protocol(PROTOCOL);
        let bounds =
            WebSocketConfig::default().max_message_size(Some(MOST_BYTES)).max_frame_size(Some(MOST_BYTES));
        let opened = tungstenite::client::client_with_config(request, stream, Some(bounds));
        let (socket, _) = opened.map_err(|error| match error {
            tungstenite::HandshakeError::Failure(Error::Http(answer)) if answer.status() == 401 => failed(
                &"the secret is not that of this panel: it stands behind # in the address that was printed",
            ),
            error => failed(&error),
        })?;
        socket.get_ref().set_nonblocking(true).map_err(|error| failed(&error))?;
        Ok(Client(socket))
    }

    /// The next document, if one has come.
    ///
    /// # Errors
    /// The panel is gone.
    pub fn news(&mut self) -> Result<Option<Value>, String> {
        loop {
            match self.0.read() {
                Ok(Message::Text(text)) => {
                    return serde_json::from_str(&text).map(Some).map_err(|error| error.to_string());
                }
                Ok(_) => {}
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => return Ok(None),
                Err(error) => return Err(error.to_string()),
            }
        }
    }

    /// Sends a request; what the socket does not take now goes with the next one.
    ///
    /// # Errors
    /// The panel is gone.
    pub fn say(&mut self, document: &Value) -> Result<(), String> {
        match self.0.send(Message::text(document.to_string())) {
            Ok(()) => Ok(()),
            Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            Err(error) => Err(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_a_place_and_a_secret_and_does_not_show_it() {
        let at: At = " http://127.0.0.1:35075/#ecf3660ce7c2\n".parse().expect("an address");
        assert_eq!((at.address.as_str(), at.token.as_str()), ("127.0.0.1:35075", "ecf3660ce7c2"));
        assert_eq!(format!("{at:?}"), "http://127.0.0.1:35075/");
        assert!("http://[::1]:80/#ab".parse::<At>().is_ok());
        for wrong in [
            "",
            "127.0.0.1:1/#ab",
            "http://127.0.0.1:1/",
            "http://127.0.0.1:1/#",
            "http://127.0.0.1/#ab",
            "http://a b:1/#ab",
            "http://127.0.0.1:1/#ab\r\nHost: x",
            "http://127.0.0.1:1/#xy",
        ] {
            let why = wrong.parse::<At>().expect_err(wrong);
            assert!(why.contains("with its secret"), "{why}");
        }
    }
}
