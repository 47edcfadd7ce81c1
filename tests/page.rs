//! The leaderboard's page in a real browser: what a person can do with it, by mouse, by keys and by ear.

mod browser;
mod viewing;
mod voting;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;
use std::sync::LazyLock;

use l4d_data::truth::Truth;
use l4d_frames::Display;
use l4d_masks::Mask;
use serde_json::{Value, json};

use self::browser::Browser;
use crate::annotation_tui::data;
use crate::leaderboard::{add_contestant, copies, scored};
use crate::real_scenes::{authored, authored_on};
use crate::support::{Dir, named, root};

const MAKE: &str = "leaderboard --html --profile tiny";
const REAL: &str = "--bench captures --profile real";
/// The table of the board.
const BOARD: &str = "document.querySelector('[aria-labelledby=ranking]')";

/// A page of scored baselines and a contestant, made once.
fn page() -> Dir {
    static PAGE: LazyLock<Dir> = LazyLock::new(|| {
        let dir = scored();
        dir.succeed(MAKE);
        dir
    });
    PAGE.copy()
}

/// The same masks under the rules of others, beside the scores.
fn judge(dir: &Dir, protocols: &[&str]) {
    for protocol in protocols {
        dir.succeed(format!("score --protocol {protocol} --profile tiny"));
    }
    dir.succeed(MAKE);
}

fn open(dir: &Dir, address: &str) -> Browser {
    let mut browser = Browser::start(1280, 900);
    browser.open(dir, address);
    browser
}

impl Browser {
    /// The text of the first element that a selector finds.
    fn text_of(&mut self, selector: &str) -> String {
        self.text(&format!("document.querySelector({selector:?}).textContent"))
    }

    /// The text of the board, or of a part of it.
    fn board(&mut self, selector: &str) -> String {
        let part = if selector.is_empty() { String::new() } else { format!(".querySelector({selector:?})") };
        self.text(&format!("{BOARD}{part}.textContent"))
    }

    /// What an expression makes of each element of the board that a selector finds, `one`.
    fn each(&mut self, selector: &str, expression: &str) -> Value {
        self.evaluate(&format!("[...{BOARD}.querySelectorAll({selector:?})].map((one) => {expression})"))
    }

    /// The names of the methods in the order of the table.
    fn order(&mut self) -> Vec<String> {
        serde_json::from_value(self.each("tbody th.name > :first-child", "one.textContent")).unwrap()
    }

    /// Whether, and how, the board is sorted by a column.
    fn sorting(&mut self, key: &str) -> String {
        self.text(&format!("{BOARD}.querySelector('[data-sort={key}]').closest('th').ariaSort"))
    }

    fn click(&mut self, selector: &str) {
        let clicked = self.evaluate(&format!(
            "(() => {{ const found = document.querySelector({selector:?}); found?.focus(); found?.click(); return found !== null; }})()"
        ));
        assert_eq!(clicked, true, "{selector} is not there");
    }

    /// Chooses an option as a person does: the value changes and the page gets the event.
    fn choose(&mut self, label: &str, value: &str) {
        self.evaluate(&format!(
            "{{ const label = [...document.querySelectorAll('label')].find((label) => label.textContent.startsWith({label:?}));
               const field = label.control;
               field.value = {value:?};
               field.dispatchEvent(new Event(field.tagName === 'SELECT' ? 'change' : 'input', {{ bubbles: true }})); }}"
        ));
    }

    /// The first cell of that kind in the row of a method.
    fn first_number(&mut self, kind: &str, name: &str) -> String {
        self.text(&format!(
            "[...{BOARD}.querySelectorAll('tbody tr')].find((row) => row.querySelector('th.name')?.firstElementChild.textContent === {name:?}).querySelector('{kind}').textContent"
        ))
    }

    /// Demands that what a selector finds first has these texts in it.
    fn shows(&mut self, selector: &str, parts: &[&str]) {
        let text = self.text_of(selector);
        for part in parts {
            assert!(text.contains(part), "no `{part}` in {selector}: {text}");
        }
    }

    /// Waits until a query is drawn.
    fn drawn(&mut self) {
        self.until("document.querySelector('.stage canvas')?.width > 200");
    }

    fn h1(&mut self) -> String {
        self.text_of("h1")
    }

    /// Waits until a scene is unpacked.
    fn ready(&mut self) {
        self.until("!document.getElementById('main').textContent.includes('Unpacking')");
    }
}

