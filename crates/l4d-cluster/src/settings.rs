//! The files that a run of the workflow starts from: its settings, the profile of its engine, and a page that says
//! which is which. They are the project's own templates (`workflow/`) with other values.

use std::path::{Path, PathBuf};

use l4d_data::{DataError, Name, Profile, StageError};
use serde::Deserialize;

use crate::Result;
use crate::estimate::Estimate;

/// The workflow's own settings, in which every key is explained.
pub(crate) const CONFIG: &str = include_str!("../../../workflow/config.yaml");
const SLURM: &str = include_str!("../../../workflow/profiles/slurm/config.yaml");
const LOCAL: &str = include_str!("../../../workflow/profiles/local/config.yaml");
const KUBERNETES: &str = include_str!("../../../workflow/profiles/kubernetes/config.yaml");
const README: &str = include_str!("../templates/README.md");

/// Who runs jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// A Slurm cluster with a shared file system.
    Slurm,
    /// This machine alone.
    Local,
    /// A Kubernetes cluster with a volume that all pods can write.
    Kubernetes,
}

impl Engine {
    /// Names, as they are typed.
    pub const NAMES: [&str; 3] = ["slurm", "local", "kubernetes"];
}

/// What is written. Paths are absolute.
#[derive(Debug)]
pub struct Settings<'a> {
    /// Receives the files.
    pub folder: PathBuf,
    /// Who runs jobs.
    pub engine: Engine,
    pub partition: Option<&'a str>,
    pub account: Option<&'a str>,
    /// In the queue or running at once.
    pub jobs: u64,
    /// That a job works.
    pub minutes: u32,
    /// Cores of a job.
    pub cores: usize,
    /// Whether the cluster counts what users take; without it the engine asks the queue.
    pub has_accounting: bool,
    pub l4d: PathBuf,
    /// Folder of the workflow.
    pub workflow: PathBuf,
    /// Folder of the Blender scripts.
    pub blender_scripts: PathBuf,
    /// Python with bpy; none for an environment that l4d makes.
    pub python: Option<PathBuf>,
    /// How much is rendered.
    pub profile: Profile,
    /// Folder of the benchmark.
    pub bench: PathBuf,
    /// Those that were chosen; none for all.
    pub scenes: &'a [Name],
    pub data: PathBuf,
    /// Pictures to learn from.
    pub training: PathBuf,
    /// What can be remade.
    pub work: PathBuf,
    /// Results of methods.
    pub results: PathBuf,
    pub scores: PathBuf,
    /// Tables and the page.
    pub leaderboard: PathBuf,
}

