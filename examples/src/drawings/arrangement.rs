//! [`Arrangement`]: options of the command line that change a drawing between reading and writing it.

use crate::drawings::drawing_file::{Diagnostic, Ops, Severity};
use clap::ValueEnum;
use plotter_motion::Point;
use plotter_motion::drawing::{Bounds, Drawing, DrawingBuilder, HatchTogether, Hatching, Hides, Placement};
use plotter_vector::{Order, order::OrderEffort};
use std::rc::Rc;
use std::str::FromStr;

/// Options that change a drawing. Without any of them its operations stream through.
///
/// They are applied in this order: begin at a line or layer; mirror, turn, scale, place on the page; hatch;
/// hide; crop; remove doubles; fit arcs; simplify; order.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Changes to the drawing")]
pub struct Arrangement {
    /// Scales it by a factor, about the origin
    #[arg(long, value_name = "F", value_parser = factor, allow_negative_numbers = true, conflicts_with = "fit")]
    pub scale: Option<f64>,
    /// Scales it to fit a page and centres it there: A4, letter, 210x297 (mm)
    #[arg(long, value_name = "PAGE")]
    pub fit: Option<Page>,
    /// Centres it on a page: its own, or as --center=A4
    #[arg(long, value_name = "PAGE", num_args = 0..=1, require_equals = true, default_missing_value = "own", conflicts_with = "fit")]
    pub center: Option<Page>,
    /// Margin along each side of the page, mm
    #[arg(long, value_name = "MM", value_parser = not_negative, allow_negative_numbers = true)]
    pub margin: Option<f64>,
    /// Takes the page in landscape format
    #[arg(long)]
    pub landscape: bool,
    /// Rotates it about its middle, counter-clockwise, degrees
    #[arg(long, value_name = "DEG", value_parser = number, allow_negative_numbers = true)]
    pub rotate: Option<f64>,
    /// Mirrors it: left becomes right (x), or top becomes bottom (y)
    #[arg(long, value_enum, value_name = "AXIS")]
    pub mirror: Option<Mirror>,
    /// Keeps the inside of a rectangle: x and y of its lower left corner, width and height, mm; or of a
    /// polygon: x and y of three corners or more, as 10,10,60,10,35,60. A polygon that crosses itself has its
    /// inside by the even-odd rule
    #[arg(long, value_name = "X,Y,W,H|X,Y,X,Y,X,Y,...", allow_negative_numbers = true)]
    pub crop: Option<Crop>,
    /// Removes lines, and parts of lines, that one pen draws twice
    #[arg(long)]
    pub drop_doubles: bool,
    /// Makes arcs of lines that lie on a circle within this tolerance, mm: --arcs, or --arcs=0.05 [default:
    /// 0.01]
    #[arg(long, value_name = "MM", value_parser = factor, allow_negative_numbers = true, num_args = 0..=1, require_equals = true, default_missing_value = "0.01")]
    pub arcs: Option<f64>,
    /// Removes vertices that lie within this distance of the simplified line, mm
    #[arg(long, value_name = "MM", value_parser = factor, allow_negative_numbers = true)]
    pub simplify_mm: Option<f64>,
    /// Hatches closed strokes with lines at this distance, mm
    #[arg(long, value_name = "MM", value_parser = factor, allow_negative_numbers = true)]
    pub hatch: Option<f64>,
    /// Direction of the hatching, degrees counter-clockwise from the x axis
    #[arg(long, value_name = "DEG", value_parser = number, allow_negative_numbers = true, default_value = "45", requires = "hatch")]
    pub hatch_angle: f64,
    /// Joins strokes whose ends are at most this far apart, mm [default with --order: 0.05]
    #[arg(long, value_name = "MM", value_parser = not_negative, allow_negative_numbers = true)]
    pub merge_mm: Option<f64>,
    /// Orders strokes for less travel, pen by pen, and joins them where they meet [default with --merge-mm:
    /// fast]
    #[arg(long, value_enum, value_name = "HOW")]
    pub order: Option<Effort>,
    /// Allows several changes of a pen where that shortens travel, instead of one for each pen
    #[arg(long, requires = "order")]
    pub across_pens: bool,
    /// Begins at a line of the file, with the pen, the speed and the power that hold there
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub from_line: Option<u32>,
    /// Begins at a layer: its name, or its number in the order of the file
    #[arg(long, value_name = "LAYER")]
    pub from_layer: Option<String>,
}