#[test]
fn the_head_of_a_column_sorts_by_click_and_by_key() {
    let dir = page();
    let mut browser = open(&dir, "");
    // Ranked first, whatever the order: the contestant. Baselines below it.
    let start = browser.order();
    assert_eq!(start.len(), 6, "{start:?}");
    assert_eq!(start[0], "contestant");
    assert!(start.contains(&"oracle".to_owned()));
    assert_eq!(browser.sorting("miou"), "descending");

    browser.click("[data-sort=name]");
    assert_eq!(browser.sorting("name"), "ascending");
    assert_eq!(browser.sorting("miou"), "none");
    let mut sorted = browser.order();
    assert!(sorted[0] == "contestant" && sorted[1..].is_sorted(), "{sorted:?}");
    browser.press("Enter");
    // The head kept the focus through the redraw, so the key pressed it again.
    assert_eq!(browser.sorting("name"), "descending");
    sorted[1..].reverse();
    assert_eq!(browser.order(), sorted);
    assert!(browser.text("location.hash").contains("sort=-name"));
    browser.shows("#said", &["Sorted by Method"]);
}

#[test]
fn filters_show_the_numbers_of_the_tables() {
    let dir = page();
    let mut browser = open(&dir, "");
    let tables = [("per_category.csv", "Category", "action"), ("per_scale.csv", "Scale", "room")];
    for (table, label, group) in tables {
        browser.choose(label, group);
        let csv = dir.read(&format!("leaderboard/{table}"));
        for line in csv.lines().filter(|line| line.contains(&format!(",{group},"))) {
            let fields: Vec<&str> = line.split(',').collect();
            let expected = format!("{:.2}", fields[5].parse::<f64>().unwrap());
            let cell = browser.first_number("td.number > span", fields[2]);
            // The first number of an unranked row is its miou as well: its rank is a dash without a span.
            assert_eq!(cell, expected, "{line}");
        }
        browser.choose(label, "");
    }
    browser.choose("Category", "spatial");
    browser.choose("Scale", "outdoor");
    assert_eq!(browser.text_of(".count"), "6 methods, 1 query");
    browser.choose("Method", "TIME");
    assert_eq!(browser.order(), ["time-agnostic"]);
    browser.choose("Method", "no such");
    assert!(browser.board("").contains("No method matches"));
}

#[test]
fn tracks_are_apart_and_have_their_own_best() {
    let dir = page();
    // A method without rivals in its track is not called best.
    let mut browser = open(&dir, "");
    assert!(browser.evaluate(&format!("{BOARD}.querySelector('.best') === null")) == true);
    for (baseline, name, depth) in [("none", "blank", false), ("oracle", "deep", true), ("all", "flat", true)]
    {
        add_contestant(&dir, baseline, name, depth);
    }
    dir.succeed("score --profile tiny");
    dir.succeed(MAKE);
    browser.open(&dir, "#a=contestant&b=deep");
    assert_eq!(browser.order()[..4], ["contestant", "blank", "deep", "flat"]);
    let heads = browser.each("tr.rule", "one.textContent");
    assert_eq!(heads, json!(["Track: colour", "Track: colour + depth", "Not ranked, shown for scale"]));
    let best = browser.each(".best", "one.closest('tbody').rows[0].textContent");
    let best: BTreeSet<&str> = best.as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert_eq!(best, BTreeSet::from(["Track: colour", "Track: colour + depth"]));
    browser.shows(".verdict", &["methods of two tracks are not compared"]);
    browser.click("[data-sort=name]");
    let order = browser.order();
    assert_eq!(order[..4], ["blank", "contestant", "deep", "flat"], "groups stay apart in any order");
    browser.open(&dir, "#method=deep");
    browser.shows(".facts", &["Rank1", "Trackcolour + depth"]);
}

#[test]
fn what_few_scenes_cannot_say_is_written_there() {
    let dir = page();
    let mut browser = open(&dir, "#a=oracle&b=none");
    let range = browser.board(".range");
    assert!(range.ends_with(" ! of fewer than 8 scenes"), "{range}");
    let verdict = ["100.00 points higher than that of none", "no outcome could have had p below 0.05"];
    browser.shows(".verdict", &verdict);
    assert!(!browser.text_of(".verdict").contains("four times in five"));
    browser.open(&dir, "#a=oracle&b=time-agnostic");
    browser.shows(".verdict", &["They do not differ in any scene."]);
}

