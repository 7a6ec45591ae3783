//! [`Expression`]: the values that `LinuxCNC`'s programs reckon: numbers, variables, `[ ]` and functions.

use super::variables::Variables;
use super::{Problem, Text};
use crate::decimal::Decimal;

/// Deepest nesting of brackets: a line of `LinuxCNC` holds 255 bytes, and no program's formula needs more
/// than a few.
const MOST_DEPTH: u8 = 32;

/// Functions, in capitals.
const FUNCTIONS: [&str; 13] =
    ["ATAN", "ABS", "ACOS", "ASIN", "COS", "EXP", "FIX", "FUP", "ROUND", "LN", "SIN", "SQRT", "TAN"];

/// What stands between two values: the higher number binds closer.
const OPERATORS: [(&str, u8); 15] = [
    ("**", 5),
    ("*", 4),
    ("/", 4),
    ("MOD", 4),
    ("+", 3),
    ("-", 3),
    ("EQ", 2),
    ("NE", 2),
    ("GT", 2),
    ("GE", 2),
    ("LT", 2),
    ("LE", 2),
    ("AND", 1),
    ("OR", 1),
    ("XOR", 1),
];

/// Reads values from the beginning of a text.
pub(super) struct Expression<'a> {
    text: &'a [u8],
    /// How much of it has been read.
    at: usize,
    variables: &'a Variables,
    depth: u8,
}

impl<'a> Expression<'a> {
    pub(super) fn new(text: &'a [u8], at: usize, variables: &'a Variables) -> Self {
        Self { text, at, variables, depth: 0 }
    }

    /// The byte to come.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Whether a value that is no plain number begins here.
    pub(super) fn begins(mut self) -> bool {
        if matches!(self.peek(), Some(b'+' | b'-')) {
            self.at += 1;
        }
        matches!(self.peek(), Some(b'#' | b'[')) || self.function().is_some()
    }

    /// The next byte that is no blank.
    fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    fn takes(&mut self, byte: u8) -> bool {
        let takes = self.peek() == Some(byte);
        self.at += usize::from(takes);
        takes
    }

