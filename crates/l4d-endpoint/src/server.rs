//! Kinds of servers, as data: which protocol they speak and what they take.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::error::EndpointError;

/// Two ways to spell the same question.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Dialect {
    /// `POST chat/completions`.
    #[default]
    Openai,
    /// `POST /api/chat`, Ollama's own.
    Ollama,
}

/// The field that limits the length of an answer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MaxTokensField {
    /// The older one, which most servers know.
    #[default]
    MaxTokens,
    /// The one that OpenAI's newer models insist on.
    MaxCompletionTokens,
}

/// A kind of server.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Server {
    /// As in the configuration.
    pub name: String,
    /// Its protocol.
    #[serde(default)]
    pub dialect: Dialect,
    /// Its spelling of the limit of the answer.
    #[serde(default)]
    pub max_tokens: MaxTokensField,
    /// Kinds of pictures that it takes.
    #[serde(default = "all_image_types")]
    pub image_types: Vec<String>,
    /// Pictures in one question; `None`: nothing is known.
    #[serde(default)]
    pub max_images: Option<usize>,
    /// Bytes of one question; `None`: nothing is known.
    #[serde(default)]
    pub max_request_bytes: Option<u64>,
    /// What its users should know.
    pub note: String,
}

#[derive(Deserialize)]
struct File {
    server: Vec<Server>,
}

static SERVERS: LazyLock<Vec<Server>> = LazyLock::new(|| {
    let file: File = toml::from_str(include_str!("servers.toml")).expect("the embedded table is valid");
    file.server
});

impl Server {
    /// All kinds, `generic` first.
    pub fn all() -> &'static [Server] {
        &SERVERS
    }

    /// The kind of that name.
    pub fn named(name: &str) -> Result<&'static Server, EndpointError> {
        Self::all().iter().find(|server| server.name == name).ok_or_else(|| {
            let names: Vec<&str> = Self::all().iter().map(|server| server.name.as_str()).collect();
            EndpointError::Config {
                place: "server".to_owned(),
                message: format!("`{}` is no kind of server that l4d knows", name.escape_debug()),
                remedy: format!("use one of {}", names.join(", ")),
            }
        })
    }
}

fn all_image_types() -> Vec<String> {
    ["image/png", "image/jpeg", "image/webp"].map(str::to_owned).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_table_parses_and_starts_with_the_default() {
        assert_eq!(Server::all()[0].name, "generic");
        assert_eq!(Server::named("ollama").unwrap().dialect, Dialect::Ollama);
        assert_eq!(Server::named("openai").unwrap().max_tokens, MaxTokensField::MaxCompletionTokens);
        assert!(Server::named("vlm").unwrap_err().hint().contains("llama-cpp"));
    }
}
