//! Schema of the elements and attributes of MJCF, and the check of files against it.

use super::super::context::{Cx, quote_word};
use super::super::element::{Node, child_elements, element_source_position, quoted_tag, read_name_attribute};
use crate::diag::nearest_candidate;
use crate::import::robot::report_repeated_names;
use crate::syntax::Name;
use std::collections::BTreeMap;

/// Elements with their attributes as MuJoCo 4.0.0 prints them (`mj_printSchema`), and names of older versions
/// with the same meaning. Attributes after the bar do not affect the motion of a mechanism without contacts.
/// A name that begins with `@` is a list of attributes. Elements that are refused have no attributes here.
const SCHEMA: &str = "
@axes: quat axisangle euler xyaxes zaxis
@soft: solref solimp
@limits: solreflimit solimplimit solreffriction solimpfriction margin
@effort: actuatorfrclimited actuatorfrcrange
@end: joint jointinparent tendon site refsite slidersite cranksite
@motor: ctrllimited ctrlrange forcelimited forcerange gear damping armature delay group
@still: cranklength lengthrange interp nsample user
@texture: builtin class colorspace content_type embed file fileback filedown filefront fileleft \
    fileright fileup gridlayout
@picture: gridsize height hflip mark markrgb name nchannel random rgb1 rgb2 type vflip width
@sensed: user name noise cutoff nsample interp delay interval objtype objname reftype refname site body \
    camera joint tendon actuator
@colours: actuator actuatornegative actuatorpositive bv bvactive camera com connect constraint \
    contactforce contactfriction
@sizes: actuatorlength actuatorwidth contactheight contactwidth forcewidth framelength framewidth \
    frustum jointlength jointwidth
mujoco: | model
compiler: alignfree angle assetdir autolimits balanceinertia boundinertia boundmass coordinate eulerseq \
    inertiafromgeom inertiagrouprange meshdir settotalmass strippath | conflict discardvisual fitaabb \
    fusestatic passthrough savecanonical savecompiled saveinertial texturedir usethread convexhull \
    exactmeshinertia
compiler/lengthrange: | accel interval inttotal maxforce mode timeconst timestep tolrange useexisting \
    uselimit
option: actuatorgroupdisable density gravity viscosity wind | apirate ccd_iterations ccd_tolerance \
    collision cone impratio integrator iterations jacobian ls_iterations ls_tolerance magnetic \
    mpr_iterations mpr_tolerance noslip_iterations noslip_tolerance o_friction o_margin o_solimp \
    o_solref sdf_initpoints sdf_iterations sleep_tolerance solver timestep tolerance
option/flag: actuation clampctrl constraint damper equality frictionloss gravity limit passive spring | \
    autoreset contact diagexact energy eulerdamp filterparent fwdinv invdiscrete ipc island midphase \
    multiccd nativeccd override refsafe sensor sensornoise sleep speculative warmstart
size: | memory nconmax njmax nkey nstack nuser_actuator nuser_body nuser_cam nuser_geom nuser_jnt \
    nuser_sensor nuser_site nuser_tendon nuserdata
statistic: | center extent meaninertia meanmass meansize
visual: |
visual/global: | azimuth bvactive cameraid elevation ellipsoidinertia fovy glow ipd linewidth offheight \
    offwidth orthographic realtime
visual/quality: | numquads numslices numstacks offsamples shadowsize
visual/headlight: | active ambient diffuse specular
visual/map: | actuatortendon alpha fogend fogstart force haze shadowclip shadowscale stiffness \
    stiffnessrot torque zfar znear
visual/scale: | @sizes camera com connect constraint light selectpoint slidercrank
visual/rgba: | @colours contactgap contactpoint contacttorque crankbroken fog force frustum haze inertia \
    joint light rangefinder selectpoint slidercrank
default: class |
default/equality: active | @soft
default/tendon: @effort armature damping frictionloss limited range springlength springyield stiffness | \
    @limits group material rgba user width
