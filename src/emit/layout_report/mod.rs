//! `report.pdf`: all that a meeting about a layout needs, in one file: figures, what is proven, the drawing, sections,
//! constraints, distances, equipment and the bill.

mod pages;

use super::bill_row::BillRow;
use super::layout::LayoutFile;
use super::paper::PaperPoint;
use super::{DrawError, OwnNumbers, pdf, svg};
use crate::base::number::{fixed, trimmed};
use crate::compiled::Compiled;
use crate::model::TOLERANCE;
use crate::solve::Stage;
use pages::{Pages, narrow, number, words};

/// The report. It holds no dates but those of the layout's title block: the same layout gives the same bytes.
///
/// # Errors
/// As [`svg::drawing`] and [`pdf::render`].
pub fn pdf(compiled: &Compiled, own: &OwnNumbers) -> Result<Vec<u8>, DrawError> {
    let layout = &compiled.layout;
    let title = &layout.drawing.title;
    let mut pages = front(compiled)?;
    pages.turn();
    tables(&mut pages, compiled, own);
    let told =
        [("project", &title.project), ("drawing", &title.number), ("revision", &title.revision), ("", &title.date)];
    let told = told.iter().filter(|(_, text)| !text.is_empty());
    let parts: Vec<String> = std::iter::once(layout.name.clone())
        .chain(told.map(|(name, text)| format!("{name} {text}").trim().to_owned()))
        .collect();
    let mut all = pages.finish(&layout.name, &parts.join(", "), (1, 1));
    all.insert(1.min(all.len()), svg::drawing(compiled, svg::Theme::Light)?);
    pdf::render(&all, &layout.name)
}

/// Least and largest height of the plan on the front page, mm.
const PLAN: (f64, f64) = (45.0, 110.0);

/// The front page. Words go first: the plan has the room that they leave, and is left out where that is too little.
fn front(compiled: &Compiled) -> Result<Pages, DrawError> {
    let mut words = Pages::new();
    title(&mut words, compiled);
    summary(&mut words, compiled);
    let (room, mut pages) = (words.room_left(), Pages::new());
    if !words.is_one() || room.y < PLAN.0 {
        return Ok(words);
    }
    title(&mut pages, compiled);
    let (picture, size) = svg::overview(compiled, PaperPoint::new(room.x, (room.y - 2.0).min(PLAN.1)))?;
    pages.picture(picture, size);
    summary(&mut pages, compiled);
    Ok(pages)
}

fn title(pages: &mut Pages, compiled: &Compiled) {
    let layout = &compiled.layout;
    let title = &layout.drawing.title;
    pages.title(&layout.name);
    if compiled.failed() {
        pages.words("NOT FEASIBLE: this is the best layout that was found; it must not be built.", "bold warn");
    }
    let fields = [
        ("project", &title.project),
        ("drawing number", &title.number),
        ("revision", &title.revision),
        ("date of revision", &title.date),
        ("author", &title.author),
        ("checked", &title.checked),
        ("approved", &title.approved),
    ];
    let fields: Vec<(&str, String)> =
        fields.iter().filter(|(_, text)| !text.is_empty()).map(|(name, text)| (*name, (*text).clone())).collect();
    pages.facts(&fields);
}

