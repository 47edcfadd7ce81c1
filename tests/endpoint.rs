//! `l4d endpoint`: against a scripted server, and (slow) against real ones with a tiny random model.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use l4d_endpoint::{
    BoxPx, CacheUse, Client, Convention, Endpoint, EndpointError, Finish, Image, Link, Message, Origin, Part,
    Request, Schema,
};
use l4d_frames::targets::Targets;
use serde_json::{Value, json};

use crate::proposing::scripted::{Server, Turn, ok, says, status, thinks};
use crate::support::{Dir, Run, root};

const KEY: &str = "sk-canary/7Yq+0123456789";

fn flags<'a>(server: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["endpoint"], &more[..1], &["--base-url", server, "--model", "tiny"], &more[1..]].concat()
}

/// States by name, from `check --json`.
fn states(document: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let lines = document["check"].as_array().unwrap();
    lines.iter().map(|line| (text(&line["name"]), text(&line["state"]))).collect()
}

#[test]
fn check_tells_what_works_and_exits_by_it() {
    let dir = Dir::new();
    let server = Server::start(vec![says("ready")]);
    let run = dir.succeed(&flags(&server.url(), &["check"]));
    assert!(run.stdout.lines().any(|line| line.starts_with("ok      chat")), "{}", run.stdout);
    let document = dir.json(&flags(&server.url(), &["check"]));
    assert_eq!(document["endpoint"]["model"], "tiny");
    assert!(states(&document).contains(&("schema".to_owned(), "lacking".to_owned())), "{document}");

    let down = Server::start(vec![says("x")]).url();
    let run = dir.run(&flags(&down, &["check"]));
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stdout.contains("FAILED  chat") && run.stdout.contains("start the server"), "{}", run.stdout);
}

#[test]
fn a_server_on_this_machine_is_asked_without_a_proxy() {
    let server = Server::start(vec![says("ready")]);
    let dir = Dir::new();
    let mut command = Command::new(env!("CARGO_BIN_EXE_l4d"));
    for variable in ["HTTP_PROXY", "http_proxy", "ALL_PROXY"] {
        command.env(variable, "http://127.0.0.1:9");
    }
    for variable in ["NO_PROXY", "no_proxy"] {
        command.env_remove(variable);
    }
    let url = server.url();
    let output = command.args(flags(&url, &["check"])).current_dir(dir.path("")).output().unwrap();
    assert_eq!(Run::from(output).code, 0);
}

#[test]
fn an_endpoint_must_be_named_and_soundly() {
    let dir = Dir::new();
    dir.write("bad.toml", "base_url = \"http://localhost:1/v1\"\nmodel = \"m\"\napi_key = \"sk-canary\"\n");
    let cases: [(&[&str], &str); 6] = [
        (&["endpoint", "check"], "--base-url"),
        (
            &["endpoint", "check", "--base-url", "http://me:sk-canary@h/v1", "--model", "m"],
            "user name or password",
        ),
        (
            &["endpoint", "check", "--base-url", "http://h/v1", "--model", "m", "--api-key-env", "sk-canary"],
            "never the key",
        ),
        (&["endpoint", "check", "--base-url", "http://h/v1", "--model", "m", "--server", "vlm"], "llama-cpp"),
        (&["endpoint", "check", "--endpoint", "bad.toml"], "unknown field"),
        (&["endpoint", "check", "--link", "replay:nowhere"], "nowhere/endpoint.json"),
    ];
    for (arguments, words) in cases {
        let run = dir.run(arguments);
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(run.stderr.contains(words) && run.stderr.contains("hint:"), "{arguments:?}: {}", run.stderr);
        assert!(!run.stderr.contains("canary"), "{}", run.stderr);
    }
}

#[test]
fn a_recorded_check_replays_without_its_server() {
    let dir = Dir::new();
    let recorded = {
        let server = Server::start(vec![says("ready")]);
        dir.succeed(&flags(&server.url(), &["check", "--link", "record:tape"]))
    };
    let replayed = dir.succeed(&["endpoint", "check", "--link", "replay:tape"]);
    assert_eq!(replayed.stdout, recorded.stdout);
    assert_eq!(replayed.stderr, recorded.stderr);
    let lost = dir.succeed(&["endpoint", "calibrate", "--help"]);
    assert!(lost.stdout.contains("--pictures"));
    let run = dir.run(&["endpoint", "calibrate", "--link", "replay:tape"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("tape: holds no answer") && run.stderr.contains("record:"), "{}", run.stderr);
}

fn files_under(folder: &Path) -> String {
    let mut contents = String::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => contents += &files_under(&path),
            false => contents += &String::from_utf8_lossy(&std::fs::read(&path).unwrap()),
        }
    }
    contents
}

