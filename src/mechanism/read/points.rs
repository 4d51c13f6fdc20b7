//! Tables of points: in the mechanism file, or in a CSV file beside it.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::table::MOST_POINTS;
use crate::mechanism::wording::{quoted, shown, shown_apart};
use crate::mechanism::{Expression, Span, Table, TableFile};

use super::context::Context;
use super::kind::{Array, ExternalName, Item, Kind, schema};
use super::number::{Limit, NUMBER, Number, Quantity};
use super::table::table;
use super::unit::Factor;

table! {
    /// Points of a motion, of a contour or of a curve.
    #[one_of(
        table,
        file,
        code::BAD_TABLE,
        "give points, `table = [[0, 0], [1, 2]]`, or a CSV file, `file = \"a.csv\"`"
    )]
    struct PointKeys<'a> {
        /// Points: time [s] and value [m or rad] of a motion, polar angle [rad] and radius [m] of
        /// a contour.
        table: Vec<Point> = Points,
        /// Name of a CSV file beside this one, with the points.
        file: &'a str = ExternalName,
        /// Names of the file's two columns; its first two if left out.
        columns: [&'a str; 2] = Array::new("[\"x\", \"y\"]", [ExternalName, ExternalName]),
        /// Factors of the two columns: numbers, or the units in which they are, such as "bar".
        scale: [Quantity; 2] = FACTORS,
    }
}

const POINT: Array<Number, 2> = Array::new("[x, y]", [NUMBER; 2]);
const FACTORS: Array<Factor, 2> = Array::new("[1, \"deg\"]", [const { Factor }; 2]);

/// Array of points.
struct Points;

/// Point as it is read: its place, its line in a CSV file, and its coordinates.
type Point = (Span, Option<u64>, [Expression; 2]);

/// Table of points with their values for the file's parameters.
pub(super) struct PointTable {
    pub(super) table: Table,
    /// Place of each point, and its line in a CSV file.
    places: Vec<(Span, Option<u64>)>,
    /// Points in SI units; none if a parameter has no value.
    values: Vec<[f64; 2]>,
    has_scale: bool,
}

impl PointTable {
    fn span(&self, at: usize) -> Span {
        self.places[at].0.clone()
    }

    /// Returns the line of a point in a CSV file, for messages.
    fn line(&self, at: usize) -> String {
        let line = |line| format!("in line {line} of the file ");
        self.places[at].1.map_or_else(String::new, line)
    }
}

impl<'a> Kind<'a> for Points {
    type Value = Vec<Point>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<Point>> {
        let items = context.items(item.value, "an array of points `[x, y]`")?;
        let count = items.len();
        if !(2..=MOST_POINTS).contains(&count) {
            let message = format!("a table has from two to {MOST_POINTS} points, this one {count}");
            context.error(code::BAD_TABLE, item.span(), message);
            return None;
        }
        let mut read = |value| {
            let point = POINT.read(context, &item.with(value))?;
            Some((value.span(), None, point.map(|q| q.expression)))
        };
        // Each is read, so that each wrong one is reported.
        let points: Vec<Option<Point>> = items.iter().map(&mut read).collect();
        points.into_iter().collect()
    }

    schema! {{ "type": "array", "items": POINT.schema(), "minItems": 2 }}
}

impl<'a> Context<'a> {
    /// Reports points, or the name of a file, that stand alone where a table has to name them;
    /// returns whether they do.
    pub(super) fn is_points_alone(
        &mut self,
        item: &Item<'_, 'a>,
        noun: &str,
        expected: &str,
    ) -> bool {
        let what = match item.value.get_ref() {
            DeValue::Array(_) => "an array of points",
            DeValue::String(text) if text.ends_with(".csv") => "the name of a file",
            _ => return false,
        };
        let message = format!("{what} is no {noun} by itself");
        self.error(code::WRONG_TYPE, item.span(), message)
            .suggest(expected);
        true
    }

    /// Reads the points under `table`, or of the CSV file under `file`, whose abscissas rise with
    /// the file's parameters.
    pub(super) fn points(&mut self, keys: PointKeys<'a>) -> Option<PointTable> {
        let table = self.any_points(keys)?;
        let falls = |pair: &[[f64; 2]]| pair[0][0] >= pair[1][0];
        if let Some(at) = table.values.windows(2).position(falls) {
            let [before, x] =
                shown_apart(self.written(&table, at, 0), self.written(&table, at + 1, 0));
            let line = table.line(at + 1);
            let message =
                format!("the first column of a table must rise; {line}{x} comes after {before}");
            self.error(code::BAD_TABLE, table.span(at + 1), message);
            return None;
        }
        Some(table)
    }

