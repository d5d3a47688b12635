//! Conditions on values computed from parameters. A violation by a constant is a compile-time error; a
//! violation by a parameter is reported at run time.

use super::scope::Scope;
use crate::expr::Expr;
use crate::kinematics::symbols_in;
use crate::mechanism::{Model, Quantity, Requirement, Rule};

impl<'g> Scope<'_, 'g> {
    /// Records a condition on values, if the values depend on parameters and on nothing else.
    pub fn record_parameter_condition(
        &self,
        rule: Rule,
        figure: impl FnOnce() -> String,
        values: &[Expr<'g>],
    ) {
        let parameter_of_symbol = |symbol| match Quantity::from_symbol(symbol) {
            Quantity::Parameter(k) => Some(k),
            _ => None,
        };
        let parameters: Option<Vec<usize>> =
            symbols_in(values).into_iter().map(parameter_of_symbol).collect();
        let Some(parameters) = parameters.filter(|all| !all.is_empty()) else { return };
        let all = &mut self.records.borrow_mut().requirements;
        // A definition may be used several times.
        if !all.iter().any(|known| known.rule.implies_rule(rule) && known.values == values) {
            all.push(Requirement { rule, figure: figure(), parameters, values: values.to_vec() });
        }
    }
}

/// Returns all conditions: those recorded, those of bounds, and finiteness of parameters without other
/// conditions. Parameters with a leading underscore are exempt.
pub fn gather_requirements<'g>(scope: &Scope<'_, 'g>, model: &Model<'g>) -> Vec<Requirement<'g>> {
    for limit in &model.limits {
        let name = model.velocities.get(limit.v.0).map_or("", |(name, _)| name.as_str());
        if let (Some(lower), Some(upper)) = (limit.lower, limit.upper) {
            scope.record_parameter_condition(
                Rule::Order,
                || format!("the range of `{name}`"),
                &[lower, upper],
            );
        }
        for (bound, what) in [(limit.speed, "speed"), (limit.effort, "effort")] {
            let describe_largest_value = || format!("the largest {what} of `{name}`");
            bound.iter().for_each(|bound| {
                scope.record_parameter_condition(Rule::NotNegative, describe_largest_value, &[*bound])
            });
        }
    }
    for (k, parameter) in scope.description.parameters.iter().enumerate() {
        let value = Quantity::Parameter(k).expr(scope.graph);
        if !parameter.text.starts_with('_') {
            scope.record_parameter_condition(
                Rule::Finite,
                || format!("the parameter `{}`", parameter.text),
                &[value],
            );
        }
    }
    std::mem::take(&mut scope.records.borrow_mut().requirements)
}
