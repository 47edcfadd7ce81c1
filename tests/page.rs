//! The leaderboard's page in a real browser: what a person can do with it, by mouse, by keys and by ear.

mod browser;
mod crowd;

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use l4d_data::truth::Truth;
use l4d_frames::Display;
use l4d_masks::Mask;
use serde_json::Value;

use self::browser::Browser;
use crate::annotation_tui::data;
use crate::support::{Dir, root};

const PROFILE: [&str; 2] = ["--profile", "tiny"];
/// The buttons in the heads of the board.
const BOARD: &str = "document.querySelector('[aria-labelledby=ranking]')";

/// A page of scored baselines and a contestant.
fn page() -> Dir {
    let dir = crate::leaderboard::scored();
    make(&dir);
    dir
}

fn make(dir: &Dir) {
    dir.succeed(&[&["leaderboard", "--html"], &PROFILE[..]].concat());
}

fn file(dir: &Dir) -> PathBuf {
    dir.path("leaderboard/index.html")
}

fn open(dir: &Dir, address: &str) -> Browser {
    let mut browser = Browser::start(1280, 900);
    browser.open(&file(dir), address);
    browser
}

/// The names of the methods in the order of the table.
fn order(browser: &mut Browser) -> Vec<String> {
    let names = browser.evaluate(&format!(
        "[...{BOARD}.querySelectorAll('tbody th.name > :first-child')].map((cell) => cell.textContent)"
    ));
    serde_json::from_value(names).unwrap()
}

fn click(browser: &mut Browser, selector: &str) {
    let clicked = browser.evaluate(&format!(
        "(() => {{ const found = document.querySelector({selector:?}); found?.focus(); found?.click(); return found !== null; }})()"
    ));
    assert_eq!(clicked, true, "{selector} is not there");
}

/// Chooses an option as a person does: the value changes and the page gets the event.
fn choose(browser: &mut Browser, label: &str, value: &str) {
    browser.evaluate(&format!(
        "{{ const label = [...document.querySelectorAll('label')].find((label) => label.textContent.startsWith({label:?}));
           const field = label.control;
           field.value = {value:?};
           field.dispatchEvent(new Event(field.tagName === 'SELECT' ? 'change' : 'input', {{ bubbles: true }})); }}"
    ));
}

/// The first cell of that kind in the row of a method.
fn first_number(browser: &mut Browser, kind: &str, name: &str) -> String {
    browser.text(&format!(
        "[...{BOARD}.querySelectorAll('tbody tr')].find((row) => row.querySelector('th.name')?.firstElementChild.textContent === {name:?}).querySelector('{kind}').textContent"
    ))
}

fn h1(browser: &mut Browser) -> String {
    browser.text("document.querySelector('h1').textContent")
}

/// Waits until a scene is unpacked.
fn ready(browser: &mut Browser) {
    browser.until("!document.getElementById('main').textContent.includes('Unpacking')");
}

