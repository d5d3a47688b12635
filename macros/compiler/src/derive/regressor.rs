//! The functions of the option `regressor`: the dynamics as linear functions of the mass properties, and the
//! minimal set of identifiable combinations (base parameters).

use super::output::AssociatedConstant;
use crate::expr::Expr;
use crate::kinematics::{self, Joint};
use crate::mechanics;
use crate::mechanics::independence::{ColumnLinearDependence, classify_columns};
use crate::mechanics::regressor::{
    COUNT, NAMES, RegressorFrame, inertia_from_parameters, inertial_parameters, regressor_columns,
};
use crate::mechanism::{Inertia, LinkId, Model, NamedFrame, Pose, Quantity, SuppliedQuantity};
use crate::passes::{RegroupOptions, VanishingMomentConvention, move_inertias_to_parents};

/// Data for the functions of parameter identification: regressors and base parameters.
pub(super) struct IdentificationFunctions<'a, 'g> {
    model: &'a Model<'g>,
    /// First declared body of each link that has bodies.
    bodies: Vec<&'a NamedFrame<'g>>,
    base: BaseParameters<'g>,
}

/// Base parameters of a model: the combinations of inertial parameters that affect its motion.
struct BaseParameters<'g> {
    /// Link of each base parameter, and index among the ten parameters about the link's own frame.
    entries: Vec<(usize, usize)>,
    /// Combination of the bodies' parameters that replaces this parameter.
    values: Vec<Expr<'g>>,
    /// Generalized forces per unit of each base parameter.
    columns: Vec<Vec<Expr<'g>>>,
}

impl<'a, 'g> IdentificationFunctions<'a, 'g> {
    pub(super) fn new(model: &'a Model<'g>, joints: &[Joint<'g>]) -> IdentificationFunctions<'a, 'g> {
        let first_massive_frame =
            |link: usize| model.frames.iter().find(|f| f.massive && f.link == Some(LinkId(link)));
        let bodies: Vec<&NamedFrame<'g>> = (0..model.links.len()).filter_map(first_massive_frame).collect();
        let base = derive_base_parameters(model, joints, &bodies);
        IdentificationFunctions { model, bodies, base }
    }

    /// Returns the numbers of bodies and of base parameters.
    pub(super) fn body_and_base_parameter_counts(&self) -> [usize; 2] {
        [self.bodies.len(), self.base.entries.len()]
    }

    /// Returns the names of the bodies and of the base parameters.
    pub(super) fn identification_name_constants(&self) -> Vec<AssociatedConstant> {
        let body_or_velocity_name_of_link = |k: usize| {
            let body = self.bodies.iter().find(|body| body.link == Some(LinkId(k)));
            let first_velocity_index_of_link =
                || kinematics::joints_of_model(self.model)[k].dofs.first().map(|d| d.index);
            let name_of_first_velocity = || {
                first_velocity_index_of_link().map_or(String::new(), |v| self.model.velocities[v].0.clone())
            };
            body.map_or_else(name_of_first_velocity, |body| body.name.clone())
        };
        let base = self
            .base
            .entries
            .iter()
            .map(|(k, p)| format!("{}.{}", body_or_velocity_name_of_link(*k), NAMES[*p]));
        let bodies: Vec<String> = self.bodies.iter().map(|body| body.name.clone()).collect();
        AssociatedConstant::regressor_name_constants(&bodies, &base.collect::<Vec<String>>())
    }

    pub(super) fn joint_torque_regressor(&self, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
        let (v, a) = (mechanics::velocity_symbols(self.model), mechanics::acceleration_symbols(self.model));
        let sites: Vec<RegressorFrame<'g>> =
            self.bodies.iter().filter_map(|body| regressor_frame_of_body(body)).collect();
        let all: Vec<(usize, usize)> =
            (0..sites.len()).flat_map(|k| (0..COUNT).map(move |p| (k, p))).collect();
        regressor_columns(self.model, joints, &v, &a, &sites, &all).concat()
    }

    pub(super) fn base_regressor(&self) -> Vec<Expr<'g>> {
        self.base.columns.concat()
    }

