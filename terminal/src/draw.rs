//! The picture. In: what is seen and typed. Out: characters. Positions in mm, of the work X of a lathe as a
//! diameter; what does not fit is left out from below.

use ratatui::{
    Frame,
    layout::{Constraint, Layout, Position, Rect},
    style::{Color, Modifier, Style},
    text::{Line, Span},
    widgets::{Paragraph, Wrap},
};
use serde_json::Value;

use crate::{
    desk::{Desk, SMALLEST, acts_unseen, is_small, plain},
    keys::{Does, KEYS},
};

/// Columns of positions and passes.
const LEFT: u16 = 54;
/// Most rows of faults and messages.
const TOLD: usize = 6;
/// Most rows of what came of the last request, and so much of a row may be left free by a long word.
const SAID: usize = 3;
const WORD: u16 = 12;

const BOLD: Style = Style::new().add_modifier(Modifier::BOLD);
const DIM: Style = Style::new().add_modifier(Modifier::DIM);
const HEAD: Style = Style::new().fg(Color::Cyan);

fn coloured(colour: Color) -> Style {
    BOLD.fg(colour)
}

/// Draws all of it.
pub fn draw(frame: &mut Frame, desk: &Desk) {
    let area = frame.area();
    if is_small(area.as_size()) {
        let [width, height] = SMALLEST;
        let need = format!("{width} by {height} characters at least; {}", desk.text("words"));
        let acts = KEYS.iter().filter(|key| acts_unseen(key.does));
        let acts: Vec<_> = acts.map(|key| format!("{} {}", key.name, key.words)).collect();
        let rows = [need, format!("here act: {}", acts.join(", ")), desk.said().1.to_owned()]
            .map(Line::from)
            .to_vec();
        return frame.render_widget(Paragraph::new(rows).wrap(Wrap { trim: true }), area);
    }
    let (keys, told) = (keys(desk, area.width), messages(desk));
    let typed = u16::from(desk.line().is_some()) + said_rows(desk, area.width);
    let rows = [
        Constraint::Length(4),
        Constraint::Fill(1),
        Constraint::Length(told.len().min(TOLD) as u16),
        Constraint::Length(typed.max(1)),
        Constraint::Length(keys.len() as u16),
    ];
    let [top, middle, below, typed, shown] = Layout::vertical(rows).areas(area);
    let columns = [Constraint::Length(LEFT), Constraint::Length(1), Constraint::Fill(1)];
    let [left, _, right] = Layout::horizontal(columns).areas(middle);
    frame.render_widget(Paragraph::new(head(desk)), top);
    frame.render_widget(Paragraph::new(machine(desk)), left);
    frame.render_widget(Paragraph::new(program(desk, right)), right);
    frame.render_widget(Paragraph::new(told), below);
    line(frame, desk, typed);
    frame.render_widget(Paragraph::new(keys), shown);
}

/// A number with so many digits; nothing where it is not known.
fn number(value: &Value, digits: usize) -> String {
    value.as_f64().map_or_else(|| "–".into(), |value| fixed(value, digits))
}

fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    // No −0.000.
    if text.trim_start_matches('-').chars().all(|letter| "0.".contains(letter)) {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

fn word(value: &Value) -> String {
    plain(value.as_str().unwrap_or_default())
}

/// Whose machine it is, what it does, what it waits for.
fn head(desk: &Desk) -> Vec<Line<'static>> {
    let (machine, program) = (desk.field("machine"), desk.field("program"));
    let parts = [word(&machine["name"]), word(&program["name"]), word(&program["folder"])];
    let mut names: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    names.extend(machine["pace"].as_str().map(|pace| format!("pace {}", plain(pace))));
    let seat = match desk.field("seat").as_str() {
        _ if desk.holds() => Span::styled("you hold the keys", coloured(Color::Green)),
        Some(name) => Span::styled(format!("{} holds the keys: you watch", plain(name)), BOLD),
        None => Span::styled("nobody holds the keys", BOLD),
    };
    let live = match desk.why_gone() {
        None => Span::styled("live", coloured(Color::Green)),
        Some(why) => Span::styled(format!("not connected: {why}"), coloured(Color::Red)),
    };
    let first = Line::from(vec![live, "  ".into(), seat, "  ".into(), names.join(" · ").into()]);
    let state = desk.field("state").as_str().unwrap_or_default();
    let style = match state {
        "fault" | "emergency-stop" => coloured(Color::Red),
        "held" | "holding" | "paused" | "tool-change" | "stopping" => coloured(Color::Yellow),
        _ => BOLD,
    };
    let outcome = desk.field("outcome").as_str().filter(|_| state == "ready");
    let words = outcome.map(|outcome| format!("{outcome}; ")).unwrap_or_default() + &desk.text("words");
    let second =
        Line::from(vec![Span::styled(format!("{:<12}", desk.mode()), HEAD), Span::styled(words, style)]);
    vec![first, second, Line::from(whereabouts(desk)), Line::styled(waits_for(desk), coloured(Color::Yellow))]
}

