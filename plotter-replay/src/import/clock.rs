//! Times as tools write them.

/// A fraction of a second as its digits say, ns; digits after the ninth are dropped.
pub(super) fn fraction_ns(digits: &str) -> Option<i128> {
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let kept = digits.get(..digits.len().min(9))?;
    let scale = 10_i128.checked_pow(u32::try_from(9_usize.checked_sub(kept.len())?).ok()?)?;
    kept.parse::<i128>().ok()?.checked_mul(scale)
}

/// A decimal number of seconds, ns: `12`, `12.5`, `-0.000012300`, `1.5e-3`.
pub(super) fn seconds_ns(text: &str) -> Option<i128> {
    let text = text.trim();
    if let Some((mantissa, exponent)) = text.split_once(['e', 'E']) {
        let exponent: i32 = exponent.parse().ok().filter(|e: &i32| (-30..=9).contains(e))?;
        let ns = seconds_ns(mantissa)?;
        let factor = 10_i128.checked_pow(exponent.unsigned_abs())?;
        return if exponent < 0 { Some(ns / factor) } else { ns.checked_mul(factor) };
    }
    let (sign, digits) = text.strip_prefix('-').map_or((1, text), |digits| (-1, digits));
    let digits = digits.strip_prefix('+').unwrap_or(digits);
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, "0"));
    let fraction = if fraction.is_empty() { "0" } else { fraction };
    if whole.is_empty() || whole.len() > 12 || !whole.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let whole = whole.parse::<i128>().ok()?.checked_mul(1_000_000_000)?;
    Some(sign * whole.checked_add(fraction_ns(fraction)?)?)
}

/// Seconds since 1970 of a date and a time of day, as if in UTC: `2026/01/15 10:00:00` or with `-` and `T`.
pub(super) fn date_s(date: &str, time: &str) -> Option<i128> {
    let mut parts = date.split(['/', '-']);
    let mut next = |least: i64, most: i64| -> Option<i64> {
        parts.next()?.parse::<i64>().ok().filter(|n| (least..=most).contains(n))
    };
    let (year, month, day) = (next(1900, 9999)?, next(1, 12)?, next(1, 31)?);
    if parts.next().is_some() {
        return None;
    }
    let mut parts = time.split(':');
    let mut next =
        |most: i64| -> Option<i64> { parts.next()?.parse::<i64>().ok().filter(|n| (0..=most).contains(n)) };
    let (hour, minute, second) = (next(23)?, next(59)?, next(60)?);
    if parts.next().is_some() {
        return None;
    }
    // Days since 1970: years begin in March, so that the day that may be missing is the last one.
    let (year, month) = if month <= 2 { (year - 1, month + 9) } else { (year, month - 3) };
    let days = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day - 1 - 719_468;
    Some(i128::from(((days * 24 + hour) * 60 + minute) * 60 + second))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_read_to_the_nanosecond() {
        assert_eq!(seconds_ns("0.000012300000000"), Some(12_300));
        assert_eq!(seconds_ns("-0.25"), Some(-250_000_000));
        assert_eq!(seconds_ns("3"), Some(3_000_000_000));
        assert_eq!(seconds_ns("1.5e-3"), Some(1_500_000));
        for wrong in ["", "x", "1.x", "1.2.3", "--1", "9999999999999", "1e99"] {
            assert_eq!(seconds_ns(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn dates_are_days_since_1970() {
        assert_eq!(date_s("1970/01/01", "00:00:00"), Some(0));
        assert_eq!(date_s("2000-03-01", "00:00:01"), Some(951_868_801));
        assert_eq!(date_s("2026/12/31", "23:59:59").map(|s| s + 1), date_s("2027/01/01", "00:00:00"));
        assert_eq!(date_s("2026/13/01", "00:00:00"), None);
    }
}
