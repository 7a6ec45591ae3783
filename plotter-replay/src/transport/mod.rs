//! Serial lines as they are: with faults.

mod fault_injector;

pub use fault_injector::{FaultCounts, FaultInjector, Faults};
