//! Content of pages: the samples up to rounding, the pieces in the positions of the mechanism, and no
//! external resources.

mod support;

use linkwork::drawing::{Kind, Role};
use linkwork::nalgebra::{Point3, UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork::{Drawn, index_of};
use linkwork_view::{Error, Figure, Motion, Page, csv, page};
use support::{channels, motions};

#[mechanism(urdf = "../../models/urdf/simple_humanoid.urdf", base = free, gravity = 0 * z, drawing)]
struct Humanoid;

type HumanoidSample = linkwork::simulate::Sample<f64, 36, 35, 29>;

/// Simulates a flight of the humanoid with all joints in motion, at 60 samples per second.
fn flight_samples(seconds: f64) -> Vec<HumanoidSample> {
    let v = SVector::<f64, 35>::from_fn(|k, _| if k < 6 { 0.2 } else { (k as f64).sin() });
    let stiff =
        |_, q: &SVector<f64, 36>, _: &SVector<f64, 35>| SVector::<f64, 29>::from_fn(|k, _| -20.0 * q[k + 7]);
    let run = simulate(&Humanoid).from(Humanoid.neutral(), v).inputs(stiff).method(Rk4::step(2e-3));
    run.duration(seconds).sample_every(1.0 / 60.0).collect::<Result<_, _>>().unwrap()
}

#[test]
fn decoded_samples_match_to_half_a_step() {
    let samples = flight_samples(1.0);
    let html = page("Humanoid", &Humanoid, &samples).unwrap();
    let motion = &motions(&html)[0];
    let (channels, step) = (channels(motion), |name: &str| motion[name].as_f64().unwrap());
    let (tick, quantum, turn) = (step("tick"), step("quantum"), step("turn"));
    assert!(quantum < 5e-4, "a humanoid is shown to half a millimetre, here {quantum}");
    assert_eq!(motion["count"], samples.len());
    for (k, sample) in samples.iter().enumerate() {
        assert!((channels[0][k] as f64 * tick - sample.t).abs() <= tick * 0.51);
        for (n, name) in motion["frames"].as_array().unwrap().iter().enumerate() {
            let frame = index_of(&Humanoid::FRAMES, name.as_str().unwrap()).unwrap();
            let placement = Humanoid.frame_placements(&sample.q)[frame];
            let frame_channel_value = |j: usize| channels[1 + 7 * n + j][k] as f64;
            for j in 0..3 {
                assert!(
                    (frame_channel_value(j) * quantum - placement.translation.vector[j]).abs()
                        <= quantum * 0.51
                );
            }
            let [x, y, z, w] = [3, 4, 5, 6].map(|j| frame_channel_value(j) * turn);
            let read = UnitQuaternion::from_quaternion(linkwork::nalgebra::Quaternion::new(w, x, y, z));
            // Four entries with an error of half a step each; the rotation angle is twice that of the
            // quaternion.
            let angle = read.angle_to(&UnitQuaternion::from_rotation_matrix(&placement.rotation));
            assert!(angle <= 2.0 * turn * 1.01, "{name}: {angle}");
        }
    }
}

#[test]
fn ten_seconds_of_humanoid_page_are_small() {
    let html = page("Humanoid", &Humanoid, &flight_samples(10.0)).unwrap();
    assert!(html.len() < 400_000, "{} bytes", html.len());
}

/// Test mechanism with every kind of solid, and joints that rotate and translate them.
#[mechanism(gravity = -9.81 * z, drawing)]
struct Solids {
    m: f64,
    r: f64,
    h: f64,
    #[body(mass = m, com = x, inertia = rod(m, h, y))]
    rod: Body,
    #[body(mass = m, inertia = ring(m, r, x))]
    ring: Body,
    #[body(mass = m, inertia = disk(m, r, x) + cylinder(m, r, h, y))]
    disk: Body,
    #[body(mass = m, inertia = tube(m, r / 2, r, h, z))]
    tube: Body,
    #[body(mass = m, inertia = cone(m, r, h, z))]
    cone: Body,
    #[body(mass = m, inertia = capsule(m, r, h, z))]
    capsule: Body,
    #[body(mass = m, inertia = sphere(m, r) + shell(m, 2 * r))]
    sphere: Body,
    #[body(mass = m, inertia = cuboid(m, r, 2 * r, h).rotated(z(pi / 2)))]
    cuboid: Body,
    #[body(mass = m, inertia = plate(m, r, h) + ellipsoid(m, r, r, h))]
    plate: Body,
    #[body(mass = m, inertia = diagonal(m * r * r, 2 * m * r * r, 2 * m * r * r))]
    figures: Body,
    #[joint(ground -> rod)]
    a: Free,
    #[joint(rod.at(h / 2 * y) -> ring, about = x)]
    b: Pin,
    #[joint(ring -> disk.at(r * x), along = y)]
    c: Sleeve,
    #[joint(disk -> tube)]
    d: Ball,
    #[joint(tube -> cone, about = (x, y))]
    e: Universal,
    #[joint(cone -> capsule, about = z, along = z)]
    f: Collar,
    #[joint(capsule -> sphere)]
    g: Weld,
    #[joint(sphere -> cuboid, about = x)]
    i: Pin,
    #[joint(cuboid -> plate, about = x)]
    j: Pin,
    #[joint(plate -> figures, about = x)]
    k: Pin,
    #[acts(on = b, stiffness = 1)]
    spiral: Spring,
    #[acts(between = (rod.at(h / 2 * y), figures), damping = 1)]
    damper: Dashpot,
    #[acts(on = c)]
    drive: Force,
}

#[test]
fn solids_have_their_declared_numbers() {
    let solids = Solids { m: 2.0, r: 0.2, h: 0.6 };
    let numbers = solids.drawing_numbers();
    let counted: usize = Solids::DRAWING.iter().map(|piece| piece.kind.count()).sum();
    assert_eq!(numbers.len(), counted);
    let find_pieces = |name: &str, role: Role| -> Vec<(Kind, &[f64])> {
        let found = Solids::DRAWING.iter().filter(|p| p.name == name && p.role == role);
        found.map(|p| (p.kind, &numbers[p.first..p.first + p.kind.count()])).collect()
    };
    assert_eq!(find_pieces("rod", Role::Body), [(Kind::Rod, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.6][..])]);
    assert_eq!(find_pieces("ring", Role::Body), [(Kind::Ring, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.2][..])]);
    assert_eq!(
        find_pieces("tube", Role::Body),
        [(Kind::Tube, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.2, 0.6][..])]
    );
    let kinds_of_pieces =
        |name| find_pieces(name, Role::Body).into_iter().map(|(kind, _)| kind).collect::<Vec<_>>();
    assert_eq!(kinds_of_pieces("disk"), [Kind::Disk, Kind::Cylinder]);
    assert_eq!(kinds_of_pieces("sphere"), [Kind::Sphere; 2]);
    assert_eq!(kinds_of_pieces("plate"), [Kind::Cuboid, Kind::Ellipsoid]);
    assert_eq!(kinds_of_pieces("figures"), [Kind::Inertia]);
    // A rotation by 90° about z maps the first edge to y.
    let cuboid = find_pieces("cuboid", Role::Body)[0].1;
    assert!((Vector3::new(cuboid[3], cuboid[6], cuboid[9]) - Vector3::y()).norm() < 1e-12);
    assert_eq!(cuboid[12..], [0.2, 0.4, 0.6]);
    assert_eq!(find_pieces("drive", Role::Input)[0].0, Kind::Force(0));
    assert_eq!(find_pieces("gravity", Role::Gravity)[0].1[3..], [0.0, 0.0, -9.81]);
}

