//! What is said of the data, in sentences: the same in the data sheet and in the metadata for machines.
//!
//! A sentence that depends on the data is made from it; nothing is claimed that the files do not show.

use l4d_data::benchmark::SetSplit;
use l4d_data::{Profile, Query, Status};
use serde::Serialize;

use crate::contents::Contents;
use crate::gather::Gathered;

/// What the data set is about.
pub(crate) const KEYWORDS: [&str; 6] = [
    "4D language grounding",
    "referring video segmentation",
    "dynamic scenes",
    "Gaussian splatting",
    "synthetic data",
    "benchmark",
];

/// Sentences about the data.
#[derive(Debug, Serialize)]
pub(crate) struct Words {
    pub(crate) collection: String,
    pub(crate) collection_types: Vec<&'static str>,
    pub(crate) raw_data: String,
    pub(crate) missing_data: String,
    pub(crate) preprocessing: Vec<&'static str>,
    pub(crate) annotation: String,
    pub(crate) platform: Vec<&'static str>,
    pub(crate) analysis: Vec<String>,
    pub(crate) annotations_per_item: String,
    pub(crate) demographics: Vec<&'static str>,
    pub(crate) machine_annotation: Vec<&'static str>,
    pub(crate) uses: Vec<&'static str>,
    pub(crate) limitations: Vec<String>,
    pub(crate) biases: Vec<&'static str>,
    pub(crate) social_impact: &'static str,
    pub(crate) personal: Vec<&'static str>,
    pub(crate) maintenance: &'static str,
}

/// How many queries have which status.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Statuses {
    pub(crate) candidate: usize,
    pub(crate) verified: usize,
    pub(crate) rejected: usize,
}

impl Statuses {
    pub(crate) fn of<'a>(queries: impl Iterator<Item = &'a Query>) -> Self {
        queries.fold(Self::default(), |mut counts, query| {
            match query.status {
                Status::Candidate => counts.candidate += 1,
                Status::Verified => counts.verified += 1,
                Status::Rejected => counts.rejected += 1,
            }
            counts
        })
    }

    pub(crate) fn judged(self) -> usize {
        self.candidate + self.verified
    }
}

/// All sentences about a release.
pub(crate) fn of(contents: &Contents, gathered: &Gathered) -> Words {
    let statuses = Statuses::of(gathered.scenes.iter().flat_map(|scene| &scene.queries));
    let captures = gathered.scenes.iter().filter(|scene| scene.tracks.is_none()).count();
    let rendered = gathered.scenes.len() - captures;
    Words {
        collection: collection(rendered, captures),
        collection_types: if captures > 0 {
            vec!["Software Collection", "Manual Human Curator", "Secondary Data analysis"]
        } else {
            vec!["Software Collection", "Manual Human Curator"]
        },
        raw_data: raw_data(contents, captures),
        missing_data: missing_data(gathered),
        preprocessing: vec![
            "Masks are run lengths of the instance ids that one ray through each pixel centre hits: no anti-aliasing, no denoising, no manual correction.",
            "Nothing was filtered out but what a people's vote rejected; rejected queries stay in the files with their status.",
        ],
        annotation: annotation(contents, statuses),
        platform: if contents.rounds.is_empty() {
            Vec::new()
        } else {
            vec!["l4d verify-prompts (terminal application of the project)"]
        },
        analysis: analysis(contents),
        annotations_per_item: annotations_per_item(contents),
        demographics: vec![if contents.rounds.is_empty() {
            "No person has annotated this version."
        } else {
            "Not collected. Annotators go by names that they chose."
        }],
        machine_annotation: vec![
            "Blender (bpy): instance ids and depth, as the renderer computes them",
            "l4d check-queries: a proof over the 3D tracks that a sentence's predicate has exactly one answer among look-alikes, with margins",
        ],
        uses: vec![
            "Testing: comparing methods that ground a sentence in a moving 3D scene, on a held-out camera.",
            "Analysis: what a method confuses, by category of reasoning, spatial scale and time.",
            "Not for training, and not for tuning thresholds where the split is test.",
            "Not as evidence that a method works on recorded scenes.",
        ],
        limitations: limitations(contents, gathered, statuses, rendered),
        biases: vec![
            "Sentences are English, in the style of those who wrote them, and describe everyday scenes as these imagine them.",
            "Look-alikes are placed on purpose: a category name alone never suffices, which is rarer in life than here.",
            "People are simple figures; their looks are drawn by seed and stand for nobody.",
        ],
        social_impact: "None is expected beyond that of the methods that are compared: finding a described person or thing in recordings can be used for surveillance.",
        personal: vec![if captures > 0 {
            "Rendered scenes show no real person or place. Captures were recorded by others; this release holds sentences and masks of them, no picture."
        } else {
            "None: no real person or place is shown or named."
        }],
        maintenance: "A published version never changes; corrections appear as a new one with its own checksums. Semantic versions: major = an answer changed, minor = additions, patch = everything else. Scores name the version that they were made with.",
    }
}

