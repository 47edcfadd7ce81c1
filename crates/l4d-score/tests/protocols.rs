//! The protocols of others against an independent implementation (`protocols/reference.py`), and by hand.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on must say where")]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use l4d_data::query::text_digest;
use l4d_data::scene::{Role, Scale};
use l4d_data::{Name, Query, QueryId};
use l4d_masks::Mask;
use l4d_score::Protocol;
use l4d_score::judge::Answer;
use l4d_score::protocols::{Sheet, Summits, judge_answers, render};
use l4d_score::truth::{SceneTruth, TruthInstance, TruthMask};
use serde_json::{Value, json};

const REFERENCE: &str = include_str!("protocols/reference.json");

/// One scene with its queries and answers.
struct Case {
    truth: SceneTruth,
    queries: Vec<Query>,
    answers: BTreeMap<QueryId, Vec<Answer>>,
}

impl Case {
    fn judge(&self, protocols: &[Protocol]) -> Vec<Sheet> {
        let asked: Vec<&Query> = self.queries.iter().collect();
        let method = Name::new("theirs").unwrap();
        let path = Path::new("queries");
        judge_answers(protocols, &method, &self.truth, &asked, path, &self.answers, &Summits::new()).unwrap()
    }
}

fn query(scene: &str, number: u64, referents: &[String], holds: Option<Vec<[u32; 2]>>) -> Query {
    let text = format!("thing {number}");
    serde_json::from_value(json!({
        "id": format!("{scene}/{number:03}"), "text": text, "categories": ["action"], "referents": referents,
        "temporal": if holds.is_some() { "while" } else { "whole" },
        "frames": holds.unwrap_or(vec![[0, 96]]), "predicate": null,
        "text_digest": text_digest(&text, None), "provenance": {"source": "author"}, "status": "candidate",
    }))
    .unwrap()
}

/// A scene of the reference: every part of a referent is an instance of its own.
fn case(scene: &Value, frames: &[u32]) -> Case {
    let side = |name: &str| scene[name].as_u64().unwrap() as u32;
    let (width, height) = (side("width"), side("height"));
    let name = scene["name"].as_str().unwrap();
    let decode = |counts: &Value| Mask::decode(counts.as_str().unwrap(), width, height).unwrap();
    let (mut instances, mut queries, mut answers) = (Vec::new(), Vec::new(), BTreeMap::new());
    for entry in scene["queries"].as_array().unwrap() {
        let number = entry["number"].as_u64().unwrap();
        let parts = entry["visible"]["0"].as_array().unwrap().len();
        let names: Vec<String> = (0..parts).map(|part| format!("q{number}_part{part}")).collect();
        for (part, name) in names.iter().enumerate() {
            let mask = |frame: &u32| TruthMask::of(&decode(&entry["visible"][frame.to_string()][part]));
            instances.push(TruthInstance {
                name: Name::new(name).unwrap(),
                id: instances.len() as u32 + 1,
                role: Role::Object,
                category: "thing".to_owned(),
                masks: frames.iter().map(mask).collect(),
            });
        }
        let query = query(name, number, &names, serde_json::from_value(entry["holds"].clone()).unwrap());
        let answer = |frame: &u32| match entry["answers"].get(frame.to_string()) {
            None => Answer::Missing,
            Some(Value::Null) => Answer::Absent,
            Some(counts) => Answer::Pixels(decode(counts)),
        };
        answers.insert(query.id.clone(), frames.iter().map(answer).collect());
        queries.push(query);
    }
    let truth =
        SceneTruth::new((Name::new(name).unwrap(), Scale::Room), (width, height), frames.to_vec(), instances);
    Case { truth, queries, answers }
}

