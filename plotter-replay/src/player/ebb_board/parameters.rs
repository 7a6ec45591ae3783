//! [`Parameters`]: the numbers behind the name of a command.

/// Which numbers a parameter may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    U8,
    U16,
    U32,
    I16,
    I32,
}

impl Kind {
    const fn range(self) -> (i64, i64) {
        match self {
            Self::U8 => (0, u8::MAX as i64),
            Self::U16 => (0, u16::MAX as i64),
            Self::U32 => (0, u32::MAX as i64),
            Self::I16 => (i16::MIN as i64, i16::MAX as i64),
            Self::I32 => (i32::MIN as i64, i32::MAX as i64),
        }
    }
}

/// What is wrong with a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrong {
    Missing,
    /// This character stands where a comma is expected.
    NoComma(u8),
    Value,
}

/// What is left of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters<'a>(pub(super) &'a [u8]);

impl<'a> Parameters<'a> {
    /// The text of the next parameter, if there is one.
    pub(super) fn text(&mut self) -> Result<&'a [u8], Wrong> {
        let (&first, rest) = self.0.split_first().ok_or(Wrong::Missing)?;
        if first != b',' {
            return Err(Wrong::NoComma(first));
        }
        let end = rest.iter().position(|&byte| byte == b',').unwrap_or(rest.len());
        let (text, rest) = rest.split_at_checked(end).unwrap_or((rest, &[]));
        self.0 = rest;
        Ok(text)
    }

    /// The next number.
    pub(super) fn number(&mut self, kind: Kind) -> Result<i64, Wrong> {
        let (&first, rest) = self.0.split_first().ok_or(Wrong::Missing)?;
        if first != b',' {
            return Err(Wrong::NoComma(first));
        }
        let (is_negative, rest) = match rest.split_first() {
            Some((b'-', rest)) => (true, rest),
            _ => (false, rest),
        };
        let count = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let (digits, rest) = rest.split_at_checked(count).unwrap_or((rest, &[]));
        self.0 = rest;
        if digits.is_empty() {
            return Err(Wrong::Missing);
        }
        let size = digits.iter().fold(0_i64, |size, &digit| {
            size.saturating_mul(10).saturating_add(i64::from(digit.wrapping_sub(b'0')))
        });
        let value = if is_negative { -size } else { size };
        let (least, most) = kind.range();
        // Even 0 has no sign where none is expected.
        if (least..=most).contains(&value) && !(is_negative && least == 0) {
            Ok(value)
        } else {
            Err(Wrong::Value)
        }
    }

    /// The same where it may be left out.
    pub(super) fn optional(&mut self, kind: Kind) -> Result<Option<i64>, Wrong> {
        match self.0 {
            [b','] => {
                self.0 = &[];
                Ok(None)
            }
            [b',', ..] => self.number(kind).map(Some),
            _ => Ok(None),
        }
    }

    /// One that is an unsigned number of 8 bits.
    pub(super) fn byte(&mut self) -> Result<u8, Wrong> {
        self.number(Kind::U8).map(|number| u8::try_from(number).unwrap_or(u8::MAX))
    }

    /// One of 16 bits.
    pub(super) fn short(&mut self) -> Result<u16, Wrong> {
        self.number(Kind::U16).map(|number| u16::try_from(number).unwrap_or(u16::MAX))
    }

    /// One of 32 bits.
    pub(super) fn long(&mut self) -> Result<u32, Wrong> {
        self.number(Kind::U32).map(|number| u32::try_from(number).unwrap_or(u32::MAX))
    }

    /// One of 32 bits with a sign.
    pub(super) fn signed(&mut self) -> Result<i32, Wrong> {
        self.number(Kind::I32).map(|number| i32::try_from(number).unwrap_or(i32::MAX))
    }
}
