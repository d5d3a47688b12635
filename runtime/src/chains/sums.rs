//! Motions of the links, and sums over each link with its descendants.

use super::lanes::{
    Eight, Inertias, Matrices, Row, Rows, Spatials, Vectors, WIDTH, cross, cross_add, dot, read,
    read_vectors, scale, scale_add, suffix_sums, symmetric, transform, transform_add, transpose, write,
    write_vectors,
};
use super::{Block, LinkQuantityLanes, MassPropertyLanes, POSITION, RATES, ROTATION};
use crate::Real;
use crate::arithmetic::Arithmetic;

/// Number of quantities that are summed over descendants: mass, first moment, inertia tensor, wrench, and the
/// vector and the matrix of the velocity map.
const SUMS: usize = 28;
/// Index of the first moment among the sums.
const MOMENT: usize = 1;
/// Index of the inertia tensor among the sums.
const TENSOR: usize = 4;
/// Index of the wrench among the sums.
const WRENCH: usize = 10;
/// Index of the vector of the velocity map among the sums.
const MAP_VECTOR: usize = 16;
/// Index of the matrix of the velocity map among the sums, by columns.
const MAP_MATRIX: usize = 19;

/// Number of rows that [`Work::links`] stores for each block.
pub const LINK_ROWS: usize = 36;
/// Index of the momentum `I S` in a block of [`Work::links`], followed by the moment `Bᵀ S`.
pub const MOMENTUM: usize = 0;
/// Index of the wrench caused by a displacement in a block of [`Work::links`], followed by the wrench caused
/// by a velocity.
pub const WRENCHES: usize = 9;
/// Index of the change `Ψ̈` of the acceleration in a block of [`Work::links`].
pub const SECOND: usize = 21;
/// Index of the change `Ψ̇` of the twist in a block of [`Work::links`]; its linear component is replaced by
/// that of the rate.
const FIRST: usize = 27;
/// Index of the linear component of the rate `Ψ̇ + V × S` in a block of [`Work::links`].
pub const RATE_LINEAR: usize = FIRST;
/// Index of the angular component of the change `Ψ̇` of the twist in a block of [`Work::links`].
pub const FIRST_ANGULAR: usize = FIRST + 3;
/// Index of the angular component of the rate `Ψ̇ + V × S` in a block of [`Work::links`].
pub const RATE_ANGULAR: usize = 33;

/// Intermediate results for all blocks.
pub struct Work<T, const B: usize> {
    /// Quantities of each body, later sums over each link with its descendants.
    sums: [Rows<T, SUMS>; B],
    /// Results for each link from which the entries of the derivatives are computed.
    pub links: [Rows<T, LINK_ROWS>; B],
    /// Twist and acceleration of the last link of each block.
    ends: [[[T; 6]; 2]; B],
    /// Sums over the blocks whose parent is the last link of each block.
    carried: [[T; SUMS]; B],
}

impl<T: Real, const B: usize> Work<T, B> {
    /// Returns intermediate results that are all zero.
    #[inline(always)]
    pub fn new() -> Self {
        let zero = T::zero();
        Work {
            sums: [[Row([zero; WIDTH]); SUMS]; B],
            links: [[Row([zero; WIDTH]); LINK_ROWS]; B],
            ends: [[[zero; 6]; 2]; B],
            carried: [[zero; SUMS]; B],
        }
    }

    /// Computes the motions of the links of block `b`, and the quantities of their bodies. `free` is true for
    /// a free root link.
    #[inline(always)]
    pub fn propagate_outward<A: Arithmetic>(
        &mut self,
        b: usize,
        block: &Block<'_>,
        link: &LinkQuantityLanes<T>,
        inertia: &MassPropertyLanes<T>,
        ground: &[T; 3],
        free: bool,
    ) {
        let (zero, [x, y, z]) = (T::zero(), *ground);
        let [twist, acceleration] = block
            .parent
            .and_then(|p| self.ends.get(p).copied())
            .unwrap_or([[zero; 6], [x, y, z, zero, zero, zero]]);
        let (twist, acceleration) = (Spatials::splat(&twist), Spatials::splat(&acceleration));
        let subspace = Spatials::<A, T>::read(link, 0);
        let (v, a) = (read::<A, T, 20>(link, RATES), read::<A, T, 20>(link, RATES + 1));
        // All degrees of freedom of a free link have the motion of its parent before, and its own after them.
        let own_and_parent_motions = |start: &Spatials<A, T>, own: &Spatials<A, T>| {
            let sums = own.prefix_sums();
            if free {
                (start.plus(&Spatials::splat(&sums.last())), *start)
            } else {
                let sums = start.plus(&sums);
                (sums, sums.minus(own))
            }
        };
        let (own, above) = own_and_parent_motions(&twist, &subspace.scale(v));
        let first = above.cross_motion(&subspace);
        let (own_change, above_change) =
            own_and_parent_motions(&acceleration, &subspace.scale_add(a, &first.scale(v)));
        let second = above_change.cross_motion(&subspace).plus(&above.cross_motion(&first));
        if let (Some(ends), Some(links)) = (self.ends.get_mut(b), self.links.get_mut(b)) {
            *ends = [own.last(), own_change.last()];
            second.write(links, SECOND);
            first.write(links, FIRST);
        }
        if let Some(sums) = self.sums.get_mut(b) {
            write_body(sums, &inertia_about_root(link, inertia), &own, &own_change);
        }
    }

