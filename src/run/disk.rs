//! A thread that writes for the launcher, which waits for no disk while the machine runs. In: what is to be
//! written, through a queue that has a bound. Out: whether the queue took it; at the end, why not all of it
//! was written.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, RecvError, RecvTimeoutError, SyncSender, TrySendError, sync_channel},
    },
    thread::{Builder, JoinHandle},
    time::Duration,
};

use process::ipc::time::{Moment, sleep_until};

/// At the end of a run a disk that takes nothing for so long is given up. One that writes back what others
/// have left it stands for half a minute at times.
pub(crate) const DISK: Duration = Duration::from_secs(60);
/// Between two looks at it.
const POLL: Duration = Duration::from_millis(1);

/// Why not all of it was written.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unwritten {
    /// What the thread says of it.
    #[error("{0}")]
    Failed(String),
    /// See [`DISK`].
    #[error("the disk has not answered for {} s", DISK.as_secs())]
    Stands,
}

/// What the thread is sent.
pub(super) struct News<T> {
    queue: Receiver<T>,
    done: Arc<AtomicU64>,
}

impl<T> News<T> {
    /// The next, when it comes. What came before is done.
    pub(super) fn next(&self) -> Result<T, RecvError> {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.queue.recv()
    }

    /// The same, if it comes in time.
    pub(super) fn next_within(&self, time: Duration) -> Result<T, RecvTimeoutError> {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.queue.recv_timeout(time)
    }
}

/// A thread that writes.
pub(super) struct Disk<T> {
    queue: SyncSender<T>,
    thread: JoinHandle<Result<(), String>>,
    done: Arc<AtomicU64>,
}

impl<T: Send + 'static> Disk<T> {
    /// Starts a thread of this name; so much may wait for it.
    ///
    /// # Errors
    /// The computer has no thread to spare.
    pub(super) fn start(
        name: &str,
        waiting: usize,
        write: impl FnOnce(&News<T>) -> Result<(), String> + Send + 'static,
    ) -> io::Result<Disk<T>> {
        let ((sender, queue), done) = (sync_channel(waiting), Arc::<AtomicU64>::default());
        let news = News { queue, done: Arc::clone(&done) };
        let thread = Builder::new().name(name.into()).spawn(move || write(&news))?;
        Ok(Disk { queue: sender, thread, done })
    }

    /// Hands it to the thread, which may have no place for it now, or have given up.
    pub(super) fn offer(&self, what: T) -> Result<(), TrySendError<T>> {
        self.queue.try_send(what)
    }

    /// Hands over the last, if there is one, and waits until all is written, or nothing of it for so long;
    /// why it is not. The machine rests, but whoever waits for a disk that is gone is not told how the run
    /// has ended.
    pub(super) fn finish(self, last: Option<T>, patience: Duration) -> Result<(), Unwritten> {
        let Disk { queue, thread, done } = self;
        let (mut queue, mut last) = (Some(queue), last);
        let (mut seen, mut since) = (done.load(Ordering::Relaxed), Moment::now());
        while !thread.is_finished() {
            // A thread that has given up takes nothing; a queue that is dropped ends one that has not.
            let sent = last.take().zip(queue.as_ref()).map(|(last, queue)| queue.try_send(last));
            match sent {
                Some(Err(TrySendError::Full(back))) => last = Some(back),
                _ => queue = None,
            }
            let now = done.load(Ordering::Relaxed);
            if now != seen {
                (seen, since) = (now, Moment::now());
            }
            if since.elapsed() > patience {
                return Err(Unwritten::Stands);
            }
            look_again();
        }
        let ended = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        ended.map_err(Unwritten::Failed)
    }
}

/// Sleeps a moment before the next look whether the disk has done something.
pub(super) fn look_again() {
    sleep_until(Moment::in_s(POLL.as_secs_f64()));
}

#[cfg(test)]
#[allow(clippy::disallowed_methods)] // threads, as in the launcher
mod tests {
    use super::*;

    /// A thread whose disk answers when it is told to.
    fn standing() -> (Disk<u32>, SyncSender<()>, Receiver<u32>) {
        let (answers, answer) = sync_channel(0);
        let (sender, written) = sync_channel(16);
        let write = move |news: &News<u32>| {
            while let Ok(number) = news.next() {
                answer.recv().map_err(|_| "gone".to_string())?;
                sender.send(number).map_err(|_| "gone".to_string())?;
            }
            Ok(())
        };
        (Disk::start("disk", 2, write).expect("a thread"), answers, written)
    }

    #[test]
    fn what_has_no_place_comes_back_and_a_disk_that_stands_is_given_up_at_the_end() {
        let (disk, answers, _written) = standing();
        let taken = (0..9).take_while(|number| disk.offer(*number).is_ok()).count();
        assert!((2..=3).contains(&taken), "{taken}");
        assert!(matches!(disk.finish(Some(9), POLL), Err(Unwritten::Stands)));
        drop(answers);
    }

    #[test]
    fn one_that_answers_late_has_all_and_the_last() {
        let (disk, answers, written) = standing();
        let taken: Vec<u32> = (0..9).take_while(|number| disk.offer(*number).is_ok()).collect();
        let all = taken.len() + 1;
        let later = std::thread::spawn(move || (0..all).try_for_each(|_| answers.send(())));
        assert!(disk.finish(Some(9), DISK).is_ok());
        assert!(later.join().expect("it ends").is_ok());
        assert_eq!(written.iter().collect::<Vec<_>>(), [&taken[..], &[9]].concat());
    }

    #[test]
    fn why_it_has_not_written_is_told() {
        let (disk, answers, _written) = standing();
        drop(answers);
        assert!(matches!(disk.finish(Some(1), DISK), Err(Unwritten::Failed(why)) if why == "gone"));
    }
}
