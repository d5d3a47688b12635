//! Alike limbs as the lanes of one: legs, arms, fingers with the same joints. The mechanism that is left has one limb
//! for each group; what differs between its lanes are constants and inputs. The algorithms run over it as over any other,
//! and where a limb hands something to the link that it hangs from, they take the sum of the lanes.

use super::find::Group;
use super::merge::Merge;
use super::velocities::{Location, Velocity, paired};
use crate::expr::{Expr, Rotation, Vec3};
use crate::kinematics::{Dof, Joint, Spatial};
use crate::mechanism::{InV, Inertia, Link, LinkId, Model, Quantity};
use std::collections::BTreeMap;

/// A mechanism with one limb for each group of alike ones.
pub struct Limbs<'g> {
    /// The mechanism, without springs and the like; its `v` are numbered by the limbs.
    pub model: Model<'g>,
    /// Its joints.
    pub joints: Vec<Joint<'g>>,
    velocities: Vec<Velocity>,
    /// By velocity of the whole mechanism.
    places: Vec<Location>,
    /// Forces of springs, dashpots and the like, by velocity here.
    passive_forces: Vec<Expr<'g>>,
}

/// A limb among alike ones.
#[derive(Clone, Copy, Debug)]
pub struct LimbLane {
    /// The first velocity of the group.
    pub group: usize,
    /// Its lane.
    pub lane: usize,
    /// How many lanes there are.
    pub width: usize,
}

/// Rows that limbs of one group have, one of each limb in turn.
pub struct AlikeRows {
    /// The first velocity of the group.
    pub group: usize,
    /// How many limbs there are.
    pub width: usize,
    /// Numbers of the rows that go together, by lane.
    pub rows: Vec<Vec<usize>>,
}

impl<'g> Limbs<'g> {
    /// The mechanism with its alike limbs as lanes. `passive_forces` gives those of the mechanism, by velocity. `None` if
    /// there are no groups, or limbs are alike in shape alone.
    pub fn of(
        model: &Model<'g>,
        joints: &[Joint<'g>],
        groups: &[Group],
        passive_forces: impl FnOnce() -> Vec<Expr<'g>>,
    ) -> Option<Limbs<'g>> {
        if groups.is_empty() || !model.inertances.is_empty() || !model.acceleration_forces.is_empty() {
            return None;
        }
        let rows = rows(joints.len(), groups);
        let merge = &mut Merge::new(model.graph);
        pair_coordinates(model, &rows, merge);
        let (velocities, places) = paired(model, joints, &rows)?;
        let mut limbs = Limbs {
            model: without_forces(model),
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
            let mut joint = limbs.joint(&row.iter().map(|k| &joints[*k]).collect::<Vec<_>>(), merge)?;
            joint.parent = parent;
            let group = groups.iter().find(|group| group.rows.first() == Some(row));
            joint.limbs = group.map_or(1, |group| group.limbs);
            limbs.joints.push(joint);
            let link = limbs.link(&links, parent, merge)?;
            limbs.model.links.push(link);
        }
        limbs.passive_forces = limbs.lane_groups(&passive_forces(), merge)?;
        limbs.model.velocities.truncate(limbs.velocities.len());
        Some(limbs)
    }