    /// Adds up the sums over the links of block `b` with their descendants, and computes the wrenches and
    /// momenta of its joints. `free` is true for a free root link.
    #[inline(always)]
    pub fn sum_inward<A: Arithmetic>(
        &mut self,
        b: usize,
        block: &Block<'_>,
        link: &LinkQuantityLanes<T>,
        free: bool,
    ) {
        let (Some(sums), Some(carried)) = (self.sums.get_mut(b), self.carried.get(b).copied()) else {
            return;
        };
        let mut parent = block.parent.and_then(|p| self.carried.get_mut(p));
        let o = T::zero();
        for (k, carried) in carried.into_iter().enumerate() {
            let own = read::<A, T, SUMS>(sums, k) + A::lanes([o, o, o, o, o, o, o, carried]);
            let sum = suffix_sums(own);
            write::<A, T, SUMS>(sums, k, sum);
            if let Some(parent) = &mut parent {
                parent[k] += sum.lane_numbers()[0];
            }
        }
        let Some(links) = self.links.get_mut(b) else { return };
        let (s, first) = (Spatials::<A, T>::read(link, 0), Spatials::read(links, FIRST));
        let second = Spatials::read(links, SECOND);
        // The rate Ψ̇ + V × S; if S is the joint's only degree of freedom, V × S = Ψ̇.
        let rate = match self.ends.get(b) {
            Some([own, _]) if free => first.plus(&Spatials::splat(own).cross_motion(&s)),
            _ => first.plus(&first),
        };
        let inertia = Inertias {
            mass: read::<A, T, SUMS>(sums, 0),
            moment: read_vectors::<A, T, SUMS>(sums, MOMENT),
            tensor: symmetric(&read_six_rows(sums, TENSOR)),
        };
        write_vectors::<A, T, LINK_ROWS>(links, RATE_LINEAR, &rate.linear);
        write_vectors::<A, T, LINK_ROWS>(links, RATE_ANGULAR, &rate.angular);
        let map = VelocityForceDerivatives::read(sums);
        let mut by_displacement = map.apply(&first.angular);
        if !free {
            by_displacement = s.cross_force_add(&Spatials::read(sums, WRENCH), &by_displacement);
        }
        inertia.momenta(&s).write(links, MOMENTUM);
        write_vectors::<A, T, LINK_ROWS>(links, MOMENTUM + 6, &map.apply_transposed(&s));
        inertia.momenta_add(&second, &by_displacement).write(links, WRENCHES);
        inertia.momenta_add(&rate, &map.apply(&s.angular)).write(links, WRENCHES + 6);
    }
}

/// Linear maps from motions to wrenches that give the change of the forces with the velocity, in the form
/// `x ↦ (x × p, (tr K − K) x)` for angular components `x`.
struct VelocityForceDerivatives<A, T> {
    vector: Vectors<A, T>,
    /// Matrices `tr K − K`.
    matrix: Matrices<A, T>,
}

impl<A: Arithmetic, T: Real> VelocityForceDerivatives<A, T> {
    #[inline(always)]
    fn read(sums: &Rows<T, SUMS>) -> Self {
        let map_matrix_column = |k: usize| read_vectors::<A, T, SUMS>(sums, MAP_MATRIX + 3 * k);
        let k = transpose(&[map_matrix_column(0), map_matrix_column(1), map_matrix_column(2)]);
        let matrix = [
            [k[1][1] + k[2][2], -k[0][1], -k[0][2]],
            [-k[1][0], k[2][2] + k[0][0], -k[1][2]],
            [-k[2][0], -k[2][1], k[0][0] + k[1][1]],
        ];
        VelocityForceDerivatives { vector: read_vectors::<A, T, SUMS>(sums, MAP_VECTOR), matrix }
    }

    #[inline(always)]
    fn apply(&self, x: &Vectors<A, T>) -> Spatials<A, T> {
        Spatials { linear: cross(x, &self.vector), angular: transform(&self.matrix, x) }
    }

