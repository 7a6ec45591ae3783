//! [`FontFiles`]: what texts of SVG pictures are set in.

use crate::shared::{at, read_file};
use plotter_vector::svg_in::SvgFonts;
use std::path::{Path, PathBuf};

/// What fonts are called in folders.
const SUFFIXES: [&str; 4] = ["ttf", "otf", "ttc", "otc"];

/// Deepest folder in a folder that is looked into.
const DEEPEST: usize = 16;

/// Most that the fonts may come to together, bytes.
const MOST_BYTES: usize = 1 << 30;

/// The options `--font` and `--single-stroke`.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct FontFiles {
    /// Font for the texts of an SVG picture, which are left out without: a file (TrueType, OpenType), or a
    /// folder for all fonts in it, as /usr/share/fonts; may be given several times
    #[arg(long = "font", value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Draws the texts of an SVG picture in letters of one line each, as labels of HPGL. With --font too,
    /// texts that name one of those fonts are set in it, and letters that are not in Latin-1 taken from them:
    /// a font is given to be used
    #[arg(long)]
    pub single_stroke: bool,
}

impl FontFiles {
    /// Whether neither is given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.files.is_empty() && !self.single_stroke
    }

    /// Those of the files, in the order in which they are named, and of a folder's files by their names; of
    /// each folder with files that are called fonts and are none, what there is to say about these.
    ///
    /// # Errors
    ///
    /// The file that cannot be read or is no font, or the folder that has none.
    pub fn load(&self) -> Result<(SvgFonts, Vec<String>), String> {
        let mut fonts = if self.single_stroke { SvgFonts::single_stroke() } else { SvgFonts::default() };
        let mut told = Vec::new();
        let mut room = MOST_BYTES;
        for named in &self.files {
            let failed = |error: &dyn std::fmt::Display| format!("--font: {}", at(named, &error.to_string()));
            if !named.is_dir() {
                let bytes = read_file(named).map_err(|error| format!("--font: {error}"))?;
                fonts.add(bytes).map_err(|error| failed(&format!("this is {error}")))?;
                continue;
            }
            let mut found = Vec::new();
            collect(named, DEEPEST, &mut found).map_err(|error| failed(&error))?;
            let (mut added, mut refused) = (0, Vec::new());
            for file in found {
                let bytes = read_file(&file).map_err(|error| format!("--font: {error}"))?;
                room = room.checked_sub(bytes.len()).ok_or_else(|| {
                    failed(&format!(
                        "more than {} MiB of fonts: name the files that are needed",
                        MOST_BYTES >> 20
                    ))
                })?;
                // A folder may hold what only looks like one.
                match fonts.add(bytes) {
                    Ok(()) => added += 1,
                    Err(error) => refused.push(at(&file, &format!("this is {error}"))),
                }
            }
            if added == 0 {
                let why = refused.first().map_or(String::new(), |first| format!("; {first}"));
                return Err(failed(&format!("this folder holds no font (.ttf, .otf, .ttc){why}")));
            }
            if let Some(first) = refused.first() {
                let count = refused.len();
                let files =
                    if count == 1 { "a file".into() } else { format!("{count} files, the first of them") };
                told.push(format!("left out of the fonts: {files} {first}"));
            }
        }
        Ok((fonts, told))
    }
}

/// The fonts in a folder and the folders in it, by their names: the system lists them in no order.
fn collect(folder: &Path, deepest: usize, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        // Folders by links may lead back.
        if entry.file_type()?.is_dir() {
            if deepest > 0 {
                collect(&path, deepest - 1, found)?;
            }
            continue;
        }
        let suffix = path.extension().map(|suffix| suffix.to_string_lossy().to_lowercase());
        if suffix.is_some_and(|suffix| SUFFIXES.contains(&suffix.as_str())) && path.is_file() {
            found.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_a_font_says_what_its_files_are() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("web.ttf"), b"wOF2\0\x01\0\0").unwrap();
        std::fs::write(folder.path().join("notes.txt"), b"no font, and not called so").unwrap();
        let error =
            FontFiles { files: vec![folder.path().to_owned()], ..FontFiles::default() }.load().unwrap_err();
        assert!(
            error.contains("this folder holds no font") && error.contains("web.ttf: this is a web font"),
            "{error}"
        );
    }
}
