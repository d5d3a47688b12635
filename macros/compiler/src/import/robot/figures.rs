//! Conversion of values of a file to fields of the mechanism, for the option `parameters`. Each value is
//! replaced by a reference to its field.

use super::names::unused_name;
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::imported::ImportedMechanism;
use crate::import::pose::{
    IDENTITY, Matrix, Vector, axis_rotation, matrix_product, roll_pitch_yaw, transpose,
};
use crate::syntax::file_parameters::{
    DAMPING, FRICTION, FileField, FileFieldKind, FileParameters, INERTIAL, PLACEMENT,
};
use crate::syntax::{Body, Expr, ExprKind, FileOptions, Joint, JointKind, Name};

/// Creates the fields of all requested values. `standing` are the names of links that are fixed to the
/// ground, whose mass properties appear in no equation.
pub(in crate::import) fn make_value_fields(
    imported: &mut ImportedMechanism,
    standing: &[String],
    options: &FileOptions,
    cx: &mut Cx<'_>,
) {
    let ImportedMechanism { bodies, joints, fields, .. } = imported;
    for figures in &options.parameters {
        if figures.word.text == INERTIAL {
            add_inertial_fields(bodies, standing, figures, (fields, options.format.word_for_body()), cx);
        } else {
            add_joint_fields(joints, figures, (fields, options.format.word_for_body()), cx);
        }
    }
}

fn add_inertial_fields(
    bodies: &mut [Body],
    standing: &[String],
    figures: &FileParameters,
    (fields, link): (&mut Vec<FileField>, &str),
    cx: &mut Cx<'_>,
) {
    let is_fixed_to_ground = |body: &Body| standing.contains(&body.name.text);
    let names: Vec<String> = bodies.iter().map(|body| body.name.text.clone()).collect();
    let chosen = requested_link_or_joint_names(figures, &names, link, cx);
    let mut found = false;
    for body in bodies {
        let Some(name) = chosen.iter().find(|name| name.text == body.name.text) else { continue };
        let missing = match () {
            () if is_fixed_to_ground(body) => {
                Some("is fixed to the ground: its mass properties appear in no equation")
            }
            () if body.mass.is_none() => Some("has no mass properties in the file"),
            () => None,
        };
        if let Some(missing) = missing {
            if figures.of.is_some() {
                let message = format!("{link} {} {missing}", quote_word(&name.text));
                cx.report_error(&name.place, message, |d| d.add_help("remove it from `parameters`"));
            }
            continue;
        }
        found = true;
        let Some(values) = mass_properties(body) else {
            cx.report_internal_loss_of_element(&body.name);
            continue;
        };
        let units = ["kg", "m", "m", "m", "kg·m²", "kg·m²", "kg·m²", "kg·m²", "kg·m²", "kg·m²"].to_vec();
        let about = format!("Mass properties of the {link} `{}`.", body.name.text);
        let of = &body.name.text;
        let e =
            add_field_of_values(FileFieldKind::Inertial, of, "", about, (values, units), &name.place, fields);
        let [mass, x, y, z, xx, xy, xz, yy, yz, zz] = e.as_slice() else { continue };
        let array_expression = |items: [&Expr; 3]| Expr {
            kind: ExprKind::Array(items.map(Clone::clone).to_vec()),
            place: name.place.clone(),
        };
        body.mass = Some(mass.clone());
        body.com = Some(array_expression([x, y, z]));
        body.inertia = Some(array_expression([
            &array_expression([xx, xy, xz]),
            &array_expression([xy, yy, yz]),
            &array_expression([xz, yz, zz]),
        ]));
    }
    if !found && figures.of.is_none() {
        let message = format!("no {link} that moves has mass properties in the file");
        cx.report_error(&figures.word.place, message, |d| {
            d.add_help(format!("leave `{INERTIAL}` out of `parameters`"))
        });
    }
}

