//! The meaning of coordinates: `IP`, `IR`, `SC`, `RO`, `PS`, and the window `IW`.

use crate::shown;

use shown::ops;

#[test]
fn without_scaling_numbers_are_plotter_units_wherever_p1_is() {
    assert_eq!(ops("IP1000,1000,5000,5000;PU10,20;"), "U10,20");
}

#[test]
fn a_scale_stretches_the_users_area_over_p1_and_p2() {
    // P1 (1000, 2000) to P2 (5000, 5000): 40 units and 15 units to one of the user's
    let set = "IP1000,2000,5000,5000;SC0,100,0,200;";
    assert_eq!(ops(&format!("{set}PU0,0,100,200,50,50")), "U1000,2000 U5000,5000 U3000,2750");
    assert_eq!(ops(&format!("{set}PA50,50;PR1,-1;")), "U3000,2750 U3040,2735");
    assert_eq!(ops(&format!("{set}PU50,50;SC;PU50,50")), "U3000,2750 U50,50");
    // Right to left: the greater number lies at P1.
    assert_eq!(ops("IP0,0,1000,1000;SC100,0,0,100;PU10,10"), "U900,100");
}

#[test]
fn without_ip_a_7475a_with_a4_is_meant() {
    assert_eq!(ops("SC0,10000,0,7200;PU0,0,10000,7200"), "U603,521 U10603,7721");
}

#[test]
fn an_undistorted_scale_leaves_room_at_both_sides_or_where_it_is_told() {
    // 10000 by 5000 units for 100 by 100: 50 units each, and 5000 units of room to the left and right
    assert_eq!(ops("IP0,0,10000,5000;SC0,100,0,100,1;PU0,0,100,100"), "U2500,0 U7500,5000");
    assert_eq!(ops("IP0,0,10000,5000;SC0,100,0,100,1,0,0;PU0,0"), "U0,0");
    assert_eq!(ops("IP0,0,5000,10000;SC0,100,0,100,1,50,100;PU0,0"), "U0,5000");
}

#[test]
fn a_scale_may_be_factors() {
    assert_eq!(ops("IP100,200;SC2,20,3,30,2;PU2,3,3,4"), "U100,200 U120,230");
}

#[test]
fn p2_follows_p1_and_comes_back_with_it() {
    assert_eq!(ops("IP0,0,100,100;IP50,60;SC0,1,0,1;PU1,1;IP;PU0,0"), "U150,160 U603,521");
    // In percent of the sheet, 11040 by 7721
    assert_eq!(ops("IR25,50,75,100;SC0,1,0,1;PU0,0,1,1"), "U2760,3860.5 U8280,7721");
}

#[test]
fn a_turn_is_about_the_origin_or_moves_it_to_a_corner_of_a_known_sheet() {
    assert_eq!(ops("RO90;PU200,100;PR10,0"), "U-100,200 U-100,210");
    assert_eq!(ops("RO180;PU200,100;RO270;PU200,100;RO;PU200,100"), "U-200,-100 U100,-200 U200,100");
    // HP-GL/2: with a sheet of 4000 by 3000 the origin is its lower right corner, and so on round.
    assert_eq!(ops("PS4000,3000;RO90;PU100,200"), "U3800,100");
    assert_eq!(ops("PS4000,3000;RO180;PU100,200"), "U3900,2800");
    assert_eq!(ops("PS4000,3000;RO270;PU100,200"), "U200,2900");
    assert_eq!(ops("RO90;IN;PU200,100"), "U200,100");
}

#[test]
fn a_sheet_moves_p1_and_p2_to_its_corners() {
    assert_eq!(ops("PS4000,2000;SC0,1,0,1;PU0,0,1,1"), "U0,0 U4000,2000");
    // The numbers of the old plotters: 4 is A4, 3 is A3.
    assert_eq!(ops("PS4;SC0,1,0,1;PU1,1;PS3;PU1,1"), "U10603,7721 U15370,10602");
}

#[test]
fn a_window_cuts_lines_and_the_pen_is_up_between() {
    let window = "IW0,0,1000,1000;";
    assert_eq!(ops(&format!("{window}PU-500,500;PD2000,500;")), "U0,500 D1000,500");
    // Out at the right and in again at the top
    assert_eq!(
        ops(&format!("{window}PU500,500;PD1500,500,500,1500,500,500")),
        "U500,500 D1000,500 U500,1000 D500,500"
    );
    assert_eq!(ops(&format!("{window}PU2000,2000;PD3000,3000;IW;PD4000,4000")), "U3000,3000 D4000,4000");
    // In user units when it is given
    assert_eq!(ops("IP0,0,1000,1000;SC0,10,0,10;IW0,0,5,5;SC;PU0,100;PD1000,100"), "U0,100 D500,100");
}

#[test]
fn a_window_cuts_arcs_exactly() {
    // The lower half of the circle about (500, 1000), from 180 to 360 degrees
    assert_eq!(
        ops("IW0,0,1000,1000;PU500,1000;CI100;"),
        "U500,1000 U600,1000 U400,1000 A600,1000(500,1000)180 U500,1000"
    );
}

#[test]
fn what_makes_no_sense_is_named() {
    insta::assert_snapshot!(
        ops("SC1,2,3;SC1,1,0,1;SC0,1,0,1,3;SC0,1,2,2;SC0,0,1,1,2;IP1;IP1,2,3;RO45;PS-5,5;IW1,2,3;PU1,1").replace("> ", ">\n"),
        @r"
    <line 1, column 1 (byte 0): SC lacks four numbers: the least and greatest x, the least and greatest y and is left out>
    <line 1, column 13 (byte 12): SC with 1 is left out: it takes an area with a width and a height>
    <line 1, column 29 (byte 28): SC with 3 is left out: it takes 0 to stretch, 1 not to, or 2 for factors as its fifth number>
    <line 1, column 39 (byte 38): SC with 2 is left out: it takes an area with a width and a height>
    <line 1, column 45 (byte 44): SC with 0 is left out: it takes a factor that is not 0>
    <line 1, column 53 (byte 52): IP lacks the x and y of P1, or of P1 and P2 and is left out>
    <line 1, column 57 (byte 56): IP lacks the y of P2 and is left out>
    <line 1, column 67 (byte 66): RO with 45 is left out: it takes 0, 90, 180 or 270 degrees>
    <line 1, column 72 (byte 71): PS with -5 is left out: it takes a length and a width above 0>
    <line 1, column 77 (byte 76): IW lacks the x and y of two opposite corners and is left out>
    U1,1
    "
    );
}
