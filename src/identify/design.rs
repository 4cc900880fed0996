//! Which simulations tell how the model answers its parameters: a two-level design in which every run moves every
//! parameter, so that each slope is estimated from all of them (Plackett and Burman 1946). Each run has a mirror image,
//! so that what two parameters do together cannot pass for what one does alone (Box and Wilson 1951, foldover).

/// Runs of the design, and without the mirror images.
pub const RUNS: usize = 2 * HALF;
const HALF: usize = 12;

/// Parameters that it takes.
pub const COLUMNS: usize = 11;

/// Plackett and Burman's first row for twelve runs; the others are its rotations, and the last is all low.
const FIRST: [f64; COLUMNS] = [1.0, 1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, -1.0];

/// Levels, −1 or 1, of a run's columns.
pub fn levels(run: usize) -> [f64; COLUMNS] {
    let (row, side) = (run % HALF, if run < HALF { 1.0 } else { -1.0 });
    std::array::from_fn(|k| side * if row + 1 == HALF { -1.0 } else { FIRST[(k + COLUMNS - row) % COLUMNS] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_balanced_and_orthogonal() {
        for a in 0..COLUMNS {
            let sum: f64 = (0..RUNS).map(|run| levels(run)[a]).sum();
            assert_eq!(sum, 0.0, "column {a}");
            for b in 0..a {
                let product: f64 = (0..RUNS).map(|run| levels(run)[a] * levels(run)[b]).sum();
                assert_eq!(product, 0.0, "columns {a} and {b}");
                let of_two =
                    |c: usize| (0..RUNS).map(|run| levels(run)[a] * levels(run)[b] * levels(run)[c]).sum::<f64>();
                assert!((0..COLUMNS).all(|c| of_two(c) == 0.0), "columns {a} and {b} together are no other's");
            }
        }
    }
}
