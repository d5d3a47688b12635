//! Identical limbs, such as legs, arms or fingers, as the SIMD lanes of one limb. The vectorised mechanism
//! has one limb for each group; its lanes differ in constants and inputs. The algorithms process it like any
//! other mechanism and sum over the lanes where a limb passes a force or an inertia to its parent link.

use super::find::LimbGroup;
use super::merge::LaneMerger;
use super::velocities::{LaneVelocity, VectorisedVelocityPosition, vectorised_velocities};
use crate::expr::{Expr, Rotation, Vec3};
use crate::kinematics::{Dof, Joint, SpatialVector};
use crate::mechanism::{InV, Inertia, Link, LinkId, Model, Quantity};
use std::collections::BTreeMap;

/// Vectorised mechanism with one limb for each group of identical limbs.
pub struct VectorisedMechanism<'g> {
    /// Vectorised mechanism without passive forces. Its velocity vector `v` has one entry per velocity of the
    /// vectorised mechanism.
    pub model: Model<'g>,
    /// Joints of the vectorised mechanism, whose identical limbs are SIMD lanes.
    pub joints: Vec<Joint<'g>>,
    velocities: Vec<LaneVelocity>,
    /// Location of each velocity of the whole mechanism among those of the vectorised mechanism.
    places: Vec<VectorisedVelocityPosition>,
    /// Passive force for each velocity of the vectorised mechanism, in which identical limbs are SIMD lanes.
    passive_forces: Vec<Expr<'g>>,
}

/// One limb of a group of identical limbs, given by its SIMD lane.
#[derive(Clone, Copy, Debug)]
pub struct LimbLane {
    /// Index of the first velocity of the limb group, which identifies the group.
    pub group: usize,
    /// SIMD lane to which the limb belongs.
    pub lane: usize,
    /// Number of SIMD lanes of the limb group.
    pub width: usize,
}

/// Corresponding matrix rows of the identical limbs of one group.
pub struct LimbRows {
    /// Index of the first velocity of the limb group, which identifies the group.
    pub group: usize,
    /// Number of identical limbs in the group.
    pub width: usize,
    /// Indices of the matrix rows that correspond to each other, one per SIMD lane.
    pub rows: Vec<Vec<usize>>,
}

impl<'g> VectorisedMechanism<'g> {
    /// Returns the mechanism with its identical limbs as SIMD lanes. `passive_forces` returns one passive
    /// force per velocity of the whole mechanism. Returns `None` if there are no groups, or if limbs of one
    /// shape cannot be merged.
    pub fn new(
        model: &Model<'g>,
        joints: &[Joint<'g>],
        groups: &[LimbGroup],
        passive_forces: impl FnOnce() -> Vec<Expr<'g>>,
    ) -> Option<VectorisedMechanism<'g>> {
        if groups.is_empty() || !model.inertances.is_empty() || !model.acceleration_forces.is_empty() {
            return None;
        }
        let rows = corresponding_links(joints.len(), groups);
        let merge = &mut LaneMerger::new(model.graph);
        pair_coordinates(model, &rows, merge);
        let (velocities, places) = vectorised_velocities(model, joints, &rows)?;
        let mut limbs = VectorisedMechanism {
            model: model_without_passive_forces(model),
            joints: Vec::new(),
            velocities,
            places,
            passive_forces: Vec::new(),
        };
        limbs.model.links.clear();
        let mut numbers = vec![LinkId(0); joints.len()];
        for row in rows.iter().filter(|row| !row.is_empty()) {
            row.iter().for_each(|k| numbers[*k] = LinkId(limbs.joints.len()));
            let parent = joints[row[0]].parent.map(|p| numbers[p.0]);
            let links: Vec<&Link<'g>> = row.iter().map(|k| &model.links[*k]).collect();
            let mut joint =
                limbs.merge_joint_lanes(&row.iter().map(|k| &joints[*k]).collect::<Vec<_>>(), merge)?;
            joint.parent = parent;
            let group = groups.iter().find(|group| group.rows.first() == Some(row));
            joint.limbs = group.map_or(1, |group| group.limbs);
            limbs.joints.push(joint);
            let link = limbs.merge_link_lanes(&links, parent, merge)?;
            limbs.model.links.push(link);
        }
        limbs.passive_forces = limbs.merge_velocity_expressions(&passive_forces(), merge)?;
        limbs.model.velocities.truncate(limbs.velocities.len());
        Some(limbs)
    }

