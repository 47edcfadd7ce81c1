//! Everyday wordings over dev scenes: what people say besides what the grammar says, and what cannot be read.
#![expect(clippy::unwrap_used, reason = "a test that cannot read the dev set has failed")]

use std::path::Path;
use std::time::{Duration, Instant};

use l4d_data::tracks::Tracks;
use l4d_data::{Role, Temporal};
use l4d_english::{Reading, Unread, Vocabulary, Words, understand};

/// Reading a hostile text may take this long in an unoptimised build on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

fn tracks(scene: &str) -> Tracks {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../benchmark/dev/scenes/{scene}.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn best(text: &str, words: &Words<'_>) -> Reading {
    understand(text, words).unwrap_or_else(|unread| panic!("{text}: {unread}")).swap_remove(0)
}

fn meaning(text: &str, words: &Words<'_>) -> String {
    let reading = best(text, words);
    let gate = if reading.temporal == Temporal::While { " while" } else { "" };
    format!("{}{gate}", reading.predicate)
}

#[test]
fn sentences_that_nobody_wrote_for_a_grammar() {
    let cases = [
        // Hypernyms and other names.
        ("room_0506", "the animal that naps", "cat(x) and sleep(x)"),
        ("room_0506", "the feline wearing a green collar", "cat(x) and collar(x) = green"),
        ("outdoor_0513", "the automobile with the dark roof", "car(x) and roof(x) = black_roof"),
        ("room_0507", "the saucepan nearest to the greenery", "pot(x) and closest_to(x, plant)"),
        ("tabletop_0515", "the android by the candle", "robot(x) and beside(x, candle)"),
        ("outdoor_0502", "someone bending over", "woman(x) and bend_down(x)"),
        // Verb phrases.
        ("outdoor_0501", "the dog which goes tearing after a ball", "dog(x) and chase(x, any ball)"),
        ("outdoor_0504", "the animal that takes to the air", "duck(x) and fly(x)"),
        ("room_0507", "the last cook who gets to their feet", "cook(x) and last stand(x)"),
        ("room_0508", "the player that lets out a cheer", "woman(x) and cheer(x)"),
        ("tabletop_0512", "Which block is it that a hand gives a push to?", "block(x) and push(any hand, x)"),
        ("room_0506", "The toy with a cat batting at it", "toy(x) and bat(any cat, x)"),
        // Parts and what they are like.
        (
            "outdoor_0502",
            "I'm talking about the lady whose hair is blonde",
            "woman(x) and hair_colour(x) = blond",
        ),
        (
            "tabletop_0515",
            "the robot with cogs on its front that's turquoise",
            "robot(x) and chest(x) = gears and colour(x) = teal",
        ),
        ("room_0514", "Which of the men has got a shirt with long sleeves?", "man(x) and sleeves(x) = long"),
        // The ends of the clip.
        (
            "outdoor_0501",
            "The ball that, when all is said and done, is the furthest from the chair",
            "ball(x) and at the end farthest_from(x, chair)",
        ),
        (
            "outdoor_0513",
            "Which vehicle is looking towards the hay bale as the video starts?",
            "car(x) and at the start facing(x, bale)",
        ),
        (
            "tabletop_0511",
            "The cup which, once the clip is done, is at the greatest distance from the notepad",
            "cup(x) and at the end farthest_from(x, notepad)",
        ),
        ("room_0508", "the ball that finishes beside the bench", "ball(x) and at the end beside(x, bench)"),
        // Orders.
        (
            "outdoor_0501",
            "Find the dog that breaks into a run before any of the others does",
            "dog(x) and first run(x)",
        ),
        (
            "outdoor_0513",
            "The car that drives only after all the others have driven",
            "car(x) and last drive(x)",
        ),
        (
            "tabletop_0511",
            "Of the two teapots, which one is tipped over first?",
            "teapot(x) and first tip(x)",
        ),
        (
            "room_0507",
            "the cook who tastes the food, but first gives a pot a stir",
            "cook(x) and stir(x, any pot) then taste(x)",
        ),
        (
            "room_0507",
            "The cook that gives a pot a stir before tasting the food",
            "cook(x) and stir(x, any pot) then taste(x)",
        ),
        // Whiles.
        ("room_0506", "the pet while it is on the move", "cat(x) and walk(x) while"),
        (
            "outdoor_0501",
            "dog, but only during the part where it's giving a ball a nudge",
            "dog(x) and nudge(x, any ball) while",
        ),
        ("outdoor_0504", "the bird facing the fence, while it does so", "duck(x) and facing(x, fence) while"),
        ("outdoor_0504", "the duck during its flight", "duck(x) and fly(x) while"),
        // Order of words, ellipsis, other sentences.
        ("tabletop_0512", "furthest cube from the jar", "block(x) and farthest_from(x, jar)"),
        ("room_0507", "chef in grey pants", "cook(x) and trousers(x) = grey"),
        (
            "tabletop_0513",
            "at the end it's touching a hand, that pen",
            "pen(x) and at the end touching(x, any hand)",
        ),
        (
            "tabletop_0511",
            "No teapot ever pours anything into this cup",
            "cup(x) and not pour_into(any teapot, x)",
        ),
        (
            "outdoor_0502",
            "There's a basket with pears; I want the one right next to it",
            "basket(x) and beside(x, the y: basket(y) and content(y) = pears)",
        ),
        (
            "room_0508",
            "Everyone waves at some point, but I want the woman who waves last",
            "woman(x) and last wave(x)",
        ),
        (
            "room_0507",
            "Who's the cook that neither holds the jug nor stirs a pot?",
            "cook(x) and not hold(x, jug) and not stir(x, any pot)",
        ),
        // Misspellings.
        (
            "outdoor_0501",
            "teh strpied ball thats orange",
            "ball(x) and colour(x) = orange and pattern(x) = striped",
        ),
        ("outdoor_0513", "the vehical farthest from teh sgin", "car(x) and farthest_from(x, sign)"),
    ];
    let mut wrong = Vec::new();
    for (scene, text, expected) in cases {
        let tracks = tracks(scene);
        let found = meaning(text, &Words::of(&tracks));
        if found != expected {
            wrong.push(format!("{text}\n    {found}\n    {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_is_inferred_says_so() {
    let tracks = tracks("outdoor_0501");
    let words = Words::of(&tracks);
    let exact = best("The dog that walks", &words);
    assert_eq!((exact.confidence, exact.note()), (1.0, None));
    let inferred = best("teh zestful dog that walks", &words);
    assert!(inferred.confidence < 1.0);
    assert_eq!(inferred.skipped, ["zestful"]);
    assert_eq!(inferred.repairs, [("teh".to_owned(), "the".to_owned())]);
    assert_eq!(inferred.note().unwrap(), "an inferred reading; skipped: zestful; read \"teh\" as \"the\"");
}

#[test]
fn what_cannot_be_read_gets_one_line_and_soon() {
    let tracks = tracks("outdoor_0501");
    let words = Words::of(&tracks);
    let started = Instant::now();
    assert_eq!(understand("", &words), Err(Unread::Empty));
    assert_eq!(understand(" ?! ", &words), Err(Unread::Empty));
    assert_eq!(understand(&"dog ".repeat(500), &words), Err(Unread::Long(500)));
    let hostile =
        "the dog that is next to the ball that is next to the dog that never chases the ball and ".repeat(4);
    let _ = understand(&hostile, &words);
    let foreign = [
        "Der braune Hund, der am Ende neben dem Tor steht",
        "le chien qui court le plus vite",
        "一番大きい犬",
        "собака, которая бежит",
        "el perro marrón que persigue la pelota",
        "asdf qwer zxcv",
        "!!!\u{202e}\0\n\t",
        "12345 67890",
    ];
    for text in foreign {
        let message = match understand(text, &words) {
            Err(unread) => unread.to_string(),
            Ok(readings) => panic!("{text}: {}", readings[0].predicate),
        };
        assert!(!message.contains('\n') && message.len() < 400, "{message}");
    }
    let unclear = understand("Der braune Hund, der läuft", &words).unwrap_err().to_string();
    assert!(unclear.contains("braune") && unclear.contains("dog"), "{unclear}");
    assert!(started.elapsed() < PATIENCE, "{:?}", started.elapsed());
}

#[test]
fn a_network_that_knows_words_alone_is_enough() {
    let nouns = [("dog", Role::Object), ("ball", Role::Object), ("gate", Role::Landmark)];
    let vocabulary = Vocabulary {
        nouns: nouns.map(|(noun, role)| (noun.to_owned(), role)).into(),
        attributes: [("colour".to_owned(), ["brown", "orange"].map(str::to_owned).into())].into(),
        verbs: ["run", "chase"].map(str::to_owned).into(),
    };
    let words = Words::of_vocabulary(&vocabulary);
    let cases = [
        ("the hound that goes after a ball", "dog(x) and chase(x, any ball)"),
        ("whichever of the dogs is brown", "dog(x) and colour(x) = brown"),
        ("ball furthest away from the gate", "ball(x) and farthest_from(x, the y: gate(y))"),
        ("the animal that takes off running first", "dog(x) and first run(x)"),
    ];
    for (text, expected) in cases {
        assert_eq!(meaning(text, &words), expected, "{text}");
    }
}
