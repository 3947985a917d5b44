//! The scope: what somebody wants to see of the newest control cycles. In: settings, the ring. Out: pictures,
//! as bytes. Everybody who watches has a scope of his own on the one ring; it needs no keys.

mod picture;
mod ring;
mod spectrum;
mod trigger;

use serde::Deserialize;
use serde_json::{Value, json};

use picture::{Curve, Drawn, over_time, passes, spectrum, turns};
pub(crate) use ring::Ring;
use trigger::Trigger;

/// Most signals of a picture, and most points of a curve.
const MOST_SIGNALS: usize = 8;
const MOST_POINTS: usize = 4000;

/// What x is.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Across {
    /// Seconds on the machine.
    Time,
    /// Degrees from the index of a pass.
    Pass,
    /// Degrees of a turn.
    Turn,
    /// Frequencies, Hz: a spectrum of what lies over time.
    Hz,
    /// How often in a revolution of the spindle: the same.
    Rev,
}

impl Across {
    /// Its unit.
    fn unit(self) -> &'static str {
        match self {
            Across::Time => "s",
            Across::Pass | Across::Turn => "deg",
            Across::Hz => "Hz",
            Across::Rev => "1/rev",
        }
    }

    /// Whether it shows a stretch of time.
    fn over_time(self) -> bool {
        !matches!(self, Across::Pass | Across::Turn)
    }
}

/// When there is a picture.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Mode {
    /// Up to the newest cycle.
    Roll,
    /// At every trigger.
    Normal,
    /// At the first trigger from now on.
    Single,
    /// From `from` on.
    Stand,
}

/// What somebody wants to see.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Asked {
    signals: Vec<String>,
    x: Across,
    mode: Mode,
    /// s, or degrees, of the picture.
    span: f64,
    /// Where it begins, s or degrees; of `stand`.
    #[serde(default)]
    from: f64,
    points: usize,
    /// How much of the picture lies before the trigger, 0 to 1.
    #[serde(default)]
    pre: f64,
    trigger: Option<Trigger>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    /// Null closes it.
    scope: Value,
}

/// Somebody's scope.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scope {
    asked: Option<Asked>,
    /// The ring that it has looked at, and the number of the next row.
    ring: u64,
    next: u64,
    /// Cycle of the trigger of the picture.
    hit: Option<u64>,
    /// Newest row, and ring, of the picture that was drawn.
    drawn: Option<(u64, u64)>,
}

/// Sets a scope by any bytes, on a ring of a thousand rows, and draws it: how many bytes the picture has.
/// For tests of what others send.
pub fn scoped(document: &[u8]) -> Option<usize> {
    let mut ring = Ring::default();
    let columns = ["cycle", "spindle_true_deg", "pass", "z_state"];
    ring.begin(columns.map(str::to_owned).to_vec(), 5e-4, 1000);
    (0..1200).for_each(|row| ring.take(&[f64::from(row), f64::from(3 * row), 1.0, f64::from(row / 300)]));
    let mut scope = Scope::default();
    scope.set(std::str::from_utf8(document).ok()?, &ring)?;
    scope.picture(&ring).map(|picture| picture.len())
}

impl Scope {
    /// Takes a document, if it is one for the scope: `{"scope": …}`, or null to close it. What is wrong
    /// with it is the answer, and changes nothing.
    pub(crate) fn set(&mut self, text: &str, ring: &Ring) -> Option<Value> {
        let document: Document = serde_json::from_str(text).ok()?;
        let told = |why: String| json!({ "scope": { "refused": "bad-value", "why": why } });
        let read = Option::<Asked>::deserialize(document.scope).map_err(|error| error.to_string());
        match read.and_then(|asked| asked.map(|asked| asked.possible(ring)).transpose()) {
            Err(why) => Some(told(format!("scope: {why}"))),
            Ok(asked) => {
                let newest = ring.oldest() + ring.rows() as u64;
                let waits = asked.as_ref().is_some_and(|asked| asked.mode == Mode::Single);
                let next = if waits { newest } else { 0 };
                *self = Scope { asked, ring: ring.begun(), next, hit: None, drawn: None };
                Some(json!({ "scope": "set" }))
            }
        }
    }

    /// Whether it is open.
    pub(crate) fn is_open(&self) -> bool {
        self.asked.is_some()
    }

