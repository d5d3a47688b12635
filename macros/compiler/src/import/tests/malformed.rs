//! Tests of files that are not XML, not URDF, or adversarial.

use super::*;

#[test]
fn malformed_xml_is_reported_at_its_position() {
    for (text, expected) in [
        ("<robot>\n<link></robot>", "r.urdf:2:7: malformed XML: expected `</link>`, found `</robot>`"),
        (
            "<robot>\n <link name='a'>\n  <inertial/>",
            "r.urdf:2:2: malformed XML: this element is never closed",
        ),
        ("<robot>\n <link name='a", "r.urdf:2:2: malformed XML: this element is never closed"),
        ("<robot>\n</robot", "r.urdf:2:8: malformed XML: the file ends in the middle of a tag"),
        ("<robot>\n <link ", "r.urdf:2:2: malformed XML: this element is never closed"),
        ("<robot a='1'\n a='2'/>", "r.urdf:2:2: malformed XML: attribute `a` is given twice"),
        ("<robot a='&x;'/>", "r.urdf:1:11: malformed XML: unknown entity `&x;`"),
        (
            "<robot a='& b'/>",
            "r.urdf:1:11: malformed XML: this `&` does not begin an entity\n= help: write `&amp;` for `&`",
        ),
        ("<a:robot b:c='1'/>", "r.urdf:1:2: malformed XML: unknown namespace prefix `a`"),
        ("<robot a='<'/>", "r.urdf:1:11: malformed XML: expected ``` not `<`"),
        ("<robot/><robot/>", "r.urdf:1:9: malformed XML: unknown token"),
        ("<robot><!-- -- --></robot>", "r.urdf:1:8: malformed XML: comment contains `--`"),
    ] {
        check_import_with_default_options(text, expected);
    }
}

/// Elements and attributes with prefixes of simulators are skipped, whether the prefix is declared or not.
/// Other contents keep their source positions and errors.
#[test]
fn prefixed_elements_are_skipped_without_declaration() {
    let extensions = "<drake:joint x='1'/><gazebo xsi:y='2'>\n<sensor:camera><ö:b/></sensor:camera></gazebo>";
    let robot_with_extensions = |inside: &str| {
        format!("<?xml version='1.0'?>\n<!-- <r> --> <robot name='r'>{extensions}{inside}</robot>")
    };
    check_import_with_default_options(
        &robot_with_extensions("<link name='a'/>"),
        "body a\nWeld root_joint: ground -> a",
    );
    check_import_with_default_options(
        &robot_with_extensions("<link name='a'/>").replace(" name='r'", ""),
        "body a\nWeld root_joint: ground -> a",
    );
    for (inside, expected) in [
        ("<link name='a'/><lnk/>", "r.urdf:3:63: unknown element `<lnk>`\n= help: did you mean `<link>`?"),
        (
            "<link nmae='a'/>",
            "r.urdf:3:53: unknown attribute `nmae` of `<link>`\n= help: did you mean `name`?",
        ),
        ("<link>", "r.urdf:3:53: malformed XML: expected `</link>`, found `</robot>`"),
        ("<a b='&x;'/>", "r.urdf:3:53: malformed XML: unknown entity `&x;`"),
        (
            "<a:link xacro:b='1'/>",
            "r.urdf:3:55: malformed XML: unknown namespace prefix `xacro`
             = help: expand the file first: `xacro robot.urdf.xacro > robot.urdf`",
        ),
    ] {
        check_import_with_default_options(&robot_with_extensions(inside), expected);
    }
    // Prefixes that are declared in some elements and used without declaration in others.
    check_import_with_default_options(
        "<robot xmlns:s ='s'><p:x xmlns:p='u'/><p:y s:a='1'/><q:z xmlns:r='r' r:a='1' t:a='1'/>\
         <link name='a'/></robot>",
        "body a\nWeld root_joint: ground -> a",
    );
    // Errors on the line of the root, where the declarations are inserted, and before them.
    check_import_with_default_options(
        "<robot><d:x/><link name='a'/><link name='b' name='c'/></robot>",
        "r.urdf:1:45: malformed XML: attribute `name` is given twice",
    );
    check_import_with_default_options(
        "<robot><d:x/><link name='a'><mass value='1 2'/>",
        "r.urdf:1:14: malformed XML: this element is never closed",
    );
    check_import_with_default_options(
        "<robot><d:x/><link name='a'><inertial><mass value='0 0'/>\
         <inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='z'/></inertial></link></robot>",
        "r.urdf:1:52: expected a number in `value`, found `0 0`
         = help: write one number, with a decimal point
         r.urdf:1:112: `z` is not a number
         = help: write digits, as in `-0.5` or `1e-3`",
    );
}

