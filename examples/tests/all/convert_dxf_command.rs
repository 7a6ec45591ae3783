//! `convert` with drawings of CAD programs.

use crate::built_example::{Folder, complaint, run_example};
use std::fmt::Write as _;

/// A drawing in millimetres: two layers and a text.
fn drawing(x: f64) -> String {
    let mut text =
        String::from("  0\r\nSECTION\r\n  2\r\nHEADER\r\n  9\r\n$INSUNITS\r\n 70\r\n4\r\n  0\r\nENDSEC\r\n");
    text.push_str("  0\r\nSECTION\r\n  2\r\nENTITIES\r\n");
    let entity = |text: &mut String, kind: &str, layer: &str, groups: &[(i32, f64)]| {
        let _ = write!(text, "  0\r\n{kind}\r\n  8\r\n{layer}\r\n");
        for (code, value) in groups {
            let _ = write!(text, "{code:3}\r\n{value}\r\n");
        }
    };
    entity(&mut text, "LINE", "cut", &[(10, x), (20, 0.0), (11, x + 30.0), (21, 0.0)]);
    entity(&mut text, "CIRCLE", "mark", &[(10, x + 15.0), (20, 20.0), (40, 5.0)]);
    text.push_str("  0\r\nENDSEC\r\n  0\r\nEOF\r\n");
    text
}

fn converted(text: &str, to: &str, options: &[&str]) -> (String, String) {
    let folder = Folder::new();
    let (from, to) = (folder.write("a.dxf", text), folder.file(to));
    let output = run_example("convert", &[&[from.as_str(), &to][..], options].concat());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    (std::fs::read_to_string(to).unwrap(), said)
}

#[test]
fn layers_become_pens_and_circles_stay_arcs() {
    let (hpgl, said) = converted(&drawing(0.0), "b.plt", &[]);
    assert!(hpgl.contains("SP1;\nPU0,0;\nPD1200,0;"), "{hpgl}");
    assert!(hpgl.contains("SP2;\nPU800,800;\nPD;\nAA600,800,90;"), "{hpgl}");
    assert_eq!(said, "");
}

#[test]
fn what_lies_left_of_the_origin_is_moved_and_that_is_said() {
    let (hpgl, said) = converted(&drawing(-100.0), "b.plt", &[]);
    assert!(hpgl.contains("SP1;\nPU0,0;\nPD1200,0;"), "{hpgl}");
    assert!(said.contains("the drawing begins at -100.000, 0.000 mm: it is moved"), "{said}");
    let (far, said) = converted(&drawing(1e6), "b.plt", &[]);
    assert!(far.contains("SP1;\nPU0,0;\nPD1200,0;") && said.contains("is moved"), "{far} {said}");
}

#[test]
fn the_unit_can_be_said() {
    let (hpgl, said) = converted(&drawing(0.0), "b.plt", &["--step-mm", "25.4"]);
    assert!(hpgl.contains("PU0,0;\nPD30480,0;"), "{hpgl}");
    assert_eq!(said, "");
    let without = drawing(0.0).replace("$INSUNITS", "$LUNITS");
    let (hpgl, said) = converted(&without, "b.plt", &[]);
    assert!(hpgl.contains("PD1200,0;") && said.contains("does not say what its unit is"), "{hpgl} {said}");
}

#[test]
fn a_drawing_of_many_metres_is_asked_for_its_unit() {
    // 30 units wide and 25 high: what many programs write for metres, without being asked.
    let metres = drawing(0.0).replace("\r\n 70\r\n4\r\n", "\r\n 70\r\n6\r\n");
    let doubt = "the drawing is 30.0 x 25.0 m, since it says that its unit is 1000 mm: give --step-mm 1 if its numbers are \
                 millimetres (30.0 x 25.0 mm), else make it smaller by --fit A4 or --scale";
    let (gcode, said) = converted(&metres, "b.gcode", &[]);
    assert!(gcode.contains("G1 X30000 Y0") && said.contains(doubt), "{gcode} {said}");
    for (options, end) in [
        (&["--step-mm", "1"][..], "G1 X30 Y0"),
        (&["--scale", "0.001"], "G1 X30 Y0"),
        (&["--fit", "60x60"], "G1 X60 Y"),
    ] {
        let (gcode, said) = converted(&metres, "b.gcode", options);
        assert!(gcode.contains(end) && said.is_empty(), "{options:?}: {gcode} {said}");
    }
    // No machine is as large as this, whatever the unit.
    let folder = Folder::new();
    let input = folder.write("a.dxf", metres.replace("\r\n30\r\n", "\r\n300\r\n"));
    let said = complaint("convert", &[&input, &folder.file("b.gcode")]);
    assert!(said.contains("the drawing is 300.0 x 25.0 m, since"), "{said}");
    assert!(!std::path::Path::new(&folder.file("b.gcode")).exists());
    let (gcode, said) =
        converted(&metres.replace("\r\n30\r\n", "\r\n300\r\n"), "b.gcode", &["--step-mm", "1"]);
    assert!(gcode.contains("G1 X300 Y0") && said.is_empty(), "{gcode} {said}");
}

#[test]
fn other_formats_of_cad_programs_are_refused_by_name() {
    let folder = Folder::new();
    let output = folder.file("b.plt");
    for (bytes, name) in [("AutoCAD Binary DXF\r\n\u{1a}\0", "binary DXF"), ("AC1032\0\0", "DWG")] {
        let input = folder.write("a.dxf", bytes);
        let said = complaint("convert", &[&input, &output]);
        assert!(said.contains(name) && said.contains("save it as ASCII DXF"), "{said}");
    }
    let input = folder
        .write("a.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0H9' stroke='#000'/></svg>");
    let said = run_example("convert", &[&input, &folder.file("b.dxf")]);
    assert_eq!(said.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&said.stderr).contains("dxf is read, not written"));
}
