//! `<equality>` → joints that follow others, constraints on coordinates, and loop-closing joints.

use super::defaults::ElementWithDefaults;
use super::reader::{MjcfReader, origin_from_pose};
use super::tendon::Tendon;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, child_elements, element_source_position, read_name_attribute};
use crate::import::pose::{NumericPose, rotation_of_quaternion};
use crate::import::robot::{plain_joint, unused_name};
use crate::syntax::{
    BinaryOp, Constraint, ConstraintKind, Endpoint, Expr, ExprKind, GROUND, JointKind, MimicRelation, Name,
    WrittenArguments,
};

const LEAVE_OUT: &str = "to ignore `<equality>`, write `#[mechanism(…, mimic = independent)]`";

impl<'a> MjcfReader<'a> {
    /// Reads all couplings and loop constraints in the element `<equality>`.
    pub(super) fn read_equalities(&mut self, root: Node<'a>, tendons: &[Tendon], cx: &mut Cx<'_>) {
        let groups = child_elements(root).filter(|node| node.tag_name().name() == "equality");
        let nodes: Vec<Node<'a>> = groups.flat_map(child_elements).collect();
        if !self.options.follow_mimic || !self.settings.are_equalities_enabled() {
            if !nodes.is_empty() {
                self.left_out.push(format!("{} couplings (`<equality>`)", nodes.len()));
            }
            return;
        }
        for node in nodes {
            let element =
                self.defaults.element_with_defaults(node, &["equality", node.tag_name().name()], 0, cx);
            if element.read_boolean_attribute("active", cx) == Some(false) {
                self.count_skipped_contents("couplings that are not active", 1);
                continue;
            }
            match node.tag_name().name() {
                "joint" => self.couple_joints(&element, cx),
                "tendon" => self.couple_tendons(&element, tendons, cx),
                "connect" => self.close_loop(&element, JointKind::Ball, cx),
                "weld" => self.close_loop(&element, JointKind::Weld, cx),
                kind => {
                    let message = format!("the coupling `<{kind}>` is not supported");
                    cx.report_error(&element_source_position(node, cx), message, |d| d.add_help(LEAVE_OUT));
                }
            }
        }
    }

    /// Couples two joints: `y − y₀ = a₀ + a₁ (x − x₀) + …`. The coordinates `x₀` and `y₀` are those in the
    /// configuration of the file. A linear relation becomes a `mimic`, any other a constraint.
    fn couple_joints(&mut self, element: &ElementWithDefaults<'a>, cx: &mut Cx<'_>) {
        let Some(first) = read_name_attribute(element.node, "joint1", cx)
            .filter(|joint| self.check_single_coordinate_joint(joint, "follow", cx))
        else {
            return;
        };
        let second = element
            .node
            .has_attribute("joint2")
            .then(|| read_name_attribute(element.node, "joint2", cx))
            .flatten();
        if second
            .as_ref()
            .is_some_and(|joint| !self.check_single_coordinate_joint(joint, "be followed by", cx))
        {
            return;
        }
        let polynomial = coupling_coefficients(element, cx);
        let [a0, a1, ..] = polynomial;
        let reference_coordinate_of_joint =
            |joint: &Name| self.references.get(&joint.text).copied().unwrap_or(0.0);
        let offset = reference_coordinate_of_joint(&first) + a0
            - second.as_ref().map_or(0.0, |joint| a1 * reference_coordinate_of_joint(joint));
        let is_linear = second.is_none() || polynomial[2..] == [0.0; 3];
        let joint = self.robot.joints.iter_mut().find(|joint| joint.name.text == first.text);
        let free = joint.filter(|joint| is_linear && joint.mimic.is_none() && joint.held.is_none());
        match (free, second) {
            (Some(joint), Some(second)) => {
                joint.mimic = Some(MimicRelation { joint: second, multiplier: a1, offset })
            }
            (Some(joint), None) => joint.held = Some(offset),
            (None, second) => {
                let second = second.map(|joint| vec![(joint, 1.0)]);
                self.add_polynomial_constraint(element, &[(first, 1.0)], second.as_deref(), polynomial, cx);
            }
        }
    }

