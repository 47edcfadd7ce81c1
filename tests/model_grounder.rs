//! `--grounder model` as its users run it: a scripted model server, and segmenter workers in processes of their own.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use serde_json::{Value, json};

use crate::proposing::scripted::{Server, says, status, thinks};
use crate::solving::world;
use crate::support::{Dir, root, shipped};

/// The left half of the first picture.
const PLAN: &str = r#"{"visible":true,"expression":"the ball that rolls","noun_phrase":"ball","boxes":[{"time":0.0,"bbox_2d":[0,0,500,1000]}]}"#;

/// The twins, and how a model and the worker that fills boxes go together.
fn stage(server: &Server) -> Dir {
    let dir = world();
    let endpoint = format!(
        "base_url = \"{}\"\nmodel = \"tiny-vl\"\ncoordinates = \"rel1000_xyxy\"\n\
         prices = {{ prompt_per_million = 10.0, completion_per_million = 100.0 }}\n\
         [retry]\ntries = 1\n",
        server.url()
    );
    dir.write("endpoint.toml", endpoint);
    grounder(&dir, "worker = \"box\"", &root().join("crates/l4d-ground/workers").display().to_string());
    dir
}

fn grounder(dir: &Dir, worker: &str, package: &str) {
    let model = "[model]\nkeyframes = 3\npicture_pixels = 4096\n";
    let segmenter = format!("[segmenter]\n{worker}\npackage = \"{package}\"\n");
    dir.write("grounder.toml", format!("coupling = \"box\"\n{segmenter}{model}"));
}

const SOLVE: &str = "solve --profile tiny --data data --queries ball/001 --grounder model \
                     --grounder-file grounder.toml --endpoint endpoint.toml";

#[test]
fn a_server_that_fails_for_half_of_the_views_is_asked_for_those_again() {
    let (count, is_well) = (AtomicUsize::new(0), Arc::new(AtomicBool::new(false)));
    let mended = Arc::clone(&is_well);
    let server = Server::start(vec![thinks(move |_| {
        match mended.load(Ordering::SeqCst) || count.fetch_add(1, Ordering::SeqCst).is_multiple_of(2) {
            true => says(PLAN),
            false => status(503, &json!({ "error": { "message": "overloaded" } })),
        }
    })]);
    let dir = stage(&server);
    let plan = |dir: &Dir| dir.json(format!("{SOLVE} --dry-run"));
    let first = plan(&dir);
    let total = &first["total"];
    assert_eq!((&total["questions"], &total["kept"], &total["images"]), (&json!(4), &json!(0), &json!(12)));
    assert!(total["tokens"]["prompt"].as_u64().unwrap() > 100, "{first}");
    assert!(total["cost"].as_f64().unwrap() > 0.1, "{first}");
    assert_eq!((&first["dry_run"], &first["plans"][0]["scene"]), (&json!(true), &json!("ball")));
    let table = dir.succeed(format!("{SOLVE} --dry-run")).stdout;
    assert!(table.contains("questions") && table.contains("cost up to"), "{table}");
    assert_eq!(server.count(), 0, "a plan sends nothing");
    assert!(!dir.path("results").exists(), "a plan answers nothing");

    dir.run(SOLVE).says(0, &["views: 2 error, 2 found", "did not answer"]);
    assert!(dir.path("results/panopticquery-model/masks/ball/001.json").is_file(), "the others go on");
    assert_eq!(plan(&dir)["total"]["questions"], 2, "what answered is not asked again");
    is_well.store(true, Ordering::SeqCst);
    dir.run(SOLVE).says(0, &["views: 4 found"]);
    assert_eq!((server.count(), &plan(&dir)["total"]["questions"]), (6, &json!(0)));
}