/// Checks that the bar of a child ends at the joint that is drawn on its parent, in an arbitrary
/// configuration.
#[test]
fn bars_end_at_the_drawn_joints() {
    let solids = Solids { m: 2.0, r: 0.2, h: 0.6 };
    let mut q = solids.neutral();
    let turn = SVector::<f64, { Solids::NV }>::from_fn(|k, _| 0.3 + 0.1 * k as f64);
    q = solids.integrate(&q, &turn);
    let (numbers, frames) = (solids.drawing_numbers(), solids.frame_placements(&q));
    let place_in_world = |frame: Option<usize>, n: &[f64]| {
        let point = Point3::new(n[0], n[1], n[2]);
        frame.map_or(point, |k| frames[k] * point)
    };
    let find_piece = |name: &str, role: Role| {
        let piece = Solids::DRAWING.iter().find(|p| p.name == name && p.role == role).unwrap();
        (piece.frames, &numbers[piece.first..])
    };
    let (hinge, ring) = (find_piece("b", Role::Joint), find_piece("rod", Role::Link));
    // The bars of the rod begin at its joint with the ground, and lead to its joint with the ring.
    assert!((place_in_world(hinge.0[0], hinge.1) - place_in_world(ring.0[1], &ring.1[3..])).norm() < 1e-12);
    let ring = solids.frame_placement(linkwork::frame!(Solids, "ring"), &q).translation.vector;
    assert!((place_in_world(hinge.0[0], hinge.1).coords - ring).norm() < 1e-12);
    let damper = find_piece("damper", Role::Element);
    assert!((place_in_world(damper.0[0], damper.1).coords - ring).norm() < 1e-12);
    let figures = solids.frame_placement(linkwork::frame!(Solids, "figures"), &q).translation.vector;
    assert!((place_in_world(damper.0[1], &damper.1[3..]).coords - figures).norm() < 1e-12);
}

