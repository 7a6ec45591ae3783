//! The followers, and the sources of their windows.

use super::command::{FollowCommand, Method, Side, WINDOWS};
use crate::follow::WindowSource;
use plotter_vector::follow::LineFollower as _;
use plotter_vector::{
    Gray, PxPoint,
    follow::{
        Correction, Hand, MappingFollower, MappingSettings, PublishedFollower, PublishedSettings,
        SimulatedCamera, Step,
    },
};

/// Where windows come from.
pub(super) enum Eyes {
    Simulated(Box<SimulatedCamera>),
    Real(WindowSource),
}

/// Either follower, with its correction of the lens.
pub(super) enum Follower {
    Ours(Box<MappingFollower>),
    Published(PublishedFollower, Option<Box<Correction>>),
}

impl Follower {
    /// As asked; `most_windows` is the most that the drawing can need, where it is known.
    pub(super) fn new(
        arguments: &FollowCommand,
        area: [PxPoint; 2],
        correction: Option<Correction>,
        most_windows: Option<u64>,
    ) -> Self {
        if arguments.method == Method::Ours {
            return Self::Ours(Box::new(MappingFollower::new(
                MappingSettings::default()
                    .with_area(Some(area))
                    .with_max_windows(
                        arguments.windows.unwrap_or(most_windows.unwrap_or(WINDOWS).min(WINDOWS)),
                    )
                    .with_correction(correction),
            )));
        }
        let settings = PublishedSettings::for_lines(arguments.thinnest)
            .with_hand(if arguments.hand == Some(Side::Left) { Hand::Left } else { Hand::Right })
            .with_only_connected(arguments.method == Method::Connected)
            .with_area(Some(area));
        Self::Published(PublishedFollower::new(settings), correction.map(Box::new))
    }

    pub(super) fn observe(&mut self, window: &Gray, pose: PxPoint) -> Step {
        match self {
            Self::Ours(follower) => follower.observe(window, pose),
            Self::Published(follower, Some(correction)) => {
                follower.observe(&correction.corrected(window), pose)
            }
            Self::Published(follower, None) => follower.observe(window, pose),
        }
    }
}
