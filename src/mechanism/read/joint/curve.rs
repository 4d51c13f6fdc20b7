//! `curve`: a point on a curve of another body.

use crate::mechanism::diagnostic::code;
use crate::mechanism::read::context::Context;
use crate::mechanism::read::kind::Described;
use crate::mechanism::read::kind::{Flag, Item, Kind, schema};
use crate::mechanism::read::number::{Formula, LENGTH, NUMBER, Quantity};
use crate::mechanism::read::points::PointKeys;
use crate::mechanism::{
    Curve, CurveShape, Expression, JointKind, PointPath, Span, Variable, shown,
};

use super::joint_type;

joint_type! {
    "curve" or "path"
        or "track" as "type = \"curve\", points = \"track.csv\""
        or "groove" as "type = \"curve\", points = \"groove.csv\", closed = true"
        or "point_on_curve" as "type = \"curve\", x = \"0.5*s\", y = \"0.1*cos(pi*s)\""
        => |keys, context| context.curve(keys);

    /// The point of marker j stays on a curve in the frame of marker i.
    #[one_of(points, x, code::BAD_TABLE, "a curve is `points = \"track.csv\"`, or `x` and `y` as expressions in `s`")]
    struct CurveKeys<'a> {
        /// Points of a spline: the name of a CSV file, or a table.
        points: Vec<[f64; 2]> = PathPoints,
        /// x of the curve [m], an expression in s.
        x: Quantity = Formula(&[Variable::CurveParameter]),
        /// y of the curve [m], an expression in s.
        y: Quantity = Formula(&[Variable::CurveParameter]),
        /// s at the first point; 0 if left out.
        from: Quantity = NUMBER,
        /// s at the last point; 1 if left out.
        to: Quantity = NUMBER,
        /// Whether the ends are one point.
        closed: bool = Flag,
        /// Distance of the parallel curve that the point follows, to the left of the curve.
        offset: Quantity = LENGTH,
        /// Whether the x-axis of j keeps the direction of the curve.
        follow: bool = Flag,
    }
}

/// Points of a curve: a table of [`PointKeys`], or the name of a file.
struct PathPoints;

impl<'a> Kind<'a> for PathPoints {
    type Value = Vec<[f64; 2]>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<[f64; 2]>> {
        if let Some(name) = item.value.get_ref().as_str() {
            return context.points_called(name, &item.span());
        }
        if item.value.get_ref().is_array() {
            let expected =
                "expected `points = { table = [[0, 0], [0.1, 0.1]] }` or `points = \"track.csv\"`";
            context.is_points_alone(item, "curve", expected);
            return None;
        }
        let fields = context.fields(item.span(), item.value, "the points".to_owned())?;
        let keys = context.table::<PointKeys<'a>>(&fields);
        context.fixed_points(keys)
    }

    schema! {{ "anyOf": [{ "type": "string" }, PointKeys::schema()] }}
}

/// Samples of a curve that is checked.
const SAMPLES: u32 = 1000;
/// Part of a curve's length by which ends that are one point may differ.
const CLOSED: f64 = 1e-9;

