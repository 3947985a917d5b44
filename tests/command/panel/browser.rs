//! The page in a real browser, driven by its own protocol: loads, shows, presses. Left out by name where
//! there is no Chromium.

use std::{
    fs,
    net::TcpStream,
    path::Path,
    process::{Child, Command, Stdio},
    time::Duration,
};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde_json::{Value, json};

use super::client::{Panel, Socket};
use crate::shop::{Place, example, until};

/// A browser without a screen.
pub(super) struct Browser {
    pub(super) process: Child,
    page: Socket,
    asked: u64,
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Browser {
    /// Opens an address, if there is a browser.
    pub(super) fn open(place: &Place, url: &str, width: u32) -> Option<Browser> {
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let there = |name: &&str| {
            let found =
                Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            found.is_ok_and(|status| status.success())
        };
        let Some(name) = names.into_iter().find(|name| there(name)) else {
            eprintln!("left out: the page in a browser: there is no Chromium on this computer");
            return None;
        };
        let profile = place.at(&format!("browser-{width}"));
        let process = Command::new(name)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
            .arg("--remote-debugging-port=0")
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg(format!("--window-size={width},900"))
            .arg(url)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts");
        let mut port = String::new();
        until("the browser listens", || {
            let text = fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
            port = text.lines().next().unwrap_or_default().to_owned();
            !port.is_empty()
        });
        let address = format!("127.0.0.1:{port}");
        let mut path = String::new();
        until("the page is there", || {
            let (_, text) = get(&address, "/json/list");
            let pages: Value = serde_json::from_str(&text).unwrap_or_default();
            let page = pages.as_array().and_then(|all| all.iter().find(|one| one["type"] == "page"));
            let page = page.and_then(|page| page["webSocketDebuggerUrl"].as_str());
            let found = page.and_then(|page| page.split_once(&port)).map(|(_, path)| path.to_owned());
            path = found.unwrap_or_default();
            !path.is_empty()
        });
        Some(Browser { process, page: Socket::open(&address, &path), asked: 0 })
    }

    /// Tells the browser to do something.
    fn tell(&mut self, method: &str, params: &Value) -> Value {
        self.asked += 1;
        let id = json!(self.asked);
        self.page.say(&json!({ "id": id, "method": method, "params": params }));
        self.page.answer(&id).expect("the browser lives")
    }

    /// The value of an expression in the page.
    pub(super) fn value(&mut self, expression: &str) -> Value {
        let answer =
            self.tell("Runtime.evaluate", &json!({ "expression": expression, "returnByValue": true }));
        assert!(answer["result"]["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["result"]["value"].clone()
    }

    /// Goes to another page, as by the line for addresses.
    pub(super) fn go(&mut self, url: &str) {
        self.value("window.before = true");
        self.tell("Page.navigate", &json!({ "url": url }));
    }

    /// The text of an element; none as long as the page is not there.
    fn text(&mut self, id: &str) -> String {
        self.value(&format!("document.getElementById('{id}')?.textContent ?? ''"))
            .as_str()
            .unwrap_or_default()
            .into()
    }

    /// Presses a button.
    pub(super) fn click(&mut self, selector: &str) {
        self.value(&format!("document.querySelector(\"{selector}\").click()"));
    }

    /// Waits until an element says something.
    pub(super) fn until_text(&mut self, id: &str, part: &str) {
        until(&format!("{id} says {part}"), || self.text(id).contains(part));
    }

    /// Keeps a picture of what lies from the first to the last of these elements, where `PITCHLOCK_PICTURES`
    /// names a folder.
    pub(super) fn picture(&mut self, name: &str, elements: &str) {
        let Some(folder) = std::env::var_os("PITCHLOCK_PICTURES") else { return };
        let clip = self.value(&format!(
            "(all => {{ const x = Math.min(...all.map(r => r.left)) + scrollX, y = Math.min(...all.map(r => r.top)) + scrollY;
            return {{ x, y, width: Math.max(...all.map(r => r.right)) + scrollX - x,
                height: Math.max(...all.map(r => r.bottom)) + scrollY - y, scale: 1 }}; }})
            ([...document.querySelectorAll('{elements}')].map(one => one.getBoundingClientRect()))"
        ));
        let how = json!({ "format": "webp", "quality": 36, "clip": clip, "captureBeyondViewport": true });
        let answer = self.tell("Page.captureScreenshot", &how);
        let text = answer["result"]["data"].as_str().expect("a picture");
        let bytes = STANDARD.decode(text).expect("base64");
        fs::write(Path::new(&folder).join(format!("{name}.webp")), bytes).expect("room for a picture");
    }
}