    fn takes_word(&mut self, word: &str) -> bool {
        self.peek();
        let rest = self.text.get(self.at..).unwrap_or_default();
        let takes = rest.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word.as_bytes()));
        self.at += if takes { word.len() } else { 0 };
        takes
    }

    fn function(&mut self) -> Option<&'static str> {
        let before = self.at;
        let found = FUNCTIONS.into_iter().find(|name| self.takes_word(name));
        if found.is_some() && self.peek() == Some(b'[') {
            return found;
        }
        self.at = before;
        None
    }

    /// A number, a variable, a function or what stands in brackets.
    pub(super) fn value(&mut self) -> Result<f64, Problem> {
        self.depth += 1;
        if self.depth > MOST_DEPTH {
            return Err(Problem::Expression {
                what: "more than 32 brackets or variables in each other: divide the formula",
            });
        }
        let value = self.value_here()?;
        self.depth -= 1;
        Ok(value)
    }

    fn value_here(&mut self) -> Result<f64, Problem> {
        if let Some(name) = self.function() {
            return self.call(name);
        }
        if self.takes_word("EXISTS") {
            return self.exists();
        }
        match self.peek() {
            Some(b'[') => self.brackets(),
            Some(b'#') => {
                let variable = self.variable()?;
                self.variables.value(&variable)
            }
            Some(b'-') => {
                self.at += 1;
                Ok(-self.value()?)
            }
            Some(b'+') => {
                self.at += 1;
                self.value()
            }
            _ => self.number(),
        }
    }

    fn number(&mut self) -> Result<f64, Problem> {
        let missing =
            Problem::Expression { what: "a value lacks: a number, a variable such as `#1`, or `[…]`" };
        let Some(byte) = self.peek().filter(|byte| byte.is_ascii_digit() || *byte == b'.') else {
            return Err(missing);
        };
        let mut number = Decimal::begin(byte).ok_or(missing)?;
        self.at += 1;
        while self.text.get(self.at).is_some_and(|byte| number.push(*byte)) {
            self.at += 1;
        }
        let value = number.value().ok_or(missing)?;
        if value.is_finite() { Ok(value) } else { Err(Problem::NumberTooGreat { written: number.written() }) }
    }

    /// `[…]`.
    pub(super) fn brackets(&mut self) -> Result<f64, Problem> {
        if !self.takes(b'[') {
            return Err(Problem::Expression { what: "`[` lacks: a formula stands in brackets" });
        }
        let value = self.binary(1)?;
        if self.takes(b']') {
            return Ok(value);
        }
        Err(Problem::Expression { what: "`]` or an operator lacks, such as `+` or `EQ`" })
    }

    /// `= value`, behind a variable.
    pub(super) fn assigned(&mut self) -> Result<f64, Problem> {
        if !self.takes(b'=') {
            return Err(Problem::Expression { what: "`=` lacks: a variable is set as in `#1 = 5`" });
        }
        self.value()
    }

    /// Whether `[` comes next.
    pub(super) fn begins_bracket(&mut self) -> bool {
        self.peek() == Some(b'[')
    }

    /// Values and what stands between them, as far as it binds so closely.
    fn binary(&mut self, least: u8) -> Result<f64, Problem> {
        let mut left = self.value()?;
        loop {
            self.peek();
            let before = self.at;
            let operator = OPERATORS.into_iter().find(|(name, _)| self.takes_word(name));
            let Some((name, binds)) = operator.filter(|(_, binds)| *binds >= least) else {
                self.at = before;
                return Ok(left);
            };
            self.depth += 1;
            if self.depth > MOST_DEPTH {
                return Err(Problem::Expression {
                    what: "more than 32 brackets or operators in each other: divide the formula",
                });
            }
            let right = self.binary(binds + 1)?;
            self.depth -= 1;
            let value = combined(name, left, right).inspect_err(|_| self.at = before)?;
            if !value.is_finite() {
                self.at = before;
                return Err(Problem::NoValue { left: Some(left), name, right });
            }
            left = value;
        }
    }

    fn call(&mut self, name: &'static str) -> Result<f64, Problem> {
        let from = self.at;
        let argument = self.brackets()?;
        match self.called(name, argument) {
            Ok(value) if value.is_finite() => Ok(value),
            wrong => {
                self.at = from;
                Err(wrong.err().unwrap_or(Problem::NoValue { left: None, name, right: argument }))
            }
        }
    }

    fn called(&mut self, name: &'static str, value: f64) -> Result<f64, Problem> {
        let outside = |expected| Problem::OutOfDomain { function: name, value, expected };
        Ok(match name {
            "ATAN" => {
                if !self.takes(b'/') {
                    return Err(Problem::Expression {
                        what: "ATAN is written with both sides: `ATAN[3]/[4]`",
                    });
                }
                libm::atan2(value, self.brackets()?).to_degrees()
            }
            "ABS" => value.abs(),
            "ACOS" | "ASIN" if value.abs() > 1.0 => return Err(outside("a number from -1 to 1")),
            "ACOS" => libm::acos(value).to_degrees(),
            "ASIN" => libm::asin(value).to_degrees(),
            "COS" => libm::cos(value.to_radians()),
            "EXP" => libm::exp(value),
            "FIX" => libm::floor(value),
            "FUP" => libm::ceil(value),
            "ROUND" => libm::round(value),
            "LN" if value <= 0.0 => return Err(outside("a number above 0")),
            "LN" => libm::log(value),
            "SIN" => libm::sin(value.to_radians()),
            "SQRT" if value < 0.0 => return Err(outside("a number not below 0")),
            "SQRT" => libm::sqrt(value),
            _ => libm::tan(value.to_radians()),
        })
    }

    fn exists(&mut self) -> Result<f64, Problem> {
        let wrong = Problem::Expression { what: "EXISTS asks for a variable with a name: `EXISTS[#<name>]`" };
        if !self.takes(b'[') {
            return Err(wrong);
        }
        let variable = self.variable()?;
        if !self.takes(b']') {
            return Err(wrong);
        }
        Ok(f64::from(u8::from(self.variables.value(&variable).is_ok())))
    }

    /// `#5`, `#[…]`, `##2` or `#<name>`.
    pub(super) fn variable(&mut self) -> Result<Variable, Problem> {
        if !self.takes(b'#') {
            return Err(Problem::Expression { what: "a variable lacks: it is like `#1` or `#<name>`" });
        }
        if self.takes(b'<') {
            let mut name = Text::default();
            let rest = self.text.get(self.at..).unwrap_or_default();
            let Some(length) = rest.iter().position(|byte| *byte == b'>') else {
                return Err(Problem::Expression { what: "`>` lacks behind the name of a variable" });
            };
            for byte in rest.iter().take(length).filter(|byte| !byte.is_ascii_whitespace()) {
                name.push(byte.to_ascii_lowercase());
            }
            self.at += length + 1;
            if name.is_cut() || name.is_empty() {
                return Err(Problem::Expression { what: "the name of a variable has 1 to 60 letters" });
            }
            return Ok(Variable::Named(name));
        }
        let number = self.value()?;
        match u16::try_from(crate::whole::whole(number)) {
            Ok(whole @ 1..=9999) if f64::from(whole) == number => Ok(Variable::Numbered(whole)),
            _ => Err(Problem::Expression { what: "the number of a variable is a whole one from 1 to 9999" }),
        }
    }
}