#[test]
fn a_key_is_told_to_its_server_alone_even_when_everything_is_logged() {
    let echo = |code: u16| {
        thinks(move |seen| {
            let header = seen.headers.get("authorization").cloned().unwrap_or_default();
            match code {
                200 => says(&format!("your header is {header}")),
                _ => status(code, &json!({"error": {"message": format!("wrong header {header}")}})),
            }
        })
    };
    for code in [200, 401, 500] {
        let server = Server::start(vec![echo(code)]);
        let dir = Dir::new();
        let base_url = server.url();
        dir.write(
            "e.toml",
            format!("base_url = \"{base_url}\"\nmodel = \"tiny\"\napi_key_env = \"L4D_CANARY\"\n"),
        );
        let output = Command::new(env!("CARGO_BIN_EXE_l4d"))
            .args(["-v", "endpoint", "check", "--endpoint", "e.toml", "--link", "record:tape"])
            .current_dir(dir.path(""))
            .env("RUST_LOG", "trace,ureq=trace,ureq_proto=trace,rustls=trace")
            .env("L4D_CANARY", KEY)
            .output()
            .unwrap();
        let run = Run::from(output);
        assert_eq!(run.code, i32::from(code != 200), "{}", run.stderr);
        let sent = format!("Bearer {KEY}");
        assert!(server.seen().iter().all(|seen| seen.headers["authorization"] == sent));
        let output = format!("{}{}{}", run.stdout, run.stderr, files_under(&dir.path("")));
        assert!(output.contains("[redacted]"), "nothing was echoed:\n{output}");
        assert!(!output.contains("canary"), "{output}");
        // Its bytes in the tables of a wire log would pass the test above.
        assert!(!run.stderr.to_lowercase().contains("authorization"), "{}", run.stderr);
        assert!(!run.stderr.contains("ureq"), "{}", run.stderr);
    }
}

/// A model that writes the squares of the pictures that `calibrate` draws, in the order in which it asks.
fn sighted(convention: &'static Convention, size: (u32, u32), pictures: u32) -> Turn {
    let asked = AtomicU32::new(0);
    thinks(move |_| {
        let number = asked.fetch_add(1, Ordering::SeqCst) % pictures;
        let targets = Targets::arrange(size.0, size.1, number);
        let boxes = targets.squares().iter().map(|square| {
            let [x, y, side] = [square.x, square.y, square.side_px].map(f64::from);
            let place = BoxPx { x0: x, y0: y, x1: x + side, y1: y + side };
            json!({ convention.key.clone(): convention.numbers(place, size), "label": square.colour })
        });
        says(&Value::from_iter(boxes).to_string())
    })
}

#[test]
fn calibrate_finds_and_remembers_the_convention() {
    let dir = Dir::new();
    for convention in Convention::all() {
        let server = Server::start(vec![sighted(convention, (714, 490), 2)]);
        let document = dir.json(&flags(&server.url(), &["calibrate"]));
        assert_eq!(document["winner"]["convention"], convention.name.as_str(), "{document}");
        assert_eq!(document["squares"], 8);
        assert!(document["winner"]["mean_iou"].as_f64().unwrap() > 0.99, "{document}");
    }
    let remembered: Value = serde_json::from_str(&dir.read("work/endpoints.json")).unwrap();
    assert_eq!(remembered.as_object().unwrap().len(), Convention::all().len());
    assert!(remembered.as_object().unwrap().values().all(|one| one["size"] == json!([714, 490])));

    // In a picture whose sides are multiples of 28, resizing by 28 changes nothing: two conventions fit.
    let server = Server::start(vec![sighted(Convention::named("abs_px_xyxy").unwrap(), (700, 504), 1)]);
    let run = dir.run(&flags(&server.url(), &["calibrate", "--size", "700x504", "--pictures", "1"]));
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("fit about as well") && run.stderr.contains("coordinates"), "{}", run.stderr);
}

