//! Linear least squares. In: rows of an overdetermined system A x = y. Out: x with standard deviations, and
//! what is left.
//!
//! ```text
//! x = argmin |A x − y|²,   s² = |A x − y|²/(m − n),   deviation of x_i = s ((AᵀA)⁻¹_ii)^½
//! ```
//! By QR of A with its columns scaled to length one.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use crate::estimate::Estimate;

/// Part of a column, of length one, that the columns before it must leave.
const INDEPENDENT: f64 = 1e-12;

/// What a fit found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit<const N: usize> {
    pub(crate) x: [Estimate; N],
    /// s, in the unit of y.
    pub(crate) residual: f64,
}

impl<const N: usize> Fit<N> {
    /// The values alone.
    pub(crate) fn values(&self) -> [f64; N] {
        self.x.map(|estimate| estimate.value)
    }
}

/// The best x; `None` if the rows do not determine it.
pub(crate) fn fit<const N: usize>(rows: &[([f64; N], f64)]) -> Option<Fit<N>> {
    if rows.len() <= N {
        return None;
    }
    let mut a = DMatrix::from_fn(rows.len(), N, |row, column| rows[row].0[column]);
    let y = DVector::from_fn(rows.len(), |row, _| rows[row].1);
    let mut scale = [1.0; N];
    for (mut column, scale) in a.column_iter_mut().zip(&mut scale) {
        *scale = column.norm();
        if !(scale.is_finite() && *scale > 0.0) {
            return None;
        }
        column /= *scale;
    }
    let qr = a.clone().qr();
    let projected = qr.q().transpose() * &y;
    let triangle = qr.unpack_r();
    if triangle.diagonal().iter().any(|length| length.abs() < INDEPENDENT) {
        return None;
    }
    let inverse = SMatrix::<f64, N, N>::from_fn(|i, j| triangle[(i, j)]).try_inverse()?;
    let x = inverse * SVector::<f64, N>::from_fn(|i, _| projected[i]);
    let left = (&a * DVector::from_column_slice(x.as_slice()) - y).norm_squared();
    let residual = (left / (rows.len() - N) as f64).sqrt();
    let estimates = core::array::from_fn(|i| Estimate {
        value: x[i] / scale[i],
        deviation: residual * inverse.row(i).norm() / scale[i],
    });
    let sound = estimates.iter().all(|e| e.value.is_finite() && e.deviation.is_finite());
    sound.then_some(Fit { x: estimates, residual })
}

#[cfg(test)]
mod tests {
    use super::fit;

    #[test]
    fn a_line_through_points_has_the_deviation_of_the_textbook() {
        // y = 1 + 2 t with errors +e, −e, −e, +e at t = 0 … 3: orthogonal to both columns.
        let e = 0.1;
        let rows: Vec<_> = [e, -e, -e, e]
            .iter()
            .enumerate()
            .map(|(t, error)| ([1.0, t as f64], 1.0 + 2.0 * t as f64 + error))
            .collect();
        let fit = fit(&rows).unwrap();
        let [offset, slope] = fit.x;
        assert!((offset.value - 1.0).abs() < 1e-12 && (slope.value - 2.0).abs() < 1e-12);
        // s² = 4 e²/2; variance of the slope s²/Σ(t − 1.5)² = s²/5, of the offset s² (1/4 + 1.5²/5).
        let s = e * 2f64.sqrt();
        assert!((fit.residual - s).abs() < 1e-12);
        assert!((slope.deviation - s / 5f64.sqrt()).abs() < 1e-12);
        assert!((offset.deviation - s * 0.7f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_determined_is_none() {
        assert!(fit(&[([1.0, 2.0], 1.0), ([2.0, 4.0], 2.0), ([3.0, 6.0], 3.0)]).is_none());
        assert!(fit(&[([1.0], 1.0)]).is_none());
        assert!(fit(&[([0.0], 1.0), ([0.0], 2.0)]).is_none());
    }
}