/// Time, pass, tool, how much is done.
fn whereabouts(desk: &Desk) -> String {
    let mut parts = Vec::new();
    if let Some(time_s) = desk.field("time_s").as_f64() {
        parts.push(format!("{time_s:.1} s, cycle {}", desk.field("cycle")));
    }
    if desk.field("pass").as_u64().is_some_and(|pass| pass > 0) {
        let depth = number(desk.field("depth_mm"), 3);
        let by_hand = desk.field("by_hand").is_object();
        let of = if by_hand { String::new() } else { format!(" of {}", desk.field("program")["passes"]) };
        parts.push(format!("pass {}{of}, {depth} deep", desk.field("pass")));
    }
    let goes = desk.field("by_hand").is_null() && desk.mode() != "off";
    if let Some(left_s) = desk.field("left_s").as_f64().filter(|_| goes) {
        parts.push(format!("{}:{:02} to go", (left_s / 60.0) as u64, left_s as u64 % 60));
    }
    if desk.field("tool").as_u64().is_some_and(|tool| tool > 0) {
        parts.push(format!("T{} {}", desk.field("tool"), desk.text("tool_name")).trim_end().to_owned());
    }
    for (field, words) in [("single_block", "single block"), ("held", "hold is pressed")] {
        parts.extend((desk.field(field) == true).then(|| words.to_owned()));
    }
    parts.extend((desk.field("optional_stop") == false).then(|| "passes M1".to_owned()));
    parts.extend(Some(desk.text("coolant")).filter(|coolant| !coolant.is_empty()));
    let not_kept = desk.field("recording") == false;
    parts.extend(not_kept.then(|| "too many presses: this session cannot be repeated".to_owned()));
    if let Some(of) = desk.field("playback")["of"].as_str() {
        let until = number(&desk.field("playback")["until_s"], 1);
        parts.push(format!("recording of {}, {until} s", plain(of)));
    }
    parts.join(" · ")
}

/// What the program or the machine wants of somebody; what begins where; what is in force by hand.
fn waits_for(desk: &Desk) -> String {
    if let Some(prompt) = desk.field("prompt").as_str() {
        return plain(prompt);
    }
    let from = desk.field("from");
    if from.is_object() {
        let (words, force) = (word(&from["words"]), word(&from["in_force"]));
        return format!("start begins at line {}: {words}; {force}", from["from"]);
    }
    let force = word(&desk.field("by_hand")["in_force"]);
    if force.is_empty() { force } else { format!("in force: {force}") }
}

/// Positions, spindle, overrides, passes.
fn machine(desk: &Desk) -> Vec<Line<'static>> {
    let of = match (desk.is_of_machine(), desk.field("origin_mm").is_array()) {
        (true, _) => "machine",
        (false, true) => "work",
        (false, false) => "machine, ⌀",
    };
    let titles = ["measured", "to go", "commanded", "error µm", "load"];
    let [measured, to_go, commanded, error, load] = titles;
    let head = format!("{of:<10}{measured:>10}{to_go:>9}{commanded:>10}{error:>9}{load:>5}");
    let mut lines = vec![Line::styled(head, HEAD)];
    lines.extend(desk.field("axes").as_array().into_iter().flatten().map(|axis| position(desk, axis)));
    let (spindle, knobs) = (desk.field("spindle"), desk.field("knobs"));
    lines.push(Line::from(vec![
        Span::styled("spindle   ", HEAD),
        Span::styled(format!("{:>7}", number(&spindle["rpm"], 0)), BOLD),
        format!(
            " 1/min  commanded {}  {}°  load {} %",
            number(&spindle["commanded_rpm"], 0),
            number(&spindle["angle_deg"], 0),
            number(&spindle["load_pct"], 0)
        )
        .into(),
    ]));
    let knob = |name: &str| {
        let (at, force) = (&knobs[format!("{name}_pct")], &knobs[format!("{name}_in_force_pct")]);
        let other = at.as_f64().zip(force.as_f64()).filter(|(at, force)| (at - force).abs() > 0.5);
        let force = other.map(|(_, force)| format!(" ({force:.0})")).unwrap_or_default();
        format!("{name} {} %{force}  ", number(at, 0))
    };
    let all = ["spindle", "feed", "rapid"].map(knob).concat();
    lines.push(Line::from(vec![Span::styled("override  ", HEAD), all.into()]));
    lines.push(Line::from(vec![Span::styled("keys      ", HEAD), desk.jog_words().into()]));
    lines.extend(passes(desk));
    lines
}

