//! Contact functions with the identical limbs of a mechanism in SIMD lanes, as in [`VectorisedMechanism`].

use super::crba::Matrix;
use crate::expr::Expr;
use crate::vectorise::{LaneMerger, LimbRows, VectorisedMechanism};

/// Contacts of identical limbs, each limb with the same number of contact velocities.
pub struct LimbContacts<'a, 'g> {
    limbs: &'a VectorisedMechanism<'g>,
    groups: Vec<LimbRows>,
    merge: LaneMerger<'g>,
    /// Number of contact velocities of all contacts.
    count: usize,
}

impl<'a, 'g> LimbContacts<'a, 'g> {
    /// Groups the contact velocities with the given Jacobian rows. Returns `None` unless each contact
    /// velocity depends on one limb of a group of identical limbs, and all limbs of a group have the same
    /// number of them.
    pub fn new(limbs: &'a VectorisedMechanism<'g>, jacobian: &Matrix<'g>) -> Option<LimbContacts<'a, 'g>> {
        let groups = limbs.group_rows_by_limb(jacobian)?;
        Some(LimbContacts { limbs, groups, merge: LaneMerger::new(limbs.model.graph), count: jacobian.len() })
    }

    /// Returns, for each group of limbs, the indices of the contact velocities of each limb.
    pub fn limb_contact_velocity_indices(&self) -> impl Iterator<Item = Vec<Vec<usize>>> {
        self.groups.iter().map(|group| {
            (0..group.width).map(|lane| group.rows.iter().map(|row| row[lane]).collect()).collect()
        })
    }

    /// Merges values, one for each contact velocity, into SIMD lanes. Returns `None` if the expressions of
    /// the limbs differ in structure.
    pub fn merge_contact_values_into_lanes(&mut self, values: &[Expr<'g>]) -> Option<Vec<Expr<'g>>> {
        let mut out = values.to_vec();
        for row in self.groups.iter().flat_map(|group| &group.rows) {
            let all = self.merge.merge_lanes(&row.iter().map(|i| values[*i]).collect::<Vec<_>>())?;
            row.iter().enumerate().for_each(|(lane, i)| out[*i] = all.lane(lane));
        }
        Some(out)
    }

    /// Merges matrix rows into SIMD lanes, one row for each contact velocity with a column for each velocity.
    /// Each row depends only on the limb of its contact velocity.
    pub fn merge_jacobian_rows_into_lanes(&mut self, rows: &Matrix<'g>) -> Option<Matrix<'g>> {
        let mut out = vec![Vec::new(); self.count];
        for numbers in self.groups.iter().flat_map(|group| &group.rows) {
            let lanes: Vec<&[Expr<'g>]> = numbers.iter().map(|i| rows[*i].as_slice()).collect();
            let all = self.limbs.merged_rows(&lanes, &mut self.merge)?;
            for (lane, i) in numbers.iter().enumerate() {
                let entry_in_lane = |(index, of): (usize, Option<usize>)| match of {
                    Some(of) if of != lane => all[index].zero(),
                    _ => all[index].lane(lane),
                };
                out[*i] = self.limbs.velocity_indices_and_lanes().map(entry_in_lane).collect();
            }
        }
        Some(out)
    }

    /// Returns the sum of square matrices over the velocities, one matrix for each limb, in the groups of
    /// [`limb_contact_velocity_indices`](Self::limb_contact_velocity_indices).
    pub fn sum_limb_matrices(&mut self, groups: &[Vec<Matrix<'g>>]) -> Option<Matrix<'g>> {
        let places: Vec<(usize, Option<usize>)> = self.limbs.velocity_indices_and_lanes().collect();
        let mut sum: Option<Matrix<'g>> = None;
        for lanes in groups {
            let all = self.limbs.merged_square_matrices(lanes, &mut self.merge)?;
            let entry_of_lane_pair =
                |(i, row): (usize, Option<usize>), (j, column): (usize, Option<usize>)| {
                    let entry = all[i][j];
                    match (row, column) {
                        (None, None) => entry.lane_sum(lanes.len()),
                        (Some(a), Some(b)) if a != b => entry.zero(),
                        (Some(lane), _) | (None, Some(lane)) => entry.lane(lane),
                    }
                };
            let row_of_summed_matrix = |row: &(usize, Option<usize>)| {
                places.iter().map(|column| entry_of_lane_pair(*row, *column)).collect()
            };
            let found: Matrix<'g> = places.iter().map(row_of_summed_matrix).collect();
            match &mut sum {
                None => sum = Some(found),
                Some(sum) => {
                    let both = sum.iter_mut().flatten().zip(found.into_iter().flatten());
                    both.for_each(|(sum, more)| *sum += more);
                }
            }
        }
        sum
    }
}
