//! [`Said`]: what a line of an EBB means.

/// What a line of the board means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Said {
    /// A command is taken.
    Ok,
    /// Its firmware: the first two numbers of the version.
    Version(u16, u16),
    /// QS: the steps of both motors.
    Place(i32, i32),
    /// ES: whether something was interrupted.
    Stopped(bool),
    /// It refuses a line, with its number.
    Error(u16),
    /// That is no line of a board.
    Unknown,
}

impl Said {
    pub(super) fn of(line: &[u8]) -> Self {
        let Ok(text) = core::str::from_utf8(line) else { return Self::Unknown };
        if text == "OK" {
            return Self::Ok;
        }
        if let Some(error) = text.strip_prefix('!') {
            let digits = error.split(' ').next().unwrap_or_default();
            return digits.parse().map_or(Self::Unknown, Self::Error);
        }
        if let Some((_, version)) = text.split_once("Firmware Version ") {
            let mut numbers = version.split('.').map(str::parse);
            if let (Some(Ok(first)), Some(Ok(second))) = (numbers.next(), numbers.next()) {
                return Self::Version(first, second);
            }
            return Self::Unknown;
        }
        let mut numbers = text.split(',').map(str::parse::<i64>);
        let taken = [(); 6].map(|()| numbers.next().and_then(Result::ok));
        match taken {
            [Some(first), Some(second), None, ..] if text.split(',').count() == 2 => {
                match (i32::try_from(first), i32::try_from(second)) {
                    (Ok(first), Ok(second)) => Self::Place(first, second),
                    _ => Self::Unknown,
                }
            }
            [Some(any @ (0 | 1)), Some(_), Some(_), Some(_), Some(_), None] => Self::Stopped(any == 1),
            _ => Self::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_told_apart() {
        for (line, said) in [
            (&b"OK"[..], Said::Ok),
            (b"EBBv13_and_above EB Firmware Version 2.8.1", Said::Version(2, 8)),
            (b"-12,34", Said::Place(-12, 34)),
            (b"1,50,1200,18634,9848", Said::Stopped(true)),
            (b"0,0,0,0,0", Said::Stopped(false)),
            (b"!8 Err: Unknown command 'Z:5A'", Said::Error(8)),
            (b"QM,0,0,0,0", Said::Unknown),
            (b"1,2,3", Said::Unknown),
            (b"12,", Said::Unknown),
            (b"\xff", Said::Unknown),
            (b"", Said::Unknown),
        ] {
            assert_eq!(Said::of(line), said, "{line:?}");
        }
    }
}