fn get(address: &str, path: &str) -> (u16, String) {
    use std::io::{Read as _, Write as _};
    let Ok(mut stream) = TcpStream::connect(address) else { return (0, String::new()) };
    let _ = stream.set_read_timeout(Some(Duration::from_secs(2)));
    let _ = stream
        .write_all(format!("GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").as_bytes());
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    (200, text.split_once("\r\n\r\n").map(|(_, body)| body.to_owned()).unwrap_or_default())
}

/// Nothing is wider than the window.
pub(super) const FITS: &str = "document.documentElement.scrollWidth <= window.innerWidth";

#[test]
fn a_browser_shows_the_machine_and_presses() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    let panel = Panel::start(&place, &["panel", &program, "--trace", "none", "--pace", "8"]);
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let Some(mut browser) = Browser::open(&place, &url, 1280) else { return };
    browser.until_text("link", "live");
    browser.until_text("words", "start starts it");
    assert_eq!(
        browser.value("location.href"),
        format!("http://{}/", panel.address),
        "the secret is not shown"
    );
    assert_eq!(browser.value("document.querySelector('[data-do=start]').disabled"), true, "without the keys");
    browser.click("#take");
    browser.until_text("seat", "You hold the keys");
    browser.click("[data-do=start]");
    browser.until_text("said", "in cycle 0");
    browser.until_text("words", "on the helix");
    browser.value(
        "(s => { s.value = 70; s.oninput(); s.onchange(); })(document.getElementById('spindle-override'))",
    );
    browser.until_text("spindle-now", "70 %");
    until("the spindle turns slower", || {
        panel.state()["spindle"]["rpm"].as_f64().is_some_and(|rpm| rpm < 450.0)
    });
    browser.until_text("passes", "complete");
    assert_eq!(browser.value("document.querySelector('#text .now b').textContent"), "28", "the running line");
    browser.click("[data-do=hold]");
    browser.until_text("words", "held");
    browser.picture("panel", "header, main");
    let drawn = "(c => c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some(p => p))(document.querySelector('canvas'))";
    assert_eq!(browser.value(drawn), true, "the view is drawn");
    assert_eq!(browser.value(FITS), true);
    // Somebody with a small screen takes over, and the first one sees it.
    let mut small = Browser::open(&place, &url, 500).expect("there is one");
    small.until_text("seat", "holds the keys: you watch");
    small.click("#take");
    small.until_text("seat", "You hold the keys");
    browser.until_text("seat", "you watch");
    assert_eq!(browser.value("document.querySelector('[data-do=stop]').disabled"), true);
    let telephone = json!({ "width": 360, "height": 800, "deviceScaleFactor": 2, "mobile": true });
    small.tell("Emulation.setDeviceMetricsOverride", &telephone);
    small.tell("Emulation.setTouchEmulationEnabled", &json!({ "enabled": true }));
    assert_eq!((small.value("window.innerWidth"), small.value(FITS)), (json!(360), json!(true)));
    let low = "[...document.querySelectorAll('.keys button')].every(key => key.offsetHeight >= 44)";
    assert_eq!(small.value(low), true, "a finger hits every key");
    small.picture("panel-telephone", "header, .state, .keys, .readout");
    small.click("[data-do=start]");
    small.until_text("said", "start: in cycle");
    small.click("[data-do=stop]");
    browser.until_text("words", "stopped");
    assert!(place.at("runs/m20x2-1/presses.toml").exists());
    // What a page of the browser may not do.
    let refused = "fetch('/api/do?do=hold').then(r => window.seen = r.status)";
    browser.value(refused);
    until("it is refused", || browser.value("window.seen") == 405);
}