    /// A picture, if there is another one than before.
    pub(crate) fn picture(&mut self, ring: &Ring) -> Option<Vec<u8>> {
        let asked = self.asked.clone()?;
        let newest = ring.oldest() + ring.rows() as u64;
        if self.ring != ring.begun() {
            (self.ring, self.next, self.hit) = (ring.begun(), 0, None);
        }
        if self.drawn == Some((ring.begun(), newest)) {
            return None;
        }
        let before = self.hit;
        self.looks(&asked, ring, newest);
        let stays = matches!(asked.mode, Mode::Stand) || self.hit.is_some() && self.hit == before;
        if asked.x.over_time() && stays && self.drawn.is_some_and(|(begun, _)| begun == ring.begun()) {
            return None;
        }
        self.drawn = Some((ring.begun(), newest));
        Some(self.draws(&asked, ring))
    }

    /// Looks for triggers in rows that it has not seen yet. One counts when its picture is whole.
    fn looks(&mut self, asked: &Asked, ring: &Ring, newest: u64) {
        let Some(trigger) = asked.trigger.as_ref().filter(|_| asked.mode.waits()) else { return };
        let behind = (asked.span * (1.0 - asked.pre) / ring.cycle_s()).ceil() as u64;
        while self.hit.is_none() || asked.mode == Mode::Normal {
            let from = self.next.saturating_sub(ring.oldest()) as usize;
            let Some(row) = trigger.first(ring, from..ring.rows()) else {
                self.next = newest;
                return;
            };
            let cycle = ring.cycle(row);
            self.next = ring.oldest() + row as u64;
            if ring.cycle(ring.rows() - 1) < cycle.saturating_add(behind) {
                return;
            }
            self.hit = Some(cycle);
            // The next one lies behind this picture.
            let end = cycle.saturating_add(behind) as f64;
            self.next = ring.oldest() + ring.between(end, end).start.max(row + 1) as u64;
        }
    }

    /// The picture: how long a document is, the document, numbers.
    fn draws(&self, asked: &Asked, ring: &Ring) -> Vec<u8> {
        let columns: Vec<_> = asked.signals.iter().filter_map(|name| ring.column(name)).collect();
        let window = (asked.mode == Mode::Stand).then_some((asked.from, asked.span));
        let waits = asked.mode.waits() && self.hit.is_none() && asked.x.over_time();
        let Drawn { curves, window: (from, span), cycles, missing, peaks } = match asked.x {
            Across::Pass => passes(ring, &columns, asked.points, window),
            Across::Turn => turns(ring, &columns, asked.points, window),
            Across::Time | Across::Hz | Across::Rev => {
                let (from, span) = window.unwrap_or_else(|| self.window(asked, ring));
                let first = (from / ring.cycle_s()).round();
                let rows = ring.between(first, first + (span / ring.cycle_s()).round() + 1.0);
                match (asked.x, waits) {
                    (_, true) => Drawn { window: (from, span), ..Drawn::default() },
                    (Across::Time, _) => over_time(ring, rows, &columns, asked.points, (from, span)),
                    (across, _) => spectrum(ring, rows, &columns, asked.points, across == Across::Rev),
                }
            }
        };
        let names: Vec<_> = asked.signals.iter().filter(|name| ring.column(name).is_some()).collect();
        let lengths: Vec<_> = curves.iter().map(|curve| json!([curve.number, curve.x.len()])).collect();
        let hit = self.hit.filter(|_| asked.x.over_time() && asked.mode.waits());
        let document = json!({
            "x": asked.x.unit(), "from": from, "span": span, "waits": waits,
            "trigger": hit.map(|cycle| cycle as f64 * ring.cycle_s()), "trigger_cycle": hit,
            "cycles": cycles, "missing": missing, "signals": names, "curves": lengths, "peaks": peaks,
        });
        let mut bytes = document.to_string().into_bytes();
        // Numbers begin at a multiple of 8.
        bytes.resize((bytes.len() + 4).next_multiple_of(8) - 4, b' ');
        let mut all = (bytes.len() as u32).to_le_bytes().to_vec();
        all.append(&mut bytes);
        let columns = |curve: Curve| {
            let values = curve.low.into_iter().zip(curve.high).flat_map(|(low, high)| [low, high]);
            std::iter::once(curve.x).chain(values).flatten()
        };
        all.extend(curves.into_iter().flat_map(columns).flat_map(f64::to_le_bytes));
        all
    }

    /// Where a picture over time begins, s, and how long it is.
    fn window(&self, asked: &Asked, ring: &Ring) -> (f64, f64) {
        let newest = ring.rows().checked_sub(1).map_or(0, |row| ring.cycle(row)) as f64 * ring.cycle_s();
        match self.hit.filter(|_| asked.mode.waits()) {
            Some(cycle) => (cycle as f64 * ring.cycle_s() - asked.pre * asked.span, asked.span),
            None => (newest - asked.span, asked.span),
        }
    }
}

