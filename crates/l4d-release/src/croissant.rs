//! `croissant.json`: the data set described for machines, in Croissant 1.1 with the fields of its vocabulary for
//! responsible AI.
//!
//! <https://docs.mlcommons.org/croissant/docs/croissant-spec-1.1.html>,
//! <https://docs.mlcommons.org/croissant/docs/croissant-rai-spec.html>.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::contents::Contents;
use crate::documents::{bibtex, licence_url, summary};
use crate::gather::Gathered;
use crate::tables::{Column, ColumnKind, Table};
use crate::words;

/// Its name in a release.
pub(crate) const FILE: &str = "croissant.json";

/// The document; `words` are those of [`words::of`], `files` those of the release with digest and size.
pub(crate) fn document(
    contents: &Contents,
    gathered: &Gathered,
    words: &Value,
    tables: &[Table],
    files: &BTreeMap<String, (String, u64)>,
) -> Value {
    let publication = &contents.publication;
    let creators: Vec<Value> =
        publication.creators.iter().map(|name| json!({ "@type": "sc:Organization", "name": name })).collect();
    let mut document = json!({
        "@context": context(),
        "@type": "sc:Dataset",
        "conformsTo": ["http://mlcommons.org/croissant/1.1", "http://mlcommons.org/croissant/RAI/1.0"],
        "name": contents.name,
        "description": summary(contents, gathered),
        "version": contents.version,
        "datePublished": publication.date,
        "license": licence_url(&contents.licence),
        "url": publication.url,
        "creator": creators,
        "citeAs": bibtex(contents),
        "inLanguage": "en",
        "isLiveDataset": false,
        "keywords": words::KEYWORDS,
    });
    if let Value::Object(fields) = &mut document {
        let responsible = words.as_object().into_iter().flatten();
        fields.extend(responsible.map(|(field, said)| (format!("rai:{field}"), said.clone())));
        fields.insert("distribution".to_owned(), distribution(files).into());
        fields.insert("recordSet".to_owned(), tables.iter().map(record_set).collect());
    }
    document
}

fn context() -> Value {
    let croissant = "annotation arrayShape citeAs column containedIn equivalentProperty extract field fileObject \
                     fileProperty fileSet format includes excludes isArray isLiveDataset jsonPath key md5 \
                     parentField path readLines recordSet references regex repeated replace samplingRate \
                     separator source subField transform unArchive value";
    let mut context = json!({
        "@language": "en",
        "@vocab": "https://schema.org/",
        "conformsTo": "dct:conformsTo",
        "cr": "http://mlcommons.org/croissant/",
        "rai": "http://mlcommons.org/croissant/RAI/",
        "data": { "@id": "cr:data", "@type": "@json" },
        "dataType": { "@id": "cr:dataType", "@type": "@vocab" },
        "dct": "http://purl.org/dc/terms/",
        "examples": { "@id": "cr:examples", "@type": "@json" },
        "prov": "http://www.w3.org/ns/prov#",
        "sc": "https://schema.org/",
    });
    if let Value::Object(fields) = &mut context {
        fields.extend(croissant.split(' ').map(|term| (term.to_owned(), format!("cr:{term}").into())));
    }
    context
}

fn distribution(files: &BTreeMap<String, (String, u64)>) -> Vec<Value> {
    let mut all: Vec<Value> = Vec::new();
    for (file, (sha256, bytes)) in files {
        all.push(json!({
            "@type": "cr:FileObject",
            "@id": file,
            "name": file,
            "description": about(file),
            "contentUrl": file,
            "contentSize": format!("{bytes} B"),
            "encodingFormat": encoding(file),
            "sha256": sha256,
        }));
    }
    for archive in files.keys().filter(|file| file.ends_with(".tar")) {
        for (what, pattern, format) in inside(archive) {
            all.push(json!({
                "@type": "cr:FileSet",
                "@id": format!("{archive}/{what}"),
                "name": format!("{what} in {archive}"),
                "containedIn": { "@id": archive },
                "encodingFormat": format,
                "includes": pattern,
            }));
        }
    }
    all
}

