//! The proof that each query has exactly one answer, over a set of scenes, and the count of the set.
//!
//! Everything is decided from the tracks; whether a referent can be seen comes from the truth file, where there is
//! one. Findings L4D2xx are listed in `docs/findings.md`.

mod agree;
mod query;
mod real;
mod scene;
mod vocabulary;
mod wording;

use l4d_data::benchmark::SetSplit;
use l4d_data::{Benchmark, Name, Profile, Report};

pub(crate) use agree::path_length_m;
pub use query::{COMPOSITES, Kind, Prover};
use real::RealSet;
use scene::check_each_is_asked;
pub(crate) use scene::predicate_of;
pub use scene::{SceneSet, check_scene, meaning, verbs as plain_events};
pub use vocabulary::Vocabulary;
pub use wording::{form_problem, says_when, wording_problem, words};

use crate::probes::{self, Probe};
use crate::summary::SetSummary;

/// Scenes of the complete benchmark: shortcuts are bounded from here on.
const COMPLETE_SCENES: usize = 21;

/// Checks the queries of the scenes, measures shortcuts, and counts the set.
pub fn check_set(bench: &Benchmark, profile: Profile, scenes: &[Name], report: &mut Report) -> SetSummary {
    if !profile.is_rendered() {
        return check_real(bench, scenes, report);
    }
    let vocabulary = Vocabulary::read(&bench.dir.vocabulary());
    if let Err(error) = &vocabulary {
        report.data_error("L4D201", error);
    }
    let vocabulary = vocabulary.ok().flatten();
    let mut sets = Vec::new();
    for scene in scenes {
        if let Some(set) = SceneSet::read(bench, profile, scene, report) {
            check_scene(&set, vocabulary.as_ref(), report);
            // In another draw some sentences lose their meaning, and with them some objects their only query.
            if bench.manifest.split == SetSplit::Test {
                check_each_is_asked(&set, report);
            }
            sets.push(set);
        }
    }
    let mut summary = SetSummary::count(sets.iter().map(SceneSet::counted));
    summary.probes = probes::measure(&sets);
    if bench.manifest.split == SetSplit::Test && scenes.len() >= COMPLETE_SCENES {
        report_shortcuts(bench, &summary.probes, report);
    }
    summary
}

/// The same for real scenes, as far as anything can be checked without tracks.
fn check_real(bench: &Benchmark, scenes: &[Name], report: &mut Report) -> SetSummary {
    let sets: Vec<RealSet> = scenes.iter().filter_map(|scene| RealSet::read(bench, scene, report)).collect();
    sets.iter().for_each(|set| set.check(report));
    SetSummary::count(sets.iter().map(RealSet::counted))
}

fn report_shortcuts(bench: &Benchmark, probes: &[Probe], report: &mut Report) {
    for probe in probes.iter().filter(|probe| probe.is_beyond()) {
        let Probe { name, accuracy, chance, .. } = probe;
        let message =
            format!("picks the referent in {accuracy:.1} % of the queries, chance is {chance:.1} %");
        let hint = "let other members of the group be the referent, or change what they do";
        let folder = bench.root().join("queries");
        report.error("L4D230", &folder, format!("shortcut {name}"), message, hint);
    }
}

#[cfg(test)]
mod tests;
