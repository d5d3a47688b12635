use super::*;
use crate::arithmetic::Compiled;
use nalgebra::{Matrix3, Rotation3, SVector, Unit, Vector3, Vector6};

/// Number of velocities of the free root link.
const FREE_VELOCITIES: usize = 6;

/// Sequence of pseudorandom numbers between −1 and 1.
struct PseudorandomSequence(u64);

impl PseudorandomSequence {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.number())
    }
}

/// Link on a screw joint of random pitch.
struct Link {
    parent: Option<usize>,
    rotation: Rotation3<f64>,
    translation: Vector3<f64>,
    axis: Unit<Vector3<f64>>,
    pitch: f64,
    mass: f64,
    moment: Vector3<f64>,
    tensor: Matrix3<f64>,
}

impl Link {
    fn random(parent: Option<usize>, next: &mut PseudorandomSequence) -> Link {
        let (mass, center) = (1.5 + next.number(), next.vector());
        let inner = Matrix3::from_fn(|_, _| next.number());
        let inertia_of_unit_mass =
            |c: Vector3<f64>| Matrix3::identity() * c.norm_squared() - c * c.transpose();
        Link {
            parent,
            rotation: Rotation3::new(next.vector() * 3.0),
            translation: next.vector(),
            axis: Unit::new_normalize(next.vector()),
            pitch: next.number(),
            mass,
            moment: center * mass,
            tensor: inner * inner.transpose() + inertia_of_unit_mass(center) * mass,
        }
    }
}

/// Tree of links; a free root link has no joint of its own.
struct Tree {
    links: Vec<Link>,
    free: bool,
}

/// Placement of a link and its motion subspace, in the axes of the root.
struct PlacedTestLink {
    rotation: Matrix3<f64>,
    position: Vector3<f64>,
    subspace: Vector6<f64>,
}

