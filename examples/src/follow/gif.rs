//! [`FollowGif`]: a line follower's run as an animated picture: the drawing, the path as it grows, the
//! camera's window, and what the camera sees.

use crate::follow::FollowFrame;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use plotter_vector::follow::Tool;
use plotter_vector::{Gray, Pixel, PxPoint};
use std::borrow::Cow;

/// Longest side of the drawing in the picture, px.
const SIDE_PX: u32 = 480;

/// Side of the camera's view beside it, px.
const VIEW_PX: u32 = 120;

/// Most pictures: with [`DELAY`] 16 s.
const MOST_SHOTS: usize = 160;

/// Time of a picture, hundredths of a second.
const DELAY: u16 = 10;

/// Time of the last picture.
const LAST_DELAY: u16 = 250;

/// Levels of grey; the noise of more would only make the file larger.
const GREYS: u8 = 8;

/// The colours behind the greys: the path, the ways with the tool lifted, the window; and what did not
/// change.
const COLOURS: [[u8; 3]; 4] = [[208, 24, 24], [90, 160, 90], [42, 111, 176], [255, 0, 255]];
const PATH: u8 = GREYS;
const LIFTED: u8 = GREYS + 1;
const WINDOW: u8 = GREYS + 2;
const SAME: u8 = GREYS + 3;

/// Gathers what the camera saw on the way. Memory is bounded: of a long run every second, fourth, eighth
/// window is kept.
#[derive(Clone, Debug, Default)]
pub struct FollowGif {
    shots: Vec<Shot>,
    /// Every so manyth window is kept.
    every: usize,
    seen: usize,
}

/// A window, and how much of the way was gone by then.
#[derive(Clone, Debug)]
struct Shot {
    frames: usize,
    view: Vec<u8>,
}

impl FollowGif {
    /// Takes a window that was seen after so many moments of the run.
    pub fn see(&mut self, window: &Gray, frames: usize) {
        let every = self.every.max(1);
        if self.seen.is_multiple_of(every) {
            self.shots.push(Shot { frames, view: view(window) });
        }
        self.seen += 1;
        if self.shots.len() >= 2 * MOST_SHOTS {
            let mut index = 0;
            self.shots.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.every = 2 * every;
        }
    }

    /// The animation.
    ///
    /// # Errors
    ///
    /// None that is known: memory takes it all.
    pub fn encode(
        &self,
        picture: &Gray,
        frames: &[FollowFrame],
        window_px: u32,
    ) -> Result<Vec<u8>, gif::EncodingError> {
        let canvas = Canvas::of(picture);
        let palette: Vec<u8> = (0..GREYS)
            .flat_map(|grey| [u8::try_from(u16::from(grey) * 255 / u16::from(GREYS - 1)).unwrap_or(255); 3])
            .chain(COLOURS.into_iter().flatten())
            .collect();
        let side = |px: u32| u16::try_from(px).unwrap_or(u16::MAX);
        let (width, height) = (canvas.width + VIEW_PX, canvas.height.max(VIEW_PX));
        let mut encoder = Encoder::new(Vec::new(), side(width), side(height), &palette)?;
        encoder.set_repeat(Repeat::Infinite)?;
        let apart = self.shots.len().div_ceil(MOST_SHOTS).max(1);
        // The last window is always shown.
        let last = self.shots.len().saturating_sub(1);
        let shown = self.shots.iter().enumerate().filter(|(i, _)| i % apart == 0 || *i == last);
        let mut ground = canvas.ground(width, height);
        let mut before: Vec<u8> = Vec::new();
        let mut drawn = 0;
        for (index, shot) in shown {
            let until = if index == last { frames.len() } else { shot.frames.min(frames.len()) };
            for pair in frames.get(drawn.max(1) - 1..until).unwrap_or(&[]).windows(2) {
                if let [from, to] = pair {
                    let colour = if to.tool == Tool::Down { PATH } else { LIFTED };
                    canvas.line(&mut ground, width, from.at, to.at, colour);
                }
            }
            drawn = until;
            let mut pixels = ground.clone();
            if let Some(frame) = frames.get(until.max(1) - 1) {
                canvas.square(&mut pixels, width, frame.at, 0.5 * f64::from(window_px));
            }
            for (row, levels) in shot.view.chunks(VIEW_PX as usize).enumerate() {
                let at = row * width as usize + canvas.width as usize;
                if let Some(target) = pixels.get_mut(at..at + levels.len()) {
                    target.copy_from_slice(levels);
                }
            }
            let delay = if index == last { LAST_DELAY } else { DELAY };
            encoder.write_frame(&changed(&before, &pixels, width, delay))?;
            before = pixels;
        }
        encoder.into_inner()
    }
}

/// The window as it is shown: [`VIEW_PX`] wide and high, in a few greys.
fn view(window: &Gray) -> Vec<u8> {
    let at = |i: u32, side: u32| i * side / VIEW_PX;
    let place = |x: u32, y: u32| Pixel::new(at(x, window.width()), at(y, window.height()));
    let level = |x: u32, y: u32| window.get(place(x, y)).unwrap_or(u8::MAX);
    (0..VIEW_PX).flat_map(|y| (0..VIEW_PX).map(move |x| (x, y))).map(|(x, y)| grey(level(x, y))).collect()
}

fn grey(level: u8) -> u8 {
    u8::try_from((u16::from(level) * u16::from(GREYS - 1) + 127) / 255).unwrap_or(0)
}

