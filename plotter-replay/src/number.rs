//! Numbers as short text.

/// `value` with at most `decimals` places, without trailing zeros, and never as `-0`.
pub(crate) fn plain(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { String::from("0") } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn zeros_at_the_end_go() {
        assert_eq!(
            [1.5, 100.0, -0.0001, 0.1234, -2.0].map(|n| plain(n, 3)),
            ["1.5", "100", "0", "0.123", "-2"]
        );
        assert_eq!(plain(120.0, 0), "120");
    }
}
