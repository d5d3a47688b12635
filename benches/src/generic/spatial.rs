//! Spatial algebra: twists and wrenches (linear part first), placements, inertias.

use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};
use std::ops::{Add, AddAssign, Mul, Sub};

/// Twist (velocity of the origin, angular velocity) or wrench (force, moment about the origin).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialVector {
    /// Linear part of a spatial vector: velocity of the origin, or force.
    pub linear: Vector3<f64>,
    /// Angular part of a spatial vector: angular velocity, or moment about the origin.
    pub angular: Vector3<f64>,
}

impl SpatialVector {
    /// Creates a spatial vector from its linear and angular parts.
    pub fn new(linear: Vector3<f64>, angular: Vector3<f64>) -> SpatialVector {
        SpatialVector { linear, angular }
    }

    /// Returns the spatial vector of zeros.
    pub fn zero() -> SpatialVector {
        SpatialVector::new(Vector3::zeros(), Vector3::zeros())
    }

    /// Returns the spatial unit vector whose entry `k` is one.
    pub fn unit_vector(k: usize) -> SpatialVector {
        let mut s = SpatialVector::zero();
        let part = if k < 3 { &mut s.linear } else { &mut s.angular };
        part[k % 3] = 1.0;
        s
    }

    /// Creates a spatial vector from the first six numbers.
    pub fn from_slice(s: &[f64]) -> SpatialVector {
        SpatialVector::new(Vector3::new(s[0], s[1], s[2]), Vector3::new(s[3], s[4], s[5]))
    }

    /// Returns the six entries, linear before angular, as one vector.
    pub fn as_six_vector(&self) -> Vector6<f64> {
        let (l, a) = (self.linear, self.angular);
        Vector6::new(l.x, l.y, l.z, a.x, a.y, a.z)
    }

    /// Applies a function to the linear and to the angular part.
    pub fn map_linear_and_angular(&self, f: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> SpatialVector {
        SpatialVector::new(f(&self.linear), f(&self.angular))
    }

    /// Returns the scalar product of twist and wrench: a power.
    pub fn dot(&self, other: &SpatialVector) -> f64 {
        self.linear.dot(&other.linear) + self.angular.dot(&other.angular)
    }

    /// Returns the rate of a twist that is fixed in a frame moving with this twist.
    pub fn cross(&self, other: &SpatialVector) -> SpatialVector {
        SpatialVector::new(
            self.angular.cross(&other.linear) + self.linear.cross(&other.angular),
            self.angular.cross(&other.angular),
        )
    }

    /// Returns the rate of a wrench that is fixed in a frame moving with this twist.
    pub fn cross_force(&self, wrench: &SpatialVector) -> SpatialVector {
        SpatialVector::new(
            self.angular.cross(&wrench.linear),
            self.angular.cross(&wrench.angular) + self.linear.cross(&wrench.linear),
        )
    }
}

impl Add for SpatialVector {
    type Output = SpatialVector;
    fn add(self, b: SpatialVector) -> SpatialVector {
        SpatialVector::new(self.linear + b.linear, self.angular + b.angular)
    }
}

impl Sub for SpatialVector {
    type Output = SpatialVector;
    fn sub(self, b: SpatialVector) -> SpatialVector {
        SpatialVector::new(self.linear - b.linear, self.angular - b.angular)
    }
}

impl AddAssign for SpatialVector {
    fn add_assign(&mut self, b: SpatialVector) {
        *self = *self + b;
    }
}

impl Mul<f64> for SpatialVector {
    type Output = SpatialVector;
    fn mul(self, s: f64) -> SpatialVector {
        SpatialVector::new(self.linear * s, self.angular * s)
    }
}

/// Placement of a child frame relative to its parent frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Rotation matrix whose columns are the child's axes in the parent's.
    pub rotation: Matrix3<f64>,
    /// Position of the child's origin, in parent axes, m.
    pub translation: Vector3<f64>,
}

impl Placement {
    /// Creates a placement from its rotation and translation.
    pub fn new(rotation: Matrix3<f64>, translation: Vector3<f64>) -> Placement {
        Placement { rotation, translation }
    }

    /// Returns the identity placement.
    pub fn identity_placement() -> Placement {
        Placement::new(Matrix3::identity(), Vector3::zeros())
    }

    /// Returns the composition of this placement with a placement in its child frame.
    pub fn compose_with(&self, next: &Placement) -> Placement {
        Placement::new(self.rotation * next.rotation, self.translation + self.rotation * next.translation)
    }

    /// Returns the placement of the parent frame in the child frame.
    pub fn inverse_placement(&self) -> Placement {
        let rotation = self.rotation.transpose();
        Placement::new(rotation, -(rotation * self.translation))
    }

    /// Transforms a twist from the parent's frame to the child's.
    pub fn twist_to_child(&self, t: &SpatialVector) -> SpatialVector {
        SpatialVector::new(
            self.rotation.tr_mul(&(t.linear + t.angular.cross(&self.translation))),
            self.rotation.tr_mul(&t.angular),
        )
    }

    /// Transforms a twist from the child's frame to the parent's.
    pub fn twist_to_parent(&self, t: &SpatialVector) -> SpatialVector {
        let angular = self.rotation * t.angular;
        SpatialVector::new(self.rotation * t.linear + self.translation.cross(&angular), angular)
    }

