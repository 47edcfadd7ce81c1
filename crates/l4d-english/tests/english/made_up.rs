//! A made-up yard: enough of everything that every clause can be said.

use l4d_data::tracks::Tracks;

/// (id, name, category, attributes)
type Thing = (u32, &'static str, &'static str, &'static [(&'static str, &'static str)]);

const THINGS: &[Thing] = &[
    (
        1,
        "cup_a",
        "cup",
        &[("colour", "red"), ("pattern", "stripes"), ("content", "coffee"), ("size", "small")],
    ),
    (2, "cup_b", "cup", &[("colour", "blue"), ("pattern", "plain"), ("content", "empty"), ("size", "large")]),
    (3, "cup_c", "cup", &[("colour", "red"), ("pattern", "plain"), ("content", "tea"), ("size", "large")]),
    (4, "cat_a", "cat", &[("colour", "grey"), ("pattern", "striped")]),
    (5, "cat_b", "cat", &[("colour", "black"), ("pattern", "plain")]),
    (6, "woman_a", "woman", &[("top", "green"), ("trousers", "jeans"), ("hair", "ponytail")]),
    (7, "woman_b", "woman", &[("top", "red"), ("trousers", "black"), ("hair", "bun")]),
    (8, "child_a", "child", &[("shirt", "yellow"), ("trousers", "shorts"), ("hair_colour", "blond")]),
    (9, "child_b", "child", &[("shirt", "red"), ("trousers", "blue"), ("hair_colour", "dark_brown")]),
    (10, "ball_a", "ball", &[("colour", "yellow"), ("pattern", "dotted")]),
    (11, "ball_b", "ball", &[("colour", "green"), ("pattern", "striped")]),
    (12, "car_a", "car", &[("colour", "mint"), ("roof", "rack")]),
    (13, "car_b", "car", &[("colour", "silver"), ("roof", "white")]),
    (14, "apple_a", "apple", &[("colour", "green"), ("state", "bitten"), ("leaf", "yes")]),
    (15, "apple_b", "apple", &[("colour", "red"), ("state", "whole"), ("leaf", "no")]),
    (16, "cook_a", "cook", &[("apron", "striped"), ("hat", "tall")]),
    (17, "cook_b", "cook", &[("apron", "none"), ("hat", "none")]),
    (18, "bag_a", "bag", &[("kind", "backpack"), ("strap", "cream")]),
    (19, "bag_b", "bag", &[("kind", "duffel"), ("strap", "none")]),
    (1001, "hand_a", "hand", &[]),
    (1002, "hand_b", "hand", &[]),
    (1003, "tray", "tray", &[]),
    (1004, "lamp", "lamp", &[]),
    (1005, "table", "table", &[]),
    (1006, "book_green", "book", &[("colour", "green")]),
    (1007, "book_blue", "book", &[("colour", "blue")]),
    (1008, "sofa", "sofa", &[]),
    (1009, "post_a", "post", &[]),
    (1010, "post_b", "post", &[]),
    (1011, "window", "window", &[]),
    (1012, "laptop", "laptop", &[]),
    (1013, "magazine", "magazine", &[]),
    (1014, "bench", "bench", &[]),
];

/// (subject, verb, object)
const EVENTS: &[(&str, &str, &str)] = &[
    ("hand_a", "lift", "cup_a"),
    ("hand_a", "put_down", "cup_a"),
    ("hand_b", "push", "cup_b"),
    ("hand_a", "hold", "cup_c"),
    ("hand_b", "stir", "cup_c"),
    ("cup_b", "slide", ""),
    ("cat_a", "run", ""),
    ("cat_b", "sleep", ""),
    ("cat_a", "watch", "ball_a"),
    ("cat_b", "bat", "ball_b"),
    ("cat_a", "sit", ""),
    ("woman_a", "wave", ""),
    ("woman_a", "pet", "cat_a"),
    ("woman_b", "walk", ""),
    ("woman_b", "carry", "bag_a"),
    ("woman_b", "phone", ""),
    ("child_a", "kick", "ball_a"),
    ("child_b", "jump", ""),
    ("child_b", "hug", "cat_b"),
    ("child_a", "walk", ""),
    ("ball_a", "roll", ""),
    ("ball_b", "roll", ""),
    ("car_a", "drive", ""),
    ("car_b", "brake", ""),
    ("car_b", "wait_for", "child_b"),
    ("apple_a", "tip", ""),
    ("cook_a", "drink_from", "cup_c"),
    ("cook_a", "type_on", "laptop"),
    ("cook_b", "turn_page", "magazine"),
    ("cook_a", "hand_over", "bag_b"),
    ("woman_a", "talk_to", "cook_a"),
];

/// The tracks of the yard: nothing moves, everything is apart.
pub(crate) fn yard() -> Tracks {
    let instances: Vec<String> = THINGS.iter().map(|thing| instance(*thing)).collect();
    let events: Vec<String> = EVENTS.iter().map(|event| line(*event)).collect();
    let text = format!(
        r#"{{"schema":"l4d/tracks/1","scene":"yard","scale":"room","variant":0,"seed":0,"fps":24,"frame_count":97,"exposure":1,"description":"","pair_reach_m":0.05,"instances":[{}],"events":[{}],"pairs":[],"cameras":[]}}"#,
        instances.join(","),
        events.join(",")
    );
    serde_json::from_str(&text).unwrap()
}

fn instance((id, name, category, attributes): Thing) -> String {
    let role = if id > 1000 { "landmark" } else { "object" };
    let attributes: Vec<String> =
        attributes.iter().map(|(key, value)| format!(r#""{key}":"{value}""#)).collect();
    format!(
        r#"{{"id":{id},"name":"{name}","role":"{role}","category":"{category}","attributes":{{{}}},"front":"-y","track":{{"centre":[[{id},0,0]],"axes":[[1,0,0,0,1,0,0,0,1]],"extents":[[0.1,0.1,0.1]]}}}}"#,
        attributes.join(",")
    )
}

fn line((subject, verb, object): (&str, &str, &str)) -> String {
    let object = if object.is_empty() { "null".to_owned() } else { format!("\"{object}\"") };
    format!(r#"{{"subject":"{subject}","verb":"{verb}","object":{object},"frames":[10,40]}}"#)
}
