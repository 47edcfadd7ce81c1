//! The rules themselves, by verb.

use super::Rule;
use super::When::{Any, Is, With, Without};

const SOLVERS: &[&str] = &["solve", "query", "serve", "ablate"];
/// What only a model server is asked with.
const SERVER: &[&str] = &[
    "endpoint",
    "base_url",
    "model",
    "api_key_env",
    "server",
    "link",
    "cache",
    "refresh",
    "max_cost",
    "max_tokens_total",
];
const LATENTS: &[&str] = &["langsplat", "langsplat-per-frame", "4d-langsplat", "*.toml"];
/// Presets of pictures and arrays.
const MAPS: &[&str] = &[
    "langsplat-masks",
    "langsplat-per-frame-masks",
    "4d-langsplat-masks",
    "gaussian-grouping",
    "opengaussian",
    "refersplat",
    "mevis",
    "davis",
    "generic",
    "*.toml",
];

pub(super) const RULES: &[Rule] = &[
    // Scenes.
    Rule {
        verbs: &["doctor"],
        options: &["setup", "python", "blender_scripts", "work"],
        when: Without("tests"),
    },
    Rule {
        verbs: &["build-scenes"],
        options: &["views", "frames", "shard", "samples", "overwrite"],
        when: Without("tracks_only"),
    },
    Rule { verbs: &["sheet"], options: &["scenes"], when: Without("scene") },
    Rule { verbs: &["sheet"], options: &["views", "plain"], when: With("scene") },
    Rule {
        verbs: &["compose"],
        options: &[
            "out",
            "seed",
            "count",
            "scale",
            "split",
            "secret",
            "spec",
            "place",
            "theme",
            "categories",
            "verbs",
            "avoid",
            "draws",
            "force",
            "jobs",
        ],
        when: Without("list"),
    },
    Rule { verbs: &["compose"], options: &["count", "scale"], when: Without("spec") },
    Rule { verbs: &["compose"], options: &["secret"], when: Is("split", &["private"]) },
    // Queries and votes.
    Rule { verbs: &["stats"], options: &["force"], when: With("output") },
    Rule { verbs: &["open-round"], options: &["queries", "composites"], when: Without("from") },
    Rule { verbs: &["verdict"], options: &["unsealed", "force"], when: Without("check") },
    Rule { verbs: &["verdict"], options: &["force"], when: Without("unsealed") },
    // Model servers: nothing is sent, so nothing needs a key.
    Rule {
        verbs: &[
            "endpoint check",
            "endpoint calibrate",
            "propose-prompts",
            "propose-scenes",
            "solve",
            "query",
            "serve",
            "ablate",
        ],
        options: &["api_key_env"],
        when: Is("link", &["live", "record:*"]),
    },
    // Splats.
    Rule { verbs: &["train-splats"], options: &["shrink", "every"], when: Is("profile", &["real"]) },
    Rule { verbs: &["render-splats"], options: &["frames"], when: Without("times") },
    Rule { verbs: &["view", "serve"], options: &["results"], when: With("methods") },
    Rule {
        verbs: &["view", "serve"],
        options: &["no_pictures"],
        when: Is("profile", &["tiny", "small", "full"]),
    },
    Rule { verbs: &["bench splats"], options: &["model"], when: With("scene") },
    Rule { verbs: &["bench splats"], options: &["gaussians", "seed", "size"], when: Without("scene") },
    Rule {
        verbs: &["bench splats"],
        options: &["adapters"],
        when: Any(&[Is("sweeps", &["rasterizer"]), Without("sweeps")]),
    },
    // The reference solver.
    Rule { verbs: &["solve", "query", "serve"], options: SERVER, when: Is("grounder", &["model"]) },
    Rule {
        verbs: &["solve"],
        options: &["control"],
        when: Is("grounder", &["panoptic", "panoptic-fused", "model"]),
    },
    Rule { verbs: &["query"], options: &["words"], when: Is("grounder", &["panoptic", "panoptic-fused"]) },
    Rule {
        verbs: &["query"],
        options: &[
            "from",
            "to",
            "preset",
            "views",
            "view_seed",
            "clip_size",
            "clip_every",
            "no_consensus",
            "abstain",
            "lift",
            "adapter",
            "splats",
            "reader",
            "sh_degree",
            "near",
            "camera",
            "cameras",
            "time",
            "size",
            "explain",
            "out",
            "force",
            "json",
        ],
        when: Without("words"),
    },
    Rule {
        verbs: &["ablate"],
        options: SERVER,
        when: Any(&[Is("grounder", &["model"]), With("grounder_files")]),
    },
    Rule { verbs: SOLVERS, options: &["grounder_file"], when: Is("grounder", &["model"]) },
    Rule { verbs: SOLVERS, options: &["noise"], when: Is("grounder", &["oracle"]) },
    Rule { verbs: SOLVERS, options: &["masks"], when: Is("grounder", &["files"]) },
    Rule { verbs: SOLVERS, options: &["weights"], when: Is("grounder", &["panoptic", "panoptic-fused"]) },
    Rule { verbs: SOLVERS, options: &["given"], when: Is("grounder", &["panoptic-fused"]) },
    Rule { verbs: SOLVERS, options: &["abstain"], when: Without("no_consensus") },
    Rule { verbs: &["solve"], options: &["dry_run"], when: Is("grounder", &["model"]) },
    Rule { verbs: &["query"], options: &["explain"], when: Without("json") },
    Rule { verbs: &["ablate"], options: &["grounder_files"], when: Is("grid", &["vlm"]) },
    Rule { verbs: &["ablate"], options: &["grounder"], when: Without("grounder_files") },
    Rule { verbs: &["ablate"], options: &["correlations", "calibrate"], when: Is("grid", &["mvsc"]) },
    Rule { verbs: &["ablate"], options: &["correlations", "calibrate"], when: Is("grounder", &["oracle"]) },
    Rule { verbs: &["ablate"], options: &["view_counts"], when: Is("grid", &["views"]) },
    Rule {
        verbs: &["ablate"],
        options: &["views"],
        when: Is("grid", &["mvsc", "vlm", "composites", "scales"]),
    },
    Rule {
        verbs: &["ablate"],
        options: &["no_consensus"],
        when: Is("grid", &["views", "vlm", "composites", "scales"]),
    },
    // Other tools.
    Rule {
        verbs: &["export"],
        options: &["points", "points_from"],
        when: Is(
            "format",
            &["4dgaussians", "4dgaussians-dynerf", "4d-langsplat", "langsplat", "nerfstudio", "colmap"],
        ),
    },
    Rule {
        verbs: &["export"],
        options: &["frames"],
        when: Is(
            "format",
            &[
                "4dgaussians",
                "4dgaussians-dynerf",
                "4d-langsplat",
                "langsplat",
                "nerfstudio",
                "colmap",
                "coco",
                "davis",
            ],
        ),
    },
    Rule {
        verbs: &["import-scene"],
        options: &["moments"],
        when: Is("source", &["neu3d", "interdigital", "hypernerf"]),
    },
    Rule { verbs: &["import-scene"], options: &["ffmpeg"], when: Is("source", &["neu3d"]) },
    Rule {
        verbs: &["import-scene"],
        options: &["moments", "ffmpeg", "held_out"],
        when: Without("masks_only"),
    },
    Rule { verbs: &["import-scene"], options: &["masks"], when: With("masks_format") },
    Rule {
        verbs: &["import-scene"],
        options: &["masks_format", "bench", "masks_only", "force"],
        when: With("masks"),
    },
    Rule { verbs: &["import-scene"], options: &["bench"], when: With("scale") },
    Rule { verbs: &["import-scene"], options: &["scale"], when: With("bench") },
    Rule { verbs: &["import"], options: &["texts", "decoder"], when: Is("format", LATENTS) },
    Rule {
        verbs: &["import"],
        options: &["time_texts", "time_decoder"],
        when: Is("format", &["4d-langsplat", "*.toml"]),
    },
    Rule { verbs: &["import"], options: &["time_decoder"], when: With("time_texts") },
    Rule {
        verbs: &["import"],
        options: &["inside"],
        when: Any(&[Is("format", MAPS), Is("codec", &["picture", "array"])]),
    },
    Rule {
        verbs: &["import"],
        options: &["inside"],
        when: Any(&[Is("codec", &["picture", "array"]), Without("codec")]),
    },
    Rule {
        verbs: &["import"],
        options: &["key"],
        when: Any(&[Is("codec", &["array"]), Is("format", &["refersplat", "*.toml"])]),
    },
    Rule { verbs: &["import"], options: &["key"], when: Any(&[Is("codec", &["array"]), Without("codec")]) },
    Rule {
        verbs: &["import"],
        options: &["selections"],
        when: Any(&[Is("inside", &["selected"]), Is("format", &["davis", "*.toml"])]),
    },
    Rule {
        verbs: &["import"],
        options: &["selections"],
        when: Any(&[Is("inside", &["selected"]), Without("inside")]),
    },
    Rule { verbs: &["import"], options: &["images_first"], when: With("images") },
    // Judging.
    Rule {
        verbs: &["baseline"],
        options: &["seed"],
        when: Any(&[Is("names", &["random-look-alike"]), Without("names")]),
    },
    Rule { verbs: &["score"], options: &["groups", "hit_iou"], when: Is("protocol", &["l4d"]) },
    Rule {
        verbs: &["score"],
        options: &["missing"],
        when: Is("protocol", &["l4d", "langsplat", "4d-langsplat", "davis"]),
    },
    Rule { verbs: &["check-results"], options: &["all"], when: Without("json") },
    Rule { verbs: &["score"], options: &["seed"], when: With("groups") },
    Rule { verbs: &["leaderboard"], options: &["results", "data"], when: With("html") },
    // Publishing.
    Rule {
        verbs: &["release"],
        options: &["date", "url", "creators", "profile", "data", "work", "since", "rounds", "out"],
        when: Without("check"),
    },
    Rule { verbs: &["release"], options: &["data", "work"], when: With("profile") },
    Rule { verbs: &["cluster init"], options: &["partition", "account"], when: Is("engine", &["slurm"]) },
];