fn assert_quiet(browser: &mut Browser) {
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn the_head_of_a_column_sorts_by_click_and_by_key() {
    let dir = page();
    let mut browser = open(&dir, "");
    // Ranked first, whatever the order: the contestant. Baselines below it.
    let start = order(&mut browser);
    assert_eq!(start.len(), 6, "{start:?}");
    assert_eq!(start[0], "contestant");
    assert!(start.contains(&"oracle".to_owned()));
    let state = |browser: &mut Browser, key: &str| {
        browser.text(&format!("{BOARD}.querySelector('[data-sort={key}]').closest('th').ariaSort"))
    };
    assert_eq!(state(&mut browser, "miou"), "descending");

    click(&mut browser, "[data-sort=name]");
    assert_eq!(state(&mut browser, "name"), "ascending");
    assert_eq!(state(&mut browser, "miou"), "none");
    let mut sorted = order(&mut browser);
    assert!(sorted[0] == "contestant" && sorted[1..].is_sorted(), "{sorted:?}");
    browser.press("Enter");
    // The head kept the focus through the redraw, so the key pressed it again.
    assert_eq!(state(&mut browser, "name"), "descending");
    sorted[1..].reverse();
    assert_eq!(order(&mut browser), sorted);
    assert!(browser.text("location.hash").contains("sort=-name"));
    assert!(browser.text("document.getElementById('said').textContent").contains("Sorted by Method"));
    assert_quiet(&mut browser);
}

#[test]
fn filters_show_the_numbers_of_the_tables() {
    let dir = page();
    let mut browser = open(&dir, "");
    let tables = [("per_category.csv", "Category", "action"), ("per_scale.csv", "Scale", "room")];
    for (table, label, group) in tables {
        choose(&mut browser, label, group);
        let csv = dir.read(&format!("leaderboard/{table}"));
        for line in csv.lines().filter(|line| line.contains(&format!(",{group},"))) {
            let fields: Vec<&str> = line.split(',').collect();
            let expected = format!("{:.2}", fields[5].parse::<f64>().unwrap());
            let cell = first_number(&mut browser, "td.number > span", fields[2]);
            // The first number of an unranked row is its miou as well: its rank is a dash without a span.
            assert_eq!(cell, expected, "{line}");
        }
        choose(&mut browser, label, "");
    }
    choose(&mut browser, "Category", "spatial");
    choose(&mut browser, "Scale", "outdoor");
    assert_eq!(browser.text("document.querySelector('.count').textContent"), "6 methods, 1 query");
    choose(&mut browser, "Method", "TIME");
    assert_eq!(order(&mut browser), ["time-agnostic"]);
    choose(&mut browser, "Method", "no such");
    assert!(browser.text(&format!("{BOARD}.textContent")).contains("No method matches"));
    assert_quiet(&mut browser);
}

#[test]
fn tracks_are_apart_and_have_their_own_best() {
    let dir = page();
    // A method without rivals in its track is not called best.
    let mut browser = open(&dir, "");
    assert!(browser.evaluate(&format!("{BOARD}.querySelector('.best') === null")) == true);
    for (baseline, name, depth) in [("none", "blank", false), ("oracle", "deep", true), ("all", "flat", true)]
    {
        crate::leaderboard::contestant(&dir, baseline, name, depth);
    }
    dir.succeed(&[&["score"], &PROFILE[..]].concat());
    make(&dir);
    browser.open(&file(&dir), "#a=contestant&b=deep");
    assert_eq!(order(&mut browser)[..4], ["contestant", "blank", "deep", "flat"]);
    let heads =
        browser.evaluate(&format!("[...{BOARD}.querySelectorAll('tr.rule')].map((one) => one.textContent)"));
    assert_eq!(
        heads,
        serde_json::json!(["Track: colour", "Track: colour + depth", "Not ranked, shown for scale"])
    );
    let best = browser.evaluate(&format!(
        "[...new Set([...{BOARD}.querySelectorAll('.best')].map((one) => one.closest('tbody').rows[0].textContent))]"
    ));
    assert_eq!(best, serde_json::json!(["Track: colour", "Track: colour + depth"]));
    let verdict = browser.text("document.querySelector('.verdict').textContent");
    assert!(verdict.contains("methods of two tracks are not compared"), "{verdict}");
    click(&mut browser, "[data-sort=name]");
    assert_eq!(
        order(&mut browser)[..4],
        ["blank", "contestant", "deep", "flat"],
        "groups stay apart in any order"
    );
    browser.open(&file(&dir), "#method=deep");
    let facts = browser.text("document.querySelector('.facts').textContent");
    assert!(facts.contains("Rank1") && facts.contains("Trackcolour + depth"), "{facts}");
    assert_quiet(&mut browser);
}

#[test]
fn what_few_scenes_cannot_say_is_told() {
    let dir = page();
    let mut browser = open(&dir, "#a=oracle&b=none");
    let range = browser.text(&format!("{BOARD}.querySelector('.range').textContent"));
    assert!(range.ends_with(" ! of fewer than 8 scenes"), "{range}");
    let verdict = browser.text("document.querySelector('.verdict').textContent");
    assert!(verdict.contains("100.00 points higher than that of none"), "{verdict}");
    assert!(verdict.contains("no outcome could have had p below 0.05"), "{verdict}");
    assert!(!verdict.contains("four times in five"), "{verdict}");
    browser.open(&file(&dir), "#a=oracle&b=time-agnostic");
    let verdict = browser.text("document.querySelector('.verdict').textContent");
    assert!(verdict.contains("They do not differ in any scene."), "{verdict}");
    assert_quiet(&mut browser);
}

#[test]
fn methods_that_were_scored_on_something_else_stand_behind_the_filter_of_protocols() {
    let dir = page();
    dir.succeed(&["score", "results/all", "--profile", "tiny", "--hit-iou", "0.5"]);
    make(&dir);
    let mut browser = open(&dir, "");
    assert!(!order(&mut browser).contains(&"all".to_owned()));
    choose(&mut browser, "Protocol", "0");
    assert_eq!(order(&mut browser), ["all"]);
    assert!(browser.text(&format!("{BOARD}.textContent")).contains("with hits above IoU 0.5"));
    assert_quiet(&mut browser);
}

/// The same masks under the rules of others, beside the scores.
fn judge(dir: &Dir, protocols: &[&str]) {
    for protocol in protocols {
        dir.succeed(&[&["score", "--protocol", protocol], &PROFILE[..]].concat());
    }
}

#[test]
fn a_protocol_of_others_has_a_table_of_its_own_down_to_the_query() {
    let dir = page();
    judge(&dir, &["davis", "4d-langsplat"]);
    make(&dir);
    let mut browser = open(&dir, "");
    let ours = browser.text(&format!("{BOARD}.textContent"));
    assert!(!ours.contains("J&F"), "a protocol is mixed into the ranking");
    choose(&mut browser, "Protocol", "davis");
    assert_eq!(order(&mut browser).len(), 6);
    assert!(browser.text("location.hash").contains("board=davis"));
    let table = browser.text(&format!("{BOARD}.textContent"));
    assert!(table.contains("protocol davis (DAVIS 2017, semi-supervised)"), "{table}");
    assert!(table.contains("never ranked") && !table.contains("mIoU"), "{table}");
    // Every head of a number names the protocol, so that a picture of a part cannot be taken for another table.
    let heads = browser.evaluate(&format!(
        "[...{BOARD}.querySelectorAll('thead th.number .over')].map((one) => one.textContent)"
    ));
    assert_eq!(heads, serde_json::json!(vec!["davis"; 7]));
    let said = browser.text("document.getElementById('said').textContent");
    assert!(said.contains("Under the rules of others: davis"), "{said}");
    assert!(browser.text("document.querySelector('main .notice').textContent").contains("never ranked"));
    let left_out = browser.text("document.querySelector('ul.plain').textContent");
    assert!(left_out.contains("Every method: 12 frames of 6 queries are first or last"), "{left_out}");

    // The numbers are those of the files, whole and in a group.
    let kept: Value = l4d_data::json::read(&dir.path("scores-davis/contestant/protocol-davis.json")).unwrap();
    let printed = |value: &Value| value.as_f64().map_or("–".to_owned(), |value| format!("{value:.2}"));
    assert_eq!(first_number(&mut browser, "td.number", "contestant"), printed(&kept["measures"]["j_and_f"]));
    choose(&mut browser, "Scale", "room");
    assert_eq!(
        first_number(&mut browser, "td.number", "contestant"),
        printed(&kept["scenes"]["room_discs"]["j_and_f"])
    );
    choose(&mut browser, "Scale", "");

    // Down to a scene, a query and its frames.
    browser.open(&file(&dir), "#board=davis&method=contestant");
    assert_eq!(h1(&mut browser), "contestant under davis");
    click(&mut browser, "a[href*='scene=room_discs']");
    browser.until("document.querySelectorAll('tbody tr').length === 4");
    let csv = dir.read("scores-davis/contestant/protocol-davis.csv");
    let line = csv.lines().find(|line| line.contains(",room_discs,001,")).unwrap();
    let value: f64 = line.split(',').nth(3).unwrap().parse().unwrap();
    let cells = browser.text(
        "[...document.querySelectorAll('tbody tr')].find((row) => row.cells[0].textContent === '001').cells[3].textContent",
    );
    assert_eq!(cells, format!("{value:.2}"));
    click(&mut browser, "a[href*='query=001']");
    browser.until("document.querySelector('.stage canvas')");
    let facts = browser.text("document.querySelector('.facts').textContent");
    assert!(facts.contains(&format!("davis: J&F{value:.2}")), "{facts}");
    // Methods that a protocol never judged, and scenes that are none, are nothing.
    for address in ["#board=davis&method=nobody", "#board=davis&method=contestant&scene=nowhere"] {
        browser.open(&file(&dir), address);
        assert_eq!(h1(&mut browser), "There is nothing at this address");
    }
    // From a method of the board to what others would say of it.
    browser.open(&file(&dir), "#method=contestant");
    click(&mut browser, "a[href*='board=4d-langsplat']");
    browser.until("document.querySelector('h1').textContent === 'contestant under 4d-langsplat'");
    assert_quiet(&mut browser);
}

#[test]
fn a_query_shows_the_pixels_that_were_counted() {
    let dir = page();
    // 001 means disc_a in the whole clip; the oracle finds it, `none` misses it, `all` marks everything.
    let truth: Value = l4d_data::json::read(&dir.path("benchmark/truth/tiny/room_discs.json")).unwrap();
    let disc = truth["instances"].as_array().unwrap().iter().find(|one| one["name"] == "disc_a").unwrap();
    let mask = Mask::decode(disc["masks"]["0048"].as_str().unwrap(), 128, 96).unwrap();
    let (target, pixels) = (mask.area(), 128 * 96);
    assert!(target > 50);
    let mut browser = Browser::start(1280, 900);
    for (method, found, missed, extra) in
        [("oracle", target, 0, 0), ("none", 0, target, 0), ("all", target, 0, pixels - target)]
    {
        browser.open(&file(&dir), &format!("#method={method}&scene=room_discs&query=001&frame=48"));
        browser.until("document.querySelector('.stage canvas')?.width > 300");
        // Yellow, blue and vermillion over the dark ground, striped or not: told apart by their channels.
        let counts = browser.evaluate(
            "(() => { const canvas = document.querySelector('.stage canvas');
                const { data, width } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
                const counts = [0, 0, 0];
                for (let at = 0; at < data.length; at += 4) {
                    const [red, green, blue] = data.slice(at, at + 3);
                    // Grey: the ground and what else is there.
                    if (Math.max(red, green, blue) - Math.min(red, green, blue) < 30) continue;
                    counts[blue > red ? 0 : green > 0.7 * red ? 1 : 2] += 1;
                }
                const factor = width / 128;
                return counts.map((count) => count / factor / factor); })()",
        );
        assert_eq!(counts, serde_json::json!([found, missed, extra]), "{method}");
        let label = browser.text("document.querySelector('.stage canvas').ariaLabel");
        assert!(label.contains("frame 48"), "{label}");
    }
    // A mask that changed after scoring contradicts its numbers, so it is not shown.
    let masks = "results/oracle/masks/room_discs/001.json";
    dir.write(masks, dir.read("results/all/masks/room_discs/001.json"));
    make(&dir);
    browser.open(&file(&dir), "#method=oracle&scene=room_discs&query=001");
    browser
        .until("document.querySelector('.stage figcaption')?.textContent.includes('truth is shown alone')");
    assert_quiet(&mut browser);
}

