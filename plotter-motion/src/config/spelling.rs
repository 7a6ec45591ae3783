//! Suggestions for an unknown key: a near spelling, another unit, another table.

use super::toml_file::Keys;
use alloc::{format, string::String, vec::Vec};

/// Longer words are no slip of the pen, and the work of comparing them grows with their square.
const LONGEST_WORD: usize = 48;

/// Endings that name a unit, each with the unit in words, longest first where one ends another.
const UNITS: [(&str, &str); 46] = [
    ("_n_s_per_mm", "N s/mm"),
    ("_n_per_mm", "N/mm"),
    ("_mm_min2", "mm/min^2"),
    ("_mm_s3", "mm/s^3"),
    ("_mm_s2", "mm/s^2"),
    ("_mm_min", "mm/min"),
    ("_mm_s", "mm/s"),
    ("_cm_s2", "cm/s^2"),
    ("_cm_s", "cm/s"),
    ("_m_s3", "m/s^3"),
    ("_m_s2", "m/s^2"),
    ("_m_min", "m/min"),
    ("_in_s", "in/s"),
    ("_n_m_per_a", "N m/A"),
    ("_mn_m_per_a", "mN m/A"),
    ("_mn_m_s", "mN m s"),
    ("_n_m_s", "N m s"),
    ("_rad_s", "rad/s"),
    ("_mn_m", "mN m"),
    ("_n_m", "N m"),
    ("_m_s", "m/s"),
    ("_kg_m2", "kg m^2"),
    ("_g_cm2", "g cm^2"),
    ("_kg_cm2", "kg cm^2"),
    ("_mv_s", "mV s"),
    ("_v_s", "V s"),
    ("_per_mm", "1/mm"),
    ("_per_in", "1/in"),
    ("_counts", "counts"),
    ("_kohm", "kohm"),
    ("_mohm", "mohm"),
    ("_ohm", "ohm"),
    ("_deg", "deg"),
    ("_khz", "kHz"),
    ("_kg", "kg"),
    ("_hz", "Hz"),
    ("_mm", "mm"),
    ("_px", "px"),
    ("_cm", "cm"),
    ("_in", "in"),
    ("_ms", "ms"),
    ("_us", "us"),
    ("_mh", "mH"),
    ("_uh", "uH"),
    ("_mv", "mV"),
    ("_m", "m"),
];

/// Units of one letter that end other units, tried after all of [`UNITS`].
const SHORT_UNITS: [(&str, &str); 5] = [("_s", "s"), ("_v", "V"), ("_h", "H"), ("_g", "g"), ("_n", "N")];

/// How many of the second unit the first one is: a quotient of two exact numbers.
const CONVERSIONS: [(&str, &str, f64, f64); 32] = [
    ("mm/min", "mm/s", 1.0, 60.0),
    ("cm/s", "mm/s", 10.0, 1.0),
    ("m/s", "mm/s", 1_000.0, 1.0),
    ("m/min", "mm/s", 1_000.0, 60.0),
    ("in/s", "mm/s", 25.4, 1.0),
    ("mm/min^2", "mm/s^2", 1.0, 3_600.0),
    ("cm/s^2", "mm/s^2", 10.0, 1.0),
    ("m/s^2", "mm/s^2", 1_000.0, 1.0),
    ("m/s^3", "mm/s^3", 1_000.0, 1.0),
    ("cm", "mm", 10.0, 1.0),
    ("m", "mm", 1_000.0, 1.0),
    ("in", "mm", 25.4, 1.0),
    ("s", "ms", 1_000.0, 1.0),
    ("us", "ms", 1.0, 1_000.0),
    ("kHz", "Hz", 1_000.0, 1.0),
    ("kohm", "ohm", 1_000.0, 1.0),
    ("mohm", "ohm", 1.0, 1_000.0),
    ("mH", "H", 1.0, 1.0e3),
    ("uH", "H", 1.0, 1.0e6),
    ("mV", "V", 1.0, 1_000.0),
    ("mV s", "V s", 1.0, 1_000.0),
    ("mN m", "N m", 1.0, 1_000.0),
    ("mN m s", "N m s", 1.0, 1_000.0),
    ("mN m/A", "N m/A", 1.0, 1_000.0),
    ("g cm^2", "kg m^2", 1.0, 1.0e7),
    ("kg cm^2", "kg m^2", 1.0, 1.0e4),
    ("1/in", "1/mm", 1.0, 25.4),
    ("g", "kg", 1.0, 1_000.0),
    ("mm/s", "mm/min", 60.0, 1.0),
    ("mm", "m", 1.0, 1_000.0),
    ("ms", "s", 1.0, 1_000.0),
    ("Hz", "kHz", 1.0, 1_000.0),
];

