//! Scene of a motion for the camera: position, extent and viewing direction.

use crate::figure::{DrawnShape, Figure};
use crate::text;
use linkwork::drawing::{Kind, Role};
use linkwork::nalgebra::{IsometryMatrix3, Point3, Vector3};

/// Scene of a motion: the data that determine the initial view of the camera.
pub(crate) struct CameraView {
    /// Extent of the mechanism in the first sample, m.
    pub(crate) size: f64,
    /// Centre of the region through which the mechanism moves.
    centre: Vector3<f64>,
    /// Maximum distance of any point of the motion from the centre, m.
    radius: f64,
    /// Unit vector upward, opposite to gravity.
    up: Vector3<f64>,
    /// Unit vector from the scene towards the viewer.
    eye: Vector3<f64>,
    /// Whether the motion is planar, so that the camera looks along its normal.
    plane: bool,
    /// Height of the floor along `up`: that of a ground plane, or below the motion if there is gravity but no
    /// terrain.
    floor: Option<f64>,
}

impl CameraView {
    /// Computes the scene of a motion from the drawing and the placements of its frames in each sample.
    /// `shown` has the indices of the samples that are shown, including the first one.
    pub(crate) fn new(
        figure: &Figure,
        placements: &[Vec<IsometryMatrix3<f64>>],
        shown: &[usize],
    ) -> CameraView {
        let first = &placements[0];
        let gravity = Vector3::from(figure.gravity);
        let up = gravity.try_normalize(0.0).map_or(Vector3::z(), |g| -g);
        let pieces: Vec<&DrawnShape> = figure.drawn_shapes().collect();
        let place_in_world = |k: usize, frame: Option<usize>, point: Vector3<f64>| {
            frame.map_or(point, |f| (placements[k][f] * Point3::from(point)).coords)
        };
        let (mut start, mut whole, mut lowest) =
            (BoundingBox::default(), BoundingBox::default(), f64::INFINITY);
        for (frame, point, beyond) in
            pieces.iter().filter(|s| s.is_part_of_mechanism()).flat_map(|s| s.reference_points_of_shape())
        {
            start.add_point(&place_in_world(0, frame, point), beyond);
        }
        let reaches: Vec<_> = pieces.iter().flat_map(|s| s.reference_points_of_shape()).collect();
        for k in shown {
            for (frame, point, beyond) in &reaches {
                let at = place_in_world(*k, *frame, *point);
                lowest = lowest.min(at.dot(&up) - beyond);
                whole.add_point(&at, *beyond);
            }
        }
        let is_valid_size = |size: &f64| *size > 0.0 && size.is_finite();
        let size =
            [start.size_of_bounds(), whole.size_of_bounds()].into_iter().find(is_valid_size).unwrap_or(1.0);
        let rotate_to_world =
            |frame: Option<usize>, v: Vector3<f64>| frame.map_or(v, |f| first[f].rotation * v);
        let normal = figure.common_hinge_direction(rotate_to_world).filter(|n| n.dot(&up).abs() < 1e-6);
        let is_fixed_terrain =
            |s: &&DrawnShape| s.role == Role::Surface && s.mesh.is_some() && s.frames[0].is_none();
        let hills = pieces.iter().any(is_fixed_terrain);
        let floor = gravity.norm() > 0.0 && !hills;
        let plane = figure.ground_height_along(&up);
        CameraView {
            size,
            centre: whole.center_of_bounding_box(),
            radius: (whole.size_of_bounds() / 2.0).max(size / 2.0),
            up,
            eye: normal.map_or_else(|| direction_to_side_view(&up), |n| direction_to_viewer(&up, n)),
            plane: normal.is_some(),
            floor: plane.or_else(|| (floor && lowest.is_finite()).then_some(lowest - 0.02 * size)),
        }
    }

    /// Returns the unit vectors of the initial view to the right, upward and towards the viewer.
    pub(crate) fn view_axes(&self) -> [Vector3<f64>; 3] {
        let (yaw, pitch): (f64, f64) = if self.plane { (0.25, 0.2) } else { (0.7, 0.38) };
        let side = self.eye * yaw.cos() + self.up.cross(&self.eye) * yaw.sin();
        let back = side * pitch.cos() + self.up * pitch.sin();
        let right = self.up.cross(&side).normalize();
        [right, back.cross(&right), back]
    }

    pub(crate) fn scene_json(&self) -> String {
        text::list([
            text::number(self.size),
            text::numbers(self.centre.as_slice()),
            text::number(self.radius),
            text::numbers(self.up.as_slice()),
            text::numbers(self.eye.as_slice()),
            self.plane.to_string(),
            self.floor.map_or("null".to_string(), text::number),
        ])
    }
}

impl Figure {
    /// Returns the height of the lowest horizontal contact plane of the ground that faces upward.
    fn ground_height_along(&self, up: &Vector3<f64>) -> Option<f64> {
        let planes = self.shapes.iter().filter(|s| s.kind == Kind::Plane && s.frames[0].is_none());
        let vector_from_entry = |s: &DrawnShape, k: usize| Vector3::from_column_slice(&s.numbers[k..k + 3]);
        let level = planes.filter(|s| vector_from_entry(s, 3).dot(up) > 1.0 - 1e-9);
        level.map(|s| vector_from_entry(s, 0).dot(up)).reduce(f64::min)
    }
}

impl DrawnShape {
    /// Whether the shape can be drawn: the files of meshes may not have been read, and terrains not have been
    /// computed.
    pub(crate) fn is_visible(&self) -> bool {
        !matches!(self.kind, Kind::Mesh(_) | Kind::Terrain(_)) || self.mesh.is_some()
    }

    /// Whether the shape is part of the mechanism itself, whose size is measured.
    fn is_part_of_mechanism(&self) -> bool {
        matches!(self.role, Role::Body | Role::Link | Role::Visual | Role::Joint)
    }
}

/// Axis-aligned bounding box of the drawn points.
struct BoundingBox {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Default for BoundingBox {
    fn default() -> BoundingBox {
        BoundingBox { low: Vector3::repeat(f64::INFINITY), high: Vector3::repeat(f64::NEG_INFINITY) }
    }
}

impl BoundingBox {
    fn add_point(&mut self, at: &Vector3<f64>, beyond: f64) {
        self.low = self.low.inf(&at.add_scalar(-beyond));
        self.high = self.high.sup(&at.add_scalar(beyond));
    }

    fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    fn size_of_bounds(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.high - self.low).norm() }
    }

    fn center_of_bounding_box(&self) -> Vector3<f64> {
        if self.is_empty() { Vector3::zeros() } else { (self.low + self.high) / 2.0 }
    }
}

/// Returns the direction towards an eye that sees the ground's first horizontal axis to the right.
fn direction_to_side_view(up: &Vector3<f64>) -> Vector3<f64> {
    let right = if up.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    (right - up * right.dot(up)).cross(up).normalize()
}

/// Returns the direction, along a normal, towards an eye that sees larger coordinates further to the right.
fn direction_to_viewer(up: &Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    let right = up.cross(&normal);
    if right[right.iamax()] < 0.0 { -normal } else { normal }
}