#[test]
fn every_protocol_agrees_with_numpy_opencv_and_pycocotools() {
    let reference: Value = serde_json::from_str(REFERENCE).unwrap();
    let frames: Vec<u32> = serde_json::from_value(reference["frames"].clone()).unwrap();
    let mut sheets: Vec<Sheet> = Vec::new();
    for scene in reference["scenes"].as_array().unwrap() {
        let found = case(scene, &frames).judge(&Protocol::ALL);
        match sheets.is_empty() {
            true => sheets = found,
            false => sheets.iter_mut().zip(found).for_each(|(all, scene)| all.rows.extend(scene.rows)),
        }
    }
    let mut compared = 0;
    for sheet in &sheets {
        let expected = reference["expected"][sheet.protocol.as_str()].as_object().unwrap();
        for (measure, expected) in expected {
            let (found, expected) = (sheet.get(measure).unwrap(), expected.as_f64().unwrap());
            let protocol = sheet.protocol;
            assert!((found - expected).abs() < 1e-9, "{protocol}, {measure}: {found} is not {expected}");
            compared += 1;
        }
    }
    // All but LangSplat's localisation, which needs relevancy.
    let measures: usize = Protocol::ALL.iter().map(|protocol| protocol.rules().measures.len()).sum();
    assert_eq!(compared, measures - 1);
}

/// The committed reference is what the script writes.
#[test]
#[ignore = "needs Python with numpy, opencv-python-headless and pycocotools in L4D_REFERENCE_PYTHON"]
fn the_reference_is_reproducible() {
    let python = std::env::var_os("L4D_REFERENCE_PYTHON").unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/protocols/reference.py");
    let output = Command::new(python).arg(script).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let again: Value = serde_json::from_slice(&output.stdout).unwrap();
    let committed: Value = serde_json::from_str(REFERENCE).unwrap();
    assert_eq!(again["scenes"], committed["scenes"]);
    for (protocol, measures) in committed["expected"].as_object().unwrap() {
        for (measure, value) in measures.as_object().unwrap() {
            let again = again["expected"][protocol][measure].as_f64().unwrap();
            assert!((again - value.as_f64().unwrap()).abs() < 1e-9, "{protocol}, {measure}");
        }
    }
}

/// 20 x 20 pixels; the instance fills columns `first..end` of rows 0 to 9.
fn bar(first: u32, end: u32) -> Mask {
    Mask::from_fn(20, 20, |col, row| (first..end).contains(&col) && row < 10)
}

/// Three sentences over five frames: one always true, one true in the first three frames, one that is never seen.
fn by_hand() -> Case {
    let truth_of = |bars: [Option<(u32, u32)>; 5]| {
        bars.map(|bar_of| bar_of.and_then(|(first, end)| TruthMask::of(&bar(first, end)))).to_vec()
    };
    let instance = |name: &str, id: u32, masks: Vec<Option<TruthMask>>| TruthInstance {
        name: Name::new(name).unwrap(),
        id,
        role: Role::Object,
        category: "bar".to_owned(),
        masks,
    };
    let instances = vec![
        instance("a", 1, truth_of([Some((0, 10)), Some((0, 10)), Some((0, 10)), None, None])),
        instance("b", 2, truth_of([Some((10, 20)); 5])),
        instance("c", 3, truth_of([None; 5])),
    ];
    let scene = (Name::new("bars").unwrap(), Scale::Tabletop);
    let truth = SceneTruth::new(scene, (20, 20), vec![0, 2, 4, 6, 8], instances);
    let named = |name: &str| [name.to_owned()];
    let queries = vec![
        query("bars", 1, &named("a"), None),
        query("bars", 2, &named("b"), Some(vec![[0, 4]])),
        query("bars", 3, &named("c"), None),
    ];
    let pixels = |first, end| Answer::Pixels(bar(first, end));
    let answers = BTreeMap::from([
        // IoU 1, 1/2, missing; then a false alarm and a right silence.
        (
            queries[0].id.clone(),
            vec![pixels(0, 10), pixels(0, 5), Answer::Missing, pixels(0, 4), Answer::Absent],
        ),
        // On, off, on; then on, wrongly, and off. IoU 1 and 1/4 where on and true.
        (
            queries[1].id.clone(),
            vec![pixels(10, 20), Answer::Absent, pixels(0, 16), pixels(10, 20), Answer::Absent],
        ),
        (queries[2].id.clone(), vec![Answer::Absent; 5]),
    ]);
    Case { truth, queries, answers }
}

