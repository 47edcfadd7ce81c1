use super::*;

fn read(text: &str) -> Result<Endpoint, EndpointError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("endpoint.toml");
    std::fs::write(&path, text).unwrap();
    Endpoint::read(&path)
}

#[test]
fn a_file_says_everything_and_defaults_say_the_rest() {
    let endpoint = read(
        r#"
        base_url = "https://gpu.example.org:8443/v1/"
        model = "Qwen/Qwen3-VL-8B-Instruct"
        api_key_env = "LAB_KEY"
        server = "vllm"
        coordinates = "rel1000_xyxy"
        omit = ["seed"]
        [header_env]
        x-organisation = "LAB_ORGANISATION"
        [body]
        top_p = 0.8
        chat_template_kwargs = { enable_thinking = false }
        [timeouts]
        request_seconds = 60
        [prices]
        prompt_per_million = 0.5
        completion_per_million = 1.5
        "#,
    )
    .unwrap();
    assert_eq!(endpoint.url("chat/completions"), "https://gpu.example.org:8443/v1/chat/completions");
    assert_eq!(endpoint.timeouts, Timeouts { request_seconds: 60.0, ..Timeouts::default() });
    assert_eq!(endpoint.body["chat_template_kwargs"]["enable_thinking"], false);
    assert!(endpoint.note().contains("VLLM"));
    assert!(!endpoint.base_url.exposes_keys());
    let least = read("base_url = \"http://localhost:8000/v1\"\nmodel = \"m\"").unwrap();
    assert_eq!(least, Endpoint::new("http://localhost:8000/v1", "m").unwrap());
}

#[test]
fn ids_tell_endpoints_and_models_apart() {
    let id = |url: &str, model: &str| Endpoint::new(url, model).unwrap().id();
    let ids = [
        id("http://a:1/v1", "m"),
        id("http://a:1/v2", "m"),
        id("http://a:1/v1", "../../m"),
        id("https://a:1/v1", "m"),
    ];
    assert_eq!(ids.iter().collect::<std::collections::BTreeSet<_>>().len(), 4);
    assert!(ids.iter().all(|id| l4d_data::Name::new(id.as_str()).is_ok()), "{ids:?}");
}

#[test]
fn what_cannot_be_is_refused_with_field_and_remedy() {
    let base = "base_url = \"http://localhost:8000/v1\"\nmodel = \"m\"\n";
    let cases = [
        ("model = \"m\"".to_owned(), "base_url"),
        ("base_url = \"http://localhost\"".to_owned(), "model"),
        (base.replace("\"m\"", "\" \""), "model"),
        (base.replace("http:", "ftp:"), "neither http nor https"),
        (base.replace("localhost:8000/v1", "h/v1?x=1"), "query"),
        (base.replace("http://localhost:8000", ""), "base_url"),
        (format!("{base}server = \"vlm\""), "no kind of server"),
        (format!("{base}[retry]\ntries = 0"), "tries"),
        (format!("{base}[retry]\nfirst_pause_seconds = nan"), "pauses"),
        (format!("{base}[timeouts]\nrequest_seconds = -1"), "timeouts"),
        (format!("{base}[timeouts]\nrequest_minutes = 1"), "timeouts"),
        (format!("{base}[prices]\nprompt_per_million = -1\ncompletion_per_million = 1"), "prices"),
        (format!("{base}[body]\nstream = true"), "must not set"),
        (format!("{base}omit = [\"messages\"]"), "cannot be left out"),
        (format!("{base}[header_env]\n\"a b\" = \"C\""), "no HTTP header"),
        (format!("{base}unknown = 1"), "unknown"),
        ("base_url = ".to_owned(), "line 1"),
    ];
    for (text, words) in cases {
        let error = read(&text).unwrap_err();
        assert!(error.to_string().contains(words), "{text}\n{error}");
        assert!(!error.hint().is_empty());
    }
}

#[test]
fn secrets_in_the_wrong_place_are_refused_and_not_quoted() {
    let base = "base_url = \"http://localhost:8000/v1\"\nmodel = \"m\"\n";
    let cases = [
        "base_url = \"https://me:sk-canary@host/v1\"\nmodel = \"m\"".to_owned(),
        "base_url = \"https://sk-canary@host/v1\"\nmodel = \"m\"".to_owned(),
        "base_url = \"https://host/v1?key=sk-canary\"\nmodel = \"m\"".to_owned(),
        format!("{base}api_key = \"sk-canary\""),
        format!("{base}api_key_env = \"sk-canary\""),
        format!("{base}api_key_env = [\"sk-canary\"]"),
        format!("{base}header_env = \"sk-canary\""),
        format!("{base}server = \"sk-canary\""),
        format!("{base}timeouts = \"sk-canary \\\" sk-canary\""),
        format!("{base}[headers]\nx-api-key = \"sk-canary\""),
        format!("{base}[header_env]\nx-api-key = \"sk-canary\""),
        format!("{base}api_key = sk-canary"),
        format!("{base}api_key = \"sk-canary"),
    ];
    for text in cases {
        let error = read(&text).unwrap_err();
        let told = format!("{error} {error:?} {}", error.hint());
        assert!(!told.contains("canary"), "{told}");
    }
    let error = Endpoint::new("https://sk-canary@host", "m").unwrap_err();
    assert!(!format!("{error:?}").contains("canary"));
}