#[test]
fn input_that_is_not_xml_gets_a_format_hint() {
    let help = "= help: a URDF file is XML: `<robot name=\"…\"> … </robot>`";
    check_import_with_default_options("", &format!("r.urdf:1:1: malformed XML: there is no element\n{help}"));
    check_import_with_default_options(
        "solid cube",
        &format!("r.urdf:1:1: malformed XML: unknown token\n{help}"),
    );
}

#[test]
fn other_robot_format_is_named_in_the_error() {
    for (root, help) in [
        ("sdf", "this is an SDF file: write `sdf = \"…\"` instead of `urdf = \"…\"`"),
        ("mujoco", "this is an MJCF file: write `mjcf = \"…\"` instead of `urdf = \"…\"`"),
        ("Robot", "did you mean `robot`?"),
        ("html", "expected `robot`"),
    ] {
        let expected = format!("r.urdf:1:1: expected `<robot>`, found `<{root}>`\n= help: {help}");
        check_import_with_default_options(&format!("<{root}/>"), &expected);
    }
}

#[test]
fn xacro_template_is_rejected_once() {
    let help = "= help: expand the file first: `xacro robot.urdf.xacro > robot.urdf`";
    check_import_with_default_options(
        "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n <xacro:include/> <xacro:arm/></robot>",
        &format!("r.urdf:2:2: `<xacro:include>` is an instruction to xacro\n{help}"),
    );
    check_import_with_default_options(
        "<robot><xacro:arm/></robot>",
        &format!("r.urdf:1:9: malformed XML: unknown namespace prefix `xacro`\n{help}"),
    );
    check_import_of_robot_elements(
        "<link name='${prefix}a'/><link name='${prefix}b'/>",
        &format!("r.urdf:2:13: `${{prefix}}a` is an expression of xacro\n{help}"),
    );
    check_import_with_default_options(
        "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><link name='a'/></robot>",
        "body a\nWeld root_joint: ground -> a",
    );
}

#[test]
fn templates_of_other_formats_are_rejected() {
    for (format, word, text, expected) in [
        (
            FileFormat::Sdf,
            "sdf",
            "<sdf><model name='m'><link name='a'><inertial><mass>${m}</mass></inertial></link></model></sdf>",
            "r.urdf:1:53: `${m}` is an expression of xacro",
        ),
        (
            FileFormat::Sdf,
            "sdf",
            "<sdf xmlns:xacro='http://ros.org/wiki/xacro'><xacro:leg/></sdf>",
            "r.urdf:1:46: `<xacro:leg>` is an instruction to xacro",
        ),
        (
            FileFormat::Mjcf,
            "xml",
            "<mujoco xmlns:xacro='http://ros.org/wiki/xacro'><xacro:leg/></mujoco>",
            "r.urdf:1:49: `<xacro:leg>` is an instruction to xacro",
        ),
    ] {
        let help = format!("= help: expand the file first: `xacro robot.{word}.xacro > robot.{word}`");
        check_import_with_options(
            &FileOptions { format, ..default_file_options() },
            text,
            &format!("{expected}\n{help}"),
        );
    }
}

