//! What a protocol says of one query, and what it leaves out.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

/// A mean over frames of one query, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// The mean.
    pub mean: f64,
    /// Frames that it rests on.
    pub frames: u64,
}

impl Value {
    /// The mean of some values; none without any.
    pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut frames = 0;
        let mean = crate::metrics::mean(values.into_iter().inspect(|_| frames += 1))?;
        Some(Self { mean, frames })
    }

    /// The share of frames for which something holds.
    pub fn share(values: impl IntoIterator<Item = bool>) -> Option<Self> {
        Self::mean(values.into_iter().map(|holds| f64::from(u8::from(holds))))
    }

    /// A number that is of the whole clip.
    pub fn whole(mean: f64, frames: usize) -> Self {
        Self { mean, frames: frames as u64 }
    }
}

/// What the source leaves out or counts without an answer, and how much of it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LeftOut {
    /// In words.
    pub what: Cow<'static, str>,
    /// Queries that are concerned.
    pub queries: u64,
    /// Frames that are concerned.
    pub frames: u64,
}

/// What a protocol says of one query.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Judged {
    /// One value a measure of the protocol; none where the query has none.
    pub values: Vec<Option<Value>>,
    /// What was left out.
    pub left_out: Vec<LeftOut>,
}

impl Judged {
    /// Values without anything left out.
    pub fn new(values: impl IntoIterator<Item = Option<Value>>) -> Self {
        Self { values: values.into_iter().collect(), left_out: Vec::new() }
    }

    /// Tells that frames were left out, if there were any.
    pub fn leaving_out(mut self, what: &'static str, frames: usize) -> Self {
        if frames > 0 {
            self.left_out.push(LeftOut { what: what.into(), queries: 1, frames: frames as u64 });
        }
        self
    }
}
