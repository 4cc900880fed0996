//! A result page in a headless browser, as a person uses it.

#![allow(dead_code)]

use crate::browser::{Browser, Tab};
use serde_json::{Value, json};
use std::path::Path;

pub struct ResultPage {
    browser: Browser,
    tab: Tab,
}

impl ResultPage {
    /// `None`, and a word of it, where there is no browser.
    pub fn start() -> Option<ResultPage> {
        let browser = Browser::start()?;
        let tab = browser.open("about:blank", (1400, 900));
        Some(ResultPage { browser, tab })
    }

    /// Opens a page in a window of a size, light or dark, and waits until its pictures stand.
    pub fn open(&self, page: &Path, (width, height): (u32, u32), dark: bool) {
        self.tab.resize(width, height);
        self.tab.prefers_dark(dark);
        self.tab.visit(&format!("file://{}", page.canonicalize().expect("a page").display()));
        self.tab.until("document.readyState === 'complete' && window.page && location.protocol === 'file:'");
    }

    /// The value of an expression.
    pub fn ask(&self, expression: &str) -> Value {
        self.tab.value(expression)
    }

    /// A number.
    pub fn number(&self, expression: &str) -> f64 {
        let value = self.ask(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression} is {value}"))
    }

    /// Until something holds.
    pub fn wait(&self, expression: &str) {
        self.tab.until(expression);
    }

    /// The mouse: `mouseMoved`, `mousePressed`, `mouseReleased` at a pixel of the window.
    pub fn mouse(&self, kind: &str, x: f64, y: f64) {
        self.tab.mouse(kind, (x, y), kind == "mousePressed");
    }

    /// Middle of an element in the window, which is scrolled there.
    pub fn middle(&self, selector: &str) -> (f64, f64) {
        self.ask(&format!("document.querySelector({}).scrollIntoView({{ block: 'center' }})", json!(selector)));
        self.tab.middle(selector)
    }

    /// Presses and lets go in the middle of an element.
    pub fn click(&self, selector: &str) {
        self.tab.click(self.middle(selector));
    }

    /// What pages threw, logged or were refused.
    pub fn errors(&self) -> Vec<String> {
        self.browser.complaints()
    }

    /// What every page holds to: no errors, nothing asked for but the page itself, no weight, no width beyond the window.
    pub fn hold(&self, page: &Path) {
        let size = std::fs::metadata(page).expect("a page").len();
        assert!(size < 1_500_000, "{} has {size} bytes", page.display());
        for (width, dark) in [(1400, false), (1400, true), (600, false), (600, true)] {
            self.open(page, (width, 900), dark);
            let beyond = self.number("document.documentElement.scrollWidth - document.documentElement.clientWidth");
            assert!(beyond <= 0.0, "{} is {beyond} px wider than {width} px", page.display());
            let drawn = "[...page.curves.values()].every(c => c.plot || !c.canvas.checkVisibility())";
            assert_eq!(self.ask(drawn), json!(true), "{} has curves that are not drawn", page.display());
            let ground = self.ask("getComputedStyle(document.body).backgroundColor");
            assert_eq!(ground == json!("rgb(255, 255, 255)"), !dark, "{ground}");
        }
        assert_eq!(self.errors(), Vec::<String>::new());
        let own = |url: &String| url.starts_with("file://") || url.starts_with("about:");
        let requests = self.browser.requests();
        assert!(requests.iter().all(own), "{requests:?}");
    }
}
