//! What changed since a release, and which version that asks for: major = changed answers, minor = additions,
//! patch = everything else.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Report, Status};
use semver::Version;
use serde::Serialize;

use crate::codes;
use crate::contents::{Contents, SceneContents};

/// How far a version has to go up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, strum::Display)]
#[serde(rename_all = "lowercase")]
#[strum(serialize_all = "lowercase")]
pub enum Step {
    /// No answer changed and nothing was added.
    Patch,
    /// Something was added; all earlier answers are what they were.
    Minor,
    /// An answer changed: scores of before and after cannot be compared.
    Major,
}

impl Step {
    /// The lowest version that says so.
    fn after(self, version: &Version) -> Version {
        match self {
            Self::Patch => Version::new(version.major, version.minor, version.patch + 1),
            Self::Minor => Version::new(version.major, version.minor + 1, 0),
            Self::Major => Version::new(version.major + 1, 0, 0),
        }
    }
}

/// One thing that changed.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Change {
    /// What it asks for.
    pub step: Step,
    /// What it is.
    pub what: String,
}

/// Everything that changed between two releases, the gravest first.
pub fn changes(before: &Contents, now: &Contents) -> Vec<Change> {
    let mut found = Vec::new();
    let mut add = |step: Step, what: String| found.push(Change { step, what });
    for (name, pair) in paired(&before.scenes, &now.scenes) {
        match pair {
            (Some(old), Some(new)) => compare_scene(name, old, new, &mut add),
            (Some(_), None) => add(Step::Major, format!("scene {name} was removed")),
            (None, _) => add(Step::Minor, format!("scene {name} was added")),
        }
    }
    let renders = |contents: &Contents| contents.renders.as_ref().map(|renders| renders.profile);
    let renders_of = |contents: &Contents| contents.renders.as_ref().map(|renders| renders.scenes.clone());
    match (renders(before), renders(now)) {
        (old, new) if old == new => {
            if renders_of(before) != renders_of(now) {
                add(Step::Patch, "renders differ".to_owned());
            }
        }
        (old, new) => {
            old.into_iter()
                .for_each(|old| add(Step::Major, format!("renders of profile {old} were removed")));
            new.into_iter().for_each(|new| add(Step::Minor, format!("renders of profile {new} were added")));
        }
    }
    let splats = |contents: &Contents| {
        contents.renders.as_ref().map(|renders| renders.splats.clone()).unwrap_or_default()
    };
    if splats(before) != splats(now) {
        add(Step::Patch, "trained models were added, changed or removed".to_owned());
    }
    let listed = |contents: &Contents| (contents.name.clone(), contents.licence.clone());
    if listed(before) != listed(now) {
        add(Step::Patch, "name or licence changed".to_owned());
    }
    // The manifest holds the version itself, which has to differ.
    let others = |contents: &Contents| {
        let mut files = contents.files.clone();
        files.remove(MANIFEST);
        files
    };
    if before.files.contains_key(MANIFEST) && others(before) != others(now) {
        add(Step::Patch, "files were written anew".to_owned());
    }
    found.sort_by(|a, b| b.step.cmp(&a.step).then_with(|| a.what.cmp(&b.what)));
    found
}

/// The manifest of a benchmark, as releases name it.
pub(crate) const MANIFEST: &str = "benchmark/panoptic-l4d.toml";

fn compare_scene(name: &str, old: &SceneContents, new: &SceneContents, add: &mut impl FnMut(Step, String)) {
    if old.world != new.world {
        add(Step::Major, format!("{name}: tracks, events or cameras changed"));
    }
    for (profile, pair) in paired(&old.truth, &new.truth) {
        let truth = format!("{name}: truth of profile {profile}");
        match pair {
            (Some(old), Some(new)) if old == new => {}
            (Some(_), Some(_)) => add(Step::Major, format!("{truth} changed")),
            (Some(_), None) => add(Step::Major, format!("{truth} was removed")),
            (None, _) => add(Step::Minor, format!("{truth} was added")),
        }
    }
    for (id, pair) in paired(&old.judged(), &new.judged()) {
        match pair {
            (Some(old), Some(new)) if old.meaning != new.meaning => {
                add(Step::Major, format!("query {id} asks something else"));
            }
            (Some(old), Some(new)) if old.status != new.status => {
                let what = match new.status {
                    Status::Verified => "was verified by people",
                    _ => "is no longer verified",
                };
                add(Step::Patch, format!("query {id} {what}"));
            }
            (Some(_), Some(_)) => {}
            (Some(_), None) => add(Step::Major, format!("query {id} is judged no longer")),
            (None, _) => add(Step::Minor, format!("query {id} was added")),
        }
    }
}

