//! [`Recorder`]: takes bytes from any thread, stamps them, and writes them into a log from a thread of its
//! own.

use crate::import::Side;
use crate::log::{self, EventRef, Header, RecordRef, WriteError, Writer};
use core::time::Duration;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

/// How often what came is written through: a kill costs no more than that, and the 0.5 s of the format are
/// kept when a disk takes its time.
const WRITE_EVERY: Duration = Duration::from_millis(200);
/// Most bytes of a record, as the format has it.
const RECORD_BYTES: usize = 64;
/// Bytes that may wait for a slow disk: five minutes of a full line at 256000 baud, both ways.
const MOST_WAITING: usize = 16 << 20;

/// What a recording holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recorded {
    /// Bytes of the host that are in the log.
    pub host_bytes: u64,
    /// Bytes of the controller that are in the log.
    pub controller_bytes: u64,
    /// Bytes that came too fast for the disk, and are not.
    pub lost_bytes: u64,
}

/// Records what goes over a line. It is cheap to hand bytes over: they are stamped and copied. Clones record
/// into the same log.
///
/// ```
/// # use plotter_replay::import::Side;
/// # use plotter_replay::log::{self, Header};
/// # use plotter_replay::record::Recorder;
/// # let directory = tempfile::tempdir()?;
/// # let path = directory.path().join("session.plog");
/// let recorder = Recorder::create(&path, &Header::new().with_number("baud", 256_000), |error| eprintln!("{error}"))?;
/// recorder.bytes(Side::Host, &[2, 0, 0, 0, 0, 1, 0, 0, 0, 0]);
/// recorder.bytes(Side::Controller, b"131+");
/// assert_eq!(recorder.finish()?.controller_bytes, 4);
/// assert_eq!(log::open(&path)?.filter(Result::is_ok).count(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Recorder {
    shared: Arc<Shared>,
    /// `None` once it has been waited for.
    thread: Arc<Mutex<Option<JoinHandle<()>>>>,
}

#[derive(Debug)]
struct Shared {
    began: Instant,
    state: Mutex<State>,
    woken: Condvar,
}

#[derive(Debug, Default)]
struct State {
    waiting: Batch,
    over: bool,
    failed: Option<WriteError>,
    recorded: Recorded,
}

/// What waits to be written: the texts and bytes of all records after one another.
#[derive(Debug, Default)]
struct Batch {
    bytes: Vec<u8>,
    /// Time, what, and how many bytes of it.
    records: Vec<(u64, What, usize)>,
    lost: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    Bytes(Side),
    Note,
}

impl Recorder {
    /// Begins a recording in a new file, or an emptied one; packed if its name ends in `.gz`. `on_failure` is
    /// called once, from another thread, if it cannot be written any further.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the file cannot be begun.
    pub fn create(
        path: &Path,
        header: &Header,
        on_failure: impl FnOnce(&WriteError) + Send + 'static,
    ) -> Result<Self, WriteError> {
        let writer = log::create(path, header)?;
        // What the system holds back must be on the disk when the computer loses its power, too. What is no
        // file of a disk (a pipe) cannot be asked that.
        let file = File::options().append(true).open(path).ok();
        let sync = move || match &file {
            Some(file) => file.sync_data().is_ok(),
            None => true,
        };
        Self::start(writer, sync, on_failure)
    }