/// Red, green and blue of the middle of a pixel of the mask, on the large picture of a query.
fn colour_at(browser: &mut Browser, [width, column, row]: [u32; 3]) -> [f64; 3] {
    let found = browser.evaluate(&format!(
        "(() => {{ const canvas = document.querySelector('.stage canvas');
            const factor = canvas.width / {width};
            const at = (place) => Math.floor((place + 0.5) * factor);
            return [...canvas.getContext('2d').getImageData(at({column}), at({row}), 1, 1).data.slice(0, 3)]; }})()"
    ));
    serde_json::from_value(found).unwrap()
}

/// What the page makes of a colour of a picture: grey, darker, so that the overlay is what is coloured.
fn greyed([red, green, blue]: [f64; 3]) -> f64 {
    0.62 * (0.299 * red + 0.587 * green + 0.114 * blue) + 12.0
}

/// As close as JPEG keeps flat colours.
fn assert_close(found: [f64; 3], expected: [f64; 3]) {
    let is_close = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= 6.0);
    assert!(is_close, "{found:?} instead of {expected:?}");
}

#[test]
fn a_picture_of_the_held_out_view_lies_under_the_masks() {
    let dir = page();
    let truth = Truth::read(&dir.path("benchmark/truth/tiny/room_discs.json")).unwrap();
    data::render(&dir, &truth);
    let run = dir.succeed(&[&["leaderboard", "--html", "--data", "data/tiny"], &PROFILE[..]].concat());
    assert!(run.stderr.contains("holds 1 of 2 scenes"), "{}", run.stderr);

    let frame = data::picture(&truth, 48);
    let display = Display::new(1.0).picture(&frame);
    let mask = |name: &str| {
        let disc = truth.instances.iter().find(|one| one.name.as_str() == name).unwrap();
        Mask::from_rle(&disc.masks["0048"], truth.width, truth.height)
    };
    // In the middle of what is flat, where JPEG changes little.
    let inside = |mask: &Mask| {
        let is_deep = |&(column, row): &(u32, u32)| {
            (column.saturating_sub(4)..=column + 4).all(|column| {
                (row.saturating_sub(4)..=row + 4)
                    .all(|row| column < truth.width && row < truth.height && mask.get(column, row))
            })
        };
        mask.pixels().find(is_deep).unwrap()
    };
    let below = |(column, row): (u32, u32)| greyed(display.get_pixel(column, row).0.map(f64::from));
    let (target, floor) = (inside(&mask("disc_a")), inside(&mask("floor")));
    assert!((below(target) - below(floor)).abs() > 12.0, "both look the same, so nothing is proved");

    let mut browser = Browser::start(1280, 900);
    browser.open(&file(&dir), "#method=oracle&scene=room_discs&query=001&frame=48");
    browser.until("document.querySelector('.stage canvas')?.width > 300");
    // Painted when the picture is decoded.
    browser.until("document.querySelector('.stage canvas').dataset.picture === 'shown'");
    let at =
        |browser: &mut Browser, (column, row): (u32, u32)| colour_at(browser, [truth.width, column, row]);
    assert_close(at(&mut browser, floor), [below(floor); 3]);
    let found = [86.0, 180.0, 233.0].map(|colour| below(target) + 0.72 * (colour - below(target)));
    assert_close(at(&mut browser, target), found);
    // Without the picture: the dark ground with what else is there.
    click(&mut browser, ".layers label:nth-of-type(3) input");
    browser.until("document.querySelector('.stage canvas').dataset.picture !== 'shown'");
    assert_close(at(&mut browser, floor), [50.0, 56.0, 63.0]);
    // The scene that is not rendered has no such switch, and its masks.
    browser.open(&file(&dir), "#method=oracle&scene=outdoor_discs&query=001");
    browser.until("document.querySelectorAll('.layers input').length === 2");
    assert_quiet(&mut browser);

    // A damaged picture is reported and left out.
    dir.write("data/tiny/room_discs/frames/test/0048.exr", "torn");
    let run = dir.succeed(&[&["leaderboard", "--html", "--data", "data/tiny"], &PROFILE[..]].concat());
    assert!(run.stderr.contains("0048.exr"), "{}", run.stderr);
    browser.open(&file(&dir), "#method=oracle&scene=room_discs&query=001&frame=48");
    browser.until("document.querySelector('.stage canvas')?.width > 300");
    assert_close(at(&mut browser, floor), [50.0, 56.0, 63.0]);
}