extension: |
asset: |
asset/mesh: class file inertia name refpos refquat scale | builtin content_type face material \
    maxhullvert normal params smoothnormal texcoord vertex
asset/hfield: | content_type elevation file name ncol nrow size
asset/texture: | @texture @picture
asset/material: | class emission metallic name reflectance rgba roughness shininess specular texrepeat \
    texture texuniform
asset/model: | content_type file name
material/layer: | role texture
worldbody: childclass |
body/body: @axes childclass gravcomp mocap name pos | fuse simple sleep user
body/frame: @axes childclass massscale name pos scale scaling |
body/inertial: @axes diaginertia fullinertia mass pos |
body/joint: @effort armature axis class damping frictionloss limited name pos range ref springdamper \
    springref springyield stiffness type | @limits actuatorgravcomp group user
body/freejoint: align name | group
body/geom: @axes class density fluidshape fromto group mass mesh name pos shellinertia size type | @soft \
    adhesion castshadow conaffinity condim contype fitscale fluidcoef friction gap hfield margin \
    material priority rgba solmix surfacevel user
body/site: @axes class fromto mesh name pos type | group material rgba size user
body/camera: | @axes class focal focalpixel fovy ipd mode name orthographic output pos principal \
    principalpixel projection resolution sensorsize target user
body/light: | active ambient attenuation bulbradius castshadow class cutoff diffuse dir directional \
    exponent intensity mode name pos range softness specular target texture type
contact: |
contact/pair: | @soft adhesion class condim friction gap geom1 geom2 margin name solreffriction
contact/exclude: | body1 body2 name
tendon: |
tendon/spatial: @effort armature class damping frictionloss limited name range springlength springyield \
    stiffness | @limits group material rgba user width
tendon/fixed: @effort armature class damping frictionloss limited name range springlength springyield \
    stiffness | @limits group user
spatial/site: site |
spatial/geom: geom sidesite |
spatial/pulley: divisor |
fixed/joint: coef joint |
equality: |
equality/connect: active anchor body1 body2 class name site1 site2 | @soft
equality/weld: active anchor body1 body2 class name relpose site1 site2 | @soft torquescale
equality/joint: active class joint1 joint2 name polycoef | @soft
equality/tendon: active class name polycoef tendon1 tendon2 | @soft
actuator: |
actuator/general: @end @motor biasprm biastype body class dynprm dyntype gainprm gaintype inheritrange \
    input lengthrange name | @still actdim actearly actlimited actrange ffrange velrange
actuator/motor: @end @motor class name | @still
actuator/position: @end @motor class dampratio inheritrange kp kv name timeconst | @still
actuator/velocity: @end @motor class kv name | @still
actuator/intvelocity: @end @motor class dampratio kp kv name | @still actlimited actrange inheritrange
actuator/damper: @end @motor class kv name | @still
actuator/cylinder: @end @motor area bias class diameter name timeconst | @still
actuator/muscle: @end @motor class force fpmax fvmax lengthrange lmax lmin name range scale tausmooth \
    timeconst vmax | @still
actuator/adhesion: body class ctrlrange delay forcelimited forcerange gain group name | ctrllimited \
    interp nsample user
actuator/orientation: class group joint name refsite site | ctrlrange dampratio delay forcelimited \
    forcerange input interp kp kv nsample user
actuator/pid: @end @motor class dampratio imax input ki kp kv name slewmax | @still ffrange inheritrange \
    posrange velrange
actuator/dcmotor: @end @motor class cogging controller inductance input lugre motorconst name nominal \
    resistance saturation thermal | @still
sensor: |
sensor/touch,accelerometer,velocimeter,gyro,force,torque,magnetometer,camprojection,rangefinder,jointpos,jointvel: \
    | @sensed data
