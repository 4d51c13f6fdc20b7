//! Places in space, and the plane of a mechanism.

/// A vector in space.
pub(super) type Vector = [f64; 3];

/// Greatest sine of the angle between directions that count as parallel; OndselSolver writes
/// assemblies to about 1e-9, FreeCAD's by hand to about 1e-6.
const PARALLEL: f64 = 1e-5;

/// A frame in space: its origin and its axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpatialFrame {
    pub(super) at: Vector,
    /// Directions of the x-, y- and z-axis.
    pub(super) axes: [Vector; 3],
}

impl SpatialFrame {
    /// The frame of the assembly.
    pub(super) const ORIGIN: Self = Self {
        at: [0.0; 3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// Returns a frame from its origin and the rows of its matrix, whose columns are its axes.
    pub(super) fn new(at: Vector, rows: [f64; 9]) -> Self {
        let axes = [0, 1, 2].map(|column| [rows[column], rows[3 + column], rows[6 + column]]);
        Self { at, axes }
    }

    /// Returns a frame that is given in this one.
    pub(super) fn then(&self, inner: &Self) -> Self {
        let turn = |v: Vector| -> Vector {
            [0, 1, 2].map(|row| (0..3).map(|axis| self.axes[axis][row] * v[axis]).sum())
        };
        let at = turn(inner.at);
        Self {
            at: [0, 1, 2].map(|row| self.at[row] + at[row]),
            axes: inner.axes.map(turn),
        }
    }

    pub(super) fn z(&self) -> Vector {
        self.axes[2]
    }
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Returns whether two directions are parallel, or opposite.
pub(super) fn are_parallel(a: Vector, b: Vector) -> bool {
    let normal = cross(a, b);
    dot(normal, normal) <= PARALLEL * PARALLEL * dot(a, a) * dot(b, b)
}

/// Returns whether two directions are at a right angle.
pub(super) fn are_perpendicular(a: Vector, b: Vector) -> bool {
    dot(a, b).powi(2) <= PARALLEL * PARALLEL * dot(a, a) * dot(b, b)
}

/// The plane in which a mechanism moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) normal: Vector,
    x: Vector,
    y: Vector,
}

impl Plane {
    /// Returns the plane with this normal, up to its sign: seen from the side on which x goes to the
    /// right and z, or y, goes up.
    pub(super) fn new(normal: Vector) -> Self {
        let length = dot(normal, normal).sqrt().max(f64::MIN_POSITIVE);
        let mut normal = normal.map(|c| c / length);
        let [x, y, z] = normal;
        // Towards the reader: z, −y and x of the assembly.
        let towards = if z.abs() > 0.5 {
            z
        } else if y.abs() > 0.5 {
            -y
        } else {
            x
        };
        if towards < 0.0 {
            normal = normal.map(|c| -c);
        }
        let right = if normal[0].abs() > 0.9 {
            [0.0, 1.0, 0.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let part = dot(right, normal);
        let right = [0, 1, 2].map(|c| right[c] - part * normal[c]);
        let length = dot(right, right).sqrt().max(f64::MIN_POSITIVE);
        // A coordinate axis stays what it is.
        let x = right.map(|c| c / length + 0.0);
        Self {
            normal,
            x,
            y: cross(normal, x),
        }
    }

    /// Returns the point, or vector, in the plane.
    pub(super) fn point(&self, at: Vector) -> [f64; 2] {
        [dot(at, self.x), dot(at, self.y)]
    }

    /// As [`Plane::point`].
    pub(super) fn vector(&self, vector: Vector) -> [f64; 2] {
        self.point(vector)
    }

    /// Returns the angle of a direction in the plane.
    pub(super) fn angle(&self, direction: Vector) -> f64 {
        let [x, y] = self.point(direction);
        y.atan2(x)
    }

    /// Returns the angle of a frame: of its x-axis, or of the first axis in the plane.
    pub(super) fn turn(&self, place: &SpatialFrame) -> f64 {
        let mut axes = place.axes.into_iter();
        let axis = axes.find(|axis| are_perpendicular(*axis, self.normal));
        axis.map_or(0.0, |axis| self.angle(axis))
    }

    pub(super) fn is_normal(&self, axis: Vector) -> bool {
        are_parallel(axis, self.normal)
    }

    pub(super) fn is_within(&self, axis: Vector) -> bool {
        are_perpendicular(axis, self.normal)
    }

    /// Returns 1 if an axis shows to the reader, −1 if away.
    pub(super) fn side(&self, axis: Vector) -> f64 {
        1.0_f64.copysign(dot(axis, self.normal))
    }
}
