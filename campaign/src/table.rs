//! Rows as Parquet. In: rows, twice, and the names that come first. Out: one file: a column for each name,
//! of the kind that holds all of its values, in the order of the names; what a row has not is null. The same
//! rows make the same bytes, and no more of them than one group are held at a time.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use serde_json::Value;

use crate::rows::Row;

/// Rows that are written as one group, and so many are in memory.
const GROUP: usize = 5_000;

/// What a column holds, from the narrowest on: a column of several kinds has the first that holds all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Nothing,
    Truth,
    Whole,
    Number,
    Text,
}

impl Kind {
    fn of(value: &Value) -> Kind {
        match value {
            Value::Null => Kind::Nothing,
            Value::Bool(_) => Kind::Truth,
            Value::Number(number) if number.is_i64() => Kind::Whole,
            Value::Number(number) if number.is_f64() => Kind::Number,
            _ => Kind::Text,
        }
    }

    fn and(self, other: Kind) -> Kind {
        match (self, other) {
            (one, Kind::Nothing) | (Kind::Nothing, one) => one,
            (one, same) if one == same => one,
            (Kind::Whole, Kind::Number) | (Kind::Number, Kind::Whole) => Kind::Number,
            _ => Kind::Text,
        }
    }

    fn field(self, name: &str) -> Result<Type, ParquetError> {
        let (physical, converted) = match self {
            Kind::Truth => (Physical::BOOLEAN, ConvertedType::NONE),
            Kind::Whole => (Physical::INT64, ConvertedType::NONE),
            Kind::Number => (Physical::DOUBLE, ConvertedType::NONE),
            Kind::Text | Kind::Nothing => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
        };
        let field = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        field.with_converted_type(converted).build()
    }
}

/// What is in the rows of a table, known before its first row is written.
#[derive(Debug, Default)]
pub struct Columns(BTreeMap<String, Kind>);

impl Columns {
    /// Sees a row that will be in the table.
    pub fn see(&mut self, row: &Row) {
        for (name, value) in row {
            let kind = Kind::of(value);
            match self.0.get_mut(name) {
                Some(known) => *known = known.and(kind),
                None => drop(self.0.insert(name.clone(), kind)),
            }
        }
    }

    /// `first` are the names that come first; the others follow by the alphabet.
    fn ordered(mut self, first: &[String]) -> Vec<(String, Kind)> {
        let mut columns: Vec<_> = first.iter().filter_map(|name| self.0.remove_entry(name)).collect();
        columns.extend(self.0);
        columns
    }
}

/// A file that rows are written to.
pub struct Table<W: Write + Send> {
    file: SerializedFileWriter<W>,
    columns: Vec<(String, Kind)>,
    waiting: Vec<Row>,
}

impl<W: Write + Send> Table<W> {
    /// Begins a file. `seen` has seen every row that will be pushed; `first` are the names of the columns
    /// that come first.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(to: W, seen: Columns, first: &[String]) -> Result<Self, ParquetError> {
        let columns = seen.ordered(first);
        let fields = columns.iter().map(|(name, kind)| kind.field(name).map(Arc::new));
        let fields = fields.collect::<Result<Vec<_>, _>>()?;
        let schema = Arc::new(Type::group_type_builder("row").with_fields(fields).build()?);
        let made_by = concat!("pitchlock ", env!("CARGO_PKG_VERSION")).into();
        let properties = Arc::new(WriterProperties::builder().set_created_by(made_by).build());
        Ok(Self { file: SerializedFileWriter::new(to, schema, properties)?, columns, waiting: Vec::new() })
    }

    /// The next row.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn push(&mut self, row: Row) -> Result<(), ParquetError> {
        self.waiting.push(row);
        if self.waiting.len() < GROUP { Ok(()) } else { self.group() }
    }

    /// The file is whole.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end(mut self) -> Result<(), ParquetError> {
        if !self.waiting.is_empty() {
            self.group()?;
        }
        self.file.close().map(drop)
    }

    fn group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        for (name, kind) in &self.columns {
            let mut column =
                group.next_column()?.ok_or_else(|| ParquetError::General("a column too few".into()))?;
            let values = self.waiting.iter().map(|row| row.get(name).filter(|value| !value.is_null()));
            put(&mut column, *kind, values)?;
            column.close()?;
        }
        group.close()?;
        self.waiting.clear();
        Ok(())
    }
}

