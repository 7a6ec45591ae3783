//! Recorded scans over the marks of a joint, as JSON: how the sheet lay, or why that cannot be told.
//!
//! Two forms are read: `stitch-trace/1`, one joint with all its tacts and intensities, and `stitch-batch/1`,
//! many joints with how often a line was seen in each tact. `docs/stitch-traces.md` has both.

use crate::long_sheet::JsonPlace;
use plotter_motion::{Axis, Point};
use plotter_stitch::{
    Crossing, FindLine, FrameReadings, FrameTransform, Optics, Reading, RigidFit, Sighting,
    sense::{BothEdges, Found, Passed, PublishedRule, Tact, found_at},
};
use serde_json::{Map, Value, json};

/// Which of a trace's crossings are used, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossingSet {
    /// The three crossings of the published procedure, by the published method.
    Paper,
    /// The sixteen crossings of the strip that can still be reached, by ours.
    Strip16,
}

impl CrossingSet {
    const fn key(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Strip16 => "strip16",
        }
    }
}

/// How one sheet lay.
#[derive(Clone, Debug, PartialEq)]
pub struct JointAnswer {
    /// Its name: of the trace, or of the joint in a batch.
    pub case: String,
    /// Which joint of a batch it is, counted from 0.
    pub joint: Option<usize>,
    /// The pose, or why there is none.
    pub pose: Result<JointPose, String>,
}

/// A pose with its deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPose {
    /// Frame to machine.
    pub transform: FrameTransform,
    /// Standard deviation of the angle, rad.
    pub sigma_angle_rad: f64,
    /// Standard deviations of the shift along x and y, mm.
    pub sigma_shift_mm: [f64; 2],
    /// How many crossings agree.
    pub inliers: u32,
}

impl JointAnswer {
    /// An object with `case` and either the numbers or `refused`.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let mut object = Map::new();
        object.insert("case".into(), json!(self.case));
        if let Some(joint) = self.joint {
            object.insert("joint".into(), json!(joint));
        }
        match &self.pose {
            Ok(pose) => {
                let shift = pose.transform.shift();
                let [sigma_x, sigma_y] = pose.sigma_shift_mm;
                let numbers = [
                    ("theta", pose.transform.angle_rad()),
                    ("tx", shift.x),
                    ("ty", shift.y),
                    ("sigma_theta", pose.sigma_angle_rad),
                    ("sigma_tx", sigma_x),
                    ("sigma_ty", sigma_y),
                ];
                object.extend(numbers.map(|(key, number)| (key.into(), json!(number))));
                object.insert("inliers".into(), json!(pose.inliers));
            }
            Err(why) => {
                object.insert("refused".into(), json!(why));
            }
        }
        Value::Object(object)
    }
}

/// Reads a trace or a batch. `name` is what its joints are called that have no name.
///
/// # Errors
///
/// What is wrong with the text as a whole. What is wrong with one joint is in its answer, and the others are
/// told.
pub fn answer_traces(text: &str, name: &str, set: CrossingSet) -> Result<Vec<JointAnswer>, String> {
    let value = JsonPlace::parse(text)?;
    let root = JsonPlace::root(&value);
    let format = root.need("format")?;
    match format.text()? {
        "stitch-trace/1" => {
            let case = root.get("case")?.map_or(Ok(name), |case| case.text())?.to_owned();
            let pose = trace(&root, set);
            Ok(vec![JointAnswer { case, joint: None, pose }])
        }
        "stitch-batch/1" => batch(&root, name, set),
        other => {
            Err(format.wrong(&format!("`{other}` is unknown; stitch-trace/1 and stitch-batch/1 are read")))
        }
    }
}

