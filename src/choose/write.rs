//! A layout's text with what was chosen in the place of what it left free.

use super::candidate::Candidate;
use super::find::Chosen;
use crate::base::number::trimmed;
use crate::model::{CountPlace, Motors};
use crate::source::{SourceMap, Span};
use crate::syntax;
use crate::syntax::tree::Item;

/// Decimals of coordinates, m, as a found route has them.
const DECIMALS: usize = 10;

/// The lines that say what was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Lines {
    pub cart: String,
    pub speed: String,
    pub motor: Option<String>,
    pub take_up: Option<String>,
    pub sensor: Option<String>,
    /// Where motors stand; empty where the layout's own stay.
    pub places: Vec<String>,
    pub radii: Option<String>,
    /// Of equipment whose number was free.
    pub numbers: Vec<String>,
}

impl Lines {
    /// All of them, in the order of a layout.
    pub fn all(&self) -> Vec<&str> {
        let first = [Some(&self.cart), self.motor.as_ref(), self.take_up.as_ref(), self.sensor.as_ref()];
        let first = first.into_iter().chain([Some(&self.speed), self.radii.as_ref()]);
        first.flatten().chain(&self.places).chain(&self.numbers).map(String::as_str).collect()
    }
}

/// The lines of a candidate. `None` where its motors do not fit.
pub fn lines(chosen: &Chosen, candidate: &Candidate) -> Option<Lines> {
    let layout = &chosen.layout;
    let (choice, built) = (&layout.choice, chosen.built(candidate)?);
    let written = choice.carts.get(chosen.fitted[candidate.fitted].cart).map(|cart| cart.written.clone());
    let millimetres = |metres: f64| format!("{} mm", trimmed(metres * 1e3, 3));
    let metres = |metres: f64| format!("{} m", trimmed(metres, 3));
    let places = match &built.layout.equipment.motors {
        _ if choice.motors.is_empty() => Vec::new(),
        Motors::Evenly { count } => vec![format!("motors {count} evenly")],
        Motors::Rows(rows) => {
            let row = |row: &crate::model::PlaceRow| {
                let (section, from) = (layout.section_name(row.place.section), metres(row.place.at));
                format!("motors on {section} from {from} every {} count {}", metres(row.every), row.count)
            };
            rows.iter().map(row).collect()
        }
    };
    let cart = chosen.cart(candidate);
    let numbers = places_of_numbers(chosen, candidate);
    Some(Lines {
        numbers: numbers.map(|(place, count)| place.line(count)).collect(),
        cart: format!(
            "cart {}",
            written.unwrap_or_else(|| format!("{}(length: {})", cart.name, millimetres(cart.length)))
        ),
        speed: format!("speed {} m/s", trimmed(candidate.speed, 6)),
        motor: choice.motors.get(candidate.motor).map(|motor| format!("motor {}", motor.written)),
        take_up: choice.take_ups.get(candidate.take_up).map(|take_up| format!("take_up {}", take_up.written)),
        sensor: choice.sensors.get(candidate.sensor).map(|sensor| format!("sensor {}", sensor.written)),
        places,
        radii: chosen
            .track(candidate)
            .radius
            .map(|radius| format!("radii {} .. {}", metres(radius), metres(layout.radii.value.high))),
    })
}

