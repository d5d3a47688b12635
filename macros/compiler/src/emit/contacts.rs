//! Code generation for mechanisms with unilateral contacts.

use super::interface::Interface;
use super::signature::SignatureContext;
use crate::catalogue::{ContactCounts, FunctionNeed, Shape};
use crate::mechanism::{Contact, ContactVelocityDependence, Model};
use std::fmt::Write;

/// Unilateral contact, as data for code generation.
#[derive(Clone, Debug)]
pub struct UnilateralContact {
    /// Name of the contact.
    name: String,
    /// Number of contact velocities: the normal velocity and the slip velocities, or the angular velocities
    /// of a friction moment.
    rates: usize,
    /// Index of the contact that supplies the normal force, if this is a friction moment.
    pressed_by: Option<usize>,
    /// True if the gap of the contact is an angle.
    turns: bool,
    /// True if the coefficient of restitution is a ratio of impulses (Poisson), false if it is a ratio of
    /// velocities (Newton).
    of_impulses: bool,
    /// Coefficients of friction, restitution and static friction; `None` if a coefficient depends on
    /// parameters.
    laws: [Option<f64>; 3],
    /// True if the static coefficient of friction differs from the kinetic one.
    has_stiction: bool,
    /// Velocities on which its contact velocities depend.
    dependence: ContactVelocityDependence,
}

impl UnilateralContact {
    /// Returns the unilateral contacts of a model.
    pub fn from_model(model: &Model<'_>) -> Vec<UnilateralContact> {
        let contacts = model.contacts.iter().zip(model.contact_velocity_dependences());
        contacts.map(|(contact, dependence)| Self::from_contact(contact, dependence)).collect()
    }

    fn from_contact(c: &Contact<'_>, dependence: ContactVelocityDependence) -> UnilateralContact {
        UnilateralContact {
            name: c.name.clone(),
            rates: c.rates.len(),
            pressed_by: c.pressed_by,
            turns: c.turns,
            of_impulses: c.of_impulses,
            laws: [c.friction, c.restitution, c.stiction].map(|law| law.constant_value()),
            has_stiction: c.stiction != c.friction,
            dependence,
        }
    }

    /// Returns one unnamed contact for a mechanism whose contacts are unknown because of an error.
    pub fn placeholder_contact() -> UnilateralContact {
        UnilateralContact {
            name: String::new(),
            rates: 1,
            pressed_by: None,
            turns: false,
            of_impulses: false,
            laws: [None; 3],
            has_stiction: false,
            dependence: ContactVelocityDependence { columns: (0, 0), drifts: false },
        }
    }
}

/// Writes the constants for the names of the contacts and the rows of their velocities.
pub fn write_constants(out: &mut String, contacts: &[UnilateralContact]) {
    if contacts.is_empty() {
        return;
    }
    let names: Vec<&str> = contacts.iter().map(|c| c.name.as_str()).collect();
    let mut first = 0;
    let ranges = contacts.iter().map(|c| {
        first += c.rates;
        format!("::linkwork::contact::Rows {{ first: {}, count: {} }}", first - c.rates, c.rates)
    });
    let ranges: Vec<String> = ranges.collect();
    let count = contacts.len();
    let _ = writeln!(
        out,
        "/// Name of every contact.\npub const CONTACTS: [&'static str; {count}] = {names:?};
        /// Rows of the contact velocities of each contact.\npub const CONTACT_ROWS: \
            [::linkwork::contact::Rows; {count}] = [{}];",
        ranges.join(", ")
    );
}