#[test]
fn pictures_of_a_capture_lie_under_its_masks() {
    let dir = crate::real_scenes::authored();
    let real = ["--bench", "captures", "--profile", "real"];
    dir.succeed(&[&["baseline", "oracle"], &real[..]].concat());
    dir.succeed(&[&["score"], &real[..]].concat());
    dir.succeed(&[&["leaderboard", "--html", "--data", "data/captures"], &real[..]].concat());
    let mut browser = Browser::start(1280, 900);
    browser.open(&file(&dir), "#method=oracle&scene=table&query=001&frame=2");
    browser.until("document.querySelector('.stage canvas')?.dataset.picture === 'shown'");
    // The pictures of frame 2 are [120, 90, 120] around the cups; the red cup is what is meant.
    assert_close(colour_at(&mut browser, [64, 32, 40]), [greyed([120.0, 90.0, 120.0]); 3]);
    let cup = greyed([200.0, 30.0, 30.0]);
    let found = [86.0, 180.0, 233.0].map(|colour| cup + 0.72 * (colour - cup));
    assert_close(colour_at(&mut browser, [64, 16, 16]), found);
    assert_quiet(&mut browser);
}

#[test]
fn one_frame_and_one_query_make_a_page() {
    let dir = crate::real_scenes::authored_on(&["0000"]);
    let queries = dir.read("captures/queries/table.jsonl");
    dir.write("captures/queries/table.jsonl", format!("{}\n", queries.lines().next().unwrap()));
    let real = ["--bench", "captures", "--profile", "real"];
    dir.succeed(&[&["baseline"], &real[..]].concat());
    dir.succeed(&[&["score"], &real[..]].concat());
    dir.succeed(&[&["score", "--protocol", "davis"], &real[..]].concat());
    dir.succeed(&[&["leaderboard", "--html"], &real[..]].concat());
    let mut browser = open(&dir, "");
    // Baselines alone: none is ranked, and the page says so.
    assert!(browser.text("document.querySelector('main').textContent").contains("No method is ranked yet"));
    assert_eq!(browser.text("document.querySelector('.count').textContent"), "6 methods, 1 query");
    // One scene: nothing is compared, and nothing looks like an interval.
    let main = browser.text("document.querySelector('main').textContent");
    assert!(main.contains("One scene") || main.contains("one scene says nothing of others"), "{main}");
    assert!(
        browser.evaluate(
            "document.getElementById('compare') === null && !document.querySelector('.range, .best')"
        ) == true
    );
    // A clip of one frame has no number under davis: dashes, and why.
    choose(&mut browser, "Protocol", "davis");
    let told = browser.text("document.querySelector('ul.plain').textContent");
    assert!(told.contains("Every method: 1 frame of 1 query belong to clips of one or two frames"), "{told}");
    browser.open(&file(&dir), "#method=oracle&scene=table&query=001");
    browser.until("document.querySelector('.stage canvas')?.width > 200");
    assert_eq!(browser.text("document.querySelector('output').textContent"), "frame 0: IoU 100.0 %");
    assert!(browser.evaluate("document.querySelectorAll('.strip li').length") == 1);
    assert_quiet(&mut browser);
}

