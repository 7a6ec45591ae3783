//! The reader of HPGL: what is one piece of text and what another, and what is said about malformed ones.

use plotter_motion::hpgl::{Event, Reader};

/// The events of a text in short: `PU 10 20.` for a command, two numbers and its end.
fn events(text: &[u8]) -> String {
    let mut reader = Reader::new();
    let mut events: Vec<_> = text.iter().filter_map(|byte| reader.push(*byte)).collect();
    events.extend(reader.finish());
    let mut shown = String::new();
    for event in events {
        let (part, last) = match event {
            Ok(Event::Command { command, .. }) => (format!(" {command}"), false),
            Ok(Event::Number { value, last, .. }) => (format!(" {value}"), last),
            Ok(Event::Byte { byte, last, .. }) => (format!(" '{}'", byte.escape_ascii()), last),
            Ok(Event::End) => (String::new(), true),
            Ok(Event::Extension { extension, .. }) => (format!(" {extension}"), true),
            Ok(Event::Escape { kind, name }) => {
                (format!(" ESC{}{}", char::from(kind), char::from(name)), false)
            }
            Ok(other) => (format!(" {other:?}"), false),
            Err(error) => (format!(" <{error}>"), false),
        };
        shown += &part;
        shown += if last { "." } else { "" };
    }
    shown.trim_start().to_string()
}

#[test]
fn separators_may_be_commas_blanks_line_ends_or_signs() {
    for text in
        ["PD1,-2,3;", "pd 1 -2 3", "P\nD1-2+3;", "PD\r\n1\r\n-2 , 3\r\n;", "Pd,1,-2.0,3.;;", "PD1,-2,3,;"]
    {
        assert_eq!(events(text.as_bytes()), "PD 1 -2 3.", "{text:?}");
    }
}

#[test]
fn the_next_mnemonic_ends_a_command() {
    assert_eq!(events(b"INSP1PUPA10 20PD;"), "IN. SP 1. PU. PA 10 20. PD.");
}

#[test]
fn a_label_is_never_read_as_commands() {
    assert_eq!(events(b"LBPU1;\x03PD"), "LB 'P' 'U' '1' ';'. PD.");
}

#[test]
fn the_label_terminator_can_be_set_shown_and_set_back() {
    assert_eq!(events(b"DT#,1;LBa#PG"), "DT '#' 1. LB 'a'. PG.");
    assert_eq!(events(b"DT#,0;LBa#PG"), "DT '#' 0. LB 'a' '#'. PG.");
    assert_eq!(events(b"DTQLBaQ;"), "DT 'Q'. LB 'a'.");
    assert_eq!(events(b"DT#;DT;LB#\x03"), "DT '#'. DT. LB '#'.");
    assert_eq!(events(b"DT#;IN;LB#\x03"), "DT '#'. IN. LB '#'.");
}

#[test]
fn symbols_strings_comments_and_encoded_data_are_taken_whole() {
    assert_eq!(events(b"SM;SM*;PU"), "SM. SM '*'. PU.");
    assert_eq!(events(b"BP1,\"P;U\",2,3;PU"), "BP 1 'P' ';' 'U' 2 3. PU.");
    assert_eq!(events(b"CO \";\";PU"), "CO ';'. PU.");
    assert_eq!(events(b"CO, PU;PU"), "CO ',' ' ' 'P' 'U'. PU.");
    assert_eq!(events(b"PE<PU,\n;PU"), "PE '<' 'P' 'U' ',' '\\n'. PU.");
}

#[test]
fn device_control_does_not_disturb_a_command() {
    assert_eq!(
        events(b"\x1b.(;\x1b.I81;;17:\x1b.N;19:PD1\x1b.Y,2,\x1b.M500:3;"),
        "ESC.( ESC.I ESC.N PD 1 ESC.Y 2 ESC.M 3."
    );
    // A missing colon does not swallow the command after it.
    assert_eq!(events(b"\x1b.M500PU;"), "ESC.M PU.");
}

