//! Closest points of two curves: lines, circles and points.
//!
//! A curve is described at one of its points by position, unit tangent and curvature vector. Newton's method
//! moves both points until their connection is perpendicular to both tangents.

use super::{PlacedPolytope, constant};
use crate::Real;
use nalgebra::Vector3;

/// Maximum number of Newton steps.
const STEPS: usize = 16;
/// Determinant of Newton's method below which curves have no unique closest points.
const SINGULAR: f64 = 1e-10;
/// Largest step along a circle, relative to its radius.
const LARGEST_STEP: f64 = 0.5;
/// Step, relative to the size of the bodies, below which closest points are accurate.
const ACCURATE: f64 = 1e-15;

/// Line, circle or point, described at one of its points.
#[derive(Clone, Copy)]
pub(super) struct Curve<T> {
    pub(super) point: Vector3<T>,
    /// Unit tangent, zero for a point.
    pub(super) tangent: Vector3<T>,
    /// Vector to the centre of curvature, divided by the square of the radius; zero for lines and points.
    pub(super) curvature: Vector3<T>,
    /// Distance of the body's surface from the curve, the radius of the side of a cylinder, m.
    pub(super) radius: T,
}

impl<T: Real> Curve<T> {
    pub(super) fn vertex(point: Vector3<T>) -> Self {
        Curve { point, tangent: Vector3::zeros(), curvature: Vector3::zeros(), radius: T::zero() }
    }

    pub(super) fn line(point: Vector3<T>, tangent: Vector3<T>, radius: T) -> Self {
        Curve { point, tangent, curvature: Vector3::zeros(), radius }
    }

    /// Returns the circle around the axis of a cylinder through a point of its side or rim.
    pub(super) fn circle(shape: &PlacedPolytope<'_, T>, point: Vector3<T>) -> Self {
        let arm = shape.offset_from_cylinder_axis(&point);
        let square = arm.norm_squared();
        let tangent = shape.direction(0).cross(&arm) / square.sqrt();
        Curve { point, tangent, curvature: -arm / square, radius: T::zero() }
    }

    /// Moves the point along the curve.
    fn advance(&mut self, step: T) {
        let square = self.curvature.norm_squared();
        if square <= T::zero() {
            self.point += self.tangent * step;
            return;
        }
        let curvature = square.sqrt();
        let limit = constant::<T>(LARGEST_STEP);
        let angle = (step * curvature).clamp(-limit, limit);
        let (inward, norm) = (self.curvature / curvature, (T::one() + angle * angle).sqrt());
        let center = self.point + inward / curvature;
        let new_inward = (inward - self.tangent * angle) / norm;
        self.tangent = (self.tangent + inward * angle) / norm;
        self.curvature = new_inward * curvature;
        self.point = center - new_inward / curvature;
    }

    fn is_point(&self) -> bool {
        self.tangent.norm_squared() <= T::zero()
    }
}

/// Closest points of two curves, with the direction of the contact.
#[derive(Clone, Copy)]
pub(super) struct ClosestCurves<T> {
    pub(super) curves: [Curve<T>; 2],
    /// Unit normal towards the first body.
    pub(super) normal: Vector3<T>,
    /// Sign with which the cross product of both tangents is the normal; zero if the normal is along the
    /// connection of both points.
    pub(super) side: T,
    pub(super) is_closest: T,
    /// Signed distance of the surfaces along the normal.
    pub(super) gap: T,
    /// Separation of the bodies along the normal; the gap if no other points of the bodies are closer along
    /// it.
    pub(super) separation: T,
}

impl<T: Real> ClosestCurves<T> {
    /// Returns the closest points of two curves near their present points; `None` if they are not unique.
    /// `towards` is approximately the normal.
    pub(super) fn solve(curves: [Curve<T>; 2], towards: &Vector3<T>, size: T) -> Option<Self> {
        let [mut a, mut b] = curves;
        for _ in 0..STEPS {
            let between = a.point - b.point;
            let diagonal =
                |curve: &Curve<T>| if curve.is_point() { T::one() } else { curve.tangent.norm_squared() };
            let (x, y) = (diagonal(&a) + a.curvature.dot(&between), diagonal(&b) - b.curvature.dot(&between));
            let (z, own, other) =
                (-a.tangent.dot(&b.tangent), a.tangent.dot(&between), -b.tangent.dot(&between));
            let determinant = x * y - z * z;
            if determinant.abs() < constant(SINGULAR) {
                return None;
            }
            let (s, t) = ((z * other - y * own) / determinant, (z * own - x * other) / determinant);
            a.advance(s);
            b.advance(t);
            if s.abs().max(t.abs()) <= size * constant(ACCURATE) {
                break;
            }
        }
        let (between, zero) = (a.point - b.point, T::zero());
        let (distance, radii) = (between.norm(), a.radius + b.radius);
        let across = a.tangent.cross(&b.tangent);
        let sine = across.norm();
        let is_crossing = radii <= zero && sine * size > distance;
        let (normal, side) = if is_crossing {
            let side = if across.dot(towards) < zero { -T::one() } else { T::one() };
            (across * (side / sine), side)
        } else if distance > zero && between.dot(towards) > zero {
            (between / distance, zero)
        } else {
            return None;
        };
        let is_closest = if is_crossing { zero } else { T::one() };
        let gap = normal.dot(&between) - radii;
        Some(ClosestCurves { curves: [a, b], normal, side, is_closest, gap, separation: gap })
    }

    /// Returns a value that is the signed distance for the curves that determine the contact, and less for
    /// all other curves.
    pub(super) fn separation_score(&self) -> T {
        self.separation + (self.separation - self.gap).min(T::zero())
    }
}