/// A row of an axis.
fn position(desk: &Desk, axis: &Value) -> Line<'static> {
    let name = word(&axis["name"]);
    let of_work = !desk.is_of_machine();
    let origin = match name.as_str() {
        "X" => desk.field("origin_mm")[0].as_f64(),
        "Z" => desk.field("origin_mm")[1].as_f64(),
        _ => None,
    };
    let zero = origin.filter(|_| of_work).unwrap_or_default();
    let across = if name == "X" && of_work && desk.is_lathe() { 2.0 } else { 1.0 };
    let place =
        |field: &str| axis[field].as_f64().map_or_else(|| "–".into(), |mm| fixed((mm - zero) * across, 3));
    let to_go = axis["to_go_mm"].as_f64().map_or_else(|| "–".into(), |mm| fixed(mm * across, 3));
    let shown = if across > 1.0 { format!("{name} ⌀") } else { name };
    let lost = if axis["referenced"] == false { "  not referenced" } else { "" };
    Line::from(vec![
        Span::styled(format!("{shown:<10}"), HEAD),
        Span::styled(format!("{:>10}", place("measured_mm")), BOLD),
        format!(
            "{to_go:>9}{:>10}{:>9}{:>4}%",
            place("commanded_mm"),
            number(&axis["error_um"], 1),
            number(&axis["load_pct"], 0)
        )
        .into(),
        lost.into(),
    ])
}

/// Passes, the one in hand first, then the newest.
fn passes(desk: &Desk) -> Vec<Line<'static>> {
    let cutting = desk.field("cutting");
    let over = desk.field("passes").as_array().into_iter().flatten().rev();
    let all: Vec<&Value> = Some(cutting).filter(|pass| pass.is_object()).into_iter().chain(over).collect();
    if all.is_empty() {
        return Vec::new();
    }
    let titles = ["pass", "depth", "1/min", "helix µm", "phase µm", "end"];
    let row = |[pass, depth, rpm, helix, phase, end]: [&str; 6]| {
        format!("{pass:<6}{depth:>8}{rpm:>12}{helix:>9}{phase:>9}  {end}")
    };
    let mut lines = vec![Line::default(), Line::styled(row(titles), HEAD)];
    lines.extend(all.into_iter().map(|pass| {
        let of_cut = |field: &str| if pass["cut"] == true { number(&pass[field], 1) } else { String::new() };
        let rpm = format!("{}–{}", number(&pass["rpm"][0], 0), number(&pass["rpm"][1], 0));
        let (depth, end) = (number(&pass["depth_mm"], 3), word(&pass["end"]));
        let cells = [&pass["pass"].to_string(), &depth, &rpm, &of_cut("helix_um"), &of_cut("phase_um"), &end];
        let style = if pass["end"] == "now" { BOLD } else { Style::new() };
        Line::styled(row(cells.map(|cell| cell.as_str())), style)
    }));
    lines
}

/// The program round the running line.
fn program(desk: &Desk, area: Rect) -> Vec<Line<'static>> {
    let text = desk.program();
    if text.is_empty() {
        let no_text = "no text of the program is known here";
        return vec![Line::styled(no_text, DIM)];
    }
    let from = desk.field("from")["from"].as_u64();
    // Those of work by hand before are no lines of it.
    let line = desk.field("line").as_u64().filter(|_| desk.field("blocks") != true);
    let running = from.or(line).unwrap_or_default() as usize;
    let rows = usize::from(area.height);
    let first = running.saturating_sub(1 + rows / 2).min(text.len().saturating_sub(rows));
    let shown = text.iter().enumerate().skip(first).take(rows);
    shown
        .map(|(at, line)| {
            let now = at + 1 == running;
            let mark = if now { ">" } else { " " };
            let style = if now { BOLD.add_modifier(Modifier::REVERSED) } else { Style::new() };
            Line::from(vec![
                Span::styled(format!("{mark}{:>5} ", at + 1), DIM),
                Span::styled(line.clone(), style),
            ])
        })
        .collect()
}

