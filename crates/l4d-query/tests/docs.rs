//! `docs/queries.md` against the code: its examples parse, its list is complete, its numbers are the shipped ones.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

use std::path::{Path, PathBuf};

use l4d_data::{Benchmark, Profile, Report};
use l4d_query::prove::SceneSet;
use l4d_query::{Predicate, Relation, Superlative, probes, thresholds};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn docs() -> String {
    std::fs::read_to_string(root().join("docs/queries.md")).unwrap()
}

/// JSON in the first cell of table rows.
fn clauses(docs: &str) -> Vec<&str> {
    let cells = docs.lines().filter_map(|line| line.strip_prefix("| `")?.split_once("` |"));
    cells.map(|(cell, _)| cell).filter(|cell| cell.starts_with('{')).collect()
}

#[test]
fn every_example_parses() {
    let docs = docs();
    let clauses = clauses(&docs);
    assert_eq!(clauses.len(), 15 + 3, "{clauses:?}");
    for clause in clauses.iter().filter(|clause| !clause.starts_with(r#"{"category": "cup""#)) {
        let is_party =
            ["name", "such", "category"].iter().any(|key| clause.starts_with(&format!("{{\"{key}\"")));
        let clause = if is_party {
            format!(r#"{{"does": {{"verb": "see", "to": {clause}}}}}"#)
        } else {
            (*clause).to_owned()
        };
        let predicate = format!(r#"[{{"category": "x"}}, {clause}]"#);
        Predicate::from_json(&serde_json::from_str(&predicate).unwrap()).unwrap();
    }
    let block = docs.split("```json").nth(1).unwrap().split("```").next().unwrap();
    let predicate = Predicate::from_json(&serde_json::from_str(block).unwrap()).unwrap();
    assert!(docs.contains(&format!("`{predicate}`")), "{predicate}");
}

#[test]
fn every_relation_and_threshold_is_stated() {
    let docs = docs();
    for kind in Relation::ALL {
        assert!(docs.contains(&format!("| `{kind}` |")), "{kind}");
    }
    for extreme in ["largest", "smallest", "tallest", "highest", "lowest"] {
        let _: Superlative = serde_json::from_str(&format!("\"{extreme}\"")).unwrap();
        assert!(docs.contains(extreme), "{extreme}");
    }
    use l4d_data::Scale::{Outdoor, Room, Tabletop};
    let centimetres = |metres: f64| format!("{} cm", (metres * 1000.0).round() / 10.0);
    let stated = [
        centimetres(thresholds::CONTACT_BEGIN_M),
        centimetres(thresholds::CONTACT_END_M),
        format!("factor of {}", thresholds::VOLUME_MARGIN),
        format!("factor of {}", thresholds::HEIGHT_MARGIN),
        format!("{} times as far", thresholds::DISTANCE_MARGIN),
        format!("{} degrees of the front", thresholds::CONE_DEG),
        format!("{} degrees of the centre", thresholds::FACING_DEG),
        format!("by {} frames", thresholds::LEAD_FRAMES),
        format!("up to {} frames", thresholds::EDGE_FRAMES),
        format!("moved by {} %", thresholds::SLACK * 100.0),
        format!("{} to {} %", thresholds::BETWEEN_MARGIN * 100.0, (1.0 - thresholds::BETWEEN_MARGIN) * 100.0),
        format!("{} % of its length", thresholds::BETWEEN_OFFSET * 100.0),
        format!("more than {} percentage points", probes::BOUND_POINTS),
        [Outdoor, Room, Tabletop]
            .map(|scale| centimetres(thresholds::beside_m(scale)))
            .join(", ")
            .replace(", 50 cm, 10 cm", " outdoors, 50 cm in a room, 10 cm on a table"),
        centimetres(thresholds::higher_m(Outdoor)),
        centimetres(thresholds::higher_m(Room)),
        centimetres(thresholds::higher_m(Tabletop)),
        format!("{} m outdoors, {} m in a room", thresholds::before_m(Outdoor), thresholds::before_m(Room)),
        centimetres(thresholds::before_m(Tabletop)),
    ];
    for statement in stated {
        assert!(docs.contains(&statement), "docs/queries.md doesn't say \"{statement}\"");
    }
}

#[test]
fn the_table_of_shortcuts_is_the_shipped_one() {
    const MARKS: [&str; 2] = ["<!-- probes -->\n", "<!-- /probes -->"];
    let docs = docs();
    let (before, rest) = docs.split_once(MARKS[0]).unwrap();
    let (table, after) = rest.split_once(MARKS[1]).unwrap();
    let measured = measured();
    if table == measured {
        return;
    }
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let text = [before, MARKS[0], &measured, MARKS[1], after].concat();
        std::fs::write(root().join("docs/queries.md"), text).unwrap();
        return;
    }
    panic!("the set has changed: run `UPDATE_DOCS=1 cargo test -p l4d-query --test docs`\n{measured}");
}

fn measured() -> String {
    let bench = Benchmark::open(root().join("benchmark")).unwrap();
    let mut report = Report::default();
    let scenes = bench.select(&[]).unwrap();
    let read = |scene| SceneSet::read(&bench, Profile::Small, scene, &mut report);
    let sets: Vec<SceneSet> = scenes.iter().filter_map(read).collect();
    let probes = probes::measure(&sets);
    let queries = probes.iter().map(|probe| probe.queries).max().unwrap_or_default();
    let mut table = format!(
        "\n{queries} queries of {} scenes; percent, and percentage points above chance:\n\n",
        sets.len()
    );
    table += "| shortcut | picks | right | chance | above | action | spatial | interaction |\n";
    table += "|---|---|---:|---:|---:|---:|---:|---:|\n";
    for probe in probes.iter().filter(|probe| probe.queries > 0) {
        let points = ["action", "spatial", "interaction"].map(|key| format!("{:+.1}", probe.categories[key]));
        table += &format!(
            "| {} | {} | {:.1} | {:.1} | {:+.1} | {} |\n",
            probe.name,
            probe.rule,
            probe.accuracy,
            probe.chance,
            probe.difference,
            points.join(" | ")
        );
    }
    table + "\n"
}
