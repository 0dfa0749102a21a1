//! Tables on a terminal: a line above, one below the header, one at the end; no ink between rows.
use comfy_table::{LineStyle, Row, Table, TableStyle};

/// An empty table with these heads.
pub(crate) fn table(heads: impl Into<Row>) -> Table {
    let line = LineStyle::none().fill('─').junction('─');
    let style = TableStyle::new().top_border(line).header_separator(line).bottom_border(line);
    let mut table = Table::new();
    table.load_style(style).set_header(heads);
    table
}