    fn merge_joint_lanes(&self, lanes: &[&Joint<'g>], merge: &mut LaneMerger<'g>) -> Option<Joint<'g>> {
        let first = *lanes.first()?;
        let mut dofs = Vec::new();
        for (d, dof) in first.dofs.iter().enumerate() {
            let index = self.places[dof.index].index;
            if lanes.len() == 1 {
                dofs.push(Dof { index, ..dof.clone() });
                continue;
            }
            let signs = &self.velocities[index].signs;
            let of_lanes = lanes.iter().zip(signs).map(|(joint, sign)| {
                let dof = joint.dofs.get(d)?;
                (dof.ratio == first.dofs[d].ratio)
                    .then(|| dof.subspace.times_scalar(self.model.graph.num(*sign)))
            });
            let subspaces: Vec<SpatialVector<'g>> = of_lanes.collect::<Option<_>>()?;
            dofs.push(Dof { index, ratio: dof.ratio, subspace: merged_spatial(&subspaces, merge)? });
        }
        if lanes.len() == 1 {
            return Some(Joint { dofs, ..first.clone() });
        }
        let rotations: Vec<&Rotation<'g>> = lanes.iter().map(|j| &j.rotation).collect();
        let translations: Vec<Vec3<'g>> = lanes.iter().map(|j| j.translation).collect();
        Some(Joint {
            parent: None,
            rotation: Rotation::merge_into_lanes(&rotations, &mut |e| merge.merge_lanes(e))?,
            translation: merged_vector(&translations, merge)?,
            dofs,
            drift: None,
            limbs: 1,
        })
    }

    fn merge_link_lanes(
        &self,
        lanes: &[&Link<'g>],
        parent: Option<LinkId>,
        merge: &mut LaneMerger<'g>,
    ) -> Option<Link<'g>> {
        let first = *lanes.first()?;
        let inertias: Vec<Inertia<'g>> = lanes.iter().map(|l| l.inertia).collect();
        let mut motion = first.motion.clone();
        motion.renumber_velocities(|v| InV(self.places[v.0].index));
        Some(Link {
            parent,
            placement: first.placement.clone(),
            motion,
            inertia: merged_inertia(&inertias, merge)?,
        })
    }

    /// Merges one expression per velocity of the whole mechanism into one expression per velocity of the
    /// vectorised mechanism.
    fn merge_velocity_expressions(
        &self,
        whole: &[Expr<'g>],
        merge: &mut LaneMerger<'g>,
    ) -> Option<Vec<Expr<'g>>> {
        let g = self.model.graph;
        let merge_signed_lane_values = |velocity: &LaneVelocity| {
            let lanes: Vec<Expr<'g>> = velocity.lanes.iter().map(|k| whole[*k]).collect();
            Some(g.lanes_from_constants(&velocity.signs) * merge.merge_lanes(&lanes)?)
        };
        self.velocities.iter().map(merge_signed_lane_values).collect()
    }

