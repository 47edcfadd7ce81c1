//! `l4d doctor`: one line for each thing that a stage needs, and what to do where it is missing.

use std::borrow::Cow;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::Result;
use l4d_blender::env::{BlenderEnv, Probe, environment_python, import_hint, probe};
use l4d_data::Benchmark;
use l4d_data::counted;
use serde::Serialize;
use serde_json::json;

use crate::cli::scenes::DoctorArgs;
use crate::out::{ExitStatus, Printer, refusal};
use crate::shipped;

/// Free space that a `full` build of the benchmark wants.
const WANTED_DISK_GIB: u64 = 20;

/// Whether a stage can run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum State {
    /// There.
    Ok,
    /// Lacks, and something else does the work.
    Optional,
    /// Lacks, and a stage cannot run.
    Missing,
}

/// One line of the report.
#[derive(Debug, Serialize)]
struct Line {
    name: Cow<'static, str>,
    state: State,
    found: String,
    hint: String,
}

impl Line {
    fn ok(name: impl Into<Cow<'static, str>>, found: impl Into<String>) -> Self {
        Self { name: name.into(), state: State::Ok, found: found.into(), hint: String::new() }
    }

    fn optional(
        name: impl Into<Cow<'static, str>>,
        found: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self { name: name.into(), state: State::Optional, found: found.into(), hint: hint.into() }
    }

    fn missing(
        name: impl Into<Cow<'static, str>>,
        found: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self { state: State::Missing, ..Self::optional(name, found, hint) }
    }
}

pub(crate) fn run(args: &DoctorArgs, out: &Printer) -> Result<ExitStatus> {
    if args.setup {
        BlenderEnv::find_or_make(&args.python.choice(), out)?;
    }
    let lines = if args.tests { test_lines()? } else { stage_lines(args) };
    let width = lines.iter().map(|line| line.name.len()).max().unwrap_or(0) + 2;
    if args.json {
        out.json(&json!({ "doctor": lines }))?;
    } else {
        for Line { name, state, found, hint } in &lines {
            let mark = match state {
                State::Ok => "ok",
                State::Optional => "--",
                State::Missing => "MISSING",
            };
            let hint = if hint.is_empty() { String::new() } else { format!(" -> {hint}") };
            out.data(format!("{mark:<8}{name:<width$}{found}{hint}"))?;
        }
    }
    let lacks = lines.iter().any(|line| line.state == State::Missing);
    Ok(if lacks { ExitStatus::Findings } else { ExitStatus::Success })
}

fn stage_lines(args: &DoctorArgs) -> Vec<Line> {
    let mut lines = python_lines(args);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let cores = Line::ok("cores", cores.to_string());
    lines.extend([benchmark_line(), adapter_line(), terminal_line(), cores, disk_line(&args.python.work)]);
    lines
}

/// What `tests/run` finds: it looks before anything is compiled, so the list and the looking are its own.
fn test_lines() -> Result<Vec<Line>> {
    let hint = "run l4d in the project's root folder, with bash on the path";
    let check = Command::new("bash").args(["tests/run", "--check"]).stderr(Stdio::inherit()).output();
    let check =
        check.map_err(|error| refusal(format!("bash tests/run --check: cannot run: {error}"), hint))?;
    let report = String::from_utf8_lossy(&check.stdout).into_owned();
    let lines: Vec<Line> = report.lines().filter_map(test_line).collect();
    if lines.is_empty() { Err(refusal("tests/run --check says nothing", hint)) } else { Ok(lines) }
}

fn test_line(line: &str) -> Option<Line> {
    let [state, package, recognised, purpose]: [&str; 4] =
        line.split('\t').collect::<Vec<_>>().try_into().ok()?;
    let package = package.to_owned();
    Some(match state {
        "ok" => Line::ok(package, format!("{recognised}, for {purpose}")),
        _ => {
            let hint = format!("`tests/run` installs it, or: apt-get install {package}");
            Line::missing(package, format!("none of {recognised}, for {purpose}"), hint)
        }
    })
}

fn python_lines(args: &DoctorArgs) -> Vec<Line> {
    let python = match &args.python.python {
        Some(python) => Ok(python.clone()),
        None => environment_python(&args.python.blender_scripts, &args.python.choice().work),
    };
    let python = match python {
        Ok(python) => python,
        Err(error) => {
            let hint = "run l4d in the project's root folder, or name the folder with --blender-scripts";
            return vec![Line::missing("python", format!("{error:#}"), hint)];
        }
    };
    if !python.exists() && args.python.python.is_none() {
        let hint = "nothing to do: `l4d build-scenes` makes it, or --setup now (needs Python 3.11 or uv, and about 1 GB)";
        return vec![Line::optional("python", "no Blender environment yet", hint)];
    }
    match probe(&python) {
        Ok(probe) => probe_lines(&python, &probe, &args.python.blender_scripts),
        Err(error) => {
            let hint = "name a working Python 3.11 with --python, or delete the environment so that it is made again";
            vec![Line::missing("python", format!("{error:#}"), hint)]
        }
    }
}