#[test]
fn a_protocol_of_others_has_a_table_of_its_own_down_to_the_query() {
    let dir = page();
    judge(&dir, &["davis", "4d-langsplat"]);
    let mut browser = open(&dir, "");
    assert!(!browser.board("").contains("J&F"), "a protocol is mixed into the ranking");
    browser.choose("Protocol", "davis");
    assert_eq!(browser.order().len(), 6);
    assert!(browser.text("location.hash").contains("board=davis"));
    let table = browser.board("");
    assert!(table.contains("protocol davis (DAVIS 2017, semi-supervised)"), "{table}");
    assert!(table.contains("never ranked") && !table.contains("mIoU"), "{table}");
    // Every head of a number names the protocol, so that a picture of a part cannot be taken for another table.
    assert_eq!(browser.each("thead th.number .over", "one.textContent"), json!(vec!["davis"; 7]));
    browser.shows("#said", &["Under the rules of others: davis"]);
    browser.shows("main .notice", &["never ranked"]);
    browser.shows("ul.plain", &["Every method: 12 frames of 6 queries are first or last"]);

    // The numbers are those of the files, whole and in a group.
    let kept = dir.value("scores-davis/contestant/protocol-davis.json");
    for (scale, measures) in [("", &kept["measures"]), ("room", &kept["scenes"]["room_discs"])] {
        browser.choose("Scale", scale);
        let printed = measures["j_and_f"].as_f64().map_or("–".to_owned(), |value| format!("{value:.2}"));
        assert_eq!(browser.first_number("td.number", "contestant"), printed, "{scale}");
    }
    browser.choose("Scale", "");

    // Down to a scene, a query and its frames.
    browser.open(&dir, "#board=davis&method=contestant");
    assert_eq!(browser.h1(), "contestant under davis");
    browser.click("a[href*='scene=room_discs']");
    browser.until("document.querySelectorAll('tbody tr').length === 4");
    let csv = dir.read("scores-davis/contestant/protocol-davis.csv");
    let line = csv.lines().find(|line| line.contains(",room_discs,001,")).unwrap();
    let value: f64 = line.split(',').nth(3).unwrap().parse().unwrap();
    let cells = browser.text(
        "[...document.querySelectorAll('tbody tr')].find((row) => row.cells[0].textContent === '001').cells[3].textContent",
    );
    assert_eq!(cells, format!("{value:.2}"));
    browser.click("a[href*='query=001']");
    browser.until("document.querySelector('.stage canvas')");
    browser.shows(".facts", &[&format!("davis: J&F{value:.2}")]);
    // Methods that a protocol never judged, and scenes that are none, are nothing.
    for address in ["#board=davis&method=nobody", "#board=davis&method=contestant&scene=nowhere"] {
        browser.open(&dir, address);
        assert_eq!(browser.h1(), "There is nothing at this address");
    }
    // From a method of the board to what others would say of it.
    browser.open(&dir, "#method=contestant");
    browser.click("a[href*='board=4d-langsplat']");
    browser.until("document.querySelector('h1').textContent === 'contestant under 4d-langsplat'");
}

#[test]
fn a_query_shows_the_pixels_that_were_counted() {
    let dir = page();
    // 001 means disc_a in the whole clip; the oracle finds it, `none` misses it, `all` marks everything.
    let truth = dir.value("benchmark/truth/tiny/room_discs.json");
    let disc = named(&truth["instances"], "disc_a");
    let mask = Mask::decode(disc["masks"]["0048"].as_str().unwrap(), 128, 96).unwrap();
    let (target, pixels) = (mask.area(), 128 * 96);
    assert!(target > 50);
    let mut browser = Browser::start(1280, 900);
    for (method, found, missed, extra) in
        [("oracle", target, 0, 0), ("none", 0, target, 0), ("all", target, 0, pixels - target)]
    {
        browser.open(&dir, &format!("#method={method}&scene=room_discs&query=001&frame=48"));
        browser.drawn();
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
        assert_eq!(counts, json!([found, missed, extra]), "{method}");
        assert!(browser.text("document.querySelector('.stage canvas').ariaLabel").contains("frame 48"));
    }
    // A mask that changed after scoring contradicts its numbers, so it is not shown.
    let masks = "results/oracle/masks/room_discs/001.json";
    dir.write(masks, dir.read("results/all/masks/room_discs/001.json"));
    dir.succeed(MAKE);
    browser.open(&dir, "#method=oracle&scene=room_discs&query=001");
    browser
        .until("document.querySelector('.stage figcaption')?.textContent.includes('truth is shown alone')");
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

/// As close as JPEG keeps what is flat and grey.
fn assert_close(found: [f64; 3], expected: [f64; 3]) {
    assert_near(found, expected, 6.0);
}

/// JPEG keeps colours with less care than light.
fn assert_near(found: [f64; 3], expected: [f64; 3], most: f64) {
    let is_near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= most);
    assert!(is_near, "{found:?} instead of {expected:?}");
}

