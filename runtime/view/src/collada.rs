//! Triangles of COLLADA files (`.dae`), versions 1.4 and 1.5: the meshes of the scene, transformed by its
//! nodes, in metres.
//!
//! `up_axis` is not applied. The frames of a robot description are those of its links, which have no upward
//! direction, and common viewers of such files (RViz, Gazebo, MoveIt) also ignore it.

use crate::mesh::MAX_TRIANGLES;
use linkwork::nalgebra::{Matrix4, Point3, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node, NodeId};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Maximum depth of nested nodes, including instances of nodes.
const MAX_DEPTH: usize = 64;
/// Maximum number of node instances. Instances may contain further instances, so that a short file could have
/// an unlimited number.
const MOST_INSTANCES: usize = 100_000;

/// Returns the corners of all triangles of a COLLADA file, three per triangle, m.
pub(crate) fn corners_of_triangles(text: &str) -> Result<Vec<[f32; 3]>, String> {
    let document = Document::parse(text).map_err(|error| format!("not XML: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(format!("expected a `COLLADA` element, found `{}`", root.tag_name().name()));
    }
    let unit = child_element(root, "asset").and_then(|asset| child_element(asset, "unit"));
    let metres = match unit.and_then(|unit| unit.attribute("meter")) {
        Some(text) => text.trim().parse().ok().filter(|m: &f64| *m > 0.0 && m.is_finite()),
        None => Some(1.0),
    };
    let metres = metres.ok_or("the `meter` of the unit is not a length")?;
    let elements_by_id = |library: &'static str, of: &'static str| {
        let libraries = child_elements(root, library).flat_map(move |all| child_elements(all, of));
        libraries.filter_map(|node| Some((node.attribute("id")?, node))).collect::<HashMap<_, _>>()
    };
    let mut reader = ColladaReader {
        geometries: elements_by_id("library_geometries", "geometry"),
        // An instance may refer to any node with an `id`, in a library or in a scene.
        nodes: root
            .descendants()
            .filter(|n| n.tag_name().name() == "node")
            .filter_map(|n| Some((n.attribute("id")?, n)))
            .collect(),
        meshes: HashMap::new(),
        instances: 0,
        corners: Vec::new(),
    };
    let scenes = elements_by_id("library_visual_scenes", "visual_scene");
    let shown = child_element(root, "scene").and_then(|scene| child_element(scene, "instance_visual_scene"));
    let to_metres = Matrix4::new_scaling(metres);
    match shown {
        Some(instance) => {
            let scene = referenced_element(instance, &scenes)?;
            for node in child_elements(scene, "node") {
                reader.read_node(node, &to_metres, 0)?;
            }
        }
        // A file that has geometries but no scene.
        None => {
            for geometry in
                child_elements(root, "library_geometries").flat_map(|all| child_elements(all, "geometry"))
            {
                reader.read_geometry(geometry, &to_metres)?;
            }
        }
    }
    Ok(reader.corners)
}

/// State of the conversion of a COLLADA file: referenced elements by name, and the corners so far.
struct ColladaReader<'a> {
    geometries: HashMap<&'a str, Node<'a, 'a>>,
    nodes: HashMap<&'a str, Node<'a, 'a>>,
    /// Triangulated meshes by the geometry node of the file, so that each geometry is read once for all its
    /// instances.
    meshes: HashMap<NodeId, Vec<Point3<f64>>>,
    instances: usize,
    corners: Vec<[f32; 3]>,
}

