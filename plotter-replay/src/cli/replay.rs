//! `replay`: a recording, or the controller again on it, as fast as wanted.

use super::check::Rerunnable;
use super::commands::{Contents, Done, Verdict, is_free, open, read, say, say_damage, seconds};
use crate::export;
use crate::log::{self, Header, Record};
use crate::{
    Player,
    compare::Decoder,
    player::{Pace, PaceSettings, Stuck},
};
use clap::Args;
use std::io::{BufRead, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(Debug, Args)]
pub(crate) struct Replay {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// The machine's description [default: the preset of the controller that the log's header names].
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// Show the recording without running a controller.
    #[arg(long, conflicts_with = "machine")]
    recorded: bool,
    /// Write the answers and actions of the controller to a log. Nothing is shown then, unless --speed
    /// or --step is given.
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite FILE if it exists.
    #[arg(long, requires = "out")]
    force: bool,
    /// Speed relative to the recording [default: without waiting].
    #[arg(long, value_name = "FACTOR", value_parser = speed)]
    speed: Option<f64>,
    /// Start of the part that is shown, seconds; everything before it is run without waiting.
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true, default_value = "0")]
    from: Duration,
    /// End of the part that is shown, seconds.
    #[arg(long, value_name = "S", value_parser = seconds)]
    to: Option<Duration>,
    /// Wait at most this many seconds [0.1] while the line is silent.
    #[arg(long, value_name = "S", value_parser = seconds, num_args = 0..=1, default_missing_value = "0.1")]
    skip_gaps: Option<Duration>,
    /// Wait for the Enter key after each record; q ends it.
    #[arg(long)]
    step: bool,
}

fn speed(text: &str) -> Result<f64, String> {
    let speed: Option<f64> = text.parse().ok();
    speed
        .filter(|speed| (1e-3..=1e6).contains(speed))
        .ok_or_else(|| format!("expected a factor of 0.001 to 1000000, found {text:?}"))
}

impl Replay {
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        if let Some(to) = self.to.filter(|&to| to < self.from) {
            return Err(format!(
                "--to {} s comes before --from {} s",
                to.as_secs_f64(),
                self.from.as_secs_f64()
            ));
        }
        let (header, contents, played): (Header, Contents, Box<dyn Iterator<Item = Result<Record, Stuck>>>);
        if self.recorded {
            contents = read(&self.log, |_| {})?;
            header = contents.header.clone();
            played = Box::new(open(&self.log)?.filter_map(Result::ok).map(Ok));
        } else {
            let log = Rerunnable::read(&self.log, self.machine.as_deref())?;
            let controller = log.controller()?;
            let player = Player::new(log.settings(&*controller));
            header = player.header(&log.contents.header);
            played = Box::new(player.rerun_iter(log.records(), controller));
            contents = log.contents;
        }
        let header = &header;
        let unwritable = |path: &PathBuf, error: log::WriteError| format!("{}: {error}", path.display());
        let mut writer = match &self.out {
            Some(path) => {
                is_free(path, self.force)?;
                Some((path, log::create(path, header).map_err(|error| unwritable(path, error))?))
            }
            None => None,
        };
        let shows = writer.is_none() || self.speed.is_some() || self.step;
        let mut pace = Pace::new(PaceSettings {
            speed: self.speed,
            from: self.from,
            to: self.to.unwrap_or(Duration::MAX),
            longest_gap: self.skip_gaps.unwrap_or(Duration::MAX),
        });
        let mut decoder = Decoder::new(header);
        let mut keys = std::io::stdin().lock();
        let mut is_stepping = self.step;
        let mut verdict = Verdict::of(contents.summary);
        // Read only where it is waited for.
        let began = (self.speed.is_some() || self.step).then(Instant::now);
        for record in played {
            let record = match record {
                Ok(record) => record,
                Err(stuck) => {
                    say(out, &stuck.to_string());
                    verdict = Verdict::Found;
                    break;
                }
            };
            if pace.is_over(record.time) {
                break;
            }
            if let Some((path, writer)) = &mut writer {
                writer.write(&record).map_err(|error| unwritable(path, error))?;
            }
            let words = decoder.words(&record);
            let wait = pace.wait(record.time, began.map_or(Duration::ZERO, |began| began.elapsed()));
            if !shows || !pace.shows(record.time) {
                continue;
            }
            if !is_stepping && !wait.is_zero() {
                // What was shown is seen before it is waited.
                let _ = out.flush(); // what fails here fails at the end, too
                std::thread::sleep(wait);
            }
            if show(out, &record, &words).is_err() && writer.is_none() {
                break; // whoever closed the pipe has seen enough
            }
            if is_stepping {
                let _ = out.flush();
                let mut key = String::new();
                match keys.read_line(&mut key) {
                    Ok(0) | Err(_) => is_stepping = false,
                    Ok(_) if key.trim().eq_ignore_ascii_case("q") => break,
                    Ok(_) => {}
                }
            }
        }
        if let Some((path, writer)) = writer {
            writer.finish().map_err(|error| unwritable(path, error))?;
            say(out, &format!("wrote {}", path.display()));
        }
        if verdict == Verdict::Found {
            say_damage(out, &contents);
        }
        Ok(verdict)
    }
}

fn show(out: &mut impl Write, record: &Record, words: &str) -> std::io::Result<()> {
    let mut line = Vec::new();
    export::line(record, words, &mut line)?;
    out.write_all(&line)
}