#[test]
fn the_whole_way_to_a_frame_and_back_by_keys_alone() {
    let dir = page();
    let mut browser = open(&dir, "");
    let focused = |browser: &mut Browser| {
        browser.text("document.activeElement.tagName + ' ' + (document.activeElement.textContent || document.activeElement.ariaLabel || '').trim()")
    };
    browser.press("Tab");
    assert_eq!(focused(&mut browser), "A Skip to the content");
    browser.press("Enter");
    assert!(focused(&mut browser).starts_with("MAIN"));
    assert_eq!(browser.text("location.hash"), "");
    let walk = |browser: &mut Browser, wanted: &str| {
        for _ in 0..80 {
            browser.press("Tab");
            if focused(browser) == wanted {
                assert!(has_ring(browser), "{wanted} has the focus and does not show it");
                return;
            }
        }
        panic!("tabbing never comes to {wanted}");
    };
    walk(&mut browser, "A contestant");
    browser.press("Enter");
    browser.until("document.activeElement.tagName === 'H1'");
    assert_eq!(browser.text("document.activeElement.textContent"), "contestant");
    walk(&mut browser, "A room_discs");
    browser.press("Enter");
    browser.until("document.querySelectorAll('tbody tr').length === 4");
    walk(&mut browser, "A the thing that number 002 means");
    browser.press("Enter");
    browser.until("document.querySelector('input[type=range]')");
    walk(&mut browser, "INPUT Frame");
    let before = browser.text("document.querySelector('output').textContent");
    browser.press("ArrowRight");
    let after = browser.text("document.querySelector('output').textContent");
    assert_ne!(before, after);
    assert!(browser.text("location.hash").contains("frame="), "a frame can be linked");
    browser.evaluate("history.back()");
    browser.until("document.querySelectorAll('tbody tr').length === 4");
    assert_eq!(browser.text("document.activeElement.tagName"), "H1");
    // Escape leads up the trail, step by step, and nowhere from the top or out of a field that it clears.
    browser.press("Escape");
    browser.until("document.querySelector('h1').textContent === 'contestant'");
    browser.press("Escape");
    browser.until("document.querySelector('[aria-labelledby=ranking] table')");
    let top = browser.text("location.hash");
    browser.press("Escape");
    assert_eq!(browser.text("location.hash"), top);
    assert_quiet(&mut browser);
}

