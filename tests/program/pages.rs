//! Result pages as a person uses them, in headless Chromium; skipped where there is none.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::result_page::ResultPage;
use assert_cmd::Command;
use lss::signal::{Channel, Run};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Duration;

fn lss(arguments: &[&str], out: &Path) {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments).arg("-o").arg(out).assert().success();
}

fn lap(layout: &str, out: &Path, more: &[&str]) -> PathBuf {
    lss(&[&["simulate", layout, "--settle", "1s"], more].concat(), out);
    out.join("lap.html")
}

fn near(a: f64, b: f64, by: f64) {
    assert!((a - b).abs() <= by, "{a} is not {b}");
}

#[test]
fn a_lap_page_answers_the_hand() {
    let Some(browser) = ResultPage::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let page = lap("examples/smallest.lss", folder.path(), &[]);
    browser.hold(&page);
    browser.open(&page, (1400, 900), false);
    hover_shows_the_data_and_moves_the_dot(&browser);
    a_stretch_is_seen_larger_in_all_pictures_and_the_whole_again(&browser);
    names_turn_curves_and_channels_off(&browser);
    the_plan_moves_the_cursor(&browser);
    let input = std::fs::read(folder.path().join("simulation.json")).expect("an input");
    let input: Value = serde_json::from_slice(&input).expect("JSON");
    the_chain_runs(&browser, input["chain"]["speed_m_s"].as_f64().expect("a speed"));
    assert_eq!(browser.errors(), Vec::<String>::new());
}

fn hover_shows_the_data_and_moves_the_dot(browser: &ResultPage) {
    let (x, y) = browser.middle("#along-joint_xi .u-over");
    let spot = |browser: &ResultPage, x: f64| {
        browser.ask("window.before = String(page.links.get('track')?.value)");
        browser.mouse("mouseMoved", x, y);
        browser.wait(
            "['#along-joint_xi', '#along-run_right'].every(id => document.querySelector(`${id} [data-curve=mean] .curve-value`).textContent)
              && String(page.links.get('track')?.value) !== window.before",
        );
        browser.ask(
            "(() => { const c = page.curves.get('along-joint_xi'), s = page.links.get('track').value;
              const at = c.spec.x.reduce((best, x, k) => Math.abs(x - s) < Math.abs(c.spec.x[best] - s) ? k : best, 0);
              return [s, c.spec.curves[1].y[at], c.host.querySelector('[data-curve=mean] .curve-value').textContent,
                page.curves.get('along-run_right').spec.curves[1].y[at],
                document.querySelector('#along-run_right [data-curve=mean] .curve-value').textContent]; })()",
        )
    };
    let (first, second) = (spot(browser, x), spot(browser, x + 150.0));
    for found in [&first, &second] {
        // The value under the hand, and that of another channel at the same place.
        for (value, text) in [(&found[1], &found[2]), (&found[3], &found[4])] {
            let shown = text.as_str().expect("text").replace('−', "-").replace(" N", "");
            assert_eq!(shown.parse::<f64>().expect("a number"), value.as_f64().expect("a number"));
        }
    }
    let width = browser.number("document.querySelector('#along-joint_xi .u-over').clientWidth");
    let lap = browser.number("page.data.plan.lap_m");
    let travelled = second[0].as_f64().unwrap() - first[0].as_f64().unwrap();
    near(travelled, 150.0 / width * lap, 0.02 * lap);
    // The dot stands where the centre line is at that place.
    let draw = "page.stage.view.draw()";
    browser.ask(draw);
    let dot = browser.ask("page.stage.view.shownAt");
    let k = (second[0].as_f64().unwrap() / lap * browser.number("page.data.plan.x.length")) as usize;
    let place = browser.ask(&format!("page.stage.view.at([page.data.plan.x[{k}], page.data.plan.y[{k}]])"));
    for axis in 0..2 {
        near(dot[axis].as_f64().unwrap(), place[axis].as_f64().unwrap(), 8.0);
    }
    let before = dot;
    browser.mouse("mouseMoved", x - 200.0, y);
    browser.ask(draw);
    assert_ne!(browser.ask("page.stage.view.shownAt"), before);
}