#[mechanism(urdf = "tests/shapes.urdf", drawing)]
struct Shapes;

#[test]
fn visual_geometry_of_files_is_drawn() {
    let numbers = Shapes.drawing_numbers();
    let visuals: Vec<_> = Shapes::DRAWING.iter().filter(|p| p.role == Role::Visual).collect();
    let kinds: Vec<Kind> = visuals.iter().map(|p| p.kind).collect();
    // Unreadable geometry is omitted.
    let meshes = ["package://shapes/meshes/wedge.obj", "package://shapes/meshes/lost.stl"].map(Kind::Mesh);
    assert_eq!(kinds, [Kind::Cuboid, meshes[0], Kind::Cylinder, Kind::Sphere, meshes[1]]);
    let cylinder = &numbers[visuals[2].first..];
    // A rotation by 90° about y maps z to x.
    assert!((Vector3::from_column_slice(&cylinder[3..6]) - Vector3::x()).norm() < 1e-12);
    assert_eq!(cylinder[6..8], [0.03, 0.5]);
    // A link without visual geometry is drawn by its inertia; so are links with meshes, in case these cannot
    // be read.
    let bodies: Vec<&str> = Shapes::DRAWING.iter().filter(|p| p.role == Role::Body).map(|p| p.name).collect();
    assert_eq!(bodies, ["base", "arm", "tip"]);

    let figure = Figure::of(&Shapes).meshes(concat!(env!("CARGO_MANIFEST_DIR"), "/tests")).unwrap();
    assert_eq!(figure.missing_meshes(), ["package://shapes/meshes/lost.stl"]);
    let html = page_of_shapes(figure);
    let motion = &motions(&html)[0];
    let meshes: Vec<_> = motion["pieces"].as_array().unwrap().iter().filter(|p| p[0] == "Mesh").collect();
    assert_eq!(meshes.len(), 1, "the other one has no file");
    // Four corners of three coordinates with two bytes each.
    assert_eq!(meshes[0][6][2].as_str().unwrap().len(), 4 * 3 * 2 * 4 / 3);
}

/// Returns the page of a drawing of the robot `Shapes` in its neutral configuration.
fn page_of_shapes(figure: Figure) -> String {
    let placements = vec![Shapes.frame_placements(&Shapes.neutral()).to_vec()];
    let motion = Motion::from_placements("", figure, vec![0.0], placements).unwrap();
    Page::new("shapes").motion(motion).html()
}