/// What the overlay makes of a colour where prediction and truth agree.
fn hit([red, green, blue]: [f64; 3]) -> [f64; 3] {
    [(red, 86.0), (green, 180.0), (blue, 233.0)].map(|(below, colour)| below + 0.72 * (colour - below))
}

#[test]
fn a_picture_of_the_held_out_view_lies_under_the_masks() {
    let dir = page();
    let truth = Truth::read(&dir.path("benchmark/truth/tiny/room_discs.json")).unwrap();
    data::render(&dir, &truth);
    dir.run(format!("{MAKE} --data data/tiny")).says(0, &["holds 1 of 2 scenes"]);

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
    let seen = |(column, row): (u32, u32)| display.get_pixel(column, row).0.map(f64::from);
    let below = |place: (u32, u32)| greyed(seen(place));
    let (target, floor) = (inside(&mask("disc_a")), inside(&mask("floor")));
    assert!((below(target) - below(floor)).abs() > 12.0, "both look the same, so nothing is proved");

    let mut browser = Browser::start(1280, 900);
    browser.open(&dir, "#method=oracle&scene=room_discs&query=001&frame=48");
    browser.drawn();
    // Painted when the picture is decoded.
    browser.until("document.querySelector('.stage canvas').dataset.picture === 'shown'");
    let at =
        |browser: &mut Browser, (column, row): (u32, u32)| colour_at(browser, [truth.width, column, row]);
    assert_near(at(&mut browser, floor), seen(floor), 16.0);
    assert_near(at(&mut browser, target), hit(seen(target)), 16.0);
    // Grey where colours of the picture are in the way.
    browser.click(".layers label:nth-of-type(4) input");
    assert_close(at(&mut browser, floor), [below(floor); 3]);
    assert_close(at(&mut browser, target), hit([below(target); 3]));
    // Without the picture: the dark ground with what else is there.
    browser.click(".layers label:nth-of-type(3) input");
    browser.until("document.querySelector('.stage canvas').dataset.picture !== 'shown'");
    assert_close(at(&mut browser, floor), [50.0, 56.0, 63.0]);
    // The scene that is not rendered has no such switch, and its masks.
    browser.open(&dir, "#method=oracle&scene=outdoor_discs&query=001");
    browser.until("document.querySelectorAll('.layers input').length === 2");
    // In lists of scenes the one is a picture, the other the outlines of what is there.
    browser.open(&dir, "#method=oracle");
    for (scene, shown) in [("room_discs", "shown"), ("outdoor_discs", "none")] {
        let thumbnail = format!("document.querySelector('a[href*={scene}] .thumbnail')");
        browser.until(&format!("{thumbnail}.dataset.picture === {shown:?}"));
        let colours = browser.evaluate(&format!(
            "new Set(new Uint32Array({thumbnail}.getContext('2d').getImageData(0, 0, 128, 96).data.buffer)).size"
        ));
        assert!(colours.as_u64().unwrap() > 1, "{scene} is blank");
    }

    // A damaged picture is reported and left out.
    dir.write("data/tiny/room_discs/frames/test/0048.exr", "torn");
    dir.run(format!("{MAKE} --data data/tiny")).says(0, &["0048.exr"]);
    browser.open(&dir, "#method=oracle&scene=room_discs&query=001&frame=48");
    browser.drawn();
    assert_close(at(&mut browser, floor), [50.0, 56.0, 63.0]);
}