    /// Returns the transposed map of a motion, `p × v + (tr K − K)ᵀ ω`. It is a moment; the corresponding
    /// force is zero.
    #[inline(always)]
    fn apply_transposed(&self, x: &Spatials<A, T>) -> Vectors<A, T> {
        transform_add(&transpose(&self.matrix), &x.angular, &cross(&self.vector, &x.linear))
    }
}

#[inline(always)]
fn read_six_rows<A: Arithmetic, T: Real, const K: usize>(rows: &Rows<T, K>, k: usize) -> [Eight<A, T>; 6] {
    let ([a, b, c], [d, e, f]) = (read_vectors::<A, T, K>(rows, k), read_vectors::<A, T, K>(rows, k + 3));
    [a, b, c, d, e, f]
}

/// Returns mass properties about the root's origin in its axes, by the parallel-axis theorem in the form of
/// `Inertia::sum_with_placed_inertia` of the compiler.
#[inline(always)]
fn inertia_about_root<A: Arithmetic, T: Real>(
    link: &LinkQuantityLanes<T>,
    inertia: &MassPropertyLanes<T>,
) -> (Inertias<A, T>, [Eight<A, T>; 6]) {
    let rotation = [0, 3, 6].map(|k| read_vectors::<A, T, 20>(link, ROTATION + k));
    let p = read_vectors::<A, T, 20>(link, POSITION);
    let mass = read::<A, T, 10>(inertia, 0);
    let moment = transform(&rotation, &read_vectors::<A, T, 10>(inertia, MOMENT));
    let tensor = symmetric(&read_six_rows(inertia, TENSOR));
    let [x, y, z] = rotation;
    let [tx, ty, tz] = [transform(&tensor, &x), transform(&tensor, &y), transform(&tensor, &z)];
    let half = A::splat(T::one() / (T::one() + T::one()));
    let s = scale_add(&p, mass * half, &moment);
    let twice = dot(&p, &s);
    let twice = twice + twice;
    let inertia_entry_about_root = |i: usize, j: usize, rotated: Eight<A, T>| {
        A::neg_mul_add(p[i], s[j], A::neg_mul_add(s[i], p[j], rotated))
    };
    let six = [
        inertia_entry_about_root(0, 0, dot(&tx, &x)) + twice,
        inertia_entry_about_root(1, 1, dot(&ty, &y)) + twice,
        inertia_entry_about_root(2, 2, dot(&tz, &z)) + twice,
        inertia_entry_about_root(1, 2, dot(&ty, &z)),
        inertia_entry_about_root(2, 0, dot(&tz, &x)),
        inertia_entry_about_root(0, 1, dot(&tx, &y)),
    ];
    (Inertias { mass, moment: scale_add(&p, mass, &moment), tensor: symmetric(&six) }, six)
}

/// Writes mass properties, wrenches and velocity maps of bodies at their twists and accelerations.
#[inline(always)]
fn write_body<A: Arithmetic, T: Real>(
    sums: &mut Rows<T, SUMS>,
    (inertia, six): &(Inertias<A, T>, [Eight<A, T>; 6]),
    twist: &Spatials<A, T>,
    acceleration: &Spatials<A, T>,
) {
    let momentum = inertia.momenta(twist);
    let turned = Spatials {
        linear: cross(&twist.angular, &momentum.linear),
        angular: cross_add(&twist.angular, &momentum.angular, &cross(&twist.linear, &momentum.linear)),
    };
    write::<A, T, SUMS>(sums, 0, inertia.mass);
    write_vectors::<A, T, SUMS>(sums, MOMENT, &inertia.moment);
    for (k, entry) in six.iter().enumerate() {
        write::<A, T, SUMS>(sums, TENSOR + k, *entry);
    }
    inertia.momenta_add(acceleration, &turned).write(sums, WRENCH);
    // Twice the momentum, and twice K = v hᵀ + [w]× J with the second moments J = ½ tr(I) − I.
    let two = A::splat(T::one() + T::one());
    write_vectors::<A, T, SUMS>(sums, MAP_VECTOR, &scale(&momentum.linear, two));
    let trace = six[0] + six[1] + six[2];
    let minus_two = -two;
    for (k, (row, h)) in inertia.tensor.iter().zip(&inertia.moment).enumerate() {
        let mut column = scale(row, minus_two);
        column[k] = column[k] + trace;
        let column = cross_add(&twist.angular, &column, &scale(&twist.linear, two * *h));
        write_vectors::<A, T, SUMS>(sums, MAP_MATRIX + 3 * k, &column);
    }
}