fn summary(pages: &mut Pages, compiled: &Compiled) {
    let layout = &compiled.layout;
    pages.heading("The layout");
    let metres = |value: f64| format!("{} m", trimmed(value, 3));
    let chain = match compiled.chain {
        None => "no whole number of carts closes".to_owned(),
        Some(fit) => format!(
            "{} of {}, {} mm left over; the take-up compensates {} mm{}",
            fit.carts,
            metres(layout.cart.length),
            trimmed(1e3 * fit.left_over, 1),
            trimmed(1e3 * layout.take_up_travel(), 1),
            if compiled.chain_fits() { "" } else { ": THE CHAIN DOES NOT FIT" }
        ),
    };
    let bill = &compiled.bill;
    let mut facts = vec![
        ("length of track", metres(compiled.length())),
        ("carts", chain),
        ("speed", format!("{} m/s", trimmed(layout.speed.value, 3))),
        ("width of band", metres(layout.width.value)),
        ("footprint", format!("{} m²", trimmed(compiled.footprint, 2))),
        ("vertices", layout.vertices.len().to_string()),
        ("elements", format!("{}, {} EUR, {} kg", bill.count, fixed(bill.price, 2), fixed(bill.mass, 1))),
        ("catalogue", layout.catalog.name.clone()),
    ];
    let placement = &compiled.placement;
    if !layout.equipment.declared.is_empty() {
        let missing: usize = placement.missing.iter().map(|(_, count)| count).sum();
        let lacking = if missing > 0 { format!("; NO ROOM FOR {missing} MORE") } else { String::new() };
        let conveyors: f64 = placement.placed.iter().filter_map(|placed| placed.conveyor).sum();
        facts.extend([
            ("equipment", format!("{}, {} EUR{lacking}", placement.placed.len(), fixed(placement.equipment, 2))),
            ("conveyors", format!("{} m, {} EUR", fixed(conveyors, 2), fixed(placement.conveyors, 2))),
            ("track, equipment, conveyors", format!("{} EUR", fixed(compiled.price_with_equipment(), 2))),
        ]);
    }
    let lines = BillRow::all(compiled);
    let unpriced = lines.iter().filter(|line| line.price.is_none()).count();
    let without = match unpriced {
        0 => String::new(),
        1 => "; one line of the bill has no price".to_owned(),
        n => format!("; {n} lines of the bill have no price"),
    };
    facts.push(("all that has a price", format!("{} EUR{without}", fixed(BillRow::sums(&lines).0, 2))));
    if let Some(takes) = compiled.takes() {
        let required = takes.required.map_or_else(String::new, |required| {
            let short = if takes.is_enough() { "" } else { ": NOT REACHED" };
            format!("; {} have to be reached{short}", fixed(required, 0))
        });
        facts.push(("capacity in closed form", format!("{}{required}", takes.words)));
        facts.push(("limited by", takes.limit));
    }
    pages.facts(&facts);
    pages.heading("How it was found");
    let cut = compiled.stages.last().is_some_and(|s| s.cut.is_some());
    let stage = |s: &Stage| {
        vec![
            s.name.replace("stage", "stage "),
            fixed(s.length, 5),
            s.status.words(cut).to_owned(),
            violation(s.max_violation),
        ]
    };
    let rows: Vec<Vec<String>> = compiled.stages.iter().map(stage).collect();
    if compiled.raised() {
        pages.words("The length of track is along the slope; stages count the plan.", "quiet");
    }
    pages.table(&[narrow("stage"), number("length, m"), words("ended as"), number("largest violation, m")], &rows);
    if cut {
        pages.words("The limit of time ended the search: with more time it may find a better layout.", "warn");
    }
    if let Some(certificate) = compiled.stages.last().and_then(|s| s.certificate.as_ref()) {
        for line in certificate.words() {
            pages.words(&sentence(&line), "");
        }
        if !certificate.assumed.is_empty() {
            pages.words(&format!("This holds if {}.", certificate.assumed.join("; ")), "quiet");
        }
    }
    for violation in compiled.stages.last().iter().flat_map(|s| &s.violations) {
        let words = format!("{} is missed by {} {}", violation.row, trimmed(violation.amount, 4), violation.unit);
        pages.words(&words, "warn");
    }
}

/// The largest violation of a stage, m: what is less than a micrometre is none that anybody could build or measure.
fn violation(metres: f64) -> String {
    if metres < 1e-6 { "none".to_owned() } else { trimmed(metres, 6) }
}

/// With a capital and a full stop.
fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    let first: String = letters.next().map(char::to_uppercase).into_iter().flatten().collect();
    format!("{first}{}.", letters.as_str())
}