    /// Records into any writer.
    ///
    /// # Errors
    ///
    /// [`WriteError::Sink`] if there can be no further thread.
    pub fn new<W: Write + Send + 'static>(
        writer: Writer<W>,
        on_failure: impl FnOnce(&WriteError) + Send + 'static,
    ) -> Result<Self, WriteError> {
        Self::start(writer, || true, on_failure)
    }

    fn start<W: Write + Send + 'static>(
        writer: Writer<W>,
        sync: impl Fn() -> bool + Send + 'static,
        on_failure: impl FnOnce(&WriteError) + Send + 'static,
    ) -> Result<Self, WriteError> {
        let shared = Arc::new(Shared {
            began: Instant::now(),
            state: Mutex::new(State::default()),
            woken: Condvar::new(),
        });
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name(String::from("recorder"))
            .spawn(move || {
                if let Err(error) = theirs.write_all(writer, sync) {
                    on_failure(&error);
                    theirs.lock().failed = Some(error);
                }
            })
            .map_err(|error| WriteError::Sink { message: error.to_string() })?;
        Ok(Self { shared, thread: Arc::new(Mutex::new(Some(thread))) })
    }

    /// Records bytes that have just come.
    pub fn bytes(&self, side: Side, bytes: &[u8]) {
        self.shared.push(What::Bytes(side), bytes);
    }

    /// Records words for people.
    pub fn note(&self, text: &str) {
        self.shared.push(What::Note, text.as_bytes());
    }

    /// Time since the recording began.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        self.shared.began.elapsed()
    }

    /// Why nothing is recorded any more, if so.
    #[must_use]
    pub fn failure(&self) -> Option<WriteError> {
        self.shared.lock().failed.clone()
    }

    /// Writes what is left and ends the recording; what is handed over later is not recorded.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if not all of it is in the log.
    pub fn finish(&self) -> Result<Recorded, WriteError> {
        self.shared.lock().over = true;
        self.shared.woken.notify_all();
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(thread) = thread {
            // A panic of the thread has been shown; what is in the log is in the log.
            let _ = thread.join();
        }
        let state = self.shared.lock();
        match &state.failed {
            Some(error) => Err(error.clone()),
            None => Ok(state.recorded),
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn push(&self, what: What, bytes: &[u8]) {
        let mut state = self.lock();
        if state.failed.is_some() || state.over {
            return;
        }
        let batch = &mut state.waiting;
        if batch.bytes.len().saturating_add(bytes.len()) > MOST_WAITING {
            batch.lost = batch.lost.saturating_add(bytes.len() as u64);
            return;
        }
        // Stamped under the lock, so that time never goes back.
        let time_us = u64::try_from(self.began.elapsed().as_micros()).unwrap_or(u64::MAX);
        let most = if what == What::Note { bytes.len().max(1) } else { RECORD_BYTES };
        for part in bytes.chunks(most) {
            batch.bytes.extend_from_slice(part);
            batch.records.push((time_us, what, part.len()));
        }
    }

    fn write_all<W: Write>(&self, mut writer: Writer<W>, sync: impl Fn() -> bool) -> Result<(), WriteError> {
        let mut batch = Batch::default();
        let mut is_synced = true;
        loop {
            let over = {
                let mut state = self.lock();
                if !state.over {
                    let (woken, _) =
                        self.woken.wait_timeout(state, WRITE_EVERY).unwrap_or_else(PoisonError::into_inner);
                    state = woken;
                }
                core::mem::swap(&mut state.waiting, &mut batch);
                state.over
            };
            if batch.records.is_empty() && batch.lost == 0 {
                if over {
                    return writer.finish().map(drop);
                }
                continue;
            }
            let recorded = write_batch(&mut writer, &mut batch)?;
            writer.flush()?;
            // Asked once; a pipe says no, and is not asked again.
            is_synced = is_synced && sync();
            let mut state = self.lock();
            let total = &mut state.recorded;
            total.host_bytes = total.host_bytes.saturating_add(recorded.host_bytes);
            total.controller_bytes = total.controller_bytes.saturating_add(recorded.controller_bytes);
            total.lost_bytes = total.lost_bytes.saturating_add(recorded.lost_bytes);
        }
    }
}

/// Writes all of a batch and empties it.
fn write_batch<W: Write>(writer: &mut Writer<W>, batch: &mut Batch) -> Result<Recorded, WriteError> {
    let mut recorded = Recorded { lost_bytes: batch.lost, ..Recorded::default() };
    let mut rest = batch.bytes.as_slice();
    let mut last = Duration::ZERO;
    for (time_us, what, count) in batch.records.drain(..) {
        let (bytes, after) = rest.split_at_checked(count).unwrap_or((rest, &[]));
        rest = after;
        last = Duration::from_micros(time_us);
        let event = match what {
            What::Bytes(Side::Host) => {
                recorded.host_bytes = recorded.host_bytes.saturating_add(count as u64);
                EventRef::Host(bytes)
            }
            What::Bytes(Side::Controller) => {
                recorded.controller_bytes = recorded.controller_bytes.saturating_add(count as u64);
                EventRef::Controller(bytes)
            }
            What::Note => EventRef::Note(String::from_utf8_lossy(bytes)),
        };
        writer.write_ref(&RecordRef { time: last, event })?;
    }
    if batch.lost > 0 {
        let note =
            format!("recorder: {} bytes came too fast for the disk and are not in the log", batch.lost);
        writer.write_ref(&RecordRef { time: last, event: EventRef::Note(note.into()) })?;
    }
    batch.bytes.clear();
    batch.lost = 0;
    Ok(recorded)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Event, Reader};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A disk with room for so many bytes.
    struct Disk(usize);

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_told_once_and_stops_nothing() {
        let told = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&told);
        let writer = Writer::new(Disk(1_000), &Header::new()).unwrap();
        let recorder = Recorder::new(writer, move |_| {
            count.fetch_add(1, Ordering::SeqCst);
        })
        .unwrap();
        let began = Instant::now();
        while recorder.failure().is_none() && began.elapsed() < Duration::from_secs(20) {
            recorder.bytes(Side::Controller, &[b'1'; 64]);
            std::thread::sleep(Duration::from_millis(1));
        }
        recorder.bytes(Side::Controller, &[b'1'; 64]);
        assert!(matches!(recorder.finish(), Err(WriteError::Sink { .. })));
        assert_eq!(told.load(Ordering::SeqCst), 1);
    }

    #[test]
    fn long_reads_become_records_of_at_most_64_bytes_and_notes_stay_whole() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.plog");
        let recorder = Recorder::create(&path, &Header::new(), |_| {}).unwrap();
        recorder.bytes(Side::Host, &[7; 150]);
        recorder.note(&"word ".repeat(40));
        let recorded = recorder.clone().finish().unwrap();
        assert_eq!(recorded, Recorded { host_bytes: 150, ..Recorded::default() });
        recorder.bytes(Side::Host, &[7]); // too late
        let file = std::fs::read(&path).unwrap();
        let records: Vec<_> = Reader::new(&file[..]).unwrap().map(Result::unwrap).collect();
        let lengths: Vec<usize> = records
            .iter()
            .map(|record| match &record.event {
                Event::Host(bytes) => bytes.len(),
                Event::Note(text) => text.len(),
                _ => 0,
            })
            .collect();
        assert_eq!(lengths, [64, 64, 22, 200]);
    }
}