    fn joint(&self, lanes: &[&Joint<'g>], merge: &mut Merge<'g>) -> Option<Joint<'g>> {
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
                (dof.ratio == first.dofs[d].ratio).then(|| dof.subspace.times(self.model.graph.num(*sign)))
            });
            let subspaces: Vec<Spatial<'g>> = of_lanes.collect::<Option<_>>()?;
            dofs.push(Dof { index, ratio: dof.ratio, subspace: merged_spatial(&subspaces, merge)? });
        }
        if lanes.len() == 1 {
            return Some(Joint { dofs, ..first.clone() });
        }
        let rotations: Vec<&Rotation<'g>> = lanes.iter().map(|j| &j.rotation).collect();
        let translations: Vec<Vec3<'g>> = lanes.iter().map(|j| j.translation).collect();
        Some(Joint {
            parent: None,
            rotation: Rotation::side_by_side(&rotations, &mut |e| merge.lanes(e))?,
            translation: merged_vector(&translations, merge)?,
            dofs,
            drift: None,
            limbs: 1,
        })
    }

    fn link(&self, lanes: &[&Link<'g>], parent: Option<LinkId>, merge: &mut Merge<'g>) -> Option<Link<'g>> {
        let first = *lanes.first()?;
        let inertias: Vec<Inertia<'g>> = lanes.iter().map(|l| l.inertia).collect();
        let mut motion = first.motion.clone();
        motion.place_velocities(|v| InV(self.places[v.0].index));
        Some(Link {
            parent,
            placement: first.placement.clone(),
            motion,
            inertia: merged_inertia(&inertias, merge)?,
        })
    }

    /// One expression for each velocity here, from those of the whole mechanism.
    fn lane_groups(&self, whole: &[Expr<'g>], merge: &mut Merge<'g>) -> Option<Vec<Expr<'g>>> {
        let g = self.model.graph;
        let gather = |velocity: &Velocity| {
            let lanes: Vec<Expr<'g>> = velocity.lanes.iter().map(|k| whole[*k]).collect();
            Some(g.lane_constants(&velocity.signs) * merge.lanes(&lanes)?)
        };
        self.velocities.iter().map(gather).collect()
    }

    /// Symbols of a kind, one expression for each velocity here.
    pub fn symbols(&self, of: impl Fn(usize) -> Quantity) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let gather = |velocity: &Velocity| {
            let symbols: Vec<_> = velocity.lanes.iter().map(|k| of(*k).symbol()).collect();
            g.lane_constants(&velocity.signs) * g.lane_symbols(&symbols)
        };
        self.velocities.iter().map(gather).collect()
    }

    /// By velocity here: the group of limbs that it belongs to, as the first velocity of these; none for those of trunks.
    pub fn groups(&self) -> Vec<Option<usize>> {
        let mut groups = vec![None; self.velocities.len()];
        let mut of_links: Vec<Option<usize>> = Vec::new();
        for joint in &self.joints {
            let above = joint.parent.and_then(|p| of_links[p.0]);
            let first = || joint.dofs.first().map(|dof| dof.index);
            let group = above.or_else(|| if joint.limbs > 1 { first() } else { None });
            joint.dofs.iter().for_each(|dof| groups[dof.index] = group);
            of_links.push(group);
        }
        groups
    }

    /// How many lanes a velocity has.
    pub fn width(&self, index: usize) -> usize {
        self.velocities[index].lanes.len()
    }

    /// The one limb whose velocities a row has, numbered by the whole mechanism, if it has those of one. Limbs that stand in several
    /// lanes have none.
    pub fn lane_of(&self, row: &[Expr<'g>], groups: &[Option<usize>]) -> Option<LimbLane> {
        let entries = row.iter().zip(&self.places).filter(|(entry, _)| !entry.is_zero());
        let mut found: Option<LimbLane> = None;
        for (_, place) in entries {
            let (Some(group), Some(lane)) = (groups[place.index], place.lane) else { continue };
            let lanes = &self.velocities[place.index].lanes;
            if (1..lanes.len()).any(|k| lanes[..k].contains(&lanes[k])) {
                return None;
            }
            let here = LimbLane { group, lane, width: lanes.len() };
            if found.is_some_and(|known| (known.group, known.lane) != (group, lane)) {
                return None;
            }
            found = Some(here);
        }
        found
    }

    /// Rows, by velocity of the whole mechanism, as the limbs have them: the first of each limb of a group go together, then the second,
    /// and so on. `None` unless each row moves one limb of several alike ones, and each of these has as many.
    pub fn alike_rows(&self, rows: &[Vec<Expr<'g>>]) -> Option<Vec<AlikeRows>> {
        let groups = self.groups();
        let mut found: BTreeMap<usize, Vec<Vec<usize>>> = BTreeMap::new();
        for (i, row) in rows.iter().enumerate() {
            let LimbLane { group, lane, width } = self.lane_of(row, &groups)?;
            found.entry(group).or_insert_with(|| vec![Vec::new(); width])[lane].push(i);
        }
        let alike = |(group, lanes): (usize, Vec<Vec<usize>>)| {
            let count = lanes.first()?.len();
            let row = |k: usize| lanes.iter().map(|numbers| numbers[k]).collect();
            let is_even = lanes.iter().all(|numbers| numbers.len() == count);
            is_even.then(|| AlikeRows { group, width: lanes.len(), rows: (0..count).map(row).collect() })
        };
        found.into_iter().map(alike).collect()
    }

    /// Rows that go together, by velocity of the whole mechanism, as one in lanes by velocity here, with the signs that they have there.
    /// `None` if they are built differently.
    pub fn merged_rows(&self, rows: &[&[Expr<'g>]], merge: &mut Merge<'g>) -> Option<Vec<Expr<'g>>> {
        let entry = |velocity: &Velocity| {
            let of = |(lane, row): (usize, &&[Expr<'g>])| self.velocity_in(velocity, lane).map(|k| row[k]);
            let lanes = rows.iter().enumerate().map(|of_lane| of(of_lane).unwrap_or(self.model.graph.zero()));
            merge.lanes(&lanes.collect::<Vec<_>>())
        };
        self.velocities.iter().map(entry).collect()
    }

    /// A square matrix of each lane, by velocities of the whole mechanism, as one in lanes; as [`merged_rows`](Self::merged_rows).
    pub fn merged_squares(
        &self,
        lanes: &[Vec<Vec<Expr<'g>>>],
        merge: &mut Merge<'g>,
    ) -> Option<Vec<Vec<Expr<'g>>>> {
        let row = |velocity: &Velocity| {
            let of = |(lane, matrix): (usize, &'_ Vec<Vec<Expr<'g>>>)| {
                self.velocity_in(velocity, lane).map(|k| matrix[k].clone())
            };
            let rows: Option<Vec<Vec<Expr<'g>>>> = lanes.iter().enumerate().map(of).collect();
            match rows {
                Some(rows) => self.merged_rows(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>(), merge),
                None => Some(vec![self.model.graph.zero(); self.velocities.len()]),
            }
        };
        self.velocities.iter().map(row).collect()
    }

    /// Which velocity of the whole mechanism one here is in a lane; of what stands alone the same in all.
    fn velocity_in(&self, velocity: &Velocity, lane: usize) -> Option<usize> {
        let is_alone = velocity.lanes.len() == 1;
        velocity.lanes.get(if is_alone { 0 } else { lane }).copied()
    }

    /// By velocity of the whole mechanism: the one here, and its lane if it is one of several.
    pub fn places(&self) -> impl Iterator<Item = (usize, Option<usize>)> {
        self.places.iter().map(|place| (place.index, place.lane))
    }

    /// Rows of the whole mechanism that belong to the limbs of a group, one of each, as one in lanes.
    pub fn side_by_side(&self, rows: &[&[Expr<'g>]]) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let merge = &mut Merge::new(g);
        let entry = |velocity: &Velocity| {
            // What stands alone is the trunk's, and of other limbs there is nothing.
            let of = |(lane, row): (usize, &&[Expr<'g>])| match self.velocity_in(velocity, lane) {
                Some(k) => row[k],
                None => g.zero(),
            };
            let lanes: Vec<Expr<'g>> = rows.iter().enumerate().map(of).collect();
            let all = merge.lanes(&lanes).unwrap_or_else(|| joined(&lanes));
            if velocity.lanes.len() == 1 { all } else { g.lane_constants(&velocity.signs) * all }
        };
        self.velocities.iter().map(entry).collect()
    }

    /// One expression for each velocity of the whole mechanism, from what `of` makes of its index here and its lane.
    pub fn scattered_from(&self, of: impl Fn(usize, usize) -> Expr<'g>) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let scatter = |place: &Location| match place.lane {
            Some(k) => (g.lane_constants(&self.velocities[place.index].signs) * of(place.index, k)).lane(k),
            None => of(place.index, 0),
        };
        self.places.iter().map(scatter).collect()
    }

    /// Forces of springs, dashpots and the like.
    pub fn passive_forces(&self) -> &[Expr<'g>] {
        &self.passive_forces
    }

    /// One expression for each velocity of the whole mechanism, from those here.
    pub fn scattered(&self, values: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let scatter = |place: &Location| match place.lane {
            Some(k) => (g.lane_constants(&self.velocities[place.index].signs) * values[place.index]).lane(k),
            None => values[place.index],
        };
        self.places.iter().map(scatter).collect()
    }

    /// By velocity of the whole mechanism: whether it stands for itself here, and is one of those marked here.
    pub fn alone_and(&self, marked: &[bool]) -> Vec<bool> {
        self.places.iter().map(|place| place.lane.is_none() && marked[place.index]).collect()
    }

    /// The matrix of the whole mechanism, by rows, from that of the velocities here.
    pub fn scattered_matrix(&self, matrix: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let signs = |index: usize| g.lane_constants(&self.velocities[index].signs);
        let mut whole = Vec::with_capacity(self.places.len() * self.places.len());
        for &Location { index: i, lane: row } in &self.places {
            for &Location { index: j, lane: column } in &self.places {
                let entry = matrix[i][j];
                whole.push(match (row, column) {
                    (None, None) => entry,
                    (Some(a), Some(b)) if a != b => g.zero(),
                    (Some(k), None) => (signs(i) * entry).lane(k),
                    (None, Some(k)) => (signs(j) * entry).lane(k),
                    (Some(k), Some(_)) => (signs(i) * signs(j) * entry).lane(k),
                });
            }
        }
        whole
    }
}

/// Expressions side by side; their number is a power of two.
pub fn joined<'g>(lanes: &[Expr<'g>]) -> Expr<'g> {
    match lanes.split_at(lanes.len() / 2) {
        ([], _) => lanes[0],
        (a, b) => joined(a).joined(a.len(), joined(b)),
    }
}

/// By link: those that become one with it, itself first; none for those that are not the first.
fn rows(links: usize, groups: &[Group]) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = (0..links).map(|k| vec![k]).collect();
    for row in groups.iter().flat_map(|group| &group.rows) {
        row.iter().for_each(|k| rows[*k].clear());
        rows[row[0]].clone_from(row);
    }
    rows
}

/// Tells which entries of `q` become the lanes of one.
fn pair_coordinates(model: &Model<'_>, rows: &[Vec<usize>], merge: &mut Merge<'_>) {
    for row in rows.iter().filter(|row| row.len() > 1) {
        let entries = |k: &usize| model.links[*k].motion.configuration();
        for i in 0..entries(&row[0]).len() {
            let symbol = |k: &usize| entries(k).nth(i).map(|q| Quantity::Configuration(q).symbol());
            merge.pair_symbols(row.iter().filter_map(symbol).collect());
        }
    }
}

/// A mechanism without springs and the like.
fn without_forces<'g>(model: &Model<'g>) -> Model<'g> {
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

fn merged_vector<'g>(lanes: &[Vec3<'g>], merge: &mut Merge<'g>) -> Option<Vec3<'g>> {
    let mut vector = *lanes.first()?;
    for k in 0..3 {
        vector.0[k] = merge.lanes(&lanes.iter().map(|v| v[k]).collect::<Vec<_>>())?;
    }
    Some(vector)
}

fn merged_spatial<'g>(lanes: &[Spatial<'g>], merge: &mut Merge<'g>) -> Option<Spatial<'g>> {
    let linear: Vec<Vec3<'g>> = lanes.iter().map(|s| s.linear).collect();
    let angular: Vec<Vec3<'g>> = lanes.iter().map(|s| s.angular).collect();
    Some(Spatial { linear: merged_vector(&linear, merge)?, angular: merged_vector(&angular, merge)? })
}

fn merged_inertia<'g>(lanes: &[Inertia<'g>], merge: &mut Merge<'g>) -> Option<Inertia<'g>> {
    let mut inertia = *lanes.first()?;
    let mut each =
        |of: &dyn Fn(&Inertia<'g>) -> Expr<'g>| merge.lanes(&lanes.iter().map(of).collect::<Vec<_>>());
    inertia.mass = each(&|i| i.mass)?;
    for k in 0..3 {
        inertia.moment.0[k] = each(&|i| i.moment[k])?;
        inertia.tensor.diagonal[k] = each(&|i| i.tensor.diagonal[k])?;
        inertia.tensor.off[k] = each(&|i| i.tensor.off[k])?;
    }
    Some(inertia)
}