impl<'a> Context<'a> {
    fn curve(&mut self, keys: CurveKeys<'a>) -> Option<JointKind> {
        let place = keys.owner.place.clone();
        let closed = keys.closed.or(false);
        let follow = keys.follow.or(false);
        let offset = keys.offset.optional();
        let shape = match (&keys.points.key, &keys.x.key) {
            (Some(_), None) => {
                for key in [&keys.y.key, &keys.from.key, &keys.to.key]
                    .into_iter()
                    .flatten()
                {
                    let message =
                        format!("{} has `points`, which are its curve", keys.owner.subject);
                    self.error(code::UNKNOWN_KEY, key.clone(), message)
                        .suggest("only a curve of `x` and `y` has these keys");
                }
                let path = PointPath::new(&keys.points.value?, closed?);
                if path.is_none() {
                    let message = "a curve has two points at least, a closed one three, and no point \
                                   right after itself";
                    self.error(code::BAD_TABLE, keys.points.span.clone(), message);
                }
                CurveShape::Points(path?)
            }
            (None, Some(_)) => {
                if keys.y.key.is_none() {
                    self.missing_key(&keys.owner, "y", "\"0.1*sin(s)\"");
                }
                let ends = [keys.from.number_or(0.0)?, keys.to.number_or(1.0)?];
                if ends[1] - ends[0] == 0.0 {
                    let message = "the ends of a curve, `from` and `to`, are one";
                    self.error(code::ILLEGAL_VALUE, keys.to.span.clone(), message);
                    return None;
                }
                let end = |field: Option<Option<Quantity>>, default| {
                    let quantity = field?;
                    Some(quantity.map_or(Expression::constant(default), |q| q.expression))
                };
                CurveShape::Formula {
                    ends: [
                        end(keys.from.optional(), 0.0)?,
                        end(keys.to.optional(), 1.0)?,
                    ],
                    x: keys.x.expression()?,
                    y: keys.y.expression()?,
                }
            }
            // Both or neither has been reported.
            _ => return None,
        };
        let curve = Curve {
            shape,
            closed: closed?,
            offset: offset?.map(|offset| offset.expression),
            follow: follow?,
        };
        self.check_curve(&curve, &place)?;
        Some(JointKind::Curve(curve))
    }

    /// Warns of a corner of a curve with the file's parameters.
    fn warn_of_corner(&mut self, curve: &Curve, place: &Span) {
        let CurveShape::Formula { ends, .. } = &curve.shape else {
            return;
        };
        let parameter = |id| self.known_value(id);
        let Some(corner) = curve.corner(&parameter) else {
            return;
        };
        let [first, last] = ends.each_ref().map(|end| end.evaluate(&parameter, 0.0));
        let [x, y] = curve.shape.at(&parameter, corner).map(|c| shown(c.value));
        let s = shown(first + (last - first) * corner);
        let message = format!("the curve has a corner at s = {s}, x = {x} m, y = {y} m");
        self.warn(code::BAD_PROFILE, place.clone(), message)
            .suggest("a motion ends there: round it off");
    }

    /// Refuses a curve that is none with the file's parameters.
    fn check_curve(&mut self, curve: &Curve, place: &Span) -> Option<()> {
        if !self.knows(curve.parameters()) {
            return Some(());
        }
        let parameter = |id| self.known_value(id);
        let jets = |s| curve.shape.at(&parameter, s);
        let offset = curve.offset.as_ref();
        let offset = offset.map_or(0.0, |offset| offset.evaluate(&parameter, 0.0));
        let places = (0..=SAMPLES).map(|part| f64::from(part) / f64::from(SAMPLES));
        let mut largest = 0.0_f64;
        let mut fault = None;
        for s in places {
            let [x, y] = jets(s);
            let speed = x.first().hypot(y.first());
            let turn = (x.first() * y.second() - y.first() * x.second()) / (speed * speed);
            if !(x.value + y.value).is_finite() {
                fault = fault.or(Some("the curve has no finite point everywhere"));
            } else if !turn.is_finite() {
                fault = fault.or(Some(
                    "the curve stands still or has a corner, where it has no direction",
                ));
            } else if speed <= turn * offset {
                fault = fault.or(Some(
                    "the `offset` is larger than a radius of curvature of the curve",
                ));
            }
            largest = largest.max(speed);
        }
        if curve.closed {
            let apart = |s: f64| {
                let ([x, y], [u, v]) = (jets(s), jets(s + 1.0));
                (x.value - u.value).hypot(y.value - v.value)
            };
            if [0.0, 0.137, 0.5, 0.731]
                .into_iter()
                .any(|s| apart(s) > CLOSED * largest)
            {
                fault = fault.or(Some(
                    "the curve is not closed: x and y have to repeat after `to`",
                ));
            }
        }
        let Some(fault) = fault else {
            self.warn_of_corner(curve, place);
            return Some(());
        };
        self.error(code::BAD_PROFILE, place.clone(), fault);
        None
    }
}