sensor/tendonpos,tendonvel,actuatorpos,actuatorvel,actuatorfrc,jointactuatorfrc,tendonactuatorfrc,ballquat,ballangvel: \
    | @sensed
sensor/jointlimitpos,jointlimitvel,jointlimitfrc,tendonlimitpos,tendonlimitvel,tendonlimitfrc,framepos,framequat: \
    | @sensed
sensor/framexaxis,frameyaxis,framezaxis,framelinvel,frameangvel,framelinacc,frameangacc,subtreecom,subtreelinvel: \
    | @sensed
sensor/subtreeangmom,insidesite,e_potential,e_kinetic,clock: | @sensed enclosed
sensor/distance,normal,fromto,contact: | @sensed body1 body2 data geom1 geom2 num reduce subtree1 \
    subtree2
sensor/tactile,user: | @sensed datatype dim geom mesh needstage
custom: |
custom/numeric: | data name size
custom/text: | data name
custom/tuple: | name
tuple/element: | objname objtype prm
keyframe: |
keyframe/key: | act ctrl mpos mquat name plastic qpos qvel time
";

/// Elements that are rejected or skipped with all their contents.
pub(in crate::import) const WHOLE: [&str; 10] = [
    "composite",
    "flexcomp",
    "replicate",
    "attach",
    "plugin",
    "deformable",
    "skin",
    "flex",
    "flexstrain",
    "distance",
];

/// Attributes of an element, divided by their influence on the motion.
#[derive(Clone, Default)]
pub(in crate::import) struct AttributesByMotionInfluence {
    /// Attributes of an MJCF element that may change the motion.
    pub(in crate::import) moving: Vec<&'static str>,
    /// Attributes of an MJCF element without effect on the motion.
    pub(in crate::import) idle: Vec<&'static str>,
}

/// Returns the attributes of every element. Keys are `parent/element`, or only the name for children of the
/// root.
pub(in crate::import) fn read_schema() -> BTreeMap<String, AttributesByMotionInfluence> {
    let mut lists: BTreeMap<&str, Vec<&'static str>> = BTreeMap::new();
    let mut all = BTreeMap::new();
    for line in SCHEMA.lines() {
        let Some((key, attributes)) = line.split_once(':') else { continue };
        let (moving, idle) = attributes.split_once('|').unwrap_or((attributes, ""));
        let expand_schema_lists = |text: &'static str| -> Vec<&'static str> {
            let words = text.split_ascii_whitespace();
            words.flat_map(|word| lists.get(word).cloned().unwrap_or_else(|| vec![word])).collect()
        };
        let (moving, idle) = (expand_schema_lists(moving), expand_schema_lists(idle));
        if key.starts_with('@') {
            lists.insert(key, moving);
            continue;
        }
        let (parent, tags) = key.split_once('/').map_or((None, key), |(parent, tags)| (Some(parent), tags));
        for name in tags.split(',') {
            let path = parent.map_or_else(|| name.to_string(), |parent| format!("{parent}/{name}"));
            all.insert(path, AttributesByMotionInfluence { moving: moving.clone(), idle: idle.clone() });
        }
    }
    all
}

/// Reports unknown MJCF elements and attributes, and repeated names.
pub(super) fn check_schema(root: Node<'_>, cx: &mut Cx<'_>) {
    check_unique_names(root, cx);
    let schema = read_schema();
    let mut open = vec![root];
    while let Some(node) = open.pop() {
        check_attributes(node, &schema, cx);
        let mut children = Vec::new();
        for child in child_elements(node) {
            let name = child.tag_name().name();
            if WHOLE.contains(&name) {
                continue;
            }
            if schema.contains_key(&schema_key(node, name)) {
                children.push(child);
            } else {
                report_unknown_element(child, &schema_key(node, ""), &schema, cx);
            }
        }
        open.extend(children.into_iter().rev());
    }
}

