//! The server: one thread, HTTP/1.1 and WebSockets, on a socket that the launcher has opened. In: the link to
//! the launcher, and who comes by the network. It ends when the launcher does.
//!
//! Whoever comes is bounded before anything else: so many connections, so long for a request, so many bytes.
//! Each connection is for one request, or becomes one WebSocket.

mod api;
mod guard;
mod house;
mod live;
mod state;

use std::{
    io,
    net::{SocketAddr, TcpListener as StdListener},
    os::unix::net::UnixStream as StdStream,
    sync::Arc,
    time::Duration,
};

use axum::Router;
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use tokio::{
    io::{AsyncBufReadExt as _, AsyncReadExt as _, AsyncWriteExt as _, BufReader},
    net::{TcpListener, TcpStream, UnixStream, unix::OwnedReadHalf},
    sync::{Semaphore, mpsc},
    time::timeout,
};

use crate::{
    Save,
    wire::{FromPanel, ToPanel},
};
use house::House;

/// Most connections at once whose request has not been answered.
const MOST_CONNECTIONS: usize = 64;
/// So long may the head of a request take.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// So long may a request take with all that belongs to it.
const REQUEST_TIME: Duration = Duration::from_secs(15);
/// Most bytes of the head of a request.
const MOST_HEAD: usize = 16 << 10;
/// Most bytes of a message of the launcher.
const MOST_MESSAGE: u64 = 16 << 20;
/// Most numbers of rows at once.
const MOST_NUMBERS: usize = 1 << 20;
/// Looks of whoever looks behind the last message of the launcher.
const LAST_LOOKS: u32 = 3;
/// Presses that wait for the launcher.
const MOST_PRESSES: usize = 64;

/// Serves until the launcher ends.
///
/// # Errors
/// The system refuses what a server needs, or the launcher sends what is not understood.
pub fn serve(listener: StdListener, launcher: StdStream, save: Save) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    launcher.set_nonblocking(true)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    runtime.block_on(async {
        let listener = TcpListener::from_std(listener)?;
        let (from, mut to) = UnixStream::from_std(launcher)?.into_split();
        let (press, mut presses) = mpsc::channel::<FromPanel>(MOST_PRESSES);
        let house = Arc::new(House::new(press, save));
        tokio::spawn(async move {
            while let Some(press) = presses.recv().await {
                let mut line = serde_json::to_vec(&press).unwrap_or_default();
                line.push(b'\n');
                if to.write_all(&line).await.is_err() {
                    break;
                }
            }
        });
        let mut lines = BufReader::new(from);
        // First comes the secret: until then nobody is let in, and whoever comes waits outside.
        if !hear(&mut lines, &house).await? {
            return Ok(());
        }
        let all = async {
            while hear(&mut lines, &house).await? {}
            // Whoever looks sees what was said last.
            tokio::time::sleep(LAST_LOOKS * live::BEAT).await;
            Ok(())
        };
        tokio::select! {
            ended = all => ended,
            () = accept(&listener, &house) => Ok(()),
        }
    })
}

/// Takes the next message of the launcher. False if it has ended.
async fn hear(launcher: &mut BufReader<OwnedReadHalf>, house: &House) -> io::Result<bool> {
    let mut line = Vec::new();
    if launcher.take(MOST_MESSAGE).read_until(b'\n', &mut line).await? == 0 {
        return Ok(false);
    }
    match serde_json::from_slice::<ToPanel>(&line) {
        Ok(ToPanel::Rows(count)) => {
            let mut bytes = vec![0; count.min(MOST_NUMBERS) * size_of::<f64>()];
            // The end of a launcher that died while it wrote.
            if launcher.read_exact(&mut bytes).await.is_err() {
                return Ok(false);
            }
            house.rows(&bytes);
        }
        Ok(message) => house.hear(message),
        // The end of a launcher that died while it wrote.
        Err(_) if line.last() != Some(&b'\n') => return Ok(false),
        Err(error) => return Err(io::Error::new(io::ErrorKind::InvalidData, error)),
    }
    Ok(true)
}

/// Lets in whoever comes, as long as there is room: who comes then waits outside.
async fn accept(listener: &TcpListener, house: &Arc<House>) {
    let room = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    let router = api::router(Arc::clone(house));
    while let Ok(place) = Arc::clone(&room).acquire_owned().await {
        // What fails here is over, or there are too few files: the next one may come in all the same.
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(live::BEAT).await;
            continue;
        };
        let Ok(local) = stream.local_addr() else { continue };
        let router = router.clone();
        tokio::spawn(async move {
            // A request that takes too long, or that is none, is not answered any more.
            let _ = timeout(REQUEST_TIME, connection(stream, local, router)).await;
            drop(place);
        });
    }
}

/// One request. A WebSocket goes on by itself.
async fn connection(stream: TcpStream, local: SocketAddr, router: Router) {
    let router = router.layer(axum::Extension(guard::Here(local)));
    let _ = stream.set_nodelay(true);
    // Whoever breaks the rules of HTTP has been told by hyper, as far as that was possible.
    let _ = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIME)
        .max_buf_size(MOST_HEAD)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades()
        .await;
}
