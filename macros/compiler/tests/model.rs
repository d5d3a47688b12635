//! Text of a mechanism in; what the model says of it, or the mistakes, out.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::eval::eval_one;
use linkwork_compiler::expr::{Expr, Graph, Mat3, Vec3};
use linkwork_compiler::mechanism::{Coordinate, Link, LinkId, Model, Motion, Pose, Quantity};
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::syntax::{Base, FileFormat, FileOptions, Inertias, InputOption, Name};
use linkwork_compiler::{import, read};
use std::path::Path;

/// Fields of a mechanism, and what comes of them; indentation does not matter.
fn check(fields: &str, expected: &str) {
    compare(&facts(fields, None), expected);
}

/// The same of a file's contents inside `<robot>`.
fn check_urdf(inside: &str, expected: &str) {
    compare(&facts("", Some(&format!("<robot name=\"r\">{inside}</robot>"))), expected);
}

fn compare(actual: &str, expected: &str) {
    let trim = |text: &str| -> Vec<String> {
        text.lines().map(|line| line.trim().to_string()).filter(|line| !line.is_empty()).collect()
    };
    assert!(trim(actual) == trim(expected), "expected\n{expected}\nfound\n{actual}");
}

fn facts(fields: &str, urdf: Option<&str>) -> String {
    let mut cx = Diagnostics::new();
    let item = format!("struct S {{ {fields} }}").parse().unwrap();
    let Some(mut source) = read("".parse().unwrap(), item, Path::new(""), &mut cx) else {
        return cx.messages().join("\n");
    };
    if let Some(text) = urdf {
        let place = source.mechanism.description.name.place.clone();
        let options = FileOptions {
            format: FileFormat::Urdf,
            path: Name { text: "r.urdf".to_string(), place },
            base: Base::Fixed,
            honour_passive: true,
            follow_mimic: true,
            limits: linkwork_compiler::syntax::LimitOption::Honour,
            inertias: Inertias::Check,
            inputs: InputOption::None,
            lock: Vec::new(),
            snap: None,
            parameters: Vec::new(),
            contacts: false,
            collisions: false,
            visuals: false,
        };
        if let Some(imported) = import::import(text, Path::new(""), &options, &mut cx) {
            source.mechanism.description.bodies = imported.bodies;
            source.mechanism.description.joints = imported.joints;
        }
    }
    let graph = Graph::new();
    let model =
        if cx.is_empty() { build_model(&source.mechanism.description, &graph, &mut cx) } else { None };
    match model {
        Some(model) => render(&model),
        None => cx.messages().join("\n"),
    }
}

fn render(model: &Model<'_>) -> String {
    let mut text = format!("q: {}\n", model.configuration.join(" "));
    let velocities: Vec<&str> = model.velocities.iter().map(|(name, _)| name.as_str()).collect();
    if velocities != model.configuration {
        text += &format!("v: {}\n", velocities.join(" "));
    }
    let inputs: Vec<&str> = model.inputs.iter().map(|(name, _)| name.as_str()).collect();
    if !inputs.is_empty() {
        text += &format!("u: {}\n", inputs.join(" "));
    }
    for (k, link) in model.links.iter().enumerate() {
        text += &format!("link {k} on {}{}\n", on(link.parent), motion(link, model));
    }
    for frame in &model.frames {
        text += &format!("frame {} on {}{}\n", frame.name, on(frame.link), pose(&frame.pose));
    }
    text
}

fn on(link: Option<LinkId>) -> String {
    link.map_or("ground".to_string(), |link| link.0.to_string())
}

fn motion(link: &Link<'_>, model: &Model<'_>) -> String {
    let by = |c: &Coordinate| {
        let name = &model.configuration[c.q];
        match (c.ratio, c.offset) {
            (1.0, 0.0) => name.clone(),
            (ratio, offset) => format!("{ratio} {name} + {offset}"),
        }
    };
    let how = match &link.motion {
        Motion::Turn { axis, coordinate } => format!("turns about {} by {}", vector(*axis), by(coordinate)),
        Motion::Slide { axis, coordinate } => format!("slides along {} by {}", vector(*axis), by(coordinate)),
        Motion::Helix { axis, pitch, coordinate } => {
            format!(
                "turns about {} by {} with pitch {}",
                vector(*axis),
                by(coordinate),
                number(value(*pitch))
            )
        }
        Motion::Ball { q, v } => format!("turns freely by q{q}, v{v}"),
        Motion::Free { q, v } => format!("moves freely by q{q}, v{v}"),
        _ => "moves otherwise".to_string(),
    };
    let i = &link.inertia;
    let mut text = format!("{} {how}", pose(&link.placement));
    if !i.mass.is_zero() {
        text += &format!("; mass {}, moment {}", number(value(i.mass)), vector(i.moment));
    }
    if i.tensor.diagonal.iter().any(|d| !d.is_zero()) {
        text += &format!(", inertia {}", matrix(&i.tensor.full()));
    }
    text
}