/// The optical head that a file describes; what it leaves out is as published.
fn optics(root: &JsonPlace<'_>) -> Result<Optics, String> {
    let mut optics = Optics::default();
    let positive = |key: &str, usual: f64| match root.get(key)? {
        None => Ok(usual),
        Some(place) => match place.number()? {
            number if (1e-6..=1e3).contains(&number) => Ok(number),
            number => Err(place.wrong(&format!("{number} is out of 0.000001 to 1000"))),
        },
    };
    optics.tact_s = positive("tact_s", optics.tact_s)?;
    optics.disc_mm = positive("disc_mm", optics.disc_mm)?;
    optics.line_mm = positive("line_mm", optics.line_mm)?;
    optics.seen_above = positive("threshold", optics.seen_above)?;
    if let Some(place) = root.get("led_offset_s")? {
        optics.led_offset_s = match place.numbers()?[..] {
            [first, second] if first <= second && -optics.tact_s <= first && second <= optics.tact_s => {
                [first, second]
            }
            _ => return Err(place.wrong("two times within a tact are expected, the earlier one first")),
        };
    }
    if optics.span_mm() <= 0.0 {
        return Err(root.wrong(&format!(
            "a line of {} mm never covers {} of a disc of {} mm; look at line_mm, disc_mm and threshold",
            optics.line_mm, optics.seen_above, optics.disc_mm
        )));
    }
    Ok(optics)
}

/// One scan: its velocity and its tacts.
struct Scan {
    velocity_mm_s: f64,
    tacts: Vec<Tact>,
}

impl Scan {
    /// From places, hits and intensities.
    fn new(
        place: &JsonPlace<'_>,
        optics: &Optics,
        positions_mm: &[f64],
        hits: &[u8],
        covered: Option<(&[f64], &[f64])>,
    ) -> Result<Self, String> {
        let lengths = [Some(hits.len()), covered.map(|(a, _)| a.len()), covered.map(|(_, b)| b.len())];
        for (what, length) in ["hits", "adc_a", "adc_b"].into_iter().zip(lengths) {
            if length.is_some_and(|length| length != positions_mm.len()) {
                return Err(place.wrong(&format!(
                    "{what} has {} tacts, the positions are {}",
                    length.unwrap_or(0),
                    positions_mm.len()
                )));
            }
        }
        let velocity_mm_s = match positions_mm {
            [first, .., last] => (last - first) / (positions_mm.len() as f64 - 1.0) / optics.tact_s,
            _ => 0.0,
        };
        let tacts = positions_mm.iter().zip(hits).enumerate().map(|(index, (&position_mm, &hits))| Tact {
            position_mm,
            hits,
            covered: covered.and_then(|(a, b)| Some([*a.get(index)?, *b.get(index)?])),
        });
        Ok(Self { velocity_mm_s, tacts: tacts.collect() })
    }

    /// All that a detector sees in it.
    fn sightings(&self, place: &JsonPlace<'_>, mut detector: impl FindLine) -> Result<Vec<Sighting>, String> {
        let mut sightings = Vec::new();
        for (index, tact) in self.tacts.iter().enumerate() {
            let sighting =
                detector.push(*tact).map_err(|error| place.wrong(&format!("tact {index}: {error}")))?;
            sightings.extend(sighting);
        }
        sightings.extend(detector.finish());
        Ok(sightings)
    }
}

/// `012…` as a text, or the same as a list of numbers.
fn hits(place: &JsonPlace<'_>) -> Result<Vec<u8>, String> {
    let digit = |index: usize, digit: Option<u8>| {
        digit
            .filter(|digit| *digit <= 2)
            .ok_or_else(|| place.wrong(&format!("tact {index} has none of the digits 0, 1 and 2")))
    };
    match place.value() {
        Value::String(text) => {
            text.bytes().enumerate().map(|(index, byte)| digit(index, byte.checked_sub(b'0'))).collect()
        }
        Value::Array(values) => values
            .iter()
            .enumerate()
            .map(|(index, value)| digit(index, value.as_u64().and_then(|value| u8::try_from(value).ok())))
            .collect(),
        _ => Err(place.wrong("a text of digits, or a list of numbers, is expected")),
    }
}

fn axis(place: &JsonPlace<'_>) -> Result<Axis, String> {
    match place.value().as_str() {
        Some("x" | "X") => Ok(Axis::X),
        Some("y" | "Y") => Ok(Axis::Y),
        _ => Err(place.wrong("\"x\" or \"y\" is expected")),
    }
}

/// Along which axis the paper is moved: files of before there was a choice have frames along x.
fn feed_axis(root: &JsonPlace<'_>) -> Result<Axis, String> {
    root.get("feed_axis")?.map_or(Ok(Axis::X), |place| axis(&place))
}

