//! [`Inputs`]: the records of a log as a player takes them.

use super::EdgeSource;
use super::unframed::Unframed;
use crate::log::Record;

/// The records of a log as they are; or, for a re-run message by message, what they say without frames, and
/// with edges.
#[derive(Debug)]
pub struct Inputs<I>(Kind<I>);

#[derive(Debug)]
enum Kind<I> {
    Plain(I),
    Unframed(Box<Unframed<I>>),
}

impl<I: Iterator<Item = Record>> Inputs<I> {
    pub(super) fn new(records: I, edges: EdgeSource) -> Self {
        Self(match edges {
            EdgeSource::Messages => Kind::Unframed(Box::new(Unframed::new(records))),
            EdgeSource::Records | EdgeSource::Pulses => Kind::Plain(records),
        })
    }
}

impl<I: Iterator<Item = Record>> Iterator for Inputs<I> {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        match &mut self.0 {
            Kind::Plain(records) => records.next(),
            Kind::Unframed(records) => records.next(),
        }
    }
}
