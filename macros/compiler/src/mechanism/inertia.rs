//! Mass properties of links: mass, first moment and inertia tensor.

use crate::expr::{Expr, Graph, Rotation, Sym3, Vec3};

/// Mass properties of a link about its frame's origin, in its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia<'g> {
    /// Mass of the rigid body, kg.
    pub mass: Expr<'g>,
    /// First moment of the rigid body: mass times centre of mass, kg·m.
    pub moment: Vec3<'g>,
    /// Inertia tensor of the rigid body about the origin of its frame, kg·m².
    pub tensor: Sym3<'g>,
}

impl<'g> Inertia<'g> {
    /// Returns the mass properties of a massless body.
    pub fn zero(graph: &'g Graph) -> Inertia<'g> {
        Inertia { mass: graph.zero(), moment: Vec3::zero(graph), tensor: Sym3::zero(graph) }
    }

    /// Returns the mass properties of a body with its centre of mass at `c` and the inertia `central` about
    /// it.
    pub fn of_body(mass: Expr<'g>, c: Vec3<'g>, central: Sym3<'g>) -> Inertia<'g> {
        Inertia { mass, moment: c * mass, tensor: central + Sym3::point_mass_inertia(mass, c) }
    }

    /// Returns the sum of mass properties about the same origin in the same axes.
    pub fn plus(&self, b: &Inertia<'g>) -> Inertia<'g> {
        Inertia { mass: self.mass + b.mass, moment: self.moment + b.moment, tensor: self.tensor + b.tensor }
    }

    /// Returns the sum with mass properties `other` of a frame that is placed in this one.
    ///
    /// With `h` the first moment of `other` in these axes and `s = h + m p / 2`, the parallel-axis theorem
    /// adds `2 (p · s) 1 − (p sᵀ + s pᵀ)`.
    pub fn sum_with_placed_inertia(
        &self,
        other: &Inertia<'g>,
        rotation: &Rotation<'g>,
        p: Vec3<'g>,
    ) -> Inertia<'g> {
        let h = rotation.vector_in_parent_axes(other.moment);
        let s = h + p * (other.mass * 0.5);
        let twice: [Expr<'g>; 3] = std::array::from_fn(|k| (p[k] * 2.0) * s[k]);
        let shift = Sym3 {
            diagonal: [twice[1] + twice[2], twice[2] + twice[0], twice[0] + twice[1]],
            off: [(0, 1), (0, 2), (1, 2)].map(|(i, j)| -(p[i] * s[j] + p[j] * s[i])),
        };
        Inertia {
            mass: self.mass + other.mass,
            moment: self.moment + (h + p * other.mass),
            tensor: self.tensor + (rotation.symmetric_tensor_in_parent_axes(other.tensor) + shift),
        }
    }
}