    /// Returns the symbols of a quantity, such as the velocities, one entry per velocity of the vectorised
    /// mechanism.
    pub fn lane_symbols_per_velocity(&self, of: impl Fn(usize) -> Quantity) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let gather_lane_symbols = |velocity: &LaneVelocity| {
            let symbols: Vec<_> = velocity.lanes.iter().map(|k| of(*k).symbol()).collect();
            g.lanes_from_constants(&velocity.signs) * g.lane_input_of_symbols(&symbols)
        };
        self.velocities.iter().map(gather_lane_symbols).collect()
    }

    /// Returns the limb group of each velocity of the vectorised mechanism, identified by the first velocity
    /// of the group; `None` outside limbs.
    pub fn group_of_each_velocity(&self) -> Vec<Option<usize>> {
        let mut groups = vec![None; self.velocities.len()];
        let mut of_links: Vec<Option<usize>> = Vec::new();
        for joint in &self.joints {
            let above = joint.parent.and_then(|p| of_links[p.0]);
            let first_velocity_of_joint = || joint.dofs.first().map(|dof| dof.index);
            let group = above.or_else(|| if joint.limbs > 1 { first_velocity_of_joint() } else { None });
            joint.dofs.iter().for_each(|dof| groups[dof.index] = group);
            of_links.push(group);
        }
        groups
    }

    /// Returns the number of SIMD lanes of a velocity of the vectorised mechanism.
    pub fn lane_count_of_velocity(&self, index: usize) -> usize {
        self.velocities[index].lanes.len()
    }

    /// Returns the limb whose velocities have nonzero entries in a matrix row of the whole mechanism. Returns
    /// `None` unless this is a single limb in one SIMD lane.
    pub fn limb_of_row(&self, row: &[Expr<'g>], groups: &[Option<usize>]) -> Option<LimbLane> {
        let entries = row.iter().zip(&self.places).filter(|(entry, _)| !entry.is_zero());
        let mut found: Option<LimbLane> = None;
        for (_, place) in entries {
            let (Some(group), Some(lane)) = (groups[place.index], place.lane) else { continue };
            let lanes = &self.velocities[place.index].lanes;
            if (1..lanes.len()).any(|k| lanes[..k].contains(&lanes[k])) {
                return None;
            }
            let limb = LimbLane { group, lane, width: lanes.len() };
            if found.is_some_and(|known| (known.group, known.lane) != (group, lane)) {
                return None;
            }
            found = Some(limb);
        }
        found
    }

    /// Groups matrix rows of the whole mechanism by limb: the first rows of all limbs of a group correspond,
    /// then the second rows, and so on. Returns `None` unless each row belongs to one limb of a group and all
    /// limbs have the same number of rows.
    pub fn group_rows_by_limb(&self, rows: &[Vec<Expr<'g>>]) -> Option<Vec<LimbRows>> {
        let groups = self.group_of_each_velocity();
        let mut found: BTreeMap<usize, Vec<Vec<usize>>> = BTreeMap::new();
        for (i, row) in rows.iter().enumerate() {
            let LimbLane { group, lane, width } = self.limb_of_row(row, &groups)?;
            found.entry(group).or_insert_with(|| vec![Vec::new(); width])[lane].push(i);
        }
        let rows_of_limb_group = |(group, lanes): (usize, Vec<Vec<usize>>)| {
            let count = lanes.first()?.len();
            let corresponding_rows_of_limbs = |k: usize| lanes.iter().map(|numbers| numbers[k]).collect();
            let is_even = lanes.iter().all(|numbers| numbers.len() == count);
            is_even.then(|| LimbRows {
                group,
                width: lanes.len(),
                rows: (0..count).map(corresponding_rows_of_limbs).collect(),
            })
        };
        found.into_iter().map(rows_of_limb_group).collect()
    }

    /// Merges corresponding matrix rows of the whole mechanism, one per SIMD lane, into one row of the
    /// vectorised mechanism. The signs of the lanes are not applied. Returns `None` if the rows have
    /// different structures.
    pub fn merged_rows(&self, rows: &[&[Expr<'g>]], merge: &mut LaneMerger<'g>) -> Option<Vec<Expr<'g>>> {
        let merged_limb_entry = |velocity: &LaneVelocity| {
            let row_entry_of_lane =
                |(lane, row): (usize, &&[Expr<'g>])| self.velocity_of_lane(velocity, lane).map(|k| row[k]);
            let lanes = rows
                .iter()
                .enumerate()
                .map(|of_lane| row_entry_of_lane(of_lane).unwrap_or(self.model.graph.zero()));
            merge.merge_lanes(&lanes.collect::<Vec<_>>())
        };
        self.velocities.iter().map(merged_limb_entry).collect()
    }

    /// Merges square matrices of the whole mechanism, one per SIMD lane, into one of the vectorised
    /// mechanism, like [`merged_rows`](Self::merged_rows).
    pub fn merged_square_matrices(
        &self,
        lanes: &[Vec<Vec<Expr<'g>>>],
        merge: &mut LaneMerger<'g>,
    ) -> Option<Vec<Vec<Expr<'g>>>> {
        let merged_row = |velocity: &LaneVelocity| {
            let matrix_row_of_lane = |(lane, matrix): (usize, &'_ Vec<Vec<Expr<'g>>>)| {
                self.velocity_of_lane(velocity, lane).map(|k| matrix[k].clone())
            };
            let rows: Option<Vec<Vec<Expr<'g>>>> = lanes.iter().enumerate().map(matrix_row_of_lane).collect();
            match rows {
                Some(rows) => self.merged_rows(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>(), merge),
                None => Some(vec![self.model.graph.zero(); self.velocities.len()]),
            }
        };
        self.velocities.iter().map(merged_row).collect()
    }

    /// Returns the velocity of the whole mechanism that a velocity is in a lane; the same in all lanes
    /// outside the limbs.
    fn velocity_of_lane(&self, velocity: &LaneVelocity, lane: usize) -> Option<usize> {
        let is_alone = velocity.lanes.len() == 1;
        velocity.lanes.get(if is_alone { 0 } else { lane }).copied()
    }

    /// Returns, for each velocity of the whole mechanism, its index in the vectorised mechanism and its SIMD
    /// lane, if it has one.
    pub fn velocity_indices_and_lanes(&self) -> impl Iterator<Item = (usize, Option<usize>)> {
        self.places.iter().map(|place| (place.index, place.lane))
    }

    /// Combines matrix rows of the whole mechanism, one for each limb of a group, as SIMD lanes of one row of
    /// the vectorised mechanism.
    pub fn merge_limb_rows_into_lanes(&self, rows: &[&[Expr<'g>]]) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let merge = &mut LaneMerger::new(g);
        let entry_in_lanes = |velocity: &LaneVelocity| {
            // Velocities outside the limbs are common to all rows; those of other groups are absent.
            let row_entry_of_lane =
                |(lane, row): (usize, &&[Expr<'g>])| match self.velocity_of_lane(velocity, lane) {
                    Some(k) => row[k],
                    None => g.zero(),
                };
            let lanes: Vec<Expr<'g>> = rows.iter().enumerate().map(row_entry_of_lane).collect();
            let all = merge.merge_lanes(&lanes).unwrap_or_else(|| join_lanes(&lanes));
            if velocity.lanes.len() == 1 { all } else { g.lanes_from_constants(&velocity.signs) * all }
        };
        self.velocities.iter().map(entry_in_lanes).collect()
    }

    /// Returns an expression for each velocity of the whole mechanism. `of` receives the index of that
    /// velocity in the vectorised mechanism, and its lane.
    pub fn scatter_lanes_to_velocities(&self, of: impl Fn(usize, usize) -> Expr<'g>) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let expression_at_vectorised_position = |place: &VectorisedVelocityPosition| match place.lane {
            Some(k) => {
                (g.lanes_from_constants(&self.velocities[place.index].signs) * of(place.index, k)).lane(k)
            }
            None => of(place.index, 0),
        };
        self.places.iter().map(expression_at_vectorised_position).collect()
    }

    /// Returns the passive forces, one entry per velocity of the vectorised mechanism.
    pub fn passive_forces(&self) -> &[Expr<'g>] {
        &self.passive_forces
    }

    /// Splits one expression per velocity of the vectorised mechanism into one expression per velocity of the
    /// whole mechanism.
    pub fn scatter_to_velocities(&self, values: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let expression_at_vectorised_position = |place: &VectorisedVelocityPosition| match place.lane {
            Some(k) => {
                (g.lanes_from_constants(&self.velocities[place.index].signs) * values[place.index]).lane(k)
            }
            None => values[place.index],
        };
        self.places.iter().map(expression_at_vectorised_position).collect()
    }

    /// Returns, for each velocity of the whole mechanism, whether it is outside the limbs and `marked` is
    /// true for it in the vectorised mechanism.
    pub fn marked_velocities_outside_limbs(&self, marked: &[bool]) -> Vec<bool> {
        self.places.iter().map(|place| place.lane.is_none() && marked[place.index]).collect()
    }

    /// Splits a matrix of the vectorised mechanism into the matrix of the whole mechanism, row by row.
    pub fn whole_mechanism_matrix(&self, matrix: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let lane_signs = |index: usize| g.lanes_from_constants(&self.velocities[index].signs);
        let mut whole = Vec::with_capacity(self.places.len() * self.places.len());
        for &VectorisedVelocityPosition { index: i, lane: row } in &self.places {
            for &VectorisedVelocityPosition { index: j, lane: column } in &self.places {
                let entry = matrix[i][j];
                whole.push(match (row, column) {
                    (None, None) => entry,
                    (Some(a), Some(b)) if a != b => g.zero(),
                    (Some(k), None) => (lane_signs(i) * entry).lane(k),
                    (None, Some(k)) => (lane_signs(j) * entry).lane(k),
                    (Some(k), Some(_)) => (lane_signs(i) * lane_signs(j) * entry).lane(k),
                });
            }
        }
        whole
    }
}

/// Joins expressions into the SIMD lanes of one expression. The number of expressions is a power of two.
pub fn join_lanes<'g>(lanes: &[Expr<'g>]) -> Expr<'g> {
    match lanes.split_at(lanes.len() / 2) {
        ([], _) => lanes[0],
        (a, b) => join_lanes(a).append_lanes(a.len(), join_lanes(b)),
    }
}

/// Returns for each link the corresponding links of its group, itself first; an empty list for links of later
/// limbs.
fn corresponding_links(links: usize, groups: &[LimbGroup]) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = (0..links).map(|k| vec![k]).collect();
    for row in groups.iter().flat_map(|group| &group.rows) {
        row.iter().for_each(|k| rows[*k].clear());
        rows[row[0]].clone_from(row);
    }
    rows
}

/// Declares to the merger which entries of `q` correspond.
fn pair_coordinates(model: &Model<'_>, rows: &[Vec<usize>], merge: &mut LaneMerger<'_>) {
    for row in rows.iter().filter(|row| row.len() > 1) {
        let configuration_indices = |k: &usize| model.links[*k].motion.configuration_range();
        for i in 0..configuration_indices(&row[0]).len() {
            let configuration_symbol =
                |k: &usize| configuration_indices(k).nth(i).map(|q| Quantity::Configuration(q).symbol());
            merge.pair_symbols(row.iter().filter_map(configuration_symbol).collect());
        }
    }
}

/// Returns a copy of the mechanism without passive forces.
fn model_without_passive_forces<'g>(model: &Model<'g>) -> Model<'g> {
    let mut model = model.clone();
    model.springs.clear();
    model.dashpots.clear();
    model.frictions.clear();
    model.potentials.clear();
    model.dissipations.clear();
    model.loads.clear();
    model.passive = None;
    model
}