    pub(super) fn base_parameters(&self) -> Vec<Expr<'g>> {
        self.base.values.clone()
    }

    /// Returns the standard parameters of the bodies in the model.
    pub(super) fn standard_parameters(&self) -> Vec<Expr<'g>> {
        let zero = Inertia::zero(self.model.graph);
        let sites = self.bodies.iter().filter_map(|body| regressor_frame_of_body(body));
        sites
            .flat_map(|site| {
                let back = site.pose.inverse();
                let own = &self.model.links[site.link.0].inertia;
                inertial_parameters(&zero.sum_with_placed_inertia(own, &back.rotation, back.translation))
            })
            .collect()
    }
}

fn regressor_frame_of_body<'g>(body: &NamedFrame<'g>) -> Option<RegressorFrame<'g>> {
    Some(RegressorFrame { link: body.link?, pose: body.pose.clone() })
}

/// Derives the base parameters of the bodies' parameters. Parameters are regrouped towards the base as far as
/// possible (Gautier and Khalil 1990); then those that still depend linearly on others are removed.
fn derive_base_parameters<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    bodies: &[&NamedFrame<'g>],
) -> BaseParameters<'g> {
    let g = model.graph;
    let mut given = model.clone();
    given.links.iter_mut().for_each(|link| link.inertia = Inertia::zero(g));
    for (k, site) in bodies.iter().filter_map(|body| regressor_frame_of_body(body)).enumerate() {
        let own = inertia_from_parameters(std::array::from_fn(|p| {
            Quantity::Given(SuppliedQuantity::Inertia, COUNT * k + p).expr(g)
        }));
        let link = &mut given.links[site.link.0].inertia;
        *link = link.sum_with_placed_inertia(&own, &site.pose.rotation, site.pose.translation);
    }
    move_inertias_to_parents(
        &mut given,
        RegroupOptions { gauge: VanishingMomentConvention::Second, to_children: false, symbolic: true },
    );

    let left: Vec<[Expr<'g>; COUNT]> =
        given.links.iter().map(|link| inertial_parameters(&link.inertia)).collect();
    let all = (0..left.len()).flat_map(|k| (0..COUNT).map(move |p| (k, p)));
    let entries: Vec<(usize, usize)> = all.filter(|(k, p)| !left[*k][*p].is_zero()).collect();
    let sites: Vec<RegressorFrame<'g>> =
        (0..left.len()).map(|k| RegressorFrame { link: LinkId(k), pose: Pose::identity(g) }).collect();
    let (v, a) = (mechanics::velocity_symbols(model), mechanics::acceleration_symbols(model));
    let columns = regressor_columns(model, joints, &v, &a, &sites, &entries);

    let parts = classify_columns(model, &columns);
    let mut values: Vec<Expr<'g>> = entries.iter().map(|(k, p)| left[*k][*p]).collect();
    for (k, part) in parts.iter().enumerate() {
        if let ColumnLinearDependence::Combination(list) = part {
            let dependent = values[k];
            list.iter().for_each(|(i, factor)| values[*i] += dependent * *factor);
        }
    }
    let mut base = BaseParameters { entries, values, columns };
    base.keep_independent_parameters(&parts);
    // Between two axes of a joint there is no body. A parameter of one body that is moved to such a link may
    // appear in two base parameters, whose values are then proportional.
    let alone: Vec<Vec<Expr<'g>>> = base.values.iter().map(|value| vec![*value]).collect();
    let parts = classify_columns(model, &alone);
    for (k, part) in parts.iter().enumerate() {
        let ColumnLinearDependence::Combination(list) = part else { continue };
        let dependent = base.columns[k].clone();
        for (i, factor) in list {
            for (entry, other) in base.columns[*i].iter_mut().zip(&dependent) {
                *entry += *other * *factor;
            }
        }
    }
    base.keep_independent_parameters(&parts);
    base
}

impl BaseParameters<'_> {
    /// Removes the inertial parameters that are combinations of other ones.
    fn keep_independent_parameters(&mut self, parts: &[ColumnLinearDependence]) {
        retain_independent_items(&mut self.entries, parts);
        retain_independent_items(&mut self.values, parts);
        retain_independent_items(&mut self.columns, parts);
    }
}

fn retain_independent_items<T>(list: &mut Vec<T>, parts: &[ColumnLinearDependence]) {
    let mut parts = parts.iter();
    list.retain(|_| parts.next() == Some(&ColumnLinearDependence::Independent));
}
