//! Reads a [`Palette`] from TOML.

use super::{MAX_PENS, Palette, PaletteError, PalettePen};
use crate::picture::Rgb;
use core::fmt;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Longest text that is read, bytes.
const LONGEST_FILE: usize = 1 << 16;
/// The keys of a pen, and what each of them takes.
const KEYS: [(&str, &str); 4] = [
    ("number", "a whole number from 1 to 255, the pen's place in the carousel"),
    ("name", "text in quotes"),
    ("colour", "a colour in quotes, as \"#d01818\""),
    ("width_mm", "a number in mm, as 0.3"),
];

/// A place in a file: line and column, both from 1, the column in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PalettePlace {
    /// Line, from 1.
    pub line: usize,
    /// Character in the line, from 1.
    pub column: usize,
}

impl PalettePlace {
    /// The place of byte `offset` of `text`; the end of the text if it has fewer.
    fn of(text: &str, offset: usize) -> Self {
        let before = || text.char_indices().take_while(|(at, _)| *at < offset).map(|(_, letter)| letter);
        let line = 1 + before().filter(|letter| *letter == '\n').count();
        let column = before().fold(1, |column, letter| if letter == '\n' { 1 } else { column + 1 });
        Self { line, column }
    }
}

impl fmt::Display for PalettePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// What is wrong with a palette's file: where, which key, and what would be right.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PaletteTomlError {
    /// The text is longer than any palette.
    TooLong {
        /// Its length.
        bytes: usize,
        /// The greatest length that is read.
        limit: usize,
    },
    /// The text is not TOML, or has a key twice.
    Syntax {
        /// Where.
        at: PalettePlace,
        /// What the TOML parser says.
        message: String,
    },
    /// A key is missing, unknown, or has a value that it does not take.
    Key {
        /// Where; `None` for what should stand at the top of the file.
        at: Option<PalettePlace>,
        /// The key with its table.
        key: String,
        /// What is wrong, and what would be right.
        problem: String,
    },
    /// Pens that are no palette.
    Pens {
        /// Where the wrong one begins; `None` when it is their count.
        at: Option<PalettePlace>,
        /// What is wrong.
        error: PaletteError,
    },
}

impl fmt::Display for PaletteTomlError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { bytes, limit } => {
                write!(f, "{bytes} bytes are no palette: at most {limit} are read")
            }
            Self::Syntax { at, message } => write!(f, "{at}: {message}"),
            Self::Key { at: Some(at), key, problem } => write!(f, "{at}: {key}: {problem}"),
            Self::Key { at: None, key, problem } => write!(f, "{key}: {problem}"),
            Self::Pens { at: Some(at), error } => write!(f, "{at}: {error}"),
            Self::Pens { at: None, error } => error.fmt(f),
        }
    }
}

impl core::error::Error for PaletteTomlError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Pens { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl Palette {
    /// Reads a palette from TOML: `schema = 1`, then a table `[[pen]]` for each pen.
    ///
    /// | key | unit | range | must it be there | meaning |
    /// | --- | --- | --- | --- | --- |
    /// | `schema` | | 1 | yes | version of this format |
    /// | `pen.number` | | 1..=255 | yes | place in the carousel |
    /// | `pen.name` | | at most 64 bytes | no: its colour | what the pen is called |
    /// | `pen.colour` | | `"#rrggbb"` | yes | colour on the paper, sRGB |
    /// | `pen.width_mm` | mm | 0.01..=50 | no | width of its line |
    ///
    /// At most 64 KiB are read.
    ///
    /// # Errors
    /// [`PaletteTomlError`] with line, column, key and remedy, for the first thing that is wrong.
    ///
    /// ```
    /// # use plotter_vector::{Palette, Rgb};
    /// let palette = Palette::from_toml(r##"
    /// schema = 1
    /// [[pen]]
    /// number = 1
    /// name = "black"
    /// colour = "#000000"
    /// [[pen]]
    /// number = 2
    /// colour = "#d01818"
    /// width_mm = 0.3
    /// "##)?;
    /// assert_eq!(palette.pens().len(), 2);
    /// assert_eq!(palette.pen(2).map(|pen| (pen.colour, pen.width_mm)), Some((Rgb([208, 24, 24]), Some(0.3))));
    ///
    /// let slip = Palette::from_toml("schema = 1\n[[pen]]\nnumber = 1\ncolour = \"red\"\n").unwrap_err();
    /// assert_eq!(
    ///     slip.to_string(),
    ///     "line 4, column 10: pen.colour: \"red\" is no colour: write `#` and six hexadecimal digits, as \"#d01818\""
    /// );
    /// # Ok::<(), plotter_vector::ink::PaletteTomlError>(())
    /// ```
    pub fn from_toml(text: &str) -> Result<Self, PaletteTomlError> {
        if text.len() > LONGEST_FILE {
            return Err(PaletteTomlError::TooLong { bytes: text.len(), limit: LONGEST_FILE });
        }
        let document = DeTable::parse(text).map_err(|error| PaletteTomlError::Syntax {
            at: PalettePlace::of(text, error.span().map_or(0, |span| span.start)),
            message: error.message().to_owned(),
        })?;
        let file = File { text };
        file.check_top(document.get_ref())?;
        let tables = file.tables(document.get_ref())?;
        let pens = tables.iter().map(|table| file.pen(table)).collect::<Result<Vec<_>, _>>()?;
        Self::new(pens.clone()).map_err(|error| {
            // The first pen with which the ones before it are no palette; their mere count has no place.
            let wrong = (1..=pens.len()).find(|count| {
                *count <= MAX_PENS && pens.get(..*count).is_some_and(|some| Self::new(some.to_vec()).is_err())
            });
            let table = wrong.and_then(|count| tables.get(count - 1));
            PaletteTomlError::Pens { at: table.map(|table| file.place(table.span().start)), error }
        })
    }
}

type Value<'a> = Spanned<DeValue<'a>>;

/// The text, to tell places in it.
struct File<'a> {
    text: &'a str,
}

