//! What is there: pages, the state, one place to ask for something, one WebSocket, files of the scope.

use std::{sync::Arc, time::Duration};

use axum::{
    Router,
    body::Bytes,
    extract::{DefaultBodyLimit, RawQuery, State, WebSocketUpgrade},
    http::{HeaderMap, StatusCode, header},
    middleware,
    response::{IntoResponse as _, Response},
    routing::{get, post},
};
use serde_json::Value;
use tokio::time::timeout;

use super::{
    guard::{PROTOCOL, guard},
    house::House,
    live, state,
};
use crate::PAGES;

/// Most bytes of a request's body, and of a message on a WebSocket.
pub(crate) const MOST_ASKED: usize = 1024;

/// So long at most is the first word of the launcher waited for: fields are null before.
const FIRST_STATE: Duration = Duration::from_secs(2);

/// The whole of it.
pub(crate) fn router(house: Arc<House>) -> Router {
    let mut router = Router::new()
        .route("/api/state", get(all))
        .route("/api/do", post(ask))
        .route("/api/live", get(live_socket))
        .route("/api/scope.csv", get(async |State(house), query| saved("csv", house, query).await))
        .route("/api/scope.mcap", get(async |State(house), query| saved("mcap", house, query).await));
    for (path, kind, content) in PAGES {
        router = router.route(path, get(async move || ([(header::CONTENT_TYPE, kind)], content)));
    }
    router
        .layer(DefaultBodyLimit::max(MOST_ASKED))
        .layer(middleware::from_fn_with_state(Arc::clone(&house), guard))
        .with_state(house)
}

/// All that is seen.
async fn all(State(house): State<Arc<House>>) -> Response {
    let mut seen = house.watch();
    // Right behind its start the server has not heard anything of the machine yet.
    let _ = timeout(FIRST_STATE, seen.wait_for(state::State::is_known)).await;
    let whole = seen.borrow().clone().whole();
    document(StatusCode::OK, &whole)
}

fn document(status: StatusCode, document: &Value) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], document.to_string()).into_response()
}

/// Does something.
async fn ask(State(house): State<Arc<House>>, headers: HeaderMap, body: Bytes) -> Response {
    let kind = headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    if kind.split(';').next().is_none_or(|kind| kind.trim() != "application/json") {
        let why = "Content-Type has to be application/json\n";
        return (StatusCode::UNSUPPORTED_MEDIA_TYPE, why).into_response();
    }
    let answer = house.ask(&body).await;
    let status = match answer["refused"].as_str() {
        None => StatusCode::OK,
        Some("bad-request" | "bad-value" | "bad-block" | "bad-offset" | "bad-line" | "unknown") => {
            StatusCode::BAD_REQUEST
        }
        Some("no-answer") => StatusCode::GATEWAY_TIMEOUT,
        Some("too-many") => StatusCode::TOO_MANY_REQUESTS,
        Some(_) => StatusCode::CONFLICT,
    };
    document(status, &answer)
}

/// Which control cycles go into a file, the last one among them.
struct Cycles {
    from: u64,
    to: u64,
}

/// A file of what the ring of the scope has of these cycles.
async fn saved(kind: &'static str, house: Arc<House>, query: RawQuery) -> Response {
    let Some(Cycles { from, to }) = query.0.as_deref().and_then(cycles) else {
        return (StatusCode::BAD_REQUEST, "?from=CYCLE&to=CYCLE says which\n").into_response();
    };
    let Ok(place) = Arc::clone(&house.files).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "another file is being written: wait for it\n")
            .into_response();
    };
    let (columns, rows) = {
        let ring = house.ring();
        (ring.columns().to_vec(), ring.part(ring.between(from as f64, to as f64 + 1.0)))
    };
    if rows.is_empty() {
        return (StatusCode::NOT_FOUND, "none of these cycles is kept\n").into_response();
    }
    let save = house.save;
    let made = tokio::task::spawn_blocking(move || (save)(kind, &columns, &rows)).await;
    drop(place);
    match made {
        Ok(Ok(bytes)) => ([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response(),
        Ok(Err(why)) => (StatusCode::INTERNAL_SERVER_ERROR, format!("{why}\n")).into_response(),
        Err(error) => (StatusCode::INTERNAL_SERVER_ERROR, format!("{error}\n")).into_response(),
    }
}

/// `from=1&to=2`.
fn cycles(query: &str) -> Option<Cycles> {
    let (from, to) = query.strip_prefix("from=")?.split_once("&to=")?;
    Some(Cycles { from: from.parse().ok()?, to: to.parse().ok()? })
}

/// Becomes a WebSocket.
async fn live_socket(State(house): State<Arc<House>>, upgrade: WebSocketUpgrade) -> Response {
    let Ok(place) = Arc::clone(&house.sockets).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many watch already\n").into_response();
    };
    let upgrade = upgrade.protocols([PROTOCOL]).max_message_size(MOST_ASKED).max_frame_size(MOST_ASKED);
    upgrade.on_upgrade(async move |socket| {
        live::live(socket, &house).await;
        drop(place);
    })
}
