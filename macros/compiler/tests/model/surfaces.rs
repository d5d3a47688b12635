//! Pairs of surfaces: the contacts and the rolling pairs that the table lists are supported, and no others.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::language::{ArgumentKind, SurfaceFeatureCounts, SurfaceId};
use linkwork_compiler::parse_source_and_import;
use linkwork_compiler::resolve::build_model;
use std::path::Path;

/// Returns a surface of a body with plausible arguments, or the body itself, which is a point.
fn surface_expression_text(body: &str, surface: Option<SurfaceId>) -> String {
    let Some(id) = surface else { return body.to_string() };
    let arguments = id.row().arguments.iter().map(|argument| match (argument.kind, id) {
        (ArgumentKind::Direction, _) => "z".to_string(),
        (ArgumentKind::HalfAngle, SurfaceId::Cone) => "0.3".to_string(),
        (ArgumentKind::HalfAngle, _) => "0.6".to_string(),
        (ArgumentKind::Height, _) => "0.1 * sin(3 * u)".to_string(),
        (ArgumentKind::Coordinate, _) => argument.name.to_string(),
        (ArgumentKind::Points, _) => "[[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]".to_string(),
        (_, SurfaceId::ParametricSurface) => "[u, w, u * w]".to_string(),
        _ => "0.1".to_string(),
    });
    format!("{body}.{}({})", id.name(), arguments.collect::<Vec<_>>().join(", "))
}

/// Returns the number of contact points of a mechanism with a pair of surfaces, and its errors.
fn contact_point_count_and_errors(pair: &str) -> (usize, String) {
    let coordinates = if pair.contains("surface(") { "u: Coordinate, w: Coordinate," } else { "" };
    let item = format!(
        "struct S {{ {coordinates} #[body(mass = 1, inertia = sphere(1, 1))] b: Body,
            #[joint(ground.at([0.1, 0.2, 0.5]) -> b)] j: Free, {pair} }}"
    );
    let mut cx = Diagnostics::new();
    let source =
        parse_source_and_import("".parse().unwrap(), item.parse().unwrap(), Path::new(""), &mut cx).unwrap();
    let graph = Graph::new();
    let model = build_model(&source.mechanism.description, &graph, &mut cx);
    (model.map_or(0, |model| model.contacts.len()), cx.full_message_texts().join("\n"))
}

#[test]
fn every_listed_pair_of_surfaces_is_supported() {
    let mut wrong = Vec::new();
    let mut check = |attribute: &str, is_listed: bool| {
        let (_, found) = contact_point_count_and_errors(attribute);
        if found.contains("the contact point of these surfaces is not supported") == is_listed {
            wrong.push(format!("{attribute}: {found}"));
        }
    };
    for below in SurfaceId::ALL.iter().copied() {
        let base = surface_expression_text("ground", Some(below));
        for above in SurfaceId::ALL.iter().copied() {
            let pairs = [(above, below), (below, above)];
            let touches = pairs.iter().any(|(a, b)| b.row().contacts.contains(&Some(*a)));
            let rolls = pairs.iter().any(|(a, b)| b.row().rollers.contains(a));
            let moving = surface_expression_text("b", Some(above));
            check(&format!("#[contact({moving}, {base})] c: Contact"), touches);
            check(&format!("#[constraint(rolls({moving}, {base}))] c: Rolling"), rolls);
        }
        check(&format!("#[contact(b, {base})] c: Contact"), below.row().contacts.contains(&None));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The number of contact points that is known without the mechanism is that of the mechanism. The hull is a
/// tetrahedron.
#[test]
fn contact_points_of_surfaces_are_counted_in_advance() {
    let size_of_surface = |id: Option<SurfaceId>| {
        let (vertices, corners) = match id {
            Some(SurfaceId::Hull) => (4, 3),
            Some(SurfaceId::Cuboid) => (0, 4),
            _ => (0, 0),
        };
        SurfaceFeatureCounts { id, vertices, corners }
    };
    let mut wrong = Vec::new();
    for below in SurfaceId::ALL.iter().copied() {
        let above = SurfaceId::ALL.iter().copied().map(Some).chain([None]);
        for above in above {
            let counted = size_of_surface(above).contact_point_count(&size_of_surface(Some(below)));
            let [moving, base] =
                [("b", above), ("ground", Some(below))].map(|(body, id)| surface_expression_text(body, id));
            let pair = format!("#[contact({moving}, {base})] c: Contact");
            let (points, errors) = contact_point_count_and_errors(&pair);
            if counted != Some(points).filter(|points| *points > 0) {
                wrong.push(format!("{pair}: {counted:?} instead of {points} {errors}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
