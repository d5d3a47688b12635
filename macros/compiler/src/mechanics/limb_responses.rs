//! Responses to impulses at contacts with the identical limbs of a mechanism in SIMD lanes, as in
//! [`VectorisedMechanism`].

use super::crba::{Matrix, mass_matrix};
use super::ldl::order_from_leaves_to_root;
use crate::expr::Expr;
use crate::vectorise::{LimbRows, VectorisedMechanism, join_lanes};
use std::collections::BTreeMap;

/// Contact velocities of the limbs of one group of identical limbs.
struct LimbGroupContactVelocities<'g> {
    /// First velocity of the group's limbs, which identifies the group.
    group: usize,
    /// Number of identical limbs in the group.
    width: usize,
    rows: Vec<LimbContactResponse<'g>>,
}

/// One contact velocity of each identical limb, in SIMD lanes.
struct LimbContactResponse<'g> {
    /// Reduced row `L⁻ᵀ g` over the velocities of [`VectorisedMechanism`], in SIMD lanes.
    reduced: Vec<Expr<'g>>,
    /// Entries of `M⁻¹ g` for the trunk and for the limb of the contact velocity.
    own: Vec<Expr<'g>>,
}

/// Location of a contact velocity among the limbs: family, row and SIMD lane.
#[derive(Clone, Copy)]
struct ContactLocation {
    family: usize,
    row: usize,
    lane: usize,
}

/// Factorisation `M = Lᵀ D L`, with limbs in lanes.
struct LaneMassFactorisation<'g> {
    /// Velocities in elimination order: from the leaves to the root.
    order: Vec<usize>,
    /// Off-diagonal entries of the factor `L`, a row for each velocity.
    rows: Vec<Vec<(usize, Expr<'g>)>>,
    /// Diagonal of `D⁻¹` in the factorisation, in the order of `v`.
    inverse: Vec<Expr<'g>>,
    /// Group of limbs of each velocity; `None` for the trunk.
    groups: Vec<Option<usize>>,
}

/// Returns `M⁻¹ Gᵀ`, then `G M⁻¹ Gᵀ`, column by column, for the rows of the contact Jacobian `G`. Returns
/// `None` unless each row depends on one limb of a group of identical limbs, and all limbs of a group have
/// the same number of rows.
pub fn limb_contact_responses<'g>(
    limbs: &VectorisedMechanism<'g>,
    rows: &[Vec<Expr<'g>>],
) -> Option<Vec<Expr<'g>>> {
    let groups = limbs.group_rows_by_limb(rows)?;
    let factor = LaneMassFactorisation::new(limbs, limbs.group_of_each_velocity());
    let (mut families, mut places) = (Vec::new(), BTreeMap::new());
    for LimbRows { group, width, rows: numbers } in groups {
        for (row, lanes) in numbers.iter().enumerate() {
            for (lane, i) in lanes.iter().enumerate() {
                places.insert(*i, ContactLocation { family: families.len(), row, lane });
            }
        }
        let all = numbers.iter().map(|lanes| {
            let lane_rows: Vec<&[Expr<'g>]> = lanes.iter().map(|i| rows[*i].as_slice()).collect();
            factor.solve_contact_row(limbs.merge_limb_rows_into_lanes(&lane_rows), group)
        });
        families.push(LimbGroupContactVelocities { group, width, rows: all.collect() });
    }
    let places: Vec<ContactLocation> = places.into_values().collect();
    let mut out = Vec::new();
    for place in &places {
        out.extend(limbs.scatter_lanes_to_velocities(|index, lane| {
            factor.velocity_change_per_impulse(&families, *place, index, lane)
        }));
    }
    for i in 0..places.len() {
        out.extend(
            (0..places.len()).map(|j| factor.delassus_entry(&families, places[i.min(j)], places[i.max(j)])),
        );
    }
    Some(out)
}

