//! Who stands at the terminal: what is seen, what is typed. In: documents of the panel, keys with the time
//! since the client began. Out: requests for the panel, and whether the terminal is left.

use std::{collections::BTreeMap, time::Duration};

use ratatui::{
    crossterm::event::{KeyEvent, KeyEventKind},
    layout::Size,
};
use serde_json::{Map, Value, json};

use crate::{
    jog::{Asks, Jog, Way},
    keys::{self, Does, Key},
    typing::{Line, Typing},
    wanted::Wanted,
};

/// The smallest terminal that it is drawn on: columns, rows.
pub(crate) const SMALLEST: [u16; 2] = [72, 20];
/// Lengths of a step, mm; 0: a jog as long as the key is pressed.
const STEPS: [f64; 6] = [0.0, 0.001, 0.01, 0.1, 1.0, 10.0];
/// Slowest feed of jogs that keys choose, mm/min.
const SLOWEST: f64 = 1.0;
/// A value that is wanted: whether this one holds the keys.
const SEAT: &str = "seat";
/// Modes in which nothing goes on.
const OFF: [&str; 2] = ["off", "playback"];
/// What somebody may want of a machine that he does not see.
const UNSEEN: [&str; 4] = ["hold", "stop", "abort", "emergency-stop"];

/// Whether a key acts in a terminal that is too small to show what it does.
pub(crate) fn acts_unseen(does: Does) -> bool {
    match does {
        Does::Ask(word) => UNSEEN.contains(&word),
        does => matches!(does, Does::Leave | Does::End),
    }
}

/// What a key leads to beside requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// Nothing.
    Stay,
    /// The terminal is left.
    Leave,
    /// What was begun here is to end, whatever it does.
    End,
}

/// What is seen and typed.
#[derive(Debug)]
pub struct Desk {
    name: String,
    /// Leaving ends what was begun here.
    begun_here: bool,
    state: Map<String, Value>,
    program: Vec<String>,
    /// Why the panel does not answer, if it does not.
    gone: Option<String>,
    asked: u64,
    waits: BTreeMap<u64, String>,
    wanted: Wanted,
    is_small: bool,
    said: (bool, String),
    typing: Typing,
    jog: Jog,
    step: usize,
    feed: f64,
    of_machine: bool,
    out: Vec<Value>,
}

/// Whether too little can be seen on a terminal of this size.
pub(crate) fn is_small(size: Size) -> bool {
    size.width < SMALLEST[0] || size.height < SMALLEST[1]
}

/// Text without what would move a cursor.
pub(crate) fn plain(text: &str) -> String {
    text.replace(|letter: char| letter.is_control(), " ")
}

impl Desk {
    /// Somebody of this name; `begun_here`: the panel was begun by this terminal, and ends with it.
    pub fn new(name: &str, begun_here: bool) -> Desk {
        Desk {
            name: name.into(),
            begun_here,
            state: Map::new(),
            program: Vec::new(),
            gone: Some("connecting".into()),
            asked: 0,
            waits: BTreeMap::new(),
            wanted: Wanted::default(),
            is_small: false,
            said: (false, String::new()),
            typing: Typing::default(),
            jog: Jog::default(),
            step: 0,
            feed: 600.0,
            of_machine: false,
            out: Vec::new(),
        }
    }

    /// The panel answers from now on.
    pub fn connected(&mut self) {
        self.gone = None;
    }

    /// The panel does not answer any more, and why. A jog has ended with it.
    pub fn gone(&mut self, why: &str) {
        self.gone = Some(plain(why));
        self.waits.clear();
        self.wanted.forget();
        self.jog.forget();
    }

    /// It is drawn on a terminal of this size.
    pub fn is_drawn_on(&mut self, size: Size) {
        self.is_small = is_small(size);
        if self.is_small {
            // What is typed would not be seen.
            self.typing.forget();
        }
    }

    /// Something is told by others than the panel.
    pub fn told(&mut self, text: &str) {
        self.said = (false, plain(text));
    }

    /// Takes a document of the panel.
    pub fn hears(&mut self, news: Value) {
        let Value::Object(mut news) = news else { return };
        if news.contains_key("id") {
            return self.answered(&news);
        }
        for left_out in ["trail", "way", "scope", "signals"] {
            news.remove(left_out);
        }
        if let Some(program) = news.get("program") {
            self.program = program["text"].as_str().unwrap_or_default().lines().map(plain).collect();
        }
        self.state.extend(news);
        let is_off = OFF.contains(&self.mode());
        self.wanted.shown(self.field("cycle").as_u64().unwrap_or_default(), is_off);
    }

