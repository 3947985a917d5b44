//! Rows as a table. In: rows of an experiment and its columns. Out: text with columns under each other, or HTML.

use maud::{Markup, html};

/// One column: its name, its unit (or nothing), and the cell of a row.
pub(super) struct Column<R> {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) cell: fn(&R) -> String,
}

/// Name, unit and cells of a column, one below the other.
fn lines<R>(column: &Column<R>, rows: &[R]) -> Vec<String> {
    let head = [column.name, column.unit].map(str::to_owned);
    head.into_iter().chain(rows.iter().map(column.cell)).collect()
}

/// The table for a terminal, every line with its end; columns are flush right.
pub(super) fn text<R>(columns: &[Column<R>], rows: &[R]) -> String {
    let mut table = vec![String::new(); rows.len() + 2];
    for column in columns {
        let lines = lines(column, rows);
        let width = lines.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        for (line, cell) in table.iter_mut().zip(lines) {
            let gap = if line.is_empty() { "" } else { "  " };
            *line += &format!("{gap}{cell:>width$}");
        }
    }
    table.iter().map(|line| format!("{line}\n")).collect()
}

/// The table for a page.
pub(super) fn markup<R>(columns: &[Column<R>], rows: &[R]) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table of rows" {
            table {
                thead { tr { @for column in columns {
                    th scope="col" { (column.name) small { (column.unit) } }
                } } }
                tbody { @for row in rows { tr { @for column in columns { td { ((column.cell)(row)) } } } } }
            }
        }
    }
}

/// A number in six significant digits, without zeros at its end.
pub(super) fn six(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().unwrap_or(value).to_string()
}

#[cfg(test)]
mod tests {
    use super::{Column, six, text};

    #[test]
    fn numbers_have_six_digits_at_most() {
        let shown = [0.0, 0.1 + 0.2, 4.017_538_767, -78.539_816, 1_234_567.0].map(six);
        assert_eq!(shown, ["0", "0.3", "4.01754", "-78.5398", "1234570"]);
    }

    #[test]
    fn columns_stand_under_each_other() {
        let columns: [Column<f64>; 2] = [
            Column { name: "way", unit: "m", cell: |row| six(*row) },
            Column { name: "a", unit: "m/s²", cell: |row| six(row * 2.0) },
        ];
        assert_eq!(text(&columns, &[0.25, 1000.0]), " way     a\n   m  m/s²\n0.25   0.5\n1000  2000\n");
    }
}
