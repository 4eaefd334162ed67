//! Writes a file in a second thread, so that a slow disk does not delay the link.

use std::fs::File;
use std::io::{BufWriter, Error, ErrorKind, IntoInnerError, Result, Seek, SeekFrom, Write};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

/// Bytes that may wait for the disk: a minute of a run of nine channels.
pub(super) const WAITING_MAX: usize = 8 << 20;
/// Longest wait for the disk when a log is opened, before the device is armed: a disk that takes nothing is reported then.
const OPENING_MAX: Duration = Duration::from_millis(100);
/// Bytes that are passed to the second thread together.
const BLOCK: usize = 1 << 16;

enum Order {
    Write(Vec<u8>),
    Seek(u64),
    /// Answers once everything before is carried out.
    Reply(Sender<()>),
}

/// Shared by both threads.
#[derive(Default)]
struct Shared {
    /// Bytes that wait.
    waiting: AtomicUsize,
    error: Mutex<Option<Error>>,
}

/// The end of a file that the thread of the link holds: it takes bytes and never waits for the disk.
pub(super) struct Background<W> {
    block: Vec<u8>,
    position: u64,
    length: u64,
    /// Whether the opening of the file was flushed.
    is_open: bool,
    orders: Option<Sender<Order>>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<Option<W>>>,
}

impl<W: Write + Seek + Send + 'static> Background<W> {
    /// Hands an empty file to a thread.
    ///
    /// # Errors
    /// If the system starts no thread.
    pub(super) fn new(file: W) -> Result<Self> {
        let (sender, receiver) = channel();
        let shared = Arc::new(Shared::default());
        let of_thread = Arc::clone(&shared);
        let thread = Builder::new().name("log".into()).spawn(move || write_all(file, &receiver, &of_thread))?;
        Ok(Self {
            block: Vec::new(),
            position: 0,
            length: 0,
            is_open: false,
            orders: Some(sender),
            shared,
            thread: Some(thread),
        })
    }

    /// Waits until everything is written, and returns the file.
    ///
    /// # Errors
    /// That of the disk.
    pub(super) fn into_inner(mut self) -> Result<W> {
        self.hand_over()?;
        self.orders = None;
        let file = self.thread.take().and_then(|thread| thread.join().ok().flatten());
        file.ok_or_else(|| self.failure().err().unwrap_or_else(lost))
    }

    /// The error of the disk, which stays for every later call.
    fn failure(&self) -> Result<()> {
        let error = self.shared.error.lock().unwrap_or_else(PoisonError::into_inner);
        match &*error {
            // Neither kind nor text may be lost, and an error cannot be copied.
            Some(error) => Err(error
                .raw_os_error()
                .map_or_else(|| Error::new(error.kind(), error.to_string()), Error::from_raw_os_error)),
            None => Ok(()),
        }
    }

    fn order(&self, order: Order) -> Result<()> {
        self.failure()?;
        let Some(orders) = &self.orders else { return Err(lost()) };
        if let Order::Write(block) = &order {
            let waiting = self.shared.waiting.fetch_add(block.len(), Ordering::Relaxed) + block.len();
            if waiting > WAITING_MAX {
                let text = format!("the disk is too slow: {} MiB wait for it", WAITING_MAX >> 20);
                let error = Error::new(ErrorKind::TimedOut, text);
                *self.shared.error.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                return self.failure();
            }
        }
        orders.send(order).map_err(|_| self.failure().err().unwrap_or_else(lost))
    }

    fn hand_over(&mut self) -> Result<()> {
        if self.block.is_empty() {
            return self.failure();
        }
        let block = std::mem::take(&mut self.block);
        self.order(Order::Write(block))
    }
}

fn lost() -> Error {
    Error::other("the thread that writes the log has ended")
}

/// Carries out orders until the other end is gone; the file, or `None` after an error.
fn write_all<W: Write + Seek>(file: W, orders: &Receiver<Order>, shared: &Shared) -> Option<W> {
    let mut file = file;
    for order in orders {
        let (done, bytes) = match order {
            Order::Write(block) => (file.write_all(&block), block.len()),
            Order::Seek(position) => (file.seek(SeekFrom::Start(position)).map(drop), 0),
            Order::Reply(reply) => {
                let _ = reply.send(());
                (Ok(()), 0)
            }
        };
        shared.waiting.fetch_sub(bytes, Ordering::Relaxed);
        if let Err(error) = done {
            shared.error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            return None;
        }
    }
    Some(file)
}

impl<W: Write + Seek + Send + 'static> Write for Background<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.block.extend_from_slice(bytes);
        self.position += bytes.len() as u64;
        self.length = self.length.max(self.position);
        if self.block.len() >= BLOCK {
            self.hand_over()?;
        }
        Ok(bytes.len())
    }

    /// Passes buffered bytes to the second thread. The first call waits for the disk, for at most [`OPENING_MAX`]; later ones do not.
    fn flush(&mut self) -> Result<()> {
        self.hand_over()?;
        if self.is_open {
            return Ok(());
        }
        self.is_open = true;
        let (reply, done) = channel();
        self.order(Order::Reply(reply))?;
        // Neither a slow disk nor a failed one replies.
        let _ = done.recv_timeout(OPENING_MAX);
        self.failure()
    }
}

