//! Assigns bytes to host and controller where a tool gives only names of ports.

use super::{ImportSettings, Side};

/// Names and who they are, found out as they come.
#[derive(Debug)]
pub(super) struct Sides {
    host: Option<String>,
    controller: Option<String>,
    known: Vec<(String, Side)>,
}

/// More names than this are no recording of one line.
const MOST_NAMES: usize = 16;

impl Sides {
    pub(super) fn new(settings: &ImportSettings) -> Self {
        Self { host: settings.host.clone(), controller: settings.controller.clone(), known: Vec::new() }
    }

    /// Who a name is: as was said, as the name says, or the one who speaks first is the host.
    pub(super) fn of(&mut self, name: &str) -> Result<Side, String> {
        if let Some(&(_, side)) = self.known.iter().find(|(known, _)| known == name) {
            return Ok(side);
        }
        let taken = |side| self.known.iter().any(|&(_, known)| known == side);
        let side = if self.host.as_deref() == Some(name) {
            Side::Host
        } else if self.controller.as_deref() == Some(name) {
            Side::Controller
        } else if self.host.is_some() && self.controller.is_some() || self.known.len() >= MOST_NAMES {
            return Err(format!("{name:?} is neither the host nor the controller"));
        } else if self.host.is_some() {
            Side::Controller
        } else if self.controller.is_some() {
            Side::Host
        } else if let Some(side) = hint(name) {
            side
        } else if !taken(Side::Host) {
            Side::Host
        } else if !taken(Side::Controller) {
            Side::Controller
        } else {
            return Err(format!("{name:?} is a third name: which is the host, which the controller?"));
        };
        self.known.push((name.to_owned(), side));
        Ok(side)
    }

    pub(super) fn known(self) -> Vec<(String, Side)> {
        self.known
    }
}

/// The sender that a name suggests by its words.
pub(super) fn hint(name: &str) -> Option<Side> {
    let lower = name.to_ascii_lowercase();
    let mut sides = lower.split(|c: char| !c.is_ascii_alphanumeric()).filter_map(|word| match word {
        "h" | "host" | "pc" | "tx" | "sent" => Some(Side::Host),
        "d" | "device" | "controller" | "plotter" | "machine" | "rx" | "received" => Some(Side::Controller),
        _ => None,
    });
    let first = sides.next()?;
    sides.all(|side| side == first).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_or_the_first_to_speak_is_the_host() {
        assert_eq!(hint("sigrok_uart_H.txt"), Some(Side::Host));
        assert_eq!(hint("sigrok_uart_D.txt"), Some(Side::Controller));
        assert_eq!(hint("host-to-plotter"), None);
        let mut sides = Sides::new(&ImportSettings::default());
        assert_eq!(sides.of("/dev/ttyS0"), Ok(Side::Host));
        assert_eq!(sides.of("/dev/ttyS1"), Ok(Side::Controller));
        assert_eq!(sides.of("/dev/ttyS0"), Ok(Side::Host));
        assert!(sides.of("/dev/ttyS2").is_err());
        let said = ImportSettings { host: Some("b".into()), ..ImportSettings::default() };
        let mut sides = Sides::new(&said);
        assert_eq!((sides.of("a"), sides.of("b")), (Ok(Side::Controller), Ok(Side::Host)));
    }
}
