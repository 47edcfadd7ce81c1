//! `tests/run`, the command that sets up a machine and runs all tests, with stand-ins for cargo and the package tools.

use std::path::Path;
use std::process::Command;

use crate::support::{Dir, Run, l4d, named, root, shipped};

/// What cargo prints where a test fails, a program of tests crashes, and a documentation test fails.
const SAID: &str = "   Compiling l4d-data v0.1.0
     Running unittests src/lib.rs (target/debug/deps/l4d_data-0123456789abcdef)
running 3 tests
test a ... ok
test deep::b ... FAILED
failures:

---- deep::b stdout ----
    an indented line of its output

failures:
    deep::b

test result: FAILED. 1 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s

     Running tests/gpu/main.rs (target/debug/deps/gpu-0123456789abcdef)
running 1 test
error: test failed, to rerun pass `-p l4d-gpu --test gpu`
     Running tests/main.rs (target/debug/deps/e2e-0123456789abcdef)
test result: ok. 40 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out; finished in 0.00s

   Doc-tests l4d_data
failures:

failures:
    src/lib.rs - (line 3)

test result: FAILED. 0 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s
";

/// A machine without anything that `tests/packages.txt` lists, as far as its path, its loader and its folders say.
fn bare_machine() -> Dir {
    let dir = Dir::new();
    let tools = ["bash", "env", "dirname", "mkdir", "tee", "awk", "cat"];
    let path = std::env::var_os("PATH").unwrap();
    for tool in tools {
        let found = std::env::split_paths(&path).map(|folder| folder.join(tool)).find(|file| file.is_file());
        link(&dir, tool, &found.unwrap());
    }
    dir.write("libraries", "");
    stand_in(&dir, "ldconfig", "cat libraries");
    stand_in(&dir, "id", "echo \"${USER_ID:-0}\"");
    stand_in(&dir, "cargo", "echo \"$@\" >>cargo.log; cat said; exit \"${CARGO_ENDS:-0}\"");
    dir.write("said", "test result: ok. 5 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out;\n");
    dir
}

fn link(dir: &Dir, name: &str, to: &Path) {
    dir.write("bin/.folder", "");
    std::os::unix::fs::symlink(to, dir.path("bin").join(name)).unwrap();
}

/// A program on the machine's path that runs this in the machine's folder.
fn stand_in(dir: &Dir, name: &str, script: &str) {
    let place = format!("bin/{name}");
    dir.write(&place, format!("#!/usr/bin/env bash\ncd \"$MACHINE\"\n{script}\n"));
    std::fs::set_permissions(dir.path(&place), std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
}

/// An `apt-get` that brings all that is recognised, at once, and writes down how it was called.
fn with_apt(dir: &Dir) {
    let programs = "for name in cc kill python3 uv tmux chromium; do echo >\"bin/$name\"; chmod +x \"bin/$name\"; done
        mkdir -p share/vulkan/icd.d; echo >share/vulkan/icd.d/lvp.json
        for name in libX11.so.6 libXrender.so.1 libXfixes.so.3 libXi.so.6 libxkbcommon.so.0 libGL.so.1 libvulkan.so.1; do
            echo \"$name (libc6) => /usr/lib/$name\" >>libraries; done";
    stand_in(dir, "apt-get", &format!("echo \"$@\" >>apt.log\n[[ $1 == update ]] && exit 1\n{programs}"));
    let chmod = ["/bin/chmod", "/usr/bin/chmod"].into_iter().map(Path::new).find(|file| file.is_file());
    link(dir, "chmod", chmod.unwrap());
}

fn on(dir: &Dir, mut command: Command) -> Command {
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "L4D_CHROMIUM"] {
        command.env_remove(variable);
    }
    command.env("PATH", dir.path("bin")).env("MACHINE", dir.path("")).env("XDG_DATA_DIRS", dir.path("share"));
    command.env("CARGO_TARGET_DIR", dir.path("target")).current_dir(root());
    command
}

fn tests(dir: &Dir) -> Command {
    let mut command = on(dir, Command::new(dir.path("bin/bash")));
    command.arg("tests/run");
    command
}

fn run(mut command: Command) -> Run {
    command.output().unwrap().into()
}

/// What is listed, in its order.
fn packages() -> Vec<String> {
    let lines = shipped("tests/packages.txt");
    let lines = lines.lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| line.split_whitespace().next().unwrap().to_owned()).collect()
}

