//! What the server holds for whoever comes: what is seen, who holds the keys, presses that wait for their
//! cycle.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use serde_json::{Map, Value, json};
use tokio::{
    sync::{Semaphore, mpsc, oneshot, watch},
    time::timeout,
};

use super::state::State;
use crate::{
    Save,
    press::{self, Asked, Refusal},
    scope::Ring,
    seen,
    wire::{FromPanel, ToPanel},
};

/// Most WebSockets at once.
const MOST_SOCKETS: usize = 32;
/// Most scopes at once.
const MOST_SCOPES: usize = 8;
/// Most files that are written at once.
const MOST_FILES: usize = 1;
/// So long a press waits for its cycle.
const ANSWER_TIME: Duration = Duration::from_secs(3);

/// What became of a press.
type Answer = Result<u64, (String, String)>;

/// The house.
pub(crate) struct House {
    token: Mutex<String>,
    state: watch::Sender<State>,
    press: mpsc::Sender<FromPanel>,
    /// The last ticket, and who waits with which.
    waiting: Mutex<(u64, BTreeMap<u64, oneshot::Sender<Answer>>)>,
    seat: Mutex<Option<String>>,
    /// Places of WebSockets, of scopes, and of files that are being written.
    pub(crate) sockets: Arc<Semaphore>,
    pub(crate) scopes: Arc<Semaphore>,
    pub(crate) files: Arc<Semaphore>,
    /// What the scope shows, and how it is saved.
    ring: Mutex<Ring>,
    pub(crate) save: Save,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl House {
    /// One whose presses go there.
    pub(crate) fn new(press: mpsc::Sender<FromPanel>, save: Save) -> House {
        let (state, _) = watch::channel(State::default());
        let house = House {
            token: Mutex::default(),
            state,
            press,
            waiting: Mutex::default(),
            seat: Mutex::default(),
            sockets: Arc::new(Semaphore::new(MOST_SOCKETS)),
            scopes: Arc::new(Semaphore::new(MOST_SCOPES)),
            files: Arc::new(Semaphore::new(MOST_FILES)),
            ring: Mutex::default(),
            save,
        };
        house.state.send_modify(|state| state.set(seen::nothing()));
        house.seat(None);
        house
    }

    /// Takes what the launcher says.
    pub(crate) fn hear(&self, message: ToPanel) {
        match message {
            ToPanel::Token(token) => *locked(&self.token) = token,
            ToPanel::Set(fields) => self.state.send_modify(|state| state.set(fields)),
            ToPanel::Trail(points) => self.state.send_modify(|state| state.trail.go_on(points)),
            ToPanel::NoTrail => self.state.send_modify(|state| state.trail.begin()),
            ToPanel::Scope { columns, cycle_s, most } => self.ring().begin(columns, cycle_s, most),
            // Their numbers come behind the message.
            ToPanel::Rows(_) => {}
            ToPanel::Taken { ticket, cycle } => self.answered(ticket, Ok(cycle)),
            ToPanel::Refused { ticket, code, why } => self.answered(ticket, Err((code, why))),
        }
    }

    /// Takes rows of the scope.
    pub(crate) fn rows(&self, bytes: &[u8]) {
        let numbers: Vec<f64> = bytes.as_chunks().0.iter().copied().map(f64::from_le_bytes).collect();
        self.ring().take(&numbers);
    }

    /// What the scope shows.
    pub(crate) fn ring(&self) -> MutexGuard<'_, Ring> {
        locked(&self.ring)
    }

    /// Whether this is the secret. How long that takes tells nothing but its length.
    pub(crate) fn knows(&self, told: &str) -> bool {
        let token = locked(&self.token);
        let differs =
            token.bytes().zip(told.bytes()).fold(0, |differs, (one, other)| differs | (one ^ other));
        !token.is_empty() && token.len() == told.len() && differs == 0
    }

    /// What is seen, and what will be.
    pub(crate) fn watch(&self) -> watch::Receiver<State> {
        self.state.subscribe()
    }