/// Position and axes, as far as they differ from none.
fn pose(pose: &Pose<'_>) -> String {
    let mut text = String::new();
    if !pose.translation.is_zero() {
        text += &format!(" at {}", vector(pose.translation));
    }
    if !pose.rotation.is_identity() {
        text += &format!(" rotated {}", matrix(&pose.rotation.matrix()));
    }
    text
}

/// The values of the parameters are 2, 3, 4, …
fn value(e: Expr<'_>) -> f64 {
    eval_one(e, &|symbol| match Quantity::of(symbol) {
        Quantity::Parameter(k) => k as f64 + 2.0,
        other => unreachable!("{other:?} in a model of numbers"),
    })
}

fn number(x: f64) -> String {
    let rounded = (x * 1e6).round() / 1e6;
    (rounded + 0.0).to_string()
}

fn vector(v: Vec3<'_>) -> String {
    format!("[{}]", v.0.map(|c| number(value(c))).join(", "))
}

fn matrix(m: &Mat3<'_>) -> String {
    format!("[{}]", m.0.map(|row| vector(Vec3(row))).join(", "))
}

const BODY: &str = "#[body(mass = 1, inertia = sphere(1, 1))]";

#[test]
fn coordinates_are_named_after_their_joints_in_the_order_of_declaration() {
    let joints = [
        ("Pin", "about = z", "j", ""),
        ("Sleeve", "along = x", "j", ""),
        ("Screw", "about = z, pitch = 1", "j", ""),
        ("Collar", "about = z", "j.slide j.turn", ""),
        ("Slot", "along = x, about = z", "j.slide j.turn", ""),
        ("Universal", "about = (x, y)", "j.first j.second", ""),
        ("Planar", "about = z", "j.x j.y j.angle", ""),
        ("Stage", "along = (y, z)", "j.x j.y", ""),
        ("Stage", "along = (y, z, x)", "j.x j.y j.z", ""),
        ("Ball", "", "j.qx j.qy j.qz j.qw", "j.wx j.wy j.wz"),
        ("Free", "", "j.x j.y j.z j.qx j.qy j.qz j.qw", "j.vx j.vy j.vz j.wx j.wy j.wz"),
        ("Weld", "", "", ""),
    ];
    for (kind, axes, q, v) in joints {
        let fields = format!("{BODY} b: Body, #[joint(ground -> b, {axes})] j: {kind},");
        let expected =
            if v.is_empty() { vec![format!("q: {q}")] } else { vec![format!("q: {q}"), format!("v: {v}")] };
        let found = facts(&fields, None);
        let names: Vec<&str> = found.lines().take(expected.len()).map(str::trim).collect();
        assert_eq!(names, expected.iter().map(|line| line.trim()).collect::<Vec<_>>(), "{kind}: {found}");
    }
    // The joints come in their order, the links from the ground outwards.
    check(
        "#[body(mass = 1)] b: Body, #[body(mass = 1)] a: Body,
        #[joint(a -> b, along = y)] second: Sleeve,
        #[joint(ground -> a, along = x)] first: Sleeve,
        #[acts(on = second)] push: Force,
        #[acts(on = first)] pull: Force,",
        "q: second first
        u: push pull
        link 0 on ground slides along [1, 0, 0] by first; mass 1, moment [0, 0, 0]
        link 1 on 0 slides along [0, 1, 0] by second; mass 1, moment [0, 0, 0]
        frame b on 1
        frame a on 0",
    );
}