    fn answered(&mut self, news: &Map<String, Value>) {
        let Some(id) = news["id"].as_u64() else { return };
        let Some(what) = self.waits.remove(&id) else { return };
        self.wanted.answered(id, news.get("cycle").and_then(Value::as_u64));
        if let Some(why) = news.get("why").and_then(Value::as_str) {
            if what.starts_with("jog") {
                self.jog.forget();
            }
            self.said = (true, plain(&format!("{what}: {why}")));
        } else if what != "jog-on" {
            let cycle = news.get("cycle").and_then(Value::as_u64).unwrap_or_default();
            self.said = (false, format!("{what}: in cycle {cycle}"));
        }
    }

    /// Takes a key.
    pub fn key(&mut self, event: &KeyEvent, now: Duration) -> Act {
        if event.kind == KeyEventKind::Release {
            return Act::Stay;
        }
        let key = keys::of(event);
        if self.typing.line().is_some() && key.is_none_or(|key| key.does != Does::End) {
            if let Some((word, value)) = self.typing.key(event) {
                self.ask(&word, value);
            }
            return Act::Stay;
        }
        let Some(Key { does, .. }) = key else { return Act::Stay };
        if self.is_small && !acts_unseen(*does) {
            let [width, height] = SMALLEST;
            let text = format!("this key acts where the machine is seen, on {width} by {height} characters");
            self.said = (true, text);
            return Act::Stay;
        }
        self.does(*does, now)
    }

    /// Time goes by.
    pub fn beat(&mut self, now: Duration) {
        if let Some(asks) = self.jog.beat(now) {
            self.jogs(asks);
        }
    }

    /// What is to be sent to the panel.
    pub fn asks(&mut self) -> Vec<Value> {
        std::mem::take(&mut self.out)
    }

    fn ask(&mut self, word: &str, value: Value) {
        self.asked += 1;
        let mut request = json!({ "id": self.asked, "do": word, "as": self.name });
        let mut what = word.to_owned();
        if !value.is_null() {
            if word != "jog-on" {
                what =
                    value.as_str().map_or_else(|| format!("{word} {value}"), |text| format!("{word} {text}"));
            }
            request["value"] = value;
        }
        if self.gone.is_some() {
            self.said = (true, format!("{what}: the panel is not connected"));
            return self.jog.forget();
        }
        self.waits.insert(self.asked, what);
        self.out.push(request);
    }

    fn does(&mut self, does: Does, now: Duration) -> Act {
        match does {
            Does::Ask(word) => self.ask(word, Value::Null),
            Does::Switch(word, field) => {
                let on = self.wanted.value(word).unwrap_or(self.field(field)).as_bool().unwrap_or_default();
                self.turns(word, json!(!on));
            }
            Does::Turn(word, field, more, highest) => {
                let shown = &self.field("knobs")[field];
                let now = self.wanted.value(word).unwrap_or(shown).as_f64().unwrap_or(100.0);
                self.turns(word, json!((now + more).clamp(0.0, highest)));
            }
            Does::Seat => {
                let holds = self.wanted.value(SEAT).map_or(self.holds(), |holds| *holds == true);
                self.ask(if holds { "leave-seat" } else { "take-seat" }, Value::Null);
                self.wants(SEAT, json!(!holds));
            }
            Does::ToolIn => self.ask("tool-change", self.field("tool").clone()),
            Does::Play => {
                let shown = &self.field("playback")["speed"];
                let plays = self.wanted.value("play").unwrap_or(shown).as_f64() != Some(0.0);
                self.turns("play", json!(if plays { 0.0 } else { 1.0 }));
            }
            Does::Jog(key, positive) => self.moves(key, positive, now),
            Does::Step => self.step = (self.step + 1) % STEPS.len(),
            Does::Feed(factor) => {
                self.feed = (self.feed * factor).clamp(SLOWEST, self.fastest().max(SLOWEST))
            }
            Does::Block => self.typing.begins(true),
            Does::Order => self.typing.begins(false),
            Does::Frame => self.of_machine = !self.of_machine,
            Does::Leave if self.begun_here && self.gone.is_none() && !OFF.contains(&self.mode()) => {
                let text =
                    "the machine is on: end its program first, or press Ctrl-C, which stops it and ends";
                self.said = (true, text.into());
            }
            Does::Leave => return Act::Leave,
            Does::End => return Act::End,
        }
        Act::Stay
    }

