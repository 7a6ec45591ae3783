//! `compare`: one log with another.

use super::commands::{Done, Verdict, open, read, say, say_damage};
use crate::{CompareSettings, compare::compare};
use clap::Args;
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// The first log; packed if its name ends in .gz.
    first: PathBuf,
    /// The second log.
    second: PathBuf,
    /// Tolerance for times, microseconds.
    #[arg(long, value_name = "US", default_value_t = 0)]
    tolerance_us: u64,
    /// Records shown before and after the first difference.
    #[arg(long, value_name = "RECORDS", default_value_t = 10)]
    context: usize,
}

impl Compare {
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        // What cannot be compared is refused before anything is said of the first.
        for log in [&self.first, &self.second] {
            open(log)?;
        }
        let mut verdict = Verdict::Clean;
        let mut header = None;
        for log in [&self.first, &self.second] {
            let contents = read(log, |_| {})?;
            say(out, &log.display().to_string());
            say_damage(out, &contents);
            if Verdict::of(contents.summary) == Verdict::Found {
                verdict = Verdict::Found;
            }
            header.get_or_insert(contents.header);
        }
        let records = |path: &PathBuf| open(path).into_iter().flatten().filter_map(Result::ok);
        let tolerance = Duration::from_micros(self.tolerance_us);
        let comparison = compare(
            &header.unwrap_or_default(),
            || records(&self.first),
            || records(&self.second),
            CompareSettings { tolerance, context: self.context.min(10_000) },
        );
        say(out, &comparison.to_string());
        Ok(if comparison.is_equal() { verdict } else { Verdict::Found })
    }
}