impl<W: Write + Seek + Send + 'static> Seek for Background<W> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        let outside = || Error::new(ErrorKind::InvalidInput, "a place before the start of the log");
        let position = match to {
            SeekFrom::Start(position) => position,
            SeekFrom::Current(by) => self.position.checked_add_signed(by).ok_or_else(outside)?,
            SeekFrom::End(by) => self.length.checked_add_signed(by).ok_or_else(outside)?,
        };
        if position != self.position {
            self.hand_over()?;
            self.order(Order::Seek(position))?;
            self.position = position;
        }
        Ok(position)
    }
}

impl<W> Drop for Background<W> {
    /// Waits for the disk unless it has failed or is too slow.
    fn drop(&mut self) {
        let has_failed = self.shared.error.lock().unwrap_or_else(PoisonError::into_inner).is_some();
        if let (Some(orders), false) = (&self.orders, has_failed || self.block.is_empty()) {
            let _ = orders.send(Order::Write(std::mem::take(&mut self.block)));
        }
        self.orders = None;
        if let (Some(thread), false) = (self.thread.take(), has_failed) {
            let _ = thread.join();
        }
    }
}

/// The file of a log: written at once, or in the background while a device is live.
pub(super) enum LogFile {
    Direct(BufWriter<File>),
    Background(Background<File>),
}

impl LogFile {
    /// The file with everything in it.
    ///
    /// # Errors
    /// That of the disk.
    pub(super) fn into_inner(self) -> Result<File> {
        match self {
            Self::Direct(file) => file.into_inner().map_err(IntoInnerError::into_error),
            Self::Background(file) => file.into_inner(),
        }
    }
}

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        match self {
            Self::Direct(file) => file.write(bytes),
            Self::Background(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> Result<()> {
        match self {
            Self::Direct(file) => file.flush(),
            Self::Background(file) => file.flush(),
        }
    }
}

impl Seek for LogFile {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        match self {
            Self::Direct(file) => file.seek(to),
            Self::Background(file) => file.seek(to),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn bytes_and_places_are_those_of_a_file_written_at_once() {
        let mut at_once = Cursor::new(Vec::new());
        let mut behind = Background::new(Cursor::new(Vec::new())).unwrap();
        let write = |file: &mut dyn FnMut(&[u8], Option<SeekFrom>) -> u64| -> Vec<u64> {
            let steps: [(&[u8], Option<SeekFrom>); 5] = [
                (b"head........", None),
                (b"body", None),
                (b"1234", Some(SeekFrom::Start(4))),
                (b"tail", Some(SeekFrom::End(0))),
                (b"!", Some(SeekFrom::Current(-1))),
            ];
            steps.into_iter().map(|(bytes, to)| file(bytes, to)).collect()
        };
        let places = write(&mut |bytes, to| {
            let place = to.map_or(0, |to| at_once.seek(to).unwrap());
            at_once.write_all(bytes).unwrap();
            place
        });
        let also = write(&mut |bytes, to| {
            let place = to.map_or(0, |to| behind.seek(to).unwrap());
            behind.write_all(bytes).unwrap();
            place
        });
        assert_eq!(places, also);
        assert_eq!(behind.into_inner().unwrap().into_inner(), at_once.into_inner());
    }

    /// A disk that takes nothing until it is let go.
    struct Stuck(Receiver<()>);

    impl Write for Stuck {
        fn write(&mut self, bytes: &[u8]) -> Result<usize> {
            let _ = self.0.recv();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> Result<()> {
            Ok(())
        }
    }

    impl Seek for Stuck {
        fn seek(&mut self, _: SeekFrom) -> Result<u64> {
            Ok(0)
        }
    }

    #[test]
    fn disk_that_stands_still_holds_nobody_up_and_is_told_beyond_the_bound() {
        let (let_go, stuck) = sync_channel(0);
        let mut file = Background::new(Stuck(stuck)).unwrap();
        let block = vec![0; BLOCK];
        let taken = (0..).take_while(|_| file.write_all(&block).is_ok()).count();
        assert_eq!(taken, WAITING_MAX / BLOCK);
        let told = file.write_all(&block).unwrap_err();
        assert_eq!(
            (told.kind(), told.to_string().as_str()),
            (ErrorKind::TimedOut, "the disk is too slow: 8 MiB wait for it")
        );
        assert_eq!(file.flush().unwrap_err().to_string(), told.to_string());
        // Nor does its end wait.
        drop(file);
        drop(let_go);
    }

    #[test]
    fn error_of_the_disk_is_told_with_its_number() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> Result<usize> {
                Err(Error::from_raw_os_error(28))
            }

            fn flush(&mut self) -> Result<()> {
                Ok(())
            }
        }
        impl Seek for Full {
            fn seek(&mut self, _: SeekFrom) -> Result<u64> {
                Ok(0)
            }
        }
        let mut file = Background::new(Full).unwrap();
        file.write_all(b"x").unwrap();
        assert_eq!(file.into_inner().err().and_then(|error| error.raw_os_error()), Some(28));
    }
}