/// What the writer of the unknown key `word` in the table `table` (empty: the top) may have meant; `value` is
/// the number behind it, if it is one.
pub(super) fn remedy(keys: &Keys, table: &str, word: &str, value: Option<f64>) -> String {
    if let Some((_, _, now)) = keys.renamed.iter().find(|(of, old, _)| (*of, *old) == (table, word)) {
        return format!("write {now}");
    }
    let known = keys_of(keys, table);
    if let Some(text) = another_unit(word, value, &known) {
        return text;
    }
    if let Some(path) = same_key_elsewhere(keys, table, word) {
        let place = path.rsplit_once('.').map_or("at the top of the file", |(place, _)| place);
        return if path.contains('.') {
            format!("`{word}` belongs under [{place}]")
        } else {
            format!("`{word}` belongs {place}, above all tables")
        };
    }
    if let Some(near) = nearest(word, &known) {
        return format!("did you mean `{near}`?");
    }
    let list: Vec<_> = known.iter().map(|key| format!("`{key}`")).collect();
    format!("known here: {}", list.join(", "))
}

/// The keys and tables that stand directly in `table`, each once.
fn keys_of(of: &Keys, table: &str) -> Vec<&'static str> {
    let mut keys = Vec::new();
    for rule in &of.rules {
        let below = if table.is_empty() {
            Some(rule.key)
        } else {
            rule.key.strip_prefix(table).and_then(|rest| rest.strip_prefix('.'))
        };
        let key = below.and_then(|path| path.split('.').next());
        if let Some(key) = key.filter(|key| !keys.contains(key)) {
            keys.push(key);
        }
    }
    keys
}

/// A key apart from its unit, and the unit.
fn split_unit(key: &str) -> (&str, &'static str) {
    let units = || UNITS.iter().chain(&SHORT_UNITS);
    let longest = units().filter(|(ending, _)| key.ends_with(ending)).max_by_key(|(ending, _)| ending.len());
    longest.map_or((key, ""), |(ending, unit)| (key.strip_suffix(ending).unwrap_or(key), unit))
}

