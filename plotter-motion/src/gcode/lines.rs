//! [`Lines`]: the lines of a text in the order in which they are carried out.

#[cfg(feature = "alloc")]
use super::PenWords;
#[cfg(feature = "alloc")]
use super::program::Program;
use super::{Block, Error, Reader, Text};

/// The lines of a text, with their variables and subprograms where there is memory for them.
#[derive(Clone, Debug)]
pub(super) struct Lines<I> {
    bytes: I,
    reader: Reader,
    #[cfg(feature = "alloc")]
    program: Program,
    #[cfg(not(feature = "alloc"))]
    is_over: bool,
}

impl<I: Iterator<Item = u8>> Lines<I> {
    pub(super) fn new(bytes: I) -> Self {
        Self {
            bytes,
            reader: Reader::new(),
            #[cfg(feature = "alloc")]
            program: Program::default(),
            #[cfg(not(feature = "alloc"))]
            is_over: false,
        }
    }

    #[cfg(feature = "alloc")]
    pub(super) fn with_pen_words(self, words: PenWords) -> Self {
        Self { program: self.program.with_pen_words(words), ..self }
    }

    /// The next line that has words, which is the [block](Self::block) until that is [cleared](Self::clear),
    /// or what is wrong with it.
    #[cfg(feature = "alloc")]
    pub(super) fn advance(&mut self) -> Option<Result<(), Error>> {
        self.program.advance(&mut self.bytes, &mut self.reader)
    }

    /// The next line that has words, which is the [block](Self::block) until that is [cleared](Self::clear),
    /// or what is wrong with it.
    #[cfg(not(feature = "alloc"))]
    pub(super) fn advance(&mut self) -> Option<Result<(), Error>> {
        let ended = self.bytes.by_ref().find_map(|byte| self.reader.advance(byte));
        if ended.is_none() && !core::mem::replace(&mut self.is_over, true) {
            return self.reader.advance_to_end();
        }
        ended
    }

    /// How many lines so far have begun a subprogram of Fanuc's.
    #[cfg(feature = "alloc")]
    pub(super) fn labels(&self) -> u32 {
        self.program.labels()
    }

    /// How many lines so far have begun a subprogram of Fanuc's.
    #[cfg(not(feature = "alloc"))]
    pub(super) fn labels(&self) -> u32 {
        u32::from(self.block().number(b'O').is_some())
    }

    pub(super) fn block(&self) -> &Block {
        self.reader.block()
    }

    pub(super) fn text(&self) -> Text {
        self.reader.text()
    }

    pub(super) fn clear(&mut self) {
        self.reader.clear_block();
    }
}