/// Work by hand from the page alone: switched on, a block, a jog as long as its key is pressed, touched off.
#[test]
fn a_browser_works_by_hand() {
    let place = Place::new();
    let panel = Panel::start(&place, &["panel", "--trace", "none", "--out", "session"]);
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let Some(mut browser) = Browser::open(&place, &url, 1280) else { return };
    browser.until_text("link", "live");
    browser.click("#take");
    browser.until_text("seat", "You hold the keys");
    browser.until_text("mode", "off");
    browser.click("#hand-on");
    browser.until_text("mode", "ready");
    let z = |panel: &Panel| panel.state()["axes"][1]["commanded_mm"].as_f64().expect("a place");
    let begun = z(&panel);
    browser.value("document.getElementById('block').value = 'G91 G7 G0 Z-20'");
    browser.click("#mdi button");
    until("the block is done", || (z(&panel) - begun + 20.0).abs() < 1e-6);
    browser.until_text("force", "G91");
    browser.until_text("mode", "ready");
    browser.value("document.getElementById('block').value = 'G1 Z-1 F0'");
    browser.click("#mdi button");
    browser.until_text("said", "F is 0");
    // A key that is held down: Z goes; let go, it stands.
    browser.value("document.getElementById('step').value = ''");
    browser.value("document.getElementById('jog-Z-minus').dispatchEvent(new PointerEvent('pointerdown'))");
    until("Z goes", || z(&panel) < begun - 21.0);
    browser.picture("panel-by-hand", ".state, .hand");
    browser.value("document.getElementById('jog-Z-minus').dispatchEvent(new PointerEvent('pointerup'))");
    browser.until_text("mode", "ready");
    let stands = z(&panel);
    assert!(stands < begun - 21.0);
    browser.value("document.getElementById('touch-axis').value = 'Z'");
    browser.value("document.getElementById('touch-value').value = '2.5'");
    browser.click("#touch button");
    until("zero lies there", || {
        let state = panel.state();
        state["origin_mm"][1].as_f64().is_some_and(|zero| (zero - (stands - 2.5)).abs() < 1e-6)
    });
    browser.until_text("mode", "ready");
    // The page may show the mode of before, and a key that is off takes no press.
    let home = machine::Machine::default().axis[&protocol::Axis::Z].home_mm;
    until("Z is at its home", || {
        browser.click("#home-Z");
        (z(&panel) - home).abs() < 1e-6
    });
    browser.until_text("mode", "ready");
    browser.click("[data-do=abort]");
    browser.until_text("mode", "off");
    assert!(place.at("session/by-hand.mc").is_file());
}

/// The wear of a tool from the page alone, while the machine is off: a diameter is typed, a radius kept.
#[test]
fn a_browser_corrects_a_tool() {
    let place = Place::new();
    fs::write(place.at("cut.ngc"), super::tables::CUT).expect("room");
    fs::write(place.at("tool.tbl"), super::tables::TOOLS).expect("room");
    let arguments = ["panel", "cut.ngc", "--tools", "tool.tbl", "--trace", "none", "--pace", "max"];
    let panel = Panel::start(&place, &arguments);
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let Some(mut browser) = Browser::open(&place, &url, 1200) else { return };
    browser.until_text("tools", "-0.2000");
    assert_eq!(browser.value("document.querySelector('#offset button').disabled"), true, "without the keys");
    browser.click("#take");
    browser.until_text("seat", "You hold the keys");
    browser.click("#tools tbody tr:nth-child(2)");
    browser.until_text("offset-note", "T3 in mm");
    browser.value("document.getElementById('offset-value').value = '-50'");
    browser.click("#offset-add");
    browser.until_text("said", "is no correction");
    browser.value("document.getElementById('offset-value').value = '-0.05'");
    browser.click("#offset-add");
    browser.until_text("tools", "-0.2500");
    let kept = fs::read_to_string(place.at("tool.tbl")).expect("a table");
    assert!(kept.contains("T3 P3 X-0.125 Z0.2 ;threading"), "{kept}");
    browser.picture("panel-offsets", ".offsets");
    assert_eq!(browser.value(FITS), true);
    browser.click("[data-do=start]");
    browser.until_text("words", "completed");
    let telephone = json!({ "width": 360, "height": 800, "deviceScaleFactor": 2, "mobile": true });
    browser.tell("Emulation.setDeviceMetricsOverride", &telephone);
    assert_eq!((browser.value("window.innerWidth"), browser.value(FITS)), (json!(360), json!(true)));
}

