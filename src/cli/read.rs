//! The way from a file to one checked layout that can be built, or on to the input of its simulation, shared by the
//! verbs that need one.

use super::check::{Opened, open};
use super::progress::Solving;
use super::{MessageFormat, Outcome, could_not, foreign, report};
use crate::chain_input::Simulation;
use crate::cli::limits;
use crate::compiled::Compiled;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::Layout;
use crate::route;
use crate::semantics::given::{self, GivenLet};
use crate::semantics::{self, analyse};
use crate::solve::{self, Options, unsupported};
use crate::source::{FileId, Loader, SourceMap, input, one_line, revision, root, shown};
use std::path::Path;
use std::sync::Arc;

/// A checked layout, its sources, and what was said of it so far.
pub struct Read {
    pub sources: SourceMap,
    pub layout: Layout,
    pub said: Vec<Diagnostic>,
    /// Whether warnings are left out.
    pub mute: bool,
}

/// Reads and checks a layout with vertices; mistakes are reported here, and end the verb with the outcome returned.
pub fn read(file: &Path, name: Option<&str>, format: MessageFormat) -> Result<Read, Outcome> {
    with_vertices(read_any(file, name, &[], format)?, format)
}

/// The same with values for its `let`s.
pub fn read_with(file: &Path, name: Option<&str>, lets: &[GivenLet], format: MessageFormat) -> Result<Read, Outcome> {
    with_vertices(read_any(file, name, lets, format)?, format)
}

fn with_vertices(read: Read, format: MessageFormat) -> Result<Read, Outcome> {
    let Read { sources, layout, mut said, mute } = read;
    match without_vertices(&layout) {
        None => Ok(Read { sources, layout, said, mute }),
        Some(diagnostic) => {
            said.push(diagnostic);
            Err(tell(&sources, &said, format))
        }
    }
}

/// The same for a layout that may ask for its vertices, with values for its `let`s.
pub fn read_any(file: &Path, name: Option<&str>, lets: &[GivenLet], format: MessageFormat) -> Result<Read, Outcome> {
    let mut sources = SourceMap::default();
    let (mut loader, main) = match open(&mut sources, file) {
        Ok(opened) => opened,
        Err(Opened::Unreadable(why)) => return Err(could_not("read", file, why)),
        Err(Opened::Problem(diagnostic)) => return Err(tell(&sources, &[*diagnostic], format)),
    };
    if lets.is_empty() {
        return analysed(sources, &mut loader, main, name, format);
    }
    let overlay = match given::given(&mut sources, &mut loader, main, lets) {
        Ok(overlay) => overlay,
        Err(why) => {
            report::error(&format!("--let: {why}"));
            report::note(&format!("  help: {}", why.help()));
            return Err(Outcome::CouldNotRun);
        }
    };
    let mut sources = SourceMap::default();
    match Loader::open_over(&mut sources, file, Arc::new(overlay)) {
        Ok((mut loader, main)) => analysed(sources, &mut loader, main, name, format),
        Err(why) => Err(could_not("read", file, format!("{why:?}"))),
    }
}

/// `NAME=VALUE` of `--let`.
pub fn given_let(text: &str) -> Result<GivenLet, String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && given::is_value(value) => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err(format!("{text} is not NAME=VALUE, such as aisle=3m")),
    }
}

/// The same as [`read_any`] of a file as it is in a revision of its repository.
pub fn read_revision(file: &Path, revision: &str, name: Option<&str>, format: MessageFormat) -> Result<Read, Outcome> {
    let files = match revision::layouts(file, revision) {
        Ok(files) => files,
        Err(why) => {
            report::error(&why.to_string());
            return Err(if why.is_absent() { Outcome::Problems } else { Outcome::CouldNotRun });
        }
    };
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
    let mut sources = SourceMap::default();
    let label = format!("{}:", one_line(revision));
    let shown = format!("{label}{}", shown(file));
    match Loader::labelled(&mut sources, &files, &label) {
        Ok((mut loader, main)) => analysed(sources, &mut loader, main, name, format),
        Err(why) => match semantics::unreadable(&mut sources, &why, &shown) {
            Some(diagnostic) => Err(tell(&sources, &[diagnostic], format)),
            None => Err(could_not("read", Path::new(&shown), format!("{why:?}"))),
        },
    }
}

fn analysed(
    mut sources: SourceMap,
    loader: &mut Loader,
    main: FileId,
    name: Option<&str>,
    format: MessageFormat,
) -> Result<Read, Outcome> {
    let analysis = analyse(&mut sources, loader, main, name);
    let mut said = analysis.diagnostics.clone();
    match analysis.chosen() {
        Ok(Some(layout)) if !analysis.has_errors() => Ok(Read { layout: layout.clone(), sources, said, mute: false }),
        Ok(_) => Err(tell(&sources, &said, format)),
        Err(unclear) => {
            if !said.contains(&unclear) {
                said.push(*unclear);
            }
            Err(tell(&sources, &said, format))
        }
    }
}

