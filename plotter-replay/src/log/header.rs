//! [`Header`]: what a log says about itself in its first line.

use super::text::checksum;
use super::{MAGIC, ReadError, VERSION};
use core::fmt;
use serde_json::{Map, Value};

/// What a log says about the line and the machine: a JSON object, unknown keys kept, in their order.
///
/// ```
/// # use plotter_replay::log::Header;
/// let header = Header::new().with_number("baud", 256_000).with_text("protocol", "digits");
/// assert_eq!(header.to_json(), r#"{"baud":256000,"protocol":"digits"}"#);
/// assert_eq!(header.baud(), Some(256_000));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Header {
    settings: Map<String, Value>,
}

/// Text that is not one JSON object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeaderError {
    /// What is wrong, with line and column.
    pub message: String,
}

impl Header {
    /// A header that says nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Reads a JSON object.
    ///
    /// # Errors
    ///
    /// [`HeaderError`] if the text is anything else.
    pub fn from_json(text: &str) -> Result<Self, HeaderError> {
        serde_json::from_str(text)
            .map(|settings| Self { settings })
            .map_err(|error| HeaderError { message: error.to_string() })
    }

    /// The object as JSON, in one line.
    #[must_use]
    pub fn to_json(&self) -> String {
        Value::Object(self.settings.clone()).to_string()
    }

    /// The first line of a log, without its end: magic, version, and the object with its checksum as the last
    /// key, [`Header::SUM`].
    pub(super) fn to_line(&self) -> String {
        let mut settings = self.settings.clone();
        settings.shift_remove(Self::SUM);
        let mut line = format!("{MAGIC} {VERSION} {}", Value::Object(settings));
        // The brace makes room for one more key.
        line.pop();
        let sum = checksum(line.as_bytes());
        let comma = if line.ends_with('{') { "" } else { "," };
        line.push_str(&format!("{comma}\"{}\":\"{sum:02x}\"}}", Self::SUM));
        line
    }

    /// Reads the first line of a log; with it, what is wrong with it, if it can be read in spite of that.
    pub(super) fn from_line(line: &[u8]) -> Result<(Self, Option<String>), ReadError> {
        let line = String::from_utf8_lossy(line);
        let rest =
            line.strip_prefix(MAGIC).and_then(|rest| rest.strip_prefix(' ')).ok_or(ReadError::NotALog)?;
        let (version, settings) = rest.split_once(' ').unwrap_or((rest, ""));
        let sum = Sum::of(&line);
        if version.parse() != Ok(VERSION) {
            if sum == Sum::Wrong {
                // Of a log with another version it would fit.
                return Err(ReadError::NotALog);
            }
            // Only so much of it that the message stays one line.
            return Err(ReadError::Version { found: version.chars().take(16).collect() });
        }
        match Self::from_json(settings) {
            Err(error) => Ok((
                Self::new(),
                Some(format!("its settings are no JSON object ({}): read without them", error.message)),
            )),
            Ok(mut header) => {
                header.settings.shift_remove(Self::SUM);
                let wrong = String::from("its checksum does not fit: one of the settings may be wrong");
                Ok((header, (sum == Sum::Wrong).then_some(wrong)))
            }
        }
    }

    /// Key of the checksum of the first line: CRC-8/SMBUS of all of it that stands before the key and its
    /// comma, in two hex digits. Readers take a header without it as it is.
    pub const SUM: &str = "sum";

    /// With `key` saying `text`.
    #[must_use]
    pub fn with_text(mut self, key: &str, text: &str) -> Self {
        self.settings.insert(key.to_owned(), Value::from(text));
        self
    }

    /// With `key` saying a whole number.
    #[must_use]
    pub fn with_number(mut self, key: &str, number: u64) -> Self {
        self.settings.insert(key.to_owned(), Value::from(number));
        self
    }

    /// With `key` saying a number; one that is not finite becomes `null`.
    #[must_use]
    pub fn with_decimal(mut self, key: &str, number: f64) -> Self {
        self.settings.insert(key.to_owned(), Value::from(number));
        self
    }

    /// What `key` says, if it says a text.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<&str> {
        self.settings.get(key)?.as_str()
    }

    /// What `key` says, if it says a number.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<f64> {
        self.settings.get(key)?.as_f64()
    }

    /// Whether `key` is there, whatever it says.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.settings.contains_key(key)
    }

    /// Keys in their order, each with its value as JSON.
    pub fn entries(&self) -> impl Iterator<Item = (&str, String)> {
        self.settings.iter().map(|(key, value)| (key.as_str(), value.to_string()))
    }

    /// Bits a second on the serial line, key `baud`.
    #[must_use]
    pub fn baud(&self) -> Option<u32> {
        self.settings.get("baud")?.as_u64().and_then(|baud| u32::try_from(baud).ok()).filter(|&baud| baud > 0)
    }
}

/// Whether a first line is as it was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sum {
    None,
    Right,
    Wrong,
}

impl Sum {
    fn of(line: &str) -> Self {
        // The last key and its value, if that is a text of two characters.
        let last = line.strip_suffix("\"}").and_then(|line| {
            let (rest, found) = line.split_at_checked(line.len().checked_sub(2)?)?;
            let (covered, key) = rest.strip_suffix("\":\"")?.rsplit_once('"')?;
            Some((covered.strip_suffix(',').unwrap_or(covered), key, found))
        });
        let Some((covered, key, found)) = last else {
            return if line.contains(&format!("\"{}\":", Header::SUM)) { Self::Wrong } else { Self::None };
        };
        let fits = found == format!("{:02x}", checksum(covered.as_bytes()));
        match (key == Header::SUM, fits) {
            (true, true) => Self::Right,
            (false, false) => Self::None,
            // A value that is the checksum by chance is one in 256; more likely its key was hit.
            (true, false) | (false, true) => Self::Wrong,
        }
    }
}

impl fmt::Display for HeaderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no JSON object: {}", self.message)
    }
}

impl core::error::Error for HeaderError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_keys_stay_in_their_order() {
        let text = r#"{"zebra":[1,{"a":null}],"baud":9600,"apple":0.1}"#;
        let header = Header::from_json(text).unwrap();
        assert_eq!(header.to_json(), text);
        assert_eq!(header.number("apple"), Some(0.1));
        assert_eq!(header.entries().map(|(key, _)| key).collect::<Vec<_>>(), ["zebra", "baud", "apple"]);
    }

    #[test]
    fn only_one_object_is_a_header() {
        for text in ["", "[]", "7", "{", "{} {}", "{\"a\":}"] {
            assert!(Header::from_json(text).is_err(), "{text}");
        }
        let deep = "[".repeat(10_000);
        assert!(Header::from_json(&format!("{{\"a\":{deep}")).is_err());
    }

    #[test]
    fn a_baud_rate_of_nothing_is_none() {
        for text in ["{}", r#"{"baud":0}"#, r#"{"baud":-1}"#, r#"{"baud":"fast"}"#, r#"{"baud":5000000000}"#]
        {
            assert_eq!(Header::from_json(text).unwrap().baud(), None, "{text}");
        }
    }
}