    /// Couples the lengths of fixed tendons. If a single tendon of two joints is constrained, the second
    /// joint follows the first.
    fn couple_tendons(&mut self, element: &ElementWithDefaults<'a>, tendons: &[Tendon], cx: &mut Cx<'_>) {
        let Some(first) = terms_of_tendon("tendon1", element, tendons, cx) else { return };
        let has_second_tendon = element.node.has_attribute("tendon2");
        let second = if has_second_tendon { terms_of_tendon("tendon2", element, tendons, cx) } else { None };
        if has_second_tendon && second.is_none() {
            return;
        }
        let polynomial = coupling_coefficients(element, cx);
        if let ([(leader, weight), (follower, own)], None) = (first.as_slice(), &second) {
            let reference_coordinate_of_joint =
                |joint: &Name| self.references.get(&joint.text).copied().unwrap_or(0.0);
            let multiplier = -weight / own;
            let offset = reference_coordinate_of_joint(follower) + polynomial[0] / own
                - multiplier * reference_coordinate_of_joint(leader);
            let joint = self.robot.joints.iter_mut().find(|joint| joint.name.text == follower.text);
            if let Some(joint) = joint.filter(|joint| joint.mimic.is_none() && joint.held.is_none()) {
                joint.mimic = Some(MimicRelation { joint: leader.clone(), multiplier, offset });
                return;
            }
        }
        self.add_polynomial_constraint(element, &first, second.as_deref(), polynomial, cx);
    }

    /// Adds the constraint `Σ (y − y₀) = a₀ + a₁ d + … + a₄ d⁴` with `d = Σ (x − x₀)`. The sums are weighted
    /// with the coefficients of the tendons.
    fn add_polynomial_constraint(
        &mut self,
        element: &ElementWithDefaults<'a>,
        first: &[(Name, f64)],
        second: Option<&[(Name, f64)]>,
        polynomial: [f64; 5],
        cx: &mut Cx<'_>,
    ) {
        let at = element_source_position(element.node, cx);
        let number_literal = |x: f64| Expr::number_at(x, &at);
        let weighted_displacement_sum = |terms: &[(Name, f64)]| {
            let zero: f64 = terms
                .iter()
                .map(|(joint, weight)| weight * self.references.get(&joint.text).copied().unwrap_or(0.0))
                .sum();
            terms.iter().fold(number_literal(-zero), |sum, (joint, weight)| {
                let coordinate = Expr { kind: ExprKind::Name(joint.text.clone()), place: at.clone() };
                Expr::binary_operation(
                    BinaryOp::Add,
                    sum,
                    Expr::binary_operation(BinaryOp::Mul, number_literal(*weight), coordinate),
                )
            })
        };
        let other = match second {
            Some(second) => {
                let d = weighted_displacement_sum(second);
                let highest = polynomial.iter().rposition(|factor| *factor != 0.0).unwrap_or(0);
                let start = number_literal(polynomial.get(highest).copied().unwrap_or(0.0));
                polynomial.iter().take(highest).rev().fold(start, |inner, factor| {
                    Expr::binary_operation(
                        BinaryOp::Add,
                        number_literal(*factor),
                        Expr::binary_operation(BinaryOp::Mul, inner, d.clone()),
                    )
                })
            }
            None => number_literal(polynomial[0]),
        };
        let value = weighted_displacement_sum(first);
        let kind = element.node.tag_name().name();
        let said = element
            .node
            .has_attribute("name")
            .then(|| read_name_attribute(element.node, "name", cx))
            .flatten();
        let mut named = said.unwrap_or_else(|| Name { text: format!("{kind}_coupling"), place: at.clone() });
        named.text = unused_name(&named.text, |name| {
            self.joint_names.contains(name)
                || self.robot.constraints.iter().any(|known| known.name.text == name)
        });
        let constraint = Constraint {
            name: named,
            kind: ConstraintKind::Holonomic,
            value,
            other: Some(other),
            arguments: WrittenArguments::default(),
        };
        self.robot.constraints.push(constraint);
    }

