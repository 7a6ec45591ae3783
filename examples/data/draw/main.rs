//! Draws the two pictures that the examples trace when they are given none.
//!
//! `flag.png` is the line art of the Turkish flag in its official proportions; `technical.png` is the drawing
//! of a bearing bracket with its dimensions, frame and title block. Both look like a scan after thresholding:
//! lines of 1 to 3 px without grey borders. The program only uses whole numbers and square roots, so it draws
//! the same pixels everywhere:
//!
//! ```text
//! cargo run --release --example draw_data            # rewrites examples/data/*.png
//! cargo run --release --example draw_data -- DIR     # writes them into DIR
//! ```

mod canvas;
mod flag;
mod technical;

use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let directory = std::env::args_os().nth(1).map_or(beside, PathBuf::from);
    flag::draw().save(directory.join("flag.png"))?;
    technical::draw().save(directory.join("technical.png"))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn committed(name: &str) -> image::GrayImage {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name);
        image::open(path).unwrap().into_luma8()
    }

    #[test]
    fn the_committed_flag_is_the_one_drawn_here() {
        assert!(flag::draw() == committed("flag.png"), "run `cargo run --example draw_data`");
    }

    #[test]
    fn the_committed_technical_drawing_is_the_one_drawn_here() {
        assert!(technical::draw() == committed("technical.png"), "run `cargo run --example draw_data`");
    }
}