    /// Somebody holds the keys, or nobody, and everybody sees it.
    fn seat(&self, name: Option<String>) {
        let fields = Map::from_iter([("seat".to_owned(), json!(name))]);
        *locked(&self.seat) = name;
        self.state.send_modify(|state| state.set(fields));
    }

    fn answered(&self, ticket: u64, answer: Answer) {
        if let Some(waits) = locked(&self.waiting).1.remove(&ticket) {
            // Whoever waited for it may have gone.
            let _ = waits.send(answer);
        }
    }

    /// Does what a document asks for, and answers it: `{id, cycle}` or `{id, refused, why}`.
    pub(crate) async fn ask(&self, text: &[u8]) -> Value {
        let (id, asked) = press::read(text);
        match self.done(asked).await {
            Ok(cycle) => json!({ "id": id, "cycle": cycle }),
            Err(Refusal { code, why }) => json!({ "id": id, "refused": code, "why": why }),
        }
    }

    async fn done(&self, asked: Result<(String, Asked), Refusal>) -> Result<u64, Refusal> {
        let (name, asked) = asked?;
        match asked {
            Asked::TakeSeat => self.seat(Some(name)),
            Asked::LeaveSeat => {
                self.holds_the_seat(&name)?;
                self.seat(None);
            }
            Asked::Press(press) => {
                self.holds_the_seat(&name)?;
                return self.pass_on(press).await;
            }
        }
        Ok(self.cycle())
    }

    /// The newest cycle that is seen.
    fn cycle(&self) -> u64 {
        self.state.borrow().fields.get("cycle").and_then(|cycle| cycle.as_u64()).unwrap_or_default()
    }

    fn holds_the_seat(&self, name: &str) -> Result<(), Refusal> {
        match locked(&self.seat).as_deref() {
            Some(holder) if holder == name => Ok(()),
            Some(holder) => {
                let why =
                    format!("{holder} holds the keys; take-seat takes them over, and everybody sees it");
                Err(Refusal::new("not-your-seat", why))
            }
            None => Err(Refusal::new("no-seat", "nobody holds the keys; take-seat takes them")),
        }
    }

    /// The launcher passes it on to the machine, which says in which cycle.
    async fn pass_on(&self, press: FromPanel) -> Result<u64, Refusal> {
        let (ticket, answer) = {
            let (send, answer) = oneshot::channel();
            let mut waiting = locked(&self.waiting);
            waiting.0 += 1;
            let ticket = waiting.0;
            waiting.1.insert(ticket, send);
            (ticket, answer)
        };
        let sent = self.press.try_send(FromPanel { ticket, ..press });
        let answer = match sent {
            Ok(()) => timeout(ANSWER_TIME, answer).await,
            Err(_) => {
                locked(&self.waiting).1.remove(&ticket);
                return Err(Refusal::new("too-many", "presses come faster than the machine takes them"));
            }
        };
        match answer {
            Ok(Ok(Ok(cycle))) => Ok(cycle),
            Ok(Ok(Err((code, why)))) => Err(Refusal { code: known(&code), why }),
            Ok(Err(_)) | Err(_) => {
                locked(&self.waiting).1.remove(&ticket);
                let seconds = ANSWER_TIME.as_secs();
                let why = format!(
                    "the machine has not said within {seconds} s that it has taken it: look at its state before \
                     you press again"
                );
                Err(Refusal::new("no-answer", why))
            }
        }
    }
}

/// The codes that launchers refuse by.
fn known(code: &str) -> &'static str {
    const CODES: [&str; 8] = [
        "not-running",
        "too-many",
        "not-now",
        "not-referenced",
        "bad-value",
        "bad-block",
        "bad-offset",
        "bad-line",
    ];
    CODES.into_iter().find(|known| *known == code).unwrap_or("refused")
}

#[cfg(test)]
mod tests {
    use tokio::runtime::{Builder, Runtime};

    use super::*;

    fn house() -> (Arc<House>, mpsc::Receiver<FromPanel>, Runtime) {
        let (press, presses) = mpsc::channel(2);
        let runtime = Builder::new_current_thread().enable_time().build().expect("a runtime");
        (Arc::new(House::new(press, |_, _, _| Err("not here".into()))), presses, runtime)
    }