/// Checks that a link whose meshes were all read is not also drawn by its mass properties. A link with a
/// missing mesh is, and the page lists the file. A folder that does not exist is an error.
#[test]
fn missing_meshes_are_replaced_and_listed() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");
    let sample = Sample::new(&Shapes, 0.0, Shapes.neutral(), [0.0; 2], [0.0; 2]).unwrap();
    let note = "<p>Drawn by mass properties, since these meshes were not read: ";
    let lost = "<code>package://shapes/meshes/lost.stl</code>";
    let wedge = "<code>package://shapes/meshes/wedge.obj</code>";
    for (html, bodies, list) in [
        (page_of_shapes(Figure::of(&Shapes).meshes(folder).unwrap()), &["arm", "tip"][..], lost.to_string()),
        (page("shapes", &Shapes, &[sample]).unwrap(), &["base", "arm", "tip"], format!("{lost}, {wedge}")),
    ] {
        assert!(html.contains(&format!("{note}{list}.</p>")));
        let motion = &motions(&html)[0];
        let pieces = motion["pieces"].as_array().unwrap();
        let names_with_role = |role: &str| -> Vec<&str> {
            pieces.iter().filter(|p| p[1] == role).map(|p| p[2].as_str().unwrap()).collect()
        };
        assert_eq!(names_with_role("Body"), bodies);
        // Bars from the shoulder to the wrist and to the centre of mass.
        assert_eq!(names_with_role("Link").iter().filter(|name| **name == "arm").count(), 2);
    }
    let error = Figure::of(&Shapes).meshes("/nowhere/meshes").unwrap_err();
    assert!(matches!(&error, Error::File { path, .. } if path.ends_with("meshes")), "{error}");
    assert!(error.to_string().starts_with("/nowhere/meshes: "), "{error}");
}

/// Checks that a log has the errors of a page: no samples, and times that decrease.
#[test]
fn logs_and_pages_agree_on_errors() {
    let sample_at = |t: f64| Sample::new(&Shapes, t, [0.1, 0.2], [0.0; 2], [0.0; 2]).unwrap();
    for samples in [vec![], vec![sample_at(1.0), sample_at(0.5)]] {
        let [log, html] = [csv(&Shapes, &samples), page("", &Shapes, &samples)].map(Result::unwrap_err);
        assert_eq!(std::mem::discriminant(&log), std::mem::discriminant(&html), "{log} {html}");
    }
    assert!(
        csv(&Shapes, &[sample_at(0.5), sample_at(0.5)]).unwrap().ends_with("\r\n0.5,0.1,0.2,0,0,0,0\r\n")
    );
}

#[mechanism(mjcf = "tests/shapes.xml", drawing)]
struct MujocoShapes;

#[mechanism(sdf = "tests/shapes.sdf", drawing)]
struct SdfShapes;

/// Returns the kinds of visual geometry with their positions and first axes in the ground frame, in the zero
/// configuration.
fn visuals_in_ground<M, const NV: usize>(mechanism: &M) -> Vec<(Kind, Vector3<f64>, Vector3<f64>)>
where
    M: Drawn<NV, NV, Scalar = f64>,
{
    let numbers = mechanism.drawing_numbers();
    let visual = M::DRAWING.iter().filter(|p| p.role == Role::Visual);
    let placed = visual.map(|piece| {
        let n = &numbers.as_ref()[piece.first..];
        let home = piece.frames[0].map(|k| mechanism.placement_of(k, 0.0, &SVector::zeros()).unwrap());
        let home = home.unwrap_or_else(linkwork::nalgebra::IsometryMatrix3::identity);
        let (at, axis) = (Vector3::from_column_slice(n), Vector3::from_column_slice(&n[3..]));
        let axis = if piece.kind.count() > 6 { home.rotation * axis } else { Vector3::zeros() };
        (piece.kind, (home * Point3::from(at)).coords, axis)
    });
    placed.collect()
}

