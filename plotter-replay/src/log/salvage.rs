//! Two records that became one line because the line end between them was hit.

use super::Record;
use super::text::parse_line;

/// Two whole records with something between them that should be a line end.
pub(super) struct Both {
    pub(super) records: [Record; 2],
    /// Where that lies in the line.
    pub(super) at: u64,
    /// How long it is: 1 byte, or 0 if it is missing.
    pub(super) bytes: u64,
}

/// Where a record can end in a line: behind an asterisk and two hex digits. More places are not tried, so
/// that a line of asterisks takes no longer than any other.
const MOST_PLACES: usize = 16;

/// The two records of a line that is none, if it is so. Both must be whole, each by its own checksum.
pub(super) fn salvage(line: &[u8], bytes: &mut Vec<u8>) -> Option<Both> {
    let mut read = |line: &[u8]| -> Option<Record> {
        let parsed = parse_line(line, bytes).ok()?;
        parsed.of(line, bytes).map(|record| record.to_record())
    };
    for at in memchr::memchr_iter(b'*', line).take(MOST_PLACES) {
        let end = at.saturating_add(3);
        for between in [1, 0] {
            let (Some(first), Some(second)) = (line.get(..end), line.get(end.saturating_add(between)..))
            else {
                continue;
            };
            if let Some(second) = read(second)
                && let Some(first) = read(first)
            {
                return Some(Both { records: [first, second], at: end as u64, bytes: between as u64 });
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_on_both_sides_of_a_hit_line_end_are_read() {
        let times = |line: &[u8]| {
            salvage(line, &mut Vec::new())
                .map(|both| (both.records.map(|r| r.time.as_micros()), both.at, both.bytes))
        };
        assert_eq!(times(b"10312 < 31 33 31 *87J10350 @ edge x+ *5a"), Some(([10_312, 10_350], 20, 1)));
        assert_eq!(times(b"10312 < 31 33 31 *8710350 @ edge x+ *5a"), Some(([10_312, 10_350], 20, 0)));
        assert_eq!(times(b"10312 < 31 33 31 *87J10350 @ edge x- *5a"), None);
        assert_eq!(times(b"10312 < 31 33 31 *87"), None);
        assert_eq!(times(&[b'*'; 60_000]), None);
    }
}