#[test]
fn models_and_couplings_are_rows_of_a_table() {
    let server = Server::start(vec![says(PLAN)]);
    let dir = stage(&server);
    dir.write("boxes.toml", dir.read("grounder.toml"));
    let no_vlm = dir.read("grounder.toml").replace("\"box\"", "\"null\"");
    dir.write("no_vlm.toml", no_vlm.replace("coupling = \"null\"", "coupling = \"no-vlm\""));
    let published = "benchmark/published/vlm.csv";
    dir.write(published, shipped(published));
    let grid = "ablate vlm --profile tiny --data data --grounder-files";
    let document = dir.json(format!("{grid} boxes.toml,no_vlm.toml --endpoint endpoint.toml"));
    let rows = document["rows"].as_array().unwrap();
    let miou = |setting: &str| {
        let wanted = [("source", "measured"), ("setting", setting), ("column", "all"), ("metric", "miou")];
        let is_meant = |row: &&Value| wanted.iter().all(|(field, value)| row[*field] == **value);
        let row = rows.iter().find(is_meant).unwrap_or_else(|| panic!("no {setting} in {document}"));
        assert_eq!(row["used_truth"], false);
        row["value"].as_f64().unwrap()
    };
    assert!(miou("boxes") > 0.0, "half of every picture holds some of the balls");
    assert_eq!(miou("no_vlm"), 0.0);
    assert!(rows.iter().any(|row| row["source"] == "published"));
    assert_eq!(server.count(), 4 * 3, "a question a view and query, by one of the rows");
    let endpoints = |name: &str| {
        let card = dir.value(&format!("work/tiny/ablations/vlm/results/{name}/method.json"));
        card["used"]["endpoints"].clone()
    };
    assert_eq!((endpoints("boxes"), endpoints("no_vlm")), (json!([server.url()]), json!([])));
    dir.write("other/boxes.toml", dir.read("boxes.toml"));
    let twice = "two of --grounder-files are called `boxes`";
    dir.refuses(format!("{grid} boxes.toml,other/boxes.toml"), &[twice]);
    dir.refuses(format!("{grid} missing.toml"), &["missing.toml"]);
}

#[test]
fn a_file_that_names_no_worker_is_refused() {
    let server = Server::start(vec![says(PLAN)]);
    let dir = stage(&server);
    let shipped = root().join("crates/l4d-ground/workers").display().to_string();
    for (worker, parts) in [
        ("", ["segmenter.worker", "neither is there"]),
        ("worker = \"box\"\nprogram = \"python3\"", ["segmenter.worker", "is beside"]),
        ("worker = \"sam9\"", ["is `sam9`", "sam2-hf"]),
        ("worker = \"samwise\"", ["segmenter.python", "checkout"]),
        ("program = \"python3\"", ["segmenter.package", "leave it out"]),
    ] {
        grounder(&dir, worker, &shipped);
        dir.refuses(SOLVE, &parts);
    }
    grounder(&dir, "worker = \"box\"", "nowhere");
    dir.refuses(SOLVE, &["nowhere", "not there", "`package`"]);
    let panoptic = "solve --profile tiny --data data --dry-run";
    dir.refuses(panoptic, &["--dry-run does not apply to --grounder panoptic"]);
    assert_eq!(server.count(), 0);
}

/// What makes a Python environment.
mod python {
    use super::*;

    #[test]
    fn a_worker_of_ours_runs_in_an_environment_that_is_made_once() {
        let server = Server::start(vec![says(PLAN)]);
        let dir = stage(&server);
        // The real package, but for the networks and what they need: the worker that fills boxes takes the place of SAM 2.
        for (file, place) in ["__init__", "__main__", "protocol", "rle", "box"]
            .map(|file| (file, file))
            .into_iter()
            .chain([("box", "sam2_hf")])
        {
            let text = shipped(&format!("crates/l4d-ground/workers/l4d_workers/{file}.py"));
            dir.write(&format!("package/l4d_workers/{place}.py"), text);
        }
        dir.write("package/requirements.txt", "# nothing\n");
        grounder(&dir, "worker = \"sam2-hf\"", "package");
        dir.run(SOLVE).says(0, &["making the environment of the segmenter workers", "views: 4 found"]);
        let kinds =
            std::fs::read_dir(dir.path("work/workers-env")).unwrap().map(|entry| entry.unwrap().path());
        let kinds: Vec<_> = kinds.filter(|path| path.is_dir()).collect();
        assert_eq!(kinds.len(), 1);
        assert!(kinds[0].join("complete").is_file() && kinds[0].join("bin/python").exists());
        let again = dir.succeed(format!("{SOLVE} --force"));
        assert!(!again.stderr.contains("making"), "{}", again.stderr);
    }
}