#[test]
fn welded_bodies_become_one_link() {
    check(
        "#[body(mass = 1)] a: Body,
        #[body(mass = 2, com = x)] b: Body,
        #[particle(mass = 3, at = b.at(z))] p: Particle,
        #[body(mass = 7)] post: Body,
        #[joint(ground -> a, along = x)] rail: Sleeve,
        #[joint(a.at(y).rotated(z(pi / 2)) -> b)] bolt: Weld,
        #[joint(ground.at(2 * x) -> post)] footing: Weld,",
        "q: rail
        link 0 on ground slides along [1, 0, 0] by rail; mass 6, moment [0, 7, 3], inertia [[14, 0, 0], [0, 3, -3], [0, -3, 11]]
        frame a on 0
        frame b on 0 at [0, 1, 0] rotated [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        frame post on ground at [2, 0, 0]
        frame p on 0 at [0, 1, 1] rotated [[0, -1, 0], [1, 0, 0], [0, 0, 1]]",
    );
}

#[test]
fn ends_are_placed_and_rotated() {
    // The joint's frame is that of both ends: the body is where its own end comes to lie on the other.
    check(
        "l: f64,
        #[body(mass = 1)] b: Body,
        #[joint(ground.at(l * x).rotated(x(pi / 2)) -> b.at(l * y), along = y)] rail: Sleeve,",
        "q: rail
        link 0 on ground at [2, 0, 0] rotated [[1, 0, 0], [0, 0, -1], [0, 1, 0]] slides along [0, 1, 0] by rail; mass 1, moment [0, -2, 0], inertia [[4, 0, 0], [0, 0, 0], [0, 0, 4]]
        frame b on 0 at [0, -2, 0]",
    );
    check(
        "#[body(mass = 1, com = x)] b: Body,
        #[joint(ground -> b.rotated(z(pi / 2)), about = z)] pin: Pin,",
        "q: pin
        link 0 on ground turns about [0, 0, 1] by pin; mass 1, moment [0, -1, 0], inertia [[1, 0, 0], [0, 0, 0], [0, 0, 1]]
        frame b on 0 rotated [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]",
    );
    // Rotations in order about carried axes; a direction turned by an angle; a matrix by rows.
    for rotations in [
        "x(pi / 2), z(pi / 2)",
        "eigenaxis(x, pi / 2), eigenaxis(z, pi / 2)",
        "[[0, -1, 0], [0, 0, -1], [1, 0, 0]]",
    ] {
        check(
            &format!("#[body(mass = 1)] b: Body, #[joint(ground.rotated({rotations}) -> b, along = x)] j: Sleeve,"),
            "q: j
            link 0 on ground rotated [[0, -1, 0], [0, 0, -1], [1, 0, 0]] slides along [1, 0, 0] by j; mass 1, moment [0, 0, 0]
            frame b on 0",
        );
    }
}

#[test]
fn turning_axes_of_numbers_are_brought_onto_coordinate_axes() {
    // The frame of the body is not moved by that: what the link's frame is rotated by is taken back.
    check(
        "#[body(mass = 1, com = x)] b: Body, #[joint(ground -> b, about = [0.6, 0, 0.8])] pin: Pin,",
        "q: pin
        link 0 on ground rotated [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]] turns about [0, 0, 1] by pin; mass 1, moment [0.8, 0, 0.6], inertia [[0.36, 0, -0.48], [0, 1, 0], [-0.48, 0, 0.64]]
        frame b on 0 rotated [[0.8, 0, -0.6], [0, 1, 0], [0.6, 0, 0.8]]",
    );
    check(
        "#[body(mass = 1, com = x)] b: Body, #[joint(ground -> b, about = -z)] pin: Pin,",
        "q: pin
        link 0 on ground turns about [0, 0, -1] by pin; mass 1, moment [1, 0, 0], inertia [[0, 0, 0], [0, 1, 0], [0, 0, 1]]
        frame b on 0",
    );
    // One that depends on parameters stays as it is, and so does a sliding one.
    check(
        "a: f64, #[body(mass = 1, com = z)] b: Body, #[joint(ground -> b, about = cos(a) * x + sin(a) * y)] pin: Pin,",
        "q: pin
        link 0 on ground turns about [-0.416147, 0.909297, 0] by pin; mass 1, moment [0, 0, 1], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 0]]
        frame b on 0",
    );
    check(
        "#[body(mass = 1)] b: Body, #[joint(ground -> b, along = unit(3 * x + 4 * y))] rail: Sleeve,",
        "q: rail
        link 0 on ground slides along [0.6, 0.8, 0] by rail; mass 1, moment [0, 0, 0]
        frame b on 0",
    );
}

