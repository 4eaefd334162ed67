//! Work on several threads, in an order that does not depend on them.

use std::thread;

/// What a function makes of items, in their order.
pub(super) fn parallel<T: Sync, R: Send>(items: &[T], threads: usize, make: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let share = items.len().div_ceil(threads.max(1)).max(1);
    let make = &make;
    thread::scope(|scope| {
        let start = |few: &'_ [T]| few.iter().map(make).collect::<Vec<_>>();
        let workers: Vec<_> = items.chunks(share).map(|few| scope.spawn(move || start(few))).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined.flat_map(|made| made.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    })
}
