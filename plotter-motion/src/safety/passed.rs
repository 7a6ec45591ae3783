//! [`Drive`], [`Pulse`] and [`Beam`]: demands that a gate has passed. Nothing else makes one.

use super::{Duty, SafetyGate};
use crate::{Axis, StepPair};
use core::marker::PhantomData;

/// What both motors get: made by [`SafetyGate::pass`] only. It ends when its gate is told anything; the
/// default is none at all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Drive<'gate> {
    x: Duty,
    y: Duty,
    #[cfg(feature = "third-motor")]
    z: Duty,
    gate: PhantomData<&'gate SafetyGate>,
}

impl Drive<'_> {
    /// The duty of the first motor.
    #[must_use]
    pub const fn x(self) -> Duty {
        self.x
    }

    /// The duty of the second motor.
    #[must_use]
    pub const fn y(self) -> Duty {
        self.y
    }

    /// The duty of a third motor, upwards: by [`SafetyGate::pass_z`], and then of that alone.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn z(self) -> Duty {
        self.z
    }

    /// The share of a third motor, as the driver of an axis takes it.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn of_z(self, axis: Axis) -> Self {
        let (x, y) = match axis {
            Axis::X => (self.z, Duty::ZERO),
            Axis::Y => (Duty::ZERO, self.z),
        };
        Self { x, y, z: Duty::ZERO, gate: self.gate }
    }

    /// The duty of the motor of `axis`.
    #[must_use]
    pub const fn axis(self, axis: Axis) -> Duty {
        match axis {
            Axis::X => self.x,
            Axis::Y => self.y,
        }
    }

    /// Those of both motors.
    #[must_use]
    pub const fn duties(self) -> [Duty; 2] {
        [self.x, self.y]
    }

    /// The same without its end: for a controller that keeps its gate in the same place, and passes the
    /// demand again whenever it tells the gate anything. It lends the drive no longer than itself.
    pub(crate) const fn kept(self) -> Drive<'static> {
        Drive {
            x: self.x,
            y: self.y,
            #[cfg(feature = "third-motor")]
            z: self.z,
            gate: PhantomData,
        }
    }
}

pub(super) const fn drive(x: Duty, y: Duty) -> Drive<'static> {
    Drive {
        x,
        y,
        #[cfg(feature = "third-motor")]
        z: Duty::ZERO,
        gate: PhantomData,
    }
}

#[cfg(feature = "third-motor")]
pub(super) const fn drive_z(z: Duty) -> Drive<'static> {
    Drive { x: Duty::ZERO, y: Duty::ZERO, z, gate: PhantomData }
}

/// A step of either motor or of both that may be made: by [`SafetyGate::pass_step`] only. It ends when its
/// gate is told anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pulse<'gate> {
    x: i8,
    y: i8,
    #[cfg(feature = "third-motor")]
    z: i8,
    /// What the second motor of an axis makes, where that is not what the first makes.
    #[cfg(feature = "third-motor")]
    apart: Option<i8>,
    gate: PhantomData<&'gate SafetyGate>,
}

impl Pulse<'_> {
    /// The step of the first motor: -1, 0 or 1.
    #[must_use]
    pub const fn x(self) -> i8 {
        self.x
    }

    /// The step of the second motor: -1, 0 or 1.
    #[must_use]
    pub const fn y(self) -> i8 {
        self.y
    }

    /// The step of a third motor: -1, 0 or 1. It comes alone.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn z(self) -> i8 {
        self.z
    }

    /// The step of the second motor of an axis that has two: that of the first, but where both are made
    /// square.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn second(self, axis: Axis) -> i8 {
        match (self.apart, axis) {
            (Some(step), _) => step,
            (None, Axis::X) => self.x,
            (None, Axis::Y) => self.y,
        }
    }

    /// The step of the second motor of an axis, where that is not what the first makes.
    #[cfg(all(feature = "third-motor", feature = "step-ahead"))]
    pub(crate) const fn apart(self) -> Option<i8> {
        self.apart
    }

    /// The share of a third axis, as the driver of an axis takes it.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn of_z(self, axis: Axis) -> Self {
        self.alone(axis, self.z)
    }

    /// The share of the second motor of an axis, as the driver of that axis takes it.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn of_second(self, axis: Axis) -> Self {
        self.alone(axis, self.second(axis))
    }

    #[cfg(feature = "third-motor")]
    const fn alone(self, axis: Axis, step: i8) -> Self {
        let (x, y) = match axis {
            Axis::X => (step, 0),
            Axis::Y => (0, step),
        };
        Self { x, y, z: 0, apart: None, gate: self.gate }
    }

    /// A step of a third motor in its place.
    #[cfg(feature = "third-motor")]
    pub(super) const fn with_z(self, z: i8) -> Self {
        Self { z, ..self }
    }

    /// With another step of the second motor of an axis.
    #[cfg(feature = "third-motor")]
    pub(super) const fn with_second(self, step: i8) -> Self {
        Self { apart: Some(step), ..self }
    }

    /// As [`Drive::kept`].
    pub(crate) const fn kept(self) -> Pulse<'static> {
        Pulse {
            x: self.x,
            y: self.y,
            #[cfg(feature = "third-motor")]
            z: self.z,
            #[cfg(feature = "third-motor")]
            apart: self.apart,
            gate: PhantomData,
        }
    }
}

impl From<Pulse<'_>> for StepPair {
    fn from(pulse: Pulse<'_>) -> Self {
        Self { x: pulse.x, y: pulse.y }
    }
}

pub(super) const fn pulse(step: StepPair) -> Pulse<'static> {
    Pulse {
        x: step.x,
        y: step.y,
        #[cfg(feature = "third-motor")]
        z: 0,
        #[cfg(feature = "third-motor")]
        apart: None,
        gate: PhantomData,
    }
}

/// Power of a laser, in 65535ths, that may be switched on: by [`SafetyGate::pass_laser`] only. It ends when
/// its gate is told anything; the default is off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beam<'gate> {
    power: u16,
    gate: PhantomData<&'gate SafetyGate>,
}

impl Beam<'_> {
    /// No power.
    pub const OFF: Self = Self { power: 0, gate: PhantomData };

    /// The power, in 65535ths.
    #[must_use]
    pub const fn power(self) -> u16 {
        self.power
    }

    /// As [`Drive::kept`].
    pub(crate) const fn kept(self) -> Beam<'static> {
        Beam { power: self.power, gate: PhantomData }
    }
}

pub(super) const fn beam(power: u16) -> Beam<'static> {
    Beam { power, gate: PhantomData }
}