impl Settings<'_> {
    /// The settings of the workflow.
    pub fn config_path(&self) -> PathBuf {
        self.folder.join("config.yaml")
    }

    /// What `--workflow-profile` names.
    pub fn profile_folder(&self) -> PathBuf {
        self.folder.join("profile")
    }

    /// Every file, by its path.
    ///
    /// # Errors
    /// A path that a shell would take apart: the workflow writes them into command lines.
    pub fn files(&self, estimate: &Estimate, table: &str, commands: &str) -> Result<[(PathBuf, String); 3]> {
        let readme = README
            .replace("{table}", &indented(table))
            .replace("{commands}", &indented(commands))
            .replace("{remarks}", &estimate.remarks().join("\n"))
            .replace("{folder}", &plain(&self.folder)?);
        Ok([
            (self.config_path(), self.config(estimate)?),
            (self.profile_folder().join("config.yaml"), self.engine_profile()?),
            (self.folder.join("README.md"), readme),
        ])
    }

    fn config(&self, estimate: &Estimate) -> Result<String> {
        let python = self.python.as_deref().map(plain).transpose()?.unwrap_or_else(|| "\"\"".to_owned());
        let scenes: Vec<&str> = self.scenes.iter().map(Name::as_str).collect();
        let values = [
            ("l4d", plain(&self.l4d)?),
            ("blender_scripts", plain(&self.blender_scripts)?),
            ("python", python),
            ("profile", self.profile.to_string()),
            ("bench", plain(&self.bench)?),
            ("data", plain(&self.data)?),
            ("work", plain(&self.work)?),
            ("results", plain(&self.results)?),
            ("scores", plain(&self.scores)?),
            ("leaderboard", plain(&self.leaderboard)?),
            ("scenes", format!("[{}]", scenes.join(", "))),
            ("volume", (self.engine == Engine::Kubernetes).to_string()),
            ("jobs", self.cores.to_string()),
            ("render_blocks", estimate.render_blocks.to_string()),
            ("solve_blocks", estimate.solve_blocks.to_string()),
        ];
        let training = format!("  folder: {}", plain(&self.training)?);
        let config = with_line(CONFIG, "  folder: data/training", &training)?;
        values.iter().try_fold(config, |text, (key, value)| with_value(&text, key, value))
    }

    fn engine_profile(&self) -> Result<String> {
        // Three times what was measured and ten minutes more, as the workflow asks for its own jobs.
        let runtime = format!("  - runtime={}", 3 * self.minutes + 10);
        let jobs = self.jobs.to_string();
        let text = match self.engine {
            Engine::Local => LOCAL.to_owned(),
            Engine::Slurm => self.slurm(with_value(SLURM, "jobs", &jobs)?, &runtime)?,
            // config.yaml has the folders; the template names them for those who use it by hand.
            Engine::Kubernetes => {
                let text = with_value(KUBERNETES, "jobs", &jobs)?;
                let lines = text.lines().filter(|line| *line != "config:" && !is_setting(line));
                with_line(
                    &lines.map(|line| format!("{line}\n")).collect::<String>(),
                    "  - runtime=60",
                    &runtime,
                )?
            }
        };
        let [snakefile, config, folder] =
            [&self.workflow.join("Snakefile"), &self.config_path(), &self.folder].map(|path| plain(path));
        Ok(format!(
            "{text}\n# What is run, with which settings, and where the engine keeps its own files.\n\
             snakefile: {}\nconfigfile:\n  - {}\ndirectory: {}\n",
            snakefile?, config?, folder?
        ))
    }

    fn slurm(&self, text: String, runtime: &str) -> Result<String> {
        let mut text = with_value(&text, "slurm-logdir", &plain(&self.folder.join("logs"))?)?;
        text = with_line(&text, "  - runtime=60", runtime)?;
        if let Some(partition) = self.partition {
            let line = format!("  - slurm_partition={}", word("--partition", partition)?);
            text = with_line(&text, "  # - slurm_partition=NAME", &line)?;
        }
        if let Some(account) = self.account {
            let line = format!("  - slurm_account={}", word("--account", account)?);
            text = with_line(&text, "  # - slurm_account=NAME", &line)?;
            let lines = text.lines().filter(|line| !line.starts_with("slurm-no-account:"));
            text = lines.map(|line| format!("{line}\n")).collect();
        }
        if !self.has_accounting {
            text.push_str(
                "slurm-status-command: squeue   # `sacctmgr` did not answer: there is no accounting\n",
            );
        }
        Ok(text)
    }
}

/// A path that needs no quotes, neither in YAML nor in a shell.
fn plain(path: &Path) -> Result<String> {
    let text = path.to_str().filter(|text| text.chars().all(is_plain));
    text.map(str::to_owned).ok_or_else(|| {
        StageError::new(
            format!(
                "{}: the workflow writes paths into command lines, which this one would break",
                path.display()
            ),
            "use folders whose names have letters, digits, `/`, `.`, `_`, `-`, `+` and `@` alone",
        )
    })
}

fn word<'a>(option: &str, text: &'a str) -> Result<&'a str> {
    let is_word = !text.is_empty() && text.chars().all(|letter| is_plain(letter) || letter == ',');
    is_word.then_some(text).ok_or_else(|| {
        StageError::new(
            format!("{option}: `{}` is no name of a cluster", text.escape_debug()),
            "name it as `sinfo` or `sacctmgr` prints it",
        )
    })
}

fn is_plain(letter: char) -> bool {
    letter.is_alphanumeric() || "/._-+@".contains(letter)
}

fn is_setting(line: &str) -> bool {
    line.strip_prefix("  - ").and_then(|setting| setting.split_once('=')).is_some_and(|(key, _)| {
        CONFIG.lines().any(|line| line.split_once(':').is_some_and(|(known, _)| known == key))
    })
}

/// A template with another value of a key; what is said of it stays.
fn with_value(text: &str, key: &str, value: &str) -> Result<String> {
    let start = format!("{key}:");
    let line = text.lines().find(|line| line.starts_with(&start)).ok_or_else(|| lacks(&start))?;
    let changed = match line.split_once("  #") {
        Some((_, remark)) => format!("{:<25} #{remark}", format!("{start} {value}")),
        None => format!("{start} {value}"),
    };
    with_line(text, line, &changed)
}

