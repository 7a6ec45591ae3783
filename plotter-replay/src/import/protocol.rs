//! [`protocol_of`]: which protocol a recording is of, where nobody says it.

/// What a line of the host or the machine begins with, and which protocol says so. Only what no other of
/// these says: an `ok` is Grbl's and Marlin's.
///
/// Sources: the Grbl project's wiki, "Grbl v1.1 Interface"; Marlin's documentation, "G-code" and "Host
/// communication"; the firmware xybot; EBB Command Set; HP 7475A Interfacing and Programming Manual.
const TELL: [(&str, &[&str], &[&str]); 5] = [
    ("ebb", &["XM,", "SM,", "LM,", "EM,", "SP,", "QS", "QM"], &["EBBv"]),
    ("marlin", &["M110", "M115", "M114", "M400", "M155"], &["echo:", "FIRMWARE_NAME:", "Resend:", "start"]),
    ("grbl", &["$"], &["Grbl ", "<Idle|", "<Run|", "<Hold", "<Alarm", "<Jog|", "[GC:", "[MSG:", "ALARM:"]),
    ("mdraw", &["M10", "M11", "M5 A", "M2 U"], &["distance=", "POS X", "M10 XY"]),
    ("hpgl", &["IN;", "\u{1b}.", "SP1;", "PU", "PD"], &[]),
];

/// The protocol of a recording that begins with these bytes of the host and of the machine: as a log's header
/// names it, `unknown` for text that is none of those.
///
/// ```
/// # use plotter_replay::import::protocol_of;
/// assert_eq!(protocol_of(&[2, 0, 0, 0, 0, 1, 0, 0, 0, 0], b"1131+"), "digits");
/// assert_eq!(protocol_of(b"G21\nG1 X10 F600\n", b"\r\nGrbl 1.1h ['$' for help]\r\nok\r\nok\r\n"), "grbl");
/// assert_eq!(protocol_of(b"G28\nM104 S0\n", b"// Klipper state: Ready\nok\n"), "unknown");
/// ```
#[must_use]
pub fn protocol_of(host: &[u8], machine: &[u8]) -> &'static str {
    // Digits and their answers, and frames, are no text: both are read as digits, which know a frame.
    let ends = |bytes: &[u8]| bytes.iter().any(|byte| matches!(byte, b'\n' | b'\r' | b';'));
    if !(is_text(host) && is_text(machine) && (ends(host) || ends(machine))) {
        return "digits";
    }
    let begins = |bytes: &[u8], words: &[&str]| {
        let mut lines = bytes.split(|byte| matches!(byte, b'\r' | b'\n'));
        // `M104` is another word than `M10`.
        let is_whole = |word: &str, rest: &[u8]| {
            !(word.ends_with(|c: char| c.is_ascii_digit()) && rest.first().is_some_and(u8::is_ascii_digit))
        };
        let is = |line: &[u8], word: &str| {
            line.strip_prefix(word.as_bytes()).is_some_and(|rest| is_whole(word, rest))
        };
        lines.any(|line| words.iter().any(|word| is(line, word)))
    };
    for (protocol, said, answered) in TELL {
        if begins(machine, answered) || begins(host, said) {
            return protocol;
        }
    }
    // Lines of G-code of which each is answered are Grbl's where nothing else is said.
    let is_answered = |word: &[u8]| {
        let lines = machine.split(|byte| matches!(byte, b'\r' | b'\n')).filter(|line| !line.is_empty());
        let mut count = (0_u32, 0_u32);
        lines.for_each(|line| if line == word { count.0 += 1 } else { count.1 += 1 });
        count.0 > 0 && count.1 == 0
    };
    match (is_answered(b"ok"), is_answered(b"OK")) {
        (true, _) => "grbl",
        (_, true) => "mdraw",
        _ => "unknown",
    }
}

/// Whether these are printable characters, but for a byte in twenty.
fn is_text(bytes: &[u8]) -> bool {
    let printable = |byte: &&u8| matches!(byte, b' '..=b'~' | b'\r' | b'\n' | 0x1b);
    bytes.iter().filter(printable).count().saturating_mul(20) >= bytes.len().saturating_mul(19)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_language_is_known_by_what_it_alone_says() {
        for (host, machine, wanted) in [
            (&b"\n\nG21\nG90\n"[..], &b"ok\r\nok\r\nok\r\nok\r\n"[..], "grbl"),
            (b"?", b"<Idle|MPos:0.000,0.000,0.000|Bf:15,128|FS:0,0>\r\n", "grbl"),
            (b"M10\nG1 X3 Y4\n", b"M10 XY 380 310 0.00 0.00 A0 B0 H0 S80 U160 D90\r\nOK\r\n", "mdraw"),
            (b"G1 X3 Y4\n", b"OK\r\n", "mdraw"),
            (b"N1 M110*125\nG28\n", b"start\necho:Marlin 2.1.2\nok\n", "marlin"),
            (b"V\rSM,20,0,0\r", b"EBBv13_and_above EB Firmware Version 2.8.1\r\nOK\r\n", "ebb"),
            (b"IN;SP1;PU80,40;PD160,40;", b"", "hpgl"),
            (b"QUIT\r\n", b"goodbye\r\n", "unknown"),
            (b"", b"1131+", "digits"),
            (b"", b"", "digits"),
            (&[0, 3, 1, 2, 0], &[0, 2, 9, 0], "digits"),
        ] {
            assert_eq!(protocol_of(host, machine), wanted, "{}", String::from_utf8_lossy(host));
        }
    }
}
