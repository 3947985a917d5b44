//! The part before it is cut. In: a file beside the program (`[part]`), or a comment in it (`(part, bar D40
//! L60)`). Out: of a lathe the stock as radii over Z, and where the jaws of the chuck begin; of a mill the
//! corners of a block; mm, in the coordinates of the program.
//!
//! | stock | keys | words of the comment |
//! |---|---|---|
//! | `bar` | `diameter_mm`, `length_mm`, `face_mm` | D, L, Z |
//! | `tube` | the same and `inner_mm`, the diameter of its bore | D, L, Z, I |
//! | `profile` | `profile_mm`: rows of Z and diameter | Z and D in turn |
//! | each of these | `chuck_mm`: Z at which the jaws begin; they lie below | C |
//! | `block` | `from_mm`, `to_mm`: opposite corners | X, Y and Z, twice each |
//!
//! The face of the stock is at Z 0 if nothing else is said, and the stock lies below it. A comment is in the
//! units of its program, a file in mm.

mod block;
mod error;
#[cfg(test)]
mod tests;

use serde::Deserialize;

pub use block::Corners;
pub use error::PartError;

use crate::Kinematics;

/// Widest and longest part, mm.
const LARGEST_MM: f64 = 10_000.0;
/// Most rows of a profile.
const MOST_ROWS: usize = 256;
/// Tables and keys by which a file beside a program is known to be something else: a job, a machine file, a
/// scenario, what is kept of a run.
const OTHERS: [&str; 6] = ["kind", "job", "machine", "event", "dialect", "block_delete"];

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Bar,
    Tube,
    Profile,
    Block,
}

impl Kind {
    fn named(name: &str) -> Option<Kind> {
        let kinds =
            [("bar", Kind::Bar), ("tube", Kind::Tube), ("profile", Kind::Profile), ("block", Kind::Block)];
        kinds.into_iter().find(|(known, _)| name.eq_ignore_ascii_case(known)).map(|(_, kind)| kind)
    }
}

/// What is said of a part, in mm.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Said {
    stock: Kind,
    diameter_mm: Option<f64>,
    inner_mm: Option<f64>,
    length_mm: Option<f64>,
    face_mm: Option<f64>,
    profile_mm: Option<Vec<[f64; 2]>>,
    chuck_mm: Option<f64>,
    from_mm: Option<[f64; 3]>,
    to_mm: Option<[f64; 3]>,
}

/// `part.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    part: Said,
}

/// The part before it is cut, in the coordinates of the program: radii over Z, or a block; mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    block: Option<Corners>,
    /// Z and radius, Z rising; a step has two rows of one Z. None of a block.
    rows: Vec<[f64; 2]>,
    inner_mm: f64,
    chuck_mm: Option<f64>,
}

impl Part {
    /// Reads the file beside a program; `None` if it is something else: a job, a machine file, a scenario.
    ///
    /// # Errors
    /// [`PartError`] says what is wrong and where.
    pub fn from_toml(text: &str) -> Result<Option<Part>, PartError> {
        let syntax = |error: toml::de::Error| PartError::Syntax(error.to_string().trim_end().to_owned());
        let table: toml::Table = toml::from_str(text).map_err(syntax)?;
        if !table.contains_key("part") {
            let other = OTHERS.iter().any(|key| table.contains_key(*key));
            return if other { Ok(None) } else { Err(PartError::NotAPart) };
        }
        let File { part } = toml::from_str(text).map_err(syntax)?;
        Part::of(&part).map(Some)
    }

    /// Reads a comment of a program whose unit is so many mm; `None` if it is a remark.
    ///
    /// # Errors
    /// [`PartError`] says what is wrong.
    pub fn from_comment(text: &str, unit_mm: f64) -> Result<Option<Part>, PartError> {
        let text = text.trim();
        let word = text.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
        if !word.eq_ignore_ascii_case("part") {
            return Ok(None);
        }
        let rest = text[word.len()..].trim_start();
        let Some(rest) = rest.strip_prefix(',') else {
            let next = rest.split_whitespace().next().unwrap_or_default();
            return if Kind::named(next).is_some() { Err(PartError::Comma) } else { Ok(None) };
        };
        let mut words = rest.split_whitespace();
        let kind = words.next().unwrap_or_default();
        let stock = Kind::named(kind).ok_or_else(|| PartError::Kind(kind.into()))?;
        Part::of(&said(stock, words, unit_mm)?).map(Some)
    }