    /// Reads points of the plane that no parameter moves.
    pub(super) fn fixed_points(&mut self, keys: PointKeys<'a>) -> Option<Vec<[f64; 2]>> {
        let place = keys.owner.place.clone();
        let points = self.any_points(keys)?;
        if points.table.parameters().next().is_some() {
            let message = "the points of a curve are numbers, without parameters";
            self.error(code::BAD_TABLE, place, message)
                .suggest("`x` and `y` may use parameters: expressions in `s`");
            return None;
        }
        Some(points.values)
    }

    /// Reads points of the plane from the CSV file called `name`.
    pub(super) fn points_called(&mut self, name: &str, span: &Span) -> Option<Vec<[f64; 2]>> {
        let points = self.points_of_file(name, span, None)?;
        let number = |e: Expression| e.literal();
        let points = points.into_iter();
        points
            .map(|(.., [x, y])| Some([number(x)?, number(y)?]))
            .collect()
    }

    /// Reads the points under `table`, or of the CSV file under `file`, in any order.
    fn any_points(&mut self, keys: PointKeys<'a>) -> Option<PointTable> {
        if let (Some(span), None) = (keys.columns.key.clone(), &keys.file.key) {
            let message = format!("{} has `columns`, but no `file`", keys.owner.subject);
            self.error(code::UNKNOWN_KEY, span, message)
                .suggest("`columns` chooses among the columns of a CSV file");
        }
        let points = match (&keys.table.key, &keys.file.key) {
            (None, Some(_)) => {
                let columns = keys.columns.optional()?;
                self.points_of_file(keys.file.value?, &keys.file.span, columns)
            }
            (Some(_), None) => keys.table.value,
            // Both or neither has been reported.
            _ => None,
        }?;
        let has_scale = keys.scale.key.is_some();
        let scale = match keys.scale.optional()? {
            None => [1.0, 1.0].map(Expression::constant),
            Some(scale) => {
                let subject = "the factor of the first column";
                self.check_limit(Limit::Positive, &scale[0], subject)?;
                scale.map(|factor| factor.expression)
            }
        };
        let (places, points) = points
            .into_iter()
            .map(|(span, line, point)| ((span, line), point))
            .unzip();
        let table = Table { points, scale };
        let mut values = Vec::new();
        if self.knows(table.parameters()) {
            let (mut x, mut y) = (vec![0.0; table.points.len()], vec![0.0; table.points.len()]);
            table.write(&|id| self.known_value(id), &mut x, &mut y);
            values = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
        }
        Some(PointTable {
            table,
            places,
            values,
            has_scale,
        })
    }

    fn points_of_file(
        &mut self,
        name: &str,
        span: &Span,
        columns: Option<[&str; 2]>,
    ) -> Option<Vec<Point>> {
        let file = self.table_file(name, span)?;
        let (code, message) = match self.table_files[file].rows(columns) {
            Ok(rows) if rows.len() >= 2 => {
                // The shortest digits that give the same numbers back.
                let numbers: Vec<_> = rows.iter().map(|(_, row)| row).collect();
                let _ = write!(self.file_tables, "{numbers:?}");
                let point = |(line, row): (u64, [f64; 2])| {
                    (span.clone(), Some(line), row.map(Expression::constant))
                };
                return Some(rows.into_iter().map(point).collect());
            }
            Ok(_) => (
                code::BAD_TABLE,
                format!(
                    "the file {} has one point, a table two at least",
                    quoted(name)
                ),
            ),
            Err(error) => (
                code::TABLE_FILE,
                format!("in the file {}: {error}", quoted(name)),
            ),
        };
        self.error(code, span.clone(), message);
        None
    }

