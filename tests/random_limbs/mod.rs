//! Random mechanisms with alike limbs, in the words of the language.

use proptest::collection::vec;
use proptest::prelude::*;
use std::fmt::Write;

/// A mechanism whose limbs have the same joints, and figures of their own.
#[derive(Clone, Debug)]
pub struct Creature {
    /// What carries the limbs.
    trunk: usize,
    limbs: usize,
    /// The joints of every limb, by index into `KINDS`, each with its axis.
    joints: Vec<(usize, usize)>,
    /// The last two joints of a limb hang side by side.
    forked: bool,
    /// Limbs are mirror images of each other, or differ in all figures.
    mirrored: bool,
    /// Masses are parameters: some of all limbs, some of each.
    symbolic: bool,
    numbers: Vec<f64>,
}

const TRUNKS: [&str; 4] = ["ground", "free body", "pinned body", "arm on a free body"];
const KINDS: [&str; 4] = ["Pin", "Sleeve", "Screw", "Ball"];

/// Creatures with two to five limbs of up to `joints` joints.
pub fn creatures(joints: usize) -> impl Strategy<Value = Creature> {
    let kinds = vec((0..KINDS.len(), 0..3_usize), 1..=joints);
    let parts = (0..TRUNKS.len(), 2..6_usize, kinds, any::<[bool; 3]>(), vec(-1.0..1.0_f64, 61));
    parts.prop_map(|(trunk, limbs, joints, [forked, mirrored, symbolic], numbers)| Creature {
        trunk,
        limbs,
        joints,
        forked,
        mirrored,
        symbolic,
        numbers,
    })
}

impl Creature {
    /// The attribute's arguments and the struct.
    pub fn source(&self) -> (String, String) {
        let mut fields = String::new();
        if self.symbolic {
            fields.push_str("common: f64,\n");
        }
        let carrier = self.write_trunk(&mut fields);
        for limb in 0..self.limbs {
            for k in 0..self.joints.len() {
                let fork = self.forked && k + 1 == self.joints.len() && k >= 2;
                let parent = match k {
                    0 => carrier.to_string(),
                    _ => format!("limb{limb}_{}", if fork { k - 2 } else { k - 1 }),
                };
                self.write_joint(limb, k, &parent, &mut fields);
            }
        }
        ("gravity = [0.3, -1.2, -9.0]".to_string(), format!("pub struct Creature {{\n{fields}}}"))
    }

    fn write_trunk(&self, out: &mut String) -> &'static str {
        let body = "#[body(mass = 3, com = [0.1, -0.2, 0.05], inertia = cuboid(3, 0.5, 0.4, 0.2))]";
        let _ = match TRUNKS[self.trunk] {
            "ground" => return "ground",
            "free body" => writeln!(out, "{body} trunk: Body, #[joint(ground -> trunk)] base: Free,"),
            "pinned body" => writeln!(out, "{body} trunk: Body, #[joint(ground -> trunk, about = y)] base: Pin,"),
            _ => writeln!(
                out,
                "{body} below: Body, #[joint(ground -> below)] base: Free,
                 {body} trunk: Body, #[joint(below.at([0.2, 0.1, 0.3]) -> trunk, about = unit(x + z))] waist: Pin,"
            ),
        };
        "trunk"
    }

    /// A figure of joint `k`: of all limbs, or of this one.
    fn number(&self, limb: usize, k: usize, which: usize) -> f64 {
        let own = if self.mirrored { 0 } else { 17 * limb };
        self.numbers[(own + 7 * k + which) % self.numbers.len()]
    }

    fn write_joint(&self, limb: usize, k: usize, parent: &str, out: &mut String) {
        let (kind, axis) = self.joints[k];
        let n = |which: usize| self.number(limb, k, which);
        // Left and right, front and back.
        let side = if limb.is_multiple_of(2) { 1.0 } else { -1.0 };
        let end = if limb / 2 == 0 { 1.0 } else { -1.0 };
        let mass = match (self.symbolic, k % 2) {
            (false, _) => format!("{:?}", 1.5 + n(0)),
            (true, 0) => "common".to_string(),
            (true, _) => {
                let _ = writeln!(out, "mass{limb}_{k}: f64,");
                format!("mass{limb}_{k}")
            }
        };
        let _ = writeln!(
            out,
            "#[body(mass = {mass}, com = [{:?}, {:?}, {:?}], inertia = cuboid({mass}, 0.3, 0.2, {:?}))] limb{limb}_{k}: Body,",
            0.2 * n(1) * end,
            0.2 * n(2) * side,
            0.3 * n(3),
            0.5 + 0.2 * n(4)
        );
        let turned =
            if self.mirrored { String::new() } else { format!(".rotated(z({:?}), x({:?}))", n(5), n(6)) };
        let sign = if side < 0.0 && self.mirrored { "-" } else { "" };
        let axis = ["x", "y", "z"][axis];
        let words = match KINDS[kind] {
            "Pin" => format!(", about = {sign}{axis}"),
            "Sleeve" => format!(", along = {sign}{axis}"),
            "Screw" => format!(", about = {axis}, pitch = {:?}", 0.2 + 0.1 * n(7)),
            _ => String::new(),
        };
        let at = [0.3 * end + 0.1 * n(8), (0.2 + 0.1 * n(9)) * side, -0.3];
        let _ = writeln!(
            out,
            "#[joint({parent}.at({at:?}){turned} -> limb{limb}_{k}{words})] joint{limb}_{k}: {},",
            KINDS[kind]
        );
        if KINDS[kind] != "Ball" {
            let _ = writeln!(
                out,
                "#[acts(on = joint{limb}_{k}, stiffness = {:?})] spring{limb}_{k}: Spring,
                 #[acts(on = joint{limb}_{k}, damping = {:?})] dashpot{limb}_{k}: Dashpot,",
                5.0 + n(10),
                0.5 + 0.2 * n(11)
            );
        }
    }
}