impl File<'_> {
    fn place(&self, offset: usize) -> PalettePlace {
        PalettePlace::of(self.text, offset)
    }

    fn wrong(&self, offset: usize, key: &str, problem: impl Into<String>) -> PaletteTomlError {
        let key = key.chars().take(64).flat_map(char::escape_debug).collect();
        PaletteTomlError::Key { at: Some(self.place(offset)), key, problem: problem.into() }
    }

    /// Whether the file is of the known version and has no key that it should not have.
    fn check_top(&self, top: &DeTable<'_>) -> Result<(), PaletteTomlError> {
        let missing = || PaletteTomlError::Key {
            at: None,
            key: "schema".to_owned(),
            problem: "missing; write `schema = 1` at the top of the file, above all tables".to_owned(),
        };
        let schema = get(top, "schema").ok_or_else(missing)?;
        if whole(schema) != Some(1) {
            let problem = "this program reads version 1: write `schema = 1`";
            return Err(self.wrong(schema.span().start, "schema", problem));
        }
        let known = |key: &str| key == "schema" || key == "pen";
        match top.keys().find(|key| !known(key.get_ref())) {
            Some(key) => {
                let problem = "unknown key; the file has `schema` and a table [[pen]] for each pen";
                Err(self.wrong(key.span().start, key.get_ref(), problem))
            }
            None => Ok(()),
        }
    }

    /// The tables of the pens.
    fn tables<'t, 'v>(&self, top: &'t DeTable<'v>) -> Result<Vec<&'t Value<'v>>, PaletteTomlError> {
        let Some(pens) = get(top, "pen") else { return Ok(Vec::new()) };
        match pens.get_ref() {
            DeValue::Array(tables) => Ok(tables.iter().collect()),
            _ => {
                Err(self.wrong(pens.span().start, "pen", "write [[pen]] with two brackets, one table a pen"))
            }
        }
    }

    fn pen(&self, table: &Value<'_>) -> Result<PalettePen, PaletteTomlError> {
        let start = table.span().start;
        let DeValue::Table(pen) = table.get_ref() else {
            return Err(self.wrong(start, "pen", "write [[pen]], and its keys on the lines below"));
        };
        if let Some(key) = pen.keys().find(|key| KEYS.iter().all(|(known, _)| known != key.get_ref())) {
            let problem = "unknown key; a pen has `number`, `name`, `colour` and `width_mm`";
            return Err(self.wrong(key.span().start, &format!("pen.{}", key.get_ref()), problem));
        }
        let [number, name, colour, width] = KEYS.map(|(key, takes)| Key { key, takes, value: get(pen, key) });
        let colour = self.read(&colour, start, |value| {
            text(value).map(|text| text.parse::<Rgb>().map_err(|error| error.to_string()))
        })?;
        let name = match name.value {
            Some(_) => self.read(&name, start, |value| text(value).map(|text| Ok(text.to_owned())))?,
            None => colour.to_string(),
        };
        let number = self.read(&number, start, |value| {
            whole(value).and_then(|number| u8::try_from(number).ok()).filter(|number| *number > 0).map(Ok)
        })?;
        let width_mm = match width.value {
            Some(_) => Some(self.read(&width, start, |value| float(value).map(Ok))?),
            None => None,
        };
        Ok(PalettePen { number, name, colour, width_mm })
    }

    /// The value of a key: `read` gives none for one of the wrong kind, and a message for one that is wrong.
    fn read<T>(
        &self,
        key: &Key<'_, '_>,
        table_start: usize,
        read: impl Fn(&Value<'_>) -> Option<Result<T, String>>,
    ) -> Result<T, PaletteTomlError> {
        let full = format!("pen.{}", key.key);
        let Some(value) = key.value else {
            return Err(self.wrong(table_start, &full, format!("missing; write {}", key.takes)));
        };
        let wrong = |problem: String| self.wrong(value.span().start, &full, problem);
        match read(value) {
            Some(outcome) => outcome.map_err(wrong),
            None => Err(wrong(format!("write {}", key.takes))),
        }
    }
}

