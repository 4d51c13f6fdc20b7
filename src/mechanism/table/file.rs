//! Tables in CSV files.

use std::fmt::Write as _;

use super::separated::{Separated, comma_hint};

/// Largest number of points: each costs several hundred bytes in every instance.
pub(in crate::mechanism) const MOST_POINTS: usize = 100_000;

/// CSV file beside the mechanism file; the FMU holds both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableFile {
    /// Name, without a folder.
    pub name: String,
    /// Content.
    pub text: String,
}

/// Fault of a CSV file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(in crate::mechanism) enum TableFileError {
    /// It has no rows of numbers.
    #[error("it has no numbers")]
    Empty,
    /// A row is too short.
    #[error("line {line} ends after {found} of {expected} columns")]
    Columns {
        /// The line, from 1.
        line: u64,
        /// Number of its columns.
        found: usize,
        /// Number of columns that it needs.
        expected: usize,
    },
    /// Something other than a finite number.
    #[error("line {line}: `{found}` is not a finite number{}", comma_hint(.found))]
    Number {
        /// The line, from 1.
        line: u64,
        /// Text in the place of the number.
        found: String,
    },
    /// More points than anyone needs.
    #[error("it has more than {most} points")]
    TooLong {
        /// Largest number of points.
        most: usize,
    },
    /// Two columns of one name that is asked for.
    #[error("it has two columns `{name}`: column {} and column {}", .places[0], .places[1])]
    Twice {
        /// Name asked for.
        name: String,
        /// Places of the first two, from 1.
        places: [usize; 2],
    },
    /// Abscissas of a grid do not rise.
    #[error("the {place} must rise; {next} comes after {before}")]
    Falls {
        /// First column or first row.
        place: &'static str,
        /// An abscissa.
        before: f64,
        /// The one after it, which is not larger.
        next: f64,
    },
    /// A grid of one row or one column.
    #[error("a grid has from two rows and two columns of values to {MOST_POINTS} values")]
    Small,
    /// No column of that name.
    #[error("{}", no_column(.name, .header))]
    Column {
        /// Name asked for.
        name: String,
        /// Names in the file.
        header: Vec<String>,
    },
}

fn no_column(name: &str, header: &[String]) -> String {
    if header
        .iter()
        .all(|known| known.replace(',', ".").parse::<f64>().is_ok())
    {
        return format!("it has no line of column names, so no column `{name}`");
    }
    let mut message = format!("it has no column `{name}`; its columns are");
    for (index, known) in header.iter().enumerate() {
        let _ = write!(message, "{} `{known}`", if index > 0 { "," } else { "" });
    }
    message
}

/// Row of two numbers, with its line.
pub(in crate::mechanism) type Row = (u64, [f64; 2]);

impl TableFile {
    /// Reads two columns: those called `columns`, or the first two.
    ///
    /// The first line that is no comment has the columns' names if `columns` asks for them, or if
    /// neither of its first two fields is a number.
    ///
    /// # Errors
    ///
    /// First fault of the file.
    pub(in crate::mechanism) fn rows(
        &self,
        columns: Option<[&str; 2]>,
    ) -> Result<Vec<Row>, TableFileError> {
        let separated = Separated::new(&self.text);
        let mut places = [0, 1];
        let mut rows = Vec::new();
        let mut header = Vec::new();
        for (index, (line, record)) in separated.rows().enumerate() {
            if index == 0 {
                let mut used = record.iter().take(2);
                if columns.is_some() || used.all(|field| separated.number(field).is_none()) {
                    header = record.iter().map(str::to_owned).collect();
                }
                if let Some(names) = columns {
                    places = find_columns(names, &header)?;
                }
                if !header.is_empty() {
                    continue;
                }
            }
            if rows.len() == MOST_POINTS {
                return Err(TableFileError::TooLong { most: MOST_POINTS });
            }
            let mut row = [0.0; 2];
            for (value, place) in row.iter_mut().zip(places) {
                let field = record.get(place).ok_or(TableFileError::Columns {
                    line,
                    found: record.len(),
                    expected: place + 1,
                })?;
                *value = separated
                    .number(field)
                    .ok_or_else(|| TableFileError::Number {
                        line,
                        found: field.to_owned(),
                    })?;
            }
            rows.push((line, row));
        }
        if rows.is_empty() {
            return Err(TableFileError::Empty);
        }
        Ok(rows)
    }