fn spatial(linear: Vector3<f64>, angular: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

fn parts(x: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (x.fixed_rows::<3>(0).into_owned(), x.fixed_rows::<3>(3).into_owned())
}

fn cross_motion(v: &Vector6<f64>, x: &Vector6<f64>) -> Vector6<f64> {
    let ((v, w), (l, a)) = (parts(v), parts(x));
    spatial(w.cross(&l) + v.cross(&a), w.cross(&a))
}

fn cross_force(v: &Vector6<f64>, f: &Vector6<f64>) -> Vector6<f64> {
    let ((v, w), (l, a)) = (parts(v), parts(f));
    spatial(w.cross(&l), w.cross(&a) + v.cross(&l))
}

impl Tree {
    fn first_jointed_link(&self) -> usize {
        usize::from(self.free)
    }

    /// Returns the index of the first velocity of a link.
    fn first_velocity_index(&self, link: usize) -> usize {
        if self.free && link > 0 { link + FREE_VELOCITIES - 1 } else { link }
    }

    fn place(&self, q: &[f64]) -> Vec<PlacedTestLink> {
        let mut all: Vec<PlacedTestLink> = Vec::new();
        for (k, link) in self.links.iter().enumerate() {
            let (rotation, position) = match link.parent {
                Some(p) => (all[p].rotation, all[p].position),
                None => (Matrix3::identity(), Vector3::zeros()),
            };
            if k < self.first_jointed_link() {
                all.push(PlacedTestLink { rotation, position, subspace: Vector6::zeros() });
                continue;
            }
            let angle = q[self.first_velocity_index(k)];
            let own = rotation * link.rotation.matrix();
            let axis = own * link.axis.into_inner();
            let position = position + rotation * link.translation + axis * (link.pitch * angle);
            let turned = own * Rotation3::from_axis_angle(&link.axis, angle).matrix();
            let subspace = spatial(axis * link.pitch + position.cross(&axis), axis);
            all.push(PlacedTestLink { rotation: turned, position, subspace });
        }
        all
    }

    /// Returns momentum or force for a body's inertia about the root's origin.
    fn apply_inertia(&self, k: usize, place: &PlacedTestLink, x: &Vector6<f64>) -> Vector6<f64> {
        let link = &self.links[k];
        let ((linear, angular), p) = (parts(x), place.position);
        let (moment, tensor) =
            (place.rotation * link.moment, place.rotation * link.tensor * place.rotation.transpose());
        let velocity = linear + angular.cross(&p);
        let force = velocity * link.mass + angular.cross(&moment);
        let about_link = tensor * angular + moment.cross(&velocity);
        spatial(force, about_link + p.cross(&force))
    }

    /// Returns the joint forces by the recursive Newton–Euler algorithm.
    fn inverse_dynamics(&self, q: &[f64], v: &[f64], a: &[f64], ground: Vector3<f64>) -> Vec<f64> {
        let places = self.place(q);
        let mut motions: Vec<(Vector6<f64>, Vector6<f64>)> = Vec::new();
        let mut wrenches: Vec<Vector6<f64>> = Vec::new();
        for (k, (link, place)) in self.links.iter().zip(&places).enumerate() {
            let (mut twist, mut change) =
                link.parent.map_or((Vector6::zeros(), spatial(ground, Vector3::zeros())), |p| motions[p]);
            if k < self.first_jointed_link() {
                twist += Vector6::from_column_slice(&v[..6]);
                change += Vector6::from_column_slice(&a[..6]);
            } else {
                let (s, i) = (place.subspace, self.first_velocity_index(k));
                change += s * a[i] + cross_motion(&twist, &s) * v[i];
                twist += s * v[i];
            }
            let momentum = self.apply_inertia(k, place, &twist);
            wrenches.push(self.apply_inertia(k, place, &change) + cross_force(&twist, &momentum));
            motions.push((twist, change));
        }
        let mut tau = vec![0.0; v.len()];
        for (k, link) in self.links.iter().enumerate().rev() {
            let wrench = wrenches[k];
            if k < self.first_jointed_link() {
                tau[..6].copy_from_slice(wrench.as_slice());
            } else {
                tau[self.first_velocity_index(k)] = places[k].subspace.dot(&wrench);
            }
            if let Some(p) = link.parent {
                wrenches[p] += wrench;
            }
        }
        tau
    }

    /// Returns the quantities of the lane of a velocity: those of its link, and its mass properties.
    fn lane_quantities(&self, i: usize, q: &[f64], v: &[f64], a: &[f64]) -> ([f64; 20], [f64; 10]) {
        let root_lane = self.free && i < FREE_VELOCITIES;
        let k = if root_lane { 0 } else { i - (self.first_velocity_index(1) - 1) };
        let (place, link) = (&self.place(q)[k], &self.links[k]);
        let subspace = if root_lane { Vector6::ith(i, 1.0) } else { place.subspace };
        let mut lane = [0.0; 20];
        lane[..6].copy_from_slice(subspace.as_slice());
        lane[6..15].copy_from_slice(place.rotation.transpose().as_slice());
        lane[15..18].copy_from_slice(place.position.as_slice());
        (lane[18], lane[19]) = (v[i], a[i]);
        let (h, t) = (link.moment, link.tensor);
        let inertia = [link.mass, h.x, h.y, h.z, t.m11, t.m22, t.m33, t.m23, t.m13, t.m12];
        (lane, if root_lane && i + 1 < FREE_VELOCITIES { [0.0; 10] } else { inertia })
    }
}

/// Compares the loops with central differences of the recursive Newton–Euler algorithm.
fn check_derivatives_of_tree<const N: usize, const B: usize, const FREE: bool>(
    parents: &[Option<usize>],
    blocks: [Block<'_>; B],
) {
    let mut next = PseudorandomSequence(N as u64);
    let links = parents.iter().map(|parent| Link::random(*parent, &mut next)).collect();
    let tree = Tree { links, free: FREE };
    let mut random_vector = || SVector::<f64, N>::from_fn(|_, _| next.number());
    let (q, v, a) = (random_vector(), random_vector(), random_vector());
    let ground = Vector3::new(1.0, -2.0, 9.0);
    let mut rows = [[Row([0.0; 8]); 20]; B];
    let mut inertias = [[Row([0.0; 8]); 10]; B];
    for (b, block) in blocks.iter().enumerate() {
        for lane in 0..block.count {
            let (link, inertia) =
                tree.lane_quantities(block.first + lane, q.as_slice(), v.as_slice(), a.as_slice());
            for (row, x) in rows[b].iter_mut().zip(link) {
                row.0[lane] = x;
            }
            for (row, x) in inertias[b].iter_mut().zip(inertia) {
                row.0[lane] = x;
            }
        }
    }
    let (mut by_q, mut by_v) = (SMatrix::<f64, N, N>::zeros(), SMatrix::<f64, N, N>::zeros());
    chain_derivatives::<Compiled, f64, N, B, FREE>(
        &blocks,
        &rows,
        &inertias,
        &ground.into(),
        [&mut by_q, &mut by_v],
        [&[], &[]],
    );
    let tau = |q: &SVector<f64, N>, v: &SVector<f64, N>, ground: Vector3<f64>| {
        let tau = tree.inverse_dynamics(q.as_slice(), v.as_slice(), a.as_slice(), ground);
        SVector::<f64, N>::from_column_slice(&tau)
    };
    let step = 1e-5;
    for j in 0..N {
        let shifted_state = |sign: f64| {
            let (mut q, mut v) = (q, v);
            q[j] += sign * step;
            v[j] += sign * step;
            // A rotation of the free root rotates gravity in its axes.
            let turn = match j {
                3..FREE_VELOCITIES if FREE => Vector3::ith(j - 3, -sign * step),
                _ => Vector3::zeros(),
            };
            (q, v, Rotation3::new(turn) * ground)
        };
        let (q_after, v_after, ground_after) = shifted_state(1.0);
        let (q_before, v_before, ground_before) = shifted_state(-1.0);
        let expected_q = (tau(&q_after, &v, ground_after) - tau(&q_before, &v, ground_before)) / (2.0 * step);
        let expected_v = (tau(&q, &v_after, ground) - tau(&q, &v_before, ground)) / (2.0 * step);
        for (found, expected) in [(by_q.column(j), expected_q), (by_v.column(j), expected_v)] {
            let error = (found - expected).amax() / (1.0 + expected.amax());
            assert!(error < 1e-7, "column {j} of {N}: {error:e}");
        }
    }
}

fn block<'a>(
    (first, count): (usize, usize),
    parent: Option<usize>,
    ancestors: &'a [usize],
    descendants: &'a [usize],
) -> Block<'a> {
    Block { first, count, parent, ancestors, descendants }
}

