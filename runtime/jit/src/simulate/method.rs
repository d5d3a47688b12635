//! Integration methods of simulations, selected by name.

use crate::error::Error;

/// Integration method, with its tolerance (relative and absolute) or its step size, s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// Automatic choice: [`DormandPrince`](linkwork::integrate::DormandPrince) with a tolerance, and
    /// [`Rodas`](linkwork::integrate::Rodas) from the time at which the motion is stiff. Mechanisms with
    /// contacts use [`TimeStepping`](linkwork::integrate::TimeStepping) with steps of 1 ms.
    Automatic(f64),
    /// Method [`DormandPrince`](linkwork::integrate::DormandPrince), with its tolerance.
    DormandPrince(f64),
    /// Method [`DormandPrince8`](linkwork::integrate::DormandPrince8), with its tolerance.
    DormandPrince8(f64),
    /// Method [`Rodas`](linkwork::integrate::Rodas), with its tolerance.
    Rodas(f64),
    /// Method [`Rk4`](linkwork::integrate::Rk4), with its step size, s.
    Rk4(f64),
    /// Method [`ImplicitMidpoint`](linkwork::integrate::ImplicitMidpoint), with its step size, s.
    ImplicitMidpoint(f64),
    /// Method [`Rosenbrock`](linkwork::integrate::Rosenbrock), with its step size, s.
    Rosenbrock(f64),
    /// Method [`SemiImplicitEuler`](linkwork::integrate::SemiImplicitEuler), with its step size, s.
    SemiImplicitEuler(f64),
    /// Method [`TimeStepping`](linkwork::integrate::TimeStepping), with its step size, s.
    TimeStepping(f64),
    /// Method [`TimeStepping::midpoint`](linkwork::integrate::TimeStepping::midpoint), with its step size, s.
    TimeSteppingMidpoint(f64),
    /// Method [`TimeStepping::leapfrog`](linkwork::integrate::TimeStepping::leapfrog), with its step size, s.
    TimeSteppingLeapfrog(f64),
    /// Method [`EventDriven`](linkwork::integrate::EventDriven), with its tolerance.
    EventDriven(f64),
}

/// Default tolerance of adaptive methods.
const TOLERANCE: f64 = 1e-9;
/// Default step size of methods with fixed steps, s.
pub(super) const STEP: f64 = 1e-3;

impl Method {
    /// Integration methods: name, whether the setting is a step size (otherwise a tolerance), and whether
    /// contacts are supported.
    pub const NAMES: [(&'static str, bool, bool); 12] = [
        ("automatic", false, true),
        ("dormand_prince", false, false),
        ("dormand_prince8", false, false),
        ("rodas", false, false),
        ("rk4", true, false),
        ("implicit_midpoint", true, false),
        ("rosenbrock", true, false),
        ("semi_implicit_euler", true, false),
        ("time_stepping", true, true),
        ("time_stepping_midpoint", true, true),
        ("time_stepping_leapfrog", true, true),
        ("event_driven", false, true),
    ];

    /// Returns the method with a name of [`NAMES`](Self::NAMES), with its tolerance or step size. Without a
    /// setting, the tolerance is `1e-9` and the step size 1 ms.
    ///
    /// # Errors
    ///
    /// There is no such method.
    pub fn from_name(name: &str, setting: Option<f64>) -> Result<Method, Error> {
        let method_names = || Self::NAMES.iter().map(|(name, ..)| *name);
        let Some((_, has_step, _)) = Self::NAMES.iter().find(|(known, ..)| *known == name) else {
            return Err(Error::unknown_name_error("method", name, method_names()));
        };
        let setting = setting.unwrap_or(if *has_step { STEP } else { TOLERANCE });
        Ok(match name {
            "dormand_prince" => Method::DormandPrince(setting),
            "dormand_prince8" => Method::DormandPrince8(setting),
            "rodas" => Method::Rodas(setting),
            "rk4" => Method::Rk4(setting),
            "implicit_midpoint" => Method::ImplicitMidpoint(setting),
            "rosenbrock" => Method::Rosenbrock(setting),
            "semi_implicit_euler" => Method::SemiImplicitEuler(setting),
            "time_stepping" => Method::TimeStepping(setting),
            "time_stepping_midpoint" => Method::TimeSteppingMidpoint(setting),
            "time_stepping_leapfrog" => Method::TimeSteppingLeapfrog(setting),
            "event_driven" => Method::EventDriven(setting),
            _ => Method::Automatic(setting),
        })
    }
}

impl Default for Method {
    fn default() -> Self {
        Method::Automatic(TOLERANCE)
    }
}
