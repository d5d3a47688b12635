//! Springs: linear, and with a force or an energy as an expression of the stretch.

use crate::diag::Diagnostics;
use crate::expr::diff::DirectionalDerivative;
use crate::expr::replace::substitute_symbols;
use crate::expr::{Expr, Extreme, Function, Node, Symbol};
use crate::kinematics::symbols_in;
use crate::language::Callable;
use crate::mechanism::{Pose, Quantity, Spring};
use crate::resolve::element_forces::ElementForces;
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::resolve::terms::{ForceElementCoordinate, StretchWithRate};
use crate::syntax::{self, Action, ExprKind, Key};
use std::collections::BTreeSet;

/// Maximum power of the stretch in a spring's force for which the energy is found by integration.
const HIGHEST_POWER: usize = 9;

/// Force law of a spring, as written.
pub enum SpringLaw<'e> {
    /// Force proportional to the stretch, with this stiffness.
    Linear(&'e syntax::Expr),
    /// Spring force as an expression of `stretch`.
    Force(&'e syntax::Expr),
    /// Energy as an expression of `stretch`; the force is its derivative.
    Energy(&'e syntax::Expr),
}

/// Returns the force of a spring. A linear spring on a coordinate is stored separately in the model.
pub fn spring_force<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    on: ForceElementCoordinate<'g>,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let law = match action.written_law()? {
        (Key::Force, e) => SpringLaw::Force(e),
        (Key::Energy, e) => SpringLaw::Energy(e),
        (_, e) => SpringLaw::Linear(e),
    };
    if let (SpringLaw::Linear(stiffness), Some(on), angle) = (&law, on.coordinate, on.angle) {
        let stiffness = scope.resolve_scalar(stiffness, cx);
        let free = free_length(scope, action, angle, cx);
        let spring = Spring { on, stiffness: stiffness?, free: free? };
        return Some(ElementForces { springs: vec![spring], ..ElementForces::default() });
    }
    let angle = on.angle;
    let stretch = on.stretch(scope)?;
    let free = free_length(scope, action, angle, cx)?;
    spring_force_of_law(scope, stretch, &law, free, cx)
}

/// Returns the force of a spring with any force law.
pub fn spring_force_of_law<'g>(
    scope: &Scope<'_, 'g>,
    stretch: StretchWithRate<'g>,
    law: &SpringLaw<'_>,
    free: Expr<'g>,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let g = scope.graph;
    let length = if stretch.signed && !free.is_zero() {
        stretch.value.apply_function(Function::Abs)
    } else {
        stretch.value
    };
    let value = length - free;
    let symbol = Quantity::Stretch.symbol();
    let locals = vec![("stretch", g.symbol(symbol)), ("length", g.symbol(symbol) + free)];
    let context =
        Context::new(AllowedQuantities::Placement, Some((None, Pose::identity(g)))).with_locals(locals);
    let energy = match law {
        // Smooth even where the points coincide.
        SpringLaw::Linear(k) if free.is_zero() => scope.resolve_scalar(k, cx)? * 0.5 * stretch.square,
        SpringLaw::Linear(k) => scope.resolve_scalar(k, cx)? * 0.5 * g.symbol(symbol).square(),
        SpringLaw::Energy(e) => scope.call_in_context(context, |scope| scope.resolve_scalar(e, cx))?,
        SpringLaw::Force(e) => spring_energy_of_force(scope, e, &context, cx)?,
    };
    Some(ElementForces::forces_of_potentials([substitute_symbols(energy, &|s| {
        (s == symbol).then_some(value)
    })]))
}