#[test]
fn pictures_of_a_capture_lie_under_its_masks() {
    let dir = authored();
    for verb in ["baseline oracle", "score", "leaderboard --html --data data/captures"] {
        dir.succeed(format!("{verb} {REAL}"));
    }
    let mut browser = Browser::start(1280, 900);
    browser.open(&dir, "#method=oracle&scene=table&query=001&frame=2");
    browser.until("document.querySelector('.stage canvas')?.dataset.picture === 'shown'");
    // The pictures of frame 2 are [120, 90, 120] around the cups; the red cup is what is meant.
    assert_near(colour_at(&mut browser, [64, 32, 40]), [120.0, 90.0, 120.0], 16.0);
    assert_near(colour_at(&mut browser, [64, 16, 16]), hit([200.0, 30.0, 30.0]), 16.0);
    browser.click(".layers label:nth-of-type(4) input");
    assert_close(colour_at(&mut browser, [64, 32, 40]), [greyed([120.0, 90.0, 120.0]); 3]);
    assert_close(colour_at(&mut browser, [64, 16, 16]), hit([greyed([200.0, 30.0, 30.0]); 3]));
}

#[test]
fn one_frame_and_one_query_make_a_page() {
    let dir = authored_on(&["0000"]);
    let queries = dir.read("captures/queries/table.jsonl");
    dir.write("captures/queries/table.jsonl", format!("{}\n", queries.lines().next().unwrap()));
    for verb in ["baseline", "score", "score --protocol davis", "leaderboard --html"] {
        dir.succeed(format!("{verb} {REAL}"));
    }
    let mut browser = open(&dir, "");
    // Baselines alone: none is ranked, and the page says so.
    browser.shows("main", &["No method is ranked yet"]);
    assert_eq!(browser.text_of(".count"), "6 methods, 1 query");
    // One scene: nothing is compared, and nothing looks like an interval.
    let main = browser.text_of("main");
    assert!(main.contains("One scene") || main.contains("one scene says nothing of others"), "{main}");
    assert_eq!(browser.evaluate("document.querySelector('#compare, .range, .best')"), Value::Null);
    // A clip of one frame has no number under davis: dashes, and why.
    browser.choose("Protocol", "davis");
    browser.shows("ul.plain", &["Every method: 1 frame of 1 query belong to clips of one or two frames"]);
    browser.open(&dir, "#method=oracle&scene=table&query=001");
    browser.drawn();
    assert_eq!(browser.text_of("output"), "frame 0: IoU 100.0 %");
    assert!(browser.evaluate("document.querySelectorAll('.strip li').length") == 1);
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
    let before = browser.text_of("output");
    browser.press("ArrowRight");
    let after = browser.text_of("output");
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
}

#[test]
fn play_goes_to_the_end_of_the_clip_and_stops() {
    let dir = page();
    let mut browser = open(&dir, "#method=oracle&scene=room_discs&query=001&frame=48");
    browser.drawn();
    let before = browser.text_of("output");
    assert_eq!(browser.text_of(".play"), "Play", "nothing moves by itself");
    browser.click(".play");
    assert_eq!(browser.text_of(".play"), "Pause");
    browser.until(&format!("document.querySelector('output').textContent !== {before:?}"));
    browser.until("document.querySelector('.play').textContent === 'Play'");
    let slider = "document.querySelector('input[type=range]')";
    assert_eq!(browser.evaluate(&format!("{slider}.value === {slider}.max")), true);
    // Space begins at the first frame again, and stops.
    let space = "new KeyboardEvent('keydown', { key: ' ', bubbles: true, cancelable: true })";
    for (state, at) in [("Pause", Some("0")), ("Play", None)] {
        browser.evaluate(&format!("{slider}.dispatchEvent({space})"));
        assert_eq!(browser.text_of(".play"), state);
        assert!(at.is_none_or(|at| browser.text(&format!("{slider}.value")) == at));
    }
    // A frame that is chosen stops it as well.
    browser.click(".play");
    browser.click(".strip li:nth-child(2) button");
    assert_eq!(browser.text_of(".play"), "Play");
    assert_eq!(browser.text(&format!("{slider}.value")), "1");
}

/// The name and the text of the file that a button hands over.
fn downloaded(browser: &mut Browser) -> (String, String) {
    browser.evaluate(
        "URL.createObjectURL = (blob) => { window.kept = blob; return '#'; };
         HTMLAnchorElement.prototype.click = function () { window.file = this.download; };
         window.file = null",
    );
    browser.click(".tools button");
    browser.until("window.file");
    (browser.text("window.file"), browser.text("window.kept.text()"))
}

