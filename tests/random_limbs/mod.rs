//! Random mechanisms with isomorphic limbs, in the language of the macro. Some have elements between the
//! limbs, or between a limb and the trunk or the ground.

use proptest::collection::vec;
use proptest::prelude::*;
use std::fmt::Write;

/// Random mechanism with several limbs on a trunk. All limbs have the same joints; their values may differ.
#[derive(Clone, Debug)]
pub struct RandomLimbMechanism {
    /// Index into `TRUNKS` of the body that carries the limbs.
    trunk: usize,
    limbs: usize,
    /// Joints of each limb, as indices into `KINDS` and of the axis.
    joints: Vec<(usize, usize)>,
    /// Whether the last two joints of a limb have the same parent.
    forked: bool,
    /// Whether limbs are mirror images of each other; otherwise all their values differ.
    mirrored: bool,
    /// Whether masses are parameters: some shared by all limbs, some of each limb.
    symbolic: bool,
    /// Whether all joints of the limbs have springs and dashpots.
    sprung: bool,
    /// Force elements, inerters and constraints between limbs, or between a limb and the trunk or the ground.
    interactions: Vec<Interaction>,
    numbers: Vec<f64>,
}

/// Element that connects points or coordinates of two limbs, or of a limb and the trunk or the ground.
#[derive(Clone, Debug)]
struct Interaction {
    /// Index of the interaction's declaration in `INTERACTIONS`.
    kind: usize,
    /// Limb and joint at the first end of the element; the joint also determines the body.
    first: (usize, usize),
    /// Limb and joint of the second end. A limb index out of range means the ground or the trunk.
    second: (usize, usize),
}

/// Declarations of elements between points `@a` and `@b`, or between coordinates `@p` and `@q` with one
/// velocity each.
const INTERACTIONS: [&str; 13] = [
    "#[acts(between = (@a, @b), stiffness = 3, free_length = 0.2)] #: Spring,",
    "#[acts(between = (@a, @b), force = 2 * stretch + pow(stretch, 3), free_length = 0.3)] #: Spring,",
    "#[acts(between = (@a, @b), damping = 0.6)] #: Dashpot,",
    "#[acts(between = (@a, @b), inertance = 0.4)] #: Inerter,",
    "#[acts(between = (@b, @a), strength = 0.7)] #: Attraction,",
    "#[energy(0.3 * dot(r(@a / @b), r(@a / @b)))] #: Potential,",
    "#[dissipation(0.2 * dot(v(@a / @b / ground), v(@a / @b / ground)))] #: Rayleigh,",
    "#[acts(on = @a, value = 0.4 * r(@b / ground) - 0.3 * v(@a / ground / ground))] #: Force,",
    "#[acts(on = @p, inertance = 0.3)] #: Inerter,",
    "#[energy(0.5 * pow(@p - @q, 2) + 0.2 * sin(@p) * @q)] #: Potential,",
    "#[dissipation(0.3 * pow(rate(@p) - rate(@q), 2))] #: Rayleigh,",
    "#[acts(on = @p, value = 0.4 * sin(@q) - 0.2 * rate(@p))] #: Torque,",
    "#[constraint(norm(r(@a / @b)) = 1.3)] #: Holonomic,",
];

/// Range of indices of the interactions that act on coordinates.
const ON_COORDINATES: std::ops::Range<usize> = 8..12;

const TRUNKS: [&str; 4] = ["ground", "free body", "pinned body", "arm on a free body"];
const KINDS: [&str; 4] = ["Pin", "Sleeve", "Screw", "Ball"];

/// Returns creatures with two to five limbs of up to `joints` joints.
pub fn random_creatures(joints: usize) -> impl Strategy<Value = RandomLimbMechanism> {
    let kinds = vec((0..KINDS.len(), 0..3_usize), 1..=joints);
    let random_end = || (0..7_usize, 0..4_usize);
    let interaction = (0..INTERACTIONS.len(), random_end(), random_end())
        .prop_map(|(kind, first, second)| Interaction { kind, first, second });
    let flags = any::<[bool; 4]>();
    let parts = (0..TRUNKS.len(), 2..6_usize, kinds, flags, vec(interaction, 0..=3), vec(-1.0..1.0_f64, 61));
    parts.prop_map(|(trunk, limbs, joints, [forked, mirrored, symbolic, sprung], interactions, numbers)| {
        RandomLimbMechanism {
            trunk,
            limbs,
            joints,
            forked,
            mirrored,
            symbolic,
            sprung,
            interactions,
            numbers,
        }
    })
}

impl RandomLimbMechanism {
    /// Returns the generated source: the arguments of the attribute and the struct.
    pub fn creature_source(&self) -> (String, String) {
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
        for (k, interaction) in self.interactions.iter().enumerate() {
            self.write_interaction(k, interaction, carrier, &mut fields);
        }
        ("gravity = [0.3, -1.2, -9.0]".to_string(), format!("pub struct Creature {{\n{fields}}}"))
    }

    /// Returns name and kind of joint `k` of a limb.
    fn joint_name_and_kind(&self, (limb, k): (usize, usize)) -> (String, &'static str) {
        let k = k % self.joints.len();
        (format!("joint{}_{k}", limb % self.limbs), KINDS[self.joints[k].0])
    }