#[test]
fn an_order_is_of_all_methods_though_the_first_alone_are_drawn() {
    let dir = page();
    crate::leaderboard::copies(&dir, 300);
    make(&dir);
    let mut browser = open(&dir, "#sort=-name");
    let drawn = order(&mut browser);
    assert_eq!((drawn.len(), drawn[0].as_str()), (250, "method00299"));
    browser.evaluate("[...document.querySelectorAll('main button')].find((one) => one.textContent.startsWith('Show all 306')).click()");
    assert_eq!(order(&mut browser).len(), 306);
    assert_quiet(&mut browser);
}

#[test]
fn no_view_is_wider_than_a_phone() {
    let dir = page();
    judge(&dir, &["davis"]);
    // As long as a name can be, without and with seams.
    for long in ["x".repeat(80), "a-name_of.".repeat(8)] {
        std::fs::rename(dir.path("scores/contestant"), dir.path(format!("scores/{long}"))).unwrap();
        dir.edit(&format!("scores/{long}/summary.json"), "\"contestant\"", &format!("\"{long}\""));
        make(&dir);
        let mut browser = Browser::start(1280, 900);
        for (width, height) in [(400, 800), (320, 640)] {
            browser.resize(width, height);
            for view in [
                "".to_owned(),
                "#board=davis".to_owned(),
                "#board=davis&method=oracle".to_owned(),
                "#board=davis&method=oracle&scene=room_discs".to_owned(),
                format!("#method={long}"),
                format!("#method={long}&scene=room_discs"),
                format!("#method={long}&scene=room_discs&query=001"),
            ] {
                browser.open(&file(&dir), &view);
                ready(&mut browser);
                let widths = browser.evaluate("[document.documentElement.scrollWidth, innerWidth]");
                assert_eq!(widths, serde_json::json!([width, width]), "{view}");
            }
        }
        assert_quiet(&mut browser);
        std::fs::rename(dir.path(format!("scores/{long}")), dir.path("scores/contestant")).unwrap();
        dir.edit("scores/contestant/summary.json", &format!("\"{long}\""), "\"contestant\"");
    }
}