/// Checks that the same robot in three formats has the same drawing. The sign of a cylinder axis is
/// irrelevant.
#[test]
fn file_formats_give_the_same_drawing() {
    let urdf = visuals_in_ground::<_, 2>(&Shapes);
    let [mujoco, sdf] = [visuals_in_ground::<_, 2>(&MujocoShapes), visuals_in_ground::<_, 2>(&SdfShapes)];
    // In the MJCF file, a collision shape is drawn if a body has no visual geometry.
    assert_eq!(mujoco.len(), 5);
    assert_eq!(mujoco[4].0, Kind::Ellipsoid);
    // The fifth piece of the URDF file refers to a missing file.
    assert_eq!((urdf.len(), sdf.len()), (5, 4));
    for (given, other) in urdf.iter().zip(&mujoco).take(4).chain(urdf.iter().zip(&sdf)) {
        assert_eq!(std::mem::discriminant(&given.0), std::mem::discriminant(&other.0));
        assert!(
            (given.1 - other.1).norm() < 1e-12 && given.2.cross(&other.2).norm() < 1e-12,
            "{given:?} {other:?}"
        );
    }
    for path in [mujoco[1].0, sdf[1].0] {
        assert!(matches!(path, Kind::Mesh(path) if path.ends_with("wedge.obj")));
    }
}

#[mechanism(gravity = -9.81 * y, scalar = f32, drawing)]
struct SinglePrecisionArm {
    #[particle(mass = 1)]
    bob: Particle,
    #[joint(ground -> bob.at(y), about = z)]
    hinge: Pin,
    #[contact(bob, ground.plane(y))]
    floor: Contact,
}

#[mechanism(inertia = none, drawing)]
struct KinematicArm {
    #[body]
    arm: Body,
    #[body]
    hand: Body,
    #[joint(ground -> arm, about = y)]
    shoulder: Pin,
    #[joint(arm.at(x) -> hand, about = y)]
    elbow: Pin,
}

#[test]
fn single_precision_and_kinematics_are_drawn() {
    let q = [0.3_f32].into();
    let sample =
        |t| linkwork::simulate::Sample { t, q, v: [0.0].into(), u: [].into(), event: None, violation: 0.0 };
    let html = page("single", &SinglePrecisionArm {}, &[sample(0.0_f32), sample(1.0)]).unwrap();
    assert_eq!(motions(&html)[0]["scene"][3], serde_json::json!([0, 1, 0]));

    let roles: Vec<Role> = KinematicArm::DRAWING.iter().map(|p| p.role).collect();
    assert_eq!(roles, [Role::Joint, Role::Joint, Role::Link]);
    let frames = vec![KinematicArm {}.frame_placements(&[0.0, 1.0].into()).to_vec()];
    assert!(Motion::from_placements("", Figure::of(&KinematicArm {}), vec![0.0], frames).is_ok());
}

#[test]
fn pages_are_self_contained_and_escape_names() {
    let hostile = "</script><script>alert('1')</script>\"&";
    let samples = flight_samples(0.1);
    let energy = samples.iter().map(|s| Humanoid.kinetic_energy(&s.q, &s.v)).collect();
    let motion =
        Motion::of(hostile, &Humanoid, &samples).unwrap().plot(hostile, hostile, [(hostile, energy)]);
    let html = Page::new(hostile).text(hostile).motion(motion.unwrap().caption(0.0, hostile)).html();
    assert_eq!(html.matches("<script").count(), 2);
    assert_eq!(html.matches("</script").count(), 2);
    assert!(!html.contains("http:") && !html.contains("https:") && !html.contains("src="));
    assert_eq!(motions(&html)[0]["title"], hostile);
    assert_eq!(motions(&html)[0]["plots"][0][2][0][0], hostile);
}

#[test]
fn invalid_motions_are_errors() {
    let samples = flight_samples(0.1);
    let humanoid_motion = || Motion::of("", &Humanoid, &samples).unwrap();
    assert!(matches!(page::<_, 36, 35, 29>("", &Humanoid, &[]), Err(Error::Empty { .. })));
    assert!(matches!(
        humanoid_motion().plot("", "", [("few", vec![1.0])]),
        Err(Error::Count { found: 1, .. })
    ));
    let nowhere = humanoid_motion().trail("nose", [0.0; 3], 1.0);
    assert!(matches!(nowhere, Err(Error::Frame { name, .. }) if name == "nose"));
    let mut broken = samples.clone();
    broken[2].q[0] = f64::NAN;
    assert!(matches!(Motion::of("", &Humanoid, &broken), Err(Error::NotFinite { sample: 2, .. })));
    broken[2] = samples[0];
    assert!(matches!(Motion::of("", &Humanoid, &broken), Err(Error::Time { sample: 2, .. })));
    let wrong = Figure::of(&Humanoid).add("ball", Kind::Sphere, None, &[0.0; 3]);
    assert!(matches!(wrong, Err(Error::Count { expected: 4, found: 3, .. })));
}

