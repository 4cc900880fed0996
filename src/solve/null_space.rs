//! What gradients of rows leave free, and how they depend on one another: null spaces by the eigenvectors of their products.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Gradients are scaled to unit length; combinations of them that are shorter than this are none.
const RANK: f64 = 1e-5;

/// An orthonormal basis of what no row changes.
pub fn null_space(n: usize, rows: impl Iterator<Item = DVector<f64>>) -> Vec<DVector<f64>> {
    let mut products = DMatrix::<f64>::zeros(n, n);
    for row in rows {
        let size = row.norm();
        if size > 0.0 {
            let unit = row / size;
            products += &unit * unit.transpose();
        }
    }
    null_directions(products)
}

/// An orthonormal basis of the combinations of rows, each scaled to unit length, that are nothing.
pub fn dependences(rows: &[&DVector<f64>]) -> Vec<DVector<f64>> {
    let norms: Vec<f64> = rows.iter().map(|row| row.norm()).collect();
    null_directions(DMatrix::from_fn(rows.len(), rows.len(), |i, j| match norms[i] * norms[j] {
        0.0 => 0.0,
        scale => rows[i].dot(rows[j]) / scale,
    }))
}

/// Of a sum of squares; its eigenvalues are squares of singular values.
fn null_directions(products: DMatrix<f64>) -> Vec<DVector<f64>> {
    let eigen = SymmetricEigen::new(products);
    let null = (0..eigen.eigenvalues.len()).filter(|&k| eigen.eigenvalues[k] <= RANK * RANK);
    null.map(|k| eigen.eigenvectors.column(k).into_owned()).collect()
}
