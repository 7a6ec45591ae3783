//! Any bytes from the line: neither end of the reliable link panics or speaks for ever, and nothing is read
//! that was not sent.
#![no_main]

use core::time::Duration;
use libfuzzer_sys::fuzz_target;
use plotter_motion::protocol::{Link, LinkSettings, LinkState, MessageDecoder, Order};

fuzz_target!(|bytes: &[u8]| {
    let settings = LinkSettings::default();
    let mut ends = [Link::<4, 32>::host(9, settings), Link::<4, 32>::machine(settings)];
    for link in &mut ends {
        let mut messages = MessageDecoder::default();
        for (n, &byte) in bytes.iter().enumerate() {
            let now = Duration::from_millis(n as u64);
            link.receive(now, byte);
            link.write(&[byte]);
            if let Some(order) = Order::from_byte(byte) {
                link.order(order);
            }
            if let Some((number, _)) = link.take_order() {
                link.order_taken(number);
            }
            let spoken = std::iter::from_fn(|| link.transmit(now)).take(2000).count();
            assert!(spoken < 2000);
            let mut read = [0; 8];
            let length = link.read(&mut read);
            for &byte in &read[..length] {
                let _ = messages.push(byte);
            }
            assert!(
                link.next_wake().is_some()
                    || matches!(link.state(), LinkState::Idle | LinkState::DigitsOnly | LinkState::Restarted)
            );
        }
    }
});
