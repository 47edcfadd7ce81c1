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
pub use wording::{form_problem, says_when, words};

use crate::probes::{self, Probe};
use crate::rules;
use crate::summary::SetSummary;

/// Scenes of the complete benchmark: what is demanded of the set holds from here on.
pub const COMPLETE_SCENES: usize = 21;

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
    let mut summary = SetSummary::count(&sets);
    summary.probes = probes::measure(&sets);
    if bench.manifest.split == SetSplit::Test {
        summary.rules = rules::measure(&sets, &summary);
        if scenes.len() >= COMPLETE_SCENES {
            report_set(bench, &summary, report);
        }
    }
    summary
}

/// The same for real scenes, as far as anything can be checked without tracks.
fn check_real(bench: &Benchmark, scenes: &[Name], report: &mut Report) -> SetSummary {
    let sets: Vec<RealSet> = scenes.iter().filter_map(|scene| RealSet::read(bench, scene, report)).collect();
    sets.iter().for_each(|set| set.check(report));
    SetSummary::of_written(&sets.iter().map(RealSet::written).collect::<Vec<_>>())
}

fn report_set(bench: &Benchmark, summary: &SetSummary, report: &mut Report) {
    let folder = bench.root().join("queries");
    for probe in summary.probes.iter().filter(|probe| probe.is_beyond()) {
        let Probe { name, accuracy, chance, .. } = probe;
        let message =
            format!("picks the referent in {accuracy:.1} % of the queries, chance is {chance:.1} %");
        let hint = "let other members of the group be the referent, or change what they do";
        report.error("L4D230", &folder, format!("shortcut {name}"), message, hint);
    }
    for rule in summary.rules.iter().filter(|rule| !rule.is_met()) {
        let message = format!("{} of {}", rule.found, rule.demand());
        if rule.is_met_as_written() {
            let message = format!("{message}: people rejected {}", rule.rejected);
            let hint = "edit what they rejected and ask again with `l4d open-round --from ROUND`";
            report.warning("L4D231", &folder, rule.name, message, hint);
        } else {
            report.error("L4D231", &folder, rule.name, message, "see docs/queries.md, The set");
        }
    }
}

#[cfg(test)]
mod tests;
