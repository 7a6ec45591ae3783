//! A place in a JSON document that knows its own name, so that what is wrong there can be said with it.

use serde_json::Value;

/// A value and the way to it: `crossings[3].coarse.v_mm_s`.
#[derive(Clone, Debug)]
pub struct JsonPlace<'a> {
    value: &'a Value,
    name: String,
}

impl<'a> JsonPlace<'a> {
    /// The whole document.
    #[must_use]
    pub const fn root(value: &'a Value) -> Self {
        Self { value, name: String::new() }
    }

    /// The document in a text.
    ///
    /// # Errors
    ///
    /// Where it stops to be JSON, and why.
    pub fn parse(text: &str) -> Result<Value, String> {
        serde_json::from_str(text).map_err(|error| {
            let at = text
                .lines()
                .nth(error.line().saturating_sub(1))
                .and_then(|line| line.get(error.column().saturating_sub(1)..))
                .unwrap_or("");
            let number = ["NaN", "Infinity", "-Infinity"].into_iter().find(|number| at.starts_with(number));
            match number {
                Some(number) => format!(
                    "{number} in line {}, column {} is no number of JSON: a measurement is missing; take it again",
                    error.line(),
                    error.column()
                ),
                None => format!("is no JSON: {error}"),
            }
        })
    }

    /// What is there.
    #[must_use]
    pub const fn value(&self) -> &'a Value {
        self.value
    }

    /// An error about this place.
    pub fn wrong(&self, what: &str) -> String {
        if self.name.is_empty() { what.to_owned() } else { format!("{}: {what}", self.name) }
    }

    fn expected(&self, what: &str) -> String {
        let found = match self.value {
            Value::Null => "null".into(),
            Value::Bool(value) => value.to_string(),
            Value::Number(number) => number.to_string(),
            Value::String(text) if text.len() < 40 => format!("\"{text}\""),
            Value::String(_) => "a long text".into(),
            Value::Array(values) => format!("a list of {}", values.len()),
            Value::Object(_) => "an object".into(),
        };
        self.wrong(&format!("{what} is expected, found {found}"))
    }

    /// A member that may be missing; `null` counts as missing.
    ///
    /// # Errors
    ///
    /// If this is no object.
    pub fn get(&self, key: &str) -> Result<Option<Self>, String> {
        let members = self.value.as_object().ok_or_else(|| self.expected("an object"))?;
        Ok(members.get(key).filter(|value| !value.is_null()).map(|value| {
            let dot = if self.name.is_empty() { "" } else { "." };
            Self { value, name: format!("{}{dot}{key}", self.name) }
        }))
    }

    /// A member that must be there.
    ///
    /// # Errors
    ///
    /// If it is missing, or this is no object.
    pub fn need(&self, key: &str) -> Result<Self, String> {
        self.get(key)?.ok_or_else(|| self.wrong(&format!("`{key}` is missing")))
    }

    /// The elements of a list.
    ///
    /// # Errors
    ///
    /// If this is no list.
    pub fn list(&self) -> Result<Vec<Self>, String> {
        let values = self.value.as_array().ok_or_else(|| self.expected("a list"))?;
        Ok(values
            .iter()
            .enumerate()
            .map(|(index, value)| Self { value, name: format!("{}[{index}]", self.name) })
            .collect())
    }

    /// A finite number.
    ///
    /// # Errors
    ///
    /// If this is none.
    pub fn number(&self) -> Result<f64, String> {
        self.value.as_f64().filter(|number| number.is_finite()).ok_or_else(|| self.expected("a number"))
    }

    /// A list of finite numbers.
    ///
    /// # Errors
    ///
    /// If this is none; the element is named.
    pub fn numbers(&self) -> Result<Vec<f64>, String> {
        let values = self.value.as_array().ok_or_else(|| self.expected("a list of numbers"))?;
        let number = |(index, value): (usize, &'a Value)| {
            let place = || Self { value, name: format!("{}[{index}]", self.name) };
            value.as_f64().filter(|number| number.is_finite()).ok_or_else(|| place().expected("a number"))
        };
        values.iter().enumerate().map(number).collect()
    }

    /// A text.
    ///
    /// # Errors
    ///
    /// If this is none.
    pub fn text(&self) -> Result<&'a str, String> {
        self.value.as_str().ok_or_else(|| self.expected("a text"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let value = JsonPlace::parse(r#"{"a": [{"b": 1}, {"b": "two", "c": [1, null]}]}"#).unwrap();
        let list = JsonPlace::root(&value).need("a").unwrap().list().unwrap();
        assert_eq!(list[0].need("b").unwrap().number(), Ok(1.0));
        let said = |result: Result<f64, String>| result.unwrap_err();
        assert_eq!(said(list[1].need("b").unwrap().number()), "a[1].b: a number is expected, found \"two\"");
        assert_eq!(
            list[1].need("c").unwrap().numbers().unwrap_err(),
            "a[1].c[1]: a number is expected, found null"
        );
        assert_eq!(list[0].need("d").unwrap_err(), "a[0]: `d` is missing");
        assert_eq!(
            JsonPlace::parse("[1,\n NaN]").unwrap_err(),
            "NaN in line 2, column 2 is no number of JSON: a measurement is missing; take it again"
        );
        assert!(JsonPlace::parse("[1,").unwrap_err().starts_with("is no JSON: EOF"));
    }
}
