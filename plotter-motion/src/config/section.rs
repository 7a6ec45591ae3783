//! [`Section`]: a table of a machine's file that another crate reads, with its keys.

use super::{ConfigError, MachineConfig};

/// A section of a machine's file that this crate does not use itself: the settings of a crate that builds on
/// it.
///
/// A machine is one file for all programs. This crate knows the names of the family's sections (`vectorize`,
/// `sheet`, `follower`) and reads none of them: [`Machine::from_toml`](super::Machine::from_toml) takes what
/// stands there unread. The crate that owns one says with this trait which keys it has;
/// [`Machine::from_toml_with`](super::Machine::from_toml_with) then reads both, with the same refusals.
///
/// ```
/// use plotter_motion::{ConfigError, MachineConfig, config::{Key, Section}};
///
/// #[derive(Default)]
/// struct Sheet {
///     frame_mm: f64,
/// }
///
/// impl Section for Sheet {
///     const NAME: &'static str = "sheet";
///
///     fn keys() -> &'static [Key<Self>] {
///         static KEYS: [Key<Sheet>; 1] =
///             [Key::number("sheet.frame_mm", |s| s.frame_mm, (0.0, 1000.0), "mm", "0 for none")];
///         &KEYS
///     }
/// }
///
/// let refused = Sheet { frame_mm: -1.0 }.checked(&MachineConfig::default()).err();
/// assert_eq!(
///     refused.map(|error| error.to_string()).as_deref(),
///     Some("sheet.frame_mm: -1 mm lies outside 0..=1000 mm; 0 for none")
/// );
/// ```
pub trait Section: Default + 'static {
    /// Name of the table.
    const NAME: &'static str;

    /// All of its keys, in the order of the documentation.
    fn keys() -> &'static [Key<Self>];

    /// Keys of older files without the table, and what says the same today, as after the word *write*.
    fn renamed() -> &'static [(&'static str, &'static str)] {
        &[]
    }

    /// Refuses values that contradict one another or the machine. Each of them lies in its range already.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] for the first that is wrong.
    fn fit(&self, machine: &MachineConfig) -> Result<(), ConfigError> {
        let _ = machine;
        Ok(())
    }

    /// The same, if each value lies in its range and [`Section::fit`] finds nothing.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] for the first value that is wrong, with its key and what would be right.
    fn checked(self, machine: &MachineConfig) -> Result<Self, ConfigError> {
        Self::keys().iter().try_for_each(|key| key.check(&self))?;
        self.fit(machine)?;
        Ok(self)
    }
}

/// One key of a machine's file, and what may stand behind it in a `C`.
#[derive(Debug)]
pub struct Key<C> {
    pub(super) rule: Rule,
    read: Option<fn(&C) -> f64>,
}

/// What a file may say behind a key.
#[derive(Debug)]
pub(super) struct Rule {
    /// The key with dots, as in the TOML file.
    pub(super) key: &'static str,
    /// What may stand behind it.
    pub(super) form: Form,
}

/// What may stand behind a key.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// A number.
    Number(Range),
    /// A number without fraction.
    Whole(Range),
    /// Text of at most this many bytes.
    #[cfg_attr(not(feature = "toml"), expect(dead_code, reason = "only the reader of TOML files asks"))]
    Text(usize),
    /// One of a few words.
    #[cfg_attr(not(feature = "toml"), expect(dead_code, reason = "only the reader of TOML files asks"))]
    Choice(&'static [&'static str]),
    /// A number without fraction, or a text that is one of those meant; the remedy for all else.
    #[cfg_attr(not(feature = "toml"), expect(dead_code, reason = "only the reader of TOML files asks"))]
    WholeOrText(Range, fn(&str) -> bool, &'static str),
    /// `true` or `false`.
    Switch,
    /// A table that another crate reads.
    Table,
}

/// The range of a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    /// Least allowed value.
    pub(super) least: f64,
    /// Greatest allowed value.
    pub(super) most: f64,
    /// The unit, empty for a plain number.
    pub(super) unit: &'static str,
    remedy: &'static str,
}