fn probe_lines(python: &Path, probe: &Probe, scripts: &Path) -> Vec<Line> {
    let modules = [("bpy", "bpy"), ("OpenEXR", "OpenEXR"), ("usd-core", "pxr"), ("numpy", "numpy")];
    let module_line = |(name, module): (&'static str, &str)| match probe.errors.get(module) {
        Some(error) => Line::missing(name, error.clone(), import_hint(module, error, scripts)),
        None => Line::ok(name, probe.modules.get(module).cloned().unwrap_or_default()),
    };
    let python = Line::ok("python", format!("{} ({})", probe.version, python.display()));
    std::iter::once(python).chain(modules.into_iter().map(module_line)).collect()
}

fn benchmark_line() -> Line {
    match Benchmark::open(shipped::benchmark()) {
        Ok(bench) => {
            let manifest = bench.manifest;
            let what = format!(
                "{} {}, {}",
                manifest.name,
                manifest.version,
                counted(manifest.scenes.len(), "scene")
            );
            Line::ok("benchmark", format!("{what} ({})", bench.dir.root().display()))
        }
        Err(error) => Line::missing(
            "benchmark",
            format!("{:#}", anyhow::Error::from(error)),
            "run l4d in the project's root folder",
        ),
    }
}

/// What the GPU rasterizer can draw with, under the numbers that `--adapter` takes; the best first.
#[cfg(feature = "gpu")]
fn adapter_line() -> Line {
    let found = l4d_gpu::adapters();
    if found.is_empty() {
        let hint = "the processor draws instead; to use graphics hardware install its Vulkan driver (in software: apt-get install mesa-vulkan-drivers)";
        return Line::optional("gpu", "no Vulkan adapter", hint);
    }
    let numbered = |(place, adapter): (usize, &l4d_gpu::AdapterReport)| format!("{place}: {adapter}");
    Line::ok("gpu", found.iter().enumerate().map(numbered).collect::<Vec<_>>().join("; "))
}

#[cfg(not(feature = "gpu"))]
fn adapter_line() -> Line {
    let hint = "the processor draws instead; `cargo build --release --features gpu` adds graphics hardware";
    Line::optional("gpu", "not built in", hint)
}

fn terminal_line() -> Line {
    let var = |name: &str| std::env::var(name).unwrap_or_default();
    let (program, term) = (var("TERM_PROGRAM").to_lowercase(), var("TERM"));
    let protocols = [
        (
            "kitty graphics",
            !var("KITTY_WINDOW_ID").is_empty() || term.contains("kitty") || program == "ghostty",
        ),
        ("iTerm2 graphics", program == "iterm.app" || program == "wezterm"),
        ("sixel", ["sixel", "foot", "mlterm"].iter().any(|name| term.contains(name))),
    ];
    let protocol = protocols.into_iter().find_map(|(name, is_there)| is_there.then_some(name));
    let colours =
        if var("COLORTERM").contains("truecolor") { "24-bit colour" } else { "256 colours or fewer" };
    match protocol {
        Some(protocol) => Line::ok("terminal", format!("{protocol}, {colours}")),
        None => Line::optional(
            "terminal",
            format!("no graphics protocol seen, {colours}"),
            "pictures are drawn in half blocks; kitty, WezTerm, iTerm2 or foot show them in full",
        ),
    }
}

fn disk_line(work: &Path) -> Line {
    let existing =
        work.ancestors().find(|folder| folder.exists()).filter(|folder| !folder.as_os_str().is_empty());
    let folder = existing.unwrap_or(Path::new("."));
    let free_gib = match rustix::fs::statvfs(folder) {
        Ok(stat) => stat.f_bavail * stat.f_frsize / (1 << 30),
        Err(error) => return Line::optional("disk", error.to_string(), "check that the folder is readable"),
    };
    let found = format!("{free_gib} GiB free");
    if free_gib >= WANTED_DISK_GIB {
        return Line::ok("disk", found);
    }
    let hint = format!("profile full wants {WANTED_DISK_GIB} GiB; --data and --work may be elsewhere");
    Line::optional("disk", found, hint)
}
