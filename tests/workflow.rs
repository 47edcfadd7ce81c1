//! `workflow/` over Snakemake, on this machine and on Slurm daemons that the tests start: the same bytes as the verbs.
//!
//! The suite itself is Python, beside the workflow. Its environment is made once in the project's `work/` folder.

use std::process::Command;

use l4d_blender::python::Environment;
use l4d_data::Silent;

use crate::support::{Dir, l4d, root, succeed};

/// Of the development set, as `workflow/tests/conftest.py` names it.
const SCENE: &str = "tabletop_0515";

#[test]
#[ignore = "slow: makes an environment with Snakemake, waits for Slurm's daemons"]
fn jobs_leave_what_the_bare_verbs_leave() {
    let environment = Environment {
        requirements: root().join("workflow/tests/requirements.txt"),
        kind_folder: root().join("work/workflow-tests"),
        name: "the environment of the workflow's tests",
        holds: "snakemake and its plugins; about 400 MB",
    };
    let python = environment.find_or_make(&Silent).unwrap();
    let dir = Dir::new();
    let mut build =
        l4d(&format!("build-scenes --bench benchmark/dev --profile tiny --scenes {SCENE} --data"));
    succeed(build.arg(dir.path("dev")));
    let mut suite = Command::new(python);
    suite
        .current_dir(root())
        .args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "workflow/tests"])
        .env("L4D", env!("CARGO_BIN_EXE_l4d"))
        .env("L4D_DEV_TINY", dir.path("dev"));
    let said = succeed(&mut suite);
    let mut skipped = said.lines().filter(|line| line.starts_with("SKIPPED"));
    assert!(
        skipped.all(|line| line.contains("slurmd has to be started by root")),
        "all of it has to run, on Slurm too:\n{said}"
    );
}