/// A crossing of a joint and the scans over it.
struct Scanned<'a> {
    place: JsonPlace<'a>,
    crossing: Crossing,
    scans: Vec<(JsonPlace<'a>, Scan)>,
}

/// The joint of a `stitch-trace/1`.
fn trace(root: &JsonPlace<'_>, set: CrossingSet) -> Result<JointPose, String> {
    let optics = optics(root)?;
    let full_scale = match root.get("adc_full_scale")? {
        None => 1000.0,
        Some(place) => match place.number()? {
            number if number > 0.0 => number,
            _ => return Err(place.wrong("a number above 0 is expected")),
        },
    };
    let mut scanned = Vec::new();
    for place in root.need("crossings")?.list()? {
        if place.need("set")?.text()? != set.key() {
            continue;
        }
        let crossing = Crossing {
            axis: axis(&place.need("scan_axis")?)?,
            mark_mm: place.need("mark_local_mm")?.number()?,
            scan_at_mm: place.need("scan_at_machine_mm")?.number()?,
        };
        let mut scans = Vec::new();
        let fine = place.get("fine")?.map_or(Ok(Vec::new()), |fine| fine.list())?;
        for place in place.get("coarse")?.into_iter().chain(fine) {
            scans.push((place.clone(), traced_scan(&place, &optics, full_scale)?));
        }
        scanned.push(Scanned { place, crossing, scans });
    }
    if scanned.is_empty() {
        return Err(format!("the trace has no crossings of the set {}", set.key()));
    }
    tell(&scanned, &optics, feed_axis(root)?, set)
}

fn traced_scan(place: &JsonPlace<'_>, optics: &Optics, full_scale: f64) -> Result<Scan, String> {
    let positions_mm = place.need("pos_mm")?.numbers()?;
    let hits = hits(&place.need("hits")?)?;
    let adc = |key: &str| -> Result<Option<Vec<f64>>, String> {
        let Some(place) = place.get(key)? else { return Ok(None) };
        Ok(Some(place.numbers()?.iter().map(|adc| adc / full_scale).collect()))
    };
    let (a, b) = (adc("adc_a")?, adc("adc_b")?);
    let covered = a.as_deref().zip(b.as_deref());
    let scan = Scan::new(place, optics, &positions_mm, &hits, covered)?;
    if let Some(dir) = place.get("dir")?
        && dir.number()? * scan.velocity_mm_s < 0.0
    {
        return Err(dir.wrong("the positions go the other way"));
    }
    Ok(scan)
}

/// The joints of a `stitch-batch/1`.
fn batch(root: &JsonPlace<'_>, name: &str, set: CrossingSet) -> Result<Vec<JointAnswer>, String> {
    let optics = optics(root)?;
    let crossings = layout(&root.need(&format!("layout_{}", set.key()))?)?;
    let name = root.get("case")?.map_or(Ok(name), |case| case.text())?;
    let feed = feed_axis(root)?;
    let mut answers = Vec::new();
    for (index, joint) in root.need("joints")?.list()?.into_iter().enumerate() {
        let own_name = ["case", "name", "id"].into_iter().find_map(|key| joint.get(key).ok().flatten());
        let case = match own_name.as_ref().map(JsonPlace::value) {
            Some(Value::String(text)) => text.clone(),
            Some(Value::Number(number)) => number.to_string(),
            _ => format!("{name}#{index}"),
        };
        let pose = batched_joint(&joint, &crossings, &optics, feed, set);
        answers.push(JointAnswer { case, joint: Some(index), pose });
    }
    Ok(answers)
}