fn a_stretch_is_seen_larger_in_all_pictures_and_the_whole_again(browser: &ResultPage) {
    let (x, y) = browser.middle("#along-steer_left .u-over");
    browser.mouse("mouseMoved", x - 100.0, y);
    browser.mouse("mousePressed", x - 100.0, y);
    browser.mouse("mouseMoved", x, y);
    browser.mouse("mouseMoved", x + 100.0, y);
    browser.mouse("mouseReleased", x + 100.0, y);
    let ranges = "[...page.curves.values()].filter(c => c.spec.axis === 'track').map(c => c.plot.scales.x.max - c.plot.scales.x.min)";
    let whole = browser.number("page.data.plan.lap_m");
    let width = browser.number("document.querySelector('#along-steer_left .u-over').clientWidth");
    let found = browser.ask(ranges);
    for range in found.as_array().expect("plots") {
        near(range.as_f64().unwrap(), 200.0 / width * whole, 0.02 * whole);
    }
    browser.ask(
        "page.curves.get('along-steer_left').plot.over.dispatchEvent(new MouseEvent('dblclick', {bubbles: true}))",
    );
    let found = browser.ask(ranges);
    assert!(
        found.as_array().expect("plots").iter().all(|range| (range.as_f64().unwrap() - whole).abs() < 1e-6),
        "{found}"
    );
}

fn names_turn_curves_and_channels_off(browser: &ResultPage) {
    let inked = "(() => { const c = page.curves.get('along-joint_xi').plot.ctx.canvas;
        const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0;
        for (let k = 0; k < d.length; k += 4) if (d[k + 3] > 200 && d[k + 2] > d[k] + 60) n++; return n; })()";
    let with = browser.number(inked);
    browser.click("#along-joint_xi [data-curve=mean]");
    browser.wait("!page.curves.get('along-joint_xi').plot.series[3].show");
    std::thread::sleep(Duration::from_millis(100));
    let without = browser.number(inked);
    assert!(without < 0.5 * with, "{without} of {with} pixels are left");
    browser.click("#along-joint_xi [data-curve=mean]");
    browser.wait("page.curves.get('along-joint_xi').plot.series[3].show");
    browser.click("[data-shows=channel-run_left]");
    assert_eq!(browser.ask("document.getElementById('channel-run_left').checkVisibility()"), json!(false));
    browser.click("[data-shows=channel-run_left]");
    assert_eq!(browser.ask("document.getElementById('channel-run_left').checkVisibility()"), json!(true));
}

fn the_plan_moves_the_cursor(browser: &ResultPage) {
    browser.middle("#plan canvas");
    let place = browser.ask(
        "(() => { const v = page.stage.view, b = v.canvas.getBoundingClientRect(), p = v.at(v.line.at(10));
          return [b.x + p[0], b.y + p[1]]; })()",
    );
    let (x, y) = (place[0].as_f64().unwrap(), place[1].as_f64().unwrap());
    for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
        browser.mouse(kind, x, y);
    }
    near(browser.number("page.links.get('track').value"), 10.0, 0.5);
    // The chain is shown at the time when the sensors were there.
    let there = "page.stage.flat.wrap(page.stage.travelled(page.stage.time))";
    near(browser.number(there), 10.0, 0.5);
    let other = browser.ask("document.querySelector('[data-layer=steer_left]').click() || page.stage.key.textContent");
    assert!(other.as_str().expect("text").starts_with("steer_left"), "{other}");
}

