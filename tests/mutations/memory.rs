//! Inputs that ask for much memory, made on purpose.
#![allow(clippy::print_stdout)] // `-- --nocapture` shows the figures of the page

use super::{JOB_MEMORY, PER_BYTE, targets};

/// Files of TOML: their tables are trees.
const TOML_PER_BYTE: u64 = 512;

/// The name of the program says that it is half a gigabyte long.
#[test]
fn the_length_of_a_name_is_no_promise_that_memory_is_taken_for() {
    let mut content = vec![252];
    content.extend((1u32 << 29).to_le_bytes());
    content.extend(b"mutated.ngc");
    let memory = allocation_counter::measure(|| targets::code_file(&content));
    assert!(memory.bytes_max < 10_000, "{} bytes", memory.bytes_max);
}

/// A small tool on a large surface: more places than are looked at, and more of its path than are kept.
#[test]
fn a_job_of_very_many_places_takes_no_more_memory_than_the_page_says() {
    let job = "[job]\nkind = \"surface\"\norigin_mm = [-50, -40, -170]\nz = \"x/50\"\nx = [0, 100]\ny = [0, 80]\n\
               tool = { kind = \"ball\", diameter_mm = 0.4 }\n\
               path = { pattern = \"lines\", along = \"x\", step_mm = 0.1 }\nfeed_mm_min = 1000\n";
    let memory = allocation_counter::measure(|| targets::job(job.as_bytes()));
    assert!((40 << 20..JOB_MEMORY).contains(&memory.bytes_max), "{} bytes", memory.bytes_max);
}

/// Bytes of the long files here.
const LONG: usize = 300_000;

/// A long text: a beginning, pieces with their number, an end.
fn long(begin: &str, piece: impl Fn(usize) -> String, end: &str) -> String {
    let mut text = begin.to_string();
    for number in 1.. {
        text += &piece(number);
        if text.len() >= LONG {
            break;
        }
    }
    text + end
}

/// Reads a text, which may be refused, within so many bytes for each of its bytes.
fn within(per_byte: u64, name: &str, text: &str, read: impl Fn(&str)) {
    let memory = allocation_counter::measure(|| read(text));
    let taken = memory.bytes_max as f64 / text.len() as f64;
    println!("{name}: {taken:.1} for each byte");
    assert!(memory.bytes_max <= per_byte * text.len() as u64, "{name}: {taken:.1} for each byte");
}

/// Tables of TOML that take much: the last two the most that is known.
#[test]
fn toml_takes_no_more_for_each_byte_than_the_page_says() {
    let texts = [
        ("keys", long("", |n| format!("k{n}=1\n"), "")),
        ("empty lists", long("a=[", |_| "[],".into(), "]\n")),
        ("numbers", long("a=[", |_| "1,".into(), "]\n")),
        ("tables of one", long("a=[", |_| "{a=1},".into(), "]\n")),
        ("headings", long("", |n| format!("[t{n}.a.b.c.d.e.f]\n"), "")),
        ("events", long("", |_| "[[event]]\n".into(), "")),
        ("dotted keys", long("", |n| format!("a{n}.b.c.d.e.f.g.h.i.j.k.l.m=1\n"), "")),
        ("dotted lists", long("a=[", |_| "{a.b.c.d.e.f.g.h=1},".into(), "]\n")),
    ];
    for (name, text) in texts {
        within(TOML_PER_BYTE, &format!("machine file, {name}"), &text, |text| {
            assert!(machine::Machine::from_toml(text).is_err());
        });
        within(TOML_PER_BYTE, &format!("scenario, {name}"), &text, |text| {
            drop(sim_plant::Scenario::from_toml(text));
        });
        within(TOML_PER_BYTE, &format!("part, {name}"), &text, |text| drop(machine::Part::from_toml(text)));
        within(TOML_PER_BYTE, &format!("language, {name}"), &text, |text| {
            drop(toml::from_str::<interpreter::Language>(text));
        });
        let job = format!("[job]\n{text}");
        within(TOML_PER_BYTE, &format!("job, {name}"), &job, |text| targets::job(text.as_bytes()));
    }
    let event = "[[event]]\nat={cycle=1}\nstop=true\n";
    within(TOML_PER_BYTE, "scenario", &long("", |_| event.into(), ""), |text| {
        assert!(sim_plant::Scenario::from_toml(text).is_ok());
    });
}

/// The short lists of a summary; and one with the most that each may have.
#[test]
fn a_summary_takes_no_more_for_each_byte_than_the_page_says() {
    let whole = String::from_utf8(super::kept::summaries().remove(0)).expect("text");
    let rest = whole.replacen('{', ",", 1);
    let read = |text: &str| serde_json::from_str::<rig::observe::Summary>(text).map(|_| ());
    for list in ["traces", "real_time", "pauses", "outputs", "warnings"] {
        let text = long(&format!("{{\"{list}\":["), |_| "{},".into(), "{}]") + &rest;
        within(PER_BYTE, list, &text, |text| assert!(read(text).is_err(), "{list}"));
    }
    let few = format!("{{\"traces\":[{}{{}}]{rest}", "{},".repeat(255));
    assert!(read(&few).is_ok(), "{:?}", read(&few));
    let tools = long("{\"tools\":{", |n| format!("\"{n}\":{{}},"), "\"0\":{}}") + &rest;
    within(PER_BYTE, "tools", &tools, |text| assert!(read(text).is_ok()));
    let files = long("{\"files\":{", |n| format!("\"{n}\":\"\","), "\"0\":\"\"}") + &rest;
    within(PER_BYTE, "files", &files, |text| drop(read(text)));
}

#[test]
fn tables_and_records_take_no_more_for_each_byte_than_the_page_says() {
    let tools = long("", |n| format!("T{n}P1\n"), "");
    within(PER_BYTE, "tool table", &tools, |text| drop(gcode::files::ToolTable::parse("a", text)));
    let parameters = long("", |n| format!("{n} 1\n"), "");
    within(PER_BYTE, "parameters", &parameters, |text| {
        drop(gcode::files::ParameterFile::parse("a", text));
    });
    for (name, ini) in [
        ("ini, headings", long("", |n| format!("[A{n}]\n"), "")),
        ("ini, keys", long("[A]\n", |n| format!("A{n}=\n"), "")),
    ] {
        within(PER_BYTE, name, &ini, |text| {
            drop(gcode::files::MachineFile::parse("a", text, std::path::Path::new("")));
        });
    }
    let arrivals = long("pitchlock arrivals 1\n", |_| "1 truth due\n".into(), "");
    within(PER_BYTE, "arrivals", &arrivals, |text| {
        assert!(rig::replay::Arrivals::from_text(text).is_ok());
    });
    let head = rig::replay::Arrivals::head(false, false, 1);
    for line in ["1 truth due\n", "\n"] {
        let live = long(&head, |n| rig::replay::Arrivals::live(n + 4, line), "");
        within(PER_BYTE, "live", &live, |text| drop(rig::replay::Arrivals::left(text.as_bytes())));
    }
    let touches = long("", |n| format!("{n} 1\n"), "");
    within(PER_BYTE, "touches", &touches, |text| drop(gauge::pickup::touches(text)));
}