fn add_joint_fields(
    joints: &mut [Joint],
    figures: &FileParameters,
    (fields, link): (&mut Vec<FileField>, &str),
    cx: &mut Cx<'_>,
) {
    let word = figures.word.text.as_str();
    // The joint between ground and root is not in the file.
    let has_placement_in_file =
        |joint: &Joint| joint.parent.body.text != crate::syntax::GROUND || joint.child.at.is_some();
    let is_supported_joint = |joint: &Joint| match word {
        PLACEMENT => has_placement_in_file(joint),
        _ => matches!(joint.kind, JointKind::Pin | JointKind::Sleeve),
    };
    let names: Vec<String> = joints.iter().map(|joint| joint.name.text.clone()).collect();
    let chosen = requested_link_or_joint_names(figures, &names, "joint", cx);
    for joint in joints {
        let Some(name) = chosen.iter().find(|name| name.text == joint.name.text) else { continue };
        if !is_supported_joint(joint) {
            if figures.of.is_some() {
                let message = format!("joint {} has no {word}", quote_word(&name.text));
                cx.report_error(&name.place, message, |d| match word {
                    PLACEMENT => d.add_help("it connects the root of the file to the ground"),
                    _ => {
                        d.add_help("a joint that moves along or about one axis has one, unless it is locked")
                    }
                });
            }
            continue;
        }
        let of = &joint.name.text;
        let describe_joint_parameter = |what: &str| format!("{what} of the joint `{of}`.");
        if word == PLACEMENT {
            let Some(values) = joint_placement(joint) else {
                cx.report_internal_loss_of_element(&joint.name);
                continue;
            };
            let units = vec!["m", "m", "m", "rad", "rad", "rad"];
            let description = describe_joint_parameter(&format!("Place, on the parent {link},"));
            let e = add_field_of_values(
                FileFieldKind::Placement,
                of,
                word,
                description,
                (values, units),
                &name.place,
                fields,
            );
            let expression_with_span_of_name = |e| Expr { kind: e, place: name.place.clone() };
            joint.parent.at = Some(expression_with_span_of_name(ExprKind::Array(e[..3].to_vec())));
            let turns = [("z", 5), ("y", 4), ("x", 3)];
            joint.parent.rotated = turns
                .map(|(axis, k)| Expr::function_call_expression(axis, vec![e[k].clone()], &name.place))
                .to_vec();
            continue;
        }
        let turns = joint.kind == JointKind::Pin;
        let (slot, what, unit) = match (word, turns) {
            (DAMPING, true) => (&mut joint.damping, "Viscous damping", "N·m·s/rad"),
            (DAMPING, _) => (&mut joint.damping, "Viscous damping", "N·s/m"),
            (_, true) => (&mut joint.friction, "Dry friction", "N·m"),
            _ => (&mut joint.friction, "Dry friction", "N"),
        };
        debug_assert!([DAMPING, FRICTION].contains(&word));
        let Some(value) = slot.as_ref().map_or(Some(0.0), Expr::literal_number) else {
            cx.report_internal_loss_of_element(&joint.name);
            continue;
        };
        let e = add_field_of_values(
            FileFieldKind::Number,
            of,
            word,
            describe_joint_parameter(what),
            (vec![value], vec![unit]),
            &name.place,
            fields,
        );
        *slot = e.into_iter().next();
    }
}

/// Returns the requested links or joints, or all of them if none are named. Reports unknown and repeated
/// names.
fn requested_link_or_joint_names(
    figures: &FileParameters,
    known: &[String],
    what: &str,
    cx: &mut Cx<'_>,
) -> Vec<Name> {
    let Some(of) = &figures.of else {
        let name_with_option_span =
            |text: &String| Name { text: text.clone(), place: figures.word.place.clone() };
        return known.iter().map(name_with_option_span).collect();
    };
    for (k, name) in of.iter().enumerate() {
        if !known.contains(&name.text) {
            let message = format!("unknown {what} {} in `parameters`", quote_word(&name.text));
            let known = known.iter().map(String::as_str);
            cx.report_error(&name.place, message, |d| d.suggest_name(&name.text, known));
        } else if of[..k].iter().any(|other| other.text == name.text) {
            let message = format!("{what} {} is given twice", quote_word(&name.text));
            cx.report_error(&name.place, message, |d| d.add_help("remove one of the two"));
        }
    }
    of.clone()
}

