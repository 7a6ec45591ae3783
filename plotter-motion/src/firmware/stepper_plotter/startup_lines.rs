//! [`StartupLines`]: what Grbl's `$N` keeps.

/// Most characters of such a line: what a line of 80 has left beside `$N0=`.
const MOST: usize = 76;

/// The two lines that a machine carries out when it is switched on, reset or homed: Grbl's `$N0` and `$N1`.
/// What is to be kept of them is [`StepperPlotter::startup_lines`](super::StepperPlotter::startup_lines).
///
/// ```
/// # use plotter_motion::firmware::stepper_plotter::StartupLines;
/// let lines = StartupLines::new(["G55", ""]).expect("they are short enough");
/// assert_eq!((lines.get(0), lines.get(1), lines.get(2)), ("G55", "", ""));
/// assert_eq!(StartupLines::new(["G55", &"G".repeat(77)]), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StartupLines {
    texts: [[u8; MOST]; 2],
    lengths: [u8; 2],
}

impl Default for StartupLines {
    fn default() -> Self {
        Self { texts: [[0; MOST]; 2], lengths: [0; 2] }
    }
}

impl StartupLines {
    /// How many there are.
    pub const COUNT: u8 = 2;

    /// These lines, without blanks and comments, in capitals, as a controller keeps them; none if one is
    /// longer than 76 characters or not of ASCII.
    #[must_use]
    pub fn new(lines: [&str; 2]) -> Option<Self> {
        let mut kept = Self::default();
        for (line, number) in lines.into_iter().zip(0..) {
            kept.set(number, line.as_bytes())?;
        }
        Some(kept)
    }

    /// A line, empty if there is none.
    #[must_use]
    pub fn get(&self, number: u8) -> &str {
        core::str::from_utf8(self.bytes(number)).unwrap_or_default()
    }

    pub(super) fn bytes(&self, number: u8) -> &[u8] {
        let at = usize::from(number);
        let length = self.lengths.get(at).copied().unwrap_or_default();
        self.texts.get(at).and_then(|text| text.get(..usize::from(length))).unwrap_or_default()
    }

    /// Keeps a line, if it is short enough.
    pub(super) fn set(&mut self, number: u8, line: &[u8]) -> Option<()> {
        let at = usize::from(number);
        let length = u8::try_from(line.len()).ok()?;
        if !line.is_ascii() {
            return None;
        }
        self.texts.get_mut(at)?.get_mut(..line.len())?.copy_from_slice(line);
        *self.lengths.get_mut(at)? = length;
        Some(())
    }
}
