//! What the panel costs and how soon it acts. What the clock says is printed, not judged: docs/panel.md has
//! the figures and the command. Judged is what does not hang on the computer: the size of the pages, that a
//! press has its cycle, that the scope misses none.

use std::{
    io::{Read as _, Write as _},
    net::TcpListener,
};

use process::ipc::time::Moment;
use serde_json::{Value, json};

use super::{browser::Browser, client::Panel};
use crate::shop::{Place, until};

/// A share of sorted values.
fn of(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

/// Seconds of a processor that a process has had; of Linux, where a tick is 10 ms.
fn processor_s(pid: u32) -> f64 {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).expect("it lives");
    let fields: Vec<_> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |at: usize| fields.get(at).and_then(|text| text.parse::<f64>().ok()).expect("ticks");
    (ticks(11) + ticks(12)) / 100.0
}

/// Reads the pictures of a scope over the whole minute: how many, and the most cycles that one misses.
fn watches(panel: &Panel, until: Moment) -> (u64, u64) {
    let mut socket = panel.socket();
    let signals = json!(["z_servo_error", "x_servo_error", "spindle_rpm"]);
    socket.say(
        &json!({ "scope": { "signals": signals, "x": "time", "mode": "roll", "span": 60, "points": 1000 } }),
    );
    let (mut pictures, mut missing) = (0, 0);
    while !until.passed() {
        if let Some(head) = socket.picture() {
            pictures += 1;
            missing = missing.max(head["missing"].as_u64().expect("a number"));
        }
    }
    (pictures, missing)
}

/// What one sees who watches and presses.
#[derive(Default)]
struct Seen {
    /// From a press to its answer, s.
    answered: Vec<f64>,
    /// When a readout came, since the beginning, and its time on the machine, s.
    readouts: Vec<[f64; 2]>,
    /// The machine was at time 0 no sooner than this, s since the beginning.
    zero: f64,
}

/// Presses one after the other, and reads what comes.
fn presses(panel: &Panel, until: Moment) -> Seen {
    let mut socket = panel.socket();
    let begun = Moment::now();
    let now = || begun.elapsed().as_secs_f64();
    let mut seen = Seen { zero: f64::MIN, ..Seen::default() };
    let (mut number, mut waits) = (0, None);
    let mut before = 0;
    while !until.passed() {
        let news = socket.next().expect("it lives");
        if news["id"].is_u64() {
            let sent = waits.take().expect("one was sent");
            let cycle = news["cycle"].as_u64().unwrap_or_else(|| panic!("{news}"));
            assert!(cycle > before, "every press has a cycle of its own: {news}");
            before = cycle;
            seen.answered.push(now() - sent);
            // The machine came to that cycle after the press was sent.
            seen.zero = seen.zero.max(sent - cycle as f64 * 5e-4);
        } else if let Some(time_s) = news["time_s"].as_f64() {
            seen.readouts.push([now(), time_s]);
            if waits.is_none() {
                number += 1;
                waits = Some(now());
                let value = 50 + number % 50;
                socket.say(&json!({ "id": number, "do": "feed-override", "as": "test", "value": value }));
            }
        }
    }
    seen
}

#[test]
fn figures_of_the_panel() {
    let bytes: usize = panel::PAGES.iter().map(|(.., content)| content.len()).sum();
    assert!(bytes <= 250_000, "{bytes}");
    println!("pages: {bytes} bytes");
    let seconds = testing::count("PITCHLOCK_PANEL_S", 2);
    let place = Place::new();
    let panel = Panel::start(&place, &["panel", "--trace", "none"]);
    panel.press("take-seat");
    panel.press("by-hand");
    until("it is ready", || panel.state()["mode"] == "ready");
    let server = panel.server().expect("it is there");
    let (begun, end) = (processor_s(server), Moment::in_s(seconds as f64));
    let (mut seen, [one, other]) = std::thread::scope(|scope| {
        let watchers = [(); 2].map(|()| scope.spawn(|| watches(&panel, end)));
        (presses(&panel, end), watchers.map(|watcher| watcher.join().expect("it has watched")))
    });
    let load = (processor_s(server) - begun) / seconds as f64;
    let mut ages: Vec<_> = seen.readouts.iter().map(|[came, time_s]| came - seen.zero - time_s).collect();
    assert!(one.0 > 0 && other.0 > 0 && !ages.is_empty());
    println!("{seconds} s at pace 1: three who watch, two of them a scope of 60 s with 3 signals");
    let presses = seen.answered.len();
    let [median, most] = [0.5, 0.99].map(|share| 1e3 * of(&mut seen.answered, share));
    println!("press to cycle: {presses} presses, median {median:.1} ms, 99 % {most:.1} ms");
    let [median, most] = [0.5, 0.99].map(|share| 1e3 * of(&mut ages, share));
    println!(
        "age of a readout when it comes: {} readouts, median {median:.1} ms, 99 % {most:.1} ms",
        ages.len()
    );
    println!("server: {:.1} % of a processor", 100.0 * load);
    println!("scope: {} pictures, {} cycles missing at most", one.0 + other.0, one.1.max(other.1));
    assert_eq!((one.1, other.1), (0, 0), "cycles are missing");
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let one_word = one_word();
    // A browser of its own for each time, with an empty profile, that does nothing else any more.
    let tries = testing::count("PITCHLOCK_PAINTS", 1);
    let mut firsts = [("this page", &url, Vec::new()), ("one word", &one_word, Vec::new())];
    for width in (1200..).step_by(2).take(tries as usize) {
        for (more, (_, url, at)) in (0..).zip(&mut firsts) {
            let Some(mut browser) = Browser::open(&place, "about:blank", width + more) else { return };
            browser.go(url);
            at.push(painted(&mut browser));
            if more == 0 {
                browser.value("window.before = true; location.reload()");
                println!("first paint of a page that is opened again: {:.0} ms", painted(&mut browser));
            }
        }
    }
    for (what, _, mut at) in firsts {
        let [least, median, most] = [0.0, 0.5, 1.0].map(|share| of(&mut at, share));
        println!(
            "first paint of {what} in a new browser, {tries} times: {least:.0}, {median:.0}, {most:.0} ms"
        );
    }
}

/// The address of a page with one word: what is left for any page.
fn one_word() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("it has one");
    let serves = move || {
        let page = "<p id=link>live</p>";
        let head = "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nConnection: close\r\n";
        for mut stream in listener.incoming().flatten() {
            // What the browser asks for is always the same.
            let _ = stream.read(&mut [0; 4096]);
            let _ = write!(stream, "{head}Content-Length: {}\r\n\r\n{page}", page.len());
        }
    };
    std::thread::Builder::new().spawn(serves).expect("a thread");
    format!("http://{address}/")
}

/// When the page was painted first, ms since it was asked for.
fn painted(browser: &mut Browser) -> f64 {
    until("it is another page", || browser.value("window.before ?? null").is_null());
    browser.until_text("link", "live");
    let paint = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime";
    let mut at = Value::Null;
    until("it is painted", || {
        at = browser.value(paint);
        at.is_number()
    });
    at.as_f64().expect("a time")
}
