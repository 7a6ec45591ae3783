//! [`Host`]: the task that talks to the host; [`Receive`]: that of either dialect.

use super::grbl::{Grbl, Pens};
use super::mdraw::MDraw;
use super::{
    Dialect, Link, SettingsError, Signal, StartupLines, Status, StepperPlotterSettings, StoredSettings,
};
use crate::Point;
use crate::homing::Homed;

/// A receive side: bytes from the host in, commands for the motion side out, and answers.
///
/// After each byte and each report call [`work`](Self::work), and fetch the answers with
/// [`transmit`](Self::transmit).
pub trait Host: Clone + core::fmt::Debug + PartialEq + Sized {
    /// The receive side of a machine that has just been switched on.
    fn new(settings: StepperPlotterSettings) -> Self;

    /// Whether it is built for what these settings ask of it.
    ///
    /// # Errors
    ///
    /// [`SettingsError::Dialect`], [`SettingsError::Pen`].
    fn check(settings: &StepperPlotterSettings) -> Result<(), SettingsError>;

    /// Takes a byte from the host; gives what the motion side must know at once.
    fn receive(&mut self, byte: u8) -> Option<Signal>;

    /// Takes reports, carries out lines and answers them, as far as both queues have room.
    fn work(&mut self, status: &Status, link: &mut Link);

    /// The next byte for the host, if there is one.
    fn transmit(&mut self) -> Option<u8>;

    /// What the host has stored up to now, to be kept.
    fn stored(&self) -> StoredSettings;

    /// Begins anew with what has been stored, the pen at `at`.
    fn restart(&mut self, at: Point);

    /// The lines that it carries out at its start, to be kept: none, if it knows no such lines.
    fn startup_lines(&self) -> StartupLines {
        StartupLines::default()
    }

    /// Takes those that have been kept, before it does anything else.
    fn set_startup_lines(&mut self, _: &StartupLines) {}

    /// Takes what an earlier homing has measured.
    fn set_homed(&mut self, _: Homed) {}
}

/// The receive side for either dialect, as the settings say. See [`Host`] for what it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Receive {
    host: Either,
}

#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one of it, for as long as the machine runs, and no heap"
)]
enum Either {
    MDraw(MDraw),
    Grbl(Grbl),
}

/// Hands a call on to the dialect.
macro_rules! either {
    ($host:expr, $name:ident ( $($argument:expr),* )) => {
        match $host {
            Either::MDraw(mdraw) => mdraw.$name($($argument),*),
            Either::Grbl(grbl) => grbl.$name($($argument),*),
        }
    };
}

impl Receive {
    /// The receive side of a machine that has just been switched on.
    #[must_use]
    pub fn new(settings: StepperPlotterSettings) -> Self {
        let host = match settings.dialect {
            Dialect::MDraw => Either::MDraw(MDraw::new(settings)),
            Dialect::Grbl => Either::Grbl(Grbl::new(settings)),
        };
        Self { host }
    }

    /// See [`Host::receive`].
    pub fn receive(&mut self, byte: u8) -> Option<Signal> {
        either!(&mut self.host, receive(byte))
    }

    /// See [`Host::work`].
    pub fn work(&mut self, status: &Status, link: &mut Link) {
        either!(&mut self.host, work(status, link));
    }

    /// See [`Host::transmit`].
    pub fn transmit(&mut self) -> Option<u8> {
        either!(&mut self.host, transmit())
    }

    /// See [`Host::stored`].
    #[must_use]
    pub const fn stored(&self) -> StoredSettings {
        either!(&self.host, stored())
    }

    /// See [`Host::restart`].
    pub fn restart(&mut self, at: Point) {
        either!(&mut self.host, restart(at));
    }

    /// See [`Host::startup_lines`].
    #[must_use]
    pub fn startup_lines(&self) -> StartupLines {
        either!(&self.host, startup_lines())
    }

    /// See [`Host::set_startup_lines`].
    pub fn set_startup_lines(&mut self, lines: &StartupLines) {
        either!(&mut self.host, set_startup_lines(lines));
    }

    /// See [`Host::set_homed`].
    pub fn set_homed(&mut self, homed: Homed) {
        either!(&mut self.host, set_homed(homed));
    }
}

/// All of them call the type's own, which are there without the trait.
macro_rules! host {
    ($host:ty, $speaks:pat, $fits:expr $(, $pens:ident)?) => {
        impl$(<$pens: Pens>)? Host for $host {
            fn new(settings: StepperPlotterSettings) -> Self {
                Self::new(settings)
            }

            fn check(settings: &StepperPlotterSettings) -> Result<(), SettingsError> {
                if !matches!(settings.dialect, $speaks) {
                    return Err(SettingsError::Dialect(settings.dialect));
                }
                let fits: fn(&StepperPlotterSettings) -> bool = $fits;
                if fits(settings) { Ok(()) } else { Err(SettingsError::Pen(settings.convention())) }
            }

            fn receive(&mut self, byte: u8) -> Option<Signal> {
                self.receive(byte)
            }

            fn work(&mut self, status: &Status, link: &mut Link) {
                self.work(status, link);
            }

            fn transmit(&mut self) -> Option<u8> {
                self.transmit()
            }

            fn stored(&self) -> StoredSettings {
                self.stored()
            }

            fn restart(&mut self, at: Point) {
                self.restart(at);
            }

            fn startup_lines(&self) -> StartupLines {
                self.startup_lines()
            }

            fn set_startup_lines(&mut self, lines: &StartupLines) {
                self.set_startup_lines(lines);
            }

            fn set_homed(&mut self, homed: Homed) {
                self.set_homed(homed);
            }
        }
    };
}

host!(Receive, _, |_| true);
host!(MDraw, Dialect::MDraw, |_| true);
host!(Grbl<P>, Dialect::Grbl, P::fit, P);