/// A key of a pen, what it takes, and its value in the file.
struct Key<'t, 'v> {
    key: &'static str,
    takes: &'static str,
    value: Option<&'t Value<'v>>,
}

fn get<'t, 'v>(table: &'t DeTable<'v>, name: &str) -> Option<&'t Value<'v>> {
    table.iter().find(|(key, _)| key.get_ref() == name).map(|(_, value)| value)
}

fn text<'t>(value: &'t Value<'_>) -> Option<&'t str> {
    if let DeValue::String(text) = value.get_ref() { Some(text) } else { None }
}

fn whole(value: &Value<'_>) -> Option<i64> {
    match value.get_ref() {
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok(),
        _ => None,
    }
}

fn float(value: &Value<'_>) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(_) => whole(value).and_then(|whole| i32::try_from(whole).ok()).map(f64::from),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_named_with_line_key_and_remedy() {
        let pen = |keys: &str| format!("schema = 1\n\n[[pen]]\n{keys}");
        let files = [
            String::new(),
            "schema = 2\n".to_owned(),
            "schema = 1\n".to_owned(),
            "schema = 1\npens = 3\n".to_owned(),
            "schema = 1\n[pen]\nnumber = 1\n".to_owned(),
            "schema = 1\npen = [1]\n".to_owned(),
            pen("number = \n"),
            pen("number = 1\nnumber = 2\n"),
            pen("number = 1\n"),
            pen("colour = \"#000000\"\n"),
            pen("number = 0\ncolour = \"#000000\"\n"),
            pen("number = 256\ncolour = \"#000000\"\n"),
            pen("number = 1\ncolour = \"#00000\"\n"),
            pen("number = 1\ncolour = 0\n"),
            pen("number = 1\ncolor = \"#000000\"\n"),
            pen("number = 1\ncolour = \"#000000\"\nwidth_mm = \"0.3 mm\"\n"),
            pen("number = 1\ncolour = \"#000000\"\nwidth_mm = 0\n"),
            pen("number = 1\ncolour = \"#000000\"\nname = 7\n"),
            pen("number = 1\ncolour = \"#000000\"\n[[pen]]\nnumber = 1\ncolour = \"#0000ff\"\n"),
            pen("number = 1\ncolour = \"#0000ff\"\n[[pen]]\nnumber = 2\ncolour = \"#0000FF\"\n"),
        ];
        let said = files.map(|file| Palette::from_toml(&file).unwrap_err().to_string());
        insta::assert_snapshot!(said.join("\n"));
    }

    #[test]
    fn a_file_too_long_is_not_read() {
        let error = Palette::from_toml(&"#".repeat(LONGEST_FILE + 1)).unwrap_err();
        assert_eq!(error.to_string(), "65537 bytes are no palette: at most 65536 are read");
    }

    #[test]
    fn a_pen_without_a_name_is_called_by_its_colour() {
        let palette =
            Palette::from_toml("schema = 1\n[[pen]]\nnumber = 0x3\ncolour = \"#AB00ff\"\n").unwrap();
        assert_eq!(palette.pen(3).map(|pen| pen.name.as_str()), Some("#ab00ff"));
    }
}