/// Writes the functions of the trait `Contacts`.
pub fn write_trait(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    let ContactCounts { count, rates: rows } = i.facts.contacts;
    let (scalar, q, v, nv) = (s.scalar.scalar_name(), s.vector_type(s.nq), s.vector_type(s.nv), s.nv);
    let pass = if s.time { "t, " } else { "" };
    let (gaps, rates) = (s.vector_type(count), s.vector_type(rows));
    let laws: Vec<String> = (0..count)
        .map(|k| {
            let of_impulses = i.contacts.get(k).is_some_and(|contact| contact.of_impulses);
            format!(
                "::linkwork::contact::Law {{ friction: laws[{}], restitution: laws[{}], stiction: laws[{}], \
                 hypothesis: ::linkwork::contact::Restitution::{} }}",
                3 * k,
                3 * k + 1,
                3 * k + 2,
                if of_impulses { "Poisson" } else { "Newton" }
            )
        })
        .collect();
    let is_written =
        i.facts.meets_need(FunctionNeed::Inertia) && i.facts.meets_need(FunctionNeed::FewContacts);
    let responses = if is_written {
        format!(
            "#[inline]\nfn contact_responses(&self, t: {scalar}, q: &{q}, _: &[bool; {count}]) \
             -> ::linkwork::contact::Responses<{scalar}, {nv}, {rows}> \
             {{ ::linkwork::contact::Responses::from_list(&self.__contact_responses({pass}q)) }}\n        "
        )
    } else {
        let columns: Vec<(usize, usize)> =
            i.contacts.iter().map(|contact| contact.dependence.columns).collect();
        format!(
            "#[inline]\nfn contact_columns(&self) -> [(usize, usize); {count}] {{ {columns:?} }}\n        "
        )
    };
    let drifts = i.contacts.iter().any(|contact| contact.dependence.drifts);
    let pressed_by = if i.contacts.iter().any(|c| c.pressed_by.is_some()) {
        let all: Vec<usize> = i.contacts.iter().enumerate().map(|(k, c)| c.pressed_by.unwrap_or(k)).collect();
        format!("const PRESSED_BY: [usize; {count}] = {all:?};\n        ")
    } else {
        String::new()
    };
    if i.facts.requests.derivatives {
        let (u, square) = (s.vector_type(s.nu), s.shape_type(Shape::Square(nv)));
        let _ = writeln!(
            out,
            "#[inline]\nfn held_derivatives(&self, t: {scalar}, state: (&{q}, &{v}), u: &{u}, touches: \
             &[::linkwork::contact::Touch; {count}], gains: [{scalar}; 2]) -> \
             ::core::option::Option<({square}, {square}, {inputs})> {{
                ::linkwork::__private::held_derivatives(self, t, state, u, touches, gains)
            }}",
            inputs = s.shape_type(Shape::Matrix(nv, s.nu)),
        );
        let _ = writeln!(
            out,
            "#[inline]\nfn differentiate_step(&self, method: &::linkwork::integrate::TimeStepping<{scalar}>, \
             t: {scalar}, state: (&{q}, &{v}), u: &{u}, \
             into: &mut ::linkwork::discrete::Transition<{scalar}, {nq}, {nv}, {nu}>) -> \
             ::core::option::Option<::core::result::Result<(), ::linkwork::integrate::Error>> {{
                let done = ::linkwork::__private::differentiate_step(self, method, t, state, u, into);
                ::core::option::Option::Some(done)
            }}",
            nq = s.nq,
            nu = s.nu,
        );
    }
    let _ = writeln!(
        out,
        "const CONTACTS: [&'static str; {count}] = Self::CONTACTS;
        const CONTACT_ROWS: [::linkwork::contact::Rows; {count}] = Self::CONTACT_ROWS;
        {pressed_by}#[inline]\nfn contact_gaps(&self, t: {scalar}, q: &{q}) -> {gaps} {{ \
            Self::contact_gaps(self, {pass}q) }}
        #[inline]\nfn contact_rates(&self, t: {scalar}, q: &{q}, v: &{v}) -> {rates} {{ \
            Self::contact_rates(self, {pass}q, v) }}
        #[inline]\nfn contact_jacobian(&self, t: {scalar}, q: &{q}) -> \
            ::linkwork::nalgebra::SMatrix<{scalar}, {rows}, {nv}> {{ Self::contact_jacobian(self, {pass}q) }}
        #[inline]\nfn contact_bias(&self, t: {scalar}, q: &{q}, v: &{v}) -> {rates} {{ \
            Self::contact_bias(self, {pass}q, v) }}
        {responses}#[inline]\nfn contacts_drift(&self) -> bool {{ {drifts} }}
        #[inline]\nfn contact_laws(&self) -> [::linkwork::contact::Law<{scalar}>; {count}] {{
            let laws = self.__contact_laws();
            [{}]
        }}",
        laws.join(", ")
    );
}

/// Writes `contact_derivatives`, the function of the trait `ContactDerivatives`.
pub fn write_derivatives(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    let rows = i.facts.contacts.rates;
    let (scalar, q, v, nv) = (s.scalar.scalar_name(), s.vector_type(s.nq), s.vector_type(s.nv), s.nv);
    let pass = if s.time { "t, " } else { "" };
    let _ = writeln!(
        out,
        "fn contact_derivatives(&self, t: {scalar}, q: &{q}, v: &{v}, a: &{v}, forces: &{}) -> \
         ::linkwork::contact::FirstOrder<{scalar}, {nv}, {rows}> {{
            ::linkwork::contact::FirstOrder::from(self.__contact_derivatives({pass}q, v, a, \
                &forces.data.0[0]))
        }}",
        s.vector_type(rows)
    );
}