/// Kinds of MJCF elements whose names must be unique. Names of bodies and joints are checked after unnamed
/// ones have received generated names.
const NAMED: [&str; 6] = ["site", "geom", "tendon", "equality", "actuator", "sensor"];

/// Reports repeated names of MJCF elements of one kind.
fn check_unique_names(root: Node<'_>, cx: &mut Cx<'_>) {
    for kind in NAMED {
        let belongs_to_schema_kind = |node: &Node<'_>| {
            let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
            parent == kind
                || (node.tag_name().name() == kind && ["worldbody", "body", "frame"].contains(&parent))
        };
        let named =
            root.descendants().filter(|node| node.has_attribute("name") && belongs_to_schema_kind(node));
        let names: Vec<Name> = named.filter_map(|node| read_name_attribute(node, "name", cx)).collect();
        report_repeated_names(names.iter(), kind, cx);
    }
}

/// Returns the key of an element with this parent in the schema.
fn schema_key(parent: Node<'_>, name: &str) -> String {
    let parent = match (parent.tag_name().name(), name) {
        ("mujoco", _) | ("default", "default") => return name.to_string(),
        ("worldbody" | "frame", _) => "body",
        ("default", "joint" | "geom" | "site" | "camera" | "light") => "body",
        ("default", "mesh" | "texture" | "material") => "asset",
        ("default", "pair") => "contact",
        ("default", name) if super::actuator::ALL.contains(&name) => "actuator",
        (parent, _) => parent,
    };
    format!("{parent}/{name}")
}

/// Attributes that refer to individual elements and therefore do not occur in defaults.
const OWN: [&str; 10] = [
    "name",
    "class",
    "joint",
    "jointinparent",
    "tendon",
    "site",
    "refsite",
    "slidersite",
    "cranksite",
    "body",
];

fn check_attributes(node: Node<'_>, schema: &BTreeMap<String, AttributesByMotionInfluence>, cx: &mut Cx<'_>) {
    let parent = node.parent_element();
    let name = node.tag_name().name();
    let path = parent.map_or_else(|| name.to_string(), |parent| schema_key(parent, name));
    let Some(found) = schema.get(&path) else { return };
    let within = parent.is_some_and(|parent| parent.tag_name().name() == "default") && name != "default";
    let mut known: Vec<&str> = found.moving.iter().chain(&found.idle).copied().collect();
    known.retain(|attribute| !(within && OWN.contains(attribute)));
    for attribute in node.attributes().filter(|attribute| attribute.namespace().is_none()) {
        if known.contains(&attribute.name()) {
            continue;
        }
        let absent: Vec<&str> = known.iter().copied().filter(|name| !node.has_attribute(*name)).collect();
        let message = format!("unknown attribute {} of {}", quote_word(attribute.name()), quoted_tag(node));
        cx.report_error(&cx.source_position(attribute.range().start), message, |d| {
            match nearest_candidate(attribute.name(), &absent) {
                Some(best) => d.add_help(format!("did you mean `{best}`?")),
                None => d.add_help("MuJoCo 4.0 does not know it either: remove it"),
            }
        });
    }
}

fn report_unknown_element(
    node: Node<'_>,
    parent: &str,
    schema: &BTreeMap<String, AttributesByMotionInfluence>,
    cx: &mut Cx<'_>,
) {
    let name = node.tag_name().name();
    let siblings = schema.keys().map(String::as_str).filter_map(|known| match parent {
        "" => (!known.contains('/')).then_some(known),
        _ => known.strip_prefix(parent),
    });
    let siblings: Vec<&str> = siblings.collect();
    let message = format!("unknown element {}", quoted_tag(node));
    cx.report_error(&element_source_position(node, cx), message, |d| {
        match nearest_candidate(name, &siblings) {
            Some(best) => d.add_help(format!("did you mean `<{best}>`?")),
            None => d.add_help("MuJoCo 4.0 does not know it here either: remove it"),
        }
    });
}