/// What changed, as a frame: a part of the picture, in which unchanged pixels are left out.
fn changed(before: &[u8], pixels: &[u8], width: u32, delay: u16) -> Frame<'static> {
    let width = width as usize;
    let is_new = |i: &usize| before.get(*i) != pixels.get(*i);
    let (mut left, mut right, mut top, mut bottom) = (width, 0, usize::MAX, 0);
    for i in (0..pixels.len()).filter(is_new) {
        let (x, y) = (i % width, i / width);
        (left, right, top, bottom) = (left.min(x), right.max(x), top.min(y), bottom.max(y));
    }
    if left > right {
        // Nothing: a pixel that stays.
        (left, right, top, bottom) = (0, 0, 0, 0);
    }
    let buffer: Vec<u8> = (top..=bottom)
        .flat_map(|y| (left..=right).map(move |x| y * width + x))
        .map(|i| if is_new(&i) { pixels.get(i).copied().unwrap_or(SAME) } else { SAME })
        .collect();
    let side = |px: usize| u16::try_from(px).unwrap_or(u16::MAX);
    Frame {
        delay,
        dispose: DisposalMethod::Keep,
        transparent: Some(SAME),
        left: side(left),
        top: side(top),
        width: side(right - left + 1),
        height: side(bottom - top + 1),
        buffer: Cow::Owned(buffer),
        ..Frame::default()
    }
}

/// The drawing, made smaller.
struct Canvas<'a> {
    picture: &'a Gray,
    scale: f64,
    width: u32,
    height: u32,
}

impl<'a> Canvas<'a> {
    fn of(picture: &'a Gray) -> Self {
        let longest = picture.width().max(picture.height()).max(1);
        let scale = (f64::from(SIDE_PX) / f64::from(longest)).min(1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 480")]
        let side = |px: u32| (f64::from(px) * scale).ceil().max(1.0) as u32;
        Self { picture, scale, width: side(picture.width()), height: side(picture.height()) }
    }

    /// The drawing in pale grey, with room for the camera's view beside it.
    fn ground(&self, width: u32, height: u32) -> Vec<u8> {
        let shown = |x: u32, y: u32| {
            if x >= self.width || y >= self.height {
                return GREYS - 1;
            }
            // The darkest of the pixels that become one, so that thin lines stay.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in the picture")]
            let span = |at: u32, side: u32| {
                let first = (f64::from(at) / self.scale) as u32;
                let last = (f64::from(at + 1) / self.scale).ceil() as u32;
                first.min(side.saturating_sub(1))..last.clamp(first + 1, side.max(first + 1))
            };
            let rows = span(y, self.picture.height());
            let columns = span(x, self.picture.width());
            let level = rows
                .flat_map(|v| columns.clone().map(move |u| Pixel::new(u, v)))
                .filter_map(|pixel| self.picture.get(pixel))
                .min()
                .unwrap_or(u8::MAX);
            grey(u8::MAX - (u8::MAX - level) / 2)
        };
        (0..height).flat_map(|y| (0..width).map(move |x| shown(x, y))).collect()
    }

    fn put(&self, pixels: &mut [u8], width: u32, x: f64, y: f64, colour: u8) {
        if x < 0.0 || y < 0.0 || x >= f64::from(self.width) || y >= f64::from(self.height) {
            return;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in the picture")]
        let index = y as usize * width as usize + x as usize;
        if let Some(pixel) = pixels.get_mut(index) {
            *pixel = colour;
        }
    }

    fn line(&self, pixels: &mut [u8], width: u32, from: PxPoint, to: PxPoint, colour: u8) {
        let (dx, dy) = (self.scale * (to.x - from.x), self.scale * (to.y - from.y));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded")]
        let parts = (2.0 * dx.abs().max(dy.abs())).ceil().clamp(1.0, 4096.0) as u32;
        for part in 0..=parts {
            let share = f64::from(part) / f64::from(parts);
            let (x, y) = (self.scale * from.x + share * dx, self.scale * from.y + share * dy);
            self.put(pixels, width, x, y, colour);
        }
    }

    /// The frame of a window, and its middle.
    fn square(&self, pixels: &mut [u8], width: u32, at: PxPoint, half: f64) {
        let corner = |x: f64, y: f64| PxPoint::new(at.x + x * half, at.y + y * half);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        for (from, to) in corners.into_iter().zip(corners.into_iter().cycle().skip(1)) {
            self.line(pixels, width, from, to, WINDOW);
        }
        for (dx, dy) in [(-2.0, 0.0), (-1.0, 0.0), (0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]
            .into_iter()
            .flat_map(|(x, y)| [(x, y), (y, x)])
        {
            self.put(pixels, width, self.scale * at.x + dx, self.scale * at.y + dy, WINDOW);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_is_a_short_animation() {
        let picture = Gray::new(900, 300, vec![200; 900 * 300]).unwrap();
        let mut gif = FollowGif::default();
        let mut frames = Vec::new();
        for i in 0..5000_u32 {
            frames.push(FollowFrame { at: PxPoint::new(f64::from(i) * 0.18, 150.0), tool: Tool::Down });
            let level = u8::try_from(i % 256).unwrap();
            gif.see(&Gray::new(50, 50, vec![level; 2500]).unwrap(), frames.len());
        }
        let bytes = gif.encode(&picture, &frames, 100).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::Indexed);
        let mut decoder = options.read_info(bytes.as_slice()).unwrap();
        assert_eq!((decoder.width(), decoder.height()), (600, 160));
        let (mut count, mut time, mut path) = (0, 0, 0);
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            count += 1;
            time += u32::from(frame.delay);
            path += frame.buffer.iter().filter(|pixel| **pixel == PATH).count();
        }
        assert!((80..=MOST_SHOTS + 1).contains(&count) && (1000..2000).contains(&time), "{count} {time}");
        // 480 px of path, each drawn once or more.
        assert!(path >= 480, "{path}");
    }
}
