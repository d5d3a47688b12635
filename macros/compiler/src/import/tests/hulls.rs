//! Tests of convex hulls of mesh files in contacts.

use super::Folder;
use crate::diag::Diagnostics;
use crate::syntax::Description;

/// Returns the description of a mechanism of this file with the contacts that the file declares.
pub(super) fn read_description(
    test: &str,
    options: &str,
    item: &str,
    text: &str,
) -> Result<Description, String> {
    let folder = Folder::new(test, &[("r.xml", text), ("stone.obj", STONE)]);
    let mut cx = Diagnostics::new();
    let (options, item) = (options.parse().expect("tokens"), item.parse().expect("tokens"));
    let source = crate::parse_source_and_import(options, item, &folder.0, &mut cx);
    match source.filter(|_| cx.is_empty()) {
        Some(source) => Ok(source.mechanism.description),
        None => Err(cx.full_message_texts().join("\n")),
    }
}

/// Corners of a box with edges 1, 2 and 3, with points on an edge, on a face and inside.
const STONE: &str = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 1 2 0\nv 0 0 3\nv 1 0 3\nv 0 2 3\nv 1 2 3\n\
                     v 0.5 0 0\nv 0.5 1 0\nv 0.5 1 1\nf 1 2 3 4 5 6 7 8 9 10 11\n";

/// Returns a model with bodies whose mesh has 60 vertices on a sphere.
fn sphere_mesh_model(count: usize) -> String {
    let vertices: String = (0..60)
        .map(|k| {
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 60.0;
            let (sine, cosine) = (f64::from(k) * 2.4).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            format!("{} {} {z} ", radius * cosine, radius * sine)
        })
        .collect();
    let body = "<body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>\
                <geom type='mesh' mesh='m'/></body>";
    format!(
        "<mujoco><asset><mesh name='m' vertex='{vertices}'/></asset><worldbody>\
         <geom type='plane' size='1 1 1'/>{}</worldbody></mujoco>",
        body.repeat(count)
    )
}

#[test]
fn meshes_share_a_budget_of_hull_vertices() {
    for (count, vertices) in [(1, 32), (5, 25), (10, 0)] {
        let found = read_description(
            &format!("hulls{count}"),
            "mjcf = \"r.xml\", contacts = file",
            "struct S;",
            &sphere_mesh_model(count),
        );
        let found = found.expect("a mechanism");
        assert!(found.collisions.iter().all(|part| part.hull.len() == vertices), "{count}");
        assert_eq!(found.contacts.len(), if vertices == 0 { 0 } else { count });
        let line = match vertices {
            // 10 with the plane, and 45 of two bodies.
            0 => "contacts of meshes whose hulls would have more than 128 points together: 55".to_string(),
            _ => format!(
                "the part of the mesh of `body1` outside of the convex hull of {vertices} of its 60 vertices"
            ),
        };
        assert!(found.left_out.iter().any(|found| found.starts_with(&line)), "{:?}", found.left_out);
    }
}

#[test]
fn mesh_files_yield_hulls_with_their_corners() {
    let model = "<mujoco><asset><mesh name='m' file='stone.obj' scale='1 1 -2' refpos='1 0 0'/></asset>\
                 <worldbody><body name='b'><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>\
                 <geom type='mesh' mesh='m'/></body></worldbody></mujoco>";
    let item = "struct S { #[contact(b.collision(), ground.plane(z))] floor: Contact,
        #[contact(ground.hull(\"stone.obj\"), b.sphere(1))] stone: Contact }";
    let found = read_description("stones", "mjcf = \"r.xml\"", item, model).expect("a mechanism");
    let mut corners = found.collisions[0].hull.clone();
    corners.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    let expected = [-1.0, 0.0].map(|x| [0.0, 2.0].map(|y| [-6.0, 0.0].map(|z| [x, y, z]))).concat().concat();
    assert_eq!(corners, expected);
    assert!(found.left_out.iter().all(|line| !line.contains("hull")), "{:?}", found.left_out);
    let error = read_description("lost", "mjcf = \"r.xml\"", &item.replace("stone.obj", "lost.obj"), model);
    assert!(error.is_err_and(|error| error.starts_with("cannot read the mesh `lost.obj`: ")));
}
