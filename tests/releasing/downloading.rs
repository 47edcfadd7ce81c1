//! `l4d download`: from a release, over HTTP and from a folder, to what the verbs work on.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, sleep};
use std::time::Duration;

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::{Profile, Scene};
use l4d_frames::Display;
use l4d_frames::exr::read_frame;

use super::{RELEASE, expect, published};

/// Into folders beside those of the release.
const THERE: &str = "--bench there/benchmark --data there/data/tiny --work there/work";
const SHARD: &str = "shards/tiny/room_living_cats-train-000.tar";

/// A server of files on this machine that knows ranges.
struct Server {
    port: u16,
    state: Arc<State>,
    thread: Option<JoinHandle<()>>,
}

struct State {
    folder: PathBuf,
    /// Path and first byte of each request.
    seen: Mutex<Vec<(String, u64)>>,
    /// So many bytes of shards are sent before the line goes silent.
    shard_bytes: AtomicU64,
    ended: AtomicBool,
}

impl Server {
    fn start(folder: PathBuf, shard_bytes: u64) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let state = Arc::new(State {
            folder,
            seen: Mutex::default(),
            shard_bytes: shard_bytes.into(),
            ended: AtomicBool::new(false),
        });
        let shared = Arc::clone(&state);
        let thread = std::thread::spawn(move || {
            for stream in listener.incoming() {
                if shared.ended.load(Ordering::SeqCst) {
                    return;
                }
                let state = Arc::clone(&shared);
                // The other side may leave at any time; that is its right.
                std::thread::spawn(move || state.serve(stream.unwrap()).ok());
            }
        });
        Self { port, state, thread: Some(thread) }
    }

    fn url(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    fn seen(&self) -> Vec<(String, u64)> {
        self.state.seen.lock().unwrap().clone()
    }
}