/// Rotates `n` lanes: lane `k` of the result is lane `k + by` modulo `n`.
fn cyclically_shifted_lanes(e: Expr<'_>, n: usize, by: usize) -> Expr<'_> {
    let lanes: Vec<Expr<'_>> = (0..n).map(|k| e.lane((k + by) % n)).collect();
    join_lanes(&lanes)
}

impl<'g> LaneMassFactorisation<'g> {
    fn new(limbs: &VectorisedMechanism<'g>, groups: Vec<Option<usize>>) -> LaneMassFactorisation<'g> {
        let mut m: Matrix<'g> = mass_matrix(&limbs.model, &limbs.joints);
        let order = order_from_leaves_to_root(&limbs.joints, m.len());
        let (mut rows, mut inverse) = (vec![Vec::new(); m.len()], Vec::new());
        inverse.extend((0..m.len()).map(|k| m[k][k]));
        for (step, &k) in order.iter().enumerate() {
            inverse[k] = m[k][k].num(1.0) / m[k][k];
            let rest: Vec<usize> =
                order[step + 1..].iter().copied().filter(|&i| !m[k][i].is_zero()).collect();
            for &i in &rest {
                let factor = m[k][i] * inverse[k];
                for &j in rest.iter().filter(|&&j| j <= i) {
                    let taken = factor * m[k][j];
                    let hangs = groups[k].is_some() && groups[i].is_none() && groups[j].is_none();
                    let taken = if hangs { taken.lane_sum(limbs.lane_count_of_velocity(k)) } else { taken };
                    m[i][j] -= taken;
                    m[j][i] = m[i][j];
                }
                rows[k].push((i, factor));
            }
        }
        LaneMassFactorisation { order, rows, inverse, groups }
    }

    /// Solves for one contact velocity of each limb of a group, whose Jacobian entries `g` are in SIMD lanes.
    fn solve_contact_row(&self, g: Vec<Expr<'g>>, group: usize) -> LimbContactResponse<'g> {
        let mut reduced = g;
        for &k in &self.order {
            for (i, factor) in &self.rows[k] {
                reduced[*i] = reduced[*i] - *factor * reduced[k];
            }
        }
        let mut own: Vec<Expr<'g>> = reduced.iter().map(|r| r.zero()).collect();
        for &k in self.order.iter().rev().filter(|k| self.groups[**k].is_none_or(|of| of == group)) {
            let start = reduced[k] * self.inverse[k];
            own[k] = self.rows[k].iter().fold(start, |x, (i, factor)| x - *factor * own[*i]);
        }
        LimbContactResponse { reduced, own }
    }

    /// Returns the change of a velocity, in its own lane, per unit impulse along a contact velocity.
    fn velocity_change_per_impulse(
        &self,
        families: &[LimbGroupContactVelocities<'g>],
        at: ContactLocation,
        index: usize,
        lane: usize,
    ) -> Expr<'g> {
        let LimbGroupContactVelocities { group, width, rows } = &families[at.family];
        let own = &rows[at.row].own;
        match self.groups[index] {
            None => own[index].lane(at.lane),
            Some(of) if of == *group && lane == at.lane => own[index],
            Some(of) if of == *group => self.limb_velocity_change_from_trunk(index, &|k| {
                cyclically_shifted_lanes(own[k], *width, width + at.lane - lane)
            }),
            Some(_) => self.limb_velocity_change_from_trunk(index, &|k| own[k].lane(at.lane)),
        }
    }

    /// Returns the change of a limb's velocity that results from the velocity changes `trunk` of the trunk.
    fn limb_velocity_change_from_trunk(&self, index: usize, trunk: &dyn Fn(usize) -> Expr<'g>) -> Expr<'g> {
        self.rows[index].iter().fold(self.inverse[index].zero(), |x, (i, factor)| {
            let value = if self.groups[*i].is_none() {
                trunk(*i)
            } else {
                self.limb_velocity_change_from_trunk(*i, trunk)
            };
            x - *factor * value
        })
    }

    /// Returns the change of one contact velocity per unit impulse along another.
    fn delassus_entry(
        &self,
        families: &[LimbGroupContactVelocities<'g>],
        a: ContactLocation,
        b: ContactLocation,
    ) -> Expr<'g> {
        let (first, second) = (&families[a.family], &families[b.family]);
        let (x, y) = (&first.rows[a.row].reduced, &second.rows[b.row].reduced);
        let inverse_weighted_dot_product =
            |is_in: &dyn Fn(usize) -> bool, of: &dyn Fn(usize) -> [Expr<'g>; 2]| {
                let terms = (0..x.len()).filter(|k| is_in(*k)).map(|k| {
                    let [x, y] = of(k);
                    x * (y * self.inverse[k])
                });
                terms.reduce(|a, b| a + b).unwrap_or_else(|| self.inverse[0].zero())
            };
        let is_trunk_velocity = |k: usize| self.groups[k].is_none();
        if a.family != b.family {
            return inverse_weighted_dot_product(&is_trunk_velocity, &|k| {
                [x[k].lane(a.lane), y[k].lane(b.lane)]
            });
        }
        let n = first.width;
        let by = (n + b.lane - a.lane) % n;
        if 2 * by > n || (2 * by == n && a.row > b.row) || (by == 0 && a.row > b.row) {
            return self.delassus_entry(families, b, a);
        }
        match by {
            0 => inverse_weighted_dot_product(
                &|k| is_trunk_velocity(k) || self.groups[k] == Some(first.group),
                &|k| [x[k], y[k]],
            )
            .lane(a.lane),
            _ => inverse_weighted_dot_product(&is_trunk_velocity, &|k| {
                [x[k], cyclically_shifted_lanes(y[k], n, by)]
            })
            .lane(a.lane),
        }
    }
}
