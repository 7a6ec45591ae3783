//! [`WindowSource`]: windows of a real camera, or of a folder with pictures that stands in for one.

use crate::shared::{at, read_file};
use plotter_vector::{Gray, decode};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[cfg(all(feature = "camera", target_os = "linux"))]
use crate::follow::v4l_camera::V4lCamera;

/// What a picture's name ends with.
const ENDINGS: [&str; 12] =
    ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "gif", "pgm", "pbm", "ppm", "pnm"];

/// How often it is looked whether a picture has come, and grows no more.
const AWAITED_EVERY: Duration = Duration::from_millis(20);

/// Where windows come from. Each is grey, and the square middle of its picture.
#[derive(Debug)]
pub struct WindowSource {
    from: From,
    side_px: Option<u32>,
}

#[derive(Debug)]
enum From {
    Folder {
        name: PathBuf,
        files: std::vec::IntoIter<PathBuf>,
    },
    /// A folder whose pictures come while a machine waits for them: the number of the next, and how long.
    Awaited {
        name: PathBuf,
        number: u64,
        within: Duration,
    },
    #[cfg(all(feature = "camera", target_os = "linux"))]
    Camera(Box<V4lCamera>),
}

impl WindowSource {
    /// Opens a folder, whose pictures come in the order of their names, or a device such as `/dev/video0`. Windows get the side
    /// `side_px`, or that of the picture's shorter side.
    ///
    /// # Errors
    ///
    /// What is missing, has no pictures, or is no camera; a camera where the program is built without one.
    pub fn open(path: &Path, side_px: Option<u32>) -> Result<Self, String> {
        let kind =
            std::fs::metadata(path).map_err(|error| at(path, &format!("cannot be opened: {error}")))?;
        let from = if kind.is_dir() {
            let files = pictures(path)?;
            if files.is_empty() {
                return Err(at(
                    path,
                    &format!("no pictures in it; their names end in {}", ENDINGS.join(", ")),
                ));
            }
            From::Folder { name: path.to_owned(), files: files.into_iter() }
        } else {
            camera(path)?
        };
        Ok(Self { from, side_px })
    }

    /// The same, for a machine that waits: of a folder the picture that is called by its number, 0 at first,
    /// is waited for at most `within`.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open), but a folder must have no such pictures yet: they were taken elsewhere.
    pub fn awaiting(path: &Path, side_px: Option<u32>, within: Duration) -> Result<Self, String> {
        if !path.is_dir() {
            return Self::open(path, side_px);
        }
        if let Some(old) = pictures(path)?.into_iter().find(|file| number_of(file).is_some()) {
            return Err(at(
                &old,
                &"was here before the machine was: empty the folder, lest an old picture leads it",
            ));
        }
        Ok(Self { from: From::Awaited { name: path.to_owned(), number: 0, within }, side_px })
    }

    /// Whether time passes between the pictures: a folder does not wait for a machine.
    #[must_use]
    pub const fn is_live(&self) -> bool {
        !matches!(self.from, From::Folder { .. } | From::Awaited { .. })
    }

    /// The next window; none when a folder has no more.
    ///
    /// # Errors
    ///
    /// A file that is no picture, or a camera that gives none any more.
    pub fn next_window(&mut self) -> Result<Option<Gray>, String> {
        let picture = match &mut self.from {
            From::Folder { files, .. } => {
                let Some(file) = files.next() else { return Ok(None) };
                decode(&read_file(&file)?).map_err(|error| at(&file, &error))?
            }
            From::Awaited { name, number, within } => {
                let picture = awaited(name, *number, *within)?;
                *number += 1;
                picture
            }
            #[cfg(all(feature = "camera", target_os = "linux"))]
            From::Camera(camera) => camera.picture()?,
        };
        let shorter = picture.width().min(picture.height());
        let side = self.side_px.unwrap_or(shorter);
        if side > shorter {
            let (width, height) = (picture.width(), picture.height());
            return Err(format!(
                "{}: a picture of {width} x {height} px, too small for windows of {side} px",
                self.name()
            ));
        }
        middle_square(&picture, side).map(Some)
    }

