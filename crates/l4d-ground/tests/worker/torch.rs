//! The workers with networks, on tiny random models of the real classes that `workers/tests/tiny_models.py` writes.

use std::process::Command;

use super::*;

/// The Python of the workers' environment, if the slow suite is asked for.
fn python() -> Option<PathBuf> {
    std::env::var_os("L4D_WORKERS_PYTHON").map(PathBuf::from)
}

#[test]
fn networks_load_and_answer_through_the_protocol() {
    let Some(python) = python() else { return };
    let setting = Setting::new();
    let models = setting.folder.path().join("models");
    let script = here().join("workers/tests/tiny_models.py");
    let made = Command::new(&python).arg(script).arg(&models).env("OMP_NUM_THREADS", "1").status().unwrap();
    assert!(made.success());
    let open = |name: &str, model: &str| {
        let folder = models.join(model).display().to_string();
        let launch = shipped(&python, &[name, "--model", &folder, "--device", "cpu", "--threads", "1"]);
        setting.segmenter(launch, Patience { hello: Duration::from_secs(300), ..Patience::default() })
    };
    let clip = clip(64, 48, &[0, 12, 24, 36, 48]);

    let sam2 = open("sam2-hf", "sam2");
    let prompt = ClipPrompt::Box { object: 1, frame: 24, box_px: [10.0, 10.0, 30.0, 30.0] };
    let found = sam2.segment(&clip, &[prompt], None).unwrap();
    assert_eq!(found.objects.len(), 1);
    let frames: Vec<u32> = found.objects[0].masks.keys().copied().collect();
    assert_eq!(frames, [0, 12, 24, 36, 48], "followed both ways");
    assert!(found.objects[0].score.is_some());
    assert_eq!(sam2.identity()["worker"]["deps"]["transformers"], "5.23.0");

    let grounder = TextGrounder::new(open("sam3-hf", "sam3")).unwrap();
    let grounding = grounder.ground(&clip, &question("red cup"));
    assert!(grounding.outcome.is_answer(), "{grounding:?}");
    assert_eq!(grounding.masks.len(), 5);
    let long = grounder.ground(&clip, &question("the cup that is moved from left to right by the hand"));
    assert!(matches!(long.outcome, Outcome::Unsupported(_)), "{long:?}");
}