/// A list of crossings, each an object or a list of axis, mark and scan; or an object of three lists.
fn layout(place: &JsonPlace<'_>) -> Result<Vec<Crossing>, String> {
    if place.value().is_object() {
        let axes = first_of(place, ["axis", "scan_axis"])?.list()?;
        let marks_mm = place.need("mark_local_mm")?.numbers()?;
        let scans_mm = place.need("scan_at_machine_mm")?.numbers()?;
        if axes.len() != marks_mm.len() || axes.len() != scans_mm.len() {
            return Err(place.wrong(&format!(
                "{} axes, {} marks and {} scans; as many of each are expected",
                axes.len(),
                marks_mm.len(),
                scans_mm.len()
            )));
        }
        let numbers = marks_mm.into_iter().zip(scans_mm);
        return axes
            .iter()
            .zip(numbers)
            .map(|(place, (mark_mm, scan_at_mm))| Ok(Crossing { axis: axis(place)?, mark_mm, scan_at_mm }))
            .collect();
    }
    let crossing = |place: JsonPlace<'_>| {
        let [axis_place, mark, scan] = if place.value().is_object() {
            [
                first_of(&place, ["axis", "scan_axis"])?,
                place.need("mark_local_mm")?,
                place.need("scan_at_machine_mm")?,
            ]
        } else {
            <[JsonPlace<'_>; 3]>::try_from(place.list()?).map_err(|list| {
                place.wrong(&format!("axis, mark and scan are expected, found a list of {}", list.len()))
            })?
        };
        Ok(Crossing { axis: axis(&axis_place)?, mark_mm: mark.number()?, scan_at_mm: scan.number()? })
    };
    place.list()?.into_iter().map(crossing).collect()
}

fn first_of<'a>(place: &JsonPlace<'a>, keys: [&str; 2]) -> Result<JsonPlace<'a>, String> {
    match place.get(keys[1])? {
        Some(found) => Ok(found),
        None => place.need(keys[0]),
    }
}

fn batched_joint(
    joint: &JsonPlace<'_>,
    crossings: &[Crossing],
    optics: &Optics,
    feed: Axis,
    set: CrossingSet,
) -> Result<JointPose, String> {
    let list = joint.need(set.key())?;
    let places = list.list()?;
    if places.len() != crossings.len() {
        return Err(list.wrong(&format!("{} crossings, the layout has {}", places.len(), crossings.len())));
    }
    let mut scanned = Vec::new();
    for (place, &crossing) in places.into_iter().zip(crossings) {
        // One scan, some of them, or none.
        let scan_places = match place.value() {
            Value::Null => Vec::new(),
            Value::Array(values) if values.first().is_some_and(Value::is_number) => vec![place.clone()],
            _ => place.list()?,
        };
        let mut scans = Vec::new();
        for place in scan_places {
            if place.value().is_null() || place.value().as_array().is_some_and(Vec::is_empty) {
                continue;
            }
            scans.push((place.clone(), batched_scan(&place, optics)?));
        }
        scanned.push(Scanned { place, crossing, scans });
    }
    if scanned.is_empty() {
        return Err(format!("the joint has no crossings of the set {}", set.key()));
    }
    tell(&scanned, optics, feed, set)
}

/// `[start, signed step, hits]`.
fn batched_scan(place: &JsonPlace<'_>, optics: &Optics) -> Result<Scan, String> {
    let [start, step, hits_place] = <[JsonPlace<'_>; 3]>::try_from(place.list()?).map_err(|list| {
        place.wrong(&format!("start, step and hits are expected, found a list of {}", list.len()))
    })?;
    let (start_mm, step_mm) = (start.number()?, step.number()?);
    if step_mm == 0.0 {
        return Err(step.wrong("the head did not move; a step in mm is expected"));
    }
    let hits = hits(&hits_place)?;
    let positions_mm: Vec<f64> = (0..hits.len()).map(|tact| start_mm + step_mm * tact as f64).collect();
    let scan = Scan::new(place, optics, &positions_mm, &hits, None)?;
    Ok(Scan { velocity_mm_s: step_mm / optics.tact_s, ..scan })
}

