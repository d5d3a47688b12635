//! Optional drawings: regions of unbounded surfaces, arrows of forces, and meshes whose files specify a unit.

mod support;

use linkwork::drawing::Kind;
use linkwork::prelude::*;
use linkwork::simulate::Sample;
use linkwork_view::{Error, Figure, Motion, Page};
use serde_json::Value;
use support::{channels, motions};

#[mechanism(gravity = -9.81 * z, drawing)]
struct RollingBall {
    #[body(mass = 2, inertia = sphere(2, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.1), ground.terrain(0.2 * sin(3 * u)))]
    hills: Contact,
}

fn sample_at_time(t: f64) -> Sample<f64, 7, 6, 0> {
    let q = [0.2 * t, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0];
    Sample { t, q: q.into(), v: SVector::zeros(), u: [].into(), event: None, violation: 0.0 }
}

fn motion_of_ball() -> Motion {
    Motion::of("ball", &RollingBall {}, &[sample_at_time(0.0), sample_at_time(0.5), sample_at_time(1.0)])
        .unwrap()
        .without_plots()
}

fn point_on_hill(u: f64, w: f64) -> [f64; 3] {
    [u, w, 0.2 * (3.0 * u).sin()]
}

fn data_of_motion(motion: Motion) -> Value {
    motions(&Page::new("").motion(motion).html()).remove(0)
}

fn meshes_of_motion(motion: &Value) -> Vec<&Value> {
    motion["pieces"].as_array().unwrap().iter().filter(|piece| piece[0] == "Mesh").collect()
}

/// Returns the lowest and highest coordinate of a mesh along each axis.
fn bounds_of_mesh(surface: &Value) -> [[f64; 2]; 3] {
    let (low, step) = (&surface[6][0], &surface[6][1]);
    [0, 1, 2].map(|k| {
        let low = low[k].as_f64().unwrap();
        [low, low + 65535.0 * step[k].as_f64().unwrap()]
    })
}

fn assert_mesh_bounds(surface: &Value, known: [[f64; 2]; 3]) {
    let found = bounds_of_mesh(surface);
    for (found, known) in found.as_flattened().iter().zip(known.as_flattened()) {
        assert!((found - known).abs() < 2e-3, "{surface} {known}");
    }
}

/// Checks the bounds of a surface and the heights of the sine over it. The floor is omitted, and the camera
/// distance does not change.
#[test]
fn surface_is_drawn_over_its_region() {
    let plain = data_of_motion(motion_of_ball());
    let figure =
        motion_of_ball().drawn().surface("more", None, [-1.0, 2.0], [-0.5, 0.5], point_on_hill).unwrap();
    let motion = data_of_motion(motion_of_ball().figure(figure).unwrap());
    let [_, surface] = meshes_of_motion(&motion)[..] else { panic!("the terrain and one surface") };
    assert_eq!((&surface[1], &surface[2]), (&"Surface".into(), &"more".into()));
    assert_mesh_bounds(surface, [[-1.0, 2.0], [-0.5, 0.5], [-0.2, 0.2]]);
    assert!(motion["scene"][6].is_null());
    assert_eq!(plain["scene"][2], motion["scene"][2]);
}

/// Checks that a declared terrain is drawn over the region of the motion, extended by the size of the ball,
/// which is the diagonal of its bounding box.
#[test]
fn terrain_is_drawn_from_its_declaration() {
    let motion = data_of_motion(motion_of_ball());
    let [surface] = meshes_of_motion(&motion)[..] else { panic!("the terrain") };
    assert_eq!((&surface[1], &surface[2], &surface[3]), (&"Surface".into(), &"hills".into(), &(-1).into()));
    let size = motion["scene"][0].as_f64().unwrap();
    assert!((size - 0.2 * 3.0_f64.sqrt()).abs() < 1e-3, "{size}");
    let (low, high) = (-size, 0.2 + size);
    let terrain_height = |u: f64| 0.2 * (3.0 * u).sin();
    assert_mesh_bounds(surface, [[low, high], [-size, size], [terrain_height(low), terrain_height(0.5)]]);
    assert!(motion["scene"][6].is_null(), "no floor under it");
}