/// Writes the integrator hooks of mechanisms with contacts.
pub fn write_contact_integrator_hooks(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    if i.contacts.is_empty() {
        return;
    }
    let (scalar, q, v) = (s.scalar.scalar_name(), s.vector_type(s.nq), s.vector_type(s.nv));
    let _ = writeln!(
        out,
        "const CONTACTING: bool = true;
        const LOCATABLE: bool = true;
        {}
        fn contact_start(&self, t: {scalar}, q: &{q}, parts: bool) -> ::core::result::Result<{q}, \
            ::linkwork::ConstraintError> {{
            ::linkwork::contact::start(self, t, q, parts)
        }}
        fn contact_step(&self, t: {scalar}, start: (&{q}, &{v}), end: (&{q}, &{v}), given: ::linkwork::contact::Assumed<'_, {scalar}, {}>, h: {scalar}) -> ::core::result::Result<::linkwork::contact::Touched<{scalar}, {}, {}>, ::linkwork::ConstraintError> {{
            ::linkwork::contact::step(self, t, start, end, given, h)
        }}
        #[inline]\nfn visit_contacts<V: ::linkwork::contact::Visitor<{scalar}, {}, {}, {}>>(&self, visitor: \
            V) -> ::core::option::Option<V::Output> {{
            ::core::option::Option::Some(::linkwork::contact::Visitor::visit(visitor, self))
        }}",
        velocity_transport_hooks(i, s), s.nv, s.nq, s.nv, s.nq, s.nv, s.nu
    );
}

/// Returns the hooks that express a velocity in the axes, and in the generalized speeds, of another
/// configuration, its rate of change, and the linear velocities of free joints.
fn velocity_transport_hooks(i: &Interface<'_>, s: &SignatureContext<'_>) -> String {
    let (scalar, q, v) = (s.scalar.scalar_name(), s.vector_type(s.nq), s.vector_type(s.nv));
    if i.facts.speeds {
        return format!(
            "#[inline]
            fn carry(&self, t: {scalar}, q: &{q}, dv: &{v}, v: &{v}) -> {v} {{
                let way = self.rates_of_speeds(q, dv);
                let there = self.__integrate(q, &way);
                self.speeds_of_rates(&there, &self.__carry(&way, &self.rates_of_speeds(q, v)))
            }}"
        );
    }
    format!(
        "#[inline]
        fn carry(&self, t: {scalar}, _q: &{q}, dv: &{v}, v: &{v}) -> {v} {{ self.__carry(dv, v) }}
        #[inline]
        fn carry_rate(&self, t: {scalar}, dv: &{v}, v: &{v}) -> {v} {{ self.__carry_rate(dv, v) }}
        #[inline]
        fn translation(&self, t: {scalar}, dv: &{v}) -> {v} {{ self.__translation(dv) }}"
    )
}

/// Adds a table of the contacts to the documentation of the struct.
pub fn write_documentation_table(text: &mut String, contacts: &[UnilateralContact]) {
    if contacts.is_empty() {
        return;
    }
    text.push_str(
        "\n# Contacts\n\nUnilateral contacts, see `linkwork::contact`. The functions of the dynamics assume \
         that all are separated.\n\n| | contact | gap | slip velocities | friction | restitution |\n| --- | \
         --- | --- | ---: | ---: | ---: |\n",
    );
    for (k, contact) in contacts.iter().enumerate() {
        let [friction, restitution, stiction] =
            contact.laws.map(|law| law.map_or("by parameters".to_string(), |law| law.to_string()));
        let restitution =
            if contact.of_impulses { format!("{restitution}, of impulses") } else { restitution };
        let friction =
            if contact.has_stiction { format!("{friction}, at rest {stiction}") } else { friction };
        let unit = if contact.turns { "rad" } else { "m" };
        // A friction moment opposes the spinning or the rolling of its contact.
        let (slip, friction) = match contact.pressed_by {
            None => ((contact.rates - 1).to_string(), friction),
            Some(_) => (format!("{} angular", contact.rates), format!("{friction} m")),
        };
        let _ = writeln!(text, "| {k} | `{}` | {unit} | {slip} | {friction} | {restitution} |", contact.name);
    }
}