/// A column: its values, and of every row whether it has one.
fn put<'a>(
    column: &mut SerializedColumnWriter,
    kind: Kind,
    values: impl Iterator<Item = Option<&'a Value>> + Clone,
) -> Result<(), ParquetError> {
    let there: Vec<i16> = values.clone().map(|value| i16::from(value.is_some())).collect();
    let (there, values) = (Some(there.as_slice()), values.flatten());
    match (column.untyped(), kind) {
        (ColumnWriter::BoolColumnWriter(typed), _) => {
            typed.write_batch(&values.filter_map(Value::as_bool).collect::<Vec<_>>(), there, None)?;
        }
        (ColumnWriter::Int64ColumnWriter(typed), _) => {
            typed.write_batch(&values.filter_map(Value::as_i64).collect::<Vec<_>>(), there, None)?;
        }
        (ColumnWriter::DoubleColumnWriter(typed), _) => {
            typed.write_batch(&values.filter_map(Value::as_f64).collect::<Vec<_>>(), there, None)?;
        }
        (ColumnWriter::ByteArrayColumnWriter(typed), _) => {
            let texts = values.map(|value| match value {
                Value::String(text) => ByteArray::from(text.as_str()),
                other => ByteArray::from(other.to_string().as_str()),
            });
            typed.write_batch(&texts.collect::<Vec<_>>(), there, None)?;
        }
        _ => return Err(ParquetError::General(format!("no column is written of {kind:?}"))),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::io::{Read as _, Seek as _};

    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;
    use serde_json::json;

    fn rows(of: Value) -> Vec<Row> {
        serde_json::from_value(of).expect("rows")
    }

    fn file(rows: &[Row]) -> File {
        let mut file = tempfile::tempfile().expect("a file");
        let mut seen = Columns::default();
        rows.iter().for_each(|row| seen.see(row));
        let mut table = Table::begin(&mut file, seen, &["job".into(), "not there".into()]).expect("a table");
        rows.iter().for_each(|row| table.push(row.clone()).expect("a row"));
        table.end().expect("an end");
        file
    }

    fn bytes(mut of: File) -> Vec<u8> {
        let mut bytes = Vec::new();
        of.rewind().and_then(|()| of.read_to_end(&mut bytes)).expect("bytes");
        bytes
    }

    #[test]
    fn what_is_written_is_read_again() {
        let rows = rows(json!([
            { "job": 0, "a.b": 1.5, "good": true, "text": "x", "mixed": 1, "whole": 7, "none": null },
            { "job": 1, "a.b": 3, "text": null, "mixed": "one", "whole": -2 },
        ]));
        let reader = SerializedFileReader::new(file(&rows)).expect("a file");
        let schema = reader.metadata().file_metadata().schema_descr();
        let names: Vec<&str> = schema.columns().iter().map(|column| column.name()).collect();
        assert_eq!(names, ["job", "a.b", "good", "mixed", "none", "text", "whole"]);
        let read: Vec<Vec<Field>> = reader
            .into_iter()
            .map(|row| row.expect("a row").get_column_iter().map(|(_, field)| field.clone()).collect())
            .collect();
        let text = |text: &str| Field::Str(text.into());
        let first = [
            Field::Long(0),
            Field::Double(1.5),
            Field::Bool(true),
            text("1"),
            Field::Null,
            text("x"),
            Field::Long(7),
        ];
        let second = [
            Field::Long(1),
            Field::Double(3.0),
            Field::Null,
            text("one"),
            Field::Null,
            Field::Null,
            Field::Long(-2),
        ];
        assert_eq!(read, [first, second]);
    }

    #[test]
    fn the_same_rows_make_the_same_bytes() {
        let rows = rows(json!([{ "job": 0, "a": 0.1 }, { "job": 1, "a": 1e-300 }]));
        assert_eq!(bytes(file(&rows)), bytes(file(&rows.clone())));
    }

    #[test]
    fn what_is_more_than_a_group_is_written_in_groups() {
        let last = GROUP as i64 * 2;
        let mut rows: Vec<Row> = (0..=last).map(|job| Row::from_iter([("job".into(), job.into())])).collect();
        // What only the last row has is a column of all.
        rows[GROUP * 2].insert("late".into(), 0.5.into());
        let reader = SerializedFileReader::new(file(&rows)).expect("a file");
        let groups = reader.metadata().row_groups().iter().map(|group| group.num_rows());
        assert_eq!(groups.collect::<Vec<_>>(), [GROUP as i64, GROUP as i64, 1]);
        let read: Vec<_> = reader.into_iter().map(|row| row.expect("a row")).collect();
        let field =
            |row: usize, at: usize| read[row].get_column_iter().nth(at).map(|(_, field)| field.clone());
        assert!((0..=last).all(|job| field(job as usize, 0) == Some(Field::Long(job))));
        assert_eq!((field(0, 1), field(GROUP * 2, 1)), (Some(Field::Null), Some(Field::Double(0.5))));
    }

    #[test]
    fn a_table_without_rows_is_a_table() {
        assert_eq!(SerializedFileReader::new(file(&[])).expect("a file").into_iter().count(), 0);
    }

    #[test]
    fn a_number_keeps_its_last_bit() {
        let value = 0.1 + 0.2;
        let text = serde_json::to_string(&json!([{ "a": value }])).expect("text");
        let reader = SerializedFileReader::new(file(&rows(serde_json::from_str(&text).expect("rows"))))
            .expect("a file");
        let row = reader.into_iter().next().expect("one").expect("a row");
        assert_eq!(row.get_column_iter().next().map(|(_, field)| field.clone()), Some(Field::Double(value)));
    }
}
