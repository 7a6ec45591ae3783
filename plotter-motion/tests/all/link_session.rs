//! The bytes of a session, from the call to the first target reached, then a stop: what
//! docs/serial-protocol.md shows.

use core::fmt::Write;
use core::time::Duration;
use plotter_motion::protocol::{Link, LinkSettings, Message, Order};
use plotter_motion::{Pen, StepPoint};

type End = Link<4, 64>;

/// What `from` says now, as text, while `to` hears it.
fn says(name: &str, from: &mut End, to: &mut End, now: Duration, text: &mut String) {
    let mut frame = Vec::new();
    while let Some(byte) = from.transmit(now) {
        to.receive(now, byte);
        frame.push(byte);
        // a frame's end; the zeros of a call and the one before a greeting stand alone
        if byte == 0 && frame.len() > 2 && frame.iter().any(|&byte| byte != 0) || frame.len() == 20 {
            line(name, &mut frame, text);
        }
    }
    line(name, &mut frame, text);
}

fn line(name: &str, frame: &mut Vec<u8>, text: &mut String) {
    if !frame.is_empty() {
        let bytes: Vec<_> = frame.drain(..).map(|byte| format!("{byte:02x}")).collect();
        writeln!(text, "{name:<8} {}", bytes.join(" ")).unwrap();
    }
}

fn write(link: &mut End, message: Message) {
    let (bytes, length) = message.encode();
    assert_eq!(link.write(&bytes[..length]), length);
}

#[test]
fn a_session_is_these_bytes() {
    let settings = LinkSettings::default();
    let (mut host, mut machine) = (End::host(0x1234, settings), End::machine(settings));
    let mut text = String::new();
    let mut now = Duration::ZERO;
    for _ in 0..2 {
        says("host", &mut host, &mut machine, now, &mut text);
        now += Duration::from_millis(30);
        says("machine", &mut machine, &mut host, now, &mut text);
    }
    write(&mut machine, Message::Status { boot: 7, taken: 0, reached: 0, position: StepPoint::default() });
    says("machine", &mut machine, &mut host, now, &mut text);
    write(&mut host, Message::Target { pen: Pen::Up, by: StepPoint::new(900, 600) });
    write(&mut host, Message::Target { pen: Pen::Down, by: StepPoint::new(100, -3) });
    says("host", &mut host, &mut machine, now, &mut text);
    write(&mut machine, Message::Moved(StepPoint::new(900, 600)));
    write(&mut machine, Message::Reached(1));
    says("machine", &mut machine, &mut host, now, &mut text);
    says("host", &mut host, &mut machine, now, &mut text);
    // A stop, and on again.
    for order in [Order::Stop, Order::GoOn] {
        let number = host.order(order);
        says("host", &mut host, &mut machine, now, &mut text);
        assert_eq!(machine.take_order(), Some((number, order)));
        write(&mut machine, Message::Stands { order: number.into(), state: order });
        says("machine", &mut machine, &mut host, now, &mut text);
        host.order_taken(number);
        now += Duration::from_millis(100);
        says("host", &mut host, &mut machine, now, &mut text);
    }
    insta::assert_snapshot!(text);
}