#[test]
fn calibrate_says_when_nothing_fits_and_forgets_what_did() {
    let dir = Dir::new();
    let mut turns = vec![sighted(&Convention::all()[0], (714, 490), 1); 3];
    turns.push(says(r#"[{"bbox_2d": [1, 2, 3, 4], "label": "red"}]"#));
    let server = Server::start(turns);
    let url = server.url();
    let calibrate = flags(&url, &["calibrate", "--pictures", "1"]);
    dir.succeed(&calibrate);
    assert!(dir.read("work/endpoints.json").contains("rel1000_xyxy"));
    let run = dir.run(&calibrate);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("no convention fits") && run.stderr.contains("hint:"), "{}", run.stderr);
    assert_eq!(dir.read("work/endpoints.json").trim(), "{}");
    let bad_size = dir.run(&flags(&url, &["calibrate", "--size", "714"]));
    assert_eq!(bad_size.code, 2);

    // An error of the server is an error, not a model that sees nothing.
    let server = Server::start(vec![ok(&json!({"error": "out of memory"}))]);
    let run = dir.run(&flags(&server.url(), &["calibrate"]));
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("out of memory"), "{}", run.stderr);
}

/// A server process; ends with the test.
pub(crate) struct Process {
    child: Child,
    pub(crate) base_url: String,
}

impl Process {
    /// Starts one and waits until it answers.
    pub(crate) fn start(mut command: Command, port: u16) -> Self {
        let log = Stdio::null;
        let child = command.stdin(Stdio::null()).stdout(log()).stderr(log()).spawn().unwrap();
        let mut process = Self { child, base_url: format!("http://127.0.0.1:{port}/v1") };
        let deadline = Instant::now() + Duration::from_secs(300);
        while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(process.child.try_wait().unwrap().is_none(), "{command:?} ended");
            assert!(Instant::now() < deadline, "{command:?} does not answer");
            std::thread::sleep(Duration::from_millis(200));
        }
        process
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

pub(crate) fn free_port() -> u16 {
    std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// The folder of the environment that `tests/endpoint_server/setup.sh` makes, and a tiny model in it.
pub(crate) fn environment() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::var_os("L4D_ENDPOINT_SERVER").map(PathBuf::from);
        let folder = folder.unwrap_or_else(|| root().join("work/endpoint-server"));
        let script = root().join("tests/endpoint_server/setup.sh");
        let made = Command::new("bash").arg(script).arg(&folder).status().unwrap();
        assert!(made.success(), "tests/endpoint_server/setup.sh failed");
        folder
    })
}

pub(crate) fn python(folder: &Path, program: &str) -> Command {
    let mut command = Command::new(folder.join("bin").join(program));
    command.env("HF_HUB_OFFLINE", "1").env("OMP_NUM_THREADS", "1");
    command
}

fn with_pictures(schema: Option<Value>) -> Request {
    let picture = |number| Part::Image(Image::new(Targets::arrange(320, 240, number).png()).unwrap());
    let mut parts = Vec::new();
    for number in 0..3 {
        parts.push(Part::text(format!("<{number}.0 seconds>")));
        parts.push(picture(number));
    }
    parts.push(Part::text("Which square moves?"));
    let request = Request::new(vec![Message::user(parts)]).with_max_tokens(200);
    match schema {
        Some(value) => request.with_schema(Schema::new("boxes", value)),
        None => request,
    }
}

fn boxes_schema() -> Value {
    let number = json!({"type": "integer", "minimum": 0, "maximum": 1000});
    let item = json!({
        "type": "object",
        "properties": {
            "bbox_2d": {"type": "array", "minItems": 4, "maxItems": 4, "items": number},
            "label": {"type": "string", "enum": ["red", "green"]},
        },
        "required": ["bbox_2d", "label"],
        "additionalProperties": false,
    });
    json!({
        "type": "object",
        "properties": {"boxes": {"type": "array", "minItems": 1, "maxItems": 2, "items": item}},
        "required": ["boxes"],
        "additionalProperties": false,
    })
}

