//! What people read in a release: card, data sheet, citation. The texts are templates; the numbers come from the data.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::benchmark::SetSplit;
use l4d_data::scene::Role;
use l4d_data::{Category, DataError, Profile, Query};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, UndefinedBehavior};
use serde::Serialize;
use serde_json::{Value, json};

use crate::contents::{Contents, slug};
use crate::gather::Gathered;
use crate::tables::Table;
use crate::words::{KEYWORDS, is_public};

/// Name in a release, template.
const TEMPLATES: [(&str, &str); 3] = [
    ("README.md", include_str!("../templates/README.md")),
    ("DATASHEET.md", include_str!("../templates/DATASHEET.md")),
    ("CITATION.cff", include_str!("../templates/CITATION.cff")),
];

/// Everything that the templates speak of.
#[derive(Debug)]
pub(crate) struct Documents(Value);

impl Documents {
    /// `archives`: path, bytes, number of files.
    pub(crate) fn new(
        contents: &Contents,
        gathered: &Gathered,
        words: &Value,
        tables: &[Table],
        archives: Vec<(&str, u64, usize)>,
    ) -> Self {
        let queries = || gathered.scenes.iter().flat_map(|scene| &scene.queries);
        let roles = |role| {
            gathered.scenes.iter().flat_map(|scene| scene.instances()).filter(|one| one.role == role).count()
        };
        let categories = Category::ALL.map(|category| {
            let count = queries().filter(|query| query.categories.contains(&category)).count();
            json!({ "name": category, "queries": count })
        });
        let mut groups: BTreeMap<&str, (u64, usize, usize)> = BTreeMap::new();
        for (path, bytes, files) in &archives {
            let group = path.rsplit_once('/').map_or(*path, |(folder, _)| folder);
            let sum = groups.entry(group).or_default();
            *sum = (sum.0 + bytes, sum.1 + files, sum.2 + 1);
        }
        let statuses = gathered.statuses();
        Self(json!({
            "name": contents.name,
            "folder": contents.folder(),
            "version": contents.version,
            "licence": contents.licence,
            "licence_url": licence_url(&contents.licence),
            "hub_licence": contents.licence.to_ascii_lowercase(),
            "is_hub_licence": HUB_LICENCES.contains(&contents.licence.to_ascii_lowercase().as_str()),
            "publication": contents.publication,
            "summary": summary(contents, gathered),
            "keywords": KEYWORDS,
            "split": if is_public(gathered) { split(gathered) } else { "private" },
            "is_public": is_public(gathered),
            "is_dev": gathered.manifest.split == SetSplit::Dev,
            "variant": gathered.manifest.variant,
            "seed": gathered.manifest.seed,
            "scenes": contents.scenes.len(),
            "objects": roles(Role::Object),
            "landmarks": roles(Role::Landmark),
            "statuses": statuses,
            "judged": statuses.judged(),
            "queries": queries().count(),
            "size_category": size_category(queries().count()),
            "composites": gathered.scenes.iter().map(|scene| scene.composites.len()).sum::<usize>(),
            "absents": gathered.scenes.iter().map(|scene| scene.absents.len()).sum::<usize>(),
            "categories": categories,
            "scales": scales(gathered),
            "sources": sources(queries()),
            "profiles": gathered.profiles.iter().map(|&profile| profile_facts(profile)).collect::<Vec<_>>(),
            "renders": contents.renders.as_ref().map(|renders| renders.profile),
            "rounds": contents.rounds,
            "tables": tables.iter().map(Table::card).collect::<Vec<_>>(),
            "archive_groups": groups.iter().map(|(group, (bytes, files, archives))| {
                json!({ "group": group, "bytes": bytes, "files": files, "archives": archives })
            }).collect::<Vec<_>>(),
            "bytes": archives.iter().map(|(_, bytes, _)| bytes).sum::<u64>(),
            "words": words,
            "bibtex": bibtex(contents),
        }))
    }

    /// What the templates speak of, and more.
    pub(crate) fn with(&self, more: Value) -> Value {
        let mut values = self.0.clone();
        if let (Value::Object(values), Value::Object(more)) = (&mut values, more) {
            values.extend(more);
        }
        values
    }

    /// Name and text of each document.
    pub(crate) fn render(&self) -> Result<Vec<(&'static str, String)>, DataError> {
        TEMPLATES.into_iter().map(|(name, template)| Ok((name, render(name, template, &self.0)?))).collect()
    }
}

/// A template with its values. Text that is to be one YAML scalar goes through `quoted`.
pub(crate) fn render(name: &str, template: &str, values: &impl Serialize) -> Result<String, DataError> {
    let refuse = |error: minijinja::Error| {
        let place = format!("line {} of its template", error.line().unwrap_or_default());
        DataError::format(Path::new(name), place, error)
    };
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    let syntax = SyntaxConfig::builder()
        .trim_blocks(true)
        .lstrip_blocks(true)
        .keep_trailing_newline(true)
        .build()
        .map_err(&refuse)?;
    environment.set_syntax(syntax);
    environment.add_filter("quoted", |text: String| Value::from(text).to_string());
    environment.add_filter("share", |value: Option<f64>| {
        value.map_or_else(|| "undefined".to_owned(), |value| format!("{value:.3}"))
    });
    environment.add_filter("size", |bytes: u64| size(bytes));
    environment.add_filter("plural", |count: u64, one: String, many: Option<String>| match (count, many) {
        (1, _) => format!("1 {one}"),
        (_, Some(many)) => format!("{count} {many}"),
        (_, None) => format!("{count} {one}s"),
    });
    environment.render_str(template, Serde(values)).map_err(refuse)
}