    /// Reads the abscissas and the values of a grid from the CSV file called `name`.
    pub(super) fn grid_of_file(
        &mut self,
        name: &str,
        span: &Span,
    ) -> Option<([Vec<f64>; 2], Vec<f64>)> {
        let file = self.table_file(name, span)?;
        match self.table_files[file].grid() {
            Ok(grid) => {
                let _ = write!(self.file_tables, "{:?}{:?}", grid.abscissas, grid.values);
                Some((grid.abscissas, grid.values))
            }
            Err(error) => {
                let message = format!("in the file {}: {error}", quoted(name));
                self.error(code::TABLE_FILE, span.clone(), message);
                None
            }
        }
    }

    /// Returns the place among the files read of the one called `name`; reads it if it is new.
    fn table_file(&mut self, name: &str, span: &Span) -> Option<usize> {
        let mut known = self.table_files.iter();
        if let Some(place) = known.position(|file| file.name == name) {
            return Some(place);
        }
        // Together in a folder they have to differ on systems that take A for a.
        let lower_case = name.to_lowercase();
        let mut others = self.table_files.iter().map(|file| file.name.as_str());
        let file = quoted(name);
        let message = if lower_case.ends_with(".toml") {
            format!("{file} has the name of a mechanism, not of a table")
        } else if let Some(other) = others.find(|other| other.to_lowercase() == lower_case) {
            let other = quoted(other);
            format!("{file} and {other} are one file on some systems")
        } else {
            match self.source.read_beside(name) {
                Ok(text) => {
                    self.table_files.push(TableFile {
                        name: name.to_owned(),
                        text,
                    });
                    return Some(self.table_files.len() - 1);
                }
                Err(error) => format!("cannot read the file {file}: {error}"),
            }
        };
        self.error(code::TABLE_FILE, span.clone(), message);
        None
    }

    /// Returns a column of a point as the file has it, before it is multiplied by its factor.
    fn written(&self, table: &PointTable, at: usize, column: usize) -> f64 {
        let number = &table.table.points[at][column];
        number.evaluate(&|id| self.known_value(id), 0.0)
    }

    /// Warns of ordinates, angles of plain numbers, that look like degrees.
    pub(super) fn warn_of_ordinates(&mut self, table: &PointTable) {
        let points = table.table.points.iter();
        let angles: Option<Vec<f64>> = points.map(|[_, y]| y.literal()).collect();
        let angles = angles.filter(|_| !table.has_scale).unwrap_or_default();
        let largest = angles.iter().enumerate();
        let largest = largest.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
        if let Some((at, _)) = largest {
            self.warn_of_angles(&table.span(at), &angles);
        }
    }

    /// Reports the first point whose ordinate is not positive.
    pub(super) fn check_ordinates_positive(
        &mut self,
        table: &PointTable,
        subject: &str,
    ) -> Option<()> {
        let Some(at) = table.values.iter().position(|[_, y]| *y <= 0.0) else {
            return Some(());
        };
        let (line, value) = (table.line(at), shown(self.written(table, at, 1)));
        let message = format!("{subject} must be positive; {line}it is {value}");
        self.error(code::ILLEGAL_VALUE, table.span(at), message);
        None
    }

    /// Makes a table of polar angles go once round: a last point that repeats the first a turn
    /// later, with the same number or expression, is left out; any other there is an error.
    pub(super) fn close_turn(&mut self, table: &mut PointTable) -> Option<()> {
        // Angles written in degrees come back to within some ulp of a turn.
        const OFF_TURN: f64 = 1e-12;
        let (Some([start, _]), Some([end, _])) = (table.values.first(), table.values.last()) else {
            return Some(());
        };
        let excess = end - start - TAU;
        let points = &mut table.table.points;
        let is_repeated =
            points.first().map(|point| &point[1]) == points.last().map(|point| &point[1]);
        if excess.abs() <= OFF_TURN && is_repeated {
            points.pop();
            table.places.pop();
            table.values.pop();
        } else if excess >= -OFF_TURN {
            let [start, end] = shown_apart(start.to_degrees(), end.to_degrees());
            let last = table.places.len() - 1;
            let message = format!(
                "{}the last point, at {end} deg, is not within the turn that starts at {start} deg",
                table.line(last)
            );
            let help = if table.has_scale {
                "angles go once round: the last point is joined to the first, and only that \
                     one may be repeated"
            } else {
                "angles go once round, in radians: degrees have `scale = [\"deg\", 1]`"
            };
            self.error(code::BAD_TABLE, table.span(last), message)
                .suggest(help);
            return None;
        }
        Some(())
    }
}