#[test]
fn a_chain_of_two_blocks_has_the_derivatives_of_newton_euler() {
    let parents: Vec<Option<usize>> = (0..11_usize).map(|k| k.checked_sub(1)).collect();
    check_derivatives_of_tree::<11, 2, false>(
        &parents,
        [block((0, 8), None, &[], &[1]), block((8, 3), Some(0), &[0], &[])],
    );
}

#[test]
fn a_tree_with_branches_has_the_derivatives_of_newton_euler() {
    // A stem of two links with branches of one, nine and two links.
    let parents = [
        [None, Some(0), Some(1), Some(1)].as_slice(),
        &(3..11).map(Some).collect::<Vec<_>>(),
        &[Some(1), Some(12)],
    ]
    .concat();
    check_derivatives_of_tree::<14, 5, false>(
        &parents,
        [
            block((0, 2), None, &[], &[1, 2, 3, 4]),
            block((2, 1), Some(0), &[0], &[]),
            block((3, 8), Some(0), &[0], &[3]),
            block((11, 1), Some(2), &[0, 2], &[]),
            block((12, 2), Some(0), &[0], &[]),
        ],
    );
}

#[test]
fn a_free_tree_has_the_derivatives_of_newton_euler() {
    // A free root with branches of three and two links.
    check_derivatives_of_tree::<11, 3, true>(
        &[None, Some(0), Some(1), Some(2), Some(0), Some(4)],
        [
            block((0, 6), None, &[], &[1, 2]),
            block((6, 3), Some(0), &[0], &[]),
            block((9, 2), Some(0), &[0], &[]),
        ],
    );
}

#[test]
fn only_listed_entries_become_zero() {
    let blocks = [block((0, 2), None, &[], &[])];
    let mut next = PseudorandomSequence(3);
    let mut row = || Row([next.number(), next.number(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let (rows, inertias) = ([[(); 20].map(|()| row())], [[(); 10].map(|()| row())]);
    let derivatives_with_zeroed_entries = |zeros: [&[(usize, usize)]; 2]| {
        let mut found = [SMatrix::<f64, 2, 2>::zeros(); 2];
        let [by_q, by_v] = &mut found;
        let ground = [0.0, 0.0, 9.8];
        chain_derivatives::<Compiled, f64, 2, 1, false>(
            &blocks,
            &rows,
            &inertias,
            &ground,
            [by_q, by_v],
            zeros,
        );
        found
    };
    let mut expected = derivatives_with_zeroed_entries([&[], &[]]);
    assert!(expected[0][(1, 0)] != 0.0 && expected[1][(1, 1)] != 0.0);
    (expected[0][(1, 0)], expected[1][(1, 1)]) = (0.0, 0.0);
    assert_eq!(derivatives_with_zeroed_entries([&[(0, 1)], &[(1, 1)]]), expected);
}