    /// Asks for a value that the next key may count from.
    fn turns(&mut self, word: &str, value: Value) {
        self.ask(word, value.clone());
        self.wants(word, value);
    }

    fn wants(&mut self, word: &str, value: Value) {
        if self.gone.is_none() {
            self.wanted.asked(word, self.asked, value);
        }
    }

    /// The key of an axis: a step, or a jog as long as it is pressed.
    fn moves(&mut self, key: usize, positive: bool, now: Duration) {
        let axis = self.axis(key);
        if axis.is_empty() {
            return;
        }
        let way = Way { axis: axis.into(), positive };
        if self.step == 0 {
            if let Some(asks) = self.jog.pressed(way, now) {
                self.jogs(asks);
            }
        } else if self.mode() == "ready" {
            // Repeats of a key that is still down while the axis goes are no further steps.
            let mm = STEPS[self.step] * if positive { 1.0 } else { -1.0 };
            self.ask("jog", json!({ "axis": axis, "mm_min": self.feed, "step_mm": mm }));
        }
    }

    fn jogs(&mut self, asks: Asks) {
        match asks {
            Asks::Begin(Way { axis, positive }) => {
                let feed = self.feed.min(self.fastest_of(&axis));
                let way = if positive { "+" } else { "-" };
                self.ask("jog", json!({ "axis": axis, "mm_min": feed, "way": way }));
            }
            Asks::Confirm => self.ask("jog-on", Value::Null),
            Asks::LetGo => self.ask("let-go", Value::Null),
        }
    }

    /// The fastest jog of any axis, mm/min; that of no axis is known: any.
    fn fastest(&self) -> f64 {
        let known = self.field("machine")["fastest_jog"].as_array().into_iter().flatten();
        known.filter_map(Value::as_f64).reduce(f64::max).unwrap_or(f64::MAX)
    }

    /// The fastest jog of an axis, mm/min.
    fn fastest_of(&self, axis: &str) -> f64 {
        let machine = self.field("machine");
        let at = machine["axes"].as_array().and_then(|axes| axes.iter().position(|name| name == axis));
        at.and_then(|at| machine["fastest_jog"][at].as_f64()).unwrap_or(f64::MAX)
    }
}

/// What is drawn.
impl Desk {
    pub(crate) fn field(&self, name: &str) -> &Value {
        self.state.get(name).unwrap_or(&Value::Null)
    }

    pub(crate) fn text(&self, name: &str) -> String {
        plain(self.field(name).as_str().unwrap_or_default())
    }

    pub(crate) fn mode(&self) -> &str {
        self.field("mode").as_str().unwrap_or("off")
    }

    pub(crate) fn holds(&self) -> bool {
        self.field("seat").as_str() == Some(&self.name)
    }

    pub(crate) fn is_lathe(&self) -> bool {
        self.field("machine")["kinematics"] == "lathe"
    }

    /// The axis of the keys of a jog; empty: none.
    pub(crate) fn axis(&self, key: usize) -> &'static str {
        let machine = self.field("machine");
        let name = keys::axes(machine["kinematics"].as_str().unwrap_or("lathe"))[key];
        let there = machine["axes"].as_array().is_some_and(|axes| axes.iter().any(|axis| axis == name));
        if there { name } else { "" }
    }

    pub(crate) fn program(&self) -> &[String] {
        &self.program
    }

    pub(crate) fn why_gone(&self) -> Option<&str> {
        self.gone.as_deref()
    }

    pub(crate) fn said(&self) -> (bool, &str) {
        (self.said.0, &self.said.1)
    }

    pub(crate) fn line(&self) -> Option<&Line> {
        self.typing.line()
    }

    pub(crate) fn is_of_machine(&self) -> bool {
        self.of_machine
    }

    /// What the keys of axes do.
    pub(crate) fn jog_words(&self) -> String {
        match STEPS[self.step] {
            0.0 => format!("jog while pressed, {} mm/min", self.feed.min(self.fastest())),
            step => format!("steps of {step} mm, {} mm/min", self.feed),
        }
    }
}