/// Axis along which a drawing is mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mirror {
    /// Left becomes right
    X,
    /// Top becomes bottom
    Y,
}

/// How thoroughly an order is searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Effort {
    /// The order of the file; with --merge-mm a joined stroke is at the place of its first piece
    None,
    /// From each end to the nearest stroke; up to 25,000 strokes, then changed while that shortens the way
    Fast,
    /// As fast, then improved for some 10 s at most
    Best,
}

/// A page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Page {
    /// The drawing's own page.
    Own,
    /// Width and height, mm.
    Size(f64, f64),
}

/// Greatest side of a page, mm.
const MOST_PAGE_MM: f64 = 1e6;

impl FromStr for Page {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.to_ascii_lowercase();
        let size = match lower.as_str() {
            "own" => return Ok(Self::Own),
            "a0" => (841.0, 1189.0),
            "a1" => (594.0, 841.0),
            "a2" => (420.0, 594.0),
            "a3" => (297.0, 420.0),
            "a4" => (210.0, 297.0),
            "a5" => (148.0, 210.0),
            "a6" => (105.0, 148.0),
            "letter" => (215.9, 279.4),
            "legal" => (215.9, 355.6),
            "tabloid" => (279.4, 431.8),
            sides => {
                let side = |text: &str| {
                    let side: f64 = text.trim().trim_end_matches("mm").parse().ok()?;
                    (side > 0.0 && side <= MOST_PAGE_MM).then_some(side)
                };
                let wrong = || {
                    "give A0 to A6, letter, legal, tabloid, or width x height in mm, as 210x297".to_owned()
                };
                let (width, height) = sides.split_once('x').ok_or_else(wrong)?;
                (side(width).ok_or_else(wrong)?, side(height).ok_or_else(wrong)?)
            }
        };
        Ok(Self::Size(size.0, size.1))
    }
}

/// The part of a drawing that is kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Crop {
    /// The inside of a rectangle.
    Rectangle(Bounds),
    /// The inside of a polygon with these corners.
    Polygon(Vec<Point>),
}

impl FromStr for Crop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const KINDS: &str = "give x and y of the lower left corner, width and height in mm, as 10,10,180,120, \
                             or x and y of three corners or more, as 10,10,60,10,35,60";
        let number = |text: &str| {
            let number: Option<f64> = text.trim().parse().ok();
            let number = number.filter(|number| number.abs() <= MOST_PAGE_MM);
            number
                .ok_or_else(|| format!("{:?} is no number of mm up to {MOST_PAGE_MM}: {KINDS}", text.trim()))
        };
        let numbers = text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?;
        if let [x, y, width, height] = numbers[..] {
            if width > 0.0 && height > 0.0 {
                return Ok(Self::Rectangle(Bounds::between(
                    Point::new(x, y),
                    Point::new(x + width, y + height),
                )));
            }
            return Err(format!("{width} x {height} mm is no rectangle: give a width and a height above 0"));
        }
        let (pairs, rest) = numbers.as_chunks::<2>();
        if !rest.is_empty() {
            let count = numbers.len();
            return Err(format!("{count} numbers are no corners, which have x and y each: {KINDS}"));
        }
        let corners: Vec<Point> = pairs.iter().map(|[x, y]| Point::new(*x, *y)).collect();
        let &[first, second, ..] = &corners[..] else { return Err(KINDS.into()) };
        if corners.iter().all(|corner| (*corner - first).cross(second - first) == 0.0) && second != first {
            return Err(format!(
                "{} corners lie on one line: give three or more round an area",
                corners.len()
            ));
        }
        Ok(Self::Polygon(corners))
    }
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.abs() <= 1e6).ok_or_else(|| String::from("give a number"))
}

