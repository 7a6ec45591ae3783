//! Polygons: how they are put into the buffer, edged and filled.

use crate::shown;

use plotter_motion::PlotOp;
use plotter_motion::hpgl::{Interpreter, PlotOps, ReadOptions};
use shown::ops;

#[test]
fn a_polygon_is_drawn_when_it_is_edged_and_as_often() {
    assert_eq!(ops("PU10,10;PM0;PD20,10,20,20;PM2;"), "U10,10");
    assert_eq!(ops("PU10,10;PM0;PD20,10,20,20;PM2;EP;"), "U10,10 D20,10 D20,20 D10,10");
    assert_eq!(ops("PU10,10;PM0;PD20,10;PU;PM2;EP;EP"), "U10,10 D20,10 U10,10 D20,10");
}

#[test]
fn sides_with_the_pen_up_are_not_drawn() {
    assert_eq!(ops("PM0;PD10,0;PU10,10;PD0,10;PU;PM2;EP"), "D10,0 U10,10 D0,10");
    // A part begins with the first place after PM1, whatever the pen does.
    assert_eq!(ops("PM0;PD9,0,9,9;PM1;PD2,1,3,1,3,3;PM2;EP"), "D9,0 D9,9 D0,0 U2,1 D3,1 D3,3 D2,1");
}

#[test]
fn the_pen_goes_on_from_the_last_place_of_a_polygon() {
    assert_eq!(ops("PM0;PD10,0,10,10;PM2;PR;PU5,5"), "U15,15");
}

#[test]
fn circles_and_arcs_are_sides() {
    assert_eq!(
        ops("PU100,0;PM0;PD;AA0,0,180;PM1;PU0,20;CI10;PM2;EP"),
        "U100,0 A-100,0(0,0)180 D100,0 U10,20 A10,20(0,20)360"
    );
    assert_eq!(ops("PM0;PU50,50;CI10,90;PM2;EP"), "U60,50 D50,60 D40,50 D50,40 D60,50");
}

#[test]
fn rectangles_and_wedges_stay_in_the_buffer() {
    let square = "D20,0 D20,10 D0,10 D0,0";
    assert_eq!(ops("EA20,10;"), square);
    assert_eq!(ops("PU5,5;ER20,10;PD6,6"), "U5,5 D25,5 D25,15 D5,15 D5,5 D6,6");
    assert_eq!(ops("FT3,100;RA20,10;EP"), format!("D20,0 U0,0 {square}"));
    assert_eq!(ops("EW100,0,90"), "D100,0 A0,100(0,0)90 D0,0");
    assert_eq!(ops("EW-100,0,-90"), "D-100,0 A0,100(0,0)-90 D0,0");
    assert_eq!(ops("EW100,0,60,30"), "D100,0 D86.603,50 D50,86.603 D0,0");
    assert_eq!(ops("EW100,0,360"), "U100,0 A100,0(0,0)360");
}

#[test]
fn a_solid_fill_is_lines_a_pens_width_apart_back_and_forth() {
    // 0.25 mm are 10 units; lines lie at multiples of them from the origin.
    assert_eq!(ops("PW0.25;PU3,5;RA33,25"), "U3,5 U3,10 D33,10 U33,20 D3,20");
    assert_eq!(
        ops("FT2;PT0.25;SP1;PT0.5;PU3,5;RA33,45").replace("S1 ", ""),
        "U3,5 U3,20 D33,20 U3,40 D33,40"
    );
}

#[test]
fn hatching_has_a_distance_an_angle_and_an_anchor() {
    assert_eq!(ops("FT3,10;PU3,5;RR30,20"), "U3,5 U3,10 D33,10 U33,20 D3,20");
    assert_eq!(ops("FT3,10;AC0,7;PU3,5;RR30,20"), "U3,5 U3,7 D33,7 U33,17 D3,17");
    assert_eq!(ops("FT3,10,90;PU5,0;RR20,30"), "U5,0 U20,0 D20,30 U10,30 D10,0");
    assert_eq!(ops("FT4,20;PU5,5;RR20,20"), "U5,5 U5,20 D25,20 U20,5 D20,25");
    // In the text's own units along x: 10 are 100 units. And 1 % of P1 to P2 where none is said: 50 units.
    assert_eq!(ops("IP0,0,1000,1000;SC0,100,0,100;FT3,10;PU0,5;RR10,10"), "U0,50 U0,100 D100,100");
    assert_eq!(ops("IP0,0,4000,3000;FT3;PU0,5;RA10,95"), "U0,5 U0,50 D10,50");
    // A line type applies to lines that are not solid.
    assert_eq!(ops("IP0,0,4000,3000;LT2;FT3,100;PU0,50;RA200,150"), "U0,50 U0,100 D100,100");
}

#[test]
fn shading_is_lines_as_far_apart_as_it_is_light() {
    // A pen of 10 units covers a quarter of the sheet at a distance of 40.
    assert_eq!(ops("PW0.25;FT10,25;PU0,5;RA10,100"), "U0,5 U0,40 D10,40 U10,80 D0,80");
    assert_eq!(ops("FT10,0;RA10,100"), "");
    // A fill of one's own: the mean of its distances
    assert_eq!(ops("UF10,30;FT6;PU0,5;RA10,50"), "U0,5 U0,20 D10,20 U10,40 D0,40");
}

