//! Writes CSV in which text cells cannot break out of their cell or be read as formulas.
//!
//! Spreadsheet programs evaluate a cell that begins with `=`, `+`, `-` or `@`, some also with their full-width forms or
//! with blanks before them. Such a text is prefixed with an apostrophe, which marks text there. A text that begins with an apostrophe gets another
//! one, so that different texts stay different. [Control characters](colltrans_mesh::plain) are escaped first, so that
//! none precedes such a sign.

use std::fmt::Write;

use colltrans_mesh::plain::escape_control;

/// Content of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cell<'a> {
    Number(f64),
    Text(&'a str),
}

/// A table under construction.
pub(crate) struct Table {
    text: String,
}

impl Table {
    /// Creates a table with a header line.
    pub(crate) fn new(heads: &[&str]) -> Self {
        let mut table = Self { text: String::new() };
        let heads: Vec<Cell> = heads.iter().map(|head| Cell::Text(head)).collect();
        table.push_row(&heads);
        table
    }

    /// Appends a line.
    pub(crate) fn push_row(&mut self, cells: &[Cell]) {
        for (k, cell) in cells.iter().enumerate() {
            if k > 0 {
                self.text.push(',');
            }
            match cell {
                Cell::Number(number) => {
                    let _ = write!(self.text, "{number}");
                }
                Cell::Text(text) => self.write_text_cell(text),
            }
        }
        self.text.push('\n');
    }

    /// Appends a text cell: escaped, quoted if it contains a separator or a quote.
    fn write_text_cell(&mut self, text: &str) {
        let text = escape_control(text);
        let starts_formula =
            text.trim_start().starts_with(['=', '+', '-', '@', '＝', '＋', '－', '＠']);
        let needs_mark = starts_formula || text.starts_with('\'');
        let prefix = if needs_mark { "'" } else { "" };
        if text.contains([',', '"', ';']) {
            let _ = write!(self.text, "\"{prefix}{}\"", text.replace('"', "\"\""));
        } else {
            let _ = write!(self.text, "{prefix}{text}");
        }
    }

    /// Returns the table as text.
    pub(crate) fn into_text(self) -> String {
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_formulas_and_control_characters_are_escaped() {
        let mut table = Table::new(&["a", "b"]);
        table.push_row(&[Cell::Text("=1+1"), Cell::Number(-0.5)]);
        table.push_row(&[Cell::Text("a,\"b\"\r\nc"), Cell::Text("\t@x")]);
        table.push_row(&[Cell::Text("\u{1b}[31m\u{9b}\u{7f}"), Cell::Text("@\u{200b}")]);
        table.push_row(&[Cell::Text("plain"), Cell::Text("-x")]);
        table.push_row(&[Cell::Text("'=1+1"), Cell::Text("＝1+1")]);
        table.push_row(&[Cell::Text("  =1+1"), Cell::Text("\u{3000}\u{a0}@x")]);
        table.push_row(&[Cell::Text(" '=1"), Cell::Text(" a=1")]);
        let expected = "a,b\n'=1+1,-0.5\n\"a,\"\"b\"\"\\r\\nc\",\\t@x\n\\u{1b}[31m\\u{9b}\\u{7f},'@\\u{200b}\nplain,'-x\n''=1+1,'＝1+1\n'  =1+1,'\u{3000}\u{a0}@x\n '=1, a=1\n";
        assert_eq!(table.into_text(), expected);
    }
}