/// Adds a field for several values of the file, and returns one expression for each value.
fn add_field_of_values(
    kind: FileFieldKind,
    of: &str,
    word: &str,
    about: String,
    (values, units): (Vec<f64>, Vec<&'static str>),
    place: &Place,
    fields: &mut Vec<FileField>,
) -> Vec<Expr> {
    let ident = unused_name(&identifier_of_names(of, word, "link"), |name| {
        fields.iter().any(|field| field.ident == name)
    });
    let field = FileField { ident, kind, of: of.to_string(), about, values, units };
    let name_expression = |text| Expr { kind: ExprKind::Name(text), place: place.clone() };
    let expressions = field.value_access_paths().into_iter().map(name_expression).collect();
    fields.push(field);
    expressions
}

/// Returns an identifier from a name of a file and a word. The `kind` of the named element distinguishes it
/// from numbers and keywords.
pub(in crate::import) fn identifier_of_names(of: &str, word: &str, kind: &str) -> String {
    let replace_nonidentifier_character = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut name: String = of.chars().map(replace_nonidentifier_character).collect();
    if !word.is_empty() {
        name = format!("{name}_{word}");
    }
    if name.starts_with(|c: char| c.is_ascii_digit()) || name.trim_matches('_').is_empty() {
        name = format!("{kind}_{name}");
    }
    if syn::parse_str::<syn::Ident>(&name).is_err() {
        name = format!("{name}_{kind}");
    }
    name
}

/// Returns mass, centre of mass and the entries xx, xy, xz, yy, yz, zz of the inertia about it, in link axes.
fn mass_properties(body: &Body) -> Option<Vec<f64>> {
    let mass = body.mass.as_ref().map_or(Some(0.0), Expr::literal_number)?;
    let com = body.com.as_ref().map_or(Some([0.0; 3]), vector_components)?;
    let inertia = body.inertia.as_ref().map_or(Some([[0.0; 3]; 3]), inertia_matrix_of_expression)?;
    let entries = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| inertia[i][j]);
    Some([mass].into_iter().chain(com).chain(entries).collect())
}

/// Returns the three numbers of a vector, if all components are numbers.
fn vector_components(e: &Expr) -> Option<Vector> {
    let ExprKind::Array(items) = &e.kind else { return None };
    let numbers: Option<Vec<f64>> = items.iter().map(Expr::literal_number).collect();
    numbers?.try_into().ok()
}

/// Returns the inertia matrix of the file as numbers, including rotations about successive axes.
fn inertia_matrix_of_expression(e: &Expr) -> Option<Matrix> {
    match &e.kind {
        ExprKind::Array(rows) => {
            let rows: Option<Vec<Vector>> = rows.iter().map(vector_components).collect();
            rows?.try_into().ok()
        }
        ExprKind::Method(inner, _, rotations) => {
            let axes = rotation_matrix_of_expressions(rotations)?;
            Some(matrix_product(
                &matrix_product(&axes, &inertia_matrix_of_expression(inner)?),
                &transpose(&axes),
            ))
        }
        _ => None,
    }
}

/// Returns axis index and angle of a rotation about a coordinate axis; `None` for another axis.
fn axis_and_angle_of_rotation(e: &Expr) -> Option<(usize, f64)> {
    let ExprKind::Call(axis, arguments) = &e.kind else { return None };
    let axis = ["x", "y", "z"].iter().position(|known| *known == axis.text)?;
    Some((axis, arguments.first()?.literal_number()?))
}

/// Returns the matrix of successive rotations about moving axes.
fn rotation_matrix_of_expressions(rotations: &[Expr]) -> Option<Matrix> {
    rotations
        .iter()
        .try_fold(IDENTITY, |whole, e| Some(matrix_product(&whole, &matrix_of_rotation_expression(e)?)))
}

/// Returns the matrix of one rotation: about a coordinate axis, or about a unit vector.
fn matrix_of_rotation_expression(e: &Expr) -> Option<Matrix> {
    let Some((axis, angle)) = axis_and_angle_of_rotation(e) else {
        let ExprKind::Call(_, arguments) = &e.kind else { return None };
        let [axis, angle] = arguments.as_slice() else { return None };
        return Some(axis_rotation(vector_components(axis)?, angle.literal_number()?));
    };
    let (s, c) = libm::sincos(angle);
    let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = [[0.0; 3]; 3];
    (m[axis][axis], m[p][p], m[q][q], m[p][q], m[q][p]) = (1.0, c, c, -s, s);
    Some(m)
}

/// Returns position, roll, pitch and yaw of a joint's frame. A joint that is locked at a nonzero coordinate
/// has one more rotation than its frame.
fn joint_placement(joint: &Joint) -> Option<Vec<f64>> {
    let rotations = &joint.parent.rotated;
    let turns: Option<Vec<(usize, f64)>> = rotations.iter().map(axis_and_angle_of_rotation).collect();
    let rpy = match turns.filter(|turns| turns.windows(2).all(|pair| pair[0].0 > pair[1].0)) {
        // Yaw, pitch, roll, as the file has them.
        Some(turns) => turns.into_iter().fold([0.0; 3], |mut rpy, (axis, angle)| {
            rpy[axis] = angle;
            rpy
        }),
        None => roll_pitch_yaw(&rotation_matrix_of_expressions(rotations)?),
    };
    let xyz = joint.parent.at.as_ref().map_or(Some([0.0; 3]), vector_components)?;
    Some(xyz.into_iter().chain(rpy).collect())
}
