//! [`PaperSearch`]: the head looks for both edges of the paper.

use super::{GREATEST_TURN_RAD, Paper, PaperError, STRAIGHT_MM, Side};
use crate::{
    Optics, Search,
    sense::{Ask, SearchError, Tact},
};
use plotter_motion::{Axis, Point};

/// Number of places along the paper where both edges are looked for: two tell a straight edge, the others
/// show torn places.
const ROWS: usize = 5;

/// How the paper is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct PaperSettings {
    /// The optical head.
    pub optics: Optics,
    /// The head's least and greatest x, mm.
    pub reach_mm: [f64; 2],
    /// Where along the table the head goes across, mm: from the first of five places to the last.
    pub rows_mm: [f64; 2],
    /// Speed of the head, mm/s.
    pub speed_mm_s: f64,
    /// Paper is where nothing dark is seen over this length, mm: a slit of light in a torn edge is none.
    pub least_mm: f64,
}

impl PaperSettings {
    /// The same with another [`PaperSettings::optics`].
    #[must_use]
    pub const fn with_optics(self, optics: Optics) -> Self {
        Self { optics, ..self }
    }

    /// The same with another [`PaperSettings::reach_mm`].
    #[must_use]
    pub const fn with_reach_mm(self, reach_mm: [f64; 2]) -> Self {
        Self { reach_mm, ..self }
    }

    /// The same with another [`PaperSettings::rows_mm`].
    #[must_use]
    pub const fn with_rows_mm(self, rows_mm: [f64; 2]) -> Self {
        Self { rows_mm, ..self }
    }

    /// The same with another [`PaperSettings::speed_mm_s`].
    #[must_use]
    pub const fn with_speed_mm_s(self, speed_mm_s: f64) -> Self {
        Self { speed_mm_s, ..self }
    }

    /// The same with another [`PaperSettings::least_mm`].
    #[must_use]
    pub const fn with_least_mm(self, least_mm: f64) -> Self {
        Self { least_mm, ..self }
    }
}

impl Default for PaperSettings {
    /// The documented textile plotter: 2100 mm at 0.3 m/s.
    fn default() -> Self {
        Self {
            optics: Optics::default(),
            reach_mm: [-50.0, 2_050.0],
            rows_mm: [20.0, 970.0],
            speed_mm_s: 300.0,
            least_mm: 20.0,
        }
    }
}

/// Looks for both edges of the paper, whose place and width are not known: at five places along the table the
/// head comes from the left end of its way until it has seen 20 mm of paper, then from the right end.
///
/// Beside the paper the head sees the glass of the table, which throws the lamps' light away from the
/// detector: as dark as ink.
///
/// Source for what must be found: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper
/// sheets", section II: "the exact basic position and width are unknown at the beginning of a new sketch
/// drawing". How is ours; it does not say.
///
/// ```
/// use plotter_stitch::{PaperSearch, paper::{PaperSettings, SensedPaper}};
///
/// let mut paper = SensedPaper::new([312.0, 1480.0], 0.001, 1);
/// let mut search = PaperSearch::new(PaperSettings::default());
/// paper.run(&mut search)?;
/// let found = search.paper()?;
/// // Turned by 0.001 rad, the left edge lies 0.02 mm to the left of 312 mm at y = 20, the right one 0.97 mm left of 1480 mm at y = 970.
/// assert!((found.left_mm - 311.98).abs() < 0.4 && (found.right_mm - 1479.03).abs() < 0.4);
/// assert!((found.turn_rad - 0.001).abs() < 3e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PaperSearch {
    settings: PaperSettings,
    /// Which scan: row by row, left then right; twice the number of rows is the end.
    scan: usize,
    is_scanning: bool,
    /// The scan under way: the last tact with something dark, and the first without after it.
    dark: Option<Tact>,
    light: Option<Tact>,
    edges_mm: [[Option<f64>; 2]; ROWS],
    error: Option<PaperError>,
}

impl PaperSearch {
    /// With these settings.
    #[must_use]
    pub const fn new(settings: PaperSettings) -> Self {
        Self {
            settings,
            scan: 0,
            is_scanning: false,
            dark: None,
            light: None,
            edges_mm: [[None; 2]; ROWS],
            error: None,
        }
    }

