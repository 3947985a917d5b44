//! One WebSocket. Out: what changed, 25 times a second at most, answers, pictures of the scope. In:
//! documents as `/api/do` takes them, and settings of the scope. One that does not read is closed, and costs
//! nobody else anything. Documents that come faster than they are answered wait in the socket: none is lost,
//! and a hold behind many others is taken in its turn.

use std::{sync::Arc, time::Duration};

use axum::extract::ws::{Message, WebSocket};
use serde_json::{Value, json};
use tokio::{
    sync::{OwnedSemaphorePermit, mpsc},
    time::{MissedTickBehavior, interval, timeout},
};

use super::{house::House, state::State};
use crate::scope::Scope;

/// Between two looks at the state.
pub(crate) const BEAT: Duration = Duration::from_millis(40);
/// Between two pictures of the scope.
const LOOK: Duration = Duration::from_millis(100);
/// So long one may take for a message before it is given up.
const READ_TIME: Duration = Duration::from_secs(10);
/// Documents of one socket that wait for their answers; the next one is read when there is one.
const MOST_WAITING: usize = 16;

/// Serves it to its end.
pub(crate) async fn live(mut socket: WebSocket, house: &Arc<House>) {
    let mut watch = house.watch();
    let mut seen = State::default();
    let mut beat = interval(BEAT);
    beat.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let (answer, mut answers) = mpsc::channel::<Value>(MOST_WAITING);
    let (mut scope, mut room) = (Scope::default(), None);
    let mut looks = interval(LOOK);
    looks.set_missed_tick_behavior(MissedTickBehavior::Delay);
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
                Message::text(news.to_string())
            }
            _ = looks.tick(), if scope.is_open() => {
                let picture = scope.picture(&house.ring());
                let Some(picture) = picture else { continue };
                Message::binary(picture)
            }
            Some(news) = answers.recv() => Message::text(news.to_string()),
            message = socket.recv(), if answer.capacity() > 0 => match message {
                Some(Ok(Message::Text(text))) => match scope.set(&text, &house.ring()) {
                    Some(told) => Message::text(with_room(told, &mut scope, &mut room, house).to_string()),
                    None => {
                        // There is a place: nobody else takes one.
                        let Ok(place) = answer.clone().try_reserve_owned() else { return };
                        let house = Arc::clone(house);
                        tokio::spawn(async move { place.send(house.ask(text.as_bytes()).await) });
                        continue;
                    }
                },
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => continue,
                // The end; bytes; and what breaks the rules of WebSockets.
                _ => return,
            },
        };
        let sent = timeout(READ_TIME, socket.send(news)).await;
        if !matches!(sent, Ok(Ok(()))) {
            return;
        }
    }
}

/// A scope is drawn as long as not too many are: what somebody is told who has set one.
fn with_room(
    told: Value,
    scope: &mut Scope,
    room: &mut Option<OwnedSemaphorePermit>,
    house: &House,
) -> Value {
    *room = scope
        .is_open()
        .then(|| room.take().or_else(|| Arc::clone(&house.scopes).try_acquire_owned().ok()))
        .flatten();
    if room.is_some() || !scope.is_open() {
        return told;
    }
    *scope = Scope::default();
    json!({ "scope": { "refused": "too-many", "why": "too many scopes are open: close one" } })
}