fn has_ring(browser: &mut Browser) -> bool {
    browser.evaluate("getComputedStyle(document.activeElement).outlineStyle !== 'none'") == true
}

#[test]
fn a_view_can_be_linked_and_an_address_of_nothing_says_so() {
    let dir = page();
    let mut browser = open(&dir, "#category=action&sort=-tube_iou");
    assert_eq!(browser.text("document.querySelector('.filters select:nth-of-type(1)').value"), "");
    assert!(
        browser.text(&format!("{BOARD}.querySelector('caption').textContent")).contains("Shown: action (2)")
    );
    assert_eq!(
        browser.text(&format!("{BOARD}.querySelector('[data-sort=tube_iou]').closest('th').ariaSort")),
        "descending"
    );
    for address in
        ["#method=nobody", "#method=oracle&scene=nowhere", "#method=oracle&scene=room_discs&query=999"]
    {
        browser.open(&file(&dir), address);
        assert_eq!(h1(&mut browser), "There is nothing at this address");
    }
    click(&mut browser, "main a");
    browser.until("document.querySelector('[aria-labelledby=ranking] table')");
    for address in [
        "#%",
        "#board=9",
        "#sort=none",
        "#frame=x&method=oracle&scene=room_discs&query=001",
        "#method=__proto__",
    ] {
        browser.open(&file(&dir), address);
        assert!(browser.evaluate("document.querySelector('h1') !== null") == true, "{address}");
    }
    assert_quiet(&mut browser);
}

#[test]
fn the_theme_follows_the_system_until_it_is_chosen() {
    let dir = page();
    let mut browser = Browser::start(1280, 900);
    let paper = "getComputedStyle(document.body).backgroundColor";
    browser.prefer("light");
    browser.open(&file(&dir), "");
    assert_eq!(browser.text(paper), "rgb(255, 255, 255)");
    browser.prefer("dark");
    assert_eq!(browser.text(paper), "rgb(21, 24, 28)");
    choose(&mut browser, "Theme", "light");
    assert_eq!(browser.text(paper), "rgb(255, 255, 255)");
    browser.open(&file(&dir), "");
    assert_eq!(browser.text(paper), "rgb(255, 255, 255)", "the choice is remembered");
    choose(&mut browser, "Theme", "");
    assert_eq!(browser.text(paper), "rgb(21, 24, 28)");
    assert_quiet(&mut browser);
}

#[test]
fn axe_finds_nothing_in_any_view_and_theme() {
    let dir = page();
    judge(&dir, &["davis"]);
    make(&dir);
    let axe = std::fs::read_to_string(axe()).unwrap();
    let mut browser = Browser::start(1280, 900);
    let views = [
        "",
        "#category=spatial&scale=room",
        "#method=contestant",
        "#method=contestant&scene=room_discs",
        "#method=contestant&scene=room_discs&query=002",
        "#board=davis",
        "#board=davis&method=contestant",
        "#board=davis&method=contestant&scene=room_discs",
        "#board=davis&method=contestant&scene=room_discs&query=002",
        "#method=nobody",
    ];
    for theme in ["light", "dark"] {
        browser.prefer(theme);
        for view in views {
            browser.open(&file(&dir), view);
            ready(&mut browser);
            browser.evaluate(
                "document.querySelectorAll('details').forEach((details) => { details.open = true; })",
            );
            browser.evaluate(&axe);
            let found = browser.evaluate(
                "axe.run(document, { resultTypes: ['violations', 'incomplete'] }).then((result) => [...result.violations].map((one) => `${one.id}: ${one.help}: ${one.nodes.map((node) => node.html + ' ' + node.failureSummary).join(' | ')}`))",
            );
            assert_eq!(found, serde_json::json!([]), "{theme} {view}");
            let checked = browser.evaluate("axe.run(document).then((result) => result.passes.length)");
            assert!(checked.as_u64().unwrap() > 10, "axe looked at nothing: {checked}");
        }
    }
}

