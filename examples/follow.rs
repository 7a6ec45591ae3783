//! A camera that follows the lines of a drawing larger than what it sees, and a torch that goes with it.
//!
//! A picture lies under a simulated camera that blurs, on a simulated table that misses. Window by window the
//! line follower says where to go: the published one with its circles and its same hand, or ours with its
//! map. Each move goes through the machine's planner to timed steps; the table adds its errors. At the end
//! the path that the tool really took is compared with the drawing.
//!
//! Look at the path over the drawing, and try the published method on the same figure: it cuts sharp corners,
//! turns round in them, and never knows that it is done.
//!
//! With `--from` the windows come from a camera, or from a folder with pictures, and the moves are printed
//! for the machine. With `--live` they are made: a machine on a port is led from place to place, and the next
//! window is taken when it says that it is there.
//!
//! ```text
//! cargo run --release --example follow -- --svg follow.svg
//! cargo run --release --example follow -- drawing.png --table-error 1 --animation follow.gif
//! cargo run --release --example follow -- drawing.png --method published --hand left --report follow.json
//! cargo run --release --features camera --example follow -- --from /dev/video0 --correction camera.json --moves moves.gcode
//! cargo run --release --features live --example follow -- drawing.png --live tcp:127.0.0.1:7000 --protocol grbl
//! ```

use clap::Parser as _;
use plotter_examples::follow::FollowCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    FollowCommand::parse().run()
}
