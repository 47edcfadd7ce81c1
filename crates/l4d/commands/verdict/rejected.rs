//! `rejected.png`: each rejected prompt beside pictures of its scene, as far as that is rendered.

use std::collections::BTreeMap;

use anyhow::Result;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::truth::Truth;
use l4d_data::{Benchmark, Name, Workspace};
use l4d_frames::overlay::marks;
use l4d_frames::sheet::{Card, MOST_CARDS, Shot, cards, save};
use l4d_votes::Judged;
use l4d_votes::{ItemVerdict, Outcome};

use crate::cli::annotation::VerdictArgs;
use crate::out::Printer;

/// Draws the sheet; false where there is nothing to show, which it says.
pub(super) fn draw(args: &VerdictArgs, judged: &Judged, bench: &Benchmark, out: &Printer) -> Result<bool> {
    let rejected: Vec<&ItemVerdict> =
        judged.verdicts.items.iter().filter(|verdict| verdict.outcome == Outcome::Rejected).collect();
    if rejected.is_empty() {
        return Ok(false);
    }
    if !judged.round.profile.is_rendered() {
        out.note("rejected.png was not drawn: it shows rendered scenes");
        return Ok(false);
    }
    let space = Workspace::new(judged.round.profile, bench.manifest.draw()).with_data(args.data.as_deref());
    let data = space.data();
    let mut stages: BTreeMap<&Name, Stage> = BTreeMap::new();
    for verdict in &rejected {
        let scene = &verdict.query.scene;
        let dir = space.scene(scene);
        if !stages.contains_key(scene) && dir.scene().is_file() {
            let truth = bench.dir.truth(judged.round.profile, scene);
            let truth = truth.exists().then(|| bench.truth(judged.round.profile, scene)).transpose()?;
            stages.insert(scene, Stage { scene: Scene::read(&dir.scene())?, dir, truth });
        }
    }
    if stages.is_empty() {
        out.note(format!("rejected.png was not drawn: no scene of it is rendered in {}", data.display()));
        return Ok(false);
    }
    let shown = &rejected[..rejected.len().min(MOST_CARDS)];
    if shown.len() < rejected.len() {
        out.note(format!("rejected.png shows the first {} of {}", shown.len(), rejected.len()));
    }
    let page: Vec<Card<'_>> =
        shown.iter().map(|verdict| card(verdict, stages.get(&verdict.query.scene))).collect();
    let missing = page.iter().filter(|card| card.shots.is_empty()).count();
    if missing > 0 {
        out.note(format!(
            "rejected.png lacks pictures for {missing} prompts: not rendered in {}",
            data.display()
        ));
    }
    let kind = if judged.round.simulated { ", simulated votes" } else { "" };
    let heading = format!(
        "Rejected in round {}{kind}: {} of {}",
        judged.round.name,
        rejected.len(),
        judged.verdicts.items.len()
    );
    save(&cards(&heading, &page)?, &judged.dir.rejected())?;
    Ok(true)
}

/// A rendered scene.
struct Stage {
    scene: Scene,
    dir: SceneDir,
    truth: Option<Truth>,
}

impl Stage {
    /// The view that shows most of the referents at two frames, with these frames.
    fn shots(&self, verdict: &ItemVerdict) -> Vec<Shot<'_>> {
        let held: Vec<u32> = self
            .scene
            .profile
            .frames()
            .filter(|frame| verdict.meaning.frames.iter().any(|interval| interval.contains(*frame)))
            .collect();
        let frames = [held.get(held.len() / 4), held.get(3 * held.len() / 4)].into_iter().flatten();
        let Some(view) = self.best_view(verdict, &held) else { return Vec::new() };
        let is_there = |frame: &u32| self.dir.frame(view, *frame).is_file();
        let shot = |frame: u32| Shot { scene: &self.scene, dir: &self.dir, view, frame };
        frames.copied().filter(is_there).map(shot).collect()
    }

    fn best_view(&self, verdict: &ItemVerdict, held: &[u32]) -> Option<&Name> {
        let pixels = |view: &Name| -> u64 {
            let Some((truth, counts)) =
                self.truth.as_ref().and_then(|truth| Some((truth, truth.visible.get(view)?)))
            else {
                return 0;
            };
            let seen = verdict.meaning.referents.iter().filter_map(|name| counts.get(name));
            let at_held = |counts: &Vec<u32>| -> u64 {
                let frames = truth.frames.iter().zip(counts);
                frames.filter(|(frame, _)| held.contains(frame)).map(|(_, count)| u64::from(*count)).sum()
            };
            seen.map(at_held).sum()
        };
        // Of equals the held-out view, whose masks are scored.
        let held_out = self.scene.test_camera();
        let cameras = self.scene.cameras.iter().chain(held_out);
        cameras.max_by_key(|camera| pixels(&camera.name)).map(|camera| &camera.name)
    }

    /// `3 hen_pecking`: the number on the pictures and the name.
    fn label(&self, name: &Name) -> String {
        let marks = marks(&self.scene.instances);
        let place = self.scene.instances.iter().position(|instance| instance.name == *name);
        place.map_or_else(|| name.to_string(), |place| format!("{} {name}", marks[place].number))
    }
}

fn card<'a>(verdict: &ItemVerdict, stage: Option<&'a Stage>) -> Card<'a> {
    let label = |name: &Name| stage.map_or_else(|| name.to_string(), |stage| stage.label(name));
    let meant: Vec<String> = verdict.meaning.referents.iter().map(label).collect();
    let mut lines = vec![
        format!("{}   votes {}", verdict.query, verdict.pattern()),
        format!("meant: {}", meant.join(", ")),
    ];
    lines.extend(verdict.reasons.iter().cloned());
    for vote in &verdict.votes {
        lines.extend(vote.comments.iter().map(|text| format!("{} remarks: {text}", vote.annotator)));
    }
    Card {
        shots: stage.map(|stage| stage.shots(verdict)).unwrap_or_default(),
        title: verdict.text.clone(),
        lines,
    }
}
