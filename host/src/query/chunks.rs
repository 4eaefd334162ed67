//! Lines answered by several threads, in order and in bounded memory.

use std::collections::VecDeque;
use std::io::{self, BufRead, Read, Write};
use std::num::NonZero;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Bytes of input that a thread takes at a time, at first: some fifty lines, which keep slow lines apart.
const CHUNK: u64 = 16 << 10;
/// The same once many chunks were read: lines that are so many are fast, and their hand-over counts.
const LARGE_CHUNK: u64 = 64 << 10;
/// Chunks after which they are large.
const MANY: usize = 32;
/// Chunks a thread may be ahead of the writer.
const AHEAD: usize = 8;

/// Whole lines of the input; only the last of all may lack its end.
pub(super) struct Chunk {
    pub(super) lines: Vec<u8>,
    /// Number of its first line, from 1.
    pub(super) first_line: usize,
}

type Answers = io::Result<Vec<u8>>;

/// A chunk, and where its answers go.
type Job = (Chunk, SyncSender<Answers>);

/// Writes the answers to all chunks of `input` in the order of the chunks.
///
/// # Errors
/// The first error in reading, answering or writing; what was read before it is answered and written.
pub(super) fn in_order(
    threads: NonZero<usize>,
    mut input: impl BufRead,
    mut output: impl Write,
    answer: impl Fn(&Chunk) -> Answers + Sync,
) -> io::Result<()> {
    let (jobs, queue) = mpsc::channel::<Job>();
    let queue = Mutex::new(queue);
    let work = || {
        while let Some((chunk, answers)) = next(&queue) {
            // The writer has given up where nobody receives.
            let _ = answers.send(answer(&chunk));
        }
    };
    thread::scope(|scope| {
        // Dropped at the end, which ends the threads.
        let jobs = jobs;
        let mut pending = VecDeque::new();
        let mut workers = 0;
        let mut first_line = 1;
        let mut chunks = 0;
        let end = loop {
            let (lines, end) = read(&mut input, if chunks < MANY { CHUNK } else { LARGE_CHUNK });
            chunks += 1;
            if lines.is_empty() {
                break end;
            }
            if workers < threads.get() {
                scope.spawn(work);
                workers += 1;
            }
            let chunk = Chunk { first_line, lines };
            first_line += ends(&chunk.lines);
            let (sender, receiver) = mpsc::sync_channel(1);
            jobs.send((chunk, sender)).map_err(io::Error::other)?;
            pending.push_back(receiver);
            if end.is_err() {
                break end;
            }
            if pending.len() > AHEAD * threads.get() {
                pending.pop_front().map_or(Ok(()), |first| write(&first, &mut output))?;
            }
        };
        for answers in pending {
            write(&answers, &mut output)?;
        }
        output.flush()?;
        end
    })
}

fn next(queue: &Mutex<Receiver<Job>>) -> Option<Job> {
    queue.lock().unwrap_or_else(PoisonError::into_inner).recv().ok()
}

/// Number of lines that end in some bytes. Sums of single bytes, which vector units add side by side, cannot overflow in short pieces.
fn ends(lines: &[u8]) -> usize {
    let in_piece = |piece: &[u8]| usize::from(piece.iter().map(|byte| u8::from(*byte == b'\n')).sum::<u8>());
    lines.chunks(128).map(in_piece).sum()
}

fn write(answers: &Receiver<Answers>, output: &mut impl Write) -> io::Result<()> {
    output.write_all(&answers.recv().map_err(io::Error::other)??)
}

/// The next whole lines, none at the end of the input, and what ended the reading.
fn read(input: &mut impl BufRead, length: u64) -> (Vec<u8>, io::Result<()>) {
    // The last line ends beyond.
    let mut lines = Vec::with_capacity(length as usize + CHUNK as usize / 4);
    let read = input.by_ref().take(length).read_to_end(&mut lines);
    let is_whole = lines.last().is_none_or(|byte| *byte == b'\n');
    let read = match read {
        Ok(_) if !is_whole => input.read_until(b'\n', &mut lines),
        read => read,
    };
    if read.is_err() {
        // Of a line that could not be read to its end nothing is answered.
        let whole = lines.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        lines.truncate(whole);
    }
    (lines, read.map(|_| ()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    fn echo(threads: usize, input: impl BufRead) -> (String, io::Result<()>) {
        let mut out = vec![];
        let threads = NonZero::new(threads).expect("not zero");
        let done = in_order(threads, input, &mut out, |chunk| {
            // The first chunks take longest.
            thread::sleep(std::time::Duration::from_millis(20 / chunk.first_line as u64));
            let lines = String::from_utf8(chunk.lines.clone()).expect("text");
            let numbered = lines.lines().enumerate().map(|(i, line)| format!("{} {line}\n", chunk.first_line + i));
            Ok(numbered.collect::<String>().into_bytes())
        });
        (String::from_utf8(out).expect("text"), done)
    }

    fn words(count: usize) -> (String, String) {
        let word = |i: usize| "word ".repeat(1 + i % 7 * 40);
        let input = (1..=count).map(|i| word(i) + "\n").collect();
        (input, (1..=count).map(|i| format!("{i} {}\n", word(i))).collect())
    }

    #[test]
    fn chunks_are_written_in_order_by_any_number_of_threads() {
        let (input, expected) = words(2000);
        for threads in [1, 2, 7] {
            let (out, done) = echo(threads, input.as_bytes());
            assert!(done.is_ok() && out == expected, "{threads} threads");
            // A last line without its end, and a reader of few bytes at a time.
            let unended = input.trim_end_matches('\n').as_bytes();
            assert!(echo(threads, BufReader::with_capacity(7, unended)).0 == expected, "{threads} threads");
        }
        assert_eq!(echo(2, &b""[..]).0, "");
    }

    /// Fails after its bytes.
    struct Broken<'a>(&'a [u8]);

    impl Read for Broken<'_> {
        fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
            if self.0.is_empty() { Err(io::ErrorKind::ConnectionReset.into()) } else { self.0.read(to) }
        }
    }

    #[test]
    fn lines_before_an_error_are_answered() {
        let (input, expected) = words(300);
        let (out, done) = echo(2, BufReader::new(Broken((input + "half a li").as_bytes())));
        assert_eq!(done.expect_err("broken").kind(), io::ErrorKind::ConnectionReset);
        assert_eq!(out, expected);
    }

    /// Takes a few bytes.
    struct Closed(usize);

    impl Write for Closed {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::BrokenPipe)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn error_in_writing_ends_the_work() {
        let threads = NonZero::new(2).expect("not zero");
        let done =
            in_order(threads, BufReader::new(io::repeat(b'\n')), Closed(100_000), |chunk| Ok(chunk.lines.clone()));
        assert_eq!(done.expect_err("closed").kind(), io::ErrorKind::BrokenPipe);
    }
}
