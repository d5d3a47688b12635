//! Checks motions of MJCF scenes with the contacts that the files declare: bodies with each other, with
//! shapes of the world, declared and excluded pairs.

use linkwork_jit::{Error, Loader, Method, Robot, Sample};

const G: f64 = 9.81;

/// Loads a scene from a temporary file. `test` names the file.
fn load_scene(test: &str, text: &str) -> Result<Robot, Error> {
    let path = std::env::temp_dir().join(format!("linkwork-scene-{test}-{}.xml", std::process::id()));
    std::fs::write(&path, text).expect("a temporary file");
    let robot = Loader::file(&path).options("contacts = file").load();
    std::fs::remove_file(&path).expect("the file is there");
    robot
}

/// Returns the state of a scene of free bodies after a duration. Each body has a position, the angle of its
/// rotation about y, and a velocity along its own axes.
fn end_of_motion(
    robot: &Robot,
    bodies: &[([f64; 3], f64, [f64; 3])],
    duration: f64,
) -> Result<Sample, Error> {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for (position, angle, velocity) in bodies {
        let (sine, cosine) = (angle / 2.0).sin_cos();
        q.extend(position);
        q.extend([0.0, sine, 0.0, cosine]);
        v.extend(velocity);
        v.extend([0.0; 3]);
    }
    robot.simulate().from(&q, &v).method(Method::TimeStepping(1e-3)).duration(duration).finish()
}

#[test]
fn stacked_boxes_stay_where_they_are() -> Result<(), Error> {
    let robot = load_scene(
        "stack",
        "<mujoco><worldbody><geom type='plane'/><body name='a' pos='0 0 .1'><freejoint/><geom type='box' \
         size='.1 .1 .1'/></body>\
         <body name='b' pos='.03 .02 .28'><freejoint/><geom type='box' size='.08 .08 \
         .08'/></body></worldbody></mujoco>",
    )?;
    assert_eq!(robot.contacts(), 8 + 8 + 13);
    let end =
        end_of_motion(&robot, &[([0.0, 0.0, 0.1], 0.0, [0.0; 3]), ([0.03, 0.02, 0.28], 0.0, [0.0; 3])], 0.5)?;
    assert!((end.q[2] - 0.1).abs() < 1e-9 && (end.q[9] - 0.28).abs() < 1e-9, "{:?}", end.q);
    assert!(end.v.iter().all(|v| v.abs() < 1e-9), "{:?}", end.v);
    Ok(())
}

/// Two balls of masses 1 and 3 collide without restitution and friction, so that they continue with their
/// common velocity. The second ball passes through the third, which `<exclude>` names, and through the
/// fourth, whose masks differ.
#[test]
fn balls_collide_unless_the_file_excludes_it() -> Result<(), Error> {
    let ball = |name: &str, x: f64, mass: f64, bits: &str| {
        format!(
            "<body name='{name}' pos='{x} 0 0'><freejoint/><geom size='.1' condim='1' mass='{mass}' \
             {bits}/></body>"
        )
    };
    let bodies = [
        ball("a", 0.0, 1.0, ""),
        ball("b", 0.5, 3.0, ""),
        ball("c", 1.0, 1.0, ""),
        ball("d", 1.5, 1.0, "contype='2' conaffinity='2'"),
    ];
    let robot = load_scene(
        "balls",
        &format!(
            "<mujoco><option gravity='0 0 0'/><worldbody>{}</worldbody><contact><exclude body1='c' \
             body2='b'/>\
             <exclude body1='a' body2='c'/></contact></mujoco>",
            bodies.concat()
        ),
    )?;
    assert_eq!(robot.contacts(), 1);
    let ball_state = |x: f64, velocity: f64| ([x, 0.0, 0.0], 0.0, [velocity, 0.0, 0.0]);
    let start = [ball_state(0.0, 4.0), ball_state(0.5, 0.0), ball_state(1.0, 0.0), ball_state(1.5, 0.0)];
    let end = end_of_motion(&robot, &start, 2.0)?;
    let velocities = [0, 6, 12, 18].map(|k| end.v[k]);
    assert!(velocities.iter().zip([1.0, 1.0, 0.0, 0.0]).all(|(v, e)| (v - e).abs() < 1e-9), "{velocities:?}");
    // The first ball moves 0.3 m at 4 m/s before the impact.
    assert!((end.q[7] - (0.5 + 2.0 - 0.075)).abs() < 4e-3, "{:?}", end.q);
    Ok(())
}