/// A recording in the page: marked as one, without keys; played, paused, stepped, led to a time.
#[test]
fn a_browser_plays_a_recording() {
    let place = Place::new();
    let panel = super::playback::plays(&place, &["--pace", "0.05"]);
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let Some(mut browser) = Browser::open(&place, &url, 1200) else { return };
    browser.until_text("playback", "made, completed");
    browser.click("#take");
    browser.until_text("seat", "You hold the keys");
    assert_eq!(browser.value("document.querySelector('[data-do=start]').disabled"), true);
    assert_eq!(browser.value("document.querySelector('#offset button').disabled"), true);
    browser.click("#play");
    browser.until_text("playback", "stands");
    let cycle = |panel: &Panel| panel.state()["cycle"].as_u64().unwrap_or_default();
    let before = cycle(&panel);
    browser.click("#step-one");
    until("one cycle on", || cycle(&panel) == before + 1);
    browser.click("#step-many");
    until("100 ms on", || cycle(&panel) == before + 201);
    let pass = super::playback::column(&place, "pass");
    let cycle = pass.iter().position(|pass| *pass == 2.0).expect("a second pass") + 300;
    let time = format!("{:.3}", cycle as f64 * 5e-4);
    browser.value(&format!("(s => {{ s.value = {time}; s.onchange(); }})(document.getElementById('seek'))"));
    browser.until_text("playback", &format!("{time} of"));
    browser.until_text("words", "pass 2");
    assert_eq!(browser.value(FITS), true);
    browser.picture("panel-playback", ".state, .player");
    browser.value("document.getElementById('speed').value = '1000'");
    browser.click("#play");
    browser.until_text("words", "over");
    browser.until_text("passes", "complete");
    browser.until_text("other", "bit for bit");
    let telephone = json!({ "width": 360, "height": 800, "deviceScaleFactor": 2, "mobile": true });
    browser.tell("Emulation.setDeviceMetricsOverride", &telephone);
    assert_eq!((browser.value("window.innerWidth"), browser.value(FITS)), (json!(360), json!(true)));
}

/// The scope of a recording in the page: triggered by the index, cursors with their differences, passes over
/// each other, a part of it saved.
#[test]
fn a_browser_has_a_scope() {
    let place = Place::new();
    let panel = super::playback::plays(&place, &["--pace", "max"]);
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let Some(mut browser) = Browser::open(&place, &url, 1200) else { return };
    browser.until_text("playback", "stands");
    browser.value("scope.signals = ['spindle_true_deg', 'z_servo_error']");
    browser.click("#scope-open");
    browser.value("(s => { s.value = 0.1; s.onchange(); })(document.getElementById('scope-span'))");
    browser.click("[data-scope=normal]");
    browser.until_text("scope-state", "trigger in cycle");
    browser.until_text("scope-state", "none missing");
    let hit = browser.value("scope.picture.trigger_cycle").as_u64().expect("a cycle") as usize;
    let angle = super::playback::column(&place, "spindle_true_deg");
    let turn = |cycle: usize| (angle[cycle] / 360.0).floor();
    assert!(turn(hit) != turn(hit - 1), "the index goes by in cycle {hit}");
    browser
        .value("scope.cursors = [scope.picture.trigger - 0.02, scope.picture.trigger + 0.02]; drawScope()");
    browser.until_text("scope-read", "0.04 (25 Hz)");
    browser.picture("panel-scope", ".scope");
    let apart = browser
        .value("valueAt(scope.picture, 0, scope.cursors[1]) - valueAt(scope.picture, 0, scope.cursors[0])");
    assert!((apart.as_f64().expect("degrees") - (angle[hit + 40] - angle[hit - 40])).abs() < 1e-9, "{apart}");
    browser.click("#scope-zoom");
    until("it is what lies between them", || browser.value("scope.picture.span < 0.05") == true);
    let folder = place.at("saved");
    fs::create_dir(&folder).expect("room");
    browser.tell(
        "Page.setDownloadBehavior",
        &json!({ "behavior": "allow", "downloadPath": folder.display().to_string() }),
    );
    browser.click("[data-save=csv]");
    let name = format!("scope-{}-{}.csv", hit - 40, hit + 40);
    until("it is saved", || {
        fs::read_to_string(folder.join(&name)).is_ok_and(|text| text.lines().count() == 82)
    });
    // Of the piece that is shown: the newest 64 of its 81 cycles.
    browser.value("(s => { s.value = 'hz'; s.onchange(); })(document.getElementById('scope-x'))");
    browser.until_text("scope-state", "(0.032 s), window of Hann · spindle_true_deg highest");
    assert_eq!(browser.value("scope.picture.cycles"), json!([hit - 23, hit + 40]));
    browser.value("(s => { s.value = 'pass'; s.onchange(); })(document.getElementById('scope-x'))");
    browser.until_text("scope-state", "passes 1 to 2");
    assert_eq!(browser.value(FITS), true);
    browser.picture("panel-scope-passes", ".scope");
    let telephone = json!({ "width": 360, "height": 800, "deviceScaleFactor": 2, "mobile": true });
    browser.tell("Emulation.setDeviceMetricsOverride", &telephone);
    assert_eq!((browser.value("window.innerWidth"), browser.value(FITS)), (json!(360), json!(true)));
}
