//! Reads a machine's description from TOML.
//!
//! The file is read twice: first key by key against the list of keys, so that what is wrong is named with
//! its line and a remedy; then, found to be right, into the fields.

use super::rules::{MachineKey, rules};
use super::section::{Form, Range, Rule};
use super::spelling::{nearest, remedy};
use super::{ConfigError, FileConfig, Machine, MachineConfig, Section, TomlError, TomlPlace};
use alloc::{
    format,
    string::{String, ToString as _},
    vec::Vec,
};
use serde::{Deserialize as _, de::DeserializeOwned};
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer};

/// Longest text that is read, bytes: a hundred times a fully commented file.
const LONGEST_FILE: usize = 1 << 20;

impl MachineConfig {
    /// Reads a description from TOML, without checking whether such a machine can be: [`Machine::new`] or
    /// [`Machine::from_toml`] do that.
    ///
    /// `schema = 1` must be there; every other key may be left out and then has its default. At most 1 MiB
    /// is read.
    ///
    /// ```
    /// # use plotter_motion::MachineConfig;
    /// let config = MachineConfig::from_toml("schema = 1\n[area]\nwidth_mm = 420.0\n")?;
    /// assert_eq!(config.area.width_mm, 420.0);
    /// assert_eq!(config.serial.baud, 256_000); // left out: the documented gantry's
    ///
    /// let slip = MachineConfig::from_toml("schema = 1\n[area]\nwidth_cm = 42\n").unwrap_err();
    /// assert_eq!(
    ///     slip.to_string(),
    ///     "line 3, column 1: unknown key `area.width_cm`; the unit here is mm: write `width_mm = 420`"
    /// );
    /// # Ok::<(), plotter_motion::config::TomlError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`TomlError`] with line, column and remedy: for text that is not TOML or has a key twice, an unknown
    /// key, a value of the wrong kind, a number that is not finite or does not fit its field, and a missing
    /// or unknown `schema`. The first one in the file, but `schema` before all others.
    pub fn from_toml(text: &str) -> Result<Self, TomlError> {
        let document = parse(text)?;
        check(text, document.get_ref(), &Keys::of_the_machine())?;
        let file = FileConfig::of_checked(text, &document)?;
        let placed = |error| placed(text, &document, error);
        let config = Self::try_from(file).map_err(placed)?;
        // What a machine of this kind does not read is checked while it is here.
        let kept = FileConfig::from(config);
        let unread = |key: &&MachineKey| key.value(&kept) != key.value(&file);
        rules().filter(unread).try_for_each(|key| key.check(&file)).map_err(placed)?;
        Ok(config)
    }
}

impl FileConfig {
    /// What a document says whose keys have been checked.
    fn of_checked(text: &str, document: &Spanned<DeTable<'_>>) -> Result<Self, TomlError> {
        let is_another_s = |name: &str| rules().any(|key| key.key() == name && is_table(&key.rule));
        let own = document.get_ref().iter().filter(|(name, _)| !is_another_s(name.get_ref()));
        let own = own.map(|(name, value)| (name.clone(), value.clone())).collect();
        Self::deserialize(Deserializer::from(Spanned::new(document.span(), own)))
            .map_err(|error| syntax(text, &error))
    }
}