fn factor(text: &str) -> Result<f64, String> {
    let factor = number(text)?;
    if (1e-6..=1e6).contains(&factor) { Ok(factor) } else { Err("give a number above 0, as 0.5 or 2".into()) }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if number >= 0.0 { Ok(number) } else { Err("give 0 or more".into()) }
}

/// Default gap across which strokes are joined, mm: a tenth of the width of a pen's line.
const MERGE_MM: f64 = 0.05;

/// Budget of `--order best`, comparisons of strokes: some 10 s, used up by 200,000 strokes and more.
const ORDER_BUDGET: u64 = 1_000_000_000;

/// Travel that lifting and lowering the pen is worth, mm: a servo takes some 0.1 s each way, in which a
/// plotter at 100 mm/s travels that far.
const LIFT_MM: f64 = 20.0;

/// Whether closed strokes hide the lines below them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hidden {
    /// They hide nothing.
    None,
    /// They hide the lines below them.
    Below,
    /// The drawing's lines are hidden and its areas hatched already.
    Hatched,
}

/// The warning that `--hatch` has filled nothing.
pub(crate) fn nothing_filled() -> Diagnostic {
    let text = "--hatch: no stroke is closed, so that nothing is filled: join their ends first (--merge-mm), and convert again";
    Diagnostic::new(Severity::Warning, text.into())
}

impl Arrangement {
    /// Settings of the hatching, if it is asked for.
    pub(crate) fn hatching(&self, tolerance_mm: f64) -> Option<Hatching> {
        let mut hatching = Hatching::default();
        hatching.distance_mm = self.hatch?;
        (hatching.angle_rad, hatching.tolerance_mm) = (self.hatch_angle.to_radians(), tolerance_mm);
        Some(hatching)
    }

    /// The hatching to apply before a drawing is mirrored, turned and scaled, which becomes `hatching` by
    /// that.
    pub(crate) fn before_placing(&self, hatching: Hatching, ops: Ops<'_>) -> Result<Hatching, String> {
        let (mut drawing, _, head) = gathered(ops);
        let before_mm = drawing.length_mm();
        self.put(&mut drawing, head.sheet_mm, &mut Vec::new())?;
        let scale = drawing.length_mm() / before_mm;
        let mut before = hatching;
        if scale.is_finite() && scale > 0.0 {
            before.distance_mm /= scale;
            before.tolerance_mm /= scale;
        }
        let unturned_rad = hatching.angle_rad - self.rotate.unwrap_or(0.0).to_radians();
        before.angle_rad = if self.mirror.is_some() { -unturned_rad } else { unturned_rad };
        Ok(before)
    }

    /// Whether the whole drawing must be read before its first stroke can be drawn.
    fn needs_all(&self) -> bool {
        let Self { scale, fit, center, rotate, mirror, crop, .. } = self;
        let Self { hatch, drop_doubles, arcs, simplify_mm, merge_mm, order, from_layer, .. } = self;
        let places =
            scale.is_some() || fit.is_some() || center.is_some() || rotate.is_some() || mirror.is_some();
        let cuts = crop.is_some() || hatch.is_some() || *drop_doubles;
        let bends = arcs.is_some() || simplify_mm.is_some();
        places || cuts || bends || merge_mm.is_some() || order.is_some() || from_layer.is_some()
    }