impl Range {
    const fn new((least, most): (f64, f64), unit: &'static str, remedy: &'static str) -> Self {
        Self { least, most, unit, remedy }
    }

    /// Refuses `value` behind `key` when it is not finite or outside the range.
    pub(super) fn check(&self, key: &'static str, value: f64) -> Result<(), ConfigError> {
        // A NaN lies in no range.
        if (self.least..=self.most).contains(&value) {
            return Ok(());
        }
        let Self { least, most, unit, remedy } = *self;
        Err(ConfigError::OutOfRange { key, value, least, most, unit, remedy })
    }
}

impl<C> Key<C> {
    const fn plain(key: &'static str, form: Form) -> Self {
        Self { rule: Rule { key, form }, read: None }
    }

    /// A number from `least` to `most`, both allowed, in `unit` (empty for none). `key` has its table, as in
    /// `sheet.frame_mm`; `remedy` says what would be right, and ends the message of a refusal.
    #[must_use]
    pub const fn number(
        key: &'static str,
        read: fn(&C) -> f64,
        range: (f64, f64),
        unit: &'static str,
        remedy: &'static str,
    ) -> Self {
        let form = Form::Number(Range::new(range, unit, remedy));
        Self { rule: Rule { key, form }, read: Some(read) }
    }

    /// The same of a number without fraction, 0 to 2³² − 1.
    #[must_use]
    pub const fn whole(
        key: &'static str,
        read: fn(&C) -> f64,
        range: (f64, f64),
        unit: &'static str,
        remedy: &'static str,
    ) -> Self {
        let form = Form::Whole(Range::new(range, unit, remedy));
        Self { rule: Rule { key, form }, read: Some(read) }
    }

    /// A whole number in a range, or a text that `is_meant`. `remedy` goes with a number that lies outside,
    /// `instead` says what to write in place of all else. `read` gives a number in the range where a text
    /// stands.
    #[must_use]
    pub const fn whole_or_text(
        key: &'static str,
        read: fn(&C) -> f64,
        (range, remedy): ((f64, f64), &'static str),
        is_meant: fn(&str) -> bool,
        instead: &'static str,
    ) -> Self {
        let form = Form::WholeOrText(Range::new(range, "", remedy), is_meant, instead);
        Self { rule: Rule { key, form }, read: Some(read) }
    }

    /// One of some words.
    #[must_use]
    pub const fn choice(key: &'static str, words: &'static [&'static str]) -> Self {
        Self::plain(key, Form::Choice(words))
    }

    /// `true` or `false`.
    #[must_use]
    pub const fn switch(key: &'static str) -> Self {
        Self::plain(key, Form::Switch)
    }

    /// Text of at most so many bytes.
    #[must_use]
    pub const fn text(key: &'static str, most_bytes: usize) -> Self {
        Self::plain(key, Form::Text(most_bytes))
    }

    /// A table that another crate reads.
    pub(super) const fn table(name: &'static str) -> Self {
        Self::plain(name, Form::Table)
    }

    /// The key with its table.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        self.rule.key
    }

    /// Of a number: the least and the greatest value, and the unit.
    #[must_use]
    pub const fn range(&self) -> Option<((f64, f64), &'static str)> {
        match self.rule.form {
            Form::Number(range) | Form::Whole(range) | Form::WholeOrText(range, ..) => {
                Some(((range.least, range.most), range.unit))
            }
            Form::Text(_) | Form::Choice(_) | Form::Switch | Form::Table => None,
        }
    }

    /// The value of a number in a description.
    #[must_use]
    pub fn value(&self, config: &C) -> Option<f64> {
        self.read.map(|read| read(config))
    }

    /// Refuses a description whose value behind this key is out of range.
    pub(super) fn check(&self, config: &C) -> Result<(), ConfigError> {
        match (self.rule.form, self.read) {
            (Form::Number(range) | Form::Whole(range) | Form::WholeOrText(range, ..), Some(read)) => {
                range.check(self.rule.key, read(config))
            }
            _ => Ok(()),
        }
    }
}
