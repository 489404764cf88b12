//! CSV: cells that are text cannot leave their cell, nor be taken for formulas.
//!
//! Programs that show tables compute a cell that begins with `=`, `+`, `-` or `@`, also behind a tab or
//! a line's end. Such a text gets an apostrophe before it, which they take for "text follows". What
//! [steers](colltrans_mesh::plain) is written out.

use std::fmt::Write;

use colltrans_mesh::plain::shown;

/// What a cell holds.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cell<'a> {
    Number(f64),
    Text(&'a str),
}

/// A table in the making.
pub(crate) struct Table {
    text: String,
}

impl Table {
    pub(crate) fn new(heads: &[&str]) -> Self {
        let mut table = Self { text: String::new() };
        let heads: Vec<Cell> = heads.iter().map(|head| Cell::Text(head)).collect();
        table.row(&heads);
        table
    }

    pub(crate) fn row(&mut self, cells: &[Cell]) {
        for (k, cell) in cells.iter().enumerate() {
            if k > 0 {
                self.text.push(',');
            }
            match cell {
                Cell::Number(number) => {
                    let _ = write!(self.text, "{number}");
                }
                Cell::Text(text) => self.cell(text),
            }
        }
        self.text.push('\n');
    }

    fn cell(&mut self, text: &str) {
        let text = shown(text);
        let is_formula = text.starts_with(['=', '+', '-', '@']);
        let mark = if is_formula { "'" } else { "" };
        if text.contains([',', '"', ';']) {
            let _ = write!(self.text, "\"{mark}{}\"", text.replace('"', "\"\""));
        } else {
            let _ = write!(self.text, "{mark}{text}");
        }
    }

    pub(crate) fn finish(self) -> String {
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_stay_texts_and_in_their_cells() {
        let mut table = Table::new(&["a", "b"]);
        table.row(&[Cell::Text("=1+1"), Cell::Number(-0.5)]);
        table.row(&[Cell::Text("a,\"b\"\r\nc"), Cell::Text("\t@x")]);
        table.row(&[Cell::Text("\u{1b}[31m\u{9b}\u{7f}"), Cell::Text("@\u{200b}")]);
        table.row(&[Cell::Text("plain"), Cell::Text("-x")]);
        let wanted = "a,b\n'=1+1,-0.5\n\"a,\"\"b\"\"\\r\\nc\",\\t@x\n\\u{1b}[31m\\u{9b}\\u{7f},'@\\u{200b}\nplain,'-x\n";
        assert_eq!(table.finish(), wanted);
    }
}