impl Machine {
    /// Reads a description from TOML and checks it.
    ///
    /// ```
    /// # use plotter_motion::Machine;
    /// let refused = Machine::from_toml("schema = 1\n\n[serial]\nbaud = 25\n").unwrap_err();
    /// assert_eq!(
    ///     refused.to_string(),
    ///     "line 4, column 8: serial.baud: 25 baud lies outside 300..=4000000 baud; the documented gantry uses 256000"
    /// );
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`MachineConfig::from_toml`], and [`TomlError::Invalid`] with the line of the value that
    /// [`Machine::new`] refuses.
    pub fn from_toml(text: &str) -> Result<Self, TomlError> {
        let document = parse(text)?;
        check(text, document.get_ref(), &Keys::of_the_machine())?;
        Self::of_checked(text, &document)
    }

    /// Reads a description and the section of another crate in the same file. Without that section it has its
    /// defaults.
    ///
    /// # Errors
    ///
    /// Those of [`Machine::from_toml`], for the keys and values of the section, too.
    pub fn from_toml_with<S: Section + DeserializeOwned>(text: &str) -> Result<(Self, S), TomlError> {
        let document = parse(text)?;
        check(text, document.get_ref(), &Keys::of_the_machine().with::<S>())?;
        let machine = Self::of_checked(text, &document)?;
        let written = document.get_ref().iter().find(|(name, _)| name.get_ref() == S::NAME);
        let section = match written.map(|(_, value)| (value.span(), value.get_ref())) {
            Some((span, DeValue::Table(table))) => {
                S::deserialize(Deserializer::from(Spanned::new(span, table.clone())))
                    .map_err(|error| syntax(text, &error))?
            }
            _ => S::default(),
        };
        let section = section.checked(machine.config()).map_err(|error| placed(text, &document, error))?;
        Ok((machine, section))
    }

    fn of_checked(text: &str, document: &Spanned<DeTable<'_>>) -> Result<Self, TomlError> {
        let file = FileConfig::of_checked(text, document)?;
        rules()
            .try_for_each(|key| key.check(&file))
            .and_then(|()| MachineConfig::try_from(file))
            .and_then(Self::new)
            .map_err(|error| placed(text, document, error))
    }
}

/// A refusal with the place of its key.
fn placed(text: &str, document: &Spanned<DeTable<'_>>, error: ConfigError) -> TomlError {
    let span = find(document.get_ref(), error.key());
    TomlError::Invalid { at: span.map(|offset| TomlPlace::of(text, offset)), error }
}

/// The keys that a file may have.
pub(super) struct Keys {
    pub(super) rules: Vec<&'static Rule>,
    /// Table, key of older files, and what says the same today.
    pub(super) renamed: Vec<(&'static str, &'static str, &'static str)>,
}

impl Keys {
    /// Those of this crate, and the names of the other sections.
    pub(super) fn of_the_machine() -> Self {
        Self { rules: rules().map(|key| &key.rule).collect(), renamed: Vec::new() }
    }

    /// These with the keys of a section that another crate reads.
    fn with<S: Section>(mut self) -> Self {
        self.rules.retain(|rule| rule.key != S::NAME);
        self.rules.extend(S::keys().iter().map(|key| &key.rule));
        self.renamed.extend(S::renamed().iter().map(|(key, now)| (S::NAME, *key, *now)));
        self
    }
}

const fn is_table(rule: &Rule) -> bool {
    matches!(rule.form, Form::Table)
}

/// Refuses a document with a wrong key or a value of the wrong kind: the first in the file, but `schema`
/// before all others.
fn check(text: &str, table: &DeTable<'_>, keys: &Keys) -> Result<(), TomlError> {
    check_schema(text, table)?;
    let mut first = None;
    check_table(text, table, "", keys, &mut first);
    first.map_or(Ok(()), |(_, error)| Err(error))
}

fn parse(text: &str) -> Result<Spanned<DeTable<'_>>, TomlError> {
    if text.len() > LONGEST_FILE {
        return Err(TomlError::TooLong { bytes: text.len(), limit: LONGEST_FILE });
    }
    DeTable::parse(text).map_err(|error| syntax(text, &error))
}

fn syntax(text: &str, error: &toml::de::Error) -> TomlError {
    let offset = error.span().map_or(0, |span| span.start);
    TomlError::Syntax { at: TomlPlace::of(text, offset), message: error.message().to_string() }
}