impl<'a> ColladaReader<'a> {
    fn read_node(&mut self, node: Node<'a, 'a>, above: &Matrix4<f64>, depth: usize) -> Result<(), String> {
        self.instances += 1;
        if depth > MAX_DEPTH || self.instances > MOST_INSTANCES {
            return Err("endlessly nested nodes".to_string());
        }
        let mut place = *above;
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "matrix" | "translate" | "rotate" | "scale" | "skew" | "lookat" => {
                    place *= transform_of_element(part)?;
                }
                "node" => self.read_node(part, &place, depth + 1)?,
                "instance_node" => {
                    self.read_node(referenced_element(part, &self.nodes)?, &place, depth + 1)?
                }
                "instance_geometry" => {
                    self.read_geometry(referenced_element(part, &self.geometries)?, &place)?
                }
                "instance_controller" => return Err("meshes with skins are not read".to_string()),
                _ => {}
            }
        }
        Ok(())
    }

    fn read_geometry(&mut self, geometry: Node<'a, 'a>, place: &Matrix4<f64>) -> Result<(), String> {
        let mesh = match self.meshes.entry(geometry.id()) {
            Entry::Occupied(found) => found.into_mut(),
            Entry::Vacant(free) => free.insert(triangles_of_geometry(geometry)?),
        };
        check_triangle_limit(self.corners.len() + mesh.len())?;
        self.corners.extend(mesh.iter().map(|corner| {
            let at = place.transform_point(corner);
            [at.x as f32, at.y as f32, at.z as f32]
        }));
        Ok(())
    }
}

fn check_triangle_limit(corners: usize) -> Result<(), String> {
    match corners / 3 > MAX_TRIANGLES {
        true => Err(format!("more than {MAX_TRIANGLES} triangles: take a simplified mesh")),
        false => Ok(()),
    }
}

/// Returns the corners of the triangles of a COLLADA geometry, three per triangle, in its own axes.
fn triangles_of_geometry(geometry: Node<'_, '_>) -> Result<Vec<Point3<f64>>, String> {
    let Some(mesh) = child_element(geometry, "mesh") else {
        let name = geometry.attribute("id").unwrap_or("a geometry without name");
        return Err(format!("`{name}` is not a mesh of polygons"));
    };
    let mut corners = Vec::new();
    for list in mesh.children().filter(Node::is_element) {
        if ["triangles", "polylist", "polygons", "tristrips", "trifans"].contains(&list.tag_name().name()) {
            for face in corners_of_faces(mesh, list)? {
                match list.tag_name().name() {
                    "tristrips" => corners.extend(face.windows(3).flatten()),
                    _ => {
                        let pairs = face.get(1..).unwrap_or_default().windows(2);
                        pairs.for_each(|pair| corners.extend([face[0], pair[0], pair[1]]));
                    }
                }
                check_triangle_limit(corners.len())?;
            }
        }
    }
    Ok(corners)
}

/// Returns the corners of each face, strip or fan in a list of a COLLADA mesh.
fn corners_of_faces(mesh: Node<'_, '_>, list: Node<'_, '_>) -> Result<Vec<Vec<Point3<f64>>>, String> {
    let kind = list.tag_name().name();
    if child_element(list, "ph").is_some() {
        return Err("polygons with holes are not read".to_string());
    }
    let (mut vertices, mut stride) = (None, 1_usize);
    for input in child_elements(list, "input") {
        let offset: Option<usize> = input.attribute("offset").unwrap_or("0").trim().parse().ok();
        let offset = offset.ok_or("an `offset` of an input is not a count")?;
        stride = stride.max(offset.saturating_add(1));
        vertices = vertices.or((input.attribute("semantic") == Some("VERTEX")).then_some((offset, input)));
    }
    let (offset, input) = vertices.ok_or_else(|| format!("a `{kind}` has no input for its vertices"))?;
    let points = vertex_positions(mesh, input)?;
    let corner_position_at_indices = |index: &[usize]| {
        let found = index.get(offset).and_then(|k| points.get(*k)).copied();
        found.ok_or_else(|| format!("a `{kind}` refers to a vertex that does not exist"))
    };
    let mut counts = child_element(list, "vcount")
        .map(parse_number_list::<usize>)
        .transpose()?
        .unwrap_or_default()
        .into_iter();
    let mut faces = Vec::new();
    for indices in child_elements(list, "p") {
        let indices: Vec<usize> = parse_number_list(indices)?;
        let corners: Vec<Point3<f64>> =
            indices.chunks(stride).map(corner_position_at_indices).collect::<Result<_, _>>()?;
        let mut rest = &corners[..];
        while !rest.is_empty() {
            let count = match kind {
                "triangles" => 3,
                "polylist" => counts.next().unwrap_or(0),
                _ => rest.len(),
            };
            if count == 0 || count > rest.len() {
                return Err(format!("the vertices of a `{kind}` do not fit its count"));
            }
            faces.push(rest[..count].to_vec());
            rest = &rest[count..];
        }
    }
    Ok(faces)
}