/// axe-core as a file, brought by pip into a folder of the project's own.
fn axe() -> PathBuf {
    static AXE: OnceLock<PathBuf> = OnceLock::new();
    AXE.get_or_init(|| {
        let folder = root().join("work/page-tests");
        let library = folder.join("lib/python3.11/site-packages/axe_playwright_python/axe.min.js");
        if !library.is_file() {
            let run = |program: &str, arguments: &[&str]| {
                let status = Command::new(program).args(arguments).current_dir(root()).status();
                let status =
                    status.unwrap_or_else(|error| panic!("{program} is needed for axe-core: {error}"));
                assert!(status.success(), "{program} {arguments:?}");
            };
            let path = |relative: &str| folder.join(relative).display().to_string();
            run("python3.11", &["-m", "venv", &path("")]);
            let requirements = "tests/page/requirements.txt";
            run(
                &path("bin/pip"),
                &["install", "--quiet", "--no-deps", "--require-hashes", "--requirement", requirements],
            );
        }
        library
    })
    .clone()
}

#[test]
fn names_and_sentences_that_are_markup_stay_text() {
    const HOSTILE: &str = "</script><script>window.ran=1</script><img src=x onerror=\"window.ran=1\"><!-- {{script}} 'x' \u{2028}";
    let dir = Dir::with_benchmark();
    let manifest = dir.read("benchmark/panoptic-l4d.toml");
    dir.write("benchmark/panoptic-l4d.toml", manifest.replace("\"Made up\"", &toml(HOSTILE)));
    let queries = dir.read("benchmark/queries/room_discs.jsonl");
    let mut lines: Vec<Value> = queries.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let text = HOSTILE.replace('\u{2028}', "");
    lines[0]["text"] = text.as_str().into();
    lines[0]["text_digest"] = l4d_data::query::text_digest(&text, None).into();
    l4d_data::json::write_lines(&dir.path("benchmark/queries/room_discs.jsonl"), &lines).unwrap();
    dir.succeed(&[&["baseline", "oracle", "all"], &PROFILE[..]].concat());
    for (name, link) in [
        ("oracle", "javascript:window.ran=1"),
        ("all", "https://example.org/\"><script>window.ran=1</script>"),
    ] {
        let card = dir.path(format!("results/{name}/method.json"));
        let mut value: Value = l4d_data::json::read(&card).unwrap();
        value["version"] = HOSTILE.into();
        value["link"] = link.into();
        l4d_data::json::write(&card, &value).unwrap();
    }
    dir.succeed(&[&["score"], &PROFILE[..]].concat());
    make(&dir);
    let mut browser = Browser::start(1280, 900);
    for address in [
        "",
        "#method=oracle",
        "#method=all",
        "#method=all&scene=room_discs",
        "#method=all&scene=room_discs&query=001",
    ] {
        browser.open(&file(&dir), address);
        ready(&mut browser);
        assert_eq!(browser.evaluate("window.ran ?? null"), Value::Null, "{address}");
        assert_eq!(
            browser.evaluate("document.querySelectorAll('main img, main script').length"),
            0,
            "{address}"
        );
        let links = browser.evaluate("[...document.links].map((link) => link.protocol).filter((protocol) => !['file:', 'https:'].includes(protocol))");
        assert_eq!(links, serde_json::json!([]), "{address}");
    }
    assert!(h1(&mut browser).contains(&text));
    assert_quiet(&mut browser);
}

fn toml(text: &str) -> String {
    serde_json::to_string(text).unwrap()
}

#[test]
fn without_results_there_are_numbers_and_truth() {
    let dir = page();
    std::fs::remove_dir_all(dir.path("results")).unwrap();
    let run = dir.succeed(&[&["leaderboard", "--html"], &PROFILE[..]].concat());
    assert!(run.stderr.contains("warning:") && run.stderr.contains("--results"), "{}", run.stderr);
    let mut browser = open(&dir, "#method=oracle&scene=room_discs&query=001");
    browser
        .until("document.querySelector('.stage figcaption')?.textContent.includes('truth is shown alone')");
    assert_quiet(&mut browser);
}

#[test]
fn fifty_methods_and_four_hundred_queries_are_shown() {
    let dir = crowd::scored(50, 20, 20);
    make(&dir);
    let mut browser = open(&dir, "");
    assert_eq!(order(&mut browser).len(), 50);
    click(&mut browser, "[data-sort=name]");
    assert_eq!(order(&mut browser).len(), 50);
    browser.open(&file(&dir), "#method=method-07&scene=crowd_03&query=011");
    browser.until("document.querySelectorAll('.all li').length === 50");
    assert_quiet(&mut browser);
}