#[test]
fn joints_of_several_motions_are_chains() {
    check(
        &format!("{BODY} b: Body, #[joint(ground -> b, about = (z, x))] j: Universal,"),
        "q: j.first j.second
        link 0 on ground turns about [0, 0, 1] by j.first
        link 1 on 0 turns about [1, 0, 0] by j.second; mass 1, moment [0, 0, 0], inertia [[0.4, 0, 0], [0, 0.4, 0], [0, 0, 0.4]]
        frame b on 1",
    );
    check(
        "#[body(mass = 1)] b: Body, #[particle(mass = 1)] p: Particle,
        #[joint(ground -> b, along = (x, y))] table: Stage,
        #[joint(b.at(z) -> p, along = z)] lift: Sleeve,",
        "q: table.x table.y lift
        link 0 on ground slides along [1, 0, 0] by table.x
        link 1 on 0 slides along [0, 1, 0] by table.y; mass 1, moment [0, 0, 0]
        link 2 on 1 at [0, 0, 1] slides along [0, 0, 1] by lift; mass 1, moment [0, 0, 0]
        frame b on 1
        frame p on 2",
    );
    check(
        "#[body(mass = 1, com = x, inertia = sphere(1, 0))] nut: Body, #[joint(ground -> nut, about = x, lead = 2 * pi)] j: Screw,",
        "q: j
        link 0 on ground turns about [1, 0, 0] by j with pitch 1; mass 1, moment [1, 0, 0], inertia [[0, 0, 0], [0, 1, 0], [0, 0, 1]]
        frame nut on 0",
    );
}

#[test]
fn followers_share_their_masters_coordinate() {
    let link = |name: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
        )
    };
    let joint = |name: &str, kind: &str, parent: &str, child: &str, more: &str| {
        format!(
            "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><axis xyz='0 0 1'/>{more}</joint>"
        )
    };
    let text = link("base")
        + &link("a")
        + &link("b")
        + &link("c")
        + &joint("a_joint", "revolute", "base", "a", "<mimic joint='c_joint' multiplier='-2' offset='0.5'/>")
        + &joint("b_joint", "prismatic", "base", "b", "<mimic joint='a_joint' multiplier='3'/>")
        + &joint("c_joint", "revolute", "base", "c", "");
    check_urdf(
        &text,
        "q: c_joint
        link 0 on ground turns about [0, 0, 1] by -2 c_joint + 0.5; mass 1, moment [0, 0, 0], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        link 1 on ground slides along [0, 0, 1] by -6 c_joint + 1.5; mass 1, moment [0, 0, 0], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        link 2 on ground turns about [0, 0, 1] by c_joint; mass 1, moment [0, 0, 0], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        frame base on ground
        frame a on 0
        frame b on 1
        frame c on 2",
    );
}

/// Exporters leave such figures where there are none; a body with mass is not as small as they say.
#[test]
fn noise_is_no_inertia() {
    let link = |mass: &str, moment: &str| {
        format!(
            "<link name='a'><inertial><mass value='{mass}'/>
             <inertia ixx='0' ixy='0' ixz='0' iyy='{moment}' iyz='0' izz='0'/></inertial></link>
             <link name='b'/><joint name='j' type='JOINT'><parent link='b'/><child link='a'/></joint>"
        )
    };
    let mistake = |moment: &str| {
        format!(
            "r.urdf:2:14: no real body has the inertia of `a`
             = help: its principal moments are 0, 0, {moment}: the largest exceeds the sum of the others
             = help: mend the file, or write `#[mechanism(urdf = \"…\", inertia = trust)]` to take it as it is"
        )
    };
    for (mass, moment, real) in
        [("0", "1e-18", true), ("0", "2e-18", false), ("2", "1e-16", true), ("2", "3e-16", false)]
    {
        let text = link(mass, moment);
        let moving = text.replace("JOINT", "revolute");
        match real {
            true => assert!(facts("", Some(&format!("<robot>{moving}</robot>"))).starts_with("q: j\n")),
            false => check_urdf(&moving, &mistake(moment)),
        }
        // What is fixed to the ground enters no equation.
        check_urdf(&text.replace("JOINT", "fixed"), "q:\nframe b on ground\nframe a on ground");
    }
}

/// The inertia of a solid as the model has it.
fn inertia(solid: &str) -> [[f64; 3]; 3] {
    let mut cx = Diagnostics::new();
    let item =
        format!("struct S {{ #[body(mass = 1, inertia = {solid})] b: Body, #[joint(ground -> b)] j: Free }}");
    let source = read("".parse().unwrap(), item.parse().unwrap(), Path::new(""), &mut cx).unwrap();
    let graph = Graph::new();
    let model = build_model(&source.mechanism.description, &graph, &mut cx);
    let model = model.unwrap_or_else(|| panic!("{solid}: {:?}", cx.messages()));
    model.links[0].inertia.tensor.full().0.map(|row| row.map(value))
}