/// Where the value behind a dotted key stands.
fn find(table: &DeTable<'_>, path: &str) -> Option<usize> {
    let (head, tail) = path.split_once('.').map_or((path, None), |(head, tail)| (head, Some(tail)));
    let (_, value) = table.iter().find(|(key, _)| key.get_ref() == head)?;
    match (tail, value.get_ref()) {
        (None, _) => Some(value.span().start),
        (Some(tail), DeValue::Table(inner)) => find(inner, tail),
        (Some(_), _) => None,
    }
}

/// The version says what all other keys mean, so it comes first.
fn check_schema(text: &str, table: &DeTable<'_>) -> Result<(), TomlError> {
    let schema = table.iter().find(|(key, _)| key.get_ref() == "schema");
    let (_, value) = schema.ok_or(TomlError::MissingSchema)?;
    match whole(value.get_ref()).and_then(|number| u32::try_from(number).ok()) {
        Some(found) if found != 1 => {
            let at = Some(TomlPlace::of(text, value.span().start));
            Err(TomlError::Invalid { at, error: ConfigError::Schema { found } })
        }
        // What is no version at all is refused with the other keys of the wrong kind.
        _ => Ok(()),
    }
}

/// The first error in the file so far, with its offset. (Tables keep their keys in alphabetical order.)
type First = Option<(usize, TomlError)>;

fn note(first: &mut First, offset: usize, error: TomlError) {
    if first.as_ref().is_none_or(|(earlier, _)| offset < *earlier) {
        *first = Some((offset, error));
    }
}

/// Checks the keys of `table`, whose own name is `path` (empty: the top). Known tables lie three deep.
fn check_table(text: &str, table: &DeTable<'_>, path: &str, keys: &Keys, first: &mut First) {
    for (key, value) in table {
        let name: &str = key.get_ref();
        let full = if path.is_empty() { name.to_string() } else { format!("{path}.{name}") };
        // A quoted key may contain a dot and then is not the key that it spells.
        let rule = keys.rules.iter().find(|rule| rule.key == full && !name.contains('.'));
        let is_table = !name.contains('.')
            && keys
                .rules
                .iter()
                .any(|rule| rule.key.strip_prefix(full.as_str()).is_some_and(|rest| rest.starts_with('.')));
        if let Some(rule) = rule {
            if let Some(error) = check_value(text, rule, value) {
                note(first, value.span().start, error);
            }
        } else if !is_table {
            let offset = key.span().start;
            let at = TomlPlace::of(text, offset);
            let remedy = remedy(keys, path, name, number(value.get_ref()));
            note(first, offset, TomlError::UnknownKey { at, key: shown(&full), remedy });
        } else if let DeValue::Table(inner) = value.get_ref() {
            check_table(text, inner, &full, keys, first);
        } else {
            note(first, value.span().start, wrong_type(text, &full, value, as_a_table(&full)));
        }
    }
}

fn as_a_table(key: &str) -> String {
    format!("it is a table: write [{key}], and its keys on the lines below")
}

fn wrong_type(text: &str, key: &str, value: &Spanned<DeValue<'_>>, remedy: String) -> TomlError {
    let found = match value.get_ref() {
        DeValue::String(text) => format!("the text {}", shown_text(text)),
        DeValue::Integer(_) => "a whole number".to_string(),
        DeValue::Float(_) => "a number with fraction".to_string(),
        DeValue::Boolean(yes) => yes.to_string(),
        DeValue::Datetime(_) => "a date".to_string(),
        DeValue::Array(_) => "a list".to_string(),
        DeValue::Table(_) => "a table".to_string(),
    };
    TomlError::WrongType { at: TomlPlace::of(text, value.span().start), key: key.to_string(), found, remedy }
}

