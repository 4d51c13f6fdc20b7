//! Tables of points: in the mechanism file, or in a CSV file beside it.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::{quoted, shown};
use crate::mechanism::syntax::Value;
use crate::mechanism::table::MOST_POINTS;
use crate::mechanism::{Expression, Span, Table, TableFile};

use super::context::{Context, Fields};

/// The keys with which a table is given.
pub(super) const TABLE_KEYS: [&str; 4] = ["table", "file", "columns", "scale"];

/// A table with its values for the file's parameters.
pub(super) struct KnownTable {
    pub(super) table: Table,
    /// One a point: where it stands, and its numbers in SI units if they are known.
    points: Vec<KnownPoint>,
}

struct KnownPoint {
    span: Span,
    /// The line in a CSV file.
    line: Option<u64>,
    values: Option<[f64; 2]>,
}

impl<'a> Context<'a> {
    /// The points under `table`, or of the CSV file under `file`; `form` shows a point.
    ///
    /// Their abscissas rise with the file's parameters.
    pub(super) fn table(&mut self, fields: &Fields<'a>, form: &str) -> Option<KnownTable> {
        let known = match (fields.get("table"), fields.get("file")) {
            (Some(table), None) => {
                if let Some(span) = fields.key_span("columns") {
                    self.error_with_help(
                        code::UNKNOWN_KEY,
                        span,
                        format!("{} has `columns`, but no `file`", fields.subject),
                        "`columns` chooses among the columns of a CSV file".to_owned(),
                    );
                }
                let points = self.points(table, form);
                self.scaled(fields, points?)
            }
            (None, Some(file)) => {
                let points = self.points_of_file(fields, file);
                self.scaled(fields, points?)
            }
            (table, file) => {
                let (place, has) = if table.and(file).is_some() {
                    (fields.key_span("file")?, "both `table` and `file`")
                } else {
                    (fields.place.clone(), "neither `table` nor `file`")
                };
                self.error_with_help(
                    code::BAD_TABLE,
                    place,
                    format!("{} has {has}", fields.subject),
                    format!(
                        "give points, `table = [{form}, …]`, or a CSV file, `file = \"a.csv\"`"
                    ),
                );
                None
            }
        }?;
        self.check_rising(&known)?;
        Some(known)
    }

    fn points(&mut self, value: &'a Value<'a>, form: &str) -> Option<Vec<Point>> {
        let items = self.items(value, &format!("an array of points {form}"))?;
        let count = items.len();
        if !(2..=MOST_POINTS).contains(&count) {
            let message = format!("a table has from two to {MOST_POINTS} points, this one {count}");
            self.error(code::BAD_TABLE, value.span(), message);
            return None;
        }
        let point_form = format!("an array {form}");
        // All are read, so that each says what is wrong with it.
        let points: Vec<_> = items
            .iter()
            .map(|item| {
                let [x, y] = self.quantities::<2>(item, &point_form)?;
                Some(Point {
                    span: item.span(),
                    line: None,
                    values: x.value.zip(y.value).map(|(x, y)| [x, y]),
                    expressions: [x.expression, y.expression],
                })
            })
            .collect();
        points.into_iter().collect()
    }

    fn points_of_file(&mut self, fields: &Fields<'a>, value: &'a Value<'a>) -> Option<Vec<Point>> {
        let columns = match fields.get("columns") {
            Some(columns) => Some(self.column_names(columns)?),
            None => None,
        };
        let name = self.text(value)?;
        let file = self.table_file(value, name)?;
        let rows = match self.table_files[file].rows(columns) {
            Ok(rows) => rows,
            Err(error) => {
                let message = format!("in the file {}: {error}", quoted(name));
                self.error(code::TABLE_FILE, value.span(), message);
                return None;
            }
        };
        if rows.len() < 2 {
            let message = format!(
                "the file {} has one point, a table two at least",
                quoted(name)
            );
            self.error(code::BAD_TABLE, value.span(), message);
            return None;
        }
        // The shortest digits that give the same numbers back.
        let numbers: Vec<_> = rows.iter().map(|(_, row)| row).collect();
        let _ = write!(self.file_tables, "{numbers:?}");
        let points = rows.into_iter().map(|(line, row)| Point {
            span: value.span(),
            line: Some(line),
            values: Some(row),
            expressions: row.map(Expression::constant),
        });
        Some(points.collect())
    }

    fn column_names(&mut self, value: &'a Value<'a>) -> Option<[&'a str; 2]> {
        let items = self.items_of(value, 2..=2, "an array of two column names")?;
        let names: Vec<Option<&str>> = items.iter().map(|item| self.text(item)).collect();
        Some([*names.first()?, *names.get(1)?].map(|name| name.unwrap_or_default()))
    }

