//! The scan, where it lies on the sheet, and its vectorizations.

use super::command::MaxErrorCommand;
use crate::shared::{IN_MACHINE_FILE, at, doubted, fit_picture, read_file, told_ink, told_notes};
use plotter_motion::{Machine, Point};
use plotter_vector::{
    Bitmap, Drawing, FileRows, Gray, PxPoint, Scale, Vectorized,
    ink::Despeckled,
    report::{FollowedLines, InkDistance, Spots, followed_lines},
    stroke::Pieces,
    trace::VectorizeConfig,
};
use std::io::Cursor;
use std::path::Path;

/// Tolerances that the vectorization is tried with, px: from the finest, each a fifth more than the one
/// before, so that a greater error has all choices of a smaller one.
const FINEST_PX: f64 = 0.125;
const STEPS: u32 = 48;

/// Tolerance of the strokes that the ink's widths are measured along, px.
const REFERENCE_PX: f64 = 0.5;

/// The scan, and where it lies on the sheet.
pub(super) struct Scan {
    pub(super) picture: Gray,
    /// What is to be drawn, and all that there was before its dirt was taken out.
    pub(super) ink: Bitmap,
    pub(super) all_ink: Bitmap,
    pub(super) dirt: Despeckled,
    /// Ink of areas that outlines do not draw.
    pub(super) insides: Spots,
    pub(super) scale: Scale,
    /// What was taken from the file or assumed.
    pub(super) told: Vec<(&'static str, String)>,
    vectorize: VectorizeConfig,
    /// Strokes along which the ink's widths are measured.
    pub(super) reference: Drawing,
}

impl Scan {
    pub(super) fn read(
        args: &MaxErrorCommand,
        machine: &Machine,
        mut vectorize: VectorizeConfig,
    ) -> Result<Self, String> {
        let (bytes, path) = match &args.image {
            Some(path) => (read_file(path)?, path.as_path()),
            None => (include_bytes!("../../data/flag.png").to_vec(), Path::new("flag.png")),
        };
        // What is asked for and not found would be promised of another picture: nothing is drawn.
        let straightened = args.paper.straightened(&bytes, args.page, false, &args.size);
        let straightened = straightened.map_err(|error| at(path, &error.told()))?;
        let (bytes, page) = match &straightened {
            Some(found) => (&found.file, 1),
            None => (&bytes, args.page),
        };
        let scan = FileRows::of_page(Cursor::new(bytes), page).map_err(|error| at(path, &error))?;
        let (notes, asked) = match &straightened {
            Some(found) => (&found.notes, found.paper.sized(&args.size)),
            None => (scan.notes(), args.size),
        };
        let (scale, size) = fit_picture(notes, &asked, machine)?;
        let mut told = vec![("size", size)];
        told.extend(told_notes(notes));
        told.extend(straightened.iter().flat_map(|found| found.paper.told()));
        let picture = scan.into_gray().map_err(|error| at(path, &error))?;
        // Straight lines: what is followed is what was measured.
        vectorize.pieces = Pieces::Lines;
        let settings = vectorize.vectorizer(scale.mm_per_px()).map_err(|error| error.to_string())?;
        let (ink, (all_ink, _)) = (settings.ink(&picture), settings.threshold.apply(&picture));
        let (reference, dirt, insides) = (Drawing::default(), Despeckled::default(), Spots::default());
        let mut scan = Self { picture, ink, all_ink, dirt, insides, scale, told, vectorize, reference };
        let Vectorized { drawing, removed, insides, look, split, doubt, .. } =
            scan.traced(REFERENCE_PX).map_err(|error| at(path, &error))?;
        doubted(doubt, IN_MACHINE_FILE).map_err(|error| at(path, &error))?;
        scan.told.extend(told_ink(look, split));
        (scan.reference, scan.dirt, scan.insides) = (drawing, removed, insides);
        if scan.ink.count() == 0 {
            return Err(at(path, &"there is no ink on it"));
        }
        Ok(scan)
    }

    pub(super) fn traced(&self, max_error_px: f64) -> Result<Vectorized, String> {
        let mut config = self.vectorize;
        config.max_error_px = max_error_px;
        let vectorizer = config.vectorizer(self.scale.mm_per_px()).map_err(|error| error.to_string())?;
        vectorizer.vectorize(&self.picture).map_err(|error| error.to_string())
    }

    /// No line of the drawing is longer, mm.
    pub(super) fn diagonal_mm(&self) -> f64 {
        f64::from(self.ink.width()).hypot(f64::from(self.ink.height())) * self.scale.mm_per_px()
    }

    /// How far the ink is from something drawn and it from the ink, mm.
    pub(super) fn distance_mm(&self, ink: &Bitmap, drawn: &Drawing) -> [f64; 2] {
        let distance = InkDistance::new(ink, &self.reference);
        [distance.of_ink(drawn).max_px, distance.of_drawn(drawn)].map(|px| px * self.scale.mm_per_px())
    }

    /// How each line of the scan is followed, in order, no farther off than this.
    pub(super) fn followed(&self, drawn: &Drawing, bound_mm: f64) -> FollowedLines {
        followed_lines(&self.reference, drawn, bound_mm / self.scale.mm_per_px() + REFERENCE_PX)
    }

    /// What was drawn on the sheet as a drawing in pixels of the scan.
    pub(super) fn in_pixels(&self, strokes: &[Vec<Point>]) -> Drawing {
        let corner = self.scale.to_sheet(PxPoint::new(0.0, 0.0));
        let per_px = self.scale.mm_per_px();
        let mut drawing = Drawing::new(self.ink.width(), self.ink.height());
        for stroke in strokes {
            drawing.push(
                stroke.iter().map(|p| PxPoint::new((p.x - corner.x) / per_px, (corner.y - p.y) / per_px)),
            );
        }
        drawing
    }
}

/// A vectorization, and what it costs.
pub(super) struct Traced {
    pub(super) tolerance_px: f64,
    pub(super) drawing: Drawing,
    pub(super) error_mm: f64,
}

/// All vectorizations that may do, the finest first.
pub(super) fn candidates(scan: &Scan, max_error_mm: f64) -> Result<Vec<Traced>, String> {
    let mut found: Vec<Traced> = Vec::new();
    for step in 0..STEPS {
        let tolerance_px = FINEST_PX * libm::exp2(0.25 * f64::from(step));
        // The finest ones are always tried, to find out what the smallest error is.
        if tolerance_px > REFERENCE_PX && tolerance_px * scan.scale.mm_per_px() > max_error_mm {
            break;
        }
        let drawing = scan.traced(tolerance_px)?.drawing;
        if found.last().is_some_and(|before| before.drawing == drawing) {
            continue;
        }
        // Measured on this very scan, both ways: what was asked of the vectorization is the most that it can
        // be.
        let [ink_mm, drawn_mm] = scan.distance_mm(&scan.ink, &drawing);
        found.push(Traced { tolerance_px, drawing, error_mm: ink_mm.max(drawn_mm) });
    }
    Ok(found)
}