#[test]
fn what_is_shown_can_be_taken_along_as_csv() {
    let dir = page();
    judge(&dir, &["davis"]);
    let mut browser = open(&dir, "#sort=-name");
    let (file, text) = downloaded(&mut browser);
    assert_eq!(file, "leaderboard.csv");
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines[0][..7], ["rank", "method", "version", "track", "unranked_because", "miou", "miou_low"]);
    assert_eq!(lines[1][..2], ["1", "contestant"]);
    let kept = dir.table("leaderboard/leaderboard.csv");
    let kept = kept.iter().find(|row| row["method"] == "contestant").unwrap();
    let close = |a: &str, b: &str| (a.parse::<f64>().unwrap() - b.parse::<f64>().unwrap()).abs() < 0.006;
    assert!(close(lines[1][5], &kept["miou"]), "{text}");
    let names: Vec<&str> = lines[1..].iter().map(|line| line[1]).collect();
    assert_eq!(names, browser.order(), "the order is that of the table");
    browser.choose("Method", "TIME");
    let (_, text) = downloaded(&mut browser);
    assert_eq!(text.lines().count(), 2, "{text}");
    assert!(text.contains(",time-agnostic,") && text.contains("\"baseline, used ground truth\""), "{text}");

    for (view, name, head, lines) in [
        ("#board=davis", "leaderboard-davis.csv", "method,version,j_and_f,", 7),
        ("#method=contestant", "contestant.csv", "scene,number,text,category,miou,", 9),
        ("#method=contestant&scene=room_discs", "contestant-room_discs.csv", "number,text,category,miou,", 5),
    ] {
        browser.open(&dir, view);
        browser.until("document.querySelector('.tools button')");
        let (file, text) = downloaded(&mut browser);
        assert_eq!(file, name);
        assert!(text.starts_with(head) && text.lines().count() == lines, "{text}");
    }
}

#[test]
fn every_head_of_a_column_is_explained() {
    const SHOWN: &str =
        "[...document.querySelectorAll('.tip')].filter((tip) => !tip.hidden).map((tip) => tip.textContent)";
    let dir = page();
    judge(&dir, &["davis"]);
    let mut browser = Browser::start(1280, 900);
    for view in [
        "",
        "#method=contestant",
        "#method=contestant&scene=room_discs",
        "#method=contestant&scene=room_discs&query=001",
        "#board=davis",
        "#board=davis&method=contestant",
        "#board=davis&method=contestant&scene=room_discs",
    ] {
        browser.open(&dir, view);
        browser.ready();
        let found = browser.evaluate(
            "[...document.querySelectorAll('th[scope=col], th[scope=colgroup]')].map((head) => [head.textContent,
                document.getElementById(head.querySelector('[aria-describedby]')?.getAttribute('aria-describedby'))?.textContent ?? ''])",
        );
        let found: Vec<[String; 2]> = serde_json::from_value(found).unwrap();
        assert!(found.len() > 1, "{view}");
        for [head, about] in found {
            assert!(about.len() > 15 && about.ends_with('.'), "{view} {head}: {about}");
        }
    }
    // By focus, tap and pointer; Escape closes it and does nothing else.
    browser.open(&dir, "#method=contestant");
    browser.click(".about");
    assert_eq!(browser.evaluate(&format!("{SHOWN}.length")), 1);
    browser.press("Tab");
    let found = browser.evaluate(SHOWN);
    assert_eq!(found, json!(["How many queries the row is about."]));
    browser.press("Escape");
    assert_eq!(browser.evaluate(SHOWN), json!([]));
    assert_eq!(browser.h1(), "contestant");
    browser.evaluate("document.querySelector('th[aria-sort]').dispatchEvent(new MouseEvent('mouseenter'))");
    browser.until(&format!("{SHOWN}.length === 1"));
    browser.evaluate("document.querySelector('th[aria-sort]').dispatchEvent(new MouseEvent('mouseleave'))");
    browser.until(&format!("{SHOWN}.length === 0"));
}

#[test]
fn a_phone_shows_rank_method_and_scores_without_scrolling_sideways() {
    let dir = page();
    let mut browser = Browser::start(1280, 900);
    browser.resize(375, 800);
    browser.open(&dir, "");
    let rows = browser.evaluate(
        "[document.documentElement, document.querySelector('.scroll')].map((one) => one.scrollWidth - one.clientWidth)",
    );
    assert_eq!(rows, json!([0, 0]));
    let found = browser.each(
        "tbody tr:not(.rule)",
        "(() => {
            const cells = [...one.cells].filter((cell) => cell.getClientRects().length > 0);
            const boxes = cells.map((cell) => cell.getBoundingClientRect());
            const meet = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
            const isWrong = (box, at) => box.left < 0 || box.right > 375 || cells[at].scrollWidth > cells[at].clientWidth + 1
                || boxes.slice(at + 1).some((other) => meet(box, other));
            return { wrong: boxes.filter(isWrong).length, labels: cells.map((cell) => cell.dataset.label ?? 'name') };
        })()",
    );
    let found = found.as_array().unwrap();
    assert_eq!(found.len(), 6);
    for row in found {
        assert_eq!(row["wrong"], 0, "{row}");
        let labels: Vec<&str> = row["labels"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
        for wanted in ["Rank", "name", "mIoU", "mAcc", "tube IoU", "select"] {
            assert!(labels.contains(&wanted), "{labels:?}");
        }
    }
}