#[test]
fn edges_by_hand() {
    let case = by_hand();
    let sheets: BTreeMap<&str, Sheet> =
        case.judge(&Protocol::ALL).into_iter().map(|sheet| (sheet.protocol.as_str(), sheet)).collect();
    let near = |protocol: &str, measure: &str, expected: f64| {
        let found = sheets[protocol].get(measure).unwrap();
        assert!((found - expected).abs() < 1e-12, "{protocol}, {measure}: {found} is not {expected}");
    };
    // b is 100 pixels; (0, 16) shares 60 of 200: 0.3.
    let pairs = [1.0, 0.5, 0.0, 1.0, 0.0, 0.3];
    near("langsplat", "miou", pairs.iter().sum::<f64>() / 6.0);
    near("4d-langsplat", "miou", 1.5 / 3.0);
    // True in 0, 2, 4; said in 0, 4, 6: four frames, of which two are both.
    near("4d-langsplat", "viou", 1.3 / 4.0);
    near("4d-langsplat", "acc", 3.0 / 5.0);
    // The missing frame is skipped.
    near("gaussian-grouping", "miou", (1.5 / 2.0 + 1.3 / 3.0) / 2.0);
    // The first expression lacks an answer and is lost; of the others 1, 0, 0.3, 0, 1 and five times 1.
    near("mevis", "j", (2.3 / 5.0 + 1.0) / 2.0);
    // Without the ends: 1/2, 0, 0 and 0, 0.3, 0; the third object is not in the first frame.
    near("davis", "j_mean", (0.5 / 3.0 + 0.3 / 3.0) / 2.0);

    let told = |protocol: &str, words: &str| {
        let left_out = &sheets[protocol].left_out;
        let one = left_out.iter().find(|one| one.what.contains(words));
        one.map(|one| (one.queries, one.frames))
    };
    assert_eq!(told("langsplat", "no one annotates"), Some((3, 9)));
    assert_eq!(told("langsplat", "false alarms"), Some((2, 2)));
    assert_eq!(told("langsplat", "count as empty"), Some((1, 1)));
    assert_eq!(told("gaussian-grouping", "skipped silently"), Some((1, 1)));
    assert_eq!(told("mevis", "lost silently"), Some((1, 5)));
    assert_eq!(told("davis", "first frame does not show"), Some((1, 5)));
}

#[test]
fn a_sheet_bears_the_name_of_its_protocol_wherever_it_stands() {
    for sheet in by_hand().judge(&Protocol::ALL) {
        let name = sheet.protocol.as_str();
        let table = render(sheet.protocol, std::slice::from_ref(&sheet));
        let mut lines = table.lines();
        assert!(lines.next().unwrap().starts_with(&format!("protocol {name} (")), "{table}");
        assert!(lines.next().unwrap().starts_with(name), "{table}");
        assert!(table.contains("never ranked") && table.lines().all(|line| line.len() <= 100), "{table}");
        assert_eq!(sheet.to_json()["protocol"], name);
        assert!(sheet.to_csv().lines().skip(1).all(|line| line.starts_with(&format!("{name},bars,"))));
    }
}

#[test]
fn nothing_to_average_is_no_number() {
    let mut case = by_hand();
    case.queries.clear();
    for sheet in case.judge(&Protocol::ALL) {
        assert!((0..sheet.protocol.rules().measures.len()).all(|measure| sheet.number(measure).is_none()));
        assert_eq!((sheet.queries(), sheet.left_out), (0, Vec::new()));
    }
}