    /// Reads a grid: first abscissas down the first column, second ones along the first row, values
    /// between. The first cell counts for nothing.
    ///
    /// # Errors
    ///
    /// First fault of the file.
    pub(in crate::mechanism) fn grid(&self) -> Result<GridRows, TableFileError> {
        let separated = Separated::new(&self.text);
        let mut grid = GridRows::default();
        for (index, (line, record)) in separated.rows().enumerate() {
            let number = |field: &str| {
                let number = separated.number(field);
                number.ok_or_else(|| TableFileError::Number {
                    line,
                    found: field.to_owned(),
                })
            };
            if index == 0 {
                // A separator at the end of the line leaves an empty field.
                let fields: Vec<&str> = record.iter().skip(1).collect();
                let count = fields.iter().rposition(|field| !field.is_empty());
                let fields = &fields[..count.map_or(0, |last| last + 1)];
                let read: Result<Vec<f64>, _> = fields.iter().map(|field| number(field)).collect();
                grid.abscissas[1] = read?;
                continue;
            }
            let expected = grid.abscissas[1].len() + 1;
            if record.len() < expected {
                return Err(TableFileError::Columns {
                    line,
                    found: record.len(),
                    expected,
                });
            }
            if grid.values.len() + expected > MOST_POINTS {
                return Err(TableFileError::TooLong { most: MOST_POINTS });
            }
            let mut fields = record.iter().take(expected).map(number);
            grid.abscissas[0].extend(fields.next().transpose()?);
            for value in fields {
                grid.values.push(value?);
            }
        }
        if grid.abscissas.iter().any(|abscissas| abscissas.len() < 2) {
            return Err(TableFileError::Small);
        }
        for (place, abscissas) in ["first column", "first row"]
            .into_iter()
            .zip(&grid.abscissas)
        {
            if let Some(pair) = abscissas.windows(2).find(|pair| pair[0] >= pair[1]) {
                let [before, next] = [pair[0], pair[1]];
                return Err(TableFileError::Falls {
                    place,
                    before,
                    next,
                });
            }
        }
        Ok(grid)
    }
}

/// Values of a grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::mechanism) struct GridRows {
    /// First and second abscissas.
    pub(in crate::mechanism) abscissas: [Vec<f64>; 2],
    /// By rows of one first abscissa.
    pub(in crate::mechanism) values: Vec<f64>,
}