fn tell(scanned: &[Scanned<'_>], optics: &Optics, feed: Axis, set: CrossingSet) -> Result<JointPose, String> {
    match set {
        CrossingSet::Paper => published(scanned, optics),
        CrossingSet::Strip16 => ours(scanned, optics, feed),
    }
}

/// Many crossings, by ours.
fn ours(scanned: &[Scanned<'_>], optics: &Optics, feed: Axis) -> Result<JointPose, String> {
    let crossings: Vec<Crossing> = scanned.iter().map(|scanned| scanned.crossing).collect();
    let mut found: Vec<Found> = Vec::new();
    for (index, scanned) in scanned.iter().enumerate() {
        let mut passed = Vec::new();
        for (place, scan) in &scanned.scans {
            let velocity_mm_s = scan.velocity_mm_s;
            let sightings = scan.sightings(place, BothEdges::new(optics, velocity_mm_s))?;
            passed.extend(sightings.into_iter().map(|sighting| Passed { velocity_mm_s, sighting }));
        }
        found.extend(found_at(index, optics, &passed));
    }
    let fit = RigidFit { joint: joint_of(&crossings, feed), ..RigidFit::default() };
    let estimate = fit.estimate(&crossings, &found).map_err(|error| error.to_string())?;
    let sigma_shift = estimate.sigma_shift_mm();
    Ok(JointPose {
        transform: estimate.transform,
        sigma_angle_rad: estimate.sigma_angle_rad(),
        sigma_shift_mm: [sigma_shift.x, sigma_shift.y],
        inliers: estimate.inlier_count(),
    })
}

/// The border along the first mark across the paper's way, as far as it is scanned.
fn joint_of(crossings: &[Crossing], feed: Axis) -> [Point; 2] {
    let usual = RigidFit::default().joint;
    let across = || crossings.iter().filter(|crossing| crossing.axis == feed);
    let Some(first) = across().next() else { return usual };
    let scans = across().map(|crossing| crossing.scan_at_mm);
    let (least, most) = scans.fold((f64::MAX, f64::MIN), |(least, most), at| (least.min(at), most.max(at)));
    if most - least < 1.0 {
        return usual;
    }
    [least, most].map(|at| match feed {
        Axis::X => Point::new(first.mark_mm, at),
        Axis::Y => Point::new(at, first.mark_mm),
    })
}

/// Three crossings, by the published method: shift from the border and the left Y marker, rotation from both
/// Y markers.
fn published(scanned: &[Scanned<'_>], optics: &Optics) -> Result<JointPose, String> {
    let mut tact_mm = 0.0_f64;
    let mut read = |scanned: &Scanned<'_>| {
        let (place, scan) = scanned
            .scans
            .first()
            .ok_or_else(|| scanned.place.wrong(&format!("mark {} was not scanned", scanned.crossing)))?;
        tact_mm = tact_mm.max((scan.velocity_mm_s * optics.tact_s).abs());
        let sightings = scan.sightings(place, PublishedRule::new(optics, scan.velocity_mm_s))?;
        let first = sightings
            .first()
            .ok_or_else(|| scanned.place.wrong(&format!("mark {} was not seen", scanned.crossing)))?;
        let Crossing { mark_mm, scan_at_mm, .. } = scanned.crossing;
        Ok::<_, String>(Reading { expected_mm: mark_mm, found_mm: first.at_mm, scan_at_mm })
    };
    let along = |axis: Axis| scanned.iter().filter(move |scanned| scanned.crossing.axis == axis);
    let border =
        along(Axis::X).next().ok_or("the published method needs a border that is scanned along x")?;
    let by_place =
        |a: &&Scanned<'_>, b: &&Scanned<'_>| a.crossing.scan_at_mm.total_cmp(&b.crossing.scan_at_mm);
    let (Some(left), Some(right)) = (along(Axis::Y).min_by(by_place), along(Axis::Y).max_by(by_place)) else {
        return Err("the published method needs two Y markers that are scanned along y".into());
    };
    let x_border1 = read(border)?;
    let (y_left, y_right) = (read(left)?, read(right)?);
    // The second border takes no part in the transform.
    let readings = FrameReadings { x_border1, x_border2: x_border1, y_left, y_right };
    let transform = FrameTransform::from_readings(&readings).map_err(|error| error.to_string())?;
    // Each reading is evenly spread over a tact; the transform is linear in them.
    let sigma_mm = tact_mm / 12_f64.sqrt();
    let sigma_angle_rad = sigma_mm * 2_f64.sqrt() / (y_right.scan_at_mm - y_left.scan_at_mm).abs();
    let left_share = y_left.scan_at_mm / (y_right.scan_at_mm - y_left.scan_at_mm);
    Ok(JointPose {
        transform,
        sigma_angle_rad,
        sigma_shift_mm: [
            sigma_mm.hypot(x_border1.scan_at_mm * sigma_angle_rad),
            sigma_mm * (1.0 + left_share).hypot(left_share),
        ],
        inliers: 3,
    })
}