/// Bytes for people.
fn size(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["kB", "MB", "GB", "TB"];
    if bytes < 1000 {
        return format!("{bytes} B");
    }
    let mut value = bytes as f64 / 1000.0;
    let mut unit = 0;
    while value >= 999.95 && unit + 1 < UNITS.len() {
        value /= 1000.0;
        unit += 1;
    }
    format!("{value:.1} {}", UNITS[unit])
}

/// Two sentences that say what it is.
pub(crate) fn summary(contents: &Contents, gathered: &Gathered) -> String {
    let statuses = gathered.statuses();
    let verified = match statuses.verified {
        0 => "none of which people have verified".to_owned(),
        all if all == statuses.judged() => "all verified by people".to_owned(),
        some => format!("{some} of them verified by people"),
    };
    format!(
        "{}: a benchmark for 4D language grounding. Given a moving 3D scene and a sentence, which pixels, at which times, from a camera that no one trained on? {} scenes and {} scored queries, {verified}.",
        contents.name,
        contents.scenes.len(),
        statuses.judged(),
    )
}

/// How to cite a release.
pub(crate) fn bibtex(contents: &Contents) -> String {
    let publication = &contents.publication;
    let date = publication.date.to_string();
    format!(
        "@misc{{{key}, title = {{{name} {version}}}, author = {{{authors}}}, year = {{{year}}}, url = {{{url}}}}}",
        key = slug(&contents.name),
        name = contents.name,
        version = contents.version,
        authors = publication.creators.join(" and "),
        year = &date[..4],
        url = publication.url,
    )
}

/// Page of an SPDX licence.
pub(crate) fn licence_url(licence: &str) -> String {
    format!("https://spdx.org/licenses/{licence}.html")
}

/// Licences that the Hugging Face Hub knows by their SPDX name; others are called `other` there.
const HUB_LICENCES: [&str; 8] = [
    "cc-by-4.0",
    "cc-by-sa-4.0",
    "cc-by-nc-4.0",
    "cc-by-nc-sa-4.0",
    "cc0-1.0",
    "mit",
    "apache-2.0",
    "odc-by",
];

/// Splits of the benchmark as loaders call them.
pub(crate) fn split(gathered: &Gathered) -> &'static str {
    match gathered.manifest.split {
        SetSplit::Train => "train",
        SetSplit::Dev => "validation",
        SetSplit::Test | SetSplit::Private => "test",
    }
}

/// The Hub's words for how large a set is.
fn size_category(queries: usize) -> &'static str {
    match queries {
        0..1_000 => "n<1K",
        1_000..10_000 => "1K<n<10K",
        _ => "10K<n<100K",
    }
}

fn scales(gathered: &Gathered) -> Vec<Value> {
    let scale = |scale: l4d_data::Scale| {
        let scenes: Vec<_> = gathered.scenes.iter().filter(|scene| scene.scale == scale).collect();
        (!scenes.is_empty()).then(|| {
            json!({
                "name": scale,
                "scenes": scenes.len(),
                "queries": scenes.iter().map(|scene| scene.queries.len()).sum::<usize>(),
            })
        })
    };
    l4d_data::Scale::ALL.into_iter().filter_map(scale).collect()
}

/// Who wrote the queries -> how many.
fn sources<'a>(queries: impl Iterator<Item = &'a Query>) -> BTreeMap<&'a str, usize> {
    queries.fold(BTreeMap::new(), |mut counts, query| {
        *counts.entry(query.provenance.source.as_str()).or_default() += 1;
        counts
    })
}

fn profile_facts(profile: Profile) -> Value {
    json!({
        "name": profile,
        "is_rendered": profile.is_rendered(),
        "width": profile.width(),
        "height": profile.height(),
        "frames": profile.frames().count(),
        "views": profile.training_views(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_for_people() {
        let shown = [0, 999, 1_000, 999_949, 999_950, 123_456_789, u64::MAX].map(size);
        assert_eq!(shown, ["0 B", "999 B", "1.0 kB", "999.9 kB", "1.0 MB", "123.5 MB", "18446744.1 TB"]);
    }

    #[test]
    fn a_template_that_asks_for_what_is_not_there_is_an_error() {
        let error = render("a.md", "one\n{{ nothing }}", &json!({})).unwrap_err().to_string();
        assert!(error.contains("a.md") && error.contains("line 2"), "{error}");
        assert_eq!(render("a", "{{ x|quoted }}", &json!({ "x": "a: \"b\"\n" })).unwrap(), r#""a: \"b\"\n""#);
    }
}
