//! Exponentials of small matrices.

/// A square matrix by its rows.
pub(super) type Matrix<const N: usize> = [[f64; N]; N];

fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    let mut c = [[0.0; N]; N];
    for (row, a_row) in c.iter_mut().zip(a) {
        for (factor, b_row) in a_row.iter().zip(b) {
            for (entry, b_entry) in row.iter_mut().zip(b_row) {
                *entry += factor * b_entry;
            }
        }
    }
    c
}

/// Exponential by scaling and squaring: the Taylor series of the matrix divided by 2^k, squared k times
/// (C. Moler, C. Van Loan, "Nineteen Dubious Ways to Compute the Exponential of a Matrix", SIAM Review 2003,
/// method 3).
pub(super) fn exponential<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    const TAYLOR_TERMS: u32 = 18; // 0.5^18/18! is far below the last bit of 1
    const MOST_SQUARINGS: u32 = 60;
    let norm = a.iter().map(|row| row.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
    let mut squarings = 0;
    let mut scale = 1.0;
    while norm * scale > 0.5 && squarings < MOST_SQUARINGS {
        scale *= 0.5;
        squarings += 1;
    }
    let scaled = a.map(|row| row.map(|v| v * scale));
    let mut sum = [[0.0; N]; N];
    for (i, row) in sum.iter_mut().enumerate() {
        if let Some(entry) = row.get_mut(i) {
            *entry = 1.0;
        }
    }
    let mut term = sum;
    for n in 1..=TAYLOR_TERMS {
        term = product(&term, &scaled).map(|row| row.map(|v| v / f64::from(n)));
        for (sum_row, term_row) in sum.iter_mut().zip(&term) {
            for (entry, v) in sum_row.iter_mut().zip(term_row) {
                *entry += v;
            }
        }
    }
    for _ in 0..squarings {
        sum = product(&sum, &sum);
    }
    sum
}
