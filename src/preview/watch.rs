//! Looks again and again whether a file of the preview changed. Asking the disk for times and sizes does with every
//! editor and file system, also where a file is replaced by another one.

use super::session::{Ask, Session, Watched};
use crate::source::{SIZE_LIMIT, Stamp, root};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const INTERVAL: Duration = Duration::from_millis(150);
/// A file that another one imports and that is missing is looked for in every so many rounds.
const ROUNDS: usize = 6;
/// A file is away for a moment while some editors save it: it is missing after so many rounds.
const PATIENCE: usize = 3;

/// Asks the session to look whenever a file changed, until told to end.
pub fn watch(session: &Arc<Session>, ended: &AtomicBool) {
    let mut before: Vec<Stamp> = Vec::new();
    let (mut round, mut away) = (0, 0);
    while !ended.load(Ordering::Relaxed) {
        std::thread::sleep(INTERVAL);
        round += 1;
        let Watched { texts, incomplete } = session.watched();
        let stamps: Vec<Stamp> = texts.iter().map(|(place, _)| Stamp::of(place)).collect();
        let doubtful = stamps != before || stamps.iter().any(Stamp::is_fresh) || away > 0;
        before = stamps;
        let mut changed = incomplete && round % ROUNDS == 0;
        if doubtful {
            let now: Vec<Option<String>> = texts.iter().map(|(place, _)| text(place)).collect();
            let lost = |((_, known), now): (&(_, Option<String>), &Option<String>)| known.is_some() && now.is_none();
            away = if texts.iter().zip(&now).any(lost) { away + 1 } else { 0 };
            let differs = texts.iter().zip(&now).any(|((_, known), now)| known != now);
            changed |= differs && (away == 0 || away >= PATIENCE);
        }
        if changed {
            session.ask(Ask::Look);
        }
    }
}

/// The text of a file now; `None` of what is not there or no text.
fn text(place: &Path) -> Option<String> {
    String::from_utf8(root::read_given(place, SIZE_LIMIT).ok()?).ok()
}
