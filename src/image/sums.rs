//! Sums of an image's alpha, along rows of texels and over rectangles of them (Crow 1984, "Summed-area tables for texture mapping").

/// Sums of alpha up to each column and behind the last, in rows of one more than there are columns.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    columns: usize,
    /// Each alpha from 0 to 1.
    table: Vec<f64>,
}

impl Sums {
    /// Of each row of texels, from pixels of four bytes, the last of which is alpha.
    pub(super) fn of_rows(columns: usize, pixels: &[u8]) -> Self {
        let mut table = Vec::with_capacity(pixels.len() / (4 * columns) * (columns + 1));
        for row in pixels.chunks_exact(4 * columns) {
            let mut sum = 0.0;
            table.push(sum);
            for pixel in row.chunks_exact(4) {
                sum += f64::from(pixel[3]) / 255.0;
                table.push(sum);
            }
        }
        Self { columns, table }
    }

    /// Of all rows above each row, and of all: one more than there are.
    pub(super) fn of_areas(columns: usize, pixels: &[u8]) -> Self {
        let mut table = vec![0.0; (pixels.len() / (4 * columns) + 1) * (columns + 1)];
        let mut above = 0;
        for row in pixels.chunks_exact(4 * columns) {
            let mut sum = 0.0;
            for (column, pixel) in row.chunks_exact(4).enumerate() {
                sum += f64::from(pixel[3]) / 255.0;
                let at = above + column + 1;
                table[at + columns + 1] = table[at] + sum;
            }
            above += columns + 1;
        }
        Self { columns, table }
    }

    /// A row of the sums.
    pub(crate) fn row(&self, row: usize) -> Row<'_> {
        Row(&self.table[row * (self.columns + 1)..][..=self.columns])
    }

    /// The sum of areas up to a point in texels.
    pub(crate) fn up_to(&self, x: f64, y: f64) -> f64 {
        let rows = self.table.len() / (self.columns + 1) - 1;
        let (row, share) = between(y, rows);
        let (above, below) = (self.row(row).up_to(x), self.row(row + 1).up_to(x));
        above + (below - above) * share
    }
}

/// Sums up to each column and behind the last.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row<'a>(&'a [f64]);

impl Row<'_> {
    /// The sum up to an x in texels.
    #[inline(always)]
    pub(crate) fn up_to(self, x: f64) -> f64 {
        let (column, share) = between(x, self.0.len() - 1);
        self.0[column] + (self.0[column + 1] - self.0[column]) * share
    }
}

/// The texel that holds a place, the first or the last beyond them, and how far in it that is.
#[inline(always)]
fn between(place: f64, count: usize) -> (usize, f64) {
    let place = place.clamp(0.0, count as f64);
    let texel = (place as usize).min(count - 1);
    (texel, place - texel as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_texels() {
        let alphas = [[0_u8, 255, 90], [200, 0, 33]];
        let pixels: Vec<u8> = alphas
            .iter()
            .flatten()
            .flat_map(|&alpha| [10, 20, 30, alpha])
            .collect();
        let (rows, areas) = (Sums::of_rows(3, &pixels), Sums::of_areas(3, &pixels));
        for (x, y) in [(0.0, 0.0), (3.0, 2.0), (1.5, 1.25), (2.2, 0.6), (-4.0, 9.0)] {
            let covered = |from: usize, to: f64| (to - from as f64).clamp(0.0, 1.0);
            let mut sum = 0.0;
            for (row, alphas) in alphas.iter().enumerate() {
                let mut along = 0.0;
                for (column, alpha) in alphas.iter().enumerate() {
                    along += covered(column, x) * f64::from(*alpha) / 255.0;
                }
                assert!((rows.row(row).up_to(x) - along).abs() < 1e-12, "{x} {row}");
                sum += covered(row, y) * along;
            }
            assert!((areas.up_to(x, y) - sum).abs() < 1e-12, "{x} {y}");
        }
    }
}
