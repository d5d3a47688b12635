//! Which velocities of a mechanism with alike limbs go together.

use crate::kinematics::{Joint, Spatial};
use crate::mechanism::Model;

/// Velocities of the whole mechanism that are the lanes of one.
#[derive(Clone, Debug)]
pub struct Velocity {
    /// One for each lane; a single one for what is in no limb.
    pub lanes: Vec<usize>,
    /// Of each lane: minus one where the limb's joint moves the other way.
    pub signs: Vec<f64>,
}

/// Where a velocity of the whole mechanism is found.
#[derive(Clone, Copy, Debug)]
pub struct Location {
    /// The velocity that it is, or is a lane of.
    pub index: usize,
    /// Its lane, if it is one of several.
    pub lane: Option<usize>,
}

/// The velocities that are left when corresponding ones are lanes, and the places of all. Each row holds corresponding
/// links. `None` if the joints of limbs are coupled differently.
pub fn paired(
    model: &Model<'_>,
    joints: &[Joint<'_>],
    rows: &[Vec<usize>],
) -> Option<(Vec<Velocity>, Vec<Location>)> {
    let alone = |k| Some(Velocity { lanes: vec![k], signs: vec![1.0] });
    let mut left: Vec<Option<Velocity>> = (0..model.nv()).map(alone).collect();
    for row in rows.iter().filter(|row| row.len() > 1) {
        for (d, dof) in joints[row[0]].dofs.iter().enumerate() {
            let index = |k: &usize| joints[*k].dofs.get(d).map(|dof| dof.index);
            let lanes: Vec<usize> = row.iter().map(index).collect::<Option<_>>()?;
            let sign = |k: &usize| sign_between(&dof.subspace, &joints[*k].dofs[d].subspace);
            let velocity = Velocity { signs: row.iter().map(sign).collect(), lanes };
            match &left[dof.index] {
                Some(known) if known.lanes.len() == 1 => {}
                Some(known) if known.lanes == velocity.lanes => continue,
                _ => return None,
            }
            velocity.lanes[1..].iter().for_each(|k| left[*k] = None);
            left[dof.index] = Some(velocity);
        }
    }
    let velocities: Vec<Velocity> = left.into_iter().flatten().collect();
    let mut places = vec![Location { index: 0, lane: None }; model.nv()];
    for (index, velocity) in velocities.iter().enumerate() {
        for (lane, k) in velocity.lanes.iter().enumerate() {
            places[*k] = Location { index, lane: (velocity.lanes.len() > 1).then_some(lane) };
        }
    }
    Some((velocities, places))
}

/// Minus one if the second of two motions is the opposite of the first, as far as their first numbers tell.
fn sign_between(a: &Spatial<'_>, b: &Spatial<'_>) -> f64 {
    let pairs = a.linear.0.iter().chain(&a.angular.0).zip(b.linear.0.iter().chain(&b.angular.0));
    let mut products = pairs.filter_map(|(x, y)| Some(x.value()? * y.value()?));
    let first = products.find(|product| *product != 0.0);
    if first.is_some_and(|product| product < 0.0) { -1.0 } else { 1.0 }
}
