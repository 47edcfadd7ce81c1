//! Runs the examples of `docs/scoring.md`: the documentation is the hand-computed test of the judge.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on must say where")]

use std::collections::BTreeSet;

use l4d_data::scene::Role;
use l4d_data::{Name, Query, Scale};
use l4d_masks::Mask;
use l4d_score::counts::{FrameCount, State};
use l4d_score::judge::{Answer, QueryJudge};
use l4d_score::metrics::{Metric, Missing, Options, QueryFacts, QueryTally, Ratios};
use l4d_score::truth::{SceneTruth, TruthInstance, TruthMask};

const SIDE: u32 = 4;
const LETTERS: [char; 3] = ['a', 'b', 'c'];

#[derive(Debug, Default)]
struct Example {
    title: String,
    referents: Vec<char>,
    holds: Option<[u32; 2]>,
    options: Options,
    frames: Vec<Frame>,
    metrics: Vec<(String, String)>,
}

#[derive(Debug)]
struct Frame {
    number: u32,
    truth: Vec<String>,
    predicted: Vec<String>,
    expected: String,
}

#[test]
fn every_example_holds_and_every_state_has_one() {
    let examples = parse(include_str!("../../../docs/scoring.md"));
    assert!(examples.len() >= 10, "only {} examples were found", examples.len());
    let mut states = BTreeSet::new();
    let mut metrics = BTreeSet::new();
    for example in &examples {
        for count in run(example) {
            states.insert(count.state);
        }
        metrics.extend(example.metrics.iter().map(|(name, _)| name.clone()));
    }
    assert_eq!(states.len(), State::ALL.len(), "some state has no example");
    assert_eq!(metrics.len(), Metric::ALL.len(), "some metric has no example");
}

fn parse(page: &str) -> Vec<Example> {
    let mut examples = Vec::new();
    let mut title = "";
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if let Some(heading) = line.strip_prefix("### ") {
            title = heading;
        }
        if line == "```scoring" {
            let body: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            examples.push(parse_example(title, &body));
        }
    }
    examples
}

fn parse_example(title: &str, lines: &[&str]) -> Example {
    let mut example = Example { title: title.to_owned(), ..Example::default() };
    let mut lines = lines.iter();
    while let Some(line) = lines.next() {
        if let Some(letters) = line.strip_prefix("referents: ") {
            example.referents = letters.chars().filter(|letter| *letter != ' ').collect();
        } else if let Some(interval) = line.strip_prefix("holds: ") {
            let (first, last) = interval.split_once('-').unwrap();
            example.holds = Some([first.parse().unwrap(), last.parse().unwrap()]);
        } else if let Some(policy) = line.strip_prefix("--missing ") {
            example.options.missing = if policy == "zero" { Missing::Zero } else { Missing::Skip };
        } else if let Some(threshold) = line.strip_prefix("--hit-iou ") {
            example.options.hit_iou = threshold.parse().unwrap();
        } else if let Some(number) = line.strip_prefix("frame ") {
            let rows: Vec<Vec<&str>> =
                lines.by_ref().take(SIDE as usize).map(|row| row.split_whitespace().collect()).collect();
            let column = |index: usize| -> Vec<String> {
                rows.iter().filter_map(|row| row.get(index)).map(|&cell| cell.to_owned()).collect()
            };
            let expected = lines.next().unwrap().strip_prefix("-> ").unwrap().to_owned();
            let (truth, predicted) = (column(0), column(1));
            example.frames.push(Frame { number: number.parse().unwrap(), truth, predicted, expected });
        } else {
            let (metric, value) = line.split_once(" = ").unwrap_or_else(|| panic!("{title}: `{line}`"));
            example.metrics.push((metric.to_owned(), value.to_owned()));
        }
    }
    example
}

fn run(example: &Example) -> Vec<FrameCount> {
    let truth = truth_of(example);
    let query = query_of(example);
    let referents: Vec<usize> = example
        .referents
        .iter()
        .map(|letter| LETTERS.iter().position(|other| other == letter).unwrap())
        .collect();
    let clip: Vec<u32> = example.frames.iter().map(|frame| frame.number).collect();
    let answers: Vec<Answer> = example.frames.iter().map(answer_of).collect();
    let counts = QueryJudge::new(&truth, &query, &referents).clip(&clip, &answers);
    for (frame, count) in example.frames.iter().zip(&counts) {
        assert_eq!(describe(count), frame.expected, "{}: frame {}", example.title, frame.number);
    }
    let tally = QueryTally::of(QueryFacts::of(&query, Scale::Room), &counts, &example.options);
    for (metric, expected) in &example.metrics {
        let found = value_of(&tally.ratios(), metric);
        match (found, fraction(expected)) {
            (Some(found), Some(expected)) => {
                assert!((found - expected).abs() < 1e-12, "{}: {metric} is {found}", example.title);
            }
            (found, expected) => assert_eq!(found, expected, "{}: {metric}", example.title),
        }
    }
    counts
}

fn truth_of(example: &Example) -> SceneTruth {
    let annotated: Vec<&Frame> =
        example.frames.iter().filter(|frame| !frame.truth[0].starts_with('?')).collect();
    let instances = LETTERS.iter().enumerate().map(|(index, &letter)| TruthInstance {
        name: Name::new(letter).unwrap(),
        id: index as u32 + 1,
        role: Role::Object,
        category: "letter".to_owned(),
        masks: annotated.iter().map(|frame| TruthMask::of(&mask(&frame.truth, letter))).collect(),
    });
    let frames = annotated.iter().map(|frame| frame.number).collect();
    let scene = (Name::new("page").unwrap(), Scale::Room);
    SceneTruth::new(scene, (SIDE, SIDE), frames, instances.collect())
}

fn query_of(example: &Example) -> Query {
    let temporal = if example.holds.is_some() { "while" } else { "whole" };
    let referents: Vec<String> = example.referents.iter().map(char::to_string).collect();
    serde_json::from_value(serde_json::json!({
        "id": "page/001",
        "text": example.title,
        "categories": ["action"],
        "referents": referents,
        "temporal": temporal,
        "frames": [example.holds.unwrap_or([0, 96])],
        "predicate": null,
        "text_digest": "",
        "provenance": { "source": "author" },
        "status": "candidate",
    }))
    .unwrap()
}

fn answer_of(frame: &Frame) -> Answer {
    match frame.predicted[0].as_str() {
        "absent" => Answer::Absent,
        "missing" => Answer::Missing,
        _ => Answer::Pixels(mask(&frame.predicted, '#')),
    }
}

fn mask(rows: &[String], inside: char) -> Mask {
    Mask::from_fn(SIDE, SIDE, |col, row| rows[row as usize].chars().nth(col as usize) == Some(inside))
}

fn describe(count: &FrameCount) -> String {
    let FrameCount { state, intersection, union, predicted, truth, instance, instance_overlap, .. } = count;
    let most = instance.as_ref().map(|name| format!(" most {name} {instance_overlap}")).unwrap_or_default();
    format!("{} {intersection}/{union} predicted {predicted} truth {truth}{most}", state.as_str())
}

fn value_of(ratios: &Ratios, metric: &str) -> Option<f64> {
    let known = Metric::ALL.into_iter().find(|known| known.key() == metric);
    ratios.get(known.unwrap_or_else(|| panic!("no metric is called {metric}")))
}

fn fraction(text: &str) -> Option<f64> {
    if text == "none" {
        return None;
    }
    let (part, whole) = text.split_once('/').unwrap_or((text, "1"));
    Some(part.parse::<f64>().unwrap() / whole.parse::<f64>().unwrap())
}