/// What each key of two maps means in them.
fn paired<'a, K: Ord, V>(
    before: &'a BTreeMap<K, V>,
    now: &'a BTreeMap<K, V>,
) -> impl Iterator<Item = (&'a K, (Option<&'a V>, Option<&'a V>))> {
    let keys: BTreeSet<&K> = before.keys().chain(now.keys()).collect();
    keys.into_iter().map(|key| (key, (before.get(key), now.get(key))))
}

/// Reports a version that is none, or that does not say what changed since `before`.
pub(crate) fn check(
    manifest: &std::path::Path,
    now: &Contents,
    before: Option<&Contents>,
    changed: &[Change],
    report: &mut Report,
) {
    let mut refuse = |message: String, hint: String| {
        report.error(codes::VERSION, manifest, "field `version`", message, hint);
    };
    let version = match Version::parse(&now.version) {
        Ok(version) => version,
        Err(error) => {
            let message = format!("`{}` is no semantic version: {error}", now.version.escape_debug());
            return refuse(message, "write major.minor.patch, for example 1.0.0".to_owned());
        }
    };
    let Some(before) = before else { return };
    let Ok(old) = Version::parse(&before.version) else {
        return refuse(
            format!("cannot be compared with `{}` of the earlier release", before.version.escape_debug()),
            "name a release that `l4d release` made with --since".to_owned(),
        );
    };
    let Some(step) = changed.iter().map(|change| change.step).max() else {
        if version < old {
            refuse(format!("{version} comes before {old}"), format!("write {old}: nothing changed since"));
        }
        return;
    };
    let lowest = step.after(&old);
    // Of 1.0.0-rc.1 only the part before the hyphen has to be high enough.
    let core = Version::new(version.major, version.minor, version.patch);
    if version <= old || core < lowest {
        let gravest: Vec<&str> =
            changed.iter().filter(|change| change.step == step).map(|change| change.what.as_str()).collect();
        let (shown, more) = gravest.split_at(gravest.len().min(3));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let message = format!("{version} is too low after {old}: {}{more} ({step})", shown.join("; "));
        refuse(message, format!("write {lowest} or higher"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contents::{QueryContents, RenderContents, SCHEMA};
    use std::path::Path;

    use l4d_data::{Name, Profile, QueryId};
    use serde_json::json;

    fn contents(version: &str) -> Contents {
        let query = |meaning: &str, status: &str| json!({ "meaning": meaning, "status": status });
        serde_json::from_value(json!({
            "schema": SCHEMA, "name": "P", "version": version, "licence": "CC0-1.0",
            "publication": { "date": "2026-11-22", "url": "https://example.org", "creators": ["A"] },
            "scenes": { "a": {
                "world": "w",
                "truth": { "tiny": "t" },
                "queries": { "a/001": query("one", "candidate"), "a/002": query("two", "rejected") },
                "composites": {},
                "absents": { "a/901": query("none", "candidate") },
            } },
            "rounds": [], "files": { (MANIFEST): "m", "x": "1" }, "renders": null,
        }))
        .unwrap()
    }

    fn scene(contents: &mut Contents) -> &mut SceneContents {
        contents.scenes.values_mut().next().unwrap()
    }

    fn edited(edit: impl Fn(&mut Contents)) -> Contents {
        let mut now = contents("9.0.0");
        edit(&mut now);
        now
    }

    fn step(edit: impl Fn(&mut Contents)) -> Option<Step> {
        changes(&contents("0.2.0"), &edited(edit)).first().map(|change| change.step)
    }

    fn query<'a>(contents: &'a mut Contents, id: &str) -> &'a mut QueryContents {
        scene(contents).queries.get_mut(&id.parse::<QueryId>().unwrap()).unwrap()
    }

    #[test]
    fn each_change_asks_for_its_step() {
        let other = |text: &mut String| "other".clone_into(text);
        assert_eq!(step(|_| {}), None);
        assert_eq!(step(|now| other(now.files.get_mut(MANIFEST).unwrap())), None, "it holds the version");
        assert_eq!(step(|now| other(now.files.get_mut("x").unwrap())), Some(Step::Patch));
        assert_eq!(step(|now| other(&mut now.licence)), Some(Step::Patch));
        assert_eq!(step(|now| query(now, "a/001").status = Status::Verified), Some(Step::Patch));
        assert_eq!(step(|now| query(now, "a/001").status = Status::Rejected), Some(Step::Major));
        assert_eq!(step(|now| query(now, "a/002").status = Status::Candidate), Some(Step::Minor));
        assert_eq!(step(|now| other(&mut query(now, "a/002").meaning)), None, "it is not asked");
        assert_eq!(step(|now| other(&mut query(now, "a/001").meaning)), Some(Step::Major));
        assert_eq!(step(|now| scene(now).world = None), Some(Step::Major));
        assert_eq!(step(|now| other(scene(now).truth.get_mut(&Profile::Tiny).unwrap())), Some(Step::Major));
        assert_eq!(step(|now| scene(now).truth.clear()), Some(Step::Major));
        assert_eq!(step(|now| scene(now).absents.clear()), Some(Step::Major));
        assert_eq!(step(|now| now.scenes.clear()), Some(Step::Major));
        let more = |now: &mut Contents| drop(scene(now).truth.insert(Profile::Full, "f".to_owned()));
        assert_eq!(step(more), Some(Step::Minor));
        let added = |now: &mut Contents| {
            let copy = scene(now).clone();
            now.scenes.insert(Name::new("b").unwrap(), copy);
        };
        assert_eq!(step(added), Some(Step::Minor));
        let both = edited(|now| {
            added(now);
            scene(now).world = None;
        });
        let found = changes(&contents("0.2.0"), &both);
        assert_eq!(
            (found[0].step, found.last().unwrap().step),
            (Step::Major, Step::Minor),
            "the gravest first"
        );
    }

    #[test]
    fn renders_that_are_gone_are_missed() {
        let with = |profile: Option<Profile>, digest: &str| {
            let scenes = BTreeMap::from([(Name::new("a").unwrap(), digest.to_owned())]);
            let mut contents = contents("0.2.0");
            contents.renders =
                profile.map(|profile| RenderContents { profile, scenes, splats: BTreeMap::new() });
            contents
        };
        let steps = |before: &Contents, now: &Contents| -> Vec<Step> {
            changes(before, now).iter().map(|change| change.step).collect()
        };
        let (none, tiny) = (with(None, ""), with(Some(Profile::Tiny), "1"));
        assert_eq!(steps(&none, &tiny), [Step::Minor]);
        assert_eq!(steps(&tiny, &with(Some(Profile::Tiny), "2")), [Step::Patch]);
        assert_eq!(steps(&tiny, &with(Some(Profile::Full), "1")), [Step::Major, Step::Minor]);
        assert_eq!(steps(&tiny, &none), [Step::Major]);
    }

    #[test]
    fn a_version_says_at_least_what_changed() {
        let verdict = |old: &str, new: &str, step: Option<Step>| {
            let changed: Vec<Change> =
                step.into_iter().map(|step| Change { step, what: "it".to_owned() }).collect();
            let mut report = Report::default();
            check(Path::new("m"), &contents(new), Some(&contents(old)), &changed, &mut report);
            report.into_sorted().first().map(|finding| finding.hint.clone())
        };
        let asks = |hint: &str| Some(format!("write {hint} or higher"));
        assert_eq!(verdict("1.2.3", "1.2.3", None), None);
        assert_eq!(verdict("1.2.3", "1.2.3", Some(Step::Patch)), asks("1.2.4"));
        assert_eq!(verdict("1.2.3", "1.2.4", Some(Step::Patch)), None);
        assert_eq!(verdict("1.2.3", "1.2.4", Some(Step::Minor)), asks("1.3.0"));
        assert_eq!(verdict("1.2.3", "1.10.0", Some(Step::Minor)), None);
        assert_eq!(verdict("1.2.3", "1.3.0", Some(Step::Major)), asks("2.0.0"));
        assert_eq!(verdict("0.2.0", "0.3.0", Some(Step::Major)), asks("1.0.0"));
        assert_eq!(verdict("1.2.3", "2.0.0-rc.1", Some(Step::Major)), None);
        assert_eq!(verdict("2.0.0-rc.1", "2.0.0-rc.1", Some(Step::Patch)), asks("2.0.1"));
        assert_eq!(verdict("1.2.3", "3.0.0", Some(Step::Patch)), None, "higher is always allowed");
        assert!(verdict("1.2.3", "1.2", None).is_some(), "two numbers are no version");
        assert!(verdict("1.2.3", "1.2.2", None).is_some(), "back in time");
    }
}