fn assert_near(solid: &str, expected: [[f64; 3]; 3], tolerance: f64) {
    let found = inertia(solid);
    let scale = expected.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() <= tolerance * scale, "{solid}: {found:?}, expected {expected:?}");
    }
}

fn diagonal(d: [f64; 3]) -> [[f64; 3]; 3] {
    [[d[0], 0.0, 0.0], [0.0, d[1], 0.0], [0.0, 0.0, d[2]]]
}

/// Mass 3 between two radii along z: axial moment, and transverse moment about the centre of mass, by slices.
fn of_revolution(from: f64, to: f64, outer: impl Fn(f64) -> f64, inner: impl Fn(f64) -> f64) -> (f64, f64) {
    const SLICES: usize = 40_000;
    let (mut mass, mut first, mut axial, mut transverse) = (0.0, 0.0, 0.0, 0.0);
    for k in 0..SLICES {
        let z = from + (to - from) * (k as f64 + 0.5) / SLICES as f64;
        let (r2, s2) = (outer(z).powi(2), inner(z).powi(2));
        let slice = r2 - s2;
        mass += slice;
        first += slice * z;
        axial += slice * (r2 + s2) / 2.0;
        transverse += slice * ((r2 + s2) / 4.0 + z * z);
    }
    let density = 3.0 / mass;
    (axial * density, transverse * density - 3.0 * (first / mass).powi(2))
}

#[test]
fn solids_of_revolution_agree_with_quadrature() {
    let none = |_: f64| 0.0;
    let ball = |r: f64| move |z: f64| (r * r - z * z).max(0.0).sqrt();
    let thin = 1e-5;
    let table = [
        ("rod(3, 2, z)", of_revolution(0.0, 2.0, |_| thin, none), 1e-8),
        ("ring(3, 0.5, z)", of_revolution(0.0, thin, |_| 0.5, |_| 0.5 - thin), 1e-4),
        ("disk(3, 0.5, z)", of_revolution(0.0, thin, |_| 0.5, none), 1e-8),
        ("cylinder(3, 0.5, 2, z)", of_revolution(-1.0, 1.0, |_| 0.5, none), 1e-8),
        ("tube(3, 0.3, 0.5, 2, z)", of_revolution(-1.0, 1.0, |_| 0.5, |_| 0.3), 1e-8),
        ("cone(3, 0.5, 2, z)", of_revolution(0.0, 2.0, |z| z / 4.0, none), 1e-8),
        (
            "capsule(3, 0.5, 2, z)",
            of_revolution(-1.5, 1.5, |z| ball(0.5)((z.abs() - 1.0).max(0.0)), none),
            1e-8,
        ),
        ("sphere(3, 0.5)", of_revolution(-0.5, 0.5, ball(0.5), none), 1e-8),
        ("shell(3, 0.5)", of_revolution(-0.5, 0.5, ball(0.5), ball(0.5 - thin)), 1e-4),
    ];
    for (solid, (axial, transverse), tolerance) in table {
        assert_near(solid, diagonal([transverse, transverse, axial]), tolerance);
        if solid.contains("z)") {
            assert_near(&solid.replace("z)", "x)"), diagonal([axial, transverse, transverse]), tolerance);
            assert_near(&solid.replace("z)", "-y)"), diagonal([transverse, axial, transverse]), tolerance);
            // Moment `a` about n, `t` about its normals: t 1 + (a − t) n nᵀ.
            let n = [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0];
            let tensor = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    (axial - transverse) * n[i] * n[j] + if i == j { transverse } else { 0.0 }
                })
            });
            assert_near(&solid.replace("z)", "[1 / 3, 2 / 3, -2 / 3])"), tensor, tolerance);
        }
    }
}