    /// The operations of a drawing after all changes; `hides` tells whether closed strokes hide the lines
    /// below them.
    ///
    /// # Errors
    ///
    /// A change that is not possible, with the remedy.
    pub(crate) fn apply<'a>(
        &self,
        ops: Ops<'a>,
        tolerance_mm: f64,
        hides: Hidden,
    ) -> Result<Ops<'a>, String> {
        let occludes = hides == Hidden::Below;
        let ops = match self.from_line {
            Some(line) => ops.beginning_at(line),
            None => ops,
        };
        if !self.needs_all() && !occludes {
            if self.margin.is_some() || self.landscape {
                return Err("--margin and --landscape belong to a page: give --fit or --center".into());
            }
            return Ok(ops);
        }
        let (mut drawing, mut said, head) = gathered(ops);
        if let Some(layer) = &self.from_layer {
            from_layer(&mut drawing, layer)?;
        }
        let sheet_mm = self.put(&mut drawing, head.sheet_mm, &mut said)?;
        if let Some(mut hatching) = self.hatching(tolerance_mm).filter(|_| hides != Hidden::Hatched) {
            if occludes {
                hatching.together = HatchTogether::Within;
            }
            let lines = drawing.hatch(&hatching, |_| true).map_err(|error| format!("--hatch: {error}"))?;
            if lines == 0 {
                said.push(nothing_filled());
            }
        }
        if occludes {
            drawing.occlude(Hides::All, tolerance_mm);
        }
        match &self.crop {
            Some(Crop::Rectangle(rectangle)) => {
                drawing.crop_to_rectangle(*rectangle);
            }
            Some(Crop::Polygon(corners)) => {
                drawing.crop_to_polygon(corners);
            }
            None => {}
        }
        if self.drop_doubles {
            drawing.drop_doubles(tolerance_mm);
        }
        if let Some(arcs_mm) = self.arcs {
            drawing.fit_arcs(arcs_mm);
        }
        if let Some(simplify_mm) = self.simplify_mm {
            drawing.simplify(simplify_mm);
        }
        if self.order.is_some() || self.merge_mm.is_some() {
            let effort = match self.order.unwrap_or(Effort::Fast) {
                Effort::None if self.merge_mm.is_some() => OrderEffort::Join,
                Effort::None => OrderEffort::None,
                Effort::Fast => OrderEffort::Fast,
                Effort::Best => OrderEffort::Best,
            };
            let merge_mm = self.merge_mm.unwrap_or(MERGE_MM);
            // In the order of the file pens may change at any time.
            let across_pens = self.across_pens || effort == OrderEffort::Join;
            let merge_gap_px = merge_mm * Order::PX_PER_MM;
            let lift_px = LIFT_MM * Order::PX_PER_MM;
            let order = Order::default()
                .with_effort(effort)
                .with_budget(ORDER_BUDGET)
                .with_merge_gap_px(merge_gap_px)
                .with_bridges_corners(true)
                .with_across_pens(across_pens)
                .with_lift_px(lift_px);
            drawing = order.apply_to(drawing);
        }
        let mut arranged = head.with(said, drawing.into_ops(tolerance_mm));
        arranged.sheet_mm = sheet_mm;
        Ok(arranged)
    }

    /// Mirrors, turns, scales and places a drawing on the page; returns the page's size.
    fn put(
        &self,
        drawing: &mut Drawing,
        own_mm: Option<(f64, f64)>,
        said: &mut Vec<Diagnostic>,
    ) -> Result<Option<(f64, f64)>, String> {
        let asked = match self.fit.or(self.center) {
            Some(Page::Own) => {
                Some(own_mm.ok_or("the drawing has no page of its own: give one, as --center=A4")?)
            }
            Some(Page::Size(width, height)) => Some((width, height)),
            None => None,
        };
        let turned = |(width, height): (f64, f64)| {
            if self.landscape { (width.max(height), width.min(height)) } else { (width, height) }
        };
        let page_mm = asked.map(turned);
        if page_mm.is_none() && (self.margin.is_some() || self.landscape) {
            return Err("--margin and --landscape belong to a page: give --fit or --center".into());
        }
        let placement = Placement {
            mirror_x: self.mirror == Some(Mirror::X),
            mirror_y: self.mirror == Some(Mirror::Y),
            rotate_deg: self.rotate.unwrap_or(0.0),
            scale: self.scale.unwrap_or(1.0),
            page_mm,
            fits: self.fit.is_some(),
            centres: self.center.is_some(),
            margin_mm: self.margin.unwrap_or(0.0),
        };
        placement.put(drawing).map_err(|error| error.to_string())?;
        let (bounds, Some((width, height))) = (drawing.bounds(), page_mm) else {
            // Without a page in the options, the drawing's own page is scaled with it.
            return Ok(own_mm.map(|(width, height)| (width * placement.scale, height * placement.scale)));
        };
        let margin_mm = placement.margin_mm;
        let (x, y) = bounds.size_mm();
        if x > width - 2.0 * margin_mm + 1e-6 || y > height - 2.0 * margin_mm + 1e-6 {
            let text = format!(
                "the drawing is {x:.1} x {y:.1} mm, larger than the page of {width:.1} x {height:.1} mm within its margins: --fit makes \
                 it smaller"
            );
            said.push(Diagnostic::new(Severity::Warning, text));
        }
        Ok(Some((width, height)))
    }
}

