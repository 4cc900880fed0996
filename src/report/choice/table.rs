//! `candidates.csv`: all candidates of a choice, a row each.

use super::found::{Row, outcome};
use crate::base::number::{fixed, trimmed};
use crate::choose::Chosen;
use crate::choose::refused::short_words;

/// Every candidate with what it gives, what it falls short of, and what its check said.
pub fn table(chosen: &Chosen) -> Result<Vec<u8>, String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut heads = vec![
        "cart",
        "cart_length_m",
        "carts",
        "left_over_mm",
        "least_radius_m",
        "speed_m_s",
        "motor",
        "motors",
        "take_up",
        "sensor",
        "capacity_per_hour",
        "simulated_per_hour",
        "simulated_half_width",
        "thrust_running_n",
        "thrust_starting_n",
        "thrust_stopping_n",
        "length_m",
        "footprint_m2",
        "polygon_action_mm",
        "price_eur",
        "energy_kwh_per_year",
        "total_eur",
        "short_of",
        "check",
    ];
    let numbers = chosen.layout.choice.counts.iter().flat_map(|free| &free.declared);
    let numbers: Vec<&str> = numbers.map(|k| chosen.layout.equipment.declared[*k].name.as_str()).collect();
    let short_of = heads.len() - 2;
    heads.splice(short_of..short_of, numbers.iter().copied());
    writer.write_record(heads).map_err(|why| why.to_string())?;
    let some = |value: Option<f64>, decimals: usize| value.map_or_else(String::new, |x| fixed(x, decimals));
    for (k, c) in chosen.candidates.iter().enumerate() {
        let row = Row::new(chosen, c);
        let short: Vec<String> = c.shortfalls.iter().map(short_words).collect();
        let mut cells = vec![
            row.cart,
            trimmed(row.cart_length_m, 6),
            row.carts.to_string(),
            fixed(row.left_over_mm, 2),
            some(row.least_radius_m, 3),
            trimmed(row.speed_m_s, 6),
            row.motor,
            row.motors.to_string(),
            row.take_up.unwrap_or_default(),
            row.sensor.unwrap_or_default(),
            some(row.capacity_per_hour, 2),
            some(row.simulated_per_hour.map(|mean| mean.value), 2),
            some(row.simulated_per_hour.map(|mean| mean.half_width), 2),
            fixed(c.thrust.resistance.most(), 2),
            some(c.thrust.starting, 2),
            some(c.thrust.stopping, 2),
            fixed(row.length_m, 3),
            fixed(row.footprint_m2, 3),
            some(row.polygon_action_mm, 4),
            fixed(row.price_eur, 2),
            some(row.energy_kwh_per_year, 1),
            fixed(row.total_eur, 2),
            short.join("; "),
            outcome(chosen, k).unwrap_or_default(),
        ];
        let counts = numbers.iter().filter_map(|name| row.equipment.get(*name)).map(usize::to_string);
        cells.splice(short_of..short_of, counts);
        writer.write_record(cells).map_err(|why| why.to_string())?;
    }
    writer.into_inner().map_err(|why| why.to_string())
}
