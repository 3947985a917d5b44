//! What can be pressed. In: a document `{id, do, value, as}`. Out: what is to be done, or a refusal with a
//! name and a remedy. The table is the only place that says what there is.

use protocol::{OperatorRequest, operator::Request};
use serde::Deserialize;
use serde_json::Value;

use crate::{
    by_hand,
    wire::{FromPanel, HandAsked},
};

/// Most characters of a name.
const LONGEST_NAME: usize = 32;

/// What a word does.
#[derive(Clone, Copy, Debug)]
pub enum Does {
    /// A button: without a value.
    Button(Request),
    /// A switch: true or false.
    Switch(fn(bool) -> Request),
    /// A knob: per cent, up to this.
    Knob(fn(f64) -> Request, f64),
    /// Who asks holds the keys from now on.
    TakeSeat,
    /// Who asks gives them back.
    LeaveSeat,
    /// Work by hand: what its value says.
    Hand(fn(&Value) -> Result<HandAsked, &'static str>),
}

/// Every word, in the order of the documentation.
pub const DOES: [(&str, Does); 26] = [
    ("start", Does::Button(Request::CycleStart)),
    ("hold", Does::Button(Request::FeedHold)),
    ("stop", Does::Button(Request::Stop)),
    ("abort", Does::Button(Request::Abort)),
    ("emergency-stop", Does::Button(Request::EmergencyStop)),
    ("single-block", Does::Switch(Request::SingleBlock)),
    ("optional-stop", Does::Switch(Request::OptionalStop)),
    ("spindle-override", Does::Knob(Request::SpindleOverride, 200.0)),
    ("feed-override", Does::Knob(Request::FeedOverride, 200.0)),
    ("rapid-override", Does::Knob(Request::RapidOverride, 100.0)),
    ("take-seat", Does::TakeSeat),
    ("leave-seat", Does::LeaveSeat),
    ("by-hand", Does::Hand(by_hand::on)),
    ("mdi", Does::Hand(by_hand::block)),
    ("jog", Does::Hand(by_hand::jog)),
    ("jog-on", Does::Hand(by_hand::jog_on)),
    ("let-go", Does::Button(Request::Jog(false))),
    ("touch-off", Does::Hand(by_hand::touch_off)),
    ("offset", Does::Hand(by_hand::offset)),
    ("spindle", Does::Hand(by_hand::spindle)),
    ("play", Does::Hand(by_hand::play)),
    ("step", Does::Hand(by_hand::step)),
    ("seek", Does::Hand(by_hand::seek)),
    ("home", Does::Hand(by_hand::home)),
    ("tool-change", Does::Hand(by_hand::tool_in)),
    ("from", Does::Hand(by_hand::from)),
];

/// Why something is not done.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// A stable name.
    pub code: &'static str,
    /// The reason, and what would be right.
    pub why: String,
}

impl Refusal {
    pub(crate) fn new(code: &'static str, why: impl Into<String>) -> Refusal {
        Refusal { code, why: why.into() }
    }
}

/// What a document presses at the machine; nothing if it is about the seat.
///
/// # Errors
/// What is wrong with it.
pub fn pressed(document: &[u8]) -> Result<Option<OperatorRequest>, Refusal> {
    Ok(match read(document).1?.1 {
        Asked::Press(FromPanel { hand: None, kind, value, .. }) => {
            Some(OperatorRequest { kind, value, ..OperatorRequest::default() })
        }
        Asked::Press(_) | Asked::TakeSeat | Asked::LeaveSeat => None,
    })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    id: Value,
    #[serde(rename = "do")]
    word: String,
    #[serde(default)]
    value: Value,
    #[serde(rename = "as")]
    name: String,
}

/// What somebody asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Asked {
    /// It goes to the machine.
    Press(FromPanel),
    TakeSeat,
    LeaveSeat,
}

/// Reads a document: what the answer is to be called, who asks, and what for.
pub(crate) fn read(text: &[u8]) -> (Value, Result<(String, Asked), Refusal>) {
    let document: Document = match serde_json::from_slice(text) {
        Ok(document) => document,
        Err(error) => {
            let why = format!("{{\"id\", \"do\", \"value\", \"as\"}} is expected: {error}");
            return (Value::Null, Err(Refusal::new("bad-request", why)));
        }
    };
    let short = |text: &str| text.chars().count() <= LONGEST_NAME;
    let id = match document.id {
        Value::Number(number) => Value::Number(number),
        Value::String(text) if short(&text) => Value::String(text),
        _ => {
            let why = format!("id is a number, or up to {LONGEST_NAME} characters");
            return (Value::Null, Err(Refusal::new("bad-request", why)));
        }
    };
    (id, asked(&document.word, &document.value, document.name))
}

