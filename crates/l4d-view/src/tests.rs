use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use l4d_data::{Silent, json as files};
use l4d_splat::synthetic::Room;
use l4d_testing::{Dataset, name, query};
use serde_json::{Value, json};

use super::*;

/// A made-up scene with everything that a page shows.
struct Given {
    fake: Dataset,
    dir: SceneDir,
    rig: Rig,
    model: Model,
    truth: Truth,
    queries: Vec<Query>,
    methods: Vec<(String, ResultsDir)>,
}

impl Given {
    fn new() -> Self {
        let fake = Dataset::new();
        let dir = fake.dir();
        let truth = Truth::read(&fake.bench().truth(Profile::Tiny, &fake.scene.name)).unwrap();
        let queries = vec![query("yard/001", "The ball that </script> rolls", &["ball_red"], [24, 60])];
        let rig = Rig::read(&dir.scene()).unwrap();
        let model = Room::small(5).model().unwrap();
        Self { dir, rig, model, truth, queries, methods: Vec::new(), fake }
    }

    /// A method whose answer to the first sentence is this file.
    fn answer(&mut self, method: &str, file: &Value) {
        let folder = ResultsDir::new(self.fake.data().join("results").join(method));
        files::write(&folder.mask_file(&self.queries[0].id), file).unwrap();
        self.methods.push((method.to_owned(), folder));
    }

    fn request(&self) -> Request<'_> {
        Request {
            scene: &self.fake.scene.name,
            profile: Profile::Tiny,
            rig: &self.rig,
            model: &self.model,
            background: [0.0, 0.5, 1.0],
            near_m: 0.2,
            tracks: Some(&self.fake.tracks),
            rendered: Some((&self.fake.scene, &self.dir)),
            truth: Some(&self.truth),
            queries: &self.queries,
            methods: &self.methods,
            asks: None,
        }
    }
}

/// What is between a script's start and the next end of a script.
fn script<'a>(html: &'a str, id: &str) -> &'a str {
    let (_, after) = html.split_once(&format!("id=\"{id}\">")).unwrap();
    after.split_once("</script>").unwrap().0
}

fn document(html: &str) -> Value {
    serde_json::from_str(script(html, "document")).unwrap()
}

#[test]
fn a_page_holds_the_scene_and_asks_for_nothing() {
    let mut given = Given::new();
    given.answer("guess", &json!({"size": [96, 128], "frames": {"0000": null}}));
    let written = page(&given.request(), &Silent).unwrap();
    let counts = (written.gaussians, written.times, written.pictures, written.sentences);
    assert_eq!(counts, (400, 25, 45, 1));
    let html = String::from_utf8(written.html).unwrap();
    for address in ["http:", "https:", "src=", "@import", "{{"] {
        assert!(!html.contains(address), "{address}");
    }
    let document = document(&html);
    assert_eq!(document["clip"], json!([0, 96]));
    assert_eq!(document["cameras"].as_array().unwrap().len(), 5);
    assert_eq!(document["cameras"][2]["held_out"], true);
    assert_eq!(document["masks"], json!(["cam02", [128, 96]]));
    assert_eq!(document["instances"][0]["name"], "ball_red");
    assert_eq!(document["instances"][0]["centre"].as_array().unwrap().len(), 97);
    let sentence = &document["sentences"][0];
    assert_eq!(sentence["text"], "The ball that </script> rolls", "no text ends the element that holds it");
    assert_eq!(sentence["answers"], json!([{"0000": null}]));
    let ball = &given.truth.instance("ball_red").unwrap().masks["0048"];
    assert_eq!(sentence["truth"]["0048"], serde_json::to_value(ball).unwrap());
}

#[test]
fn a_block_of_pictures_is_as_long_as_its_files() {
    let given = Given::new();
    let html = String::from_utf8(page(&given.request(), &Silent).unwrap().html).unwrap();
    let pictures = &document(&html)["pictures"];
    assert_eq!((&pictures["width"], &pictures["colour"]), (&json!(128), &json!(true)));
    for album in pictures["cameras"].as_array().unwrap() {
        let id = format!("block-pictures-{}", album["name"].as_str().unwrap());
        let bytes = STANDARD.decode(script(&html, &id)).unwrap();
        let lengths: Vec<[usize; 3]> = serde_json::from_value(album["lengths"].clone()).unwrap();
        assert_eq!(bytes.len(), lengths.iter().flatten().sum::<usize>());
        let mut at = 0;
        for (length, start) in
            lengths.iter().flatten().zip([b"\xff\xd8", b"\xff\xd8", b"\x89P"].iter().cycle())
        {
            assert_eq!(&bytes[at..at + 2], *start);
            at += length;
        }
    }
}

#[test]
fn cameras_and_a_model_are_enough() {
    let given = Given::new();
    let bare = Request { tracks: None, rendered: None, truth: None, queries: &[], ..given.request() };
    let written = page(&bare, &Silent).unwrap();
    assert_eq!((written.pictures, written.sentences), (0, 0));
    let document = document(&String::from_utf8(written.html).unwrap());
    assert_eq!((&document["pictures"], &document["masks"]), (&Value::Null, &Value::Null));
}

#[test]
fn the_same_request_gives_the_same_bytes() {
    let given = Given::new();
    assert_eq!(page(&given.request(), &Silent).unwrap(), page(&given.request(), &Silent).unwrap());
}

#[test]
fn masks_of_another_size_and_a_fourth_method_are_refused() {
    let mut given = Given::new();
    given.answer("large", &json!({"size": [192, 256], "frames": {}}));
    let error = page(&given.request(), &Silent).unwrap_err();
    assert!(error.to_string().contains("256 x 192, but the truth is 128 x 96"), "{error}");
    for method in ["b", "c", "d"] {
        given.answer(method, &json!({"size": [96, 128], "frames": {}}));
    }
    let error = page(&given.request(), &Silent).unwrap_err();
    assert_eq!(
        (error.to_string().as_str(), error.hint()),
        ("4 methods, but a page shows 3", "choose 3 of them")
    );
}

#[test]
fn colours_are_those_of_contact_sheets() {
    use l4d_data::Role::{Landmark, Object};
    let colours = pictures::colours([Object, Landmark, Object, Landmark].into_iter());
    assert_eq!(colours[0], l4d_frames::overlay::object_colour(0).0);
    assert_eq!(colours[2], l4d_frames::overlay::object_colour(1).0);
    assert_ne!(colours[1], colours[3]);
    assert_eq!(name("yard"), Given::new().fake.scene.name);
}
