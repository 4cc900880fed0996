//! The page in a browser: what a person sees and does.

use super::client::{HALL, Preview, optimised};
use crate::browser::{Browser, Tab};
use std::fs;

const WIDE: (u32, u32) = (1400, 900);
const NARROW: (u32, u32) = (600, 900);

/// The page has a drawing that is neither a picture in passing nor out of date.
const SOLVED: &str = "document.querySelector('#facts section') && !document.querySelector('#facts.before') \
                      && document.querySelector('#drawing .area') && document.querySelectorAll('.handle').length > 0";

fn opened(browser: &Browser, preview: &Preview, size: (u32, u32)) -> Tab {
    let tab = browser.open(&preview.address, size);
    tab.until(SOLVED);
    tab
}

fn handle(vertex: usize) -> String {
    format!(".handle[data-vertex=\"{vertex}\"] .dot")
}

/// Where the band of the drawing lies.
fn drawn(tab: &Tab) -> String {
    tab.value("document.querySelector('#drawing path.band').getAttribute('d')").as_str().unwrap().to_owned()
}

/// Pixels a metre.
fn pixels(tab: &Tab) -> f64 {
    let (a, b) = (tab.middle(&handle(0)), tab.middle(&handle(3)));
    (a.1 - b.1) / 14.0
}

#[test]
fn dragging_a_vertex_changes_its_numbers_and_the_drawing() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(HALL);
    let tab = opened(&browser, &preview, WIDE);
    let (before, metre) = (drawn(&tab), pixels(&tab));
    let from = tab.middle(&handle(1));
    let at = |metres: (f64, f64)| (from.0 + metres.0 * metre, from.1 - metres.1 * metre);
    tab.mouse("mouseMoved", from, false);
    tab.mouse("mousePressed", from, true);
    for k in 1..=8 {
        tab.mouse("mouseMoved", at((-0.25 * f64::from(k), 0.125 * f64::from(k))), true);
    }
    // It is solved while the button is held, and nothing is written.
    tab.until("document.getElementById('length').textContent.startsWith('≈')");
    let label = tab.value("document.querySelector('.handle.held').getAttribute('aria-label')");
    assert_eq!(label, "P2 (35 m, 4 m)");
    tab.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') !== '{before}'"));
    assert_eq!(preview.text(), HALL);
    tab.mouse("mouseReleased", at((-2.0, 1.0)), false);
    let parts = preview.until("the written vertex", |parts| parts["plan"]["vertices"][1]["x"] == 35.0);
    assert_eq!(parts["plan"]["vertices"][1]["y"], 4.0);
    assert_eq!(preview.text(), HALL.replace("(37.0 m ,  3000 mm)", "(35.0 m ,  4000 mm)"));
    tab.until(SOLVED);
    tab.until("!document.getElementById('length').textContent.startsWith('≈')");
    assert_ne!(drawn(&tab), before);
    // The line is marked in the text, which is the new one.
    assert!(tab.text("#source li.chosen").contains("P2   (35.0 m ,  4000 mm) radius 3 m // the dock, measured"));
    // And back again.
    tab.key("z", 2);
    preview.until("the vertex taken back", |parts| parts["plan"]["vertices"][1]["x"] == 37.0);
    assert_eq!(preview.text(), HALL);
    tab.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') === '{before}'"));
    assert_eq!(browser.complaints(), [""; 0]);
}

/// A layout that is optimised comes to the same track wherever the optimiser begins; the page says so.
#[test]
fn a_drag_that_changes_nothing_says_what_would() {
    let Some(browser) = Browser::start() else { return };
    // With one vertex fixed, there is one shortest track.
    let pinned = optimised().replace("fix rotation", "fix P1\n  fix rotation");
    let preview = Preview::new(&pinned);
    let tab = opened(&browser, &preview, WIDE);
    let (before, metre) = (drawn(&tab), pixels(&tab));
    assert_eq!(tab.text("#note"), "");
    let from = tab.middle(&handle(1));
    tab.mouse("mouseMoved", from, false);
    tab.mouse("mousePressed", from, true);
    tab.mouse("mouseMoved", (from.0 - 0.5 * metre, from.1), true);
    tab.mouse("mouseMoved", (from.0 - metre, from.1), true);
    tab.mouse("mouseReleased", (from.0 - metre, from.1), false);
    preview.until("the written vertex", |parts| parts["plan"]["vertices"][1]["x"] == 36.0);
    tab.until("document.getElementById('note').textContent.includes('came to the same track')");
    let said = tab.text("#note");
    assert!(said.starts_with("P2 was moved") && said.contains("`fix P2` or `optimise nothing`"), "{said}");
    assert_eq!(drawn(&tab), before);
    // What changes the track takes the words away.
    preview.save(&pinned.replace(">= 12 m", ">= 15 m"));
    tab.until("document.getElementById('note').hidden");
    tab.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') !== '{before}'"));
    assert_eq!(browser.complaints(), [""; 0]);
}