/// What an archive holds: name, pattern, media type.
fn inside(archive: &str) -> Vec<(&'static str, &'static str, &'static str)> {
    match archive {
        _ if archive.starts_with("archives/renders/") => vec![
            ("scene", "data/*/*/scene.json", "application/json"),
            ("views", "data/*/*/frames/*/view.json", "application/json"),
        ],
        _ if archive.starts_with("archives/splats/") => {
            vec![("model", "work/*/*/splats/*.safetensors", "application/octet-stream")]
        }
        _ if archive.starts_with("shards/") => vec![
            ("colour", "*/*/[0-9]*[0-9].png", "image/png"),
            ("depth", "*/*/*.depth.png", "image/png"),
            ("depth_rest", "*/*/*.depth_rest.png", "image/png"),
            ("ids", "*/*/*.ids.png", "image/png"),
            ("cameras", "*/*/*.json", "application/json"),
        ],
        _ if archive.starts_with("archives/scenes/") => vec![
            ("tracks", "benchmark/scenes/*.json", "application/json"),
            ("queries", "benchmark/queries/*.jsonl", "application/jsonlines"),
            ("truth", "benchmark/truth/*/*.json", "application/json"),
        ],
        "archives/annotation.tar" => {
            vec![("votes", "annotation/rounds/*/votes/*.jsonl", "application/jsonlines")]
        }
        _ => vec![("published", "benchmark/published/*.csv", "text/csv")],
    }
}

fn encoding(file: &str) -> &'static str {
    match file.rsplit('.').next().unwrap_or_default() {
        "tar" => "application/x-tar",
        "jsonl" => "application/jsonlines",
        "parquet" => "application/vnd.apache.parquet",
        "json" => "application/json",
        "md" => "text/markdown",
        "cff" => "application/yaml",
        _ => "text/plain",
    }
}

fn about(file: &str) -> &'static str {
    match file {
        "archives/benchmark.tar" => "Manifest, licence, vocabulary, tables of published numbers.",
        "archives/annotation.tar" => "Guidelines, ballots and verdicts of the rounds of people.",
        _ if file.starts_with("archives/scenes/") => {
            "A scene: tracks, queries and truth, as `l4d` reads them."
        }
        _ if file.starts_with("archives/renders/") => {
            "A rendered scene without its pictures: description, stage, tracks, cards of the views."
        }
        _ if file.starts_with("archives/splats/") => "A trained 4D Gaussian splatting model of a scene.",
        _ if file.starts_with("shards/") => {
            "Pictures of a scene and split in the layout of WebDataset: colour, depth, ids, cameras and time."
        }
        _ if file.ends_with(".parquet") => "The table of the same name, as Parquet.",
        _ if file.starts_with("tables/") => "A table, one JSON object a line.",
        _ => "About this release.",
    }
}

fn record_set(table: &Table) -> Value {
    let name = &table.name;
    let key = |column: &str| json!({ "@id": format!("{name}/{column}") });
    let keys: Vec<Value> = table.key.iter().map(|column| key(column)).collect();
    json!({
        "@type": "cr:RecordSet",
        "@id": name,
        "name": name,
        "description": table.about,
        "key": if let [only] = keys.as_slice() { only.clone() } else { keys.into() },
        "field": table.columns.iter().map(|column| field(table, column)).collect::<Vec<Value>>(),
    })
}

fn field(table: &Table, column: &Column) -> Value {
    let mut field = json!({
        "@type": "cr:Field",
        "@id": format!("{}/{}", table.name, column.name),
        "name": column.name,
        "description": column.about,
        "dataType": match column.kind {
            ColumnKind::Text | ColumnKind::Texts => "sc:Text",
            ColumnKind::Integer | ColumnKind::Intervals => "sc:Integer",
            ColumnKind::Float => "sc:Float",
        },
        "source": { "fileObject": { "@id": table.path() }, "extract": { "column": column.name } },
    });
    match column.kind {
        ColumnKind::Texts => {
            field["isArray"] = true.into();
            field["arrayShape"] = "-1".into();
        }
        ColumnKind::Intervals => {
            field["isArray"] = true.into();
            field["arrayShape"] = "-1,2".into();
        }
        ColumnKind::Text | ColumnKind::Integer | ColumnKind::Float => {}
    }
    if let Some((other, column)) = &column.refers_to {
        field["references"] = json!({ "field": { "@id": format!("{other}/{column}") } });
    }
    field
}