    /// The file of that name beside the mechanism file, read once: its place among those read.
    fn table_file(&mut self, value: &'a Value<'a>, name: &'a str) -> Option<usize> {
        let mut known = self.table_files.iter();
        if let Some(place) = known.position(|file| file.name == name) {
            return Some(place);
        }
        // Together in a folder they have to differ on systems that take A for a.
        let lower_case = name.to_lowercase();
        let mut others = self.table_files.iter().map(|file| file.name.as_str());
        let message = if lower_case.ends_with(".toml") {
            format!(
                "{} has the name of a mechanism, not of a table",
                quoted(name)
            )
        } else if let Some(other) = others.find(|other| other.to_lowercase() == lower_case) {
            format!(
                "{} and {} are one file on some systems",
                quoted(name),
                quoted(other)
            )
        } else {
            match self.source.read_beside(name) {
                Ok(text) => {
                    self.table_files.push(TableFile {
                        name: name.to_owned(),
                        text,
                    });
                    return Some(self.table_files.len() - 1);
                }
                Err(error) => format!("cannot read the file {}: {error}", quoted(name)),
            }
        };
        self.error(code::TABLE_FILE, value.span(), message);
        None
    }

    /// Brings points to SI units.
    fn scaled(&mut self, fields: &Fields<'a>, points: Vec<Point>) -> Option<KnownTable> {
        let one = || Expression::constant(1.0);
        let (scale, factors) = match fields.get("scale") {
            None => ([one(), one()], Some([1.0, 1.0])),
            Some(value) => {
                let [across, up] = self.quantities::<2>(value, "an array of two factors")?;
                if across.value.is_some_and(|factor| factor <= 0.0) {
                    self.check_positive(&across, "the factor of the first column");
                    return None;
                }
                let factors = across.value.zip(up.value).map(|(x, y)| [x, y]);
                ([across.expression, up.expression], factors)
            }
        };
        let (expressions, known) = points
            .into_iter()
            .map(|point| {
                let values = point.values.zip(factors);
                let known = KnownPoint {
                    span: point.span,
                    line: point.line,
                    values: values.map(|([x, y], [across, up])| [x * across, y * up]),
                };
                (point.expressions, known)
            })
            .unzip();
        Some(KnownTable {
            table: Table {
                points: expressions,
                scale,
            },
            points: known,
        })
    }

    fn check_rising(&mut self, known: &KnownTable) -> Option<()> {
        for pair in known.points.windows(2) {
            let (Some([before, _]), Some([x, _])) = (pair[0].values, pair[1].values) else {
                continue;
            };
            if before >= x {
                let at = &pair[1];
                let message = format!(
                    "the first column of a table must rise; {}{} comes after {}",
                    at.place(),
                    shown(x),
                    shown(before)
                );
                self.error(code::BAD_TABLE, at.span.clone(), message);
                return None;
            }
        }
        Some(())
    }

    /// The first point whose ordinate is not positive is an error.
    pub(super) fn check_ordinates_positive(
        &mut self,
        known: &KnownTable,
        what: &str,
    ) -> Option<()> {
        for point in &known.points {
            if let Some([_, y]) = point.values.filter(|[_, y]| *y <= 0.0) {
                let message = format!(
                    "{what} must be positive; {}it is {}",
                    point.place(),
                    shown(y)
                );
                self.error(code::ILLEGAL_VALUE, point.span.clone(), message);
                return None;
            }
        }
        Some(())
    }

    /// Makes the table of a closed curve go once round: a last point that repeats the first a
    /// turn later, with the same number or expression, is left out; any other there is an error.
    pub(super) fn close_turn(&mut self, known: &mut KnownTable) -> Option<()> {
        // Angles written in degrees come back to within some ulp of a turn.
        const ROUNDING: f64 = 1e-12;
        let values = |point: Option<&KnownPoint>| point.and_then(|point| point.values);
        let ends = (values(known.points.first()), values(known.points.last()));
        let ordinates = |point: Option<&[Expression; 2]>| point.map(|[_, y]| y.clone());
        let points = &known.table.points;
        let same = ordinates(points.first()) == ordinates(points.last());
        if let (Some([start, _]), Some([end, _])) = ends {
            let excess = end - start - TAU;
            if excess.abs() <= ROUNDING && same {
                known.points.pop();
                known.table.points.pop();
            } else if excess >= -ROUNDING {
                let at = known.points.last()?;
                let message = format!(
                    "{}the last point, at {} deg, is not within the turn that starts at {} deg",
                    at.place(),
                    shown(end.to_degrees()),
                    shown(start.to_degrees())
                );
                let help = "angles go once round: the last point is joined to the first, and only \
                            that one may be repeated"
                    .to_owned();
                self.error_with_help(code::BAD_TABLE, at.span.clone(), message, help);
                return None;
            }
        }
        Some(())
    }
}

impl KnownTable {
    /// How many points it has.
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }
}

impl KnownPoint {
    /// The line of a CSV file, for messages.
    fn place(&self) -> String {
        self.line
            .map_or_else(String::new, |line| format!("in line {line} of the file "))
    }
}

/// A point as it is read.
struct Point {
    span: Span,
    line: Option<u64>,
    values: Option<[f64; 2]>,
    expressions: [Expression; 2],
}