    /// Transforms a wrench from the child's frame to the parent's.
    pub fn wrench_to_parent(&self, w: &SpatialVector) -> SpatialVector {
        let force = self.rotation * w.linear;
        SpatialVector::new(force, self.rotation * w.angular + self.translation.cross(&force))
    }
}

/// Rigid-body inertia about the origin of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Mass of the body, kg.
    pub mass: f64,
    /// First moment of the body: mass times centre of mass, kg·m.
    pub moment: Vector3<f64>,
    /// Inertia tensor of the body about the origin of the frame, kg·m².
    pub tensor: Matrix3<f64>,
}

impl Inertia {
    /// Returns the inertia of a massless link.
    pub fn zero_inertia() -> Inertia {
        Inertia { mass: 0.0, moment: Vector3::zeros(), tensor: Matrix3::zeros() }
    }

    /// Returns the inertia of a body with its centre of mass at `c` and an inertia tensor about it.
    pub fn inertia_of_body(mass: f64, c: Vector3<f64>, central: Matrix3<f64>) -> Inertia {
        Inertia {
            mass,
            moment: c * mass,
            tensor: central + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass,
        }
    }

    /// Returns the spatial momentum of a body with this inertia and twist.
    pub fn momentum_of_twist(&self, t: &SpatialVector) -> SpatialVector {
        SpatialVector::new(
            t.linear * self.mass + t.angular.cross(&self.moment),
            self.tensor * t.angular + self.moment.cross(&t.linear),
        )
    }

    /// Transforms the inertia to the parent's origin and axes.
    pub fn inertia_in_parent(&self, placement: &Placement) -> Inertia {
        let (r, p) = (&placement.rotation, &placement.translation);
        let h = r * self.moment;
        let s = h + p * (0.5 * self.mass);
        let outer = p * s.transpose();
        let tensor = r * self.tensor * r.transpose() + Matrix3::identity() * (2.0 * p.dot(&s))
            - outer
            - outer.transpose();
        Inertia { mass: self.mass, moment: h + p * self.mass, tensor }
    }
}

impl AddAssign for Inertia {
    fn add_assign(&mut self, b: Inertia) {
        self.mass += b.mass;
        self.moment += b.moment;
        self.tensor += b.tensor;
    }
}

/// Articulated inertia: force `m a + hᵀ w`, moment `h a + i w` for an acceleration `(a, w)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArticulatedInertia {
    /// Block of the articulated inertia that maps linear acceleration to force.
    pub m: Matrix3<f64>,
    /// Block of the articulated inertia that maps linear acceleration to moment.
    pub h: Matrix3<f64>,
    /// Block of the articulated inertia that maps angular acceleration to moment.
    pub i: Matrix3<f64>,
}

impl ArticulatedInertia {
    /// Returns the articulated inertia of a rigid body.
    pub fn from_rigid_inertia(inertia: &Inertia) -> ArticulatedInertia {
        ArticulatedInertia {
            m: Matrix3::from_diagonal_element(inertia.mass),
            h: inertia.moment.cross_matrix(),
            i: inertia.tensor,
        }
    }

    /// Returns the wrench that gives a body of this articulated inertia an acceleration.
    pub fn wrench_of_acceleration(&self, a: &SpatialVector) -> SpatialVector {
        SpatialVector::new(
            self.m * a.linear + self.h.tr_mul(&a.angular),
            self.h * a.linear + self.i * a.angular,
        )
    }

    /// Returns the articulated inertia after elimination of a joint: `IA − U Uᵀ / D`.
    pub fn inertia_after_joint_elimination(&self, u: &SpatialVector, inverse: f64) -> ArticulatedInertia {
        let scaled = *u * inverse;
        ArticulatedInertia {
            m: self.m - scaled.linear * u.linear.transpose(),
            h: self.h - scaled.angular * u.linear.transpose(),
            i: self.i - scaled.angular * u.angular.transpose(),
        }
    }

    /// Transforms the articulated inertia to the parent's origin and axes.
    pub fn inertia_in_parent(&self, placement: &Placement) -> ArticulatedInertia {
        let r = &placement.rotation;
        let rotate_matrix = |x: &Matrix3<f64>| r * x * r.transpose();
        let p = placement.translation.cross_matrix();
        let m = rotate_matrix(&self.m);
        let h = rotate_matrix(&self.h);
        let moved = h + p * m;
        ArticulatedInertia { m, h: moved, i: rotate_matrix(&self.i) - moved * p + p * h.transpose() }
    }

    /// Returns the acceleration that a wrench causes by this articulated inertia.
    pub fn acceleration_from_wrench(&self, wrench: &SpatialVector) -> SpatialVector {
        let mut full = Matrix6::zeros();
        full.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.m);
        full.fixed_view_mut::<3, 3>(0, 3).copy_from(&self.h.transpose());
        full.fixed_view_mut::<3, 3>(3, 0).copy_from(&self.h);
        full.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.i);
        let nothing = Vector6::from_element(f64::NAN);
        let solved = full.cholesky().map_or(nothing, |factors| factors.solve(&wrench.as_six_vector()));
        SpatialVector::from_slice(solved.as_slice())
    }
}

impl AddAssign for ArticulatedInertia {
    fn add_assign(&mut self, b: ArticulatedInertia) {
        self.m += b.m;
        self.h += b.h;
        self.i += b.i;
    }
}
