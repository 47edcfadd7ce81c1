//! What help says beside the options: verbs by stage, and an example of each.

use clap::Command;

/// Verbs in the order in which data goes through them.
const STAGES: &[(&str, &[&str])] = &[
    ("Begin", &["quickstart", "doctor"]),
    ("Scenes", &["build-scenes", "check-scenes", "sheet", "compose", "arrange"]),
    ("Queries", &["check-queries", "stats", "propose-prompts", "propose-scenes"]),
    ("Votes", &["open-round", "verify-prompts", "import-ballot", "verdict"]),
    ("Splats", &["train-splats", "render-splats", "view", "serve"]),
    ("Reference solver", &["query", "solve", "ablate", "bench"]),
    ("Other tools", &["export", "import-scene", "import"]),
    ("Scores", &["baseline", "init-results", "check-results", "score", "leaderboard"]),
    ("Publish", &["release", "download", "host", "cluster"]),
    ("This program", &["completions", "man"]),
];

/// Lines that can be typed as they are, once what they name is there.
const EXAMPLES: &[(&str, &[&str])] = &[
    ("quickstart", &["l4d quickstart --out first"]),
    ("doctor", &["l4d doctor", "l4d doctor --setup --json"]),
    (
        "build-scenes",
        &[
            "l4d build-scenes --profile tiny --scenes room_office,tabletop_tea",
            "l4d build-scenes --profile full --scenes room_office --views cam02 --frames 0-24",
        ],
    ),
    ("check-scenes", &["l4d check-scenes --profile tiny --scenes room_office"]),
    ("sheet", &["l4d sheet room_office --profile tiny --out office.png"]),
    ("compose", &["l4d compose --out mine --count 5 --scale room --seed 100", "l4d compose --list"]),
    ("arrange", &["l4d arrange --out pictures --count 20 --seed 5000"]),
    ("check-queries", &["l4d check-queries", "l4d check-queries --bench mine --against benchmark"]),
    ("stats", &["l4d stats --profile tiny --out stats"]),
    ("propose-prompts", &["l4d propose-prompts --profile tiny --endpoint endpoint.toml --dry-run"]),
    ("propose-scenes", &["l4d propose-scenes --endpoint endpoint.toml --scales room --per-scale 3"]),
    (
        "open-round",
        &["l4d open-round r1 --annotators ada,ben,cyd,dee,eve --sample 40", "l4d open-round r1 --pack ada"],
    ),
    ("verify-prompts", &["l4d verify-prompts r1 --as ada"]),
    ("import-ballot", &["l4d import-ballot r1-ada.ballot.jsonl"]),
    ("verdict", &["l4d verdict r1", "l4d verdict r1 --check"]),
    ("train-splats", &["l4d train-splats room_office --profile tiny"]),
    (
        "render-splats",
        &[
            "l4d render-splats room_office --profile tiny --views cam00 --frames 0,48,96",
            "l4d render-splats room_office --profile tiny --orbit --preview",
        ],
    ),
    ("view", &["l4d view room_office --profile tiny"]),
    ("serve", &["l4d serve room_office --profile tiny"]),
    ("query", &["l4d query room_office \"The woman who sits down\" --profile tiny"]),
    ("solve", &["l4d solve --profile tiny --scenes room_office", "l4d solve --profile tiny --shard 1/4"]),
    ("ablate", &["l4d ablate mvsc --profile tiny --grounder oracle --calibrate"]),
    ("bench splats", &["l4d bench splats room_office --profile tiny"]),
    ("bench lift", &["l4d bench lift room_office --profile tiny --queries 2"]),
    (
        "export",
        &[
            "l4d export room_office --profile tiny --format 4dgaussians --out office",
            "l4d export room_office --profile tiny --format usd-splats --out office-usd",
        ],
    ),
    ("import-scene", &["l4d import-scene neu3d coffee_martini"]),
    ("import", &["l4d import davis masks --profile tiny --name mine"]),
    ("baseline", &["l4d baseline random-look-alike --profile tiny"]),
    ("init-results", &["l4d init-results mine --profile tiny"]),
    ("check-results", &["l4d check-results results --profile tiny"]),
    ("score", &["l4d score results --profile tiny", "l4d score results --profile tiny --protocol davis"]),
    ("leaderboard", &["l4d leaderboard scores --profile tiny --html"]),
    ("release", &["l4d release --profile tiny --date 2026-12-01 --url https://example.org/l4d-0.2.0"]),
    ("download", &["l4d download https://example.org/l4d-0.2.0 --scenes room_office"]),
    ("host codabench", &["l4d host codabench --date 2026-12-01 --url https://example.org/l4d-0.2.0"]),
    ("host huggingface", &["l4d host huggingface --dataset lab/panoptic-l4d"]),
    ("cluster init", &["l4d cluster init run --engine slurm --profile small"]),
    ("completions", &["l4d completions bash > ~/.local/share/bash-completion/completions/l4d"]),
    ("man", &["l4d man --out ~/.local/share/man/man1"]),
];

/// The grammar with its help.
pub(super) fn with_help(root: Command) -> Command {
    let template = format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{}{{options}}\n\n\
         `l4d <verb> --help` has the options of a verb, and an example.",
        stages(&root)
    );
    let root = root.help_template(template);
    root.mut_subcommands(|verb| with_examples("", verb))
}

