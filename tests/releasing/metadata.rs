//! Metadata of releases: Croissant, the card of the Hub, the citation. The validators that others wrote run where
//! `L4D_VALIDATORS_PYTHON` names a Python that has them.

use std::collections::BTreeSet;
use std::process::Command;

use l4d_data::digest::sha256_file;
use serde_json::Value;

use super::{RELEASE, released, write_renders};
use crate::annotation::bench;
use crate::support::{root, succeed};

/// Ids of nodes that have one.
fn ids(nodes: &Value) -> BTreeSet<&str> {
    nodes.as_array().unwrap().iter().map(|node| node["@id"].as_str().unwrap()).collect()
}

#[test]
fn croissant_describes_every_file_and_every_column() {
    let dir = bench();
    write_renders(&dir);
    released(&dir, "--profile tiny");
    let document = dir.value(&format!("{RELEASE}/croissant.json"));
    for field in ["name", "description", "license", "url", "datePublished", "version", "citeAs"] {
        assert!(document[field].as_str().is_some_and(|text| !text.is_empty()), "{field}");
    }
    assert_eq!(document["conformsTo"][0], "http://mlcommons.org/croissant/1.1");
    let minimal = [
        "dataCollection",
        "dataCollectionType",
        "dataAnnotationProtocol",
        "annotationsPerItem",
        "dataLimitations",
        "dataBiases",
        "dataUseCases",
        "personalSensitiveInformation",
        "dataSocialImpact",
        "dataReleaseMaintenancePlan",
    ];
    for field in minimal {
        let value = &document[format!("rai:{field}")];
        let is_said = value.is_string() || value.as_array().is_some_and(|list| !list.is_empty());
        assert!(is_said, "rai:{field} {value}");
    }
    assert_eq!(document["rai:annotationsPerItem"], "0");

    let files = document["distribution"].as_array().unwrap();
    let objects: Vec<&Value> = files.iter().filter(|file| file["@type"] == "cr:FileObject").collect();
    let mut described = BTreeSet::new();
    for object in objects {
        let name = object["contentUrl"].as_str().unwrap();
        let path = dir.path(RELEASE).join(name);
        assert_eq!(object["sha256"], sha256_file(&path).unwrap(), "{name}");
        assert_eq!(object["contentSize"], format!("{} B", path.metadata().unwrap().len()), "{name}");
        described.insert(name.to_owned());
    }
    let mut there: BTreeSet<String> = dir.tree(RELEASE).into_keys().collect();
    assert!(there.remove("croissant.json") && there.remove("SHA256SUMS"));
    assert_eq!(described, there);
    assert_eq!(ids(&document["distribution"]).len(), files.len(), "an id occurs twice");

    let record_sets = document["recordSet"].as_array().unwrap();
    let fields: BTreeSet<&str> = record_sets.iter().flat_map(|set| ids(&set["field"])).collect();
    for set in record_sets {
        let name = set["@id"].as_str().unwrap();
        let row = dir.lines(&format!("{RELEASE}/tables/{name}.jsonl")).remove(0);
        let columns = set["field"].as_array().unwrap();
        let names = columns.iter().map(|field| field["name"].as_str().unwrap());
        assert!(row.as_object().unwrap().keys().eq(names), "{name}");
        for field in columns {
            let value = &row[field["name"].as_str().unwrap()];
            let fits = match (field["isArray"].as_bool(), field["dataType"].as_str().unwrap()) {
                (Some(true), _) => value.is_array(),
                (_, "sc:Text") => value.is_string(),
                (_, "sc:Integer") => value.is_u64(),
                (_, "sc:Float") => value.is_f64(),
                (_, other) => panic!("{other}"),
            };
            assert!(fits, "{name}: {field} {value}");
            if let Some(other) = field["references"]["field"]["@id"].as_str() {
                assert!(fields.contains(other), "{other}");
            }
        }
    }
}

#[test]
fn the_card_names_files_that_are_there() {
    let dir = bench();
    released(&dir, "");
    let card = dir.read(&format!("{RELEASE}/README.md"));
    let front = card.strip_prefix("---\n").unwrap().split("\n---\n").next().unwrap();
    for line in ["license: cc0-1.0", "pretty_name: \"Two\"", "    default: true", "      - split: test"] {
        assert!(front.lines().any(|found| found == line), "{line}\n{front}");
    }
    let paths: Vec<&str> = front.lines().filter_map(|line| line.trim().strip_prefix("path: ")).collect();
    assert!(paths.len() >= 6 && paths.iter().all(|path| dir.path(RELEASE).join(path).is_file()), "{paths:?}");
    assert!(card.contains("**Not verified by people:**"));
    let sheet = dir.read(&format!("{RELEASE}/DATASHEET.md"));
    for section in
        ["Motivation", "Composition", "Collection", "Preprocessing", "Uses", "Distribution", "Maintenance"]
    {
        assert!(sheet.contains(&format!("\n## {section}")), "{section}");
    }
    for text in [&card, &sheet] {
        assert!(!text.contains("{{") && !text.contains("{%") && !text.contains("\n\n\n"), "{text}");
    }
}

#[test]
#[ignore = "needs mlcroissant, datasets and cffconvert in L4D_VALIDATORS_PYTHON"]
fn validators_of_others_find_nothing_wrong() {
    let python = std::env::var_os("L4D_VALIDATORS_PYTHON").expect("L4D_VALIDATORS_PYTHON names a Python");
    let dir = bench();
    write_renders(&dir);
    released(&dir, "--profile tiny");
    let script = root().join("tests/releasing/validate.py");
    let mut command = Command::new(python);
    command.arg(script).arg(dir.path(RELEASE)).env("HF_HOME", dir.path("hub")).env("HF_HUB_OFFLINE", "1");
    let said = succeed(&mut command);
    for validator in ["mlcroissant", "datasets", "cffconvert"] {
        assert!(said.contains(&format!("{validator}: ok")), "{said}");
    }
}