/// Returns the positions of vertices from the source that their `POSITION` input refers to.
fn vertex_positions(mesh: Node<'_, '_>, vertices: Node<'_, '_>) -> Result<Vec<Point3<f64>>, String> {
    let find_child_by_id = |of: &str, name: &str| {
        mesh.children().find(|node| node.tag_name().name() == of && node.attribute("id") == Some(name))
    };
    let name = vertices.attribute("source").unwrap_or_default();
    let missing_positions_error = || format!("no source of positions at `{name}`");
    let vertices =
        find_child_by_id("vertices", name.trim_start_matches('#')).ok_or_else(missing_positions_error)?;
    let input =
        child_elements(vertices, "input").find(|input| input.attribute("semantic") == Some("POSITION"));
    let source = input.and_then(|input| input.attribute("source")).unwrap_or_default();
    let source =
        find_child_by_id("source", source.trim_start_matches('#')).ok_or_else(missing_positions_error)?;
    let list: Vec<f64> =
        parse_number_list(child_element(source, "float_array").ok_or_else(missing_positions_error)?)?;
    let accessor =
        child_element(source, "technique_common").and_then(|common| child_element(common, "accessor"));
    let accessor_attribute_or_default = |name: &str, otherwise: usize| match accessor
        .and_then(|a| a.attribute(name))
    {
        Some(text) => text.trim().parse().map_err(|_| format!("the `{name}` of an accessor is not a count")),
        None => Ok(otherwise),
    };
    let (stride, offset) =
        (accessor_attribute_or_default("stride", 3)?, accessor_attribute_or_default("offset", 0)?);
    if stride < 3 {
        return Err("positions with fewer than three numbers".to_string());
    }
    let tuples = list.get(offset..).unwrap_or_default().chunks(stride).filter(|p| p.len() >= 3);
    Ok(tuples.map(|p| Point3::new(p[0], p[1], p[2])).collect())
}

/// Returns the homogeneous transform of a transformation element of a node.
fn transform_of_element(part: Node<'_, '_>) -> Result<Matrix4<f64>, String> {
    let (kind, n) = (part.tag_name().name(), parse_number_list::<f64>(part)?);
    Ok(match (kind, n.as_slice()) {
        ("matrix", n) if n.len() == 16 && n[12..] == [0.0, 0.0, 0.0, 1.0] => Matrix4::from_row_slice(n),
        ("translate", [x, y, z]) => Matrix4::new_translation(&Vector3::new(*x, *y, *z)),
        ("scale", [x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(*x, *y, *z)),
        ("rotate", [x, y, z, degrees]) => match Unit::try_new(Vector3::new(*x, *y, *z), 0.0) {
            Some(axis) => Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous(),
            None => Matrix4::identity(),
        },
        _ => {
            let text: String = part.text().unwrap_or_default().chars().take(60).collect();
            return Err(format!("a node is placed by `{kind}` with `{}`, which is not read", text.trim()));
        }
    })
}

fn child_element<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.tag_name().name() == name)
}

fn child_elements<'a>(node: Node<'a, 'a>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |child| child.tag_name().name() == name)
}

/// Returns the element that an instance refers to.
fn referenced_element<'a>(
    instance: Node<'_, '_>,
    known: &HashMap<&str, Node<'a, 'a>>,
) -> Result<Node<'a, 'a>, String> {
    let url = instance.attribute("url").unwrap_or_default();
    let found = url.strip_prefix('#').and_then(|name| known.get(name)).copied();
    found.ok_or_else(|| format!("`{}` refers to `{url}`, which does not exist", instance.tag_name().name()))
}