/// Of a run that is over, whether the part is good; faults with what to look at, then messages, the newest
/// first.
fn messages(desk: &Desk) -> Vec<Line<'static>> {
    let all = |field: &str| desk.field(field).as_array().cloned().unwrap_or_default();
    let mut lines = Vec::new();
    let part = desk.field("part");
    if let Some(verdict) = part["verdict"].as_str() {
        let (words, colour) = match verdict {
            "good" => ("the part is good", Color::Green),
            "bad" => ("the part is not good", Color::Red),
            _ => ("the part is not judged", Color::Yellow),
        };
        let why: Vec<_> = part["words"].as_array().into_iter().flatten().map(word).collect();
        let words = [&[words.to_owned()], &why[..]].concat().join(": ");
        lines.push(Line::styled(words, coloured(colour)));
    }
    lines.push(Line::styled("faults and messages", HEAD));
    let head = lines.len();
    for fault in all("faults") {
        let [source, code, text] = ["source", "code", "text"].map(|field| word(&fault[field]));
        lines.push(Line::styled(format!("{source} {code}: {text}"), coloured(Color::Red)));
        let remedy = word(&fault["remedy"]);
        lines.extend(Some(format!("  look at: {remedy}")).filter(|_| !remedy.is_empty()).map(Line::from));
    }
    let of = if desk.field("blocks") == true { "block" } else { "line" };
    let told = |message: &Value| Line::from(format!("{of} {}: {}", message["line"], word(&message["text"])));
    lines.extend(all("messages").iter().rev().map(told));
    if lines.len() == head {
        lines.push(Line::styled("none", DIM));
    }
    lines
}

/// Rows of what came of the last request: why it was refused is read to its end.
fn said_rows(desk: &Desk, width: u16) -> u16 {
    let letters = Line::from(desk.said().1).width();
    // Words go to the next row whole.
    letters.div_ceil(usize::from(width.saturating_sub(WORD)).max(1)).min(SAID) as u16
}

/// What is typed, and below it what came of the last request.
fn line(frame: &mut Frame, desk: &Desk, area: Rect) {
    let rows = [Constraint::Length(u16::from(desk.line().is_some())), Constraint::Fill(1)];
    let [area, below] = Layout::vertical(rows).areas(area);
    let (refused, said) = desk.said();
    let style = if refused { coloured(Color::Red) } else { BOLD };
    let said = Paragraph::new(Line::styled(said.to_owned(), style)).wrap(Wrap { trim: true });
    frame.render_widget(said, below);
    let Some(line) = desk.line() else { return };
    let what = if line.is_block { "block> " } else { "request> " };
    let room = usize::from(area.width).saturating_sub(what.chars().count() + 1);
    let skipped = line.text.chars().count().saturating_sub(room);
    let text: String = line.text.chars().skip(skipped).collect();
    let at = (what.chars().count() + text.chars().count()) as u16;
    let shown = Line::from(vec![Span::styled(what, HEAD), text.into()]);
    frame.render_widget(Paragraph::new(shown), area);
    frame.set_cursor_position(Position::new(area.x + at.min(area.width.saturating_sub(1)), area.y));
}

/// All keys, those that do the same side by side, in as many rows as they need.
fn keys(desk: &Desk, width: u16) -> Vec<Line<'static>> {
    let mut shown: Vec<(String, String)> = Vec::new();
    for key in KEYS {
        let words = match key.does {
            Does::Jog(at, _) if desk.axis(at).is_empty() => continue,
            Does::Jog(at, _) => format!("jog {}", desk.axis(at)),
            _ => key.words.to_owned(),
        };
        match shown.last_mut() {
            Some((names, same)) if *same == words => *names += &format!(" {}", key.name),
            _ => shown.push((key.name.to_owned(), words)),
        }
    }
    if desk.line().is_some() {
        shown =
            [("Enter", "does it"), ("Esc", "leaves the line"), ("↑", "the one before"), ("Ctrl-C", "end")]
                .map(|(name, words)| (name.to_owned(), words.to_owned()))
                .to_vec();
    }
    let mut rows: Vec<Vec<Span>> = vec![Vec::new()];
    let mut used = 0;
    for (names, words) in shown {
        let more = names.chars().count() + words.chars().count() + 3;
        if used + more > usize::from(width) {
            rows.push(Vec::new());
            used = 0;
        }
        used += more;
        let row = rows.last_mut().expect("there is one");
        row.extend([Span::styled(names, BOLD), Span::raw(format!(" {words}  "))]);
    }
    let mut lines: Vec<Line> = rows.into_iter().map(Line::from).collect();
    lines.push(Line::styled(
        "This is software and no emergency stop: that is a button wired to the drives.",
        DIM,
    ));
    lines
}
