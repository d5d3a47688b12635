//! Helper functions of generated bodies that the mathematical library does not have. Each helper is written
//! only if it is called. Helper names begin with `lw_`, which no name of a mechanism does
//! (`names::prefix_identifier`).

/// Set of C helper functions that a source file needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Support {
    /// Whether C code computes in single precision.
    single: bool,
    /// Whether every operation is rounded separately, for reproducible results.
    pub is_reproducible: bool,
    /// Whether the target defines fused products and the functions for sines and cosines itself.
    pub is_kernel: bool,
    one_angle: bool,
    four_angles: bool,
    signum: bool,
    atmosphere: [bool; 3],
    /// Whether products with the inverse of the mass matrix are needed.
    pub products: bool,
    /// Whether the C helper for the low-rank update of the inverse is needed.
    pub completed: bool,
    /// Whether the blockwise inversion of a mass matrix is needed.
    pub inverted: bool,
    /// Whether the C helper that solves linear systems with the blockwise inverse is needed.
    pub solved: bool,
    /// Whether C helpers for ball joints are needed.
    pub balls: bool,
    /// Whether C helpers for free joints are needed.
    pub motions: bool,
    /// Whether C helpers for interpolation tables are needed.
    pub tabulated: bool,
    /// Whether derivatives on the configuration space are needed: of ball joints, of free joints.
    pub jacobians: [bool; 2],
    /// Whether products of matrices with derivatives of a step are needed.
    pub sums: bool,
    /// True if a program reads a value that its function does not have, or has another number of results:
    /// an internal error.
    pub missing: bool,
}

impl Support {
    /// Name of the function that returns `a * b + c`.
    pub const MUL_ADD: &'static str = "lw_mul_add";
    /// Name of the function that returns `a * b - c`.
    pub const MUL_SUB: &'static str = "lw_mul_sub";
    /// Name of the function that returns `c - a * b`.
    pub const NEG_MUL_ADD: &'static str = "lw_neg_mul_add";

    /// Creates an empty set of C helper functions.
    pub fn new(single: bool) -> Support {
        Support { single, ..Support::default() }
    }

    /// Creates an empty set of helpers for a target that defines fused products, sines and cosines itself.
    pub fn of_kernels() -> Support {
        Support { is_kernel: true, ..Support::default() }
    }

    /// Returns the name of the C helper for sines and cosines of one or four angles, and marks it as needed.
    pub fn sine_cosine_function(&mut self, count: usize) -> &'static str {
        self.one_angle = true;
        self.four_angles |= count > 1;
        if count > 1 { "lw_sin_cos_4" } else { "lw_sin_cos" }
    }

    /// Returns the name of the C helper for signs, and marks it as needed.
    pub fn sign_function(&mut self) -> String {
        self.signum = true;
        "lw_signum".to_string()
    }

    /// Returns the function for a quantity of the standard atmosphere.
    pub fn atmosphere_function(&mut self, name: &str) -> String {
        if let Some(at) = QUANTITIES.iter().position(|(known, _)| *known == name) {
            self.atmosphere[at] = true;
        }
        format!("lw_{name}")
    }

    /// Returns the dependencies whose results may differ in bits from those of Rust, if any.
    pub fn irreproducible(&self) -> Option<&'static str> {
        match (self.atmosphere.contains(&true), self.tabulated) {
            (true, _) => Some("the standard atmosphere"),
            (_, true) => Some("a table"),
            _ => None,
        }
    }

    /// Returns the C standard headers that are needed in addition to `math.h`.
    pub fn required_headers(self) -> &'static [&'static str] {
        let exact = self.one_angle && !self.single;
        match (exact, self.balls || self.motions || exact) {
            (true, _) => &["float.h", "stdint.h", "string.h"],
            (_, true) => &["float.h"],
            _ => &[],
        }
    }

    /// Returns the definitions for a mechanism with `nv` velocities and this prefix of names.
    pub fn support_definitions(self, nv: usize, prefix: &str) -> String {
        let angles = match self.single {
            true => {
                [include_str!("templates/single_angles.c"), include_str!("templates/four_single_angles.c")]
            }
            false => [include_str!("templates/angles.c"), include_str!("templates/four_angles.c")],
        };
        let air = self.atmosphere.contains(&true);
        let jacobians = self.jacobians.contains(&true);
        let own_sines = self.is_reproducible && (self.balls || self.motions);
        let parts = [
            (!self.is_kernel && !self.is_reproducible, include_str!("templates/fused.c")),
            ((self.one_angle || own_sines) && !self.is_kernel, angles[0]),
            (self.four_angles && !self.is_kernel, angles[1]),
            (self.signum, include_str!("templates/signum.c")),
            (air, include_str!("templates/atmosphere.c")),
            (self.products, include_str!("templates/products.c")),
            (self.completed || self.inverted, include_str!("templates/completed.c")),
            (self.inverted, include_str!("templates/inverted.c")),
            (self.solved, include_str!("templates/solved.c")),
            (own_sines, include_str!("templates/own_sines.c")),
            (self.balls || self.motions, include_str!("templates/turns.c")),
            (self.motions || jacobians, include_str!("templates/even_brackets.c")),
            (self.motions || self.jacobians[0], include_str!("templates/left_jacobian.c")),
            (self.balls, include_str!("templates/ball_rates.c")),
            (self.motions, include_str!("templates/motions.c")),
            (self.jacobians[0], include_str!("templates/ball_jacobians.c")),
            (self.jacobians[1], include_str!("templates/motion_jacobians.c")),
            (self.sums, include_str!("templates/sums.c")),
            (self.tabulated, include_str!("templates/tabulated.c")),
        ];
        let mut texts: Vec<String> =
            parts.iter().filter(|(needed, _)| *needed).map(|(_, text)| (*text).to_string()).collect();
        let asked = QUANTITIES.iter().zip(self.atmosphere).filter(|(_, asked)| *asked);
        texts.extend(asked.map(|((name, variable), _)| {
            format!(
                "static double lw_{name}(double h) {{\n    double temperature, pressure, rate;\n    \
                 lw_atmosphere(h, &temperature, &pressure, &rate);\n    return {variable};\n}}\n"
            )
        }));
        texts.join("\n").replace("@NV@", &nv.max(1).to_string()).replace("@PREFIX@", prefix)
    }
}

/// Functions of the standard atmosphere, with the variable of the helper `lw_atmosphere` that each returns.
const QUANTITIES: [(&str, &str); 3] =
    [("isa_temperature", "temperature"), ("isa_lapse_rate", "rate"), ("isa_pressure", "pressure")];
