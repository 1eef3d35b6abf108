use std::fmt::{self, Display};

/// Figures in rows and columns, as text for people and as CSV for programs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// As many cells per row as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new<T: Into<String>>(columns: impl IntoIterator<Item = T>) -> Self {
        Table { columns: columns.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Appends a row.
    pub fn push<T: Into<String>>(&mut self, cells: impl IntoIterator<Item = T>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The table with comma-separated values (RFC 4180).
    pub fn to_csv(&self) -> String {
        let mut text = String::new();
        for row in std::iter::once(&self.columns).chain(&self.rows) {
            let cells: Vec<String> = row.iter().map(|cell| csv_cell(cell)).collect();
            text += &cells.join(",");
            text += "\r\n";
        }
        text
    }
}

fn csv_cell(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |column: usize| {
            let cells = std::iter::once(&self.columns).chain(&self.rows).filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        for row in std::iter::once(&self.columns).chain(&self.rows) {
            for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
                // The first column names the row, the others are figures.
                let space = if column == 0 { "" } else { "  " };
                if column == 0 { write!(f, "{cell:<width$}")? } else { write!(f, "{space}{cell:>width$}")? }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// A positive number, such as seconds, with three significant digits; `-` if it is not positive.
pub fn seconds(value: f64) -> String {
    if !value.is_finite() || value <= 0.0 {
        return "-".to_owned();
    }
    let magnitude = value.log10().floor() as i32;
    let decimals = usize::try_from((2 - magnitude).clamp(0, 6)).unwrap_or(0);
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_aligned_and_quoted() {
        let mut table = Table::new(["objects", "CPU, all"]);
        table.push(["7", "0.12"]);
        table.push(["841", "12"]);
        assert_eq!(table.to_string(), "objects  CPU, all\n7            0.12\n841            12\n");
        assert_eq!(table.to_csv(), "objects,\"CPU, all\"\r\n7,0.12\r\n841,12\r\n");
    }

    #[test]
    fn times_have_three_digits() {
        let texts = [123.456, 12.3456, 0.0123456, 0.0].map(seconds);
        assert_eq!(texts, ["123", "12.3", "0.0123", "-"]);
    }
}