    /// The same part, if a machine of this kind can cut it.
    ///
    /// # Errors
    /// A lathe has no block, a mill nothing else.
    pub fn fits(self, kinematics: Kinematics) -> Result<Part, PartError> {
        match (kinematics, self.block.is_some()) {
            (Kinematics::Lathe, true) => Err(PartError::OnLathe),
            (Kinematics::Mill, false) => Err(PartError::OnMill),
            _ => Ok(self),
        }
    }

    /// The block of a mill.
    pub fn block(&self) -> Option<Corners> {
        self.block
    }

    /// The same part, a block elsewhere along X and Y.
    #[must_use]
    pub fn moved(mut self, by_mm: [f64; 2]) -> Part {
        self.block = self.block.map(|block| block.moved(by_mm));
        self
    }

    fn of(said: &Said) -> Result<Part, PartError> {
        if said.stock == Kind::Block {
            return Part::of_block(said);
        }
        if said.from_mm.is_some() || said.to_mm.is_some() {
            return Err(PartError::Word("from_mm or to_mm".into()));
        }
        let unwanted = match said.stock {
            Kind::Bar => [said.inner_mm.map(|_| "inner_mm"), said.profile_mm.as_ref().map(|_| "profile_mm")],
            Kind::Tube => [said.profile_mm.as_ref().map(|_| "profile_mm"), None],
            Kind::Profile | Kind::Block => {
                let size = said
                    .diameter_mm
                    .or(said.length_mm)
                    .or(said.face_mm)
                    .map(|_| "a diameter, length or face");
                [said.inner_mm.map(|_| "inner_mm"), size]
            }
        };
        if let Some(word) = unwanted.into_iter().flatten().next() {
            return Err(PartError::Word(word.into()));
        }
        let rows = match &said.profile_mm {
            Some(rows) => profile(rows)?,
            None if said.stock == Kind::Profile => return Err(PartError::Missing("profile")),
            None => {
                let diameter = size("diameter", said.diameter_mm)?;
                let length = size("length", said.length_mm)?;
                let face = place("face", said.face_mm.unwrap_or(0.0))?;
                vec![[face - length, 0.5 * diameter], [face, 0.5 * diameter]]
            }
        };
        let inner_mm =
            if said.stock == Kind::Tube { 0.5 * size("inner diameter", said.inner_mm)? } else { 0.0 };
        if rows.iter().any(|[_, radius]| inner_mm > 0.0 && *radius <= inner_mm) {
            let (what, value) = ("inner diameter", 2.0 * inner_mm);
            return Err(PartError::Value { what, value, allowed: "less than the outer one" });
        }
        let chuck_mm = said.chuck_mm.map(|z| place("chuck", z)).transpose()?;
        Ok(Part { block: None, rows, inner_mm, chuck_mm })
    }

    fn of_block(said: &Said) -> Result<Part, PartError> {
        let numbers = [said.diameter_mm, said.inner_mm, said.length_mm, said.face_mm, said.chuck_mm];
        if numbers.iter().any(Option::is_some) || said.profile_mm.is_some() {
            return Err(PartError::Word("what is round".into()));
        }
        let missing = |corner: &'static str| PartError::Missing(corner);
        let from = said.from_mm.ok_or_else(|| missing("corner from_mm"))?;
        let to = said.to_mm.ok_or_else(|| missing("corner to_mm"))?;
        Ok(Part { block: Some(Corners::of(from, to)?), rows: Vec::new(), inner_mm: 0.0, chuck_mm: None })
    }

    /// Where the stock ends and begins along Z, of a block as of what turns.
    pub fn ends_mm(&self) -> [f64; 2] {
        if let Some(Corners { low_mm: [.., low], high_mm: [.., high] }) = self.block {
            return [low, high];
        }
        let end = |row: Option<&[f64; 2]>| row.map_or(0.0, |[z, _]| *z);
        [end(self.rows.first()), end(self.rows.last())]
    }

    /// Z and outer radius, Z rising; a step has two rows of one Z.
    pub fn rows_mm(&self) -> &[[f64; 2]] {
        &self.rows
    }

    /// The largest radius.
    pub fn widest_mm(&self) -> f64 {
        self.rows.iter().map(|[_, radius]| *radius).fold(0.0, f64::max)
    }

