//! What was found in the latest clips, so that the questions about a scene look at it once.

use std::sync::{Arc, Mutex, PoisonError};

use crate::clip::ViewClip;

/// Clips whose findings are kept: the views of one scene and some more.
const MOST_CLIPS: usize = 16;

/// Findings of the latest clips by digest, the latest last.
#[derive(Debug)]
pub(crate) struct Remembered<T>(Mutex<Vec<(String, Arc<T>)>>);

impl<T> Default for Remembered<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Remembered<T> {
    /// What is known of a clip, found by `find` the first time.
    pub(crate) fn of<E>(&self, clip: &ViewClip, find: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let digest = clip.digest();
        // A panic elsewhere leaves nothing half-written here.
        let entries = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = entries().iter().find(|(key, _)| *key == digest) {
            return Ok(Arc::clone(known));
        }
        let found = Arc::new(find()?);
        let mut entries = entries();
        if entries.len() >= MOST_CLIPS {
            entries.remove(0);
        }
        entries.push((digest, Arc::clone(&found)));
        Ok(found)
    }
}