fn tables(pages: &mut Pages, compiled: &Compiled, own: &OwnNumbers) {
    let file = LayoutFile::new(compiled);
    // Alike in a column.
    let metres = |value: f64| fixed(value, 3);
    let degrees = |value: f64| fixed(value, 2);
    let text = |value: &str| value.to_owned();

    pages.heading("Curves and straights, in driving order");
    let vertex = |(v, s): (&super::layout::Vertex, &super::layout::Section)| {
        let place = [v.x_m, v.y_m, v.radius_m].map(metres);
        let [x, y, radius] = place;
        let turn = degrees(v.turn_deg);
        let straight = [metres(s.straight_m), degrees(s.heading_deg)];
        let [length, heading] = straight;
        vec![v.name.clone(), x, y, radius, turn, s.name.clone(), length, heading]
    };
    let rows: Vec<Vec<String>> = file.vertices.iter().zip(&file.sections).map(vertex).collect();
    let columns = [
        narrow("vertex"),
        number("x, m"),
        number("y, m"),
        number("radius, m"),
        number("turn, deg"),
        words("then"),
        number("straight, m"),
        number("heading, deg"),
    ];
    pages.table(&columns, &rows);

    let capacity = capacity(compiled);
    if !file.constraints.is_empty() || capacity.is_some() {
        pages.heading("Constraints");
        let unit = |value: f64, unit: &str| match unit {
            "rad" => format!("{} deg", trimmed(value.to_degrees(), 3)),
            _ => format!("{} {unit}", trimmed(value, 4)).trim().to_owned(),
        };
        let row = |c: &super::layout::Constraint| {
            let limits = match (c.low, c.high) {
                (Some(low), Some(high)) if low == high => unit(low, &c.unit),
                (Some(low), Some(high)) => format!("{} to {}", unit(low, &c.unit), unit(high, &c.unit)),
                (Some(low), None) => format!("at least {}", unit(low, &c.unit)),
                (None, Some(high)) => format!("at most {}", unit(high, &c.unit)),
                (None, None) => String::new(),
            };
            let short = c.low.map_or(0.0, |low| low - c.value).max(c.high.map_or(0.0, |high| c.value - high));
            let at = |limit: Option<f64>| limit.is_some_and(|limit| (limit - c.value).abs() <= 10.0 * TOLERANCE);
            let state = match short > TOLERANCE {
                true => "NOT MET",
                false if c.low == c.high => "",
                false if at(c.low) || at(c.high) => "at its limit",
                false => "",
            };
            // The row of a direction counts how far one end is off the line through the other.
            let direction = c.row.starts_with("fix rotation") && c.low == c.high;
            let (limits, is) = match (direction, c.difference) {
                (true, _) => ("as written".to_owned(), format!("{} off", unit(c.value, &c.unit))),
                (false, true) => ("as written".to_owned(), format!("{} apart", unit(c.value, &c.unit))),
                (false, false) => (limits, unit(c.value, &c.unit)),
            };
            let row = c.reason.as_ref().map_or_else(|| c.row.clone(), |why| format!("{}, \"{why}\"", c.row));
            vec![row, limits, is, text(state)]
        };
        let rows: Vec<Vec<String>> = file.constraints.iter().map(row).chain(capacity).collect();
        pages.table(&[words("line"), narrow("asks for"), number("is"), narrow("")], &rows);
    }

    if !file.contacts.is_empty() {
        pages.heading("Distances of the band");
        let row = |c: &super::layout::ContactArea| vec![c.name.clone(), metres(c.clearance_m), metres(c.required_m)];
        let rows: Vec<Vec<String>> = file.contacts.iter().map(row).collect();
        pages.table(&[words("to"), number("is, m"), number("at least, m")], &rows);
    }

    if !file.equipment.is_empty() {
        pages.heading("Along the track");
        let row = |e: &super::layout::Equipment| {
            let kind =
                serde_json::to_value(e.kind).ok().and_then(|k| k.as_str().map(str::to_owned)).unwrap_or_default();
            let [s, x, y, z] = [e.s_m, e.x_m, e.y_m, e.z_m].map(metres);
            vec![kind, e.name.clone(), s, x, y, z, degrees(e.heading_deg)]
        };
        let rows: Vec<Vec<String>> = file.equipment.iter().map(row).collect();
        let columns = [
            narrow("kind"),
            words("name"),
            number("s, m"),
            number("x, m"),
            number("y, m"),
            number("height, m"),
            number("heading, deg"),
        ];
        pages.table(&columns, &rows);
    }

    pages.heading("Bill");
    let numbers = |article: &str| own.of(article).unwrap_or_default().to_owned();
    let euros = |value: Option<f64>| value.map_or_else(String::new, |value| fixed(value, 2));
    let kilograms = |value: Option<f64>| value.map_or_else(String::new, |value| fixed(value, 1));
    let lines = BillRow::all(compiled);
    let row = |line: &BillRow| {
        let (own, count) = (numbers(&line.article), line.count.to_string());
        vec![line.article.clone(), own, line.description.clone(), count, euros(line.price), kilograms(line.mass)]
    };
    let mut rows: Vec<Vec<String>> = lines.iter().map(row).collect();
    let (price, mass) = BillRow::sums(&lines);
    rows.push(vec![text(""), text(""), text("sum of what has a price"), text(""), fixed(price, 2), fixed(mass, 1)]);
    let mut columns = vec![
        narrow("article"),
        narrow("own number"),
        words("description"),
        number("count"),
        number("price, EUR"),
        number("mass, kg"),
    ];
    if own.is_empty() {
        columns.remove(1);
        rows.iter_mut().for_each(|row| drop(row.remove(1)));
    }
    pages.table(&columns, &rows);
}

