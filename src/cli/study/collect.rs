//! `lss study collect`: one table of all.

use super::{Studied, tasks};
use crate::cli::{Outcome, could_not, report};
use crate::report::study;
use crate::source::disk::Files;
use crate::source::shown;
use crate::study::State;
use crate::study::table::Table;

/// Merge what all tasks found into one table and a page.
///
/// Writes study.parquet, study.csv and study.html with a row a task. The same tasks give the same bytes, whatever order
/// they were done in, and wherever. The exit code is 1 where tasks failed or are open; they have a row, too.
#[derive(Debug, clap::Args)]
pub struct Collect {
    #[command(flatten)]
    studied: Studied,
}

impl Collect {
    pub fn run(&self) -> Outcome {
        let (plan, place) = match self.studied.planned() {
            Ok(planned) => planned,
            Err(outcome) => return outcome,
        };
        let table = Table::collect(&plan, &place);
        let parquet = match table.parquet() {
            Ok(bytes) => bytes,
            Err(why) => return could_not("write", place.folder(), why),
        };
        let mut files = Files::default();
        files.push("study.parquet", parquet);
        files.push("study.csv", table.csv());
        files.push("study.html", study::page(&table));
        if let Err(error) = files.write_set(place.folder(), "study") {
            return could_not("write", &error.path, &error.reason);
        }
        let count = |state: State| table.states().filter(|name| *name == state.name()).count();
        let (done, failed, open) = (count(State::Done), count(State::Failed), count(State::Open));
        report::print(&format!(
            "{}: {}, {} columns\n  written to {}\n",
            table.name,
            tasks(table.rows),
            table.columns.len(),
            shown(place.folder())
        ));
        if failed > 0 {
            report::warning(&format!("{} failed: the column `error` says why", tasks(failed)));
        }
        if open > 0 {
            report::warning(&format!(
                "{} open: `lss study run` does what is left",
                if open == 1 { "1 task is".to_owned() } else { format!("{open} tasks are") }
            ));
        }
        if done == table.rows { Outcome::Clean } else { Outcome::Problems }
    }
}