/// Checks that samples above the limit are omitted and that gaps in plotted curves are preserved. A motion of
/// one second has at most 600 samples, one of a minute at most 60 per second.
#[test]
fn samples_are_thinned_and_gaps_preserved() {
    let sample_at_step = |k: i32| {
        let t = f64::from(k) * 1e-3;
        linkwork::simulate::Sample {
            t,
            q: [t].into(),
            v: [1.0].into(),
            u: [].into(),
            event: None,
            violation: 0.0,
        }
    };
    let samples: Vec<_> = (0..=1000).map(sample_at_step).collect();
    let value_with_gap = |k: usize| if k == 0 { f64::NAN } else { k as f64 };
    let motion = Motion::of("", &WheelOnAxle {}, &samples).unwrap().without_plots();
    let motion = motion.plot("", "", [("gap", (0..samples.len()).map(value_with_gap).collect())]).unwrap();
    let html = Page::new("").motion(motion).html();
    let motion = &motions(&html)[0];
    assert_eq!(motion["count"], 501, "every second one");
    let channels = channels(motion);
    assert_eq!(channels[channels.len() - 1][0], -1);
    // The last sample is always shown.
    assert_eq!(channels[0].last(), Some(&100_000));
    let sample_every_six_milliseconds =
        |k: i32| linkwork::simulate::Sample { t: 6e-3 * f64::from(k), ..sample_at_step(k) };
    let minute: Vec<_> = (0..=10_000).map(sample_every_six_milliseconds).collect();
    let html = page("", &WheelOnAxle {}, &minute).unwrap();
    assert_eq!(motions(&html)[0]["count"], 3335, "of samples 6 ms apart every third, and the last");
}

#[mechanism(drawing)]
struct WheelOnAxle {
    #[body(mass = 1, inertia = sphere(1, 1))]
    wheel: Body,
    #[joint(ground -> wheel, about = z)]
    axle: Pin,
}

/// Checks that coordinates of the same unit share one plot: positions, quaternions, angles.
#[test]
fn coordinates_of_one_unit_share_a_plot() {
    #[mechanism(drawing)]
    struct SwingingPendulum {
        #[body(mass = 1, inertia = sphere(1, 1))]
        ball: Body,
        #[joint(ground -> ball)]
        pose: Free,
        #[body(mass = 1, com = x, inertia = rod(1, 2, x))]
        rod: Body,
        #[joint(ball -> rod, about = y)]
        hinge: Pin,
    }
    let run = simulate(&SwingingPendulum {})
        .from(SwingingPendulum.neutral(), [1.0; 7])
        .method(Rk4::step(0.01))
        .duration(0.1);
    let samples: Vec<_> = run.collect::<Result<_, _>>().unwrap();
    let html = page("", &SwingingPendulum {}, &samples).unwrap();
    let plots = motions(&html)[0]["plots"].as_array().unwrap().clone();
    let told = plots.iter().map(|plot| {
        let names: Vec<&str> =
            plot[2].as_array().unwrap().iter().map(|curve| curve[0].as_str().unwrap()).collect();
        (plot[1].as_str().unwrap(), names.join(" "))
    });
    let expected = [("m", "pose.x pose.y pose.z"), ("", "pose.qx pose.qy pose.qz pose.qw"), ("rad", "hinge")];
    assert_eq!(told.collect::<Vec<_>>(), expected.map(|(unit, names)| (unit, names.to_string())));
}

#[test]
fn generic_code_reads_drawings() {
    fn count_drawn_pieces<M: Drawn<NQ, NV>, const NQ: usize, const NV: usize>(_: &M) -> usize {
        M::DRAWING.len()
    }
    assert_eq!(count_drawn_pieces(&WheelOnAxle {}), 2);
}