fn the_chain_runs(browser: &ResultPage, speed: f64) {
    browser.ask("page.stage.go(0, false)");
    let first = browser.ask("[...page.stage.carts.places]");
    browser.click(".play");
    browser.wait("page.stage.time > 0.5");
    browser.click(".play");
    assert_eq!(browser.ask("Boolean(page.stage.running)"), json!(false));
    let (time, last) = (browser.number("page.stage.time"), browser.ask("[...page.stage.carts.places]"));
    let carts = browser.number("page.data.replay.carts") as usize;
    assert_eq!(first.as_array().map(Vec::len), Some(carts));
    // At the chain's speed, and every cart a pitch behind the one before it.
    let place = |of: &Value, k: usize| of[k].as_f64().expect("a place");
    near(place(&last, 0) - place(&first, 0), speed * time, 0.02 * speed * time);
    let pitch = browser.number("page.data.replay.pitch_m");
    near(place(&last, 0) - place(&last, carts - 1), (carts - 1) as f64 * pitch, 1e-6);
    // The cursor went with the sensors.
    let lap = browser.number("page.data.plan.lap_m");
    near(browser.number("page.links.get('track').value"), place(&last, 0).rem_euclid(lap), 1e-6);
    browser.ask(
        "(() => { const s = document.querySelector('.time'); s.value = 5; s.dispatchEvent(new Event('input')); })()",
    );
    near(browser.number("page.stage.time"), 5.0, 1e-9);
}

#[test]
fn a_raised_track_is_seen_in_space() {
    let Some(browser) = ResultPage::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let page = lap("examples/levels.lss", folder.path(), &[]);
    browser.hold(&page);
    browser.open(&page, (1400, 900), false);
    browser.ask("page.stage.space.click()");
    let drawn = "(() => { const v = page.stage.view; v.draw(); const g = v.gl, [w, h] = [v.canvas.width, v.canvas.height];
        const d = new Uint8Array(4 * w * h); g.readPixels(0, 0, w, h, g.RGBA, g.UNSIGNED_BYTE, d);
        let [n, sum] = [0, 0]; for (let k = 3; k < d.length; k += 4) if (d[k]) { n++; sum = (sum * 31 + d[k - 1] + d[k - 2] + k) % 1e9; }
        return [n, sum]; })()";
    let first = browser.ask(drawn);
    assert!(first[0].as_f64().unwrap() > 5000.0, "{first}");
    // The chain moves there, too, and the whole track is in the picture.
    browser.ask("page.stage.go(3, true)");
    assert_ne!(browser.ask(drawn), first);
    let seen = "(() => { const v = page.stage.view, m = v.camera(); let out = 0;
        for (let s = 0; s < page.data.plan.lap_m; s += 1) { const [x, y] = v.pixel(m, v.place(s));
          if (!(x > 0 && y > 0 && x < v.width && y < v.height)) out++; } return out; })()";
    assert_eq!(browser.ask(seen), json!(0));
    // A place's pixel leads back to the place.
    let back = "(() => { const v = page.stage.view, p = v.pixel(v.camera(), v.place(40)); return v.nearest(...p); })()";
    near(browser.number(back), 40.0, 0.5);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
