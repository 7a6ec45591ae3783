//! [`Modes`]: which ways of planning a program is built with.

use super::settings::LEAST_TOLERANCE_MM;
use super::{PathMode, PlannerSettings};
use core::fmt::Debug;
use core::marker::PhantomData;

/// Which ways of planning a program is built with: [`AllModes`], or [`ExactOnly`] or [`ExactPen`] for a small
/// one. What they can do they do alike, to the last bit.
///
/// Nobody else implements it.
pub trait Modes: sealed::Sealed {
    /// Whether curves within a tolerance and S-curves are there.
    #[doc(hidden)]
    const ALL: bool;
    /// Whether a laser is there.
    #[doc(hidden)]
    const LASER: bool;
    /// Memory that only those need.
    #[doc(hidden)]
    type Kept<T: Part>: Keep<T>;
    /// Whether a third axis is there, and the memory that only that needs.
    #[doc(hidden)]
    const Z: bool = false;
    #[doc(hidden)]
    type Rise<T: Part>: Keep<T>;
    /// Memory for one thing, or for another that only those need.
    #[doc(hidden)]
    type Either<A: Part, B: Part>: Choice<A, B>;
}

/// All ways of planning: [`PlannerSettings`] choose one for each job.
///
/// A block takes a Cortex-M4F at most so many instructions, on four drawings
/// (`examples/firmware/counts/check` of the repository): 4879 in [`PathMode::Exact`], 182,000 within a
/// tolerance of 0.05 mm, and with [`PlannerSettings::jerk_mm_s3`] 8.2 million, in parts of at most 196,000
/// ([`Planner::prepare`](super::Planner::prepare)); in the mean 2707, 32,800 and 421,000.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct AllModes;

/// [`PathMode::Exact`] with constant accelerations and nothing else. The firmware of the stepper plotter
/// takes a quarter less program memory with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ExactOnly;

/// [`AllModes`], of a machine with a third axis: a tool that is raised and lowered by a
/// motor of its own, along with the other two. See [`Planner::push_rising`](super::Planner::push_rising).
#[cfg(feature = "third-motor")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ThreeAxes;

/// [`ExactOnly`], of a machine without a laser. The firmware of the stepper plotter takes another kilobyte
/// less with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ExactPen;

impl Modes for AllModes {
    const ALL: bool = true;
    const LASER: bool = true;
    type Kept<T: Part> = Here<T>;
    type Rise<T: Part> = Nowhere<T>;
    type Either<A: Part, B: Part> = Either<A, B>;
}

#[cfg(feature = "third-motor")]
impl Modes for ThreeAxes {
    const ALL: bool = true;
    const LASER: bool = true;
    const Z: bool = true;
    type Kept<T: Part> = Here<T>;
    type Rise<T: Part> = Here<T>;
    type Either<A: Part, B: Part> = Either<A, B>;
}

impl Modes for ExactOnly {
    const ALL: bool = false;
    const LASER: bool = true;
    type Kept<T: Part> = Nowhere<T>;
    type Rise<T: Part> = Nowhere<T>;
    type Either<A: Part, B: Part> = First<A, B>;
}

impl Modes for ExactPen {
    const ALL: bool = false;
    const LASER: bool = false;
    type Kept<T: Part> = Nowhere<T>;
    type Rise<T: Part> = Nowhere<T>;
    type Either<A: Part, B: Part> = First<A, B>;
}

mod sealed {
    pub trait Sealed: Clone + core::fmt::Debug + PartialEq {}
    impl Sealed for super::AllModes {}
    #[cfg(feature = "third-motor")]
    impl Sealed for super::ThreeAxes {}
    impl Sealed for super::ExactOnly {}
    impl Sealed for super::ExactPen {}
}

/// Data that a planner keeps if it is built with a mode.
#[doc(hidden)]
pub trait Part: Clone + Debug + Default + PartialEq {}
impl<T: Clone + Debug + Default + PartialEq> Part for T {}

/// Data that is kept, or nothing in its place.
#[doc(hidden)]
pub trait Keep<T>: Part {
    fn get(&self) -> Option<&T>;
    fn get_mut(&mut self) -> Option<&mut T>;
}

#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Here<T>(T);

#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Nowhere<T>(PhantomData<T>);

/// One of two kinds of data.
#[doc(hidden)]
pub trait Choice<A, B>: Clone + Debug + PartialEq {
    fn of(is_second: bool) -> Self;
    fn first(&self) -> Option<&A>;
    fn first_mut(&mut self) -> Option<&mut A>;
    fn second(&self) -> Option<&B>;
    fn second_mut(&mut self) -> Option<&mut B>;
}

#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Either<A, B> {
    First(A),
    Second(B),
}

#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct First<A, B>(A, PhantomData<B>);

impl<A: Part, B: Part> Choice<A, B> for Either<A, B> {
    fn of(is_second: bool) -> Self {
        if is_second { Self::Second(B::default()) } else { Self::First(A::default()) }
    }

    fn first(&self) -> Option<&A> {
        if let Self::First(first) = self { Some(first) } else { None }
    }

    fn first_mut(&mut self) -> Option<&mut A> {
        if let Self::First(first) = self { Some(first) } else { None }
    }

    fn second(&self) -> Option<&B> {
        if let Self::Second(second) = self { Some(second) } else { None }
    }

    fn second_mut(&mut self) -> Option<&mut B> {
        if let Self::Second(second) = self { Some(second) } else { None }
    }
}

impl<A: Part, B: Part> Choice<A, B> for First<A, B> {
    fn of(_: bool) -> Self {
        Self(A::default(), PhantomData)
    }

    fn first(&self) -> Option<&A> {
        Some(&self.0)
    }

    fn first_mut(&mut self) -> Option<&mut A> {
        Some(&mut self.0)
    }

    fn second(&self) -> Option<&B> {
        None
    }

    fn second_mut(&mut self) -> Option<&mut B> {
        None
    }
}

impl<T: Part> Keep<T> for Here<T> {
    fn get(&self) -> Option<&T> {
        Some(&self.0)
    }

    fn get_mut(&mut self) -> Option<&mut T> {
        Some(&mut self.0)
    }
}

impl<T: Part> Keep<T> for Nowhere<T> {
    fn get(&self) -> Option<&T> {
        None
    }

    fn get_mut(&mut self) -> Option<&mut T> {
        None
    }
}

impl PlannerSettings {
    /// The way to follow the path: only what these modes can do is left in the program.
    pub(super) const fn path_of<M: Modes>(&self) -> PathMode {
        if M::ALL { self.path } else { PathMode::Exact }
    }

    /// As [`Self::path_of`], how far vertices may be missed in exact mode; 0 for not at all.
    pub(super) const fn allowance_of<M: Modes>(&self) -> f64 {
        if M::ALL && self.allowance_mm >= LEAST_TOLERANCE_MM { self.allowance_mm } else { 0.0 }
    }

    /// As [`Self::path_of`], the jerk.
    pub(super) const fn jerk_of<M: Modes>(&self) -> Option<f64> {
        if M::ALL { self.jerk_mm_s3 } else { None }
    }
}
