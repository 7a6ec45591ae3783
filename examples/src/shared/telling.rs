//! [`Telling`]: what a tool says on the standard output, chosen alike in all of them.

use super::command::print;
use clap::Args;

/// Whether a tool prints its table, JSON, or nothing.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Telling {
    /// Prints no figures and shows no progress; warnings and errors are told all the same
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
    /// Prints the figures as JSON in place of the table
    #[arg(long)]
    json: bool,
}

impl Telling {
    /// Whether nothing is to be said that is no warning.
    #[must_use]
    pub fn is_quiet(self) -> bool {
        self.quiet
    }

    /// Prints the figures as they were asked for.
    ///
    /// # Errors
    ///
    /// They cannot be written, on the standard output or as JSON.
    pub fn tell(self, table: &str, json: impl FnOnce() -> Result<String, String>) -> Result<(), String> {
        self.text(table, json)?.map_or(Ok(()), |text| print(&text))
    }

    /// The same on the standard error, where a drawing goes to the standard output.
    ///
    /// # Errors
    ///
    /// They cannot be written as JSON.
    pub fn tell_aside(
        self,
        table: &str,
        json: impl FnOnce() -> Result<String, String>,
    ) -> Result<(), String> {
        if let Some(text) = self.text(table, json)? {
            eprint!("{text}");
        }
        Ok(())
    }

    fn text(
        self,
        table: &str,
        json: impl FnOnce() -> Result<String, String>,
    ) -> Result<Option<String>, String> {
        if self.quiet {
            return Ok(None);
        }
        if !self.json {
            return Ok(Some(table.to_owned()));
        }
        let text = json()?;
        Ok(Some(if text.ends_with('\n') { text } else { text + "\n" }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_are_a_table_json_or_nothing() {
        let text = |quiet, json| Telling { quiet, json }.text("a 1\n", || Ok("{\"a\":1}".into())).unwrap();
        assert_eq!(text(false, false).as_deref(), Some("a 1\n"));
        assert_eq!(text(false, true).as_deref(), Some("{\"a\":1}\n"));
        assert_eq!(text(true, false), None);
    }
}