fn with_examples(before: &str, verb: Command) -> Command {
    let name = format!("{before} {}", verb.get_name()).trim().to_owned();
    let examples = EXAMPLES.iter().find(|(of, _)| *of == name).map(|(_, lines)| *lines);
    let verb = match examples {
        None => verb,
        Some(lines) => {
            let lines: Vec<String> = lines.iter().map(|line| format!("  {line}")).collect();
            let more = verb.get_after_help().map(|help| format!("\n\n{help}")).unwrap_or_default();
            let title = if lines.len() == 1 { "Example:" } else { "Examples:" };
            verb.after_help(format!("{title}\n{}{more}", lines.join("\n")))
        }
    };
    verb.mut_subcommands(|below| with_examples(&name, below))
}

/// The verbs by stage, each with its sentence.
fn stages(root: &Command) -> String {
    let mut text = String::new();
    for (stage, verbs) in STAGES {
        text.push_str(&format!("{stage}:\n"));
        for name in *verbs {
            let about = root.find_subcommand(name).and_then(Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            text.push_str(&format!("  {name:<16} {about}\n"));
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::Cli;
    use crate::cli::applies::tests::{Verb, verbs};

    const REFERENCE: &str = "docs/cli.md";

    /// The help of every verb, in the order of the stages.
    fn reference() -> String {
        let mut text =
            "# Command line\n\nThe help of every verb, as `l4d <verb> --help` prints it. Written by \
                        `UPDATE_DOCS=1 cargo test --bin l4d reference`.\n"
                .to_owned();
        let mut root = with_help(Cli::command()).term_width(100);
        root.build();
        for (stage, verbs) in STAGES {
            text.push_str(&format!("\n## {stage}\n"));
            for verb in *verbs {
                let verb = root.find_subcommand(verb).expect("each verb has one stage").clone();
                let below: Vec<Command> =
                    verb.get_subcommands().filter(|one| one.get_name() != "help").cloned().collect();
                let shown = if below.is_empty() { vec![verb] } else { below };
                for mut verb in shown {
                    let name = verb.get_bin_name().unwrap_or_default().to_owned();
                    let help = verb.render_help().to_string();
                    let lines: Vec<&str> = help.trim_end().lines().map(str::trim_end).collect();
                    text.push_str(&format!("\n### {name}\n\n```text\n{}\n```\n", lines.join("\n")));
                }
            }
        }
        text
    }

    #[test]
    fn the_reference_is_what_help_says() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(REFERENCE);
        let reference = reference();
        if std::env::var_os("UPDATE_DOCS").is_some() {
            std::fs::write(&path, &reference).expect("the docs can be written");
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(committed == reference, "{REFERENCE} is not what help says: run it with UPDATE_DOCS=1");
    }

    #[test]
    fn each_verb_has_one_stage() {
        let staged: Vec<&str> = STAGES.iter().flat_map(|(_, verbs)| verbs.iter().copied()).collect();
        let known: BTreeSet<String> =
            Cli::command().get_subcommands().map(|verb| verb.get_name().to_owned()).collect();
        assert_eq!(staged.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>(), known);
        assert_eq!(staged.len(), known.len(), "a verb has two stages");
    }

    /// What the help of an option says wherever it occurs, one of these in small letters.
    const SAID: &[(&str, &str)] = &[
        ("bench", "folder of the benchmark|folder of a benchmark|receives the benchmark"),
        ("force", "replace|again|write"),
        ("jobs", "at once"),
        ("json", "json"),
        ("out", "receives|to write|the page|folder of the"),
        ("profile", "profile|tiny, small|small or full"),
        ("scenes", "scenes"),
        ("seed", "seed"),
        ("shard", "part i of n"),
        ("splats", "model"),
        ("view_count", "views|pictures"),
        ("views", "views"),
        ("vlm", "model"),
        ("work", "can be remade|trained models"),
    ];
    /// What options were called once.
    const OLD: &[&str] = &["output", "overwrite", "model", "training_views", "camera", "time", "round_name"];

    #[test]
    fn one_word_means_one_thing() {
        let mut wrong = Vec::new();
        for Verb { name, command } in verbs() {
            for argument in command.get_arguments() {
                let id = argument.get_id().as_str();
                let help = argument.get_help().map(ToString::to_string).unwrap_or_default().to_lowercase();
                if argument.get_long().is_some() && OLD.contains(&id) {
                    wrong.push(format!("{name}: --{id} is an old word"));
                }
                if let Some((_, said)) = SAID.iter().find(|(option, _)| *option == id)
                    && !said.split('|').any(|words| help.contains(words))
                {
                    wrong.push(format!("{name} --{id}: \"{help}\" says none of {said}"));
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    #[test]
    fn each_verb_has_examples_that_it_takes() {
        let (mut lacking, mut wrong) = (Vec::new(), Vec::new());
        for Verb { name, .. } in verbs() {
            let Some((_, lines)) = EXAMPLES.iter().find(|(of, _)| *of == name) else {
                lacking.push(name);
                continue;
            };
            for line in *lines {
                let (line, _) = line.split_once(" > ").unwrap_or((line, ""));
                let words: Vec<String> = line
                    .split('"')
                    .enumerate()
                    .flat_map(|(place, part)| match place % 2 {
                        0 => part.split_whitespace().map(str::to_owned).collect(),
                        _ => vec![part.to_owned()],
                    })
                    .collect();
                if let Err(error) = Cli::read(words) {
                    wrong.push(format!("{line}: {error}"));
                }
            }
        }
        assert!(lacking.is_empty(), "no example: {lacking:?}");
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
