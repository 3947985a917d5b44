//! Tables. In: rows and columns. Out: text with columns under each other, or HTML.

use maud::{Markup, html};

/// One column: its name, its unit (or nothing), and the cell of a row.
pub struct Column<R> {
    /// What stands above it.
    pub name: &'static str,
    /// Its unit, or nothing.
    pub unit: &'static str,
    /// What it shows of a row.
    pub cell: fn(&R) -> String,
}

/// Where a table is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// On the screen and on the page.
    Everywhere,
    /// On the page.
    Page,
    /// On the page, folded up until it is asked for: tables of many rows.
    Details,
}

/// A table as it is shown.
pub struct Table {
    /// What stands above it.
    pub title: String,
    /// How to read it; on the page alone.
    pub caption: String,
    /// Name and unit of each column.
    pub head: Vec<[String; 2]>,
    /// As many cells in each row.
    pub rows: Vec<Vec<String>>,
    /// Where it is shown.
    pub place: Place,
}

impl Table {
    /// A table everywhere, of rows seen through columns.
    pub fn of<R>(title: &str, columns: &[Column<R>], rows: &[R]) -> Table {
        Table {
            title: title.into(),
            caption: String::new(),
            head: columns.iter().map(|column| [column.name, column.unit].map(str::to_owned)).collect(),
            rows: rows.iter().map(|row| columns.iter().map(|column| (column.cell)(row)).collect()).collect(),
            place: Place::Everywhere,
        }
    }

    /// The table with a caption.
    pub fn with_caption(self, caption: impl Into<String>) -> Table {
        Table { caption: caption.into(), ..self }
    }

    /// The table in another place.
    pub fn at(self, place: Place) -> Table {
        Table { place, ..self }
    }

    /// The table for a terminal, every line with its end; columns are flush right.
    pub fn text(&self) -> String {
        let head = [0, 1].map(|line| self.head.iter().map(|column| column[line].clone()).collect());
        let lines: Vec<Vec<String>> = head.into_iter().chain(self.rows.iter().cloned()).collect();
        let width = |column: usize| {
            let cells = lines.iter().filter_map(|line| line.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let line = |cells: &Vec<String>| {
            let cells: Vec<_> =
                cells.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
            format!("{}\n", cells.join("  ").trim_end())
        };
        lines.iter().map(line).collect()
    }

    /// The table for a page.
    pub fn markup(&self) -> Markup {
        html! {
            div.scroll tabindex="0" role="region" aria-label=(self.title) {
                table {
                    thead { tr { @for [name, unit] in &self.head { th scope="col" { (name) small { (unit) } } } } }
                    tbody { @for row in &self.rows { tr { @for cell in row { td { (cell) } } } } }
                }
            }
        }
    }
}

/// A number in six significant digits, without zeros at its end.
pub fn six(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().unwrap_or(value).to_string()
}

/// Three significant digits, small ones as powers of ten.
pub fn three(value: f64) -> String {
    if value == 0.0 || (1e-2..1e6).contains(&value.abs()) {
        return format!("{value:.2e}").parse::<f64>().unwrap_or(value).to_string();
    }
    let (digits, power) = format!("{value:.2e}").split_once('e').map_or_else(
        || (value.to_string(), String::from("0")),
        |(digits, power)| (digits.trim_end_matches('0').trim_end_matches('.').to_owned(), power.to_owned()),
    );
    format!("{digits}e{power}")
}

#[cfg(test)]
mod tests {
    use super::{Column, Table, six, three};

    #[test]
    fn numbers_have_six_digits_at_most() {
        let shown = [0.0, 0.1 + 0.2, 4.017_538_767, -78.539_816, 1_234_567.0].map(six);
        assert_eq!(shown, ["0", "0.3", "4.01754", "-78.5398", "1234570"]);
    }

    #[test]
    fn small_numbers_are_powers_of_ten() {
        let shown = [0.0, 0.012_345, 123.456, 2.5e-6, -1e-9, 12_345_678.0].map(three);
        assert_eq!(shown, ["0", "0.0123", "123", "2.5e-6", "-1e-9", "1.23e7"]);
    }

    #[test]
    fn columns_stand_under_each_other() {
        let columns: [Column<f64>; 2] = [
            Column { name: "way", unit: "m", cell: |row| six(*row) },
            Column { name: "a", unit: "m/s²", cell: |row| six(row * 2.0) },
        ];
        let table = Table::of("ways", &columns, &[0.25, 1000.0]);
        assert_eq!(table.text(), " way     a\n   m  m/s²\n0.25   0.5\n1000  2000\n");
    }
}