    /// Inner and outer radius at Z; the larger outer one at a step; `None` beside the stock.
    pub fn radii_mm(&self, z: f64) -> Option<[f64; 2]> {
        let between = self.rows.windows(2).filter_map(|rows| {
            let ([z0, r0], [z1, r1]) = (rows[0], rows[1]);
            let share = if z1 > z0 { (z - z0) / (z1 - z0) } else { 0.0 };
            (z0..=z1).contains(&z).then_some(r0 + (r1 - r0) * share)
        });
        between.reduce(f64::max).map(|outer| [self.inner_mm, outer])
    }

    /// Whether a point lies in the stock.
    pub fn holds(&self, x: f64, z: f64) -> bool {
        self.radii_mm(z).is_some_and(|[inner, outer]| (inner..=outer).contains(&x.abs()))
    }

    /// Z at which the jaws begin.
    pub fn chuck_mm(&self) -> Option<f64> {
        self.chuck_mm
    }
}

/// The words of a comment: a letter and a number each.
fn said<'a>(stock: Kind, words: impl Iterator<Item = &'a str>, unit_mm: f64) -> Result<Said, PartError> {
    let mut said = Said {
        stock,
        diameter_mm: None,
        inner_mm: None,
        length_mm: None,
        face_mm: None,
        profile_mm: None,
        chuck_mm: None,
        from_mm: None,
        to_mm: None,
    };
    if stock == Kind::Block {
        let [from, to] = block::said(words, unit_mm)?;
        (said.from_mm, said.to_mm) = (Some(from), Some(to));
        return Ok(said);
    }
    // The Z of a row of a profile whose diameter is still to come.
    let mut z = None;
    for word in words {
        let wrong = || PartError::Word(word.into());
        let letter = word.chars().next().map(|letter| letter.to_ascii_uppercase()).ok_or_else(wrong)?;
        let number: f64 =
            word.get(letter.len_utf8()..).and_then(|text| text.parse().ok()).ok_or_else(wrong)?;
        let mm = number * unit_mm;
        let (name, slot) = match (letter, stock) {
            ('Z', Kind::Profile) => ("Z", &mut z),
            ('D', Kind::Profile) => {
                let z = z.take().ok_or(PartError::Missing("Z before a diameter"))?;
                said.profile_mm.get_or_insert_default().push([z, mm]);
                continue;
            }
            ('D', _) => ("D", &mut said.diameter_mm),
            ('I', _) => ("I", &mut said.inner_mm),
            ('L', _) => ("L", &mut said.length_mm),
            ('Z', _) => ("Z", &mut said.face_mm),
            ('C', _) => ("C", &mut said.chuck_mm),
            _ => return Err(wrong()),
        };
        if slot.replace(mm).is_some() {
            return Err(PartError::Twice(name));
        }
    }
    if z.is_some() { Err(PartError::Missing("diameter behind the last Z")) } else { Ok(said) }
}

/// Rows of a profile from either end, as radii with Z rising.
fn profile(rows: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, PartError> {
    let mut radii = Vec::with_capacity(rows.len());
    for [z, diameter] in rows {
        radii.push([place("profile", *z)?, 0.5 * size("diameter", Some(*diameter))?]);
    }
    if radii.first().zip(radii.last()).is_some_and(|([first, _], [last, _])| first > last) {
        radii.reverse();
    }
    let refuse = |value: f64, allowed| Err(PartError::Value { what: "profile", value, allowed });
    if !(2..=MOST_ROWS).contains(&radii.len()) {
        return refuse(radii.len() as f64, "2 to 256 rows");
    }
    if let Some(rows) = radii.windows(2).find(|rows| rows[0][0] > rows[1][0]) {
        return refuse(rows[1][0], "Z has to go in one direction");
    }
    let [[low, _], [high, _]] = [radii[0], radii[radii.len() - 1]];
    if low >= high { refuse(low, "the stock has no length") } else { Ok(radii) }
}

fn size(what: &'static str, value: Option<f64>) -> Result<f64, PartError> {
    let value = value.ok_or(PartError::Missing(what))?;
    let allowed = "more than 0 and at most 10000 mm";
    if value > 0.0 && value <= LARGEST_MM {
        Ok(value)
    } else {
        Err(PartError::Value { what, value, allowed })
    }
}

fn place(what: &'static str, value: f64) -> Result<f64, PartError> {
    let allowed = "within 10000 mm";
    if value.abs() <= LARGEST_MM { Ok(value) } else { Err(PartError::Value { what, value, allowed }) }
}