/// Removes all strokes before the first one of a layer.
fn from_layer(drawing: &mut Drawing, asked: &str) -> Result<(), String> {
    let names = &drawing.layers;
    let by_name = names.iter().position(|name| name.eq_ignore_ascii_case(asked));
    let by_number = || {
        asked.parse::<usize>().ok().and_then(|number| number.checked_sub(1)).filter(|at| *at < names.len())
    };
    let Some(layer) = by_name.or_else(by_number) else {
        let known =
            if names.is_empty() { "it has none".into() } else { format!("it has {}", names.join(", ")) };
        return Err(format!("--from-layer: the drawing has no layer {asked}: {known}"));
    };
    let number = u32::try_from(layer + 1).unwrap_or(u32::MAX);
    let left_out = drawing.begin_at_layer(number);
    left_out.map(|_| ()).ok_or_else(|| format!("--from-layer: the layer {asked} draws nothing"))
}

/// Reads all operations: the drawing, its diagnostics, and the emptied `ops` with its other facts.
fn gathered(mut ops: Ops<'_>) -> (Drawing, Vec<Diagnostic>, Ops<'_>) {
    let (mut builder, mut said) = (DrawingBuilder::default(), Vec::new());
    while let Some(item) = ops.next() {
        match item {
            Ok(op) => {
                builder.set_layer(ops.layer());
                builder.push(op);
            }
            Err(found) => said.push(found),
        }
    }
    let mut drawing = builder.finish();
    if !ops.layers.is_empty() {
        drawing.layers = Rc::unwrap_or_clone(std::mem::take(&mut ops.layers));
    }
    (drawing, said, ops)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_have_names_and_sizes() {
        assert_eq!("A4".parse(), Ok(Page::Size(210.0, 297.0)));
        assert_eq!("100x50.5mm".parse(), Ok(Page::Size(100.0, 50.5)));
        for bad in ["A9", "10", "0x5", "-1x5", "nanx5", ""] {
            assert!(bad.parse::<Page>().is_err(), "{bad}");
        }
    }

    #[test]
    fn rectangles_are_four_numbers_and_polygons_six_or_more() {
        let corner = |x: f64, y: f64| Point::new(x, y);
        let rectangle = Bounds::between(corner(-1.0, 2.0), corner(2.0, 6.5));
        assert_eq!("-1,2, 3,4.5".parse(), Ok(Crop::Rectangle(rectangle)));
        let triangle = vec![corner(10.0, 10.0), corner(60.0, 10.0), corner(35.0, -6.5)];
        assert_eq!("10,10,60,10, 35,-6.5".parse(), Ok(Crop::Polygon(triangle)));
        for (bad, expected) in [
            ("1,2", "give x and y of the lower left corner"),
            ("1,2,3", "3 numbers are no corners"),
            ("1,2,3,0", "3 x 0 mm is no rectangle"),
            ("1,2,3,4,5", "5 numbers are no corners"),
            ("1,2,3,4,5,6,7", "7 numbers are no corners"),
            ("0,0,1,1,3,3", "3 corners lie on one line"),
            ("a,1,1,1", "\"a\" is no number of mm"),
            ("1,2,nan,4", "\"nan\" is no number"),
            ("1,2,3,4,5,1e9", "\"1e9\" is no number of mm up to 1000000"),
            ("", "\"\" is no number"),
        ] {
            let error = bad.parse::<Crop>().unwrap_err();
            assert!(error.contains(expected), "{bad}: {error}");
        }
    }
}