impl Mode {
    /// Whether it needs a trigger.
    fn waits(self) -> bool {
        matches!(self, Mode::Normal | Mode::Single)
    }
}

impl Asked {
    /// The same, if it can be drawn.
    fn possible(self, ring: &Ring) -> Result<Asked, String> {
        let unknown = |name: &&String| !ring.columns().is_empty() && ring.column(name).is_none();
        let of_trigger = match &self.trigger {
            Some(Trigger::Level(level)) => Some(&level.signal),
            _ => None,
        };
        if let Some(name) = self.signals.iter().chain(of_trigger).find(unknown) {
            return Err(format!("{name} is not a signal of this machine: signals of /api/state names them"));
        }
        let why = match () {
            () if !(1..=MOST_SIGNALS).contains(&self.signals.len()) => "signals are 1 to 8 names",
            () if !(10..=MOST_POINTS).contains(&self.points) => "points is 10 to 4000",
            () if !(self.span > 0.0 && self.span <= 1e6) => {
                "span is above 0 and at most 1000000, s or degrees"
            }
            () if !(-1e9..=1e9).contains(&self.from) => {
                "from is a time on the machine, s, or an angle, degrees"
            }
            () if !(0.0..=1.0).contains(&self.pre) => "pre is 0 to 1",
            () if self.mode.waits() && self.x.over_time() && self.trigger.is_none() => {
                "normal and single need a trigger"
            }
            () => return Ok(self),
        };
        Err(why.into())
    }
}

#[cfg(test)]
mod tests {
    use super::{
        ring::tests::{filled, row},
        *,
    };

    /// A picture read again: its document, and its numbers.
    fn read(bytes: &[u8]) -> (Value, Vec<f64>) {
        let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
        let document = serde_json::from_slice(&bytes[4..4 + length]).expect("a document");
        assert_eq!((4 + length) % 8, 0);
        let numbers =
            bytes[4 + length..].chunks(8).map(|eight| f64::from_le_bytes(eight.try_into().expect("eight")));
        (document, numbers.collect())
    }

    fn scope(ring: &Ring, more: &str) -> Scope {
        let mut scope = Scope::default();
        let text = format!(
            "{{\"scope\":{{\"signals\":[\"cycle\"],\"x\":\"time\",\"span\":0.05,\"points\":500,{more}}}}}"
        );
        assert_eq!(scope.set(&text, ring), Some(json!({ "scope": "set" })), "{text}");
        scope
    }

    #[test]
    fn a_picture_begins_where_it_should_before_its_trigger() {
        let mut ring = filled(0..1090, 3000);
        let index = r#""pre":0.2,"trigger":{"event":"index"}"#;
        let mut normal = scope(&ring, &format!("\"mode\":\"normal\",{index}"));
        let (document, numbers) = read(&normal.picture(&ring).expect("a picture"));
        // Of the indices at 840, 960, 1080, the last one whose 80 cycles behind it are there.
        assert_eq!((&document["trigger_cycle"], &document["cycles"]), (&json!(960), &json!([940, 1040])));
        assert_eq!(numbers[101..202], (940..=1040).map(f64::from).collect::<Vec<_>>());
        assert_eq!(normal.picture(&ring), None, "nothing is new");
        let mut single = scope(&ring, &format!("\"mode\":\"single\",{index}"));
        assert_eq!(read(&single.picture(&ring).expect("a picture")).0["waits"], true);
        (1090..1400).for_each(|cycle| ring.take(&row(cycle)));
        let (document, _) = read(&single.picture(&ring).expect("a picture"));
        assert_eq!((&document["trigger_cycle"], &document["waits"]), (&json!(1200), &json!(false)));
        assert_eq!(read(&normal.picture(&ring).expect("a picture")).0["trigger_cycle"], 1200);
        assert_eq!(normal.picture(&ring), None, "1320 is whole with cycle 1400");
        (1400..1500).for_each(|cycle| ring.take(&row(cycle)));
        assert_eq!(single.picture(&ring), None, "it stays");
        assert_eq!(read(&normal.picture(&ring).expect("a picture")).0["trigger_cycle"], 1320);
        (1500..1600).for_each(|cycle| ring.take(&row(cycle)));
        assert_eq!(read(&normal.picture(&ring).expect("a picture")).0["trigger_cycle"], 1440);
    }