/// Parses the text of an element as a list of numbers.
fn parse_number_list<T: std::str::FromStr>(node: Node<'_, '_>) -> Result<Vec<T>, String> {
    let read_number = |word: &str| {
        let shown: String = word.chars().take(60).collect();
        word.parse().map_err(|_| format!("`{shown}` in a `{}` is not a number", node.tag_name().name()))
    };
    node.text().unwrap_or_default().split_whitespace().map(read_number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the text of a COLLADA file with a mesh of four corners: a square in the plane z = 0 with edges
    /// of length 2.
    fn collada_file(unit: &str, faces: &str, scene: &str) -> String {
        format!(
            "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' \
             version='1.4.1'>
             <asset>{unit}<up_axis>Y_UP</up_axis></asset>
             <library_geometries><geometry id='square'><mesh>
             <source id='places'><float_array id='f' count='12'>0 0 0 2 0 0 2 2 0 0 2 0</float_array>
             <technique_common><accessor source='#f' count='4' stride='3'/></technique_common></source>
             <source id='normals'><float_array id='n' count='3'>0 0 1</float_array></source>
             <vertices id='v'><input semantic='POSITION' source='#places'/></vertices>{faces}
             </mesh></geometry></library_geometries>{scene}</COLLADA>"
        )
    }

    fn collada_scene_text(nodes: &str) -> String {
        format!(
            "<library_visual_scenes><visual_scene id='s'>{nodes}</visual_scene></library_visual_scenes>
             <scene><instance_visual_scene url='#s'/></scene>"
        )
    }

    const TWO: &str = "<triangles count='2'><input semantic='VERTEX' source='#v' offset='0'/>
        <input semantic='NORMAL' source='#normals' offset='1'/><p>0 0 1 0 2 0 0 0 2 0 3 0</p></triangles>";
    const SHOWN: &str = "<instance_geometry url='#square'/>";

    /// Checks that triangles, polygons and triangle fans of one square yield the same corners. A strip
    /// divides the square along the other diagonal.
    #[test]
    fn face_lists_give_equal_corners() {
        let square = corners_of_triangles(&collada_file("", TWO, "")).unwrap();
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0_f32]];
        assert_eq!(square, [a, b, c, a, c, d]);
        let vertex = "<input semantic='VERTEX' source='#v' offset='0'/>";
        for list in [
            format!("<polylist count='1'>{vertex}<vcount>4</vcount><p>0 1 2 3</p></polylist>"),
            format!("<polylist count='2'>{vertex}<vcount>3 3</vcount><p>0 1 2 0 2 3</p></polylist>"),
            format!("<polygons count='1'>{vertex}<p>0 1 2 3</p></polygons>"),
            format!("<trifans count='1'>{vertex}<p>0 1 2 3</p></trifans>"),
        ] {
            assert_eq!(corners_of_triangles(&collada_file("", &list, "")).as_ref(), Ok(&square), "{list}");
        }
        let strip = format!("<tristrips count='1'>{vertex}<p>0 1 3 2</p></tristrips>");
        assert_eq!(corners_of_triangles(&collada_file("", &strip, "")), Ok(vec![a, b, d, b, d, c]));
    }

    /// Checks the length unit of a COLLADA file and the order of nested transforms: inner transforms are
    /// applied first.
    #[test]
    fn nodes_transform_their_geometry() {
        let nodes = format!(
            "<node><translate>100 0 0</translate><node><rotate>0 0 1 90</rotate>\
             <scale>1 3 1</scale>{SHOWN}</node></node>"
        );
        let found = corners_of_triangles(&collada_file(
            "<unit meter='0.01' name='cm'/>",
            TWO,
            &collada_scene_text(&nodes),
        ))
        .unwrap();
        // (2, 2, 0) is scaled to (2, 6, 0), rotated to (−6, 2, 0) and translated to (94, 2, 0), in
        // centimetres.
        for (x, y) in found[2].into_iter().zip([0.94, 0.02, 0.0]) {
            assert!((x - y).abs() < 1e-6, "{:?}", found[2]);
        }
        let matrix = format!("<node><matrix>0 -3 0 100 1 0 0 0 0 0 1 0 0 0 0 1</matrix>{SHOWN}</node>");
        let by_matrix =
            corners_of_triangles(&collada_file("<unit meter='0.01'/>", TWO, &collada_scene_text(&matrix)))
                .unwrap();
        for (a, b) in found.iter().flatten().zip(by_matrix.iter().flatten()) {
            assert!((a - b).abs() < 1e-6);
        }
        let library =
            "<library_nodes><node id='part'><instance_geometry url='#square'/></node></library_nodes>";
        let twice = "<node><instance_node url='#part'/><translate>0 0 1</translate>\
                     <instance_node url='#part'/></node>";
        let both =
            corners_of_triangles(&collada_file("", TWO, &[library, &collada_scene_text(twice)].concat()))
                .unwrap();
        assert_eq!((both.len(), both[0], both[6]), (12, [0.0; 3], [0.0, 0.0, 1.0]));
    }

    #[test]
    fn invalid_collada_files_are_errors() {
        let vertex = "<input semantic='VERTEX' source='#v'/>";
        let corners_of_faces = |list: &str| corners_of_triangles(&collada_file("", list, ""));
        let corners_of_scene =
            |nodes: &str| corners_of_triangles(&collada_file("", TWO, &collada_scene_text(nodes)));
        let bomb = (0..40).map(|k| {
            let next = format!("<instance_node url='#n{}'/>", k + 1);
            format!("<node id='n{k}'>{next}{next}</node>")
        });
        let bomb: String = bomb.chain([format!("<node id='n40'>{SHOWN}</node>")]).collect();
        let deep = ["<node>".repeat(30_000), "</node>".repeat(30_000)].concat();
        for (what, found) in [
            ("not XML", corners_of_triangles("solid")),
            ("expected a `COLLADA` element, found `robot`", corners_of_triangles("<robot/>")),
            ("`meter`", corners_of_triangles(&collada_file("<unit meter='0'/>", TWO, ""))),
            ("is not a number", corners_of_faces(&format!("<triangles>{vertex}<p>0 1 x</p></triangles>"))),
            (
                "a vertex that does not exist",
                corners_of_faces(&format!("<triangles>{vertex}<p>0 1 9</p></triangles>")),
            ),
            ("do not fit its count", corners_of_faces(&format!("<triangles>{vertex}<p>0 1</p></triangles>"))),
            (
                "do not fit its count",
                corners_of_faces(&format!("<polylist>{vertex}<vcount>4</vcount><p>0 1 2</p></polylist>")),
            ),
            ("no input for its vertices", corners_of_faces("<triangles><p>0 1 2</p></triangles>")),
            ("holes", corners_of_faces(&format!("<polygons>{vertex}<ph><p>0 1 2</p></ph></polygons>"))),
            (
                "no source of positions at `#w`",
                corners_of_faces("<triangles><input semantic='VERTEX' source='#w'/></triangles>"),
            ),
            ("refers to `#cube`", corners_of_scene("<node><instance_geometry url='#cube'/></node>")),
            ("placed by `skew`", corners_of_scene("<node><skew>1 2 3</skew></node>")),
            ("skins", corners_of_scene("<node><instance_controller url='#c'/></node>")),
            ("endlessly nested", corners_of_scene("<node id='a'><instance_node url='#a'/></node>")),
            ("endlessly nested", corners_of_scene(&bomb)),
            ("endlessly nested", corners_of_scene(&deep)),
            (
                "not XML",
                corners_of_triangles(&format!(
                    "<!DOCTYPE x [<!ENTITY e 'lol'>]>{}",
                    collada_file("", TWO, "")
                )),
            ),
        ] {
            let message = found.unwrap_err();
            assert!(message.contains(what), "{what}: {message}");
        }
    }
}