    #[test]
    fn one_seat_holds_the_keys_and_is_taken_over_visibly() {
        let (house, mut presses, runtime) = house();
        let ask = |word: &str, name: &str| {
            let text = format!("{{\"id\":1,\"do\":\"{word}\",\"as\":\"{name}\"}}");
            let answer = runtime.block_on(house.ask(text.as_bytes()));
            answer["refused"].as_str().map_or_else(|| answer["cycle"].to_string(), str::to_owned)
        };
        let seat = || house.watch().borrow().fields["seat"].as_str().map(str::to_owned);
        assert_eq!((ask("hold", "a").as_str(), seat()), ("no-seat", None));
        house.hear(ToPanel::Set(Map::from_iter([("cycle".to_owned(), json!(17))])));
        assert_eq!((ask("take-seat", "a").as_str(), seat().as_deref()), ("17", Some("a")));
        assert_eq!(ask("hold", "b"), "not-your-seat");
        assert!(presses.try_recv().is_err(), "nothing has gone to the machine");
        assert_eq!((ask("take-seat", "b").as_str(), seat().as_deref()), ("17", Some("b")));
        assert_eq!(
            (ask("hold", "a").as_str(), ask("leave-seat", "a").as_str()),
            ("not-your-seat", "not-your-seat")
        );
        assert_eq!((ask("leave-seat", "b").as_str(), seat()), ("17", None));
    }

    #[test]
    fn a_press_has_the_cycle_that_the_launcher_tells_or_its_refusal() {
        let (house, mut presses, runtime) = house();
        runtime.block_on(async {
            house.ask(b"{\"id\":0,\"do\":\"take-seat\",\"as\":\"a\"}").await;
            let ask = |text: &'static str| {
                let house = Arc::clone(&house);
                tokio::spawn(async move { house.ask(text.as_bytes()).await })
            };
            let one = ask("{\"id\":1,\"do\":\"hold\",\"as\":\"a\"}");
            let other = ask("{\"id\":2,\"do\":\"feed-override\",\"value\":60,\"as\":\"a\"}");
            let [hold, turn] = [presses.recv().await, presses.recv().await].map(Option::unwrap_or_default);
            assert_eq!((hold.kind, turn.kind, turn.value), (4, 2, 60.0));
            house.hear(ToPanel::Taken { ticket: turn.ticket, cycle: 99 });
            house.hear(ToPanel::Taken { ticket: 4711, cycle: 1 });
            let (code, why) = ("not-running".into(), "nothing runs".into());
            house.hear(ToPanel::Refused { ticket: hold.ticket, code, why });
            assert_eq!(other.await.expect("it ends"), json!({ "id": 2, "cycle": 99 }));
            let refused = json!({ "id": 1, "refused": "not-running", "why": "nothing runs" });
            assert_eq!(one.await.expect("it ends"), refused);
            let many: Vec<_> = (0..4).map(|_| ask("{\"id\":3,\"do\":\"stop\",\"as\":\"a\"}")).collect();
            let mut told = Vec::new();
            for one in many {
                told.push(one.await.expect("it ends")["refused"].as_str().unwrap_or_default().to_owned());
            }
            told.sort();
            assert_eq!(told, ["no-answer", "no-answer", "too-many", "too-many"], "two wait, the rest cannot");
            assert!(locked(&house.waiting).1.is_empty(), "nothing is left of them");
        });
    }

    #[test]
    fn a_secret_is_known_by_all_of_it() {
        let (house, ..) = house();
        assert!(!house.knows(""), "before there is one nobody knows it");
        house.hear(ToPanel::Token("0123456789abcdef".into()));
        for wrong in ["", "0123456789abcde", "0123456789abcdeF", "0123456789abcdef0", "1123456789abcdef"] {
            assert!(!house.knows(wrong), "{wrong}");
        }
        assert!(house.knows("0123456789abcdef"));
    }
}
