//! What `cluster init` writes and prints, on machines with a cluster and without one.

use std::os::unix::fs::PermissionsExt as _;
use std::process::Command;

use crate::support::{Dir, Run, root};

/// An empty path, so that no cluster of the machine answers; with `stand_in`, one that does.
fn init(dir: &Dir, more: &str) -> Command {
    let mut command = dir.command(format!("cluster init cluster {more} --bench"));
    command.arg(root().join("benchmark"));
    command.arg("--workflow").arg(root().join("workflow"));
    command.arg("--blender-scripts").arg(root().join("blender_scripts"));
    command.env("PATH", dir.path("bin")).env("USER", "ann");
    command
}

fn done(mut command: Command) -> Run {
    let run = Run::from(command.output().unwrap());
    assert_eq!(run.code, 0, "{run}");
    run
}

/// A command of a cluster that says this when its arguments have these words, and fails otherwise.
fn stand_in(dir: &Dir, name: &str, words: &str, says: &str) {
    let place = format!("bin/{name}");
    dir.write(&place, format!("#!/bin/sh\ncase \"$*\" in *'{words}'*) printf '{says}';; *) exit 1;; esac\n"));
    std::fs::set_permissions(dir.path(place), std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// With the folders of this machine taken out.
fn portable(dir: &Dir, text: &str) -> String {
    let folders = [
        (dir.path("").canonicalize().unwrap(), "<here>"),
        (dir.path(""), "<here>"),
        (root().to_owned(), "<project>"),
    ];
    let program = env!("CARGO_BIN_EXE_l4d");
    folders.iter().fold(text.replace(program, "<program>"), |text, (folder, name)| {
        text.replace(folder.to_str().unwrap().trim_end_matches('/'), name)
    })
}

#[test]
fn a_cluster_gets_settings_a_profile_and_an_estimate() {
    let dir = Dir::new();
    let scenes = "--scenes room_office,tabletop_tea";
    let run = done(init(&dir, &format!("--profile full --partition long --account vision {scenes}")));
    let files = ["config.yaml", "profile/config.yaml", "README.md"];
    let written = files.map(|file| format!("== {file}\n{}", dir.read(&format!("cluster/{file}"))));
    let all = format!("{}== stdout\n{}== stderr\n{}", written.concat(), run.stdout, run.stderr);
    insta::assert_snapshot!(portable(&dir, &all));
}

#[test]
fn each_profile_is_estimated() {
    let dir = Dir::new();
    let all = ["tiny", "small", "full"].map(|profile| {
        let run = done(init(&dir, &format!("--profile {profile} --force --quiet")));
        run.stdout
            .lines()
            .filter(|line| !line.contains("/cluster/"))
            .map(|line| format!("{line}\n"))
            .collect::<String>()
    });
    insta::assert_snapshot!(all.join("\n"));
    assert!(
        dir.read("cluster/config.yaml").contains("\nscenes: [] "),
        "all scenes are those of the benchmark"
    );
}

#[test]
fn jobs_stay_within_what_the_cluster_says() {
    let dir = Dir::new();
    stand_in(&dir, "scontrol", "show config", "SlurmctldPort = 6817\\nMaxArraySize = 1001\\n");
    stand_in(&dir, "sacctmgr", "user=ann", "500\\n\\n40\\n");
    let run = done(init(&dir, "--jobs 200"));
    run.says(0, &["MaxArraySize is 1001", "MaxSubmitJobs is 40", "--jobs: the cluster lets you submit 40"]);
    let profile = dir.read("cluster/profile/config.yaml");
    assert!(profile.contains("\njobs: 40 ") && !profile.contains("squeue"), "{profile}");
    let run = done(init(&dir, "--jobs 7 --force"));
    assert!(!run.stderr.contains("--jobs:"), "{run}");
    assert!(dir.read("cluster/profile/config.yaml").contains("\njobs: 7 "));
}

#[test]
fn what_was_changed_is_not_replaced_and_nothing_else_is_written() {
    let dir = Dir::new();
    dir.write("cluster/profile/config.yaml", "jobs: 3\n");
    let run = Run::from(init(&dir, "--profile tiny").output().unwrap());
    run.refused(&["cluster/profile/config.yaml", "is there with other content", "--force"]);
    assert_eq!(dir.tree("cluster").len(), 1);
    done(init(&dir, "--profile tiny --force"));
    let written = dir.tree("cluster");
    assert_eq!(written.len(), 3);
    // The same again is no change.
    done(init(&dir, "--profile tiny"));
    assert_eq!(dir.tree("cluster"), written);
}

#[test]
fn what_cannot_be_run_is_refused_before_anything_is_written() {
    let dir = Dir::new();
    let refused = |more: &str, words: &[&str]| Run::from(init(&dir, more).output().unwrap()).refused(words);
    refused("--scenes moon_base", &["moon_base", "choose among", "room_office"]);
    refused("--engine local --partition long", &["--partition does not apply to --engine local"]);
    refused("--profile real", &["real scenes are not rendered"]);
    refused("--data 'my data'", &["my data", "command lines"]);
    assert!(!dir.path("cluster").exists());
}

/// That Snakemake takes it is tested beside the workflow (`workflow/tests`), where Snakemake is.
#[test]
fn the_workflow_finds_all_settings_that_it_reads() {
    let dir = Dir::new();
    done(init(&dir, "--profile tiny --engine local --jobs 1"));
    let read = |file: &str| serde_yaml_ng::from_str::<serde_yaml_ng::Value>(&dir.read(file)).unwrap();
    let (config, profile) = (read("cluster/config.yaml"), read("cluster/profile/config.yaml"));
    assert_eq!(profile["configfile"][0], dir.path("cluster/config.yaml").to_str().unwrap());
    let snakefile = std::fs::read_to_string(profile["snakefile"].as_str().unwrap()).unwrap();
    let asked: Vec<&str> =
        snakefile.split("config[\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(asked.len() > 15, "{asked:?}");
    for key in asked {
        assert!(config.get(key).is_some(), "no {key} in {config:?}");
    }
}