fn merged_vector<'g>(lanes: &[Vec3<'g>], merge: &mut LaneMerger<'g>) -> Option<Vec3<'g>> {
    let mut vector = *lanes.first()?;
    for k in 0..3 {
        vector.0[k] = merge.merge_lanes(&lanes.iter().map(|v| v[k]).collect::<Vec<_>>())?;
    }
    Some(vector)
}

fn merged_spatial<'g>(lanes: &[SpatialVector<'g>], merge: &mut LaneMerger<'g>) -> Option<SpatialVector<'g>> {
    let linear: Vec<Vec3<'g>> = lanes.iter().map(|s| s.linear).collect();
    let angular: Vec<Vec3<'g>> = lanes.iter().map(|s| s.angular).collect();
    Some(SpatialVector { linear: merged_vector(&linear, merge)?, angular: merged_vector(&angular, merge)? })
}

fn merged_inertia<'g>(lanes: &[Inertia<'g>], merge: &mut LaneMerger<'g>) -> Option<Inertia<'g>> {
    let mut inertia = *lanes.first()?;
    let mut each =
        |of: &dyn Fn(&Inertia<'g>) -> Expr<'g>| merge.merge_lanes(&lanes.iter().map(of).collect::<Vec<_>>());
    inertia.mass = each(&|i| i.mass)?;
    for k in 0..3 {
        inertia.moment.0[k] = each(&|i| i.moment[k])?;
        inertia.tensor.diagonal[k] = each(&|i| i.tensor.diagonal[k])?;
        inertia.tensor.off[k] = each(&|i| i.tensor.off[k])?;
    }
    Some(inertia)
}
