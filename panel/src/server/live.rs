//! One WebSocket. Out: what changed, 25 times a second at most, and answers. In: documents as `/api/do` takes
//! them. One that does not read is closed, and costs nobody else anything.

use std::{sync::Arc, time::Duration};

use axum::extract::ws::{Message, WebSocket};
use serde_json::{Value, json};
use tokio::{
    sync::mpsc,
    time::{MissedTickBehavior, interval, timeout},
};

use super::{house::House, state::State};

/// Between two looks at the state.
pub(crate) const BEAT: Duration = Duration::from_millis(40);
/// So long one may take for a message before it is given up.
const READ_TIME: Duration = Duration::from_secs(10);
/// Documents of one socket that wait for their answers.
const MOST_WAITING: usize = 16;

/// Serves it to its end.
pub(crate) async fn live(mut socket: WebSocket, house: &Arc<House>) {
    let mut watch = house.watch();
    let mut seen = State::default();
    let mut beat = interval(BEAT);
    beat.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let (answer, mut answers) = mpsc::channel::<Value>(MOST_WAITING);
    watch.mark_changed();
    loop {
        let news = tokio::select! {
            _ = beat.tick() => {
                if !watch.has_changed().unwrap_or(false) {
                    continue;
                }
                let state = watch.borrow_and_update().clone();
                let news = state.since(&seen);
                seen = state;
                let Some(news) = news else { continue };
                news
            }
            Some(news) = answers.recv() => news,
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => match answer.clone().try_reserve_owned() {
                    Ok(place) => {
                        let house = Arc::clone(house);
                        tokio::spawn(async move { place.send(house.ask(text.as_bytes()).await) });
                        continue;
                    }
                    Err(_) => json!({ "id": null, "refused": "too-many", "why": "wait for the answers" }),
                },
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => continue,
                // The end; bytes; and what breaks the rules of WebSockets.
                _ => return,
            },
        };
        let sent = timeout(READ_TIME, socket.send(Message::text(news.to_string()))).await;
        if !matches!(sent, Ok(Ok(()))) {
            return;
        }
    }
}