fn find_columns(names: [&str; 2], header: &[String]) -> Result<[usize; 2], TableFileError> {
    let mut places = [0; 2];
    for (place, name) in places.iter_mut().zip(names) {
        let all = header.iter().enumerate();
        let mut found = all.filter(|(_, known)| *known == name).map(|(at, _)| at);
        *place = found.next().ok_or_else(|| TableFileError::Column {
            name: name.to_owned(),
            header: header.to_vec(),
        })?;
        if let Some(second) = found.next() {
            return Err(TableFileError::Twice {
                name: name.to_owned(),
                places: [*place + 1, second + 1],
            });
        }
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_points_are_refused() {
        let text: String = (0..=MOST_POINTS).map(|k| format!("{k},0\n")).collect();
        let error = rows(&text, None).expect_err("one too many");
        assert_eq!(error, TableFileError::TooLong { most: MOST_POINTS });
    }

    fn rows(text: &str, columns: Option<[&str; 2]>) -> Result<Vec<Row>, TableFileError> {
        let file = TableFile {
            name: "table.csv".to_owned(),
            text: text.to_owned(),
        };
        file.rows(columns)
    }

    #[test]
    fn usual_files_are_read() {
        let expected = vec![[0.0, 1.0], [0.5, -2e-3]];
        for text in [
            "0,1\n0.5,-2e-3\n",
            "\u{feff}0,1\r\n0.5,-2e-3",
            "# comment\ntime,value\n0, 1\n\n 0.5 ,-2e-3,9\n",
            "t;u\n0;1\n# between\n0.5;-2e-3\n",
            "0\t1\n0.5\t-2e-3\n",
            "\"t\",\"u\"\n\"0\",1\n0.5,\"-2e-3\"\n",
            "0,1,\n0.5,-2e-3,\n",
            "0,1,start\n0.5,-2e-3,end\n",
            "  0   1\n# between\n0.5\t-2e-3\n",
            "time angle\n0 1\n0.5 -2e-3\n",
            "0,1\n   \n0.5,-2e-3\n# end",
            // As a German Excel writes them.
            "Zeit;Winkel\r\n0;1\r\n0,5;-2e-3\r\n",
            "\u{feff}sep=;\r\nZeit;Winkel\r\n0;1\r\n0,5;-0,002\r\n",
            "0,0\t1\n0,5\t-0,002\n",
            "SEP=,\n0,1\n0.5,-2e-3\n",
            "0 1\n0.5 -2e-3\n# end",
        ] {
            let read = rows(text, None).expect(text);
            let numbers: Vec<_> = read.into_iter().map(|(_, row)| row).collect();
            assert_eq!(numbers, expected, "{text}");
        }
    }

    #[test]
    fn columns_are_found_by_name() {
        let text = "angle,time,force\n1,0,7\n2,1,8\n";
        let read = rows(text, Some(["time", "angle"])).expect("both are there");
        assert_eq!(read, [(2, [0.0, 1.0]), (3, [1.0, 2.0])]);
        let error = rows(text, Some(["time", "anlge"])).expect_err("misspelt");
        assert_eq!(
            error.to_string(),
            "it has no column `anlge`; its columns are `angle`, `time`, `force`"
        );
        let error = rows("u,t,u\n0,1,2\n", Some(["t", "u"])).expect_err("which one?");
        assert_eq!(
            error.to_string(),
            "it has two columns `u`: column 1 and column 3"
        );
        // A name that nobody asks for may be there twice.
        let numbers: Vec<_> = read.into_iter().map(|(_, row)| row).collect();
        for (text, columns) in [
            ("t,u,x,x\n0,1,7,7\n1,2,8,8\n", Some(["t", "u"])),
            ("t,t\n0,1\n1,2\n", None),
        ] {
            let read = rows(text, columns).expect(text);
            let found: Vec<_> = read.into_iter().map(|(_, row)| row).collect();
            assert_eq!(found, numbers, "{text}");
        }
        let error = rows("0,1\n", Some(["t", "u"])).expect_err("no names");
        assert_eq!(
            error.to_string(),
            "it has no line of column names, so no column `t`"
        );
    }

    #[test]
    fn grids_are_read_by_rows() {
        let file = |text: &str| TableFile {
            name: "map.csv".to_owned(),
            text: text.to_owned(),
        };
        let expected = GridRows {
            abscissas: [vec![0.0, 1.0], vec![-1.0, 0.5, 2.0]],
            values: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.5],
        };
        for text in [
            "speed,-1,0.5,2\n0,1,2,3\n1,4,5,6.5\n",
            ";-1;0,5;2;\n0;1;2;3;\n# between\n1;4;5;6,5;\n",
            "0\t-1\t0.5\t2\n0\t1\t2\t3\n1\t4\t5\t6.5\n",
        ] {
            assert_eq!(file(text).grid().expect(text), expected, "{text}");
        }
        for (text, message) in [
            (
                "x,0\n0,1\n1,2\n",
                "a grid has from two rows and two columns of values to 100000 values",
            ),
            ("x,0,1\n0,1\n1,2,3\n", "line 2 ends after 2 of 3 columns"),
            (
                "x,0,1\n0,1,a\n1,2,3\n",
                "line 2: `a` is not a finite number",
            ),
            (
                "x,0,0\n0,1,1\n1,2,3\n",
                "the first row must rise; 0 comes after 0",
            ),
            (
                "x,0,1\n0,1,1\n-1,2,3\n",
                "the first column must rise; -1 comes after 0",
            ),
        ] {
            assert_eq!(file(text).grid().expect_err(text).to_string(), message);
        }
    }

    #[test]
    fn what_is_wrong_has_its_line() {
        for (text, message) in [
            ("", "it has no numbers"),
            ("t,u\n# nothing\n", "it has no numbers"),
            ("t,u\n0,1\n\n1,x\n", "line 4: `x` is not a finite number"),
            ("0,1\n1,inf\n", "line 2: `inf` is not a finite number"),
            ("0,1\n1\n", "line 2 ends after 1 of 2 columns"),
            ("0,x\n1,2\n", "line 1: `x` is not a finite number"),
            (
                "t,u\n0,\"0,5\"\n",
                "line 2: `0,5` is not a finite number; decimals stand after a point",
            ),
            (
                "sep=;\nt;u\n0;1.000,5\n",
                "line 3: `1.000,5` is not a finite number; digits are not grouped",
            ),
        ] {
            assert_eq!(rows(text, None).expect_err(text).to_string(), message);
        }
    }
}