#[test]
fn what_lacks_is_installed_and_all_ends_with_one_summary() {
    let dir = bare_machine();
    with_apt(&dir);
    dir.write("said", SAID);
    let mut command = tests(&dir);
    command.env("CARGO_ENDS", "101");
    let done = run(command);
    assert_eq!(done.code, 1, "{:?}", done.stderr);
    let calls = dir.read("apt.log");
    let (first, second) = calls.trim_end().split_once('\n').unwrap();
    assert_eq!(first, "update -qq");
    // The machine that the tests run on may have a driver in `/etc/vulkan`, where every loader looks.
    for package in packages().iter().filter(|package| *package != "mesa-vulkan-drivers") {
        assert!(second.split(' ').any(|word| word == package), "{package}: {second}");
    }
    assert_eq!(dir.read("cargo.log"), "test --workspace --locked --no-fail-fast\n");
    let (_, summary) = done.stdout.rsplit_once("\nfailed:\n").unwrap();
    let expected = format!(
        "    l4d_data deep::b\n    gpu: ended without a result\n    documentation of l4d_data src/lib.rs - (line 3)\n\n\
         41 passed, 3 failed, 3 ignored (slow suites: CONTRIBUTING.md); all output is in {}\n",
        dir.path("target/tests.log").display()
    );
    assert_eq!(summary, expected);
    assert_eq!(dir.read("target/tests.log"), SAID);

    // Nothing is installed twice, and what passes ends with 0.
    dir.remove("apt.log");
    dir.write("said", "     Running x (x-0)\ntest result: ok. 5 passed; 0 failed; 1 ignored; 0 measured;\n");
    let done = run(tests(&dir));
    assert!(done.code == 0 && done.stdout.contains("\n5 passed, 0 failed, 1 ignored"), "{:?}", done.stdout);
    assert!(!done.stdout.contains("failed:") && !dir.path("apt.log").exists(), "{:?}", done.stdout);

    // Cargo that stops before any test is a failure of its own.
    dir.write("said", "error: could not compile `l4d-data`\n");
    let mut command = tests(&dir);
    command.env("CARGO_ENDS", "101");
    let done = run(command);
    assert_eq!(done.code, 1);
    assert!(done.stdout.contains("\nfailed:\n    cargo itself"), "{:?}", done.stdout);
}

#[test]
fn who_may_not_install_is_told_the_packages_before_cargo_starts() {
    let dir = bare_machine();
    let refused = |dir: &Dir, user: &str, parts: &[&str]| {
        let mut command = tests(dir);
        command.env("USER_ID", user);
        let done = run(command);
        assert_eq!(done.code, 1, "{:?}", done.stdout);
        for part in parts.iter().copied().chain(["libxfixes3", "tmux", "chromium", "python3.11-venv"]) {
            assert!(done.stderr.contains(part), "{part}: {:?}", done.stderr);
        }
        assert!(!dir.path("cargo.log").exists());
    };
    refused(&dir, "0", &["no apt-get here"]);
    with_apt(&dir);
    refused(
        &dir,
        "1000",
        &["no right to install", "sudo apt-get install --no-install-recommends build-essential"],
    );
    stand_in(&dir, "sudo", "exit 1");
    refused(&dir, "1000", &["no right to install"]);
    assert!(!dir.path("apt.log").exists());

    // `sudo` that asks for nothing is used.
    stand_in(&dir, "sudo", "printf '%s\\n' \"$*\" >>sudo.log; shift; exec \"$@\"");
    stand_in(&dir, "true", "");
    let mut command = tests(&dir);
    command.env("USER_ID", "1000");
    let done = run(command);
    assert_eq!(done.code, 0, "{:?}", done.stderr);
    assert!(dir.read("sudo.log").starts_with("-n true\n-n apt-get update"), "{}", dir.read("sudo.log"));
}

#[test]
fn the_doctor_prints_the_same_list() {
    let dir = bare_machine();
    let doctor = |dir: &Dir| run(on(dir, l4d("doctor --tests --json")));
    let (bare, listed) = (doctor(&dir), packages());
    assert_eq!(bare.code, 1, "{bare}");
    let document = bare.value();
    let names: Vec<&str> =
        document["doctor"].as_array().unwrap().iter().map(|line| line["name"].as_str().unwrap()).collect();
    assert_eq!(names, listed);
    assert_eq!(named(&document["doctor"], "tmux")["state"], "missing");
    run(on(&dir, l4d("doctor --tests")))
        .says(1, &["MISSING tmux", "apt-get install tmux", "the annotation screen"]);
    with_apt(&dir);
    assert_eq!(run(tests(&dir)).code, 0);
    let whole = doctor(&dir);
    assert_eq!(whole.code, 0, "{whole}");
    let check = run({
        let mut command = tests(&dir);
        command.arg("--check");
        command
    });
    assert!(check.code == 0 && check.stdout.lines().count() == listed.len(), "{check}");
}

#[test]
fn continuous_integration_has_no_list_of_its_own() {
    let ci = shipped(".ci/run");
    assert!(ci.ends_with("\ntests/run\n"), "{ci}");
    for package in packages() {
        assert!(!ci.contains(&package) && !shipped("tests/run").contains(&package), "{package}");
    }
}
