//! The sheet under the camera, where it is known.

use super::command::FollowCommand;
use crate::shared::{SizeOptions, UsualSize, at, doubted, read_file, told_ink, told_notes};
use plotter_vector::{FileRows, Gray, Ours, PxPoint, Vectorizer, follow::Paper, picture::GrayError};
use std::io::Cursor;

/// Farther than this the true lines are not from the middle of the picture's lines, px: less than what the
/// tool is off.
const TRUTH_PX: f64 = 0.1;

/// A drawing with a bit of everything: loops within loops, crossings, sharp tips, hatching.
fn built_in() -> Result<Paper, String> {
    let circle = |x: f64, y: f64, r: f64| -> Vec<PxPoint> {
        let at = |i: i32| f64::from(i) * std::f64::consts::TAU / 120.0;
        (0..=120).map(|i| PxPoint::new(x + r * libm::cos(at(i)), y + r * libm::sin(at(i)))).collect()
    };
    let line = |places: &[(f64, f64)]| places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect::<Vec<_>>();
    let mut strokes = vec![
        (circle(260.0, 260.0, 180.0), 5.0),
        (circle(260.0, 260.0, 110.0), 4.0),
        (circle(310.0, 260.0, 40.0), 3.0),
        (line(&[(40.0, 262.0), (480.0, 255.0)]), 4.0),
        (line(&[(520.0, 90.0), (560.0, 430.0), (610.0, 95.0), (650.0, 425.0), (690.0, 100.0)]), 5.0),
        (line(&[(560.0, 480.0), (820.0, 480.0), (820.0, 620.0), (560.0, 620.0), (560.0, 480.0)]), 5.0),
    ];
    for i in 0..9 {
        let x = 120.0 + 11.0 * f64::from(i);
        strokes.push((line(&[(x, 500.0), (x + 120.0, 640.0)]), 4.0));
    }
    Paper::drawn(880, 700, &strokes).map_err(|error| error.to_string())
}

/// What lies under the camera, where that is known.
pub(super) struct Sheet {
    pub(super) picture: Gray,
    /// The middles of its lines.
    pub(super) truth: Vec<Vec<PxPoint>>,
    /// Size of a pixel on the paper, mm.
    pub(super) mm_per_px: f64,
    /// What was taken from the file or assumed.
    pub(super) told: Vec<(&'static str, String)>,
}

impl Sheet {
    /// The most windows that these lines can need, with such windows: of a clean drawing there is one to two
    /// pixels of a line, and one to half a window of the way between lines and of the search for more. Eight
    /// times as many are allowed, so that a follower that goes in circles ends.
    pub(super) fn most_windows(&self, window_px: u32) -> u64 {
        const TIMES: f64 = 8.0; // two whole drawings took about what is reckoned
        const BEGINS: f64 = 1000.0; // windows that the least of drawings gets
        let length = |line: &Vec<PxPoint>| -> f64 {
            line.windows(2).filter_map(|pair| Some(pair.first()?.distance(*pair.get(1)?))).sum()
        };
        let half_px = 0.5 * f64::from(window_px.max(2));
        let lines = self.truth.iter().map(|line| 0.5 * length(line) + 4.0).sum::<f64>();
        let search = f64::from(self.picture.width()) * f64::from(self.picture.height()) / (half_px * half_px);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of windows")]
        let most = (BEGINS + TIMES * (lines + search)) as u64;
        most
    }
}

/// Size of a pixel where nothing says it, mm.
pub(super) const MM_PER_PX: f64 = 0.1;

pub(super) fn sheet(arguments: &FollowCommand, name: &str) -> Result<Sheet, String> {
    let (mut mm_per_px, mut told) = (arguments.mm_per_px.unwrap_or(MM_PER_PX), Vec::new());
    let picture = match &arguments.image {
        Some(path) => {
            let scan = FileRows::of_page(Cursor::new(read_file(path)?), arguments.page);
            let scan = scan.map_err(|error| at(path, &error))?;
            let asked = SizeOptions { mm_per_px: arguments.mm_per_px, ..SizeOptions::default() };
            let size = asked.of(scan.notes(), UsualSize::MmPerPx(MM_PER_PX))?;
            mm_per_px = size.mm_per_px;
            told.push(("size", size.told()));
            told.extend(told_notes(scan.notes()));
            scan.into_gray().map_err(|error| at(path, &error))?
        }
        None => built_in()?.picture().map_err(|error| error.to_string())?,
    };
    let vectorizer = Vectorizer::from(Ours::default().with_tolerance_px(TRUTH_PX));
    let traced = vectorizer.vectorize(&picture).map_err(|error| format!("{name}: {error}"))?;
    doubted(traced.doubt, "`plotter trace --ink F.png` shows what was taken for ink")
        .map_err(|error| format!("{name}: {error}"))?;
    told.extend(told_ink(traced.look, traced.split));
    let is_light = traced.split.is_some_and(|split| !split.ink_is_dark);
    if traced.look.is_some() {
        told.push(("seen", "as black ink on white paper, evened as the ink was told".into()));
    } else if is_light {
        told.push(("seen", "with dark and light exchanged: the camera looks for dark lines".into()));
    }
    let picture = match traced.look.and_then(|_| vectorizer.threshold.look(&picture)) {
        Some((evened, _)) => evened,
        None if is_light => negative(&picture).map_err(|error| format!("{name}: {error}"))?,
        None => picture,
    };
    let truth = traced.drawing.chords(0.05).strokes().map(<[PxPoint]>::to_vec).collect();
    Ok(Sheet { picture, truth, mm_per_px, told })
}

/// A picture with dark and light exchanged.
fn negative(picture: &Gray) -> Result<Gray, GrayError> {
    Gray::new(picture.width(), picture.height(), picture.pixels().iter().map(|level| !level).collect())
}
