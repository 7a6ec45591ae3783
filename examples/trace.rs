//! From a scanned line drawing to pen strokes: vectorization alone, without a machine.
//!
//! Shows the published vectorization and ours side by side on the same picture: trace it with both and
//! compare the vertices, the error and the travel with the pen up. Look at the SVG beside the picture: the
//! published strokes wander off slow curves and leave a pixel open where lines meet; ours stay within the
//! promised error and close.
//!
//! The picture is read by rows and never held whole, so a sheet may have any size: look at the last line of
//! an A1 scan, whose memory is that of a small picture. Only `--pens` needs all of it at once. Ctrl-C stops
//! it between two bands, and nothing is written.
//!
//! Without a picture it traces the flag that comes with the examples:
//!
//! ```text
//! cargo run --release --example trace
//! cargo run --release --example trace -- scan.png --max-error-px 0.4 --svg scan.svg --hpgl scan.plt
//! cargo run --release --example trace -- scan.png --arcs --svg scan.svg --gcode scan.gcode
//! cargo run --release --example trace -- photo.jpg --pens 3 --svg pens.svg --overlay pens.png
//! scanimage --format png | cargo run --release --example trace -- - --hpgl - > scan.plt
//! cargo run --release --example draw_corpus -- --sheet a1 --dpi 600 a1.pbm
//! cargo run --release --example trace -- a1.pbm --svg a1.svg
//! ```

use clap::Parser as _;
use plotter_examples::trace::TraceCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    TraceCommand::parse().run()
}
