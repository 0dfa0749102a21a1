//! Tables on a terminal: a line above, one below the header, one at the end; no ink between rows.
//!
//! A table is as wide as the terminal at most; where there is none, as a page of text. What does
//! not fit is wrapped within its column, numbers never.
use comfy_table::{
    Cell, CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Row, Table, TableStyle,
};

/// Columns of text where no terminal says how many there are.
const PAGE: u16 = 100;
/// A table is never narrower than this: what a column of numbers needs cannot be wrapped.
const NARROWEST: u16 = 40;

/// An empty table with these heads, no wider than the terminal.
pub(crate) fn table(heads: impl Into<Row>) -> Table {
    let line = LineStyle::none().fill('─').junction('─');
    let style = TableStyle::new().top_border(line).header_separator(line).bottom_border(line);
    let mut table = Table::new();
    table.load_style(style).set_header(heads);
    fit(&mut table);
    table
}

/// Let a table be no wider than the terminal.
pub(crate) fn fit(table: &mut Table) {
    let width = table.width().unwrap_or(PAGE).max(NARROWEST);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(width);
}

/// A table of measures: the first column names them, all others are numbers, aligned to the right
/// and never wrapped. A column in which no row has anything is left out.
pub(crate) fn figures(heads: &[&str], rows: &[Vec<String>]) -> Table {
    let used = |column: &usize| {
        *column == 0 || rows.iter().any(|r| r.get(*column).is_some_and(|cell| !cell.is_empty()))
    };
    let columns: Vec<usize> = (0..heads.len()).filter(used).collect();
    let mut table = table(columns.iter().map(|at| heads[*at]).collect::<Vec<_>>());
    for row in rows {
        table.add_row(columns.iter().map(|at| Cell::new(row.get(*at).map_or("", |c| c.as_str()))));
    }
    for at in 1..columns.len() {
        if let Some(column) = table.column_mut(at) {
            column.set_cell_alignment(CellAlignment::Right);
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widest(table: &Table) -> usize {
        table.to_string().lines().map(|line| line.chars().count()).max().unwrap_or(0)
    }

    #[test]
    fn a_table_is_no_wider_than_its_screen_and_its_numbers_stay_whole() {
        let long = "conventional cycle in a tension/compression holder with a long name of its own";
        let rows = vec![
            vec![long.to_owned(), "-13.913".into(), "1234.56".into()],
            vec!["clutch holder".into(), "+0.001".into(), "0.42".into()],
        ];
        for width in [60, 80, 100] {
            let mut table = figures(&["cycle", "depth error\nmm", "1σ\nµm"], &rows);
            table.set_width(width);
            assert!(widest(&table) <= usize::from(width), "{table}");
            assert!(table.to_string().contains("-13.913"), "{table}");
        }
    }

    #[test]
    fn a_column_in_which_nothing_stands_is_left_out() {
        let rows = vec![vec!["hole".to_owned(), String::new(), "3".into()]];
        let text = figures(&["feature", "class", "depth"], &rows).to_string();
        assert!(!text.contains("class") && text.contains("depth"), "{text}");
    }
}