    /// Closes a loop with a ball joint or a weld.
    fn close_loop(&mut self, element: &ElementWithDefaults<'a>, kind: JointKind, cx: &mut Cx<'_>) {
        let Some([first, second]) = self.ends_of_loop(element, kind, cx) else { return };
        for (body, _) in [&first, &second] {
            if self.mocap.contains(&body.text) {
                let message = format!("{} is a mocap body, which does not move here", quote_word(&body.text));
                cx.report_error(&body.place, message, |d| d.add_help(LEAVE_OUT));
                return;
            }
        }
        if first.0.text == second.0.text {
            let message = format!("body {} closes a loop with itself", quote_word(&first.0.text));
            cx.report_error(&second.0.place, message, |d| d.add_help(LEAVE_OUT));
            return;
        }
        let number = self.robot.closing.len() + 1;
        let said = element
            .node
            .has_attribute("name")
            .then(|| read_name_attribute(element.node, "name", cx))
            .flatten();
        let mut named = said.unwrap_or_else(|| Name {
            text: format!("{}{number}", element.node.tag_name().name()),
            place: element_source_position(element.node, cx),
        });
        named.text = unused_name(&named.text, |name| self.joint_names.contains(name));
        self.joint_names.insert(named.text.clone());
        let [parent, child] = [first, second].map(|(body, pose)| {
            let origin = origin_from_pose(&pose, &body.place);
            Endpoint { at: origin.nonzero_position(), rotated: origin.nonzero_rotations(), body }
        });
        self.robot.closing.push(plain_joint(named, kind, parent, child));
    }

    /// Returns the bodies and the poses of the two ends of a loop-closing joint.
    fn ends_of_loop(
        &self,
        element: &ElementWithDefaults<'a>,
        kind: JointKind,
        cx: &mut Cx<'_>,
    ) -> Option<[(Name, NumericPose); 2]> {
        if element.node.has_attribute("site1") {
            let mut end_at_site = |attribute: &str| {
                let site = read_name_attribute(element.node, attribute, cx)?;
                let found = self.find_site(&site, cx)?;
                Some((Name { text: found.body, place: site.place }, found.pose))
            };
            return Some([end_at_site("site1")?, end_at_site("site2")?]);
        }
        let mut end_on_body = |attribute: &str| {
            let zero = Name { text: GROUND.to_string(), place: element_source_position(element.node, cx) };
            if attribute == "body2" && !element.node.has_attribute(attribute) {
                return Some((zero, NumericPose::ZERO));
            }
            self.find_body(read_name_attribute(element.node, attribute, cx)?, cx)
        };
        let [(first, outer), (second, inner)] = [end_on_body("body1")?, end_on_body("body2")?];
        // Pose of the first body relative to the second, in the configuration of the file.
        let between = inner.inverse_pose().compose_with(&outer);
        let anchor = element.read_exactly_n_numbers("anchor", cx).map_or([0.0; 3], |anchor| anchor.value);
        if kind == JointKind::Ball {
            let at = NumericPose { at: anchor, ..NumericPose::ZERO };
            return Some([
                (first, at),
                (second, NumericPose { at: between.compose_with(&at).at, ..NumericPose::ZERO }),
            ]);
        }
        let said = element.read_exactly_n_numbers::<7>("relpose", cx).map(|said| said.value);
        // `relpose` is the pose of the second body's anchor relative to the first body. Without it, the
        // relative pose is that in the configuration of the file.
        let (pose, own) = match said.filter(|[_, _, _, quat @ ..]| *quat != [0.0; 4]) {
            Some([x, y, z, quat @ ..]) => {
                let size = quat.iter().map(|x| x * x).sum::<f64>().sqrt();
                let pose =
                    NumericPose { at: [x, y, z], axes: rotation_of_quaternion(quat.map(|x| x / size)) };
                (pose, NumericPose { at: anchor, ..NumericPose::ZERO })
            }
            None => (between.inverse_pose(), NumericPose::ZERO),
        };
        Some([(first, pose), (second, own)])
    }
}

/// Returns the coefficients `polycoef` of a joint coupling. The default is the identity.
fn coupling_coefficients(element: &ElementWithDefaults<'_>, cx: &mut Cx<'_>) -> [f64; 5] {
    let usual = [0.0, 1.0, 0.0, 0.0, 0.0];
    element.numbers_with_defaults("polycoef", usual, cx).map_or(usual, |found| found.value)
}

/// Returns the joints and weights of the fixed tendon that a coupling names.
fn terms_of_tendon(
    attribute: &str,
    element: &ElementWithDefaults<'_>,
    tendons: &[Tendon],
    cx: &mut Cx<'_>,
) -> Option<Vec<(Name, f64)>> {
    let tendon = read_name_attribute(element.node, attribute, cx)?;
    Tendon::terms_of_tendon(&tendon, tendons, LEAVE_OUT, cx).filter(|terms| !terms.is_empty())
}
