//! What each untrusted format has to hold for any bytes. The targets in `fuzz_targets/` ask it of what libFuzzer finds, and
//! `tests/layouts/mutated.rs`, which reads this file, of seeds with random edits.

use lss::diagnostic::text::{Style, render};
use lss::diagnostic::{Diagnostic, json};
use lss::source::SourceMap;
use std::path::Path;

/// Every diagnostic can be shown, as text and as JSON.
fn show(sources: &SourceMap, said: &[Diagnostic]) {
    for diagnostic in said {
        render(sources, diagnostic, Style::Plain);
        json::line(sources, diagnostic);
    }
}

/// Any text ends in a tree and diagnostics; what has no mistakes is formatted once and for all.
pub fn parse(text: &str) {
    use lss::source::FileId;
    use lss::syntax::{format, parse};

    let (tree, problems) = parse(FileId(0), text);
    let once = format(&tree, text);
    if problems.is_empty() {
        let (again, problems) = parse(FileId(0), &once);
        assert!(problems.is_empty(), "the formatter broke the file: {problems:?}");
        assert_eq!(once, format(&again, &once), "not idempotent");
    }
}

/// Any bytes go through the whole front end, in memory: a model or diagnostics.
pub fn front_end(bytes: &[u8]) {
    use lss::semantics::{analyse, unreadable};
    use lss::solve::unsupported;
    use lss::source::Loader;

    let mut sources = SourceMap::default();
    let said = match Loader::memory(&mut sources, &[("main.lss", bytes)]) {
        Ok((mut loader, main)) => {
            let analysis = analyse(&mut sources, &mut loader, main, None);
            let mut said = analysis.diagnostics;
            for layout in &analysis.layouts {
                said.extend(unsupported(layout));
                lss::model::print(layout);
            }
            said
        }
        Err(error) => unreadable(&mut sources, &error, "main.lss").into_iter().collect(),
    };
    show(&sources, &said);
}

/// Any line as the answer of a model outside.
pub fn answers(line: &str) {
    use lss::gap::outside::{description, series};

    let _ = description(line).map_err(|why| why.to_string());
    match series(line, &["x".to_owned()], 0.0, 2.0) {
        Ok(rows) => assert!(rows.iter().flatten().all(|x| !x.is_infinite()), "{rows:?}"),
        Err(why) => drop(why.to_string()),
    }
}

/// Any bytes as a campaign and as a sidecar.
pub fn campaign(bytes: &[u8]) {
    use lss::signal::{Campaign, Sidecar};

    let _ = Campaign::files(bytes, Path::new("campaign.toml")).map_err(|why| why.to_string());
    match Sidecar::read(bytes, Path::new("run.toml")) {
        Ok(sidecar) => {
            let again = Sidecar::read(&sidecar.write(), Path::new("run.toml")).expect("what is written is read");
            assert_eq!(again.write(), sidecar.write());
        }
        Err(why) => drop(why.to_string()),
    }
}

/// Any bytes as a run in CSV, of a sensor cart and of another machine: columns that can be written again, or an error
/// that can be shown.
pub fn csv(bytes: &[u8]) {
    use lss::signal::{Run, Sidecar, csv, measures};

    let file = Path::new("run.csv");
    let _ =
        csv::read_as(std::io::Cursor::new(bytes), file, &|name, _| Ok((name != "skipped").then(|| name.to_owned())))
            .map_err(|why| why.to_string());
    match csv::read(bytes, file) {
        Ok((time, channels)) => {
            let run = Run { time, channels, sidecar: Sidecar::default() };
            assert!(run.rate().is_finite() && run.duration().is_finite());
            run.warnings(Some(50.0));
            for samples in run.channels.values() {
                if let Some(found) = measures::statistics(samples) {
                    assert!(found.mean.is_finite() && found.sd.is_finite(), "{found:?}");
                }
            }
            let (time, _) = csv::read(&csv::write(&run), file).expect("what is written is read");
            assert_eq!(time, run.time);
        }
        Err(why) => drop(why.to_string()),
    }
}

/// Any text as a drawing: a plan whose layout is free of mistakes of form, or diagnostics.
pub fn dxf(drawing: &str) {
    use lss::import::{self, Options};
    use lss::source::FileId;
    use lss::syntax::parse;

    let mut sources = SourceMap::default();
    let file = sources.add("plan.dxf", drawing);
    let (plan, said) = import::read(&sources, file, &Options::default());
    show(&sources, &said);
    if let Some(plan) = plan {
        let layout = import::write(&plan, "plan", "Imported.");
        let (_, mistakes) = parse(FileId(0), &layout);
        assert!(mistakes.is_empty(), "{mistakes:?}\n{layout}");
    }
}

/// Any bytes as a run in MDF4.
pub fn mdf4(bytes: &[u8]) {
    use lss::signal::mdf4;

    let _ = mdf4::read(std::io::Cursor::new(bytes), Path::new("run.mf4")).map_err(|why| why.to_string());
}

/// Any bytes as a run in Parquet.
pub fn parquet(bytes: &[u8]) {
    use lss::signal::parquet;

    let bytes = bytes::Bytes::copy_from_slice(bytes);
    let _ = parquet::read(bytes, Path::new("run.parquet")).map_err(|why| why.to_string());
}

/// Any bytes as an input of a simulation: what is read has a centre line, parameters, and a model or a reason why not.
pub fn simulation(bytes: &[u8]) {
    use lss::chain_input::Simulation;
    use lss::dynamics::parameters;
    use lss::effects;

    match Simulation::read(bytes) {
        Ok(mut simulation) => {
            assert!(simulation.track.centre_line().length.is_finite());
            parameters::parameters(&simulation);
            if simulation.chain.carts < 1_000 && simulation.track.elements.len() < 100 {
                let _ = effects::model(&simulation).map_err(|why| why.to_string());
            }
            simulation.derive();
            assert!(simulation.chain.left_over_m.is_finite());
        }
        Err(why) => drop(why.to_string()),
    }
}

/// Any text as a study.
pub fn study(text: &str) {
    let mut sources = SourceMap::default();
    let file = sources.add("study.toml", text);
    let (study, said) = lss::study::read(file, text);
    assert!(!said.is_empty() || !study.sweeps.is_empty());
    show(&sources, &said);
}