#[test]
fn xml_entities_are_rejected() {
    let bomb = "<!DOCTYPE robot [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;'>]>\n<robot name='&b;'/>";
    let expected = "a URDF file has no document type and no entities of its own";
    check_import_with_default_options(bomb, &format!("r.urdf:1:1: {expected}"));
    check_import_with_default_options(
        "<?xml version='1.0'?>\n<!-- c -->\n<!DOCTYPE robot>\n<robot/>",
        &format!("r.urdf:3:1: {expected}"),
    );
}

#[test]
fn deeply_nested_xml_is_rejected() {
    let deep = "<a>".repeat(100_000);
    let expected = "r.urdf:1:193: more than 64 nested elements";
    check_import_with_default_options(&deep, expected);
    check_import_with_default_options(&(deep + &"</a>".repeat(100_000)), expected);
    // Markup inside comments, instructions, character data and attributes is ignored.
    let quiet =
        [("<!-- ", "-->"), ("<?p ", "?>"), ("<![CDATA[", "]]>"), ("<a b='", "'/>"), ("<a b=\"", "\"/>")];
    let inside: String =
        quiet.map(|(open, close)| open.to_string() + &"/><a>".replace('<', "") + close).concat();
    let text = format!("<robot><link name='a'/>{}</robot>", inside.repeat(100));
    check_import_with_default_options(&text, "body a\nWeld root_joint: ground -> a");
    let markup = "<a>".repeat(100);
    let text = format!("<robot><link name='a'/><!--{markup}--><![CDATA[{markup}]]><?p {markup}?></robot>");
    check_import_with_default_options(&text, "body a\nWeld root_joint: ground -> a");
    // Comments and instructions that end early do not hide the markup after them.
    for hide in ["<!---->", "<?p ?>", "<![CDATA[]]>", "<a b='>'/>", "<a b='\">'/>"] {
        check_import_with_default_options(
            &format!("<r>{hide}{markup}"),
            &expected.replace("193", &(1 + 3 + hide.len() + 63 * 3).to_string()),
        );
    }
}

#[test]
fn excessive_numbers_of_elements_are_rejected() {
    let attributes: String = (0..100).map(|k| format!(" a{k}=''")).collect();
    check_import_with_default_options(
        &format!("<robot{attributes}/>"),
        "r.urdf:1:1: element with more than 64 attributes",
    );
    let crowd = "r.urdf:1:1: the file has too many elements, attributes or namespaces for a robot";
    check_import_with_default_options(&format!("<robot>{}</robot>", "<a xmlns:a='b'/>".repeat(300)), crowd);
    check_import_with_default_options(&"<".repeat(2_000_000), crowd);
}

#[test]
fn oversized_file_is_rejected() {
    check_import_with_default_options(
        &" ".repeat((16 << 20) + 1),
        "`r.urdf` has 17 MiB, expected at most 16 MiB",
    );
}

#[test]
fn source_columns_count_characters() {
    let before = "<!-- änderung\r\n über -->".repeat(50);
    let expected = "r.urdf:52:10: `<link>` without `name`\n= help: expected `<link name=\"…\"/>`";
    check_import_with_default_options(&format!("\u{feff}<robot>\n{before}<link/></robot>"), expected);
}

/// Like other readers of URDF, the importer accepts leading empty lines and trailing zero bytes.
#[test]
fn blank_lines_and_trailing_zero_bytes_are_accepted() {
    let link = "<robot><link name='a'/>";
    check_import_with_default_options(
        &format!("\n \n<?xml version='1.0'?>{link}</robot>\n\0"),
        "body a\nWeld root_joint: ground -> a",
    );
    check_import_with_default_options(
        &format!("\n<?xml version='1.0'\n?> {link}<jiont/></robot>"),
        "r.urdf:3:27: unknown element `<jiont>`\n= help: did you mean `<joint>`?",
    );
    check_import_with_default_options(
        "\n<?xml version='1.0'",
        "r.urdf:2:1: malformed XML: unexpected XML declaration",
    );
}
