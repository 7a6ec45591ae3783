//! `RO` together with whatever says what coordinates mean: `IP`, `IR`, all kinds of `SC`, `IW`, `PS`, each of
//! them before the turn and after it, by every angle, on a sheet whose size is known and on one whose size is
//! not.
//!
//! The places are those of a small model of its own, in which a place is a complex number and a quarter of a
//! turn a factor of i. Where hp2xx is at hand, its lines are compared too.
//!
//! Source of the rules: *PCL 5 Printer Language Technical Reference Manual*, part II, chapter 19. P1, P2 and
//! the window keep their numbers when the axes turn, and so turn with them; `IP` without numbers, `IR` and
//! the sheet go by the axes as they are now.

#[cfg(feature = "font")]
use crate::hpgl_against_hp2xx::{TOLERANCE_UNITS, compared, folder, has_hp2xx, prepared};
use crate::shown;
use shown::ops;

/// A place in plotter units, or a way.
type Place = (f64, f64);

fn sum(a: Place, b: Place) -> Place {
    (a.0 + b.0, a.1 + b.1)
}

fn product(a: Place, b: Place) -> Place {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// What lies where when the axes are turned by so many quarters.
struct Model {
    quarters: usize,
    /// The size of the sheet as it lies, if the text says it.
    sheet: Option<Place>,
    p1: Place,
    p2: Place,
}

/// P1 and P2 of a 7475A with A4 as the turned axes count them, for each quarter: worked by hand from (603,
/// 521), (10603, 7721) and the sheet of 11040 by 7721. At 90 degrees x' is y, and y' is 11040 - x.
const USUAL: [[Place; 2]; 4] = [
    [(603.0, 521.0), (10_603.0, 7_721.0)],
    [(521.0, 437.0), (7_721.0, 10_437.0)],
    [(437.0, 0.0), (10_437.0, 7_200.0)],
    [(0.0, 603.0), (7_200.0, 10_603.0)],
];

impl Model {
    fn new(sheet: Option<Place>) -> Self {
        let [p1, p2] = sheet.map_or(USUAL[0], |sheet| [(0.0, 0.0), sheet]);
        Self { quarters: 0, sheet, p1, p2 }
    }

    /// The sheet's size along the turned axes.
    fn frame(&self) -> Place {
        let (x, y) = self.sheet.unwrap_or((11_040.0, 7_721.0));
        if self.quarters.is_multiple_of(2) { (x, y) } else { (y, x) }
    }

    /// Does what a short text says, of the texts that are in the table.
    fn take(&mut self, text: &str) {
        let (letters, numbers) = text.trim_end_matches(';').split_at(2);
        let numbers: Vec<f64> = numbers.split(',').filter_map(|number| number.parse().ok()).collect();
        let of_frame = |share: Place| (self.frame().0 * share.0 / 100.0, self.frame().1 * share.1 / 100.0);
        let way = sum(self.p2, (-self.p1.0, -self.p1.1));
        (self.p1, self.p2) = match (letters, &numbers[..]) {
            ("RO", [angle]) => {
                self.quarters =
                    [0.0, 90.0, 180.0, 270.0].iter().position(|quarter| quarter == angle).unwrap();
                return;
            }
            ("IP" | "IR", []) => match self.sheet {
                Some(_) => ((0.0, 0.0), self.frame()),
                None => (USUAL[self.quarters][0], USUAL[self.quarters][1]),
            },
            ("IP", [x, y]) => ((*x, *y), sum((*x, *y), way)),
            ("IP", [x1, y1, x2, y2]) => ((*x1, *y1), (*x2, *y2)),
            ("IR", [x, y]) => (of_frame((*x, *y)), sum(of_frame((*x, *y)), way)),
            ("IR", [x1, y1, x2, y2]) => (of_frame((*x1, *y1)), of_frame((*x2, *y2))),
            ("PS", [length, width]) => {
                self.sheet = Some((*length, *width));
                ((0.0, 0.0), self.frame())
            }
            ("SC" | "IW", _) => return,
            other => panic!("{other:?}"),
        };
    }

    /// Where on the sheet what the turned axes count as `units` lies.
    fn place(&self, units: Place) -> Place {
        let (x, y) = self.sheet.unwrap_or_default();
        let corner = [(0.0, 0.0), (x, 0.0), (x, y), (0.0, y)][self.quarters];
        (0..self.quarters).fold(units, |way, _| product((0.0, 1.0), way)).pipe(|way| sum(corner, way))
    }

    /// Plotter units of what the user counts as `user`, by a scale of this text.
    fn units(&self, scale: &str, user: Place) -> Place {
        let numbers: Vec<f64> =
            scale[2..].trim_end_matches(';').split(',').map(|n| n.parse().unwrap()).collect();
        let frame = sum(self.p2, (-self.p1.0, -self.p1.1));
        match numbers[..] {
            [x, x_factor, y, y_factor, 2.0] => {
                sum(self.p1, ((user.0 - x) * x_factor, (user.1 - y) * y_factor))
            }
            [x1, x2, y1, y2] => {
                sum(self.p1, ((user.0 - x1) / (x2 - x1) * frame.0, (user.1 - y1) / (y2 - y1) * frame.1))
            }
            [x1, x2, y1, y2, 1.0, ref room @ ..] => {
                let share = |index| room.get(index).copied().unwrap_or(50.0) / 100.0;
                let (width, height) = ((x2 - x1).abs(), (y2 - y1).abs());
                let unit = (frame.0.abs() / width).min(frame.1.abs() / height);
                // Of the room that is left over, so much lies before the area on either axis, from P1 towards
                // P2.
                let along = |frame: f64, width: f64, share: f64, from: f64| {
                    frame.signum() * ((frame.abs() - unit * width) * share + unit * from)
                };
                sum(
                    self.p1,
                    (
                        along(frame.0, width, share(0), user.0 - x1),
                        along(frame.1, height, share(1), user.1 - y1),
                    ),
                )
            }
            _ => panic!("{scale}"),
        }
    }
}

/// A value into a function.
trait Pipe: Sized {
    fn pipe<T>(self, function: impl FnOnce(Self) -> T) -> T {
        function(self)
    }
}
impl Pipe for Place {}

fn shown_place((x, y): Place) -> String {
    let rounded = |value: f64| (value * 1e3).round() / 1e3 + 0.0;
    format!("{},{}", rounded(x), rounded(y))
}

/// What is said of coordinates, and a scale that it is looked at through.
const SAID: [(&str, &str); 14] = [
    ("IP1000,200,3000,1800;", "SC0,10,0,20;"),
    ("IP3000,200,1000,1800;", "SC0,10,0,20;"), // mirrored
    ("IP0,0,1016,-1016;", "SC0,300,0,300;"),
    ("IP500,300;", "SC0,10,0,20;"),
    ("IP;", "SC0,10,0,20;"),
    ("IR10,20,60,70;", "SC0,10,0,20;"),
    ("IR0,0,100,100;", "SC0,1,0,1;"),
    ("IR0,100;", "SC0,10,0,20;"),
    ("IR;", "SC0,10,0,20;"),
    ("IP1000,200,3000,1800;", "SC0,10,0,20,1;"),
    ("IR10,20,60,70;", "SC0,10,0,20,1,0,100;"),
    ("IP1000,200,3000,1800;", "SC2,20,3,30,2;"),
    ("PS6000,3000;", "SC0,10,0,20;"),
    ("PS3000,6000;", "SC0,10,0,20,1,100,0;"),
];
const ANGLES: [&str; 4] = ["RO0;", "RO90;", "RO180;", "RO270;"];
const SHEETS: [Option<(&str, Place)>; 2] = [None, Some(("PS8000,4000;", (8_000.0, 4_000.0)))];

/// All rows: what is said, in which order, and the scale before or after all of it. The scale goes by P1 and
/// P2 as they are when it is used.
fn rows() -> impl Iterator<Item = (String, String)> {
    SHEETS.into_iter().flat_map(|sheet| {
        SAID.into_iter().flat_map(move |(said, scale)| {
            ANGLES.into_iter().flat_map(move |angle| {
                [[angle, said, scale], [said, angle, scale], [scale, angle, said], [said, scale, angle]].map(
                    move |texts| {
                        let mut model = Model::new(sheet.map(|(_, size)| size));
                        texts.iter().for_each(|text| model.take(text));
                        let begin = sheet.map_or("", |(text, _)| text);
                        let text = format!("{begin}{}PU0,0;PD10,0;PD10,20;", texts.concat());
                        let place = |user| shown_place(model.place(model.units(scale, user)));
                        let expected = format!(
                            "U{} D{} D{}",
                            place((0.0, 0.0)),
                            place((10.0, 0.0)),
                            place((10.0, 20.0))
                        );
                        (text, expected)
                    },
                )
            })
        })
    })
}

#[test]
fn the_frame_turns_with_the_paper_whatever_comes_first() {
    let wrong: Vec<String> = rows()
        .filter_map(|(text, expected)| {
            let got = ops(&text);
            (got != expected).then(|| format!("{text}: {got}, not {expected}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), rows().count(), wrong.join("\n"));
}

#[test]
fn a_window_turns_with_the_axes_whatever_comes_first() {
    let cross = "PU0,1000;PD9000,1000;PU2000,0;PD2000,9000;";
    for sheet in SHEETS {
        for angle in ANGLES {
            let begin = sheet.map_or("", |(text, _)| text);
            for texts in [[angle, "IW1000,500,3000,1500;"], ["IW3000,1500,1000,500;", angle]] {
                let mut model = Model::new(sheet.map(|(_, size)| size));
                texts.iter().for_each(|text| model.take(text));
                let place = |units| shown_place(model.place(units));
                let text = format!("{begin}{}{cross}", texts.concat());
                // Both lines are cut where the window ends.
                let expected = format!(
                    "U{} D{} U{} D{}",
                    place((1_000.0, 1_000.0)),
                    place((3_000.0, 1_000.0)),
                    place((2_000.0, 500.0)),
                    place((2_000.0, 1_500.0))
                );
                let got: Vec<String> = ops(&text).split(' ').map(str::to_owned).collect();
                // The ends of the lines that lie outside are travelled to with the pen up, or not at all.
                let drawn = got.iter().position(|op| op.starts_with('D')).unwrap();
                assert_eq!(got[drawn - 1..].join(" "), expected, "{text}");
            }
        }
    }
    // In user units, and off again.
    assert_eq!(
        ops("PS8000,4000;IP0,0,1000,1000;SC0,10,0,10;IW0,0,5,5;RO90;SC;PU0,100;PD1000,100;IW;PD2000,100"),
        "U7900,0 D7900,500 U7900,1000 D7900,2000"
    );
}

#[test]
fn a_picture_frame_that_is_the_whole_turned_sheet_has_the_border_of_the_sheet() {
    // As AutoCAD lays its plots: the turned frame's upper left corner is P1, and y counts down from it.
    assert_eq!(
        ops("PS10496,7977;RO90;IP0,0,1016,-1016;IR0,100;SC0,300,0,300;PU0,0;PD300,0;PD300,600"),
        "U0,0 D0,1016 D2032,1016"
    );
    assert_eq!(
        ops("IN;PS8000,4000;RO90;IR0,0,100,100;SC0,1,0,1;PU0,0;PD1,0,1,1,0,1,0,0;PU;"),
        "U8000,0 D8000,4000 D0,4000 D0,0 D8000,0 U8000,0"
    );
}

/// What hp2xx 3.4.4 does otherwise, and why it is not followed.
#[cfg(feature = "font")]
fn hp2xx_differs(text: &str) -> Option<&'static str> {
    let place = |letters: &str| text.rfind(letters);
    if text.contains("PS") {
        return Some("it moves the origin to no corner: HP-GL/2 turns and shifts the axes (RO)");
    }
    if text.contains("IR") {
        return Some(
            "it counts IR from the P1 and P2 that were: percent are of the frame, along the turned axes (IR)",
        );
    }
    if text.contains("IP;") {
        return Some("it takes the sheet for one of A0, as it lies: P1 and P2 go by the turned axes (IP)");
    }
    if place("IP") > place("SC") {
        return Some("its IP ends SC: P1 and P2 keep the user's coordinates wherever they are moved to (SC)");
    }
    None
}

/// hp2xx turns about the origin, as is done here while the size of the sheet is not known.
#[cfg(feature = "font")]
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn turned_frames_are_where_hp2xx_draws_them() -> std::io::Result<()> {
    let mut wrong = Vec::new();
    if !has_hp2xx() {
        return Ok(());
    }
    for (text, _) in rows().filter(|(text, _)| hp2xx_differs(text).is_none()) {
        let text = prepared(format!("IN;{text}").as_bytes(), &[]);
        let name = String::from_utf8_lossy(&text).into_owned();
        wrong.extend(compared(&name, &text, &folder("turned"), TOLERANCE_UNITS)?.err());
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let compared = rows().filter(|(text, _)| hp2xx_differs(text).is_none()).count();
    assert!(compared >= 60, "{compared}");
    Ok(())
}