    /// What it is called.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.from {
            From::Folder { name, .. } | From::Awaited { name, .. } => name.display().to_string(),
            #[cfg(all(feature = "camera", target_os = "linux"))]
            From::Camera(camera) => camera.name().to_owned(),
        }
    }

    /// Waits until a live camera's machine has made its move and stands still.
    pub fn wait(&self, seconds: f64) {
        if self.is_live() && seconds > 0.0 {
            std::thread::sleep(Duration::from_secs_f64(seconds.min(3600.0)));
        }
    }
}

/// The number that a picture is called by: 7 for `7.png` and `0007.jpg`.
fn number_of(file: &Path) -> Option<u64> {
    file.file_stem()?.to_str()?.parse().ok()
}

/// The picture of a number, once it is there and whole.
fn awaited(folder: &Path, number: u64, within: Duration) -> Result<Gray, String> {
    let until = Instant::now() + within;
    let (mut bytes_before, mut broken) = (None, None);
    loop {
        let file = pictures(folder)?.into_iter().find(|file| number_of(file) == Some(number));
        if let Some(file) = file {
            let bytes = read_file(&file)?.len();
            // Whoever writes it may not be done: it is whole when it grows no more and can be read.
            if bytes_before.replace(bytes) == Some(bytes) {
                match decode(&read_file(&file)?) {
                    Ok(picture) => return Ok(picture),
                    Err(error) => broken = Some(at(&file, &error)),
                }
            }
        }
        if Instant::now() >= until {
            let missing = || {
                at(
                    folder,
                    &format!("no picture {number} (such as {number}.png) came within {} s", within.as_secs()),
                )
            };
            return Err(broken.unwrap_or_else(missing));
        }
        std::thread::sleep(AWAITED_EVERY);
    }
}

fn pictures(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let failed = |error: std::io::Error| at(folder, &format!("cannot be read: {error}"));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        if ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(all(feature = "camera", target_os = "linux"))]
fn camera(path: &Path) -> Result<From, String> {
    V4lCamera::open(path).map(|camera| From::Camera(Box::new(camera)))
}

#[cfg(not(all(feature = "camera", target_os = "linux")))]
fn camera(path: &Path) -> Result<From, String> {
    Err(at(path, &"no folder; a camera (Linux) needs a build with --features camera"))
}

/// The square middle of a picture.
fn middle_square(picture: &Gray, side: u32) -> Result<Gray, String> {
    let (left, top) = ((picture.width() - side) / 2, (picture.height() - side) / 2);
    let columns = left as usize..(left + side) as usize;
    let rows = picture.rows().skip(top as usize).take(side as usize);
    let levels = rows.flat_map(|row| row.get(columns.clone()).unwrap_or(&[])).copied().collect();
    Gray::new(side, side, levels).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_cut_out() {
        let levels = (0..4).flat_map(|y| (0..6).map(move |x| 10 * y + x)).collect();
        let square = middle_square(&Gray::new(6, 4, levels).unwrap(), 2).unwrap();
        assert_eq!(square.pixels(), [12, 13, 22, 23]);
    }

    #[test]
    fn a_folder_gives_its_pictures_in_order_and_ends() {
        let folder = tempfile::tempdir().unwrap();
        for (name, level) in [("b.PGM", 2), ("a.pgm", 1), ("notes.txt", 9)] {
            std::fs::write(
                folder.path().join(name),
                format!("P2 3 2 255\n{}", format!("{level} ").repeat(6)),
            )
            .unwrap();
        }
        let mut source = WindowSource::open(folder.path(), None).unwrap();
        let mut level = || source.next_window().unwrap().map(|window| (window.width(), window.pixels()[0]));
        assert_eq!([level(), level(), level(), level()], [Some((2, 1)), Some((2, 2)), None, None]);
        assert!(WindowSource::open(&folder.path().join("missing"), None).unwrap_err().contains("missing: "));
        let mut larger = WindowSource::open(folder.path(), Some(3)).unwrap();
        assert!(larger.next_window().unwrap_err().contains("too small for windows of 3 px"));
    }
}
