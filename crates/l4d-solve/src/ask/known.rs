//! The sentences that the benchmark has about a scene: which one was asked, and which is the nearest to it.

use std::path::{Path, PathBuf};

use l4d_data::{Benchmark, Name, Query, StageError, Status};
use strsim::sorensen_dice;

/// All sentences that the benchmark has about a scene; none without a benchmark.
pub(super) struct Known {
    bench: PathBuf,
    scene: Name,
    pub(super) queries: Vec<Query>,
}

impl Known {
    pub(super) fn read(bench: &Path, scene: &Name) -> Self {
        let queries = Benchmark::open(bench).map_or_else(
            |_| Vec::new(),
            |found| {
                let sets = [found.queries(scene), found.composites(scene), found.absents(scene)];
                sets.into_iter().flatten().flatten().collect()
            },
        );
        Self { bench: bench.to_owned(), scene: scene.clone(), queries }
    }

    /// The number of the query with this sentence.
    pub(super) fn number_of(&self, text: &str) -> Option<Name> {
        let plain = |text: &str| text.trim().trim_end_matches('.').to_lowercase();
        let found = self.queries.iter().find(|query| plain(&query.text) == plain(text));
        found.map(|query| query.id.number.clone())
    }

    /// The sentence that is spelled the most like it, of those that mean something in the scene and can be read.
    pub(super) fn nearest(&self, text: &str, can_be_read: impl Fn(&str) -> bool) -> Option<&str> {
        let means_something =
            |query: &&Query| !query.referents.is_empty() && query.status != Status::Rejected;
        let likeness = |query: &&Query| sorensen_dice(&text.to_lowercase(), &query.text.to_lowercase());
        let can_be_asked = |query: &&Query| means_something(query) && can_be_read(&query.text);
        let candidates = self.queries.iter().filter(can_be_asked);
        candidates.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).map(|query| query.text.as_str())
    }

    /// Why a grounder that answers these sentences alone is not asked another one.
    pub(super) fn refusal(&self, grounder: &str, text: &str) -> StageError {
        let (scene, bench) = (&self.scene, self.bench.display());
        let rule = format!("grounder {grounder} answers only sentences of the benchmark");
        let (message, hint) = match self.nearest(text, |_| true) {
            Some(nearest) => (
                format!("{rule}, and this is none of those about scene {scene}"),
                format!("ask \"{nearest}\", or ask with --grounder panoptic"),
            ),
            None => (
                format!("{rule}, and {bench} has none about scene {scene}"),
                "name the folder of the benchmark with --bench, or ask with --grounder panoptic".to_owned(),
            ),
        };
        StageError::new(message, hint)
    }
}