fn two_laps_are_laid_over_each_other() {
    let Some(browser) = ResultPage::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    let page = lap("examples/smallest.lss", &a, &[]);
    lap("examples/smallest.lss", &b, &["--tension", "900N"]);
    // On the page of a lap, by its own file of the other.
    browser.open(&page, (1400, 900), false);
    let other = std::fs::read_to_string(b.join("lap.html")).expect("a page");
    let other = other.replacen(
        "<body>",
        "<body><script>window.strange = 1</script><img src=x onerror=\"window.strange = 1\">",
        1,
    );
    let lay = |other: &str| {
        browser.ask(&format!(
            "(() => {{ const t = new DataTransfer(); t.items.add(new File([{}], 'b.html')); const i = document.getElementById('other-page');
              i.files = t.files; i.dispatchEvent(new Event('change')); }})()",
            json!(other)
        ))
    };
    lay(&other);
    browser.wait("page.curves.get('along-joint_xi').others.length === 1");
    let warned = "document.getElementById('other-said').textContent.includes('different tracks')";
    assert_eq!(browser.ask(warned), json!(false));
    assert_eq!(browser.ask("typeof window.strange"), json!("undefined"));
    let laid = "(() => { const c = page.curves.get('along-joint_xi'); const y = c.others[0].y.filter(v => v !== null);
        return y.reduce((a, b) => a + b, 0) / y.length; })()";
    let mean = |folder: &Path| {
        let run = Run::read(&folder.join("run-01.csv")).expect("a run");
        let samples = &run.channels[&Channel::JointXi];
        samples.iter().sum::<f64>() / samples.len() as f64
    };
    assert!(mean(&b) > 1.2 * mean(&a), "{} against {}", mean(&a), mean(&b));
    near(browser.number(laid), mean(&b), 0.02 * mean(&b));
    // A lap of another track is told as such: here one that is 100 m longer.
    lay(&other.replacen("\"lap_m\":", "\"lap_m\":1", 1));
    browser.wait(warned);
    // As pages of their own.
    let (run_a, run_b) = (a.join("run-01.csv"), b.join("run-01.csv"));
    let out = folder.path().join("compare");
    lss(&["compare", &run_a.to_string_lossy(), &run_b.to_string_lossy()], &out);
    let page = out.join("compare.html");
    browser.hold(&page);
    let curves = browser.ask("page.data.plots.find(p => p.id === 'along-joint_xi').curves.map(c => c.name)");
    assert_eq!(curves, json!(["A, least to largest", "A", "B"]));
    assert!(browser.ask("document.querySelector('.lead').textContent").as_str().expect("text").contains("joint_xi"));
    let campaign = folder.path().join("campaign");
    std::fs::create_dir(&campaign).expect("a folder");
    for (from, name) in [(&a, "a"), (&b, "b")] {
        std::fs::copy(from.join("run-01.csv"), campaign.join(format!("{name}.csv"))).expect("copied");
        std::fs::copy(from.join("run-01.toml"), campaign.join(format!("{name}.toml"))).expect("copied");
    }
    std::fs::copy(a.join("simulation.json"), campaign.join("simulation.json")).expect("copied");
    lss(&["runs", &campaign.to_string_lossy()], &out);
    let page = out.join("runs.html");
    browser.hold(&page);
    let curves = browser.ask("page.data.plots.find(p => p.id === 'along-joint_xi-0').curves.map(c => c.name)");
    assert_eq!(curves, json!(["a", "b"]));
}

#[test]
fn polygon_action_is_asked_start_by_start() {
    let Some(browser) = ResultPage::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    lss(&["polygon", "examples/reference.lss"], folder.path());
    let page = folder.path().join("polygon.html");
    browser.hold(&page);
    let written = std::fs::read(folder.path().join("polygon.json")).expect("a file");
    let report: Value = serde_json::from_slice(&written).expect("JSON");
    let straight = &report["straights"][1];
    // The cursor in the middle of a straight says what the report has, and a start that is turned on its own value.
    let start = straight["name"].as_str().expect("a name");
    let button = format!("[data-curve=\"from {start}\"]");
    browser.click(&format!("#along {button}"));
    let middle = straight["s_m"].as_f64().unwrap() + 0.5 * straight["length_m"].as_f64().unwrap();
    browser.ask(&format!("page.links.get('track').set({middle})"));
    let shown = browser
        .ask(&format!("document.querySelector('#along {} .curve-value').textContent", button.replace('"', "\\\"")));
    let shown: f64 = shown.as_str().expect("text").split(' ').next().unwrap().parse().expect("a number");
    near(shown, report["delta_p_mm"][1][1].as_f64().unwrap(), 0.01);
    let cells = browser.ask("document.querySelectorAll('.matrix td').length");
    let count = report["straights"].as_array().expect("straights").len();
    assert_eq!(cells, json!(count * count));
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
fn what_a_shorter_track_costs_is_a_picture() {
    let Some(browser) = ResultPage::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    lss(&["build", "examples/written.lss", "--emit", "pareto"], folder.path());
    let page = folder.path().join("pareto.html");
    browser.hold(&page);
    let written = std::fs::read(folder.path().join("pareto.json")).expect("a file");
    let layouts: Value = serde_json::from_slice(&written).expect("JSON");
    let count = layouts["layouts"].as_array().expect("layouts").len();
    assert_eq!(browser.ask("document.querySelectorAll('.traded').length"), json!(count));
    assert_eq!(browser.ask("document.querySelectorAll('.traded:not([hidden])').length"), json!(count.min(2)));
}
