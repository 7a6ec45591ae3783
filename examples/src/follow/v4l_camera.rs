//! [`V4lCamera`]: pictures of a web camera, through V4L2.

use crate::shared::at;
use linuxvideo::format::{PixFormat, PixelFormat};
use linuxvideo::stream::ReadStream;
use linuxvideo::{BufType, Device};
use plotter_vector::{Gray, decode};
use std::path::Path;
use std::time::{Duration, Instant};

/// What is asked of a camera; it takes the nearest that it has.
const SIZE_PX: (u32, u32) = (640, 480);

/// Pictures that were exposed while the machine moved, at most: those in the driver's buffers, and the one in
/// progress.
const STALE: usize = 3;

/// A camera that gives no picture by then is unplugged, or used by another program.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long nothing is asked while no picture is there.
const PAUSE: Duration = Duration::from_millis(5);

/// Times that a picture with an error is asked for again.
const TRIES: usize = 5;

/// A camera that runs.
pub(crate) struct V4lCamera {
    name: String,
    stream: ReadStream,
    format: Format,
}

/// What the camera's bytes are.
#[derive(Clone, Copy, Debug)]
struct Format {
    width: u32,
    height: u32,
    row_bytes: u32,
    pixels: PixelFormat,
}

impl std::fmt::Debug for V4lCamera {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("V4lCamera")
            .field("name", &self.name)
            .field("format", &self.format)
            .finish_non_exhaustive()
    }
}

impl V4lCamera {
    /// Starts a camera: uncompressed pictures where it has them, otherwise JPEG.
    ///
    /// # Errors
    ///
    /// What is no camera, is used by another program, or has no form of pictures that can be read.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        let failed = |error: std::io::Error| at(path, &format!("cannot be used as a camera: {error}"));
        let device = Device::open(path).map_err(failed)?;
        let offered: Vec<PixelFormat> = device
            .formats(BufType::VIDEO_CAPTURE)
            .filter_map(Result::ok)
            .map(|format| format.pixel_format())
            .collect();
        let known = [PixelFormat::YUYV, PixelFormat::MJPG, PixelFormat::JPEG];
        let Some(chosen) = known.into_iter().find(|format| offered.contains(format)) else {
            return Err(at(path, &format!("gives {offered:?}; YUYV, MJPG or JPEG are read")));
        };
        let capture = device.video_capture(PixFormat::new(SIZE_PX.0, SIZE_PX.1, chosen)).map_err(failed)?;
        let agreed = capture.format();
        let format = Format {
            width: agreed.width(),
            height: agreed.height(),
            row_bytes: agreed.bytes_per_line(),
            pixels: agreed.pixel_format(),
        };
        let stream = capture.into_stream().map_err(failed)?;
        Ok(Self { name: path.display().to_string(), stream, format })
    }

    /// Name of the device.
    #[must_use]
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// A picture that was exposed after this call.
    ///
    /// # Errors
    ///
    /// A camera that was unplugged, or gives nothing for five seconds.
    pub(crate) fn picture(&mut self) -> Result<Gray, String> {
        for _ in 0..STALE {
            self.bytes()?;
        }
        let mut last = String::new();
        for _ in 0..TRIES {
            let bytes = self.bytes()?;
            match grey(&bytes, self.format) {
                Ok(picture) => return Ok(picture),
                Err(error) => last = error,
            }
        }
        Err(format!("{}: {TRIES} broken pictures in a row: {last}", self.name))
    }

    fn bytes(&mut self) -> Result<Vec<u8>, String> {
        let gone = |name: &str, error: &dyn std::fmt::Display| {
            format!("{name}: no picture: {error}; is the camera still plugged in?")
        };
        let since = Instant::now();
        while self.stream.will_block().map_err(|error| gone(&self.name, &error))? {
            if since.elapsed() > PATIENCE {
                return Err(gone(&self.name, &"nothing came for 5 s"));
            }
            std::thread::sleep(PAUSE);
        }
        self.stream.dequeue(|view| Ok(view.to_vec())).map_err(|error| gone(&self.name, &error))
    }
}

/// The light of a picture as it came.
fn grey(bytes: &[u8], format: Format) -> Result<Gray, String> {
    if format.pixels != PixelFormat::YUYV {
        return decode(bytes).map_err(|error| error.to_string());
    }
    // A colour stands after each level of light.
    let row = (format.row_bytes as usize).max(2 * format.width as usize);
    let levels: Vec<u8> = bytes
        .chunks(row.max(1))
        .take(format.height as usize)
        .flat_map(|row| row.iter().step_by(2).take(format.width as usize))
        .copied()
        .collect();
    Gray::new(format.width, format.height, levels).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_is_every_second_byte_of_each_row() {
        let format = Format { width: 2, height: 2, row_bytes: 6, pixels: PixelFormat::YUYV };
        let bytes = [10, 128, 20, 128, 0, 0, 30, 128, 40, 128, 0, 0];
        assert_eq!(grey(&bytes, format).unwrap().pixels(), [10, 20, 30, 40]);
        assert!(grey(&bytes[..6], format).is_err(), "half of a picture");
    }

    #[test]
    fn what_is_no_camera_is_told() {
        let told = V4lCamera::open(Path::new("/dev/null")).unwrap_err();
        assert!(told.starts_with("/dev/null: cannot be used as a camera"), "{told}");
    }
}