/// What is wrong with one value by its kind; its range is checked later, with the line, by [`Machine::new`].
fn check_value(text: &str, rule: &Rule, value: &Spanned<DeValue<'_>>) -> Option<TomlError> {
    let refused = |remedy| Some(wrong_type(text, rule.key, value, remedy));
    match rule.form {
        Form::Number(range) => match number(value.get_ref()) {
            // A number that fits no field would be refused by the field with less to say.
            Some(number) if is_extreme(number) => out_of_range(text, rule.key, &range, number, value),
            Some(_) => None,
            None => refused(match number_in_text(value.get_ref()) {
                Some(number) => {
                    format!("write the number alone, without quotes or unit: `{} = {number}`", last(rule.key))
                }
                None => format!("write a number{}", in_unit(range.unit)),
            }),
        },
        Form::WholeOrText(range, is_meant, instead) => match (value.get_ref(), number(value.get_ref())) {
            (DeValue::String(text), _) if is_meant(text) => None,
            (DeValue::Integer(_), Some(number)) => out_of_range(text, rule.key, &range, number, value),
            _ => refused(instead.to_string()),
        },
        Form::Whole(range) => match (whole(value.get_ref()), value.get_ref()) {
            (Some(whole), _) if u32::try_from(whole).is_ok() => None,
            (_, DeValue::Integer(_)) => {
                let number = number(value.get_ref()).unwrap_or(f64::NAN);
                out_of_range(text, rule.key, &range, number, value)
            }
            _ => refused(format!("write a whole number{}, without fraction and quotes", in_unit(range.unit))),
        },
        Form::Text(most) => match value.get_ref() {
            DeValue::String(text) if text.len() <= most => None,
            DeValue::String(text) => {
                refused(format!("{} bytes are too long, at most {most} fit", text.len()))
            }
            _ => refused("write text in quotes".to_string()),
        },
        Form::Choice(words) => match value.get_ref() {
            DeValue::String(text) if words.contains(&text.as_ref()) => None,
            other => {
                let near = if let DeValue::String(text) = other { nearest(text, words) } else { None };
                let quoted: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
                let guess = near.map(|near| format!(": did you mean \"{near}\"?")).unwrap_or_default();
                refused(format!("write {}{guess}", quoted.join(" or ")))
            }
        },
        Form::Switch => match value.get_ref() {
            DeValue::Boolean(_) => None,
            _ => refused("write true or false, without quotes".to_string()),
        },
        Form::Table => match value.get_ref() {
            DeValue::Table(_) => None,
            _ => refused(as_a_table(rule.key)),
        },
    }
}

/// Whether a number is none, or so great that single precision has no place for it.
fn is_extreme(number: f64) -> bool {
    !number.is_finite() || libm::fabs(number) > f64::from(f32::MAX)
}

fn out_of_range(
    text: &str,
    key: &'static str,
    range: &Range,
    number: f64,
    value: &Spanned<DeValue<'_>>,
) -> Option<TomlError> {
    let at = Some(TomlPlace::of(text, value.span().start));
    range.check(key, number).err().map(|error| TomlError::Invalid { at, error })
}

/// The number that a value is; infinite when it is too great.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            let whole = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
            #[expect(clippy::cast_precision_loss, reason = "for a message and a range far below")]
            Some(whole.map_or(f64::INFINITY, |whole| whole as f64))
        }
        _ => None,
    }
}

/// The number that a value is, if it is written without fraction and fits.
fn whole(value: &DeValue<'_>) -> Option<i64> {
    match value {
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok(),
        _ => None,
    }
}

/// The number that a text starts with: `"60 mm/s"` was meant as 60.
fn number_in_text(value: &DeValue<'_>) -> Option<f64> {
    let DeValue::String(text) = value else { return None };
    let word = text.split_whitespace().next()?;
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

fn in_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in {unit}") }
}

fn last(key: &'static str) -> &'static str {
    key.rsplit('.').next().unwrap_or(key)
}

/// How much of a stranger's text a message repeats, characters.
const SHOWN: usize = 64;

/// A key as a message shows it: short and free of control characters.
fn shown(key: &str) -> String {
    let mut text: String = key.chars().take(SHOWN).flat_map(char::escape_debug).collect();
    if key.chars().nth(SHOWN).is_some() {
        text.push_str("...");
    }
    text
}

fn shown_text(text: &str) -> String {
    format!("\"{}\"", shown(text))
}
