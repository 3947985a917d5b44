//! The tables of the language pages, which are the one place where words are explained: whoever reads them in
//! an editor reads what the pages say, and the tests of the pages hold them against the sources.

use std::sync::OnceLock;

/// A row of a table.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) page: &'static str,
    /// The heading it stands below.
    pub(crate) section: &'static str,
    /// What the columns are called.
    pub(crate) head: Vec<&'static str>,
    pub(crate) cells: Vec<&'static str>,
}

const PAGES: [(&str, &str); 6] = [
    ("gcode.md", include_str!("../../docs/gcode.md")),
    ("gcode-parameters.md", include_str!("../../docs/gcode-parameters.md")),
    ("gcode-cycles.md", include_str!("../../docs/gcode-cycles.md")),
    ("gcode-compensation.md", include_str!("../../docs/gcode-compensation.md")),
    ("gcode-fanuc.md", include_str!("../../docs/gcode-fanuc.md")),
    ("gcode-fanuc-mill.md", include_str!("../../docs/gcode-fanuc-mill.md")),
];

/// Every row of every table.
pub(crate) fn rows() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| PAGES.iter().flat_map(|(page, text)| rows_of(page, text)).collect())
}

fn rows_of(page: &'static str, text: &'static str) -> Vec<Row> {
    let mut rows = Vec::new();
    let (mut section, mut head) = ("", None);
    for line in text.lines() {
        if let Some(heading) = line.strip_prefix("## ").or_else(|| line.strip_prefix("### ")) {
            section = heading;
        }
        let cells = line.strip_prefix('|').and_then(|line| line.strip_suffix('|'));
        let Some(cells) = cells.map(|cells| cells.split('|').map(str::trim).collect::<Vec<_>>()) else {
            head = None;
            continue;
        };
        match &head {
            None => head = Some(cells),
            Some(_) if cells.iter().all(|cell| cell.starts_with("---")) => {}
            Some(head) => rows.push(Row { page, section, head: head.clone(), cells }),
        }
    }
    rows
}

/// The rows of the tables below a heading.
pub(crate) fn below(page: &str, section: &str) -> impl Iterator<Item = &'static Row> {
    rows().iter().filter(move |row| row.page == page && row.section == section)
}

impl Row {
    /// The words of its first cell.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.cells
            .first()
            .into_iter()
            .flat_map(|cell| cell.split([' ', ',', '`']))
            .filter(|name| !name.is_empty())
    }

    /// Whether one of its cells has a letter among its words.
    pub(crate) fn has(&self, cell: usize, letter: char) -> bool {
        let words = self.cells.get(cell).map(|cell| cell.split([' ', ',', '`']));
        words.is_some_and(|mut words| words.any(|word| word.chars().eq([letter])))
    }

    /// Its last cell.
    pub(crate) fn meaning(&self) -> String {
        self.cells.last().map(|cell| plain(cell)).unwrap_or_default()
    }

    /// The sections of the language pages that it leads to: page and heading.
    pub(crate) fn leads(&self) -> Vec<(&'static str, &'static str)> {
        let mut leads = Vec::new();
        for link in self.cells.iter().flat_map(|cell| cell.split("](").skip(1)) {
            let Some((target, _)) = link.split_once(')') else { continue };
            let (page, anchor) = target.split_once('#').unwrap_or((target, ""));
            let page = if page.is_empty() { self.page } else { page };
            let found = rows().iter().find(|row| row.page == page && slug(row.section) == anchor);
            leads.extend(found.map(|row| (row.page, row.section)));
        }
        leads
    }

    /// What it says, for people: each cell behind the first under the name of its column.
    pub(crate) fn told(&self) -> String {
        let cells = self.head.iter().zip(&self.cells).skip(1).filter(|(_, cell)| !cell.is_empty());
        let told = |(head, cell): (&&str, &&str)| match *head {
            "" | "meaning" | "what" => plain(cell),
            head => format!("*{}:* {}", plain(head), plain(cell)),
        };
        cells.map(told).collect::<Vec<_>>().join("  \n")
    }
}

fn slug(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-');
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// A cell without its links: they lead to places that an editor does not know.
fn plain(cell: &str) -> String {
    let mut text = String::new();
    let mut rest = cell;
    while let Some((before, after)) = rest.split_once("](") {
        let Some((_, behind)) = after.split_once(')') else { break };
        match before.rsplit_once('[') {
            Some((head, name)) => text.extend([head, name]),
            None => text.push_str(before),
        }
        rest = behind;
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::{below, plain, rows};

    #[test]
    fn tables_are_found_and_lead_on() {
        assert!(rows().len() > 150, "{}", rows().len());
        let thread = below("gcode.md", "G codes").find(|row| row.names().any(|name| name == "G76"));
        let thread = thread.expect("there is a row");
        assert_eq!(thread.leads(), [("gcode-cycles.md", "Threads")]);
        assert_eq!(plain("see [arcs](gcode-cycles.md#arcs), and [more](x)"), "see arcs, and more");
    }
}