    /// Where the paper lies.
    ///
    /// # Errors
    ///
    /// [`PaperError`]: the search is not over, there is no paper, it reaches beyond the head's way, or an
    /// edge is not straight.
    pub fn paper(&self) -> Result<Paper, PaperError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let mut edges = [[0.0; ROWS]; 2];
        for (row, found) in self.edges_mm.iter().enumerate() {
            for (side, edge_mm) in found.iter().enumerate() {
                edges[side][row] = edge_mm.ok_or(PaperError::NotDone)?;
            }
        }
        let rows_mm: [f64; ROWS] = core::array::from_fn(|row| self.row_mm(row));
        let slopes = edges.map(|edge_mm| straight(&rows_mm, &edge_mm));
        for (side, (edge_mm, slope)) in [Side::Left, Side::Right].into_iter().zip(edges.iter().zip(slopes)) {
            let off_mm = off(&rows_mm, edge_mm, slope);
            let worst = (0..ROWS).fold(0, |worst, row| {
                if libm::fabs(off_mm[row]) > libm::fabs(off_mm[worst]) { row } else { worst }
            });
            if libm::fabs(off_mm[worst]) > STRAIGHT_MM {
                return Err(PaperError::Torn { side, y_mm: rows_mm[worst], off_mm: off_mm[worst] });
            }
        }
        let turn_rad = -libm::atan(0.5 * (slopes[0] + slopes[1]));
        if libm::fabs(turn_rad) > GREATEST_TURN_RAD {
            return Err(PaperError::Askew { turn_rad });
        }
        let [left, right] = edges;
        Ok(Paper {
            left_mm: left.into_iter().fold(f64::NEG_INFINITY, f64::max),
            right_mm: right.into_iter().fold(f64::INFINITY, f64::min),
            turn_rad,
        })
    }

    #[expect(clippy::cast_precision_loss, reason = "five at the most")]
    fn row_mm(&self, row: usize) -> f64 {
        let [first, last] = self.settings.rows_mm;
        first + (last - first) * row as f64 / (ROWS - 1) as f64
    }

    /// From where to where the scan under way goes.
    const fn ends_mm(&self) -> [f64; 2] {
        let [least, most] = self.settings.reach_mm;
        if self.scan.is_multiple_of(2) { [least, most] } else { [most, least] }
    }

    const fn side(&self) -> Side {
        if self.scan.is_multiple_of(2) { Side::Left } else { Side::Right }
    }

    /// The edge between the last dark sample and the first light one, where the disc is covered by as much as
    /// is seen.
    fn edge_mm(&self, dark: Tact, light: Tact) -> f64 {
        let optics = &self.settings.optics;
        let way_mm = light.position_mm - dark.position_mm;
        // One sample in two: the change lies within that tact, else between both.
        let between_mm = if dark.hits == 1 { dark.position_mm } else { dark.position_mm + 0.5 * way_mm };
        let seen_mm = 0.5 * (optics.span_mm() - optics.line_mm);
        let delay_mm = libm::copysign(self.settings.speed_mm_s * optics.latency_s, way_mm);
        between_mm - delay_mm - libm::copysign(seen_mm, way_mm)
    }

    fn next(&mut self, found_mm: f64) {
        if let Some(edge_mm) = self.edges_mm.get_mut(self.scan / 2).and_then(|row| row.get_mut(self.scan % 2))
        {
            *edge_mm = Some(found_mm);
        }
        self.scan += 1;
        self.is_scanning = false;
        (self.dark, self.light) = (None, None);
    }

    fn fail(&mut self, error: PaperError) {
        self.error = Some(error);
        self.scan = 2 * ROWS;
    }
}

impl Search for PaperSearch {
    fn ask(&self) -> Ask {
        if self.scan >= 2 * ROWS {
            return Ask::Done;
        }
        let ([from_mm, to_mm], y_mm) = (self.ends_mm(), self.row_mm(self.scan / 2));
        let from = Point::new(from_mm, y_mm);
        if !self.is_scanning {
            return Ask::Travel { to: from };
        }
        let velocity_mm_s = libm::copysign(self.settings.speed_mm_s, to_mm - from_mm);
        Ask::Scan { crossing: self.scan, from, axis: Axis::X, to_mm, velocity_mm_s }
    }

    fn tact(&mut self, tact: Tact) -> Result<(), SearchError> {
        if !self.is_scanning || self.scan >= 2 * ROWS {
            return Ok(());
        }
        if tact.hits > 0 {
            (self.dark, self.light) = (Some(tact), None);
            return Ok(());
        }
        let light = *self.light.get_or_insert(tact);
        match self.dark {
            None => {
                let [reach_mm, _] = self.ends_mm();
                self.fail(PaperError::Beyond {
                    side: self.side(),
                    y_mm: self.row_mm(self.scan / 2),
                    reach_mm,
                });
            }
            Some(dark) if libm::fabs(tact.position_mm - light.position_mm) >= self.settings.least_mm => {
                self.next(self.edge_mm(dark, light));
            }
            Some(_) => {}
        }
        Ok(())
    }

    fn arrived(&mut self) -> Result<(), SearchError> {
        if self.scan < 2 * ROWS {
            if self.is_scanning {
                self.fail(PaperError::NoPaper { y_mm: self.row_mm(self.scan / 2) });
            }
            self.is_scanning = true;
        }
        Ok(())
    }
}

/// The slope of an edge, x over y: the median of those between all pairs, which two places of five do not
/// spoil.
///
/// Source: P. K. Sen, "Estimates of the regression coefficient based on Kendall's tau" (1968).
fn straight(rows_mm: &[f64; ROWS], edge_mm: &[f64; ROWS]) -> f64 {
    let mut slopes = [0.0; ROWS * (ROWS - 1) / 2];
    let pairs = (0..ROWS).flat_map(|a| (0..a).map(move |b| (a, b)));
    for (slot, (a, b)) in slopes.iter_mut().zip(pairs) {
        *slot = (edge_mm[a] - edge_mm[b]) / (rows_mm[a] - rows_mm[b]);
    }
    slopes.sort_unstable_by(f64::total_cmp);
    0.5 * (slopes[slopes.len() / 2 - 1] + slopes[slopes.len() / 2])
}

/// How far each place of an edge is from the line of that slope through most of them.
fn off(rows_mm: &[f64; ROWS], edge_mm: &[f64; ROWS], slope: f64) -> [f64; ROWS] {
    let across_mm: [f64; ROWS] = core::array::from_fn(|row| edge_mm[row] - slope * rows_mm[row]);
    let mut sorted = across_mm;
    sorted.sort_unstable_by(f64::total_cmp);
    across_mm.map(|mm| mm - sorted[ROWS / 2])
}