impl State {
    fn serve(&self, stream: TcpStream) -> std::io::Result<()> {
        let mut lines = BufReader::new(stream.try_clone()?).lines();
        let first = lines.next().unwrap()?;
        let path = first.split(' ').nth(1).unwrap().trim_start_matches('/').to_owned();
        let mut from = 0;
        for line in lines {
            let line = line?.to_ascii_lowercase();
            if line.is_empty() {
                break;
            }
            if let Some(range) = line.strip_prefix("range: bytes=") {
                from = range.trim_end_matches('-').parse().unwrap();
            }
        }
        self.seen.lock().unwrap().push((path.clone(), from));
        let mut out = &stream;
        let Ok(bytes) = fs::read(self.folder.join(&path)) else {
            return write!(out, "HTTP/1.1 404 Not Found\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
        };
        let rest = &bytes[from as usize..];
        let (status, range) = match from {
            0 => ("200 OK", String::new()),
            _ => (
                "206 Partial Content",
                format!("content-range: bytes {from}-{}/{}\r\n", bytes.len() - 1, bytes.len()),
            ),
        };
        write!(
            out,
            "HTTP/1.1 {status}\r\n{range}content-length: {}\r\nconnection: close\r\n\r\n",
            rest.len()
        )?;
        let allowed =
            if path.starts_with("shards/") { self.shard_bytes.load(Ordering::SeqCst) } else { u64::MAX };
        out.write_all(&rest[..rest.len().min(usize::try_from(allowed).unwrap_or(usize::MAX))])?;
        while (allowed as usize) < rest.len() && !self.ended.load(Ordering::SeqCst) {
            sleep(Duration::from_millis(20));
        }
        Ok(())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.state.ended.store(true, Ordering::SeqCst);
        TcpStream::connect(("127.0.0.1", self.port)).ok();
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

/// Demands that a downloaded scene shows, picture by picture, what the built one does.
fn expect_same_pictures(built: &Path, downloaded: &Path, scene: &str) {
    let (built, downloaded) = (SceneDir::new(built, scene), SceneDir::new(downloaded, scene));
    let scene = Scene::read(&downloaded.scene()).unwrap();
    let display = Display::new(scene.exposure);
    for camera in scene.cameras {
        let view = camera.name;
        for frame in Profile::Tiny.frames() {
            let [a, b] = [&built, &downloaded]
                .map(|dir| read_frame(&dir.frame(&view, frame), UVec2::new(128, 96)).unwrap());
            assert_eq!(a.surfaces.digest(), b.surfaces.digest(), "{view} {frame}");
            assert!(display.picture(&a) == display.picture(&b), "{view} {frame}");
        }
    }
}

#[test]
fn what_was_released_comes_back() {
    let dir = published();
    let server = Server::start(dir.path(RELEASE), u64::MAX);
    let line = format!("download {} {THERE}", server.url());
    dir.succeed(&line).says(0, &["Two 0.1.0: 2 scenes", "0 here already", "tables are in"]);
    assert_eq!(dir.tree("there/benchmark"), dir.tree("benchmark"));
    for scene in ["room_living_cats", "tabletop_mouse_cups"] {
        expect_same_pictures(&dir.path("data/tiny"), &dir.path("there/data/tiny"), scene);
    }
    assert_eq!(dir.tree("there/work/tiny"), dir.tree("work/tiny"));
    let asked = server.seen().len();
    dir.succeed(&line).says(0, &["0 files of the release fetched"]);
    assert_eq!(server.seen().len(), asked + 2, "lists alone are asked for again");

    let verify = format!("{line} --verify-only --json");
    expect(&dir.run(&verify), &[]);
    let frame = "there/data/tiny/room_living_cats/frames/cam00/0000.exr";
    let mut bytes = dir.bytes(frame);
    bytes[400] ^= 1;
    dir.write(frame, &bytes);
    expect(&dir.run(&verify), &[("L4D614", frame)]);
    dir.remove(frame);
    expect(&dir.run(&verify), &[("L4D612", frame)]);
    // What lacks is made again.
    dir.succeed(&line).says(0, &["1 file of the release fetched"]);
    expect(&dir.run(&verify), &[]);
    // Frames are compared with the digests of the list that was written, as those of a build are.
    let listed = dir.read("there/data/tiny/room_living_cats/SHA256SUMS");
    assert_eq!(listed.lines().count(), 5 * 9 + 3);
}

#[test]
fn a_killed_download_goes_on_where_it_was() {
    let dir = published();
    let whole = dir.path(RELEASE).join(SHARD).metadata().unwrap().len();
    let server = Server::start(dir.path(RELEASE), whole / 2);
    let line = format!("download {} {THERE} --scenes room_living_cats", server.url());
    let mut child = dir.spawn(&line);
    let part = || {
        let folders = fs::read_dir(dir.path("there/work/download")).ok()?;
        let path = folders.flatten().next()?.path().join(format!("{SHARD}.part"));
        Some(path.metadata().ok()?.len())
    };
    let begun = std::time::Instant::now();
    while part() != Some(whole / 2) {
        assert!(begun.elapsed() < Duration::from_secs(60), "{:?} of {whole}", part());
        sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    server.state.shard_bytes.store(u64::MAX, Ordering::SeqCst);
    dir.succeed(&line);
    let starts: Vec<u64> =
        server.seen().into_iter().filter(|(path, _)| path == SHARD).map(|(_, from)| from).collect();
    assert_eq!(starts, [0, whole / 2]);
    expect_same_pictures(&dir.path("data/tiny"), &dir.path("there/data/tiny"), "room_living_cats");
    assert!(!dir.path("there/data/tiny/tabletop_mouse_cups").exists());
    assert_eq!(part(), None);
}

#[test]
fn another_byte_is_refused_by_the_name_of_its_file() {
    let dir = published();
    let server = Server::start(dir.path(RELEASE), u64::MAX);
    let line = format!("download {} {THERE}", server.url());
    let file = format!("{RELEASE}/{SHARD}");
    let mut bytes = dir.bytes(&file);
    bytes[100_000] ^= 1;
    dir.write(&file, &bytes);
    dir.run(&line).says(2, &[SHARD, "SHA256SUMS", "hint:"]);
    assert!(!dir.path("there/data/tiny/room_living_cats/frames/cam00/0000.exr").exists());
    bytes[100_000] ^= 1;
    dir.write(&file, &bytes);
    dir.succeed(&line);
    // What somebody built or changed here is not replaced.
    let frame = "kept/tiny/room_living_cats/frames/cam00/0000.exr";
    dir.write(frame, "mine");
    dir.run(format!("download {RELEASE} --work kept-work --data kept/tiny --parts colour,depth,ids"))
        .says(2, &["cam00/0000.exr", "other content", "hint:"]);
    assert_eq!(dir.read(frame), "mine");
}

#[test]
fn only_what_is_asked_comes() {
    let dir = published();
    let refused = |more: &str, words: &[&str]| {
        dir.run(format!("download {RELEASE} {THERE} {more}")).says(2, words);
    };
    refused("--scenes room_livin_cats", &["room_livin_cats", "did you mean `room_living_cats`?"]);
    refused("--parts colour", &["--parts", "colour,depth"]);
    dir.run("download nowhere").says(2, &["nowhere", "no such folder"]);
    dir.run("download ftp://example.org").says(2, &["neither http nor https"]);

    let some = "--scenes room_living_cats --splits train --parts colour,depth";
    dir.succeed(format!("download {RELEASE} {THERE} {some}"));
    let there: BTreeMap<String, Vec<u8>> = dir.tree("there/data/tiny");
    assert!(there.keys().all(|name| name.starts_with("room_living_cats/")));
    assert_eq!(there.keys().filter(|name| name.ends_with(".exr")).count(), 4 * 9);
    assert!(!dir.path("there/benchmark").exists());
    // Frames without ids become frames with them when these are asked for.
    let all = "--scenes room_living_cats --parts colour,depth,ids";
    dir.succeed(format!("download {RELEASE} {THERE} {all}"));
    expect_same_pictures(&dir.path("data/tiny"), &dir.path("there/data/tiny"), "room_living_cats");
}
