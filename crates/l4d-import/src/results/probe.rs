//! What a folder looks like: which presets find files in it, and why.

use std::path::Path;

use l4d_data::{DataError, Report};
use l4d_formats::arrays;
use serde::Serialize;

use super::codec::Codec;
use super::preset::Preset;
use super::template::{Captures, Hit, Template};

/// A preset that fits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Recognised {
    /// Its name.
    pub preset: String,
    /// What it is for.
    pub title: String,
    /// Files that its template finds.
    pub files: usize,
    /// Sentences for people: what was seen, and what would be needed.
    pub why: Vec<String>,
}

/// Presets that find something below a folder, those with most files first.
///
/// # Errors
/// A folder that cannot be listed.
pub fn probe(root: &Path) -> Result<Vec<Recognised>, DataError> {
    let mut found = Vec::new();
    for preset in Preset::built_in()? {
        let Ok(template) = Template::parse(&preset.template) else { continue };
        let mut report = Report::default();
        let hits = template.find(root, &Captures::new(), &mut report)?;
        let ignored = |hit: &Hit| {
            let name = hit.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            preset.ignore.iter().any(|beginning| name.starts_with(beginning.as_str()))
        };
        let hits: Vec<Hit> = hits.into_iter().filter(|hit| !ignored(hit)).collect();
        if hits.is_empty() {
            continue;
        }
        let mut why = vec![format!("{} files at {template}", hits.len())];
        why.extend(template.fields().iter().map(|field| values(field, &hits)));
        why.extend(needs(&preset, &hits[0]));
        if !report.is_empty() {
            why.push(format!("{} links were not followed", report.len()));
        }
        found.push(Recognised { preset: preset.name, title: preset.title, files: hits.len(), why });
    }
    found.sort_by_key(|recognised| std::cmp::Reverse(recognised.files));
    Ok(found)
}

/// What a field is, in a few words.
fn values(field: &str, hits: &[Hit]) -> String {
    let mut values: Vec<&str> = hits.iter().filter_map(|hit| hit.text(field)).collect();
    match values.iter().map(|value| value.parse::<u64>()).collect::<Result<Vec<_>, _>>() {
        Ok(mut numbers) => {
            numbers.sort_unstable();
            numbers.dedup();
            let (first, last) = (numbers.first().copied().unwrap_or(0), numbers.last().copied().unwrap_or(0));
            format!("{{{field}}}: {} numbers from {first} to {last}", numbers.len())
        }
        Err(_) => {
            values.sort_unstable();
            values.dedup();
            let shown: Vec<&str> = values.iter().take(4).copied().collect();
            let more = if values.len() > shown.len() { ", ..." } else { "" };
            format!("{{{field}}}: {}{more}", l4d_data::error::inert(&shown.join(", ")))
        }
    }
}

/// What the first file says, and what an import would ask for.
fn needs(preset: &Preset, hit: &Hit) -> Vec<String> {
    let mut needs = Vec::new();
    if matches!(preset.codec, Codec::Latents | Codec::Array) {
        match arrays::read(&hit.path, preset.key.as_deref()) {
            Ok(array) => needs.push(format!("the first holds {:?} numbers", array.shape)),
            Err(error) => needs.push(format!("the first cannot be read: {error}")),
        }
    }
    if preset.codec == Codec::Latents {
        needs.push(
            "needs --texts, and --decoder where the autoencoder does not stand at its usual place".to_owned(),
        );
    }
    if preset.inside == super::inside::Inside::Selected {
        needs.push("needs --selections: which ids mean which sentence".to_owned());
    }
    if preset.template.contains("{image") {
        needs.push("needs --images: folders are named by ids of images".to_owned());
    }
    needs
}
