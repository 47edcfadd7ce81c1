//! What verbs that ask model servers share: keys, proxies, refusals; and (slow) the client against real servers with a
//! tiny random model.

use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use l4d_endpoint::coordinates::WrittenBox;
use l4d_endpoint::{
    CacheUse, Client, Endpoint, EndpointError, Finish, Image, Link, Message, Origin, Part, Request, Schema,
};
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use serde_json::{Value, json};

use crate::proposing::scripted::{Server, says, status, thinks};
use crate::support::{Dir, Run, root};

const KEY: &str = "sk-canary/7Yq+0123456789";

/// A question to a server about scenes of the benchmark.
const ASK: &str = "propose-scenes --scales room --out scenarios";

fn ask(dir: &Dir, more: &str) -> Command {
    let mut command = dir.command(format!("{ASK} {more}"));
    command.arg("--bench").arg(root().join("benchmark"));
    command
}

#[test]
fn a_server_on_this_machine_is_asked_without_a_proxy() {
    let server = Server::start(vec![says("no ideas")]);
    let dir = Dir::new();
    let mut command = ask(&dir, &format!("--base-url {} --vlm tiny", server.url()));
    for variable in ["HTTP_PROXY", "http_proxy", "ALL_PROXY"] {
        command.env(variable, "http://127.0.0.1:9");
    }
    command.env_remove("NO_PROXY").env_remove("no_proxy");
    command.output().unwrap();
    assert_eq!(server.count(), 1);
}

#[test]
fn an_endpoint_that_is_not_named_or_not_sound_is_refused() {
    let dir = Dir::new();
    dir.write("bad.toml", "base_url = \"http://localhost:1/v1\"\nmodel = \"m\"\napi_key = \"sk-canary\"\n");
    for (more, words) in [
        ("", "--base-url"),
        ("--base-url http://me:sk-canary@h/v1 --vlm m", "user name or password"),
        ("--base-url http://h/v1 --vlm m --api-key-env sk-canary", "never the key"),
        ("--base-url http://h/v1 --vlm m --server vlm", "llama-cpp"),
        ("--endpoint bad.toml", "unknown field"),
        ("--link replay:nowhere", "nowhere/endpoint.json"),
    ] {
        let run = Run::from(ask(&dir, more).output().unwrap());
        run.refused(&[words]);
        assert!(!run.stderr.contains("canary"), "{run}");
    }
}

/// The same for the eye.
fn hidden(text: &str) -> String {
    text.chars().flat_map(|letter| [letter, '\u{200b}']).collect()
}

#[test]
fn a_key_goes_to_its_server_alone_even_when_everything_is_logged() {
    let echo = |code: u16| {
        thinks(move |seen| {
            let header = seen.headers.get("authorization").cloned().unwrap_or_default();
            match code {
                200 => says(&format!("your header is {header} {}", hidden(&header))),
                _ => status(code, &json!({"error": {"message": format!("{header} {}", hidden(&header))}})),
            }
        })
    };
    for code in [200, 401, 500] {
        let server = Server::start(vec![echo(code)]);
        let dir = Dir::new();
        let base_url = server.url();
        let text = format!(
            "base_url = \"{base_url}\"\nmodel = \"tiny\"\napi_key_env = \"L4D_CANARY\"\n[retry]\ntries = 1\n"
        );
        dir.write("e.toml", text);
        let mut command = ask(&dir, "--endpoint e.toml --link record:tape -v");
        command.env("RUST_LOG", "trace,ureq=trace,ureq_proto=trace,rustls=trace").env("L4D_CANARY", KEY);
        let run = Run::from(command.output().unwrap());
        assert_eq!(run.code, 1, "no answer is a scene: {}", run.stderr);
        let sent = format!("Bearer {KEY}");
        assert!(server.seen().iter().all(|seen| seen.headers["authorization"] == sent));
        let files: Vec<u8> = dir.tree("").into_values().flatten().collect();
        let output = format!("{run}{}", String::from_utf8_lossy(&files));
        assert_eq!(output.contains("[redacted]"), code == 200, "only answers are kept:\n{output}");
        let visible: String = output.chars().filter(char::is_ascii_graphic).collect();
        assert!(!visible.replace("\\u200b", "").contains("canary/"), "{output}");
        // Its bytes in the tables of a wire log would pass the test above.
        let log = run.stderr.to_lowercase();
        assert!(!log.contains("authorization") && !log.contains("ureq"), "{run}");
    }
}

/// A server process; ends with the test.
pub(crate) struct Process {
    child: Child,
    pub(crate) base_url: String,
}

impl Process {
    /// Starts a program of [`environment`], with what it needs to know of a port, and waits until it answers.
    pub(crate) fn start(program: &str, arguments: impl FnOnce(&str) -> Vec<String>) -> Self {
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut command = Command::new(environment().join("bin").join(program));
        command.args(arguments(&port.to_string())).env("HF_HUB_OFFLINE", "1").env("OMP_NUM_THREADS", "1");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let child = command.spawn().unwrap();
        let mut process = Self { child, base_url: format!("http://127.0.0.1:{port}/v1") };
        let deadline = Instant::now() + Duration::from_secs(300);
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(process.child.try_wait().unwrap().is_none(), "{command:?} ended");
            assert!(Instant::now() < deadline, "{command:?} does not answer");
            std::thread::sleep(Duration::from_millis(200));
        }
        process
    }

    /// The server of `tests/endpoint_server`, which keeps to a schema.
    pub(crate) fn with_grammar() -> Self {
        let script = root().join("tests/endpoint_server/serve.py").display().to_string();
        Self::start("python", |port| vec![script, tiny_model(), port.to_owned()])
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

/// The folder of the environment that `tests/endpoint_server/setup.sh` makes.
fn environment() -> &'static Path {
    static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
        let folder = std::env::var_os("L4D_ENDPOINT_SERVER").map(PathBuf::from);
        let folder = folder.unwrap_or_else(|| root().join("work/endpoint-server"));
        let script = root().join("tests/endpoint_server/setup.sh");
        let made = Command::new("bash").arg(script).arg(&folder).status().unwrap();
        assert!(made.success(), "tests/endpoint_server/setup.sh failed");
        folder
    });
    &FOLDER
}

/// A tiny model in it.
fn tiny_model() -> String {
    environment().join("tiny").display().to_string()
}

fn with_pictures(schema: Option<Value>) -> Request {
    let picture = |number: u8| {
        let plain = RgbImage::from_pixel(320, 240, Rgb([200, 60 * number, 30]));
        Part::Image(Image::new(encode_colour(&plain)).unwrap())
    };
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
    let server = Process::with_grammar();
    let dir = Dir::new();

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
    assert!(
        value["boxes"].as_array().unwrap().iter().all(|found| WrittenBox::of(found).is_some()),
        "{value}"
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
    let model = tiny_model();
    let server = Process::start("transformers", |port| {
        ["serve", &model, "--device", "cpu", "--port", port].map(str::to_owned).into()
    });
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
}
