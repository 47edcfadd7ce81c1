//! What was asked of a process and what came of it so far. One thread reads the worker's lines into it, others wait.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use l4d_frames::Mask;

use super::error::WorkerError;
use super::protocol::{Hello, MaskLine, PROTOCOL, Said};

/// More objects than anybody looks at.
const MOST_OBJECTS: usize = 64;
/// Lines of stderr that are kept for an error.
const TAIL_LINES: usize = 12;
/// Remarks about one answer that are kept.
const MOST_REMARKS: usize = 16;

/// What a worker found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// Number of the object -> what was found of it.
    pub objects: BTreeMap<u32, Found>,
    /// Steps that the worker had to leave out, in its words.
    pub skipped: Vec<String>,
}

/// One object over the frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Found {
    /// Index of the frame -> its mask. A frame without one does not show it.
    pub masks: BTreeMap<u32, Mask>,
    /// Highest score in any frame; none if the worker gives none.
    pub score: Option<f64>,
}

/// Why a process is of no use any more.
#[derive(Debug, Clone)]
pub(super) enum End {
    /// Its output ended.
    Closed,
    /// It said what cannot be.
    Broken(String),
    /// It did this for so long.
    Hung(&'static str, Duration),
}

/// A request that waits for its answer.
#[derive(Debug)]
pub(super) struct Pending {
    width: u32,
    height: u32,
    range: [u32; 2],
    answer: Answer,
    /// When everything before it was answered.
    pub(super) turn_since: Option<Instant>,
    pub(super) result: Option<Result<(), Failure>>,
}

/// How one request failed while the process goes on.
#[derive(Debug)]
pub(super) enum Failure {
    /// The worker's own error.
    Refused { kind: String, message: String },
    /// An answer that is of no use.
    Useless(String),
}

/// Everything that the reading thread and the waiting ones share.
#[derive(Debug)]
pub(super) struct Book {
    pub(super) hello: Option<Hello>,
    pub(super) pending: BTreeMap<u64, Pending>,
    /// Highest id that was asked.
    highest: u64,
    pub(super) last_heard: Instant,
    pub(super) end: Option<End>,
    tail: VecDeque<String>,
}

impl Book {
    pub(super) fn new() -> Self {
        Self {
            hello: None,
            pending: BTreeMap::new(),
            highest: 0,
            last_heard: Instant::now(),
            end: None,
            tail: VecDeque::new(),
        }
    }

    pub(super) fn open(&mut self, id: u64, (width, height): (u32, u32), range: [u32; 2]) {
        self.highest = self.highest.max(id);
        let answer = Answer::default();
        self.pending.insert(id, Pending { width, height, range, answer, turn_since: None, result: None });
    }

    /// Takes the answer of a request that has come to its end.
    pub(super) fn close(&mut self, id: u64, worker: &str) -> Option<Result<Answer, WorkerError>> {
        self.pending.get(&id)?.result.as_ref()?;
        let pending = self.pending.remove(&id)?;
        let worker = worker.to_owned();
        Some(match pending.result? {
            Ok(()) => Ok(pending.answer),
            Err(Failure::Refused { kind, message }) => Err(WorkerError::Refused { worker, kind, message }),
            Err(Failure::Useless(message)) => Err(WorkerError::Answer { worker, message }),
        })
    }

    /// Takes note of a line. An error means that the process can't be trusted any more.
    pub(super) fn note(&mut self, said: Said) -> Result<(), String> {
        self.last_heard = Instant::now();
        if self.hello.is_none() && !matches!(said, Said::Hello(_) | Said::Alive) {
            return Err("it answers before its hello".to_owned());
        }
        match said {
            Said::Alive => Ok(()),
            Said::Hello(hello) => self.greet(*hello),
            Said::Mask(line) => {
                if let Some(pending) = self.waiting(line.id)?
                    && let Err(message) = pending.take(&line)
                {
                    pending.result = Some(Err(Failure::Useless(message)));
                }
                Ok(())
            }
            Said::Done { id, skipped } => {
                if let Some(pending) = self.waiting(id)? {
                    let tamed =
                        skipped.iter().take(MOST_REMARKS).map(|remark| crate::plan::clean(remark, 200));
                    pending.answer.skipped = tamed.collect();
                    pending.result = Some(Ok(()));
                }
                Ok(())
            }
            Said::Failed { id, kind, message } => {
                if let Some(pending) = self.waiting(id)? {
                    let (kind, message) = (crate::plan::clean(&kind, 40), crate::plan::clean(&message, 500));
                    pending.result = Some(Err(Failure::Refused { kind, message }));
                }
                Ok(())
            }
        }
    }

    /// Whether a request waits that the process should be working on; starts its clock when its turn comes.
    pub(super) fn is_turn_of(&mut self, id: u64) -> Option<Instant> {
        let (oldest, pending) = self.pending.iter_mut().find(|(_, pending)| pending.result.is_none())?;
        (*oldest == id).then(|| *pending.turn_since.get_or_insert_with(Instant::now))
    }

    pub(super) fn note_talk(&mut self, line: String) {
        if self.tail.len() == TAIL_LINES {
            self.tail.pop_front();
        }
        self.tail.push_back(line);
    }

    pub(super) fn tail(&self) -> String {
        self.tail.iter().map(String::as_str).collect::<Vec<_>>().join("\n")
    }

    fn greet(&mut self, hello: Hello) -> Result<(), String> {
        if self.hello.is_some() {
            return Err("it says hello twice".to_owned());
        }
        if hello.protocol != PROTOCOL {
            return Err(format!(
                "it speaks version {} of the protocol, l4d speaks {PROTOCOL}",
                hello.protocol
            ));
        }
        self.hello = Some(hello);
        Ok(())
    }

    /// The request of this id; none if it was answered or given up before, in which case late lines are no harm.
    fn waiting(&mut self, id: u64) -> Result<Option<&mut Pending>, String> {
        if id > self.highest {
            return Err(format!("it answers request {id}, which nobody asked"));
        }
        Ok(self.pending.get_mut(&id).filter(|pending| pending.result.is_none()))
    }
}

impl Pending {
    fn take(&mut self, line: &MaskLine) -> Result<(), String> {
        let [first, last] = self.range;
        if !(first..=last).contains(&line.frame) {
            return Err(format!("a mask of frame {}, asked were {first} to {last}", line.frame));
        }
        let mask = line.rle.decode(self.width, self.height)?;
        let is_new = !self.answer.objects.contains_key(&line.object);
        if is_new && self.answer.objects.len() == MOST_OBJECTS {
            return Err(format!("more than {MOST_OBJECTS} objects"));
        }
        let found = self.answer.objects.entry(line.object).or_default();
        if found.masks.insert(line.frame, mask).is_some() {
            return Err(format!("two masks of object {} in frame {}", line.object, line.frame));
        }
        found.score = match (found.score, line.score) {
            (Some(before), Some(score)) => Some(before.max(score)),
            (before, score) => before.or(score),
        };
        Ok(())
    }
}