/// A box with the friction of a declared pair slides down a ramp of the world; another one with the friction
/// of its shapes sticks; a ball whose contact is excluded falls through. MuJoCo 4.0.0 finds 0.3291 for the
/// first coordinate of the box that slides, and its soft contacts sink in by up to 1.5 mm.
#[test]
fn declared_pairs_slide_with_their_own_friction() -> Result<(), Error> {
    let robot = load_scene(
        "pairs",
        "<mujoco><default><default class='ice'><pair friction='0.05 0.05'/></default></default><worldbody>\
         <geom name='ramp' type='box' size='2 .5 .05' euler='0 20 0'/>\
         <body name='a' pos='0 -.2 .2' euler='0 20 0'><freejoint/><geom name='a' type='box' size='.1 .1 \
         .1'/></body>\
         <body name='b' pos='0 .2 .2' euler='0 20 0'><freejoint/><geom name='b' type='box' size='.1 .1 \
         .1'/></body>\
         <body name='ghost' pos='0 0 1'><freejoint/><geom size='.1'/></body></worldbody><contact>\
         <pair name='ice' class='ice' geom1='ramp' geom2='a'/><exclude body1='world' \
         body2='ghost'/></contact></mujoco>",
    )?;
    let tilt = 20.0_f64.to_radians();
    let (sine, cosine) = tilt.sin_cos();
    let height = 0.15;
    let initial_state_on_slope = |y: f64| ([height * sine, y, height * cosine], tilt, [0.0; 3]);
    let time = 0.5;
    let end = end_of_motion(
        &robot,
        &[initial_state_on_slope(-0.2), initial_state_on_slope(0.2), ([-3.0, 0.0, 1.0], 0.0, [0.0; 3])],
        time,
    )?;
    let path = 0.5 * G * (sine - 0.05 * cosine) * time * time;
    let slid = [height * sine + path * cosine, -0.2, height * cosine - path * sine];
    for (k, expected) in slid.into_iter().enumerate() {
        assert!((end.q[k] - expected).abs() < 1e-6, "{k}: {} {expected}", end.q[k]);
    }
    assert!(
        (end.q[7] - height * sine).abs() < 1e-9 && (end.q[9] - height * cosine).abs() < 1e-9,
        "{:?}",
        end.q
    );
    assert!((end.q[16] - (1.0 - 0.5 * G * time * time)).abs() < 1e-9, "{:?}", end.q);
    Ok(())
}

/// A ball rolls against a wall of the world and stays there: its centre is a radius in front of it.
#[test]
fn ball_stops_at_a_wall_of_the_world() -> Result<(), Error> {
    let robot = load_scene(
        "wall",
        "<mujoco><worldbody><body name='yard'><geom name='floor' type='plane'/>\
         <geom name='wall' type='box' size='.05 1 .5' pos='1 0 .5'/></body>\
         <body name='ball' pos='.5 0 .1'><freejoint/><geom size='.1' \
         friction='.5'/></body></worldbody></mujoco>",
    )?;
    assert_eq!(robot.contacts(), 2);
    let end = end_of_motion(&robot, &[([0.5, 0.0, 0.1], 0.0, [2.0, 0.0, 0.0])], 1.5)?;
    assert!((end.q[0] - 0.85).abs() < 1e-6 && (end.q[2] - 0.1).abs() < 1e-6, "{:?}", end.q);
    assert!(end.v.iter().all(|v| v.abs() < 1e-6), "{:?}", end.v);
    Ok(())
}

/// Two fingers press on a box with 5 N each. With friction 1.5 they carry up to 15 N, more than its weight of
/// 1.96 N; with 0.1 they carry 1 N, and the box falls with the acceleration of the difference.
#[test]
fn gripper_carries_a_box_by_friction() -> Result<(), Error> {
    for (friction, fall) in [(1.5, 0.0), (0.1, G - 1.0 / 0.2)] {
        let robot = load_scene(
            &format!("gripper{friction}"),
            &format!(
                "<mujoco><default><geom type='box' friction='{friction}' condim='3'/></default><worldbody>\
                 <body name='palm' pos='0 0 .3'><geom name='palm' size='.08 .03 .02'/>\
                 <body name='left' pos='-.05 0 -.1'><joint name='l' type='slide' axis='1 0 0'/><geom \
                 size='.01 .02 .04' mass='.1'/></body>\
                 <body name='right' pos='.05 0 -.1'><joint name='r' type='slide' axis='-1 0 0'/><geom \
                 size='.01 .02 .04' mass='.1'/></body></body>\
                 <body name='box' pos='0 0 .2'><freejoint/><geom size='.03 .03 .03' \
                 mass='.2'/></body></worldbody>\
                 <actuator><motor joint='l'/><motor joint='r'/></actuator></mujoco>"
            ),
        )?;
        let q = [0.01, 0.01, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0];
        let run = robot.simulate().from(&q, &[0.0; 8]).method(Method::TimeStepping(1e-3)).duration(0.05);
        let end = run.inputs(linkwork_jit::Inputs::Constant(&[5.0, 5.0])).finish()?;
        let drop = 0.5 * fall * 0.05 * 0.05;
        assert!((end.q[4] - (0.2 - drop)).abs() < 2e-6, "{friction}: {:?} {drop}", end.q);
    }
    Ok(())
}

/// Loaded mechanisms move with nearly the maximum number of contact points of a mechanism.
#[test]
fn scenes_with_many_contact_points_move() -> Result<(), Error> {
    let boxes: String = (0..15)
        .map(|k| {
            format!(
                "<body pos='{k} 0 .1'><joint type='slide' axis='0 0 1'/><geom type='box' size='.1 .1 \
             .1' mass='1'/></body>"
            )
        })
        .collect();
    let text = format!(
        "<mujoco><default><geom contype='1' conaffinity='2'/></default><worldbody>\
         <geom type='plane' contype='2'/>{boxes}</worldbody></mujoco>"
    );
    let robot = load_scene("many", &text)?;
    assert_eq!(robot.contacts(), 120);
    let q: Vec<f64> = (0..15).map(|k| 0.01 * f64::from(k)).collect();
    let run = robot.simulate().from(&q, &[0.0; 15]).method(Method::TimeStepping(1e-3)).duration(0.1);
    let end = run.finish()?;
    for (k, q) in q.iter().enumerate() {
        let expected = (q - 0.5 * G * 0.01).max(0.0);
        assert!((end.q[k] - expected).abs() < 1e-6, "{k}: {} {expected}", end.q[k]);
    }
    Ok(())
}
