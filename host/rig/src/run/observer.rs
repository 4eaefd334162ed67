//! Observer of a session by hand. In real time it works on a separate thread: a solved pose would delay an order on its way to the wire.

use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use super::recording::{Bench, Moment, Recording};
use crate::link::Event;
use crate::record::{Body, InjectedFault, Posture, Sample};

/// Moments on their way to the thread. With more, the session waits.
const WAITING: usize = 64;

/// Latest observations since the last look.
#[derive(Default)]
pub(super) struct Look {
    pub(super) sample: Option<Sample>,
    pub(super) body: Option<Body>,
    pub(super) posture: Option<Posture>,
}

impl Look {
    /// Adds later observations.
    fn add(&mut self, later: Self) {
        self.sample = later.sample.or(self.sample.take());
        self.body = later.body.or(self.body.take());
        self.posture = later.posture.or(self.posture.take());
    }
}

/// Entry of the record.
pub(super) enum Note {
    Moment(Box<Moment>),
    OnPurpose(InjectedFault),
}

/// Records events, and returns the observations.
pub(super) enum Observer<'o, 'a> {
    Here(&'o mut Recording<'a>, Box<Look>),
    Beside(SyncSender<Note>, &'o Mutex<Look>),
}

impl Observer<'_, '_> {
    /// Takes an event of the link.
    pub(super) fn take(&mut self, device: &mut impl Bench, event: Event) {
        self.note(Note::Moment(Box::new(Moment::of(device, event))));
    }

    /// Notes a fault that was injected now.
    pub(super) fn on_purpose(&mut self, fault: InjectedFault) {
        self.note(Note::OnPurpose(fault));
    }

    fn note(&mut self, note: Note) {
        match self {
            Self::Here(recording, look) => look.add(recorded(recording, note)),
            // The thread ends after this.
            Self::Beside(notes, _) => {
                let _ = notes.send(note);
            }
        }
    }

    /// The observations since the last call.
    pub(super) fn look(&mut self) -> Look {
        match self {
            Self::Here(_, look) => std::mem::take(look.as_mut()),
            Self::Beside(_, look) => std::mem::take(&mut *lock(look)),
        }
    }
}

/// Runs a session with an observer on a separate thread, or on this one.
pub(super) fn observing<'a, R>(
    recording: &mut Recording<'a>,
    is_beside: bool,
    session: impl FnOnce(&mut Observer<'_, 'a>) -> R,
) -> R {
    if !is_beside {
        return session(&mut Observer::Here(recording, Box::default()));
    }
    let look = Mutex::new(Look::default());
    thread::scope(|scope| {
        let (notes, taken) = sync_channel(WAITING);
        let shared = &look;
        scope.spawn(move || {
            for note in taken {
                let later = recorded(recording, note);
                lock(shared).add(later);
            }
        });
        session(&mut Observer::Beside(notes, shared))
    })
}

fn recorded(recording: &mut Recording<'_>, note: Note) -> Look {
    match note {
        Note::Moment(moment) => {
            let sample = recording.observe(*moment);
            Look { sample, body: recording.take_body(), posture: recording.take_posture() }
        }
        Note::OnPurpose(fault) => {
            recording.on_purpose(&fault);
            Look::default()
        }
    }
}

fn lock(look: &Mutex<Look>) -> MutexGuard<'_, Look> {
    // Nothing panics while it is locked.
    look.lock().unwrap_or_else(PoisonError::into_inner)
}