#[test]
#[ignore = "slow: makes a Python environment with a model server"]
fn a_real_server_with_a_grammar() {
    let folder = environment();
    let port = free_port();
    let mut command = python(folder, "python");
    command.arg(root().join("tests/endpoint_server/serve.py")).arg(folder.join("tiny")).arg(port.to_string());
    let server = Process::start(command, port);
    let dir = Dir::new();

    let document = dir.json(&flags(&server.base_url, &["check"]));
    let states = states(&document);
    for (name, state) in
        [("models", "ok"), ("usage", "ok"), ("schema", "ok"), ("seed", "ok"), ("picture", "unclear")]
    {
        assert!(states.contains(&(name.to_owned(), state.to_owned())), "{document:#}");
    }
    // Random weights see nothing.
    let calibrated =
        dir.run(&flags(&server.base_url, &["calibrate", "--pictures", "1", "--answer-tokens", "64"]));
    assert_eq!(calibrated.code, 1, "{}", calibrated.stderr);
    assert!(calibrated.stderr.contains("no convention fits"));

    let endpoint = Endpoint::new(&server.base_url, "tiny").unwrap();
    let open = || {
        let client = Client::open(endpoint.clone(), &Link::Live).unwrap();
        client.with_cache(&dir.path("answers"), CacheUse::Take)
    };
    let request = with_pictures(Some(boxes_schema()));
    let ask = || {
        let reply = open().ask(&request).unwrap();
        (reply.json::<Value>().unwrap(), reply)
    };
    let (value, reply) = ask();
    assert_eq!(
        l4d_endpoint::coordinates::written_boxes(&value).len(),
        value["boxes"].as_array().unwrap().len()
    );
    // 320x240 becomes 320x256: 10 x 8 tokens a picture, as the server counts.
    assert!(reply.usage.prompt_tokens.unwrap() >= 3 * 80, "{:?}", reply.usage);
    assert!(reply.notes.is_empty() && reply.finish == Finish::Stop, "{reply:?}");
    let (again, kept) = ask();
    assert_eq!((again, kept.origin), (value.clone(), Origin::Cache));
    open().forget(&request).unwrap();
    let (third, fresh) = ask();
    assert_eq!((third, fresh.origin), (value, Origin::Server), "temperature 0 gives one answer");

    let mut unknown = endpoint.clone();
    unknown.model = "huge".to_owned();
    let error = Client::open(unknown, &Link::Live).unwrap().ask(&request).unwrap_err();
    assert!(error.to_string().contains("HTTP 404"), "{error:?}");
    let slow = Request::new(vec![Message::user(vec![Part::text("Go on and on.")])]).with_max_tokens(60_000);
    let mut hurried = endpoint.clone();
    hurried.timeouts.request_seconds = 1.0;
    hurried.retry.tries = 1;
    let error = Client::open(hurried, &Link::Live).unwrap().ask(&slow).unwrap_err();
    assert!(error.to_string().contains("timeout"), "{error}");
}

#[test]
#[ignore = "slow: makes a Python environment with a model server"]
fn a_real_server_of_transformers() {
    let folder = environment();
    let port = free_port();
    let model = folder.join("tiny").display().to_string();
    let mut command = python(folder, "transformers");
    command.args(["serve", &model, "--device", "cpu", "--port", &port.to_string()]);
    let server = Process::start(command, port);
    let dir = Dir::new();
    let mut endpoint = Endpoint::new(&server.base_url, &model).unwrap();
    endpoint.server = "transformers".to_owned();
    let client = Client::open(endpoint, &Link::Record(dir.path("tape"))).unwrap();
    let reply = client.ask(&with_pictures(Some(boxes_schema()))).unwrap();
    assert!(reply.usage.prompt_tokens.unwrap() >= 3 * 80, "{:?}", reply.usage);
    // It ignores the schema, and random weights never come to an end.
    assert_eq!(reply.finish, Finish::Length);
    assert!(matches!(reply.json::<Value>(), Err(EndpointError::Truncated { .. })));

    let replay = Link::Replay(dir.path("tape"));
    let endpoint = Endpoint::recorded(&dir.path("tape")).unwrap();
    let mut replayed =
        Client::open(endpoint, &replay).unwrap().ask(&with_pictures(Some(boxes_schema()))).unwrap();
    replayed.origin = Origin::Server;
    assert_eq!(replayed, reply);

    let arguments =
        ["endpoint", "check", "--base-url", &server.base_url, "--model", &model, "--server", "transformers"];
    let document = dir.json(&arguments);
    let states = states(&document);
    for (name, state) in [("chat", "unclear"), ("usage", "ok"), ("schema", "lacking"), ("picture", "unclear")]
    {
        assert!(states.contains(&(name.to_owned(), state.to_owned())), "{document:#}");
    }
}
