//! Writes small pictures of every kind into `corpus/`, for each target.

#[path = "../../plotter-vector/tests/scan/pictures.rs"]
mod pictures;

fn main() -> std::io::Result<()> {
    let corpus = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for target in ["image_to_drawing", "rows"] {
        let folder = corpus.join(target);
        std::fs::create_dir_all(&folder)?;
        for (number, (_, bytes)) in pictures::every_kind(9, 6).into_iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number:03}")), bytes)?;
        }
    }
    Ok(())
}
