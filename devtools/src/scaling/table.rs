//! A table of a bench: `elbowroom_testkit::bench::GrowthTable` prints it, this module reads it and fits exponents.

/// Range of sizes, below the largest, over which an exponent is fitted: two decades.
const FITTED_RANGE: f64 = 100.0;

/// A table whose first column is the size that grows.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    pub title: String,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<f64>>,
}

/// The power law `measure ~ size^exponent`, fitted to some rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    pub exponent: f64,
    /// Smallest and largest fitted size.
    pub range: [f64; 2],
}

impl Table {
    /// Reads all tables of a text: a line `# TITLE`, a line of columns that two spaces separate, then rows of numbers. Other
    /// lines are skipped.
    pub fn parse_all(text: &str) -> Result<Vec<Self>, String> {
        let mut tables: Vec<Self> = Vec::new();
        let mut lines = text.lines();
        let mut is_in_table = false;
        while let Some(line) = lines.next() {
            if let Some(title) = line.strip_prefix("# ") {
                let names = lines.next().ok_or_else(|| format!("the table `{title}` has no columns"))?;
                let columns = names.split("  ").map(|name| name.trim().to_owned()).collect();
                tables.push(Self { title: title.to_owned(), columns, rows: Vec::new() });
                is_in_table = true;
            } else if line.trim().is_empty() {
                is_in_table = false;
            } else if is_in_table && let Some(table) = tables.last_mut() {
                let row = row(line, table.columns.len())?;
                table.rows.push(row);
            }
        }
        Ok(tables)
    }

    /// Sizes and values of a column.
    pub fn points(&self, column: &str) -> Result<Vec<(f64, f64)>, String> {
        let index = self.columns.iter().position(|name| name == column);
        let index = index.ok_or_else(|| format!("the table `{}` has no column `{column}`", self.title))?;
        Ok(self.rows.iter().map(|row| (row[0], row[index])).collect())
    }

    /// One line with the exponent of each column that has one.
    pub fn exponents(&self) -> String {
        let columns = self.columns.iter().skip(1);
        let laws: Vec<(&String, PowerLaw)> =
            columns.filter_map(|column| Some((column, PowerLaw::fit(&self.points(column).ok()?)?))).collect();
        let range =
            laws.first().map_or_else(String::new, |(_, law)| format!(" from {} to {}", law.range[0], law.range[1]));
        let each: Vec<String> = laws.iter().map(|(column, law)| format!("{column} {:.2}", law.exponent)).collect();
        format!("exponents of `{}`{range}: {}", self.title, each.join("; "))
    }
}

impl PowerLaw {
    /// Fits by least squares of logarithms over the upper two decades of sizes. `None` if fewer than two points remain, or a
    /// value has no logarithm.
    pub fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let largest = points.iter().map(|p| p.0).fold(0.0, f64::max);
        // Sizes are rounded: 972 parts in place of 1,000.
        let is_fitted = |p: &&(f64, f64)| p.0 * FITTED_RANGE >= largest * 0.9;
        let fitted: Vec<(f64, f64)> = points.iter().filter(is_fitted).map(|(x, y)| (x.ln(), y.ln())).collect();
        let n = fitted.len() as f64;
        let mean = |value: fn(&(f64, f64)) -> f64| fitted.iter().map(value).sum::<f64>() / n;
        let (x_mean, y_mean) = (mean(|p| p.0), mean(|p| p.1));
        let product = fitted.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum::<f64>();
        let square = fitted.iter().map(|(x, _)| (x - x_mean).powi(2)).sum::<f64>();
        let smallest = points.iter().filter(is_fitted).map(|p| p.0).fold(f64::INFINITY, f64::min);
        let exponent = product / square;
        exponent.is_finite().then_some(Self { exponent, range: [smallest, largest] })
    }
}

fn row(line: &str, columns: usize) -> Result<Vec<f64>, String> {
    let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
    match numbers {
        Ok(row) if row.len() == columns => Ok(row),
        _ => Err(format!("a row of a bench's table does not have {columns} numbers: {line:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\n# balls\nsize  time ms  allocations\n   10  2.5  0\n 1000  25  0\n\nallocations: 3\n\n# boxes\nsize  µs\n1  7\n";

    #[test]
    fn tables_end_at_an_empty_line() {
        let tables = Table::parse_all(TEXT).unwrap();
        assert_eq!(
            tables.iter().map(|t| (&t.title[..], t.rows.len())).collect::<Vec<_>>(),
            [("balls", 2), ("boxes", 1)]
        );
        assert_eq!(tables[0].points("time ms"), Ok(vec![(10.0, 2.5), (1000.0, 25.0)]));
        assert!(tables[0].points("µs").is_err());
    }

    #[test]
    fn rows_have_a_number_for_each_column() {
        assert!(row("1 2", 3).is_err() && row("1 two", 2).is_err());
        assert_eq!(row("  960  0.39 ", 2), Ok(vec![960.0, 0.39]));
    }

    #[test]
    fn exponents_are_of_the_upper_two_decades() {
        let cubes = [(1.0, 500.0), (10.0, 1.0), (100.0, 1e3), (1000.0, 1e6)];
        let law = PowerLaw::fit(&cubes).unwrap();
        assert!((law.exponent - 3.0).abs() < 1e-12 && law.range == [10.0, 1000.0], "{law:?}");
        assert_eq!(PowerLaw::fit(&[(1.0, 2.0)]), None);
        let line = Table::parse_all(TEXT).unwrap()[0].exponents();
        assert_eq!(line, "exponents of `balls` from 10 to 1000: time ms 0.50");
    }
}
