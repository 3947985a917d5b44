//! The pictures of `docs/panel.md`: each is made by the test that is named below it, and small.

use std::fs;

use crate::shop::project;

/// Most bytes of a picture.
const MOST: usize = 60_000;

/// The tests of the panel.
fn sources() -> String {
    let files = fs::read_dir(project().join("tests/command/panel")).expect("a folder").flatten();
    let texts = files.map(|file| fs::read_to_string(file.path()).expect("a source"));
    texts.collect::<Vec<_>>().join("\n")
}

/// Name of each picture on the page, and the test below it.
fn shown() -> Vec<(String, String)> {
    let page = fs::read_to_string(project().join("docs/panel.md")).expect("the page");
    let mut lines = page.lines().filter(|line| !line.is_empty());
    let mut all = Vec::new();
    while let Some(line) = lines.next() {
        let Some(name) = line.strip_prefix("![").and_then(|rest| rest.split_once(".webp)")) else { continue };
        let name = name.0.rsplit_once("](").expect("an address").1.to_owned();
        let below = lines.next().unwrap_or_default();
        let test = below.strip_prefix("*Made by `").and_then(|rest| rest.strip_suffix("`.*"));
        all.push((name, test.unwrap_or_else(|| panic!("{below}: which test makes it?")).to_owned()));
    }
    all
}

#[test]
fn every_picture_is_made_by_the_test_that_the_page_names() {
    let (sources, shown) = (sources(), shown());
    for (name, test) in &shown {
        let begin =
            sources.find(&format!("fn {test}()")).unwrap_or_else(|| panic!("there is no test {test}"));
        let body = sources[begin..].split("\n}\n").next().unwrap_or_default();
        assert!(body.contains(&format!(".picture(\"{name}\"")), "{test} does not make {name}");
        let bytes = fs::read(project().join(format!("docs/{name}.webp"))).expect("it is there");
        assert!(bytes.starts_with(b"RIFF") && bytes[8..].starts_with(b"WEBP"), "{name}");
        assert!(bytes.len() < MOST, "{name}: {} bytes", bytes.len());
    }
    let made: Vec<_> =
        sources.split("picture(\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let names: Vec<_> = shown.iter().map(|(name, _)| name.as_str()).collect();
    assert!(!names.is_empty());
    for name in made {
        assert!(names.contains(&name), "{name} is made, and not shown on the page");
    }
}