#[test]
fn nothing_is_read_in_the_other_language_of_a_printer() {
    assert_eq!(
        events(b"\x1bE\x1b&l1X\x1b%0BPU1\x1b%0APD;LB\x1bE\x1b%-1BPG"),
        "ESCEE ESC&X ESC%B PU 1 ESC%A ESCEE ESC%B PG."
    );
    assert_eq!(events(b"\x1b%-12345X@PJL SET X=1\r\n@PJL ENTER LANGUAGE=HPGL2\r\nIN;PD"), "ESC%X IN. PD.");
}

#[test]
fn an_error_costs_the_rest_of_its_command_only() {
    assert_eq!(
        events(b"PD1,2,,3;PD--1;PD1.2.3;PU:;PD9e9;"),
        "PD 1 2 <line 1, column 7 (byte 6): PD lacks a number between two commas, and its rest is left out: \
         write the number, 0 included> \
         PD <line 1, column 12 (byte 11): PD holds a malformed number, and its rest is left out: a number is \
         like `-12` or `0.5`> \
         PD <line 1, column 18 (byte 17): PD holds a malformed number, and its rest is left out: a number is \
         like `-12` or `0.5`> \
         PU <line 1, column 26 (byte 25): `:` does not belong into PU, whose rest is left out: separate numbers \
         by commas and end the command with `;`> \
         PD 9. <line 1, column 32 (byte 31): `9` after the letter `e` makes no command: a command is two letters>"
    );
}

#[test]
fn garbage_between_commands_is_reported_once() {
    assert_eq!(
        events(b"\n\xEF\xBB\xBFPU;\0\x1a"),
        "<line 2, column 1 (byte 1): byte 0xEF begins no command: a command is two letters> PU."
    );
}

#[test]
fn what_editors_add_is_passed_over_and_what_cutters_are_told_is_no_command() {
    assert_eq!(events(b"\xEF\xBB\xBFPU;"), "PU.");
    assert_eq!(events(b"!ST1;PU;!FS80\nPD1,2;!PG;"), "!ST. PU. !FS. PD 1 2. !PG.");
    assert_eq!(events(b"PD1,2;PG;@@@\n@"), "PD 1 2. PG. @. @. @. @.");
    assert_eq!(events(b"!S;!;!1,2;\x03!Q"), "!S. !. !. byte 0x03. !Q.");
}

#[test]
fn a_truncated_text_says_what_is_missing() {
    let ends: Vec<String> = [
        &b"P"[..],
        b"PD1,-",
        b"LBabc",
        b"BP\"abc",
        b"PE!!",
        b"\x1b",
        b"\x1b.",
        b"\x1b%0",
        b"PD1,2",
        b"DT",
        b"CO a",
    ]
    .into_iter()
    .map(events)
    .collect();
    insta::assert_snapshot!(ends.join("\n"), @r#"
    <line 1, column 2 (byte 1): the text ends after the letter `P`: a command is two letters>
    PD 1 <line 1, column 5 (byte 4): PD holds a malformed number, and its rest is left out: a number is like `-12` or `0.5`>
    LB 'a' 'b' 'c' <line 1, column 6 (byte 5): the text ends within LB: it must be ended by the label terminator (byte 0x03 unless DT sets another)>
    BP 'a' 'b' 'c' <line 1, column 7 (byte 6): the text ends within BP: it must be ended by `"`>
    PE '!' '!'.
    <line 1, column 2 (byte 1): the text ends within an escape sequence>
    <line 1, column 3 (byte 2): the text ends within an escape sequence>
    <line 1, column 4 (byte 3): the text ends within an escape sequence>
    PD 1 2.
    DT.
    CO 'a'.
    "#);
}

#[test]
fn numbers_out_of_range_are_refused() {
    assert_eq!(events(b"PD1073741824,-1073741824"), "PD 1073741824 -1073741824.");
    assert_eq!(
        events(b"PD1073741825,1;PU"),
        "PD <line 1, column 3 (byte 2): PD holds the number 1073741825, and its rest is left out: numbers reach \
         from -1073741824 to 1073741824> PU."
    );
}
