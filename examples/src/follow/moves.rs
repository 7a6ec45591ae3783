//! [`MovesFile`]: the moves of a line follower, as they come, for the machine that makes them.

use crate::follow::FollowMachine;
use crate::shared::at;
use core::fmt;
use plotter_motion::gcode;
use plotter_vector::PxPoint;
use plotter_vector::follow::Tool;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

/// Writes what it gets at once: who reads it makes the move.
#[derive(Debug)]
enum Out {
    File(File),
    Standard,
}

impl fmt::Write for Out {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let written = match self {
            Self::File(file) => file.write_all(text.as_bytes()),
            Self::Standard => io::stdout().write_all(text.as_bytes()).and_then(|()| io::stdout().flush()),
        };
        written.map_err(|_| fmt::Error)
    }
}

/// The moves as a table (`.csv`, or the standard output), or as G-code.
#[derive(Debug)]
pub struct MovesFile {
    name: String,
    form: Form,
    moves: u64,
}

#[derive(Debug)]
enum Form {
    Table(Out),
    Gcode(Option<Box<gcode::Writer<'static, Out>>>),
}

impl MovesFile {
    /// A file: a table where its name ends in `.csv`, otherwise G-code. `None` is a table on the standard
    /// output.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn new(path: Option<&Path>) -> Result<Self, String> {
        let name = path.map_or_else(|| "standard output".into(), |path| path.display().to_string());
        let out = match path {
            Some(path) => Out::File(
                File::create(path).map_err(|error| at(path, &format!("cannot be written: {error}")))?,
            ),
            None => Out::Standard,
        };
        let is_table = path.is_none_or(|path| path.extension().is_some_and(|e| e == "csv"));
        let form = if is_table {
            Form::Table(out)
        } else {
            Form::Gcode(Some(Box::new(gcode::Writer::with_options(out, gcode::WriteOptions::default()))))
        };
        let mut file = Self { name, form, moves: 0 };
        if let Form::Table(out) = &mut file.form {
            writeln!(out, "move,tool,x_px,y_px,x_mm,y_mm").map_err(|_| file.failed())?;
        }
        Ok(file)
    }

    fn failed(&self) -> String {
        format!("{}: cannot be written", self.name)
    }

    /// Writes a move; the first one, number 0, is the way to the start.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn push(&mut self, machine: &FollowMachine, path: &[PxPoint], tool: Tool) -> Result<(), String> {
        let name = if tool == Tool::Down { "down" } else { "up" };
        for to in path {
            let place = machine.on_sheet(*to);
            let written = match &mut self.form {
                Form::Table(out) => {
                    // A line in one piece.
                    let line = format!(
                        "{},{name},{:.3},{:.3},{:.4},{:.4}\n",
                        self.moves, to.x, to.y, place.x, place.y
                    );
                    out.write_str(&line).is_ok()
                }
                Form::Gcode(writer) => {
                    writer.as_mut().is_none_or(|writer| writer.push(machine.op(*to, tool)).is_ok())
                }
            };
            if !written {
                return Err(self.failed());
            }
        }
        self.moves += 1;
        Ok(())
    }

    /// Ends the file: G-code lifts the tool.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), String> {
        let done = match &mut self.form {
            Form::Table(_) => true,
            Form::Gcode(writer) => writer.take().is_none_or(|writer| writer.finish().is_ok()),
        };
        if done { Ok(()) } else { Err(self.failed()) }
    }
}