/// Long messages stand beside the plan and do not push the text away from it.
#[test]
fn messages_leave_the_text_under_the_plan() {
    let Some(browser) = Browser::start() else { return };
    let statements: String = (0..12).map(|k| format!("  sped{k} 2.0 m/s\n")).collect();
    let preview = Preview::new(HALL);
    let tab = opened(&browser, &preview, WIDE);
    preview.save(&HALL.replace("  width 1.2 m\n", &format!("  width 1.2 m\n{statements}")));
    tab.until("document.querySelectorAll('#messages article.error').length >= 12");
    let edge = |of: &str| tab.value(of).as_f64().unwrap();
    let messages = edge("document.getElementById('messages').offsetHeight");
    let sheet = edge("document.getElementById('sheet').getBoundingClientRect().bottom");
    let source = edge("document.getElementById('source').getBoundingClientRect().top");
    assert!(messages > edge("document.getElementById('sheet').offsetHeight"), "{messages}");
    assert!((source - sheet).abs() < 30.0, "the text begins at {source}, and the plan ends at {sheet}");
}

#[test]
fn a_drag_that_is_given_up_writes_nothing_and_a_formula_is_not_dragged() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(&HALL.replace("P4 (3 m, 17 m)", "P4 (far - 34 m, far - 20 m)"));
    let text = preview.text();
    let tab = opened(&browser, &preview, WIDE);
    let before = drawn(&tab);
    let from = tab.middle(&handle(0));
    tab.mouse("mouseMoved", from, false);
    tab.mouse("mousePressed", from, true);
    tab.mouse("mouseMoved", (from.0 + 30.0, from.1 - 20.0), true);
    tab.until("document.getElementById('length').textContent.startsWith('≈')");
    tab.key("Escape", 0);
    tab.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') === '{before}'"));
    tab.mouse("mouseReleased", (from.0 + 30.0, from.1 - 20.0), false);
    // A vertex that formulas place stays, and says why.
    let from = tab.middle(&handle(3));
    tab.mouse("mouseMoved", from, false);
    tab.mouse("mousePressed", from, true);
    tab.mouse("mouseMoved", (from.0 + 30.0, from.1 + 20.0), true);
    tab.mouse("mouseReleased", (from.0 + 30.0, from.1 + 20.0), false);
    assert_eq!(tab.text("#note"), "P4 cannot be dragged: a formula places it");
    // One whose x is a formula moves up and down only.
    let from = tab.middle(&handle(2));
    let metre = (tab.middle(&handle(1)).1 - from.1) / 14.0;
    tab.mouse("mouseMoved", from, false);
    tab.mouse("mousePressed", from, true);
    tab.mouse("mouseMoved", (from.0 + 40.0, from.1 + metre), true);
    tab.mouse("mouseReleased", (from.0 + 40.0, from.1 + metre), false);
    preview.until("the vertex lower down", |parts| parts["plan"]["vertices"][2]["y"] == 16.0);
    assert_eq!(preview.text(), text.replace("(far, 17 m)", "(far, 16 m)"));
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn a_mistake_appears_and_the_last_drawing_stays() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(HALL);
    let tab = opened(&browser, &preview, WIDE);
    let before = drawn(&tab);
    preview.save(&HALL.replace("speed 2.0", "sped 2.0"));
    tab.until("document.querySelector('#messages article.error')");
    let said = tab.text("#messages");
    for wanted in ["E0102", "hall.lss:10:3", "sped 2.0 m/s", "did you mean `speed`"] {
        assert!(said.contains(wanted), "{wanted}: {said}");
    }
    assert_eq!((drawn(&tab), tab.text("#status")), (before.clone(), "the drawing is of the text before".to_owned()));
    // Its place leads to the line.
    tab.click(tab.middle("#messages button.line"));
    tab.until("document.querySelector('#source li.chosen')?.textContent.includes('sped 2.0')");
    // What is not of the text cannot be dragged.
    let from = tab.middle(&handle(1));
    tab.mouse("mouseMoved", from, false);
    tab.mouse("mousePressed", from, true);
    tab.mouse("mouseMoved", (from.0 - 30.0, from.1), true);
    tab.mouse("mouseReleased", (from.0 - 30.0, from.1), false);
    assert!(preview.text().contains("(37.0 m ,  3000 mm)"));
    preview.save(&HALL.replace("P2   (37.0 m", "P2   (36.0 m"));
    tab.until("!document.querySelector('#messages article.error')");
    tab.until(SOLVED);
    tab.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') !== '{before}'"));
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn a_page_that_is_loaded_again_shows_what_is_now() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(&optimised());
    let tab = opened(&browser, &preview, WIDE);
    let before = drawn(&tab);
    preview.save(&optimised().replace(">= 12 m", ">= 15 m"));
    tab.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') !== '{before}'"));
    tab.until(SOLVED);
    preview.until_solved();
    tab.until("!document.getElementById('length').textContent.startsWith('≈')");
    let (now, length) = (drawn(&tab), tab.text("#length"));
    tab.reload();
    tab.until(SOLVED);
    assert_eq!((drawn(&tab), tab.text("#length")), (now, length));
    assert!(tab.text("#source").contains(">= 15 m"));
    // And a page in which a mistake was loaded again has it, with the drawing before.
    preview.save(&optimised().replace("width 1.2 m", "width 1.2"));
    tab.until("document.querySelector('#messages article.error')");
    tab.reload();
    tab.until("document.querySelector('#messages article.error') && document.querySelector('#drawing path.band')");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn two_tabs_follow_the_same_file() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(HALL);
    let [first, second] = [(); 2].map(|()| opened(&browser, &preview, WIDE));
    let before = drawn(&second);
    assert_eq!(drawn(&first), before);
    let (from, metre) = (first.middle(&handle(1)), pixels(&first));
    first.mouse("mouseMoved", from, false);
    first.mouse("mousePressed", from, true);
    first.mouse("mouseMoved", (from.0 - metre, from.1), true);
    // The other one sees the movement, too.
    second.until("document.getElementById('length').textContent.startsWith('≈')");
    second
        .until("document.querySelector('.handle[data-vertex=\"1\"]').getAttribute('aria-label') === 'P2 (36 m, 3 m)'");
    first.mouse("mouseReleased", (from.0 - metre, from.1), false);
    for tab in [&first, &second] {
        tab.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') !== '{before}'"));
        tab.until("document.querySelector('#source').textContent.includes('(36.0 m ,  3000 mm)')");
        tab.until("!document.getElementById('length').textContent.startsWith('≈')");
        tab.until("!document.getElementById('undo').disabled");
    }
    assert_eq!(drawn(&first), drawn(&second));
    // What one did, the other takes back.
    second.click(second.middle("#undo"));
    first.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') === '{before}'"));
    assert_eq!(preview.text(), HALL);
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn a_tab_that_comes_back_shows_what_is_now() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(HALL);
    let behind = opened(&browser, &preview, WIDE);
    let before = drawn(&behind);
    let front = browser.open_over("about:blank", WIDE);
    front.show();
    behind.until("document.hidden");
    preview.save(&HALL.replace("P1 (3 m, 3 m)", "P1 (4 m, 3 m)"));
    preview.until_solved();
    // Nobody looks: it asks for nothing.
    assert_eq!(drawn(&behind), before);
    behind.show();
    behind.until(&format!("document.querySelector('#drawing path.band').getAttribute('d') !== '{before}'"));
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn a_section_says_what_it_is_and_where_it_is_written() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(&optimised());
    let tab = opened(&browser, &preview, WIDE);
    let parts = preview.until_solved();
    tab.until("!document.getElementById('length').textContent.startsWith('≈')");
    // What is told beside the drawing may still change its size, at which a tip goes away.
    tab.value("new Promise((laid_out) => requestAnimationFrame(() => requestAnimationFrame(laid_out)))");
    // On the straight P3..P4, a third of its way along: not where a label or an arrow stands.
    let on = |selector: &str, share: f64| {
        let at = tab.value(&format!(
            "(() => {{ const path = document.querySelector('{selector}'); const p = \
             path.getPointAtLength({share} * path.getTotalLength()).matrixTransform(path.getScreenCTM()); return [p.x, \
             p.y]; }})()"
        ));
        (at[0].as_f64().unwrap(), at[1].as_f64().unwrap())
    };
    let straight = on(".area[data-section=\"2\"]", 0.3);
    tab.mouse("mouseMoved", straight, false);
    tab.until("!document.getElementById('tip').hidden");
    let said = tab.text("#tip");
    let articles = parts["plan"]["tips"]["s2"].as_str().unwrap();
    assert!(said.starts_with("P3..P4straight of ") && said.contains("heading 180°"), "{said}");
    assert!(articles.contains("<code>ST-") && said.contains("ST-"), "{said} {articles}");
    tab.click(straight);
    let chosen = tab.value("[...document.querySelectorAll('#source li.chosen')].map((l) => l.textContent.trim())");
    assert_eq!(chosen, serde_json::json!(["vertex P3 (far, 17 m) radius 3 m", "vertex P4 (3 m, 17 m) radius 3 m"]));
    tab.mouse("mouseMoved", on(".area[data-curve=\"1\"]", 0.5), false);
    tab.until("document.getElementById('tip').textContent.includes('90° to the left')");
    assert!(tab.text("#tip").starts_with("P2radius 3 m"));
    // The stages before lie under it when they are wanted.
    let stages = "getComputedStyle(document.querySelector('#drawing .stages')).display";
    assert_eq!(tab.value(stages), "none");
    tab.click(tab.middle("#stages"));
    assert_eq!(tab.value(stages), "inline");
    assert_eq!(tab.value("document.querySelectorAll('#drawing .stages path').length"), 3);
    assert!(tab.value("document.getElementById('sheet').clientHeight").as_u64().unwrap() > 300);
    // Limits with a price lead to their line.
    tab.click(tab.middle("#facts ul.rows button.line"));
    let line = tab.value("document.querySelector('#source li.chosen').dataset.line");
    assert_eq!(format!("line {}", line.as_str().unwrap()), tab.text("#facts ul.rows button.line"));
    assert!(tab.text("#facts ul.rows").contains("shortens the track by"));
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn pages_are_read_on_narrow_and_dark_screens() {
    let Some(browser) = Browser::start() else { return };
    let preview = Preview::new(&optimised());
    let tab = opened(&browser, &preview, NARROW);
    preview.until_solved();
    for size in [WIDE, NARROW, (360, 700)] {
        tab.resize(size.0, size.1);
        tab.until(&format!("innerWidth === {}", size.0));
        let wide = tab.value("document.documentElement.scrollWidth").as_u64().unwrap();
        assert!(wide <= u64::from(size.0), "{wide} px in {size:?}");
    }
    let ground = || tab.value("getComputedStyle(document.body).backgroundColor");
    let ink = || tab.value("getComputedStyle(document.querySelector('#drawing .edge')).stroke");
    let light = (ground(), ink());
    tab.prefers_dark(true);
    let dark = (ground(), ink());
    assert!(light.0 == "rgb(255, 255, 255)" && dark.0 != light.0 && dark.1 != light.1, "{light:?} {dark:?}");
    assert_eq!(browser.complaints(), [""; 0]);
}

/// Forces where a simulated run of this track is at hand, and no word of them where it is of another.
#[test]
fn forces_of_a_run_are_told_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lss.toml"), "").unwrap();
    let text = HALL.replace("optimise nothing", "motors 4 evenly\n  optimise nothing");
    fs::write(folder.path().join("hall.lss"), &text).unwrap();
    let mut simulate = assert_cmd::Command::cargo_bin("lss").unwrap();
    simulate.current_dir(folder.path()).args(["simulate", "hall.lss", "-o", "out", "--settle", "0.1s"]);
    simulate.assert().success();
    let preview = Preview::of(folder, &["--run", "out/run-01.csv"]);
    let parts = preview.until_solved();
    for key in ["s0", "c1", "s3", "c0"] {
        let tip = parts["plan"]["tips"][key].as_str().unwrap();
        assert!(tip.contains("pull of the joint: ") && tip.contains(" N ("), "{key}: {tip}");
    }
    preview.save(&text.replace("P1 (3 m, 3 m)", "P1 (2.9 m, 3 m)"));
    let parts = preview.until_solved();
    assert!(!parts["plan"]["tips"].to_string().contains("pull of the joint"));
}
