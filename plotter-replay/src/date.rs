//! Times of day for people.

/// Greatest time that is put into words, s: the end of the year 9999.
const LAST_S: f64 = 253_402_300_799.0;

/// Microseconds since 1970 as a date and a time of day, to the second.
pub(crate) fn of_unix_us(us: f64) -> Option<String> {
    let seconds = libm::floor(us / 1e6);
    if !(0.0..=LAST_S).contains(&seconds) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "within the years 1970 to 9999, as checked")]
    let seconds = seconds as i64;
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Days in eras of 400 years that begin in March, so that a leap day is the last of its year. Source:
    // H. Hinnant, "chrono-Compatible Low-Level Date Algorithms" (2013), civil_from_days.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = era * 400 + year_of_era + i64::from(month <= 2);
    let (hour, minute, second) = (second / 3_600, second / 60 % 60, second % 60);
    Some(format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, words) in [
            (0.0, "1970-01-01 00:00:00 UTC"),
            (951_782_399.0, "2000-02-28 23:59:59 UTC"),
            (951_782_400.0, "2000-02-29 00:00:00 UTC"),
            (4_107_542_400.0, "2100-03-01 00:00:00 UTC"), // no leap year
            (1_795_629_973.994, "2026-11-25 18:06:13 UTC"),
            (LAST_S, "9999-12-31 23:59:59 UTC"),
        ] {
            assert_eq!(of_unix_us(seconds * 1e6).unwrap(), words);
        }
        for us in [-1.0, f64::NAN, f64::INFINITY, 1e18] {
            assert_eq!(of_unix_us(us), None, "{us}");
        }
    }
}
