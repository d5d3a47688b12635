//! Helpers: functions that bodies call in addition to those of the mathematical library, each written where
//! something calls it. Their names begin with `lw_`, which no name of a mechanism does
//! (`names::prefix_identifier`).

/// What a file needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Support {
    /// Numbers have single precision.
    single: bool,
    one_angle: bool,
    four_angles: bool,
    signum: bool,
    atmosphere: [bool; 3],
    /// Products with the inverse of the mass matrix.
    pub products: bool,
    /// Its completion.
    pub completed: bool,
    /// Its inversion in parts.
    pub inverted: bool,
    /// What such an inverse solves.
    pub solved: bool,
    /// Ball joints.
    pub balls: bool,
    /// Free joints.
    pub motions: bool,
    /// Tables.
    pub tabulated: bool,
    /// Derivatives on the configuration space, of ball joints and of free ones.
    pub jacobians: [bool; 2],
    /// Products of matrices with what changes in a step, of so many columns.
    pub sums: bool,
}

impl Support {
    /// `a * b + c`
    pub const MUL_ADD: &'static str = "lw_mul_add";
    /// `a * b - c`
    pub const MUL_SUB: &'static str = "lw_mul_sub";
    /// `c - a * b`
    pub const NEG_MUL_ADD: &'static str = "lw_neg_mul_add";

    /// Nothing yet.
    pub fn new(single: bool) -> Support {
        Support { single, ..Support::default() }
    }

    /// The function for sines and cosines of so many angles.
    pub fn angles(&mut self, count: usize) -> &'static str {
        self.one_angle = true;
        self.four_angles |= count > 1;
        if count > 1 { "lw_sin_cos_4" } else { "lw_sin_cos" }
    }

    /// The one for signs.
    pub fn signum(&mut self) -> String {
        self.signum = true;
        "lw_signum".to_string()
    }

    /// The one for a quantity of the standard atmosphere.
    pub fn atmosphere(&mut self, name: &str) -> String {
        if let Some(at) = QUANTITIES.iter().position(|(known, _)| *known == name) {
            self.atmosphere[at] = true;
        }
        format!("lw_{name}")
    }

    /// Headers beside `math.h`.
    pub fn includes(self) -> &'static [&'static str] {
        let exact = self.one_angle && !self.single;
        match (exact, self.balls || self.motions || exact) {
            (true, _) => &["float.h", "stdint.h", "string.h"],
            (_, true) => &["float.h"],
            _ => &[],
        }
    }

    /// The definitions, for a mechanism of so many velocities whose names begin with this.
    pub fn text(self, nv: usize, prefix: &str) -> String {
        let angles = match self.single {
            true => {
                [include_str!("templates/single_angles.c"), include_str!("templates/four_single_angles.c")]
            }
            false => [include_str!("templates/angles.c"), include_str!("templates/four_angles.c")],
        };
        let air = self.atmosphere.contains(&true);
        let parts = [
            (true, include_str!("templates/fused.c")),
            (self.one_angle, angles[0]),
            (self.four_angles, angles[1]),
            (self.signum, include_str!("templates/signum.c")),
            (air, include_str!("templates/atmosphere.c")),
            (self.products, include_str!("templates/products.c")),
            (self.completed || self.inverted, include_str!("templates/completed.c")),
            (self.inverted, include_str!("templates/inverted.c")),
            (self.solved, include_str!("templates/solved.c")),
            (self.balls || self.motions, include_str!("templates/turns.c")),
            (self.balls, include_str!("templates/ball_rates.c")),
            (self.motions, include_str!("templates/motions.c")),
            (self.jacobians.contains(&true), include_str!("templates/fourth_bracket.c")),
            (self.jacobians[0], include_str!("templates/left_jacobian.c")),
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
                "static double lw_{name}(double h) {{\n    double temperature, pressure, rate;\n    lw_atmosphere(h, &temperature, &pressure, &rate);\n    return {variable};\n}}\n"
            )
        }));
        texts.join("\n").replace("@NV@", &nv.max(1).to_string()).replace("@PREFIX@", prefix)
    }
}

/// Functions of the standard atmosphere, and what each takes of it.
const QUANTITIES: [(&str, &str); 3] =
    [("isa_temperature", "temperature"), ("isa_lapse_rate", "rate"), ("isa_pressure", "pressure")];