/// Where numbers of equipment stand that were free, with what a candidate has.
fn places_of_numbers<'c>(
    chosen: &'c Chosen,
    candidate: &Candidate,
) -> impl Iterator<Item = (&'c CountPlace, usize)> + use<'c> {
    let counts = chosen.layout.choice.counts.iter().zip(&chosen.track(candidate).counts);
    counts.flat_map(|(free, count)| free.places.iter().map(|place| (place, *count)))
}

/// The text of the layout's file with a candidate's lines. `None` where what they replace stands in another file, and where
/// the motors do not fit.
pub fn text(sources: &SourceMap, chosen: &Chosen, candidate: &Candidate) -> Option<String> {
    let lines = lines(chosen, candidate)?;
    let at = &chosen.layout.choice.statements;
    let file = chosen.layout.span.file;
    let cart = at.cart?;
    let all = [Some(cart), at.speed, at.motor, at.take_up, at.sensor, at.radii];
    let vertices = chosen.layout.vertices.iter().map(|vertex| &vertex.span);
    let numbers = || places_of_numbers(chosen, candidate);
    // A take-up of little travel asks for less than the layout allows.
    let within = chosen.layout.chain.closes_within.as_ref();
    let closes = within.zip(chosen.track(candidate).left_over).filter(|(within, left_over)| *left_over < within.value);
    let closes = closes.map(|(within, left_over)| (within.span, left_over));
    let variant = Variant::of(sources, chosen);
    let is_base = |span: &Span| variant.as_ref().is_some_and(|own| !own.has(span));
    let elsewhere = |span: &Span| span.file != file;
    let free = || at.free.iter().map(|(_, span)| span);
    if all.iter().flatten().chain(&at.places).chain(free()).chain(vertices).any(elsewhere)
        || numbers().any(|(place, _)| elsewhere(&place.span) || is_base(&place.span))
        || closes.is_some_and(|(span, _)| elsewhere(&span))
    {
        return None;
    }
    let mut edits: Vec<(Span, String)> = Vec::new();
    // What has no place yet goes behind the cart.
    let mut behind = String::new();
    let mut put = |place: Option<Span>, line: Option<&String>| match (place, line) {
        (Some(span), Some(line)) => edits.push((span, line.clone())),
        (None, Some(line)) => behind += &format!("\n{line}"),
        _ => {}
    };
    if !chosen.layout.choice.speeds.is_empty() {
        put(at.speed, Some(&lines.speed));
    }
    put(at.motor, lines.motor.as_ref());
    put(at.take_up, lines.take_up.as_ref());
    put(at.sensor, lines.sensor.as_ref());
    put(at.radii, lines.radii.as_ref());
    let mut removed: Vec<Span> = free().copied().collect();
    let mut places = at.places.iter();
    if !lines.places.is_empty() {
        put(places.next().copied(), Some(&lines.places.join("\n")));
        removed.extend(places.copied());
    }
    edits.extend(closes.map(|(span, left_over)| {
        let within = format!("{} mm", trimmed(left_over * 1e3, 6));
        (span, if is_base(&span) { format!("chain closes within {within}") } else { within })
    }));
    // The track is written as it was found: motors stand on it, and a build begins there. Of one that is not proven best a
    // build could find another, with another price.
    let found = chosen.track(candidate);
    if !found.proven && !chosen.layout.objective.terms.is_empty() {
        let goal = "optimise nothing // the track as it was found";
        match chosen.layout.objective.span.filter(|span| span.file == file) {
            Some(span) => edits.push((span, goal.to_owned())),
            None => behind += &format!("\n{goal}"),
        }
    }
    let track = &found.compiled.track;
    for (vertex, corner) in chosen.layout.vertices.iter().zip(&track.corners) {
        let [x, y, radius] = [corner.point.x, corner.point.y, corner.radius].map(|v| trimmed(v, DECIMALS));
        edits.push((vertex.span, format!("vertex {} ({x} m, {y} m) radius {radius} m", vertex.name)));
    }
    let own = sources.text(cart).to_owned();
    let cart_line = if chosen.layout.choice.carts.is_empty() { own } else { lines.cart };
    let stays = is_base(&cart) && chosen.layout.choice.carts.is_empty();
    edits.push((cart, if stays { behind.trim_start().to_owned() } else { cart_line + &behind }));
    edits.extend(numbers().map(|(place, count)| (place.span, format!("{}{count}", place.word))));
    edits.extend(removed.into_iter().map(|span| (span, String::new())));
    edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    let (base, mut edits): (Vec<_>, Vec<_>) = edits.into_iter().partition(|(span, _)| is_base(span));
    let mut text = sources.file(file).text.to_string();
    if let Some(own) = variant {
        // What the base says stays there, and the variant says otherwise.
        let said: Vec<String> = base.into_iter().rev().map(|(_, new)| new).filter(|new| !new.is_empty()).collect();
        edits.insert(0, own.with(&said.join("\n")));
    }
    for (span, new) in edits {
        let (mut start, mut end) = (span.start as usize, span.end as usize);
        if new.is_empty() {
            // The whole line, where nothing else stands on it.
            let begin = text[..start].rfind('\n').map_or(0, |at| at + 1);
            let stop = text[end..].find('\n').map(|at| end + at + 1);
            if let Some(stop) = stop
                && text[begin..start].trim().is_empty()
                && text[end..stop].trim().is_empty()
            {
                (start, end) = (begin, stop);
            }
        }
        text.replace_range(start..end, &new);
    }
    unimport(&mut text, chosen, candidate);
    let (tree, said) = syntax::parse(file, &text);
    said.iter().all(|d| !d.is_error()).then(|| syntax::format(&tree, &text))
}

/// A layout that changes another one.
struct Variant {
    span: Span,
    /// Whether it has a body.
    has_body: bool,
}

impl Variant {
    /// The layout, where it is one.
    fn of(sources: &SourceMap, chosen: &Chosen) -> Option<Variant> {
        let at = chosen.layout.span;
        let text = &sources.file(at.file).text;
        let (tree, _) = syntax::parse(at.file, text);
        let own = tree.items.iter().find_map(|item| match item {
            Item::Layout(own) if own.name.span == at => Some(own),
            _ => None,
        })?;
        own.from.as_ref()?;
        Some(Variant { span: own.span, has_body: !own.body.is_absent() })
    }

    /// Whether something stands in it, and not in what it changes.
    fn has(&self, span: &Span) -> bool {
        self.span.file == span.file && self.span.start <= span.start && span.end <= self.span.end
    }

    /// More statements at its end.
    fn with(&self, lines: &str) -> (Span, String) {
        let end = self.span.end - u32::from(self.has_body);
        let at = Span { start: end, end, ..self.span };
        (at, if self.has_body { format!("{lines}\n") } else { format!(" {{\n{lines}\n}}") })
    }
}

/// Takes out imports of components that were not chosen and are named nowhere else.
fn unimport(text: &mut String, chosen: &Chosen, candidate: &Candidate) {
    let choice = &chosen.layout.choice;
    let mut free: Vec<&String> = choice.carts.iter().map(|cart| &cart.item.name).collect();
    free.extend(choice.motors.iter().map(|motor| &motor.item.name));
    free.extend(choice.take_ups.iter().map(|take_up| &take_up.item.name));
    free.extend(choice.sensors.iter().map(|sensor| &sensor.item.name));
    let mut kept = vec![&chosen.cart(candidate).name, &chosen.motor(candidate).name];
    kept.extend(chosen.take_up(candidate).map(|take_up| &take_up.item.name));
    kept.extend(chosen.sensor(candidate).map(|sensor| &sensor.item.name));
    for name in free.into_iter().filter(|name| !kept.contains(name)) {
        let imports =
            |line: &&str| line.trim_start().starts_with("use std.") && line.trim_end().ends_with(&format!(".{name}"));
        let Some(line) = text.lines().find(imports).map(str::to_owned) else { continue };
        let word = |rest: &str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name);
        let rest = text.replacen(&format!("{line}\n"), "", 1);
        if !word(&rest) {
            *text = rest;
        }
    }
}
