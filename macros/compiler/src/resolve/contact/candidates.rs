//! Points where a pair of surfaces may touch.

use super::cylinders::{Drum, capsule_unbounded_cylinder_contacts};
use super::geometry::{
    FLAT_RIM, PointContact, clamp, closest_positions_on_segments, directions_to_rim_points,
};
use super::hull::sphere_on_hull;
use super::pair::{SurfacePair, sphere_contact, support_point};
use super::surface::SurfaceForm;
use super::terrain::Terrain;
use crate::expr::{Expr, Vec3};
use crate::kinematics::perpendicular_directions;

impl<'g> SurfacePair<'_, 'g> {
    /// Returns the points where a pair may touch.
    pub(super) fn candidate_contacts(&self) -> Vec<PointContact<'g>> {
        let g = self.expression_graph();
        let first_surface_to_common_axes = |v| self.direction_of_first_body(v).value;
        let second_surface_to_common_axes = |v| self.direction_of_second_body(v).value;
        let c = self.center.value - self.base.value;
        if let SurfaceForm::Terrain(terrain) = &self.b.form {
            return self.terrain_contacts(terrain, c, &second_surface_to_common_axes);
        }
        if let SurfaceForm::Cuboid(lengths) = &self.b.form {
            return self.contacts_with_box(lengths, c);
        }
        if let (SurfaceForm::Sphere(radius), SurfaceForm::Hull(hull)) = (&self.a.form, &self.b.form) {
            let axes = std::array::from_fn(|k| second_surface_to_common_axes(Vec3::coordinate_axis(g, k)));
            let contact = hull.shape.as_ref().and_then(|hull| sphere_on_hull(*radius, hull, c, &axes));
            return contact.into_iter().collect();
        }
        let SurfaceForm::Plane(n) = &self.b.form else {
            return self.contacts_with_curved_surface(c, &second_surface_to_common_axes);
        };
        let [(first, e1), (second, e2)] =
            perpendicular_directions(*n).map(|(word, e)| (word, second_surface_to_common_axes(e)));
        let normal = second_surface_to_common_axes(*n);
        let contact_at_point = |point: Vec3<'g>| PointContact {
            gap: normal.dot(c + point),
            point,
            axes: [("normal", normal), (first, e1), (second, e2)],
            conditions: Vec::new(),
        };
        let half = g.num(0.5);
        match &self.a.form {
            SurfaceForm::Point => vec![contact_at_point(Vec3::zero(g))],
            SurfaceForm::Cuboid(lengths) => corners_of_box(lengths)
                .map(|corner| contact_at_point(first_surface_to_common_axes(corner)))
                .into(),
            SurfaceForm::Hull(hull) => {
                hull.vertices.iter().map(|p| contact_at_point(first_surface_to_common_axes(*p))).collect()
            }
            SurfaceForm::Drum(radius, length, axis) => {
                let rim = directions_to_rim_points(*axis, normal, &first_surface_to_common_axes);
                let ends = [-half, half].map(|side| first_surface_to_common_axes(*axis * (*length * side)));
                let sides = ends
                    .into_iter()
                    .flat_map(|end| rim.map(|direction| contact_at_point(end + direction * *radius)));
                sides.collect()
            }
            SurfaceForm::Capsule(radius, length, axis) => [-half, half]
                .map(|side| {
                    contact_at_point(
                        first_surface_to_common_axes(*axis * (*length * side)) - normal * *radius,
                    )
                })
                .into(),
            SurfaceForm::Cone(..) => Vec::new(),
            form => support_point(form, normal, FLAT_RIM, &first_surface_to_common_axes)
                .map(|far| contact_at_point(-far))
                .into_iter()
                .collect(),
        }
    }

    /// Returns the contacts of a sphere, a point, the ends of a capsule, or the corners of a box or a hull
    /// with a terrain.
    fn terrain_contacts(
        &self,
        terrain: &Terrain<'g>,
        c: Vec3<'g>,
        second_surface_to_common_axes: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> Vec<PointContact<'g>> {
        let g = self.expression_graph();
        let first_surface_to_common_axes = |v| self.direction_of_first_body(v).value;
        let (radius, places) = match &self.a.form {
            SurfaceForm::Point => (g.zero(), vec![Vec3::zero(g)]),
            SurfaceForm::Sphere(radius) => (*radius, vec![Vec3::zero(g)]),
            SurfaceForm::Cuboid(lengths) => {
                (g.zero(), corners_of_box(lengths).map(first_surface_to_common_axes).into())
            }
            SurfaceForm::Hull(hull) => {
                (g.zero(), hull.vertices.iter().map(|p| first_surface_to_common_axes(*p)).collect())
            }
            SurfaceForm::Capsule(radius, length, axis) => (
                *radius,
                [-0.5, 0.5].map(|side| first_surface_to_common_axes(*axis * (*length * side))).into(),
            ),
            _ => return Vec::new(),
        };
        let axes: [Vec3<'g>; 3] =
            std::array::from_fn(|k| second_surface_to_common_axes(Vec3::coordinate_axis(g, k)));
        let touches = places.into_iter().map(|place| {
            let contact = terrain.sphere_contact(
                radius,
                Vec3(axes.map(|axis| axis.dot(c + place))),
                second_surface_to_common_axes,
            );
            PointContact { point: contact.point + place, ..contact }
        });
        touches.collect()
    }

    /// Returns the contacts of a sphere, a point or a capsule with a curved surface. Two capsules touch where
    /// their axes are closest, and at the spheres at their ends, which carry parallel capsules.
    fn contacts_with_curved_surface(
        &self,
        c: Vec3<'g>,
        second_surface_to_common_axes: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> Vec<PointContact<'g>> {
        let g = self.expression_graph();
        let half = g.num(0.5);
        let (radius, own) = match &self.a.form {
            SurfaceForm::Point => (g.zero(), None),
            SurfaceForm::Sphere(radius) => (*radius, None),
            SurfaceForm::Capsule(radius, length, axis) => {
                (*radius, Some((self.direction_of_first_body(*axis).value, *length * half)))
            }
            _ => return Vec::new(),
        };
        let contact = match &self.b.form {
            SurfaceForm::Capsule(other, length, axis) => {
                let (axis, reach) = (second_surface_to_common_axes(*axis), *length * half);
                let sphere = SurfaceForm::Sphere(*other);
                let Some((own, own_reach)) = own else {
                    let along = clamp(axis.dot(c), reach);
                    return sphere_contact(radius, &sphere, c - axis * along, second_surface_to_common_axes)
                        .into_iter()
                        .collect();
                };
                let own_ends =
                    [-own_reach, own_reach].map(|near| (near, clamp(axis.dot(c + own * near), reach)));
                let other_ends = [-reach, reach].map(|far| (clamp(own.dot(axis * far - c), own_reach), far));
                let places = [closest_positions_on_segments(c, (own, own_reach), (axis, reach))].into_iter();
                let touches = places.chain(own_ends).chain(other_ends).filter_map(|(near, far)| {
                    let contact = sphere_contact(
                        radius,
                        &sphere,
                        c + own * near - axis * far,
                        second_surface_to_common_axes,
                    )?;
                    Some(PointContact { point: contact.point + own * near, ..contact })
                });
                return touches.collect();
            }
            SurfaceForm::Drum(wide, length, axis) => {
                let drum =
                    Drum { radius: *wide, half: *length * half, axis: second_surface_to_common_axes(*axis) };
                return match own {
                    Some(own) => drum.capsule_contacts_with_cylinder(radius, own, c),
                    None => vec![drum.sphere_contact(radius, c)],
                };
            }
            SurfaceForm::Cylinder(_, axis) if own.is_some() => {
                let axis = second_surface_to_common_axes(*axis);
                let contacts = own.map(|own| {
                    capsule_unbounded_cylinder_contacts(
                        radius,
                        own,
                        &self.b.form,
                        axis,
                        c,
                        second_surface_to_common_axes,
                    )
                });
                return contacts.unwrap_or_default();
            }
            form => sphere_contact(radius, form, c, second_surface_to_common_axes),
        };
        contact.into_iter().collect()
    }
}

/// Returns the corners of a box with these edge lengths, relative to its centre.
fn corners_of_box<'g>(lengths: &[Expr<'g>; 3]) -> [Vec3<'g>; 8] {
    std::array::from_fn(|k| {
        let corner_fraction_along_axis = |axis: usize| if k >> axis & 1 == 0 { -0.5 } else { 0.5 };
        Vec3(std::array::from_fn(|axis| lengths[axis] * corner_fraction_along_axis(axis)))
    })
}