#[test]
fn the_page_says_what_it_is_of_and_how_to_take_part() {
    let dir = page();
    let mut browser = open(&dir, "");
    let digest =
        browser.text("document.getElementById('board').textContent.match(/\"truthDigest\":\"(.{12})/)[1]");
    let software = format!("l4d {}", env!("CARGO_PKG_VERSION"));
    browser.shows("#foot", &["Discs 0.1.0", "profile tiny", &digest, "Date 20", &software]);
    browser
        .shows("#submit + ol", &["l4d init-results NAME", "l4d check-results", "l4d score", "pull request"]);
}

#[test]
fn an_order_is_of_all_methods_though_the_first_alone_are_drawn() {
    let dir = page();
    copies(&dir, 300);
    dir.succeed(MAKE);
    let mut browser = open(&dir, "#sort=-name");
    let drawn = browser.order();
    assert_eq!((drawn.len(), drawn[0].as_str()), (250, "method00299"));
    browser.evaluate("[...document.querySelectorAll('main button')].find((one) => one.textContent.startsWith('Show all 306')).click()");
    assert_eq!(browser.order().len(), 306);
}

#[test]
fn no_view_is_wider_than_a_phone() {
    let dir = page();
    judge(&dir, &["davis"]);
    // As long as a name can be, without and with seams.
    for long in ["x".repeat(80), "a-name_of.".repeat(8)] {
        let rename = |from: &str, to: &str| {
            dir.rename(&format!("scores/{from}"), &format!("scores/{to}"));
            dir.change(&format!("scores/{to}/summary.json"), |summary| summary["name"] = to.into());
        };
        rename("contestant", &long);
        dir.succeed(MAKE);
        let mut browser = Browser::start(1280, 900);
        for (width, height) in [(400, 800), (320, 640)] {
            browser.resize(width, height);
            for view in [
                "",
                "#board=davis",
                "#board=davis&method=oracle",
                "#board=davis&method=oracle&scene=room_discs",
                "#method=LONG",
                "#method=LONG&scene=room_discs",
                "#method=LONG&scene=room_discs&query=001",
            ] {
                browser.open(&dir, &view.replace("LONG", &long));
                browser.ready();
                let widths = browser.evaluate("[document.documentElement.scrollWidth, innerWidth]");
                assert_eq!(widths, json!([width, width]), "{view}");
            }
        }
        rename(&long, "contestant");
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
    assert!(browser.board("caption").contains("Shown: action (2)"));
    assert_eq!(browser.sorting("tube_iou"), "descending");
    for address in
        ["#method=nobody", "#method=oracle&scene=nowhere", "#method=oracle&scene=room_discs&query=999"]
    {
        browser.open(&dir, address);
        assert_eq!(browser.h1(), "There is nothing at this address");
    }
    browser.click("main a");
    browser.until("document.querySelector('[aria-labelledby=ranking] table')");
    for address in [
        "#%",
        "#board=9",
        "#sort=none",
        "#frame=x&method=oracle&scene=room_discs&query=001",
        "#method=__proto__",
    ] {
        browser.open(&dir, address);
        assert!(browser.evaluate("document.querySelector('h1') !== null") == true, "{address}");
    }
}

#[test]
fn the_theme_follows_the_system_until_it_is_chosen() {
    let dir = page();
    let mut browser = Browser::start(1280, 900);
    let paper = "getComputedStyle(document.body).backgroundColor";
    browser.prefer("light");
    browser.open(&dir, "");
    assert_eq!(browser.text(paper), "rgb(255, 255, 255)");
    browser.prefer("dark");
    assert_eq!(browser.text(paper), "rgb(21, 24, 28)");
    browser.choose("Theme", "light");
    assert_eq!(browser.text(paper), "rgb(255, 255, 255)");
    browser.open(&dir, "");
    assert_eq!(browser.text(paper), "rgb(255, 255, 255)", "the choice is remembered");
    browser.choose("Theme", "");
    assert_eq!(browser.text(paper), "rgb(21, 24, 28)");
}

#[test]
fn axe_finds_nothing_in_any_view_and_theme() {
    let dir = page();
    judge(&dir, &["davis"]);
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
            browser.open(&dir, view);
            browser.ready();
            browser.evaluate(
                "document.querySelectorAll('details').forEach((details) => { details.open = true; })",
            );
            browser.evaluate(&axe);
            let found = browser.evaluate(
                "axe.run(document, { resultTypes: ['violations', 'incomplete'] }).then((result) => [...result.violations].map((one) => `${one.id}: ${one.help}: ${one.nodes.map((node) => node.html + ' ' + node.failureSummary).join(' | ')}`))",
            );
            assert_eq!(found, json!([]), "{theme} {view}");
            let checked = browser.evaluate("axe.run(document).then((result) => result.passes.length)");
            assert!(checked.as_u64().unwrap() > 10, "axe looked at nothing: {checked}");
        }
    }
}

