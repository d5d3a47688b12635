//! Chains of pins of any length, as the text of a `#[mechanism]` struct and as a URDF file.

use std::fmt::Write;

/// Source text of a mechanism: the arguments of its attribute, and the struct.
pub struct MechanismSourceText {
    /// Arguments in the parentheses of `#[mechanism]`.
    pub arguments: String,
    /// Text of the struct with its attributes.
    pub item: String,
}

/// Names of a link's parameters: mass, centre of mass, moments of inertia about it, length.
const NUMBERS: [&str; 6] = ["m", "c", "a", "b", "e", "l"];
/// Typical values of the parameters of a link: mass, lengths and moments of inertia, in SI units.
const SIZES: [f64; 6] = [2.0, 0.2, 0.03, 0.04, 0.02, 0.4];

/// Returns the numeric values of link `k` as source text.
fn link_values_text(k: usize) -> [String; 6] {
    SIZES.map(|size| format!("{:.4}", size * (1.0 + 0.1 / k as f64)))
}

/// Returns the names of the parameters of link `k` of `n`. The last link carries no other, so that its length
/// is not used.
fn link_parameter_names(k: usize, n: usize) -> impl Iterator<Item = String> {
    let count = if k < n { 6 } else { 5 };
    NUMBERS.into_iter().take(count).map(move |name| format!("{name}{k}"))
}

/// Returns the index of the axis of joint `k`: x, y or z.
fn axis_index_of_joint(k: usize) -> usize {
    [2, 1, 0][k % 3]
}

/// Returns a chain of `n` links on pins about changing axes, in the struct `name`. With `symbolic`, mass,
/// length, centre of mass and inertia of each link are parameters; otherwise they are numbers.
pub fn chain_source(name: &str, n: usize, symbolic: bool) -> MechanismSourceText {
    let mut item = format!("pub struct {name} {{\n");
    let mut parent = "ground".to_string();
    for k in 1..=n {
        let values = if symbolic { NUMBERS.map(|name| format!("{name}{k}")) } else { link_values_text(k) };
        let [m, c, a, b, e, l] = values;
        if symbolic {
            for parameter in link_parameter_names(k, n) {
                let _ = writeln!(item, "pub {parameter}: f64,");
            }
        }
        let axis = ["x", "y", "z"][axis_index_of_joint(k)];
        let _ = writeln!(
            item,
            "#[body(mass = {m}, com = {c} * z, inertia = diagonal({a}, {b}, {e}))] link{k}: Body,"
        );
        let _ = writeln!(item, "#[joint({parent} -> link{k}, about = {axis})] joint{k}: Pin,");
        parent = format!("link{k}.at({l} * z)");
    }
    item.push('}');
    MechanismSourceText { arguments: "gravity = -9.81 * z".to_string(), item }
}

/// Returns the expression of a struct with parameters that is the same robot as the chain with numbers.
pub fn chain_struct_expression(name: &str, n: usize) -> String {
    let fields = (1..=n).flat_map(|k| link_parameter_names(k, n).zip(link_values_text(k)));
    let fields: Vec<String> = fields.map(|(name, number)| format!("{name}: {number}")).collect();
    format!("{name} {{ {} }}", fields.join(", "))
}

/// Returns the chain as the text of a URDF file.
pub fn chain_as_urdf(n: usize) -> String {
    let mut text = "<robot name=\"chain\">\n  <link name=\"link0\"/>\n".to_string();
    let mut length = "0".to_string();
    for k in 1..=n {
        let [m, c, a, b, e, l] = link_values_text(k);
        let axis = ["1 0 0", "0 1 0", "0 0 1"][axis_index_of_joint(k)];
        let _ = write!(
            text,
            r#"  <link name="link{k}">
    <inertial>
      <origin xyz="0 0 {c}"/>
      <mass value="{m}"/>
      <inertia ixx="{a}" ixy="0" ixz="0" iyy="{b}" iyz="0" izz="{e}"/>
    </inertial>
  </link>
  <joint name="joint{k}" type="revolute">
    <origin xyz="0 0 {length}"/>
    <parent link="link{}"/>
    <child link="link{k}"/>
    <axis xyz="{axis}"/>
    <limit lower="-3.2" upper="3.2" effort="1000" velocity="100"/>
  </joint>
"#,
            k - 1
        );
        length = l;
    }
    text.push_str("</robot>\n");
    text
}