/// The known key that is `word` in another unit.
fn another_unit(word: &str, value: Option<f64>, known: &[&'static str]) -> Option<String> {
    let (stem, unit) = split_unit(word);
    let (key, right) = known
        .iter()
        .map(|&key| (key, split_unit(key)))
        .find(|(_, (known_stem, known_unit))| *known_stem == stem && *known_unit != unit)
        .map(|(key, (_, right))| (key, right))?;
    let conversion = CONVERSIONS.iter().find(|(from, to, ..)| *from == unit && *to == right);
    Some(match (conversion, value.filter(|value| value.is_finite())) {
        (Some((_, _, times, over)), Some(value)) => {
            format!("the unit here is {right}: write `{key} = {}`", rounded(value * times / over))
        }
        (Some((_, _, times, over)), None) => {
            format!("the unit here is {right}: write `{key}`, 1 {unit} is {} {right}", rounded(times / over))
        }
        (None, _) if right.is_empty() => format!("did you mean `{key}`?"),
        (None, _) => format!("did you mean `{key}`? The unit here is {right}"),
    })
}

/// A converted number with at most nine digits: enough for any machine, and free of binary dust.
fn rounded(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

/// The path of a key of this very name in another table: the one that shares most of `table`.
fn same_key_elsewhere(keys: &Keys, table: &str, word: &str) -> Option<&'static str> {
    let shared = |path: &str| path.bytes().zip(table.bytes()).take_while(|(a, b)| a == b).count();
    let mut best: Option<(usize, &'static str)> = None;
    for rule in &keys.rules {
        let path = prefixes(rule.key).find(|path| path.rsplit('.').next() == Some(word));
        if let Some(path) = path.filter(|path| best.is_none_or(|(share, _)| shared(path) > share)) {
            best = Some((shared(path), path));
        }
    }
    best.map(|(_, path)| path)
}

/// `a`, `a.b`, `a.b.c` for the key `a.b.c`: the tables on the way to it and the key itself.
fn prefixes(key: &'static str) -> impl Iterator<Item = &'static str> {
    key.match_indices('.').filter_map(move |(dot, _)| key.get(..dot)).chain(core::iter::once(key))
}

/// The known key that differs least from `word`, if the difference is a slip of the pen: up to a third of
/// its letters.
pub(super) fn nearest(word: &str, known: &[&'static str]) -> Option<&'static str> {
    let length = word.chars().take(LONGEST_WORD + 1).count();
    if length > LONGEST_WORD {
        return None;
    }
    let allowed = (length / 3).max(1);
    known
        .iter()
        .map(|&key| (edit_distance(word, key), key))
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, key)| key)
}

/// How many letters must be added, dropped, changed or swapped with their neighbour to make one word of the
/// other, regardless of case.
///
/// Source: F. J. Damerau, "A technique for computer detection and correction of spelling errors" (1964);
/// computed row by row, each letter taking part in one swap at most.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().map(|letter| letter.to_ascii_lowercase()).collect();
    // The rows for all of `a` but its last letter (`above`) and last two letters (`two_above`).
    let mut two_above: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    let mut letter_before = None;
    for (i, letter) in a.chars().map(|letter| letter.to_ascii_lowercase()).enumerate() {
        let mut left = i + 1;
        let mut row = Vec::with_capacity(above.len());
        row.push(left);
        let mut other_before = None;
        for ((j, other), pair) in b.iter().copied().enumerate().zip(above.windows(2)) {
            let &[diagonal, up] = pair else { break };
            left = (diagonal + usize::from(letter != other)).min(up + 1).min(left + 1);
            if letter_before == Some(other) && other_before == Some(letter) {
                let before_both = j.checked_sub(1).and_then(|j| two_above.get(j));
                left = before_both.map_or(left, |distance| left.min(distance + 1));
            }
            row.push(left);
            other_before = Some(other);
        }
        two_above = core::mem::replace(&mut above, row);
        letter_before = Some(letter);
    }
    above.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_textbook_pair_is_three_letters_apart() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("abc", ""), 3);
        assert_eq!(edit_distance("Baud", "baud"), 0);
        assert_eq!(edit_distance("buad", "baud"), 1);
        assert_eq!(edit_distance("ab", "ba"), 1);
    }

    #[test]
    fn a_speed_in_another_unit_is_converted() {
        let feed = |word, value| remedy(&Keys::of_the_machine(), "control.contouring", word, value);
        assert_eq!(feed("feed_mm_min", Some(3_600.0)), "the unit here is mm/s: write `feed_mm_s = 60`");
        assert_eq!(feed("accel_m_s2", Some(0.6)), "the unit here is mm/s^2: write `accel_mm_s2 = 600`");
        assert_eq!(feed("feed_m_s", None), "the unit here is mm/s: write `feed_mm_s`, 1 m/s is 1000 mm/s");
        assert_eq!(feed("feed", None), "did you mean `feed_mm_s`? The unit here is mm/s");
    }

    #[test]
    fn every_unit_that_converts_has_an_ending_and_every_ending_is_a_key_s_or_converts() {
        let keys = Keys::of_the_machine();
        let endings = || UNITS.iter().chain(&SHORT_UNITS).map(|(_, unit)| *unit);
        for (from, to, ..) in CONVERSIONS {
            assert!(endings().any(|unit| unit == from), "{from} has no ending");
            assert!(endings().any(|unit| unit == to), "{to} has no ending");
        }
        for unit in endings() {
            let converts = CONVERSIONS.iter().any(|(from, ..)| *from == unit);
            let is_a_key_s = keys.rules.iter().any(|rule| split_unit(rule.key).1 == unit);
            // Keys in pixels stand in the sections of other crates.
            assert!(converts || is_a_key_s || unit == "px", "{unit} is of no use");
        }
    }

    #[test]
    fn a_key_in_the_wrong_table_is_sent_to_its_own() {
        let remedy = |table, word, value| remedy(&Keys::of_the_machine(), table, word, value);
        assert_eq!(remedy("y.motor", "coulomb_n_m", None), "`coulomb_n_m` belongs under [y.load]");
        assert_eq!(remedy("", "encoder", None), "`encoder` belongs under [x]");
        assert_eq!(
            remedy("area", "schema", None),
            "`schema` belongs at the top of the file, above all tables"
        );
    }

    #[test]
    fn a_word_like_no_key_gets_the_list() {
        assert_eq!(
            remedy(&Keys::of_the_machine(), "area", "colour", None),
            "known here: `width_mm`, `height_mm`"
        );
        assert_eq!(nearest(&"e".repeat(100_000), &["x", "y"]), None);
    }
}