/// axe-core as a file, brought by uv or pip into a folder of the project's own.
fn axe() -> PathBuf {
    static AXE: LazyLock<PathBuf> = LazyLock::new(|| {
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
            let pinned =
                ["--quiet", "--no-deps", "--require-hashes", "--requirement", "tests/page/requirements.txt"];
            if Command::new("uv").arg("--version").output().is_ok_and(|said| said.status.success()) {
                run("uv", &["venv", "--quiet", "--python", "3.11", &path("")]);
                let install = ["pip", "install", "--python", &path("bin/python")];
                run("uv", &[&install[..], &pinned].concat());
            } else {
                run("python3.11", &["-m", "venv", &path("")]);
                run(&path("bin/pip"), &[&["install"][..], &pinned].concat());
            }
        }
        library
    });
    AXE.clone()
}

#[test]
fn names_and_sentences_that_are_markup_stay_text() {
    const HOSTILE: &str = "</script><script>window.ran=1</script><img src=x onerror=\"window.ran=1\"><!-- {{script}} 'x' \u{2028}";
    let dir = Dir::with_benchmark();
    dir.edit("benchmark/panoptic-l4d.toml", "\"Discs\"", &serde_json::to_string(HOSTILE).unwrap());
    let mut lines = dir.lines("benchmark/queries/room_discs.jsonl");
    let text = HOSTILE.replace('\u{2028}', "");
    lines[0]["text"] = text.as_str().into();
    lines[0]["text_digest"] = l4d_data::query::text_digest(&text, None).into();
    l4d_data::json::write_lines(&dir.path("benchmark/queries/room_discs.jsonl"), &lines).unwrap();
    dir.succeed("baseline oracle all --profile tiny");
    for (name, link) in [
        ("oracle", "javascript:window.ran=1"),
        ("all", "https://example.org/\"><script>window.ran=1</script>"),
    ] {
        dir.change(&format!("results/{name}/method.json"), |card| {
            (card["version"], card["link"]) = (HOSTILE.into(), link.into());
        });
    }
    dir.succeed("score --profile tiny");
    dir.succeed(MAKE);
    let mut browser = Browser::start(1280, 900);
    for address in [
        "",
        "#method=oracle",
        "#method=all",
        "#method=all&scene=room_discs",
        "#method=all&scene=room_discs&query=001",
    ] {
        browser.open(&dir, address);
        browser.ready();
        assert_eq!(browser.evaluate("window.ran ?? null"), Value::Null, "{address}");
        let elements = browser.evaluate("document.querySelectorAll('main img, main script').length");
        assert_eq!(elements, 0, "{address}");
        let links = browser.evaluate("[...document.links].map((link) => link.protocol).filter((protocol) => !['file:', 'https:'].includes(protocol))");
        assert_eq!(links, json!([]), "{address}");
    }
    assert!(browser.h1().contains(&text));
}

#[test]
fn without_results_there_are_numbers_and_truth() {
    let dir = page();
    dir.remove("results");
    dir.run(MAKE).says(0, &["warning:", "--results"]);
    let mut browser = open(&dir, "#method=oracle&scene=room_discs&query=001");
    browser
        .until("document.querySelector('.stage figcaption')?.textContent.includes('truth is shown alone')");
}