    fn write_interaction(&self, k: usize, interaction: &Interaction, carrier: &str, out: &mut String) {
        let Interaction { kind, first, second } = *interaction;
        let body_name = |(limb, joint): (usize, usize)| {
            format!("limb{}_{}", limb % self.limbs, joint % self.joints.len())
        };
        let a = body_name(first);
        let b = match second.0 {
            5 => "ground".to_string(),
            6 => carrier.to_string(),
            _ => body_name(second),
        };
        let [(p, one), (q, other)] = [first, second].map(|end| self.joint_name_and_kind(end));
        let plain = one != "Ball" && other != "Ball" && p != q;
        let is_refused = if ON_COORDINATES.contains(&kind) { !plain } else { a == b };
        if is_refused {
            return;
        }
        let stored_number_at_index = |which: usize| self.numbers[(5 * k + which) % self.numbers.len()];
        let a = format!("{a}.at([{:?}, {:?}, 0.3])", stored_number_at_index(0), stored_number_at_index(1));
        let b = format!("{b}.at([{:?}, 0.7, {:?}])", stored_number_at_index(2), stored_number_at_index(3));
        let text = INTERACTIONS[kind].replace("@a", &a).replace("@b", &b).replace("@p", &p).replace("@q", &q);
        let text = if one == "Sleeve" { text.replace("Torque", "Force") } else { text };
        let _ = writeln!(out, "{}", text.replacen("#:", &format!("between{k}:"), 1));
    }

    fn write_trunk(&self, out: &mut String) -> &'static str {
        let body = "#[body(mass = 3, com = [0.1, -0.2, 0.05], inertia = cuboid(3, 0.5, 0.4, 0.2))]";
        let _ = match TRUNKS[self.trunk] {
            "ground" => return "ground",
            "free body" => writeln!(out, "{body} trunk: Body, #[joint(ground -> trunk)] base: Free,"),
            "pinned body" => writeln!(
                out,
                "{body} trunk: Body, #[joint(ground -> trunk, about = y)] base: \
                                            Pin,"
            ),
            _ => writeln!(
                out,
                "{body} below: Body, #[joint(ground -> below)] base: Free,
                 {body} trunk: Body, #[joint(below.at([0.2, 0.1, 0.3]) -> trunk, about = unit(x + z))] \
                     waist: Pin,"
            ),
        };
        "trunk"
    }

    /// Returns a random number for joint `k` of a limb. Limbs that are mirror images share the number.
    fn random_number_of_joint(&self, limb: usize, k: usize, which: usize) -> f64 {
        let own = if self.mirrored { 0 } else { 17 * limb };
        self.numbers[(own + 7 * k + which) % self.numbers.len()]
    }

    fn write_joint(&self, limb: usize, k: usize, parent: &str, out: &mut String) {
        let (kind, axis) = self.joints[k];
        let stored_number_at_index = |which: usize| self.random_number_of_joint(limb, k, which);
        // Signs of mirrored limbs: left and right, front and back.
        let side = if limb.is_multiple_of(2) { 1.0 } else { -1.0 };
        let end = if limb / 2 == 0 { 1.0 } else { -1.0 };
        let mass = match (self.symbolic, k % 2) {
            (false, _) => format!("{:?}", 1.5 + stored_number_at_index(0)),
            (true, 0) => "common".to_string(),
            (true, _) => {
                let _ = writeln!(out, "mass{limb}_{k}: f64,");
                format!("mass{limb}_{k}")
            }
        };
        let _ = writeln!(
            out,
            "#[body(mass = {mass}, com = [{:?}, {:?}, {:?}], inertia = cuboid({mass}, 0.3, 0.2, {:?}))] \
             limb{limb}_{k}: Body,",
            0.2 * stored_number_at_index(1) * end,
            0.2 * stored_number_at_index(2) * side,
            0.3 * stored_number_at_index(3),
            0.5 + 0.2 * stored_number_at_index(4)
        );
        let turned = if self.mirrored {
            String::new()
        } else {
            format!(".rotated(z({:?}), x({:?}))", stored_number_at_index(5), stored_number_at_index(6))
        };
        let sign = if side < 0.0 && self.mirrored { "-" } else { "" };
        let axis = ["x", "y", "z"][axis];
        let words = match KINDS[kind] {
            "Pin" => format!(", about = {sign}{axis}"),
            "Sleeve" => format!(", along = {sign}{axis}"),
            "Screw" => format!(", about = {axis}, pitch = {:?}", 0.2 + 0.1 * stored_number_at_index(7)),
            _ => String::new(),
        };
        let at = [
            0.3 * end + 0.1 * stored_number_at_index(8),
            (0.2 + 0.1 * stored_number_at_index(9)) * side,
            -0.3,
        ];
        let _ = writeln!(
            out,
            "#[joint({parent}.at({at:?}){turned} -> limb{limb}_{k}{words})] joint{limb}_{k}: {},",
            KINDS[kind]
        );
        if KINDS[kind] != "Ball" && self.sprung {
            let _ = writeln!(
                out,
                "#[acts(on = joint{limb}_{k}, stiffness = {:?})] spring{limb}_{k}: Spring,
                 #[acts(on = joint{limb}_{k}, damping = {:?})] dashpot{limb}_{k}: Dashpot,",
                5.0 + stored_number_at_index(10),
                0.5 + 0.2 * stored_number_at_index(11)
            );
        }
    }
}