/// Returns the energy of a force. A piecewise force with a condition on the stretch or the length has the
/// sum of the energies of its pieces.
fn spring_energy_of_force<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    context: &Context<'g>,
    cx: &mut Diagnostics,
) -> Option<Expr<'g>> {
    let read_scalar = |e: &syntax::Expr, cx: &mut Diagnostics| {
        scope.call_in_context(context.clone(), |scope| scope.resolve_scalar(e, cx))
    };
    let force = read_scalar(e, cx)?;
    if symbols_in(&[force]).iter().any(|s| matches!(Quantity::from_symbol(*s), Quantity::Configuration(_))) {
        let message = "the force of a spring is a law of `stretch`, but this contains coordinates";
        cx.report_error(e.place.clone(), message)
            .add_help("write the law in terms of `stretch` or `length`")
            .add_help(
                "a force that depends on other coordinates is a `Force` with a `value`, or follows from an \
             `energy`",
            );
        return None;
    }
    let value_of_local = |e: &syntax::Expr| {
        context.locals.iter().find(|(name, _)| e.as_name() == Some(name)).map(|(_, value)| *value)
    };
    if let ExprKind::Call(name, arguments) = &e.kind
        && let [left, right, below, above] = arguments.as_slice()
        && name.id == Some(Callable::If)
    {
        let found = match (value_of_local(left), value_of_local(right)) {
            (Some(x), None) => Some((x, right, [below, above])),
            (None, Some(x)) => Some((x, left, [above, below])),
            _ => None,
        };
        if let Some((own, border, pieces)) = found {
            let symbol = Quantity::Stretch.symbol();
            let x = scope.graph.symbol(symbol);
            let border = read_scalar(border, cx)? - (own - x);
            let [below, above] = pieces.map(|piece| spring_energy_of_force(scope, piece, context, cx));
            let substitute_stretch =
                |energy: Expr<'g>, x| substitute_symbols(energy, &|s| (s == symbol).then_some(x));
            let (below, above) = (below?, above?);
            let (low, high) =
                (x.minimum_or_maximum(Extreme::Min, border), x.minimum_or_maximum(Extreme::Max, border));
            return Some(
                substitute_stretch(below, low) + substitute_stretch(above, high)
                    - substitute_stretch(above, border),
            );
        }
    }
    integrate_force_over_stretch(scope, force, e, cx)
}

/// Returns the energy of a force that is a polynomial in the stretch, by integration of its Taylor
/// series.
fn integrate_force_over_stretch<'g>(
    scope: &Scope<'_, 'g>,
    force: Expr<'g>,
    e: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<Expr<'g>> {
    let g = scope.graph;
    let symbol = Quantity::Stretch.symbol();
    let x = g.symbol(symbol);
    let mut d = DirectionalDerivative::with_respect_to(symbol, g);
    let (mut energy, mut derivative, mut power, mut factorial) = (g.zero(), force, x, 1.0);
    for n in 1..=HIGHEST_POWER + 1 {
        factorial *= n as f64;
        let at_zero = substitute_symbols(derivative, &|s| (s == symbol).then_some(g.zero()));
        energy += at_zero * (1.0 / factorial) * power;
        power = power * x;
        derivative = d.differentiate(derivative);
        // A law with corner points is a polynomial between them.
        if derivative.is_zero() && !is_nonsmooth_in_symbol(force, symbol) {
            return Some(energy);
        }
    }
    cx.report_error(
        e.place.clone(),
        "this law has no energy in closed form: it is not a polynomial in `stretch`",
    )
    .add_help(
        "give the spring by its energy instead: `energy = …`, and the force follows, as in \
             `energy = k / 2 * pow(min(stretch, 0), 2)`",
    );
    None
}

/// Returns the length or the angle at which the force of a spring is zero.
fn free_length<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    angle: Option<bool>,
    cx: &mut Diagnostics,
) -> Option<Expr<'g>> {
    let free_angle = action.expression_of_key(Key::FreeAngle);
    let is_angle = free_angle.is_some();
    let Some(free) = action.expression_of_key(Key::FreeLength).or(free_angle) else {
        return Some(scope.graph.zero());
    };
    if let Some(angle) = angle.filter(|angle| *angle != is_angle) {
        let (is, key) = if angle { ("an angle", "free_angle") } else { ("a length", "free_length") };
        cx.report_error(free.place.clone(), format!("the coordinate of this spring is {is}"))
            .add_help(format!("write `{key} = …`"));
        return None;
    }
    if is_angle { scope.resolve_angle_in_radians(free, cx) } else { scope.resolve_scalar(free, cx) }
}

/// Whether an expression contains a sign, a magnitude or an extreme of a subexpression that depends on the
/// symbol.
fn is_nonsmooth_in_symbol(e: Expr<'_>, symbol: Symbol) -> bool {
    let g = e.graph();
    let mut seen = BTreeSet::from([e.id()]);
    let mut todo = vec![e.id()];
    while let Some(id) = todo.pop() {
        let node = g.node(id);
        let corner = matches!(node, Node::Call(Function::Abs | Function::Signum, _) | Node::Extreme(..));
        if corner && symbols_in(&[g.expr(id)]).contains(&symbol) {
            return true;
        }
        node.visit_operands(|a| {
            if seen.insert(a) {
                todo.push(a);
            }
        });
    }
    false
}