/// A template with another line in the place of one.
fn with_line(text: &str, line: &str, changed: &str) -> Result<String> {
    let place = text.lines().position(|found| found == line).ok_or_else(|| lacks(line))?;
    let lines = text.lines().enumerate().map(|(index, line)| if index == place { changed } else { line });
    Ok(lines.map(|line| format!("{line}\n")).collect())
}

fn lacks(line: &str) -> StageError {
    let message = format!("has no line `{line}`");
    DataError::invalid(
        Path::new("workflow"),
        "template",
        message,
        "report it: the program was built with a template of another form",
    )
    .into()
}

fn indented(text: &str) -> String {
    text.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use serde_yaml_ng::Value;

    use super::*;

    fn settings(engine: Engine) -> Settings<'static> {
        let at = |name: &str| Path::new("/srv").join(name);
        Settings {
            folder: at("cluster"),
            engine,
            partition: Some("long"),
            account: Some("vision"),
            jobs: 40,
            minutes: 20,
            cores: 2,
            has_accounting: false,
            l4d: at("l4d"),
            workflow: at("workflow"),
            blender_scripts: at("blender_scripts"),
            python: None,
            profile: Profile::Full,
            bench: at("benchmark"),
            scenes: &[],
            data: at("data"),
            training: at("training"),
            work: at("work"),
            results: at("results"),
            scores: at("scores"),
            leaderboard: at("leaderboard"),
        }
    }

    fn estimate(settings: &Settings<'_>) -> Estimate {
        Estimate::new(settings.profile, &[14], settings.minutes).unwrap()
    }

    fn written(settings: &Settings<'_>) -> (Value, Value, String) {
        let estimate = estimate(settings);
        let [(_, config), (_, profile), (_, readme)] =
            settings.files(&estimate, "table", "commands").unwrap();
        (serde_yaml_ng::from_str(&config).unwrap(), serde_yaml_ng::from_str(&profile).unwrap(), readme)
    }

    #[test]
    fn every_engine_gets_its_profile() {
        let (config, slurm, readme) = written(&settings(Engine::Slurm));
        assert_eq!(config["bench"], "/srv/benchmark");
        let blocks = estimate(&settings(Engine::Slurm)).render_blocks as u64;
        assert!(blocks > 1);
        assert_eq!(
            (config["render_blocks"].as_u64(), config["volume"].as_bool()),
            (Some(blocks), Some(false))
        );
        assert!(config["sizes"]["full"].is_mapping() && config["scenes"].as_sequence().unwrap().is_empty());
        assert_eq!((slurm["executor"].as_str(), slurm["jobs"].as_u64()), (Some("slurm"), Some(40)));
        assert_eq!(
            (&slurm["slurm-no-account"], &slurm["slurm-status-command"]),
            (&Value::Null, &"squeue".into())
        );
        let resources = slurm["default-resources"].as_sequence().unwrap();
        for resource in ["slurm_partition=long", "slurm_account=vision", "runtime=70"] {
            assert!(resources.contains(&resource.into()), "{resource}: {resources:?}");
        }
        assert!(readme.contains("    table\n") && !readme.contains('{'), "{readme}");

        let (_, local, _) = written(&settings(Engine::Local));
        assert_eq!(
            (&local["cores"], &local["snakefile"]),
            (&"all".into(), &"/srv/workflow/Snakefile".into())
        );
        let (config, kubernetes, _) = written(&settings(Engine::Kubernetes));
        assert_eq!((&config["volume"], &kubernetes["config"]), (&true.into(), &Value::Null));
        assert!(kubernetes["default-resources"].as_sequence().unwrap().contains(&"runtime=70".into()));
    }

    #[test]
    fn paths_that_a_shell_takes_apart_are_refused() {
        let blank = Settings { data: "/srv/my data".into(), ..settings(Engine::Local) };
        let estimate = Estimate::new(Profile::Tiny, &[1], 20).unwrap();
        let error = blank.files(&estimate, "", "").unwrap_err();
        assert!(error.to_string().contains("/srv/my data"), "{error}");
        let wrong = Settings { partition: Some("a b"), ..settings(Engine::Slurm) };
        assert!(wrong.files(&estimate, "", "").unwrap_err().to_string().contains("--partition"));
    }
}