    #[test]
    fn it_rolls_stands_and_tells_what_is_missing() {
        let mut ring = filled(0..1000, 3000);
        let mut roll = scope(&ring, "\"mode\":\"roll\"");
        assert_eq!(read(&roll.picture(&ring).expect("a picture")).0["cycles"], json!([899, 999]));
        (1010..1020).for_each(|cycle| ring.take(&row(cycle)));
        let (document, _) = read(&roll.picture(&ring).expect("a picture"));
        assert_eq!((&document["cycles"], &document["missing"]), (&json!([919, 1019]), &json!(10)));
        let mut stand = scope(&ring, "\"mode\":\"stand\",\"from\":0.1");
        assert_eq!(read(&stand.picture(&ring).expect("a picture")).0["cycles"], json!([200, 300]));
        ring.take(&row(1020));
        assert_eq!(stand.picture(&ring), None);
        // Another run.
        ring.begin(vec!["cycle".into()], 5e-4, 100);
        ring.take(&[7.0]);
        assert_eq!(read(&roll.picture(&ring).expect("a picture")).0["cycles"], json!([7, 7]));
    }

    /// A spectrum is of the stretch that would be seen over time; with a gap in it there is none.
    #[test]
    fn a_spectrum_is_of_what_is_seen_over_time() {
        let ring = filled(0..3000, 3000);
        let of = |x: &str, ring: &Ring| {
            let mut scope = Scope::default();
            let asked = json!({ "signals": ["cycle", "z_error"], "x": x, "mode": "stand", "from": 0.6,
                                "span": 0.52, "points": 4000 });
            scope.set(&json!({ "scope": asked }).to_string(), ring);
            read(&scope.picture(ring).expect("a picture"))
        };
        let (document, numbers) = of("hz", &ring);
        assert_eq!((&document["x"], &document["cycles"]), (&json!("Hz"), &json!([1217, 2240])));
        assert_eq!((&document["curves"], numbers.len()), (&json!([[0, 512]]), 5 * 512));
        let step = 1.0 / (1024.0 * 5e-4);
        assert!((numbers[1] - step).abs() < 1e-12 && (document["span"] == json!(512.0 * step)), "{document}");
        let (document, _) = of("rev", &ring);
        assert_eq!((&document["x"], &document["cycles"]), (&json!("1/rev"), &json!([1280, 2240])));
        assert!(document["peaks"][1][1].as_f64().is_some_and(|highest| highest > 1e-6), "{document}");
        let mut gap = filled(0..2000, 3000);
        (2001..2300).for_each(|cycle| gap.take(&row(cycle)));
        let (document, numbers) = of("hz", &gap);
        assert_eq!((&document["missing"], &document["peaks"]), (&json!(1), &Value::Null));
        assert!(numbers.is_empty());
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_and_the_picture_stays() {
        let ring = filled(0..100, 100);
        let mut scope = scope(&ring, "\"mode\":\"roll\"");
        for (wrong, why) in [
            (r#"{"signals":[],"x":"time","mode":"roll","span":1,"points":100}"#, "1 to 8"),
            (r#"{"signals":["nothing"],"x":"time","mode":"roll","span":1,"points":100}"#, "not a signal"),
            (r#"{"signals":["pass"],"x":"time","mode":"roll","span":0,"points":100}"#, "span"),
            (r#"{"signals":["pass"],"x":"time","mode":"roll","span":1,"points":1e9}"#, "invalid type"),
            (r#"{"signals":["pass"],"x":"time","mode":"roll","span":1,"points":100000}"#, "points"),
            (r#"{"signals":["pass"],"x":"time","mode":"normal","span":1,"points":100}"#, "trigger"),
            (r#"{"signals":["pass"],"x":"time","mode":"roll","span":1,"points":100,"pre":2}"#, "pre"),
            (r#"{"signals":["pass"],"x":"moon","mode":"roll","span":1,"points":100}"#, "moon"),
            (r#"{"signals":["pass"],"x":"time","mode":"roll","span":1,"points":100,"more":1}"#, "more"),
        ] {
            let told = scope.set(&format!("{{\"scope\":{wrong}}}"), &ring).expect("an answer");
            let reason = told["scope"]["why"].as_str().unwrap_or_default();
            assert!(reason.contains(why), "{wrong}: {told}");
        }
        assert!(scope.is_open() && scope.picture(&ring).is_some());
        assert_eq!(
            scope.set("{\"id\":1,\"do\":\"hold\",\"as\":\"me\"}", &ring),
            None,
            "that is for the machine"
        );
        scope.set("{\"scope\":null}", &ring);
        assert!(!scope.is_open() && scope.picture(&ring).is_none());
    }
}