/// The row of `require capacity`, which is of the whole system and not of the track's shape.
fn capacity(compiled: &Compiled) -> Option<Vec<String>> {
    let required = compiled.layout.capacity.required.as_ref()?;
    let least = fixed(required.least.value, 0);
    let takes = compiled.takes();
    let is =
        takes.as_ref().map_or_else(|| "not known".to_owned(), |takes| format!("{} per hour", fixed(takes.most, 0)));
    let state = if takes.is_some_and(|takes| takes.is_enough()) { "" } else { "NOT MET" };
    let why = required.reason.as_ref().map_or_else(String::new, |why| format!(", \"{why}\""));
    let line = format!("require capacity >= {least} per hour{why}");
    Some(vec![line, format!("at least {least} per hour"), is, state.to_owned()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::plan::samples;
    use crate::model::RequiredCapacity;
    use crate::source::Spanned;

    fn front_page(compiled: &Compiled) -> String {
        front(compiled).expect("a plan").finish("title", "foot", (1, 0)).concat()
    }

    #[test]
    fn the_front_page_has_prices_and_capacity() {
        let mut compiled = samples::equipped();
        compiled.layout.capacity.required =
            Some(RequiredCapacity { least: Spanned::new(2e6, crate::model::fixture::span()), reason: None });
        let text = front_page(&compiled);
        let (track, placement) = (compiled.bill.price, &compiled.placement);
        for price in [placement.equipment, placement.conveyors, track + placement.equipment + placement.conveyors] {
            assert!(price > 0.0 && text.contains(&format!("{price:.2} EUR")), "{price} in {text}");
        }
        let takes = compiled.takes().expect("a sorter");
        assert!(text.contains("overview") && text.contains("class=\"band\""), "a plan");
        assert!(text.contains(&takes.words) && text.contains("2000000 have to be reached: NOT"), "{text}");
    }

    #[test]
    fn the_required_capacity_is_among_the_constraints() {
        let mut compiled = samples::equipped();
        assert_eq!(capacity(&compiled), None);
        let required = |least: f64| {
            let least = Spanned::new(least, crate::model::fixture::span());
            Some(RequiredCapacity { least, reason: Some("peak of the year".to_owned()) })
        };
        compiled.layout.capacity.required = required(2e6);
        let most = fixed(compiled.takes().expect("a sorter").most, 0);
        let row = capacity(&compiled).expect("a row");
        let is = format!("{most} per hour");
        assert_eq!(
            row,
            ["require capacity >= 2000000 per hour, \"peak of the year\"", "at least 2000000 per hour", &is, "NOT MET"]
        );
        compiled.layout.capacity.required = required(1.0);
        assert_eq!(capacity(&compiled).expect("a row")[3], "");
        let mut pages = Pages::new();
        tables(&mut pages, &compiled, &OwnNumbers::default());
        assert!(pages.finish("title", "foot", (1, 0)).concat().contains("require capacity"));
    }

    #[test]
    fn what_nobody_could_measure_is_no_violation() {
        assert_eq!([violation(4.4e-16), violation(9.9e-7), violation(1.5e-3)], ["none", "none", "0.0015"]);
        assert!(front_page(&samples::rectangle()).contains(">none<"));
    }
}
