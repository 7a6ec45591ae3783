//! `plotter-raw/1`: `t_us,H|D,hex` a line, after a line `# plotter-raw/1 ...`.

use super::hex_dump::hex_run;
use super::{Chunk, Format, Lines, Saw, Side};

#[derive(Debug)]
pub(super) struct PlotterRaw;

fn read(line: &str) -> Option<Chunk> {
    let mut cells = line.split(',');
    let time_us: u64 = cells.next()?.parse().ok()?;
    let side = match cells.next()? {
        "H" => Side::Host,
        "D" => Side::Controller,
        _ => return None,
    };
    let bytes = hex_run(cells.next()?)?;
    let over = cells.next().is_some();
    let time_ns = i128::from(time_us) * 1_000;
    (!over).then_some(Chunk { time_ns, side: Saw::Side(side), bytes })
}

impl Format for PlotterRaw {
    fn line(&mut self, line: &str, out: &mut Lines) {
        if !line.is_empty() && !line.starts_with('#') {
            out.push(read(line).ok_or_else(|| String::from("expected t_us,H|D,hex")));
        }
    }
}
