//! [`doubted`]: a drawing that may be none is no success.

use plotter_vector::trace::Doubt;

/// What helps a tool that takes its settings from a machine's file.
pub const IN_MACHINE_FILE: &str = "`plotter trace --ink F.png` shows what was taken for ink; `threshold` in the machine's table [vectorize] is \
     another way to tell it";

/// Refuses a drawing that may be none, with what helps.
///
/// # Errors
///
/// Why it may be none, and `remedy`.
pub fn doubted(doubt: Option<Doubt>, remedy: &str) -> Result<(), String> {
    doubt.map_or(Ok(()), |doubt| Err(format!("{doubt}; {remedy}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doubt_is_told_with_what_helps_and_none_is_none() {
        assert_eq!(doubted(None, IN_MACHINE_FILE), Ok(()));
        let told = doubted(Some(Doubt::Thrown { strokes: 12_345 }), IN_MACHINE_FILE).unwrap_err();
        assert!(told.contains("12345 strokes; `plotter trace --ink"), "{told}");
    }
}
