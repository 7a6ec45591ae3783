//! [`Diagnostics`]: what there is to say about a drawing, as much of it as anybody reads.

use crate::drawings::{Diagnostic, Severity};

/// Diagnostics that are kept for a report, and that are printed of each kind.
const MOST_KEPT: usize = 1000;
const MOST_PRINTED: usize = 10;

/// What there is to say: the first of it, and how much.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// The first thousand, and all warnings.
    pub kept: Vec<Diagnostic>,
    /// How many errors there were.
    pub errors: usize,
    /// How many warnings.
    pub warnings: usize,
    /// How many notices.
    pub notices: usize,
}

impl Diagnostics {
    /// Takes one more.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        match diagnostic.severity {
            Severity::Error => self.errors += 1,
            Severity::Warning => self.warnings += 1,
            Severity::Notice => self.notices += 1,
        }
        // A warning sums up the whole drawing.
        if self.kept.len() < MOST_KEPT || diagnostic.severity == Severity::Warning {
            self.kept.push(diagnostic);
        }
    }

    /// Why nothing is drawn by a file: its first error, else its first warning, else its first notice; empty
    /// where there is none.
    #[must_use]
    pub fn why_nothing(&self) -> String {
        let kinds = [Severity::Error, Severity::Warning, Severity::Notice];
        let first = kinds.into_iter().find_map(|kind| self.kept.iter().find(|said| said.severity == kind));
        first.map_or_else(String::new, |first| format!("; {first}"))
    }

    /// Says the first of each kind about the file `name` on the standard error.
    pub fn complain(&self, name: &str) {
        let kinds = [
            (Severity::Error, "error", self.errors),
            (Severity::Warning, "warning", self.warnings),
            (Severity::Notice, "notice", self.notices),
        ];
        for (severity, kind, count) in kinds {
            let of_kind = self.kept.iter().filter(|said| said.severity == severity);
            for diagnostic in of_kind.take(MOST_PRINTED) {
                eprintln!("{kind}: {name}: {diagnostic}");
            }
            if count > MOST_PRINTED {
                eprintln!("{kind}: {name}: and {} more", count - MOST_PRINTED);
            }
        }
    }
}
