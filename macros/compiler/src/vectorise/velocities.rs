//! Correspondence between the velocities of a mechanism and those of its vectorised form, in which identical
//! limbs are SIMD lanes.

use crate::kinematics::{Joint, SpatialVector};
use crate::mechanism::Model;

/// Velocity of the vectorised mechanism, one or several velocities of the whole one.
#[derive(Clone, Debug)]
pub struct LaneVelocity {
    /// Index in the whole mechanism of the velocity in each lane; a single index for a velocity outside the
    /// limbs.
    pub lanes: Vec<usize>,
    /// Sign of each SIMD lane: minus one if the limb's joint moves in the opposite direction.
    pub signs: Vec<f64>,
}

/// Position of a velocity of the whole mechanism in the vectorised mechanism.
#[derive(Clone, Copy, Debug)]
pub struct VectorisedVelocityPosition {
    /// Index of the velocity in the vectorised mechanism.
    pub index: usize,
    /// SIMD lane of the velocity, if the vectorised one has several lanes.
    pub lane: Option<usize>,
}

/// Returns the velocities of the vectorised mechanism, and the location of each velocity of the whole
/// mechanism in it. Each row holds corresponding links. Returns `None` if the joints of the limbs are coupled
/// differently.
pub fn vectorised_velocities(
    model: &Model<'_>,
    joints: &[Joint<'_>],
    rows: &[Vec<usize>],
) -> Option<(Vec<LaneVelocity>, Vec<VectorisedVelocityPosition>)> {
    let single_lane_velocity = |k| Some(LaneVelocity { lanes: vec![k], signs: vec![1.0] });
    let mut left: Vec<Option<LaneVelocity>> = (0..model.nv()).map(single_lane_velocity).collect();
    for row in rows.iter().filter(|row| row.len() > 1) {
        for (d, dof) in joints[row[0]].dofs.iter().enumerate() {
            let velocity_index = |k: &usize| joints[*k].dofs.get(d).map(|dof| dof.index);
            let lanes: Vec<usize> = row.iter().map(velocity_index).collect::<Option<_>>()?;
            let sign_of_lane =
                |k: &usize| relative_sign_of_subspaces(&dof.subspace, &joints[*k].dofs[d].subspace);
            let velocity = LaneVelocity { signs: row.iter().map(sign_of_lane).collect(), lanes };
            match &left[dof.index] {
                Some(known) if known.lanes.len() == 1 => {}
                Some(known) if known.lanes == velocity.lanes => continue,
                _ => return None,
            }
            velocity.lanes[1..].iter().for_each(|k| left[*k] = None);
            left[dof.index] = Some(velocity);
        }
    }
    let velocities: Vec<LaneVelocity> = left.into_iter().flatten().collect();
    let mut places = vec![VectorisedVelocityPosition { index: 0, lane: None }; model.nv()];
    for (index, velocity) in velocities.iter().enumerate() {
        for (lane, k) in velocity.lanes.iter().enumerate() {
            places[*k] =
                VectorisedVelocityPosition { index, lane: (velocity.lanes.len() > 1).then_some(lane) };
        }
    }
    Some((velocities, places))
}

/// Returns minus one if two joint motion subspaces have opposite signs in the first component that is a
/// nonzero number in both.
fn relative_sign_of_subspaces(a: &SpatialVector<'_>, b: &SpatialVector<'_>) -> f64 {
    let pairs = a.linear.0.iter().chain(&a.angular.0).zip(b.linear.0.iter().chain(&b.angular.0));
    let mut products = pairs.filter_map(|(x, y)| Some(x.constant_value()? * y.constant_value()?));
    let first = products.find(|product| *product != 0.0);
    if first.is_some_and(|product| product < 0.0) { -1.0 } else { 1.0 }
}