/// Whether a file is a simulation input rather than a layout.
pub fn is_json(file: &Path) -> bool {
    file.extension().is_some_and(|e| e == "json")
}

/// The simulation input that a `.json` is, or that a layout builds.
pub fn simulation(file: &Path, name: Option<&str>, format: MessageFormat) -> Result<Simulation, Outcome> {
    simulation_with(file, name, &[], format)
}

/// The same; what is only warned of is not said, as the layout is not what was asked about.
pub fn simulation_quietly(file: &Path) -> Result<Simulation, Outcome> {
    if is_json(file) {
        return simulation(file, None, MessageFormat::Text);
    }
    simulated(Read { mute: true, ..read_any(file, None, &[], MessageFormat::Text)? }, MessageFormat::Text)
}

/// The same, with values for a layout's `let`s.
pub fn simulation_with(
    file: &Path,
    name: Option<&str>,
    lets: &[GivenLet],
    format: MessageFormat,
) -> Result<Simulation, Outcome> {
    if is_json(file) {
        if let Some((name, _)) = lets.first() {
            report::error(&format!("--let {name}: a simulation input has no `let`s"));
            report::note("  help: give the .lss that it was built from, or set its numbers with --set");
            return Err(Outcome::CouldNotRun);
        }
        let bytes = root::read_given(file, input::JSON_LIMIT).map_err(|why| could_not("read", file, why))?;
        return Simulation::read(&bytes).map_err(|why| {
            match foreign::not_a_simulation(&bytes) {
                Some(what) => report::error(&format!("{} is not a simulation input: {what}", shown(file))),
                None => report::error(&format!("{}{why}", shown(file))),
            }
            Outcome::Problems
        });
    }
    simulated(read_any(file, name, lets, format)?, format)
}

fn simulated(read: Read, format: MessageFormat) -> Result<Simulation, Outcome> {
    match solved(read, format)? {
        (compiled, Outcome::Clean) => Ok(Simulation::new(&compiled)),
        (_, failed) => Err(failed),
    }
}

/// What a layout builds; what is wrong with it is reported here.
pub fn built(file: &Path, name: Option<&str>, format: MessageFormat) -> Result<Compiled, Outcome> {
    match solved(read_any(file, name, &[], format)?, format)? {
        (compiled, Outcome::Clean) => Ok(compiled),
        (_, failed) => Err(failed),
    }
}

/// What a layout that was read builds, and whether it is a layout that can be built.
pub fn solved(read: Read, format: MessageFormat) -> Result<(Compiled, Outcome), Outcome> {
    let Read { sources, layout, mut said, mute } = read;
    said.extend(unsupported(&layout));
    if said.iter().any(Diagnostic::is_error) {
        return Err(tell(&sources, &said, format));
    }
    let compiled = match solve(&layout, format) {
        Ok(compiled) => compiled,
        Err(why) => {
            said.extend(why);
            return Err(tell(&sources, &said, format));
        }
    };
    said.extend(crate::solve::diagnose(&compiled.layout, &compiled.stages));
    // The bill does not matter here.
    said.extend(compiled.heights.iter().filter(|d| d.is_error()).cloned());
    if !compiled.failed() {
        said.extend(compiled.loose());
        said.extend(compiled.without_room());
    }
    said.retain(|d| !mute || d.is_error());
    let outcome = tell(&sources, &said, format);
    Ok((compiled, outcome))
}

/// Reports diagnostics, and whether they are problems.
pub fn tell(sources: &SourceMap, said: &[Diagnostic], format: MessageFormat) -> Outcome {
    report::diagnostics(&mut std::io::stderr(), sources, said, format);
    if said.iter().any(Diagnostic::is_error) { Outcome::Problems } else { Outcome::Clean }
}

/// Solves with the default options, and finds the vertices that a layout asks for; shows meanwhile how far it is.
fn solve(layout: &Layout, format: MessageFormat) -> Result<Compiled, Vec<Diagnostic>> {
    let line = Solving::new(format);
    let solved = match layout.route {
        None => Ok(Compiled::new(layout.clone(), solve::solve(layout, &options(), &|progress| line.show(progress)))),
        Some(_) => route::find(layout, &options(), &|progress| line.show(progress))
            .map(|found| Compiled::new(found.layout, found.stages)),
    };
    line.finish();
    solved
}

fn options() -> Options {
    Options { threads: limits::threads(), stop: limits::stop(), ..Options::default() }
}

/// Why a verb that works on the layout as it is written does not take one with a route.
fn without_vertices(layout: &Layout) -> Option<Diagnostic> {
    let route = layout.route.as_ref()?;
    Some(
        Diagnostic::new(Code::E0414, "the layout has no vertices yet", route.span, "asks for them")
            .help("`lss build` finds them: take its `layout.lss`, which is this layout with vertices"),
    )
}