/// Whether anybody can have looked at the truth: somebody's own draw is not published with the benchmark.
pub(crate) fn is_public(gathered: &Gathered) -> bool {
    gathered.manifest.split != SetSplit::Private
}

fn collection(rendered: usize, captures: usize) -> String {
    let mut text = Vec::new();
    if rendered > 0 {
        text.push(format!(
            "{rendered} scenes are synthetic: recipes in Python build geometry, materials and motion procedurally and Blender renders them. Events are recorded by the code that animates them."
        ));
    }
    if captures > 0 {
        text.push(format!("{captures} scenes are captures of others on which people drew object masks."));
    }
    text.join(" ")
}

fn raw_data(contents: &Contents, captures: usize) -> String {
    let pictures = match &contents.renders {
        Some(renders) => format!(
            "Renders of profile {} are part of this release: linear colour, planar depth and instance ids as EXR.",
            renders.profile
        ),
        None => "This release holds no pictures: `l4d build-scenes` renders them from the recipes. Depth and ids come out the same bit for bit; colour differs by up to 4e-5 between processes.".to_owned(),
    };
    let captured = if captures > 0 { " Pictures of captures stay with those who recorded them." } else { "" };
    format!("{pictures}{captured}")
}

fn missing_data(gathered: &Gathered) -> String {
    let profiles: Vec<&str> = gathered.profiles.iter().map(|profile| profile.as_str()).collect();
    let absent: Vec<&str> = Profile::ALL
        .into_iter()
        .filter(|profile| !gathered.profiles.contains(profile))
        .map(Profile::as_str)
        .collect();
    let absent = match absent.is_empty() {
        true => String::new(),
        false => format!(" There is none of {}.", absent.join(", ")),
    };
    format!(
        "Truth is shipped for the profiles {}.{absent} A frame in which an instance shows no pixel has no mask.",
        profiles.join(", ")
    )
}

fn annotation(contents: &Contents, statuses: Statuses) -> String {
    let Statuses { candidate, verified, rejected } = statuses;
    let total = candidate + verified + rejected;
    let machine = "Masks, depth, tracks and events come from the generator, not from people. Sentences were written with a predicate each; a program proves from the tracks that the predicate means exactly the referents.";
    let people = match contents.rounds.len() {
        0 => format!(
            "Whether people read the sentences in the same way has not been tested: of {total} queries, 0 are verified by people."
        ),
        rounds => format!(
            "People who saw a sentence and the scene, and nothing else, pointed at what it means ({rounds} sealed rounds): of {total} queries {verified} are verified, {rejected} rejected and not scored, {candidate} not judged."
        ),
    };
    format!("{machine} {people}")
}

fn analysis(contents: &Contents) -> Vec<String> {
    let number =
        |value: Option<f64>| value.map_or_else(|| "undefined".to_owned(), |value| format!("{value:.3}"));
    let line = |round: &crate::votes::Round| {
        format!(
            "Round {}, rule {}, {} annotators, before anything was left out: of {} prompts {} valid, {} rejected; share of right answers {}; agreement on right or wrong: raw {}, AC1 {}, alpha {}.",
            round.name,
            round.rule,
            round.annotators,
            round.prompts,
            round.valid,
            round.rejected,
            number(round.ceiling),
            number(round.raw),
            number(round.ac1),
            number(round.alpha),
        )
    };
    match contents.rounds.is_empty() {
        true => vec!["No votes of people, so no agreement.".to_owned()],
        false => contents.rounds.iter().map(line).collect(),
    }
}

fn annotations_per_item(contents: &Contents) -> String {
    let counts: std::collections::BTreeSet<usize> =
        contents.rounds.iter().map(|round| round.annotators).collect();
    match counts.len() {
        0 => "0".to_owned(),
        _ => counts.iter().map(usize::to_string).collect::<Vec<_>>().join(", "),
    }
}

fn limitations(contents: &Contents, gathered: &Gathered, statuses: Statuses, rendered: usize) -> Vec<String> {
    let mut all = Vec::new();
    if statuses.verified < statuses.judged() {
        all.push(format!(
            "{} of {} scored queries are not verified by people: a sentence may mean more to a reader than to its predicate.",
            statuses.judged() - statuses.verified,
            statuses.judged()
        ));
    }
    if rendered > 0 {
        all.push("Rendered scenes are stylised and clean: no motion blur, no depth of field, no mirrors, no transparency in anything annotated, no sensor noise.".to_owned());
        all.push("Clips last four seconds, with few events each.".to_owned());
    }
    all.push("One camera of each scene is held out: scores say nothing about other viewpoints.".to_owned());
    if is_public(gathered) {
        all.push("The truth is public. A method could have seen it; a fresh draw of the scenes (`l4d draw-variant`) is the remedy.".to_owned());
    }
    if !gathered.profiles.contains(&Profile::Full) && rendered > 0 {
        all.push("There is no truth at the full resolution of 640x480 in this version.".to_owned());
    }
    if contents.renders.is_none() {
        all.push("Pictures have to be rendered or obtained apart.".to_owned());
    }
    all
}