fn asked(word: &str, value: &Value, name: String) -> Result<(String, Asked), Refusal> {
    let plain = |letter: char| letter.is_alphanumeric() || " -_.".contains(letter);
    if name.is_empty() || name.chars().count() > LONGEST_NAME || !name.chars().all(plain) {
        let why = format!("as is who asks: 1 to {LONGEST_NAME} letters, digits, spaces, - _ .");
        return Err(Refusal::new("bad-request", why));
    }
    let Some((_, does)) = DOES.iter().find(|(known, _)| *known == word) else {
        let known = DOES.map(|(word, _)| word);
        return Err(Refusal::new("unknown", format!("do is one of {}", known.join(", "))));
    };
    let wrong = |what: String| Err(Refusal::new("bad-value", format!("{word}: {what}")));
    let request = match (*does, value) {
        (Does::Button(_) | Does::TakeSeat | Does::LeaveSeat, value) if !value.is_null() => {
            return wrong("has no value".into());
        }
        (Does::TakeSeat, _) => return Ok((name, Asked::TakeSeat)),
        (Does::LeaveSeat, _) => return Ok((name, Asked::LeaveSeat)),
        (Does::Button(request), _) => request,
        (Does::Hand(asks), value) => match asks(value) {
            Ok(hand) => {
                return Ok((name, Asked::Press(FromPanel { hand: Some(hand), ..FromPanel::default() })));
            }
            Err(what) => return wrong(what.into()),
        },
        (Does::Switch(request), Value::Bool(on)) => request(*on),
        (Does::Switch(_), _) => return wrong("value is true or false".into()),
        (Does::Knob(request, highest), value) => match value.as_f64() {
            Some(pct) if (0.0..=highest).contains(&pct) => request(pct),
            _ => return wrong(format!("value is per cent, 0 to {highest}")),
        },
    };
    let OperatorRequest { kind, value, .. } = OperatorRequest::pack(0, request);
    Ok((name, Asked::Press(FromPanel { kind, value, ..FromPanel::default() })))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Play;

    fn refused(text: &str) -> (Value, &'static str, String) {
        match read(text.as_bytes()) {
            (id, Err(Refusal { code, why })) => (id, code, why),
            (_, Ok(asked)) => panic!("{text}: {asked:?}"),
        }
    }

    #[test]
    fn every_word_is_a_request_that_the_machine_takes() {
        for (word, does) in DOES {
            let value = match does {
                Does::Switch(_) => ",\"value\":true",
                Does::Knob(..) => ",\"value\":62.5",
                Does::Hand(_) => match word {
                    "mdi" => ",\"value\":\"G0 X1\"",
                    "jog" => ",\"value\":{\"axis\":\"Z\",\"mm_min\":5,\"way\":\"-\"}",
                    "touch-off" => ",\"value\":{\"axis\":\"Z\",\"value\":-2.5,\"tool\":3}",
                    "offset" => ",\"value\":{\"of\":\"T3\",\"add\":{\"X\":-0.025}}",
                    "spindle" => ",\"value\":-300",
                    "home" => ",\"value\":\"Z\"",
                    "from" => ",\"value\":28",
                    "tool-change" => ",\"value\":3",
                    "play" => ",\"value\":0.5",
                    "step" => ",\"value\":100",
                    "seek" => ",\"value\":2.5",
                    _ => "",
                },
                _ => "",
            };
            let text = format!("{{\"id\":7,\"do\":\"{word}\",\"as\":\"me\"{value}}}");
            let (id, asked) = read(text.as_bytes());
            match (does, asked) {
                (Does::TakeSeat, asked) => assert_eq!(asked, Ok(("me".into(), Asked::TakeSeat))),
                (Does::LeaveSeat, asked) => assert_eq!(asked, Ok(("me".into(), Asked::LeaveSeat))),
                (Does::Hand(_), Ok((_, Asked::Press(press)))) => {
                    let wanted = match word {
                        "by-hand" => HandAsked::On,
                        "mdi" => HandAsked::Block("G0 X1".into()),
                        "jog" => HandAsked::Jog { axis: "Z".into(), positive: false, mm_min: 5.0 },
                        "jog-on" => HandAsked::JogOn,
                        "home" => HandAsked::Home("Z".into()),
                        "from" => HandAsked::From(Some(28)),
                        "tool-change" => HandAsked::ToolIn(3),
                        "play" => HandAsked::Play(Play::Speed(0.5)),
                        "step" => HandAsked::Play(Play::Step(100)),
                        "seek" => HandAsked::Play(Play::Seek(2.5)),
                        "touch-off" => HandAsked::TouchOff { axis: "Z".into(), value: -2.5, tool: Some(3) },
                        "offset" => {
                            HandAsked::Offset { of: "T3".into(), words: vec![('X', -0.025)], add: true }
                        }
                        _ => HandAsked::Spindle(-300.0),
                    };
                    assert_eq!(press.hand, Some(wanted), "{word}");
                }
                (_, Ok((_, Asked::Press(FromPanel { kind, value, .. })))) => {
                    let packet = OperatorRequest { kind, value, ..OperatorRequest::default() };
                    let request = packet.unpack().unwrap_or_else(|error| panic!("{word}: {error}"));
                    let wanted = match does {
                        Does::Button(request) => request,
                        Does::Switch(request) => request(true),
                        Does::Knob(request, _) => request(62.5),
                        _ => panic!("{word} is no press"),
                    };
                    assert_eq!((id, request), (Value::from(7), wanted), "{word}");
                }
                (_, asked) => panic!("{word}: {asked:?}"),
            }
        }
    }

    #[test]
    fn what_is_not_understood_is_refused_by_name() {
        let cases = [
            ("", "bad-request"),
            ("[]", "bad-request"),
            ("{\"id\":1}", "bad-request"),
            ("{\"id\":1,\"do\":\"hold\"}", "bad-request"),
            ("{\"id\":{},\"do\":\"hold\",\"as\":\"me\"}", "bad-request"),
            ("{\"id\":1,\"do\":5,\"as\":\"me\"}", "bad-request"),
            ("{\"id\":1,\"do\":\"hold\",\"as\":\"me\",\"more\":1}", "bad-request"),
            ("{\"id\":1,\"do\":\"hold\",\"as\":\"<b>\"}", "bad-request"),
            ("{\"id\":1,\"do\":\"hold\",\"as\":\"\"}", "bad-request"),
            ("{\"id\":1,\"do\":\"hold\",\"as\":\"me\",\"value\":1}", "bad-value"),
            ("{\"id\":1,\"do\":\"single-block\",\"as\":\"me\",\"value\":1}", "bad-value"),
            ("{\"id\":1,\"do\":\"feed-override\",\"as\":\"me\"}", "bad-value"),
            ("{\"id\":1,\"do\":\"feed-override\",\"as\":\"me\",\"value\":\"60\"}", "bad-value"),
            ("{\"id\":1,\"do\":\"feed-override\",\"as\":\"me\",\"value\":-1}", "bad-value"),
            ("{\"id\":1,\"do\":\"feed-override\",\"as\":\"me\",\"value\":200.1}", "bad-value"),
            ("{\"id\":1,\"do\":\"rapid-override\",\"as\":\"me\",\"value\":101}", "bad-value"),
            ("{\"id\":1,\"do\":\"feed-override\",\"as\":\"me\",\"value\":1e999}", "bad-request"),
            ("{\"id\":1,\"do\":\"offset\",\"as\":\"me\",\"value\":{\"of\":\"T3\"}}", "bad-value"),
            ("{\"id\":1,\"do\":\"offset\",\"as\":\"me\",\"value\":{\"of\":\"T3\",\"set\":{}}}", "bad-value"),
            (
                "{\"id\":1,\"do\":\"offset\",\"as\":\"me\",\"value\":{\"of\":\"T3\",\"set\":{\"X\":\"1\"}}}",
                "bad-value",
            ),
            (
                "{\"id\":1,\"do\":\"offset\",\"as\":\"me\",\"value\":{\"of\":\"T3\",\"set\":{\"X\":1},\"add\":{\"X\":1}}}",
                "bad-value",
            ),
            ("{\"id\":1,\"do\":\"home\",\"as\":\"me\"}", "bad-value"),
            ("{\"id\":1,\"do\":\"from\",\"as\":\"me\",\"value\":0}", "bad-value"),
            ("{\"id\":1,\"do\":\"from\",\"as\":\"me\",\"value\":\"28\"}", "bad-value"),
            ("{\"id\":1,\"do\":\"tool-change\",\"as\":\"me\"}", "bad-value"),
            ("{\"id\":1,\"do\":\"tool-change\",\"as\":\"me\",\"value\":-3}", "bad-value"),
            ("{\"id\":1,\"do\":\"play\",\"as\":\"me\",\"value\":-1}", "bad-value"),
            ("{\"id\":1,\"do\":\"step\",\"as\":\"me\",\"value\":0.5}", "bad-value"),
            ("{\"id\":1,\"do\":\"seek\",\"as\":\"me\"}", "bad-value"),
            ("{\"id\":1,\"do\":\"format\",\"as\":\"me\"}", "unknown"),
        ];
        for (text, code) in cases {
            let (_, told, why) = refused(text);
            assert_eq!(told, code, "{text}: {why}");
        }
        let deep = "[".repeat(100_000);
        assert_eq!(refused(&deep).1, "bad-request");
        let (id, _, why) = refused("{\"id\":\"a\",\"do\":\"go\",\"as\":\"me\"}");
        assert!(id == "a" && why.contains("take-seat"), "{why}");
    }
}