#[test]
fn holes_are_left_out_or_filled_as_the_fill_says() {
    let hole = "FT3,20;PU0,5;PM0;PD60,5,60,35,0,35,0,5;PM1;PU20,15;PD40,15,40,25,20,25;PM2;";
    assert_eq!(ops(&format!("{hole}FP")), "U0,5 U0,20 D20,20 U40,20 D60,20");
    assert_eq!(ops(&format!("{hole}FP1")), "U0,5 U0,20 D60,20");
}

#[test]
fn what_has_no_place_in_a_polygon_is_said() {
    assert_eq!(
        ops("PM0;PD5,5;EA9,9;LBa\u{3}PM2;EP;FP2;PM3"),
        "<line 1, column 11 (byte 10): EA has no place in a polygon and is left out: end the polygon with PM2 first> \
         <line 1, column 17 (byte 16): LB has no place in a polygon and is left out: end the polygon with PM2 first> \
         D5,5 D0,0 \
         <line 1, column 30 (byte 29): FP with 2 is left out: it takes 0 to fill what an odd number of sides surrounds or \
         1 for all> \
         <line 1, column 34 (byte 33): PM with 3 is left out: it takes 0 to begin a polygon, 1 to close a part of it, 2 to \
         end it>"
    );
}

#[test]
fn a_polygon_that_is_too_long_loses_no_line() {
    let text = "PU0,0;PM0;PD1,0,2,0,3,0,4,0,5,0,6,0,7,0,8,0,9,0,9,9;PM2;EP;FP;PD0,0";
    let small = Interpreter::<8>::with_options(ReadOptions::default());
    let (mut drawn, mut said) = (Vec::new(), Vec::new());
    for outcome in PlotOps::with_interpreter(text.bytes(), small) {
        match outcome {
            Ok(PlotOp::Draw { to, .. }) => drawn.push((to.x * 40.0, to.y * 40.0)),
            Ok(_) => {}
            Err(error) => said.push(error.to_string()),
        }
    }
    // The start and seven sides fit; the others come first, then with EP those in the buffer.
    let late = [(8.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 0.0)];
    let edged = (1..=7).map(|x| (f64::from(x), 0.0));
    let expected: Vec<_> = late.into_iter().chain(edged).chain([(0.0, 0.0)]).collect();
    assert_eq!(drawn, expected);
    insta::assert_snapshot!(said.join("\n"), @r"
    line 1, column 11 (byte 10): PD adds to a polygon that is longer than the 8 places there are for it: what follows is drawn at once, and the polygon cannot be filled
    line 1, column 60 (byte 59): FP fills no polygon that did not fit: divide it into smaller ones
    ");
}

#[test]
fn a_fill_that_is_too_fine_is_said() {
    assert_eq!(
        ops("PW0.01;PU0,0;RA9000,9000"),
        "U0,0 <line 1, column 14 (byte 13): RA would fill with more than 16384 lines, 0.010000 mm apart, and is left out: \
         set a wider pen (PW) or distance (FT)>"
    );
}

#[test]
fn a_raster_is_shaded_as_much_as_it_inks() {
    // One dot of four has ink: as a shading of 25 %. Without dots it is forgotten, and what nobody has
    // defined is solid.
    let pen = "PW0.25;PU0,0;";
    let shaded = ops(&format!("{pen}FT10,25;RA80,80;"));
    assert_eq!(ops(&format!("{pen}RF2,2,2,1,0,0,0;FT11,2;RA80,80;")), shaded);
    let solid = ops(&format!("{pen}FT1;RA80,80;"));
    assert_eq!(ops(&format!("{pen}FT11,2;RA80,80;")), solid);
    assert_eq!(ops(&format!("{pen}RF2,2,2,1,0,0,0;RF2;FT11,2;RA80,80;")), solid);
    assert_eq!(ops(&format!("{pen}RF2,2,2,1,0,0,0;RF;FT11,2;RA80,80;")), solid);
    assert_eq!(ops(&format!("{pen}RF1,1,1,0;FT11,1;RA80,80;")), ops(&format!("{pen}FT10,0;RA80,80;")));
    assert!(ops("RF9,1,1,0").contains("it takes a raster from 1 to 8"));
    assert!(ops("RF1,8,8").contains("RF lacks a pen for each dot of the raster"));
}

#[test]
fn a_printers_lines_lie_stand_slant_and_cross() {
    let frame = "IP0,0,3000,4000;PU0,0;";
    for (number, lines) in
        [(1, "FT3,0,0"), (2, "FT3,0,90"), (3, "FT3,0,45"), (4, "FT3,0,135"), (5, "FT4,0,0"), (6, "FT4,0,45")]
    {
        let printer = ops(&format!("{frame}FT21,{number};RA400,400;"));
        assert_eq!(printer, ops(&format!("{frame}{lines};RA400,400;")), "{number}");
        assert!(printer.contains('D'));
    }
    assert!(ops("FT22").contains("FT with 22 is left out"));
}