/// Checks the drawing of a terrain from a table with parameters on a tilted, moving tray. Its positions are
/// along the axes of the tray.
#[test]
fn terrain_table_is_drawn_in_axes_of_moving_body() {
    #[mechanism(gravity = -9.81 * z, drawing)]
    struct TiltedTray {
        share: f64,
        bumps: Table<2>,
        #[body(mass = 3, inertia = cuboid(3, 1, 1, 0.1))]
        tray: Body,
        #[body(mass = 0.1, inertia = sphere(0.1, 0.05))]
        pearl: Body,
        #[joint(ground -> tray, about = y)]
        tilt: Pin,
        #[joint(ground -> pearl)]
        pose: Free,
        #[contact(pearl.sphere(0.05), tray.at(0.5 * z).terrain(share * bumps(u, w)))]
        hills: Contact,
    }

    let values = &[0.0, 0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 0.0];
    let bumps = Table::new([&[-9.0, 0.0, 9.0], &[-9.0, 1.0, 9.0]], values).unwrap();
    let tray = TiltedTray { share: 0.5, bumps };
    let turned = std::f64::consts::FRAC_PI_2;
    // The x axis of the tray points down, its z axis along x: the pearl is 2 m along −x and 1 m along y of
    // the tray.
    let q = [turned, 0.7, 1.0, 2.0, 0.0, 0.0, 0.0, 1.0];
    let sample =
        Sample { t: 0.0, q: q.into(), v: SVector::zeros(), u: [].into(), event: None, violation: 0.0 };
    let motion = data_of_motion(Motion::of("tray", &tray, &[sample]).unwrap());
    let [surface] = meshes_of_motion(&motion)[..] else { panic!("the terrain") };
    let size = motion["scene"][0].as_f64().unwrap();
    let found = bounds_of_mesh(surface);
    for (found, known) in found[..2].as_flattened().iter().zip([-2.0 - size, size, -size, 1.0 + size]) {
        assert!((found - known).abs() < 2e-3, "{found} {known}");
    }
    // Half of the largest value, near the grid point at 0, 1; zero elsewhere.
    assert!(found[2][1] > 0.15 && found[2][1] <= 0.2 + 1e-6, "{found:?}");
}

#[test]
fn invalid_surfaces_are_errors() {
    let figure_of_ball = || Figure::of(&RollingBall {});
    let error_message = |found: Result<Figure, Error>| found.unwrap_err().to_string();
    let pole =
        error_message(figure_of_ball().surface("pole", None, [0.0, 1.0], [0.0, 1.0], |u, w| [u, w, 1.0 / u]));
    assert!(pole.contains("the surface `pole`") && pole.contains("at 0, 0"), "{pole}");
    for bounds in [[1.0, 1.0], [0.0, f64::NAN], [f64::NEG_INFINITY, 0.0]] {
        assert!(
            error_message(figure_of_ball().surface("", None, bounds, [0.0, 1.0], point_on_hill))
                .contains("increase")
        );
    }
    let nowhere = figure_of_ball().surface("", Some("moon"), [0.0, 1.0], [0.0, 1.0], point_on_hill);
    assert!(matches!(nowhere, Err(Error::Frame { name, .. }) if name == "moon"));
}

/// Checks that decoded components of an arrow equal the given vectors to one quantisation step. Components
/// that are not finite are missing.
#[test]
fn arrows_reproduce_the_given_vectors() {
    let vectors = vec![[0.0, 1.0, 20.0], [3.0, f64::NAN, 10.0], [-3.0, 0.0, 0.0]];
    let motion = motion_of_ball().force(Some("ball"), [0.0, 0.0, -0.1], vectors).unwrap();
    let motion = data_of_motion(motion.torque(None, [1.0, 0.0, 0.0], vec![[0.0, 0.0, 2.0]; 3]).unwrap());
    let arrows = motion["arrows"].as_array().unwrap();
    assert_eq!((&arrows[0][0], &arrows[0][1]), (&"Force".into(), &0.into()));
    assert_eq!((&arrows[1][0], &arrows[1][1]), (&"Torque".into(), &(-1).into()));
    let channels = channels(&motion);
    let first = channels.len() - 6;
    let arrow_component = |arrow: usize, axis: usize, sample: usize| {
        let step = channels[first + 3 * arrow + axis][sample];
        let [low, size] = [1, 2].map(|k| arrows[arrow][3][axis][k].as_f64().unwrap());
        (step >= 0).then_some(low + size * step as f64)
    };
    for (sample, z) in [20.0, 10.0, 0.0].into_iter().enumerate() {
        assert!((arrow_component(0, 2, sample).unwrap() - z).abs() < 0.01);
    }
    assert_eq!((arrow_component(0, 1, 1), arrow_component(1, 2, 2)), (None, Some(2.0)));
    let few = motion_of_ball().force(None, [0.0; 3], vec![[0.0; 3]]);
    assert!(matches!(few, Err(Error::Count { expected: 3, found: 1, .. })));
}

/// Checks that a Collada file in centimetres is read in metres: a wedge with edges of 0.1 m and 0.05 m along
/// x.
#[test]
fn collada_files_are_read_in_metres() {
    let mut numbers = [0.0; 15];
    [3, 7, 11, 12, 13, 14].into_iter().for_each(|k| numbers[k] = 1.0);
    let figure =
        Figure::of(&RollingBall {}).add("wedge", Kind::Mesh("meshes/wedge.dae"), Some("ball"), &numbers);
    let figure = figure.unwrap().meshes(concat!(env!("CARGO_MANIFEST_DIR"), "/tests")).unwrap();
    let motion = data_of_motion(motion_of_ball().figure(figure).unwrap());
    let low = meshes_of_motion(&motion)[0][6][0].as_array().unwrap().iter().map(|x| x.as_f64().unwrap());
    assert!(low.zip([0.05, 0.0, 0.0]).all(|(x, y)| (x - y).abs() < 1e-6));
}