#[test]
fn solids_of_three_lengths_agree_with_quadrature() {
    // Moments of second order of a box by the rule of two points, which is exact for them.
    let second = |a: f64| (a / 2.0 / 3.0_f64.sqrt()).powi(2);
    let from_second =
        |m: f64, s: [f64; 3]| diagonal([m * (s[1] + s[2]), m * (s[0] + s[2]), m * (s[0] + s[1])]);
    let cuboid = from_second(3.0, [0.5, 1.0, 2.0].map(second));
    assert_near("cuboid(3, 0.5, 1, 2)", cuboid, 1e-12);
    assert_near("box(3, 0.5, 1, 2)", cuboid, 1e-12);
    assert_near("plate(3, 0.5, 1)", from_second(3.0, [second(0.5), second(1.0), 0.0]), 1e-12);
    // A ball of radius one has I = 2 ∫ z² dm about every axis; lengths stretch each second moment alone.
    let (moment, _) = of_revolution(-1.0, 1.0, |z| (1.0 - z * z).max(0.0).sqrt(), |_| 0.0);
    let second = [0.5_f64, 1.0, 2.0].map(|a| a * a * moment / 2.0 / 3.0);
    assert_near("ellipsoid(3, 0.5, 1, 2)", from_second(3.0, second), 1e-8);
    assert_near("diagonal(2, 3, 4)", diagonal([2.0, 3.0, 4.0]), 0.0);
}

#[test]
fn inertias_are_added_and_rotated() {
    assert_near("diagonal(2, 3, 4).rotated(z(pi / 2))", diagonal([3.0, 2.0, 4.0]), 1e-15);
    // R I Rᵀ with R = R_x(π/2) R_z(π/2), whose columns are the rotated axes (0, 0, 1), (−1, 0, 0), (0, −1, 0).
    assert_near("diagonal(2, 3, 4).rotated(x(pi / 2), z(pi / 2))", diagonal([3.0, 4.0, 2.0]), 1e-15);
    let (c, s) = (0.3_f64.cos(), 0.3_f64.sin());
    let rotated =
        [[2.0 * c * c + 3.0 * s * s, -c * s, 0.0], [-c * s, 2.0 * s * s + 3.0 * c * c, 0.0], [0.0, 0.0, 4.0]];
    assert_near("diagonal(2, 3, 4).rotated(z(0.3))", rotated, 1e-15);
    assert_near("diagonal(2, 3, 4).rotated(eigenaxis(z, 0.3))", rotated, 1e-15);
    assert_near(
        "rod(1, 1, x).rotated(z(pi / 2)) + sphere(1, 1)",
        diagonal([29.0, 24.0, 29.0].map(|x| x / 60.0)),
        1e-15,
    );
    assert_near(
        "[[2, 0.1, 0.2], [0.1, 3, 0.3], [0.2, 0.3, 4]]",
        [[2.0, 0.1, 0.2], [0.1, 3.0, 0.3], [0.2, 0.3, 4.0]],
        0.0,
    );
}

#[test]
fn mistakes_are_reported_together_and_once() {
    check(
        "#[body(mass = -1)] a: Body, #[body(mass = 1, com = 2)] b: Body,
        #[joint(ground -> a, along = x + y)] first: Sleeve,
        #[joint(a -> b, about = 0 * z)] second: Pin,
        #[acts(on = second)] push: Force,",
        "this axis is not of unit length
        = help: its length is 1.4142135623730951; write `unit(…)` around it
        this axis has no direction: it is zero
        = help: write `x`, `y`, `z` or another vector of unit length
        the mass of `a` cannot be negative, but it is -1
        = help: a mass is zero or more, kg; gravity has the sign
        expected a vector, found a scalar
        = help: multiply it by a direction, as in `length * y`
        this coordinate is an angle
        = help: what acts on it is a Torque",
    );
    // A body that failed to parse is not unknown where it is joined.
    check(
        "#[body(mass = )] a: Body, #[joint(ground -> a, along = x)] rail: Sleeve,",
        "`mass` has no value\n= help: write `mass = …`",
    );
    check(
        "m: f64, #[body(mass = m * l)] a: Body, #[joint(ground -> a, along = x)] rail: Sleeve,",
        "unknown name `l`
        = help: expected `m`, `x`, `y`, `z` or `pi`
        = help: or declare it: `l: f64` is a parameter, `l: Coordinate` a coordinate",
    );
}

#[test]
fn elements_between_points_need_no_others() {
    let plain = "#[body(mass = 1, inertia = 1)] hull: Body, #[joint(ground -> hull)] pose: Free,";
    let links = facts(plain, None);
    let links = links.lines().next().expect("there is a link");
    for element in [
        "stiffness = 3)] e: Spring",
        "damping = 3)] e: Dashpot",
        "inertance = 3)] e: Inerter",
        "mu = 3)] e: Gravity",
    ] {
        let found = facts(&format!("{plain} #[acts(between = (ground.at(x), hull), {element},"), None);
        assert!(found.starts_with(links), "{element}: {found}");
    }
}
