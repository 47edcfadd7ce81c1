//! Work on many items at once, with results in the order of the items.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// Does work for each item, `jobs` at once.
///
/// # Errors
/// The first error in the order of the items; after an error nothing more is begun.
pub fn in_parallel<T: Sync, R: Send, E: Send>(
    items: &[T],
    jobs: usize,
    work: impl Fn(&T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let next = AtomicUsize::new(0);
    let has_failed = AtomicBool::new(false);
    let done: Vec<Mutex<Option<Result<R, E>>>> = items.iter().map(|_| Mutex::new(None)).collect();
    thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, items.len().max(1)) {
            scope.spawn(|| {
                while !has_failed.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some((item, slot)) = items.get(index).zip(done.get(index)) else { return };
                    let result = work(item);
                    has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
                    if let Ok(mut slot) = slot.lock() {
                        *slot = Some(result);
                    }
                }
            });
        }
    });
    done.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..40).collect();
        let doubled = in_parallel(&items, 4, |&item| {
            thread::sleep(std::time::Duration::from_micros(500 * (item % 3)));
            Ok::<u64, ()>(2 * item)
        });
        assert_eq!(doubled.unwrap(), items.iter().map(|item| 2 * item).collect::<Vec<_>>());
    }

    #[test]
    fn the_first_error_ends_it() {
        let begun = AtomicUsize::new(0);
        let result: Result<Vec<()>, u32> = in_parallel(&[1, 2, 3, 4], 1, |&item| {
            begun.fetch_add(1, Ordering::Relaxed);
            if item == 2 { Err(item) } else { Ok(()) }
        });
        assert_eq!((result, begun.into_inner()), (Err(2), 2));
    }
}
