//! Grammar of the verbs that ask models: propose-prompts, propose-scenes.

use std::path::PathBuf;

use clap::Args;
use l4d_data::{Scale, Shard};
use l4d_endpoint::Link;

use super::{BenchArgs, number, one_of};
use crate::shipped;

/// Which model of which server is meant: a file, flags, or flags that override the file.
#[derive(Debug, Clone, Args)]
pub(crate) struct EndpointArgs {
    /// Description of the endpoint: server, model, name of the variable that holds the key (docs/endpoints.md)
    #[arg(long, value_name = "TOML")]
    pub(crate) endpoint: Option<PathBuf>,
    /// Root of the server's protocol, e.g. http://localhost:8000/v1
    #[arg(long, value_name = "URL")]
    pub(crate) base_url: Option<String>,
    /// Name of the model, as the server knows it
    #[arg(long, value_name = "NAME")]
    pub(crate) vlm: Option<String>,
    /// Environment variable that holds the key; the key itself is never an argument
    #[arg(long, value_name = "VARIABLE")]
    pub(crate) api_key_env: Option<String>,
    /// Kind of server: generic, vllm, llama-cpp, ollama, openai, gemini, mistral-rs, transformers, dashscope
    #[arg(long, value_name = "KIND")]
    pub(crate) server: Option<String>,
    /// live, record:<folder> or replay:<folder> (which brings its own endpoint)
    #[arg(long, value_name = "LINK", default_value = "live")]
    pub(crate) link: Link,
}

/// Which model is asked, what may be spent, and what becomes of its answers.
#[derive(Debug, Clone, Args)]
pub(crate) struct ServerArgs {
    #[command(flatten)]
    pub(crate) endpoint: EndpointArgs,
    /// Folder that keeps every answer, so that nothing is asked twice
    #[arg(long, value_name = "DIR", default_value = "work/answers")]
    pub(crate) cache: PathBuf,
    /// Ask again and replace kept answers
    #[arg(long)]
    pub(crate) refresh: bool,
    /// Stop before questions and answers cost more than this (needs prices in the endpoint's file)
    #[arg(long, value_name = "COST", value_parser = number::<f64>(0.0..))]
    pub(crate) max_cost: Option<f64>,
    /// Stop before questions and answers have more tokens than this
    #[arg(long, value_name = "TOKENS")]
    pub(crate) max_tokens_total: Option<u64>,
}

/// How a model is asked for proposals.
#[derive(Debug, Clone, Args)]
pub(crate) struct AskArgs {
    #[command(flatten)]
    pub(crate) server: ServerArgs,
    /// Ask once more for other answers: 1, 2, ...
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) repeat: u32,
    /// Longest single answer, tokens; default: what the number of proposals needs
    #[arg(long, value_name = "TOKENS", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) answer_tokens: Option<u32>,
    /// Only say what would be asked and what it may cost
    #[arg(long)]
    pub(crate) dry_run: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ProposePromptsArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) ask: AskArgs,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder that receives the proposals; default: work/<profile>/proposals
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Queries wanted of each of the four categories
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    pub(crate) per_category: u32,
    /// Moments of the clip that the model sees
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(2..=97))]
    pub(crate) frames: u32,
    /// Training views that the model sees beside the held-out one
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(0..=16))]
    pub(crate) view_count: u32,
    /// Pictures are enlarged until they are at least this wide, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(128..=1920))]
    pub(crate) width: u32,
    /// Scenes at once
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) jobs: u32,
    /// Ask about part i of n of the scenes (a deterministic partition for clusters), e.g. 2/8
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    /// Replace proposals of other models or runs
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ProposeScenesArgs {
    /// Folder of the benchmark whose scenes exist already
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    #[command(flatten)]
    pub(crate) ask: AskArgs,
    /// Folder that receives the scenarios
    #[arg(long, short, value_name = "DIR", default_value = "work/scenarios")]
    pub(crate) out: PathBuf,
    /// Only these scales (comma-separated or repeated); default: all
    #[arg(long, value_name = "SCALE", value_delimiter = ',', value_parser = one_of::<Scale>(["outdoor", "room", "tabletop"]))]
    pub(crate) scales: Vec<Scale>,
    /// Scenarios of each scale
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    pub(crate) per_scale: u32,
    /// Replace files that hold something else
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}