/// What a variable is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Numbered(u16),
    Named(Text),
}

fn combined(name: &'static str, left: f64, right: f64) -> Result<f64, Problem> {
    let is = |holds: bool| f64::from(u8::from(holds));
    // As LinuxCNC has it: reckoned numbers are seldom equal to the last bit.
    let equal = (left - right).abs() < 1e-6;
    Ok(match name {
        "**" => libm::pow(left, right),
        "*" => left * right,
        "/" | "MOD" if right == 0.0 => {
            return Err(Problem::Expression { what: "a division by 0" });
        }
        "/" => left / right,
        "MOD" => {
            let rest = libm::fmod(left, right);
            if rest < 0.0 { rest + right.abs() } else { rest }
        }
        "+" => left + right,
        "-" => left - right,
        "EQ" => is(equal),
        "NE" => is(!equal),
        "GT" => is(left > right),
        "GE" => is(left >= right),
        "LT" => is(left < right),
        "LE" => is(left <= right),
        "AND" => is(left != 0.0 && right != 0.0),
        "OR" => is(left != 0.0 || right != 0.0),
        _ => is((left != 0.0) != (right != 0.0)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<f64, Problem> {
        Expression::new(text.as_bytes(), 0, &Variables::default()).value()
    }

    #[test]
    fn formulas_have_linuxcncs_order() {
        for (text, expected) in [
            ("[1+2*3]", 7.0),
            ("[2**3**2]", 64.0),
            ("[7-2-1]", 4.0),
            ("[-2 ** 2]", 4.0),
            ("[2 * -3]", -6.0),
            ("[10 MOD 4 + 1]", 3.0),
            ("[-1 MOD 4]", 3.0),
            ("[1 + 1 EQ 2 AND 3 GT 2]", 1.0),
            ("[1 LT 0 OR 2 LE 2]", 1.0),
            ("[1 XOR 1]", 0.0),
            ("[1 EQ 1.0000001]", 1.0),
            ("SIN[30]", 0.5),
            ("cos[60]", 0.5),
            ("ATAN[1]/[-1]", 135.0),
            ("ACOS[0]", 90.0),
            ("SQRT[2 * [4 + 4]]", 4.0),
            ("FIX[-2.8]", -3.0),
            ("FUP[2.2]", 3.0),
            ("ROUND[-2.5]", -3.0),
            ("ABS[-3]", 3.0),
            ("-[3]", -3.0),
            ("LN[EXP[2]]", 2.0),
            ("#7", 0.0),
            ("EXISTS[#<a>]", 0.0),
        ] {
            assert!(
                value(text).is_ok_and(|found| (found - expected).abs() < 1e-12),
                "{text}: {:?}",
                value(text)
            );
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let deep = |count| "[".repeat(count) + "1" + &"]".repeat(count);
        assert_eq!(value(&deep(15)), Ok(1.0));
        for text in [
            "[1+]",
            "[1",
            "SQRT[-1]",
            "[1/0]",
            "LN[0]",
            "ASIN[2]",
            "#0",
            "#<a>",
            "#<a",
            "ATAN[1]",
            "[10**999]",
            &deep(99),
        ] {
            assert!(value(text).is_err(), "{text}");
        }
    }
}
