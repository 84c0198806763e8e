//! Sums of alpha, along rows of texels and over rectangles of them (Crow 1984, "Summed-area tables for texture mapping").

/// Sums of alpha up to each column and behind the last, in rows of one more than there are columns.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sums {
    columns: usize,
    table: Vec<f64>,
}

impl Sums {
    /// Of each row of texels, from their alphas.
    pub(crate) fn of_rows<Row: Iterator<Item = f64>>(
        columns: usize,
        rows: impl ExactSizeIterator<Item = Row>,
    ) -> Self {
        let mut table = Vec::with_capacity(rows.len() * (columns + 1));
        for row in rows {
            let mut sum = 0.0;
            table.push(sum);
            for alpha in row {
                sum += alpha;
                table.push(sum);
            }
        }
        Self { columns, table }
    }

    /// Of all rows above each row, and of all: one more than there are.
    pub(crate) fn of_areas<Row: Iterator<Item = f64>>(
        columns: usize,
        rows: impl ExactSizeIterator<Item = Row>,
    ) -> Self {
        let mut table = Vec::with_capacity((rows.len() + 1) * (columns + 1));
        table.resize(columns + 1, 0.0);
        for row in rows {
            let mut sum = 0.0;
            table.push(sum);
            for alpha in row {
                sum += alpha;
                let above = table[table.len() - columns - 1];
                table.push(above + sum);
            }
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
        let of_row = |row: &[u8; 3]| row.map(|alpha| f64::from(alpha) / 255.0).into_iter();
        let rows = Sums::of_rows(3, alphas.iter().map(of_row));
        let areas = Sums::of_areas(3, alphas.iter().map(of_row));
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
